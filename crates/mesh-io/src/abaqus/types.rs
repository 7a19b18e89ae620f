//! Types of elements: which cell each is read as, and what a user should know of it.

use stoss_reference_element::{CellKind, FaceKind, Integration};

/// A type of solid elements by its name in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SolidType {
    pub name: &'static str,
    /// The cell, of a plane element that of a layer on it.
    pub kind: CellKind,
    /// The face that a plane element is.
    pub plane: Option<FaceKind>,
}

/// Plane elements: of bodies of revolution, in plane strain, in plane stress. Their nodes are numbered as ours.
const PLANE: [(FaceKind, &[&str]); 4] = [
    (FaceKind::Tri3, &["CAX3", "CPE3", "CPS3", "CAX3H", "CPE3H"]),
    (
        FaceKind::Quad4,
        &[
            "CAX4", "CPE4", "CPS4", "CAX4R", "CPE4R", "CPS4R", "CAX4H", "CPE4H", "CAX4RH", "CPE4RH", "CAX4I", "CPE4I",
            "CPS4I",
        ],
    ),
    (FaceKind::Tri6, &["CAX6", "CPE6", "CPS6", "CAX6M", "CPE6M", "CPS6M", "CAX6H", "CPE6H", "CAX6MH", "CPE6MH"]),
    (FaceKind::Quad8, &["CAX8", "CPE8", "CPS8", "CAX8R", "CPE8R", "CPS8R", "CAX8H", "CPE8H", "CAX8RH", "CPE8RH"]),
];

impl SolidType {
    /// The type of this name in upper case, if Stoss computes with it.
    pub fn find(name: &str) -> Option<SolidType> {
        let solid = CellKind::ALL.into_iter().find_map(|kind| {
            let name = kind.table().abaqus.iter().find(|known| **known == name)?;
            Some(SolidType { name, kind, plane: None })
        });
        solid.or_else(|| {
            PLANE.into_iter().find_map(|(face, names)| {
                let name = names.iter().find(|known| **known == name)?;
                Some(SolidType { name, kind: face.layer(), plane: Some(face) })
            })
        })
    }

    /// Number of nodes of an element.
    pub fn node_count(self) -> usize {
        self.plane.map_or(self.kind.node_count(), FaceKind::node_count)
    }

    /// The nodes of an element in our order.
    pub fn ours(self, theirs: &[u64]) -> Box<[u64]> {
        match self.plane {
            Some(_) => theirs.into(),
            None => self.kind.table().from_abaqus.iter().map(|&i| theirs[usize::from(i)]).collect(),
        }
    }

    /// How the element is computed here, where that is not what its name says: "C3D20R is read as hex20; ...".
    pub fn note(self) -> Option<String> {
        let SolidType { name, kind, .. } = self;
        // What follows the number of nodes: letters for variants of the element.
        let letters = name.get(3..).unwrap_or_default().trim_start_matches(|c: char| c.is_ascii_digit());
        if letters.is_empty() {
            return None;
        }
        let mut parts = Vec::new();
        for letter in letters.chars() {
            parts.push(match letter {
                'R' if kind.rule(Integration::Reduced).is_some() => "use integration = \"reduced\" for its rule",
                'R' => "it is fully integrated here, without hourglass modes: stiffer in bending",
                'H' => "use volumetric = \"mixed\" for its independent pressure",
                'I' if !kind.is_quadratic() => "it has no incompatible modes here: stiffer in bending",
                'M' => "its modified shape functions and mass are not used: it is the standard element here",
                _ => "its extrapolation of surface stresses is not used",
            });
        }
        Some(format!("{name} is read as {kind}; {}", parts.join("; ")))
    }
}

/// Names of the elements that Stoss computes with, without their variants.
pub(super) fn known() -> String {
    let names: Vec<&str> = CellKind::ALL.into_iter().filter_map(|kind| kind.table().abaqus.first().copied()).collect();
    names.join(", ")
}

/// What to do instead of a type of elements that is not read.
pub(super) fn advice(name: &str) -> String {
    let rest = name.strip_prefix("C3D").unwrap_or_default();
    let digits: &str = &rest[..rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len()];
    let stem = CellKind::ALL.into_iter().find_map(|kind| {
        kind.table()
            .abaqus
            .first()
            .copied()
            .filter(|stem| !digits.is_empty() && stem.strip_prefix("C3D") == Some(digits))
    });
    match (stem, digits) {
        (Some("C3D15"), _) if name.contains('V') => {
            "this one has a variable number of nodes: use C3D15, or C3D10 or C3D20 (Element Type in the mesh module)".to_owned()
        }
        (Some(stem), _) => format!("change the type to {stem} if the mechanical part of it is what you want"),
        (None, "5" | "13") => {
            "there are no pyramids: mesh each part with hexahedra or with tetrahedra (Mesh Controls, Element Shape), and tie them".to_owned()
        }
        (None, _) if name.starts_with("C3D") => {
            "mesh the part with one of them (in the mesh module: Mesh Controls, Element Type)".to_owned()
        }
        _ => "remove these elements (from Gmsh: save as .msh instead); loads, masses and constraints belong into the scene"
            .to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_are_told() {
        let note = |name: &str| SolidType::find(name).unwrap().note();
        assert_eq!(note("C3D8"), None);
        assert_eq!(note("C3D27"), None);
        let expected = "C3D20R is read as hex20; use integration = \"reduced\" for its rule";
        assert_eq!(note("C3D20R").as_deref(), Some(expected));
        let expected = "C3D10H is read as tet10; use volumetric = \"mixed\" for its independent pressure";
        assert_eq!(note("C3D10H").as_deref(), Some(expected));
        let both = note("C3D20RH").unwrap();
        assert!(both.contains("\"reduced\"") && both.contains("\"mixed\""), "{both}");
        assert!(note("C3D8R").unwrap().contains("fully integrated"));
        assert!(note("C3D8I").unwrap().contains("no incompatible modes"));
        assert!(note("C3D10M").unwrap().contains("modified"));
        assert!(note("C3D10HS").unwrap().contains("surface stresses"));
        // Every name of every cell is found, and no two cells share one.
        for kind in CellKind::ALL {
            for name in kind.table().abaqus {
                assert_eq!(SolidType::find(name), Some(SolidType { name, kind, plane: None }));
            }
        }
        assert_eq!(SolidType::find("C3D5"), None);
    }

    #[test]
    fn advice_fits_the_type() {
        assert!(advice("C3D8T").contains("to C3D8 "));
        assert!(advice("C3D20RT").contains("to C3D20 "));
        assert!(advice("C3D15V").contains("variable"));
        assert!(advice("C3D5").contains("pyramids"));
        assert!(advice("C3D13").contains("pyramids"));
        assert!(advice("S4R").contains("remove"));
        assert!(advice("C3D").contains("mesh the part"));
    }
}
