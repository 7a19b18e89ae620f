//! Numerical tangents against exact ones (thesis D.1), and the tangents of laws and elements against numerical ones.

use std::sync::Arc;

use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{ForceRule, SolidBody, SolidStep, TangentTarget, Workspace};
use stoss_linalg::{ScatterMap, SparsityPattern};
use stoss_mesh::Mesh;
use stoss_mesh::generate::Block;
use stoss_numerical_derivative::{Analytic, AnalyticScalar, Method, Row, Scalar, optimum, steps, study};

use super::check::{Bound, Check, number};
use super::derivatives::{self, Worst};
use super::laws::LAWS;
use super::report::{Grid, Section};
use super::states::Random;
use super::{Bench, Findings, Suite};
use crate::plot::{self, Labels, Series};
use crate::workspace::Outcome;

/// Figure D.1 of the thesis, and every analytic tangent.
pub struct Tangents;

/// The study is at this argument.
const X: f64 = 2.0;

/// The complex step must be exact but for round-off with steps up to this.
const SMALL_STEP: f64 = 1e-8;
const COMPLEX_STEP: f64 = 1e-14;

/// A difference must reach the theoretical error at its best step within this factor.
const OPTIMUM: f64 = 10.0;

/// Central differences reach 4e-11 for a well-scaled function; derivatives of higher order take the rest.
const TANGENT: f64 = 1e-8;

/// The energy-momentum stress is a quotient: the differences divide its round-off, 1e-16 over the increment, by
/// their step.
const QUOTIENT: f64 = 1e-7;

/// Random states of a law.
const STATES: usize = 500;

/// Random steps of an element, for each law and each rule of a scheme.
const ELEMENTS: usize = 30;

/// Nodes of the element move by up to this fraction of its edge: from the reference position, and in the step.
const AMPLITUDE: f64 = 0.12;

impl Suite for Tangents {
    fn name(&self) -> &'static str {
        "tangents"
    }

    fn about(&self) -> &'static str {
        "Differences and complex step against an exact derivative; tangents of laws and elements against differences, \
         as fractions of their largest entry."
    }

    fn measure(&self, _bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        example(&mut findings)?;
        for sample in &LAWS {
            let law = sample.energy.law()?;
            of_law(&mut findings, law.as_ref())?;
            of_element(&mut findings, &law)?;
        }
        Ok(findings)
    }
}

/// `f(x) = sin x + x^4`, thesis (D.6).
struct Example;

impl AnalyticScalar for Example {
    fn at<S: Scalar>(&self, x: S) -> S {
        x.sin() + x.powi(4)
    }
}

/// `f'(x) = cos x + 4 x^3`, thesis (D.7).
fn exact(x: f64) -> f64 {
    x.cos() + 4.0 * x.powi(3)
}

/// Figure D.1 of the thesis and what must be seen in it.
fn example(findings: &mut Findings) -> Outcome<()> {
    let rows = study(&mut Analytic(Example), exact(X), X, &steps(0, -16, 8))?;
    let scene = "figure D.1";
    let small = rows.iter().filter(|row| row.step <= SMALL_STEP).map(|row| row.error(Method::ComplexStep));
    let worst = small.fold(0.0_f64, |worst, error| if error.is_nan() { f64::INFINITY } else { worst.max(error) });
    let quantity = format!("complex step, error for steps up to {SMALL_STEP:.0e}");
    findings.checks.push(Check::new(scene, quantity, worst, Bound::AtMost(COMPLEX_STEP)));
    for method in [Method::Forward, Method::Backward, Method::Central] {
        let best = optimum(&rows, method).ok_or("the study has no rows")?;
        let bound = Bound::AtMost(OPTIMUM * method.attainable_error());
        let check = Check::new(scene, format!("{method}, error at the best step"), best.error, bound);
        let expected = method.unit_step();
        findings.checks.push(check.noted(format!("step {:.1e}, in theory about {expected:.1e}", best.step)));
    }
    for method in Method::ALL {
        let order = order(&rows, method);
        let bound = Bound::Near { value: method.order().into(), tolerance: 0.05 };
        findings.checks.push(Check::new(scene, format!("{method}, order"), order, bound));
    }
    findings.sections.push(figure(&rows));
    Ok(())
}

/// Observed order between the steps 1e-2 and 1e-4.
fn order(rows: &[Row], method: Method) -> f64 {
    let at = |step: f64| rows.iter().find(|row| (row.step / step - 1.0).abs() < 1e-9).map(|row| row.error(method));
    match (at(1e-2), at(1e-4)) {
        (Some(large), Some(small)) => 0.5 * (large / small).log10(),
        _ => f64::NAN,
    }
}

/// Left the function, right the errors.
fn figure(rows: &[Row]) -> Section {
    let x: Vec<f64> = (0..=150).map(|k| 0.02 * f64::from(k)).collect();
    let near = [X - 0.7, X + 0.7];
    let function = [
        Series::new("f", &x, x.iter().map(|x| Example.at(*x))),
        Series::new("tangent at 2", &near, near.map(|x| Example.at(X) + exact(X) * (x - X))),
    ];
    let step: Vec<f64> = rows.iter().map(|row| row.step).collect();
    let errors = Method::ALL.map(|method| Series::new(method.name(), &step, rows.iter().map(|row| row.error(method))));
    let labels = Labels { title: "error of f'(2); zero is drawn at 1e-17", x: "step", y: "relative error" };
    let figures = vec![
        plot::linear(Labels { title: "f(x) = sin x + x⁴", x: "x", y: "" }, &function),
        plot::log_log(labels, &errors, Some(1e-17), &[1.0, 2.0]),
    ];
    let entries = |row: &Row| {
        let errors = Method::ALL.map(|method| row.error(method));
        std::iter::once(format!("{:.0e}", row.step)).chain(errors.map(number_or_dash)).collect()
    };
    let grid = Grid {
        caption: "relative error; no value where the step is lost in the round-off of x".into(),
        head: std::iter::once("step").chain(Method::ALL.map(Method::name)).map(str::to_owned).collect(),
        rows: rows.iter().step_by(16).map(entries).collect(),
    };
    Section { title: "Figure D.1: numerical tangents".into(), reading: "Derivatives by differences, by a complex step and by dual numbers against the exact one (thesis, appendix D). Differences lose half of the digits or more; the other two none.".into(), figures, tables: vec![grid] }
}

fn number_or_dash(value: f64) -> String {
    if value.is_nan() { "-".into() } else { number(value) }
}

/// Elasticity tensor and energy-momentum tangent.
fn of_law(findings: &mut Findings, law: &dyn HyperelasticLaw) -> Outcome<()> {
    let mut random = Random(1);
    let (mut elasticity, mut energy_momentum) = (Worst::default(), Worst::default());
    for _ in 0..STATES {
        elasticity.see_entry(&derivatives::elasticity(law, &random.moderate())?);
        // Shorter steps drown in the round-off of the quotient, which the differences divide by their own step.
        energy_momentum.see_entry(&derivatives::energy_momentum(law, &random.step(-1.5, 0.0))?);
    }
    findings.checks.push(elasticity.check(law.name(), "elasticity tensor", TANGENT));
    findings.checks.push(energy_momentum.check(law.name(), "energy-momentum tangent", QUOTIENT));
    Ok(())
}

/// Rules of schemes at which stresses are taken, and their names.
const RULES: [(&str, ForceRule); 4] = [
    ("hex8, end point", ForceRule::END_POINT),
    ("hex8, midpoint", ForceRule::MIDPOINT),
    ("hex8, theta = 0.3", ForceRule::Configuration { theta: 0.3 }),
    ("hex8, energy-momentum", ForceRule::DiscreteGradient),
];

/// The tangent of one distorted element under every rule.
fn of_element(findings: &mut Findings, law: &Arc<dyn HyperelasticLaw>) -> Outcome<()> {
    for (quantity, rule) in RULES {
        let mut random = Random(2);
        let mut worst = Worst::default();
        // Some random elements are inverted; there are enough others.
        for _ in 0..10 * ELEMENTS {
            if worst.count < ELEMENTS
                && let Some(element) = Element::new(&mut random, law, rule)
            {
                worst.see_entry(&element.compare()?);
            }
        }
        findings.checks.push(worst.check(law.name(), quantity, TANGENT));
    }
    Ok(())
}

/// One element in a step, and its tangent.
struct Element {
    body: SolidBody,
    rule: ForceRule,
    q_n: Vec<f64>,
    q_np1: Vec<f64>,
    tangent: Vec<f64>,
}

impl Element {
    /// A random element in a random step; `None` if it is inverted somewhere.
    fn new(random: &mut Random, law: &Arc<dyn HyperelasticLaw>, rule: ForceRule) -> Option<Self> {
        let mut mesh = Block::new([0.0; 3], [1.0; 3], [1; 3]).generate().ok()?;
        let mut moved =
            |x: &[f64]| -> Vec<f64> { x.iter().map(|x| x + random.between(-AMPLITUDE, AMPLITUDE)).collect() };
        let reference = moved(mesh.nodes.as_flattened());
        let q_n = moved(&reference);
        let q_np1 = moved(&q_n);
        for (node, x) in mesh.nodes.iter_mut().zip(reference.chunks_exact(3)) {
            node.copy_from_slice(x);
        }
        let mut body = SolidBody::new("element", &mesh, 0, law.clone()).ok()?;
        body.begin_step(&q_n, rule, 1.0).ok()?;
        let tangent = dense_tangent(&body, &mesh, SolidStep { q_n: &q_n, q_np1: &q_np1, rule })?;
        Some(Self { body, rule, q_n, q_np1, tangent })
    }

    fn compare(&self) -> Outcome<stoss_numerical_derivative::Comparison> {
        let mut workspace = Workspace::default();
        let mut force = |q: &[f64], out: &mut [f64]| {
            out.fill(0.0);
            let step = SolidStep { q_n: &self.q_n, q_np1: q, rule: self.rule };
            if self.body.assemble(step, 1.0, out, None, &mut workspace).is_err() {
                out.fill(f64::NAN);
            }
        };
        Ok(derivatives::force(&mut force, &self.q_np1, &self.tangent)?)
    }
}

/// `dF/dq_np1`, row-major; `None` if the body has none.
fn dense_tangent(body: &SolidBody, mesh: &Mesh, step: SolidStep) -> Option<Vec<f64>> {
    let unknowns = step.q_np1.len();
    let stencils: Vec<Vec<u32>> =
        mesh.elements.iter().map(|nodes| nodes.iter().flat_map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect()).collect();
    let stencils = || stencils.iter().map(Vec::as_slice);
    let pattern = SparsityPattern::from_stencils(unknowns, stencils()).ok()?;
    let map = ScatterMap::new(&pattern, stencils()).ok()?;
    let (mut values, mut force) = (vec![0.0; pattern.nnz()], vec![0.0; unknowns]);
    let target = TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values: &mut values };
    body.assemble(step, 1.0, &mut force, Some(target), &mut Workspace::default()).ok()?;
    let mut dense = vec![0.0; unknowns * unknowns];
    for column in 0..unknowns {
        for (row, k) in pattern.column(column).iter().zip(pattern.column_range(column)) {
            dense[*row as usize * unknowns + column] = values[k];
        }
    }
    Some(dense)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_between_two_steps() {
        let row = |step: f64, error: f64| Row { step, errors: [error, error * error, f64::NAN, 1.0] };
        let rows = [row(1e-1, 1.0), row(1e-2, 1e-3), row(1e-3, 1e-4), row(1e-4, 1e-5)];
        assert!((order(&rows, Method::Forward) - 1.0).abs() < 1e-12);
        assert!((order(&rows, Method::Backward) - 2.0).abs() < 1e-12);
        assert!(order(&rows, Method::Central).is_nan() && order(&rows[..2], Method::Forward).is_nan());
    }

    #[test]
    fn a_wrong_tangent_of_an_element_is_seen() {
        let law = LAWS[1].energy.law().unwrap();
        for (name, rule) in RULES {
            let mut element = Element::new(&mut Random(3), &law, rule).expect("this element is not inverted");
            assert!(element.compare().unwrap().relative_error < TANGENT, "{name}");
            let place = 5 * 24 + 7;
            let largest = element.tangent.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            element.tangent[place] += 1e-4 * largest;
            let worst = element.compare().unwrap();
            assert_eq!((worst.row, worst.column), (5, 7), "{name}");
        }
    }
}
