// Section of a bolt with head and nut through its axis, triangles [mm].
//   gmsh -2 -bin bolt.geo -o bolt.msh
// Body: bolt. Boundaries: head left, head right, nut left, nut right (what clamps, from the edge of the hole outwards),
// shank left, shank right, rest.

DefineConstant[
  size  = {1.6, Name "Mesh/Cell size [mm]"},
  shank = {8, Name "Radius of the shank [mm]"},
  hole  = {9, Name "Radius of the holes [mm]"},
  head  = {15, Name "Half width of head and nut [mm]"},
  grip  = {10, Name "Half length between head and nut [mm]"},
  tall  = {11, Name "Height of head and nut [mm]"}
];

Point(1) = {-head, -grip - tall, 0, size}; Point(2) = {head, -grip - tall, 0, size};
Point(3) = {head, -grip, 0, size}; Point(4) = {hole, -grip, 0, size}; Point(5) = {shank, -grip, 0, size};
Point(6) = {shank, grip, 0, size}; Point(7) = {hole, grip, 0, size}; Point(8) = {head, grip, 0, size};
Point(9) = {head, grip + tall, 0, size}; Point(10) = {-head, grip + tall, 0, size};
Point(11) = {-head, grip, 0, size}; Point(12) = {-hole, grip, 0, size}; Point(13) = {-shank, grip, 0, size};
Point(14) = {-shank, -grip, 0, size}; Point(15) = {-hole, -grip, 0, size}; Point(16) = {-head, -grip, 0, size};
For i In {1:16}
  Line(i) = {i, i % 16 + 1};
EndFor
Curve Loop(1) = {1:16};
Plane Surface(1) = {1};

Physical Surface("bolt") = {1};
Physical Curve("nut right") = {3};
Physical Curve("shank right") = {5};
Physical Curve("head right") = {7};
Physical Curve("head left") = {11};
Physical Curve("shank left") = {13};
Physical Curve("nut left") = {15};
Physical Curve("rest") = {1, 2, 4, 6, 8, 9, 10, 12, 14, 16};

Mesh.Algorithm = 6;
Mesh.MshFileVersion = 2.2;
