//! The cells, a file for each family. A cell is a constant [`crate::CellTable`]; nothing else in Stoss tells one cell from another.

mod hex;
mod tet;
mod wedge;

pub(crate) use hex::{HEX8, HEX20, HEX27};
pub(crate) use tet::{TET4, TET10};
pub(crate) use wedge::{WEDGE6, WEDGE15};

use crate::table::{MAX_CELL_NODES, ShapeFunctions, ShapeGradient};

/// Values at the nodes of a cell with `N` nodes, with zeros behind them.
fn padded<const N: usize, T: Copy>(values: [T; N], zero: T) -> [T; MAX_CELL_NODES] {
    let mut out = [zero; MAX_CELL_NODES];
    out[..N].copy_from_slice(&values);
    out
}

fn shape<const N: usize>(values: [f64; N]) -> ShapeFunctions {
    padded(values, 0.0)
}

fn gradient<const N: usize>(values: [[f64; 3]; N]) -> ShapeGradient {
    padded(values, [0.0; 3])
}
