//! What goes wrong in a term.

use std::error::Error;
use std::sync::Arc;

/// Why a term has no contribution: its own error, which [`Self::cause`] gives back.
#[derive(Clone, Debug)]
pub struct Fault {
    undefined: bool,
    cause: Arc<dyn Error + Send + Sync>,
}

impl Fault {
    /// The contribution has no value at these positions: an element is inverted, a string has no length. Another start of the iteration may help as well as a smaller step.
    pub fn undefined(cause: impl Error + Send + Sync + 'static) -> Self {
        Self { undefined: true, cause: Arc::new(cause) }
    }

    /// Anything else: a search or a projection that fails, a rule of the scheme that the term does not have.
    pub fn other(cause: impl Error + Send + Sync + 'static) -> Self {
        Self { undefined: false, cause: Arc::new(cause) }
    }

    /// Whether it was made by [`Self::undefined`].
    pub fn is_undefined(&self) -> bool {
        self.undefined
    }

    /// The term's own error, if it is of this type.
    pub fn cause<E: Error + 'static>(&self) -> Option<&E> {
        (*self.cause).downcast_ref()
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.cause.fmt(f)
    }
}

impl Error for Fault {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.source()
    }
}

/// Something of a model whose forces or energy are not defined at given positions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{term}: {reason}")]
pub struct Undefined {
    /// Name of the term.
    pub term: String,
    /// What is wrong, with element and value.
    pub reason: String,
}

impl From<Undefined> for Fault {
    fn from(error: Undefined) -> Self {
        Self::undefined(error)
    }
}
