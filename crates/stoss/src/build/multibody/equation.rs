//! Linear equations between displacements.

use super::super::Problems;
use super::super::condition::resolve;
use super::super::placed::{Placed, index};
use super::coupling::weights;
use super::{Parts, extent::extent};
use crate::scene::{Equation, EquationTerm, Scene};
use crate::solver::Model;
use stoss_multibody::{Embedded, LinearEquations, LinearTerms, PiecewiseLinear};

/// Part of the size of sets by which nodes at the same place may differ.
const SAME: f64 = 1e-6;

/// Points of a term in the order of the equations: one for all of them, or one for each.
type Points = Vec<Embedded>;

/// What the equations of a scene need to be made.
struct Maker<'a> {
    scene: &'a Scene,
    placed: &'a [Placed],
    parts: &'a Parts,
    model: &'a Model,
}

/// The equations in the order of the scene; `None` for those with problems.
pub(super) fn equations(
    scene: &Scene,
    placed: &[Placed],
    parts: &Parts,
    model: &Model,
    problems: &mut Problems<'_>,
) -> Vec<Option<LinearEquations>> {
    let maker = Maker { scene, placed, parts, model };
    scene.equations.iter().enumerate().map(|(e, item)| maker.equation(item, e, problems)).collect()
}

impl Maker<'_> {
    fn equation(&self, item: &Equation, e: usize, problems: &mut Problems<'_>) -> Option<LinearEquations> {
        let key = format!("equation[{e}]");
        let mut points = Vec::new();
        for (t, term) in item.terms.iter().enumerate() {
            points.push(self.points(term, &format!("{key}.terms[{t}]"), problems)?);
        }
        let count = points.iter().map(Vec::len).max()?;
        let leader = points.iter().position(|points| points.len() == count)?;
        for t in 0..points.len() {
            if points[t].len() == 1 || t == leader {
                continue;
            }
            points[t] = self
                .paired(&points[leader], &points[t])
                .map_err(|message| {
                    let set = item.terms[t].set.as_deref().unwrap_or_default();
                    let remedy =
                        "name sets of the same nodes but for a translation, or of one node, or write `mean = true`";
                    problems.add(format!("{key}.terms[{t}].set"), set, message, remedy);
                })
                .ok()?;
        }
        let terms = |k: usize| -> LinearTerms {
            let one = |(points, term): (&Points, &EquationTerm)| {
                (points[if points.len() == 1 { 0 } else { k }].clone(), term.factors())
            };
            points.iter().zip(&item.terms).map(one).collect()
        };
        let all: Vec<LinearTerms> = (0..count).map(terms).collect();
        let value = item.value.rows().iter().map(|row| (row[0], row[1])).collect();
        let length = self.length(&all);
        match LinearEquations::new(&item.name, length, &all, PiecewiseLinear(value), &self.model.reference) {
            Ok(made) => Some(made),
            Err(error) => {
                problems.add(key, &item.name, error.to_string(), "correct its terms");
                None
            }
        }
    }

    /// A node, or what carries it.
    fn node(&self, node: u32) -> Embedded {
        match self.model.embedding.carriers(node) {
            Some(carriers) => Embedded { terms: carriers.to_vec(), ..Embedded::default() },
            None => Embedded::vector(node),
        }
    }

    fn points(&self, term: &EquationTerm, key: &str, problems: &mut Problems<'_>) -> Option<Points> {
        if let (Some(part), Some(x)) = (&term.body, term.point) {
            if let Some(body) = self.parts.rigid(part) {
                return Some(vec![body.point(x)]);
            }
            return Some(vec![self.node(self.placed[index(self.placed, part)?].nearest(x).0)]);
        }
        let set = term.set.as_deref()?;
        let (p, nodes) = resolve(self.placed, &format!("{key}.set"), set, problems, Placed::nodes_of)?;
        if !term.mean {
            return Some(nodes.into_iter().map(|node| self.node(node)).collect());
        }
        let weights = weights(&self.placed[p], set, &nodes, &self.model.reference);
        let total: f64 = weights.iter().map(|(_, w)| w).sum();
        let mean =
            weights.into_iter().fold(Embedded::default(), |mean, (node, w)| mean.plus(w / total, &self.node(node)));
        Some(vec![mean])
    }

    /// The second points in the order of the first: those at the same place relative to the centre of all.
    fn paired(&self, first: &Points, second: &Points) -> Result<Points, String> {
        if first.len() != second.len() {
            return Err(format!("has {} nodes, and another set of the equation {}", second.len(), first.len()));
        }
        let places = |points: &Points| {
            let all: Vec<[f64; 3]> = points.iter().map(|point| point.at(&self.model.reference)).collect();
            let centre: [f64; 3] = std::array::from_fn(|i| all.iter().map(|x| x[i]).sum::<f64>() / all.len() as f64);
            all.iter().map(|x| std::array::from_fn(|i| x[i] - centre[i])).collect::<Vec<[f64; 3]>>()
        };
        let (a, b) = (places(first), places(second));
        let size = a.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs()));
        // By one coordinate after the other, so that only neighbours are compared.
        let mut order: Vec<usize> = (0..b.len()).collect();
        order.sort_by(|&i, &j| b[i][0].total_cmp(&b[j][0]));
        let mut taken = vec![false; b.len()];
        let mut paired = Points::new();
        for x in &a {
            let from = order.partition_point(|&j| b[j][0] < x[0] - SAME * size);
            let near = order[from..].iter().take_while(|&&j| b[j][0] <= x[0] + SAME * size);
            let mut near = near.filter(|&&j| (0..3).all(|i| (b[j][i] - x[i]).abs() <= SAME * size) && !taken[j]);
            let Some(&j) = near.next() else {
                return Err(format!(
                    "has no node at ({:.6e}, {:.6e}, {:.6e}) from its centre, where another set of the equation has one",
                    x[0], x[1], x[2]
                ));
            };
            taken[j] = true;
            paired.push(second[j].clone());
        }
        Ok(paired)
    }

    /// A length that is typical of what is coupled.
    fn length(&self, equations: &[LinearTerms]) -> f64 {
        let mut nodes = equations.iter().flatten().flat_map(|(point, _)| &point.terms).map(|(vector, _)| *vector);
        let own = nodes.find_map(|node| self.model.bodies.iter().find(|body| body.nodes.contains(&node)));
        own.map_or_else(|| extent(self.scene, &self.model.reference), |body| body.solid.characteristic_length())
    }
}
