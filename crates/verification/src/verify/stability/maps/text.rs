//! Scenes of the maps as text.

use std::fmt::Write;

/// A system of units: factors of length, mass and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Of lengths.
    pub length: f64,
    /// Of masses.
    pub mass: f64,
    /// Of times.
    pub time: f64,
}

/// No change of units.
pub const PLAIN: Units = Units { length: 1.0, mass: 1.0, time: 1.0 };

impl Units {
    /// Of velocities.
    pub fn velocity(&self) -> f64 {
        self.length / self.time
    }

    /// Of stresses.
    pub fn stress(&self) -> f64 {
        self.mass / (self.length * self.time * self.time)
    }

    /// Of forces.
    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }

    /// Of densities.
    pub fn density(&self) -> f64 {
        self.mass / self.length.powi(3)
    }

    /// Of what a probe records.
    pub fn of_quantity(&self, quantity: &str) -> f64 {
        match quantity {
            "linear_momentum" => self.mass * self.velocity(),
            "angular_momentum" => self.mass * self.velocity() * self.length,
            "velocity" => self.velocity(),
            "reaction" | "contact_force" => self.force(),
            _ => self.length,
        }
    }
}

/// A block of neo-Hooke material.
#[derive(Clone, Debug)]
pub struct Block<'a> {
    /// Name of the body.
    pub name: &'a str,
    /// Smallest and largest coordinates.
    pub corners: [[f64; 3]; 2],
    /// Elements along the axes.
    pub divisions: [u32; 3],
    /// Young's modulus.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Mass per volume; zero: left out.
    pub density: f64,
    /// Further keys.
    pub more: String,
}

/// A scene that grows, table after table. Lengths, masses and times are given in [`Units`].
#[derive(Clone, Debug)]
pub struct Text {
    text: String,
    units: Units,
    /// Names and quantities of the probes.
    pub probes: Vec<(&'static str, &'static str)>,
}

impl Text {
    /// A quasi-static scene of some increments until time 1 or more.
    pub fn statics(units: Units, step: f64, end: f64) -> Self {
        Self::new(units, "quasi-static", step, end, "")
    }

    /// A dynamic scene.
    pub fn dynamics(units: Units, scheme: &str, step: f64, end: f64) -> Self {
        Self::new(units, "dynamic", step, end, &format!("integrator = {{ scheme = \"{scheme}\" }}\n"))
    }

    fn new(units: Units, kind: &str, step: f64, end: f64, more: &str) -> Self {
        let [step, end] = [step, end].map(|time| time * units.time);
        let text = format!(
            "[scene]\ntitle = \"Stability map\"\nkind = \"{kind}\"\n\n[time]\nend = {end:?}\nstep = {step:?}\n{more}\n\
             [output]\nevery = 1000000\ncheckpoint_every = 1000000\n"
        );
        Self { text, units, probes: Vec::new() }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Adds a table as it stands.
    pub fn table(mut self, text: &str) -> Self {
        // cannot fail: writing to a String.
        let _ = write!(self.text, "\n{}\n", text.trim_end());
        self
    }

    /// Adds a block.
    pub fn block(self, block: &Block) -> Self {
        let units = self.units;
        let corners = block.corners.map(|corner| corner.map(|x| x * units.length));
        let (young, density) = (block.young * units.stress(), block.density * units.density());
        let density = if density > 0.0 { format!("density = {density:?}\n") } else { String::new() };
        self.table(&format!(
            "[[body]]\nname = \"{}\"\nmesh = {{ generator = \"block\", min = {:?}, max = {:?}, divisions = {:?} }}\n\
             material = {{ law = \"neo-hooke\", young = {young:?}, poisson = {:?} }}\n{density}{}",
            block.name, corners[0], corners[1], block.divisions, block.poisson, block.more
        ))
    }

    /// Fixes components of a set.
    pub fn fixed(self, set: &str, components: &[&str]) -> Self {
        self.table(&format!("[[prescribe]]\nset = \"{set}\"\ncomponents = {components:?}\nfixed = true"))
    }

    /// A pressure on a set that grows from zero to `pressure` until `until`.
    pub fn pressed(self, set: &str, pressure: f64, until: f64) -> Self {
        let (pressure, until) = (pressure * self.units.stress(), until * self.units.time);
        self.table(&format!("[[load]]\nset = \"{set}\"\npressure = {{ table = [[0, 0], [{until:?}, {pressure:?}]] }}"))
    }

    /// Nodes in a box, as a further set.
    pub fn set(self, body: &str, name: &str, corners: [[f64; 3]; 2]) -> Self {
        let [min, max] = corners.map(|corner| corner.map(|x| x * self.units.length));
        self.table(&format!(
            "[[set]]\nname = \"{body}.{name}\"\nbody = \"{body}\"\nbox = {{ min = {min:?}, max = {max:?} }}"
        ))
    }

    /// Contact of two surfaces by one of the methods of the maps, or a tie.
    pub fn contact(self, method: &str, [slave, master]: [&str; 2], friction: f64) -> Self {
        let law = if friction > 0.0 {
            format!("friction = {{ law = \"coulomb\", mu = {friction:?} }}\n")
        } else {
            String::new()
        };
        let pair =
            |method: &str| format!("[[contact]]\nmethod = {method}\nslave = \"{slave}\"\nmaster = \"{master}\"\n{law}");
        self.table(&match method {
            "tie" => format!("[[tie]]\nslave = \"{slave}\"\nmaster = \"{master}\""),
            "general" => format!("[general_contact]\nfriction = {friction:?}"),
            "mortar dual" => pair("\"mortar\"\nmultipliers = \"dual\""),
            _ => pair(&format!("{method:?}")),
        })
    }

    /// A probe of a set, a body or, without either, of the whole model.
    pub fn probe(mut self, name: &'static str, quantity: &'static str, of: &str) -> Self {
        self.probes.push((name, quantity));
        self.table(&format!("[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\n{of}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_scaled() {
        let units = Units { length: 2.0, mass: 4.0, time: 8.0 };
        let block = Block {
            name: "a",
            corners: [[0.0; 3], [1.0, 2.0, 3.0]],
            divisions: [1, 2, 3],
            young: 50.0,
            poisson: 0.25,
            density: 8.0,
            more: String::new(),
        };
        let text = Text::dynamics(units, "midpoint", 0.1, 1.0).block(&block).pressed("a.top", 50.0, 1.0);
        let text =
            text.contact("mortar dual", ["a.top", "b.bottom"], 0.5).probe("p", "linear_momentum", "body = \"a\"");
        let table: toml::Table = text.text().parse().unwrap();
        assert_eq!(table["time"]["end"].as_float(), Some(8.0));
        assert_eq!(table["body"][0]["mesh"]["max"][2].as_float(), Some(6.0));
        assert_eq!(table["body"][0]["material"]["young"].as_float(), Some(1.5625));
        assert_eq!(table["body"][0]["density"].as_float(), Some(4.0));
        assert_eq!(table["load"][0]["pressure"]["table"][1][1].as_float(), Some(1.5625));
        assert_eq!(table["contact"][0]["multipliers"].as_str(), Some("dual"));
        assert_eq!((units.of_quantity("linear_momentum"), units.of_quantity("position")), (1.0, 2.0));
    }
}
