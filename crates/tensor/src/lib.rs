//! Second- and fourth-order 3-D tensors, invariants, spectral forms and their derivatives.
