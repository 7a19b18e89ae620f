//! The problems of the campaign, a file each.

mod bar_impact;
mod beam;
mod belt;
mod block_impact;
mod bouncing;
mod bowl;
mod cantilever_stop;
mod cattaneo_mindlin;
mod cook;
mod corner_impact;
mod creep;
mod cube_general;
mod free_top;
mod hertz_ball;
mod hertz_cylinder;
mod history;
mod inflated_sphere;
mod ironing;
mod parts;
mod patch;
mod plane;
mod press_fit;
mod rolling;
mod sliding_block;
mod spinning_bar;
mod tied_bars;
mod trebuchet;
mod yielding_tube;

use super::campaign::Problem;

/// All problems, in the order of the page.
pub const PROBLEMS: &[&Problem] = &[
    &patch::PROBLEM,
    &press_fit::PROBLEM,
    &hertz_cylinder::PROBLEM,
    &hertz_ball::PROBLEM,
    &cattaneo_mindlin::PROBLEM,
    &ironing::PROBLEM,
    &bowl::PROBLEM,
    &cube_general::PROBLEM,
    &tied_bars::PROBLEM,
    &cook::PROBLEM,
    &inflated_sphere::PROBLEM,
    &yielding_tube::PROBLEM,
    &creep::PROBLEM,
    &beam::PROBLEM,
    &belt::PROBLEM,
    &bar_impact::PROBLEM,
    &block_impact::PROBLEM,
    &cantilever_stop::PROBLEM,
    &bouncing::PROBLEM,
    &corner_impact::PROBLEM,
    &rolling::PROBLEM,
    &sliding_block::PROBLEM,
    &spinning_bar::PROBLEM,
    &free_top::PROBLEM,
    &trebuchet::PROBLEM,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::work_precision::campaign::lines;

    #[test]
    fn problems_are_told_apart_and_have_what_they_name() {
        for (k, problem) in PROBLEMS.iter().enumerate() {
            let Problem { name, .. } = problem;
            assert!(PROBLEMS[..k].iter().all(|other| other.name != *name), "{name} twice");
            let lines = lines(problem);
            for claim in problem.claims {
                assert!(lines.iter().any(|line| line.name == claim.line), "{name}: no line {:?}", claim.line);
                assert!(problem.quantities.contains(&claim.quantity), "{name}: no quantity {:?}", claim.quantity);
            }
            assert!(
                problem.meshes.contains(&problem.best.mesh) && problem.steps.contains(&problem.best.steps),
                "{name}: the best is in no line"
            );
            assert!(
                (problem.scene)(&problem.best).is_ok_and(|text| stoss_scene::parse(&text, name).is_ok()),
                "{name}: the best is no scene"
            );
        }
    }
}
