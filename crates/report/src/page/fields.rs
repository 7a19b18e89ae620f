//! The numbers by which a frame can be coloured.

use serde::Serialize;

use crate::vtu::{Array, Grid};

/// What is taken of an array.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// The number itself, or the length of a vector.
    Size,
    /// A principal value of a symmetric tensor, the largest first.
    Principal(usize),
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
    /// Its name for people.
    pub label: String,
    /// Array of the frames.
    #[serde(skip)]
    array: String,
    #[serde(skip)]
    part: Part,
}

impl Field {
    /// All fields of a frame. Displacement is left out: positions tell it.
    pub fn of(grid: &Grid) -> Vec<Self> {
        let field = |label: &str, array: &str, part| Self { label: label.to_owned(), array: array.to_owned(), part };
        let mut fields = Vec::new();
        for (name, array) in grid.point_data.iter().filter(|(name, _)| *name != "displacement") {
            let words = name.replace('_', " ").replace("von mises", "von Mises stress");
            let label = match name.as_str() {
                "contact_status" => "contact status (1 sticks, 2 slides or has no friction)".to_owned(),
                _ => words,
            };
            match (name.as_str(), array.components) {
                // Those that the frames have, unless they have the tensor to make them of.
                ("principal_stresses", 3) if grid.point_data.contains_key("cauchy_stress") => {}
                ("principal_stresses", 3) => fields.extend(
                    (0..3).map(|k| field(&format!("{} principal cauchy stress", PLACES[k]), name, Part::Component(k))),
                ),
                (_, 6) => {
                    for (k, place) in PLACES.into_iter().enumerate() {
                        fields.push(field(&format!("{place} principal {label}"), name, Part::Principal(k)));
                    }
                    if name.ends_with("stress") {
                        fields.push(field(&format!("pressure of {label}"), name, Part::Pressure));
                    }
                }
                (_, 9) => fields.push(field(&format!("determinant of {label}"), name, Part::Determinant)),
                _ => fields.push(field(&label, name, Part::Size)),
            }
        }
        fields
    }

    /// Its name in a command line: that of the array, or what is taken of it.
    pub fn name(&self) -> String {
        if self.part == Part::Size { self.array.clone() } else { self.label.replace(' ', "_") }
    }

    /// Its value at each of these points, no number where it has none.
    pub fn values(&self, grid: &Grid, points: &[usize]) -> Vec<f32> {
        let Some(array) = grid.point_data.get(&self.array) else { return vec![f32::NAN; points.len()] };
        points.iter().map(|&point| self.value(array, point) as f32).collect()
    }

    fn value(&self, array: &Array, point: usize) -> f64 {
        match (self.part, array.row(point)) {
            (Part::Principal(k), &[xx, yy, zz, xy, yz, xz]) => principal([xx, yy, zz, xy, yz, xz])[k],
            (Part::Pressure, [xx, yy, zz, ..]) => -(xx + yy + zz) / 3.0,
            (Part::Component(k), row) => row[k],
            (Part::Determinant, &[a, b, c, d, e, f, g, h, i]) => {
                a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
            }
            _ => array.magnitude(point),
        }
    }
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

    #[test]
    fn a_tensor_gives_four_fields_and_displacement_none() {
        let mut grid = cube(&[1.0; 8]);
        let array = |components, value| Array { components, values: vec![value; 8 * components] };
        grid.point_data.insert("cauchy_stress".into(), array(6, 0.0));
        grid.point_data.insert("displacement".into(), array(3, 1.0));
        grid.point_data.insert("velocity".into(), array(3, 2.0));
        let fields = Field::of(&grid);
        let labels: Vec<&str> = fields.iter().map(|field| field.label.as_str()).collect();
        assert_eq!(labels[..2], ["largest principal cauchy stress", "middle principal cauchy stress"]);
        assert_eq!(labels[3..], ["pressure of cauchy stress", "speed", "velocity"]);
        assert_eq!(fields[5].values(&grid, &[3, 4]), [12.0_f32.sqrt(); 2]);
        // Principal stresses are offered once, under one name; of a strain there is no pressure, of a gradient the change of volume.
        let names = |grid: &Grid| Field::of(grid).iter().map(Field::name).collect::<Vec<_>>();
        let before = names(&grid);
        grid.point_data.insert("principal_stresses".into(), array(3, 1.0));
        assert_eq!(names(&grid), before);
        grid.point_data.remove("cauchy_stress");
        assert_eq!(names(&grid)[..3], before[..3]);
        let mut row = vec![2.0, 0.5, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 3.0];
        row = row.repeat(8);
        grid.point_data.insert("deformation_gradient".into(), Array { components: 9, values: row });
        grid.point_data.insert("green_lagrange_strain".into(), array(6, 0.0));
        let fields = Field::of(&grid);
        assert_eq!(fields[0].name(), "determinant_of_deformation_gradient");
        assert!((fields[0].values(&grid, &[7])[0] - 5.85).abs() < 1e-6);
        assert!(fields.iter().any(|field| field.label == "middle principal green lagrange strain"));
        assert!(!fields.iter().any(|field| field.label == "pressure of green lagrange strain"));
        grid.point_data.clear();
        assert!(fields[5].values(&grid, &[3]).iter().all(|value| value.is_nan()));
    }
}
