//! Gmsh and Abaqus readers, VTU and PVD writers.
