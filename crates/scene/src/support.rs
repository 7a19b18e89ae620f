//! `[[support]]`: elastic foundation, springs and dashpots to the ground.

use crate::names::named;
use crate::read::{Node, Table};
use crate::world::{World, set_reference};
use crate::{Kind, PartKind, split_set};
use stoss_scene_derive::table;

named! {
    /// Reference of stiffness and damping of a support.
    SupportPer {
        /// Per reference area of a set of facets.
        Area = "area",
        /// Per node of a set.
        Node = "node",
    }
}

/// Sine of the angle between the directions of a frame below which they count as parallel.
const SMALLEST_SINE: f64 = 1e-6;

/// `[[support]]`: springs and dashpots from a set of a deformable body to the ground, without force in the reference configuration.
#[table(context(World<'_>), check_all = support)]
pub struct Support {
    /// Set of facets, or of nodes with `per = "node"`, `body.set`.
    #[key(example = "\"block.bottom\"", by = supported_set)]
    pub set: String,
    /// Reference of `stiffness` and `damping`: per `area` of facets, or per `node`. `area` if left out.
    #[key(default = SupportPer::Area)]
    pub per: SupportPer,
    /// Axes of the springs, by two directions of any length that are not parallel: the first axis, and a direction in the plane of the first and second axis; the third axis is normal to both.
    /// The coordinate axes if left out.
    #[key(dimension = Number, direction)]
    pub frame: Option<[[f64; 3]; 2]>,
    /// Stiffness along the three axes, not negative: force per length, and per area or node. Zero if left out.
    #[key(default, dimension = [ForcePerVolume, ForcePerLength], not_negative)]
    pub stiffness: [f64; 3],
    /// Damping along the three axes, not negative: force per velocity, and per area or node. Zero if left out. It does not act in statics; a quasi-static scene needs stiffness.
    #[key(default, dimension = [ForcePerAreaVelocity, ForcePerVelocity], not_negative)]
    pub damping: [f64; 3],
}

impl Support {
    /// Orthonormal axes of stiffness and damping; `None` if the two directions of the frame are parallel.
    pub fn axes(&self) -> Option<[[f64; 3]; 3]> {
        let Some([first, second]) = self.frame else {
            return Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        };
        let unit = |v: [f64; 3]| {
            let size = v.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            let v = v.map(|x| x / size);
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            v.map(|x| x / length)
        };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let (first, second) = (unit(first), unit(second));
        let third = cross(first, second);
        let sine = third.iter().map(|x| x * x).sum::<f64>().sqrt();
        if sine.is_nan() || sine <= SMALLEST_SINE {
            return None;
        }
        let third = third.map(|x| x / sine);
        Some([first, cross(third, first), third])
    }

    /// Name of the part that the support with this number in the scene becomes.
    pub fn part_name(&self, number: usize) -> String {
        format!("support[{number}] of {}", self.set)
    }
}

fn support(support: &Support, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    if support.axes().is_none() {
        let remedy = "give the first axis and another direction, for instance [[1, 1, 0], [-1, 1, 0]]";
        return table.fail("frame", "its two directions are parallel", remedy);
    }
    if support.stiffness == [0.0; 3] && support.damping == [0.0; 3] {
        return table.fail("stiffness", "a support needs stiffness or damping", "add `stiffness = [0.0, 0.0, 1e5]`");
    }
    if support.stiffness == [0.0; 3] && world.kind == Some(Kind::QuasiStatic) {
        return table.fail(
            "damping",
            "a quasi-static scene has no velocities: dashpots alone exert no force",
            "add `stiffness`, remove the support, or set [scene] kind = \"dynamic\"",
        );
    }
    Some(())
}

fn supported_set(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    match split_set(&text).and_then(|(part, _)| world.part(part)) {
        Some(part) if part.kind != PartKind::Body => node.fail(
            format!("`{}` is {}: a support acts on deformable bodies", part.name, part.kind.noun()),
            "use a [[spring]] or a [[joint]] to the ground",
        ),
        _ => Some(text),
    }
}
