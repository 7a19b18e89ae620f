//! Batteries, derivative oracles and strategies for tests; never a normal dependency.
