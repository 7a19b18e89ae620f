//! Reference axes of beams: nodes with directors.

use crate::error::{PartDataError, finite};
use crate::line::{combine, cross, difference, element_count, norm, shapes};
use crate::quadratic::dot;

/// Three unit vectors `d_1`, `d_2`, `d_3`, one a row: `d_1`, `d_2` along the principal axes of the section, `d_3` its normal.
pub type Triad = [[f64; 3]; 3];

/// A reference axis of Lagrange elements of order 1, 2 or 3, and the directors of its nodes.
///
/// Elements that meet at a corner share the node and its directors, but each has its own section there, which turns with the node.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamAxis {
    order: usize,
    positions: Vec<[f64; 3]>,
    triads: Vec<Triad>,
    /// Section of each node of each element.
    frames: Vec<Triad>,
}

impl BeamAxis {
    /// The axis from `order * elements + 1` nodes in a row (lengths) and their directors.
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn new(order: usize, positions: Vec<[f64; 3]>, triads: Vec<Triad>) -> Result<Self, PartDataError> {
        let elements =
            element_count(positions.len(), order).ok_or(PartDataError::Elements { nodes: positions.len(), order })?;
        if triads.len() != positions.len() {
            let (found, expected) = (triads.len(), positions.len());
            return Err(PartDataError::Count { what: "directors of the nodes of a beam", found, expected });
        }
        let frames = (0..elements).flat_map(|e| triads[e * order..=(e + 1) * order].iter().copied()).collect();
        Self { order, positions, triads, frames }.checked()
    }

    /// A straight axis; `d_1` is the part of `up` normal to it, `d_2 = d_3 x d_1`.
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn straight(
        from: [f64; 3],
        to: [f64; 3],
        up: [f64; 3],
        elements: usize,
        order: usize,
    ) -> Result<Self, PartDataError> {
        Self::polyline(&[from, to], up, &[elements], order)
    }

    /// Straight pieces from point to point with a number of elements each, rigidly joined; `d_1` as in [`Self::straight`], in each of the pieces.
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn polyline(
        points: &[[f64; 3]],
        up: [f64; 3],
        elements: &[usize],
        order: usize,
    ) -> Result<Self, PartDataError> {
        let pieces = points.len().saturating_sub(1);
        if elements.len() != pieces {
            let (found, expected) = (elements.len(), pieces);
            return Err(PartDataError::Count { what: "numbers of elements of a polyline", found, expected });
        }
        finite("coordinate of a beam", points)?;
        let (mut positions, mut triads, mut frames) = (Vec::new(), Vec::new(), Vec::new());
        for (ends, &count) in points.windows(2).zip(elements) {
            let triad = upright(difference(ends[1], ends[0]), up)?;
            let steps = order * count;
            for i in 0..=steps {
                let t = i as f64 / steps.max(1) as f64;
                // The first node of a piece is the last of the one before.
                if i > 0 || positions.is_empty() {
                    positions.push(combine(&[1.0 - t, t], ends));
                    triads.push(triad);
                }
            }
            frames.extend(std::iter::repeat_n(triad, count * (order + 1)));
        }
        if elements.contains(&0) || element_count(positions.len(), order).is_none() {
            return Err(PartDataError::Elements { nodes: positions.len(), order });
        }
        Self { order, positions, triads, frames }.checked()
    }

    /// Part of a circle from a point on it by an angle (radians, right-handed about `normal`); `d_1` is `normal`, `d_2 = d_3 x d_1`.
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn arc(
        centre: [f64; 3],
        from: [f64; 3],
        normal: [f64; 3],
        angle: f64,
        elements: usize,
        order: usize,
    ) -> Result<Self, PartDataError> {
        finite("coordinate of a beam", &[centre, from, normal, [angle; 3]])?;
        let arm = difference(from, centre);
        let of = |direction, axis| PartDataError::Direction { direction, axis };
        let n = unit(normal).ok_or(of(normal, arm))?;
        let axial = dot(arm, n);
        let radius: [f64; 3] = std::array::from_fn(|i| arm[i] - axial * n[i]);
        let across = cross(n, radius);
        if norm(radius) <= 1e-12 * norm(arm) || angle == 0.0 {
            return Err(of(normal, arm));
        }
        let steps = order * elements;
        let (mut positions, mut triads) = (Vec::new(), Vec::new());
        for i in 0..=steps {
            let (s, c) = (angle * i as f64 / steps.max(1) as f64).sin_cos();
            positions.push(std::array::from_fn(|k| from[k] + (c - 1.0) * radius[k] + s * across[k]));
            let tangent: [f64; 3] = std::array::from_fn(|k| angle.signum() * (c * across[k] - s * radius[k]));
            triads.push(upright(tangent, n)?);
        }
        Self::new(order, positions, triads)
    }

    fn checked(self) -> Result<Self, PartDataError> {
        finite("coordinate of a beam", &self.positions)?;
        for (node, d) in self.triads.iter().enumerate() {
            let third = difference(cross(d[0], d[1]), d[2]);
            // `<=` is false for NaN.
            let near = |x: f64| x.abs() <= 1e-9;
            if !(near(norm(third)) && near(dot(d[0], d[1])) && near(norm(d[0]) - 1.0) && near(norm(d[1]) - 1.0)) {
                return Err(PartDataError::Directors { node });
            }
        }
        check_lengths(&self.positions, self.order)?;
        Ok(self)
    }

    /// Order of the shape functions.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Reference positions of the nodes.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Reference directors of the nodes.
    pub fn triads(&self) -> &[Triad] {
        &self.triads
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        (self.positions.len() - 1) / self.order
    }

    /// Section of a node of an element in the reference configuration.
    pub(crate) fn frame(&self, element: usize, local: usize) -> &Triad {
        &self.frames[element * (self.order + 1) + local]
    }

    /// Positions of the nodes of an element.
    pub(crate) fn element(&self, element: usize) -> &[[f64; 3]] {
        &self.positions[element * self.order..=(element + 1) * self.order]
    }
}

/// Elements must have a positive length at all their points; seen at the nodes and halfway between them.
pub(crate) fn check_lengths(positions: &[[f64; 3]], order: usize) -> Result<(), PartDataError> {
    for element in 0..(positions.len() - 1) / order {
        let nodes = &positions[element * order..=(element + 1) * order];
        let chord: f64 = nodes.windows(2).map(|n| norm(difference(n[1], n[0]))).sum();
        let mut before: Option<[f64; 3]> = None;
        for i in 0..=2 * order {
            let slope = combine(&shapes(order, i as f64 / order as f64 - 1.0).slopes[..=order], nodes);
            let folded = before.is_some_and(|b| dot(b, slope) <= 0.0);
            // False for NaN.
            let has_length = norm(slope) > 1e-6 * chord;
            if folded || !has_length {
                return Err(PartDataError::NoLength { element });
            }
            before = Some(slope);
        }
    }
    Ok(())
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(v);
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

/// The triad with `d_3` along `tangent` and `d_1` the normal part of `up`.
fn upright(tangent: [f64; 3], up: [f64; 3]) -> Result<Triad, PartDataError> {
    let error = PartDataError::Direction { direction: up, axis: tangent };
    let (Some(third), Some(up)) = (unit(tangent), unit(up)) else { return Err(error) };
    let along = dot(up, third);
    let normal: [f64; 3] = std::array::from_fn(|i| up[i] - along * third[i]);
    if norm(normal) < 1e-6 {
        return Err(error);
    }
    let Some(first) = unit(normal) else { return Err(error) };
    Ok([first, cross(third, first), third])
}
