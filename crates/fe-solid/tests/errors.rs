//! Inverted elements and other bad input are reported by name and number.
use crate::common::*;
use std::sync::Arc;
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};
use stoss_fe_solid::{ForceRule, SolidBody, SolidError, SolidStep, TimeLevel};
use stoss_mesh::{Elements, Mesh, generate::Block};
use stoss_reference_element::CellKind;

#[test]
fn inverted_element_is_found_by_the_sign_of_det_f() {
    // Three separate cubes in one mesh; the second is mirrored, so det F = -1 while C = 1.
    let cube = Block::new([0.0; 3], [1.0; 3], [1, 1, 1]).generate().unwrap();
    let mut nodes = Vec::new();
    let mut elements = Elements::new();
    for k in 0..3 {
        nodes.extend(cube.nodes.iter().map(|x| [x[0] + 2.0 * k as f64, x[1], x[2]]));
        let nodes: Vec<u32> = cube.elements[0].iter().map(|n| n + 8 * k).collect();
        elements.push(CellKind::Hex8, &nodes);
    }
    let mesh = Mesh::new(nodes, elements).unwrap();
    let x = positions(&mesh);
    let mut mirrored = x.clone();
    for node in 8..16 {
        mirrored[3 * node] = 5.0 - mirrored[3 * node];
    }
    for law in laws() {
        let mut body = body(&mesh, &law);
        body.begin_step(&x, ForceRule::DiscreteGradient, 1.0).unwrap();
        for rule in [ForceRule::END_POINT, ForceRule::MIDPOINT, ForceRule::DiscreteGradient] {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let step = SolidStep { q_n: &x, q_np1: &mirrored, rule };
                let error = pool.install(|| force(&body, step)).unwrap_err();
                let SolidError::InvertedElement { body, element, gauss_point, determinant, level } = error else {
                    panic!("{error}");
                };
                assert_eq!((body.as_str(), element, gauss_point, level), ("body", 1, 0, TimeLevel::End));
                assert!((determinant + 1.0).abs() < 1e-14);
            }
        }
        assert!(matches!(body.strain_energy(&mirrored), Err(SolidError::InvertedElement { element: 1, .. })));
        assert!(matches!(body.gauss_point_state(&mirrored), Err(SolidError::InvertedElement { element: 1, .. })));
        assert!(matches!(
            body.begin_step(&mirrored, ForceRule::DiscreteGradient, 1.0),
            Err(SolidError::InvertedElement { element: 1, level: TimeLevel::Start, .. })
        ));
    }
}

#[test]
fn half_a_turn_has_no_midpoint_configuration_but_an_energy_momentum_force() {
    let mesh = Block::with_size([1.0; 3], [1, 1, 1]).generate().unwrap();
    let x = positions(&mesh);
    let turned = map_positions(&x, |x| [-x[0], -x[1], x[2]]);
    let mut body = body(&mesh, &laws()[0]);
    body.begin_step(&x, ForceRule::DiscreteGradient, 1.0).unwrap();
    let step = |rule| SolidStep { q_n: &x, q_np1: &turned, rule };
    assert!(matches!(
        force(&body, step(ForceRule::MIDPOINT)),
        Err(SolidError::InvertedElement { element: 0, level: TimeLevel::Intermediate, .. })
    ));
    assert!(max_abs(&force(&body, step(ForceRule::DiscreteGradient)).unwrap()) < 1e-12);
}

#[test]
fn not_a_number_in_the_positions_is_an_inverted_element() {
    let mesh = distorted_block([2, 1, 1], 0.0, 0);
    let mut q = positions(&mesh);
    q[0] = f64::NAN;
    let body = body(&mesh, &laws()[0]);
    assert!(matches!(
        force(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT }),
        Err(SolidError::InvertedElement { element: 0, .. })
    ));
}

#[derive(Debug)]
struct FailsBeyond(f64);

impl HyperelasticLaw for FailsBeyond {
    fn name(&self) -> &str {
        "fails beyond a stretch"
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        if c.trace() > self.0 { Err(ConstitutiveError::NonFinite) } else { Ok(0.0) }
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        self.energy(c).map(|_| *c)
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        Ok((self.stress(c)?, Tensor4::symmetric_identity()))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli { shear: 1.0, bulk: 1.0 }
    }
}

#[test]
fn a_law_without_a_value_is_reported_with_its_place() {
    let mesh = Block::new([0.0; 3], [3.0, 1.0, 1.0], [3, 1, 1]).generate().unwrap();
    // x -> x^2-like stretch: the last element is stretched most.
    let q = map_positions(&positions(&mesh), |x| [if x[0] > 2.5 { 5.0 } else { x[0] }, x[1], x[2]]);
    let law: Arc<dyn HyperelasticLaw> = Arc::new(FailsBeyond(8.0));
    let mut body = body(&mesh, &law);
    let expected = |gauss_point| SolidError::Constitutive {
        body: "body".into(),
        element: 2,
        gauss_point,
        source: ConstitutiveError::NonFinite,
    };
    assert_eq!(body.strain_energy(&q), Err(expected(0)));
    assert_eq!(body.begin_step(&q, ForceRule::DiscreteGradient, 1.0), Err(expected(0)));
    assert_eq!(force(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT }), Err(expected(0)));
    assert_eq!(
        expected(0).to_string(),
        "body 'body': element 2, Gauss point 0: the state of strain is out of the law's range (non-finite result)"
    );
}

#[test]
fn bad_meshes_and_arrays_are_errors() {
    let law = &laws()[0];
    let cube = Block::new([0.0; 3], [1.0; 3], [1, 1, 1]).generate().unwrap();
    let mut inside_out = cube.clone();
    inside_out.elements[0].swap(0, 4);
    inside_out.elements[0].swap(1, 5);
    inside_out.elements[0].swap(2, 6);
    inside_out.elements[0].swap(3, 7);
    let error = SolidBody::new("box", &inside_out, 0, law.clone()).unwrap_err();
    let SolidError::InvertedReference { body: name, element: 0, gauss_point: 0, determinant } = error else {
        panic!("{error}");
    };
    assert_eq!(name, "box");
    assert!((determinant + 0.125).abs() < 1e-15);

    let mut dangling = cube.clone();
    dangling.elements[0][3] = 8;
    assert_eq!(
        SolidBody::new("box", &dangling, 0, law.clone()).unwrap_err(),
        SolidError::NoSuchNode { body: "box".into(), element: 0, node: 8, count: 8 }
    );
    let empty = Mesh { elements: Elements::new(), ..cube.clone() };
    assert_eq!(SolidBody::new("box", &empty, 0, law.clone()).unwrap_err(), SolidError::Empty { body: "box".into() });

    let body = SolidBody::new("box", &cube, 2, law.clone()).unwrap();
    assert!(body.elements()[0].iter().eq(cube.elements[0].iter().map(|n| n + 2).collect::<Vec<_>>().iter()));
    assert!(matches!(body.strain_energy(&[0.0; 24]), Err(SolidError::Length { found: 24, expected: 30, .. })));
    let q: Vec<f64> = [0.0; 6].into_iter().chain(positions(&cube)).collect();
    assert_eq!(body.strain_energy(&q).map(|w| w.abs() < 1e-12), Ok(true));
    assert_eq!(
        force(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::DiscreteGradient }).unwrap_err(),
        SolidError::StepNotBegun { body: "box".into() }
    );
}

#[test]
fn an_element_turned_inside_out_at_a_vertex_is_counted() {
    // The node at (1, 1, 1) of a unit cube goes along the diagonal by `d`: F = I - d 1 (grad N)^T with grad N = (1, 1, 1) there, so
    // that det F = 1 - 3 d at this vertex, and 1 - 1.87 d at the next Gauss point.
    let mesh = Block::new([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).generate().unwrap();
    let law = &laws()[0];
    let body = body(&mesh, law);
    let x = positions(&mesh);
    let corner = (0..mesh.nodes.len()).find(|&n| mesh.nodes[n] == [2.0, 1.0, 1.0]).unwrap();
    let element = mesh.elements.iter().position(|e| e.contains(&(corner as u32))).unwrap();
    for d in [0.0, 0.3, 0.4, 0.5] {
        let mut q = x.clone();
        q[3 * corner..3 * corner + 3].iter_mut().for_each(|x| *x -= d);
        assert!(body.strain_energy(&q).is_ok(), "the Gauss points notice nothing");
        let found = body.inside_out(&q).unwrap();
        if d < 1.0 / 3.0 {
            assert_eq!(found, None);
            continue;
        }
        let found = found.unwrap();
        assert_eq!((found.count, found.element), (1, element));
        assert_eq!(mesh.elements[element][found.node], corner as u32);
        assert!((found.relative_volume - (1.0 - 3.0 * d)).abs() < 1e-14, "{found:?}");
    }
    let mut q = x;
    q[3 * corner] = f64::NAN;
    assert_eq!(body.inside_out(&q).unwrap().map(|f| f.count), Some(1));
}
