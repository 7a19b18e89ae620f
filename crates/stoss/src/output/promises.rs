//! What scheme, loads, supports and contacts of a scene together promise of momenta and energy.

use crate::scene::{Constraint, Contact, Integrals, Mass, Scene, split_set};
use stoss_integrators::Scheme;
use stoss_solver::{LoadKind, Model, Simulation};
use stoss_watch::{ClosingJudgement, Promises};

/// Part of its scale that a conserved quantity may be off: sums of what iterations leave over long runs are far below.
const TOLERANCE: f64 = 1e-7;

/// The directions in which supports and loads act.
fn driven(model: &Model) -> [bool; 3] {
    let mut driven = [false; 3];
    for component in model.prescriptions.iter().flat_map(|prescription| &prescription.components) {
        driven[usize::from(*component)] = true;
    }
    for load in &model.loads {
        for (driven, acts) in driven.iter_mut().zip(load.directions()) {
            *driven |= acts;
        }
    }
    driven
}

/// Whether nothing that acts between the bodies takes linear momentum, or angular momentum: what is joined to the ground gives it a part.
fn kept(model: &Model) -> [bool; 2] {
    let (pairs, parts) = (|| model.contacts.iter().map(|pair| &pair.term), || model.parts.iter());
    [
        pairs().all(|method| method.conserves_linear_momentum())
            && parts().all(|part| part.conserves_linear_momentum()),
        pairs().all(|method| method.conserves_angular_momentum())
            && parts().all(|part| part.conserves_angular_momentum()),
    ]
}

/// Whether a load is a moment, which changes angular momentum only.
fn turned(model: &Model) -> bool {
    model.loads.iter().any(|load| matches!(load.kind, LoadKind::Moment { .. }))
}

/// Whether a body has mass-proportional damping, which resists all motions.
fn slowed(model: &Model) -> bool {
    model.bodies.iter().any(|body| body.damping.mass > 0.0)
}

/// Which losses at closing gaps are judged: those under schemes of the second order, whose own losses go with the square of the step size, while those at closing gaps do not. A scheme of the
/// first order is there to take energy. The nodes of strings and beams carry the mass of their neighbours with them under every scheme.
fn closing(scene: &Scene, order: u32) -> ClosingJudgement {
    let is_line = |set: &str| {
        let part = split_set(set).map_or(set, |(part, _)| part);
        scene.strings.iter().any(|line| line.name == part && line.mass_matrix == Mass::Consistent)
            || scene.beams.iter().any(|line| line.name == part)
    };
    if scene.contacts.iter().any(|contact| contact.surfaces().into_iter().any(is_line)) {
        return ClosingJudgement::Lines;
    }
    if order >= 2 { ClosingJudgement::Surfaces } else { ClosingJudgement::Unjudged }
}

/// The promises of a run, or stage, with this scheme; none in statics, where there is neither momentum nor kinetic energy.
pub(crate) fn promises(scene: &Scene, simulation: &Simulation, scheme: Option<&dyn Scheme>) -> Option<Promises> {
    let scheme = scheme?;
    let (claims, model) = (scheme.claims(), simulation.model());
    let driven = driven(model);
    let [keeps_linear, keeps_angular] = kept(model).map(|keeps| keeps && !slowed(model));
    let mut inclined = scene.prescriptions.iter().filter(|item| item.is_inclined());
    let moved = model.prescriptions.iter().any(stoss_solver::Prescription::moves)
        || scene.equations.iter().any(crate::scene::Equation::moves)
        || inclined.any(|item| item.rows().iter().any(|row| row[1] != item.rows()[0][1]));
    let gives_nothing = |contact: &Contact| match contact.method.integrates {
        true => contact.integrals != Some(Integrals::Frozen),
        false => contact.constraint == Some(Constraint::Modified),
    };
    let is_free = driven == [false; 3] && !turned(model) && keeps_linear && keeps_angular;
    Some(Promises {
        linear: driven.map(|driven| claims.linear_momentum && keeps_linear && !driven),
        angular: claims.angular_momentum && is_free,
        is_free,
        energy: claims.energy,
        autonomous: !moved && model.loads.iter().all(stoss_solver::Load::is_conservative),
        closing: closing(scene, claims.order),
        contact_gives_nothing: claims.energy && scene.contacts.iter().all(gives_nothing),
        // A user who asks for less gets less.
        tolerance: TOLERANCE.max(100.0 * scene.solver.relative_tolerance.unwrap_or(0.0)),
    })
}

/// Why there is no drift of linear momentum, angular momentum and energy to report.
pub(crate) fn changed_by(scene: &Scene, model: &Model) -> [Option<String>; 3] {
    if !scene.is_dynamic() {
        let statics = || Some("a quasi-static run has no momenta, and loads and supports do work".to_owned());
        return [statics(), statics(), statics()];
    }
    let axes: Vec<&str> =
        ["x", "y", "z"].into_iter().zip(driven(model)).filter(|(_, on)| *on).map(|(a, _)| a).collect();
    let [keeps_linear, keeps_angular] = kept(model);
    let ground = || {
        let equations = if scene.equations.is_empty() { "" } else { ", or an equation between displacements," };
        Some(format!("what is joined to the ground{equations} changes it"))
    };
    if !keeps_linear {
        return [ground(), ground(), None];
    }
    if slowed(model) {
        let slowed = || Some("mass-proportional damping changes it".to_owned());
        return [slowed(), slowed(), None];
    }
    if axes.is_empty() {
        let turned = turned(model).then(|| "moments change it".to_owned());
        return [None, turned.or_else(|| ground().filter(|_| !keeps_angular)), None];
    }
    let linear = format!("loads or supports change it along {}", axes.join(", "));
    [Some(linear), Some("loads or supports change it".to_owned()), None]
}
