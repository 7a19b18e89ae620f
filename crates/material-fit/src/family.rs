//! Which parameters of a law are sought.

use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_materials::entry;
use stoss_registry::{Given, Refusal};

/// Most terms of Ogden's law.
const MAX_TERMS: usize = 3;

/// What the starts of a search are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Shear modulus of a neo-Hookean material near the curves.
    pub shear: f64,
    /// Largest first invariant less 3 in a test.
    pub largest_invariant: f64,
}

/// Parameters by name; a list for one that is a list.
pub(crate) type Parameters = Vec<(&'static str, Vec<f64>)>;

/// A law and the way to its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Name of the law.
    pub law: &'static str,
    /// Number of parameters that are sought.
    pub unknowns: usize,
    /// Places where the search begins.
    pub(crate) starts: fn(Size, usize) -> Vec<Vec<f64>>,
    /// The parameters of the law with this bulk modulus.
    pub(crate) parameters: fn(&[f64], f64) -> Parameters,
}

impl Family {
    /// Names of the laws that can be fitted.
    pub const NAMES: [&str; 6] = ["neo-hooke", "mooney-rivlin", "yeoh", "gent", "arruda-boyce", "ogden"];

    /// The family of the law with that name; `terms` of Ogden's law, from 1 to 3. `None` if it cannot be fitted.
    pub fn of(law: &str, terms: usize) -> Option<Self> {
        Some(match law {
            "neo-hooke" => Self {
                law: "neo-hooke",
                unknowns: 1,
                starts: |size, _| vec![vec![size.shear]],
                parameters: |x, bulk| vec![("lambda", vec![bulk - 2.0 / 3.0 * x[0]]), ("mu", vec![x[0]])],
            },
            "mooney-rivlin" => Self {
                law: "mooney-rivlin",
                unknowns: 2,
                starts: |size, _| vec![vec![0.4 * size.shear, 0.1 * size.shear]],
                parameters: |x, bulk| {
                    let c = 0.5 * (bulk - 4.0 * x[1] - 4.0 / 3.0 * (x[0] + x[1]));
                    vec![("c1", vec![x[0]]), ("c2", vec![x[1]]), ("c", vec![c])]
                },
            },
            "yeoh" => Self {
                law: "yeoh",
                unknowns: 3,
                starts: |size, _| vec![vec![0.5 * size.shear, 0.0, 0.0]],
                parameters: |x, bulk| {
                    vec![("c1", vec![x[0]]), ("c2", vec![x[1]]), ("c3", vec![x[2]]), ("kappa", vec![bulk])]
                },
            },
            // Logarithms: both are positive.
            "gent" => Self {
                law: "gent",
                unknowns: 2,
                starts: |size, _| {
                    [1.1, 3.0, 30.0].map(|f| vec![size.shear.ln(), (f * size.largest_invariant).ln()]).to_vec()
                },
                parameters: |x, bulk| {
                    vec![("mu", vec![x[0].exp()]), ("limit", vec![x[1].exp()]), ("kappa", vec![bulk])]
                },
            },
            "arruda-boyce" => Self {
                law: "arruda-boyce",
                unknowns: 2,
                starts: |size, _| {
                    let chain = (1.0 + size.largest_invariant / 3.0).sqrt();
                    [0.5, 1.2, 4.0].map(|f| vec![size.shear.ln(), (f * chain).ln()]).to_vec()
                },
                parameters: |x, bulk| {
                    vec![("mu", vec![x[0].exp()]), ("lock", vec![1.0 + x[1].exp()]), ("kappa", vec![bulk])]
                },
            },
            "ogden" if (1..=MAX_TERMS).contains(&terms) => Self {
                law: "ogden",
                unknowns: 2 * terms,
                starts: |size, unknowns| {
                    let starts: &[&[f64]] = match unknowns {
                        2 => &[&[2.0], &[-2.0], &[5.0]],
                        4 => &[&[2.0, -2.0], &[1.3, 5.0], &[5.0, -2.0], &[0.7, 8.0]],
                        _ => &[&[1.3, 5.0, -2.0], &[2.0, 8.0, -2.0], &[1.0, 4.0, -1.0], &[1.5, 11.0, -3.0]],
                    };
                    let moduli =
                        |alpha: &[f64]| alpha.iter().map(|a| 2.0 * size.shear / (a * alpha.len() as f64)).collect();
                    starts.iter().map(|alpha| [moduli(alpha), alpha.to_vec()].concat()).collect()
                },
                parameters: |x, bulk| {
                    let (mu, alpha) = x.split_at(x.len() / 2);
                    vec![("mu", mu.to_vec()), ("alpha", alpha.to_vec()), ("kappa", vec![bulk]), ("beta", vec![9.0])]
                },
            },
            _ => return None,
        })
    }

    /// The law with these parameters.
    pub(crate) fn law(&self, parameters: &Parameters) -> Result<Arc<dyn HyperelasticLaw>, Refusal> {
        let unknown = || Refusal::new("law", format!("there is no law {}", self.law), "take one of the catalogue");
        let row = entry(self.law).ok_or_else(unknown)?;
        row.with(parameters.iter().map(|(name, values)| {
            let is_list = row.parameters().any(|parameter| parameter.name == *name && parameter.is_list());
            (*name, if is_list { Given::List(values) } else { Given::Number(values[0]) })
        }))
    }
}
