//! What contact methods report against the conditions of contact: no tension, closed gaps are zero, friction stays within its bound and opposes the slip.

use crate::words::short_time;
use crate::{Finding, FindingKind, Severity};

/// Part of the largest pressure, and of the stiffness of the bodies, that is round-off and what the iteration leaves.
const TOLERANCE: [f64; 2] = [1e-6, 1e-9];
/// Part of an edge that the iteration leaves of a slip: its direction means nothing.
const NO_SLIP: f64 = 1e-9;

/// A slave point of a contact at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Global number of the node.
    pub node: u32,
    /// Whether the contact is closed.
    pub active: bool,
    /// Pressure (a stress), positive in compression.
    pub pressure: f64,
    /// Gap (a length); `None` if no master is within reach.
    pub gap: Option<f64>,
    /// Gap that a closed contact keeps (a length; zero, but for the modified constraint).
    pub reference_gap: f64,
    /// Friction of the point; `None` without friction.
    pub friction: Option<PointFriction>,
}

/// Friction of a point in a step, in components of an orthonormal frame of the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointFriction {
    /// Traction, positive along the slip, against which it acts.
    pub traction: [f64; 2],
    /// Slip in the step, a length.
    pub slip: [f64; 2],
    /// Largest traction that the law admits, a stress.
    pub bound: f64,
    /// True if the point sticks.
    pub sticks: bool,
}

/// What a contact reports at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct ContactState<'a> {
    /// Name.
    pub name: &'a str,
    /// Numbers of the two bodies; `None` if the slave is a line (beam or string), whose geometry is not checked.
    pub bodies: Option<[usize; 2]>,
    /// Young's modulus or another stress against which pressures are small.
    pub stiffness: f64,
    /// Edge length of the slave surface.
    pub edge: f64,
    /// Whether closed gaps are closed exactly (multipliers), not by springs.
    pub exact: bool,
    /// Points of the contact.
    pub points: &'a [ContactPoint],
}

/// Inadmissible states that a contact reports. `limit`: gap of a closed contact, as a part of an edge length, from which on it is doubtful. `name_of` names a node in
/// messages.
pub(crate) fn observe(
    step: u64,
    time: f64,
    contact: &ContactState<'_>,
    limit: f64,
    name_of: impl Fn(u32) -> String,
) -> Vec<Finding> {
    let ContactState { name, bodies, stiffness, edge, exact, points } = *contact;
    let largest = points.iter().filter(|point| point.active).map(|point| point.pressure.abs()).fold(0.0, f64::max);
    let small = TOLERANCE[0] * largest + TOLERANCE[1] * stiffness;
    let mut found: Vec<Finding> = Vec::new();
    let mut add = |level, what: String, figure: f64| {
        let sentence = format!("at t = {} {what}", short_time(time));
        found.push(Finding { bodies, ..Finding::new(level, FindingKind::Contact, (step, time), sentence, figure) });
    };
    for point in points {
        let node = || format!("{} in contact {name}", name_of(point.node));
        let pressure = point.pressure;
        if !point.active {
            if pressure.abs() > small || pressure.is_nan() {
                add(Severity::Wrong, format!("{} is open but has the pressure {pressure:.2e}", node()), pressure.abs());
            }
            // Of surfaces that are checked themselves the gap of an open node may be that to an extended facet.
            let behind = -point.gap.unwrap_or(0.0) / edge;
            if bodies.is_none() && behind > limit && behind < 1.0 {
                add(
                    Severity::Doubtful,
                    format!("{} is open but {behind:.3} edge lengths behind the surface", node()),
                    behind,
                );
            }
            continue;
        }
        if pressure < -small || pressure.is_nan() {
            add(Severity::Wrong, format!("{} is in tension: its pressure is {pressure:.2e}", node()), -pressure);
        }
        if let Some(gap) = point.gap.filter(|_| exact) {
            let part = (gap - point.reference_gap).abs() / edge;
            // At rims a weighted gap, or that to an extended facet, need not be one of the surfaces, which are checked themselves.
            if part > limit {
                add(Severity::Doubtful, format!("{} is closed but has a gap of {part:.3} edge lengths", node()), part);
            }
        }
        let Some(PointFriction { traction: [t0, t1], slip: [s0, s1], bound, sticks }) = point.friction else {
            continue;
        };
        let traction = t0.hypot(t1);
        if traction > bound + small || traction.is_nan() {
            let what = format!("the friction of {} is {traction:.3e}, above its bound {bound:.3e}", node());
            add(Severity::Wrong, what, traction - bound);
        }
        let slides = !sticks && s0.hypot(s1) > NO_SLIP * edge;
        if slides && t0 * s0 + t1 * s1 < -small * s0.hypot(s1) {
            add(
                Severity::Wrong,
                format!("the friction of {} acts along the slip and not against it", node()),
                traction,
            );
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: ContactPoint = ContactPoint {
        node: 3,
        active: true,
        pressure: 2.0,
        gap: Some(1e-16),
        reference_gap: 0.0,
        friction: Some(PointFriction { traction: [0.6, 0.8], slip: [0.03, 0.04], bound: 1.0, sticks: false }),
    };

    fn levels(points: &[ContactPoint]) -> Vec<Severity> {
        let contact = ContactState { name: "c", bodies: None, stiffness: 1e3, edge: 0.1, exact: true, points };
        let found = observe(1, 0.1, &contact, 0.05, |node| format!("node {node}"));
        found.into_iter().map(|finding| finding.level).collect()
    }

    #[test]
    fn sound_points_raise_no_alarm() {
        let open = ContactPoint { active: false, pressure: 0.0, gap: Some(0.3), friction: None, ..SOUND };
        let far = ContactPoint { gap: None, ..open };
        let kept = ContactPoint { gap: Some(0.02), reference_gap: 0.02, ..SOUND };
        let barely = ContactPoint { pressure: -1e-7, ..SOUND };
        let unloading = ContactPoint {
            friction: Some(PointFriction { traction: [0.6, 0.0], slip: [-0.01, 0.0], bound: 1.0, sticks: true }),
            ..SOUND
        };
        let no_slip = PointFriction { traction: [1.0, 0.0], slip: [-1e-12, 0.0], bound: 1.0, sticks: false };
        let stopped = ContactPoint { friction: Some(no_slip), ..SOUND };
        assert_eq!(levels(&[SOUND, open, far, kept, barely, unloading, stopped]), []);
    }

    #[test]
    fn nodes_of_lines_that_are_open_behind_the_surface_are_doubtful() {
        let behind = |gap| ContactPoint { active: false, pressure: 0.0, gap: Some(gap), friction: None, ..SOUND };
        assert_eq!(levels(&[behind(-0.02), behind(-0.001), behind(0.02), behind(-0.2)]), [Severity::Doubtful]);
    }

    #[test]
    fn planted_errors_are_found() {
        let friction = |traction, slip| Some(PointFriction { traction, slip, bound: 1.0, sticks: false });
        for wrong in [
            ContactPoint { pressure: -1.0, ..SOUND },
            ContactPoint { pressure: f64::NAN, ..SOUND },
            ContactPoint { active: false, friction: None, ..SOUND },
            ContactPoint { friction: friction([0.9, 0.9], [1.0, 1.0]), ..SOUND },
            ContactPoint { friction: friction([-0.6, 0.0], [1.0, 0.0]), ..SOUND },
        ] {
            assert_eq!(levels(&[SOUND, wrong]), [Severity::Wrong], "{wrong:?}");
        }
        for (gap, reference_gap) in [(0.01, 0.0), (-0.05, 0.0), (0.0, -0.05)] {
            assert_eq!(levels(&[ContactPoint { gap: Some(gap), reference_gap, ..SOUND }]), [Severity::Doubtful]);
        }
    }
}
