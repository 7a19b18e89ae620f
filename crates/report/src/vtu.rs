//! Frames that `stoss` writes, as the crate `stoss-mesh-io` reads them, and collections of frames.

use std::path::Path;

use stoss_mesh::Elements;
pub use stoss_mesh_io::{Array, VtuData as Grid};
use stoss_mesh_io::{read_pvd_from_str, read_vtu};

use crate::Outcome;

/// The elements with these numbers.
pub(crate) fn chosen(elements: &Elements, numbers: impl Iterator<Item = usize>) -> Elements {
    let mut chosen = Elements::new();
    numbers.for_each(|k| chosen.push(elements.kind(k), &elements[k]));
    chosen
}

/// Whether a frame has no displacement, so that every point is drawn where it was at the start.
pub(crate) fn is_undeformed(grid: &Grid) -> bool {
    grid.point_data.get("displacement").is_none_or(|array| array.components != 3)
}

/// Reads a file.
///
/// # Errors
/// What is wrong with it, with its name.
pub fn load(path: &Path) -> Outcome<Grid> {
    Ok(read_vtu(path)?)
}

/// Reads a frame, counted from 0, of a VTKHDF file.
///
/// # Errors
/// What is wrong with the file, with its name; without the feature `vtkhdf` that it cannot be read.
#[cfg(feature = "vtkhdf")]
pub fn load_part(path: &Path, frame: usize) -> Outcome<Grid> {
    Ok(stoss_mesh_io::VtkhdfFile::open(path)?.read(frame)?)
}

/// Times of the frames of a VTKHDF file.
///
/// # Errors
/// What is wrong with the file, with its name; without the feature `vtkhdf` that it cannot be read.
#[cfg(feature = "vtkhdf")]
pub fn times(path: &Path) -> Outcome<Vec<f64>> {
    Ok(stoss_mesh_io::VtkhdfFile::open(path)?.frames().iter().map(|&(_, time)| time).collect())
}

/// The grid of a frame as with the feature `vtkhdf`, without which the file cannot be read.
///
/// # Errors
/// Always.
#[cfg(not(feature = "vtkhdf"))]
pub fn load_part(path: &Path, _: usize) -> Outcome<Grid> {
    Err(absent(path))
}

/// Times of the frames as with the feature `vtkhdf`, without which the file cannot be read.
///
/// # Errors
/// Always.
#[cfg(not(feature = "vtkhdf"))]
pub fn times(path: &Path) -> Outcome<Vec<f64>> {
    Err(absent(path))
}

#[cfg(not(feature = "vtkhdf"))]
fn absent(path: &Path) -> Box<dyn std::error::Error> {
    format!("{}: this build reads VTU frames only (cargo feature `vtkhdf`)", path.display()).into()
}

/// Time and path (relative to the collection) of every frame of a `.pvd` file.
///
/// # Errors
/// What is wrong with the text.
pub fn collection(text: &str) -> Outcome<Vec<(f64, String)>> {
    let entries = read_pvd_from_str("collection", text)?;
    Ok(entries.into_iter().map(|entry| (entry.time, entry.file)).collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use stoss_mesh_io::{Field, VtuFrame, write_vtu_to};

    /// A frame, written and read.
    pub fn copied(frame: &VtuFrame) -> Grid {
        let mut out = Vec::new();
        write_vtu_to(&mut out, frame).unwrap();
        stoss_mesh_io::read_vtu_from_bytes("frame", &out).unwrap()
    }

    /// A cube with an array `speed` on the points.
    pub fn cube(speed: &[f64; 8]) -> Grid {
        let point_data = vec![Field { name: "speed", components: 1, values: speed }];
        let cube = Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
        copied(&VtuFrame { points: &CUBE, elements: cube.blocks(), point_data, ..VtuFrame::default() })
    }

    /// The eight corners of a unit cube in VTK's order.
    pub const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];

    #[test]
    fn a_frame_has_its_cells_and_arrays() {
        let elements = Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
        let frame = VtuFrame {
            points: &CUBE,
            elements: elements.blocks(),
            facets: &[[0, 1, 2].into(), [4, 5, 6, 7].into()],
            lines: &[vec![0, 3, 6]],
            vertices: &[5],
            point_data: vec![Field { name: "velocity", components: 3, values: CUBE.as_flattened() }],
            cell_data: vec![Field { name: "body", components: 1, values: &[0.0, 1.0, 1.0, 2.0, 3.0] }],
            ..VtuFrame::default()
        };
        let grid = copied(&frame);
        assert_eq!((&grid.points[..], grid.elements), (&CUBE[..], vec![[0, 1, 2, 3, 4, 5, 6, 7]].into()));
        assert_eq!(grid.facets, [[0, 1, 2].into(), [4, 5, 6, 7].into()]);
        assert_eq!((grid.lines, grid.vertices), (vec![vec![0, 3, 6]], vec![5]));
        assert_eq!(grid.cell_data["body"].values, [0.0, 1.0, 1.0, 2.0, 3.0]);
        assert_eq!(grid.point_data["velocity"].row(6), [1.0; 3]);
        assert_eq!(grid.point_data["velocity"].magnitude(6), 3.0_f64.sqrt());
        assert_eq!(cube(&[-1.5; 8]).point_data["speed"].magnitude(1), -1.5);
    }

    #[test]
    fn frames_of_a_collection() {
        let text = "<VTKFile><Collection><DataSet timestep=\"0\" part=\"0\" file=\"frames/a.vtu\"/>\n\
                    <DataSet timestep=\"1e-1\" file=\"frames/b.vtu\"></DataSet></Collection></VTKFile>";
        assert_eq!(collection(text).unwrap(), [(0.0, "frames/a.vtu".to_owned()), (0.1, "frames/b.vtu".to_owned())]);
        assert!(collection("<DataSet file=\"a\"/>").is_err());
    }
}
