//! Time-stepping schemes for constrained second-order systems.
