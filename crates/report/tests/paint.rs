//! A picture of a made-up frame of all kinds of cells.

use stoss_mesh_io::{Field, VtuFrame, write_vtu_to};
use stoss_report::paint::{Camera, Primitives, Shot, Style, draw};

/// Quadrilaterals of a box whose corners are numbered from `first` on as those of a hexahedron.
const SIDES: [[u32; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn corners(centre: [f64; 3], half: [f64; 3], angle: f64) -> [[f64; 3]; 8] {
    let signs = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]];
    signs.map(|sign| {
        let [x, y, z] = std::array::from_fn(|i| f64::from(sign[i]) * half[i]);
        let (s, c) = angle.sin_cos();
        [centre[0] + c * x + s * z, centre[1] + y, centre[2] - s * x + c * z]
    })
}

/// A trebuchet from the side: ground and counterweight (rigid bodies), frame and arm (beams), sling (string), projectile (point), and a solid block.
#[test]
fn a_trebuchet_is_seen_from_the_side() {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let add = |points: &mut Vec<[f64; 3]>, new: &[[f64; 3]]| {
        let first = points.len() as u32;
        points.extend_from_slice(new);
        first
    };
    let block = add(&mut points, &corners([4.0, 0.0, 0.5], [0.5, 0.5, 0.5], 0.0));
    let ground = add(&mut points, &[[-8.0, -3.0, 0.0], [6.0, -3.0, 0.0], [6.0, 3.0, 0.0], [-8.0, 3.0, 0.0]]);
    let weight = add(&mut points, &corners([2.2, 0.0, 3.2], [0.6, 0.6, 0.6], 0.4));
    let mut lines: Vec<Vec<u32>> = Vec::new();
    let mut line = |points: &mut Vec<[f64; 3]>, nodes: &[[f64; 3]]| {
        let first = add(points, nodes);
        lines.push((first..first + nodes.len() as u32).collect());
    };
    for y in [-1.0, 1.0] {
        line(&mut points, &[[-1.5, y, 0.0], [0.0, y, 4.0], [1.5, y, 0.0]]);
    }
    line(&mut points, &[[0.0, -1.0, 4.0], [0.0, 1.0, 4.0]]);
    line(&mut points, &[[2.0, 0.0, 4.0], [0.0, 0.0, 4.0], [-2.0, 0.0, 3.9], [-4.0, 0.0, 3.5]]);
    line(&mut points, &[[-4.0, 0.0, 3.5], [-4.6, 0.0, 2.4], [-4.9, 0.0, 1.2]]);
    let ball = add(&mut points, &[[-4.9, 0.0, 1.2]]);
    let side = |k: usize| SIDES[k].map(|corner| corner + weight).into();
    let speed: Vec<f64> = points.iter().map(|x| (x[0].powi(2) + (x[2] - 4.0).powi(2)).sqrt()).collect();
    let body: Vec<f64> = [vec![0.0, 1.0], vec![2.0; 6], (3..9).map(f64::from).collect()].concat();
    let elements = stoss_mesh::Elements::from(vec![std::array::from_fn(|k| block + k as u32)]);
    let frame = VtuFrame {
        points: &points,
        elements: elements.blocks(),
        facets: &[
            [ground, ground + 1, ground + 2, ground + 3].into(),
            side(0),
            side(1),
            side(2),
            side(3),
            side(4),
            side(5),
        ],
        lines: &lines,
        vertices: &[ball],
        point_data: vec![Field { name: "speed", components: 1, values: &speed }],
        cell_data: vec![Field { name: "body", components: 1, values: &body }],
        ..VtuFrame::default()
    };
    let mut text = Vec::new();
    write_vtu_to(&mut text, &frame).unwrap();
    let grid = stoss_mesh_io::read_vtu_from_bytes("frame", &text).unwrap();
    let surface = Primitives::new(&grid, "speed").unwrap();
    let style = Style { title: "Trebuchet", label: "speed", width: 560.0, range: None };
    let shots = [-90.0, -60.0].map(|azimuth| (Camera { azimuth, elevation: 8.0 }, surface.clone()));
    for (number, (camera, surface)) in shots.into_iter().enumerate() {
        let svg = draw(&[Shot { caption: format!("azimuth {}", camera.azimuth), surface }], camera, &style);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(svg.matches("<circle").count(), 1);
        // Every part of a line is a dark rim and a colour upon it.
        let [rims, colours] = ["butt", "round\" d="].map(|cap| svg.matches(cap).count());
        assert!(rims == colours && rims > 20, "{rims} {colours}");
        // The ground lies behind what stands on it: it is drawn first. The projectile hangs before it.
        let (first_face, disc) = (svg.find("<path").unwrap(), svg.find("<circle").unwrap());
        assert!(first_face < disc);
        std::fs::write(format!("{}/trebuchet-{number}.svg", env!("CARGO_TARGET_TMPDIR")), svg).unwrap();
    }
    // From below the open ground is seen, too, and hides what stands on it.
    let below = Camera { azimuth: -90.0, elevation: -80.0 };
    let svg = draw(&[Shot { caption: String::new(), surface }], below, &style);
    let (disc, last_face) = (svg.find("<circle").unwrap(), svg.rfind("<path stroke=\"#222222\" d=").unwrap());
    assert!(disc < last_face);
}
