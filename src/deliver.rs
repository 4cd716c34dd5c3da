//! The files that a result is delivered as: numbers, tables, and the report as PDF and HTML. Each
//! has its path inside the output folder.

use std::{panic::resume_unwind, thread};

use crate::diagnose::Outcome;
use crate::problem::{Problem, Problems};
use crate::provenance::{
    carried::{REPORT_HTML, REPORT_PDF},
    statement,
};
use crate::report::{
    self, attached, document::Document, figure, html, pdf::Attachment, tables, typst, view,
};
use crate::result::{self, Certification, comparison::Comparison, impact::Impact, study::Study};

/// Paths and contents.
pub type Files = Vec<(String, Vec<u8>)>;

/// The forms of a report that are wanted.
#[derive(Clone, Copy, Debug)]
pub struct Reports {
    pub pdf: bool,
    pub html: bool,
}

impl Reports {
    pub const ALL: Self = Self { pdf: true, html: true };
    pub const NONE: Self = Self { pdf: false, html: false };
}

/// # Errors
/// A table, a template or a text cannot be written.
pub fn certification(found: &Certification, reports: Reports) -> Result<Files, Problems> {
    let (results, tables) = rayon::join(|| result::text(found), || tables::certification(found));
    let mut files = in_folder(tables)?;
    if reports.pdf || reports.html {
        let data = view::document(found);
        let figures = figure::figures(found);
        let pdf = || {
            let attachments = attached::attachments(found, &results);
            Ok(typst::typeset(&data, &figures, &attachments)?.bytes)
        };
        files.extend(both(reports, pdf, || html::html(&data, &figures))?);
    }
    files.push((attached::RESULTS.into(), results.into_bytes()));
    files.push((statement::FILE.into(), statement::statement(found, &files).into_bytes()));
    Ok(files)
}

/// # Errors
/// As [`certification`].
pub fn study(found: &Study, reports: Reports) -> Result<Files, Problems> {
    let tables = in_folder(tables::study(found))?;
    let (data, figures) = (report::study::document(found), report::study::figures(found));
    let name = ("study.json", "Every number of this study");
    document(name, result::text(found), &data, &figures, reports, tables)
}

/// # Errors
/// As [`certification`].
pub fn comparison(found: &Comparison, reports: Reports) -> Result<Files, Problems> {
    let tables = in_folder(tables::comparison(found))?;
    let (data, figures) = (report::comparison::document(found), report::comparison::figures(found));
    let name = ("comparison.json", "Every number of this comparison");
    document(name, result::text(found), &data, &figures, reports, tables)
}

/// # Errors
/// As [`certification`].
pub fn impact(found: &Impact, reports: Reports) -> Result<Files, Problems> {
    let tables = in_folder(tables::impact(found))?;
    let name = ("impact.json", "Every number of this report");
    let data = report::impact::document(found);
    document(name, result::text(found), &data, &[], reports, tables)
}

/// # Errors
/// As [`certification`].
pub fn diagnosis(outcome: &Outcome, reports: Reports) -> Result<Files, Problems> {
    let found = &outcome.diagnosis;
    let (data, figures) =
        (report::diagnosis::document(found, &outcome.before), report::diagnosis::figures(found));
    let name = ("diagnosis.json", "Every number of this diagnosis");
    document(name, result::text(found), &data, &figures, reports, Files::new())
}

/// Tables, a document as report.pdf with its numbers attached, as report.html, and the numbers as
/// `name`.
///
/// # Errors
/// A template or a text cannot be typeset.
pub fn document(
    (name, description): (&'static str, &'static str),
    numbers: String,
    data: &Document,
    figures: &[(String, String)],
    reports: Reports,
    mut files: Files,
) -> Result<Files, Problems> {
    let pdf = || {
        let attachment =
            Attachment { name, mime: "application/json", bytes: numbers.as_bytes(), description };
        Ok(typst::typeset(data, figures, &[attachment])?.bytes)
    };
    files.extend(both(reports, pdf, || html::html(data, figures))?);
    files.push((name.into(), numbers.into_bytes()));
    Ok(files)
}

/// The reports that are wanted, PDF and HTML at the same time: typesetting keeps one processor
/// busy.
fn both(
    reports: Reports,
    pdf: impl FnOnce() -> Result<Vec<u8>, Problems>,
    html: impl FnOnce() -> Result<String, Problems> + Send,
) -> Result<Files, Problems> {
    thread::scope(|scope| {
        let html = reports.html.then(|| scope.spawn(html));
        let pdf = reports.pdf.then(pdf).transpose();
        let html =
            html.map(|html| html.join().unwrap_or_else(|panic| resume_unwind(panic))).transpose();
        let pdf = pdf?.map(|bytes| (REPORT_PDF.into(), bytes));
        Ok(pdf
            .into_iter()
            .chain(html?.map(|text| (REPORT_HTML.into(), text.into_bytes())))
            .collect())
    })
}

/// Tables in the folder `tables`.
fn in_folder(tables: Result<Files, csv::Error>) -> Result<Files, Problems> {
    let tables = tables.map_err(|error| Problem::error("table", error.to_string()))?;
    Ok(tables.into_iter().map(|(name, bytes)| (format!("tables/{name}"), bytes)).collect())
}
