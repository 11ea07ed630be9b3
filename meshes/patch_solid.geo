// A block of tetrahedra above one of hexahedra whose mesh does not match, for the patch test in space [mm].
//   gmsh -3 -format msh22 patch_solid.geo -o patch_solid.msh
// Bodies: tetrahedra (4 x 3 x 4 above y = 0), hexahedra (below). Boundaries of each: top, bottom, left (x = 0), back (z = 0) behind "upper"
// or "lower".

DefineConstant[size = {1.1, Name "Mesh/Size of the tetrahedra [mm]"}, cells = {5, Name "Mesh/Hexahedra along an edge"}];
SetFactory("OpenCASCADE");
l = 4; h = 3;
Box(1) = {0, 0, 0, l, h, l}; // faces 1 to 6: x, y, z, each first the lower one
Box(2) = {0, -h, 0, l, h, l};
Physical Volume("tetrahedra") = {1}; Physical Volume("hexahedra") = {2};
Physical Surface("upper top") = {4}; Physical Surface("upper bottom") = {3};
Physical Surface("upper left") = {1}; Physical Surface("upper back") = {5};
Physical Surface("lower top") = {10}; Physical Surface("lower bottom") = {9};
Physical Surface("lower left") = {7}; Physical Surface("lower back") = {11};
Transfinite Curve {13:24} = cells + 1;
Transfinite Surface {7:12}; Recombine Surface {7:12}; Transfinite Volume {2};
Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;
