//! What an element keeps of its reference geometry: the inverse Jacobian matrices and volumes of its Gauss points. Gradients of shape functions are made of them and of
//! those in natural coordinates, which all elements of a block share.

use crate::kernel::{self, ElementIntegration, Gradients, NodalVectors};
use crate::matrices::Matrices;
use stoss_continuum::wide::{LANES, Several, Simd, Wide, parts};

/// Gradients of the shape functions in natural coordinates at the Gauss points.
#[derive(Clone, Debug)]
pub(crate) struct Natural<const N: usize, const G: usize> {
    /// `[g][A][I]`: `dN_I/dxi_A`.
    pub gradients: [Gradients<N>; G],
    /// Gradients of [`LANES`] points side by side, `[A][I][point]`; the last point stands for those that are missing.
    several: Vec<[[Several; N]; 3]>,
}

impl<const N: usize, const G: usize> Natural<N, G> {
    pub fn new(gradients: [Gradients<N>; G]) -> Self {
        let several = (0..G).step_by(LANES).map(|first| {
            std::array::from_fn(|a| {
                std::array::from_fn(|node| std::array::from_fn(|l| gradients[(first + l).min(G - 1)][a][node]))
            })
        });
        Self { several: several.collect(), gradients }
    }
}

/// Reference geometry of an element at its Gauss points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementReference<const G: usize> {
    /// `dxi_A/dX_a`, `[A][a][g]`.
    inverse: [[[f64; G]; 3]; 3],
    /// Gauss weight times `det dX/dxi`.
    pub weights: [f64; G],
}

/// The numbers of [`LANES`] points from `first` on; the last point stands for those that are missing.
#[inline(always)]
pub(crate) fn several<const G: usize>(values: &[f64; G], first: usize) -> Several {
    match values[first..].first_chunk() {
        Some(chunk) => *chunk,
        None => std::array::from_fn(|l| values[(first + l).min(G - 1)]),
    }
}

impl<const G: usize> ElementReference<G> {
    /// Inverse Jacobian and weights at the Gauss points, as of [`kernel::integration`].
    pub fn new<const N: usize>(
        x: &NodalVectors<N>,
        natural: &[Gradients<N>; G],
        gauss_weights: &[f64; G],
    ) -> Result<Self, (usize, f64)> {
        let mut out = Self { inverse: [[[0.0; G]; 3]; 3], weights: [0.0; G] };
        for g in 0..G {
            let (inverse, weight) =
                kernel::inverse_jacobian(x, &natural[g], gauss_weights[g]).map_err(|det| (g, det))?;
            for i in 0..3 {
                for a in 0..3 {
                    out.inverse[i][a][g] = inverse[i][a];
                }
            }
            out.weights[g] = weight;
        }
        Ok(out)
    }

    /// `dN/dX_a = J^-T_aA dN/dxi_A` at a Gauss point.
    #[inline(always)]
    pub fn gradients<const N: usize>(&self, natural: &[Gradients<N>; G], g: usize, out: &mut Gradients<N>) {
        let mut inverse = [[0.0; 3]; 3];
        for i in 0..3 {
            for a in 0..3 {
                inverse[i][a] = self.inverse[i][a][g];
            }
        }
        kernel::write_gradients(&inverse, &natural[g], out);
    }

    /// The integration of the element with the gradients at all Gauss points.
    #[inline(always)]
    pub fn integration<const N: usize>(&self, natural: &[Gradients<N>; G]) -> ElementIntegration<N, G> {
        let mut out = ElementIntegration { gradients: [[[0.0; N]; 3]; G], weights: self.weights };
        for g in 0..G {
            self.gradients(natural, g, &mut out.gradients[g]);
        }
        out
    }

    /// `F` at one Gauss point, with the bits of [`Self::deformation_gradients`].
    pub fn deformation_gradient<const N: usize>(
        &self,
        natural: &Natural<N, G>,
        q: &NodalVectors<N>,
        g: usize,
    ) -> kernel::Matrix3 {
        let (natural, mut f) = (&natural.gradients[g], [[0.0; 3]; 3]);
        for i in 0..3 {
            let along = |a: usize| {
                let mut terms = q[i].iter().zip(&natural[a]).map(|(q, gradient)| gradient * q);
                let first = terms.next().unwrap_or(0.0);
                terms.fold(first, |sum, term| sum + term)
            };
            let h = [along(0), along(1), along(2)];
            for a in 0..3 {
                let of = |k: usize| self.inverse[k][a][g];
                f[i][a] = h[0] * of(0) + h[1] * of(1) + h[2] * of(2);
            }
        }
        f
    }

    /// `F_ia = (sum_I q_iI dN_I/dxi_A) dxi_A/dX_a` at the Gauss points from `first` on.
    #[inline(always)]
    pub fn deformation_gradients<S: Simd, const N: usize>(
        &self,
        simd: S,
        natural: &Natural<N, G>,
        q: &NodalVectors<N>,
        first: usize,
        out: &mut Matrices,
    ) {
        let natural = &natural.several[first / LANES];
        let mut inverse = [[[0.0; LANES]; 3]; 3];
        for i in 0..3 {
            for a in 0..3 {
                inverse[i][a] = several(&self.inverse[i][a], first);
            }
        }
        for part in 0..parts::<S>() {
            let mut h = [[Wide::splat(simd, 0.0); 3]; 3];
            for a in 0..3 {
                for node in 0..N {
                    let gradient = Wide::load(simd, &natural[a][node], part);
                    for i in 0..3 {
                        let term = gradient * q[i][node];
                        h[i][a] = if node == 0 { term } else { h[i][a] + term };
                    }
                }
            }
            for i in 0..3 {
                for a in 0..3 {
                    let mut f = h[i][0] * Wide::load(simd, &inverse[0][a], part);
                    f = f + h[i][1] * Wide::load(simd, &inverse[1][a], part);
                    f = f + h[i][2] * Wide::load(simd, &inverse[2][a], part);
                    f.store(&mut out.0[i][a], part);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_continuum::wide::{Operation, dispatch};

    struct All<'a, const N: usize, const G: usize>(
        &'a ElementReference<G>,
        &'a Natural<N, G>,
        &'a NodalVectors<N>,
        usize,
    );

    impl<const N: usize, const G: usize> Operation for All<'_, N, G> {
        type Output = Matrices;
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Matrices {
            let mut out = Matrices::ZERO;
            self.0.deformation_gradients(simd, self.1, self.2, self.3, &mut out);
            out
        }
    }

    #[test]
    fn points_side_by_side_or_alone() {
        // A tetrahedron in three quarters of its points' places: any gradients of functions that sum to one will do.
        let gradients: [Gradients<4>; 6] = std::array::from_fn(|g| {
            std::array::from_fn(|a| {
                let x = 0.01 * g as f64;
                let slope = |node: usize| if node == a { 1.0 + x } else { -x / 2.0 };
                [-(slope(0) + slope(1) + slope(2)), slope(0), slope(1), slope(2)]
            })
        });
        let x = [[0.0, 1.0, 0.1, 0.0], [0.0, 0.0, 1.2, 0.1], [0.1, 0.0, 0.0, 0.9]];
        let q = [[0.3, 1.4, 0.2, 0.1], [0.1, 0.0, 1.1, 0.2], [0.1, 0.3, 0.0, 1.3]];
        let natural = Natural::new(gradients);
        let reference = ElementReference::new(&x, &gradients, &[0.5; 6]).unwrap();
        let integration = reference.integration(&gradients);
        for g in 0..6 {
            let alone = reference.deformation_gradient(&natural, &q, g);
            let first = g / LANES * LANES;
            assert_eq!(dispatch(All(&reference, &natural, &q, first)).get(g - first), alone);
            let by_gradients = kernel::deformation_gradient(&q, &integration.gradients[g]);
            for i in 0..3 {
                for a in 0..3 {
                    assert!((by_gradients[i][a] - alone[i][a]).abs() < 1e-14);
                }
            }
        }
    }
}
