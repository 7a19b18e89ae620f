//! Which block computes which cells.

use crate::{
    SolidOptions, Volumetric,
    block::Block,
    element_block::{ElementBlock, InvertedCell},
    nodal::NodalTetrahedra,
};
use stoss_continuum::HyperelasticLaw;
use stoss_mesh::{CellBlock, Elements};
use stoss_reference_element::{CellKind, Integration};

/// Cells whose data [`check`] makes at once.
const PIECE: usize = 256;

/// Checks that these cells are not inverted, and adds their volumes, without keeping any of their data.
pub(crate) fn check(
    cells: &CellBlock,
    reference: &[[f64; 3]],
    options: SolidOptions,
    law: &dyn HyperelasticLaw,
    volume: &mut f64,
) -> Result<(), InvertedCell> {
    // Averages tell nothing of that.
    let options = SolidOptions { volumetric: Volumetric::Displacement, ..options };
    let kind = cells.kind();
    for (piece, nodes) in cells.nodes().chunks(PIECE * kind.node_count()).enumerate() {
        for cells in Elements::of_kind(kind, nodes.to_vec()).blocks() {
            let block = of_cells(cells, reference, options, law, 0);
            let block = block.map_err(|found| InvertedCell { element: PIECE * piece + found.element, ..found })?;
            block.add_volume(volume);
        }
    }
    Ok(())
}

/// The block of these cells. A new kind of cell needs a line here. `law` is the part of the body's law that may have a state, `offset` the global number of the first node.
pub(crate) fn of_cells(
    cells: &CellBlock,
    reference: &[[f64; 3]],
    options: SolidOptions,
    law: &dyn HyperelasticLaw,
    offset: u32,
) -> Result<Box<dyn ElementBlock>, InvertedCell> {
    use Integration::{Full, Reduced};
    Ok(match (cells.kind(), options.integration) {
        (CellKind::Hex8, _) => Box::new(Block::<8, 8>::new(cells, reference, options, law)?),
        (CellKind::Hex20, Full) => Box::new(Block::<20, 27>::new(cells, reference, options, law)?),
        (CellKind::Hex20, Reduced) => Box::new(Block::<20, 8>::new(cells, reference, options, law)?),
        (CellKind::Hex27, _) => Box::new(Block::<27, 27>::new(cells, reference, options, law)?),
        (CellKind::Tet4, _) => {
            let block = Block::<4, 1>::new(cells, reference, options, law)?;
            match options.volumetric {
                Volumetric::Displacement => Box::new(block),
                Volumetric::Mixed => Box::new(NodalTetrahedra::new(block, cells.nodes(), offset)),
            }
        }
        (CellKind::Tet10, Full) => Box::new(Block::<10, 8>::new(cells, reference, options, law)?),
        (CellKind::Tet10, Reduced) => Box::new(Block::<10, 4>::new(cells, reference, options, law)?),
        (CellKind::Wedge6, _) => Box::new(Block::<6, 6>::new(cells, reference, options, law)?),
        (CellKind::Wedge15, _) => Box::new(Block::<15, 21>::new(cells, reference, options, law)?),
    })
}
