//! Reads the mesh of a body.

use super::node::Node;
use super::table::Table;
use crate::{
    Ball, Block, Cylinder, Disc, Generator, Hexahedron, HollowBall, HollowTorus, Indenter, LShape, MeshFile,
    MeshSource, Part, Rectangle, Refinement,
};

/// More elements in one mesh than this are a mistake in `divisions`.
const MAX_ELEMENTS: f64 = 2e7;

pub(super) fn mesh(node: &Node<'_>) -> Option<MeshSource> {
    let table = node.table()?;
    let source = match (table.get("file"), table.get("generator")) {
        (Some(_), Some(generator)) => {
            return generator.fail("a mesh has either a generator or a file", "remove one of them");
        }
        (None, None) => return table.missing("generator", "generator = \"block\"` or `file = \"part.msh\""),
        (Some(file), None) => {
            let file = file_name(&file);
            let group = table.optional("group", Node::text);
            let scale = table.default("scale", MeshFile::default_scale(), Node::positive);
            (|| Some(MeshSource::File(MeshFile { file: file?, group: group?, scale: scale? })))()
        }
        (None, Some(name)) => {
            let reader = name.choice(Generator::NAMES, |name| match name {
                "block" => Some(block as fn(&Table<'_>) -> Option<Generator>),
                "hollow-ball" => Some(hollow_ball),
                "hollow-torus" => Some(hollow_torus),
                "hexahedron" => Some(hexahedron),
                "indenter" => Some(indenter),
                "ball" => Some(ball),
                "cylinder" => Some(cylinder),
                "rectangle" => Some(rectangle),
                "disc" => Some(disc),
                "l-shape" => Some(l_shape),
                _ => None,
            });
            // Without a generator it is not known which other keys are right.
            reader?(&table).map(MeshSource::Generator)
        }
    };
    table.finish();
    source
}

fn file_name(node: &Node<'_>) -> Option<String> {
    let file = node.text()?;
    let lower = file.to_lowercase();
    if ![".msh", ".inp", ".vtu"].iter().any(|extension| lower.ends_with(extension)) {
        return node.fail("is not a known mesh format", "use a Gmsh (.msh), Abaqus (.inp) or VTK (.vtu) file");
    }
    Some(file)
}

/// Numbers of elements, each at least its minimum; `total` is the number of elements of the mesh.
fn divisions<const N: usize>(
    table: &Table<'_>,
    example: &str,
    minima: [u64; N],
    total: impl Fn([f64; N]) -> f64,
) -> Option<[usize; N]> {
    table.required("divisions", example, |n| {
        let counts: [u64; N] = n.array(|n| n.whole(1..=u64::MAX))?;
        if let Some(i) = (0..N).find(|&i| counts[i] < minima[i]) {
            return n.fail(
                format!("entry {} must be at least {}", i + 1, minima[i]),
                format!("write for instance `{example}`"),
            );
        }
        let elements = total(counts.map(|c| c as f64));
        if elements > MAX_ELEMENTS {
            return n
                .fail(format!("gives {elements:.1e} elements"), format!("at most {MAX_ELEMENTS:.0e} are possible"));
        }
        Some(counts.map(|c| c as usize))
    })
}

fn product<const N: usize>(counts: [f64; N]) -> f64 {
    counts.iter().product()
}

/// Gradings, 1 where there is a single element.
fn grading<const N: usize>(table: &Table<'_>, divisions: Option<[usize; N]>) -> Option<[f64; N]> {
    table.default("grading", [1.0; N], |n| {
        let grading: [f64; N] = n.array(|n| {
            let value = n.positive()?;
            if !(1e-6..=1e6).contains(&value) {
                return n.fail("must lie between 1e-6 and 1e6", "choose a weaker grading");
            }
            Some(value)
        })?;
        if let Some(i) = (0..N).find(|&i| grading[i] != 1.0 && divisions.is_some_and(|d| d[i] == 1)) {
            return n.fail(
                format!("entry {} must be 1 where there is a single element", i + 1),
                "set it to 1 or use more divisions",
            );
        }
        Some(grading)
    })
}

fn block(table: &Table<'_>) -> Option<Generator> {
    let size = table.optional("size", |n| n.array(Node::positive));
    let min = table.optional("min", Node::vector);
    let max = table.optional("max", Node::vector);
    let divisions = divisions(table, "divisions = [4, 4, 4]", [1; 3], product);
    let grading = grading(table, divisions);
    let size_or_corners = match (table.has("size"), table.has("min"), table.has("max")) {
        (true, false, false) | (false, true, true) => Some(()),
        (false, false, false) => table.missing("size", "size = [1, 1, 1]"),
        (true, _, _) => {
            table.fail("size", "a block has either `size` or `min` and `max`", "remove `size`, or `min` and `max`")
        }
        (false, true, false) => table.missing("max", "max = [1, 1, 1]"),
        (false, false, true) => table.missing("min", "min = [0, 0, 0]"),
    };
    if let (Some(Some(min)), Some(Some(max))) = (min, max) {
        ordered(table, min, max)?;
    }
    size_or_corners?;
    Some(Generator::Block(Block { size: size?, min: min?, max: max?, divisions: divisions?, grading: grading? }))
}

/// Reports corners that do not span a box.
fn ordered<const N: usize>(table: &Table<'_>, min: [f64; N], max: [f64; N]) -> Option<()> {
    if let Some(i) = (0..N).find(|&i| min[i] >= max[i]) {
        let axis = ["x", "y", "z"][i];
        return table.fail("max", format!("must exceed `min` = {min:?} in {axis}"), "exchange or correct the corners");
    }
    Some(())
}

fn rectangle(table: &Table<'_>) -> Option<Generator> {
    let min = table.required("min", "min = [0, 0]", |n| n.array(Node::number));
    let max = table.required("max", "max = [1, 1]", |n| n.array(Node::number));
    let divisions = divisions(table, "divisions = [4, 4]", [1; 2], product);
    let grading = grading(table, divisions);
    let (min, max): ([f64; 2], [f64; 2]) = (min?, max?);
    ordered(table, min, max)?;
    Some(Generator::Rectangle(Rectangle { min, max, divisions: divisions?, grading: grading? }))
}

/// Reports `smaller` unless it is below `larger`.
fn less(table: &Table<'_>, smaller: (&'static str, f64), larger: (&str, f64)) -> Option<()> {
    if smaller.1 >= larger.1 {
        return table.fail(
            smaller.0,
            format!("must be smaller than `{}` = {}", larger.0, larger.1),
            format!("reduce it or increase `{}`", larger.0),
        );
    }
    Some(())
}

fn hollow_ball(table: &Table<'_>) -> Option<Generator> {
    let inner_diameter = table.required("inner_diameter", "inner_diameter = 0.8", Node::positive);
    let outer_diameter = table.required("outer_diameter", "outer_diameter = 1.0", Node::positive);
    let divisions = divisions(table, "divisions = [6, 2]", [1; 2], |[n, layers]| 6.0 * n * n * layers);
    let (inner_diameter, outer_diameter) = (inner_diameter?, outer_diameter?);
    less(table, ("inner_diameter", inner_diameter), ("outer_diameter", outer_diameter))?;
    Some(Generator::HollowBall(HollowBall { inner_diameter, outer_diameter, divisions: divisions? }))
}

fn hollow_torus(table: &Table<'_>) -> Option<Generator> {
    let ring_radius = table.required("ring_radius", "ring_radius = 38", Node::positive);
    let tube_outer_radius = table.required("tube_outer_radius", "tube_outer_radius = 12", Node::positive);
    let tube_inner_radius = table.required("tube_inner_radius", "tube_inner_radius = 7.5", Node::positive);
    let divisions = divisions(table, "divisions = [78, 20, 2]", [3, 3, 1], product);
    let (ring_radius, tube_outer_radius, tube_inner_radius) = (ring_radius?, tube_outer_radius?, tube_inner_radius?);
    let outer = less(table, ("tube_outer_radius", tube_outer_radius), ("ring_radius", ring_radius));
    less(table, ("tube_inner_radius", tube_inner_radius), ("tube_outer_radius", tube_outer_radius))?;
    outer?;
    Some(Generator::HollowTorus(HollowTorus {
        ring_radius,
        tube_outer_radius,
        tube_inner_radius,
        divisions: divisions?,
    }))
}

fn hexahedron(table: &Table<'_>) -> Option<Generator> {
    let corners = table
        .required("corners", "corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], ...]", |n| n.array(Node::vector));
    let divisions = divisions(table, "divisions = [1, 1, 1]", [1; 3], product);
    let grading = grading(table, divisions);
    Some(Generator::Hexahedron(Hexahedron { corners: corners?, divisions: divisions?, grading: grading? }))
}

fn indenter(table: &Table<'_>) -> Option<Generator> {
    let size = table.required("size", "size = [2, 2]", |n| n.array(Node::positive));
    let height = table.required("height", "height = 1.5", Node::positive);
    let radius = table.required("radius", "radius = 2", Node::positive);
    let divisions = divisions(table, "divisions = [10, 10, 7]", [1; 3], product);
    let grading = grading(table, divisions);
    let (size, height, radius): ([f64; 2], f64, f64) = (size?, height?, radius?);
    let corner = 0.5 * (size[0] * size[0] + size[1] * size[1]).sqrt();
    if radius <= corner {
        return table.fail(
            "radius",
            format!("must exceed the distance {corner} of the corners from the axis"),
            "increase the radius or reduce `size`",
        );
    }
    let rim = radius - (radius * radius - corner * corner).sqrt();
    if height <= rim {
        return table.fail(
            "height",
            format!("must exceed the height {rim} of the bottom's corners"),
            "increase the height or the radius",
        );
    }
    Some(Generator::Indenter(Indenter { size, height, radius, divisions: divisions?, grading: grading? }))
}

/// Refinement of a round body with this radius and this first entry of the divisions.
fn refinement(table: &Table<'_>, radius: Option<f64>, across: Option<usize>) -> Option<Option<Refinement>> {
    table.optional("refinement", |n| {
        let inner = n.table()?;
        let half_width = inner.required("half_width", "half_width = 0.03", Node::positive);
        let elements = inner.required("elements", "elements = 8", Node::count);
        inner.finish();
        let (half_width, elements) = (half_width?, elements? as usize);
        if let Some(arc) = radius.map(|r| std::f64::consts::FRAC_PI_4 * r)
            && half_width >= arc
        {
            let message = format!("must be smaller than an eighth of the circle, {arc}");
            return inner.fail("half_width", message, "reduce it, or leave out the refinement");
        }
        if let Some(across) = across
            && elements >= across
        {
            let message = format!("must be below the first of the divisions, {across}");
            return inner.fail("elements", message, "reduce it, or use more divisions");
        }
        Some(Refinement { half_width, elements })
    })
}

fn part(table: &Table<'_>) -> Option<Part> {
    table.default("part", Part::default_part(), |n| n.choice(Part::NAMES, Part::from_name))
}

fn ball(table: &Table<'_>) -> Option<Generator> {
    let radius = table.required("radius", "radius = 1", Node::positive);
    let part = part(table);
    let divisions = divisions(table, "divisions = [6, 4, 6]", [1; 3], |[across, up, out]| {
        8.0 * (across * across * up + (across * across + 2.0 * across * up) * out)
    });
    let refinement = refinement(table, radius, divisions.map(|d| d[0]));
    Some(Generator::Ball(Ball { radius: radius?, part: part?, divisions: divisions?, refinement: refinement? }))
}

/// A part of what is round in a plane.
fn round_part(table: &Table<'_>) -> Option<Part> {
    table.default("part", Part::default_part(), |n| {
        let part = n.choice(Part::NAMES, Part::from_name)?;
        if part == Part::Eighth {
            return n.fail("is a part of a ball only", "choose \"quarter\", \"half\" or \"full\"");
        }
        Some(part)
    })
}

fn disc(table: &Table<'_>) -> Option<Generator> {
    let radius = table.required("radius", "radius = 1", Node::positive);
    let part = round_part(table);
    let divisions = divisions(table, "divisions = [6, 6, 6]", [1; 3], |[x, y, out]| 4.0 * (x * y + (x + y) * out));
    let refinement = refinement(table, radius, divisions.map(|d| d[0]));
    Some(Generator::Disc(Disc { radius: radius?, part: part?, divisions: divisions?, refinement: refinement? }))
}

fn cylinder(table: &Table<'_>) -> Option<Generator> {
    let radius = table.required("radius", "radius = 1", Node::positive);
    let length = table.required("length", "length = 1", Node::positive);
    let part = round_part(table);
    let divisions = divisions(table, "divisions = [6, 4, 6, 1]", [1; 4], |[across, up, out, along]| {
        4.0 * (across * up + (across + up) * out) * along
    });
    let refinement = refinement(table, radius, divisions.map(|d| d[0]));
    let (radius, length) = (radius?, length?);
    Some(Generator::Cylinder(Cylinder { radius, length, part: part?, divisions: divisions?, refinement: refinement? }))
}

fn l_shape(table: &Table<'_>) -> Option<Generator> {
    let length = table.required("length", "length = [4, 3]", |n| n.array(Node::positive));
    let width = table.required("width", "width = 1", Node::positive);
    let thickness = table.required("thickness", "thickness = 1", Node::positive);
    let divisions = divisions(table, "divisions = [3, 2, 1, 1]", [1; 4], |[along_x, along_y, across, through]| {
        (along_x + along_y + across) * across * through
    });
    let (length, width): ([f64; 2], f64) = (length?, width?);
    if length.iter().any(|&l| l <= width) {
        return table.fail(
            "length",
            format!("both lengths must exceed the width {width}"),
            "increase the lengths or reduce `width`",
        );
    }
    Some(Generator::LShape(LShape { length, width, thickness: thickness?, divisions: divisions? }))
}
