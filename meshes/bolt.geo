// Section of a bolt with head and nut through its axis, triangles [mm].
//   gmsh -2 -bin bolt.geo -o bolt.msh
// Body: bolt. Boundaries: head left, head right, nut left, nut right (the sides that clamp), shank left, shank right,
// rest.

DefineConstant[
  size  = {1.6, Name "Mesh/Cell size [mm]"},
  shank = {8, Name "Radius of the shank [mm]"},
  head  = {15, Name "Half width of head and nut [mm]"},
  grip  = {10, Name "Half length between head and nut [mm]"},
  tall  = {11, Name "Height of head and nut [mm]"}
];

Point(1) = {-head, -grip - tall, 0, size}; Point(2) = {head, -grip - tall, 0, size};
Point(3) = {head, -grip, 0, size}; Point(4) = {shank, -grip, 0, size};
Point(5) = {shank, grip, 0, size}; Point(6) = {head, grip, 0, size};
Point(7) = {head, grip + tall, 0, size}; Point(8) = {-head, grip + tall, 0, size};
Point(9) = {-head, grip, 0, size}; Point(10) = {-shank, grip, 0, size};
Point(11) = {-shank, -grip, 0, size}; Point(12) = {-head, -grip, 0, size};
For i In {1:12}
  Line(i) = {i, i % 12 + 1};
EndFor
Curve Loop(1) = {1:12};
Plane Surface(1) = {1};

Physical Surface("bolt") = {1};
Physical Curve("nut right") = {3};
Physical Curve("shank right") = {4};
Physical Curve("head right") = {5};
Physical Curve("head left") = {9};
Physical Curve("shank left") = {10};
Physical Curve("nut left") = {11};
Physical Curve("rest") = {1, 2, 6, 7, 8, 12};

Mesh.Algorithm = 6;
Mesh.MshFileVersion = 2.2;
