//! Scenes with general contact, as text, with what their momenta are measured against.

use std::fmt::Write;

use super::mesh::Hexahedra;

/// A scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The scene.
    pub text: String,
    /// Files that it names.
    pub files: Vec<(String, String)>,
    /// Mass of all bodies.
    pub mass: f64,
    /// Whether energy is to be kept: the energy-momentum scheme.
    pub keeps_energy: bool,
    /// Whether nothing holds, drives or weighs the bodies.
    pub free: bool,
}

/// A deformable body. Density is 1, Poisson's ratio 0.3.
#[derive(Clone, Debug)]
pub struct Body<'a> {
    name: &'a str,
    mesh: String,
    volume: f64,
    young: f64,
    position: [f64; 3],
    turn: ([f64; 3], f64),
    motion: String,
    file: Option<(String, String)>,
}

impl<'a> Body<'a> {
    fn new(name: &'a str, mesh: String, volume: f64) -> Self {
        let turn = ([0.0, 0.0, 1.0], 0.0);
        Self { name, mesh, volume, young: 1.0, position: [0.0; 3], turn, motion: String::new(), file: None }
    }

    /// A block about the origin.
    pub fn block(name: &'a str, size: [f64; 3], divisions: [u32; 3]) -> Self {
        let mesh = format!("{{ generator = \"block\", size = {size:?}, divisions = {divisions:?} }}");
        Self::new(name, mesh, size.iter().product())
    }

    /// A cube of edge 1 with two elements along each edge.
    pub fn cube(name: &'a str) -> Self {
        Self::block(name, [1.0; 3], [2; 3])
    }

    /// A mesh from a file, which bodies of the same mesh share.
    pub fn hexahedra(name: &'a str, file: &str, mesh: &Hexahedra) -> Self {
        let body = Self::new(name, format!("{{ file = \"{file}.inp\" }}"), mesh.volume());
        Self { file: Some((format!("{file}.inp"), mesh.text())), ..body }
    }

    /// A mesh as the scene format has it, and its volume.
    pub fn generated(name: &'a str, mesh: &str, volume: f64) -> Self {
        Self::new(name, mesh.to_owned(), volume)
    }

    /// Young's modulus instead of 1.
    pub fn young(self, young: f64) -> Self {
        Self { young, ..self }
    }

    /// The place, from that of the mesh.
    pub fn at(self, position: [f64; 3]) -> Self {
        Self { position, ..self }
    }

    /// Turned by so many degrees.
    pub fn turned(self, axis: [f64; 3], degrees: f64) -> Self {
        Self { turn: (axis, degrees), ..self }
    }

    /// Velocity at the start.
    pub fn velocity(self, velocity: [f64; 3]) -> Self {
        self.also(&format!("velocity = {velocity:?}\n"))
    }

    /// Angular velocity at the start.
    pub fn spin(self, spin: [f64; 3]) -> Self {
        self.also(&format!("angular_velocity = {spin:?}\n"))
    }

    /// Gradient of the velocity at the start.
    pub fn gradient(self, rows: [[f64; 3]; 3]) -> Self {
        self.also(&format!("velocity_gradient = {rows:?}\n"))
    }

    fn also(mut self, text: &str) -> Self {
        self.motion.push_str(text);
        self
    }
}

impl Scene {
    /// A dynamic scene with the energy-momentum scheme.
    pub fn dynamic(step: f64, end: f64) -> Self {
        let integrator = "integrator = { scheme = \"energy-momentum\" }\n";
        Self { keeps_energy: true, free: true, ..Self::new("dynamic", step, end, integrator) }
    }

    /// A sequence of equilibria from 0 to 1; `keys` go into `[time]`.
    pub fn equilibria(steps: u32, keys: &str) -> Self {
        Self::new("quasi-static", 1.0 / f64::from(steps), 1.0, keys)
    }

    fn new(kind: &str, step: f64, end: f64, keys: &str) -> Self {
        let text = format!(
            "[scene]\ntitle = \"General contact\"\nkind = \"{kind}\"\n\n[time]\nstep = {step:?}\nend = {end:?}\n{keys}\n\
             [output]\nlast_only = true\ncheckpoint_every = 1000000\n"
        );
        Self { text, ..Self::default() }
    }

    /// The watch looks every so many steps.
    pub fn watched(self, every: u32) -> Self {
        self.also(&format!("\n[watch]\nevery = {every}\non_fault = \"ignore\"\n"))
    }

    /// Adds a body.
    pub fn body(mut self, body: Body<'_>) -> Self {
        let Body { name, mesh, volume, young, position, turn: (axis, degrees), motion, file } = body;
        // cannot fail: writing to a String.
        let _ = write!(
            self.text,
            "\n[[body]]\nname = \"{name}\"\nmesh = {mesh}\nrotation = {{ axis = {axis:?}, degrees = {degrees:?} }}\nposition = {position:?}\n\
             material = {{ law = \"neo-hooke\", young = {young:?}, poisson = 0.3 }}\ndensity = 1.0\n{motion}"
        );
        self.mass += volume;
        self.files.extend(file.filter(|file| !self.files.contains(file)));
        self
    }

    /// Adds a rigid body that does not move; `shape` is text.
    pub fn obstacle(self, name: &str, shape: &str, position: [f64; 3]) -> Self {
        let obstacle = format!("\n[[rigid]]\nname = \"{name}\"\n{shape}\nposition = {position:?}\nfixed = true\n");
        self.also(&obstacle).held()
    }

    /// Components of a set that do not move.
    pub fn fixed(self, set: &str, components: &[&str]) -> Self {
        self.also(&format!("\n[[prescribe]]\nset = \"{set}\"\ncomponents = {components:?}\nfixed = true\n")).held()
    }

    /// Gravity along z.
    pub fn gravity(self, acceleration: f64) -> Self {
        self.also(&format!("\n[gravity]\nacceleration = [0.0, 0.0, {:?}]\n", -acceleration)).held()
    }

    /// A probe of a set.
    pub fn probe(self, name: &str, set: &str, quantity: &str) -> Self {
        self.also(&format!("\n[[probe]]\nname = \"{name}\"\nset = \"{set}\"\nquantity = \"{quantity}\"\n"))
    }

    /// General contact with these keys.
    pub fn general(self, keys: &str) -> Self {
        self.also(&format!("\n[general_contact]\n{keys}\n"))
    }

    /// Anything else that leaves momenta alone.
    pub fn also(mut self, text: &str) -> Self {
        self.text.push_str(text);
        self
    }

    /// Momenta are not kept.
    pub fn held(self) -> Self {
        Self { free: false, ..self }
    }

    /// A file that the text names.
    pub fn file(mut self, name: &str, text: String) -> Self {
        self.files.push((name.to_owned(), text));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::band;
    use super::*;

    #[test]
    fn scenes_are_read_and_know_their_mass() {
        let mesh = band(12, 0.2, 0.4, 0.0);
        let scene = Scene::dynamic(0.1, 1.0)
            .watched(1)
            .body(Body::block("a", [1.0, 2.0, 3.0], [1; 3]).velocity([0.1, 0.0, 0.0]).spin([0.0, 0.1, 0.0]))
            .body(Body::hexahedra("b", "band", &mesh).turned([1.0, 0.0, 0.0], 10.0).at([3.0, 0.0, 0.0]))
            .body(Body::hexahedra("c", "band", &mesh).at([6.0, 0.0, 0.0]))
            .general("friction = 0.3");
        assert!((scene.mass - 6.0 - 2.0 * mesh.volume()).abs() < 1e-12);
        assert_eq!(scene.files.len(), 1);
        assert!(stoss_scene::parse(&scene.text, "test").is_ok());
        assert!(scene.free && scene.keeps_energy && !scene.clone().gravity(1.0).free);
        let scene = Scene::equilibria(4, "stabilise = { fraction = 1e-3 }").body(Body::cube("a"));
        let scene = scene.fixed("a.bottom", &["x"]).probe("f", "a.bottom", "reaction").general("");
        assert!(stoss_scene::parse(&scene.text, "test").is_ok());
        assert!(!scene.free && !scene.keeps_energy);
    }
}
