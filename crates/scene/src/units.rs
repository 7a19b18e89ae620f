//! `[scene] units`: systems of units. Labels only: nothing is converted.

use crate::names::named;

named! {
    /// A consistent system of units, named by length, mass (or force) and time: forces are mass times length over time squared.
    Units {
        /// Metre, kilogram, second: N, Pa, J.
        MKgS = "m-kg-s",
        /// Millimetre, tonne, second: N, MPa, mJ.
        MmTS = "mm-t-s",
        /// Millimetre, kilogram, millisecond: kN, GPa, J.
        MmKgMs = "mm-kg-ms",
        /// Millimetre, gram, millisecond: N, MPa, mJ.
        MmGMs = "mm-g-ms",
        /// Millimetre, kilogram, second: mN, kPa, uJ.
        MmKgS = "mm-kg-s",
        /// Centimetre, gram, second: dyn, dyn/cm2, erg.
        CmGS = "cm-g-s",
        /// Centimetre, gram, microsecond: 1e7 N, Mbar, 1e5 J.
        CmGUs = "cm-g-us",
        /// Micrometre, kilogram, second: uN, MPa, pJ.
        UmKgS = "um-kg-s",
        /// Inch, pound force, second; the mass is lbf s2/in.
        InLbfS = "in-lbf-s",
        /// Foot, pound force, second; the mass is the slug.
        FtLbfS = "ft-lbf-s",
    }
}

named! {
    /// Physical dimension of a number: of a key of the scene (`x-dimension` in its schema) or of a result.
    Dimension {
        /// Position, displacement, gap.
        Length = "length",
        /// Time.
        Time = "time",
        /// Mass.
        Mass = "mass",
        /// Force.
        Force = "force",
        /// Stress, pressure, traction, modulus.
        Stress = "stress",
        /// Energy, work.
        Energy = "energy",
        /// Moment of a force.
        Moment = "moment",
        /// Velocity.
        Velocity = "velocity",
        /// Acceleration.
        Acceleration = "acceleration",
        /// Density.
        Density = "density",
        /// Area.
        Area = "area",
        /// Linear momentum.
        Momentum = "momentum",
        /// Angular momentum.
        AngularMomentum = "angular_momentum",
        /// Angular velocity.
        AngularVelocity = "angular_velocity",
        /// Angle.
        Angle = "angle",
        /// A dimensionless number, for instance a strain.
        Number = "number",
        /// Reciprocal of a time: a rate of deformation.
        Rate = "1/time",
        /// Second moment of area.
        SecondMoment = "length⁴",
        /// Mass of a line.
        LineDensity = "mass/length",
        /// Moment of inertia of a line, per length.
        RotaryInertia = "mass length",
        /// Moment of inertia.
        MomentOfInertia = "mass length²",
        /// Stiffness of a spring.
        ForcePerLength = "force/length",
        /// Force per volume, or stiffness per area.
        ForcePerVolume = "force/length³",
        /// Stiffness of a contact: pressure or traction per gap or slip.
        StressPerLength = "stress/length",
        /// Stiffness of a cross-section in bending and torsion.
        BendingStiffness = "force length²",
        /// Coefficient of a dashpot.
        ForcePerVelocity = "force time/length",
        /// Coefficient of dashpots on an area.
        ForcePerAreaVelocity = "force time/length³",
        /// Coefficient of dashpots in a volume.
        ForcePerVolumeVelocity = "force time/length⁴",
        /// Coefficient of a rotational dashpot.
        MomentPerAngularVelocity = "moment time",
    }
}

impl Dimension {
    /// Exponents of length, mass and time.
    pub fn exponents(self) -> [i32; 3] {
        match self {
            Self::Angle | Self::Number => [0, 0, 0],
            Self::Length => [1, 0, 0],
            Self::Area => [2, 0, 0],
            Self::SecondMoment => [4, 0, 0],
            Self::Mass => [0, 1, 0],
            Self::LineDensity => [-1, 1, 0],
            Self::Density => [-3, 1, 0],
            Self::RotaryInertia => [1, 1, 0],
            Self::MomentOfInertia => [2, 1, 0],
            Self::Time => [0, 0, 1],
            Self::AngularVelocity | Self::Rate => [0, 0, -1],
            Self::Velocity => [1, 0, -1],
            Self::Acceleration => [1, 0, -2],
            Self::Momentum => [1, 1, -1],
            Self::AngularMomentum | Self::MomentPerAngularVelocity => [2, 1, -1],
            Self::Force => [1, 1, -2],
            Self::ForcePerLength => [0, 1, -2],
            Self::Stress => [-1, 1, -2],
            Self::ForcePerVolume | Self::StressPerLength => [-2, 1, -2],
            Self::Energy | Self::Moment => [2, 1, -2],
            Self::BendingStiffness => [3, 1, -2],
            Self::ForcePerVelocity => [0, 1, -1],
            Self::ForcePerAreaVelocity => [-2, 1, -1],
            Self::ForcePerVolumeVelocity => [-3, 1, -1],
        }
    }
}

/// Labels of a system, and its length, mass and time in SI.
struct System {
    length: &'static str,
    mass: &'static str,
    time: &'static str,
    force: &'static str,
    stress: &'static str,
    energy: &'static str,
    /// Metres, kilograms, seconds.
    si: [f64; 3],
}

/// Pound force, inch, foot in SI, exact by definition.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
const INCH: f64 = 0.0254;
const FOOT: f64 = 0.3048;

impl Units {
    fn system(self) -> System {
        let system = |[length, mass, time, force, stress, energy]: [&'static str; 6], si| System {
            length,
            mass,
            time,
            force,
            stress,
            energy,
            si,
        };
        match self {
            Self::MKgS => system(["m", "kg", "s", "N", "Pa", "J"], [1.0, 1.0, 1.0]),
            Self::MmTS => system(["mm", "t", "s", "N", "MPa", "mJ"], [1e-3, 1e3, 1.0]),
            Self::MmKgMs => system(["mm", "kg", "ms", "kN", "GPa", "J"], [1e-3, 1.0, 1e-3]),
            Self::MmGMs => system(["mm", "g", "ms", "N", "MPa", "mJ"], [1e-3, 1e-3, 1e-3]),
            Self::MmKgS => system(["mm", "kg", "s", "mN", "kPa", "µJ"], [1e-3, 1.0, 1.0]),
            Self::CmGS => system(["cm", "g", "s", "dyn", "dyn/cm²", "erg"], [1e-2, 1e-3, 1.0]),
            Self::CmGUs => system(["cm", "g", "µs", "10⁷ N", "Mbar", "10⁵ J"], [1e-2, 1e-3, 1e-6]),
            Self::UmKgS => system(["µm", "kg", "s", "µN", "MPa", "pJ"], [1e-6, 1.0, 1.0]),
            Self::InLbfS => system(["in", "lbf s²/in", "s", "lbf", "psi", "in lbf"], [INCH, POUND_FORCE / INCH, 1.0]),
            Self::FtLbfS => system(["ft", "slug", "s", "lbf", "lbf/ft²", "ft lbf"], [FOOT, POUND_FORCE / FOOT, 1.0]),
        }
    }

    /// The unit of a number; empty for pure numbers.
    pub fn label(self, dimension: Dimension) -> String {
        let System { length, mass, time, force, stress, energy, .. } = self.system();
        // A product of several letters in a quotient needs brackets.
        let mass_over = if mass.contains(' ') { format!("({mass})") } else { mass.to_owned() };
        match dimension {
            Dimension::Length => length.to_owned(),
            Dimension::Time => time.to_owned(),
            Dimension::Mass => mass.to_owned(),
            Dimension::Force => force.to_owned(),
            Dimension::Stress => stress.to_owned(),
            Dimension::Energy => energy.to_owned(),
            Dimension::Moment => format!("{force} {length}"),
            Dimension::Velocity => format!("{length}/{time}"),
            Dimension::Acceleration => format!("{length}/{time}²"),
            Dimension::Density => format!("{mass_over}/{length}³"),
            Dimension::Area => format!("{length}²"),
            Dimension::Momentum => format!("{force} {time}"),
            Dimension::AngularMomentum => format!("{force} {length} {time}"),
            Dimension::AngularVelocity | Dimension::Rate => format!("1/{time}"),
            Dimension::SecondMoment => format!("{length}⁴"),
            Dimension::LineDensity => format!("{mass_over}/{length}"),
            Dimension::RotaryInertia => format!("{mass_over} {length}"),
            Dimension::MomentOfInertia => format!("{mass_over} {length}²"),
            Dimension::ForcePerLength => format!("{force}/{length}"),
            Dimension::ForcePerVolume | Dimension::StressPerLength => format!("{force}/{length}³"),
            Dimension::BendingStiffness => format!("{force} {length}²"),
            Dimension::ForcePerVelocity => format!("{force} {time}/{length}"),
            Dimension::ForcePerAreaVelocity => format!("{force} {time}/{length}³"),
            Dimension::ForcePerVolumeVelocity => format!("{force} {time}/{length}⁴"),
            Dimension::MomentPerAngularVelocity => format!("{force} {length} {time}"),
            Dimension::Angle => "°".to_owned(),
            Dimension::Number => String::new(),
        }
    }

    /// What one unit of a dimension is in SI.
    pub fn in_si(self, dimension: Dimension) -> f64 {
        let powers = self.system().si.into_iter().zip(dimension.exponents());
        powers.map(|(unit, exponent)| unit.powi(exponent)).product()
    }

    /// All systems of units.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::NAMES.iter().filter_map(|name| Self::from_name(name))
    }
}

impl crate::Quantity {
    /// What its values measure.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::Displacement | Self::Position | Self::JointDisplacement => Dimension::Length,
            Self::Velocity => Dimension::Velocity,
            Self::Reaction | Self::SupportForce | Self::ContactForce | Self::JointForce | Self::EquationForce => {
                Dimension::Force
            }
            Self::ReactionMoment | Self::ContactMoment | Self::JointMoment => Dimension::Moment,
            Self::JointAngle | Self::Elevation => Dimension::Angle,
            Self::AngularVelocity => Dimension::AngularVelocity,
            Self::CauchyStress | Self::PrincipalStresses | Self::VonMises | Self::BackStress => Dimension::Stress,
            Self::GreenLagrangeStrain
            | Self::LogarithmicStrain
            | Self::DeformationGradient
            | Self::EquivalentPlasticStrain
            | Self::PlasticStrain
            | Self::Yielding
            | Self::ViscousStrain => Dimension::Number,
            Self::Energy | Self::KineticEnergy | Self::StrainEnergy => Dimension::Energy,
            Self::LinearMomentum => Dimension::Momentum,
            Self::AngularMomentum => Dimension::AngularMomentum,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels of forces, stresses and energies against their definitions in SI.
    #[test]
    fn systems_are_consistent() {
        let si = |label: &str| match label {
            "N" | "Pa" | "J" => 1.0,
            "kN" => 1e3,
            "mN" | "mJ" => 1e-3,
            "µN" | "µJ" => 1e-6,
            "pJ" => 1e-12,
            "kPa" => 1e3,
            "MPa" => 1e6,
            "GPa" => 1e9,
            "dyn" => 1e-5,
            "dyn/cm²" => 0.1,
            "erg" => 1e-7,
            "10⁷ N" => 1e7,
            "10⁵ J" => 1e5,
            "Mbar" => 1e11,
            "lbf" => 4.448_221_615_260_5,
            "psi" => 6_894.757_293_168,
            "lbf/ft²" => 47.880_258_980_336,
            "in lbf" => 0.112_984_829_027_616_7,
            "ft lbf" => 1.355_817_948_331_400_4,
            other => panic!("{other}"),
        };
        for units in Units::all() {
            for dimension in [Dimension::Force, Dimension::Stress, Dimension::Energy] {
                let label = units.label(dimension);
                let (found, expected) = (units.in_si(dimension), si(&label));
                assert!((found / expected - 1.0).abs() < 1e-12, "{units} {label}: {found}");
            }
        }
        // Steel, 7850 kg/m3.
        let steel = 7.85e-9 * Units::MmTS.in_si(Dimension::Density);
        assert!((steel - 7850.0).abs() < 1e-9);
        let steel = 7.345e-4 * Units::InLbfS.in_si(Dimension::Density);
        assert!((steel - 7850.0).abs() < 10.0, "{steel}");
        assert_eq!(Units::InLbfS.label(Dimension::Density), "(lbf s²/in)/in³");
        assert_eq!(Units::MmTS.label(Dimension::AngularMomentum), "N mm s");
        assert_eq!(Units::MmTS.label(Dimension::ForcePerAreaVelocity), "N s/mm³");
    }

    /// Exponents of a product of words with raised digits, as names of dimensions and labels of the system `m-kg-s` are.
    fn exponents_of(product: &str) -> [i32; 3] {
        let mut sum = [0; 3];
        for (place, part) in product.split('/').enumerate() {
            for factor in part.split(' ') {
                let word = factor.trim_end_matches(['²', '³', '⁴']);
                let exponent = match &factor[word.len()..] {
                    "²" => 2,
                    "³" => 3,
                    "⁴" => 4,
                    _ => 1,
                };
                let of_word = match word {
                    "1" | "°" | "" => [0, 0, 0],
                    "m" => [1, 0, 0],
                    "kg" => [0, 1, 0],
                    "s" => [0, 0, 1],
                    "N" => [1, 1, -2],
                    "Pa" => [-1, 1, -2],
                    "J" => [2, 1, -2],
                    name => Dimension::from_name(name).unwrap_or_else(|| panic!("{name} in {product}")).exponents(),
                };
                for (sum, one) in sum.iter_mut().zip(of_word) {
                    *sum += if place == 0 { exponent * one } else { -exponent * one };
                }
            }
        }
        sum
    }

    /// A dimension says the same in its exponents, in the unit of SI, and, where it is a product, in its name.
    #[test]
    fn names_and_labels_of_dimensions_say_their_exponents() {
        for name in Dimension::NAMES {
            let dimension = Dimension::from_name(name).unwrap();
            assert_eq!(exponents_of(name), dimension.exponents(), "{name}");
            let label = Units::MKgS.label(dimension);
            assert_eq!(exponents_of(&label), dimension.exponents(), "{name}: {label}");
        }
    }
}
