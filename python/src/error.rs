//! Problems of the library as exceptions and warnings. The classes are Python code (`errors.py`).

use std::ffi::CString;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use fishplate::problem::{Problem, Problems, Severity};
use fishplate::source::Span;

/// One problem as a `fishplate.Problem`.
fn one<'py>(py: Python<'py>, problem: &Problem) -> PyResult<Bound<'py, PyAny>> {
    let told = PyDict::new(py);
    told.set_item(
        "severity",
        if problem.severity == Severity::Error { "error" } else { "warning" },
    )?;
    told.set_item("code", problem.code)?;
    told.set_item("message", &problem.says)?;
    told.set_item(
        "span",
        problem.at.as_ref().map(|at| span(py, at, problem.label.as_deref())).transpose()?,
    )?;
    let also: Vec<Bound<'_, PyAny>> = problem
        .also
        .iter()
        .map(|(at, label)| span(py, at, Some(label)))
        .collect::<PyResult<_>>()?;
    told.set_item("also", also)?;
    told.set_item("help", &problem.help)?;
    told.set_item("text", problem.render(false))?;
    classes(py)?.getattr("Problem")?.call((), Some(&told))
}

fn span<'py>(py: Python<'py>, at: &Span, label: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    let (line, column) = at.source.line_column(at.start);
    let (end_line, end_column) = at.source.line_column(at.end.max(at.start));
    let told = PyDict::new(py);
    told.set_item("file", &at.source.name)?;
    told.set_item("line", line)?;
    told.set_item("column", column)?;
    told.set_item("end_line", end_line)?;
    told.set_item("end_column", end_column)?;
    told.set_item("text", at.text())?;
    told.set_item("label", label)?;
    classes(py)?.getattr("Span")?.call((), Some(&told))
}

fn classes(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("fishplate.errors")
}

/// All problems as a list of `fishplate.Problem`.
pub fn listed<'py>(py: Python<'py>, problems: &Problems) -> PyResult<Bound<'py, PyAny>> {
    let all: Vec<Bound<'_, PyAny>> =
        problems.0.iter().map(|problem| one(py, problem)).collect::<PyResult<_>>()?;
    Ok(PyList::new(py, all)?.into_any())
}

/// The exception with all problems.
pub fn raised(py: Python<'_>, problems: &Problems) -> PyErr {
    let made = || classes(py)?.getattr("Error")?.call1((listed(py, problems)?,));
    match made() {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// The exception with one problem.
pub fn one_raised(py: Python<'_>, problem: Problem) -> PyErr {
    raised(py, &Problems(vec![problem]))
}

/// Raises the errors; else issues the warnings as `fishplate.Warning`.
pub fn told(py: Python<'_>, problems: &Problems) -> PyResult<()> {
    if problems.any_error() {
        return Err(raised(py, problems));
    }
    let category = classes(py)?.getattr("Warning")?;
    for problem in &problems.0 {
        let text =
            CString::new(problem.render(false).replace('\0', "\u{fffd}")).unwrap_or_default();
        PyErr::warn(py, &category, &text, 2)?;
    }
    Ok(())
}

/// The value, or the errors.
pub fn or_raise<T>(py: Python<'_>, value: Option<T>, problems: &Problems) -> PyResult<T> {
    told(py, problems)?;
    value.ok_or_else(|| {
        one_raised(py, Problem::error("internal", "no result, and no problem that says why"))
    })
}
