//! A bar of rubber in tension: assembly, Newton's method and a linear solver around one body, without the rest of Stoss.
//!
//! Checked: the stretches against the closed form of the neo-Hookean law.
//!
//! `cargo run --example bar -p stoss-fe-solid`

use std::error::Error;
use std::sync::Arc;
use stoss_fe_solid::{ForceRule, SolidBody, SolidStep, TangentTarget, Workspace, dead_traction};
use stoss_linalg::{AutoSolver, LinearSolver, MatrixKind, NONE, ScatterMap, SparsityPattern};
use stoss_materials::NeoHooke;
use stoss_mesh::generate::Block;

fn main() -> Result<(), Box<dyn Error>> {
    let (lambda, mu) = (100.0, 40.0);
    // Sides are free of stress if mu (c^2 - 1) + lambda ln J = 0 with their stretch c: so c gives J, the stretch and the nominal stress.
    let across = 0.9_f64;
    let log_j = mu * (1.0 - across * across) / lambda;
    let along = log_j.exp() / (across * across);
    let stress = mu * (along - 1.0 / along) + lambda * log_j / along;

    let mesh = Block::new([0.0; 3], [4.0, 1.0, 1.0], [8, 2, 2]).generate()?;
    let mut body = SolidBody::new("bar", &mesh, 0, Arc::new(NeoHooke::new(lambda, mu)?))?;
    let reference: Vec<f64> = mesh.nodes.iter().flatten().copied().collect();
    let mut load = vec![0.0; reference.len()];
    let end: Vec<_> = mesh.facets_of("right")?.iter().map(|facet| facet.nodes).collect();
    dead_traction(&end, &reference, [stress, 0.0, 0.0], &mut load)?;
    // Planes of symmetry: a component that is zero at the start stays so and has no equation.
    let free: Vec<usize> = (0..reference.len()).filter(|&k| reference[k] != 0.0).collect();
    let mut equations = vec![NONE; reference.len()];
    free.iter().enumerate().for_each(|(equation, &k)| equations[k] = equation as u32);
    let of_node = |node: &u32| (0..3).map(|i| equations[3 * *node as usize + i]).collect::<Vec<_>>();
    let stencils: Vec<Vec<u32>> = body.stencils().map(|nodes| nodes.iter().flat_map(of_node).collect()).collect();
    let pattern = Arc::new(SparsityPattern::from_stencils(free.len(), stencils.iter().map(Vec::as_slice))?);
    let map = ScatterMap::new(&pattern, stencils.iter().map(Vec::as_slice))?;
    let mut solver = AutoSolver::new();
    solver.analyse(&pattern, MatrixKind::Symmetric)?;

    let rule = ForceRule::END_POINT;
    body.begin_step(&reference, rule, 1.0)?;
    let (mut q, mut workspace) = (reference.clone(), Workspace::default());
    println!("iteration  residual");
    for iteration in 0..20 {
        let (mut force, mut values) = (vec![0.0; q.len()], vec![0.0; pattern.nnz()]);
        let target = TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values: &mut values };
        body.assemble(SolidStep { q_n: &reference, q_np1: &q, rule }, 1.0, &mut force, Some(target), &mut workspace)?;
        let residual: Vec<f64> = free.iter().map(|&k| load[k] - force[k]).collect();
        let norm = residual.iter().map(|r| r * r).sum::<f64>().sqrt();
        println!("{iteration:9} {norm:9.2e}");
        if norm < 1e-12 * stress {
            break;
        }
        solver.factorise(&values)?;
        let mut increment = vec![0.0; free.len()];
        solver.solve(&residual, &mut increment)?;
        free.iter().zip(&increment).for_each(|(&k, u)| q[k] += u);
    }
    let error = |k: usize| q[k] - reference[k] * if k.is_multiple_of(3) { along } else { across };
    let worst = (0..q.len()).map(|k| error(k).abs()).fold(0.0, f64::max);
    println!("nominal stress {stress:.4}, stretch {along:.4}, across {across:.4}; error of positions {worst:.1e}");
    assert!(worst < 1e-12, "{worst:e}");
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
