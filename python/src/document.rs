//! `study` and `compare`, and their result: a document with numbers, tables and figures.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{or_raise, raised};
use crate::inputs::Campaign;
use crate::result::written;
use crate::table::{Table, of_csv};
use crate::{Asked, TYPESETS, html, opened, work};
use fishplate::deliver::{self, Files, Reports};
use fishplate::diagnose::Outcome;
use fishplate::prepare::set_by_hand;
use fishplate::problem::Problems;
use fishplate::report::document::{Block, Document, Fact, ResultBox, Tone};
use fishplate::report::{comparison, diagnosis, study as report};
use fishplate::result::comparison::Comparison;
use fishplate::result::study::Study;
use fishplate::robustness::{Asked as Kind, Margins, Settings, Synchronisation, Vary};

/// What was found.
#[derive(Debug)]
pub enum Found {
    Study(Box<Study>),
    Comparison(Box<Comparison>),
    Diagnosis(Box<Outcome>),
}

impl Found {
    fn document(&self) -> Document {
        match self {
            Self::Study(found) => report::document(found),
            Self::Comparison(found) => comparison::document(found),
            Self::Diagnosis(found) => diagnosis::document(&found.diagnosis, &found.before),
        }
    }

    fn figures(&self) -> Vec<(String, String)> {
        match self {
            Self::Study(found) => report::figures(found),
            Self::Comparison(found) => comparison::figures(found),
            Self::Diagnosis(found) => diagnosis::figures(&found.diagnosis),
        }
    }

    fn files(&self, reports: Reports) -> Result<Files, Problems> {
        match self {
            Self::Study(found) => deliver::study(found, reports),
            Self::Comparison(found) => deliver::comparison(found, reports),
            Self::Diagnosis(found) => deliver::diagnosis(found, reports),
        }
    }
}

/// The result of a study, a comparison or a diagnosis.
#[pyclass(frozen, module = "fishplate")]
#[derive(Clone, Debug)]
pub struct Report {
    found: Arc<Found>,
    document: Arc<Document>,
}

impl Report {
    pub fn new(found: Found) -> Self {
        Self { document: Arc::new(found.document()), found: Arc::new(found) }
    }
}

/// Figures that a notebook shows.
const FIGURES: usize = 2;

#[pymethods]
impl Report {
    #[getter]
    fn title(&self) -> &str {
        &self.document.title
    }

    /// The result in a few words; of a diagnosis the verdict.
    #[getter]
    fn verdict(&self) -> String {
        match &*self.found {
            Found::Diagnosis(found) => found.diagnosis.verdict.to_string(),
            _ => self.result().map_or_else(String::new, |result| result.finding.word.clone()),
        }
    }

    #[getter]
    fn sentence(&self) -> &str {
        self.result().map_or("", |result| &result.sentence)
    }

    /// Short facts: name and value.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let facts = PyDict::new(py);
        for fact in self.tiles() {
            facts.set_item(&fact.name, fact.value.letters())?;
        }
        Ok(facts)
    }

    /// The bytes of study.json, comparison.json or diagnosis.json.
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let files = py
            .detach(|| self.found.files(Reports::NONE))
            .map_err(|problems| raised(py, &problems))?;
        let numbers = files
            .iter()
            .find(|(name, _)| name.ends_with(".json"))
            .map(|(_, bytes)| bytes.as_slice());
        Ok(PyBytes::new(py, numbers.unwrap_or_default()))
    }

    /// All tables by name.
    fn tables(&self, py: Python<'_>) -> PyResult<Vec<(String, Table)>> {
        let files = py
            .detach(|| self.found.files(Reports::NONE))
            .map_err(|problems| raised(py, &problems))?;
        let name =
            |path: &str| Some(path.strip_prefix("tables/")?.trim_end_matches(".csv").to_string());
        Ok(files
            .into_iter()
            .filter_map(|(path, bytes)| Some((name(&path)?, of_csv(&bytes))))
            .collect())
    }

    /// The figures as SVG, by name.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let drawn = PyDict::new(py);
        for (name, svg) in py.detach(|| self.found.figures()) {
            drawn.set_item(name, svg)?;
        }
        Ok(drawn)
    }

    /// Writes the report, all files or none.
    #[pyo3(signature = (out, *, pdf = None, html = true))]
    fn write(&self, py: Python<'_>, out: PathBuf, pdf: Option<bool>, html: bool) -> PyResult<()> {
        let pdf = pdf.unwrap_or(TYPESETS);
        let found = Arc::clone(&self.found);
        written(py, out, move || found.files(Reports { pdf, html }))
    }

    fn __repr__(&self) -> String {
        format!("<fishplate.Report {:?}: {}>", self.document.title, self.verdict())
    }

    fn _repr_html_(&self) -> String {
        let document = &self.document;
        let holds = self.result().and_then(|result| match result.finding.tone {
            Tone::Good => Some(true),
            Tone::Bad => Some(false),
            Tone::Open => None,
        });
        let facts: Vec<Vec<String>> =
            self.tiles().map(|fact| vec![fact.name.clone(), fact.value.letters()]).collect();
        let drawn = self
            .found
            .figures()
            .into_iter()
            .take(FIGURES)
            .map(|(name, svg)| html::figure(&svg, &name));
        html::head(&document.title, holds, &self.verdict(), &[self.sentence().to_owned()])
            + &drawn.collect::<String>()
            + &html::table(&[String::new(), String::new()], &facts, None)
    }
}

impl Report {
    fn result(&self) -> Option<&ResultBox> {
        Some(&self.document.cover.as_ref()?.result)
    }

    /// The short facts of the first page.
    fn tiles(&self) -> impl Iterator<Item = &Fact> {
        let blocks = self.document.cover.iter().flat_map(|cover| &cover.blocks);
        blocks.flat_map(|block| match block {
            Block::Tiles(facts) => &facts[..],
            _ => &[],
        })
    }
}

/// What is studied, as the Python code says it.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Studied {
    kind: String,
    offsets: Vec<f64>,
    farthest: f64,
    correct: bool,
    vary: Vec<(String, Vec<String>)>,
    take: Option<usize>,
    reduce: Option<usize>,
    most: Option<f64>,
    width: f64,
    draws: Option<usize>,
    seed: u64,
}

impl Studied {
    fn asked(&self) -> Kind {
        match self.kind.as_str() {
            "sync" => Kind::Sync(Synchronisation {
                offsets: self.offsets.clone(),
                farthest: self.farthest,
                correct: self.correct,
            }),
            "parameters" => Kind::Parameters(
                self.vary
                    .iter()
                    .map(|(name, values)| Vary { name: name.clone(), values: values.clone() })
                    .collect(),
            ),
            "margin" => {
                Kind::Margin(Margins { draws: self.draws.unwrap_or(fishplate::robustness::DRAWS) })
            }
            _ => Kind::Sections,
        }
    }

    fn settings(&self) -> Settings {
        let most = self.most.unwrap_or(fishplate::study::MOST).min(fishplate::study::MOST);
        Settings {
            selections: fishplate::study::Settings { most, width: self.width, seed: self.seed },
            take: self.take,
            reduce: self.reduce,
        }
    }
}

#[pyfunction]
pub fn study(
    py: Python<'_>,
    campaigns: Vec<PyRef<'_, Campaign>>,
    protocol: Option<Asked>,
    set: Vec<String>,
    studied: Studied,
    jobs: Option<usize>,
) -> PyResult<Report> {
    let campaigns: Vec<_> = campaigns.iter().map(|campaign| campaign.inner.clone()).collect();
    let (found, problems) = work::run(py, jobs, move |_| {
        let mut problems = Problems::default();
        let opened = opened(campaigns, protocol.as_ref(), &set, &mut problems);
        let found = opened.and_then(|opened| {
            let asked = studied.asked();
            let found =
                asked.ready(&opened).and_then(|_| asked.run(&opened, &studied.settings(), &|_| {}));
            found.map_err(|told| problems.add(told.0)).ok()
        });
        (found, problems)
    })?;
    let found = or_raise(py, found, &problems)?;
    Ok(Report::new(Found::Study(Box::new(found))))
}

/// Protocols side by side over campaigns.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    campaigns: Vec<PyRef<'_, Campaign>>,
    protocols: Vec<Asked>,
    set: Vec<(String, String)>,
    sizes: Option<Vec<f64>>,
    jobs: Option<usize>,
) -> PyResult<Report> {
    let campaigns: Vec<_> = campaigns.iter().map(|campaign| campaign.inner.clone()).collect();
    let (found, problems) = work::run(py, jobs, move |_| {
        let mut problems = Problems::default();
        let families: Option<Vec<_>> =
            protocols.iter().map(|protocol| protocol.of().load(&mut problems)).collect();
        let sizes = sizes.unwrap_or_else(|| fishplate::compare::SIZES.to_vec());
        let set: Vec<String> = set.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let set = set_by_hand(&set, &mut problems);
        let prepared = families.zip(set).and_then(|(families, set)| {
            let settings = fishplate::compare::Settings { sizes, set };
            fishplate::compare::Prepared::new(families, campaigns, settings, &mut problems)
        });
        let found =
            prepared.filter(|_| !problems.any_error()).map(|prepared| prepared.compare(&|_| {}));
        (found, problems)
    })?;
    let found = or_raise(py, found, &problems)?;
    Ok(Report::new(Found::Comparison(Box::new(found))))
}
