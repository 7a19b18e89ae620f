//! Node-to-surface contact: direct form and energy-momentum element.
