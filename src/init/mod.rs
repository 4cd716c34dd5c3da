//! The first draft of a protocol and an empty campaign: from a list of channels, and from what a
//! protocol needs.

pub mod campaign;
pub mod channels;
pub mod protocol;

use minijinja::{Environment, UndefinedBehavior, Value};
use serde_json::Value as Json;

use crate::problem::{Problem, problem};
use crate::words;

/// A file of the draft: its path inside the folder, and its text.
pub type File = (String, String);

/// Fills a template with texts, as they are.
pub(crate) fn filled(template: &str, data: &Json) -> Result<String, Problem> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    let text = engine
        .render_str(template, value(data))
        .map_err(|error| problem!("internal", "a template cannot be filled: {error}"))?;
    Ok(text.trim_end().to_owned() + "\n")
}

fn value(data: &Json) -> Value {
    words::value(data, value)
}
