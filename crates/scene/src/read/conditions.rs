//! Reads `[[set]]`, `[[contact]]`, `[[load]]`.

use super::contact_method::of_method;
use super::friction::friction;
use super::node::{Node, is_name, known};
use super::prescribe::series;
use super::table::Table;
use super::world::{World, action_name, contact_reference, is_line, meshed_part, set_reference};
use crate::chosen::of_which;
use crate::{
    BoxRegion, Closing, ClosingFriction, Constraint, Contact, ContactMethod, Coupling, Edges, Enforcement,
    GapAtClosing, Integrals, Kind, Load, LoadKind, MethodEntry, Multipliers, OverlapAtStart, PartKind, PlaneRegion,
    Quadrature, Reduction, SetDefinition, SurfaceMass, split_set,
};
use toml::de::DeValue;

pub(super) fn set(table: &Table<'_>, world: &World<'_>) -> Option<SetDefinition> {
    let body = table.required("body", "body = \"plate\"", |n| meshed_part(n, world, true));
    let name = table.required("name", "name = \"plate.rim\"", |n| {
        let text = n.text()?;
        let Some((owner, set)) = split_set(&text) else {
            return n
                .fail("is not of the form `body.set`", "write the name of the body, a dot, and the name of the set");
        };
        if !is_name(set) {
            return n.fail("is not a valid name", "use letters, digits, `-` and `_` only after the dot");
        }
        if let Some(body) = &body
            && owner != body
        {
            return n.fail(format!("does not start with the set's body `{body}`"), format!("call it \"{body}.{set}\""));
        }
        Some(text)
    });
    let inside = table.optional("box", box_region);
    let plane = table.optional("plane", plane_region);
    let one_region = match (table.has("box"), table.has("plane")) {
        (true, true) => table.fail("plane", "a set has either a box or a plane", "remove one of them"),
        (false, false) => table.missing("box", "box = { min = [0, 0, 0], max = [1, 1, 1] }"),
        _ => Some(()),
    };
    table.finish();
    one_region?;
    Some(SetDefinition { name: name?, body: body?, inside: inside?, plane: plane? })
}

fn box_region(node: &Node<'_>) -> Option<BoxRegion> {
    let table = node.table()?;
    let min = table.required("min", "min = [0, 0, 0]", |n| n.array(Node::extended));
    let max = table.required("max", "max = [1, 1, 1]", |n| n.array(Node::extended));
    table.finish();
    let (min, max): ([f64; 3], [f64; 3]) = (min?, max?);
    if let Some(i) = (0..3).find(|&i| min[i] > max[i]) {
        let axis = ["x", "y", "z"][i];
        return table.fail("max", format!("is below `min` = {min:?} in {axis}"), "exchange or correct the corners");
    }
    Some(BoxRegion { min, max })
}

fn plane_region(node: &Node<'_>) -> Option<PlaneRegion> {
    let table = node.table()?;
    let point = table.required("point", "point = [0, 0, 0]", Node::vector);
    let normal = table.required("normal", "normal = [0, 0, 1]", Node::direction);
    let tolerance = table.optional("tolerance", Node::positive);
    table.finish();
    Some(PlaneRegion { point: point?, normal: normal?, tolerance: tolerance? })
}

pub(super) fn contact(table: &Table<'_>, world: &World<'_>) -> Option<Contact> {
    let name = table.optional("name", Node::name);
    let method =
        table.required("method", "method = \"nts\"", |n| n.choice(&ContactMethod::names(), ContactMethod::from_name));
    let has = |n: &Node<'_>, key| of_method(n, key, method);
    // The sides of a contact, first the method.
    let side = |n: &Node<'_>| {
        let reference = contact_reference(n, world)?;
        match method {
            Some(method) if !method.takes_lines && is_line(&reference, world) => n.fail(
                format!("`{method}` is for surfaces, and a beam or string has no facets"),
                format!("set `method` to one of {}", of_which::<MethodEntry>(|method| method.takes_lines)),
            ),
            _ => Some(reference),
        }
    };
    let master_side = |n: &Node<'_>| {
        let reference = side(n)?;
        if is_line(&reference, world) {
            let message = "a beam or string has no facets and can only be the slave, and two of them have no contact";
            return n.fail(message, "choose a surface as the master");
        }
        Some(reference)
    };
    let between = table.optional("between", |n| n.array(side));
    // Where `between` is there, right or wrong, the other two are not to be.
    let named = |key: &'static str, example: &'static str, side: &dyn Fn(&Node<'_>) -> Option<String>| match between {
        Some(None) => table.required(key, example, side).map(Some),
        _ => table.optional(key, |n| {
            n.fail("is not needed: `between` determines slave and master", "remove one of the two keys")
        }),
    };
    let slave = named("slave", "slave = \"ball.outer\"", &side);
    let master = named("master", "master = \"plate.top\"", &master_side);
    let constraint = table.optional("constraint", |n| {
        let constraint = n.choice(Constraint::NAMES, Constraint::from_name)?;
        if constraint != Constraint::Standard && world.kind == Some(Kind::QuasiStatic) {
            return n.fail("is for dynamic scenes only", "use \"standard\", which closes the gap");
        }
        has(n, "constraint")?;
        Some(constraint)
    });
    let enforcement = table.default("enforcement", Enforcement::Multiplier, |n| {
        let enforcement = enforcement(n)?;
        let has_it = |method: ContactMethod| method.enforcements.contains(&enforcement.name());
        if !enforcement.is_multiplier() && !method.is_none_or(has_it) {
            return n.fail("is not for this method, which has pressures as multipliers", "remove it");
        }
        if matches!(enforcement, Enforcement::Penalty(_)) && constraint == Some(Some(Constraint::Modified)) {
            return n.fail("a penalty needs the standard constraint", "remove `constraint`, or set it to \"standard\"");
        }
        Some(enforcement)
    });
    let friction = table.optional("friction", |n| {
        let friction = friction(n, method, world.own_friction)?;
        if constraint == Some(Some(Constraint::Modified)) {
            return n.fail("cannot be combined with the modified constraint", "set `constraint` to \"standard\"");
        }
        Some(friction)
    });
    let surface_velocity = table.optional("surface_velocity", |n| {
        if matches!(friction, Some(None)) {
            return n.fail("has no effect without friction", "give the contact a `friction`, or remove it");
        }
        has(n, "surface_velocity")?;
        if matches!(between, Some(Some(_))) {
            let message = "needs to be told which surface moves: it is that of the master";
            return n.fail(message, "write `slave` and `master` instead of `between`");
        }
        series(n, 3)
    });
    let reduction = table.optional("reduction", |n| {
        has(n, "reduction")?;
        n.choice(Reduction::NAMES, Reduction::from_name)
    });
    let flag = |key| {
        table.default(key, false, |n| {
            has(n, key)?;
            n.boolean()
        })
    };
    let (drop_gap_term, drop_gap_slope) = (flag("drop_gap_term"), flag("drop_gap_slope"));
    let second = !matches!(reduction, Some(Some(Reduction::None | Reduction::First)));
    let has_effect = match drop_gap_slope {
        Some(true) if !second => table.fail(
            "drop_gap_slope",
            "has no effect without the second reduction: the derivative is a part of the equations there",
            "remove it, or write reduction = \"second\"",
        ),
        _ => Some(()),
    };
    let multipliers = table.optional("multipliers", |n| {
        has(n, "multipliers")?;
        n.choice(Multipliers::NAMES, Multipliers::from_name)
    });
    let quadrature = table.optional("quadrature", |n| {
        has(n, "quadrature")?;
        n.choice(Quadrature::NAMES, Quadrature::from_name)
    });
    let integrals = table.optional("integrals", |n| {
        has(n, "integrals")?;
        n.choice(Integrals::NAMES, Integrals::from_name)
    });
    let modified = constraint == Some(Some(Constraint::Modified));
    let is_penalty = matches!(enforcement, Some(Enforcement::Penalty(_)));
    let frozen = integrals == Some(Some(Integrals::Frozen));
    let surface_mass = table.default("surface_mass", SurfaceMass::default(), |n| {
        let mass = n.choice(SurfaceMass::NAMES, SurfaceMass::from_name)?;
        if mass == SurfaceMass::Consistent {
            return Some(mass);
        }
        if world.kind == Some(Kind::QuasiStatic) {
            return n.fail("is for dynamic scenes only", "remove it");
        }
        has(n, "surface_mass")?;
        if matches!(between, Some(Some(_))) {
            let message = "needs to be told which surface has no mass: it is that of the slave, if it is deformable";
            return n.fail(message, "write `slave` and `master` instead of `between`");
        }
        Some(mass)
    });
    let is_massless = surface_mass == Some(SurfaceMass::None);
    let closing = table.optional("closing", |n| {
        let closing = n.choice(Closing::NAMES, Closing::from_name)?;
        if closing == Closing::Impact && is_massless {
            return n.fail("is not for a surface without mass, which has no impact", "remove it");
        }
        if closing == Closing::Impact && (modified || is_penalty || frozen) {
            let message = "is for exact contact: not for a penalty, the modified constraint, or frozen integrals";
            return n.fail(message, "remove it");
        }
        Some(closing)
    });
    let keeps = modified
        || is_penalty
        || frozen
        || closing == Some(Some(Closing::Keep)) && !is_massless
        || method.is_some_and(|method| !method.has_impact) && closing == Some(None);
    let of_impact = |n: &Node<'_>| {
        if world.kind == Some(Kind::QuasiStatic) {
            return n.fail("is for dynamic scenes only", "remove it");
        }
        if keeps {
            return n.fail(
                "is a number of the law of impact, and this contact keeps the velocities of the step",
                "remove it",
            );
        }
        Some(())
    };
    let restitution = table.optional("restitution", |n| {
        of_impact(n)?;
        if is_massless {
            return n.fail("is a number of the law of impact, and a surface without mass has no impact", "remove it");
        }
        restitution(n)
    });
    let gap = table.default("gap", GapAtClosing::Auto, |n| {
        of_impact(n)?;
        let gap = n.choice(GapAtClosing::NAMES, GapAtClosing::from_name)?;
        if let (GapAtClosing::Hold, Some(method)) = (gap, method.filter(|method| !method.has_impact)) {
            return n.fail(format!("is not for `{method}`, which closes gaps"), "remove it");
        }
        Some(gap)
    });
    let closes = gap == Some(GapAtClosing::Close);
    let settle = table.optional("settle", |n| {
        of_impact(n)?;
        if closes {
            return n.fail(
                "says how a gap that is held comes down, and `gap = \"close\"` holds none",
                "remove one of them",
            );
        }
        n.count()
    });
    let nearness = table.optional("nearness", |n| {
        has(n, "nearness")?;
        n.not_negative()
    });
    let apart = (modified, frozen);
    let overlap = table.optional("overlap", |n| {
        keeps_gaps(n, apart)?;
        n.choice(OverlapAtStart::NAMES, OverlapAtStart::from_name)
    });
    let interference = table.optional("interference", |n| {
        keeps_gaps(n, apart)?;
        let given = series(n, 1)?;
        if given.rows().iter().any(|row| row[1] < 0.0) {
            return n.fail(
                "is negative: surfaces cannot be pushed together",
                "give a clearance by the places of the bodies",
            );
        }
        Some(given)
    });
    let in_time = matches!(overlap, Some(Some(OverlapAtStart::Ramp)))
        || interference.iter().flatten().any(|series| series.rows().len() > 1);
    let closing_friction = table.optional("closing_friction", |n| {
        let closing = n.choice(ClosingFriction::NAMES, ClosingFriction::from_name)?;
        if friction == Some(None) {
            return n.fail("says when friction acts, and this contact has none", "remove it");
        }
        if closing == ClosingFriction::Grows && !in_time {
            let remedy = "write overlap = \"ramp\", or the interference as a table";
            return n.fail("is in proportion to time, and what closes does so in the first step", remedy);
        }
        Some(closing)
    });
    let edges = table.default("edges", Edges::default(), |n| {
        let edges = n.choice(Edges::NAMES, Edges::from_name)?;
        let sets = [&slave, &master].into_iter().flatten().flatten().chain(between.iter().flatten().flatten());
        if edges == Edges::General && sets.clone().any(|set| is_line(set, world)) {
            return n.fail("needs facets on both sides: beams and strings have none", "remove it");
        }
        if edges == Edges::General && !matches!(surface_velocity, Some(None)) {
            let message =
                "is not for a contact with `surface_velocity`: general contact takes surfaces as their nodes move";
            return n.fail(message, "remove one of the two");
        }
        Some(edges)
    });
    let normals: Option<Option<()>> = table.optional("normals", |n| {
        n.fail(
            "is no longer an option: normals are the means of the facets around a node, on each side of a sharp edge",
            "remove it",
        )
    });
    let smoothing: Option<Option<()>> = table.optional("smoothing", |n| {
        n.fail("is no longer an option: the weighted gap follows the facets, and slivers have no pressure", "remove it")
    });
    table.finish();
    let (slave, master, between) = (slave?, master?, between?);
    let sets = between.as_ref().map(|[a, b]| (a, b)).or(slave.as_ref().zip(master.as_ref()));
    if let Some((a, b)) = sets
        && let (Some((a, _)), Some((b, _))) = (split_set(a), split_set(b))
        && a == b
    {
        return table.fail(
            if between.is_some() { "between" } else { "master" },
            format!("slave and master belong to the same body `{a}`"),
            "choose the surface of another body; contact of a body with itself is part of [general_contact]",
        );
    }
    if let Some([a, b]) = &between
        && is_line(a, world)
        && is_line(b, world)
    {
        return table.fail("between", "both are beams or strings, which have no facets", "name a surface on one side");
    }
    has_effect?;
    normals?;
    smoothing?;
    let (constraint, enforcement) = (constraint?, enforcement?);
    Some(Contact {
        name: name?,
        method: method?,
        slave,
        master,
        between,
        constraint,
        enforcement,
        reduction: reduction?,
        drop_gap_term: drop_gap_term?,
        drop_gap_slope: drop_gap_slope?,
        multipliers: multipliers?,
        quadrature: quadrature?,
        integrals: integrals?,
        closing: closing?,
        restitution: restitution?,
        gap: gap?,
        settle: settle?,
        surface_mass: surface_mass?,
        nearness: nearness?,
        edges: edges?,
        overlap: overlap?,
        interference: interference?,
        closing_friction: closing_friction?,
        friction: friction?,
        surface_velocity: surface_velocity?,
    })
}

/// Whether closed slots may keep other gaps than zero: not those of the modified constraint, nor frozen integrals.
fn keeps_gaps(node: &Node<'_>, (modified, frozen): (bool, bool)) -> Option<()> {
    match (modified, frozen) {
        (true, _) => {
            node.fail("cannot be combined with the modified constraint, which keeps what gap there is", "remove it")
        }
        (_, true) => {
            node.fail("cannot be combined with frozen integrals, which have no gap of the end of a step", "remove it")
        }
        _ => Some(()),
    }
}

/// A coefficient of restitution.
pub(super) fn restitution(node: &Node<'_>) -> Option<f64> {
    let value = node.not_negative()?;
    if value > 1.0 {
        node.fail("is more than 1", "choose a value from 0 (plastic) to 1 (elastic)")
    } else {
        Some(value)
    }
}

fn enforcement(node: &Node<'_>) -> Option<Enforcement> {
    let example = "write \"multiplier\", { penalty = 1e5 } or { augmented = 1e5 }";
    match node.value {
        DeValue::Table(_) => {
            let table = node.table()?;
            let penalty = table.optional("penalty", Node::positive);
            let augmented = table.optional("augmented", Node::positive);
            table.finish();
            match (penalty?, augmented?) {
                (Some(stiffness), None) => Some(Enforcement::Penalty(stiffness)),
                (None, Some(stiffness)) => Some(Enforcement::Augmented(stiffness)),
                _ => node.fail("needs exactly one of `penalty` and `augmented`", example),
            }
        }
        DeValue::String(_) => match node.text()?.as_str() {
            "multiplier" => Some(Enforcement::Multiplier),
            "penalty" | "augmented" => node.fail("needs a stiffness, a traction per length", example),
            other => node.fail("is not known", known(other, Enforcement::NAMES.iter().copied())),
        },
        _ => node.fail(format!("must be a word or a table, found a {}", node.value.type_str()), example),
    }
}

pub(super) fn load(table: &Table<'_>, world: &World<'_>) -> Option<Load> {
    let name = table.optional("name", action_name);
    let set = table.optional("set", |n| loaded_set(n, table, world));
    let body = table.optional("body", |n| meshed_part(n, world, false));
    let value = |key: &'static str, kind: LoadKind| table.optional(key, |n| series(n, kind.columns()));
    let pressure = value("pressure", LoadKind::Pressure);
    let traction = value("traction", LoadKind::Traction);
    let body_force = value("body_force", LoadKind::BodyForce);
    let follower_pressure = value("follower_pressure", LoadKind::FollowerPressure);
    let force = value("force", LoadKind::Force);
    let moment = value("moment", LoadKind::Moment);
    let coupling = table.optional("coupling", |n| {
        let coupling = n.choice(Coupling::NAMES, Coupling::from_name)?;
        if !table.has("moment") {
            return n.fail("is for moments on sets of deformable bodies", "remove it");
        }
        let part =
            set.as_ref().and_then(|set| set.as_deref()).and_then(split_set).and_then(|(part, _)| world.part(part));
        match part {
            Some(part) if part.kind != PartKind::Body => n.fail(
                format!("is for sets of deformable bodies, and the load acts on {}", part.kind.noun()),
                "remove it",
            ),
            _ => Some(coupling),
        }
    });
    let acceleration = value("acceleration", LoadKind::Acceleration);
    let total_force = value("total_force", LoadKind::TotalForce);
    let angular_velocity = value("angular_velocity", LoadKind::Centrifugal);
    let turns = table.has("angular_velocity");
    let of_axis = |n: &Node<'_>| if turns { Some(()) } else { n.fail("is for an `angular_velocity`", "remove it") };
    let axis = table.optional("axis", |n| of_axis(n).and_then(|()| n.direction()));
    let about = table.optional("about", |n| of_axis(n).and_then(|()| n.vector()));
    let has_axis = if turns && !table.has("axis") { table.missing("axis", "axis = [0, 0, 1]") } else { Some(()) };
    let given: Vec<&'static str> = LoadKind::NAMES.iter().copied().filter(|key| table.has(key)).collect();
    let one_kind = match given.as_slice() {
        [_] => Some(()),
        [] => {
            let list = known("", LoadKind::NAMES.iter().copied());
            table.fail(
                "pressure",
                "a load needs one kind of load",
                format!("add `pressure = 1.0` or another kind; {list}"),
            )
        }
        [first, second, ..] => {
            table.fail(second, format!("`{first}` is given too"), "write a [[load]] of its own for each kind")
        }
    };
    let target = match (table.has("set"), table.has("body")) {
        (true, true) => table.fail("body", "a load has either a set or a body", "remove one of them"),
        (false, false) => table.missing("set", "set = \"plate.bottom\""),
        (true, false) if table.has("acceleration") => {
            table.fail("set", "an `acceleration` acts on a whole body", "write `body` with the name of a body instead")
        }
        (true, false) if turns => table.fail(
            "set",
            "an `angular_velocity` acts on a whole body",
            "write `body` with the name of a body instead",
        ),
        (false, true) if !(table.has("body_force") || table.has("acceleration") || turns) => table.fail(
            "body",
            "only a `body_force`, an `acceleration` or an `angular_velocity` acts on a whole body",
            "name a set, for instance `set = \"plate.bottom\"`",
        ),
        _ => Some(()),
    };
    table.finish();
    one_kind?;
    target?;
    has_axis?;
    Some(Load {
        name: name?,
        set: set?,
        body: body?,
        pressure: pressure?,
        traction: traction?,
        body_force: body_force?,
        follower_pressure: follower_pressure?,
        force: force?,
        moment: moment?,
        coupling: coupling?,
        acceleration: acceleration?,
        total_force: total_force?,
        angular_velocity: angular_velocity?,
        axis: axis?,
        about: about?,
    })
}

/// The set of a load: pressures, tractions and body forces act on deformable bodies, forces and moments also on other parts.
fn loaded_set(node: &Node<'_>, table: &Table<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    let Some((part, set)) = split_set(&text).and_then(|(part, set)| Some((world.part(part)?, set))) else {
        return Some(text);
    };
    let noun = part.kind.noun();
    if part.kind != PartKind::Body
        && let Some(kind) = LoadKind::NAMES
            .iter()
            .find(|&&key| table.has(key) && ![LoadKind::Force, LoadKind::Moment].map(LoadKind::name).contains(&key))
    {
        let message = format!("`{}` is {noun}: a `{kind}` acts on deformable bodies", part.name);
        return node.fail(message, "write `force`, or [gravity] for weight");
    }
    if part.kind == PartKind::Rigid && set != "all" {
        let remedy = format!("write \"{}.all\"; a force acts at its centre of mass", part.name);
        return node.fail(format!("`{}` is {noun}, on which forces and moments act as a whole", part.name), remedy);
    }
    if table.has(LoadKind::Moment.name()) && matches!(part.kind, PartKind::Mass | PartKind::String) {
        return node.fail(
            format!("`{}` is {noun}, which has no orientation for a moment", part.name),
            "name a rigid body, a beam or a deformable body",
        );
    }
    Some(text)
}
