//! Mistakes in what a material has beside its elastic law.

use super::{Case, dynamic};

/// A mistake in the plasticity of the dynamic scene's plate.
macro_rules! metal {
    ($keys:literal, $key:literal) => {
        dynamic(
            "law = \"neo-hooke\", young = 2250, poisson = 0.3",
            concat!("law = \"hencky\", young = 2250, poisson = 0.3, plasticity = { ", $keys, " }"),
            "hencky",
            concat!("body[1].material.plasticity", $key),
        )
    };
}

pub const CASES: &[Case] = &[
    dynamic(
        "poisson = 0.3",
        "poisson = 0.3, plasticity = { yield_stress = 9 }",
        "young",
        "body[1].material.plasticity",
    ),
    dynamic("poisson = 0.3", "poisson = 0.3, prony = [[1.5, 1]]", "young", "body[1].material.prony"),
    dynamic("poisson = 0.3", "poisson = 0.3, prony = [[0.5, 0]]", "young", "body[1].material.prony[0][1]"),
    dynamic("poisson = 0.3", "poisson = 0.3, moduli = \"long-term\"", "young", "body[1].material.moduli"),
    dynamic("poisson = 0.3", "poisson = 0.3, mullins = { r = 0.5, m = 1 }", "young", "body[1].material.mullins"),
    dynamic("poisson = 0.3", "poisson = 0.3, mullins = { r = 2 }", "young", "body[1].material.mullins.m"),
    metal!("yield_stress = -1", ".yield_stress"),
    metal!("hardening_modulus = 10", ".yield_stress"),
    metal!("yield_stress = 1, hardening = [[0, 1]]", ".hardening"),
    metal!("yield_stress = 1, saturation_rate = 1", ".saturation_stress"),
    metal!("yield_stress = 1, saturation_stress = 1", ".saturation_rate"),
    metal!("yield_stress = 1, rate = { stress = 1, rate = 1 }", ".rate.exponent"),
    metal!("yield_stress = 1, kinematic_modulus = -1", ".kinematic_modulus"),
    metal!("hardening = [[0.1, 1]]", ""),
    metal!("hardening = [[0, 1], [0, 2]]", ""),
    metal!("yield_stress = 1, hardening_modulus = -1e9", ""),
    // A yield stress that falls below zero at some strain.
    metal!("yield_stress = 100, hardening_modulus = -1", ""),
];
