// One body of triangles and quadrilaterals, scattered.
// gmsh -2 mixed.geo -format msh41 -o mixed.msh
Mesh.RandomSeed = 1; Mesh.Algorithm = 6; Mesh.RecombinationAlgorithm = 0; 
Point(1) = {0, 0, 0, .4}; Point(2) = {3, 0, 0, .7}; Point(3) = {3, 2, 0, .4}; Point(4) = {0, 2, 0, .4};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1}; Recombine Surface {1} = 20;
Physical Surface("plate") = {1}; Physical Curve("left") = {4};
