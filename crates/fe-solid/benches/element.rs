//! Cost of an element: force and tangent by rule and law, the parts of the kernel, and a body with scatter.
//!
//! `cargo bench -p stoss-fe-solid`; every figure of a `body` group is for all its elements (divide by the number in the
//! name), on one thread. Times are CPU times of the thread, because a busy machine lets others run in between.

use cpu_time::ThreadTime;
use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;
use std::{hint::black_box, sync::Arc};
use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{
    ForceRule, MassKind, SolidBody, SolidOptions, SolidStep, TangentTarget, Volumetric, Workspace,
    kernel::{self, LocalTangent, TangentFactors, TangentPoint},
};
use stoss_linalg::{ScatterMap, SparsityPattern};
use stoss_materials::{
    Fibres, Hardening, Hencky, Inelastic, Moduli, MooneyRivlin, Mullins, NeoHooke, Ogden, Plasticity,
    SaintVenantKirchhoff,
};
use stoss_mesh::{Mesh, generate::Block};
use stoss_reference_element::{CellKind, hex8, quadrature::GAUSS_HEX_2};

const NODES: usize = 8;
const GAUSS_POINTS: usize = 8;
const UNKNOWNS: usize = 24;

#[path = "../tests/common/mod.rs"]
mod common;

/// CPU time of the thread.
struct CpuTime;

impl Measurement for CpuTime {
    type Intermediate = ThreadTime;
    type Value = Duration;

    fn start(&self) -> ThreadTime {
        ThreadTime::now()
    }
    fn end(&self, start: ThreadTime) -> Duration {
        start.elapsed()
    }
    fn add(&self, a: &Duration, b: &Duration) -> Duration {
        *a + *b
    }
    fn zero(&self) -> Duration {
        Duration::ZERO
    }
    fn to_f64(&self, value: &Duration) -> f64 {
        value.as_nanos() as f64
    }
    fn formatter(&self) -> &dyn ValueFormatter {
        WallTime.formatter()
    }
}

/// Elements that are sheared and waved, everything assembled.
struct Problem {
    body: SolidBody,
    q_n: Vec<f64>,
    q_np1: Vec<f64>,
    map: ScatterMap,
    values: Vec<f64>,
    force: Vec<f64>,
    workspace: Workspace,
}

impl Problem {
    fn new(n: usize, law: Arc<dyn HyperelasticLaw>) -> Self {
        let mesh = Block::new([0.0; 3], [n as f64; 3], [n; 3]).generate().expect("a block");
        Self::of(&mesh, law, SolidOptions::default())
    }

    fn of(mesh: &Mesh, law: Arc<dyn HyperelasticLaw>, options: SolidOptions) -> Self {
        let waved = |amplitude: f64| -> Vec<f64> {
            let wave = |x: &[f64; 3]| {
                [
                    x[0] + amplitude * (1.3 * x[1] + x[2]).sin(),
                    x[1] * (1.0 + 0.5 * amplitude),
                    x[2] + amplitude * x[0].cos(),
                ]
            };
            mesh.nodes.iter().flat_map(wave).collect()
        };
        let (q_n, q_np1) = (waved(0.08), waved(0.1));
        let body = SolidBody::with_options("block", mesh, 0, law, options).expect("a good mesh");
        // Averages at nodes have stencils beside those of the elements.
        let stencils: Vec<Vec<u32>> =
            body.stencils().map(|nodes| nodes.iter().flat_map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect()).collect();
        let stencils = || stencils.iter().map(Vec::as_slice);
        let pattern = SparsityPattern::from_stencils(q_n.len(), stencils()).expect("a small pattern");
        let map = ScatterMap::new(&pattern, stencils()).expect("the same stencils");
        let (values, force) = (vec![0.0; pattern.nnz()], vec![0.0; q_n.len()]);
        Self { body, q_n, q_np1, map, values, force, workspace: Workspace::default() }
    }

    fn assemble(&mut self, rule: ForceRule, with_tangent: bool) {
        let step = SolidStep { q_n: &self.q_n, q_np1: &self.q_np1, rule };
        let target = with_tangent.then_some(TangentTarget {
            map: &self.map,
            first_stencil: 0,
            factor: 1.0,
            values: &mut self.values,
        });
        self.body.assemble(step, 1.0, &mut self.force, target, &mut self.workspace).expect("no element is inverted");
    }
}

fn laws() -> Vec<Arc<dyn HyperelasticLaw>> {
    const GOOD: &str = "good parameters";
    vec![
        Arc::new(NeoHooke::new(1298.0769, 865.3846).expect(GOOD)),
        Arc::new(SaintVenantKirchhoff::new(1298.0769, 865.3846).expect(GOOD)),
        Arc::new(MooneyRivlin::new(176051.0, 4332.63, 2.0e6).expect(GOOD)),
        Arc::new(Ogden::new(&[6300.0, 12.0, -100.0], &[1.3, 5.0, -2.0], 2000.0, 9.0).expect(GOOD)),
    ]
}

fn on_one_thread(criterion: &mut Criterion<CpuTime>) {
    // While it exists this thread is the one worker of the current pool: the serial path.
    let _pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().expect("a pool");
    assert_eq!(rayon::current_num_threads(), 1);
    bodies(criterion);
    cells(criterion);
    states(criterion);
}

/// A mixed hex8 for each material with a state in the middle of its flow, beside neo-Hooke's law: force and tangent, force, and the end of the step (what it lost, and its states).
fn states(criterion: &mut Criterion<CpuTime>) {
    const GOOD: &str = "good parameters";
    let neo_hooke: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(1298.0769, 865.3846).expect(GOOD));
    let metal = |kinematic| {
        let law = Hencky::new(1298.0769, 865.3846).expect(GOOD);
        let plasticity = Plasticity { hardening: Hardening::linear(5.0, 100.0), kinematic, overstress: None };
        Inelastic::plastic(law, plasticity).expect(GOOD)
    };
    let viscous = |shares: &[(f64, f64)]| Inelastic::viscous(&neo_hooke, shares, Moduli::Instantaneous).expect(GOOD);
    let fibres = Fibres { stiffness: 100.0, exponent: 2.0, dispersion: 0.1 };
    let materials: [(&str, Arc<dyn HyperelasticLaw>); 7] = [
        ("neo-hooke", neo_hooke.clone()),
        ("plastic", Arc::new(metal(0.0))),
        ("plastic, kinematic", Arc::new(metal(100.0))),
        ("one branch", Arc::new(viscous(&[(0.3, 1.0)]))),
        ("three branches", Arc::new(viscous(&[(0.3, 1.0), (0.2, 0.1), (0.1, 10.0)]))),
        ("softening", Arc::new(Inelastic::softening(&neo_hooke, Mullins { r: 1.5, m: 1.0, beta: 0.0 }).expect(GOOD))),
        (
            "two families of fibres",
            Arc::new(Inelastic::fibrous(&neo_hooke, fibres, &[[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]]).expect(GOOD)),
        ),
    ];
    let mesh = Block::new([0.0; 3], [1.0; 3], [1; 3]).generate().expect("a block");
    let reference: Vec<f64> = mesh.nodes.iter().flatten().copied().collect();
    let mut group = criterion.benchmark_group("mixed hex8 with a state");
    for (name, law) in materials {
        let options = SolidOptions { volumetric: Volumetric::Mixed, ..SolidOptions::default() };
        let mut problem = Problem::of(&mesh, law, options);
        problem.body.begin_step(&reference, ForceRule::END_POINT, 1.0).expect("no element is inverted");
        problem.body.end_step(&problem.q_n).expect("no element is inverted");
        for rule in [ForceRule::END_POINT, ForceRule::DiscreteGradient] {
            problem.body.begin_step(&problem.q_n, rule, 1.0).expect("no element is inverted");
            for (what, with_tangent) in [("force and tangent", true), ("force", false)] {
                group.bench_function(format!("{name}, {rule:?} {what}"), |bencher| {
                    bencher.iter(|| problem.assemble(black_box(rule), with_tangent));
                });
            }
        }
        group.bench_function(format!("{name}, end of a step"), |bencher| {
            bencher.iter(|| problem.body.step_end(black_box(&problem.q_np1)).expect("no element is inverted"));
        });
    }
}

fn bodies(criterion: &mut Criterion<CpuTime>) {
    for (name, n) in [("element", 1), ("body of 512 elements", 8)] {
        let mut group = criterion.benchmark_group(name);
        for law in laws() {
            let mut problem = Problem::new(n, law.clone());
            for rule in [ForceRule::END_POINT, ForceRule::MIDPOINT, ForceRule::DiscreteGradient] {
                problem.body.begin_step(&problem.q_n, rule, 1.0).expect("no element is inverted");
                group.bench_function(format!("{} {rule:?} force and tangent", law.name()), |bencher| {
                    bencher.iter(|| problem.assemble(black_box(rule), true));
                });
                group.bench_function(format!("{} {rule:?} force", law.name()), |bencher| {
                    bencher.iter(|| problem.assemble(black_box(rule), false));
                });
            }
        }
    }
    let mut problem = Problem::new(8, laws().swap_remove(0));
    let mass = problem.body.mass(1.0, MassKind::Consistent);
    criterion.bench_function("body of 512 elements, mass times vector", |bencher| {
        bencher.iter(|| mass.multiply_add(1.0, black_box(&problem.q_n), &mut problem.force));
    });
    let local = [1.0; UNKNOWNS * UNKNOWNS];
    criterion.bench_function("body of 512 elements, scatter alone", |bencher| {
        bencher.iter(|| {
            for element in 0..512 {
                problem.map.add(element, black_box(&local), &mut problem.values);
            }
        });
    });
}

/// Every cell with each of its rules, without and with averages: two cubes a direction, filled with cells. The number of Gauss points is in the name.
fn cells(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("cells");
    for (kind, integration) in CellKind::with_rules() {
        let mesh = common::cells(&[kind], [2; 3], 0.0, 0.0, 0);
        let points = mesh.elements.len() * kind.rule(integration).map_or(0, <[_]>::len);
        for volumetric in [Volumetric::Displacement, Volumetric::Mixed] {
            let mut problem = Problem::of(&mesh, laws().swap_remove(0), SolidOptions { integration, volumetric });
            for rule in [ForceRule::END_POINT, ForceRule::DiscreteGradient] {
                problem.body.begin_step(&problem.q_n, rule, 1.0).expect("no element is inverted");
                group.bench_function(
                    format!("{kind} {integration:?} {volumetric:?} {rule:?}, {points} points"),
                    |bencher| {
                        bencher.iter(|| problem.assemble(black_box(rule), true));
                    },
                );
            }
        }
    }
}

fn kernels(criterion: &mut Criterion<CpuTime>) {
    let natural = std::array::from_fn(|g| {
        let gradient = hex8::shape_gradient(GAUSS_HEX_2[g].0);
        std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
    });
    let x = std::array::from_fn(|i| std::array::from_fn(|node| hex8::VERTICES[node][i]));
    let Ok(integration) = kernel::integration(&x, &natural, &[1.0; GAUSS_POINTS]) else {
        unreachable!("the cube is not inverted");
    };
    let f = [[1.1, 0.1, 0.0], [0.2, 0.9, 0.1], [0.0, 0.1, 1.0]];
    let (moduli, stress) = ([[1.0; 6]; 6], [1.0; 6]);
    let mut factors: TangentFactors = [[[[0.0; NODES]; 3]; GAUSS_POINTS]; 9];
    let mut tangent: LocalTangent = [[[[0.0; 3]; NODES]; 3]; NODES];
    for symmetric in [true, false] {
        criterion.bench_function(&format!("kernel, right factors, symmetric = {symmetric}"), |bencher| {
            bencher.iter(|| {
                for g in (0..GAUSS_POINTS).step_by(4) {
                    let (left, right, moduli, stress) = (black_box(&f), &f, black_box(&moduli), &stress);
                    let point = TangentPoint { left, right, moduli, stress, geometric: 1.0, weight: 1.0 };
                    kernel::tangent_factors(&[point; 4], &integration.gradients, g, symmetric, &mut factors);
                }
                black_box(&factors);
            });
        });
        criterion.bench_function(&format!("kernel, products, symmetric = {symmetric}"), |bencher| {
            bencher.iter(|| {
                kernel::tangent_from_factors(
                    &integration.gradients,
                    black_box(&factors),
                    symmetric,
                    1.0,
                    black_box(&mut tangent),
                );
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .with_measurement(CpuTime)
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = kernels, on_one_thread
}
criterion_main!(benches);
