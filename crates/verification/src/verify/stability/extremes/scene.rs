//! Small scenes of blocks, written as text.

use std::fmt::Write;

/// Material and density of a body.
#[derive(Clone, Copy, Debug)]
pub struct Matter {
    /// Name of the law; it is given Young's modulus and Poisson's ratio.
    pub law: &'static str,
    /// Young's modulus.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Mass per volume.
    pub density: f64,
}

impl Matter {
    /// Neo-Hooke with Poisson's ratio 0.3.
    pub fn new(young: f64, density: f64) -> Self {
        Self { law: "neo-hooke", young, poisson: 0.3, density }
    }

    /// With another Poisson's ratio.
    pub fn poisson(self, poisson: f64) -> Self {
        Self { poisson, ..self }
    }

    /// Speed of pressure waves at small strains.
    pub fn wave_speed(&self) -> f64 {
        let nu = self.poisson;
        (self.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * self.density)).sqrt()
    }
}

/// A block: two opposite corners and the elements along its edges.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Smallest coordinates.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
    /// Elements along x, y, z.
    pub divisions: [u32; 3],
}

impl Block {
    /// As the scene format has it.
    fn text(&self) -> String {
        format!(
            "{{ generator = \"block\", min = {:?}, max = {:?}, divisions = {:?} }}",
            self.min, self.max, self.divisions
        )
    }

    fn volume(&self) -> f64 {
        (0..3).map(|i| self.max[i] - self.min[i]).product()
    }

    fn extent(&self) -> f64 {
        self.min.iter().chain(&self.max).fold(0.0, |largest, x| x.abs().max(largest))
    }
}

/// A scene as text, and the scales that its momenta are measured against.
#[derive(Clone, Debug)]
pub struct Scene {
    text: String,
    /// Mass of all bodies.
    pub mass: f64,
    /// Largest initial speed.
    pub speed: f64,
    /// Largest coordinate.
    pub extent: f64,
}

impl Scene {
    /// Of a given length; quasi-static without a scheme. Steps may be halved `cuts` times.
    pub fn new(scheme: Option<&str>, step: f64, steps: u32, cuts: u32) -> Self {
        let kind = if scheme.is_some() { "dynamic" } else { "quasi-static" };
        let integrator = scheme.map(|scheme| format!("integrator = {{ scheme = \"{scheme}\" }}\n")).unwrap_or_default();
        let end = step * f64::from(steps);
        let velocity = if scheme.is_some() { "\"velocity\", " } else { "" };
        let text = format!(
            "[scene]\ntitle = \"Extreme case\"\nkind = \"{kind}\"\n\n[time]\nend = {end:?}\nstep = {step:?}\n\
             {integrator}max_cuts = {cuts}\n\n[output]\nevery = 1\ncheckpoint_every = 1000\n\
             fields = [\"displacement\", {velocity}\"von_mises\"]\n\
             \n[watch]\non_fault = \"ignore\"\n"
        );
        Self { text, mass: 0.0, speed: 0.0, extent: 0.0 }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Replaces the frame of every step by one every so many steps.
    pub fn frames(mut self, every: u32) -> Self {
        self.text = self.text.replacen("every = 1\n", &format!("every = {every}\n"), 1);
        self
    }

    /// A block with a velocity.
    pub fn block(self, name: &str, block: Block, matter: Matter, velocity: [f64; 3]) -> Self {
        let speed = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let motion = if speed > 0.0 { format!("velocity = {velocity:?}\n") } else { String::new() };
        self.body(name, &block.text(), matter, &motion).scales(block.volume() * matter.density, speed, block.extent())
    }

    /// A block with motions as text and its largest speed.
    pub fn moving(self, name: &str, block: Block, matter: Matter, motion: &str, speed: f64) -> Self {
        let mass = block.volume() * matter.density;
        self.body(name, &block.text(), matter, motion).scales(mass, speed, block.extent())
    }

    /// A body with a mesh and motions as text, without scales.
    pub fn body(mut self, name: &str, mesh: &str, matter: Matter, motion: &str) -> Self {
        let Matter { law, young, poisson, density } = matter;
        self.add(&format!(
            "\n[[body]]\nname = \"{name}\"\nmesh = {mesh}\n\
             material = {{ law = \"{law}\", young = {young:?}, poisson = {poisson:?} }}\ndensity = {density:?}\n{motion}"
        ));
        self
    }

    /// Adds to mass, largest speed and largest coordinate.
    pub fn scales(mut self, mass: f64, speed: f64, extent: f64) -> Self {
        self.mass += mass;
        self.speed = self.speed.max(speed);
        self.extent = self.extent.max(extent);
        self
    }

    /// Contact.
    pub fn contact(mut self, slave: &str, master: &str, constraint: &str) -> Self {
        self.add(&format!(
            "\n[[contact]]\nmethod = \"nts\"\nslave = \"{slave}\"\nmaster = \"{master}\"\nconstraint = \"{constraint}\"\n"
        ));
        self
    }

    /// Mortar contact.
    pub fn mortar(mut self, slave: &str, master: &str) -> Self {
        self.add(&format!("\n[[contact]]\nmethod = \"mortar\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n"));
        self
    }

    /// Supports.
    pub fn fixed(mut self, set: &str, components: &[&str]) -> Self {
        self.add(&format!("\n[[prescribe]]\nset = \"{set}\"\ncomponents = {components:?}\nfixed = true\n"));
        self
    }

    /// A displacement that grows linearly from zero at the start to `value` at time 1.
    pub fn pulled(mut self, set: &str, component: &str, value: f64) -> Self {
        self.add(&format!(
            "\n[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{component}\"]\n\
             displacement = {{ table = [[0.0, 0.0], [1.0, {value:?}]] }}\n"
        ));
        self
    }

    /// A follower pressure that grows linearly from zero at the start to `value` at time 1.
    pub fn follower(mut self, set: &str, value: f64) -> Self {
        self.add(&format!(
            "\n[[load]]\nset = \"{set}\"\nfollower_pressure = {{ table = [[0.0, 0.0], [1.0, {value:?}]] }}\n"
        ));
        self
    }

    /// A probe of the mean over a set.
    pub fn probe(mut self, name: &str, set: &str, quantity: &str) -> Self {
        self.add(&format!("\n[[probe]]\nname = \"{name}\"\nset = \"{set}\"\nquantity = \"{quantity}\"\n"));
        self
    }

    /// Anything else.
    pub fn also(mut self, text: &str) -> Self {
        self.add(text);
        self
    }

    fn add(&mut self, text: &str) {
        // cannot fail: writing to a String.
        let _ = self.text.write_str(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_toml_and_know_their_scales() {
        let block = Block { min: [0.0; 3], max: [1.0, 2.0, 3.0], divisions: [1, 1, 1] };
        let scene = Scene::new(Some("midpoint"), 1e-7, 20, 10)
            .frames(5)
            .block("a", block, Matter::new(1e3, 2.0), [0.0, 3.0, 4.0])
            .contact("a.top", "b.bottom", "standard")
            .fixed("a.left", &["x"])
            .pulled("a.right", "x", -0.5)
            .probe("p", "a.all", "position");
        assert_eq!((scene.mass, scene.speed, scene.extent), (12.0, 5.0, 3.0));
        let table: toml::Table = scene.text().parse().unwrap();
        assert_eq!(table["time"]["step"].as_float(), Some(1e-7));
        assert_eq!(table["output"]["every"].as_integer(), Some(5));
        assert_eq!(table["body"][0]["velocity"][2].as_float(), Some(4.0));
    }

    #[test]
    fn the_wave_speed_is_that_of_the_oedometer() {
        let speed = Matter { law: "neo-hooke", young: 4.0, poisson: 0.0, density: 1.0 }.wave_speed();
        assert_eq!(speed, 2.0);
    }
}
