//! The tables of a run: their columns, and what a step adds to each.

use super::OutputError;
use super::means::Means;
use super::settings::FolderSettings;
use super::table::CsvTable;
use crate::build::{JointPlace, Probe};
use crate::terms::Terms;
use std::collections::BTreeMap;
use stoss_continuum::Mechanisms;
use stoss_solver::{BodyPair, Simulation, StepRecord};

const BALANCE: &str = "step,time,dt,lx,ly,lz,jx,jy,jz,kinetic,strain,potential,contact,dissipation,external_work,total";
/// Columns that follow where there is contact or a joint with limits.
const CLOSING: &str = "closing_loss,contact_remainder,impact_loss,impact_deformable,impacts,impact_capped";
/// Columns that follow where there is friction.
const FRICTION: &str = "friction_work,friction_stored";
/// Column that follows where a body is damped.
const DAMPING: &str = "damping";
/// Columns that follow where a material can lose energy in this way.
const PLASTIC: &str = "plastic_loss,hardening";
const VISCOUS: &str = "viscous_loss";
const SOFTENING: &str = "softening_loss";
/// Column that follows where a stage of statics is stabilised.
const STABILISATION: &str = "stabilisation";
const NEWTON: &str = "step,time,iteration,residual,increment,active,changes";
const CONTACT: &str = "step,time,active,closed,released,repaired,min_gap,max_pressure,\
contact_force_x,contact_force_y,contact_force_z,coverage_defect";
/// Columns of each contact pair in the same table, after its name and a point.
const PAIR: [&str; 10] =
    ["active", "min_gap", "max_pressure", "force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z", "area"];
/// Column of a pair with friction, after these.
const PAIR_FRICTION: &str = "friction_work";

/// Columns of general contact in the same table: it has no slave.
const GENERAL: [&str; 4] = ["active", "min_gap", "max_pressure", "area"];

/// Table of general contact: a row for every pair of bodies that act on each other, with a frame also for those that have since the last one; forces and moment about the origin on the first one.
const BODIES: &str = "general.csv";
const BODY_PAIR: &str = "step,time,first,second,active,min_distance,max_pressure,area,\
force_x,force_y,force_z,moment_x,moment_y,moment_z,friction_work,mean_force_x,mean_force_y,mean_force_z";

/// Table of the joints: forces and moments on the second side, angle in degrees or displacement, what acts along that.
const JOINTS: &str = "joints.csv";
/// Columns of each joint.
const JOINT: [&str; 12] =
    ["fx", "fy", "fz", "mx", "my", "mz", "coordinate", "friction", "viscous", "spring", "motor", "limit"];
/// Further columns of a joint with two coordinates.
const SECOND: [&str; 6] =
    ["second", "second_friction", "second_viscous", "second_spring", "second_motor", "second_limit"];

/// Table of the energies of everything that makes forces, from the first step on.
const TERMS: &str = "terms.csv";

/// Table of the probes, whose columns the scene names.
pub const PROBES: &str = "probes.csv";

/// A contact pair with columns of its own.
#[derive(Clone, Copy, Debug)]
struct PairPlace {
    /// Number of the pair among the contacts of the model.
    place: usize,
    has_friction: bool,
    /// Whether it is general contact.
    is_general: bool,
}

/// Open tables, but for that of the watch.
#[derive(Debug)]
pub struct Tables {
    balance: CsvTable,
    newton: CsvTable,
    probes: Option<CsvTable>,
    contact: Option<CsvTable>,
    pairs: Vec<PairPlace>,
    joints: Option<CsvTable>,
    terms: (Terms, CsvTable),
    bodies: Option<CsvTable>,
}

fn has_damping(simulation: &Simulation) -> bool {
    simulation.model().bodies.iter().any(|body| body.damping.acts())
}

/// Ways of losing energy that any of the materials has.
fn mechanisms(simulation: &Simulation) -> Mechanisms {
    let bodies = simulation.model().bodies.iter().map(|body| body.solid.mechanisms());
    bodies.fold(Mechanisms::default(), Mechanisms::or)
}

impl Tables {
    /// Opens each table that the run has; `open` takes its name and its header.
    ///
    /// # Errors
    /// The errors of `open`.
    pub fn open(
        settings: &FolderSettings,
        simulation: &Simulation,
        open: &impl Fn(&str, &str) -> Result<CsvTable, OutputError>,
    ) -> Result<Self, OutputError> {
        let heads: Vec<String> = settings.probes.iter().flat_map(Probe::columns).collect();
        let probe_header = format!("step,time,{}", heads.join(","));
        let contacts = &simulation.model().contacts;
        let with_friction = |name: &str| settings.contacts.iter().any(|c| c.name == name && c.friction.is_some());
        let pairs: Vec<PairPlace> = (0..contacts.len())
            .filter(|&place| !contacts[place].always_holds())
            .map(|place| PairPlace {
                place,
                has_friction: with_friction(&contacts[place].name),
                is_general: contacts[place].is_potential(),
            })
            .collect();
        let has_contact = simulation.model().has_contact_pairs();
        let has_friction = settings.has_friction();
        let materials = mechanisms(simulation);
        let more = [
            (simulation.model().has_gaps(), CLOSING),
            (has_friction, FRICTION),
            (has_damping(simulation), DAMPING),
            (materials.plastic, PLASTIC),
            (materials.viscous, VISCOUS),
            (materials.softening, SOFTENING),
            (settings.schedule.is_stabilised(), STABILISATION),
        ];
        let terms = Terms::new(&settings.parts, settings.schedule.is_stabilised(), simulation);
        let more = more.iter().filter(|(has, _)| *has).map(|(_, columns)| *columns);
        let balance_header = std::iter::once(BALANCE).chain(more).collect::<Vec<_>>().join(",");
        Ok(Self {
            balance: open("balance.csv", &balance_header)?,
            newton: open("newton.csv", NEWTON)?,
            terms: {
                let table = open(TERMS, &terms.header())?;
                (terms, table)
            },
            probes: if heads.is_empty() { None } else { Some(open(PROBES, &probe_header)?) },
            contact: if has_contact {
                let heads = pairs.iter().flat_map(|pair| {
                    let of_friction = pair.has_friction.then_some(PAIR_FRICTION);
                    let name = &contacts[pair.place].name;
                    {
                        let columns = if pair.is_general { &GENERAL[..] } else { &PAIR };
                        columns.iter().copied().chain(of_friction)
                    }
                    .map(move |column| format!("{name}.{column}"))
                });
                let heads: Vec<String> = std::iter::once(CONTACT.to_owned()).chain(heads).collect();
                Some(open("contact.csv", &heads.join(","))?)
            } else {
                None
            },
            bodies: match pairs.iter().any(|pair| pair.is_general) {
                true => Some(open(BODIES, BODY_PAIR)?),
                false => None,
            },
            pairs,
            joints: if settings.joints.is_empty() {
                None
            } else {
                let heads = settings.joints.iter().flat_map(|joint| {
                    let more = if joint.coordinates > 1 { &SECOND[..] } else { &[] };
                    JOINT.iter().chain(more).map(|column| format!("{}.{column}", joint.name))
                });
                Some(open(JOINTS, &format!("step,time,{}", heads.collect::<Vec<_>>().join(",")))?)
            },
        })
    }

    /// Whether there are probes.
    pub fn has_probes(&self) -> bool {
        self.probes.is_some()
    }

    /// Adds the rows of a completed step. `friction_work` is the frictional work so far of each contact of the model, to which that of the step is added; `means` has what general contact did since the last frame, this step included. All ranks call it: probes are made of what each of them has.
    pub fn write(
        &mut self,
        settings: &FolderSettings,
        simulation: &Simulation,
        record: &StepRecord,
        friction_work: &mut [f64],
        means: &Means,
        has_frame: bool,
    ) {
        let b = &record.balance;
        let extent = settings.extent;
        self.balance
            .integer(record.step)
            .numbers(&[record.time, record.dt])
            .per(extent, &b.linear_momentum)
            .per(extent, &b.angular_momentum)
            .per(extent, &[b.kinetic, b.strain, b.potential, b.contact, b.dissipation, b.external_work, b.total()]);
        if simulation.model().has_gaps() {
            let losses = [b.closing_loss, b.contact_remainder, b.impact_loss, b.impact_deformable];
            self.balance.per(extent, &losses).integer(b.impacts).per(extent, &[b.impact_capped]);
        }
        if settings.has_friction() {
            self.balance.per(extent, &[b.friction_work, b.friction_stored]);
        }
        if has_damping(simulation) {
            self.balance.per(extent, &[b.damping]);
        }
        let materials = mechanisms(simulation);
        if materials.plastic {
            self.balance.per(extent, &[b.plastic_loss, b.hardening]);
        }
        if materials.viscous {
            self.balance.per(extent, &[b.viscous_loss]);
        }
        if materials.softening {
            self.balance.per(extent, &[b.softening_loss]);
        }
        if settings.schedule.is_stabilised() {
            self.balance.per(extent, &[b.stabilisation]);
        }
        self.balance.end_row();
        if record.step > 0 {
            let (terms, table) = &mut self.terms;
            table.integer(record.step).number(record.time);
            terms.values(&record.books).for_each(|value| {
                table.number(value / extent);
            });
            table.end_row();
        }
        for row in &record.newton {
            self.newton
                .integer(record.step)
                .number(record.time)
                .integer(u64::from(row.iteration))
                .numbers(&[row.residual, row.increment])
                .integer(row.active as u64)
                .integer(row.changes as u64)
                .end_row();
        }
        if let Some(table) = &mut self.probes {
            table.integer(record.step).number(record.time);
            for probe in &settings.probes {
                table.numbers(&probe.values(simulation));
            }
            table.end_row();
        }
        if let (Some(table), Some(c)) = (&mut self.contact, &record.contact) {
            table.integer(record.step).number(record.time);
            for count in [c.active, c.closed, c.released, c.repaired] {
                table.integer(count as u64);
            }
            table.numbers(&[c.min_gap, c.max_pressure]).per(extent, &c.force_on_slave).number(c.coverage.defect);
            for &PairPlace { place, has_friction, is_general } in &self.pairs {
                let pair = &c.pairs[place];
                let work = &mut friction_work[place];
                *work += pair.friction_work;
                table.integer(pair.active as u64).numbers(&[pair.min_gap, pair.max_pressure]);
                if !is_general {
                    table.per(extent, &pair.force).per(extent, &pair.moment);
                }
                table.per(extent, &[pair.area]);
                if has_friction {
                    table.per(extent, &[*work]);
                }
            }
            table.end_row();
        }
        if let (Some(table), Some(c)) = (&mut self.bodies, &record.contact) {
            for (bodies, mean) in means.pairs() {
                let pair = c.bodies.iter().find(|pair| pair.bodies == bodies);
                if pair.is_none() && !has_frame {
                    continue;
                }
                let pair = pair.copied().unwrap_or(BodyPair::none(bodies));
                table.integer(record.step).number(record.time);
                for body in bodies {
                    table.text(&settings.parts[body as usize]);
                }
                table.integer(pair.active as u64).numbers(&[pair.distance, pair.pressure, pair.area]);
                table.numbers(&pair.force).numbers(&pair.moment).number(pair.friction_work).numbers(&mean);
                table.end_row();
            }
        }
        if let Some(table) = &mut self.joints {
            table.integer(record.step).number(record.time);
            for &JointPlace { place, coordinates, .. } in &settings.joints {
                // Two columns are there also of a joint without any.
                let coordinates = coordinates.max(1);
                let pair = &simulation.model().contacts[place];
                match pair.joint(&simulation.state().q, &simulation.mean_pressures()[place]) {
                    Some(joint) => {
                        table.numbers(&joint.force).numbers(&joint.moment);
                        for k in 0..coordinates {
                            let of = joint.coordinates.get(k);
                            let value =
                                of.map_or(f64::NAN, |c| if c.is_angle { 1f64.to_degrees() } else { 1.0 } * c.value);
                            let t = of.map(|c| c.torques).unwrap_or_default();
                            table.numbers(&[value, t.friction, t.viscous, t.spring, t.motor, t.limit]);
                        }
                    }
                    // Released or switched off.
                    None => {
                        table.numbers(&[0.0; 6]);
                        (0..coordinates).for_each(|_| {
                            table.number(f64::NAN).numbers(&[0.0; 5]);
                        });
                    }
                }
            }
            table.end_row();
        }
    }

    /// Writes what is buffered, and notes the length of each table in bytes under its name.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn flush(&mut self, lengths: &mut BTreeMap<String, u64>) -> Result<(), OutputError> {
        lengths.insert("balance.csv".into(), self.balance.flush()?);
        lengths.insert("newton.csv".into(), self.newton.flush()?);
        lengths.insert(TERMS.into(), self.terms.1.flush()?);
        if let Some(table) = &mut self.probes {
            lengths.insert(PROBES.into(), table.flush()?);
        }
        if let Some(table) = &mut self.joints {
            lengths.insert(JOINTS.into(), table.flush()?);
        }
        if let Some(table) = &mut self.bodies {
            lengths.insert(BODIES.into(), table.flush()?);
        }
        if let Some(table) = &mut self.contact {
            lengths.insert("contact.csv".into(), table.flush()?);
        }
        Ok(())
    }
}
