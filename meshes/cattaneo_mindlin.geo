// Two halves of equal cylinders that touch at the origin [mm], graded towards the contact; the meshes do not match.
//   gmsh -2 cattaneo_mindlin.geo -o cattaneo_mindlin.msh
//   gmsh -2 -setnumber size 0.02 cattaneo_mindlin.geo -o fine.msh     the reference size of prm/cattaneo_mindlin.prm
// Bodies: upper, lower. Boundaries: contact (of both), flat (of both), arc. Points: upper middle, lower middle, lower
// end (of the flats).

DefineConstant[
  size    = {0.09, Name "Mesh/Cell size at the contact [mm]"},
  radius  = {100, Name "Radius of the cylinders [mm]"},
  contact = {1.6, Name "Half width of the contact boundary [mm]"},
  fine    = {1.1, Name "Mesh/Radius of the region of constant cell size [mm]"},
  ratio   = {1.15, Name "Mesh/Cell sizes of lower against upper"}
];

origin = newp; Point(origin) = {0, 0, 0, size};
yc = radius - Sqrt(radius^2 - contact^2);

grading[] = {}; flats[] = {}; contacts[] = {}; arcs[] = {};
For side In {0:1}
  s = 1 - 2 * side; // 1 above, -1 below: turned by 180 degrees
  h = side == 0 ? size : size * ratio;
  c = newp; Point(c) = {0, s * radius, 0, 0.2 * radius};
  l = newp; Point(l) = {-s * radius, s * radius, 0, 0.2 * radius};
  p = newp; Point(p) = {-s * contact, s * yc, 0, h};
  q = newp; Point(q) = {s * contact, s * yc, 0, h};
  r = newp; Point(r) = {s * radius, s * radius, 0, 0.2 * radius};
  a1 = newc; Circle(a1) = {l, c, p};
  a2 = newc; Circle(a2) = {p, c, q};
  a3 = newc; Circle(a3) = {q, c, r};
  f1 = newc; Line(f1) = {r, c};
  f2 = newc; Line(f2) = {c, l};
  k = newll; Curve Loop(k) = {a1, a2, a3, f1, f2};
  b = news; Plane Surface(b) = {k};
  Recombine Surface {b};
  d = newf; Field[d] = Distance; Field[d].NodesList = {origin};
  t = newf; Field[t] = Threshold; Field[t].IField = d;
  Field[t].LcMin = h; Field[t].LcMax = 0.25 * radius; Field[t].DistMin = fine; Field[t].DistMax = radius;
  g = newf; Field[g] = Restrict; Field[g].IField = t;
  Field[g].FacesList = {b}; Field[g].EdgesList = {a1, a2, a3, f1, f2};
  grading[] += g;
  flats[] += {f1, f2}; contacts[] += a2; arcs[] += {a1, a3};
  If (side == 0)
    Physical Surface("upper") = b;
    Physical Point("upper middle") = c;
  Else
    Physical Surface("lower") = b;
    Physical Point("lower middle") = c;
    Physical Point("lower end") = r;
  EndIf
EndFor
Physical Curve("contact") = contacts[];
Physical Curve("flat") = flats[];
Physical Curve("arc") = arcs[];

m = newf; Field[m] = Min; Field[m].FieldsList = {grading[]};
Background Field = m;
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;
Mesh.Algorithm = 6;
Mesh.RecombinationAlgorithm = 3; // quadrilaterals only
Mesh.MshFileVersion = 2.2;
