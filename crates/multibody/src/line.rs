//! Lagrange shape functions on a line and Gauss rules.

use crate::error::PartDataError;

/// Largest order of the shape functions.
pub const MAX_ORDER: usize = 3;

/// Nodes of an element of largest order.
const MAX_NODES: usize = MAX_ORDER + 1;

/// Values `N_I` and derivatives `dN_I/dxi` of the `order + 1` shape functions at one `xi` in `[-1, 1]`; nodes are equidistant and in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shapes {
    pub values: [f64; MAX_NODES],
    pub slopes: [f64; MAX_NODES],
}

/// Shape functions of an order from 1 to 3.
pub(crate) fn shapes(order: usize, xi: f64) -> Shapes {
    let node = |i: usize| 2.0 * i as f64 / order as f64 - 1.0;
    let mut shapes = Shapes { values: [0.0; MAX_NODES], slopes: [0.0; MAX_NODES] };
    for i in 0..=order {
        let others = || (0..=order).filter(|&j| j != i);
        let factor = |j: usize| (xi - node(j)) / (node(i) - node(j));
        shapes.values[i] = others().map(factor).product();
        shapes.slopes[i] =
            others().map(|k| others().filter(|&j| j != k).map(factor).product::<f64>() / (node(i) - node(k))).sum();
    }
    shapes
}

/// Points and weights of the Gauss rule on `[-1, 1]` with 1 to 4 points, exact to degree `2 points - 1` (Abramowitz and Stegun, table 25.4).
pub(crate) fn gauss(points: usize) -> &'static [(f64, f64)] {
    const ONE: [(f64, f64); 1] = [(0.0, 2.0)];
    const TWO: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];
    const THREE: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
    const FOUR: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    match points {
        0 | 1 => &ONE,
        2 => &TWO,
        3 => &THREE,
        _ => &FOUR,
    }
}

/// `int N_I ds` of each node along Lagrange elements of an order on nodes in a row, lengths: what of a force per length comes to a node.
///
/// # Errors
/// [`PartDataError::Elements`] if so many nodes are no whole number of elements.
pub fn tributary_lengths(nodes: &[[f64; 3]], order: usize) -> Result<Vec<f64>, PartDataError> {
    let elements = element_count(nodes.len(), order).ok_or(PartDataError::Elements { nodes: nodes.len(), order })?;
    let mut lengths = vec![0.0; nodes.len()];
    for element in 0..elements {
        let range = element * order..=(element + 1) * order;
        for &(xi, weight) in gauss(4) {
            let s = shapes(order, xi);
            let length = weight * norm(combine(&s.slopes[..=order], &nodes[range.clone()]));
            lengths[range.clone()].iter_mut().zip(s.values).for_each(|(l, n)| *l += n * length);
        }
    }
    Ok(lengths)
}

/// `sum_I w_I x_I`.
pub(crate) fn combine(weights: &[f64], vectors: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (w, x) in weights.iter().zip(vectors) {
        sum.iter_mut().zip(x).for_each(|(s, x)| *s += w * x);
    }
    sum
}

/// Euclidean norm.
pub(crate) fn norm(v: [f64; 3]) -> f64 {
    crate::quadratic::dot(v, v).sqrt()
}

/// `a - b`.
pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// `a x b`.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Number of elements of an order on so many nodes in a row.
pub(crate) fn element_count(nodes: usize, order: usize) -> Option<usize> {
    let valid = (1..=MAX_ORDER).contains(&order) && nodes > order && (nodes - 1).is_multiple_of(order);
    valid.then(|| (nodes - 1) / order)
}

/// Index of the node nearest to a point.
pub(crate) fn nearest(nodes: &[[f64; 3]], x: [f64; 3]) -> usize {
    let distance = |i: &usize| norm(difference(nodes[*i], x));
    // cannot fail to have a node: elements need two.
    (0..nodes.len()).min_by(|i, j| distance(i).total_cmp(&distance(j))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_reproduce_polynomials_of_their_order() {
        for order in 1..=MAX_ORDER {
            for xi in [-1.0, -0.3, 0.2, 0.9] {
                let s = shapes(order, xi);
                for power in 0..=order as i32 {
                    let node = |i: usize| (2.0 * i as f64 / order as f64 - 1.0).powi(power);
                    let value: f64 = (0..=order).map(|i| s.values[i] * node(i)).sum();
                    let slope: f64 = (0..=order).map(|i| s.slopes[i] * node(i)).sum();
                    let exact = if power == 0 { 0.0 } else { f64::from(power) * xi.powi(power - 1) };
                    assert!((value - xi.powi(power)).abs() < 1e-14 && (slope - exact).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn gauss_rules_are_exact_to_their_degree_and_no_further() {
        for points in 1..=4 {
            let integral = |p: i32| gauss(points).iter().map(|(x, w)| w * x.powi(p)).sum::<f64>();
            for p in 0..2 * points as i32 {
                let exact = if p % 2 == 0 { 2.0 / f64::from(p + 1) } else { 0.0 };
                assert!((integral(p) - exact).abs() < 1e-15 * 4.0, "{points} points, degree {p}");
            }
            let p = 2 * points as i32;
            assert!((integral(p) - 2.0 / f64::from(p + 1)).abs() > 1e-3);
        }
    }

    /// Tributary lengths of straight elements with equidistant nodes are the weights of Newton and Cotes.
    #[test]
    fn tributary_lengths_are_those_of_newton_and_cotes() {
        let weights: [&[f64]; 3] = [&[0.5, 0.5], &[1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0], &[0.125, 0.375, 0.375, 0.125]];
        for order in 1..=MAX_ORDER {
            let nodes: Vec<[f64; 3]> = (0..=2 * order).map(|i| [0.0, 0.3 * i as f64, 0.4 * i as f64]).collect();
            let lengths = tributary_lengths(&nodes, order).unwrap();
            let size = 0.5 * order as f64;
            for (i, length) in lengths.iter().enumerate() {
                let ends = if i == order { 2.0 } else { 1.0 };
                assert!((length - size * ends * weights[order - 1][i % order]).abs() < 1e-14, "{order} {i}");
            }
        }
        assert!(tributary_lengths(&[[0.0; 3]; 4], 2).is_err());
    }

    #[test]
    fn elements_need_their_nodes() {
        assert_eq!(element_count(7, 3), Some(2));
        assert_eq!(element_count(7, 2), Some(3));
        assert_eq!(element_count(6, 2), None);
        assert_eq!(element_count(1, 1), None);
        assert_eq!(element_count(5, 4), None);
        assert_eq!(element_count(5, 0), None);
    }
}
