//! Which scene draws what: the one table for the report and for `docs/gallery`.

use super::interface::Sides;
use stoss_report::paint::Camera;

/// What a scene draws beside its balances.
#[derive(Clone, Copy, Debug)]
pub struct Picture {
    /// Name of the scene, and of the picture.
    pub scene: &'static str,
    /// Arrays that give the colour, a row of snapshots each; of vectors the length.
    pub fields: &'static [&'static str],
    /// Title above the snapshots.
    pub title: &'static str,
    /// Numbers of the thesis's figures that the section of the report stands for; empty if there are none.
    pub thesis: &'static str,
    /// Times of the snapshots; the nearest frames are taken, those after the end of a shortened run left out.
    pub times: &'static [f64],
    /// Where it is seen from.
    pub camera: Camera,
    /// Probe of a reaction, drawn over time.
    pub reaction: Option<&'static str>,
    /// Times at which the segments are drawn.
    pub segments: &'static [f64],
    /// Surfaces between which the segments are.
    pub sides: Sides,
    /// Drawn into `docs/gallery` too; the scenes with the same data and another scheme, to compare the energies with.
    pub gallery: Option<&'static [&'static str]>,
}

const STRESS: &[&str] = &["von_mises"];

/// View from the front, a little from the right and from above.
const FRONT: Camera = Camera { azimuth: -70.0, elevation: 22.0 };

/// A picture of the report alone.
const fn report(scene: &'static str, title: &'static str, times: &'static [f64]) -> Picture {
    Picture {
        scene,
        fields: STRESS,
        title,
        thesis: "",
        times,
        camera: FRONT,
        reaction: None,
        segments: &[],
        sides: Sides::Stacked,
        gallery: None,
    }
}

/// The tori fly along x and z: seen along y. They meet at 2.5.
const fn tori(scene: &'static str, title: &'static str) -> Picture {
    let camera = Camera { azimuth: -80.0, elevation: 12.0 };
    Picture { camera, thesis: "6.15 to 6.19", ..report(scene, title, &[0.0, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0]) }
}

/// A picture of tori with the segments where they are nearer than half a facet (their facets are 3.8 long around the tube).
const fn mortar_tori(scene: &'static str, title: &'static str) -> Picture {
    Picture { segments: &[2.6, 3.0, 5.0], sides: Sides::Hulls(2.0), thesis: "6.35 to 6.38", ..tori(scene, title) }
}

/// Pressed down until 1, then drawn along x.
const fn ironing(scene: &'static str, title: &'static str, thesis: &'static str) -> Picture {
    let reaction = Some("indenter");
    Picture { reaction, segments: &[1.0, 10.0], thesis, ..report(scene, title, &[0.0, 1.0, 10.0, 15.0, 20.0]) }
}

/// A picture of blocks that meet at 0.05.
const fn blocks(scene: &'static str, title: &'static str, thesis: &'static str) -> Picture {
    Picture { segments: &[0.06], thesis, ..report(scene, title, &[0.0, 0.06, 0.13, 0.2]) }
}

/// All pictures.
pub const PICTURES: &[Picture] = &[
    Picture {
        camera: Camera { azimuth: -58.0, elevation: 24.0 },
        gallery: Some(&["ball-plate-modified", "ball-plate-midpoint"]),
        thesis: "6.6, 6.7, 6.9 and 6.10",
        ..report("ball-plate", "Hollow ball on plate", &[0.0, 0.16, 0.3, 0.6])
    },
    // Steps 0, 50, 140 and 220 of the throw, which begins at 3.
    Picture {
        fields: &["displacement"],
        camera: Camera { azimuth: -90.0, elevation: 0.0 },
        gallery: Some(&[]),
        ..report("trebuchet", "Trebuchet", &[3.0, 3.1, 3.28, 3.44])
    },
    // Pulled apart from the middle: links tighten from the ends inwards.
    Picture {
        camera: Camera { azimuth: -75.0, elevation: 30.0 },
        gallery: Some(&[]),
        ..report("general-chain", "Chain of ten tori", &[0.0, 4.0, 10.0])
    },
    tori("tori", "Two tori without friction"),
    tori("tori-friction-01", "Two tori, coefficient of friction 0.1"),
    tori("tori-friction-03", "Two tori, coefficient of friction 0.3"),
    tori("tori-cat", "Two tori without friction, coordinate augmentation"),
    tori("tori-cat-01", "Two tori, coefficient of friction 0.1, coordinate augmentation"),
    tori("tori-cat-03", "Two tori, coefficient of friction 0.3, coordinate augmentation"),
    mortar_tori("tori-mortar", "Two tori without friction, mortar"),
    mortar_tori("tori-mortar-friction", "Two tori, coefficient of friction 0.3, mortar"),
    ironing("ironing-mortar", "Ironing without friction", "6.23 to 6.25"),
    ironing("ironing-mortar-friction", "Ironing with friction", "6.25, right"),
    blocks("two-blocks-mortar", "Two blocks without friction", "6.29"),
    blocks("two-blocks-mortar-02", "Two blocks, coefficient of friction 0.2", "6.29, 6.31 and 6.32"),
    blocks("two-blocks-mortar-08", "Two blocks, coefficient of friction 0.8", "6.30, 6.33 and 6.34"),
    Picture {
        fields: &["displacement", "von_mises"],
        thesis: "6.26 to 6.28",
        reaction: Some("force"),
        segments: &[1.0, 2.0],
        ..report("rotating-indenter", "Rotating indenter", &[0.0, 1.0, 1.5, 2.0])
    },
    Picture {
        segments: &[1.0],
        sides: Sides::Sphere(0.75),
        ..report("tied-spheres", "Tied spherical shells", &[0.0, 1.0])
    },
    Picture {
        fields: &["displacement", "von_mises"],
        thesis: "6.20 to 6.22",
        segments: &[0.0, 1.0],
        ..report("patch-mortar", "Patch test with an overhang", &[0.0, 1.0])
    },
];

/// A single frame for `docs/gallery`, drawn by `stoss picture`.
#[derive(Clone, Copy, Debug)]
pub struct Still {
    /// Name of the scene, and of the picture.
    pub scene: &'static str,
    /// Where the run may end.
    pub until: f64,
    /// Options of `stoss picture`.
    pub options: &'static [&'static str],
}

/// All single frames.
pub const STILLS: &[Still] = &[
    Still { scene: "general-chain", until: 10.0, options: &["--size", "640x400"] },
    Still { scene: "general-contact", until: 6.0, options: &["--size", "640x400"] },
    Still { scene: "ironing-mortar-friction", until: 6.0, options: &["--size", "640x400"] },
    Still { scene: "rigid-punch", until: 3.0, options: &["--size", "640x400"] },
    Still { scene: "bolt", until: 3.0, options: &["--size", "640x400"] },
    Still { scene: "o-ring", until: 1.0, options: &["--size", "640x400"] },
];

/// The picture of a scene, if it has one.
pub fn of(scene: &str) -> Option<&'static Picture> {
    PICTURES.iter().find(|picture| picture.scene == scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_is_of_a_shipped_scene_and_of_its_time() {
        let workspace = crate::workspace::Workspace::find().unwrap();
        for picture in PICTURES {
            let scene: toml::Table = workspace.read(format!("scenes/{}.toml", picture.scene)).unwrap().parse().unwrap();
            let end = scene["time"]["end"].as_float().unwrap();
            let times = picture.times.iter().chain(picture.segments).copied();
            assert!(times.clone().all(|time| (0.0..=end).contains(&time)), "{}", picture.scene);
            assert!(picture.times.is_sorted() && picture.segments.is_sorted(), "{}", picture.scene);
            assert!(!picture.fields.is_empty(), "{}", picture.scene);
            if let Some(name) = picture.reaction {
                let probes = scene["probe"].as_array().unwrap();
                let probe = probes.iter().find(|probe| probe["name"].as_str() == Some(name)).unwrap();
                assert_eq!(probe["quantity"].as_str(), Some("reaction"), "{}", picture.scene);
            }
            assert_eq!(of(picture.scene).map(|found| found.title), Some(picture.title));
        }
        assert!(of("no scene").is_none());
    }

    #[test]
    fn every_single_frame_is_of_a_shipped_scene_and_of_its_time() {
        let workspace = crate::workspace::Workspace::find().unwrap();
        for still in STILLS {
            let scene: toml::Table = workspace.read(format!("scenes/{}.toml", still.scene)).unwrap().parse().unwrap();
            assert!(still.until <= scene["time"]["end"].as_float().unwrap(), "{}", still.scene);
            assert!(workspace.path(format!("docs/gallery/{}.png", still.scene)).is_file(), "{}", still.scene);
        }
    }
}
