//! Fields that go from one surface to the other through the mortar integrals.

use stoss_contact::ContactSurface;
use stoss_contact_mortar::segmentation::GapRange;
use stoss_contact_mortar::{Faces, MortarMatrices, MultiplierSpace, segment_surfaces};
use stoss_tensor::Vector3;
use stoss_tensor::nalgebra::{DMatrix, DVector};

use super::super::Findings;
use super::super::check::{Bound, Check};
use super::super::states::Random;
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Error of a constant, and of the sums of the rows.
const CONSTANT: f64 = 1e-12;
/// Error of a linear field, over its largest value.
const LINEAR: f64 = 1e-11;

/// Nodes and facets of `n x n` over the square of half side `r`.
fn sheet(
    n: usize,
    r: f64,
    first: usize,
    up: bool,
    mut place: impl FnMut(Vector3) -> Vector3,
) -> (Vec<[u32; 4]>, Vec<f64>) {
    let h = 2.0 * r / n as f64;
    let (mut facets, mut q) = (Vec::new(), Vec::new());
    for j in 0..=n {
        for i in 0..=n {
            q.extend(place(Vector3::new(i as f64 * h - r, j as f64 * h - r, 0.0)).iter());
            if i < n && j < n {
                let k = (first + j * (n + 1) + i) as u32;
                let row = n as u32 + 1;
                facets.push(if up { [k, k + 1, k + row + 1, k + row] } else { [k, k + row, k + row + 1, k + 1] });
            }
        }
    }
    (facets, q)
}

struct Pair {
    slave: ContactSurface,
    master: ContactSurface,
    q: Vec<f64>,
}

/// Two random sheets; the slave reaches over the rim of the master if that is small. Curved or in a plane.
fn pair(random: &mut Random, half_side: f64, curvature: f64) -> Outcome<Pair> {
    let [n, m] = [0; 2].map(|_| random.between(1.0, 6.999) as usize);
    let mut moved = |x: Vector3, h: f64, edge: f64| {
        let inside = if x.x.abs().max(x.y.abs()) > edge * (1.0 - 1e-9) { 0.0 } else { 0.2 * h };
        let d = [0; 2].map(|_| random.between(-1.0, 1.0) * inside);
        Vector3::new(x.x + d[0], x.y + d[1], curvature * (x.x * x.x - 0.5 * x.x * x.y))
    };
    let (slave, mut q) = sheet(n, 1.0, 0, true, |x| moved(x, 2.0 / n as f64, 1.0));
    let (master, x) = sheet(m, half_side, q.len() / 3, false, |x| moved(x, 2.0 * half_side / m as f64, half_side));
    q.extend(x);
    Ok(Pair {
        slave: ContactSurface::new("slave", &slave, &q)?,
        master: ContactSurface::new("master", &master, &q)?,
        q,
    })
}

impl Pair {
    fn matrices(&self, space: MultiplierSpace) -> Outcome<MortarMatrices> {
        let segments = segment_surfaces(&self.slave, &self.master, &self.q, GapRange::ALL)?;
        let faces = Faces::default();
        Ok(MortarMatrices::assemble(&self.slave, &self.master, [&faces; 2], &self.q, &segments, space))
    }

    /// Largest error of `D^-1 M` applied to a field at the slave nodes, over the largest value.
    fn error(&self, matrices: &MortarMatrices, field: impl Fn([f64; 3]) -> f64) -> Outcome<f64> {
        let at = |node: u32| field(std::array::from_fn(|i| self.q[3 * node as usize + i]));
        let n = matrices.slave.len();
        let (mut d, mut f) = (DMatrix::zeros(n, n), DVector::zeros(n));
        let expected: Vec<f64> = self.slave.nodes().iter().map(|&node| at(node)).collect();
        for a in 0..n {
            if matrices.weights[a] == 0.0 {
                d[(a, a)] = 1.0;
                f[a] = expected[a];
            }
            matrices.slave[a].iter().for_each(|&(j, v)| d[(a, j as usize)] += v);
            matrices.master[a].iter().for_each(|&(k, v)| f[a] += v * at(self.master.nodes()[k as usize]));
        }
        let found = d.lu().solve(&f).ok_or("D is singular")?;
        let largest = expected.iter().fold(f64::MIN_POSITIVE, |m: f64, x| m.max(x.abs()));
        Ok(found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, larger) / largest)
    }
}

/// Constants between curved surfaces also where the slave hangs over, linear fields between plane ones.
pub fn measure(findings: &mut Findings, quick: bool) -> Outcome<()> {
    let count = if quick { 100 } else { 2000 };
    for (name, space) in [("standard", MultiplierSpace::Standard), ("dual", MultiplierSpace::Dual)] {
        let mut random = Random(21);
        let (mut sums, mut constant, mut linear) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..count {
            let half_side = random.between(0.7, 1.3);
            sums = larger(sums, pair(&mut random, half_side, 0.2)?.matrices(space)?.imbalance());
            let curved = pair(&mut random, 1.3, 0.2)?;
            constant = larger(constant, curved.error(&curved.matrices(space)?, |_| 1.0)?);
            let plane = pair(&mut random, 1.3, 0.0)?;
            linear = larger(linear, plane.error(&plane.matrices(space)?, |x| 0.7 + 1.3 * x[0] - 2.1 * x[1])?);
        }
        let scene = format!("transfer, {name} multipliers");
        let row = |quantity: &str, value: f64, bound: f64| {
            let note = format!("{count} random pairs of surfaces");
            Check::new(&scene, quantity, value, Bound::AtMost(bound)).noted(note)
        };
        findings.checks.push(row("sums of rows, partly covered, curved", sums, CONSTANT));
        findings.checks.push(row("error of a constant, curved", constant, CONSTANT));
        findings.checks.push(row("error of a linear field, plane", linear, LINEAR));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadratic_field_is_not_transferred_exactly() {
        let plane = pair(&mut Random(1), 1.3, 0.0).unwrap();
        let matrices = plane.matrices(MultiplierSpace::Standard).unwrap();
        assert!(plane.error(&matrices, |x| x[0]).unwrap() < 1e-12);
        assert!(plane.error(&matrices, |x| x[0] * x[0]).unwrap() > 1e-4);
    }
}
