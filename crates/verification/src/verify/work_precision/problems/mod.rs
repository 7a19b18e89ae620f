//! The problems of the campaign, a file each.

mod spinning_bar;

use super::campaign::Problem;

/// All problems, in the order of the page.
pub const PROBLEMS: &[&Problem] = &[&spinning_bar::PROBLEM];
