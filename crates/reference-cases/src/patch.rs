//! Scenes of patch tests: two blocks whose meshes do not match under a load whose exact answer is one state of stress.
//!
//! Texts only: whoever uses them builds and runs them.

/// Name, keys of the material, and a pressure that strains it by some percent, of every law.
pub const LAWS: [(&str, &str, f64); 4] = [
    ("svk", r#"law = "saint-venant-kirchhoff", young = 1000.0, poisson = 0.3"#, 100.0),
    ("neo-hooke", r#"law = "neo-hooke", young = 1000.0, poisson = 0.3"#, 200.0),
    ("mooney-rivlin", r#"law = "mooney-rivlin", c1 = 176051.0, c2 = 4332.63, c = 2.0e6"#, 1.0e5),
    (
        "ogden",
        r#"law = "ogden", mu = [6300.0, 12.0, -100.0], alpha = [1.3, 5.0, -2.0], kappa = 2000.0, beta = 9.0"#,
        500.0,
    ),
];

/// Two blocks on each other in contact, the same pressure on all that is not held; `z` of the interface is `1 + 0.3 slope
/// x + 0.1 slope y`. On an inclined interface the pressure acts on the sides too, so that there is no shear in it.
///
/// Exact: the stress is uniform, `-pressure` a reference area in z.
#[derive(Clone, Copy, Debug)]
pub struct ContactPatch<'a> {
    /// Keys of the material of both.
    pub material: &'a str,
    /// Pressure at the end, a reference area.
    pub pressure: f64,
    /// Keys of the contact but for its surfaces.
    pub contact: &'a str,
    /// Side of the lower block; the upper one has side 1.
    pub lower: f64,
    /// Elements along the sides of the lower and of the upper block.
    pub divisions: [usize; 2],
    /// Inclination.
    pub slope: f64,
    /// Otherwise the lower one is.
    pub upper_is_slave: bool,
}

/// `int N dx` over `[0, end]` for the nodes of a line with `n` elements of length `h`.
fn hats(n: usize, h: f64, end: f64) -> Vec<f64> {
    let mut out = vec![0.0; n + 1];
    for e in 0..n {
        let t = ((end - e as f64 * h) / h).clamp(0.0, 1.0);
        out[e] += h * (t - 0.5 * t * t);
        out[e + 1] += h * 0.5 * t * t;
    }
    out
}

impl ContactPatch<'_> {
    /// The scene.
    pub fn text(&self) -> String {
        contact_patch(self)
    }

    /// The scene with a tie in place of the contact, of which [`Self::contact`] then has the keys.
    pub fn tied_text(&self) -> String {
        self.text().replace("[[contact]]", "[[tie]]")
    }
}

fn contact_patch(p: &ContactPatch<'_>) -> String {
    let (l, [nl, nu], slope, material) = (p.lower, p.divisions, p.slope, p.material);
    let z = |x: f64, y: f64| 1.0 + slope * (0.3 * x + 0.1 * y);
    let block = |side: f64, bottom: &dyn Fn(f64, f64) -> f64, top: &dyn Fn(f64, f64) -> f64| {
        let c = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        let mut list: Vec<[f64; 3]> = c.iter().map(|&[x, y]| [x, y, bottom(x, y)]).collect();
        list.extend(c.iter().map(|&[x, y]| [x, y, top(x, y)]));
        format!("{list:?}")
    };
    let lower = block(l, &|_, _| 0.0, &z);
    let upper = block(1.0, &z, &|_, _| 2.0);
    let (slave, master) = if p.upper_is_slave { ("upper.bottom", "lower.top") } else { ("lower.top", "upper.bottom") };
    let mut text = format!(
        r#"
[scene]
title = "patch"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "lower"
mesh = {{ generator = "hexahedron", corners = {lower}, divisions = [{nl}, {nl}, 2] }}
material = {{ {material} }}
[[body]]
name = "upper"
mesh = {{ generator = "hexahedron", corners = {upper}, divisions = [{nu}, {nu}, 2] }}
material = {{ {material} }}
[[contact]]
{contact}
slave = "{slave}"
master = "{master}"
[[prescribe]]
set = "lower.bottom"
components = ["z"]
fixed = true
"#,
        contact = p.contact
    );
    for body in ["lower", "upper"] {
        for (set, component) in [("left", "x"), ("front", "y")] {
            text += &format!("[[prescribe]]\nset = \"{body}.{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n");
        }
    }
    let ramp = |value: f64| format!("{{ table = [[0.0, 0.0], [1.0, {value:?}]] }}");
    text += &format!("[[load]]\nset = \"upper.top\"\npressure = {}\n", ramp(p.pressure));
    if slope != 0.0 {
        // Hydrostatic: a frictionless inclined interface carries no shear.
        for set in ["lower.right", "lower.back", "upper.right", "upper.back"] {
            text += &format!("[[load]]\nset = \"{set}\"\npressure = {}\n", ramp(p.pressure));
        }
    } else if l > 1.0 {
        // The same pressure on the part of the lower block that the upper one leaves free, which ends within facets.
        let h = l / nl as f64;
        let (all, covered) = (hats(nl, h, l), hats(nl, h, 1.0));
        for i in 0..=nl {
            for j in 0..=nl {
                let force = -p.pressure * (all[i] * all[j] - covered[i] * covered[j]);
                if force.abs() < 1e-14 * p.pressure {
                    continue;
                }
                let (x, y) = (i as f64 * h, j as f64 * h);
                let (low, high) = ([x - 1e-3, y - 1e-3, 0.999], [x + 1e-3, y + 1e-3, 1.001]);
                text += &format!(
                    "[[set]]\nname = \"lower.n{i}-{j}\"\nbody = \"lower\"\nbox = {{ min = {low:?}, max = {high:?} }}\n\
                     [[load]]\nset = \"lower.n{i}-{j}\"\nforce = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, {force:?}]] }}\n"
                );
            }
        }
    }
    text
}

/// Two blocks on the unit square one above the other up to z = 2, with 4 x 4 and 3 x 3 facets on an interface through
/// z = 1 with the slopes `a`, `b`; supports on three planes, the top pressed down by half a unit. `law` is the material, `tie` the keys of the tie.
///
/// Exact: uniaxial stress, both compressed to 3/4.
pub fn tied_stack(law: &str, [a, b]: [f64; 2], tie: &str) -> String {
    let z = |x: f64, y: f64| 1.0 + a * (x - 0.5) + b * (y - 0.5);
    let face = |height: &dyn Fn(f64, f64) -> f64| {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| format!("[{x:?}, {y:?}, {:?}]", height(x, y)))
            .join(", ")
    };
    let (bottom, middle, top) = (face(&|_, _| 0.0), face(&z), face(&|_, _| 2.0));
    let mut text = format!(
        r#"
[scene]
title = "stack"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "lower"
mesh = {{ generator = "hexahedron", divisions = [4, 4, 2], corners = [{bottom}, {middle}] }}
material = {law}
[[body]]
name = "upper"
mesh = {{ generator = "hexahedron", divisions = [3, 3, 2], corners = [{middle}, {top}] }}
material = {law}
[[tie]]
{tie}
[[prescribe]]
set = "lower.bottom"
components = ["z"]
fixed = true
[[prescribe]]
set = "upper.top"
components = ["z"]
displacement = {{ table = [[0, 0], [1, -0.5]] }}
"#
    );
    for body in ["lower", "upper"] {
        for (set, component) in [("left", "x"), ("front", "y")] {
            text += &format!("[[prescribe]]\nset = \"{body}.{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n");
        }
    }
    text
}

/// Largest difference of a component of the stresses from its mean, over the largest component of the mean; and the mean.
pub fn unevenness(stresses: &[[f64; 6]]) -> (f64, [f64; 6]) {
    let mean: [f64; 6] = std::array::from_fn(|i| stresses.iter().map(|s| s[i]).sum::<f64>() / stresses.len() as f64);
    let size = mean.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    let worst = stresses.iter().flat_map(|s| (0..6).map(move |i| (s[i] - mean[i]).abs())).fold(0.0, f64::max);
    (worst / size, mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_share_the_covered_length() {
        assert_eq!(hats(2, 1.0, 2.0), [0.5, 1.0, 0.5]);
        assert_eq!(hats(2, 1.0, 1.5), [0.5, 0.875, 0.125]);
    }

    #[test]
    fn unevenness_is_relative_to_the_largest_component() {
        let stress = |z| [0.0, 0.0, z, 0.5, 0.0, 0.0];
        assert_eq!(unevenness(&[stress(-1.0), stress(-3.0)]), (0.5, stress(-2.0)));
    }
}
