//! A length that is typical of a scene, for what has no size of its own.

use crate::scene::{Scene, Series};

/// Largest extent of the points of a scene: those of `reference` and all masses, with them centres of rigid bodies and ends of joints and springs if those are in one place. Without
/// any extent the largest way in a step of what moves or is moved, then the largest distance from the origin; 1 if the scene has no length at all.
pub(super) fn extent(scene: &Scene, reference: &[f64]) -> f64 {
    let points = reference.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).chain(scene.masses.iter().map(|m| m.at));
    let centres = scene.rigids.iter().map(|rigid| rigid.centre.unwrap_or(rigid.position));
    let joints = scene.joints.iter().flat_map(|joint| joint.at.both());
    let springs = scene.springs.iter().flat_map(|spring| spring.at);
    let all = points.clone().chain(centres).chain(joints).chain(springs);
    let far = all.clone().flatten().fold(0.0, |far: f64, x| far.max(x.abs()));
    let lengths = [size(points), size(all), way(scene), far];
    lengths.into_iter().find(|&length| length > 0.0).unwrap_or(1.0)
}

/// Longest edge of the box around points.
fn size(points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let [mut low, mut high] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for x in points {
        for i in 0..3 {
            low[i] = low[i].min(x[i]);
            high[i] = high[i].max(x[i]);
        }
    }
    (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max)
}

/// Largest magnitude of a value of a series.
pub(super) fn largest(series: &Series) -> f64 {
    series.rows().iter().map(|row| largest_of(&row[1..])).fold(0.0, f64::max)
}

fn largest_of(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

/// Largest way in a step of masses and rigid bodies, by velocities, gravity, forces on masses, and of prescribed displacements.
fn way(scene: &Scene) -> f64 {
    let step = scene.time.step;
    let velocities = scene.masses.iter().map(|m| m.velocity).chain(scene.rigids.iter().map(|r| r.velocity));
    let speed = velocities.map(|v| largest_of(&v)).fold(0.0, f64::max);
    let lightest = scene.masses.iter().map(|m| m.mass).chain(scene.rigids.iter().filter_map(|r| r.mass));
    let lightest = lightest.filter(|&m| m > 0.0).fold(f64::INFINITY, f64::min);
    let force = scene.loads.iter().filter_map(|load| load.force.as_ref()).map(largest).fold(0.0, f64::max);
    let gravity = scene.gravity.map_or(0.0, |gravity| largest_of(&gravity.acceleration));
    let prescribed = scene.prescriptions.iter().flat_map(|item| item.displacement.iter().chain(&item.translation));
    prescribed.map(largest).fold(speed * step + (gravity + force / lightest) * step * step, f64::max)
}
