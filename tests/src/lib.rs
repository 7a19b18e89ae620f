//! Facade-level conservation and literature tests live in `tests/`.

// For their features alone: see Cargo.toml.
use either as _;
use matrixmultiply as _;
use num_complex as _;
