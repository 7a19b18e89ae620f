//! Prescribed motion, loads, contact.

use super::{Placed, Problems};
use crate::scene::{LoadKind as SceneLoad, Scene, known, split_set};
use crate::solver::{Load, LoadKind, Model, Prescription, Table};
use stoss_mesh::{Mesh, MeshError, SetKind};

/// Facets of a set in global node numbers.
fn facets(placed: &Placed, set: &str) -> Result<Vec<[u32; 4]>, MeshError> {
    let list = placed.mesh.facets_of(set)?;
    Ok(list.iter().map(|facet| facet.nodes.map(|n| n + placed.first_node)).collect())
}

/// Resolves `body.set` with a given look-up; reports and returns `None` if it does not exist or is empty.
pub(super) fn resolve<T>(
    scene: &Scene,
    placed: &[Placed],
    key: &str,
    reference: &str,
    problems: &mut Problems<'_>,
    look_up: impl Fn(&Placed, &str) -> Result<Vec<T>, MeshError>,
) -> Option<(usize, Vec<T>)> {
    let (body, set) = split_set(reference)?;
    let b = scene.body_index(body)?;
    let names = || placed[b].mesh.set_names();
    match look_up(&placed[b], set) {
        Ok(list) if !list.is_empty() => Some((b, list)),
        Ok(_) => {
            let remedy = format!("choose a set that is not empty; body `{body}` has: {}", names().join(", "));
            problems.add(key.to_owned(), reference, "the set is empty", remedy);
            None
        }
        Err(MeshError::UnknownSet { name, .. }) => {
            let message = format!("body `{body}` has no set `{name}`");
            problems.add(key.to_owned(), reference, message, known(&name, names().iter().map(String::as_str)));
            None
        }
        Err(error) => {
            let remedy = match &error {
                MeshError::WrongSetKind { wanted: SetKind::Facets, .. } => format!(
                    "choose a set of facets of body `{body}`: {}; a surface between two elements has no outside and is a set of nodes",
                    facet_sets(&placed[b].mesh).join(", ")
                ),
                _ => format!("body `{body}` has: {}", names().join(", ")),
            };
            problems.add(key.to_owned(), reference, error.to_string(), remedy);
            None
        }
    }
}

/// Names of the sets that have facets.
fn facet_sets(mesh: &Mesh) -> Vec<String> {
    mesh.set_names().into_iter().filter(|name| mesh.facets_of(name).is_ok()).collect()
}

/// Global nodes of a set.
pub(super) fn nodes(placed: &Placed, set: &str) -> Result<Vec<u32>, MeshError> {
    let list = placed.mesh.nodes_of(set)?;
    Ok(list.iter().map(|n| n + placed.first_node).collect())
}

fn table(key: String, rows: &[Vec<f64>], columns: usize, problems: &mut Problems<'_>) -> Option<Table> {
    Table::from_rows(rows, columns)
        .map_err(|error| problems.add(key, "", error.to_string(), "give rows [time, value, ...] with increasing times"))
        .ok()
}

pub(super) fn prescriptions(scene: &Scene, placed: &[Placed], model: &mut Model, problems: &mut Problems<'_>) {
    let mut owner: Vec<Option<usize>> = vec![None; model.reference.len()];
    for (p, item) in scene.prescriptions.iter().enumerate() {
        let key = format!("prescribe[{p}]");
        let found = resolve(scene, placed, &format!("{key}.set"), &item.set, problems, nodes);
        let table = table(format!("{key}.displacement"), &item.rows(), item.components.len(), problems);
        let (Some((_, nodes)), Some(displacement)) = (found, table) else { continue };
        let components: Vec<u8> = item.components.iter().map(|c| c.index() as u8).collect();
        let clash = nodes.iter().find_map(|&n| {
            components.iter().find_map(|&c| owner[3 * n as usize + c as usize].map(|other| (n, c, other)))
        });
        if let Some((node, component, other)) = clash {
            let axis = ["x", "y", "z"][component as usize];
            let message = format!("component {axis} of node {node} is prescribed by prescribe[{other}] as well");
            let remedy = "let the sets not overlap, or give each component once";
            problems.add(format!("{key}.set"), &item.set, message, remedy);
            continue;
        }
        for &n in &nodes {
            for &c in &components {
                owner[3 * n as usize + c as usize] = Some(p);
            }
        }
        model.prescriptions.push(Prescription { nodes, components, displacement });
    }
}

pub(super) fn loads(scene: &Scene, placed: &[Placed], model: &mut Model, problems: &mut Problems<'_>) {
    for (l, item) in scene.loads.iter().enumerate() {
        let key = format!("load[{l}]");
        let Some((kind, series)) = item.kind() else { continue };
        let magnitude = table(format!("{key}.{}", kind.name()), &series.rows(), kind.columns(), problems);
        let load = load_kind(scene, placed, model, &key, item, kind, problems);
        if let (Some(magnitude), Some(load)) = (magnitude, load) {
            model.loads.push(Load { name: format!("{key} {}", kind.name()), kind: load, magnitude });
        }
    }
}

/// Nodal forces of unit magnitude, as the entries that are not zero.
fn pattern(
    components: usize,
    key: &str,
    problems: &mut Problems<'_>,
    fill: impl FnOnce(&mut [f64]) -> Result<(), stoss_fe_solid::SolidError>,
) -> Option<Vec<(u32, f64)>> {
    let mut force = vec![0.0; components];
    match fill(&mut force) {
        Ok(()) => Some(
            force.iter().enumerate().filter(|(_, f)| **f != 0.0).map(|(component, &f)| (component as u32, f)).collect(),
        ),
        Err(error) => {
            problems.add(key.to_owned(), "", error.to_string(), "mend the mesh or choose another set");
            None
        }
    }
}

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn load_kind(
    scene: &Scene,
    placed: &[Placed],
    model: &Model,
    key: &str,
    item: &crate::scene::Load,
    kind: SceneLoad,
    problems: &mut Problems<'_>,
) -> Option<LoadKind> {
    let components = model.reference.len();
    if kind == SceneLoad::BodyForce {
        // On a whole body: `body`, or a set of which the body is meant.
        let name = item.body.as_deref().or_else(|| item.set.as_deref().and_then(split_set).map(|(body, _)| body))?;
        let b = scene.body_index(name)?;
        if let Some((_, set)) = item.set.as_deref().and_then(split_set) {
            let whole = placed[b].mesh.elements_of(set).map(|e| e.len() == placed[b].mesh.elements.len());
            if whole != Ok(true) {
                let message = "a body force acts on a whole body, not on a set of it";
                problems.add(format!("{key}.set"), set, message, format!("write body = \"{name}\" instead of the set"));
                return None;
            }
        }
        let solid = &model.bodies[b].solid;
        let patterns = AXES.map(|axis| pattern(components, key, problems, |f| solid.body_force(axis, f)));
        return Some(LoadKind::Dead { patterns: patterns.into_iter().collect::<Option<_>>()? });
    }
    let set = item.set.as_deref()?;
    let key = format!("{key}.set");
    if kind == SceneLoad::Force {
        let (_, nodes) = resolve(scene, placed, &key, set, problems, nodes)?;
        let patterns = (0..3).map(|i| nodes.iter().map(|&n| (3 * n + i, 1.0)).collect()).collect();
        return Some(LoadKind::Dead { patterns });
    }
    let (_, facets) = resolve(scene, placed, &key, set, problems, facets)?;
    let reference = &model.reference;
    match kind {
        SceneLoad::FollowerPressure => Some(LoadKind::FollowerPressure { facets }),
        SceneLoad::Pressure => {
            let unit =
                pattern(components, &key, problems, |f| stoss_fe_solid::dead_pressure(&facets, reference, 1.0, f))?;
            Some(LoadKind::Dead { patterns: vec![unit] })
        }
        _ => {
            let patterns = AXES.map(|axis| {
                pattern(components, &key, problems, |f| stoss_fe_solid::dead_traction(&facets, reference, axis, f))
            });
            Some(LoadKind::Dead { patterns: patterns.into_iter().collect::<Option<_>>()? })
        }
    }
}

/// Tangential stiffness of friction in multiples of Young's modulus over an edge, if the scene gives none: a sticking node moves by a tenth of
/// what the elements beside it yield, and Newton's method still gets over the kink between stick and slip.
#[cfg(feature = "nts")]
const DEFAULT_TANGENTIAL_STIFFNESS: f64 = 10.0;

#[cfg(any(feature = "nts", feature = "mortar"))]
pub(super) fn contacts(
    scene: &Scene,
    placed: &[Placed],
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) {
    use crate::scene::ContactMethod;
    let mut seen: Vec<(Vec<[u32; 4]>, Vec<[u32; 4]>, String)> = Vec::new();
    for (c, item) in scene.contacts.iter().enumerate() {
        let key = format!("contact[{c}]");
        let slave = resolve(scene, placed, &format!("{key}.slave"), &item.slave, problems, facets);
        let master = resolve(scene, placed, &format!("{key}.master"), &item.master, problems, facets);
        let (Some((slave_body, slave)), Some((master_body, master))) = (slave, master) else { continue };
        if let Some((.., other)) = seen.iter().find(|(s, m, _)| *s == slave && *m == master) {
            let message = format!("is the same contact as `{other}`: its constraints would be there twice");
            problems.add(format!("{key}.name"), item.label(), message, "remove one of the two");
            continue;
        }
        seen.push((slave.clone(), master.clone(), item.label()));
        if [&slave, &master].iter().all(|surface| is_prescribed(model, surface)) {
            let message =
                "every node of both surfaces is prescribed in all components: no contact force could move them";
            problems.add(key, item.label(), message, "remove the contact, or free one of the surfaces");
            continue;
        }
        let pair = PairInput { scene, placed, key, item, bodies: [slave_body, master_body], facets: [&slave, &master] };
        match item.method {
            #[cfg(feature = "nts")]
            ContactMethod::Nts => node_to_surface(pair, model, problems, warnings),
            #[cfg(feature = "mortar")]
            ContactMethod::Mortar => super::mortar::contact(&pair, model, problems, warnings),
            #[allow(unreachable_patterns, reason = "which methods are built in depends on the features")]
            _ => not_built_in(pair.key, item, problems),
        }
    }
}

/// One contact of a scene, its surfaces found.
#[cfg(any(feature = "nts", feature = "mortar"))]
pub(super) struct PairInput<'a> {
    pub scene: &'a Scene,
    pub placed: &'a [Placed],
    pub key: String,
    pub item: &'a crate::scene::Contact,
    /// Slave and master.
    pub bodies: [usize; 2],
    pub facets: [&'a [[u32; 4]]; 2],
}

fn not_built_in(key: String, item: &crate::scene::Contact, problems: &mut Problems<'_>) {
    let name = item.method.name();
    let message = format!("this build of Stoss has no contact method `{name}`");
    problems.add(format!("{key}.method"), name, message, format!("build it with the cargo feature `{name}`"));
}

#[cfg(feature = "nts")]
fn node_to_surface(pair: PairInput<'_>, model: &mut Model, problems: &mut Problems<'_>, warnings: &mut Vec<String>) {
    use crate::scene::Constraint;
    use crate::solver::ContactPair;
    use stoss_contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};
    let constraint = match pair.item.constraint {
        Constraint::Standard => ConstraintForm::Standard,
        Constraint::Modified => ConstraintForm::Modified,
    };
    let options = NodeToSurfaceOptions { constraint, ..NodeToSurfaceOptions::default() };
    let [slave, master] = pair.facets;
    let mut method = match NodeToSurface::new(&pair.item.label(), slave, master, &model.reference, options) {
        Ok(method) => method,
        Err(error) => return pair.refused(&error, problems),
    };
    let complementarity = pair.prepare(&mut method, model, problems, warnings);
    if let Some(friction) = &pair.item.friction {
        let stiffness = DEFAULT_TANGENTIAL_STIFFNESS * complementarity;
        let friction = super::friction::friction(pair.scene, &pair.key, friction, stiffness, problems);
        let Some(friction) = friction else { return };
        method = match method.with_friction(friction) {
            Ok(method) => method,
            Err(error) => {
                let key = format!("{}.friction", pair.key);
                return problems.add(key, "", error.to_string(), "use the standard constraint");
            }
        };
    }
    model.contacts.push(ContactPair { name: pair.item.label(), method: Box::new(method), complementarity });
}

#[cfg(any(feature = "nts", feature = "mortar"))]
impl PairInput<'_> {
    /// Tells that the method cannot be made of these surfaces.
    pub fn refused(&self, error: &stoss_contact::ContactError, problems: &mut Problems<'_>) {
        let remedy = "choose two different, not degenerate surfaces of different bodies";
        problems.add(self.key.clone(), self.item.label(), error.to_string(), remedy);
    }

    /// Looks at the initial gaps; returns the factor of the complementarity function.
    pub fn prepare(
        &self,
        method: &mut dyn stoss_contact::ContactMethod,
        model: &Model,
        problems: &mut Problems<'_>,
        warnings: &mut Vec<String>,
    ) -> f64 {
        let Self { scene, placed, key, item, bodies, .. } = self;
        match method.report(&model.reference) {
            Ok(reports) => {
                let tolerance = 1.0e-9 * method.length_scale();
                let inside = reports.iter().filter(|r| r.gap.is_some_and(|g| g < -tolerance)).count();
                let deepest = reports.iter().filter_map(|r| r.gap).fold(0.0, f64::min);
                if inside > 0 {
                    warnings.push(format!(
                        "{}: {inside} slave nodes begin behind the master surface (deepest gap {deepest:.3e}); the first step closes \
                         that gap and changes the energy",
                        item.label()
                    ));
                }
            }
            Err(error) => problems.add(key.clone(), item.label(), error.to_string(), "mend the surfaces"),
        }
        warnings.extend(overlap(&item.label(), bodies.map(|b| (&scene.bodies[b].name, &placed[b].mesh))));
        // The first frame shows the gaps of the nodes that are in reach, as later ones do.
        let speed = model.velocity.chunks_exact(3).map(|v| v[0].hypot(v[1]).hypot(v[2])).fold(0.0, f64::max);
        let reach = 2.0 * speed * scene.time.step + 0.5 * method.length_scale();
        if let Err(error) = method.begin_step(&model.reference, reach) {
            problems.add(key.clone(), item.label(), error.to_string(), "mend the surfaces");
        }
        // The softer body decides how the two terms of the complementarity function balance.
        let young = bodies
            .map(|b| model.bodies[b].solid.law().small_strain_moduli().young_modulus())
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        young / method.length_scale()
    }
}

/// A warning if two bodies lie in each other: what is deeper behind a surface than the search looks has no partner there.
#[cfg(any(feature = "nts", feature = "mortar"))]
fn overlap(label: &str, [(slave, slave_mesh), (master, master_mesh)]: [(&String, &Mesh); 2]) -> Option<String> {
    use super::overlap::Locator;
    let in_master = Locator::new(master_mesh).centres_of(slave_mesh);
    let in_slave = Locator::new(slave_mesh).centres_of(master_mesh);
    (in_master + in_slave > 0).then(|| {
        format!(
            "{label}: the bodies lie in each other: {in_master} elements of `{slave}` have their centre inside `{master}`, {in_slave} \
             of `{master}` inside `{slave}`; a node deeper behind a surface than the length of a facet finds no partner and is not \
             kept out: move one of the bodies"
        )
    })
}

/// True if all components of all nodes of a surface are prescribed.
#[cfg(any(feature = "nts", feature = "mortar"))]
fn is_prescribed(model: &Model, facets: &[[u32; 4]]) -> bool {
    let mut prescribed = std::collections::BTreeSet::new();
    for prescription in &model.prescriptions {
        for &node in &prescription.nodes {
            prescribed.extend(prescription.components.iter().map(|&component| (node, component)));
        }
    }
    facets.iter().flatten().all(|&node| (0..3).all(|component| prescribed.contains(&(node, component))))
}

#[cfg(not(any(feature = "nts", feature = "mortar")))]
pub(super) fn contacts(scene: &Scene, _: &[Placed], _: &mut Model, problems: &mut Problems<'_>, _: &mut Vec<String>) {
    for (c, item) in scene.contacts.iter().enumerate() {
        not_built_in(format!("contact[{c}]"), item, problems);
    }
}
