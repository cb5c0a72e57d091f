// One of the twelve sectors of a pleated muscle whose fibres turn by 60 degrees about its axis from fitting to fitting. In mm.
//   gmsh askew.geo -2 -format msh41 -o askew.msh
radius = 16; length = 110; fibres = 12; turn = Pi/3; cables = 80;

Point(1) = {radius, 0, 0};
Point(2) = {radius*Cos(2*Pi/fibres), radius*Sin(2*Pi/fibres), 0};
Line(1) = {1, 2};
Transfinite Curve {1} = 2;
strip[] = Extrude {{0, 0, length}, {0, 0, 1}, {0, 0, 0}, turn} { Curve{1}; Layers{cables}; };

// strip[0]: the line's copy at the top; strip[1]: the surface; then its sides.
Physical Surface("facets") = {strip[1]};
Physical Curve("bottom") = {1};
Physical Curve("top") = {strip[0]};
Physical Curve("fibre") = {Abs(strip[3])};
Physical Curve("next") = {Abs(strip[2])};
