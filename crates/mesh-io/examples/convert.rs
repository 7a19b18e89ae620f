//! A ball from the generator, turned into other cells, written in three formats and read back.
//!
//! Checked: files give back cells, nodes and named sets; volumes come nearer to that of the ball with curved cells.
//!
//! `cargo run --example convert -p stoss-mesh-io`

use std::error::Error;
use stoss_mesh::generate::{Ball, Portion};
use stoss_mesh_io::{read_mesh, write_mesh};
use stoss_reference_element::CellKind;

fn main() -> Result<(), Box<dyn Error>> {
    let ball = Ball { radius: 1.0, part: Portion::Eighth, divisions: [3, 3, 3], refinement: None }.generate()?;
    let exact = std::f64::consts::PI / 6.0;
    let folder = tempfile::tempdir()?;
    println!("cells   nodes  elements  facets of `outer`  worst scaled Jacobian  volume / exact - 1");
    let mut errors = Vec::new();
    for kind in [CellKind::Hex8, CellKind::Tet4, CellKind::Hex20, CellKind::Tet10] {
        let mesh = ball.with_cells(kind)?;
        let quality = mesh.quality();
        let error = quality.volume / exact - 1.0;
        println!(
            "{kind:6} {:6} {:9} {:18} {:22.3} {error:19.2e}",
            mesh.nodes.len(),
            mesh.elements.len(),
            mesh.facets_of("outer")?.len(),
            quality.min_scaled_jacobian
        );
        errors.push(error.abs());
        for extension in ["msh", "inp", "vtu"] {
            let path = folder.path().join(format!("ball-{kind}.{extension}"));
            write_mesh(&path, &mesh)?;
            let read = read_mesh(&path)?;
            assert_eq!(read.elements, mesh.elements, "{}", path.display());
            assert_eq!(read.nodes, mesh.nodes, "{}", path.display());
            assert_eq!(read.facets_of("outer")?.len(), mesh.facets_of("outer")?.len(), "{}", path.display());
        }
    }
    assert!(errors[2..].iter().all(|curved| *curved < 0.05 * errors[0]), "{errors:?}");
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
