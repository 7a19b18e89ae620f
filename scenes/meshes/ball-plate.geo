// A hollow ball above a plate: two volumes in one file, which do not share nodes.
//
//     gmsh -3 -order 2 ball-plate.geo -o ball-plate.msh
//
// ball-plate.msh was written by Gmsh 4.8.4.
SetFactory("OpenCASCADE");
Sphere(1) = {0, -0.6, 0.8, 0.5};
Sphere(2) = {0, -0.6, 0.8, 0.4};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Box(4) = {-1.25, -1.25, 0, 2.5, 2.5, 0.25};

Physical Volume("ball") = {3};
Physical Volume("plate") = {4};
e = 0.01;
inner() = Surface In BoundingBox {-0.4-e, -1-e, 0.4-e, 0.4+e, -0.2+e, 1.2+e};
outer() = Surface In BoundingBox {-0.5-e, -1.1-e, 0.3-e, 0.5+e, -0.1+e, 1.3+e};
outer() -= inner();
Physical Surface("outer") = outer();
Physical Surface("top") = Surface In BoundingBox {-1.25-e, -1.25-e, 0.25-e, 1.25+e, 1.25+e, 0.25+e};

MeshSize { PointsOf{ Volume{3}; } } = 0.18;
MeshSize { PointsOf{ Volume{4}; } } = 0.3;
Mesh.Algorithm = 1;
