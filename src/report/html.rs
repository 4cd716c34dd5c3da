//! The HTML report: one self-contained file, filled by minijinja from
//! `templates/report.html`.
//!
//! User text is data: it is escaped by the engine, and hidden characters are made visible. The
//! page's policy allows only its own style and script, by their hashes, so that even a fault in
//! escaping could neither execute code nor load anything.

use std::collections::BTreeMap;

use base64::{Engine, engine::general_purpose::STANDARD};
use minijinja::{Environment, UndefinedBehavior, Value, context, syntax::SyntaxConfig};
use serde_json::Value as Json;

use crate::hash::sha256_base64;
use crate::problem::{Problem, Problems};
use crate::report::{
    document::{Document, Medium},
    visible::visible,
};
use crate::words;

const PAGE: &str = include_str!("../../templates/report.html");
const CSS: &str = include_str!("../../templates/report.css");
const SCRIPT: &str = include_str!("../../templates/report.js");

/// Name of the figure of the processing graph.
const GRAPH: &str = "graph";

/// A document as one HTML page.
///
/// `figures` are SVG texts of this program by their names in the document
/// ([`super::document::Figure::name`]); a missing figure is omitted. The same arguments give the
/// same bytes.
///
/// # Errors
///
/// `report-template`: the template cannot be filled.
pub fn html(document: &Document, figures: &[(String, String)]) -> Result<String, Problems> {
    filled(document, figures).map_err(|error| Problem::error("report-template", error).into())
}

fn filled(document: &Document, figures: &[(String, String)]) -> Result<String, String> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_syntax(
        SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build().map_err(said)?,
    );
    environment.add_template("report.html", PAGE).map_err(said)?;
    let data =
        serde_json::to_value(document.on(Medium::Screen)).map_err(|error| error.to_string())?;
    // The graph is wide and has its own styles: an embedded image keeps both apart from the page.
    let drawing = |(name, svg): &(String, String)| {
        let drawing = if name == GRAPH {
            format!("data:image/svg+xml;base64,{}", STANDARD.encode(svg)).into()
        } else {
            Value::from_safe_string(svg.trim_end().to_owned())
        };
        (name.clone(), drawing)
    };
    let drawn: BTreeMap<String, Value> = figures.iter().map(drawing).collect();
    let page = environment.get_template("report.html").map_err(said)?;
    page.render(context! {
        data => shown(&data),
        figures => drawn,
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
        Json::String(text) => Value::from(visible(text)),
        other => words::value(other, shown),
    }
}
