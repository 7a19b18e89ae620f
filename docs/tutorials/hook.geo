// A snap hook: a flexible arm with a nose; one half of it, y = 0 is the plane of symmetry. Millimetres.
length = 20;  // of the arm, from the wall to the nose
thick = 2;    // of the arm
half = 2;     // half the width
height = 1.5; // of the nose above the arm
coarse = 2.0; // size of the elements at the wall
fine = 0.9;   // and at the nose

Point(1) = {0, 0, 0, coarse};
Point(2) = {length + 6, 0, 0, fine};
Point(3) = {length + 6, 0, thick, fine};
Point(4) = {length + 1.5, 0, thick + height, fine};
Point(5) = {length, 0, thick + height, fine};
Point(6) = {length, 0, thick, fine};
Point(7) = {0, 0, thick, coarse};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4}; // the ramp
Line(4) = {4, 5}; // the top of the nose
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 1}; // at the wall
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};
Plane Surface(1) = {1};
// The side faces follow in the order of the lines.
side[] = Extrude {0, half, 0} { Surface{1}; };

Physical Volume("hook") = {side[1]};
Physical Surface("wall") = {side[8]};
Physical Surface("nose") = {side[4], side[5]};
Physical Surface("symmetry") = {1};
