//! A static contact scene as text, put together from blocks.

use std::fmt::Write;

/// Young's modulus and Poisson's ratio.
pub type Elastic = (f64, f64);

/// A scene with its name.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name in the table.
    pub name: String,
    /// Whether it belongs to the quick part.
    pub quick: bool,
    text: String,
}

/// Points of a table: the time, then the components.
pub type Points<'a, const N: usize> = &'a [[f64; N]];

impl Scene {
    /// A quasi-static scene of so many steps of time 1.
    pub fn new(name: impl Into<String>, steps: u32) -> Self {
        Self::with_steps(name, f64::from(steps), 1.0)
    }

    /// A quasi-static scene to a time in steps of a size.
    pub fn with_steps(name: impl Into<String>, end: f64, step: f64) -> Self {
        let name = name.into();
        let text = format!(
            "[scene]\ntitle = \"{name}\"\nkind = \"quasi-static\"\n\n[time]\nend = {end:?}\nstep = {step:?}\n\n[output]\nevery = 1000000\n\
             fields = [\"displacement\"]\n"
        );
        Self { name, quick: false, text }
    }

    /// One of the quick part.
    pub fn quick(self) -> Self {
        Self { quick: true, ..self }
    }

    /// The text of the scene.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Any further text.
    pub fn also(mut self, text: &str) -> Self {
        self.add(format_args!("{text}"));
        self
    }

    /// A body with a generated mesh, the generator's keys as text; `extra`: further keys of the body.
    pub fn body(mut self, name: &str, mesh: &str, (young, poisson): Elastic, extra: &str) -> Self {
        self.add(format_args!(
            "\n[[body]]\nname = \"{name}\"\nmesh = {{ {mesh} }}\n\
             material = {{ law = \"neo-hooke\", young = {young:?}, poisson = {poisson:?} }}\n{extra}\n"
        ));
        self
    }

    /// The scene with another law for all bodies so far.
    pub fn law(mut self, law: &str) -> Self {
        self.text = self.text.replace("neo-hooke", law);
        self
    }

    /// A block.
    pub fn block(self, name: &str, min: [f64; 3], max: [f64; 3], divisions: [u32; 3], elastic: Elastic) -> Self {
        self.block_with(name, (min, max, divisions), elastic, "")
    }

    /// A block with further keys of the body.
    pub fn block_with(
        self,
        name: &str,
        (min, max, divisions): ([f64; 3], [f64; 3], [u32; 3]),
        elastic: Elastic,
        extra: &str,
    ) -> Self {
        let mesh = format!("generator = \"block\", min = {min:?}, max = {max:?}, divisions = {divisions:?}");
        self.body(name, &mesh, elastic, extra)
    }

    /// A block that leans: its bottom and its top are rectangles, each given by two opposite corners.
    pub fn frustum(
        self,
        name: &str,
        bottom: [[f64; 3]; 2],
        top: [[f64; 3]; 2],
        divisions: [u32; 3],
        elastic: Elastic,
    ) -> Self {
        let around = |[a, b]: [[f64; 3]; 2]| [a, [b[0], a[1], b[2]], b, [a[0], b[1], a[2]]];
        let corners: Vec<[f64; 3]> = around(bottom).into_iter().chain(around(top)).collect();
        let mesh = format!("generator = \"hexahedron\", corners = {corners:?}, divisions = {divisions:?}");
        self.body(name, &mesh, elastic, "")
    }

    /// Contact, with friction if the coefficient is above zero.
    pub fn contact(mut self, method: &str, slave: &str, master: &str, mu: f64) -> Self {
        self.add(format_args!("\n[[contact]]\nmethod = \"{method}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n"));
        if mu > 0.0 {
            self.add(format_args!("friction = {{ law = \"coulomb\", mu = {mu:?} }}\n"));
        }
        self
    }

    /// Supports of all components that are named, such as `"xz"`.
    pub fn fixed(mut self, set: &str, components: &str) -> Self {
        self.add(format_args!("\n[[prescribe]]\nset = \"{set}\"\ncomponents = {}\nfixed = true\n", list(components)));
        self
    }

    /// A prescribed displacement of the components that are named.
    pub fn moved<const N: usize>(mut self, set: &str, components: &str, points: Points<'_, N>) -> Self {
        let list = list(components);
        self.add(format_args!(
            "\n[[prescribe]]\nset = \"{set}\"\ncomponents = {list}\ndisplacement = {{ table = {points:?} }}\n"
        ));
        self
    }

    /// A dead traction.
    pub fn pulled(mut self, set: &str, points: Points<'_, 4>) -> Self {
        self.add(format_args!("\n[[load]]\nset = \"{set}\"\ntraction = {{ table = {points:?} }}\n"));
        self
    }

    /// A rigid tool that does not turn and is moved.
    pub fn tool(mut self, shape: &str, position: [f64; 3], points: Points<'_, 4>) -> Self {
        self.add(format_args!(
            "\n[[rigid]]\nname = \"tool\"\nshape = {{ {shape} }}\nposition = {position:?}\n\n[[prescribe]]\nrigid = \"tool\"\n\
             rotation = {{ axis = [0, 0, 1], degrees = {{ table = [[0.0, 0.0], [1.0, 0.0]] }}, about = [0, 0, 0] }}\n\
             translation = {{ table = {points:?} }}\n"
        ));
        self
    }

    fn add(&mut self, text: std::fmt::Arguments<'_>) {
        // cannot fail: writing to a String.
        let _ = self.text.write_fmt(text);
    }
}

fn list(components: &str) -> String {
    format!("{:?}", components.chars().map(String::from).collect::<Vec<_>>())
}
