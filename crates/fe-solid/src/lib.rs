//! Element and body integrals of finite-strain solids: energy, force, tangent, mass, momenta, loads.
