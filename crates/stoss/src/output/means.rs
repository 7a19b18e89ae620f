//! What general contact does on average over the steps since the last frame: the layer on the surfaces rings, and single steps say little.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stoss_solver::ContactSummary;

/// A surface node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Node {
    /// Pressure and friction of the steps times their sizes.
    pressure: f64,
    friction: [f64; 3],
    /// Distance at the end of the last step; none where nothing was near.
    distance: Option<f64>,
}

/// Sums over steps. In statics, where forces follow the load, those of the last step alone.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Means {
    seconds: f64,
    nodes: BTreeMap<u32, Node>,
    /// Impulse on the first of two bodies, by the bodies in ascending order.
    pairs: Vec<([u32; 2], [f64; 3])>,
}

impl Means {
    /// Takes a step of the size `dt` in.
    pub fn add(&mut self, contact: &ContactSummary, dt: f64, is_static: bool) {
        if is_static {
            self.clear();
        }
        self.seconds += dt;
        self.nodes.values_mut().for_each(|node| node.distance = None);
        for node in &contact.surface {
            let of = self.nodes.entry(node.node).or_default();
            of.pressure += dt * node.pressure;
            of.friction.iter_mut().zip(node.friction).for_each(|(sum, t)| *sum += dt * t);
            of.distance = Some(node.distance).filter(|distance| distance.is_finite());
        }
        for pair in &contact.bodies {
            let place = self.pairs.binary_search_by_key(&pair.bodies, |of| of.0).unwrap_or_else(|place| {
                self.pairs.insert(place, (pair.bodies, [0.0; 3]));
                place
            });
            self.pairs[place].1.iter_mut().zip(pair.force).for_each(|(sum, force)| *sum += dt * force);
        }
    }

    /// Begins again, after a frame.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    fn mean(&self, sum: f64) -> f64 {
        if self.seconds > 0.0 { sum / self.seconds } else { 0.0 }
    }

    /// Node, pressure, size of friction and distance of the nodes where something acted or is near.
    pub fn nodes(&self) -> impl Iterator<Item = (u32, f64, f64, Option<f64>)> {
        self.nodes.iter().map(|(&node, of)| {
            let friction = of.friction.iter().map(|t| t * t).sum::<f64>().sqrt();
            (node, self.mean(of.pressure), self.mean(friction), of.distance)
        })
    }

    /// Pairs of bodies that acted on each other, with the force on the first.
    pub fn pairs(&self) -> impl Iterator<Item = ([u32; 2], [f64; 3])> {
        self.pairs.iter().map(|&(bodies, impulse)| (bodies, impulse.map(|sum| self.mean(sum))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_solver::{BodyPair, SurfaceNode};

    fn step(force: f64, pressure: f64, distance: f64) -> ContactSummary {
        let pair = BodyPair {
            bodies: [0, 2],
            active: 1,
            distance,
            pressure,
            area: 1.0,
            force: [0.0, 0.0, force],
            moment: [0.0; 3],
            friction_work: 0.0,
        };
        let node = SurfaceNode { node: 7, pressure, friction: [0.0, pressure, 0.0], distance, area: 1.0 };
        let mut summary = ContactSummary::default();
        (summary.bodies, summary.surface) = (vec![pair], vec![node]);
        summary
    }

    #[test]
    fn means_are_impulses_over_the_time() {
        let mut means = Means::default();
        means.add(&step(6.0, 2.0, 0.1), 0.5, false);
        means.add(&ContactSummary::default(), 1.0, false);
        assert_eq!(means.pairs().collect::<Vec<_>>(), [([0, 2], [0.0, 0.0, 2.0])]);
        let [(node, pressure, friction, distance)] = means.nodes().collect::<Vec<_>>()[..] else { panic!() };
        assert_eq!((node, distance), (7, None));
        assert!((pressure - 2.0 / 3.0).abs() < 1e-15 && (friction - 2.0 / 3.0).abs() < 1e-15);
        // Through a checkpoint, with the same bits.
        let text = serde_json::to_string(&means).unwrap();
        let back: Means = serde_json::from_str(&text).unwrap();
        assert_eq!((back.seconds, &back.nodes, &back.pairs), (means.seconds, &means.nodes, &means.pairs));
        means.add(&step(9.0, 4.0, f64::INFINITY), 0.25, true);
        assert_eq!(means.pairs().next(), Some(([0, 2], [0.0, 0.0, 9.0])));
        assert_eq!(means.nodes().next(), Some((7, 4.0, 4.0, None)));
        means.clear();
        assert_eq!((means.nodes().count(), means.pairs().count()), (0, 0));
    }
}
