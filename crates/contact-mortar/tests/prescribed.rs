//! What prescribed motions leave of a pair of surfaces.

use stoss_contact_mortar::{MortarContact, MortarOptions};
use stoss_reference_element::{FaceNodes, FacePiece, FacetNodes};

/// Two squares side by side, the slave at z = 0 with its normal downwards, the master below; nodes 0 to 5 and 6 to 11.
fn contact() -> MortarContact {
    let mut reference = Vec::new();
    for z in [0.0, -0.01] {
        for y in [0.0, 1.0] {
            (0..3).for_each(|k| reference.extend([f64::from(k), y, z]));
        }
    }
    let facets = |first: u32, corners: [u32; 4]| -> Vec<FacePiece> {
        let facet = |k: u32| FaceNodes::from(FacetNodes::from(corners.map(|c| first + c + k)));
        (0..2).flat_map(|k| FacePiece::of_face(facet(k), None)).collect()
    };
    let (slave, master) = (facets(0, [0, 3, 4, 1]), facets(6, [0, 1, 4, 3]));
    MortarContact::new("pair", &slave, &master, &reference, MortarOptions::default()).unwrap()
}

#[test]
fn a_slave_is_held_along_its_normals_if_all_of_its_nodes_are() {
    let contact = contact();
    assert!(contact.is_slave_held_along_normals(|_| [false, false, true]));
    assert!(contact.is_slave_held_along_normals(|n| [false, false, n < 6]));
    assert!(!contact.is_slave_held_along_normals(|n| [false, false, n != 4]));
    assert!(!contact.is_slave_held_along_normals(|_| [true, true, false]));
}

#[test]
fn a_slave_is_dragged_by_a_component_along_the_surface_that_the_master_does_not_have() {
    let contact = contact();
    assert!(contact.is_slave_dragged(|n| [n < 6, false, false]));
    assert!(contact.is_slave_dragged(|n| [false, n != 7, false]));
    assert!(!contact.is_slave_dragged(|_| [true; 3]));
    assert!(!contact.is_slave_dragged(|n| [false, false, n < 6]));
    assert!(!contact.is_slave_dragged(|n| [n < 5, false, false]));
}
