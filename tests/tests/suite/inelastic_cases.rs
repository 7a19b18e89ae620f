//! Materials with history against closed forms and measurements: thick cylinder, hardness, seal that relaxes, impact on a viscoelastic pad (theory/inelastic).

use crate::support::simulation;

/// Limit of the plastic zone of a thick cylinder (bore 100, outside 200) under plane strain, elastically and plastically incompressible, over the widening `u` of the bore, and the pressure for it.
/// R. Hill, The Mathematical Theory of Plasticity (1950), chapter V: `p = 2 Y/sqrt(3) (ln(c/a) + (1 - (c/b)^2)/2)`, and `u = sqrt(3) Y c^2 / (2 E a)`.
fn hill(u: f64, young: f64, yield_stress: f64) -> f64 {
    let c2 = 2.0 * young * 100.0 * u / (3.0_f64.sqrt() * yield_stress);
    if c2 < 1e4 {
        // Elastic: 2 G u/a (1 - (a/b)^2), with G = E/3.
        return 2.0 / 3.0 * young * u / 100.0 * 0.75;
    }
    2.0 * yield_stress / 3.0_f64.sqrt() * (0.5 * (c2 / 1e4).ln() + 0.5 * (1.0 - c2 / 4e4))
}

/// A body that is a sector of two degrees about the z axis, between two radii and heights, held by its planes of symmetry.
fn sector([inner, outer]: [f64; 2], [low, high]: [f64; 2], mesh: &str, material: &str) -> String {
    let (sin, cos) = 2.0_f64.to_radians().sin_cos();
    let corner = |r: f64, [c, s]: [f64; 2], z: f64| format!("[{:?}, {:?}, {z:?}]", r * c, r * s);
    let face = |z: f64| {
        [(inner, [1.0, 0.0]), (outer, [1.0, 0.0]), (outer, [cos, sin]), (inner, [cos, sin])]
            .map(|(r, d)| corner(r, d, z))
            .join(", ")
    };
    format!(
        "[[body]]\nname = \"sector\"\nmesh = {{ generator = \"hexahedron\", corners = [{}, {}], {mesh} }}\nmaterial = {{ {material} }}\n\
         [[prescribe]]\nset = \"sector.front\"\ncomponents = [\"y\"]\nfixed = true\n\
         [[prescribe]]\nset = \"sector.back\"\nnormal = [{:?}, {cos:?}, 0]\nfixed = true\n",
        face(low),
        face(high),
        -sin,
    )
}

/// Up to 99.4 % of the pressure at which all of it flows (192.09).
#[test]
fn a_thick_cylinder_yields_as_hill_says() {
    let mut run = simulation(&format!(
        "[scene]\ntitle = \"cylinder\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.05\n{}\
         [[prescribe]]\nset = \"sector.all\"\ncomponents = [\"z\"]\nfixed = true\n\
         [[load]]\nset = \"sector.left\"\npressure = {{ table = [[0.0, 0.0], [0.2, 120.0], [1.0, 191.0]] }}\n",
        sector(
            [100.0, 200.0],
            [0.0, 5.0],
            "divisions = [16, 1, 1]",
            "law = \"hencky\", young = 210e3, poisson = 0.4999, plasticity = { yield_stress = 240.0 }",
        ),
    ));
    let bore = run.model().reference.chunks(3).position(|x| x == [100.0, 0.0, 0.0]).unwrap();
    let mut plastic = 0;
    while !run.finished() {
        run.advance().unwrap();
        let u = run.state().q[3 * bore] - 100.0;
        let t = run.state().time;
        let pressure = if t < 0.2 { 600.0 * t } else { 120.0 + 71.0 * (t - 0.2) / 0.8 };
        let expected = hill(u, 210e3, 240.0);
        assert!((pressure / expected - 1.0).abs() < 0.002, "{t}: {u} {pressure} {expected}");
        plastic += u32::from(pressure > 105.0);
    }
    assert!(plastic > 15, "{plastic}");
}

/// Brinell's test: a rigid ball of radius 10 is pressed into a metal without hardening. When all around it flows (`E* a/(Y R)` from 40 on) the mean pressure is 2.8 to 3 yield stresses
/// (D. Tabor, The Hardness of Metals, 1951; K. L. Johnson, Contact Mechanics, 1985, section 6.3). It swings as node after node comes into contact, the contact being as large as the share of the nodes.
/// (On the sector the ball is a cylinder about the y axis, which is the same up to 6e-5 of the radius of contact.)
#[test]
fn the_hardness_of_brinell_is_three_yield_stresses() {
    let (young, yield_stress, radius) = (210e3 / (1.0 - 0.09), 400.0, 10.0);
    let mut run = simulation(&format!(
        "[scene]\ntitle = \"Brinell\"\nkind = \"quasi-static\"\n[time]\nend = 0.06\nstep = 0.004\n{}\
         [[prescribe]]\nset = \"sector.left\"\ncomponents = [\"x\"]\nfixed = true\n\
         [[prescribe]]\nset = \"sector.bottom\"\ncomponents = [\"z\"]\nfixed = true\n\
         [[rigid]]\nname = \"ball\"\nshape = {{ kind = \"cylinder\", radius = 10, length = 2, divisions = [1600, 1, 1] }}\n\
         rotation = {{ axis = [1, 0, 0], degrees = 90 }}\nposition = [0, 0, 10]\n\
         [[prescribe]]\nrigid = \"ball\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [1.0, -1.0]] }}\n\
         [[contact]]\nmethod = \"mortar\"\nslave = \"sector.top\"\nmaster = \"ball.side\"\n",
        sector(
            [0.02, 12.0],
            [-12.0, 0.0],
            "divisions = [30, 1, 24], grading = [30, 1, 0.02]",
            "law = \"hencky\", young = 210e3, poisson = 0.3, plasticity = { yield_stress = 400.0 }",
        ),
    ));
    let mut means = Vec::new();
    while !run.finished() {
        run.advance().unwrap_or_else(|e| panic!("{e}"));
        let active = &run.active()[0];
        let reports = run.contact_report(0).unwrap();
        let area: f64 = reports.iter().zip(active).filter(|(_, active)| **active).map(|(slot, _)| slot.area).sum();
        let force: f64 =
            run.contact_force().chunks(3).take(run.model().bodies[0].solid.node_count()).map(|f| f[2]).sum();
        let contact = (180.0 * area / std::f64::consts::PI).sqrt();
        if young * contact / (yield_stress * radius) > 40.0 {
            means.push(force.abs() / area / yield_stress);
        }
    }
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    assert!(means.len() > 5 && mean > 2.75 && mean < 3.0, "{mean} {means:?}");
    assert!(means.iter().all(|p| *p < 3.1), "{means:?}");
}

/// Half of a rubber cord is squeezed by a tenth of its diameter and held. It is incompressible, and the contact does not change while it is held: the force falls as the shear modulus of the
/// law relaxes, `0.5 + 0.3 exp(-t/0.5) + 0.2 exp(-t/2)`, up to the curvature of the branches (logarithmic strain, where the base is neo-Hooke's).
#[test]
fn the_force_of_a_seal_relaxes_as_its_shear_modulus() {
    let fixed =
        |set: &str, axis: &str| format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n");
    let stage = |name: &str, until: f64, step: f64| {
        format!("[[stage]]\nname = \"{name}\"\nkind = \"quasi-static\"\nuntil = {until:?}\nstep = {step:?}\n")
    };
    let mut run = simulation(&format!(
        "[scene]\ntitle = \"seal\"\nkind = \"quasi-static\"\n[time]\nend = 4.0\nstep = 0.1\n\
         [[body]]\nname = \"seal\"\nvolumetric = \"mixed\"\n\
         mesh = {{ generator = \"cylinder\", radius = 1.0, length = 0.1, part = \"quarter\", divisions = [8, 8, 4, 1], refinement = {{ half_width = 0.5, elements = 7 }} }}\n\
         material = {{ law = \"neo-hooke\", young = 6.0, poisson = 0.499, prony = [[0.3, 0.5], [0.2, 2.0]] }}\n\
         [[rigid]]\nname = \"plate\"\nshape = {{ kind = \"box\", size = [6, 2, 1] }}\nposition = [0, 0, -1.5]\nfixed = true\n\
         {}{}[[prescribe]]\nset = \"seal.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [0.01, -0.1]] }}\n\
         [[contact]]\nmethod = \"mortar\"\nslave = \"seal.outer\"\nmaster = \"plate.all\"\n{}{}",
        fixed("seal.all", "y"),
        fixed("seal.left", "x"),
        stage("squeeze", 0.01, 0.001),
        stage("hold", 4.0, 0.1),
    ));
    let reference = run.model().reference.clone();
    let top: Vec<usize> = (0..reference.len() / 3).filter(|node| reference[3 * node + 2] == 0.0).collect();
    let modulus = |t: f64| 0.5 + 0.3 * (-t / 0.5).exp() + 0.2 * (-t / 2.0).exp();
    let mut first = None;
    while !run.finished() {
        run.advance().unwrap();
        let reactions = run.reactions();
        let force: f64 = top.iter().map(|node| reactions[3 * node + 2]).sum();
        if run.state().time < 0.01 - 1e-9 {
            continue;
        }
        // Strain grew evenly until 0.01.
        let expected = modulus(run.state().time - 0.005) / modulus(0.005);
        let held = force / *first.get_or_insert(force);
        assert!((held / expected - 1.0).abs() < 0.01, "{}: {held} {expected}", run.state().time);
    }
}

/// Speed after over speed before of a mass on a rod of unit length and area whose shear modulus relaxes by one branch (share `g`, time `tau`) and whose volume is elastic, until the force is zero. Small strains:
/// `x = s/(9 K) + e`, `s = 3 G (1 - g) e + 3 G g (e - q)`, `q' = (e - q)/tau`, `m x'' = -s`, by the method of Runge and Kutta.
fn rebound_of_a_standard_solid(young: f64, poisson: f64, (g, tau): (f64, f64)) -> f64 {
    let (shear, bulk) = (young / 2.0 / (1.0 + poisson), young / 3.0 / (1.0 - 2.0 * poisson));
    let stress = |x: f64, q: f64| {
        let e = (x + shear * g * q / (3.0 * bulk)) / (1.0 + shear / (3.0 * bulk));
        (3.0 * shear * (e - g * q), e)
    };
    let rate = |y: [f64; 3]| {
        let (s, e) = stress(y[0], y[2]);
        [y[1], -s, (e - y[2]) / tau]
    };
    let along = |y: [f64; 3], h: f64, k: [f64; 3]| std::array::from_fn(|i| y[i] + h * k[i]);
    let h = 1e-5;
    let mut y = [0.0, 1.0, 0.0];
    loop {
        let k1 = rate(y);
        let k2 = rate(along(y, h / 2.0, k1));
        let k3 = rate(along(y, h / 2.0, k2));
        let k4 = rate(along(y, h, k3));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        if y[1] < 0.0 && stress(y[0], y[2]).0 <= 0.0 {
            return -y[1];
        }
    }
}

/// A heavy block falls on a light viscoelastic pad: its rebound is that of one dimension, from slow through fast branches, and what is missing stands in the dissipation.
#[test]
fn a_block_rebounds_from_a_viscoelastic_pad_as_in_one_dimension() {
    for branch in [(0.5, 1e-3), (0.5, 0.01), (0.5, 0.03), (0.3, 0.1)] {
        let fixed = |set: &str, axis: &str| {
            format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n")
        };
        let mut run = simulation(&format!(
            "[scene]\ntitle = \"pad\"\nkind = \"dynamic\"\n[time]\nend = 0.2\nstep = 1e-3\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
             [[body]]\nname = \"pad\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }}\ndensity = 1e-3\n\
             material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3, prony = [[{:?}, {:?}]] }}\n{}{}{}\
             [[rigid]]\nname = \"block\"\nshape = {{ kind = \"box\", size = [2, 2, 0.5] }}\nposition = [0.5, 0.5, 1.25]\nmass = 1.0\ninertia = [1, 1, 1]\nvelocity = [0, 0, -0.05]\n\
             [[contact]]\nmethod = \"mortar\"\nslave = \"pad.top\"\nmaster = \"block.all\"\n",
            branch.0,
            branch.1,
            fixed("pad.bottom", "z"),
            fixed("pad.left", "x"),
            fixed("pad.front", "y"),
        ));
        let start = run.balance().total();
        while !run.finished() {
            run.advance().unwrap_or_else(|e| panic!("{branch:?}: {e}"));
        }
        let rebound = run.part_balance(0).linear_momentum[2] / 0.05;
        let expected = rebound_of_a_standard_solid(1000.0, 0.3, branch);
        // The pad has a thousandth of the mass.
        assert!((rebound - expected).abs() < 1e-3, "{branch:?}: {rebound} {expected}");
        let lost = run.balance().dissipation / start;
        // Slow branches still relax when the block has left.
        assert!(lost > 0.9 * (1.0 - rebound * rebound) && lost < 1.0 - rebound * rebound, "{branch:?}: {lost}");
    }
}
