//! A run step by step.

use crate::errors::Refused;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use stoss::output::{Outcome, Overwrite};
use stoss::run::{Event, RunError, RunOptions, Session as Inner, Summary};
use stoss::solver::{Simulation, StepRecord};

/// A read-only copy.
pub fn array1<'py, T: Element + Clone>(py: Python<'py>, values: &[T]) -> Bound<'py, PyArray1<T>> {
    let array = PyArray1::from_slice(py, values);
    array.readwrite().make_nonwriteable();
    array
}

/// A read-only copy of rows with `columns` numbers each.
pub fn array2<'py>(py: Python<'py>, values: &[f64], columns: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let array = PyArray1::from_slice(py, values).reshape([values.len() / columns.max(1), columns])?;
    array.readwrite().make_nonwriteable();
    Ok(array)
}

/// A run that Python leads from step to step.
#[pyclass(frozen, module = "stoss._native")]
pub struct Session {
    state: Mutex<State>,
    stop: Arc<AtomicBool>,
    out: PathBuf,
}

struct State {
    run: Inner,
    last: StepRecord,
    /// Points of the frames among the nodes; none if they are the nodes.
    points: Option<Vec<u32>>,
    told: Told,
}

/// What the run has said since it was asked last.
#[derive(Default)]
struct Told {
    warnings: Vec<String>,
    diagnosis: Option<String>,
    worst: (Option<f64>, f64),
    end: f64,
    step: f64,
    title: String,
}

impl Told {
    fn hear(&mut self, event: &Event<'_>) {
        match event {
            Event::Start { title, end, step, .. } => {
                (self.title, self.end, self.step) = ((*title).to_owned(), *end, *step);
            }
            Event::Warning(text) => self.warnings.push((*text).to_owned()),
            Event::Step { record, watched, .. } => {
                self.worst = (watched.drift.map(|(_, drift)| drift), watched.relative_depth);
                let warnings = record.decisions.iter().filter(|of| of.kind == stoss::solver::DecisionKind::Warning);
                self.warnings.extend(warnings.map(|decision| decision.reason.clone()));
            }
            Event::Diagnosis(diagnosis) => self.diagnosis = Some(diagnosis.to_string()),
            _ => {}
        }
    }
}

impl State {
    fn simulation(&self) -> &Simulation {
        self.run.simulation()
    }

    /// What belongs to points, of what belongs to nodes.
    fn of_points<'py>(&self, py: Python<'py>, values: &[f64], n: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        match &self.points {
            None => array2(py, values, n),
            Some(points) => {
                let rows = points.iter().flat_map(|&node| &values[n * node as usize..n * (node as usize + 1)]);
                array2(py, &rows.copied().collect::<Vec<_>>(), n)
            }
        }
    }
}

impl Session {
    /// The state, unless another thread computes a step.
    fn state(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, State>> {
        let busy = || Refused::option("another thread computes a step of this run: ask it after that step").raise(py);
        self.state.try_lock().map_err(|_| busy())
    }

    /// Computes without the interpreter's lock.
    fn compute<T: Send>(
        &self,
        py: Python<'_>,
        what: impl FnOnce(&mut Inner, &mut dyn FnMut(Event<'_>)) -> Result<T, RunError> + Send,
    ) -> PyResult<(T, MutexGuard<'_, State>)> {
        // Another thread that has it computes: it is to be refused, not waited for with the interpreter locked.
        drop(self.state(py)?);
        let result = py.detach(|| {
            // A panic while a step was computed leaves a state that no one may look at.
            let Ok(mut state) = self.state.lock() else { return Err((Refused::option("this run has failed"), None)) };
            let State { run, told, .. } = &mut *state;
            match what(run, &mut |event| told.hear(&event)) {
                Ok(value) => Ok(value),
                Err(error) => Err((Refused::of(&error), told.diagnosis.clone())),
            }
        });
        match result {
            Ok(value) => Ok((value, self.state(py)?)),
            Err((refused, diagnosis)) => Err(refused.raise_with(py, diagnosis.as_deref())),
        }
    }
}

#[pymethods]
impl Session {
    #[new]
    #[pyo3(signature = (scene, out, parameters, steered, until=None, resume=false, overwrite=false))]
    fn start(
        py: Python<'_>,
        scene: PathBuf,
        out: PathBuf,
        parameters: Vec<(String, String)>,
        steered: Vec<String>,
        until: Option<f64>,
        resume: bool,
        overwrite: bool,
    ) -> PyResult<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let options = RunOptions {
            out: out.clone(),
            until,
            resume,
            steered,
            overwrite: if overwrite { Overwrite::Any } else { Overwrite::Own },
            set: parameters,
            stop: Arc::clone(&stop),
            ..RunOptions::default()
        };
        let mut told = Told::default();
        let run =
            py.detach(|| Inner::start(&scene, &options, &mut |event| told.hear(&event)).map_err(|e| Refused::of(&e)));
        let run = run.map_err(|refused| refused.raise(py))?;
        let points = run.points();
        let is_all = points.len() == run.simulation().model().node_count();
        let last = run.simulation().initial_record();
        let state = State { last, points: (!is_all).then_some(points), run, told };
        Ok(Self { state: Mutex::new(state), stop, out })
    }

    /// Does a step; false if there is none.
    fn advance(&self, py: Python<'_>) -> PyResult<bool> {
        let (record, mut state) = self.compute(py, |run, report| run.advance(report))?;
        let went_on = record.is_some();
        if let Some(record) = record {
            state.last = record;
        }
        Ok(went_on)
    }

    /// Lets the next `advance` do nothing, and the run end as one that was interrupted.
    fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether `stop` was called.
    #[getter]
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Ends the run: `summary.json` as text, whether it was interrupted, the verdict in words, the diagnosis in words if there is one.
    fn finish(&self, py: Python<'_>) -> PyResult<(String, bool, String, Option<String>)> {
        let (summary, state): (Summary, _) = self.compute(py, |run, report| run.finish(report))?;
        let text = serde_json::to_string(&summary).map_err(|error| Refused::output(&error.to_string()).raise(py))?;
        let interrupted = matches!(summary.outcome, Outcome::Interrupted { .. });
        Ok((text, interrupted, summary.verdict.to_string(), state.told.diagnosis.clone()))
    }

    /// Sets a load or a prescribed motion.
    fn lead(&self, py: Python<'_>, name: &str, values: Vec<f64>, until: Option<f64>) -> PyResult<()> {
        self.state(py)?.run.lead(name, &values, until).map_err(|error| Refused::of(&error).raise(py))
    }

    /// The present values of what is set.
    fn steered<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = self.state(py)?.run.steered_values(name).map_err(|error| Refused::of(&error).raise(py))?;
        Ok(array1(py, &values))
    }

    /// Warnings since the last call.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(std::mem::take(&mut self.state(py)?.told.warnings))
    }

    /// Folder of the results.
    #[getter]
    fn out(&self) -> PathBuf {
        self.out.clone()
    }

    /// Title, end time, nominal size of a step.
    #[getter]
    fn plan(&self, py: Python<'_>) -> PyResult<(String, f64, f64)> {
        let told = &self.state(py)?.told;
        Ok((told.title.clone(), told.end, told.step))
    }

    /// Number, time and size of the last step, linear solutions, stage, largest drift, deepest penetration in edges.
    #[getter]
    fn last(&self, py: Python<'_>) -> PyResult<(u64, f64, f64, u32, u32, Option<f64>, f64)> {
        let state = self.state(py)?;
        let (last, worst) = (&state.last, state.told.worst);
        let (step, time) = (state.simulation().step(), state.simulation().state().time);
        Ok((step, time, last.dt, last.iterations, state.simulation().stage(), worst.0, worst.1))
    }

    /// Bodies by name: first point and number of points.
    #[getter]
    fn bodies(&self, py: Python<'_>) -> PyResult<Vec<(String, usize, usize)>> {
        let state = self.state(py)?;
        let place = |node: u32| match &state.points {
            None => node as usize,
            Some(points) => points.partition_point(|&point| point < node),
        };
        let bodies = state.simulation().model().bodies.iter();
        Ok(bodies
            .map(|body| {
                let first = place(body.nodes.start);
                (body.solid.name().to_owned(), first, place(body.nodes.end) - first)
            })
            .collect())
    }

    #[getter]
    fn reference<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py)?;
        state.of_points(py, &state.simulation().model().reference, 3)
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py)?;
        state.of_points(py, &state.simulation().state().q, 3)
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py)?;
        state.of_points(py, &state.simulation().state().v, 3)
    }

    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py)?;
        let forces = state.simulation().contact_force();
        if forces.is_empty() {
            let zeros = vec![0.0; state.simulation().state().q.len()];
            return state.of_points(py, &zeros, 3);
        }
        state.of_points(py, forces, 3)
    }

    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py)?;
        let reactions = state.simulation().reactions();
        if reactions.is_empty() {
            let zeros = vec![0.0; state.simulation().state().q.len()];
            return state.of_points(py, &zeros, 3);
        }
        state.of_points(py, &reactions, 3)
    }

    /// Cauchy stress at the nodes of solids, not a number elsewhere.
    #[getter]
    fn stresses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(py)?;
        let (model, q) = (state.simulation().model(), &state.simulation().state().q);
        let mut stress = vec![[f64::NAN; 6]; model.node_count()];
        for body in &model.bodies {
            let nodes = body.nodes.start as usize..body.nodes.end as usize;
            let found = body.solid.nodal_cauchy_stress(q);
            let found = found.map_err(|error| Refused::output(&error.to_string()).raise(py))?;
            stress[nodes].copy_from_slice(&found.means());
        }
        state.of_points(py, stress.as_flattened(), 6)
    }

    /// Balance of energy and momenta.
    #[getter]
    fn balance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = self.state(py)?;
        let balance = state.simulation().balance();
        let dict = PyDict::new(py);
        dict.set_item("linear_momentum", array1(py, &balance.linear_momentum))?;
        dict.set_item("angular_momentum", array1(py, &balance.angular_momentum))?;
        for (name, value) in [
            ("kinetic", balance.kinetic),
            ("strain", balance.strain),
            ("potential", balance.potential),
            ("contact", balance.contact),
            ("external_work", balance.external_work),
            ("friction_work", balance.friction_work),
            ("damping", balance.damping),
            ("dissipation", balance.dissipation),
            ("total", balance.total()),
        ] {
            dict.set_item(name, value)?;
        }
        Ok(dict)
    }

    /// Contact at the end of the step, all pairs together; nothing in a scene without contact.
    #[getter]
    fn contact<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let state = self.state(py)?;
        let Some(contact) = &state.last.contact else { return Ok(None) };
        let dict = PyDict::new(py);
        dict.set_item("active", contact.active)?;
        dict.set_item("closed", contact.closed)?;
        dict.set_item("released", contact.released)?;
        dict.set_item("min_gap", contact.min_gap)?;
        dict.set_item("max_pressure", contact.max_pressure)?;
        dict.set_item("force_on_slave", array1(py, &contact.force_on_slave))?;
        Ok(Some(dict))
    }

    /// Values of the probes, one after the other, by the names of their columns.
    #[getter]
    fn probes(&self, py: Python<'_>) -> PyResult<Vec<(String, Vec<String>, Vec<f64>)>> {
        let state = self.state(py)?;
        let probes = state.run.probes().iter();
        Ok(probes.map(|probe| (probe.name.clone(), probe.columns(), probe.values(state.simulation()))).collect())
    }
}
