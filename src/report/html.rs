//! The HTML report: one self-contained file, filled by minijinja from `templates/`.
//!
//! User text is data: it is escaped by the engine, and hidden characters are made visible. The
//! page's policy allows only its own style and script, by their hashes, so that even a fault in
//! escaping could neither execute code nor load anything.

mod symbols;

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, UndefinedBehavior, Value, context};
use serde::Serialize;
use serde_json::Value as Json;

use crate::hash::sha256_base64;
use crate::problem::{Problem, Problems};
use crate::report::study::{Chapter, Document};
use crate::report::view::ReportData;
use crate::report::visible::visible;

const CSS: &str = include_str!("../../templates/html/report.css");
const SCRIPT: &str = include_str!("../../templates/html/report.js");

const TEMPLATES: [(&str, &str); 21] = [
    ("chapters.html", include_str!("../../templates/chapters.html")),
    ("html/chapters.html", include_str!("../../templates/html/chapters.html")),
    ("report.html", include_str!("../../templates/report.html")),
    ("study.html", include_str!("../../templates/study.html")),
    ("html/study.html", include_str!("../../templates/html/study.html")),
    ("html/macros.html", include_str!("../../templates/html/macros.html")),
    ("html/navigation.html", include_str!("../../templates/html/navigation.html")),
    ("html/cover.html", include_str!("../../templates/html/cover.html")),
    ("html/verdicts.html", include_str!("../../templates/html/verdicts.html")),
    ("html/judgements.html", include_str!("../../templates/html/judgements.html")),
    ("html/identity.html", include_str!("../../templates/html/identity.html")),
    ("html/notation.html", include_str!("../../templates/html/notation.html")),
    ("html/summary.html", include_str!("../../templates/html/summary.html")),
    ("html/vehicle.html", include_str!("../../templates/html/vehicle.html")),
    ("html/sections.html", include_str!("../../templates/html/sections.html")),
    ("html/quantities.html", include_str!("../../templates/html/quantities.html")),
    ("html/traces.html", include_str!("../../templates/html/traces.html")),
    ("html/domain.html", include_str!("../../templates/html/domain.html")),
    ("html/protocol.html", include_str!("../../templates/html/protocol.html")),
    ("html/provenance.html", include_str!("../../templates/html/provenance.html")),
    ("html/statements.html", include_str!("../../templates/html/statements.html")),
];

/// Name of the figure of the processing graph.
const GRAPH: &str = "graph";

/// The report as one HTML page.
///
/// `figures` are SVG texts of this program by their names in the view
/// ([`super::view::FigureView::name`]); a missing figure is omitted. The same arguments give the
/// same bytes.
///
/// # Errors
///
/// `report-template`: a template cannot be filled.
pub fn html(data: &ReportData, figures: &[(String, String)]) -> Result<String, Problems> {
    filled("report.html", data, figures)
        .map_err(|error| Problems(vec![Problem::error("report-template", error)]))
}

/// A study as one HTML page.
///
/// # Errors
///
/// As [`html`].
pub fn study_html(data: &Document, figures: &[(String, String)]) -> Result<String, Problems> {
    filled("study.html", data, figures)
        .map_err(|error| Problems(vec![Problem::error("report-template", error)]))
}

/// Chapters under a title as one HTML page.
///
/// # Errors
///
/// As [`html`].
pub fn chapters_html(title: &str, chapters: &[Chapter]) -> Result<String, Problems> {
    #[derive(Serialize)]
    struct Page<'a> {
        title: &'a str,
        chapters: &'a [Chapter],
        symbols: [String; 0],
    }
    filled("chapters.html", &Page { title, chapters, symbols: [] }, &[])
        .map_err(|error| Problems(vec![Problem::error("report-template", error)]))
}

fn filled(
    frame: &str,
    data: &impl Serialize,
    figures: &[(String, String)],
) -> Result<String, String> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_syntax(
        SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build().map_err(said)?,
    );
    environment
        .add_filter("symbol", |text: String| Value::from_safe_string(symbols::typeset(&text)));
    environment.add_filter("symbols", |text: String, known: Vec<String>| {
        Value::from_safe_string(symbols::typeset_in(&text, &known))
    });
    for (name, text) in TEMPLATES {
        environment.add_template(name, text).map_err(said)?;
    }
    let data = serde_json::to_value(data).map_err(|error| error.to_string())?;
    let drawn: BTreeMap<&str, Value> = figures
        .iter()
        .filter(|(name, _)| name != GRAPH)
        .map(|(name, svg)| (name.as_str(), Value::from_safe_string(svg.trim_end().to_owned())))
        .collect();
    // The graph is wide and has its own styles: an embedded image keeps both apart from the page.
    let graph = figures
        .iter()
        .find(|(name, _)| name == GRAPH)
        .map(|(_, svg)| format!("data:image/svg+xml;base64,{}", STANDARD.encode(svg)));
    let page = environment.get_template(frame).map_err(said)?;
    page.render(context! {
        data => shown(&data),
        figures => drawn,
        graph,
        css => Value::from_safe_string(CSS.to_owned()),
        script => Value::from_safe_string(SCRIPT.to_owned()),
        policy => policy(),
    })
    .map_err(said)
}

/// The message with its place in the template.
fn said(error: minijinja::Error) -> String {
    match (error.name(), error.line()) {
        (Some(name), Some(line)) => format!("{error} ({name}:{line})"),
        _ => error.to_string(),
    }
}

/// Content security policy: only the page's own style and script, identified by their hashes, and
/// embedded images are allowed.
fn policy() -> String {
    let known = |text: &str| format!("'sha256-{}'", sha256_base64(text.as_bytes()));
    format!(
        "default-src 'none'; style-src {}; script-src {}; img-src data:; base-uri 'none'; form-action 'none'",
        known(CSS),
        known(SCRIPT)
    )
}

/// The data as values of the template engine; invisible characters are made visible.
fn shown(value: &Json) -> Value {
    match value {
        Json::Null => Value::from(()),
        Json::Bool(truth) => Value::from(*truth),
        Json::Number(number) => {
            number.as_i64().map_or_else(|| Value::from(number.as_f64()), Value::from)
        }
        Json::String(text) => Value::from(visible(text)),
        Json::Array(items) => Value::from(items.iter().map(shown).collect::<Vec<_>>()),
        Json::Object(map) => {
            Value::from_pairs(map.iter().map(|(key, item)| (key.clone(), shown(item))))
        }
    }
}
