//! The problems of the campaign, a file each.

mod plastic_tube;
mod relaxation;
mod spinning_bar;

use super::campaign::Problem;

/// All problems, in the order of the page.
pub const PROBLEMS: &[&Problem] = &[&spinning_bar::PROBLEM, &plastic_tube::PROBLEM, &relaxation::PROBLEM];
