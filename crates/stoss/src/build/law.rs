//! Laws that a program brings with it, for scenes that name them.

use crate::scene::{Material, OwnMaterial, Parameter};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_materials::MaterialError;

/// What a constructor of a law gives: the law, or why the parameters are no material. An error that is a [`ParameterError`] is
/// reported at its key.
pub type LawResult = Result<Arc<dyn HyperelasticLaw>, Box<dyn Error + Send + Sync>>;

type Constructor = dyn Fn(&LawParameters<'_>) -> LawResult + Send + Sync;

/// Laws beside the catalogue: names, and what makes a law from the parameters of a scene. The checkpoint of a run does not know
/// them: a run must be resumed by a program with the same laws.
#[derive(Clone, Default)]
pub struct OwnLaws {
    constructors: BTreeMap<String, Arc<Constructor>>,
}

impl std::fmt::Debug for OwnLaws {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_set().entries(self.constructors.keys()).finish()
    }
}

/// Why a law cannot have its name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("a law cannot be called `{name}`: {reason}")]
pub struct LawNameError {
    /// The name.
    pub name: String,
    /// What is wrong with it.
    pub reason: &'static str,
}

impl OwnLaws {
    /// With one law more. A scene asks for it by `material = { law = "name", ... }`.
    ///
    /// # Errors
    /// [`LawNameError`] for the name of a law of the catalogue, a name that was given before, or one that is not made of letters,
    /// digits, `-` and `_`.
    pub fn with(
        mut self,
        name: &str,
        constructor: impl Fn(&LawParameters<'_>) -> LawResult + Send + Sync + 'static,
    ) -> Result<Self, LawNameError> {
        let good = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
        let reason = if Material::NAMES.contains(&name) {
            "the catalogue has a law of this name"
        } else if self.constructors.contains_key(name) {
            "another law has this name"
        } else if name.is_empty() || !name.chars().all(good) {
            "use letters, digits, `-` and `_` only"
        } else {
            self.constructors.insert(name.to_owned(), Arc::new(constructor));
            return Ok(self);
        };
        Err(LawNameError { name: name.to_owned(), reason })
    }

    /// The names, for [`crate::scene::parse_with`].
    pub fn names(&self) -> Vec<&str> {
        self.constructors.keys().map(String::as_str).collect()
    }

    /// The law of a material.
    pub(super) fn make(&self, material: &OwnMaterial) -> Result<Arc<dyn HyperelasticLaw>, ParameterError> {
        let Some(constructor) = self.constructors.get(&material.law) else {
            let known = crate::scene::known(&material.law, Material::NAMES.iter().copied().chain(self.names()));
            return Err(ParameterError::new("law", "is unknown", known));
        };
        let parameters = LawParameters { material, asked: RefCell::default() };
        let law = constructor(&parameters).map_err(|error| match error.downcast::<ParameterError>() {
            Ok(error) => *error,
            Err(error) => ParameterError::new("", error.to_string(), "choose other parameters"),
        })?;
        let asked = parameters.asked.into_inner();
        match material.parameters.keys().find(|key| !asked.contains(*key)) {
            Some(key) => {
                let known = crate::scene::known(key, asked.iter().map(String::as_str));
                Err(ParameterError::new(key, "is an unknown key", known))
            }
            None => Ok(law),
        }
    }
}

/// The parameters of a law as a scene gives them. Every key that the law's constructor asks for is known; any other is reported as
/// unknown.
#[derive(Debug)]
pub struct LawParameters<'a> {
    material: &'a OwnMaterial,
    asked: RefCell<BTreeSet<String>>,
}

impl LawParameters<'_> {
    /// Name of the law.
    pub fn law(&self) -> &str {
        &self.material.law
    }

    fn get(&self, key: &str) -> Option<&Parameter> {
        self.asked.borrow_mut().insert(key.to_owned());
        self.material.parameters.get(key)
    }

    /// A number.
    ///
    /// # Errors
    /// [`ParameterError`] if it is missing or a list.
    pub fn number(&self, key: &str) -> Result<f64, ParameterError> {
        match self.get(key) {
            Some(Parameter::Number(value)) => Ok(*value),
            Some(Parameter::List(_)) => Err(ParameterError::new(key, "must be a number", "write a number, not a list")),
            None => Err(ParameterError::new(key, "is missing", format!("add it, for instance `{key} = 1.0`"))),
        }
    }

    /// A number that may be left out.
    ///
    /// # Errors
    /// [`ParameterError`] if it is a list.
    pub fn number_or(&self, key: &str, default: f64) -> Result<f64, ParameterError> {
        if self.get(key).is_none() { Ok(default) } else { self.number(key) }
    }

    /// A list of numbers.
    ///
    /// # Errors
    /// [`ParameterError`] if it is missing or a single number.
    pub fn list(&self, key: &str) -> Result<&[f64], ParameterError> {
        match self.get(key) {
            Some(Parameter::List(values)) => Ok(values),
            Some(Parameter::Number(_)) => Err(ParameterError::new(key, "must be a list", "write [1.0, 2.0]")),
            None => Err(ParameterError::new(key, "is missing", format!("add it, for instance `{key} = [1.0, 2.0]`"))),
        }
    }
}

/// What is wrong with a parameter of a law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key}: {message}; {remedy}")]
pub struct ParameterError {
    /// The key; empty if the parameters together are wrong.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub remedy: String,
}

impl From<MaterialError> for ParameterError {
    fn from(error: MaterialError) -> Self {
        Self::new("", error.to_string(), "choose parameters with positive shear and bulk moduli at small strains")
    }
}

impl ParameterError {
    /// From its parts.
    pub fn new(key: &str, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { key: key.to_owned(), message: message.into(), remedy: remedy.into() }
    }
}
