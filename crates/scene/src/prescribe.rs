//! `[[prescribe]]`: prescribed displacements and motions.

use crate::read::{Node, Table, Value};
use crate::world::{World, action_name, set_reference};
use crate::{Component, PartKind, Series, split_set};
use stoss_scene_derive::table;

/// `[[prescribe]]`: prescribed displacement components of a set as functions of time, its displacement along a direction, or a rigid motion of the set. Exactly one of
/// `displacement`, `fixed = true` and `rotation`.
///
/// With `rigid` instead of `set` the whole motion of a rigid body is prescribed: without a `rotation` it does not rotate, and components that are not
/// named are fixed.
///
/// ```toml
/// [[prescribe]]
/// name = "stroke"
/// rigid = "punch"
/// components = ["z"]
/// displacement = { table = [[0.0, 0.0], [1.0, -0.1]] }
/// ```
#[table(context(World<'_>), check = prescribe)]
pub struct Prescribe {
    /// Unique name, with which an `[[event]]` releases it and a `[[stage]]` switches it off.
    #[key(read = action_name)]
    pub name: Option<String>,
    /// Set of nodes, `part.set`. Of a beam the positions of its nodes are prescribed, not its directors.
    #[key(by = moved_set)]
    pub set: Option<String>,
    /// Name of a rigid body, instead of a set.
    #[key(by = rigid_part)]
    pub rigid: Option<String>,
    /// Prescribed components `x`, `y`, `z`, each at most once. Not with a `rotation`, which prescribes all three, nor with a rigid body that is `fixed`.
    #[key(default, skip, with = components)]
    pub components: Vec<Component>,
    /// Instead of `components`: a direction of any length but zero along which the displacement is prescribed, while the nodes slide freely in the plane normal to it. With
    /// `fixed = true` this is a symmetry plane, or a sliding support, in any direction.
    #[key(dimension = Number, direction)]
    pub normal: Option<[f64; 3]>,
    /// Displacement from the reference position (a length each): one value for each component, or one value along `normal`.
    #[key(dimension = Length, with = |node, _, keys| Series::of(node, keys.columns()?))]
    pub displacement: Option<Series>,
    /// `true`: the displacement of the components, or along `normal`, is zero. `false` if left out.
    #[key(default, skip)]
    pub fixed: bool,
    /// Rotation of the reference positions of the set, by any angle.
    pub rotation: Option<PrescribedRotation>,
    /// Translation after the rotation (three lengths); none if left out. With a `rotation` only.
    #[key(dimension = Length, read = |node| Series::of(node, 3))]
    pub translation: Option<Series>,
    /// Where a stage switches it on, the nodes begin where they are then, and are where `displacement` says from this time on: the difference falls linearly, and stays
    /// if it is `inf`. If left out they are there at the end of the first step. Of sets, along components or a normal that is an axis of space.
    #[key(dimension = Time, read = end_of_ramp)]
    pub ramp_until: Option<f64>,
}

impl Prescribe {
    /// A set that is held, along no component yet.
    pub fn fixed(set: String) -> Self {
        Self {
            name: None,
            set: Some(set),
            rigid: None,
            components: Vec::new(),
            normal: None,
            displacement: None,
            fixed: true,
            rotation: None,
            translation: None,
            ramp_until: None,
        }
    }

    /// Whether it is along a `normal` that is not a coordinate axis.
    pub fn is_inclined(&self) -> bool {
        self.normal.is_some_and(|normal| normal.iter().filter(|&&n| n != 0.0).count() > 1)
    }

    /// The prescribed components: all three with a rotation, and of a rigid body that is fixed. They are the columns of [`Self::rows`]; the other
    /// components of a rigid body are fixed.
    pub fn prescribed_components(&self) -> Vec<Component> {
        match &self.rotation {
            None if self.rigid.is_none() || !self.fixed => self.components.clone(),
            _ => vec![Component::X, Component::Y, Component::Z],
        }
    }

    /// Rows `[time, value, ...]` with one value a prescribed component, or one along the normal: of the displacement, or of the translation after a rotation.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        match self.displacement.as_ref().or(self.translation.as_ref()) {
            Some(series) => series.rows(),
            None if self.normal.is_some() => vec![vec![0.0; 2]],
            None => vec![vec![0.0; 1 + self.prescribed_components().len()]],
        }
    }
}

/// Rotation of a set about an axis that moves only with the translation.
#[table]
pub struct PrescribedRotation {
    /// Direction of the axis, of any length but zero.
    #[key(dimension = Number, example = "[0, 0, 1]", direction)]
    pub axis: [f64; 3],
    /// Angle from the reference position in degrees, positive by the right-hand rule; may exceed 360.
    #[key(dimension = Angle, example = "{ table = [[0.0, 0.0], [1.0, 90.0]] }", read = |node| Series::of(node, 1))]
    pub degrees: Series,
    /// A point on the axis; the origin if left out.
    #[key(default, dimension = Length)]
    pub about: [f64; 3],
}

impl PrescribeKeys {
    /// Number of values of the displacement, if it is known.
    fn columns(&self) -> Option<usize> {
        match self.normal {
            // Without components it is reported that they are missing, or what they are missing for.
            Some(None) => self.components.as_ref().map(Vec::len).filter(|&count| count > 0),
            _ => Some(1),
        }
    }
}

fn prescribe(keys: &PrescribeKeys, table: &Table<'_>, _: &World<'_>) -> Option<()> {
    let set = match (table.has("rigid"), table.has("set")) {
        (true, true) => table.fail("set", "is not needed: the rigid body moves as a whole", "remove it, or `rigid`"),
        (false, false) => table.missing("set", "set = \"plate.rim\""),
        _ => Some(()),
    };
    let kind = if table.has("rotation") { rigid_motion(table) } else { displacement(keys, table) };
    set.and(kind)
}

/// Reports keys that do not go with a rotation.
fn rigid_motion(table: &Table<'_>) -> Option<()> {
    let mut alone = Some(());
    for (key, remedy) in [
        ("components", "remove it: a rotation prescribes all three components"),
        ("normal", "remove it: a rotation prescribes all three components"),
        ("displacement", "call it `translation`, with three values"),
        ("fixed", "remove it, or the rotation"),
        ("ramp_until", "remove it: a rotation begins where its angle and its translation are at that time"),
    ] {
        if table.has(key) {
            alone = table.fail(key, "cannot be combined with `rotation`", remedy);
        }
    }
    alone
}

/// Reports keys of a displacement that do not fit each other.
fn displacement(keys: &PrescribeKeys, table: &Table<'_>) -> Option<()> {
    let is_rigid = table.has("rigid");
    let components = if table.has("normal") {
        let mut alone = Some(());
        for (key, remedy) in [
            (
                "components",
                "remove it: a normal prescribes the displacement along itself; hold components by a [[prescribe]] of their own",
            ),
            ("rigid", "name a `set`, or let the rigid body slide on a [[joint]] to the ground"),
        ] {
            if table.has(key) {
                alone = table.fail(key, "cannot be combined with `normal`", remedy);
            }
        }
        alone
    } else {
        match (is_rigid && keys.fixed == Some(true), table.has("components")) {
            (true, true) => {
                let remedy = "remove it, or write a `displacement`";
                table.fail("components", "is not needed: a rigid body is fixed as a whole", remedy)
            }
            (false, false) => table.missing("components", "components = [\"x\", \"z\"]"),
            _ => Some(()),
        }
    };
    let translation = if table.has("translation") {
        table.fail("translation", "belongs to a `rotation`", "call it `displacement`, or add a `rotation`")
    } else {
        Some(())
    };
    let one_kind = match (keys.fixed, table.has("displacement")) {
        (Some(true), true) => table.fail(
            "fixed",
            "cannot be combined with `displacement`",
            "remove `fixed`, or `displacement` if nothing is to move",
        ),
        (Some(false), false) => table.fail(
            "displacement",
            "is missing",
            "add it, for instance `displacement = { table = [[0.0, 0.0], [1.0, 0.1]] }`, or `fixed = true`",
        ),
        _ => Some(()),
    };
    let is_inclined = keys.normal.flatten().is_some_and(|n| n.iter().filter(|&&n| n != 0.0).count() > 1);
    if table.has("ramp_until") && (is_rigid || is_inclined) {
        return table.fail(
            "ramp_until",
            "is for sets of nodes that are prescribed along axes of space",
            "remove it, and let the displacement begin where the nodes are when it is switched on",
        );
    }
    components.and(translation).and(one_kind)
}

/// A time, which may be infinite.
fn end_of_ramp(node: &Node<'_>) -> Option<f64> {
    let time = node.extended()?;
    if time.is_nan() || time <= 0.0 {
        return node.fail("must be a time after the start", "write the time at which the ramp ends, or inf");
    }
    Some(time)
}

/// The name of a rigid body that is not fixed.
fn rigid_part(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    match world.find(node, &name)? {
        Some(part) if part.kind != PartKind::Rigid => {
            let message = format!("is {}, not a rigid body", part.kind.noun());
            node.fail(message, format!("write `set = \"{name}.set\"` with one of its sets"))
        }
        Some(part) if part.fixed => {
            node.fail("is fixed by its own key", "remove `fixed = true` there, or this [[prescribe]]")
        }
        _ => Some(name),
    }
}

/// A set of nodes that can be prescribed by components.
fn moved_set(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    match split_set(&text).and_then(|(part, _)| world.part(part)) {
        Some(part) if part.kind == PartKind::Rigid => node.fail(
            format!("`{}` is a rigid body, which is prescribed as a whole", part.name),
            format!("write `rigid = \"{}\"` instead of `set`", part.name),
        ),
        _ => Some(text),
    }
}

fn components(node: &Node<'_>, world: &World<'_>, _: &PrescribeKeys) -> Option<Vec<Component>> {
    let components = node.list(|node| Component::read(node, world))?;
    if components.is_empty() {
        return node.fail("names no component", "write for instance [\"x\", \"y\", \"z\"]");
    }
    if let Some(i) = (1..components.len()).find(|&i| components[..i].contains(&components[i])) {
        return node.fail(format!("names `{}` twice", components[i]), "name every component at most once");
    }
    Some(components)
}
