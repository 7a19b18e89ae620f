//! Arithmetic of three numbers, for checks of directions.

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| factor * x)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// Euclidean norm, without overflow.
pub(crate) fn norm(a: [f64; 3]) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// True if two directions enclose an angle below 1e-6, in either sense. Neither is zero.
pub(crate) fn parallel(a: [f64; 3], b: [f64; 3]) -> bool {
    let (a, b) = (scaled(a, 1.0 / norm(a)), scaled(b, 1.0 / norm(b)));
    norm(cross(a, b)) < 1e-6
}

/// True if two directions are perpendicular to 1e-6. Neither is zero.
pub(crate) fn perpendicular(a: [f64; 3], b: [f64; 3]) -> bool {
    dot(scaled(a, 1.0 / norm(a)), scaled(b, 1.0 / norm(b))).abs() < 1e-6
}
