//! Area and largest pressure that general contact reports, against a uniform pressure.

use crate::support::simulation;

/// A block of edge 1 under a pressure of 51 on a plate that is held at its bottom, no lateral contraction: stress is uniform if the plate is as wide, or hard.
fn pressed(cell: &str, divisions: [u32; 2], plate: [f64; 2], shift: f64) -> [f64; 2] {
    let [upper, lower] = divisions;
    let [width, young] = plate;
    let text = format!(
        "[scene]\ntitle = \"pressure\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.5\nstabilise = {{ fraction = 1e-4 }}\n\
         [[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", size = [1.0, 1.0, 1.0], divisions = [{upper}, {upper}, {upper}] }}\ncell = \"{cell}\"\n\
         position = [{shift:?}, {shift:?}, 0.5]\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.0 }}\n\
         [[body]]\nname = \"plate\"\nmesh = {{ generator = \"block\", size = [{width:?}, {width:?}, 0.5], divisions = [{lower}, {lower}, 1] }}\ncell = \"{cell}\"\n\
         position = [0.0, 0.0, -0.25]\nmaterial = {{ law = \"neo-hooke\", young = {young:?}, poisson = 0.0 }}\n\
         [[prescribe]]\nset = \"plate.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[load]]\nset = \"block.top\"\npressure = {{ table = [[0.0, 0.0], [1.0, 51.0]] }}\n[general_contact]\n"
    );
    let mut simulation = simulation(&text);
    let mut found = [f64::NAN; 2];
    while !simulation.finished() {
        let record = simulation.advance().unwrap_or_else(|e| panic!("{e}\n{text}"));
        let pair = record.contact.unwrap().bodies[0];
        found = [pair.pressure, pair.area];
    }
    found
}

#[test]
fn a_uniform_pressure_is_reported_as_it_is() {
    for (cell, divisions, plate, shift) in
        [("hex8", [3, 4], [1.0, 1000.0], 0.0), ("hex8", [2, 4], [2.0, 1e5], 0.0), ("hex8", [4, 7], [2.0, 1e5], 0.07)]
    {
        let [pressure, area] = pressed(cell, divisions, plate, shift);
        println!("{cell}, {divisions:?} on {plate:?}: {pressure:.3} of 51, area {area:.6}");
        assert!((pressure / 51.0 - 1.0).abs() < 0.04, "{cell}, {divisions:?}, {plate:?}: {pressure}");
        assert!((area - 1.0).abs() < 1e-9, "{cell}, {divisions:?}, {plate:?}: {area}");
    }
}
