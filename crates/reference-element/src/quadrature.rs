//! Gauss-Legendre rules on the square and the cube.
//!
//! A rule of `n` points per direction is exact for polynomials up to degree `2 n - 1` in each coordinate; its weights add up
//! to 4 or 8. The `2 x 2 x 2` rule integrates the mass matrix of a parallelepiped exactly (theory/elements#mass).
//!
//! Rules for tetrahedra and wedges follow; their weights add up to 1/6 and 1. Those for triangles are in [`crate::triangle`].

/// `1 / sqrt(3)`, the coordinate of the two-point rule.
pub const GAUSS_2: f64 = 0.577_350_269_189_625_8;

const LINE_2: [(f64, f64); 2] = [(-GAUSS_2, 1.0), (GAUSS_2, 1.0)];
const LINE_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

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

/// The `3 x 3` rule on the square.
pub const GAUSS_QUAD_3: [([f64; 2], f64); 9] = {
    let mut rule = [([0.0; 2], 0.0); 9];
    let mut i = 0;
    while i < 9 {
        let (a, b) = (LINE_3[i % 3], LINE_3[i / 3]);
        rule[i] = ([a.0, b.0], a.1 * b.1);
        i += 1;
    }
    rule
};

/// The `3 x 3 x 3` rule on the cube; the first coordinate runs fastest.
pub const GAUSS_HEX_3: [([f64; 3], f64); 27] = {
    let mut rule = [([0.0; 3], 0.0); 27];
    let mut i = 0;
    while i < 27 {
        let (a, b, c) = (LINE_3[i % 3], LINE_3[i / 3 % 3], LINE_3[i / 9]);
        rule[i] = ([a.0, b.0, c.0], a.1 * b.1 * c.1);
        i += 1;
    }
    rule
};

/// The centre of the tetrahedron, degree 1.
pub const TET_1: [([f64; 3], f64); 1] = [([0.25; 3], 1.0 / 6.0)];

/// `(5 - sqrt 5) / 20`.
const FOUR: f64 = 0.138_196_601_125_010_5;

/// 4 points in the tetrahedron, degree 2.
pub const TET_4: [([f64; 3], f64); 4] = [
    ([FOUR, FOUR, FOUR], 1.0 / 24.0),
    ([1.0 - 3.0 * FOUR, FOUR, FOUR], 1.0 / 24.0),
    ([FOUR, 1.0 - 3.0 * FOUR, FOUR], 1.0 / 24.0),
    ([FOUR, FOUR, 1.0 - 3.0 * FOUR], 1.0 / 24.0),
];

/// 8 points of the tetrahedron, degree 3: the corners (weight 1/40 of the volume) and the centres of the faces (9/40).
pub const TET_8: [([f64; 3], f64); 8] = {
    const C: f64 = 1.0 / 240.0;
    const F: f64 = 9.0 / 240.0;
    const T: f64 = 1.0 / 3.0;
    [
        ([0.0, 0.0, 0.0], C),
        ([1.0, 0.0, 0.0], C),
        ([0.0, 1.0, 0.0], C),
        ([0.0, 0.0, 1.0], C),
        ([T, T, T], F),
        ([0.0, T, T], F),
        ([T, 0.0, T], F),
        ([T, T, 0.0], F),
    ]
};

/// 14 points in the tetrahedron, degree 5, all weights positive (Walkington 2000).
pub const TET_14: [([f64; 3], f64); 14] = {
    const A: f64 = 0.310_885_919_263_300_6;
    const B: f64 = 0.092_735_250_310_891_23;
    const C: f64 = 0.045_503_704_125_649_65;
    const D: f64 = 0.5 - C;
    const WA: f64 = 0.112_687_925_718_015_85 / 6.0;
    const WB: f64 = 0.073_493_043_116_361_95 / 6.0;
    const WC: f64 = 0.042_546_020_777_081_466 / 6.0;
    [
        ([A, A, A], WA),
        ([1.0 - 3.0 * A, A, A], WA),
        ([A, 1.0 - 3.0 * A, A], WA),
        ([A, A, 1.0 - 3.0 * A], WA),
        ([B, B, B], WB),
        ([1.0 - 3.0 * B, B, B], WB),
        ([B, 1.0 - 3.0 * B, B], WB),
        ([B, B, 1.0 - 3.0 * B], WB),
        ([C, C, D], WC),
        ([C, D, C], WC),
        ([D, C, C], WC),
        ([D, D, C], WC),
        ([D, C, D], WC),
        ([C, D, D], WC),
    ]
};

/// 3 points of the triangle times 2 of the line, degree 2.
pub const WEDGE_6: [([f64; 3], f64); 6] = {
    let mut rule = [([0.0; 3], 0.0); 6];
    let mut i = 0;
    while i < 6 {
        let (t, l) = (crate::triangle::THREE[i % 3], LINE_2[i / 3]);
        rule[i] = ([t.0[0], t.0[1], l.0], t.1 * l.1);
        i += 1;
    }
    rule
};

/// 7 points of the triangle times 3 of the line, degree 5.
pub const WEDGE_21: [([f64; 3], f64); 21] = {
    let mut rule = [([0.0; 3], 0.0); 21];
    let mut i = 0;
    while i < 21 {
        let (t, l) = (crate::triangle::SEVEN[i % 7], LINE_3[i / 7]);
        rule[i] = ([t.0[0], t.0[1], l.0], t.1 * l.1);
        i += 1;
    }
    rule
};
