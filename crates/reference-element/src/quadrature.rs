//! Gauss-Legendre rules on the line `[-1, 1]`, the square and the cube.
//!
//! A rule of `n` points per direction is exact for polynomials up to degree `2 n - 1` in each coordinate; its weights add up
//! to 2, 4 or 8. The `2 x 2 x 2` rule integrates the mass matrix of a parallelepiped exactly (formulation §3.1).
//!
//! Rules for triangles are in [`crate::triangle`].

/// `1 / sqrt(3)`, the coordinate of the two-point rule.
pub const GAUSS_2: f64 = 0.577_350_269_189_625_8;

const LINE_1: [(f64, f64); 1] = [(0.0, 2.0)];
const LINE_2: [(f64, f64); 2] = [(-GAUSS_2, 1.0), (GAUSS_2, 1.0)];
const LINE_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
const LINE_4: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The rule with `points` points on the line as pairs (coordinate, weight), or `None` unless `1 <= points <= 4`.
pub const fn gauss_line(points: usize) -> Option<&'static [(f64, f64)]> {
    match points {
        1 => Some(&LINE_1),
        2 => Some(&LINE_2),
        3 => Some(&LINE_3),
        4 => Some(&LINE_4),
        _ => None,
    }
}

/// The `2 x 2` rule on the square: pairs (coordinates, weight) in the order of [`crate::quad4::VERTICES`].
pub const GAUSS_QUAD_2: [([f64; 2], f64); 4] = {
    let mut rule = [([0.0; 2], 1.0); 4];
    let mut i = 0;
    while i < 4 {
        let v = crate::quad4::VERTICES[i];
        rule[i].0 = [v[0] * GAUSS_2, v[1] * GAUSS_2];
        i += 1;
    }
    rule
};

/// The `2 x 2 x 2` rule on the cube: pairs (coordinates, weight) in the order of [`crate::hex8::VERTICES`].
pub const GAUSS_HEX_2: [([f64; 3], f64); 8] = {
    let mut rule = [([0.0; 3], 1.0); 8];
    let mut i = 0;
    while i < 8 {
        let v = crate::hex8::VERTICES[i];
        rule[i].0 = [v[0] * GAUSS_2, v[1] * GAUSS_2, v[2] * GAUSS_2];
        i += 1;
    }
    rule
};

/// [`GAUSS_QUAD_2`]: points in the order of the facet's vertices, weights 1.
#[inline]
pub const fn gauss_quad_2() -> [([f64; 2], f64); 4] {
    GAUSS_QUAD_2
}

/// [`GAUSS_HEX_2`]: points in the order of the cell's vertices, weights 1.
#[inline]
pub const fn gauss_hex_2() -> [([f64; 3], f64); 8] {
    GAUSS_HEX_2
}
