// Quarter of a ring of radii 1 and 2, and of height 1, of second order, in the formats that have no names or write nodes in
// another order than .msh:
// for f in vtk unv; do gmsh -2 gmsh_sector.geo -order 2 -format $f -o gmsh_sector.$f
//   gmsh -3 gmsh_sector.geo -order 2 -setnumber height 1 -format $f -o gmsh_sector_27.$f
//   gmsh -3 gmsh_sector.geo -order 2 -setnumber height 1 -setnumber recombine 0 -format $f -o gmsh_sector_10.$f; done
DefineConstant[ height = 0, recombine = 1 ];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {2, 0, 0}; Point(4) = {0, 2, 0}; Point(5) = {0, 1, 0};
Line(1) = {2, 3}; Circle(2) = {3, 1, 4}; Line(3) = {4, 5}; Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 2; Transfinite Curve{2, 4} = 3; Transfinite Surface{1};
If (recombine)
  Recombine Surface{1};
EndIf
If (height > 0)
  If (recombine)
    solid[] = Extrude {0, 0, height} { Surface{1}; Layers{1}; Recombine; };
  Else
    solid[] = Extrude {0, 0, height} { Surface{1}; Layers{1}; };
  EndIf
  Physical Volume("part") = {solid[1]};
  Physical Surface("outer rim") = {solid[3]};
Else
  Physical Surface("part") = {1};
  Physical Curve("outer rim") = {2};
EndIf
