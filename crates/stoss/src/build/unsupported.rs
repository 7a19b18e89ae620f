//! Tables of the scene format that scenes may have and the simulation cannot run.

use crate::scene::{Problem, Scene};

/// One problem that names the scene's tables that cannot be simulated, at the first of them; `None` if there are none.
pub(super) fn unsupported(scene: &Scene) -> Option<Problem> {
    let tables = [
        ("rigid[0]", "[[rigid]]", !cfg!(feature = "multibody") && !scene.rigids.is_empty()),
        ("beam[0]", "[[beam]]", !cfg!(feature = "multibody") && !scene.beams.is_empty()),
        ("string[0]", "[[string]]", !cfg!(feature = "multibody") && !scene.strings.is_empty()),
        ("mass[0]", "[[mass]]", !cfg!(feature = "multibody") && !scene.masses.is_empty()),
        ("joint[0]", "[[joint]]", !cfg!(feature = "multibody") && !scene.joints.is_empty()),
        ("spring[0]", "[[spring]]", !cfg!(feature = "multibody") && !scene.springs.is_empty()),
    ];
    let found: Vec<_> = tables.into_iter().filter(|&(_, _, there)| there).collect();
    let &(key, ..) = found.first()?;
    let names: Vec<&str> = found.iter().map(|&(_, name, _)| name).collect();
    let message = format!("this version of Stoss reads {} and cannot simulate them", names.join(", "));
    let remedy =
        "remove these tables; `body_force` of a [[load]] is weight, deformable bodies can be moved by [[prescribe]]";
    Some(Problem::at(scene, key, "", message, remedy))
}

#[cfg(test)]
mod tests {
    use super::unsupported;
    use crate::scene::parse;

    const BLOCK: &str = r#"
[scene]
title = "Block"
kind = "quasi-static"

[time]
end = 1.0
step = 0.1

[[body]]
name = "block"
mesh = { generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1e6, poisson = 0.3 }
density = 1.0
"#;

    #[test]
    fn tables_that_cannot_be_simulated_are_one_problem() {
        assert!(unsupported(&parse(BLOCK, "x.toml").unwrap()).is_none());
        let text = format!("{BLOCK}\n[gravity]\nacceleration = [0, 0, -1]\n\n[[rigid]]\nname = \"punch\"\nmass = 1\n");
        let scene = parse(&text, "x.toml").unwrap();
        let problem = unsupported(&scene).unwrap();
        assert!(problem.message.contains("[gravity], [[rigid]]"), "{problem}");
        assert_eq!(text.lines().nth(problem.line - 1), Some("[gravity]"));
        let errors = super::super::build(&scene, std::path::Path::new(".")).unwrap_err();
        assert_eq!(errors.problems(), [problem]);
    }
}
