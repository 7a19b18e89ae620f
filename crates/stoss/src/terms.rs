//! Names of all that makes forces, and the columns of its energies: `terms.csv`.

use stoss_continuum::Mechanisms;
use stoss_solver::{Books, LoadKind, Posting, Simulation};

/// What a group of columns belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    Inertia,
    Body(usize),
    Part(usize),
    Load(usize),
    Coupling(usize),
    Supports,
    Stabilisation,
}

impl Of {
    /// What it is, for names that occur twice.
    fn kind(self) -> String {
        match self {
            Self::Inertia | Self::Supports | Self::Stabilisation => "all".to_owned(),
            Self::Body(b) => format!("body {b}"),
            Self::Part(p) => format!("part {p}"),
            Self::Load(l) => format!("load {l}"),
            Self::Coupling(c) => format!("contact or joint {c}"),
        }
    }
}

/// A number of a posting.
type Entry = (&'static str, fn(&Posting) -> f64);

const STORED: Entry = ("stored", |of| of.stored);
const DISSIPATED: Entry = ("dissipated", |of| of.dissipated);
const SUPPLIED: Entry = ("supplied", |of| of.supplied);
const REMAINDER: Entry = ("remainder", |of| of.remainder);

const PLASTIC: Entry = ("plastic_loss", |of| of.material.plastic);
const HARDENING: Entry = ("hardening", |of| of.material.hardening);
const VISCOUS: Entry = ("viscous_loss", |of| of.material.viscous);
const SOFTENING: Entry = ("softening_loss", |of| of.material.softening);

/// The columns of the table, by groups: only those that can be other than zero.
#[derive(Debug)]
pub(crate) struct Terms {
    groups: Vec<(Of, String, Vec<Entry>)>,
}

impl Terms {
    /// `bodies` are the names of the bodies.
    pub fn new(bodies: &[String], is_stabilised: bool, simulation: &Simulation) -> Self {
        let model = simulation.model();
        let mut groups = Vec::new();
        if simulation.plan().mass_matrix {
            groups.push((Of::Inertia, "inertia".to_owned(), vec![STORED, REMAINDER]));
        }
        for (b, body) in model.bodies.iter().enumerate() {
            let Mechanisms { plastic, viscous, softening } = body.solid.mechanisms();
            let damped = (body.damping.acts() || plastic || viscous || softening).then_some(DISSIPATED);
            let material = [(plastic, PLASTIC), (plastic, HARDENING), (viscous, VISCOUS), (softening, SOFTENING)];
            let material = material.into_iter().filter(|(has, _)| *has).map(|(_, entry)| entry);
            let columns = [STORED].into_iter().chain(damped).chain([REMAINDER]).chain(material).collect();
            groups.push((Of::Body(b), bodies.get(b).cloned().unwrap_or_default(), columns));
        }
        for (p, part) in model.parts.iter().enumerate() {
            let mut has_forces = false;
            part.stencils(&[], &mut |_, _| has_forces = true);
            if has_forces {
                groups.push((Of::Part(p), part.name().to_owned(), vec![STORED, DISSIPATED, REMAINDER]));
            }
        }
        for (l, load) in model.loads.iter().enumerate() {
            let is_nothing = |patterns: &[Vec<(u32, f64)>]| patterns.iter().all(Vec::is_empty);
            if !matches!(&load.kind, LoadKind::Dead { patterns } if is_nothing(patterns)) {
                groups.push((Of::Load(l), load.name.clone(), vec![SUPPLIED]));
            }
        }
        for (c, pair) in model.contacts.iter().enumerate() {
            groups.push((Of::Coupling(c), pair.name.clone(), vec![STORED, DISSIPATED, SUPPLIED, REMAINDER]));
        }
        if !model.prescriptions.is_empty() {
            groups.push((Of::Supports, "supports".to_owned(), vec![SUPPLIED]));
        }
        if is_stabilised {
            groups.push((Of::Stabilisation, "stabilisation".to_owned(), vec![DISSIPATED]));
        }
        // Of a name that occurs twice the second one has its kind behind it.
        let mut taken = std::collections::BTreeSet::new();
        for (of, name, _) in &mut groups {
            if !taken.insert(name.clone()) {
                *name = format!("{name} ({})", of.kind());
                taken.insert(name.clone());
            }
        }
        Self { groups }
    }

    /// The header of the table.
    pub fn header(&self) -> String {
        let columns = self.groups.iter().flat_map(|(_, name, entries)| {
            entries.iter().map(move |(entry, _)| format!("{}.{entry}", name.replace(',', " ")))
        });
        ["step".to_owned(), "time".to_owned()].into_iter().chain(columns).collect::<Vec<_>>().join(",")
    }

    /// Names of the terms and their postings.
    pub fn of<'a>(&'a self, books: &'a Books) -> impl Iterator<Item = (&'a str, Posting)> {
        self.groups.iter().map(|(of, name, _)| (name.as_str(), posting(*of, books)))
    }

    /// The numbers of a step, a column each.
    pub fn values<'a>(&'a self, books: &'a Books) -> impl Iterator<Item = f64> + 'a {
        self.groups.iter().flat_map(|(of, _, entries)| {
            let posting = posting(*of, books);
            entries.iter().map(move |(_, value)| value(&posting))
        })
    }
}

fn posting(of: Of, books: &Books) -> Posting {
    let posting = match of {
        Of::Inertia => Some(&books.inertia),
        Of::Body(b) => books.bodies.get(b),
        Of::Part(p) => books.parts.get(p),
        Of::Load(l) => books.loads.get(l),
        Of::Coupling(c) => books.couplings.get(c),
        Of::Supports => Some(&books.supports),
        Of::Stabilisation => Some(&books.stabilisation),
    };
    posting.copied().unwrap_or_default()
}
