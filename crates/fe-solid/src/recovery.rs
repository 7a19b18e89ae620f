//! Stresses and strains for output: at Gauss points, and extrapolated to nodes. Not used by any force.

use crate::{OutputPlace, SolidBody, SolidError, element::FailureKind, element_block::PointStrain};
use stoss_continuum::{ConstitutiveError, SymmetricTensor2, Tensor2};
use stoss_reference_element::{CellKind, QuadratureRule};

/// State of one Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussPointState {
    /// `F`, row: current direction, column: reference direction.
    pub deformation_gradient: [[f64; 3]; 3],
    /// Cauchy stress `F S F^T / J` in the order 11, 22, 33, 12, 23, 13.
    pub cauchy: [f64; 6],
    /// Strain energy per reference volume.
    pub energy: f64,
    /// Reference volume that belongs to the point.
    pub volume: f64,
}

/// Principal stresses of a stress in the order 11, 22, 33, 12, 23, 13, the largest first.
pub fn principal_stresses(stress: &[f64; 6]) -> [f64; 3] {
    stoss_continuum::principal_values(&SymmetricTensor2::from_components(*stress))
}

/// Von Mises stress `sqrt(3/2 s:s)`, `s` the deviator, of a stress in the order 11, 22, 33, 12, 23, 13.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    stoss_continuum::von_mises(&SymmetricTensor2::from_components(*stress))
}

impl SolidBody {
    /// The state at the Gauss points of each element, in the order of its quadrature rule, at positions `q` of the model. Of a share those of its elements.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`].
    pub fn gauss_point_state(&self, q: &[f64]) -> Result<Vec<Vec<GaussPointState>>, SolidError> {
        self.check_length("the positions", q)?;
        let mut out = Vec::with_capacity(self.element_count());
        self.for_each_block(|block, cells| {
            for element in 0..cells.len() {
                let mut states = Vec::with_capacity(block.rule().len());
                block
                    .visit_points(self.material(), cells.nodes(), element, q, &mut |point| {
                        states.push(point_state(&point)?);
                        Ok(())
                    })
                    .map_err(|failure| (element, failure))?;
                out.push(states);
            }
            Ok(())
        })?;
        Ok(out)
    }

    /// Cauchy stress at the body's nodes: the function through the Gauss points of each element, evaluated at
    /// its nodes, then the mean over the elements at a node, weighted by their reference volumes. The function is that of the linear cell with the same
    /// corners (trilinear in a hexahedron) which fits the points best, with the weights of the quadrature rule: through all of them in hex8 and wedge6; the mean if there
    /// are fewer points than corners. Order 11, 22, 33, 12, 23, 13; [`NodalSums::means`] has the stresses.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`].
    pub fn nodal_cauchy_stress(&self, q: &[f64]) -> Result<NodalSums<6>, SolidError> {
        self.nodal_sums(q, false, |f, point| {
            let stress = point.law.stress(&point.right_cauchy_green)?;
            Ok(with_pressure(stoss_continuum::cauchy_stress(f, &stress).to_components(), point.pressure))
        })
    }

    /// Deformation gradient `F` at the body's nodes, made as [`Self::nodal_cauchy_stress`]. Order 11, 12, 13, 21, ..., 33: the first
    /// index is the current direction, the second the reference direction. The mean of elements that turn differently is shorter
    /// than each: strains at nodes are means of strains, and not the strain of this mean.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`].
    pub fn nodal_deformation_gradient(&self, q: &[f64]) -> Result<NodalSums<9>, SolidError> {
        self.nodal_sums(q, false, |f, _| Ok(std::array::from_fn(|k| f[(k / 3, k % 3)])))
    }

    /// Green-Lagrange strain `E = (F^T F - 1)/2` at the body's nodes, made and ordered as [`Self::nodal_cauchy_stress`]; shears are tensor
    /// components, half of the engineering ones.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`].
    pub fn nodal_green_lagrange_strain(&self, q: &[f64]) -> Result<NodalSums<6>, SolidError> {
        self.nodal_sums(q, false, |_, point| {
            Ok(stoss_continuum::green_lagrange(&point.right_cauchy_green).to_components())
        })
    }

    /// Logarithmic (Hencky) strain `ln V = ln(F F^T)/2` in the current directions at the body's nodes, made and ordered as
    /// [`Self::nodal_cauchy_stress`]; shears are tensor components.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`].
    pub fn nodal_logarithmic_strain(&self, q: &[f64]) -> Result<NodalSums<6>, SolidError> {
        self.nodal_sums(q, false, |f, _| Ok(stoss_continuum::logarithmic_strain(f).to_components()))
    }

    /// Numbers of an output of the states at the body's nodes, made as [`Self::nodal_cauchy_stress`]; of what jumps means of elements in place of functions through their points.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`]; also if `N` is not the length of the output.
    pub fn nodal_state_output<const N: usize>(
        &self,
        q: &[f64],
        place: OutputPlace,
    ) -> Result<NodalSums<N>, SolidError> {
        if place.len != N {
            let (name, what) = (self.name().to_string(), "the numbers of the output");
            return Err(SolidError::Length { name, what, found: N, expected: place.len });
        }
        let all = std::cell::RefCell::new(vec![0.0; place.all]);
        self.nodal_sums(q, place.jumps, |_, point| {
            let mut all = all.borrow_mut();
            self.write_outputs(point.before, point.state, &mut all);
            Ok(std::array::from_fn(|k| all[place.first + k]))
        })
    }

    /// The sums for means at the body's nodes of what `value` makes of `F` and the other strains at the Gauss points, see [`Self::nodal_cauchy_stress`].
    fn nodal_sums<const N: usize>(
        &self,
        q: &[f64],
        jumps: bool,
        value: impl Fn(&Tensor2, &PointStrain<'_>) -> Result<[f64; N], ConstitutiveError>,
    ) -> Result<NodalSums<N>, SolidError> {
        self.check_length("the positions", q)?;
        let mut out = NodalSums::<N> { numbers: vec![0.0; (N + 1) * self.node_count()] };
        self.for_each_block(|block, cells| {
            let extrapolation = to_places(cells.kind(), block.rule(), cells.kind().table().nodes, jumps);
            let points = block.rule().len();
            let mut values = vec![[0.0; N]; points];
            for (element, nodes) in cells.iter().enumerate() {
                block
                    .visit_points(self.material(), cells.nodes(), element, q, &mut |point| {
                        let f = Tensor2::from_fn(|i, a| point.deformation_gradient[i][a]);
                        values[point.gauss_point] = value(&f, &point)?;
                        Ok(())
                    })
                    .map_err(|failure| (element, failure))?;
                let volume = block.element_volume(element);
                for (&node, weights) in nodes.iter().zip(extrapolation.chunks_exact(points)) {
                    let (sums, of_node) = out.of_node_mut((node - self.node_offset()) as usize);
                    *of_node += volume;
                    for (weight, values) in weights.iter().zip(&values) {
                        for (sum, value) in sums.iter_mut().zip(values) {
                            *sum += volume * weight * value;
                        }
                    }
                }
            }
            Ok(())
        })?;
        Ok(out)
    }
}

/// Sums over elements from which values at the nodes of a body are made, `N` numbers a node: the sums of the elements' values times their reference volumes, and of these volumes. Of a
/// share those of its elements, which add up to those of the body over all ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalSums<const N: usize> {
    /// Sums of each node, then the volume.
    numbers: Vec<f64>,
}

impl<const N: usize> NodalSums<N> {
    fn of_node_mut(&mut self, node: usize) -> (&mut [f64], &mut f64) {
        let (sums, volume) = self.numbers[(N + 1) * node..(N + 1) * (node + 1)].split_at_mut(N);
        (sums, &mut volume[0])
    }

    /// The sums as plain numbers, `N + 1` for each node of the body: what is to be added up over ranks.
    pub fn numbers_mut(&mut self) -> &mut [f64] {
        &mut self.numbers
    }

    /// The means at the nodes of the body; zero at nodes without element.
    pub fn means(&self) -> Vec<[f64; N]> {
        let of_node = |numbers: &[f64]| -> [f64; N] {
            let volume = numbers[N];
            std::array::from_fn(|k| if volume > 0.0 { numbers[k] / volume } else { numbers[k] })
        };
        self.numbers.chunks_exact(N + 1).map(of_node).collect()
    }
}

/// The state of a Gauss point.
pub(crate) fn point_state(point: &PointStrain<'_>) -> Result<GaussPointState, FailureKind> {
    let (f, c) = (point.deformation_gradient, point.right_cauchy_green);
    let (energy, s) = point.law.energy_and_stress(&c)?;
    let cauchy = stoss_continuum::cauchy_stress(&Tensor2::from_fn(|i, a| f[i][a]), &s);
    Ok(GaussPointState {
        deformation_gradient: f,
        cauchy: with_pressure(cauchy.to_components(), point.pressure),
        energy: energy + point.volumetric_energy,
        volume: point.volume,
    })
}

/// A stress with the averaged pressure of a mixed element, positive in tension; that is zero in others.
pub(crate) fn with_pressure(mut stress: [f64; 6], pressure: f64) -> [f64; 6] {
    stress[..3].iter_mut().for_each(|s| *s += pressure);
    stress
}

/// Weights of the points of a quadrature rule for values at places in a cell: a row for each place, a column for each point. Those of [`extrapolation`], or of the mean of what `jumps`.
pub(crate) fn to_places(kind: CellKind, rule: QuadratureRule, places: &[[f64; 3]], jumps: bool) -> Vec<f64> {
    if jumps { mean(rule, places.len()) } else { extrapolation(kind, rule, places) }
}

fn mean(rule: QuadratureRule, places: usize) -> Vec<f64> {
    let total: f64 = rule.iter().map(|(_, weight)| weight).sum();
    (0..places).flat_map(|_| rule.iter().map(|(_, weight)| weight / total)).collect()
}

/// The values at places in a cell of the function of its linear cell that fits values at the points of a quadrature rule best in the sum of squares with the weights of
/// that rule: a row for each place, a column for each point. The mean if there are fewer points than corners.
pub(crate) fn extrapolation(kind: CellKind, rule: QuadratureRule, places: &[[f64; 3]]) -> Vec<f64> {
    let linear = kind.table().linear.table();
    let corners = linear.corners;
    if rule.len() < corners {
        return mean(rule, places.len());
    }
    // E = N(nodes) (sum w N N^T)^-1 N(points)^T w
    let shapes: Vec<_> = rule.iter().map(|&(xi, _)| (linear.shape)(xi)).collect();
    let mut matrix = vec![0.0; corners * corners];
    let mut columns = vec![0.0; corners * rule.len()];
    for (g, (shape, &(_, weight))) in shapes.iter().zip(rule).enumerate() {
        for i in 0..corners {
            columns[i * rule.len() + g] = weight * shape[i];
            for j in 0..corners {
                matrix[i * corners + j] += weight * shape[i] * shape[j];
            }
        }
    }
    eliminate(&mut matrix, &mut columns, corners);
    let mut out = Vec::with_capacity(places.len() * rule.len());
    for &xi in places {
        let shape = (linear.shape)(xi);
        out.extend((0..rule.len()).map(|g| (0..corners).map(|i| shape[i] * columns[i * rule.len() + g]).sum::<f64>()));
    }
    out
}

/// Solves with a symmetric positive definite matrix of `n` rows, in place.
fn eliminate(matrix: &mut [f64], columns: &mut [f64], n: usize) {
    let m = columns.len() / n;
    for k in 0..n {
        let pivot = matrix[k * n + k];
        for i in (0..n).filter(|&i| i != k) {
            let factor = matrix[i * n + k] / pivot;
            for j in k..n {
                matrix[i * n + j] -= factor * matrix[k * n + j];
            }
            for j in 0..m {
                columns[i * m + j] -= factor * columns[k * m + j];
            }
        }
    }
    for i in 0..n {
        for j in 0..m {
            columns[i * m + j] /= matrix[i * n + i];
        }
    }
}
