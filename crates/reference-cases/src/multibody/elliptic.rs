//! Jacobi's elliptic functions.

use std::f64::consts::FRAC_PI_2;

/// `(sn, cn, dn)` of `u` for the parameter `m = k^2` in `[0, 1)`, by the descending sequence of arithmetic and geometric means (Abramowitz and Stegun,
/// *Handbook of Mathematical Functions*, 16.4).
pub fn jacobi(u: f64, m: f64) -> (f64, f64, f64) {
    let (a, c) = means(m);
    let last = a.len() - 1;
    let mut phi = a[last] * u * f64::from(1u32 << last);
    let mut before = phi;
    for n in (1..=last).rev() {
        before = phi;
        phi = 0.5 * (phi + (c[n] / a[n] * phi.sin()).asin());
    }
    let (sn, cn) = phi.sin_cos();
    // 16.4.4: dn = cos(phi_0) / cos(phi_1 - phi_0); where that is 0/0 the identity serves.
    let quotient = (before - phi).cos();
    let dn = if last == 0 {
        1.0
    } else if cn.abs() > 0.1 {
        cn / quotient
    } else {
        (1.0 - m * sn * sn).sqrt()
    };
    (sn, cn, dn)
}

/// The complete integral of the first kind `K(m)`, a quarter of the period of `sn` (17.6.3).
pub fn quarter_period(m: f64) -> f64 {
    let (a, _) = means(m);
    FRAC_PI_2 / a[a.len() - 1]
}

fn means(m: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut a, mut c, mut b) = (vec![1.0], vec![m.sqrt()], (1.0 - m).sqrt());
    while c[c.len() - 1].abs() > 1e-17 && a.len() < 20 {
        let last = a[a.len() - 1];
        a.push(0.5 * (last + b));
        c.push(0.5 * (last - b));
        b = (last * b).sqrt();
    }
    (a, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sn' = cn dn`, `cn' = -sn dn`, `dn' = -m sn cn`, and the two identities.
    #[test]
    fn derivatives_and_identities() {
        for m in [0.0, 0.1, 0.5, 0.9, 0.999] {
            for k in -20..40 {
                let u = 0.37 * f64::from(k);
                let (s, c, d) = jacobi(u, m);
                assert!((s * s + c * c - 1.0).abs() < 1e-14);
                assert!((d * d + m * s * s - 1.0).abs() < 1e-12, "{m} {u}");
                let h = 1e-5;
                let (ahead, behind) = (jacobi(u + h, m), jacobi(u - h, m));
                assert!(((ahead.0 - behind.0) / (2.0 * h) - c * d).abs() < 1e-8);
                assert!(((ahead.1 - behind.1) / (2.0 * h) + s * d).abs() < 1e-8);
                assert!(((ahead.2 - behind.2) / (2.0 * h) + m * s * c).abs() < 1e-8);
            }
        }
    }

    /// Sine and cosine without modulus; `K(1/2)` is 1.8540746773 (Abramowitz and Stegun, table 17.1), and `sn` is one there.
    #[test]
    fn special_values() {
        let (s, c, d) = jacobi(0.8, 0.0);
        assert!((s - 0.8_f64.sin()).abs() < 1e-15 && (c - 0.8_f64.cos()).abs() < 1e-15 && d == 1.0);
        let quarter = quarter_period(0.5);
        assert!((quarter - 1.854_074_677_301_372).abs() < 1e-14, "{quarter}");
        let (s, c, _) = jacobi(quarter, 0.5);
        assert!((s - 1.0).abs() < 1e-14 && c.abs() < 1e-14);
    }
}
