//! Angular velocity from directors.

/// Angular velocity (three values, 1/time) of three orthogonal directors `D_k` of equal length `l` at positions `q` and velocities `v`: `1/2 sum_k D_k x D_k' / l^2`; a mean value if the directors do not
/// rotate rigidly. `directions` are the numbers of the three vectors.
pub fn angular_velocity(directions: impl IntoIterator<Item = u32>, q: &[f64], v: &[f64]) -> [f64; 3] {
    let mut spin = [0.0; 3];
    for vector in directions {
        let first = 3 * vector as usize;
        let (d, v) = (&q[first..first + 3], &v[first..first + 3]);
        let square: f64 = d.iter().map(|d| d * d).sum();
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            spin[i] += 0.5 * (d[j] * v[k] - d[k] * v[j]) / square;
        }
    }
    spin
}
