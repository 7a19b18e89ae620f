//! Meshes of linear hexahedra that are images of a unit cube, as text of an Abaqus file: quarters of tubes, sectors of balls.

use std::f64::consts::FRAC_PI_2;

/// Corners of a face of an element, in elements.
const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];
/// Name, direction and number of the face of an element of the sides at 0 and at 1.
const SIDES: [[(&str, &str); 2]; 3] =
    [[("left", "S6"), ("right", "S4")], [("front", "S3"), ("back", "S5")], [("bottom", "S1"), ("top", "S2")]];

/// Text of a mesh with the surfaces `left`, `right` (first coordinate 0 and 1), `front`, `back` (second), `bottom`, `top` (third) of the cube. `place` takes a
/// point of the cube to its place; it must not turn it inside out.
pub fn mesh(divisions: [usize; 3], place: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let number = |[i, j, k]: [usize; 3], n: [usize; 3]| 1 + (i * n[1] + j) * n[2] + k;
    let all = |n: [usize; 3]| (0..n[0] * n[1] * n[2]).map(move |m| [m / (n[1] * n[2]), m / n[2] % n[1], m % n[2]]);
    let nodes = divisions.map(|n| n + 1);
    let mut lines = vec!["*NODE".to_owned()];
    lines.extend(all(nodes).map(|at| {
        let [x, y, z] = place(std::array::from_fn(|i| at[i] as f64 / divisions[i] as f64));
        format!("{}, {x:?}, {y:?}, {z:?}", number(at, nodes))
    }));
    lines.push("*ELEMENT, TYPE=C3D8, ELSET=all".to_owned());
    lines.extend(all(divisions).map(|at| {
        let corners = [0, 1].into_iter().flat_map(|c| CORNERS.map(|[a, b]| [at[0] + a, at[1] + b, at[2] + c]));
        let corners: Vec<String> = corners.map(|corner| number(corner, nodes).to_string()).collect();
        format!("{}, {}", number(at, divisions), corners.join(", "))
    }));
    for (axis, sides) in SIDES.iter().enumerate() {
        for ((name, face), end) in sides.iter().zip([0, divisions[axis] - 1]) {
            lines.push(format!("*SURFACE, NAME={name}, TYPE=ELEMENT"));
            let there = all(divisions).filter(|at| at[axis] == end);
            lines.extend(there.map(|at| format!("{}, {face}", number(at, divisions))));
        }
    }
    lines.join("\n") + "\n"
}

/// A quarter of a tube about the z-axis, `x, y >= 0`, from z = 0: inner and outer radius, length, numbers of elements through the wall, around and along.
/// Its surfaces: `left` inside, `right` outside, `front` in y = 0, `back` in x = 0, `bottom`, `top`.
pub fn tube(radii: [f64; 2], length: f64, divisions: [usize; 3]) -> String {
    mesh(divisions, |[u, v, w]| {
        let r = radii[0] + (radii[1] - radii[0]) * u;
        let (sin, cos) = (FRAC_PI_2 * v).sin_cos();
        [if v == 1.0 { 0.0 } else { r * cos }, r * sin, length * w]
    })
}

/// A sector of a hollow ball about the origin, a 24th, of the points with `0 <= y, z <= x`: inner and outer radius, numbers of elements through the wall and along both directions.
/// Its surfaces: `left` inside, `right` outside, `front` in y = 0, `back` in y = x, `bottom` in z = 0, `top` in z = x.
pub fn sector(radii: [f64; 2], divisions: [usize; 2]) -> String {
    mesh([divisions[0], divisions[1], divisions[1]], |[u, v, w]| {
        let r = radii[0] + (radii[1] - radii[0]) * u;
        let [y, z] = [v, w].map(|s| (0.5 * FRAC_PI_2 * s).tan());
        let x = r / (1.0 + y * y + z * z).sqrt();
        [x, x * y, x * z]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places of the nodes and corners of the elements of a text.
    fn read(text: &str) -> (Vec<[f64; 3]>, Vec<Vec<usize>>) {
        let numbers = |line: &str| line.split(", ").map(str::parse).collect::<Result<Vec<f64>, _>>();
        let lines: Vec<&str> = text.lines().collect();
        let end = lines.iter().position(|line| line.starts_with("*ELEMENT")).unwrap();
        let nodes = lines[1..end].iter().map(|line| numbers(line).unwrap()).map(|n| [n[1], n[2], n[3]]).collect();
        let elements = lines[end + 1..].iter().map_while(|line| numbers(line).ok());
        (nodes, elements.map(|n| n[1..].iter().map(|n| *n as usize - 1).collect()).collect())
    }

    /// Triple product of the edges at the first corner of every element.
    fn volumes((nodes, elements): &(Vec<[f64; 3]>, Vec<Vec<usize>>)) -> Vec<f64> {
        let edge = |a: usize, b: usize| std::array::from_fn::<f64, 3, _>(|i| nodes[b][i] - nodes[a][i]);
        let volume = |e: &Vec<usize>| {
            let [a, b, c] = [1, 3, 4].map(|k| edge(e[0], e[k]));
            (0..3).map(|i| a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3])).sum()
        };
        elements.iter().map(volume).collect()
    }

    #[test]
    fn tubes_and_sectors_have_their_radii_and_are_not_inside_out() {
        let tube = read(&tube([1.0, 2.0], 0.5, [2, 3, 1]));
        assert_eq!((tube.0.len(), tube.1.len()), (3 * 4 * 2, 6));
        let radii =
            tube.0.iter().map(|[x, y, _]| x.hypot(*y)).fold([f64::INFINITY, 0.0], |r, x| [r[0].min(x), r[1].max(x)]);
        assert!((radii[0] - 1.0).abs() < 1e-15 && (radii[1] - 2.0).abs() < 1e-15);
        let ball = read(&sector([1.0, 2.0], [2, 3]));
        assert_eq!((ball.0.len(), ball.1.len()), (3 * 4 * 4, 18));
        // On the plane y = x, and on z = x.
        assert!(ball.0.iter().any(|x| (x[0] - x[1]).abs() < 1e-15 && (x[0] - x[2]).abs() < 1e-15));
        assert!([tube, ball].iter().all(|mesh| volumes(mesh).into_iter().all(|volume| volume > 0.0)));
    }

    #[test]
    fn sides_have_the_faces_of_a_block() {
        let text = mesh([2, 1, 1], |x| x);
        for side in
            ["left, TYPE=ELEMENT\n1, S6\n*", "right, TYPE=ELEMENT\n2, S4\n*", "bottom, TYPE=ELEMENT\n1, S1\n2, S1\n*"]
        {
            assert!(text.contains(&format!("NAME={side}")), "{text}");
        }
    }
}
