//! The way from keywords to a [`super::Deck`]: steps, their supports and loads.

use super::fill::Filler;
use super::rows::Row;
use super::{
    DeckBoundary, DeckStep, ElementLoad, Force, LoadKind, OpNew, Prescribed, Procedure, SurfacePressure, Times,
};
use crate::MeshIoError;
use crate::abaqus::block::Block;

impl Filler<'_> {
    pub fn step(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let (keyword, contents) = (&block.keyword, self.contents);
        self.other_parameters(block, &["NAME", "NLGEOM", "PERTURBATION", "AMPLITUDE", "INC"]);
        let increments = block.number(contents, "INC")?;
        let is = |parameter, value: &str| keyword.value(parameter).is_some_and(|v| v.eq_ignore_ascii_case(value));
        self.deck.steps.push(DeckStep {
            name: keyword.value("NAME").map(str::to_owned),
            is_nonlinear: keyword.flag("NLGEOM") && !is("NLGEOM", "NO"),
            is_perturbation: keyword.flag("PERTURBATION"),
            is_sudden: is("AMPLITUDE", "STEP"),
            increments: increments.map(|number| number as u64),
            procedure: None,
            supports: Vec::new(),
            forces: Vec::new(),
            loads: Vec::new(),
            pressures: Vec::new(),
            changes: Vec::new(),
            op_new: OpNew::default(),
            place: block.place(),
        });
        self.in_step = true;
        Ok(())
    }

    pub fn procedure(&mut self, block: &Block, name: &str) -> Result<(), MeshIoError> {
        let mut times = Times { is_fixed: block.keyword.flag("DIRECT"), ..Times::default() };
        if let Some(row) = block.rows(self.contents).next() {
            times.initial = row.optional(0, "the first increment")?;
            times.period = row.optional(1, "the length of the step")?;
            times.smallest = row.optional(2, "the smallest increment")?;
            times.largest = row.optional(3, "the largest increment")?;
        }
        let procedure = if name == "STATIC" {
            self.other_parameters(block, &["DIRECT", "SOLVER"]);
            Procedure::Static(times)
        } else {
            self.other_parameters(block, &["DIRECT", "SOLVER", "ALPHA", "EXPLICIT"]);
            let alpha = block.number(self.contents, "ALPHA")?;
            Procedure::Dynamic { times, alpha, is_explicit: block.keyword.flag("EXPLICIT") }
        };
        match self.deck.steps.last_mut().filter(|_| self.in_step) {
            Some(step) => step.procedure = Some(procedure),
            None => self.leave(block.place(), format!("*{} outside of a step", block.keyword.name)),
        }
        Ok(())
    }

    /// The step that a keyword of loads belongs to, and its amplitude; nothing if the keyword is left out.
    fn loading(
        &mut self,
        block: &Block,
        keyword: fn(&mut OpNew) -> &mut bool,
    ) -> Result<Option<Option<String>>, MeshIoError> {
        if self.is_other(block, &["OP", "AMPLITUDE", "TIMEDELAY"]) {
            return Ok(None);
        }
        let delay = block.number(self.contents, "TIMEDELAY")?;
        let Some(step) = self.deck.steps.last_mut().filter(|_| self.in_step) else {
            self.leave(block.place(), format!("*{} outside of a step", block.keyword.name));
            return Ok(None);
        };
        *keyword(&mut step.op_new) |= is_new(block);
        let amplitude = block.keyword.value("AMPLITUDE");
        Ok(Some(amplitude.map(|name| delay.map_or_else(|| name.to_owned(), |delay| self.delayed(name, delay)))))
    }

    /// The name of the amplitude that begins later by `TIME DELAY`; the name itself if there is no such amplitude.
    fn delayed(&mut self, name: &str, delay: f64) -> String {
        let Some(own) = self.deck.amplitudes.iter().find(|own| own.name.eq_ignore_ascii_case(name)) else {
            return name.to_owned();
        };
        let later = format!("{name} later by {delay}");
        let points = own.points.iter().map(|point| [point[0] + delay, point[1]]).collect();
        let copy = super::Amplitude { name: later.clone(), points, ..own.clone() };
        if !self.deck.amplitudes.contains(&copy) {
            self.deck.amplitudes.push(copy);
        }
        later
    }

    pub fn boundary(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &["OP", "AMPLITUDE", "TYPE", "FIXED"]) {
            return Ok(());
        }
        let prescribed = match block.keyword.value("TYPE").unwrap_or("DISPLACEMENT").to_uppercase().as_str() {
            "DISPLACEMENT" if block.keyword.flag("FIXED") => Prescribed::Fixed,
            "DISPLACEMENT" => Prescribed::Displacement,
            "VELOCITY" => Prescribed::Velocity,
            "ACCELERATION" => Prescribed::Acceleration,
            other => {
                self.leave(block.place(), format!("*BOUNDARY, TYPE={other}"));
                return Ok(());
            }
        };
        let amplitude = block.keyword.value("AMPLITUDE").map(str::to_owned);
        let mut supports = Vec::new();
        for row in block.rows(self.contents) {
            let Some((freedoms, value)) = self.support(block, &row)? else { continue };
            let (nodes, amplitude, place) = (row.target(), amplitude.clone(), row.place());
            supports.push(DeckBoundary { nodes, freedoms, prescribed, value, amplitude, place });
        }
        match self.deck.steps.last_mut().filter(|_| self.in_step) {
            None => self.deck.supports.extend(supports),
            Some(step) => {
                step.op_new.supports |= is_new(block);
                step.supports.extend(supports);
            }
        }
        Ok(())
    }

    /// The degrees of freedom that a line of `*BOUNDARY` prescribes, and their value.
    fn support(&mut self, block: &Block, row: &Row) -> Result<Option<([bool; 6], f64)>, MeshIoError> {
        let given = match row.field(1).to_uppercase().as_str() {
            "ENCASTRE" => &[1, 2, 3, 4, 5, 6][..],
            "PINNED" => &[1, 2, 3],
            "XSYMM" => &[1, 5, 6],
            "YSYMM" => &[2, 4, 6],
            "ZSYMM" => &[3, 4, 5],
            "XASYMM" => &[2, 3, 4],
            "YASYMM" => &[1, 3, 5],
            "ZASYMM" => &[1, 2, 6],
            _ => {
                let Some(first) = row.freedom(1)? else {
                    return Err(row.error(row.text, "expected a degree of freedom in the second place: 1, 2 or 3"));
                };
                let last = row.freedom(2)?.unwrap_or(first);
                if last < first {
                    return Err(row.error(row.text, "the last degree of freedom is below the first"));
                }
                if !(1..=6).contains(&first) {
                    self.leave(row.place(), format!("degree of freedom {first} of *{}", block.keyword.name));
                    return Ok(None);
                }
                let value = row.optional(3, "a prescribed value")?.unwrap_or(0.0);
                return Ok(Some((std::array::from_fn(|i| (first..=last).contains(&(i as u64 + 1))), value)));
            }
        };
        Ok(Some((std::array::from_fn(|i| given.contains(&(i as u64 + 1))), 0.0)))
    }

    pub fn forces(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let Some(amplitude) = self.loading(block, |op_new| &mut op_new.forces)? else { return Ok(()) };
        let mut forces = Vec::new();
        for row in block.rows(self.contents) {
            let freedom = match row.freedom(1)? {
                Some(freedom @ 1..=6) => freedom as usize - 1,
                _ => match self.component(block, &row)? {
                    Some(component) => component,
                    None => continue,
                },
            };
            let value = row.real(2, "a force")?;
            let force = Force { nodes: row.target(), freedom, value, amplitude: amplitude.clone(), place: row.place() };
            forces.push(force);
        }
        if let Some(step) = self.deck.steps.last_mut() {
            step.forces.extend(forces);
        }
        Ok(())
    }

    pub fn loads(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let Some(amplitude) = self.loading(block, |op_new| &mut op_new.loads)? else { return Ok(()) };
        let mut loads = Vec::new();
        for row in block.rows(self.contents) {
            let label = row.field(1).to_uppercase();
            let value = |what| row.real(2, what);
            let kind = match label.as_str() {
                "P1" | "P2" | "P3" | "P4" | "P5" | "P6" => {
                    let face = usize::from(label.as_bytes()[1] - b'1');
                    LoadKind::Pressure { face, value: value("a pressure")? }
                }
                "GRAV" => LoadKind::Gravity {
                    magnitude: value("an acceleration")?,
                    direction: row.vector(3, "a component of the direction")?,
                },
                "CENTRIF" => LoadKind::Centrifugal {
                    squared: value("the square of an angular velocity")?,
                    point: row.vector(3, "a coordinate of a point of the axis")?,
                    axis: row.vector(6, "a component of the axis")?,
                },
                "BX" => LoadKind::Body { component: 0, value: value("a force per volume")? },
                "BY" => LoadKind::Body { component: 1, value: value("a force per volume")? },
                "BZ" => LoadKind::Body { component: 2, value: value("a force per volume")? },
                _ => {
                    self.leave(row.place(), format!("load {label} of *DLOAD"));
                    continue;
                }
            };
            let load = ElementLoad { elements: row.target(), kind, amplitude: amplitude.clone(), place: row.place() };
            loads.push(load);
        }
        if let Some(step) = self.deck.steps.last_mut() {
            step.loads.extend(loads);
        }
        Ok(())
    }

    pub fn pressures(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let Some(amplitude) = self.loading(block, |op_new| &mut op_new.pressures)? else { return Ok(()) };
        let mut pressures = Vec::new();
        for row in block.rows(self.contents) {
            let label = row.field(1).to_uppercase();
            if label != "P" {
                self.leave(row.place(), format!("load {label} of *DSLOAD"));
                continue;
            }
            let pressure = SurfacePressure {
                surface: row.name(0, "a surface")?,
                value: row.real(2, "a pressure")?,
                amplitude: amplitude.clone(),
                place: row.place(),
            };
            pressures.push(pressure);
        }
        if let Some(step) = self.deck.steps.last_mut() {
            step.pressures.extend(pressures);
        }
        Ok(())
    }
}

/// Whether a keyword has `OP=NEW`.
fn is_new(block: &Block) -> bool {
    block.keyword.value("OP").is_some_and(|value| value.eq_ignore_ascii_case("NEW"))
}
