//! Skins at the start: thickness, insets, what is refused; motions that take bodies apart. All of blocks whose numbers follow from their sizes.

use nalgebra::Vector3;
use stoss_contact_barrier::{
    Bodies, Interaction, Interactions, ONE_SIDED, SeparationFault, Skin, SkinFacet, Start, StartFault, THICKNESS,
    THINNEST, check_initial, separate, start,
};
use stoss_reference_element::FacetNodes;

/// A block of one hexahedron between two corners.
#[derive(Clone, Copy)]
struct Block {
    min: [f64; 3],
    max: [f64; 3],
    is_rigid: bool,
    /// Whether its surface is closed: else the top is not there.
    is_closed: bool,
}

impl Block {
    fn new(min: [f64; 3], max: [f64; 3]) -> Self {
        Self { min, max, is_rigid: false, is_closed: true }
    }
}

struct Blocks(Vec<Block>);

/// Ways out are found up to this part of the largest one that is looked for, here up to one, and are never too short.
const PRECISION: f64 = 1e-6;

const FACES: [[u32; 4]; 6] = [[0, 3, 2, 1], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]];

/// Natural coordinates, 0 or 1, of the corners.
const CORNERS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

impl Bodies for Blocks {
    fn count(&self) -> u32 {
        self.0.len() as u32
    }

    fn is_rigid(&self, body: u32) -> bool {
        self.0[body as usize].is_rigid
    }

    fn surface(&self, body: u32) -> Vec<FacetNodes> {
        let faces = if self.0[body as usize].is_closed { 6 } else { 5 };
        FACES[..faces].iter().map(|face| FacetNodes::from(face.map(|n| n + 8 * body))).collect()
    }

    fn material_point(&self, body: u32, x: [f64; 3], beyond: f64) -> Option<Vec<(u32, f64)>> {
        let Block { min, max, .. } = self.0[body as usize];
        let s: [f64; 3] = std::array::from_fn(|i| (x[i] - min[i]) / (max[i] - min[i]));
        let out = s.iter().map(|s| (-s).max(s - 1.0)).fold(0.0, f64::max);
        let weight = |c: &[f64; 3]| (0..3).map(|i| if c[i] > 0.5 { s[i] } else { 1.0 - s[i] }).product::<f64>();
        (out <= 0.5 * beyond + 1e-12)
            .then(|| CORNERS.iter().enumerate().map(|(k, c)| (8 * body + k as u32, weight(c))).collect())
    }

    fn is_carried(&self, _: u32) -> bool {
        false
    }
}

impl Blocks {
    fn reference(&self) -> Vec<f64> {
        let place = |block: &Block, c: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| block.min[i] + c[i] * (block.max[i] - block.min[i]))
        };
        self.0.iter().flat_map(|block| CORNERS.iter().flat_map(move |c| place(block, c))).collect()
    }

    fn facets(&self) -> Vec<SkinFacet> {
        let of = |class: u32| self.surface(class).into_iter().map(move |nodes| SkinFacet { nodes, class });
        (0..self.count()).flat_map(of).collect()
    }

    fn rules(&self) -> Interactions {
        let young = |block: &Block| if block.is_rigid { f64::INFINITY } else { 200.0 };
        let bodies: Vec<(u32, f64)> = (0..).zip(self.0.iter().map(young)).collect();
        let mut rules = Interactions::none(&bodies);
        let acts = Some(Interaction { modulus: 100.0, friction: None });
        (0..self.count()).for_each(|a| (0..a).for_each(|b| rules.set(a, b, acts.clone())));
        rules
    }

    fn start(&self, thickness: Option<f64>) -> Result<Start, StartFault> {
        start(thickness, self, &self.rules(), &self.reference(), self.facets(), &[]).map_err(|error| error.fault)
    }

    /// Distance of the skins of the first two.
    fn distance(&self, start: &Start) -> Option<f64> {
        let look = check_initial(&start.skin, &self.rules(), &self.reference(), 2.0 * start.thickness);
        look.nearest.get(&[0, 1]).map(|nearest| nearest.distance)
    }
}

/// Two unit cubes one above the other, with a gap (negative: an overlap).
fn two(gap: f64) -> Blocks {
    Blocks(vec![Block::new([0.0; 3], [1.0; 3]), Block::new([0.2, 0.1, 1.0 + gap], [1.2, 1.1, 2.0 + gap])])
}

#[test]
fn bodies_that_are_apart_keep_their_surfaces() {
    let blocks = two(3.0);
    let made = blocks.start(None).unwrap();
    assert!((made.thickness - THICKNESS).abs() < 1e-15 && made.one_sided.is_empty() && made.nearer.is_empty());
    let (reference, plain) = (blocks.reference(), Skin::new(blocks.facets(), &blocks.reference(), &|_| None));
    assert!((0..plain.vertex_count() as u32).all(|v| made.skin.at(v, &reference) == plain.at(v, &reference)));
}

#[test]
fn bodies_that_touch_go_inside_by_half_of_the_thickness_each() {
    for gap in [0.0, 1e-4] {
        let blocks = two(gap);
        let made = blocks.start(None).unwrap();
        let distance = blocks.distance(&made).unwrap();
        assert!((distance - made.thickness - gap).abs() < 1e-12, "{distance} {}", made.thickness);
        // Only what faces the other one: the bottom of the first stays where it is.
        let lowest = (0..8).map(|v| made.skin.at(v, &blocks.reference()).z).fold(f64::INFINITY, f64::min);
        assert_eq!(lowest, 0.0);
    }
}

#[test]
fn opposite_a_surface_without_an_inside_one_body_goes_all_of_the_way() {
    let mut blocks = two(0.0);
    blocks.0[1] = Block { is_rigid: true, is_closed: false, ..blocks.0[1] };
    let made = blocks.start(None).unwrap();
    assert_eq!(made.one_sided, [[0, 1]]);
    assert!((blocks.distance(&made).unwrap() - made.thickness).abs() < 1e-12);
    let mut rules = blocks.rules();
    rules.scale_modulus([0, 1], ONE_SIDED);
    assert_eq!(rules.between(0, 1).unwrap().modulus, 50.0);
    blocks.0[0] = Block { is_rigid: true, is_closed: false, ..blocks.0[0] };
    // The top of the first one is what is missing: let them touch by their sides.
    let side = Block { min: [1.0, 0.0, 0.0], max: [2.0, 1.0, 1.0], ..blocks.0[1] };
    let refused = Blocks(vec![blocks.0[0], side]).start(None).unwrap_err();
    assert!(matches!(refused, StartFault::NoInside { bodies: [0, 1], .. }), "{refused:?}");
}

#[test]
fn a_thickness_that_is_given_is_told_where_it_is_larger_than_a_gap() {
    let made = two(0.03).start(Some(0.1)).unwrap();
    let [nearer] = made.nearer[..] else { panic!("{:?}", made.nearer) };
    assert!(nearer.bodies == [0, 1] && (nearer.distance - 0.03).abs() < 1e-12 && made.thickness == 0.1);
    let refused = two(1.0).start(Some(0.5 * THINNEST)).unwrap_err();
    assert!(matches!(refused, StartFault::TooThin { shortest, .. } if (shortest - 1.0).abs() < 1e-12), "{refused:?}");
    let refused = two(0.0).start(Some(3.0)).unwrap_err();
    assert!(matches!(refused, StartFault::NoRoom { touches: true, .. }), "{refused:?}");
}

#[test]
fn bodies_in_each_other_are_refused() {
    match two(-0.2).start(None).unwrap_err() {
        StartFault::Cross { bodies: [0, 1], depth: Some(depth), .. } => {
            assert!(
                (0.2 - 1e-12..=0.2 + PRECISION).contains(&depth.length)
                    && (depth.direction + Vector3::z()).norm() < 1e-6,
                "{depth:?}"
            );
        }
        other => panic!("{other:?}"),
    }
    let within = Blocks(vec![Block::new([0.0; 3], [1.0; 3]), Block::new([0.3; 3], [0.7; 3])]);
    assert_eq!(within.start(None).unwrap_err(), StartFault::Inside { bodies: [0, 1] });
}

#[test]
fn bodies_are_taken_apart_by_the_least_motions() {
    let take = |blocks: &Blocks, ease: [f64; 2]| {
        let reference = blocks.reference();
        separate(&Skin::new(blocks.facets(), &reference, &|_| None), &blocks.rules(), &reference, &ease, 0.04)
    };
    let overlap = 0.1;
    let gap = 1.01 * 0.04;
    let moves = take(&two(-overlap), [1.0, 1.0]).unwrap();
    assert!((moves[1] - moves[0]).z >= overlap + gap - 1e-9, "{moves:?}");
    for (by, sign) in moves.iter().zip([-0.5, 0.5]) {
        assert!((by - Vector3::z() * (sign * (overlap + gap))).norm() < PRECISION, "{moves:?}");
    }
    // The one that is three times as easy to move goes three times as far; one that is held not at all.
    let moves = take(&two(-overlap), [3.0, 1.0]).unwrap();
    assert!((moves[0].z + 3.0 * moves[1].z).abs() < 1e-8 && moves[1].z > 0.0, "{moves:?}");
    let moves = take(&two(-overlap), [0.0, 1.0]).unwrap();
    assert!(moves[0] == Vector3::zeros() && (moves[1].z - overlap - gap).abs() < PRECISION, "{moves:?}");
    assert_eq!(take(&two(-overlap), [0.0; 2]).unwrap_err(), SeparationFault::Held { bodies: [0, 1] });
    assert!(matches!(take(&two(-0.6), [1.0; 2]).unwrap_err(), SeparationFault::TooDeep { .. }));
    assert_eq!(take(&two(1.0), [1.0; 2]).unwrap(), [Vector3::zeros(); 2]);
}
