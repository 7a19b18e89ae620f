//! Which block computes which cells.

use crate::{
    SolidOptions, Volumetric,
    block::Block,
    element_block::{BlockError, ElementBlock},
    nodal::NodalTetrahedra,
};
use stoss_continuum::HyperelasticLaw;
use stoss_mesh::CellBlock;
use stoss_reference_element::{CellKind, Integration};

/// The block of these cells. A new kind of cell needs a line here. `law` is the part of the body's law that may have a state, `offset` the global number of the first node.
pub(crate) fn of_cells(
    cells: &CellBlock,
    reference: &[[f64; 3]],
    options: SolidOptions,
    law: &dyn HyperelasticLaw,
    offset: u32,
) -> Result<Box<dyn ElementBlock>, BlockError> {
    use Integration::{Full, Reduced};
    Ok(match (cells.kind(), options.integration) {
        (CellKind::Hex8, Full) => Box::new(Block::<8, 8>::new(cells, reference, options, law)?),
        (CellKind::Hex20, Full) => Box::new(Block::<20, 27>::new(cells, reference, options, law)?),
        (CellKind::Hex20, Reduced) => Box::new(Block::<20, 8>::new(cells, reference, options, law)?),
        (CellKind::Hex27, Full) => Box::new(Block::<27, 27>::new(cells, reference, options, law)?),
        (CellKind::Tet4, Full) => {
            let block = Block::<4, 1>::new(cells, reference, options, law)?;
            match options.volumetric {
                Volumetric::Displacement => Box::new(block),
                Volumetric::Mixed => Box::new(NodalTetrahedra::new(block, cells.nodes(), offset)),
            }
        }
        (CellKind::Tet10, Full) => Box::new(Block::<10, 8>::new(cells, reference, options, law)?),
        (CellKind::Tet10, Reduced) => Box::new(Block::<10, 4>::new(cells, reference, options, law)?),
        (CellKind::Wedge6, Full) => Box::new(Block::<6, 6>::new(cells, reference, options, law)?),
        (CellKind::Wedge15, Full) => Box::new(Block::<15, 21>::new(cells, reference, options, law)?),
        (CellKind::Hex8 | CellKind::Hex27 | CellKind::Tet4 | CellKind::Wedge6 | CellKind::Wedge15, Reduced) => {
            return Err(BlockError::NoRule);
        }
    })
}
