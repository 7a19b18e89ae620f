//! Orders of convergence by regression.

/// An order with its confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Slope of the errors over the sizes, both logarithmic.
    pub value: f64,
    /// Half of the interval in which it is with a probability of 95 %, by Student's distribution; infinite from two points.
    pub confidence: f64,
}

/// Two-sided quantiles of Student's distribution at 95 % for 1 to 8 degrees of freedom (Abramowitz and Stegun, table 26.10).
const STUDENT: [f64; 8] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306];

/// Least squares through `(size, error)`; `None` from fewer than two points with positive errors.
pub fn order(points: &[(f64, f64)]) -> Option<Order> {
    let points: Vec<(f64, f64)> =
        points.iter().filter(|p| p.0 > 0.0 && p.1 > 0.0 && p.1.is_finite()).map(|p| (p.0.ln(), p.1.ln())).collect();
    let count = points.len();
    if count < 2 {
        return None;
    }
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count as f64;
    let (x, y) = (mean(&mut points.iter().map(|p| p.0)), mean(&mut points.iter().map(|p| p.1)));
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    if spread == 0.0 {
        return None;
    }
    let value = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
    let residual: f64 = points.iter().map(|p| (p.1 - y - value * (p.0 - x)).powi(2)).sum();
    let confidence = match count - 2 {
        0 => f64::INFINITY,
        freedom => STUDENT[(freedom - 1).min(STUDENT.len() - 1)] * (residual / freedom as f64 / spread).sqrt(),
    };
    Some(Order { value, confidence })
}

impl Order {
    /// As tables show it.
    pub fn text(&self) -> String {
        if self.confidence.is_finite() {
            format!("{:.2} ± {:.2}", self.value, self.confidence)
        } else {
            format!("{:.2}", self.value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_power_has_its_order_and_no_doubt() {
        let points: Vec<(f64, f64)> = [1.0, 0.5, 0.25, 0.125].map(|h: f64| (h, 3.0 * h.powi(2))).to_vec();
        let found = order(&points).unwrap();
        assert!((found.value - 2.0).abs() < 1e-12 && found.confidence < 1e-12);
        assert_eq!(order(&points[..1]), None);
        assert_eq!(order(&points[..2]).unwrap().confidence, f64::INFINITY);
        assert_eq!(order(&[(1.0, 1.0), (1.0, 2.0)]), None);
    }

    #[test]
    fn the_interval_is_that_of_least_squares() {
        // Slope and standard error of y = 1, 2, 4 over x = 0, 1, 2: 1.5 and sqrt(1/6 / 2); one degree of freedom.
        let points = [0.0, 1.0, 2.0].map(f64::exp).into_iter().zip([1.0, 2.0, 4.0].map(f64::exp)).collect::<Vec<_>>();
        let found = order(&points).unwrap();
        assert!((found.value - 1.5).abs() < 1e-12);
        assert!((found.confidence - 12.706 * (1.0_f64 / 12.0).sqrt()).abs() < 1e-9);
    }
}
