//! Hexahedral meshes: connectivity, named sets, boundary facets, generators, quality.
