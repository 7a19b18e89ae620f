//! Any number of threads gives the same bits.
use crate::common::*;
use stoss_fe_solid::{ForceRule, SolidStep, TangentTarget, Workspace};

#[test]
fn serial_and_parallel_assembly_give_the_same_bits() {
    // More than one run of elements for every pool, and a last run that is not full.
    let mesh = distorted_block([7, 5, 5], 0.15, 1);
    let mut random = Random(2);
    let q_n = random.perturbed(&positions(&mesh), 0.1);
    let q_np1 = random.perturbed(&q_n, 0.1);
    let n = q_n.len();
    let mut body = body(&mesh, &laws()[0]);
    let (pattern, map) = pattern(&body, n);
    for rule in [
        ForceRule::Configuration { theta: 0.0 },
        ForceRule::END_POINT,
        ForceRule::MIDPOINT,
        ForceRule::DiscreteGradient,
    ] {
        let mut results = Vec::new();
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut workspace = Workspace::default();
            pool.install(|| {
                body.begin_step(&q_n, rule, 1.0).unwrap();
                // Twice with one workspace: nothing of the first call may be left in it.
                for _ in 0..2 {
                    let (mut force, mut values) = (vec![0.0; n], vec![0.0; pattern.nnz()]);
                    let target = TangentTarget { map: &map, first_stencil: 0, factor: 0.7, values: &mut values };
                    let step = SolidStep { q_n: &q_n, q_np1: &q_np1, rule };
                    body.assemble(step, 1.3, &mut force, Some(target), &mut workspace).unwrap();
                    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
                    results.push((bits(&force), bits(&values)));
                }
            });
        }
        assert!(results.windows(2).all(|pair| pair[0] == pair[1]), "{rule:?}");
    }
}
