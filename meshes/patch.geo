// Square of 20 x 20 mm cut by an oblique line: triangles below, quadrilaterals above, different cell sizes [mm].
//   gmsh -2 patch.geo -o patch.msh
// Bodies: lower, upper. Boundaries: left, right, bottom, top, interface (of both).

DefineConstant[
  size  = {20, Name "Edge of the square [mm]"},
  left  = {8, Name "Height of the cut on the left [mm]"},
  right = {13, Name "Height of the cut on the right [mm]"},
  lower = {2.2, Name "Mesh/Cell size below [mm]"},
  upper = {1.7, Name "Mesh/Cell size above [mm]"}
];

Point(1) = {0, 0, 0, lower}; Point(2) = {size, 0, 0, lower};
Point(3) = {size, right, 0, lower}; Point(4) = {0, left, 0, lower};
Point(5) = {0, left, 0, upper}; Point(6) = {size, right, 0, upper};
Point(7) = {size, size, 0, upper}; Point(8) = {0, size, 0, upper};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 5};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Curve Loop(2) = {5, 6, 7, 8}; Plane Surface(2) = {2};
Recombine Surface {2};

Physical Surface("lower") = {1};
Physical Surface("upper") = {2};
Physical Curve("left") = {4, 8};
Physical Curve("right") = {2, 6};
Physical Curve("bottom") = {1};
Physical Curve("top") = {7};
Physical Curve("interface") = {3, 5};

Mesh.Algorithm = 6;
Mesh.RecombinationAlgorithm = 2; // quadrilaterals only
Mesh.MshFileVersion = 4.1;
