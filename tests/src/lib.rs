//! Facade-level conservation and literature tests live in `tests/`.
