//! `certify`, and its result.

use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, StringArray, UInt64Array};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{or_raise, raised};
use crate::inputs::Campaign;
use crate::table::{Table, of_csv};
use crate::{Asked, TYPESETS, html, opened, work};
use fishplate::data::write::Outputs;
use fishplate::deliver::{self, Files, Reports};
use fishplate::disk::SetKind;
use fishplate::problem::{Problem, Problems};
use fishplate::report::{figure, tables};
use fishplate::result::text;
use fishplate::result::{Certification, PairValue, QuantityResult, StatisticResult, Verdict};
use fishplate::run::Settings;

/// Evaluates a protocol on campaigns, as one.
#[pyfunction]
pub fn certify(
    py: Python<'_>,
    campaigns: Vec<PyRef<'_, Campaign>>,
    protocol: Option<Asked>,
    set: Vec<String>,
    plots: usize,
    jobs: Option<usize>,
) -> PyResult<Result> {
    let campaigns: Vec<_> = campaigns.iter().map(|campaign| campaign.inner.clone()).collect();
    let (found, problems) = work::run(py, jobs, move |_| {
        let mut problems = Problems::default();
        let found = opened(campaigns, protocol.as_ref(), &set, &mut problems).and_then(|opened| {
            let found = opened.certify(Settings { traces: plots }, &|_| {});
            found.map_err(|told| problems.add(told.0)).ok()
        });
        (found, problems)
    })?;
    Ok(Result { found: Arc::new(or_raise(py, found, &problems)?) })
}

/// The result of a protocol on a campaign.
#[pyclass(frozen, module = "fishplate")]
#[derive(Clone, Debug)]
pub struct Result {
    pub found: Arc<Certification>,
}

#[pymethods]
impl Result {
    /// `validated`, `not validated` or `not assessable`, or the words of the protocol.
    #[getter]
    fn verdict(&self) -> &str {
        self.found.verdict_word()
    }

    /// Names of the values that nobody has confirmed; with one of them the verdict is provisional.
    #[getter]
    fn provisional(&self) -> Vec<&str> {
        self.found.provisional.iter().map(|value| value.name.as_str()).collect()
    }

    /// Whether the verdict holds.
    #[getter]
    fn holds(&self) -> bool {
        self.found.verdict == Verdict::Validated
    }

    fn __bool__(&self) -> PyResult<bool> {
        let says = "a result is neither true nor false: use `result.holds`, which is False also where nothing could be assessed";
        Err(pyo3::exceptions::PyTypeError::new_err(says))
    }

    #[getter]
    fn reasons(&self) -> Vec<String> {
        self.found.reasons.iter().map(|reason| reason.text().to_string()).collect()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.found.notes.iter().map(|note| note.text().to_string()).collect()
    }

    /// The bytes of results.json.
    fn json<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let found = Arc::clone(&self.found);
        PyBytes::new(py, py.detach(|| text(&*found)).as_bytes())
    }

    /// One row for each statistic of each quantity.
    #[getter]
    fn summary(&self) -> Table {
        let all: Vec<(&QuantityResult, &StatisticResult)> = self
            .found
            .quantities
            .iter()
            .flat_map(|q| q.statistics.iter().map(move |s| (q, s)))
            .collect();
        let text = |of: &dyn Fn(&QuantityResult, &StatisticResult) -> Option<String>| -> ArrayRef {
            Arc::new(all.iter().map(|(q, s)| of(q, s)).collect::<StringArray>())
        };
        let number = |of: &dyn Fn(&StatisticResult) -> Option<f64>| -> ArrayRef {
            Arc::new(all.iter().map(|(_, s)| of(s)).collect::<Float64Array>())
        };
        let count = |of: &dyn Fn(&StatisticResult) -> usize| -> ArrayRef {
            Arc::new(all.iter().map(|(_, s)| Some(of(s) as u64)).collect::<UInt64Array>())
        };
        Table::new(vec![
            ("quantity", text(&|q, _| Some(q.id.clone()))),
            ("statistic", text(&|_, s| Some(s.name.to_string()))),
            ("scope", text(&|_, s| Some(s.scope.to_string()))),
            ("unit", text(&|_, s| Some(s.unit.clone()))),
            ("pairs", count(&|s| s.count)),
            ("n", count(&|s| s.n)),
            ("value", number(&|s| s.value)),
            ("low", number(&|s| s.interval.map(|(low, _)| low))),
            ("high", number(&|s| s.interval.map(|(_, high)| high))),
            ("limit", number(&|s| s.limit)),
            ("ratio", number(&|s| s.normalised)),
            ("holds", Arc::new(all.iter().map(|(_, s)| s.holds).collect::<BooleanArray>())),
            ("reason", text(&|_, s| s.reason.as_ref().map(|reason| reason.text().to_string()))),
        ])
    }

    /// One row for each value that is compared or assessed.
    #[getter]
    fn values(&self) -> Table {
        let all: Vec<(&QuantityResult, &PairValue)> = self
            .found
            .quantities
            .iter()
            .flat_map(|q| q.values.iter().map(move |v| (q, v)))
            .collect();
        let text = |of: &dyn Fn(&QuantityResult, &PairValue) -> Option<String>| -> ArrayRef {
            Arc::new(all.iter().map(|(q, v)| of(q, v)).collect::<StringArray>())
        };
        let number = |of: &dyn Fn(&PairValue) -> Option<f64>| -> ArrayRef {
            Arc::new(all.iter().map(|(_, v)| of(v)).collect::<Float64Array>())
        };
        Table::new(vec![
            ("quantity", text(&|q, _| Some(q.id.clone()))),
            ("unit", text(&|q, _| Some(q.unit.clone()))),
            ("campaign", text(&|_, v| v.campaign.clone())),
            ("section", text(&|_, v| Some(v.section.clone()))),
            ("zone", text(&|_, v| v.zone.clone())),
            ("signal", text(&|_, v| Some(v.signal.clone()))),
            ("record", text(&|_, v| v.record.as_ref().map(ToString::to_string))),
            ("simulated", number(&|v| v.simulated)),
            ("measured", number(&|v| v.measured)),
            ("difference", number(&|v| Some(v.difference))),
        ])
    }

    /// One row for each section: whether it is used, and why not.
    #[getter]
    fn sections(&self) -> Table {
        let all = &self.found.sections;
        Table::new(vec![
            (
                "section",
                Arc::new(all.iter().map(|s| Some(s.section.as_str())).collect::<StringArray>()),
            ),
            ("zone", Arc::new(all.iter().map(|s| s.zone.as_deref()).collect::<StringArray>())),
            ("used", Arc::new(all.iter().map(|s| Some(s.used)).collect::<BooleanArray>())),
            (
                "reason",
                Arc::new(
                    all.iter()
                        .map(|s| s.reason.as_ref().map(|reason| reason.text().to_string()))
                        .collect::<StringArray>(),
                ),
            ),
        ])
    }

    /// All tables of the report by name.
    fn tables(&self, py: Python<'_>) -> PyResult<Vec<(String, Table)>> {
        let all = tables::certification(&self.found).map_err(|error| {
            raised(py, &Problems(vec![Problem::error("table", error.to_string())]))
        })?;
        Ok(all
            .into_iter()
            .map(|(name, bytes)| (name.trim_end_matches(".csv").to_string(), of_csv(&bytes)))
            .collect())
    }

    /// The figures of the report as SVG, by name.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = Arc::clone(&self.found);
        let drawn = PyDict::new(py);
        for (name, svg) in py.detach(|| figure::figures(&found)) {
            drawn.set_item(name, svg)?;
        }
        Ok(drawn)
    }

    /// Writes the report, all files or none.
    #[pyo3(signature = (out, *, pdf = None, html = true))]
    fn write(&self, py: Python<'_>, out: PathBuf, pdf: Option<bool>, html: bool) -> PyResult<()> {
        let pdf = pdf.unwrap_or(TYPESETS);
        let found = Arc::clone(&self.found);
        written(py, out, move || deliver::certification(&found, Reports { pdf, html }))
    }

    fn __repr__(&self) -> String {
        format!(
            "<fishplate.Result {:?}: {}>",
            self.found.campaign.name,
            self.found.verdict_in_words()
        )
    }

    fn _repr_html_(&self) -> String {
        let found = &self.found;
        let title = format!("{}: {}", found.campaign.name, found.protocol.title);
        let holds = match found.verdict {
            Verdict::Validated => Some(true),
            Verdict::NotValidated => Some(false),
            Verdict::NotAssessable => None,
        };
        let chart = if found.quantities.is_empty() {
            String::new()
        } else {
            html::figure(
                &figure::overview(&found.quantities),
                "Every statistic divided by its limit",
            )
        };
        let names: Vec<String> =
            ["quantity", "statistic", "scope", "n", "value", "limit", "unit", "ratio", ""]
                .map(str::to_string)
                .to_vec();
        let number = |value: Option<f64>| {
            value.map_or_else(
                || "–".to_string(),
                |value| fishplate::report::number::significant(value, 4),
            )
        };
        let mut rows = Vec::new();
        for quantity in &found.quantities {
            for s in &quantity.statistics {
                let word = match s.holds {
                    Some(true) => "met",
                    Some(false) => "not met",
                    None => "not assessable",
                };
                let (value, limit, ratio) =
                    (number(s.value), number(s.limit), number(s.normalised));
                let cells = [
                    &quantity.id,
                    &s.title,
                    &s.scope.to_string(),
                    &s.n.to_string(),
                    &value,
                    &limit,
                    &s.unit,
                    &ratio,
                    &word.to_string(),
                ];
                rows.push(cells.map(Clone::clone).to_vec());
            }
        }
        let (shown, all) = (rows.len().min(MOST_SHOWN), rows.len());
        let note = (all > shown).then(|| format!("{all} rows; all are in `result.summary`"));
        html::head(&title, holds, &found.verdict_in_words(), &self.reasons())
            + &chart
            + &html::table(&names, &rows[..shown], note)
    }
}

/// Rows of the table of statistics that a notebook shows: a protocol by group has thousands.
const MOST_SHOWN: usize = 60;

/// Makes and writes a set of files, all or none.
pub fn written(
    py: Python<'_>,
    out: PathBuf,
    files: impl FnOnce() -> std::result::Result<Files, Problems> + Send + 'static,
) -> PyResult<()> {
    let done = work::run(py, None, move |_| {
        let files = files()?;
        let mut outputs = Outputs::of(SetKind::Report, &out);
        let added = files.iter().try_for_each(|(name, bytes)| outputs.add(name, bytes));
        added.and_then(|()| outputs.commit()).map_err(|problem| Problems(vec![problem]))
    })?;
    done.map_err(|problems| raised(py, &problems))
}
