//! What materials of bodies have beside an elastic law: plasticity, Maxwell branches, softening, fibres (theory/inelastic).

use crate::names::named;
use crate::read::{Node, Table};
use stoss_materials::{
    FibreFamilies, Fibres as GivenFibres, Hardening as Curve, Moduli as Given, Mullins as Softening, Overstress,
    Plasticity as Yielding,
};
use stoss_scene_derive::table;

named! {
    /// What the moduli of a law with `prony` are.
    Moduli {
        /// Those of fast strains: the branches take their shares out of them.
        Instantaneous = "instantaneous",
        /// Those that are left when all branches have relaxed.
        LongTerm = "long-term",
    }
}

impl From<Moduli> for Given {
    fn from(moduli: Moduli) -> Self {
        match moduli {
            Moduli::Instantaneous => Self::Instantaneous,
            Moduli::LongTerm => Self::LongTerm,
        }
    }
}

/// Von Mises plasticity. The yield stress is that of the Kirchhoff stress, plastic strains are logarithmic.
#[table(example = "{ yield_stress = 400.0, hardening_modulus = 100.0 }", check_all = |found: &Self, table, _| found.fits(table))]
pub struct Plasticity {
    /// Yield stress of the virgin material, positive (stress). Not together with `hardening`.
    #[key(dimension = Stress, positive)]
    pub yield_stress: Option<f64>,
    /// Isotropic hardening as a table of points `[plastic strain, yield stress]`, from the strain 0 on; linear between the points, constant behind the last one. In place of `yield_stress`.
    #[key(default, skip, dimension = [Number, Stress])]
    pub hardening: Vec<[f64; 2]>,
    /// Slope of linear isotropic hardening (stress); 0 if left out.
    #[key(default, skip, dimension = Stress)]
    pub hardening_modulus: f64,
    /// Yield stress that exponential hardening tends to (Voce), positive (stress); together with `saturation_rate`.
    #[key(dimension = Stress, positive)]
    pub saturation_stress: Option<f64>,
    /// How fast it does: `1 - exp(-saturation_rate a)` of the way at the plastic strain `a`; positive.
    #[key(dimension = Number, positive)]
    pub saturation_rate: Option<f64>,
    /// Slope of linear kinematic hardening in uniaxial stress, not negative (stress); 0 if left out.
    #[key(default, skip, dimension = Stress, not_negative)]
    pub kinematic_modulus: f64,
    /// Overstress that grows with the rate; none if left out.
    pub rate: Option<Rate>,
}

/// Overstress `stress (a' / rate)^exponent` above the yield stress, of the rate `a'` of the equivalent plastic strain.
#[table(example = "{ stress = 200.0, rate = 1e4, exponent = 0.3 }")]
#[derive(Copy)]
pub struct Rate {
    /// Overstress at the rate `rate`, positive (stress).
    #[key(dimension = Stress, example = "200.0", positive)]
    pub stress: f64,
    /// Rate of the equivalent plastic strain, positive (1/time).
    #[key(dimension = Rate, example = "1e4", positive)]
    pub rate: f64,
    /// Exponent, positive.
    #[key(dimension = Number, example = "0.3", positive)]
    pub exponent: f64,
}

/// Softening of filled rubber below the largest energy so far (Ogden and Roxburgh).
#[table(example = "{ r = 1.5, m = 0.3 }")]
#[derive(Copy)]
pub struct Mullins {
    /// Above 1: the stress goes down to `1 - 1/r` of that of the virgin material.
    #[key(dimension = Number, example = "1.5", positive)]
    pub r: f64,
    /// Energy per volume over which it does, positive (stress).
    #[key(dimension = Stress, example = "0.3", positive)]
    pub m: f64,
    /// Part of the largest energy that is added to `m`, not negative; 0 if left out.
    #[key(default, skip, dimension = Number, not_negative)]
    pub beta: f64,
}

impl Plasticity {
    /// Reports a key that does not fit the others.
    fn fits(&self, table: &Table<'_>) -> Option<()> {
        let voce = [self.saturation_stress, self.saturation_rate];
        let has_table = !self.hardening.is_empty();
        if has_table
            && (self.yield_stress.is_some() || voce.iter().any(Option::is_some) || self.hardening_modulus != 0.0)
        {
            let remedy = "remove the table, or yield_stress, hardening_modulus, saturation_stress and saturation_rate";
            return table.fail("hardening", "has all of isotropic hardening, and other keys say it too", remedy);
        }
        if !has_table && self.yield_stress.is_none() {
            return table.missing("yield_stress", "yield_stress = 400.0");
        }
        match voce {
            [Some(_), None] => table.missing("saturation_rate", "saturation_rate = 17.0"),
            [None, Some(_)] => table.missing("saturation_stress", "saturation_stress = 700.0"),
            _ => Some(()),
        }
    }

    /// The plasticity as the catalogue of laws has it.
    pub(crate) fn yielding(&self) -> Yielding {
        let hardening = if self.hardening.is_empty() {
            let s0 = self.yield_stress.unwrap_or(f64::NAN);
            Curve::Voce {
                s0,
                h: self.hardening_modulus,
                saturation: self.saturation_stress.unwrap_or(s0),
                rate: self.saturation_rate.unwrap_or(1.0),
            }
        } else {
            Curve::Table(self.hardening.iter().map(|&[a, stress]| (a, stress)).collect())
        };
        let overstress = self.rate.map(|Rate { stress, rate, exponent }| Overstress { stress, rate, exponent });
        Yielding { hardening, kinematic: self.kinematic_modulus, overstress }
    }
}

impl From<Mullins> for Softening {
    fn from(Mullins { r, m, beta }: Mullins) -> Self {
        Self { r, m, beta }
    }
}

/// Fibres of Holzapfel, Gasser and Ogden: `k1/(2 k2) (exp(k2 <E>^2) - 1)` for each family, with `E = dispersion (J^(-2/3) I1 - 3) + (1 - 3 dispersion) (I4 - 1)`
/// and the square `I4` of the isochoric stretch along the fibres. They carry tension only. Directions are given in one of three ways: `direction`, `field`, or `axis`.
#[table(example = "{ k1 = 1.0, k2 = 10.0, direction = [1, 0, 0] }", check_all = |found: &Self, table, _| found.fits(table))]
pub struct Fibres {
    /// Stiffness, positive (stress).
    #[key(dimension = Stress, example = "1.0", positive)]
    pub k1: f64,
    /// How fast they stiffen, positive.
    #[key(dimension = Number, example = "10.0", positive)]
    pub k2: f64,
    /// How far they scatter about their direction, from 0 (not at all, if left out) to 1/3 (in all directions alike).
    #[key(default, skip, dimension = Number, read = dispersion)]
    pub dispersion: f64,
    /// Direction of one family, everywhere the same, in the axes of the scene, of the undeformed body in its place.
    #[key(dimension = Number, direction)]
    pub direction: Option<[f64; 3]>,
    /// Names of vectors of the cells in the mesh file (VTU), a family each; they turn with the `rotation` of the body.
    #[key(default, skip)]
    pub field: Vec<String>,
    /// Axis of a cylinder: two families around it, which rise along the axis by plus and minus `angle`.
    #[key(dimension = Number, direction)]
    pub axis: Option<[f64; 3]>,
    /// A point of the axis (three lengths); the origin if left out.
    #[key(dimension = Length)]
    pub point: Option<[f64; 3]>,
    /// Angle of the fibres with the circumference in degrees, from 0 to 90; with `axis`.
    #[key(dimension = Angle, read = angle)]
    pub angle: Option<f64>,
}

impl Fibres {
    /// The families of fibres as the catalogue of laws has them. Directions that differ from element to element are any.
    pub(crate) fn families(&self) -> FibreFamilies {
        let any = [1.0, 0.0, 0.0];
        let directions = match (self.direction, self.axis) {
            (Some(direction), _) => vec![direction],
            (None, Some(_)) => vec![any; 2],
            (None, None) => vec![any; self.field.len()],
        };
        let fibres = GivenFibres { stiffness: self.k1, exponent: self.k2, dispersion: self.dispersion };
        FibreFamilies { fibres, directions }
    }

    /// Reports a key that does not fit the others.
    fn fits(&self, table: &Table<'_>) -> Option<()> {
        const REMEDY: &str = "give one of them";
        let ways = [self.direction.is_some(), !self.field.is_empty(), self.axis.is_some()];
        match ways.iter().filter(|has| **has).count() {
            0 => {
                let message = "is missing, and so are `field` and `axis`";
                return table.fail("direction", message, "add direction = [1, 0, 0]");
            }
            1 => {}
            _ => {
                let key = if self.direction.is_some() { "direction" } else { "field" };
                return table.fail(key, "directions are given twice, by `direction`, `field` or `axis`", REMEDY);
            }
        }
        if self.axis.is_some() && self.angle.is_none() {
            return table.fail("angle", "is missing", "add angle = 45.0, in degrees from the circumference");
        }
        if self.axis.is_none() && self.angle.is_some() {
            return table.fail("angle", "has no effect without `axis`", "remove it, or give the axis");
        }
        if self.axis.is_none() && self.point.is_some() {
            return table.fail("point", "has no effect without `axis`", "remove it, or give the axis");
        }
        Some(())
    }
}

fn dispersion(node: &Node<'_>) -> Option<f64> {
    match node.number()? {
        value if (0.0..=1.0 / 3.0).contains(&value) => Some(value),
        _ => node.fail("must be from 0 to 1/3", "choose 0 for fibres that do not scatter"),
    }
}

fn angle(node: &Node<'_>) -> Option<f64> {
    match node.number()? {
        value if (0.0..=90.0).contains(&value) => Some(value),
        _ => node.fail("must be from 0 to 90 degrees", "0 is around the axis, 90 along it"),
    }
}
