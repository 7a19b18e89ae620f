//! Functions of the configuration that are quadratic in `q`: strains, squared lengths, angles between directions. Forces of energies and of multipliers
//! are made of their gradients (theory/multibody#invariants).
//!
//! `phi_k(q) = c_k + sum_t f_t a_t(q) . b_t(q)` with vectors `a`, `b` linear in `q`. Their gradients are linear in `q`, so `grad phi(q_mid) . dq = phi(q_np1) - phi(q_n)`
//! holds exactly; where the `phi_k` are the same in every frame, so are the moments of the forces made of them zero about `q_mid`.

use crate::Embedded;
use std::collections::BTreeMap;

/// A vector of the element, linear in its local vectors.
#[derive(Clone, Debug, PartialEq)]
struct Form {
    constant: [f64; 3],
    weights: Vec<(usize, f64)>,
}

/// `c + sum f a . b`.
#[derive(Clone, Debug, Default, PartialEq)]
struct Function {
    constant: f64,
    /// Factor and the two forms.
    products: Vec<(f64, usize, usize)>,
}

/// Some quadratic functions of the same vectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quadratics {
    vectors: Vec<u32>,
    forms: Vec<Form>,
    functions: Vec<Function>,
}

/// Makes [`Quadratics`]: forms first, then functions of them.
#[derive(Clone, Debug, Default)]
pub struct QuadraticsBuilder {
    local: BTreeMap<u32, usize>,
    made: Quadratics,
}

/// A form of a [`QuadraticsBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormId(usize);

impl QuadraticsBuilder {
    /// A builder without functions.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a point or direction.
    pub fn form(&mut self, embedded: &Embedded) -> FormId {
        let weights = embedded.terms.iter().map(|&(vector, weight)| {
            let next = self.made.vectors.len();
            let local = *self.local.entry(vector).or_insert(next);
            if local == next {
                self.made.vectors.push(vector);
            }
            (local, weight)
        });
        let form = Form { constant: embedded.constant, weights: weights.collect() };
        self.made.forms.push(form);
        FormId(self.made.forms.len() - 1)
    }

    /// Adds the function `constant + sum factor a . b`; returns its number.
    pub fn function(&mut self, constant: f64, products: &[(f64, FormId, FormId)]) -> usize {
        let products = products.iter().map(|&(f, a, b)| (f, a.0, b.0)).collect();
        self.made.functions.push(Function { constant, products });
        self.made.functions.len() - 1
    }

    /// The functions.
    pub fn build(self) -> Quadratics {
        self.made
    }
}

/// Values of forms and gradients of functions at one configuration; reused from element to element.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    forms: Vec<[f64; 3]>,
    /// Value of each function.
    pub values: Vec<f64>,
    /// Gradients, row-major: functions times `3 * vectors`; empty unless asked for.
    pub gradients: Vec<f64>,
}

impl Quadratics {
    /// Global numbers of the vectors that the functions depend on.
    pub fn vectors(&self) -> &[u32] {
        &self.vectors
    }

    /// Number of functions.
    pub fn len(&self) -> usize {
        self.functions.len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Evaluates at `(1 - theta) q_n + theta q_np1`.
    pub fn evaluate(&self, q_n: &[f64], q_np1: &[f64], theta: f64, want_gradients: bool, out: &mut Evaluation) {
        out.forms.clear();
        for form in &self.forms {
            let mut u = form.constant;
            for &(local, weight) in &form.weights {
                let first = 3 * self.vectors[local] as usize;
                for (i, u) in u.iter_mut().enumerate() {
                    let (a, b) = (q_n[first + i], q_np1[first + i]);
                    // Exact at both ends, whatever is at the other.
                    let q = if theta == 1.0 {
                        b
                    } else if theta == 0.0 {
                        a
                    } else {
                        (1.0 - theta) * a + theta * b
                    };
                    *u += weight * q;
                }
            }
            out.forms.push(u);
        }
        out.values.clear();
        for function in &self.functions {
            let mut value = function.constant;
            for &(factor, a, b) in &function.products {
                value += factor * dot(out.forms[a], out.forms[b]);
            }
            out.values.push(value);
        }
        if want_gradients {
            self.gradients(out);
        }
    }

    fn gradients(&self, out: &mut Evaluation) {
        let n = 3 * self.vectors.len();
        out.gradients.clear();
        out.gradients.resize(self.functions.len() * n, 0.0);
        for (function, row) in self.functions.iter().zip(out.gradients.chunks_exact_mut(n.max(1))) {
            for &(factor, a, b) in &function.products {
                for (form, other) in [(a, b), (b, a)] {
                    let other = out.forms[other];
                    for &(local, weight) in &self.forms[form].weights {
                        for i in 0..3 {
                            row[3 * local + i] += factor * weight * other[i];
                        }
                    }
                }
            }
        }
    }

    /// Adds `factor` times the second derivatives of function `k` to the leading block of a row-major matrix with `stride` columns.
    pub fn add_second_derivatives(&self, k: usize, factor: f64, stride: usize, matrix: &mut [f64]) {
        for &(f, a, b) in &self.functions[k].products {
            for &(i, wi) in &self.forms[a].weights {
                for &(j, wj) in &self.forms[b].weights {
                    let entry = factor * f * wi * wj;
                    for d in 0..3 {
                        matrix[(3 * i + d) * stride + 3 * j + d] += entry;
                        matrix[(3 * j + d) * stride + 3 * i + d] += entry;
                    }
                }
            }
        }
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
