//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod example_of_the_thesis;
mod random_functions;
