// A block on a slab: two volumes in one file, which do not share nodes.
//
//     gmsh -3 -order 2 ironing.geo -o ironing.msh
//
// ironing.msh was written by Gmsh 4.8.4.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 9, 4, 3};
Box(2) = {1, 1.5, 3, 1, 1, 1};
Physical Volume("slab") = {1};
Physical Volume("indenter") = {2};
// Faces of a box: x low, x high, y low, y high, z low, z high.
Physical Surface("slab-top") = {6};
Physical Surface("slab-bottom") = {5};
Physical Surface("indenter-bottom") = {11};
Physical Surface("indenter-top") = {12};
// Fine along the path of the block, coarse far from it.
Field[1] = Box;
Field[1].VIn = 0.5; Field[1].VOut = 1.3; Field[1].Thickness = 2;
Field[1].XMin = 0.6; Field[1].XMax = 5.3; Field[1].YMin = 1.1; Field[1].YMax = 2.9; Field[1].ZMin = 2.6; Field[1].ZMax = 4;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 1;
