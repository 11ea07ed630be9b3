// Stone arch of voussoirs with radial joints, which do not share nodes and whose meshes do not match [mm].
//   gmsh -2 arch.geo -o arch.msh
// meshes/arch.py writes the scene for it. Bodies: v01, v02, ... from the right springing to the left. Boundaries of
// every stone: start and end (its joints, start on the side of v01), intrados, extrados. Point: load (middle of the
// extrados of stone `loaded`).

DefineConstant[
  stones = {24, Name "Arch/Number of stones"},
  inner  = {2500, Name "Arch/Radius of the intrados [mm]"},
  outer  = {3000, Name "Arch/Radius of the extrados [mm]"},
  embrace = {160, Name "Arch/Angle between the springings [degrees]"},
  loaded = {16, Name "Arch/Stone with the point load"},
  across = {6, Name "Mesh/Cells across the arch in stones of odd number, one more in the others"},
  along  = {2, Name "Mesh/Cells along half a stone"}
];

origin = newp; Point(origin) = {0, 0, 0};
start[] = {}; end[] = {}; intrados[] = {}; extrados[] = {};
For i In {1:stones}
  For j In {0:2}
    angle = (90 - embrace / 2 + embrace * (i - 1 + j / 2) / stones) * Pi / 180;
    p~{j} = newp; Point(p~{j}) = {inner * Cos(angle), inner * Sin(angle), 0};
    q~{j} = newp; Point(q~{j}) = {outer * Cos(angle), outer * Sin(angle), 0};
  EndFor
  s = newc; Line(s) = {p_0, q_0};
  e1 = newc; Circle(e1) = {q_0, origin, q_1};
  e2 = newc; Circle(e2) = {q_1, origin, q_2};
  e = newc; Line(e) = {q_2, p_2};
  i1 = newc; Circle(i1) = {p_2, origin, p_1};
  i2 = newc; Circle(i2) = {p_1, origin, p_0};
  k = newll; Curve Loop(k) = {s, e1, e2, e, i1, i2};
  b = news; Plane Surface(b) = {k};
  Transfinite Curve {s, e} = across + 1 + (i + 1) % 2;
  Transfinite Curve {e1, e2, i1, i2} = along + 1;
  Transfinite Surface {b} = {p_0, q_0, q_2, p_2};
  Recombine Surface {b};
  Physical Surface(Sprintf("v%02g", i)) = b;
  start[] += s; end[] += e; extrados[] += {e1, e2}; intrados[] += {i1, i2};
  If (i == loaded)
    Physical Point("load") = q_1;
  EndIf
EndFor
Physical Curve("start") = start[];
Physical Curve("end") = end[];
Physical Curve("intrados") = intrados[];
Physical Curve("extrados") = extrados[];

Mesh.MshFileVersion = 4.1;
