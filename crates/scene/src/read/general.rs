//! Reads `[scene]`, `[time]`, `[solver]`.

use super::node::Node;
use super::table::Table;
use crate::{
    Automatic, Component, FORMAT, Factors, Header, InsideOut, Integrator, Kind, LinearSolver, OneOrMany, PlaneSection,
    Solver, Stabilise, Time, Units,
};
use std::collections::BTreeMap;
use stoss_integrators::SCHEMES;
use toml::de::DeValue;

/// `[scene]`; the kind is returned apart, for it is needed even if the title is bad.
pub(super) fn header(table: &Table<'_>) -> (Option<Header>, Option<Kind>) {
    let title = table.required("title", "title = \"Ball on plate\"", Node::text);
    let kind = table.required("kind", "kind = \"dynamic\"", |n| n.choice(Kind::NAMES, Kind::from_name));
    let section = table.optional("section", |n| n.choice(PlaneSection::NAMES, PlaneSection::from_name));
    let symmetry = table.default("symmetry", OneOrMany::default(), |n| {
        let DeValue::Array(_) = n.value else { return Some(OneOrMany::One(component(n)?)) };
        let planes = n.list(component)?;
        if let Some(k) = (1..planes.len()).find(|&k| planes[..k].contains(&planes[k])) {
            return n.fail(format!("has {} twice", planes[k]), "write each plane once");
        }
        Some(OneOrMany::Many(planes))
    });
    let units = table.optional("units", |n| n.choice(Units::NAMES, Units::from_name));
    let format = table.optional("format", |n| {
        let format = n.count()?;
        if format > FORMAT {
            let message = format!("is newer than this program, which reads scenes of the format {FORMAT}");
            return n.fail(message, "use a newer version of Stoss, or write the scene for this format");
        }
        Some(format)
    });
    table.finish();
    let header = (|| {
        Some(Header {
            title: title?,
            kind: kind?,
            section: section?,
            symmetry: symmetry?,
            units: units?,
            format: format?,
        })
    })();
    (header, kind)
}

fn component(n: &Node<'_>) -> Option<Component> {
    n.choice(Component::NAMES, Component::from_name)
}

/// More steps than this are a mistake in `step` or `end`.
pub(super) const MAX_STEPS: f64 = 1e9;

/// The clock has so many ticks in a step at most.
const SMALLEST: f64 = 1e9;

/// `own_schemes`: there are stages, and none of them takes the scheme of `[time]`.
pub(super) fn time(table: &Table<'_>, kind: Option<Kind>, own_schemes: bool) -> Option<Time> {
    let end = table.required("end", "end = 1.0", Node::positive);
    let step = table.required("step", "step = 0.01", Node::positive);
    let integrator = match kind {
        Some(Kind::Dynamic) if !own_schemes => {
            table.required("integrator", "integrator = { scheme = \"energy-momentum\" }", integrator).map(Some)
        }
        Some(Kind::QuasiStatic) if table.has("integrator") => table.fail(
            "integrator",
            "a quasi-static scene has no integrator",
            "remove it, or set [scene] kind = \"dynamic\"",
        ),
        _ => table.optional("integrator", integrator),
    };
    let max_cuts = table.default("max_cuts", Time::DEFAULT_MAX_CUTS, |n| n.whole(0..=30).map(|i| i as u32));
    let grow_after = table.default("grow_after", Time::DEFAULT_GROW_AFTER, Node::count);
    let max_plastic_increment = table.optional("max_plastic_increment", Node::positive);
    let statics = |key| match kind {
        Some(Kind::Dynamic) if table.has(key) => {
            table.fail(key, "is for statics", "remove it, or move it into a static [[stage]]")
        }
        _ => Some(()),
    };
    let automatic = table.optional("automatic", |n| automatic(n, step));
    let stabilise = table.optional("stabilise", stabilise);
    let [chooses, stabilises] = ["automatic", "stabilise"].map(statics);
    for key in ["max_cuts", "grow_after"] {
        if chooses.is_some() && table.has("automatic") && table.has(key) {
            return table.fail(
                key,
                "cannot be combined with `automatic`",
                "remove it; see `smallest` and `after` of `automatic`",
            );
        }
    }
    table.finish();
    let (end, step) = (end?, step?);
    if step > end {
        return table.fail(
            "step",
            format!("must not exceed the end of the run, {end}"),
            "choose a smaller step or a later end",
        );
    }
    if end / step > MAX_STEPS {
        return table.fail("step", format!("gives {:.1e} steps", end / step), "choose a larger step or an earlier end");
    }
    chooses?;
    stabilises?;
    Some(Time {
        end,
        step,
        integrator: integrator?,
        max_cuts: max_cuts?,
        grow_after: grow_after?,
        max_plastic_increment: max_plastic_increment?,
        automatic: automatic?,
        stabilise: stabilise?,
    })
}

/// `step`: the largest increment, if it is known.
pub(super) fn automatic(node: &Node<'_>, step: Option<f64>) -> Option<Automatic> {
    let table = node.table_like("{ initial = 0.01, smallest = 1e-5 }")?;
    let initial = table.required("initial", "initial = 0.01", |n| {
        let initial = n.positive()?;
        match step {
            Some(step) if initial > step * (1.0 + 1e-12) => {
                n.fail(format!("must not exceed the largest increment, `step` = {step}"), "choose a smaller one")
            }
            Some(step) if step / initial > SMALLEST => n.fail(
                format!("is more than {SMALLEST:e} times smaller than `step` = {step}"),
                "choose a larger one, or a smaller step",
            ),
            _ => Some(initial),
        }
    });
    let smallest = table.optional("smallest", |n| {
        let smallest = n.positive()?;
        match initial {
            Some(initial) if smallest > initial => {
                n.fail(format!("must not exceed `initial` = {initial}"), "choose a smaller one")
            }
            _ => Some(smallest),
        }
    });
    let easy = table.default("easy", Automatic::DEFAULT_EASY, Node::count);
    let after = table.default("after", Automatic::DEFAULT_AFTER, Node::count);
    let hard = table.optional("hard", |n| {
        let hard = n.count()?;
        match easy {
            Some(easy) if hard < easy => {
                n.fail(format!("must not be less than `easy` = {easy}"), "choose a larger one")
            }
            _ => Some(hard),
        }
    });
    table.finish();
    Some(Automatic { initial: initial?, smallest: smallest?, easy: easy?, after: after?, hard: hard? })
}

pub(super) fn stabilise(node: &Node<'_>) -> Option<Stabilise> {
    let table = node.table_like("{ fraction = 2e-4 }")?;
    let fraction = table.optional("fraction", |n| {
        let fraction = n.positive()?;
        if fraction > 1.0 {
            return n.fail("must not be larger than 1", "write for instance 2e-4");
        }
        Some(fraction)
    });
    let coefficient = table.optional("coefficient", Node::positive);
    let one = match ["fraction", "coefficient"].map(|key| table.has(key)) {
        [true, true] => {
            table.fail("coefficient", "cannot be combined with `fraction`", "give either `fraction` or `coefficient`")
        }
        [false, false] => table.missing("fraction", "fraction = 2e-4"),
        _ => Some(()),
    };
    table.finish();
    one?;
    Some(Stabilise { fraction: fraction?, coefficient: coefficient? })
}

pub(super) fn integrator(node: &Node<'_>) -> Option<Integrator> {
    let table = node.table()?;
    let names: Vec<&str> = SCHEMES.iter().map(|entry| entry.name).collect();
    let entry =
        table.required("scheme", "scheme = \"energy-momentum\"", |n| n.choice(&names, stoss_integrators::entry));
    let Some(entry) = entry else {
        // Which parameters there are is not known: nothing to say about them.
        return None;
    };
    let mut parameters = BTreeMap::new();
    let mut good = true;
    for parameter in entry.parameters {
        let (low, high) = parameter.range;
        let value = table.optional(parameter.name, |n| {
            let value = n.number()?;
            if value < low || value > high {
                return n.fail(format!("is outside [{low}, {high}]"), format!("it is the {}", parameter.about));
            }
            Some(value)
        });
        good &= value.is_some();
        parameters.extend(value.flatten().map(|value| (parameter.name.to_owned(), value)));
    }
    table.finish();
    good.then(|| Integrator { scheme: entry.name.to_owned(), parameters })
}

pub(super) fn solver(node: &Node<'_>) -> Option<Solver> {
    let table = node.table()?;
    let relative_tolerance = table.optional("relative_tolerance", |n| {
        let value = n.positive()?;
        if value >= 1.0 {
            return n.fail("must be smaller than 1", "write for instance 1e-9");
        }
        Some(value)
    });
    let absolute_tolerance = table.optional("absolute_tolerance", Node::not_negative);
    let max_iterations = table.optional("max_iterations", Node::count);
    let polish = table.optional("polish", Node::boolean);
    let inside_out =
        table.default("inside_out", InsideOut::Refuse, |n| n.choice(InsideOut::NAMES, InsideOut::from_name));
    let linear =
        table.default("linear", LinearSolver::Auto, |n| n.choice(LinearSolver::NAMES, LinearSolver::from_name));
    let petsc = table.optional("petsc", |n| {
        let text = n.string()?;
        if !(["direct", "multigrid"].contains(&text.as_str()) || text.starts_with('-')) {
            let remedy = "write \"direct\", \"multigrid\", or options that begin with -, such as \"-ksp_type gmres -pc_type asm\"";
            return n.fail("is neither a set of options of PETSc nor such options", remedy);
        }
        if linear.is_some_and(|linear| !matches!(linear, LinearSolver::Auto | LinearSolver::Petsc)) {
            return n.fail("has no effect with another solver than PETSc", "remove it, or write linear = \"petsc\"");
        }
        Some(text)
    });
    let factors = table.default("factors", Factors::Reused, |n| n.choice(Factors::NAMES, Factors::from_name));
    table.finish();
    Some(Solver {
        relative_tolerance: relative_tolerance?,
        absolute_tolerance: absolute_tolerance?,
        max_iterations: max_iterations?,
        polish: polish?,
        linear: linear?,
        petsc: petsc?,
        factors: factors?,
        inside_out: inside_out?,
    })
}
