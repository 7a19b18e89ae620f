//! Strains that the functions of linear hexahedra force on them, and changes of volume that the mixed form does not resist (theory/watch#locking).

use crate::Watch;
use crate::names::Names;
use crate::solids::Tangents;
use crate::words::short_time;
use crate::{Finding, FindingKind, Severity};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use stoss_mesh::Elements;
use stoss_reference_element::CellKind;

/// Part of the strain energy from which on what elements force on a body, or do not resist, is doubtful: of what is forced, displacements are too small by about as much.
const DOUBTFUL: f64 = 0.1;

/// Bulk over shear modulus above which a change of volume within an element is no part of the solution: a Poisson's ratio of 0.45.
const STIFF_VOLUME: f64 = 10.0;

/// Strain, in the mean over a body, below which it is round-off.
const ROUND_OFF: f64 = 1e-11;

/// Shear moduli with which a change of volume that nothing resists is weighed at most.
const WEIGHED: f64 = 3.0;

/// Small-strain moduli of a body, and how its elements treat the change of volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elasticity {
    /// Shear modulus (stress).
    pub shear: f64,
    /// Bulk modulus (stress).
    pub bulk: f64,
    /// Whether elements see a mean of the change of volume (the mixed form).
    pub is_mixed: bool,
}

/// Strain energies of a body in one state, by its small-strain moduli.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainEnergies {
    /// Energy of all strains.
    pub all: f64,
    /// Energy of what the shape functions cannot leave out: shears that vary along their own directions in linear hexahedra, and in nearly incompressible ones the variation of the volume.
    pub forced: f64,
    /// Energy that the variation of the volume within elements of the mixed form would have.
    pub unresisted: f64,
}

/// Deformation of one element: Green-Lagrange strains in the frame of its axes, and ratios of volume.
#[derive(Debug, Default)]
struct Deformation {
    /// Natural coordinates, volume, strain, ratio of volumes at each Gauss point.
    points: Vec<([f64; 3], f64, Matrix3<f64>, f64)>,
}

impl Deformation {
    fn of(&mut self, tangents: &Tangents, reference: &[Vector3<f64>], current: &[Vector3<f64>]) {
        self.points.clear();
        let at = |x| tangents.at(x).map(|columns| Matrix3::from_columns(&columns));
        let centre: Matrix3<f64> = at(reference).sum();
        let axes = centre.qr().q();
        for (((xi, weight), before), now) in tangents.rule.iter().zip(at(reference)).zip(at(current)) {
            let Some(inverse) = before.try_inverse() else { continue };
            let f = now * inverse;
            let strain = 0.5 * (f.transpose() * f - Matrix3::identity());
            let strain = axes.transpose() * strain * axes;
            self.points.push((*xi, weight * before.determinant().abs(), strain, f.determinant()));
        }
    }

    fn volume(&self) -> f64 {
        self.points.iter().map(|point| point.1).sum()
    }

    /// Mean over the volume.
    fn mean(&self, value: impl Fn(&([f64; 3], f64, Matrix3<f64>, f64)) -> f64) -> f64 {
        self.points.iter().map(|point| point.1 * value(point)).sum::<f64>() / self.volume()
    }

    fn energies(&self, kind: CellKind, of: &Elasticity) -> StrainEnergies {
        let volume = self.volume();
        let trace = self.mean(|point| point.2.trace());
        let ratio = self.mean(|point| point.3);
        let varies = |value: &dyn Fn(&Matrix3<f64>, f64) -> f64, mean: f64| {
            self.mean(|(_, _, strain, ratio)| (value(strain, *ratio) - mean).powi(2))
        };
        let shape =
            self.mean(|(_, _, strain, _)| (strain - Matrix3::identity() * (strain.trace() / 3.0)).norm_squared());
        let volumes = if of.is_mixed { (ratio - 1.0).powi(2) } else { self.mean(|point| point.2.trace().powi(2)) };
        let mut energies =
            StrainEnergies { all: of.shear * shape + 0.5 * of.bulk * volumes, ..StrainEnergies::default() };
        if kind == CellKind::Hex8 {
            energies.forced = 2.0 * of.shear * self.forced_shears();
            if !of.is_mixed && of.bulk > STIFF_VOLUME * of.shear {
                energies.forced += 0.5 * of.bulk * varies(&|strain, _| strain.trace(), trace);
            }
        }
        if of.is_mixed && kind != CellKind::Hex27 {
            let lame = (of.bulk - 2.0 / 3.0 * of.shear).clamp(0.0, WEIGHED * of.shear);
            energies.unresisted = 0.5 * lame * varies(&|_, ratio| ratio, ratio);
        }
        let StrainEnergies { all, forced, unresisted } = energies;
        StrainEnergies { all: volume * all, forced: volume * forced, unresisted: volume * unresisted }
    }

    /// Sum of the mean squares of the parts of the shears that are linear along one of their own two axes: a linear hexahedron that bends about the third one cannot be without.
    fn forced_shears(&self) -> f64 {
        let linear = |i: usize, j: usize, d: usize| {
            let slope = self.mean(|(xi, _, strain, _)| strain[(i, j)] * xi[d]);
            slope * slope / self.mean(|(xi, ..)| xi[d] * xi[d])
        };
        [(0, 1), (1, 2), (0, 2)].iter().map(|&(i, j)| linear(i, j, i) + linear(i, j, j)).sum()
    }
}

impl Watch {
    /// Strain energies of a body in a state `q` (three a node); nothing of a rigid one.
    pub fn strain_energies(&self, body: usize, q: &[f64], elasticity: &Elasticity) -> StrainEnergies {
        let (mut sum, mut volume) = (StrainEnergies::default(), 0.0);
        let (mut deformation, mut before, mut now) = (Deformation::default(), Vec::new(), Vec::new());
        for (kind, nodes) in self.model.bodies[body].elements().into_iter().flat_map(Elements::cells) {
            let tangents = self.shapes.tangents(kind);
            crate::solids::places(nodes, &self.model.reference, &mut before);
            crate::solids::places(nodes, q, &mut now);
            deformation.of(&tangents, &before, &now);
            let of = deformation.energies(kind, elasticity);
            sum.all += of.all;
            sum.forced += of.forced;
            sum.unresisted += of.unresisted;
            volume += deformation.volume();
        }
        let is_strained = sum.all > elasticity.shear * volume * ROUND_OFF * ROUND_OFF;
        if is_strained { sum } else { StrainEnergies::default() }
    }
}

/// The state of a body in statics that has the largest strain energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Strained {
    pub body: usize,
    all: f64,
    forced: f64,
    unresisted: f64,
    at: (u64, f64),
}

impl Strained {
    pub fn of(body: usize) -> Self {
        Self { body, ..Self::default() }
    }

    pub fn note(&mut self, at: (u64, f64), energies: &StrainEnergies) {
        let StrainEnergies { all, forced, unresisted } = *energies;
        if all > self.all {
            *self = Self { body: self.body, all, forced, unresisted, at };
        }
    }

    /// Findings, with these names.
    pub fn findings(&self, names: &Names) -> Vec<Finding> {
        let name = names.body(self.body);
        let mut found = Vec::new();
        let mut add = |energy: f64, say: &dyn Fn(f64) -> String| {
            let part = energy / self.all;
            if self.all > 0.0 && part > DOUBTFUL {
                let sentence = format!("at t = {} {}", short_time(self.at.1), say(100.0 * part));
                let finding = Finding::new(Severity::Doubtful, FindingKind::Locking, self.at, sentence, part);
                found.push(Finding { bodies: Some([self.body; 2]), ..finding });
            }
        };
        add(self.forced, &|percent| {
            format!(
                "{percent:.0} % of the strain energy of `{name}` is in strains that its linear elements cannot do without when they bend or keep their volume: it is too stiff by about as much (locking). Take \
                 `cell = \"hex20\"` or `\"hex27\"`, more elements across, and `volumetric = \"mixed\"` for nearly incompressible materials"
            )
        });
        add(self.unresisted, &|percent| {
            format!(
                "changes of volume within the elements of `{name}`, which the mixed form does not resist, are worth {percent:.0} % of its strain energy: it is too soft where it bends. Take more elements across, or \
                 `cell = \"hex27\"`"
            )
        });
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Judge, Limits, WatchBody, WatchModel, WatchShape};

    /// A box of one hexahedron with edges 2 a, 2, 2, and its image under `map`.
    fn watch(a: f64, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> (Watch, Vec<f64>) {
        let corners = CellKind::Hex8.table().nodes.iter().map(|xi| Vector3::new(a * xi[0], xi[1], xi[2]));
        let corners: Vec<Vector3<f64>> = corners.collect();
        let mut elements = Elements::new();
        elements.push(CellKind::Hex8, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let body = WatchBody { name: "bar".into(), nodes: 0..8, shape: WatchShape::Solid(elements) };
        let reference = corners.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
        let q = corners.iter().map(|&x| map(x)).flat_map(|x| [x.x, x.y, x.z]).collect();
        (Watch::new(WatchModel { bodies: vec![body], reference, ties: Vec::new() }).unwrap(), q)
    }

    fn kinds(energies: &StrainEnergies) -> usize {
        let mut judge = Judge::new([("bar".to_owned(), 0..8)], Vec::new(), Limits::default());
        judge.observe_strains(1, 0.5, 0, energies);
        judge.verdict().reasons.iter().filter(|reason| reason.kind == FindingKind::Locking).count()
    }

    /// A hexahedron that bends with the curvature `k`: `u_x = -k x z` has the strain `-k z` and the forced shear `-k x / 2`, whose mean squares are `k^2/3` and `k^2 a^2/12`.
    /// With a Poisson's ratio of zero (`K = 2 G / 3`) the energy is `G (k^2/3 + 2 k^2 a^2/12)`.
    #[test]
    fn the_shear_of_bending_is_forced() {
        let k = 1e-6;
        let elasticity = Elasticity { shear: 3.0, bulk: 2.0, is_mixed: false };
        for a in [0.5, 1.0, 10.0] {
            let (watch, q) = watch(a, |x| x - Vector3::new(k * x.x * x.z, 0.0, 0.0));
            let energies = watch.strain_energies(0, &q, &elasticity);
            let volume = 8.0 * a;
            let forced = volume * 2.0 * 3.0 * k * k * a * a / 12.0;
            let all = volume * 3.0 * k * k / 3.0 + forced;
            assert!(
                (energies.forced / forced - 1.0).abs() < 1e-5 && (energies.all / all - 1.0).abs() < 1e-5,
                "{energies:?}"
            );
            assert_eq!((energies.unresisted, kinds(&energies)), (0.0, 1));
        }
    }

    /// Homogeneous strains, large rotations and torsion (`u = c x (-e_z y + e_y z)`, whose shears vary along the third axis) are not forced.
    #[test]
    fn what_elements_can_do_is_not_forced() {
        let elasticity = Elasticity { shear: 3.0, bulk: 2e4, is_mixed: false };
        let turned = nalgebra::Rotation3::from_euler_angles(0.3, 1.2, -2.0);
        let shear = Matrix3::new(1.1, 0.2, 0.0, 0.1, 0.9, -0.3, 0.0, 0.2, 1.2);
        let (watch_of, q) = watch(2.0, |x| turned * (shear * x) + Vector3::new(5.0, 0.0, 1.0));
        let energies = watch_of.strain_energies(0, &q, &elasticity);
        assert!(energies.all > 1.0 && energies.forced < 1e-25 * energies.all, "{energies:?}");
        let c = 1e-6;
        let (watch_of, q) = watch(2.0, |x| x + c * x.x * Vector3::new(0.0, x.z, -x.y));
        let energies = watch_of.strain_energies(0, &q, &elasticity);
        assert!(energies.forced < 1e-9 * energies.all && kinds(&energies) == 0, "{energies:?}");
    }

    /// The mixed form sees the mean volume alone: bending by `u_x = -k x z` changes it by `-k z`. The law has the energy `lambda/2 (ln J)^2`, of which
    /// `lambda k^2/6` is resisted by nothing, `lambda = K - 2 G/3`.
    #[test]
    fn the_volume_of_bending_is_not_resisted_by_the_mixed_form() {
        let k = 1e-6;
        let (watch, q) = watch(0.1, |x| x - Vector3::new(k * x.x * x.z, 0.0, 0.0));
        let of = |bulk| watch.strain_energies(0, &q, &Elasticity { shear: 3.0, bulk, is_mixed: true });
        let expected = 0.8 * 4.0 * k * k / 6.0;
        assert!((of(6.0).unresisted / expected - 1.0).abs() < 1e-5 && kinds(&of(6.0)) == 1, "{:?}", of(6.0));
        assert_eq!((of(1e6).unresisted, of(2.0).unresisted), (of(11.0).unresisted, 0.0));
    }
}
