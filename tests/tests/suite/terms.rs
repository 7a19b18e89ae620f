//! Every term of shipped scenes through the trait alone: tangents, promises, work, histories. A new kind of term is tested by being in one of these scenes.

use crate::support::simulation;
use stoss::integrators::{ForceRule, GradientRule};
use stoss::solver::{Model, Simulation};
use stoss::term::check::{self, Derivative};
use stoss::term::{At, Rule, SlotKind, StepContext, Term};

/// Scenes, and steps after which their terms are looked at.
const SCENES: [(&str, usize); 15] = [
    ("ball-plate", 16),
    ("block-impact-mortar", 12),
    ("general-chain", 4),
    ("general-contact", 30),
    ("incline", 2),
    ("necking-bar", 30),
    ("resting-block", 3),
    ("slide", 3),
    ("tied-cantilever", 2),
    ("tori-friction-03", 2),
    ("trebuchet", 20),
    ("trebuchet-event", 3),
    ("two-blocks-cat", 34),
    ("two-blocks-cat-full", 34),
    ("two-blocks-friction", 34),
];

/// Bodies of more elements are left out.
const MOST_ELEMENTS: usize = 400;

fn shipped(name: &str) -> Simulation {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).with_extension("toml");
    simulation(&std::fs::read_to_string(path).unwrap())
}

/// A term where a run is, and a motion from there.
struct Case<'a> {
    name: String,
    term: &'a mut dyn Term,
    q_n: &'a [f64],
    q_np1: &'a [f64],
    multipliers: Vec<f64>,
    auxiliaries: Vec<f64>,
    active: Vec<bool>,
    length: f64,
    dt: f64,
}

/// Number of derivatives that were taken and of those that a kink stood in the way of.
#[derive(Debug, Default)]
struct Count {
    made: usize,
    bent: usize,
    /// Terms under a rule that do something, and those whose history changes when the step is accepted.
    acting: usize,
    changed: usize,
    /// Terms of which more than one rank of three evaluates contributions.
    shared: usize,
}

impl Case<'_> {
    fn at(&self, rule: Rule) -> At<'_> {
        let (multipliers, active) = (&self.multipliers[..], &self.active[..]);
        let at = At::constraint([self.q_n, self.q_np1], GradientRule::EndPoint, multipliers, active);
        At { rule, dt: self.dt, rates: true, auxiliaries: &self.auxiliaries, ..at }
    }

    fn check(&mut self, rule: Rule, is_direction: &(dyn Fn(u32) -> bool + Sync), count: &mut Count) {
        let name = format!("{} {rule:?}", self.name);
        let step = match rule {
            Rule::Force(force) => StepContext { force, ..StepContext::new(self.q_n, GradientRule::EndPoint, self.dt) },
            Rule::Constraint(rule) => StepContext { reach: self.length, ..StepContext::new(self.q_n, rule, self.dt) },
        };
        // A rule that a method does not have.
        if self.term.begin(&step).is_err() {
            return;
        }
        if rule.constraint().is_some()
            && let Some(method) = self.term.unilateral_mut()
        {
            method.repair(self.q_np1, &self.active).unwrap();
        }
        self.auxiliaries = vec![0.0; self.term.slot_count() * self.term.auxiliaries().len()];
        let mut started = self.auxiliaries.clone();
        self.term.start_auxiliaries(&self.at(rule), &mut started).unwrap();
        self.auxiliaries = started;
        let Self { q_n, q_np1, multipliers, auxiliaries, active, length, dt, .. } = self;
        let of = At::constraint([q_n, q_np1], GradientRule::EndPoint, multipliers, active);
        let at = At { rule, dt: *dt, auxiliaries, ..of };
        let traction = multipliers.iter().fold(1.0, |most: f64, p| most.max(p.abs()));
        // As friction is not available under all rules of its method.
        if self.term.renew(&at, true).and_then(|_| self.term.assemble(&at, false, &mut |_| {})).is_err() {
            return;
        }
        for seed in 0..3 {
            let direction = check::direction(&*self.term, q_n.len() / 3, seed, *length, traction);
            let mut over = |h: f64| check::derivative(&mut *self.term, &at, &direction, h).unwrap();
            let Derivative { mut deviation, kink } = over(1e-6);
            // Round-off of a difference falls with its distance, an error of the tangent does not.
            if deviation >= 2e-6 + kink {
                deviation = over(1e-5).deviation;
            }
            count.made += 1;
            // Where it is bent a difference tells nothing.
            if kink > 1e-4 {
                count.bent += 1;
                continue;
            }
            assert!(deviation < 2e-6 + kink, "{name}: tangent {deviation:.1e}, kink {kink:.1e}");
        }
        let found = check::promises(&mut *self.term, &at, is_direction).unwrap();
        assert!(found.is_pure && found.has_order, "{name}: {found:?}");
        let sharing = check::sharing(&mut *self.term, &at, 3).unwrap();
        let is_contact = self.term.unilateral().is_some() || self.term.potential().is_some();
        assert!(sharing.is_whole, "{name}: {sharing:?}");
        count.shared += usize::from(is_contact && sharing.counts.iter().filter(|&&own| own > 0).count() > 1);
        let is_gradient = check::is_discrete_gradient(rule);
        assert!(!self.term.conserves_linear_momentum() || found.resultant < 1e-11, "{name}: {found:?}");
        let turns =
            is_gradient || matches!(rule, Rule::Constraint(GradientRule::Midpoint) | Rule::Force(ForceRule::MIDPOINT));
        if turns && self.term.conserves_angular_momentum() {
            // Equations between points have a moment as far as they do not hold, so these move rigidly.
            let rigid = turned(q_n, is_direction, *length);
            let q = if self.term.bilateral().is_some() { &rigid[..] } else { at.q_np1 };
            let found = check::promises(&mut *self.term, &At { q_np1: q, ..at }, is_direction).unwrap();
            assert!(found.moment < 1e-10, "{name}: {found:?}");
            self.term.renew(&at, true).unwrap();
        }
        assert!(!self.term.is_symmetric(rule) || found.asymmetry < 1e-10, "{name}: {found:?}");
        // What forces of energies do is what their energies change by, and what dampers take.
        let has_energy = rule.force().is_some() || self.term.potential().is_some() && !self.term.has_friction();
        if is_gradient && has_energy {
            let work = self.term.work(&at).unwrap();
            let change = work.stored - self.term.energy(q_n).unwrap() + work.dissipated;
            let scale = found.work_scale.max(work.stored.abs());
            assert!((found.work - change).abs() <= 1e-10 * scale, "{name}: {change:e} of {found:?}");
        }
        // What equations do is the change of their functions, times the multipliers.
        if is_gradient && let Some(bilateral) = self.term.bilateral() {
            let slots = 0..active.len();
            let equations: Vec<bool> =
                slots.map(|slot| active[slot] && bilateral.slot_kind(slot) == SlotKind::Equation).collect();
            let rows = |q: &[f64]| {
                let mut sum = 0.0;
                let at = At { q_np1: q, active: &equations, ..at };
                self.term
                    .assemble(&at, false, &mut |local| {
                        let rows = &local.residual[3 * local.nodes.len()..];
                        local.slots.iter().zip(rows).for_each(|(&slot, row)| sum += multipliers[slot as usize] * row);
                    })
                    .unwrap();
                sum
            };
            let (mut work, mut scale) = (0.0, 0.0);
            self.term
                .assemble(&At { active: &equations, ..at }, false, &mut |local| {
                    for (&node, f) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                        for (i, f) in f.iter().enumerate() {
                            let c = 3 * node as usize + i;
                            work += f * (q_np1[c] - q_n[c]);
                            scale += (f * q_np1[c]).abs();
                        }
                    }
                })
                .unwrap();
            // Springs and dampers along what a joint leaves free have no slot.
            let free = self.term.work(&At { active: &equations, ..at }).unwrap();
            let of_free = free.stored - self.term.energy(q_n).unwrap() + free.dissipated;
            let change = rows(q_np1) - rows(q_n) + of_free;
            assert!((work - change).abs() <= 1e-10 * scale, "{name}: {work:e} {change:e} {scale:e}");
        }
        count.acting += usize::from(found.work_scale > 0.0);
        // Histories go on when a step is accepted, and come back.
        let history = self.term.save_history();
        self.term.commit(&at);
        count.changed += usize::from(self.term.save_history() != history);
        self.term.load_history(&history).unwrap();
        assert_eq!(self.term.save_history(), history, "{name}");
    }
}

/// Positions near `q`: rigid parts of a motion would not do, so every component moves by itself.
fn moved(q: &[f64], length: f64) -> Vec<f64> {
    q.iter().enumerate().map(|(k, x)| x + length * (1.7 * k as f64 + 0.3).sin()).collect()
}

/// Positions `q` after a rigid motion, with a translation by `length`.
fn turned(q: &[f64], is_direction: &(dyn Fn(u32) -> bool + Sync), length: f64) -> Vec<f64> {
    let (axis, (sin, cos)) = ([1.0, 2.0, -2.0].map(|n: f64| n / 3.0), 0.05_f64.sin_cos());
    let turn = |x: [f64; 3]| -> [f64; 3] {
        let along: f64 = (0..3).map(|i| axis[i] * x[i]).sum();
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            cos * x[i] + sin * (axis[j] * x[k] - axis[k] * x[j]) + (1.0 - cos) * along * axis[i]
        })
    };
    let by = |node: usize| if is_direction(node as u32) { 0.0 } else { length };
    q.chunks_exact(3).enumerate().flat_map(|(node, x)| turn([x[0], x[1], x[2]]).map(|x| x + by(node))).collect()
}

#[test]
fn terms_keep_what_the_trait_promises() {
    let mut count = Count::default();
    for (name, steps) in SCENES {
        let mut run = shipped(name);
        let mut dt = 0.0;
        for _ in 0..steps {
            dt = run.advance().unwrap_or_else(|e| panic!("{name}: {e}")).dt;
        }
        let q_n = run.state().q.clone();
        let (pressures, active) = (run.pressures().to_vec(), run.active().to_vec());
        let mut model = run.into_model();
        let own: Vec<_> = model.parts.iter().map(|part| part.own_vectors()).collect();
        let directions: Vec<u32> = (model.parts.iter().zip(&own))
            .flat_map(|(part, own)| own.clone().filter(|&v| part.is_direction(v)).collect::<Vec<_>>())
            .collect();
        let is_direction = |node: u32| directions.contains(&node);
        let Model { bodies, parts, contacts, embedding, .. } = &mut model;
        // What a body of many elements does is what one of few does.
        let bodies = bodies.iter_mut().filter(|body| body.solid.element_count() <= MOST_ELEMENTS);
        let bodies = bodies.map(|body| &mut body.solid as &mut dyn Term);
        for term in bodies.chain(parts.iter_mut().map(|part| &mut **part as &mut dyn Term)) {
            let length = 0.01 * term.length_scale();
            let q_np1 = moved(&q_n, length);
            let name = format!("{name}: {}", term.name());
            let empty = (Vec::new(), Vec::new(), Vec::new());
            let (multipliers, auxiliaries, active) = empty;
            let (q_n, q_np1) = (&q_n[..], &q_np1[..]);
            let mut case = Case { name, term, q_n, q_np1, multipliers, auxiliaries, active, length, dt };
            for rule in [ForceRule::START, ForceRule::MIDPOINT, ForceRule::END_POINT, ForceRule::DiscreteGradient] {
                case.check(Rule::Force(rule), &is_direction, &mut count);
            }
        }
        for (c, pair) in contacts.iter_mut().enumerate().filter(|(_, pair)| pair.acts) {
            let length = 1e-3 * pair.term.length_scale();
            let mut q_np1 = moved(&q_n, length);
            embedding.follow(&mut q_np1);
            let (name, term) = (format!("{name}: {}", pair.name), &mut *pair.term);
            let (multipliers, active) = (pressures[c].clone(), active[c].clone());
            let (q_n, q_np1, auxiliaries) = (&q_n[..], &q_np1[..], Vec::new());
            let mut case = Case { name, term, q_n, q_np1, multipliers, auxiliaries, active, length, dt };
            for rule in [
                GradientRule::StartPoint,
                GradientRule::Midpoint,
                GradientRule::EndPoint,
                GradientRule::EndPointMean,
                GradientRule::DiscreteGradient,
            ] {
                case.check(Rule::Constraint(rule), &is_direction, &mut count);
            }
        }
    }
    println!("{count:?}");
    assert!(count.shared > 5, "{count:?}");
    assert!(count.made > 300 && 10 * count.bent < count.made, "{count:?}");
}

/// Which terms there are decides, and not the order in which a scene names them: all of one kind reversed, the motion is the same but for round-off.
#[test]
fn the_order_of_terms_changes_round_off_alone() {
    let block = |name: &str, z: f64, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, {z}], max = [1, 1, {}], divisions = [2, 2, 2] }}\n\
             material = {{ law = \"neo-hooke\", lambda = 400.0, mu = 300.0 }}\ndensity = 1.0\n{more}",
            z + 1.0
        )
    };
    let spring = |name: &str, of: &str, z: f64| {
        format!(
            "[[spring]]\nname = \"{name}\"\nbetween = [\"{of}\", \"ground\"]\nat = [[0.5, 0.5, {z}], [3, 0, {z}]]\nstiffness = 30.0\nrest_length = 2.0\ndamping = 1.0\n"
        )
    };
    let contact = |slave: &str, master: &str| {
        format!(
            "[[contact]]\nmethod = \"mortar\"\nslave = \"{slave}\"\nmaster = \"{master}\"\nfriction = {{ law = \"coulomb\", mu = 0.3 }}\n"
        )
    };
    let kinds = [
        vec![
            block("low", 0.0, ""),
            block("middle", 1.001, "velocity = [0.3, 0, -1]\n"),
            block("high", 2.003, "velocity = [0, 0.2, -2]\n"),
        ],
        ["0, 0, 5", "0.3, 0, 6"].map(|at| format!("[[rigid]]\nname = \"ball at {at}\"\nshape = {{ kind = \"sphere\", radius = 0.3, divisions = 2 }}\ndensity = 1.0\nposition = [{at}]\n").replace("ball at 0, 0, 5", "left").replace("ball at 0.3, 0, 6", "right")).to_vec(),
        vec![spring("one", "left", 5.0), spring("two", "right", 6.0)],
        vec![contact("middle.bottom", "low.top"), contact("high.bottom", "middle.top")],
        ["middle.right", "high.left", "low.top"]
            .map(|set| format!("[[load]]\nset = \"{set}\"\ntraction = {{ table = [[0, 0, 0, 0], [1, 30, 5, 10]] }}\n"))
            .to_vec(),
    ];
    let head = "[scene]\ntitle = \"order\"\nkind = \"dynamic\"\n[time]\nend = 1.0\nstep = 0.002\nintegrator = { scheme = \"energy-momentum\" }\n[gravity]\nacceleration = [0, 0, -1]\n";
    let run = |reversed: bool| {
        let ordered =
            kinds.iter().map(|kind| if reversed { kind.iter().rev().cloned().collect() } else { kind.concat() });
        let mut simulation = simulation(&(head.to_owned() + &ordered.collect::<String>()));
        let mut touched = 0;
        for _ in 0..12 {
            let record = simulation.advance().unwrap_or_else(|e| panic!("{e}"));
            touched += usize::from(record.contact.is_some_and(|contact| contact.active > 0));
        }
        assert!(touched > 3, "{touched}");
        *simulation.balance()
    };
    let (one, other) = (run(false), run(true));
    let scale = one.largest_energy;
    for (a, b) in [(one.kinetic, other.kinetic), (one.strain, other.strain), (one.friction_work, other.friction_work)] {
        assert!((a - b).abs() < 1e-11 * scale, "{a} {b}");
    }
    for (a, b) in one.linear_momentum.iter().zip(other.linear_momentum) {
        assert!((a - b).abs() < 1e-11, "{a} {b}");
    }
}
