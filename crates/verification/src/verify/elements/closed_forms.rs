//! Nearly incompressible solids at large strains against closed forms: a thick cylinder and a hollow sphere under pressure, a bar that is twisted;
//! and a block under a punch, for which only how far each form goes is checked.
//!
//! For the incompressible neo-Hookean solid with the shear modulus `mu`, inner and outer radii `a`, `b` and hoop stretches `s`, `t` there:
//! cylinder `p = mu [ln s - 1/(2 s^2) - ln t + 1/(2 t^2)]`, `b^2 (t^2 - 1) = a^2 (s^2 - 1)`;
//! sphere `p = 2 mu [1/t + 1/(4 t^4) - 1/s - 1/(4 s^4)]`, `b^3 (t^3 - 1) = a^3 (s^3 - 1)`;
//! twist `c` a length of a bar with radius `r`, its length held: moment `pi mu c r^4 / 2`, axial force `-pi mu c^2 r^4 / 4` (Rivlin 1948).

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{SolidOptions, Volumetric};
use stoss_materials::NeoHooke;
use stoss_mesh::Mesh;
use stoss_mesh::generate::{Block, Cylinder, HollowBall, Portion};
use stoss_reference_element::{CellKind, FaceNodes, Family, Integration};

use super::equilibrium::{Equilibrium, Load};
use super::{facade, table};
use crate::verify::Findings;
use crate::verify::check::{Bound, Check, number};
use crate::workspace::Outcome;

/// Largest relative error with the meshes below.
const CLOSE: f64 = 0.02;
const POISSON: f64 = 0.499_999;
/// Hoop stretch at the inner surface, which fixes the pressure.
const STRETCH: f64 = 1.4;

/// A cell with its form, and whether it has to be close.
struct Form {
    kind: CellKind,
    volumetric: Volumetric,
    close: bool,
}

const FORMS: [Form; 9] = [
    Form { kind: CellKind::Hex8, volumetric: Volumetric::Displacement, close: false },
    Form { kind: CellKind::Hex8, volumetric: Volumetric::Mixed, close: true },
    Form { kind: CellKind::Hex20, volumetric: Volumetric::Mixed, close: true },
    Form { kind: CellKind::Hex27, volumetric: Volumetric::Mixed, close: true },
    Form { kind: CellKind::Tet4, volumetric: Volumetric::Mixed, close: false },
    Form { kind: CellKind::Tet10, volumetric: Volumetric::Displacement, close: false },
    Form { kind: CellKind::Tet10, volumetric: Volumetric::Mixed, close: true },
    Form { kind: CellKind::Wedge6, volumetric: Volumetric::Mixed, close: false },
    Form { kind: CellKind::Wedge15, volumetric: Volumetric::Mixed, close: true },
];

impl Form {
    fn name(&self) -> String {
        match self.volumetric {
            Volumetric::Displacement => self.kind.name().to_owned(),
            Volumetric::Mixed => format!("{} mixed", self.kind.name()),
        }
    }

    fn options(&self) -> SolidOptions {
        SolidOptions { integration: Integration::Full, volumetric: self.volumetric }
    }

    /// Linear cells get twice the elements along an edge.
    fn elements(&self, of_quadratic: usize) -> usize {
        if self.kind.is_quadratic() { of_quadratic } else { 2 * of_quadratic }
    }
}

/// Unit shear modulus.
fn law() -> Outcome<Arc<dyn HyperelasticLaw>> {
    let lambda = 2.0 * POISSON / (1.0 - 2.0 * POISSON);
    Ok(Arc::new(NeoHooke::new(lambda, 1.0)?))
}

/// Facets all of whose nodes are at this distance from the axis (`dimensions` 2) or the centre (3).
fn at_radius(mesh: &Mesh, radius: f64, dimensions: usize) -> Vec<FaceNodes> {
    let there = |n: &u32| {
        let x = mesh.nodes[*n as usize];
        (x[..dimensions].iter().map(|x| x * x).sum::<f64>().sqrt() - radius).abs() < 1e-9
    };
    mesh.boundary_facets().iter().map(|facet| facet.nodes).filter(|nodes| nodes.iter().all(there)).collect()
}

/// Mean stretch of the hoops of these facets' nodes.
fn hoop_stretch(q: &[f64], facets: &[FaceNodes], radius: f64, dimensions: usize) -> f64 {
    let mut nodes: Vec<u32> = facets.iter().flat_map(|facet| facet.iter().copied().collect::<Vec<_>>()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let at = |n: &u32| q[3 * *n as usize..][..dimensions].iter().map(|x| x * x).sum::<f64>().sqrt();
    nodes.iter().map(at).sum::<f64>() / nodes.len() as f64 / radius
}

/// A quarter of a cylinder of radii 1 and 2 in plane strain.
fn cylinder(form: &Form) -> Outcome<(f64, f64)> {
    let n = form.elements(4);
    let mut mesh = Block::new([0.0; 3], [1.0, 1.0, 0.2], [n, n / 2, 1]).generate()?.with_cells(form.kind)?;
    for x in &mut mesh.nodes {
        let (angle, r) = (FRAC_PI_2 * (1.0 - x[0]), 1.0 + x[1]);
        let (sin, cos) = angle.sin_cos();
        let on_axis = |c: f64| if c.abs() < 1e-12 { 0.0 } else { c };
        *x = [on_axis(r * cos), on_axis(r * sin), x[2]];
    }
    let pressed = at_radius(&mesh, 1.0, 2);
    let held = |x: [f64; 3]| [x[0] == 0.0, x[1] == 0.0, true];
    let outer = (1.0 + 0.25 * (STRETCH * STRETCH - 1.0)).sqrt();
    let part = |s: f64| s.ln() - 0.5 / (s * s);
    inflate(form, mesh, held, pressed, part(STRETCH) - part(outer), 2)
}

/// A hollow sphere of radii 0.5 and 1.
fn sphere(form: &Form) -> Outcome<(f64, f64)> {
    // Flat facets converge slowly.
    let n = if form.kind.is_quadratic() { 4 } else { 12 };
    let ball = HollowBall { inner_diameter: 1.0, outer_diameter: 2.0, divisions: [n, n / 2 + 1] };
    let mut mesh = ball.generate()?.with_cells(form.kind)?;
    // New nodes of curved boundaries are near their sphere, and are put on it.
    for x in &mut mesh.nodes {
        let r = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        for radius in [0.5, 1.0] {
            if (r - radius).abs() < 0.01 {
                *x = x.map(|c| c * radius / r);
            }
        }
        *x = x.map(|c| if c.abs() < 1e-12 { 0.0 } else { c });
    }
    let pressed = at_radius(&mesh, 0.5, 3);
    let held = |x: [f64; 3]| x.map(|c| c == 0.0);
    let outer = (1.0 + 0.125 * (STRETCH.powi(3) - 1.0)).cbrt();
    let part = |s: f64| 2.0 / s + 0.5 / s.powi(4);
    inflate(form, mesh, held, pressed, part(outer) - part(STRETCH), 3)
}

/// The hoop stretch of the inner surface less 1, over the exact one, and the share of the load that was reached.
fn inflate(
    form: &Form,
    mesh: Mesh,
    held: impl Fn([f64; 3]) -> [bool; 3],
    pressed: Vec<FaceNodes>,
    pressure: f64,
    dimensions: usize,
) -> Outcome<(f64, f64)> {
    let radius = if dimensions == 2 { 1.0 } else { 0.5 };
    let problem = Equilibrium::new(mesh, law()?, form.options(), held, pressed.clone())?;
    let mut q = problem.reference();
    let reached = problem.follow(&mut q, Load { forces: &[], pressure }, 0.2, |x, _| x)?;
    let found = hoop_stretch(&q, &pressed, radius, dimensions);
    Ok(((found - 1.0) / (STRETCH - 1.0), reached))
}

/// A bar of radius 0.5 and length 1 along y, one end of which is turned by 60 degrees: the moment and the axial force over the exact ones.
fn twist(form: &Form) -> Outcome<(f64, f64, f64)> {
    let n = form.elements(4);
    let bar = Cylinder {
        radius: 0.5,
        length: 1.0,
        part: Portion::Full,
        divisions: [n / 2, n / 2, n / 2, n],
        refinement: None,
    };
    let mesh = bar.generate()?.with_cells(form.kind)?;
    let angle = PI / 3.0;
    let problem = Equilibrium::new(mesh, law()?, form.options(), |x| [x[1] == 0.0 || x[1] == 1.0; 3], Vec::new())?;
    let mut q = problem.reference();
    let reached = problem.follow(&mut q, Load { forces: &[], pressure: 0.0 }, 0.2, |x, share| {
        let (sin, cos) = (angle * share * x[1]).sin_cos();
        [cos * x[0] + sin * x[2], x[1], cos * x[2] - sin * x[0]]
    })?;
    let force = problem.internal_force(&q, None)?;
    let (mut moment, mut axial) = (0.0, 0.0);
    for (n, x) in problem.mesh.nodes.iter().enumerate() {
        if x[1] == 1.0 {
            let (x, f) = (&q[3 * n..3 * n + 3], &force[3 * n..3 * n + 3]);
            moment += x[2] * f[0] - x[0] * f[2];
            axial += f[1];
        }
    }
    let r4 = 0.5_f64.powi(4);
    Ok((moment / (0.5 * PI * angle * r4), axial / (-0.25 * PI * angle * angle * r4), reached))
}

/// A quarter of a block of 2 x 2 x 1 on a smooth plane; a smooth punch of 1 x 1 goes down to half the height. The share of that way that a form goes, and what
/// ends it.
fn punch(form: &Form) -> Outcome<(f64, String)> {
    let n = form.elements(2);
    let volumetric = if form.volumetric == Volumetric::Mixed { "volumetric = \"mixed\"" } else { "" };
    let supports = [("left", "x"), ("front", "y"), ("bottom", "z")].map(|(set, component)| {
        format!("[[prescribe]]\nset = \"b.{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n")
    });
    let text = format!(
        "[scene]\ntitle = \"punch\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.05\n\
         [[body]]\nname = \"b\"\ncell = \"{}\"\n{volumetric}\nmaterial = {{ law = \"neo-hooke\", young = {:?}, poisson = {POISSON:?} }}\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [{n}, {n}, {n}] }}\n{}\
         [[prescribe]]\nset = \"b.top & x <= 0.5 & y <= 0.5\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [1.0, -0.5]] }}\n",
        form.kind.name(),
        2.0 * (1.0 + POISSON),
        supports.concat()
    );
    let mut simulation = facade::simulation(&text)?;
    let end = match facade::run(&mut simulation) {
        Ok(_) => "reached".to_owned(),
        Err(error) => error.to_string(),
    };
    Ok((simulation.state().time, end))
}

/// Measures all closed forms.
pub fn measure(findings: &mut Findings, quick: bool) -> Outcome<()> {
    let mut rows = Vec::new();
    for form in &FORMS {
        if quick && !(form.close && matches!(form.kind, CellKind::Hex8 | CellKind::Hex27 | CellKind::Tet10)) {
            continue;
        }
        let name = form.name();
        let bound = if form.close { Bound::Near { value: 1.0, tolerance: CLOSE } } else { Bound::Unbounded };
        let mut told = vec![name.clone()];
        let mut check = |what: &str, quantity: &str, value: f64, reached: f64, told: &mut Vec<String>| {
            // What did not come to its end is no result.
            let value = if reached < 1.0 - 1e-9 { f64::NAN } else { value };
            let check = Check::new(&format!("{what}, {name}"), quantity, value, bound);
            findings.checks.push(check.noted(format!("Poisson's ratio {POISSON}")));
            told.push(number(value));
        };
        let (stretch, reached) = cylinder(form)?;
        check("thick cylinder", "hoop strain over the exact one", stretch, reached, &mut told);
        // Neither mesh has one direction along which it could be cut into wedges.
        if form.kind.table().family == Family::Wedge {
            told.extend(["-"; 3].map(String::from));
        } else {
            let (stretch, reached) = sphere(form)?;
            check("hollow sphere", "hoop strain over the exact one", stretch, reached, &mut told);
            let (moment, axial, reached) = twist(form)?;
            check("twisted bar", "moment over the exact one", moment, reached, &mut told);
            check("twisted bar", "axial force over the exact one", axial, reached, &mut told);
        }
        // tet4 takes hundreds of increments.
        if form.volumetric == Volumetric::Mixed && form.kind != CellKind::Tet4 {
            let (way, end) = punch(form)?;
            let bound = if form.kind == CellKind::Tet10 { Bound::AtLeast(1.0 - 1e-9) } else { Bound::Unbounded };
            let check = Check::new(&format!("punch, {name}"), "share of the way to half of the height", way, bound);
            findings.checks.push(check.noted(end));
            told.push(format!("{way:.2}"));
        } else {
            told.push("-".into());
        }
        rows.push(told);
    }
    let head = [
        "form",
        "cylinder",
        "sphere",
        "twist: moment",
        "twist: axial force",
        "punch to half of the height: share of the way",
    ];
    table(
        findings,
        "Closed forms at Poisson's ratio 0.499999, over the exact values",
        "A thick cylinder and a hollow sphere under pressure, a twisted bar, and a block under a punch, nearly incompressible. 1 is exact; a value far below 1 is a cell that locks.",
        &head,
        rows,
    );
    Ok(())
}
