//! `reduce` and `judge`: the values of a part of the sections as bytes, and the result from all
//! parts.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::or_raise;
use crate::inputs::Campaign;
use crate::result::Result;
use crate::{Asked, opened, work};
use fishplate::problem::{Problem, Problems};
use fishplate::run::{Settings, Shard};
use fishplate::values::{self, ReduceJob};

/// The bytes of a file of values.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn reduce<'py>(
    py: Python<'py>,
    campaigns: Vec<PyRef<'_, Campaign>>,
    protocol: Option<Asked>,
    set: Vec<String>,
    shard: (usize, usize),
    plots: bool,
    jobs: Option<usize>,
) -> PyResult<Bound<'py, PyBytes>> {
    let campaigns: Vec<_> = campaigns.iter().map(|campaign| campaign.inner.clone()).collect();
    let (made, problems) = work::run(py, jobs, move |_| {
        let mut problems = Problems::default();
        let shard = Shard::parse(&format!("{}/{}", shard.0, shard.1));
        let shard = shard.map_err(|says| problems.push(Problem::error("shard", says))).ok();
        let opened = opened(campaigns, protocol.as_ref(), &set, &mut problems);
        let made = shard.zip(opened).and_then(|(shard, opened)| {
            let found = values::reduce(&opened, ReduceJob { shard, plots }, &|_| {});
            let made = found.and_then(|found| Ok(values::write(&opened.compiled.plan, &found)?));
            made.map_err(|told| problems.add(told.0)).ok()
        });
        (made, problems)
    })?;
    Ok(PyBytes::new(py, &or_raise(py, made, &problems)?))
}

/// The result from the bytes of files of values, each with its name.
#[pyfunction]
pub fn judge(py: Python<'_>, parts: Vec<(String, Vec<u8>)>, plots: usize) -> PyResult<Result> {
    let (found, problems) = work::run(py, None, move |_| {
        let mut problems = Problems::default();
        let mut files = Vec::new();
        for (name, bytes) in parts {
            match values::read(&name, bytes) {
                Ok(file) => files.push(file),
                Err(problem) => problems.push(problem),
            }
        }
        let joined = if problems.any_error() { None } else { values::join(files, &mut problems) };
        let found = joined.filter(|_| !problems.any_error()).and_then(|joined| {
            let found = joined.certification(Settings { traces: plots });
            found.map_err(|told| problems.add(told.0)).ok()
        });
        (found, problems)
    })?;
    Ok(Result { found: Arc::new(or_raise(py, found, &problems)?) })
}
