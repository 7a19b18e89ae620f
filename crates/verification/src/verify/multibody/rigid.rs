//! Tops and pendulums.

use super::build::{ABOUT_Z, AXES, Kept, add_body, add_gravity, add_joint, cross, dynamic, follow, order, place};
use super::{ENERGY, MOMENTUM, ORDER, check, noted};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::{apart, larger, norm};
use crate::workspace::Outcome;
use stoss_multibody::{CoordinateOptions, JointFrame, JointKind, RigidBody, RigidMass, axes_along};
use stoss_reference_cases::multibody::pendulums::{DoublePendulum, spherical_pendulum};
use stoss_reference_cases::multibody::top::{FreeTop, LagrangeTop};
use stoss_solver::Model;

const GRAVITY: f64 = 9.81;

/// Measures all cases of rigid bodies.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    free_top(quick, findings)?;
    lagrange_top(findings)?;
    double_pendulum(findings)?;
    spherical(findings)
}

/// Adds rows of the energy and of the components of angular momentum that stay.
fn exact(findings: &mut Findings, case: &str, kept: &Kept, angular: &[usize], momentum: f64, energy: f64) {
    let drift = angular.iter().map(|&i| kept.angular[i] / momentum).fold(0.0, larger);
    let note = format!("{} steps, {} iterations at most", kept.steps, kept.iterations[0]);
    noted(findings, case, "drift of angular momentum", drift, Bound::AtMost(MOMENTUM), note.clone());
    noted(findings, case, "drift of the energy", kept.energy / energy, Bound::AtMost(ENERGY), note);
}

/// Angular velocity about the directors.
fn about_directors(body: &RigidBody, q: &[f64], v: &[f64]) -> [f64; 3] {
    let spin = body.angular_velocity(q, v);
    let l = body.director_length();
    std::array::from_fn(|k| {
        let d = place(q, body.first() + 1 + k as u32);
        (0..3).map(|i| spin[i] * d[i] / l).sum()
    })
}

/// A free top with three different moments of inertia: order two of the angular velocity against Jacobi's functions; momenta and energy over many steps.
fn free_top(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "free top";
    // Moments of inertia are sums of two Euler values.
    let top = FreeTop { inertia: [0.3, 0.5, 0.6], start: [1.0, 2.0] };
    let make = || -> Outcome<(Model, RigidBody)> {
        let mut model = Model::default();
        let mass = RigidMass::new(1.0, [0.0; 3], [0.4, 0.2, 0.1], AXES)?;
        // Its centre moves slowly: far from the origin angular momentum would have the round-off of the distance.
        let body = add_body(&mut model, "top", mass, [-0.002, 0.001, 0.003], [top.start[0], 0.0, top.start[1]]);
        Ok((model, body))
    };
    let error = |dt: f64| -> Outcome<f64> {
        let (model, body) = make()?;
        let mut simulation = dynamic(model, dt, top.period())?;
        let mut worst = 0.0;
        follow(&mut simulation, |s, record| {
            let w = about_directors(&body, &s.state().q, &s.state().v);
            worst = larger(worst, apart(w, top.angular_velocity(record.time)));
        })?;
        Ok(worst / top.start[1])
    };
    let errors = [0.02, 0.01].map(|part| error(part * top.period() / 10.0));
    let [coarse, fine] = errors;
    let errors = [coarse?, fine?];
    let note =
        format!("largest errors over a period {:.2e}, {:.2e}; Landau and Lifshitz, section 37", errors[0], errors[1]);
    noted(findings, case, "order of the angular velocity", order(errors), Bound::AtLeast(ORDER), note);
    let steps = if quick { 2e3 } else { 1e5 };
    let (model, _) = make()?;
    let mut simulation = dynamic(model, 0.05, 0.05 * steps)?;
    let first = *simulation.balance();
    let kept = follow(&mut simulation, |_, _| {})?;
    let sizes = [norm(first.linear_momentum), norm(first.angular_momentum), first.kinetic];
    let names = ["linear momentum", "angular momentum", "energy"];
    let drift =
        [kept.linear.iter().copied().fold(0.0, larger), kept.angular.iter().copied().fold(0.0, larger), kept.energy];
    for i in 0..3 {
        let bound = Bound::AtMost(if i == 2 { ENERGY } else { MOMENTUM });
        let note = format!("{} steps of 0.05", kept.steps);
        noted(
            findings,
            case,
            &format!("largest change of {} in a step", names[i]),
            kept.in_step[i] / sizes[i],
            bound,
            note.clone(),
        );
        noted(
            findings,
            case,
            &format!("drift of {} over the run", names[i]),
            drift[i] / sizes[i],
            Bound::Unbounded,
            note,
        );
    }
    Ok(())
}

/// A symmetric top on a ball joint: nutation between the roots of the cubic.
fn lagrange_top(findings: &mut Findings) -> Outcome<()> {
    let case = "Lagrange top";
    let (m, l, e, ea) = (1.2, 0.4, 0.02, 0.005);
    let top = LagrangeTop {
        axial: 2.0 * e,
        transverse: e + ea + m * l * l,
        moment: m * GRAVITY * l,
        cosine: 0.5,
        spin: 40.0,
        precession: 0.3,
    };
    let run = |dt: f64| -> Outcome<([f64; 2], Kept, [f64; 2])> {
        let sine = (1.0 - top.cosine * top.cosine).sqrt();
        let axis = [sine, 0.0, top.cosine];
        let axes = axes_along(axis).ok_or("no axes")?;
        let mut model = Model::default();
        let mass = RigidMass::new(m, axis.map(|a| l * a), [ea, e, e], axes)?;
        // Precession about z and spin about the axis: of the angular velocity w_3 is along it.
        let along = top.spin - top.precession * top.cosine;
        let spin = [along * axis[0], 0.0, top.precession + along * axis[2]];
        let body = add_body(&mut model, "top", mass, [0.0; 3], spin);
        add_gravity(&mut model, [0.0, 0.0, -GRAVITY]);
        let (ground, own) = (JointFrame::ground([0.0; 3], AXES), body.frame([0.0; 3], AXES));
        add_joint(&mut model, "tip", JointKind::Ball, [&ground, &own], CoordinateOptions::default())?;
        let mut simulation = dynamic(model, dt, 1.0)?;
        let first = *simulation.balance();
        let mut cosines = vec![top.cosine];
        let kept = follow(&mut simulation, |s, _| cosines.push(place(&s.state().q, body.first())[2] / l))?;
        Ok((extremes(&cosines), kept, [first.angular_momentum[2], first.kinetic]))
    };
    let limits = top.limits();
    let (coarse, ..) = run(0.004)?;
    let (fine, kept, [momentum, kinetic]) = run(0.002)?;
    let far = |found: [f64; 2]| [0, 1].map(|i| (found[i] - limits[i]).abs());
    let (a, b) = (far(coarse), far(fine));
    let moving = if (limits[0] - top.cosine).abs() > 1e-9 { 0 } else { 1 };
    let note = format!(
        "errors {:.2e}, {:.2e} at steps of 0.004, 0.002; limits {limits:.6?}, found {fine:.6?}",
        a[moving], b[moving]
    );
    noted(findings, case, "order of the limit of nutation", order([a[moving], b[moving]]), Bound::AtLeast(ORDER), note);
    let share = b[moving] / (limits[1] - limits[0]);
    noted(
        findings,
        case,
        "error of that limit over the range of nutation",
        share,
        Bound::AtMost(0.02),
        "step 0.002, about 80 steps a nutation",
    );
    exact(findings, case, &kept, &[2], momentum, kinetic);
    Ok(())
}

/// Smallest and largest value of a smooth function of which samples are given, by parabolas through three of them.
fn extremes(samples: &[f64]) -> [f64; 2] {
    let mut found = [f64::INFINITY, f64::NEG_INFINITY];
    for w in samples.windows(3) {
        let (slope, bend) = (0.5 * (w[2] - w[0]), w[0] - 2.0 * w[1] + w[2]);
        let vertex = if bend != 0.0 && (slope / bend).abs() <= 1.0 { w[1] - 0.5 * slope * slope / bend } else { w[1] };
        found = [found[0].min(vertex), found[1].max(vertex)];
    }
    found
}

/// Two rods on parallel hinges against the equations in two angles.
fn double_pendulum(findings: &mut Findings) -> Outcome<()> {
    let case = "double pendulum";
    let exact_form = double();
    let start = [1.2, 2.0, 0.0, 0.0];
    let end = 2.0;
    let expected = exact_form.state(start, end, 40_000);
    let run = |steps: u32| -> Outcome<(f64, Kept)> {
        let (model, _) = double_model(&exact_form, start)?;
        let mut simulation = dynamic(model, end / f64::from(steps), end)?;
        let kept = follow(&mut simulation, |_, _| {})?;
        Ok((double_error(&simulation.state().q, &exact_form, &expected), kept))
    };
    let (coarse, _) = run(400)?;
    let (fine, kept) = run(800)?;
    let note = format!("errors of the places {coarse:.2e}, {fine:.2e} at t = 2 against Runge and Kutta in two angles");
    noted(findings, case, "order", order([coarse, fine]), Bound::AtLeast(ORDER), note);
    let energy = exact_form.mass[0] * GRAVITY * exact_form.length;
    check(findings, case, "drift of the energy", kept.energy / energy, Bound::AtMost(ENERGY));
    Ok(())
}

/// The double pendulum of this suite.
pub fn double() -> DoublePendulum {
    DoublePendulum { mass: [1.5, 0.8], inertia: [0.12, 0.08], centre: [0.5, 0.4], length: 1.0, gravity: GRAVITY }
}

/// The model of a double pendulum: `y` is down, angles are about z from there.
pub fn double_model(data: &DoublePendulum, start: [f64; 4]) -> Outcome<(Model, [RigidBody; 2])> {
    let direction = |angle: f64| [angle.sin(), -angle.cos(), 0.0];
    let mut model = Model::default();
    let elbow = direction(start[0]).map(|d| data.length * d);
    let mut body = |k: usize, from: [f64; 3]| -> Outcome<RigidBody> {
        let d = direction(start[k]);
        let axes = [d, [-d[1], d[0], 0.0], [0.0, 0.0, 1.0]];
        let centre = std::array::from_fn(|i| from[i] + data.centre[k] * d[i]);
        // About z: the sum of the first two values.
        let j = data.inertia[k];
        let mass = RigidMass::new(data.mass[k], centre, [0.8 * j, 0.2 * j, 0.3 * j], axes)?;
        Ok(add_body(&mut model, ["upper", "lower"][k], mass, from, [0.0; 3]))
    };
    let bodies = [body(0, [0.0; 3])?, body(1, elbow)?];
    add_gravity(&mut model, [0.0, -data.gravity, 0.0]);
    let none = CoordinateOptions::default;
    let ground = JointFrame::ground([0.0; 3], ABOUT_Z);
    add_joint(&mut model, "shoulder", JointKind::Hinge, [&ground, &bodies[0].frame([0.0; 3], ABOUT_Z)], none())?;
    let sides = [&bodies[0].frame(elbow, ABOUT_Z), &bodies[1].frame(elbow, ABOUT_Z)];
    add_joint(&mut model, "elbow", JointKind::Hinge, sides, none())?;
    Ok((model, bodies))
}

/// Largest distance of the two centres from those of the angles.
pub fn double_error(q: &[f64], data: &DoublePendulum, angles: &[f64; 4]) -> f64 {
    let direction = |angle: f64| [angle.sin(), -angle.cos(), 0.0];
    let (d1, d2) = (direction(angles[0]), direction(angles[1]));
    let upper = d1.map(|d| data.centre[0] * d);
    let lower = std::array::from_fn(|i| data.length * d1[i] + data.centre[1] * d2[i]);
    larger(apart(place(q, 0), upper), apart(place(q, 4), lower))
}

/// Start of the spherical pendulum of this suite: direction and its rate; mass, distance of the centre, Euler value, and `w^2`.
pub const SPHERICAL: [f64; 6] = [0.6, 0.0, -0.8, 0.0, 2.0, 0.0];
const BOB: [f64; 3] = [1.3, 0.7, 0.02];

/// `m g l / I` of the spherical pendulum.
pub fn spherical_square() -> f64 {
    let [m, l, e] = BOB;
    m * GRAVITY * l / (2.0 * e + m * l * l)
}

/// The model of the spherical pendulum.
pub fn spherical_model() -> Outcome<Model> {
    let [m, l, e] = BOB;
    let n = [SPHERICAL[0], SPHERICAL[1], SPHERICAL[2]];
    let rate = [SPHERICAL[3], SPHERICAL[4], SPHERICAL[5]];
    let mut model = Model::default();
    let mass = RigidMass::new(m, n.map(|x| l * x), [e; 3], AXES)?;
    let body = add_body(&mut model, "bob", mass, [0.0; 3], cross(n, rate));
    add_gravity(&mut model, [0.0, 0.0, -GRAVITY]);
    let (ground, own) = (JointFrame::ground([0.0; 3], AXES), body.frame([0.0; 3], AXES));
    add_joint(&mut model, "pivot", JointKind::Ball, [&ground, &own], CoordinateOptions::default())?;
    Ok(model)
}

/// Distance of the bob from where it should be, over its distance from the pivot.
pub fn spherical_error(q: &[f64], expected: &[f64; 6]) -> f64 {
    let l = BOB[1];
    apart(place(q, 0).map(|x| x / l), [expected[0], expected[1], expected[2]])
}

fn spherical(findings: &mut Findings) -> Outcome<()> {
    let case = "spherical pendulum";
    let end = 3.0;
    let expected = spherical_pendulum(SPHERICAL, spherical_square(), end, 40_000);
    let run = |steps: u32| -> Outcome<(f64, Kept, [f64; 2])> {
        let mut simulation = dynamic(spherical_model()?, end / f64::from(steps), end)?;
        let first = *simulation.balance();
        let kept = follow(&mut simulation, |_, _| {})?;
        let error = spherical_error(&simulation.state().q, &expected);
        Ok((error, kept, [first.angular_momentum[2].abs(), first.kinetic]))
    };
    let (coarse, ..) = run(300)?;
    let (fine, kept, [momentum, kinetic]) = run(600)?;
    let note = format!("errors {coarse:.2e}, {fine:.2e} at t = 3 against Runge and Kutta on the sphere");
    noted(findings, case, "order", order([coarse, fine]), Bound::AtLeast(ORDER), note);
    exact(findings, case, &kept, &[2], momentum, kinetic);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_of_a_parabola_between_samples() {
        let samples: Vec<f64> = (0..6).map(|k| (f64::from(k) - 2.3).powi(2)).collect();
        let [low, high] = extremes(&samples);
        assert!(low.abs() < 1e-14, "{low}");
        // The ends are no extremes.
        assert!((high - 1.7_f64.powi(2)).abs() < 1e-14, "{high}");
    }

    /// The model of the double pendulum is where its angles say.
    #[test]
    fn places_of_the_double_pendulum() {
        let (data, start) = (double(), [1.2, 2.0, 0.0, 0.0]);
        let (model, _) = double_model(&data, start).unwrap();
        assert!(double_error(&model.reference, &data, &start) < 1e-15);
        assert!(spherical_error(&spherical_model().unwrap().reference, &SPHERICAL) < 1e-15);
    }
}
