//! Planes of symmetry and sliding supports in any direction.
use std::path::Path;
use stoss::mesh::{Mesh, generate::Block};
use stoss::solver::Simulation;

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Rotation about an axis of length one by an angle in degrees.
#[derive(Clone, Copy)]
struct Turn {
    axis: Vector,
    degrees: f64,
}

impl Turn {
    fn of(&self, x: Vector) -> Vector {
        let (s, c) = self.degrees.to_radians().sin_cos();
        let a = self.axis;
        let cross = [a[1] * x[2] - a[2] * x[1], a[2] * x[0] - a[0] * x[2], a[0] * x[1] - a[1] * x[0]];
        let along = dot(a, x) * (1.0 - c);
        [0, 1, 2].map(|i| c * x[i] + s * cross[i] + along * a[i])
    }
}

/// Turns about axes in all directions, the same in every run; the first is no axis of space either.
fn turns(count: usize) -> impl Iterator<Item = Turn> {
    (0..count).map(|k| {
        let axis = [(1.3 * k as f64 + 0.4).sin(), (2.1 * k as f64 + 1.0).cos(), (0.7 * k as f64 + 2.0).sin()];
        let size = dot(axis, axis).sqrt();
        Turn { axis: axis.map(|a| a / size), degrees: 23.0 + 71.0 * k as f64 }
    })
}

fn build(scene: &str, folder: &Path) -> Result<Simulation, String> {
    let scene = stoss::scene::parse(scene, "scene.toml").map_err(|error| error.to_string())?;
    let built = stoss::build::build(&scene, folder).map_err(|error| error.to_string())?;
    Ok(built.simulation)
}

fn run(scene: &str) -> Simulation {
    let mut simulation = build(scene, Path::new(".")).unwrap_or_else(|error| panic!("{error}\n{scene}"));
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|error| panic!("{error}\n{scene}"));
    }
    simulation
}

/// Positions and reactions of `turned` against those of `straight`, turned.
fn farthest(turn: Turn, straight: &Simulation, turned: &Simulation) -> [f64; 2] {
    let vector = |x: &[f64]| [x[0], x[1], x[2]];
    let off = |a: &[f64], b: &[f64]| {
        assert_eq!(a.len(), b.len());
        let pairs = a.chunks_exact(3).zip(b.chunks_exact(3));
        let each = pairs.map(|(a, b)| {
            let a = turn.of(vector(a));
            (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
        });
        each.fold(0.0, f64::max)
    };
    [off(&straight.state().q, &turned.state().q), off(&straight.reactions(), &turned.reactions())]
}

/// What holds a face along its normal: components, or a normal in any direction.
fn held(set: &str, normal: Vector, turn: Option<Turn>, motion: &str) -> String {
    match turn {
        None => {
            let component = ["x", "y", "z"][(0..3).find(|&i| normal[i] != 0.0).unwrap()];
            format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{component}\"]\n{motion}\n")
        }
        Some(turn) => format!("[[prescribe]]\nset = \"{set}\"\nnormal = {:?}\n{motion}\n", turn.of(normal)),
    }
}

fn placed(turn: Option<Turn>) -> String {
    turn.map_or_else(String::new, |t| format!("rotation = {{ axis = {:?}, degrees = {:?} }}", t.axis, t.degrees))
}

/// An eighth of a block between its planes of symmetry, whose top is pushed.
fn eighth(kind: &str, turn: Option<Turn>, cell: &str) -> String {
    let motion = "displacement = { table = [[0.0, 0.0], [0.5, -0.2], [1.0, -0.2]] }";
    format!(
        "[scene]\ntitle = \"eighth\"\n{kind}\n[[body]]\nname = \"a\"\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1.2, 0.8], divisions = [2, 2, 2] }}\n{cell}\n{}\n\
         material = {{ law = \"neo-hooke\", young = 100.0, poisson = 0.3 }}\n{}{}{}{}",
        placed(turn),
        held("a.left", [1.0, 0.0, 0.0], turn, "fixed = true"),
        held("a.front", [0.0, 1.0, 0.0], turn, "fixed = true"),
        held("a.bottom", [0.0, 0.0, 1.0], turn, "fixed = true"),
        held("a.top", [0.0, 0.0, 1.0], turn, motion),
    )
}

const STATIC: &str = "kind = \"quasi-static\"\n[solver]\nrelative_tolerance = 1e-13\n[time]\nend = 1.0\nstep = 0.25";

fn dynamic(scheme: &str) -> String {
    format!(
        "kind = \"dynamic\"\n[solver]\nrelative_tolerance = 1e-13\n[time]\nend = 1.0\nstep = 0.0625\nintegrator = {{ scheme = \"{scheme}\" }}"
    )
}

/// An eighth of a block in any position is the one along the axes: positions and forces of the supports, in statics and under every scheme with constraints.
#[test]
fn symmetry_planes_in_any_direction_are_those_along_the_axes() {
    let straight = run(&eighth(STATIC, None, ""));
    assert!(straight.reactions().iter().any(|r| r.abs() > 1.0));
    for turn in turns(6) {
        let [place, force] = farthest(turn, &straight, &run(&eighth(STATIC, Some(turn), "")));
        assert!(place < 1e-10 && force < 1e-9, "{place:e} {force:e}");
    }
    let turn = turns(4).last().unwrap();
    for cell in ["cell = \"tet10\"", "cell = \"hex20\"\nintegration = \"reduced\""] {
        let straight = run(&eighth(STATIC, None, cell));
        let [place, force] = farthest(turn, &straight, &run(&eighth(STATIC, Some(turn), cell)));
        assert!(place < 1e-10 && force < 1e-9, "{cell}: {place:e} {force:e}");
    }
}

#[test]
fn symmetry_planes_in_any_direction_under_every_scheme() {
    let turn = turns(3).last().unwrap();
    for scheme in
        ["energy-momentum", "midpoint", "variational-midpoint", "trapezoidal", "generalised-alpha", "backward-euler"]
    {
        let density = "density = 0.05";
        let kind = dynamic(scheme);
        let straight = run(&eighth(&kind, None, density));
        let turned = run(&eighth(&kind, Some(turn), density));
        let [place, _] = farthest(turn, &straight, &turned);
        assert!(place < 1e-9, "{scheme}: {place:e}");
        // The work of the moving support, too.
        let work = [&straight, &turned].map(|simulation| simulation.balance().external_work);
        let exact = scheme.starts_with("energy-momentum") || scheme == "midpoint";
        assert!(!exact || (work[0] - work[1]).abs() < 1e-9 * work[0].abs(), "{scheme}: {work:?}");
    }
}

/// A block slides, spins and vibrates on a plane: momentum along the plane and the energy stay.
#[test]
fn sliding_takes_no_momentum_along_the_plane_and_no_energy() {
    for turn in turns(3) {
        let [n, t1, t2] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|e| turn.of(e));
        let velocity = [0, 1, 2].map(|i| 1.5 * t1[i] - 0.7 * t2[i] + 0.9 * n[i]);
        let spin = n.map(|n| 4.0 * n);
        let scene = format!(
            "[scene]\ntitle = \"slide\"\nkind = \"dynamic\"\n[solver]\nrelative_tolerance = 1e-14\n[time]\nend = 1.0\nstep = 0.02\n\
             integrator = {{ scheme = \"energy-momentum\" }}\n[[body]]\nname = \"a\"\ndensity = 1.0\n\
             mesh = {{ generator = \"block\", size = [1, 1, 1], divisions = [2, 2, 2] }}\n{}\nvelocity = {velocity:?}\nangular_velocity = {spin:?}\n\
             material = {{ law = \"neo-hooke\", young = 50.0, poisson = 0.3 }}\n[[prescribe]]\nset = \"a.bottom\"\nnormal = {n:?}\nfixed = true\n",
            placed(Some(turn))
        );
        let mut simulation = build(&scene, Path::new(".")).unwrap();
        let along = |s: &Simulation| [t1, t2].map(|t| dot(t, s.balance().linear_momentum));
        let (start, energy) = (along(&simulation), simulation.balance().total());
        while !simulation.finished() {
            simulation.advance().unwrap();
            let now = along(&simulation);
            assert!((0..2).all(|i| (now[i] - start[i]).abs() < 1e-12 * start[0].abs()), "{now:?} {start:?}");
            let total = simulation.balance().total();
            assert!((total - energy).abs() < 1e-11 * energy, "{total} {energy}");
            assert!(simulation.balance().external_work.abs() < 1e-13 * energy);
        }
        let model = simulation.model();
        let off = |q: &[f64], x: &[f64]| dot(n, [q[0] - x[0], q[1] - x[1], q[2] - x[2]]).abs();
        let bottom = |x: &&[f64]| dot(n, [x[0], x[1], x[2]]) < -0.49;
        let pairs = simulation.state().q.chunks_exact(3).zip(model.reference.chunks_exact(3));
        let largest = pairs.filter(|(_, x)| bottom(x)).map(|(q, x)| off(q, x)).fold(0.0, f64::max);
        assert!(largest < 1e-12, "{largest:e}");
    }
}

/// A part of a tube: an angle of so many degrees in so many elements, from the x axis.
fn tube(degrees: f64, elements: usize) -> Mesh {
    let block = Block::new([1.0, 0.0, 0.0], [2.0, 1.0, 0.25], [4, elements, 1]).generate().unwrap();
    block
        .map(|[r, s, z]| {
            let (sin, cos) = (s * degrees).to_radians().sin_cos();
            [r * cos, r * sin, z]
        })
        .unwrap()
}

/// 30 degrees of a tube under pressure between inclined planes move as 90 degrees of it do.
#[test]
fn a_sector_of_a_tube_is_the_tube() {
    let folder = tempfile::tempdir().unwrap();
    let solve = |name: &str, degrees: f64, elements: usize| {
        let mesh = tube(degrees, elements);
        stoss::mesh_io::write_mesh(folder.path().join(format!("{name}.inp")), &mesh).unwrap();
        let angle = degrees.to_radians();
        let normal = [-angle.sin(), angle.cos(), 0.0].map(|n| if n.abs() < 1e-15 { 0.0 } else { n });
        let scene = format!(
            "[scene]\ntitle = \"tube\"\n{STATIC}\n[[body]]\nname = \"a\"\nmesh = {{ file = \"{name}.inp\" }}\n\
             material = {{ law = \"neo-hooke\", young = 100.0, poisson = 0.3 }}\n\
             [[prescribe]]\nset = \"a.front\"\nnormal = [0, -2, 0]\nfixed = true\n\
             [[prescribe]]\nset = \"a.back\"\nnormal = {normal:?}\nfixed = true\n\
             [[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"z\"]\nfixed = true\n\
             [[prescribe]]\nset = \"a.top\"\nnormal = [0, 0, 1]\nfixed = true\n\
             [[load]]\nset = \"a.left\"\nfollower_pressure = {{ table = [[0.0, 0.0], [1.0, 15.0]] }}\n"
        );
        let mut simulation = build(&scene, folder.path()).unwrap_or_else(|error| panic!("{error}"));
        while !simulation.finished() {
            simulation.advance().unwrap();
        }
        // Radius of the nodes on the x axis, inside to outside.
        let model = simulation.model();
        let on_axis = |x: &[f64]| x[1].abs() < 1e-12 && x[2] == 0.0;
        let pairs = simulation.state().q.chunks_exact(3).zip(model.reference.chunks_exact(3));
        let mut radii: Vec<(f64, f64)> =
            pairs.filter(|(_, x)| on_axis(x)).map(|(q, x)| (x[0], q[0].hypot(q[1]))).collect();
        radii.sort_by(|a, b| a.0.total_cmp(&b.0));
        radii
    };
    let (sector, quarter) = (solve("sector", 30.0, 3), solve("quarter", 90.0, 9));
    assert_eq!(sector.len(), 5);
    assert!(sector[0].1 > 1.1, "{sector:?}");
    for (a, b) in sector.iter().zip(&quarter) {
        assert!((a.1 - b.1).abs() < 1e-9, "{sector:?} {quarter:?}");
    }
}

/// Two blocks on each other between planes of symmetry: contact acts at nodes that the planes hold.
#[test]
fn contact_acts_at_nodes_that_are_held() {
    let scene = |turn: Option<Turn>, method: &str| {
        let block = |name: &str, low: f64, high: f64, n: usize| {
            format!(
                "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, {low:?}], max = [1, 1, {high:?}], divisions = [{n}, {n}, 2] }}\n{}\n\
                 material = {{ law = \"neo-hooke\", young = 100.0, poisson = 0.3 }}\n",
                placed(turn)
            )
        };
        let mut text =
            format!("[scene]\ntitle = \"pair\"\n{STATIC}\n{}{}", block("a", 0.0, 0.5, 2), block("b", 0.5, 1.0, 3));
        for body in ["a", "b"] {
            text += &held(&format!("{body}.left"), [1.0, 0.0, 0.0], turn, "fixed = true");
            text += &held(&format!("{body}.front"), [0.0, 1.0, 0.0], turn, "fixed = true");
        }
        text += &held("a.bottom", [0.0, 0.0, 1.0], turn, "fixed = true");
        text += &held("b.top", [0.0, 0.0, 1.0], turn, "displacement = { table = [[0.0, 0.0], [1.0, -0.1]] }");
        text + &format!("[[contact]]\nmethod = \"{method}\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n")
    };
    let turn = turns(2).last().unwrap();
    for method in ["mortar", "nts"] {
        let [place, force] = farthest(turn, &run(&scene(None, method)), &run(&scene(Some(turn), method)));
        assert!(place < 1e-9 && force < 1e-7, "{method}: {place:e} {force:e}");
    }
}

/// The same plane twice, by sets that overlap, says nothing new; a third plane through the edge of two others neither.
#[test]
fn directions_that_follow_from_others_are_no_error() {
    let turn = turns(1).next().unwrap();
    let scene = eighth(STATIC, Some(turn), "");
    let [n1, n2] = [[-2.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(|n| turn.of(n));
    let edge = "[[set]]\nname = \"a.edge\"\nbody = \"a\"\n";
    let inside = format!("plane = {{ point = [0, 0, 0], normal = {n2:?} }}\n");
    let more = format!(
        "{scene}[[prescribe]]\nset = \"a.left\"\nnormal = {n1:?}\nfixed = true\n{edge}{inside}[[prescribe]]\nset = \"a.edge\"\nnormal = {n2:?}\nfixed = true\n"
    );
    let (once, twice) = (run(&scene), run(&more));
    let off = once.state().q.iter().zip(&twice.state().q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-12, "{off:e}");
    let sum = |simulation: &Simulation| simulation.reactions().iter().map(|r| r.abs()).sum::<f64>();
    assert!((sum(&once) - sum(&twice)).abs() < 1e-9 * sum(&once));
}

#[test]
fn bad_normals_are_named() {
    let turn = turns(1).next().unwrap();
    let [n, m] = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(|n| turn.of(n));
    let base = eighth(STATIC, Some(turn), "");
    let refuse = |more: &str, words: &[&str]| {
        let error = build(&format!("{base}{more}"), Path::new(".")).map(|_| ()).unwrap_err();
        for word in words {
            assert!(error.contains(word), "{error}");
        }
    };
    refuse("[[prescribe]]\nset = \"a.left\"\nnormal = [0, 0, 0]\nfixed = true\n", &["normal", "zero"]);
    refuse(
        &format!("[[prescribe]]\nset = \"a.left\"\nnormal = {n:?}\ndisplacement = 0.1\n"),
        &["prescribe[4].normal", "a.left", "prescribe[0]", "same displacement"],
    );
    // The corner of three planes is held in all directions: a fourth one cannot move it.
    refuse(
        &format!(
            "[[prescribe]]\nset = \"a.left\"\nnormal = {m:?}\ndisplacement = {{ table = [[0.0, 0.0], [0.4, 0.1]] }}\n"
        ),
        &["prescribe[4].normal", "at t = "],
    );
    refuse(
        "[[prescribe]]\nset = \"a.left\"\nnormal = [1, 1, 0]\ncomponents = [\"x\"]\nfixed = true\n",
        &["components", "cannot be combined with `normal`"],
    );
    refuse("[[prescribe]]\nset = \"a.left\"\nnormal = [1, 1, 0]\ndisplacement = [0.1, 0.2]\n", &["needs 1"]);
    refuse(
        "[[prescribe]]\nset = \"a.left\"\nnormal = [1, 1, 0]\nrotation = { axis = [0, 0, 1], degrees = 3.0 }\n",
        &["normal", "rotation"],
    );
    let flat = "[[support]]\nset = \"a.top\"\nframe = [[1, 1, 0], [2, 2, 0]]\nstiffness = [1, 0, 0]\n";
    refuse(flat, &["support[0].frame", "parallel"]);
}

/// Springs along the axes of a frame: a turned block on turned springs is the straight one.
#[test]
fn springs_along_a_frame_turn_with_it() {
    let scene = |turn: Option<Turn>| {
        let frame = turn.map_or_else(String::new, |turn| {
            let [a, b] = [[2.0, 0.0, 0.0], [0.3, 1.0, 0.0]].map(|e| turn.of(e));
            format!("frame = [{a:?}, {b:?}]\n")
        });
        let pull = [3.0, -2.0, 4.0];
        let pull = turn.map_or(pull, |turn| turn.of(pull));
        format!(
            "[scene]\ntitle = \"springs\"\n{STATIC}\n[[body]]\nname = \"a\"\n\
             mesh = {{ generator = \"block\", size = [1, 1, 1], divisions = [2, 2, 2] }}\n{}\n\
             material = {{ law = \"neo-hooke\", young = 100.0, poisson = 0.3 }}\n\
             [[support]]\nset = \"a.bottom\"\n{frame}stiffness = [50, 80, 200]\n[[load]]\nset = \"a.top\"\ntraction = {pull:?}\n",
            placed(turn)
        )
    };
    let straight = run(&scene(None));
    for turn in turns(3) {
        let turned = run(&scene(Some(turn)));
        let place = farthest(turn, &straight, &turned)[0];
        assert!(place < 1e-9, "{place:e}");
        assert!((straight.balance().strain - turned.balance().strain).abs() < 1e-9);
    }
}
