//! Beams in motion.

use super::build::{ABOUT_Z, Couple, add_beam, add_constraint, add_force, beam_frame, dynamic, follow, order, place};
use super::{ENERGY, MOMENTUM, ORDER, check, noted};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::{apart, larger, norm};
use crate::workspace::Outcome;
use std::sync::Arc;
use stoss_multibody::{Beam, BeamAxis, CoordinateOptions, DriveFunction, Joint, JointFrame, JointKind, Section};
use stoss_reference_cases::multibody::lines::{spin_up, spun_rod};
use stoss_solver::Model;

/// Least order in the mesh of elements of order 2, which have order 4.
const MESH_ORDER: f64 = 3.8;

/// Measures a beam that is spun up and one that flies.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    spun(quick, findings)?;
    spaghetti(quick, findings)
}

fn straight(length: f64, elements: usize, order: usize, section: Section) -> Outcome<Beam> {
    let axis = BeamAxis::straight([0.0; 3], [length, 0.0, 0.0], [0.0, 1.0, 0.0], elements, order)?;
    Ok(Beam::new("beam", 0, axis, section)?)
}

/// A beam that a motor spins up about one of its ends (Simo and Vu-Quoc, J. Appl. Mech. 53 (1986) 855): in steady state it is longer by 5.14e-4, which is the closed form of a rod.
fn spun(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "spin-up";
    let section =
        Section { axial: 2.8e7, shear: [1e7; 2], bending: [1.4e4; 2], torsion: 1.4e4, mass: 1.2, rotary: [6e-4; 2] };
    let (length, spin, rise, dt) = (10.0, 6.0, 15.0, if quick { 0.05 } else { 0.01 });
    let beam = straight(length, 4, 2, section)?;
    let last = beam.node_count() - 1;
    let mut model = Model::default();
    add_beam(&mut model, &beam, &[]);
    let (ground, own) = (JointFrame::ground([0.0; 3], ABOUT_Z), beam_frame(&beam, 0, ABOUT_Z));
    let motor = DriveFunction(move |t: f64| spin_up(spin, rise, t));
    let options = CoordinateOptions { motor: Some(Arc::new(motor)), ..Default::default() };
    let joint =
        Joint::new("motor", JointKind::Hinge, &ground, &own, length, &model.reference)?.with_options(options)?;
    add_constraint(&mut model, "motor", joint);
    let mut run = dynamic(model, dt, 20.0)?;
    let tip = beam.node_vectors(last)[0];
    let (mut sum, mut count, mut lag) = (0.0, 0.0, 0.0_f64);
    let kept = follow(&mut run, |s, record| {
        let x = place(&s.state().q, tip);
        let (sin, cos) = spin_up(spin, rise, record.time).sin_cos();
        lag = lag.min(cos * x[1] - sin * x[0]);
        if record.time > 16.0 {
            (sum, count) = (sum + x[0].hypot(x[1]) - length, count + 1.0);
        }
    })?;
    let exact = spun_rod(length, section.axial, section.mass, spin);
    let note = format!(
        "mean of t = 16 to 20 {:.4e}, closed form {exact:.4e}, Simo and Vu-Quoc 5.14e-4; steps of {dt}",
        sum / count
    );
    // Of second order in the turn of a step; the vibration that is left adds the square of its small deflection.
    let bound = (spin * dt).powi(2) / 4.0 + 5e-3;
    noted(
        findings,
        case,
        "steady lengthening over the closed form, less one",
        (sum / count / exact - 1.0).abs(),
        Bound::AtMost(bound),
        note,
    );
    noted(
        findings,
        case,
        "largest lag of the tip",
        lag,
        Bound::Unbounded,
        "a figure of Simo and Vu-Quoc, without a number",
    );
    let energy = 0.5 * section.mass * spin * spin * length.powi(3) / 3.0;
    check(findings, case, "energy less work of the motor", kept.energy / energy, Bound::AtMost(ENERGY));
    Ok(())
}

/// A free beam with a force and moments at an end that grow and vanish (after Simo and Vu-Quoc, Comput. Meth. Appl. Mech. Engng 66 (1988) 125): the impulse is that of the force,
/// and in free flight momenta and energy stay.
fn spaghetti(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "flying spaghetti";
    let section =
        Section { axial: 1e4, shear: [1e4; 2], bending: [500.0; 2], torsion: 500.0, mass: 1.0, rotary: [10.0; 2] };
    let size = |t: f64| if t < 2.5 { t / 2.5 } else { (2.0 - t / 2.5).max(0.0) };
    let make = |dt: f64, end: f64, elements: usize| -> Outcome<_> {
        let axis = BeamAxis::straight([6.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 1.0], elements, 2)?;
        let beam = Beam::new("spaghetti", 0, axis, section)?;
        let couples = [Couple::on(&beam, 0, [0.0, 0.0, -1.0]), Couple::on(&beam, 0, [0.0, -1.0, 0.0])];
        let mut model = Model::default();
        add_beam(&mut model, &beam, &[]);
        for couple in &couples {
            model.parts.push(Box::new(couple.clone()));
        }
        add_force(&mut model, beam.node_vectors(0)[0], [20.0, 0.0, 0.0], &[[0.0, 0.0], [2.5, 1.0], [5.0, 0.0]])?;
        let mut run = dynamic(model, dt, end)?;
        let until = end.min(5.0);
        while run.state().time < until - 1e-9 {
            let at = size(run.state().time + 0.5 * dt);
            couples[0].set(200.0 * at);
            couples[1].set(100.0 * at);
            run.advance()?;
        }
        couples.iter().for_each(|couple| couple.set(0.0));
        Ok((run, beam.node_vectors(beam.node_count() - 1)[0]))
    };
    let (mut run, _) = make(0.05, if quick { 7.5 } else { 20.0 }, if quick { 5 } else { 10 })?;
    let first = *run.balance();
    noted(
        findings,
        case,
        "impulse of the force, relative error",
        (first.linear_momentum[0] / 50.0 - 1.0).abs(),
        Bound::AtMost(MOMENTUM),
        "50",
    );
    let kept = follow(&mut run, |_, _| {})?;
    let [linear, angular] = [kept.linear, kept.angular].map(|k| k.iter().copied().fold(0.0, larger));
    let note = format!(
        "{} steps of free flight, {} iterations at most, strain energy at its begin {:.1} of {:.1}",
        kept.steps,
        kept.iterations[0],
        first.strain,
        first.kinetic + first.strain
    );
    noted(
        findings,
        case,
        "drift of linear momentum",
        linear / norm(first.linear_momentum),
        Bound::AtMost(MOMENTUM),
        note.clone(),
    );
    noted(
        findings,
        case,
        "drift of angular momentum",
        angular / norm(first.angular_momentum),
        Bound::AtMost(MOMENTUM),
        note.clone(),
    );
    noted(
        findings,
        case,
        "drift of the energy",
        kept.energy / (first.kinetic + first.strain),
        Bound::AtMost(ENERGY),
        note,
    );
    let tip = |dt: f64, elements: usize| -> Outcome<[f64; 3]> {
        let (run, tip) = make(dt, 2.5, elements)?;
        Ok(place(&run.state().q, tip))
    };
    let (a, b, c) = (tip(0.025, 5)?, tip(0.0125, 5)?, tip(0.00625, 5)?);
    let (coarse, fine) = (apart(a, b), apart(b, c));
    let note = format!(
        "the free end at t = 2.5 moves by {coarse:.2e} from steps of 0.025 to 0.0125, by {fine:.2e} to 0.00625"
    );
    noted(findings, case, "order in the step", order([coarse, fine]), Bound::AtLeast(ORDER), note);
    let (a, b, c) = (tip(0.025, 5)?, tip(0.025, 10)?, tip(0.025, 20)?);
    let (coarse, fine) = (apart(a, b), apart(b, c));
    let note =
        format!("the free end at t = 2.5 moves by {coarse:.2e} from 5 to 10 elements of order 2, by {fine:.2e} to 20");
    noted(findings, case, "order in the mesh", order([coarse, fine]), Bound::AtLeast(MESH_ORDER), note);
    Ok(())
}
