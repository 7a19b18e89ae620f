//! Time and load stepping, active set, step control, energy ledger, checkpoints.
