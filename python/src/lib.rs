//! The Python package `fishplate`: thin classes over the library. Signatures, defaults and
//! documentation are in `package/fishplate`.

mod diagnose;
mod document;
mod error;
mod html;
mod inputs;
mod parts;
mod result;
mod table;
mod work;

use pyo3::prelude::*;

use fishplate::certify::Opened;
use fishplate::check::{self, Overrides};
use fishplate::data;
use fishplate::library;
use fishplate::prepare::{Protocol, prepare_opened};
use fishplate::problem::Problems;

/// The allocator of the program: see `src/main.rs`. The memory of Python, NumPy and others is not
/// touched.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Whether the wheel has the typesetter: without it there is no PDF.
const TYPESETS: bool = cfg!(feature = "typeset");

/// Every problem of a protocol, given by name or path, or as a text.
#[pyfunction]
fn check_protocol<'py>(py: Python<'py>, protocol: Asked) -> PyResult<Bound<'py, PyAny>> {
    let problems = py.detach(|| {
        let mut problems = Problems::default();
        if let Some(family) = protocol.of().load(&mut problems) {
            check::check(&family, &Overrides::new(), &mut problems);
        }
        problems
    });
    error::listed(py, &problems)
}

/// Names and titles of the shipped protocols.
#[pyfunction]
fn shipped() -> Vec<&'static str> {
    library::names().collect()
}

/// The protocol that is asked for: a name or path, or a text.
#[derive(Clone, Debug, FromPyObject)]
pub struct Asked {
    #[pyo3(item)]
    name: Option<String>,
    #[pyo3(item)]
    text: Option<String>,
}

/// Campaigns with the protocol that is asked for, if there is no error.
pub fn opened(
    campaigns: Vec<data::Campaign>,
    protocol: Option<&Asked>,
    set: &[String],
    problems: &mut Problems,
) -> Option<Opened> {
    prepare_opened(campaigns, protocol.map(Asked::of), set, problems)
        .filter(|_| !problems.any_error())
}

impl Asked {
    pub fn of(&self) -> Protocol<'_> {
        match (&self.text, &self.name) {
            (Some(text), _) => Protocol::Text(text),
            (None, name) => Protocol::Named(name.as_deref().unwrap_or_default()),
        }
    }
}

#[pymodule(gil_used = false)]
mod _fishplate {
    #[pymodule_export]
    use super::check_protocol;
    #[pymodule_export]
    use super::diagnose::{Task, diagnose};
    #[pymodule_export]
    use super::document::{Report, compare, study};
    #[pymodule_export]
    use super::inputs::Campaign;
    #[pymodule_export]
    use super::parts::{judge, reduce};
    #[pymodule_export]
    use super::result::{Result, certify};
    #[pymodule_export]
    use super::shipped;
    #[pymodule_export]
    use super::table::{Table, csv, from_arrays, read_elsewhere, read_record};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("TYPESETS", super::TYPESETS)
    }
}
