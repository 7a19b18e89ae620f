//! The way from keywords to a [`Deck`]: what stands outside of steps.

use super::rows::Row;
use super::{
    Amplitude, Axes, ContactPair, Damping, Deck, DeckPlace, Elastic, Following, Friction, Hyperelastic,
    InitialVelocity, Interaction, LeftOut, LocalAxes, Material, Procedure, SolidSection, SurfaceBehavior, Tie,
};
use crate::abaqus::block::Block;
use crate::{Contents, MeshIoError};

/// Keywords of the mesh, which its reader has read or refused, and those without a meaning of their own.
const MESH: [&str; 7] = ["ASSEMBLY", "ENDASSEMBLY", "ENDINSTANCE", "NODE", "SURFACE", "PREPRINT", "NOTE"];
/// Keywords that ask for output.
const OUTPUT: [&str; 23] = [
    "NODEPRINT",
    "NODEFILE",
    "NODEOUTPUT",
    "ELPRINT",
    "ELFILE",
    "ELEMENTOUTPUT",
    "CONTACTPRINT",
    "CONTACTFILE",
    "CONTACTOUTPUT",
    "FACEPRINT",
    "SECTIONPRINT",
    "SECTIONFILE",
    "ENERGYPRINT",
    "ENERGYFILE",
    "ENERGYOUTPUT",
    "OUTPUT",
    "FILEFORMAT",
    "FILEOUTPUT",
    "RESTART",
    "MONITOR",
    "DIAGNOSTICS",
    "TIMEPOINTS",
    "PRINT",
];
/// Keywords that say what a step computes, beside `*STATIC` and `*DYNAMIC`.
const PROCEDURES: [&str; 20] = [
    "FREQUENCY",
    "COMPLEXFREQUENCY",
    "BUCKLE",
    "MODALDYNAMIC",
    "STEADYSTATEDYNAMICS",
    "RANDOMRESPONSE",
    "RESPONSESPECTRUM",
    "HEATTRANSFER",
    "COUPLEDTEMPERATURE-DISPLACEMENT",
    "UNCOUPLEDTEMPERATURE-DISPLACEMENT",
    "DYNAMICTEMPERATURE-DISPLACEMENT",
    "VISCO",
    "GEOSTATIC",
    "CFD",
    "ELECTROMAGNETICS",
    "SENSITIVITY",
    "GREEN",
    "SUBSTRUCTUREGENERATE",
    "NOANALYSIS",
    "MASSDIFFUSION",
];

/// What keywords that follow another one belong to.
enum Owner {
    Nothing,
    Material,
    Interaction,
}

pub(super) struct Filler<'a> {
    pub contents: &'a Contents,
    pub deck: Deck,
    owner: Owner,
    /// The part that is open.
    part: Option<String>,
    /// Within `*STEP` and `*END STEP`.
    pub in_step: bool,
    /// The interaction that `*CHANGE ...` names, for the keyword after it.
    pub changed: Option<(String, DeckPlace)>,
}

/// The deck of a mesh and the other keywords of its file.
pub(super) fn deck(contents: Contents, blocks: &[Block]) -> Result<Deck, MeshIoError> {
    let mut filler = Filler {
        contents: &contents,
        deck: Deck::default(),
        owner: Owner::Nothing,
        part: None,
        in_step: false,
        changed: None,
    };
    blocks.iter().try_for_each(|block| filler.block(block))?;
    let deck = filler.deck;
    Ok(Deck { contents, ..deck })
}

impl Filler<'_> {
    fn block(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let name = block.name();
        match (name.as_str(), &self.owner) {
            (
                "DENSITY" | "ELASTIC" | "HYPERELASTIC" | "PLASTIC" | "VISCOELASTIC" | "MULLINSEFFECT" | "DAMPING",
                Owner::Material,
            ) => {
                return self.of_material(block, &name);
            }
            ("FRICTION" | "SURFACEBEHAVIOR", owner)
                if self.changed.is_some() || matches!(owner, Owner::Interaction) =>
            {
                return self.of_interaction(block, &name);
            }
            _ => {}
        }
        if let Some((_, place)) = self.changed.take() {
            self.leave(place, "*CHANGE without values".to_owned());
        }
        let owner = std::mem::replace(&mut self.owner, Owner::Nothing);
        match name.as_str() {
            "HEADING" => self.deck.title = block.rows(self.contents).next().map(|row| row.text.to_owned()),
            "MATERIAL" => {
                let (name, place) = (block.require(self.contents, "NAME")?, block.place());
                self.other_parameters(block, &["NAME"]);
                self.deck.materials.push(Material {
                    name,
                    density: None,
                    elastic: None,
                    hyperelastic: None,
                    plastic: Vec::new(),
                    is_kinematic: false,
                    prony: Vec::new(),
                    is_instantaneous: false,
                    mullins: None,
                    damping: None,
                    place,
                });
                self.owner = Owner::Material;
            }
            "SURFACEINTERACTION" => {
                let (name, place) = (block.require(self.contents, "NAME")?, block.place());
                self.other_parameters(block, &["NAME"]);
                self.deck.interactions.push(Interaction { name, friction: None, behavior: None, place });
                self.owner = Owner::Interaction;
            }
            "SOLIDSECTION" => {
                let elements = block.require(self.contents, "ELSET")?;
                let material = block.require(self.contents, "MATERIAL")?;
                self.other_parameters(block, &["ELSET", "MATERIAL"]);
                let part = self.part.clone();
                let thickness = block.rows(self.contents).next().and_then(|row| row.numbers().ok()?.first().copied());
                self.deck.sections.push(SolidSection { elements, material, part, thickness, place: block.place() });
            }
            "PART" => self.part = block.keyword.value("NAME").map(str::to_owned),
            "ENDPART" => self.part = None,
            "TRANSFORM" => self.transform(block)?,
            "AMPLITUDE" => self.amplitude(block)?,
            "CONTACTPAIR" => self.contact_pair(block)?,
            "EXPANSION" => {
                self.owner = owner;
                for row in block.rows(self.contents) {
                    self.deck.expands |= row.optional(0, "a coefficient of expansion")?.is_some_and(|own| own != 0.0);
                }
                self.leave(block.place(), format!("*{}", block.keyword.name));
            }
            "TIE" => self.tie(block)?,
            "NODE" => self.reference_nodes(block)?,
            "NSET" => self.reference_set(block)?,
            "EQUATION" => self.equations(block)?,
            "MPC" => self.multi_point(block)?,
            "COUPLING" => self.coupling(block)?,
            "KINEMATIC" => self.following(block, Following::Kinematic)?,
            "DISTRIBUTING" => self.following(block, Following::Distributing)?,
            "DISTRIBUTINGCOUPLING" => self.distributing(block)?,
            "RIGIDBODY" => self.rigid_body(block)?,
            "PRE-TENSIONSECTION" | "PRETENSIONSECTION" => self.pretension(block)?,
            "ELEMENT" => self.connections(block)?,
            "SPRING" => self.connection_section(block, "*SPRING")?,
            "DASHPOT" => self.connection_section(block, "*DASHPOT")?,
            "MASS" => self.connection_section(block, "*MASS")?,
            "CHANGEFRICTION" | "CHANGESURFACEBEHAVIOR" => self.change(block)?,
            "MODELCHANGE" => self.model_change(block)?,
            "INITIALCONDITIONS" => self.initial(block)?,
            "STEP" => self.step(block)?,
            "ENDSTEP" => self.in_step = false,
            "STATIC" | "DYNAMIC" => self.procedure(block, &name)?,
            "BOUNDARY" => self.boundary(block)?,
            "CLOAD" => self.forces(block)?,
            "DLOAD" => self.loads(block)?,
            "DSLOAD" => self.pressures(block)?,
            name if PROCEDURES.contains(&name) => {
                if let Some(step) = self.deck.steps.last_mut().filter(|_| self.in_step) {
                    step.procedure = Some(Procedure::Other(block.keyword.name.clone()));
                }
                self.leave(block.place(), format!("*{}", block.keyword.name));
            }
            name if MESH.contains(&name) => {}
            name if OUTPUT.contains(&name) => {
                let what = format!("*{}", block.keyword.name);
                self.deck.left_out.push(LeftOut { what, changes_results: false, place: block.place() });
            }
            _ => {
                // It may be one of a material or an interaction that is not known here: what follows still belongs to that.
                self.owner = owner;
                self.leave(block.place(), format!("*{}", block.keyword.name));
            }
        }
        Ok(())
    }

    /// Adds an entry for something that is not kept; one for many equal ones in a row.
    pub fn leave(&mut self, place: DeckPlace, what: String) {
        if self.deck.left_out.last().is_none_or(|last| last.what != what) {
            self.deck.left_out.push(LeftOut { what, changes_results: true, place });
        }
    }

    /// Adds entries for the parameters that are not among the known ones.
    pub fn other_parameters(&mut self, block: &Block, known: &[&str]) {
        for parameter in block.keyword.parameters().filter(|p| *p != "INPUT" && !known.contains(p)) {
            self.leave(block.place(), format!("parameter {parameter} of *{}", block.keyword.name));
        }
    }

    /// Whether a part is open, whose numbers mean other nodes in every instance.
    pub fn is_in_part(&self) -> bool {
        self.part.is_some()
    }

    /// True, with an entry for the whole keyword, if it has a parameter that is not among the known ones.
    pub fn is_other(&mut self, block: &Block, known: &[&str]) -> bool {
        let other = block.keyword.parameters().find(|p| *p != "INPUT" && !known.contains(p));
        if let Some(parameter) = other {
            self.leave(block.place(), format!("*{} with the parameter {parameter}", block.keyword.name));
        }
        other.is_some()
    }

    fn transform(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let kind = block.keyword.value("TYPE").unwrap_or("R").to_uppercase();
        let place = block.place();
        let axes = match kind.as_str() {
            "R" | "C" => {
                let first = block.first(self.contents, "six coordinates of two points")?;
                let [a, b] = [first.vector(0, "a coordinate")?, first.vector(3, "a coordinate")?];
                let across = cross(a, b);
                let apart: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
                if kind == "C" && apart == [0.0; 3] {
                    return Err(first.error(first.text, "the two points of the axis must not be the same"));
                }
                if kind == "R" && across == [0.0; 3] {
                    return Err(first.error(first.text, "the two points must not lie on one line with the origin"));
                }
                Some(if kind == "C" { Axes::Cylindrical { a, b } } else { Axes::Rectangular { a, b } })
            }
            _ => None,
        };
        let nodes = block.keyword.value("NSET");
        if axes.is_none() || nodes.is_none() {
            self.leave(place, format!("*TRANSFORM, TYPE={kind}"));
        }
        if let Some(nodes) = nodes {
            self.deck.local_axes.push(LocalAxes { nodes: nodes.to_owned(), axes, place });
        }
        Ok(())
    }

    fn of_material(&mut self, block: &Block, name: &str) -> Result<(), MeshIoError> {
        let contents = self.contents;
        let is_plain =
            block.keyword.value("TYPE").is_none_or(|kind| ["ISO", "ISOTROPIC"].contains(&&*kind.to_uppercase()));
        if name == "ELASTIC" && !is_plain || block.keyword.flag("TESTDATAINPUT") {
            let kind = block.keyword.value("TYPE").map_or("TEST DATA INPUT".to_owned(), |kind| format!("TYPE={kind}"));
            self.leave(block.place(), format!("*{}, {kind}", block.keyword.name));
            return Ok(());
        }
        if name == "DAMPING" {
            let [alpha, beta] = ["ALPHA", "BETA"].map(|parameter| block.number(contents, parameter));
            let damping = Damping { alpha: alpha?.unwrap_or(0.0), beta: beta?.unwrap_or(0.0) };
            self.other_parameters(block, &["ALPHA", "BETA"]);
            self.material(|material| material.damping = Some(damping));
            return Ok(());
        }
        match name {
            "PLASTIC" => return self.plastic(block),
            "VISCOELASTIC" => return self.viscoelastic(block),
            "MULLINSEFFECT" => return self.mullins(block),
            _ => {}
        }
        if block.keyword.value("MODULI").is_some_and(|moduli| moduli.eq_ignore_ascii_case("INSTANTANEOUS")) {
            self.material(|material| material.is_instantaneous = true);
        }
        let first = block.first(contents, "numbers of the material")?;
        match name {
            "DENSITY" => {
                let density = first.real(0, "a mass per volume")?;
                self.other_parameters(block, &[]);
                self.material(|material| material.density = Some(density));
            }
            "ELASTIC" => {
                let elastic = Elastic {
                    modulus: first.real(0, "Young's modulus")?,
                    ratio: first.optional(1, "Poisson's ratio")?.unwrap_or(0.0),
                };
                self.other_parameters(block, &["TYPE", "MODULI"]);
                self.material(|material| material.elastic = Some(elastic));
            }
            _ => {
                const OTHERS: [&str; 4] = ["N", "MODULI", "TYPE", "POISSON"];
                let law = block.keyword.parameters().find(|p| !OTHERS.contains(p)).unwrap_or("POLYNOMIAL").to_owned();
                let terms = block.number(contents, "N")?.unwrap_or(1.0) as usize;
                let coefficients = block.numbers(contents)?;
                self.other_parameters(block, &["N", "MODULI", law.as_str()]);
                self.material(|material| material.hyperelastic = Some(Hyperelastic { law, terms, coefficients }));
            }
        }
        if name != "HYPERELASTIC" && block.rows.len() > 1 {
            self.leave(block.place(), format!("all lines of *{} but the first", block.keyword.name));
        }
        Ok(())
    }

    /// Yield stress, plastic strain and temperature, line by line.
    fn plastic(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let hardening = block.keyword.value("HARDENING").unwrap_or("ISOTROPIC").to_uppercase();
        let is_kinematic = hardening == "KINEMATIC";
        if hardening != "ISOTROPIC" && !is_kinematic {
            self.leave(block.place(), format!("*PLASTIC, HARDENING={hardening}"));
            return Ok(());
        }
        if self.is_other(block, &["HARDENING"]) {
            return Ok(());
        }
        let (mut points, mut temperature, mut others) = (Vec::new(), None, false);
        for row in block.rows(self.contents) {
            let stress = row.real(0, "a yield stress")?;
            let strain = row.optional(1, "a plastic strain")?.unwrap_or(0.0);
            let at = row.optional(2, "a temperature")?;
            if *temperature.get_or_insert(at) == at {
                points.push([strain, stress]);
            } else {
                others = true;
            }
        }
        if others {
            self.leave(block.place(), "all lines of *PLASTIC but those of its first temperature".to_owned());
        }
        if is_kinematic && points.len() > 2 {
            // Linear hardening has two.
            self.leave(block.place(), format!("*PLASTIC, HARDENING=KINEMATIC with {} points", points.len()));
            return Ok(());
        }
        self.material(|material| (material.plastic, material.is_kinematic) = (points, is_kinematic));
        Ok(())
    }

    /// Shares of the shear and of the bulk modulus, and a time, line by line.
    fn viscoelastic(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let time = block.keyword.value("TIME").map(str::to_uppercase);
        if time.as_deref() != Some("PRONY") {
            let kind = time.map_or("*VISCOELASTIC".to_owned(), |time| format!("*VISCOELASTIC, TIME={time}"));
            self.leave(block.place(), kind);
            return Ok(());
        }
        if self.is_other(block, &["TIME"]) {
            return Ok(());
        }
        let mut branches = Vec::new();
        for row in block.rows(self.contents) {
            let share = row.optional(0, "a share of the shear modulus")?.unwrap_or(0.0);
            let of_bulk = row.optional(1, "a share of the bulk modulus")?.unwrap_or(0.0);
            branches.push([share, of_bulk, row.real(2, "a relaxation time")?]);
        }
        self.material(|material| material.prony = branches);
        Ok(())
    }

    /// `r`, `m`, `beta`.
    fn mullins(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &[]) {
            return Ok(());
        }
        let first = block.first(self.contents, "the numbers r, m and beta")?;
        let softening = [
            first.real(0, "the number r")?,
            first.optional(1, "the number m")?.unwrap_or(0.0),
            first.optional(2, "the number beta")?.unwrap_or(0.0),
        ];
        self.material(|material| material.mullins = Some(softening));
        Ok(())
    }

    fn material(&mut self, change: impl FnOnce(&mut Material)) {
        if let Some(material) = self.deck.materials.last_mut() {
            change(material);
        }
    }

    fn of_interaction(&mut self, block: &Block, name: &str) -> Result<(), MeshIoError> {
        if name == "FRICTION" {
            let first = block.rows(self.contents).next();
            let is_rough = block.keyword.flag("ROUGH");
            let coefficient = match first {
                _ if is_rough => f64::INFINITY,
                Some(row) => row.optional(0, "a coefficient of friction")?.unwrap_or(0.0),
                None => 0.0,
            };
            let stick_slope = first.filter(|_| !is_rough).map(|row| row.optional(1, "a stick slope")).transpose()?;
            let friction = Friction { coefficient, stick_slope: stick_slope.flatten() };
            self.other_parameters(block, &["ROUGH"]);
            if self.changed.is_some() {
                self.changed_friction(friction);
            } else if let Some(interaction) = self.deck.interactions.last_mut() {
                interaction.friction = Some(friction);
            }
            return Ok(());
        }
        let law = block.keyword.value("PRESSURE-OVERCLOSURE").unwrap_or("HARD").to_uppercase();
        let values: Vec<Vec<f64>> =
            block.rows(self.contents).map(|row| row.numbers()).collect::<Result<_, MeshIoError>>()?;
        self.other_parameters(block, &["PRESSURE-OVERCLOSURE"]);
        let behavior = SurfaceBehavior { law, values };
        if self.changed.is_some() {
            self.changed_behavior(behavior);
        } else if let Some(interaction) = self.deck.interactions.last_mut() {
            interaction.behavior = Some(behavior);
        }
        Ok(())
    }

    fn amplitude(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let name = block.require(self.contents, "NAME")?;
        let definition = block.keyword.value("DEFINITION").unwrap_or("TABULAR").to_uppercase();
        if definition != "TABULAR" {
            self.leave(block.place(), format!("*AMPLITUDE, DEFINITION={definition}"));
            return Ok(());
        }
        if self.is_other(block, &["NAME", "DEFINITION", "TIME", "VALUE"]) {
            return Ok(());
        }
        let numbers = block.numbers(self.contents)?;
        let (points, rest) = numbers.as_chunks::<2>();
        if !rest.is_empty() || points.is_empty() {
            return Err(block.error(self.contents, "needs pairs of a time and a value"));
        }
        if points.windows(2).any(|pair| pair[1][0] < pair[0][0]) {
            return Err(block.error(self.contents, "needs times that do not decrease"));
        }
        let time = block.keyword.value("TIME").unwrap_or_default().to_uppercase();
        self.deck.amplitudes.push(Amplitude {
            name,
            is_total_time: time.starts_with("TOTAL"),
            points: points.to_vec(),
            place: block.place(),
        });
        Ok(())
    }

    fn contact_pair(&mut self, block: &Block) -> Result<(), MeshIoError> {
        self.other_parameters(block, &["INTERACTION", "TYPE", "ADJUST", "SMALLSLIDING"]);
        let value = |parameter| block.keyword.value(parameter).map(str::to_owned);
        for row in block.rows(self.contents) {
            let slave = row.name(0, "a slave surface")?;
            let master = if row.field(1).is_empty() { slave.clone() } else { row.name(1, "a master surface")? };
            self.deck.pairs.push(ContactPair {
                slave,
                master,
                interaction: value("INTERACTION"),
                kind: value("TYPE").map(|kind| kind.to_uppercase()),
                adjust: value("ADJUST"),
                is_small_sliding: block.keyword.flag("SMALLSLIDING"),
                place: row.place(),
            });
        }
        Ok(())
    }

    fn tie(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &["NAME", "POSITIONTOLERANCE", "ADJUST", "TYPE"]) {
            return Ok(());
        }
        let tolerance = block.number(self.contents, "POSITIONTOLERANCE")?;
        for row in block.rows(self.contents) {
            self.deck.ties.push(Tie {
                name: block.keyword.value("NAME").map(str::to_owned),
                slave: row.name(0, "a slave surface")?,
                master: row.name(1, "a master surface")?,
                tolerance,
                adjusts: block.keyword.value("ADJUST").is_none_or(|adjust| !adjust.eq_ignore_ascii_case("NO")),
                place: row.place(),
            });
        }
        Ok(())
    }

    fn initial(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let kind = block.require(self.contents, "TYPE")?.to_uppercase();
        if kind != "VELOCITY" {
            self.leave(block.place(), format!("*INITIAL CONDITIONS, TYPE={kind}"));
            return Ok(());
        }
        if self.is_other(block, &["TYPE"]) {
            return Ok(());
        }
        for row in block.rows(self.contents) {
            if let Some(component) = self.component(block, &row)? {
                let (nodes, value, place) = (row.target(), row.real(2, "a velocity")?, row.place());
                self.deck.velocities.push(InitialVelocity { nodes, component, value, place });
            }
        }
        Ok(())
    }

    /// The component of the degree of freedom in the second field.
    pub fn component(&mut self, block: &Block, row: &Row) -> Result<Option<usize>, MeshIoError> {
        match row.freedom(1)? {
            Some(freedom @ 1..=3) => Ok(Some(freedom as usize - 1)),
            Some(freedom) => {
                self.leave(row.place(), format!("degree of freedom {freedom} of *{}", block.keyword.name));
                Ok(None)
            }
            None => Err(row.error(row.text, "expected a degree of freedom in the second place: 1, 2 or 3")),
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}
