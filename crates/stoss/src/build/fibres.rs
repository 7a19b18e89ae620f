//! Directions of the fibres of a body, element by element.

use super::Problems;
use crate::scene::Fibres;
use stoss_fe_solid::SolidBody;
use stoss_mesh::Mesh;

/// Gives the elements of a body the directions of their fibres, of which `key` is the key; a constant direction they have already.
pub(super) fn set(
    fibres: &Fibres,
    key: &str,
    mesh: &Mesh,
    solid: &mut SolidBody,
    problems: &mut Problems<'_>,
) -> Option<()> {
    let families = match (&fibres.axis, &fibres.field[..]) {
        (Some(axis), _) => around(fibres, *axis, key, mesh, problems)?,
        (None, fields) => {
            let mut families = Vec::new();
            for (f, name) in fields.iter().enumerate() {
                families.push(field(name, &format!("{key}.field[{f}]"), mesh, problems)?);
            }
            families
        }
    };
    for (f, directions) in families.iter().enumerate() {
        // cannot fail: the law has a direction for each family, and the mesh is that of the body.
        solid.set_state_of_elements(&format!("fibre_direction_{}", f + 1), directions.as_flattened()).ok()?;
    }
    Some(())
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// A vector of the cells in the mesh file.
fn field(name: &str, key: &str, mesh: &Mesh, problems: &mut Problems<'_>) -> Option<Vec<[f64; 3]>> {
    let Some(vectors) = mesh.element_vectors.get(name) else {
        let names: Vec<&str> = mesh.element_vectors.keys().map(String::as_str).collect();
        let remedy = match names[..] {
            [] => {
                "the mesh has no vectors of cells: give it as VTU with an array of the cells that has three components"
                    .to_owned()
            }
            _ => format!("the mesh has {}", names.join(", ")),
        };
        problems.add(key.to_owned(), name, "is no vector of the cells of the mesh", remedy);
        return None;
    };
    let mut out = Vec::with_capacity(vectors.len());
    for (element, vector) in vectors.iter().enumerate() {
        let Some(direction) = unit(*vector) else {
            let message = format!("is {vector:?} in element {element}, which is no direction");
            problems.add(key.to_owned(), name, message, "give every cell of the body a vector that is not zero");
            return None;
        };
        out.push(direction);
    }
    Some(out)
}

/// Two families around an axis, by the centres of the elements.
fn around(
    fibres: &Fibres,
    axis: [f64; 3],
    key: &str,
    mesh: &Mesh,
    problems: &mut Problems<'_>,
) -> Option<Vec<Vec<[f64; 3]>>> {
    // cannot fail: the reader refuses the zero vector.
    let along = unit(axis)?;
    let point = fibres.point.unwrap_or([0.0; 3]);
    let (sine, cosine) = fibres.angle.unwrap_or_default().to_radians().sin_cos();
    let mut families = vec![Vec::new(); 2];
    for (element, nodes) in mesh.elements.iter().enumerate() {
        let count = nodes.len() as f64;
        let from: [f64; 3] =
            std::array::from_fn(|i| nodes.iter().map(|&n| mesh.nodes[n as usize][i]).sum::<f64>() / count - point[i]);
        let round = cross(along, from);
        let (radius, size) = (round.iter().map(|x| x * x).sum::<f64>(), from.iter().map(|x| x * x).sum::<f64>());
        let Some(round) = unit(round).filter(|_| radius > 1e-24 * size) else {
            let message = format!("goes through the centre of element {element}, around which nothing has a direction");
            problems.add(
                format!("{key}.axis"),
                format!("{axis:?}"),
                message,
                "move `point`, or give directions by `field`",
            );
            return None;
        };
        for (family, sign) in families.iter_mut().zip([1.0, -1.0]) {
            family.push(std::array::from_fn(|i| cosine * round[i] + sign * sine * along[i]));
        }
    }
    Some(families)
}
