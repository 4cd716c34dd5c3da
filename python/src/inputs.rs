//! Campaigns: a folder, or parts in memory.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{one_raised, or_raise};
use crate::table::Table;
use fishplate::data;
use fishplate::data::campaign::Memory;
use fishplate::data::sites::originals;
use fishplate::problem::Problems;

/// A campaign that is open. Its records are read when it is evaluated.
#[pyclass(frozen, module = "fishplate._fishplate", subclass)]
#[derive(Clone, Debug)]
pub struct Campaign {
    pub inner: data::Campaign,
}

#[pymethods]
impl Campaign {
    /// `texts` and `records` by their paths inside the campaign; `folder` has what is not among
    /// them.
    #[staticmethod]
    fn of(
        py: Python<'_>,
        folder: Option<PathBuf>,
        texts: BTreeMap<String, Vec<u8>>,
        records: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let mut memory = Memory { texts, records: BTreeMap::new() };
        for (name, record) in records {
            let name: String = name.extract()?;
            let frame =
                Table::of(&record)?.frame(&name).map_err(|problem| one_raised(py, problem))?;
            memory.records.insert(name, Arc::new(frame));
        }
        let (opened, problems) = py.detach(|| {
            let mut problems = Problems::default();
            let opened = match folder {
                Some(folder) if memory.texts.is_empty() && memory.records.is_empty() => {
                    data::Campaign::open(&folder, &mut problems)
                }
                folder => data::Campaign::with_memory(folder.as_deref(), memory, &mut problems),
            };
            (opened, problems)
        });
        Ok(Self { inner: or_raise(py, opened, &problems)? })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// The names of the sections.
    #[getter]
    fn sections(&self) -> Vec<&str> {
        self.inner.names.iter().map(|name| name.value.as_str()).collect()
    }

    /// The number of the section that each section repeats, of whose records it needs those, too.
    #[getter]
    fn originals(&self) -> Vec<Option<usize>> {
        self.inner.sections.as_ref().map_or_else(|| vec![None; self.inner.names.len()], originals)
    }

    fn __repr__(&self) -> String {
        format!("<fishplate.Campaign {:?} of {} sections>", self.inner.name, self.inner.names.len())
    }
}
