//! What a scene does not need is not built.

use crate::support::simulation;

fn scene(kind: &str, integrator: &str, density: &str, contact: &str) -> String {
    format!(
        r#"
[scene]
title = "plan"
kind = "{kind}"
[time]
end = 1.0
step = 0.1
{integrator}
[[body]]
name = "a"
mesh = {{ generator = "block", min = [0, 0, 2], max = [1, 1, 3], divisions = [2, 2, 1] }}
material = {{ law = "neo-hooke", young = 100, poisson = 0.3 }}
{density}
[[body]]
name = "b"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}
material = {{ law = "neo-hooke", young = 100, poisson = 0.3 }}
{density}
[[prescribe]]
set = "b.bottom"
components = ["x", "y", "z"]
fixed = true
{contact}
"#
    )
}

const EMS: &str = "integrator = { scheme = \"energy-momentum\" }";
const CONTACT: &str = "[[contact]]\nmethod = \"nts\"\nslave = \"a.bottom\"\nmaster = \"b.top\"\n";
const NO_CONTACT: &str = "[general_contact]\nenabled = false\n";

#[test]
fn dynamics_without_contact_has_mass_and_no_contact() {
    let plan = simulation(&scene("dynamic", EMS, "density = 1", NO_CONTACT)).plan();
    assert!(plan.mass_matrix);
    assert!(!plan.contact_search);
    assert_eq!(plan.slots, 0);
    // 3 x 3 x 2 + 8 nodes, the four lower ones of `b` fixed.
    assert_eq!((plan.nodes, plan.elements), (26, 5));
    assert_eq!((plan.free_components, plan.prescribed_components), (66, 12));
    assert_eq!(plan.steps, 10);
}

#[test]
fn statics_has_no_mass() {
    let simulation = simulation(&scene("quasi-static", "", "", NO_CONTACT));
    let plan = simulation.plan();
    assert!(!plan.mass_matrix);
    assert!(!plan.contact_search);
    assert!(simulation.contact_force().is_empty());
    assert!(simulation.pressures().is_empty());
}

#[test]
fn contact_adds_one_slot_a_slave_node() {
    let plan = simulation(&scene("dynamic", EMS, "density = 1", CONTACT)).plan();
    assert!(plan.contact_search);
    assert_eq!(plan.slots, 9);
    let without = simulation(&scene("dynamic", EMS, "density = 1", NO_CONTACT)).plan();
    assert_eq!(plan.matrix_entries, without.matrix_entries, "open contact must not fill the matrix");
}
