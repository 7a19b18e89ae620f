//! What a scene asks for, and what its run allocated and called.

use super::acting::Acting;
use super::comparison::{Comparison, Item, NONE, compare, flags};
use crate::workspace::Outcome;
use stoss_integrators::{ForceRule, GradientRule, entry};
use stoss_scene::{LoadKind, MeshSource, Scene};
use stoss_solver::{PhaseTime, Simulation};

/// Everything that a run may or may not have. Asked for and found are both of this type, so that they can be compared
/// one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Inventory {
    /// Matrices and vectors.
    pub allocated: Allocated,
    /// Phases and kernels.
    pub called: Called,
}

/// Matrices and vectors that only some scenes need.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Allocated {
    /// Consistent or lumped masses and their matrix.
    pub mass_matrix: bool,
    /// Solver of equations with the mass alone: initial accelerations, velocities from momenta.
    pub mass_solver: bool,
    /// Accelerations in the state.
    pub accelerations: bool,
    /// Forces of the last end point in the state.
    pub history: bool,
    /// Bounding-volume tree and pairings.
    pub search_tree: bool,
    /// Unknown pressures.
    pub pressures: bool,
    /// Matrix with pressure rows beside that of the solids.
    pub contact_matrix: bool,
    /// Nodal contact forces.
    pub contact_force: bool,
    /// Support forces.
    pub reactions: bool,
    /// Vector of dead loads.
    pub dead_loads: bool,
    /// Vector of follower pressures.
    pub follower_pressure: bool,
}

/// Phases that were entered and the kernels in them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Called {
    /// Search and pairing.
    pub search: bool,
    /// Assembly.
    pub assembly: bool,
    /// Factorisation.
    pub factorisation: bool,
    /// Triangular solves.
    pub solve: bool,
    /// Output.
    pub output: bool,
    /// Configuration at which the stress of the solids is taken.
    pub stress: String,
    /// Rule of the contact gradient, of steps in which a constraint was active.
    pub contact: String,
}

impl Allocated {
    fn items(self) -> Vec<Item> {
        let Self { mass_matrix, mass_solver, accelerations, history, search_tree, .. } = self;
        let Self { pressures, contact_matrix, contact_force, reactions, dead_loads, follower_pressure, .. } = self;
        flags(&[
            ("mass matrix", mass_matrix),
            ("mass solver", mass_solver),
            ("accelerations", accelerations),
            ("force history", history),
            ("search tree", search_tree),
            ("pressures", pressures),
            ("contact matrix", contact_matrix),
            ("contact force", contact_force),
            ("reactions", reactions),
            ("dead loads", dead_loads),
            ("follower pressure", follower_pressure),
        ])
    }
}

impl Called {
    fn items(&self) -> Vec<Item> {
        let Self { search, assembly, factorisation, solve, output, .. } = *self;
        let mut items = flags(&[
            ("search", search),
            ("assembly", assembly),
            ("factorisation", factorisation),
            ("solve", solve),
            ("output", output),
        ]);
        items.push(("stress", self.stress.clone()));
        items.push(("contact gradient", self.contact.clone()));
        items
    }
}

impl Inventory {
    /// Structures and calls against those that were asked for.
    pub fn against(&self, asked: &Self) -> [Comparison; 2] {
        [
            compare(&asked.allocated.items(), &self.allocated.items()),
            compare(&asked.called.items(), &self.called.items()),
        ]
    }
}

/// When a scheme keeps forces of the last end point.
#[derive(Clone, Copy, Debug, PartialEq)]
enum History {
    Never,
    Always,
    /// Constraint forces only.
    WithContact,
}

/// What a scheme asks for: theory/integrators#schemes, written down here once more. The rules of the crate `integrators` are what
/// is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SchemeNeeds {
    stress: ForceRule,
    contact: GradientRule,
    accelerations: bool,
    history: History,
    mass_solver: bool,
    /// New positions are not known beforehand.
    equations: bool,
}

/// Needs of a scheme by name, with a look-up of its parameters; `None` for a scheme that is not listed here yet.
fn scheme_needs(name: &str, parameter: impl Fn(&str) -> f64) -> Option<SchemeNeeds> {
    let at = |theta| ForceRule::Configuration { theta };
    let plain = |stress, contact| SchemeNeeds {
        stress,
        contact,
        accelerations: false,
        history: History::Never,
        mass_solver: false,
        equations: true,
    };
    // Of generalised-alpha: forces at n + 1 - alpha_f, constraint forces averaged with the old ones.
    let alpha = |alpha_f: f64| SchemeNeeds {
        accelerations: true,
        history: if alpha_f == 0.0 { History::Never } else { History::WithContact },
        // The initial acceleration.
        mass_solver: true,
        ..plain(at(1.0 - alpha_f), GradientRule::EndPoint)
    };
    Some(match name {
        "energy-momentum" => plain(ForceRule::DiscreteGradient, GradientRule::DiscreteGradient),
        "midpoint" => plain(at(0.5), GradientRule::Midpoint),
        // Velocities come from momenta.
        "variational-midpoint" => {
            SchemeNeeds { mass_solver: true, ..plain(at(parameter("alpha")), GradientRule::StartPoint) }
        }
        "forward-euler" => {
            SchemeNeeds { mass_solver: true, equations: false, ..plain(at(0.0), GradientRule::StartPoint) }
        }
        "trapezoidal" => SchemeNeeds { history: History::Always, ..plain(at(1.0), GradientRule::EndPointMean) },
        "backward-euler" => plain(at(1.0), GradientRule::EndPoint),
        "generalised-alpha" => alpha(parameter("rho_inf") / (1.0 + parameter("rho_inf"))),
        "hht" => alpha((1.0 - parameter("rho_inf")) / (1.0 + parameter("rho_inf"))),
        "wbz" | "newmark" => alpha(0.0),
        _ => return None,
    })
}

fn stress_words(rule: ForceRule) -> String {
    match rule {
        ForceRule::Configuration { theta } => format!("at n + {}", (1e4 * theta).round() / 1e4),
        ForceRule::DiscreteGradient => "by discrete gradient".to_owned(),
    }
}

fn contact_words(rule: GradientRule) -> String {
    format!("{rule:?}")
}

/// What a scene asks for.
pub fn asked(scene: &Scene) -> Outcome<Inventory> {
    let first = scene.stages.first();
    let integrator = first.and_then(|stage| stage.integrator.as_ref()).or(scene.time.integrator.as_ref());
    let begins_dynamic = first.map_or(scene.header.kind, |stage| stage.kind) == stoss_scene::Kind::Dynamic;
    let needs = match integrator.filter(|_| begins_dynamic) {
        Some(integrator) => {
            let parameter = |name: &str| {
                let default = || entry(&integrator.scheme)?.parameters.iter().find(|p| p.name == name);
                let given = integrator.parameters.get(name).copied();
                given.or_else(|| default().map(|p| p.default)).unwrap_or(f64::NAN)
            };
            let unknown = || {
                format!(
                    "what {} needs is not listed in crates/verification/src/verify/lean/parts.rs",
                    integrator.scheme
                )
            };
            scheme_needs(&integrator.scheme, parameter).ok_or_else(unknown)?
        }
        None => SchemeNeeds {
            stress: ForceRule::END_POINT,
            contact: GradientRule::EndPoint,
            accelerations: false,
            history: History::Never,
            mass_solver: false,
            equations: true,
        },
    };
    let acting = Acting::asked(scene);
    let contact = acting.unilateral;
    let couples = contact || acting.general || acting.bilateral;
    let follower =
        |load: &stoss_scene::Load| matches!(load.kind(), Some((LoadKind::FollowerPressure | LoadKind::Moment, _)));
    let allocated = Allocated {
        mass_matrix: scene.is_dynamic(),
        mass_solver: needs.mass_solver,
        accelerations: needs.accelerations,
        history: needs.history == History::Always || (contact && needs.history == History::WithContact),
        search_tree: contact,
        pressures: contact || acting.bilateral,
        contact_matrix: couples,
        contact_force: couples,
        reactions: !scene.prescriptions.is_empty(),
        dead_loads: scene.gravity.is_some() || scene.loads.iter().any(|load| !follower(load)),
        follower_pressure: scene.loads.iter().any(follower),
    };
    let called = Called {
        // Ties search once.
        search: couples,
        assembly: true,
        factorisation: needs.equations,
        solve: needs.equations,
        // Nobody asked for files.
        output: false,
        stress: stress_words(needs.stress),
        contact: if contact { contact_words(needs.contact) } else { NONE.to_owned() },
    };
    Ok(Inventory { allocated, called })
}

/// Features of the facade without which the scene does not run.
pub fn features(scene: &Scene) -> Vec<&'static str> {
    let from_file = scene.bodies.iter().any(|body| matches!(body.mesh, MeshSource::File(_)));
    let mortar = |contact: &stoss_scene::Contact| contact.method.integrates;
    let acting = Acting::asked(scene);
    let multibody =
        acting.parts || !scene.joints.is_empty() || !scene.couplings.is_empty() || !scene.equations.is_empty();
    let wanted = [
        ("scene", true),
        ("nts", scene.contacts.iter().any(|contact| !mortar(contact))),
        ("mortar", !scene.ties.is_empty() || scene.contacts.iter().any(mortar)),
        ("general", acting.general),
        ("multibody", multibody),
        ("mesh-files", from_file),
    ];
    wanted.iter().filter(|(_, wanted)| *wanted).map(|(feature, _)| *feature).collect()
}

/// What a simulation has and did; `active`: a constraint was active in some step.
pub fn found(simulation: &Simulation, active: bool) -> Inventory {
    let (plan, timings) = (simulation.plan(), simulation.timings());
    let entered = |phase: PhaseTime| phase.calls > 0;
    Inventory {
        allocated: Allocated {
            mass_matrix: plan.mass_matrix,
            mass_solver: plan.mass_solver,
            accelerations: plan.accelerations,
            history: plan.history,
            search_tree: plan.contact_search,
            pressures: plan.slots > 0,
            contact_matrix: plan.contact_matrix,
            contact_force: plan.contact_force,
            reactions: plan.reactions,
            dead_loads: plan.dead_loads,
            follower_pressure: plan.follower_pressure,
        },
        called: Called {
            search: entered(timings.search),
            assembly: entered(timings.assembly),
            factorisation: entered(timings.factorisation),
            solve: entered(timings.solve),
            output: entered(timings.output),
            stress: stress_words(plan.rule.force.rule),
            contact: if active { contact_words(plan.rule.constraint.rule) } else { NONE.to_owned() },
        },
    }
}

/// How often search, assembly, factorisation and solve were entered.
pub fn calls(simulation: &Simulation) -> [u64; 4] {
    let timings = simulation.timings();
    [timings.search, timings.assembly, timings.factorisation, timings.solve].map(|phase| phase.calls)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(text: &str) -> Scene {
        let start = "[scene]\ntitle = \"t\"\nkind = ";
        let body = "[[body]]\nname = \"a\"\nmesh = { generator = \"block\", size = [1, 1, 1], divisions = [1, 1, 1] }\n\
                    material = { law = \"neo-hooke\", young = 1, poisson = 0 }\ndensity = 1\n";
        let second = body.replace("\"a\"", "\"b\"");
        // Two bodies are in general contact if nothing is said.
        let apart = "[general_contact]\nenabled = false\n";
        stoss_scene::parse(&format!("{start}{text}\n{body}{second}{apart}"), "t").unwrap()
    }

    fn dynamic(integrator: &str, rest: &str) -> Inventory {
        let time = format!("[time]\nend = 1.0\nstep = 0.1\nintegrator = {{ {integrator} }}\n");
        asked(&scene(&format!("\"dynamic\"\n{time}{rest}"))).unwrap()
    }

    const CONTACT: &str = "[[contact]]\nmethod = \"nts\"\nslave = \"a.top\"\nmaster = \"b.bottom\"";

    #[test]
    fn a_static_scene_asks_for_no_mass_and_end_point_forces() {
        let text = "\"quasi-static\"\n[time]\nend = 1.0\nstep = 0.1\n";
        let support = "[[prescribe]]\nset = \"a.top\"\ncomponents = [\"x\"]\nfixed = true";
        let parts = asked(&scene(&format!("{text}{support}"))).unwrap();
        assert_eq!(parts.allocated, Allocated { reactions: true, ..Allocated::default() });
        assert_eq!((parts.called.stress.as_str(), parts.called.contact.as_str()), ("at n + 1", "none"));
    }

    #[test]
    fn schemes_ask_for_what_they_carry() {
        let free = dynamic("scheme = \"generalised-alpha\", rho_inf = 1.0", "");
        let expected = Allocated { mass_matrix: true, mass_solver: true, accelerations: true, ..Allocated::default() };
        assert_eq!(free.allocated, expected);
        // alpha_f = 1/2.
        assert_eq!(free.called.stress, "at n + 0.5");
        let touching = dynamic("scheme = \"generalised-alpha\", rho_inf = 1.0", CONTACT);
        assert!(touching.allocated.history && touching.allocated.pressures && touching.called.search);
        assert!(!dynamic("scheme = \"newmark\"", CONTACT).allocated.history);
        assert!(dynamic("scheme = \"trapezoidal\"", "").allocated.history);
        let plain = dynamic("scheme = \"energy-momentum\"", "");
        assert_eq!(plain.allocated, Allocated { mass_matrix: true, ..Allocated::default() });
    }

    #[test]
    fn loads_ask_for_their_vectors() {
        let load = |kind: &str| format!("[[load]]\nset = \"a.top\"\n{kind} = 1.0");
        let dead = dynamic("scheme = \"midpoint\"", &load("pressure")).allocated;
        assert!(dead.dead_loads && !dead.follower_pressure);
        let follower = dynamic("scheme = \"midpoint\"", &load("follower_pressure")).allocated;
        assert!(!follower.dead_loads && follower.follower_pressure);
    }

    #[test]
    fn every_scheme_is_listed() {
        for entry in stoss_integrators::SCHEMES {
            assert!(scheme_needs(entry.name, |_| 0.5).is_some(), "{}", entry.name);
        }
        assert!(scheme_needs("leapfrog", |_| 0.5).is_none());
    }

    #[test]
    fn features_follow_from_contact_and_mesh_files() {
        let time = "\"dynamic\"\n[time]\nend = 1.0\nstep = 0.1\nintegrator = { scheme = \"midpoint\" }\n";
        assert_eq!(features(&scene(time)), ["scene"]);
        assert_eq!(features(&scene(&format!("{time}{CONTACT}"))), ["scene", "nts"]);
        let text = scene(time).text().replacen("mesh = { generator", "mesh = { file = \"a.msh\" } # {", 1);
        assert_eq!(features(&stoss_scene::parse(&text, "t").unwrap()), ["scene", "mesh-files"]);
    }

    #[test]
    fn deviations_name_the_item_and_its_direction() {
        let asked = Inventory {
            allocated: Allocated { mass_matrix: true, ..Allocated::default() },
            called: Called { stress: "at n + 1".into(), contact: NONE.into(), ..Called::default() },
        };
        let found = Inventory {
            allocated: Allocated { reactions: true, ..Allocated::default() },
            called: Called { stress: "at n + 0.5".into(), contact: "EndPoint".into(), ..Called::default() },
        };
        let [allocated, called] = found.against(&asked);
        assert_eq!(allocated.deviations, ["missing: mass matrix", "unused: reactions"]);
        assert_eq!(allocated.words, "reactions");
        assert_eq!(called.deviations, ["stress at n + 0.5 instead of at n + 1", "unused: contact gradient EndPoint"]);
        assert!(asked.against(&asked).iter().all(|comparison| comparison.deviations.is_empty()));
    }
}
