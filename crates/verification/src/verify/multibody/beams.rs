//! Beams at rest and in motion.

use super::build::{
    ABOUT_Z, Couple, add_beam, add_constraint, add_force, beam_frame, dynamic, follow, order, place, quasi_static,
};
use super::{ENERGY, MOMENTUM, ORDER, check, noted, order_in_mesh};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::{apart, larger, norm};
use crate::workspace::Outcome;
use std::f64::consts::PI;
use std::sync::Arc;
use stoss_multibody::{
    Beam, BeamAxis, CoordinateOptions, DriveFunction, Frame, Joint, JointKind, Section, SectionMaterial,
};
use stoss_reference_cases::multibody::bend::CurvedCantilever;
use stoss_reference_cases::multibody::lines::{buckling_load, cantilever, euler_load, spin_up, spun_rod};
use stoss_solver::Model;

/// Least order in the mesh of elements of order 1, and of those of order 2 and 3, which have order 4.
const MESH_ORDER: [f64; 2] = [1.9, 3.8];

/// Measures all cases of beams.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    roll_up(findings)?;
    bend(findings)?;
    tip_force(findings)?;
    buckling(findings)?;
    spun(quick, findings)?;
    spaghetti(quick, findings)
}

fn straight(length: f64, elements: usize, order: usize, section: Section) -> Outcome<Beam> {
    let axis = BeamAxis::straight([0.0; 3], [length, 0.0, 0.0], [0.0, 1.0, 0.0], elements, order)?;
    Ok(Beam::new("beam", 0, axis, section)?)
}

/// A moment `2 pi EI / L` at its end bends a cantilever to a full circle.
fn roll_up(findings: &mut Findings) -> Outcome<()> {
    let case = "roll-up to a circle";
    let section = Section { axial: 1e4, shear: [5e3; 2], bending: [2.0; 2], torsion: 1.5, mass: 0.0, rotary: [0.0; 2] };
    let (length, steps) = (10.0, 20);
    let moment = 2.0 * PI * section.bending[0] / length;
    let gap = |elements: usize, order: usize| -> Outcome<f64> {
        let beam = straight(length, elements, order, section)?;
        let last = beam.node_count() - 1;
        let couple = Couple::on(&beam, last, [0.0, 0.0, 1.0]);
        let mut model = Model::default();
        add_beam(&mut model, &beam, &[0]);
        model.parts.push(Box::new(couple.clone()));
        let mut run = quasi_static(model, 1.0, f64::from(steps))?;
        for step in 1..=steps {
            couple.set(moment * f64::from(step) / f64::from(steps));
            run.advance()?;
        }
        Ok(apart(place(&run.state().q, beam.node_vectors(last)[0]), [0.0; 3]) / length)
    };
    for (of, [coarse, fine], least) in
        [(1, [40, 80], MESH_ORDER[0]), (2, [10, 20], MESH_ORDER[1]), (3, [8, 16], MESH_ORDER[1])]
    {
        let off = ("gap of the ends over the length", [gap(coarse, of)?, gap(fine, of)?]);
        order_in_mesh(findings, case, of, off, [coarse, fine], least);
    }
    Ok(())
}

/// The 45-degree bend of Bathe and Bolourchi (Int. J. Numer. Meth. Engng 14 (1979) 961).
fn bend(findings: &mut Findings) -> Outcome<()> {
    let case = "45-degree bend";
    let g = 1e7 / 2.0;
    let section = Section {
        axial: 1e7,
        shear: [g * 5.0 / 6.0; 2],
        bending: [1e7 / 12.0; 2],
        torsion: 1e7 / 12.0,
        mass: 0.0,
        rotary: [0.0; 2],
    };
    let tip = |elements: usize, order: usize| -> Outcome<[f64; 3]> {
        let axis = BeamAxis::arc([100.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, -1.0], PI / 4.0, elements, order)?;
        let beam = Beam::new("bend", 0, axis, section)?;
        let tip = beam.node_vectors(beam.node_count() - 1)[0];
        let mut model = Model::default();
        add_beam(&mut model, &beam, &[0]);
        add_force(&mut model, tip, [0.0, 0.0, 600.0], &[[0.0, 0.0], [1.0, 1.0]])?;
        let mut run = quasi_static(model, 0.125, 1.0)?;
        follow(&mut run, |_, _| {})?;
        Ok(place(&run.state().q, tip))
    };
    let eight = tip(8, 2)?;
    let cited: [(&str, [f64; 3], f64); 2] = [
        ("Bathe and Bolourchi", [15.9, 47.2, 53.4], 0.5),
        // Comput. Meth. Appl. Mech. Engng 58 (1986) 79, eight straight elements.
        ("Simo and Vu-Quoc", [15.79, 47.23, 53.37], 0.4),
    ];
    for (name, place, bound) in cited {
        let note = format!("8 elements of order 2: {eight:.3?}, cited {place:?}, which is of 8 straight elements");
        noted(
            findings,
            case,
            &format!("distance of the tip from {name}"),
            apart(eight, place),
            Bound::AtMost(bound),
            note,
        );
    }
    let arc = CurvedCantilever { stiffness: section.stiffness(), radius: 100.0, angle: PI / 4.0 };
    let exact = arc.tip(600.0).ok_or("the shooting does not converge")?;
    let errors = [apart(tip(4, 2)?, exact), apart(eight, exact)];
    let fine = apart(tip(16, 2)?, exact);
    let note = format!(
        "errors {:.2e}, {:.2e}, {fine:.2e} with 4, 8, 16 elements of order 2; the rod integrated by itself has its tip at {exact:.4?}",
        errors[0], errors[1]
    );
    noted(findings, case, "order in the mesh", order(errors), Bound::AtLeast(MESH_ORDER[1]), note);
    noted(
        findings,
        case,
        "distance of the tip from the rod's, 16 elements",
        fine,
        Bound::AtMost(1e-3),
        "1e-5 of the radius",
    );
    // Documentation of kynema, testing/curved.rst: displacements (-23.64597, 13.72080, 53.57763) of one spectral element with 9 nodes.
    let corner = 50.0 * 2.0_f64.sqrt();
    let spectral = [100.0 - corner - 13.720_80, corner - 23.645_97, 53.577_63];
    let note = "their strain measures of the curved axis are others; 0.2 % of the displacement";
    noted(
        findings,
        case,
        "distance of the tip from the spectral element of kynema",
        apart(eight, spectral),
        Bound::Unbounded,
        note,
    );
    Ok(())
}

/// A small force at the tip, with shear.
fn tip_force(findings: &mut Findings) -> Outcome<()> {
    let case = "cantilever with shear";
    let section =
        Section::rectangle([0.3, 0.5], SectionMaterial { young: 1000.0, poisson: 0.3, density: 0.0 }, 5.0 / 6.0, None)?;
    let (length, force) = (2.0, 1e-6);
    let exact = cantilever(force, length, section.bending[1], section.shear[0]);
    let error = |elements: usize, order: usize| -> Outcome<f64> {
        let beam = straight(length, elements, order, section)?;
        let tip = beam.node_vectors(beam.node_count() - 1)[0];
        let mut model = Model::default();
        add_beam(&mut model, &beam, &[0]);
        add_force(&mut model, tip, [0.0, force, 0.0], &[[0.0, 0.0], [1.0, 1.0]])?;
        let mut run = quasi_static(model, 1.0, 1.0)?;
        run.advance()?;
        Ok((place(&run.state().q, tip)[1] / exact - 1.0).abs())
    };
    let errors = [error(4, 1)?, error(8, 1)?];
    let note = format!("errors {:.2e}, {:.2e} with 4 and 8 elements", errors[0], errors[1]);
    noted(findings, case, "order in the mesh, elements of order 1", order(errors), Bound::AtLeast(MESH_ORDER[0]), note);
    for of in [2, 3] {
        // Cubic deflection and linear curvature are in the space of these elements.
        noted(
            findings,
            case,
            &format!("relative error of 2 elements of order {of}"),
            error(2, of)?,
            Bound::AtMost(1e-8),
            "exact but for round-off",
        );
    }
    Ok(())
}

/// The load at which a clamped column has no stiffness across: zero of the force over the deflection, extrapolated from two loads below.
fn buckling(findings: &mut Findings) -> Outcome<()> {
    let case = "buckling of a column";
    let section = Section { axial: 2e3, shear: [8e2; 2], bending: [1.0; 2], torsion: 1.0, mass: 0.0, rotary: [0.0; 2] };
    let length = 1.0;
    let exact = buckling_load(length, 1.0, section.axial, section.shear[0]);
    let stiffness = |share: f64, elements: usize| -> Outcome<f64> {
        let beam = straight(length, elements, 2, section)?;
        let tip = beam.node_vectors(beam.node_count() - 1)[0];
        let mut model = Model::default();
        add_beam(&mut model, &beam, &[0]);
        let across = 1e-8;
        add_force(&mut model, tip, [-share * exact, across, 0.0], &[[0.0, 0.0], [1.0, 1.0]])?;
        let mut run = quasi_static(model, 0.25, 1.0)?;
        follow(&mut run, |_, _| {})?;
        Ok(across / place(&run.state().q, tip)[1])
    };
    let load = |elements: usize| -> Outcome<f64> {
        let (a, b) = (stiffness(0.98, elements)?, stiffness(0.99, elements)?);
        Ok(0.99 + 0.01 * b / (a - b))
    };
    let (coarse, fine) = (load(4)?, load(8)?);
    let note = format!(
        "4 elements {:.2e}, 8 elements {:.2e}; Euler's load without shear and compression is {:.4} of it",
        coarse - 1.0,
        fine - 1.0,
        euler_load(length, 1.0) / exact
    );
    // The stiffness is a straight line but for the square of the distance from the load, 1e-4, and that little.
    noted(
        findings,
        case,
        "load over the closed form with shear and compression, less one",
        (fine - 1.0).abs(),
        Bound::AtMost(1e-4),
        note,
    );
    Ok(())
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
    let (ground, own) = (Frame::ground([0.0; 3], ABOUT_Z), beam_frame(&beam, 0, ABOUT_Z));
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
    noted(findings, case, "order in the mesh", order([coarse, fine]), Bound::AtLeast(MESH_ORDER[1]), note);
    Ok(())
}
