//! The program whose size `cargo xtask verify lean` measures: it uses every feature of the facade that it is built
//! with. It is given a folder to write to.

use std::error::Error;
use std::sync::Arc;

use stoss::continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, green_lagrange,
};
use stoss::fe_solid::{MassKind, SolidBody};
use stoss::integrators::EnergyMomentum;
use stoss::linalg::AutoSolver;
use stoss::mesh::generate::Block;
use stoss::newton::NewtonOptions;
use stoss::solver::{Body, Model, InsideOutTreatment, Settings, Simulation, StepControl};

/// A law of the user's own: `W = lambda/2 (tr E)^2 + mu E:E` with `lambda = 0`, `mu = 500`.
#[derive(Debug)]
struct Law;

const SHEAR: f64 = 500.0;

impl HyperelasticLaw for Law {
    fn name(&self) -> &str {
        "own"
    }
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let strain = green_lagrange(right_cauchy_green);
        Ok(SHEAR * strain.double_contract(&strain))
    }
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        Ok(green_lagrange(right_cauchy_green) * (2.0 * SHEAR))
    }
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let mut elasticity = Tensor4::identity_dyad() * 0.0;
        elasticity.add_scaled(2.0 * SHEAR, &Tensor4::symmetric_identity());
        Ok((self.stress(right_cauchy_green)?, elasticity))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(0.0, SHEAR)
    }
}

fn run(mut simulation: Simulation) -> Result<(), Box<dyn Error>> {
    while !simulation.finished() {
        let record = simulation.advance()?;
        println!("step {}: energy {}", record.step, record.balance.total());
    }
    Ok(())
}

/// One stretching element, without a scene.
fn model() -> Result<(), Box<dyn Error>> {
    let mesh = Block::new([0.0; 3], [1.0; 3], [1, 1, 1]).generate()?;
    let body = Body {
        solid: SolidBody::new("block", &mesh, 0, Arc::new(Law))?,
        nodes: 0..mesh.nodes.len() as u32,
        density: Some(1.0),
        mass_kind: MassKind::Consistent,
        massless: None,
        damping: Default::default(),
    };
    let model = Model {
        reference: mesh.nodes.concat(),
        velocity: mesh.nodes.iter().flat_map(|x| [0.0, 0.0, x[2]]).collect(),
        bodies: vec![body],
        ..Model::default()
    };
    let settings = Settings {
        control: StepControl { step: 0.01, end: 0.02, max_cuts: 0, grow_after: 1, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-9, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    run(Simulation::new(model, settings)?)
}

#[cfg(feature = "scene")]
const SCENE: &str = r#"
[scene]
title = "two blocks"
kind = "dynamic"
[time]
end = 0.02
step = 0.01
integrator = { scheme = "energy-momentum" }
[[body]]
name = "upper"
mesh = { generator = "block", min = [0, 0, 1], max = [1, 1, 2], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1000, poisson = 0.3 }
density = 1
velocity = [0, 0, -0.1]
[[body]]
name = "lower"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1000, poisson = 0.3 }
density = 1
"#;

#[cfg(feature = "scene")]
fn scene(text: &str, folder: &std::path::Path) -> Result<(), Box<dyn Error>> {
    let scene = stoss::scene::parse(text, "scene").map_err(|errors| errors.to_string())?;
    run(stoss::build::build(&scene, folder).map_err(|errors| errors.to_string())?.simulation)
}

#[cfg(feature = "nts")]
const CONTACT: &str = r#"
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
"#;

/// An element in Abaqus' format.
#[cfg(feature = "mesh-files")]
const MESH: &str = "*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 1, 2, 3, 4, 5, 6, 7, 8
";

#[allow(unused_variables, reason = "without features nothing is written")]
fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::path::PathBuf::from(std::env::args_os().nth(1).ok_or("give a folder")?);
    model()?;
    #[cfg(feature = "scene")]
    scene(SCENE, &folder)?;
    #[cfg(all(feature = "scene", feature = "nts"))]
    scene(&format!("{SCENE}{CONTACT}"), &folder)?;
    #[cfg(feature = "mesh-files")]
    {
        let mesh = stoss::mesh_io::read_mesh_from_str("block.inp", MESH)?;
        println!("{} elements from a file", mesh.elements.len());
    }
    #[cfg(feature = "output")]
    {
        std::fs::create_dir_all(&folder)?;
        let file = folder.join("scene.toml");
        std::fs::write(&file, SCENE)?;
        let options = stoss::run::RunOptions { out: folder.join("results"), ..Default::default() };
        let summary = stoss::run::run_scene(&file, &options, &mut |_| {})?;
        println!("{summary:?}");
    }
    Ok(())
}
