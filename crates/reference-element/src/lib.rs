//! Cells, shape functions, quadrature.
