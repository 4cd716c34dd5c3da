//! `diagnose`, with a Python function as simulator.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::document::{Found, Report};
use crate::error::or_raise;
use crate::inputs::Campaign;
use crate::table::Table;
use crate::work::{self, Stopped};
use crate::{Asked, error, opened};
use fishplate::diagnose::inputs::Inputs;
use fishplate::prepare::for_diagnosis;
use fishplate::problem::{Problem, Problems, Severity};
use fishplate::simulate::{self, Builtin, Function, Simulator};

/// A record that is to be simulated.
#[pyclass(frozen, module = "fishplate", get_all)]
#[derive(Debug)]
pub struct Task {
    /// Name of the section.
    section: String,
    /// Start and end on the axis, SI; infinite without a table of sections.
    start: f64,
    end: f64,
    /// In m/s, if the table of sections has a speed.
    speed: Option<f64>,
    /// The cells of the section's row, by column without unit.
    columns: Py<PyDict>,
    /// Parameters of the simulator that differ from the vehicle file, in its units.
    settings: Py<PyDict>,
    /// Recorded minus true position in m: the record is extended by it.
    shift: f64,
}

#[pymethods]
impl Task {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<fishplate.Task {:?} with {}>", self.section, self.settings.bind(py).repr()?))
    }
}

impl Task {
    fn of(py: Python<'_>, task: &simulate::Task<'_>) -> PyResult<Self> {
        let settings = PyDict::new(py);
        for (name, value) in task.settings {
            settings.set_item(name, value)?;
        }
        let columns = PyDict::new(py);
        for fact in &task.section.facts {
            columns.set_item(&fact.name, &fact.text)?;
        }
        Ok(Self {
            section: task.section.name().to_string(),
            start: task.section.start,
            end: task.section.end,
            speed: task.section.speed,
            columns: columns.unbind(),
            settings: settings.unbind(),
            shift: task.shift,
        })
    }
}

/// Calls the function, whose result is a table.
fn called(
    function: &Py<PyAny>,
    convert: &Py<PyAny>,
    name: &str,
    task: &simulate::Task<'_>,
    stopped: &Stopped,
) -> Result<fishplate::data::record::Frame, Problem> {
    if stopped.yes() {
        return Err(Problem::error("interrupted", "the diagnosis was interrupted"));
    }
    Python::attach(|py| {
        let made = Task::of(py, task)
            .and_then(|task| Bound::new(py, task))
            .and_then(|task| function.bind(py).call1((task,)));
        let table = made.and_then(|made| Table::of(&convert.bind(py).call1((made,))?));
        let frame = table.map_err(|error| {
            let says =
                format!("section `{}`: the simulator {name} failed: {error}", task.section.name());
            let traceback = error.traceback(py).and_then(|traceback| traceback.format().ok());
            let problem = Problem::error("simulator-failed", says).at(&task.section.cell.span);
            match traceback {
                Some(text) => problem.help(text),
                None => problem,
            }
        })?;
        frame.frame(&format!("{} of {name}", task.section.name()))
    })
}

/// What makes the records of a diagnosis.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Simulates {
    function: Option<Py<PyAny>>,
    /// Turns what it returns into a table.
    convert: Py<PyAny>,
    name: String,
}

#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn diagnose(
    py: Python<'_>,
    campaign: PyRef<'_, Campaign>,
    protocol: Option<Asked>,
    catalogue: String,
    simulator: Simulates,
    set: Vec<String>,
    seed: u64,
    jobs: Option<usize>,
) -> PyResult<Report> {
    let campaign = campaign.inner.clone();
    let (found, problems) = work::run(py, jobs, move |stopped| {
        let mut problems = Problems::default();
        let found = diagnosed(
            campaign,
            protocol.as_ref(),
            &catalogue,
            &simulator,
            &set,
            seed,
            stopped,
            &mut problems,
        );
        // The function may hold the last reference to its objects.
        Python::attach(|_| drop(simulator));
        (found, problems)
    })?;
    let found = or_raise(py, found, &problems)?;
    error::told(py, &Problems(found.warnings.0.clone()))?;
    Ok(Report::new(Found::Diagnosis(Box::new(found))))
}

/// Problems of a number that is in the vehicle file: errors. What else the model lacks is a
/// warning.
const WRONG: [&str; 2] = ["wrong-kind", "range"];

#[allow(clippy::too_many_arguments)]
fn diagnosed(
    campaign: fishplate::data::Campaign,
    protocol: Option<&Asked>,
    catalogue: &str,
    simulates: &Simulates,
    set: &[String],
    seed: u64,
    stopped: &Stopped,
    problems: &mut Problems,
) -> Option<fishplate::diagnose::Outcome> {
    let mut opened = opened(vec![campaign], protocol, set, problems)?;
    let campaign = opened.campaigns.pop()?;
    let (catalogue, settings, sections) = for_diagnosis(&campaign, catalogue, problems)?;
    let call = |task: &simulate::Task<'_>| {
        let function = simulates
            .function
            .as_ref()
            .ok_or_else(|| Problem::error("internal", "no simulator"))?;
        called(function, &simulates.convert, &simulates.name, task, stopped)
    };
    let function = simulates
        .function
        .is_some()
        .then(|| Function::new(&campaign, simulates.name.as_str(), &call));
    let mut lacking = Problems::default();
    let model = if function.is_some() { None } else { Builtin::new(&campaign, &mut lacking) };
    for problem in lacking.0 {
        let severity =
            if WRONG.contains(&problem.code) { Severity::Error } else { Severity::Warning };
        problems.push(Problem { severity, ..problem });
    }
    if problems.any_error() {
        return None;
    }
    let simulator = function
        .as_ref()
        .map(|one| one as &dyn Simulator)
        .or(model.as_ref().map(|one| one as &dyn Simulator));
    let inputs = Inputs {
        campaign: &campaign,
        catalogue: &catalogue,
        settings: &settings,
        simulator,
        cache: None,
        references: &[],
        seed,
        trying: &|_| {},
    };
    match fishplate::diagnose::diagnose(&inputs, &opened.compiled, sections) {
        Ok(found) => Some(found),
        Err(told) => {
            told.0.into_iter().for_each(|problem| problems.push(problem));
            None
        }
    }
}
