//! Laws that a program brings with it, hyperelastic ones and laws of friction, for scenes that name them.

use crate::scene::{Friction, Material, OwnNames, Parameter};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::sync::Arc;
use stoss_contact::ContactError;
use stoss_contact::friction::FrictionLaw;
use stoss_continuum::HyperelasticLaw;
use stoss_registry::Refusal;

/// What a constructor of a law gives: the law, or why the parameters are no material. An error that is a [`ParameterError`] is
/// reported at its key.
pub type LawResult = Result<Arc<dyn HyperelasticLaw>, Box<dyn Error + Send + Sync>>;

/// What a constructor of a law of friction gives, as [`LawResult`].
pub type FrictionLawResult = Result<Arc<dyn FrictionLaw>, Box<dyn Error + Send + Sync>>;

/// What makes a law from the parameters of a scene.
type Constructor<L> = Arc<dyn Fn(&LawParameters<'_>) -> Result<Arc<L>, Box<dyn Error + Send + Sync>> + Send + Sync>;

/// Laws beside the catalogue: names, and what makes a law from the parameters of a scene. The checkpoint of a run does not know
/// them: a run must be resumed by a program with the same laws.
#[derive(Clone, Default)]
pub struct OwnLaws {
    materials: BTreeMap<String, Constructor<dyn HyperelasticLaw>>,
    friction: BTreeMap<String, Constructor<dyn FrictionLaw>>,
}

impl std::fmt::Debug for OwnLaws {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_set().entries(self.materials.keys().chain(self.friction.keys())).finish()
    }
}

/// Why a law cannot have its name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("a law cannot be called `{name}`: {reason}")]
pub struct LawNameError {
    /// The name.
    pub name: String,
    /// Reason.
    pub reason: &'static str,
}

impl OwnLaws {
    /// The laws with one more. A scene asks for it by `material = { law = "name", ... }`.
    ///
    /// # Errors
    /// [`LawNameError`] for the name of a law of the catalogue, a name that was given before, or one that is not made of letters,
    /// digits, `-` and `_`.
    pub fn with(
        mut self,
        name: &str,
        constructor: impl Fn(&LawParameters<'_>) -> LawResult + Send + Sync + 'static,
    ) -> Result<Self, LawNameError> {
        add(&mut self.materials, Material::names(), name, Arc::new(constructor))?;
        Ok(self)
    }

    /// The laws with one law of friction more. A scene asks for it by `friction = { law = "name", ... }`; the keys `penalty`, `stick`, `midpoint` and
    /// `slip` belong to the contact and are no parameters of the law.
    ///
    /// # Errors
    /// The errors of [`Self::with`]. A material may have the same name.
    pub fn with_friction(
        mut self,
        name: &str,
        constructor: impl Fn(&LawParameters<'_>) -> FrictionLawResult + Send + Sync + 'static,
    ) -> Result<Self, LawNameError> {
        add(&mut self.friction, Friction::names(), name, Arc::new(constructor))?;
        Ok(self)
    }

    /// The names, for [`crate::scene::parse_with`].
    pub fn names(&self) -> OwnNames<'_> {
        OwnNames { materials: names(&self.materials).collect(), friction: names(&self.friction).collect() }
    }

    /// The law of a material.
    pub(super) fn make(&self, material: &Material) -> Result<Arc<dyn HyperelasticLaw>, ParameterError> {
        make(&self.materials, Material::names(), &material.law, &material.parameters)
    }

    /// The law of a friction.
    #[cfg_attr(not(any(feature = "nts", feature = "mortar", feature = "general")), expect(dead_code))]
    pub(super) fn make_friction(&self, friction: &Friction) -> Result<Arc<dyn FrictionLaw>, ParameterError> {
        make(&self.friction, Friction::names(), &friction.law, &friction.parameters)
    }
}

fn names<L: ?Sized>(laws: &BTreeMap<String, Constructor<L>>) -> impl Iterator<Item = &str> {
    laws.keys().map(String::as_str)
}

fn add<L: ?Sized>(
    laws: &mut BTreeMap<String, Constructor<L>>,
    mut catalogue: impl Iterator<Item = &'static str>,
    name: &str,
    constructor: Constructor<L>,
) -> Result<(), LawNameError> {
    let good = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let reason = if catalogue.any(|known| known == name) {
        "the catalogue has a law of this name"
    } else if laws.contains_key(name) {
        "another law has this name"
    } else if name.is_empty() || !name.chars().all(good) {
        "use letters, digits, `-` and `_` only"
    } else {
        laws.insert(name.to_owned(), constructor);
        return Ok(());
    };
    Err(LawNameError { name: name.to_owned(), reason })
}

fn make<L: ?Sized>(
    laws: &BTreeMap<String, Constructor<L>>,
    catalogue: impl Iterator<Item = &'static str>,
    law: &str,
    given: &BTreeMap<String, Parameter>,
) -> Result<Arc<L>, ParameterError> {
    let Some(constructor) = laws.get(law) else {
        let mut all: Vec<&str> = catalogue.collect();
        all.extend(names(laws));
        return Err(ParameterError::new("law", "is unknown", crate::scene::known(law, all)));
    };
    let parameters = LawParameters { law, given, asked: RefCell::default() };
    let law = constructor(&parameters).map_err(|error| match error.downcast::<ParameterError>() {
        Ok(error) => *error,
        Err(error) => ParameterError::new("", error.to_string(), "choose other parameters"),
    })?;
    let asked = parameters.asked.into_inner();
    match given.keys().find(|key| !asked.contains(*key)) {
        Some(key) => {
            let known = crate::scene::known(key, asked.iter().map(String::as_str));
            Err(ParameterError::new(key, "is an unknown key", known))
        }
        None => Ok(law),
    }
}

/// The parameters of a law as a scene gives them. Every key that the law's constructor asks for is known; any other is reported as
/// unknown.
#[derive(Debug)]
pub struct LawParameters<'a> {
    law: &'a str,
    given: &'a BTreeMap<String, Parameter>,
    asked: RefCell<BTreeSet<String>>,
}

impl LawParameters<'_> {
    /// Name of the law.
    pub fn law(&self) -> &str {
        self.law
    }

    fn get(&self, key: &str) -> Option<&Parameter> {
        self.asked.borrow_mut().insert(key.to_owned());
        self.given.get(key)
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
    /// Message: what is wrong.
    pub message: String,
    /// Remedy: what to do.
    pub remedy: String,
}

impl From<Refusal> for ParameterError {
    fn from(Refusal { parameter, message, remedy }: Refusal) -> Self {
        Self::new(parameter, message, remedy)
    }
}

impl From<ContactError> for ParameterError {
    fn from(error: ContactError) -> Self {
        match error {
            ContactError::Friction { parameter, value, range } => {
                let message = format!("must be {range}, but is {value}");
                Self::new(parameter, message, "correct the parameter")
            }
            error => Self::new("", error.to_string(), "correct the parameters"),
        }
    }
}

impl ParameterError {
    /// An error from its parts.
    pub fn new(key: &str, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { key: key.to_owned(), message: message.into(), remedy: remedy.into() }
    }
}
