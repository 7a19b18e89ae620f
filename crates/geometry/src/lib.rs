//! Bounding-volume tree with refit, bilinear patches, closest-point projection, predicates.
