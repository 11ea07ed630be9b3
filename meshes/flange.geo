// Half of the sector of a pipe flange around one of its eight bolts, and half of the bolt, tetrahedra [mm]; the axis of the pipe is
// z, the joint is the plane z = 0, the plane of symmetry through the bolt is y = 0.
//   gmsh -3 -format msh22 flange.geo -o flange.msh
// Bodies: flange, bolt. Boundaries: joint, back (under the bolt's head), pipe end, flange y, flange cut (the plane at 22.5 degrees);
// head (what clamps), bolt y, bolt end (in the plane of the joint).

SetFactory("OpenCASCADE");
DefineConstant[
  size  = {4, Name "Mesh/Cell size [mm]"},
  fine  = {2, Name "Mesh/Cell size around the bolt [mm]"},
  inner = {40, Name "Inner radius of the pipe [mm]"},
  outer = {46, Name "Outer radius of the pipe [mm]"},
  rim   = {80, Name "Radius of the flange [mm]"},
  thick = {12, Name "Thickness of the flange [mm]"},
  long  = {60, Name "Length of the pipe from the joint [mm]"},
  place = {63, Name "Radius of the circle of bolts [mm]"},
  hole  = {5.5, Name "Radius of the hole [mm]"},
  shank = {5, Name "Radius of the shank [mm]"},
  head  = {9, Name "Radius of the head [mm]"},
  high  = {7, Name "Height of the head [mm]"}
];
e = 0.01; // of boxes

Cylinder(1) = {place, 0, 0, 0, 0, thick, shank, Pi};
Cylinder(2) = {place, 0, thick, 0, 0, high, head, Pi};
b() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };
bolt_y() = Surface In BoundingBox{-e, -e, -e, rim, e, long};
bolt_end() = Surface In BoundingBox{-e, -e, -e, rim, rim, e};
bolt_head() = Surface In BoundingBox{-e, -e, thick - e, rim, rim, thick + e};
of_bolt() = Surface{:};

Cylinder(11) = {0, 0, 0, 0, 0, thick, rim, Pi / 8};
Cylinder(12) = {0, 0, 0, 0, 0, long, outer, Pi / 8};
f() = BooleanUnion{ Volume{11}; Delete; }{ Volume{12}; Delete; };
Cylinder(13) = {0, 0, -1, 0, 0, long + 2, inner};
Cylinder(14) = {place, 0, -1, 0, 0, thick + 2, hole};
flange() = BooleanDifference{ Volume{f()}; Delete; }{ Volume{13, 14}; Delete; };
flange_y() = Surface In BoundingBox{-e, -e, -e, rim + e, e, long + e}; flange_y() -= of_bolt();
joint() = Surface In BoundingBox{-e, -e, -e, rim + e, rim, e}; joint() -= of_bolt();
back() = Surface In BoundingBox{-e, -e, thick - e, rim + e, rim, thick + e}; back() -= of_bolt();
pipe_end() = Surface In BoundingBox{-e, -e, long - e, rim, rim, long + e};
cut() = Surface In BoundingBox{-e, inner * Sin(Pi / 8) - e, -e, rim, rim, long + e};

Physical Volume("bolt") = {b()}; Physical Volume("flange") = {flange()};
Physical Surface("bolt y") = {bolt_y()}; Physical Surface("bolt end") = {bolt_end()}; Physical Surface("head") = {bolt_head()};
Physical Surface("flange y") = {flange_y()}; Physical Surface("joint") = {joint()}; Physical Surface("back") = {back()};
Physical Surface("pipe end") = {pipe_end()}; Physical Surface("flange cut") = {cut()};

Field[1] = MathEval; Field[1].F = Sprintf("min(%g, %g + 0.2 * max(0, sqrt((x - %g)^2 + y*y) - %g))", size, fine, place, head);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0;
