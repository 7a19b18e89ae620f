//! What elements of a body can do in more than one way.

use stoss_reference_element::{CellKind, Integration, QuadratureRule};

/// What elements of a body can do in more than one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolidOptions {
    /// The points at which stress and stiffness are taken. Kinds of cells with one quadrature rule only take that one.
    pub integration: Integration,
    /// How the change of volume is treated.
    pub volumetric: Volumetric,
}

impl SolidOptions {
    /// Quadrature rule of a kind of cells: the one that is asked for if the kind has it, else the full one, which every kind has.
    pub(crate) fn rule(self, kind: CellKind) -> QuadratureRule {
        kind.rule(self.integration).or_else(|| kind.rule(Integration::Full)).unwrap_or_default()
    }
}

/// How elements treat the change of volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Volumetric {
    /// The change of volume at each Gauss point, as the law says. Such elements lock near incompressibility, above a Poisson's ratio of about 0.45.
    #[default]
    Displacement,
    /// The part of the law that depends on the volume sees an average of `det F` (theory/elements#eq-dilatation): a constant of each element, for hex27 a function
    /// that is linear in natural coordinates, for tet4 the mean of the elements around each node. For nearly incompressible solids; of no use to wedge6, which
    /// locks all the same. The law must have such a part, [`stoss_continuum::HyperelasticLaw::volumetric`]. With tet4 the tangent has more stencils than elements,
    /// [`crate::SolidBody::stencils`].
    Mixed,
}
