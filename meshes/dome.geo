// A quarter of a spherical cap: 40 mm across, 8 mm high. In mm.
//   gmsh dome.geo -2 -order 2 -format msh41 -o dome.msh
SetFactory("OpenCASCADE");
radius = 20; height = 8; size = 2;
sphere = (radius^2 + height^2)/(2*height);

Point(1) = {0, 0, height - sphere};
Point(2) = {0, 0, height};
Point(3) = {radius, 0, 0};
Circle(1) = {2, 1, 3};
cap[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi/2} { Curve{1}; };

// The rim ends at the two meridians, in the planes y = 0 and x = 0.
Physical Surface("dome") = {cap[1]};
Physical Curve("left") = {1};
Physical Curve("right") = {cap[0]};
Physical Curve("rim") = {3};
MeshSize {:} = size;
Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;
