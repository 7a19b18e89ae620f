//! Bodies in plane strain: sections, and for general contact, which has none, a slice of the same mesh between two fixed planes.

use crate::verify::work_precision::campaign::Choice;

/// Thickness of what is modelled: that of a slice is about the size of an element.
pub fn thickness(choice: &Choice) -> f64 {
    if is_slice(choice) { 1.0 / f64::from(choice.mesh) } else { 1.0 }
}

fn is_slice(choice: &Choice) -> bool {
    choice.method == "general"
}

/// The tables of a run, as those of solids have them.
pub fn head(choice: &Choice, title: &str, end: f64) -> String {
    let head = choice.head(title, end);
    if is_slice(choice) { head } else { head.replacen("[time]", "section = \"plane-strain\"\n[time]", 1) }
}

/// A rectangular `[[body]]` between two corners with these numbers of elements along x and y; `more` are further lines.
pub fn body(choice: &Choice, name: &str, [min, max]: [[f64; 2]; 2], [along, high]: [u32; 2], more: &str) -> String {
    let ([x0, y0], [x1, y1]) = (min, max);
    let (mesh, held) = if is_slice(choice) {
        let thick = thickness(choice);
        (
            format!(
                "generator = \"block\", min = [{x0:?}, {y0:?}, 0], max = [{x1:?}, {y1:?}, {thick:?}], divisions = [{along}, {high}, 1]"
            ),
            format!("[[prescribe]]\nset = \"{name}.all\"\ncomponents = [\"z\"]\nfixed = true\n"),
        )
    } else {
        (
            format!("generator = \"rectangle\", min = {min:?}, max = {max:?}, divisions = [{along}, {high}]"),
            String::new(),
        )
    };
    format!("[[body]]\nname = \"{name}\"\n{}mesh = {{ {mesh} }}\n{more}{held}", choice.cell_keys())
}

/// The lower side of a body and the upper one, y, in the words of its mesh.
pub fn sides(choice: &Choice) -> [&'static str; 2] {
    if is_slice(choice) { ["front", "back"] } else { ["bottom", "top"] }
}
