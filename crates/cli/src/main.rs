//! The program `stoss`.
fn main() {}
