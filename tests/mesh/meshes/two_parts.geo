// Two bodies that share the nodes of their common line: quadrilaterals below, triangles above.
// for f in msh22 msh41; do gmsh -2 two_parts.geo -format $f -o two_parts_$f.msh
//   gmsh -2 two_parts.geo -format $f -bin -o two_parts_$f.bin.msh; done
// gmsh -2 two_parts.geo -order 2 -format msh41 -o two_parts_curved.msh
Mesh.RandomSeed = 1;
Point(1) = {0, 0, 0}; Point(2) = {2, 0, 0}; Point(3) = {2, 1, 0}; Point(4) = {0, 1, 0}; Point(5) = {1, 3, 0};
Point(6) = {7, 7, 0}; // unused
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Line(5) = {3, 5}; Line(6) = {5, 4};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6}; Plane Surface(2) = {2};
Transfinite Curve {1, 3} = 5; Transfinite Curve {2, 4} = 3; Transfinite Curve {5, 6} = 4;
Transfinite Surface {1}; Recombine Surface {1};
Physical Surface("block") = {1}; Physical Surface("roof") = {2};
Physical Curve("foot") = {1}; Physical Curve("interface") = {3}; Physical Curve("right side") = {2, 5};
Physical Curve("outline") = {1, 2, 4}; // overlaps with foot and right side
Physical Point("corner") = {1}; Physical Point("top") = {5}; Physical Point("shoulder") = {3};
