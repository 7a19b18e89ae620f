//! The numbers by which a frame can be coloured.

use serde::Serialize;

use crate::vtu::{Array, Grid};

/// Number that is taken of an array to colour by, as its size or a component.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "index", rename_all = "snake_case")]
enum Part {
    /// The number itself, or the length of a vector.
    Size,
    /// A principal value of a symmetric tensor, the largest first.
    Principal(usize),
    /// The von Mises stress `sqrt(3/2 S:S)` of a stress with the deviator `S`.
    VonMises,
    /// The equivalent strain `sqrt(2/3 e:e)` of a strain with the deviator `e`.
    Equivalent,
    /// Minus the mean of the principal values.
    Pressure,
    /// One of the numbers.
    Component(usize),
    /// Determinant of a tensor of nine components.
    Determinant,
}

/// Order of principal values.
const PLACES: [&str; 3] = ["largest", "middle", "smallest"];

/// A scalar field of the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Field {
    /// Name of the field for people.
    pub label: String,
    /// Array of the frames.
    #[serde(skip)]
    pub array: String,
    part: Part,
}

impl Field {
    /// All fields of a frame, those of an array one behind the other.
    pub fn of(grid: &Grid) -> Vec<Self> {
        let arrays = grid.point_data.iter().filter(|(name, _)| !is_made_of_stress(name, grid));
        let has_von_mises = grid.point_data.contains_key("von_mises");
        arrays.flat_map(|(name, array)| Self::of_array(name, array.components, has_von_mises)).collect()
    }

    fn of_array(name: &str, components: usize, has_von_mises: bool) -> Vec<Self> {
        let words = label(name);
        let field = |label: &str, part| Self { label: label.to_owned(), array: name.to_owned(), part };
        let mut fields = Vec::new();
        match (name, components) {
            ("principal_stresses", 3) => {
                let principal = |k: usize| field(&format!("{} principal cauchy stress", PLACES[k]), Part::Component(k));
                return (0..3).map(principal).collect();
            }
            (_, 6) => {
                if name == "cauchy_stress" && !has_von_mises {
                    fields.push(field("von Mises stress", Part::VonMises));
                } else if name.ends_with("strain") {
                    fields.push(field(&format!("equivalent {words}"), Part::Equivalent));
                }
                for (k, place) in PLACES.into_iter().enumerate() {
                    fields.push(field(&format!("{place} principal {words}"), Part::Principal(k)));
                }
                if name.ends_with("stress") {
                    fields.push(field(&format!("pressure of {words}"), Part::Pressure));
                }
            }
            (_, 9) => fields.push(field(&format!("determinant of {words}"), Part::Determinant)),
            _ => fields.push(field(&words, Part::Size)),
        }
        let endings = if components > 1 { endings(name, components) } else { Vec::new() };
        for (k, ending) in endings.iter().enumerate() {
            fields.push(field(&format!("{words} {ending}"), Part::Component(k)));
        }
        fields
    }

    /// Name of the field in a command line: that of the array, or what is taken of it.
    pub fn name(&self) -> String {
        match self.part {
            Part::Size => self.array.clone(),
            Part::VonMises => "von_mises".to_owned(),
            _ => self.label.replace(' ', "_"),
        }
    }

    /// Value of the field at each of these points, no number where it has none.
    pub fn values(&self, grid: &Grid, points: &[usize]) -> Vec<f32> {
        let Some(array) = grid.point_data.get(&self.array) else { return vec![f32::NAN; points.len()] };
        points.iter().map(|&point| self.value(array, point) as f32).collect()
    }

    fn value(&self, array: &Array, point: usize) -> f64 {
        match (self.part, array.row(point)) {
            (Part::Principal(k), &[xx, yy, zz, xy, yz, xz]) => principal([xx, yy, zz, xy, yz, xz])[k],
            (Part::VonMises, &[xx, yy, zz, xy, yz, xz]) => (1.5 * deviator([xx, yy, zz, xy, yz, xz])).sqrt(),
            (Part::Equivalent, &[xx, yy, zz, xy, yz, xz]) => (deviator([xx, yy, zz, xy, yz, xz]) / 1.5).sqrt(),
            (Part::Pressure, [xx, yy, zz, ..]) => -(xx + yy + zz) / 3.0,
            (Part::Component(k), row) => row[k],
            (Part::Determinant, &[a, b, c, d, e, f, g, h, i]) => {
                a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
            }
            _ => array.magnitude(point),
        }
    }
}

/// Name of an array for people.
pub fn label(array: &str) -> String {
    match array {
        "contact_status" => "contact status (1 sticks, 2 slides or has no friction)".to_owned(),
        "von_mises" => "von Mises stress".to_owned(),
        _ => array.replace('_', " "),
    }
}

/// Whether an array of a frame follows from the stress that the frame has.
pub fn is_made_of_stress(array: &str, grid: &Grid) -> bool {
    array == "principal_stresses" && grid.point_data.contains_key("cauchy_stress")
}

/// What the names of the components of an array end with.
pub fn endings(array: &str, components: usize) -> Vec<String> {
    const AXES: [&str; 3] = ["x", "y", "z"];
    match (array, components) {
        ("principal_stresses", _) => (1..=components).map(|k| k.to_string()).collect(),
        (_, 3) => AXES.map(str::to_owned).to_vec(),
        (_, 6) => ["xx", "yy", "zz", "xy", "yz", "xz"].map(str::to_owned).to_vec(),
        (_, 9) => AXES.iter().flat_map(|a| AXES.map(|b| format!("{a}{b}"))).collect(),
        _ => (1..=components).map(|k| k.to_string()).collect(),
    }
}

/// The square `S:S` of the deviator of the symmetric tensor `xx yy zz xy yz xz`.
fn deviator([xx, yy, zz, xy, yz, xz]: [f64; 6]) -> f64 {
    let mean = (xx + yy + zz) / 3.0;
    let squares: f64 = [xx, yy, zz].map(|entry| (entry - mean) * (entry - mean)).iter().sum();
    squares + 2.0 * (xy * xy + yz * yz + xz * xz)
}

/// Principal values of the symmetric tensor `xx yy zz xy yz xz`, the largest first: with mean `m`, deviator `D` and
/// `p^2 = D:D / 6` they are `m + 2 p cos(phi + 2 pi k / 3)`, `cos(3 phi) = det(D / p) / 2` (O. K. Smith, Comm. ACM 4, 1961, 168).
pub fn principal([xx, yy, zz, xy, yz, xz]: [f64; 6]) -> [f64; 3] {
    let mean = (xx + yy + zz) / 3.0;
    let [a, b, c] = [xx - mean, yy - mean, zz - mean];
    let p = ((a * a + b * b + c * c + 2.0 * (xy * xy + yz * yz + xz * xz)) / 6.0).sqrt();
    // Not a number stays one.
    if p == 0.0 {
        return [mean; 3];
    }
    let [a, b, c, d, e, f] = [a, b, c, xy, yz, xz].map(|entry| entry / p);
    let determinant = a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f);
    let phi = (determinant / 2.0).clamp(-1.0, 1.0).acos() / 3.0;
    let third = 2.0 * std::f64::consts::FRAC_PI_3;
    let [largest, smallest] = [phi, phi + third].map(|angle| mean + 2.0 * p * angle.cos());
    [largest, 3.0 * mean - largest - smallest, smallest]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtu::tests::cube;
    use proptest::prelude::*;

    proptest! {
        /// Sum, sum of squares and determinant of the principal values are those of the tensor.
        #[test]
        fn invariants_are_kept(t in prop::array::uniform6(-10.0..10.0_f64)) {
            let [xx, yy, zz, xy, yz, xz] = t;
            let [a, b, c] = principal(t);
            prop_assert!(a >= b - 1e-9 && b >= c - 1e-9);
            let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
            let squares = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz);
            prop_assert!((a + b + c - xx - yy - zz).abs() < 1e-11);
            prop_assert!((a * a + b * b + c * c - squares).abs() < 1e-9);
            prop_assert!((a * b * c - determinant).abs() < 1e-8);
        }
    }

    #[test]
    fn shear_and_pressure() {
        assert_eq!(principal([2.0, 2.0, 2.0, 0.0, 0.0, 0.0]), [2.0; 3]);
        let [a, b, c] = principal([0.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
        assert!((a - 3.0).abs() < 1e-14 && b.abs() < 1e-14 && (c + 3.0).abs() < 1e-14);
        assert!(principal([f64::NAN; 6]).iter().all(|value| value.is_nan()));
    }

    /// A uniaxial stress is its own von Mises stress; the equivalent strain of an extension without change of volume is the extension.
    #[test]
    fn uniaxial_states() {
        let value = |name: &str, row: [f64; 6]| {
            let mut grid = cube(&[1.0; 8]);
            grid.point_data.insert(name.into(), Array { components: 6, values: row.repeat(8) });
            Field::of(&grid)[0].values(&grid, &[3])[0]
        };
        assert!((value("cauchy_stress", [0.0, -7.0, 0.0, 0.0, 0.0, 0.0]) - 7.0).abs() < 1e-6);
        assert!((value("cauchy_stress", [2.0, 2.0, 2.0, 3.0, 0.0, 0.0]) - 27.0_f32.sqrt()).abs() < 1e-6);
        assert!((value("plastic_strain", [0.2, -0.1, -0.1, 0.0, 0.0, 0.0]) - 0.2).abs() < 1e-7);
    }

    #[test]
    fn arrays_give_components_and_what_is_made_of_them() {
        let mut grid = cube(&[1.0; 8]);
        let array = |components, value| Array { components, values: vec![value; 8 * components] };
        grid.point_data.insert("cauchy_stress".into(), array(6, 0.0));
        grid.point_data.insert("displacement".into(), array(3, 1.0));
        let names = |grid: &Grid| Field::of(grid).iter().map(Field::name).collect::<Vec<_>>();
        let mut expected = vec![
            "von_mises",
            "largest_principal_cauchy_stress",
            "middle_principal_cauchy_stress",
            "smallest_principal_cauchy_stress",
            "pressure_of_cauchy_stress",
            "cauchy_stress_xx",
            "cauchy_stress_yy",
            "cauchy_stress_zz",
            "cauchy_stress_xy",
            "cauchy_stress_yz",
            "cauchy_stress_xz",
            "displacement",
            "displacement_x",
            "displacement_y",
            "displacement_z",
            "speed",
        ];
        assert_eq!(names(&grid), expected);
        assert_eq!(Field::of(&grid)[11].values(&grid, &[3, 4]), [3.0_f32.sqrt(); 2]);
        // Principal stresses are offered once, under one name, and so is the von Mises stress.
        grid.point_data.insert("principal_stresses".into(), array(3, 1.0));
        grid.point_data.insert("von_mises".into(), array(1, 1.0));
        expected.rotate_left(1);
        assert_eq!(names(&grid), expected);
        grid.point_data.remove("cauchy_stress");
        assert_eq!(names(&grid)[4..7], expected[..3]);
        let mut row = vec![2.0, 0.5, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 3.0];
        row = row.repeat(8);
        grid.point_data.insert("deformation_gradient".into(), Array { components: 9, values: row });
        grid.point_data.insert("green_lagrange_strain".into(), array(6, 0.0));
        let fields = Field::of(&grid);
        assert_eq!(fields[0].name(), "determinant_of_deformation_gradient");
        assert!((fields[0].values(&grid, &[7])[0] - 5.85).abs() < 1e-6);
        assert_eq!((fields[2].name().as_str(), fields[2].values(&grid, &[7])[0]), ("deformation_gradient_xy", 0.5));
        assert!(fields.iter().any(|field| field.label == "middle principal green lagrange strain"));
        assert!(!fields.iter().any(|field| field.label == "pressure of green lagrange strain"));
        grid.point_data.clear();
        assert!(fields[5].values(&grid, &[3]).iter().all(|value| value.is_nan()));
    }
}
