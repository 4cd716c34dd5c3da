//! The PDF report, typeset by Typst from `templates/`.
//!
//! User text is passed to the templates as data (`/data.json`), never as markup, so that it cannot
//! be executed. The program reads nothing from outside: fonts and templates are embedded, and
//! neither clock nor network is used.

mod date;
mod text;
mod world;

use serde_json::{Value, json};
use typst::{diag::SourceDiagnostic, foundations::Smart};
use typst_layout::PagedDocument;
use typst_pdf::{PdfOptions, PdfStandard, PdfStandards, Timestamp};

use crate::hash::Hasher;
use crate::problem::{Problem, Problems};
use crate::report::{
    document::{Document, Medium},
    pdf::{Attachment, Pdf},
};
use text::Printable;
use world::Files;

/// Typesets a document as PDF/A-3a and PDF/UA-1.
///
/// `figures` are SVG texts by their names in the document ([`super::document::Figure::name`]); a
/// missing figure is omitted. The same arguments give the same bytes.
///
/// # Errors
///
/// `report-template`: Typst refuses the template or a figure.
/// `report-attachment`: a name is not a file name.
pub fn typeset(
    document: &Document,
    figures: &[(String, String)],
    attachments: &[Attachment<'_>],
) -> Result<Pdf, Problems> {
    let printable = Printable::of(world::fonts());
    let mut files = Files::new();
    let mut value = serde_json::to_value(document.on(Medium::Paper))
        .map_err(|error| Problem::error("report-template", error.to_string()))?;
    printable.clean(&mut value);
    let mut drawn = serde_json::Map::new();
    for (at, (name, svg)) in figures.iter().enumerate() {
        let path = format!("/figures/{at}.svg");
        files.add(&path, printable.svg(svg).into_bytes())?;
        drawn.insert(name.clone(), Value::String(path));
    }
    let mut attached = Vec::new();
    for attachment in attachments {
        if attachment.name.is_empty() || attachment.name.contains(['/', '\\']) {
            let says = format!("`{}` is not a file name", attachment.name);
            return Err(Problem::error("report-attachment", says).into());
        }
        let path = format!("/attached/{}", attachment.name);
        files.add(&path, attachment.bytes.to_vec())?;
        attached.push(json!({"path": path, "name": attachment.name, "mime": attachment.mime, "description": attachment.description}));
    }
    if let Value::Object(map) = &mut value {
        map.insert("figures".into(), Value::Object(drawn));
        map.insert("attachments".into(), Value::Array(attached));
    }
    files.add("/data.json", value.to_string().into_bytes())?;
    let ident = ident(&value, figures, attachments);
    let issued = document.issued.as_deref().and_then(date::issued);
    let pdf = compile(&files, ident, issued);
    // Typst's caches are global and would keep the data of all reports.
    typst::comemo::evict(0);
    pdf
}

fn compile(files: &Files, ident: String, issued: Option<Timestamp>) -> Result<Pdf, Problems> {
    let compiled = typst::compile::<PagedDocument>(files);
    let warnings = Problems(compiled.warnings.iter().map(|found| problem(found, files)).collect());
    let refuse = |errors: &[SourceDiagnostic]| {
        Problems(errors.iter().map(|found| problem(found, files)).collect())
    };
    let document = compiled.output.map_err(|errors| refuse(&errors))?;
    let standards = PdfStandards::new(&[PdfStandard::A_3a, PdfStandard::Ua_1])
        .map_err(|error| Problem::error("report-template", error.message().to_string()))?;
    let options = PdfOptions {
        ident: Smart::Custom(ident),
        creator: Smart::Custom(Some(concat!("Fishplate ", env!("CARGO_PKG_VERSION")).to_owned())),
        timestamp: issued.or_else(date::placeholder),
        standards,
        ..PdfOptions::default()
    };
    let mut bytes = typst_pdf::pdf(&document, &options).map_err(|errors| refuse(&errors))?;
    if issued.is_none() {
        date::remove_placeholder(&mut bytes);
    }
    Ok(Pdf { bytes, pages: document.pages().len(), warnings })
}

/// Document identifier: the hash of all inputs.
fn ident(value: &Value, figures: &[(String, String)], attachments: &[Attachment<'_>]) -> String {
    let mut hash = Hasher::default();
    let mut part = |bytes: &[u8]| {
        hash.add(&(bytes.len() as u64).to_le_bytes());
        hash.add(bytes);
    };
    part(value.to_string().as_bytes());
    for (name, svg) in figures {
        part(name.as_bytes());
        part(svg.as_bytes());
    }
    for attachment in attachments {
        part(attachment.name.as_bytes());
        part(attachment.bytes);
    }
    hash.finish()
}

/// An error of Typst with its place in the template. Templates are part of the program, so no user
/// text is underlined.
fn problem(found: &SourceDiagnostic, files: &Files) -> Problem {
    let mut says = found.message.to_string();
    if let Some(place) = files.place(found.span) {
        says.push_str(&format!(" ({place})"));
    }
    let made = match found.severity {
        typst::diag::Severity::Error => Problem::error("report-template", says),
        typst::diag::Severity::Warning => Problem::warning("report-template", says),
    };
    match found.hints.first() {
        Some(hint) => made.help(hint.v.to_string()),
        None => made,
    }
}
