//! What a law is given beside its own parameters to have a history, as one value: what scene formats have.

use crate::{Fibres, Hencky, Inelastic, MaterialError, Moduli, Mullins, Plasticity};
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_registry::Refusal;

/// Families of fibres that differ by their directions only.
#[derive(Clone, Debug, PartialEq)]
pub struct FibreFamilies {
    /// Stiffness, exponent and dispersion.
    pub fibres: Fibres,
    /// A direction each, of any length but zero: those of all points, but for points whose states get others.
    pub directions: Vec<[f64; 3]>,
}

/// Plasticity, Maxwell branches, softening, fibres; each may be left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Yield stress and hardening, of Hencky's law only.
    pub plasticity: Option<Plasticity>,
    /// Maxwell branches: shares of the shear modulus and relaxation times.
    pub prony: Vec<(f64, f64)>,
    /// Which moduli the law has with the branches.
    pub moduli: Moduli,
    /// Softening.
    pub mullins: Option<Mullins>,
    /// Fibres.
    pub fibres: Option<FibreFamilies>,
}

impl History {
    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.plasticity.is_none() && self.prony.is_empty() && self.mullins.is_none() && self.fibres.is_none()
    }

    /// The law with this history; the law itself if there is none.
    ///
    /// # Errors
    /// Plasticity of another law than Hencky's or together with the others, laws that are not the sum of a volumetric part and a rest, parameters out of range.
    pub fn of(&self, law: Arc<dyn HyperelasticLaw>) -> Result<Arc<dyn HyperelasticLaw>, Refusal> {
        let refused = |parameter: &'static str| {
            move |error: MaterialError| {
                let remedy = match error {
                    MaterialError::NoSplit { .. } => {
                        "choose neo-hooke, hencky, mooney-rivlin, yeoh, gent, arruda-boyce or ogden"
                    }
                    _ => "correct the value",
                };
                Refusal::new(parameter, error.to_string(), remedy)
            }
        };
        if let Some(plasticity) = &self.plasticity {
            if law.name() != "hencky" {
                let message = format!("is that of metals, whose elastic part is Hencky's law, not {}", law.name());
                return Err(Refusal::new("plasticity", message, "write law = \"hencky\""));
            }
            let others = [
                ("prony", !self.prony.is_empty()),
                ("mullins", self.mullins.is_some()),
                ("fibres", self.fibres.is_some()),
            ];
            if let Some((other, _)) = others.into_iter().find(|(_, has)| *has) {
                let message = "cannot be combined with `plasticity`";
                return Err(Refusal::new(other, message, "remove one of the two"));
            }
            let moduli = law.small_strain_moduli();
            let law = Hencky::new(moduli.lame_lambda(), moduli.shear).map_err(refused("plasticity"))?;
            return Ok(Arc::new(Inelastic::plastic(law, plasticity.clone()).map_err(refused("plasticity"))?));
        }
        let mut made = None;
        if !self.prony.is_empty() {
            made = Some(Inelastic::viscous(&law, &self.prony, self.moduli).map_err(refused("prony"))?);
        }
        if let Some(mullins) = self.mullins {
            let softer = match made {
                None => Inelastic::softening(&law, mullins),
                Some(made) => made.with_softening(mullins),
            };
            made = Some(softer.map_err(refused("mullins"))?);
        }
        if let Some(FibreFamilies { fibres, directions }) = &self.fibres {
            let stiffer = match made {
                None => Inelastic::fibrous(&law, *fibres, directions),
                Some(made) => made.with_fibres(*fibres, directions),
            };
            made = Some(stiffer.map_err(refused("fibres"))?);
        }
        Ok(match made {
            None => law,
            Some(made) => Arc::new(made),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Hardening, NeoHooke, SaintVenantKirchhoff};

    #[test]
    fn what_cannot_be_is_refused_by_its_key() {
        let metal: Arc<dyn HyperelasticLaw> = Arc::new(Hencky::from_young_poisson(2.1e5, 0.3).unwrap());
        let rubber: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::from_young_poisson(2.1, 0.49).unwrap());
        let other: Arc<dyn HyperelasticLaw> = Arc::new(SaintVenantKirchhoff::from_young_poisson(2.1, 0.3).unwrap());
        let plastic = |hardening| History {
            plasticity: Some(Plasticity { hardening, kinematic: 0.0, overstress: None }),
            ..History::default()
        };
        let prony = |prony: &[(f64, f64)]| History { prony: prony.to_vec(), ..History::default() };
        let mullins = |r| History { mullins: Some(Mullins { r, m: 0.3, beta: 0.0 }), ..History::default() };
        let fibres = |k2, direction| History {
            fibres: Some(FibreFamilies {
                fibres: Fibres { stiffness: 1.0, exponent: k2, dispersion: 0.1 },
                directions: vec![direction],
            }),
            ..History::default()
        };
        let along = [0.0, 2.0, 0.0];
        let good = plastic(Hardening::linear(400.0, 100.0));
        assert!(fibres(2.0, along).of(rubber.clone()).is_ok());
        assert!(History { prony: vec![(0.1, 1.0)], ..fibres(2.0, along) }.of(rubber.clone()).is_ok());
        assert!(good.of(metal.clone()).unwrap().history().is_some());
        assert!(History::default().of(other.clone()).unwrap().history().is_none());
        assert!(prony(&[(0.3, 1.0)]).of(metal.clone()).is_ok() && mullins(1.5).of(rubber.clone()).is_ok());
        for (history, law, key) in [
            (good.clone(), &rubber, "plasticity"),
            (plastic(Hardening::linear(-1.0, 0.0)), &metal, "plasticity"),
            (plastic(Hardening::linear(400.0, -3e5)), &metal, "plasticity"),
            (plastic(Hardening::Table(vec![(0.1, 400.0)])), &metal, "plasticity"),
            (plastic(Hardening::Table(vec![(0.0, 400.0), (0.0, 500.0)])), &metal, "plasticity"),
            (History { prony: vec![(0.1, 1.0)], ..good.clone() }, &metal, "prony"),
            (prony(&[(0.6, 1.0), (0.5, 2.0)]), &rubber, "prony"),
            (prony(&[(0.6, 0.0)]), &rubber, "prony"),
            (prony(&[(0.6, 1.0)]), &other, "prony"),
            (mullins(1.0), &rubber, "mullins"),
            (mullins(2.0), &other, "mullins"),
            (fibres(2.0, along), &other, "fibres"),
            (fibres(-2.0, along), &rubber, "fibres"),
            (fibres(2.0, [0.0; 3]), &rubber, "fibres"),
            (History { fibres: fibres(2.0, along).fibres, ..good.clone() }, &metal, "fibres"),
        ] {
            assert_eq!(history.of(law.clone()).unwrap_err().parameter, key, "{history:?}");
        }
    }
}
