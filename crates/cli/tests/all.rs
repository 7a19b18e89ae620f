//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod diagnose;
mod folder;
mod import;
mod jobs;
mod loads;
mod mesh;
mod report;
mod results;
mod robustness;
mod table;
mod tutorials;
mod watch;
