//! Effects of the shipped catalogue, and their form in a truth.

use fishplate::effects::{Applied, Catalogue, choose, read};
use fishplate::problem::Problem;
use fishplate::problem::Problems;
use fishplate::source::Source;
use serde_json::{Map, Value, json};

/// The shipped catalogue.
///
/// # Errors
/// The catalogue cannot be read.
pub fn catalogue() -> Result<Catalogue, String> {
    let known = &fishplate::library::CATALOGUES[0];
    let find = |name: &str, _: &Source| Err(Problem::error("unknown", name));
    let mut problems = Problems::default();
    read(
        &Source::new(known.name, known.text),
        &find,
        &fishplate::simulate::model_parameters(),
        &mut problems,
    )
    .ok_or_else(|| "the catalogue cannot be read".to_string())
}

/// Effects as on a command line.
///
/// # Errors
/// An effect is not valid; a message.
pub fn chosen(catalogue: &Catalogue, texts: &[String]) -> Result<Vec<Applied>, String> {
    choose(catalogue, texts).map_err(|problems| {
        problems.iter().map(|problem| problem.says.clone()).collect::<Vec<_>>().join("; ")
    })
}

/// An effect in the form of `truth.json`.
pub fn told(applied: &Applied) -> Value {
    let mut parameters = Map::new();
    if applied.effect == "channel_swap" {
        parameters.insert("measurement.swap".into(), json!([applied.channels]));
    }
    for (name, value) in applied.values.iter().filter(|_| applied.effect != "channel_swap") {
        if name.contains("<channel>") {
            applied.channels.iter().for_each(|channel| {
                drop(parameters.insert(name.replace("<channel>", channel), json!(value)))
            });
        } else {
            parameters.insert(name.clone(), json!(value));
        }
    }
    let mut effect = json!({"name": applied.effect, "parameters": parameters});
    if let Some(confined) = &applied.confined {
        let (key, value) = match confined.column.as_str() {
            "zone" => (
                "zones",
                json!(
                    confined
                        .values
                        .iter()
                        .filter_map(|value| value.parse::<i64>().ok())
                        .collect::<Vec<_>>()
                ),
            ),
            "section" => ("sections", json!(confined.values)),
            _ => ("direction", json!(confined.values[0])),
        };
        effect[key] = value;
    }
    effect
}
