// Half a section of a large cylinder that stands for a half space, x the radius, y the axis, graded towards the edge of a
// circle on its top [mm]. For Plane state = axisymmetric.
//   gmsh -2 -format msh22 half_space.geo -o half_space.msh
// Boundaries: circle and rest of the top, bottom, side.

DefineConstant[
  circle = {5, Name "Radius of the circle [mm]"},
  extent = {2000, Name "Radius and height [mm]"},
  size   = {0.5, Name "Mesh/Cell size at the centre [mm]"},
  edge   = {0.1, Name "Mesh/Cell size at the edge of the circle [mm]"}
];

Point(1) = {0, 0, 0}; Point(2) = {circle, 0, 0}; Point(3) = {extent, 0, 0};
Point(4) = {extent, -extent, 0}; Point(5) = {0, -extent, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 1};
Curve Loop(1) = {1, 2, 3, 4, 5}; Plane Surface(1) = {-1};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.25 * sqrt((x - %g)^2 + y*y)", edge, circle);
Field[2] = MathEval;
Field[2].F = Sprintf("%g + 0.3 * max(0, sqrt(x*x + y*y) - %g)", size, circle);
Field[3] = Min; Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.Algorithm = 6;

Physical Surface("half space") = {1};
Physical Curve("circle") = {1}; Physical Curve("rest") = {2}; Physical Curve("side") = {3}; Physical Curve("bottom") = {4};
