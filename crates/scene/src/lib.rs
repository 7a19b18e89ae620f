//! The scene format: schema and validation, data only.
