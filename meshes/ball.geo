// Half a section of a ball (its lower half) above a block, graded towards the point where they touch, the origin [mm]; the
// meshes do not match. For Plane state = axisymmetric: x is the radius, y the axis.
//   gmsh -2 -format msh22 ball.geo -o ball.msh
// Bodies: ball, block. Boundaries: arc and flat (of the ball), top, bottom and side (of the block); contact: what may touch,
// of both.

DefineConstant[
  size    = {0.07, Name "Mesh/Cell size at the contact [mm]"},
  radius  = {50, Name "Radius of the ball [mm]"},
  extent  = {50, Name "Radius and height of the block [mm]"},
  contact = {2, Name "Radius of the contact boundaries [mm]"},
  fine    = {0.8, Name "Mesh/Radius of the region of constant cell size [mm]"},
  ratio   = {1.15, Name "Mesh/Cell sizes of the block against the ball"}
];

Point(1) = {0, 0, 0}; Point(2) = {contact, radius - Sqrt(radius^2 - contact^2), 0};
Point(3) = {radius, radius, 0}; Point(4) = {0, radius, 0};
Circle(1) = {1, 4, 2}; Circle(2) = {2, 4, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};

Point(11) = {0, 0, 0}; Point(12) = {contact, 0, 0}; Point(13) = {extent, 0, 0};
Point(14) = {extent, -extent, 0}; Point(15) = {0, -extent, 0};
Line(11) = {11, 12}; Line(12) = {12, 13}; Line(13) = {13, 14}; Line(14) = {14, 15}; Line(15) = {15, 11};
Curve Loop(2) = {11, 12, 13, 14, 15}; Plane Surface(2) = {-2};

Field[1] = MathEval; Field[1].F = Sprintf("%g + 0.25 * max(0, sqrt(x*x + y*y) - %g)", size, fine);
Field[2] = Restrict; Field[2].InField = 1; Field[2].SurfacesList = {1}; Field[2].CurvesList = {1, 2, 3, 4}; Field[2].PointsList = {1, 2, 3, 4};
Field[3] = MathEval; Field[3].F = Sprintf("%g * (%g + 0.25 * max(0, sqrt(x*x + y*y) - %g))", ratio, size, fine);
Field[4] = Restrict; Field[4].InField = 3; Field[4].SurfacesList = {2}; Field[4].CurvesList = {11, 12, 13, 14, 15};
Field[4].PointsList = {11, 12, 13, 14, 15};
Field[5] = Min; Field[5].FieldsList = {2, 4};
Background Field = 5;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.Algorithm = 6;

Physical Surface("ball") = {1}; Physical Surface("block") = {2};
Physical Curve("contact of ball") = {1}; Physical Curve("arc") = {2}; Physical Curve("flat") = {3};
Physical Curve("contact of block") = {11}; Physical Curve("top") = {12}; Physical Curve("side") = {13};
Physical Curve("bottom") = {14};
