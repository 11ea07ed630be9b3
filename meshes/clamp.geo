// Yielding clamp connection of steel arched mine supports, right half of a section that is symmetric about x = 0 [mm]:
// two nested V-shaped profiles (B in C) pulled together by an upper and a lower yoke (A, D).
//   gmsh -2 -bin clamp.geo -o clamp.msh
// Bodies: A, B, C, D. Boundaries: symmetry (of all four); A: under; B: top, flange, upper flank, lower flank;
// C: flange, flank (inside), back (outside), web; D: web, flank; rest.
// Points: upper bolt (A), lower bolt (D), hold (C).
// Contact zones are straight, so that uniform refinement of this mesh leaves the geometry as it is there.

SetFactory("Built-in");
DefineConstant[
  size   = {1, Name "Mesh/Factor on all cell sizes"},
  angle  = {25, Name "Profiles/Flank against the vertical [degrees]"},
  wall   = {12, Name "Profiles/Thickness of the flanks [mm]"},
  plate  = {14, Name "Profiles/Thickness of web and flange [mm]"},
  height = {90, Name "Profiles/Height of C [mm]"},
  width  = {90, Name "Profiles/Half width over the flanges [mm]"},
  foot   = {22, Name "Profiles/Half width of the inner foot of C [mm]"},
  lift   = {10, Name "Profiles/Clearance between the webs of B and C [mm]"},
  clearance = {0.05, Name "Profiles/Clearance between the flanges of B and C [mm]"},
  groove = {2, Name "Profiles/Depth of the groove that parts the flank of B [mm]"},
  yoke   = {32, Name "Yokes/Depth of the yokes [mm]"},
  bolt   = {105, Name "Yokes/Distance of the bolt from the symmetry plane [mm]"}
];

t = Tan(angle * Pi / 180);
o = wall / Cos(angle * Pi / 180); // flank thickness along x
// x of the inner flank of C, where B rests, and of its outer flank, at height y
flank0 = foot - plate * t;

// Outline xs, ys with rounded (rs > 0: radius) or chamfered (rs < 0: length) corners, counterclockwise, cell size h:
// edge[i] is the line from corner i to corner i + 1, arc[i] the curve at corner i (0: none), surface the surface.
Macro Outline
  n = #xs[];
  from[] = {}; to[] = {}; arc[] = {}; edge[] = {}; loop[] = {};
  For i In {0:n-1}
    a = (i + n - 1) % n; b = (i + 1) % n;
    ux = xs[a] - xs[i]; uy = ys[a] - ys[i]; ul = Sqrt(ux * ux + uy * uy); ux /= ul; uy /= ul;
    vx = xs[b] - xs[i]; vy = ys[b] - ys[i]; vl = Sqrt(vx * vx + vy * vy); vx /= vl; vy /= vl;
    half = Acos(ux * vx + uy * vy) / 2;
    If (rs[i] == 0)
      p = newp; Point(p) = {xs[i], ys[i], 0, h};
      from[] += p; to[] += p; arc[] += 0;
    Else
      l = -rs[i];
      If (rs[i] > 0)
        l = rs[i] / Tan(half);
      EndIf
      p = newp; Point(p) = {xs[i] + l * ux, ys[i] + l * uy, 0, h}; from[] += p;
      q = newp; Point(q) = {xs[i] + l * vx, ys[i] + l * vy, 0, h}; to[] += q;
      If (rs[i] > 0)
        wx = ux + vx; wy = uy + vy; wl = Sqrt(wx * wx + wy * wy); d = rs[i] / Sin(half);
        c = newp; Point(c) = {xs[i] + d * wx / wl, ys[i] + d * wy / wl, 0, h};
        k = newc; Circle(k) = {p, c, q};
      Else
        k = newc; Line(k) = {p, q};
      EndIf
      arc[] += k;
    EndIf
  EndFor
  For i In {0:n-1}
    k = newc; Line(k) = {to[i], from[(i + 1) % n]};
    edge[] += k; loop[] += k;
    If (arc[(i + 1) % n] != 0)
      loop[] += arc[(i + 1) % n];
    EndIf
  EndFor
  k = newll; Curve Loop(k) = loop[];
  surface = news; Plane Surface(surface) = {k};
  Recombine Surface {surface};
Return

symmetry[] = {}; rest[] = {};

// C: lower profile, outside first
h = 3 * size;
yf = height - plate;
xs[] = {0, flank0 + o, flank0 + o + yf * t, width, width, flank0 + height * t, foot, 0};
ys[] = {0, 0, yf, yf, height, height, plate, plate};
rs[] = {0, -7, 6, 4, 4, -6, 6, 0};
Call Outline;
Physical Surface("C") = surface;
web[] = edge[0]; back[] = edge[1]; flange[] = edge[4]; flank[] = edge[5];
symmetry[] += edge[7];
rest[] += {edge[2], edge[3], edge[6], arc[1], arc[2], arc[3], arc[4], arc[5], arc[6]};
Physical Point("hold") = from[7];

// B: upper profile, its flank parted by a groove
h = 2.4 * size;
yb = plate + lift; yf = height + clearance; top = height + plate; g1 = 50; g2 = 60;
nx = groove / Cos(angle * Pi / 180);
xs[] = {0, flank0 + yb * t, flank0 + g1 * t, flank0 + (g1 + 2) * t - nx, flank0 + (g2 - 2) * t - nx, flank0 + g2 * t,
        flank0 + yf * t, width, width, flank0 + top * t - o, flank0 + (yb + plate) * t - o, 0};
ys[] = {yb, yb, g1, g1 + 2, g2 - 2, g2, yf, yf, top, top, yb + plate, yb + plate};
rs[] = {0, 4, 0, 0, 0, 0, 3, 4, 4, 4, 6, 0};
Call Outline;
Physical Surface("B") = surface;
Physical Curve("lower flank") = edge[1];
Physical Curve("upper flank") = edge[5];
Physical Curve("top") = edge[8];
flange[] += edge[6];
symmetry[] += edge[11];
rest[] += {edge[0], edge[2], edge[3], edge[4], edge[7], edge[9], edge[10], arc[1],
           arc[6], arc[7], arc[8], arc[9], arc[10]};

// A: upper yoke across the profiles; the bolt presses on its top
h = 3.2 * size;
end = bolt + 13;
xs[] = {0, end, end, bolt, width - 5, width - 25, 0};
ys[] = {top, top, top + yoke - 6, top + yoke - 6, top + yoke - 6, top + yoke, top + yoke};
rs[] = {0, 6, 6, 0, 10, 10, 0};
Call Outline;
Physical Surface("A") = surface;
Physical Curve("under") = edge[0];
symmetry[] += edge[6];
rest[] += {edge[1], edge[2], edge[3], edge[4], edge[5], arc[1], arc[2], arc[4], arc[5]};
Physical Point("upper bolt") = from[3];

// D: lower yoke around C; the bolt presses from below on its ear
h = 3.4 * size;
ear = 60;
xs[] = {0, flank0 + o + 8, bolt - 33, bolt, end, end, flank0 + o + ear * t, flank0 + o, 0};
ys[] = {-yoke, -yoke, ear - 28, ear - 28, ear - 28, ear, ear, 0, 0};
rs[] = {0, 14, 10, 0, 6, 6, 4, 4, 0};
Call Outline;
Physical Surface("D") = surface;
flank[] += edge[6];
web[] += edge[7];
symmetry[] += edge[8];
rest[] += {edge[0], edge[1], edge[2], edge[3], edge[4], edge[5], arc[1], arc[2], arc[4], arc[5], arc[6], arc[7]};
Physical Point("lower bolt") = from[3];

// one name for several bodies: BODY/NAME tells them apart
Physical Curve("web") = web[];       // C and D
Physical Curve("back") = back[];     // C, outside of the flank
Physical Curve("flank") = flank[];   // C inside, and D
Physical Curve("flange") = flange[]; // B and C
Physical Curve("symmetry") = symmetry[];
Physical Curve("rest") = rest[];

Mesh.Algorithm = 6;
Mesh.RecombinationAlgorithm = 3; // quadrilaterals only
Mesh.MshFileVersion = 4.1;
