// A punch with rounded corners above a block: two bodies for doc/tutorial.md. Lengths in mm.
SetFactory("OpenCASCADE");

w = 10;  // half width of the punch
h = 15;  // its height
r = 4;   // radius of its corners

// The punch stands on y = 0, and so does the block below it: they touch along the flat part.
Point(1) = {-w, h, 0};
Point(2) = {-w, r, 0};
Point(3) = {-w + r, r, 0};
Point(4) = {-w + r, 0, 0};
Point(5) = { w - r, 0, 0};
Point(6) = { w - r, r, 0};
Point(7) = { w, r, 0};
Point(8) = { w, h, 0};
Line(1) = {1, 2};
Circle(2) = {2, 3, 4};
Line(3) = {4, 5};
Circle(4) = {5, 6, 7};
Line(5) = {7, 8};
Line(6) = {8, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};

Point(11) = {-40, -30, 0};
Point(12) = { 40, -30, 0};
Point(13) = { 40, 0, 0};
Point(14) = {-40, 0, 0};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 11};
Curve Loop(2) = {11, 12, 13, 14};
Plane Surface(2) = {2};

// Names that the scene uses. Every surface that is a part needs one, and every line that is loaded, held or in contact.
Physical Surface("punch") = {1};
Physical Surface("block") = {2};
Physical Curve("head") = {6};
Physical Curve("face") = {2, 3, 4};
Physical Curve("top") = {13};
Physical Curve("bottom") = {11};

// Fine where they touch, coarse elsewhere.
Field[1] = Distance;
Field[1].CurvesList = {2, 3, 4};
Field[1].NumPointsPerCurve = 40;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = 0.4;
Field[2].SizeMax = 4;
Field[2].DistMin = 1;
Field[2].DistMax = 25;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.RecombineAll = 1;
