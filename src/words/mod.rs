//! The table of texts: what results say in words. A value of a result is data with a `code`; the
//! table has a text for each code, with the fields of the value in braces. A value inside another
//! one is put in as its own text. Another language is another table.

mod number;

pub use number::digits;

use std::{collections::BTreeMap, fmt, sync::LazyLock};

use minijinja::{Environment, Value};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

/// English: `code: text` in each line; a line that begins with two blanks continues the one before.
const ENGLISH: &str = include_str!("en.txt");

/// A printed text. It can be shown and written, but not looked into: what a result means is in its
/// data.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Text(String);

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

impl From<Text> for String {
    fn from(text: Text) -> Self {
        text.0
    }
}

/// The texts of a language by their codes.
fn read(table: &str) -> BTreeMap<&str, String> {
    let (mut texts, mut last) = (BTreeMap::<&str, String>::new(), "");
    for line in table.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if let Some(more) = line.strip_prefix("  ") {
            texts.entry(last).or_default().push_str(more);
        } else if let Some((code, text)) = line.split_once(": ") {
            last = code;
            texts.insert(last, text.to_owned());
        }
    }
    texts
}

/// Fills texts. Each is compiled when it is first used.
static FILLER: LazyLock<Environment<'static>> = LazyLock::new(|| {
    let texts = read(ENGLISH);
    let mut filler = Environment::new();
    filler.set_loader(move |code| Ok(texts.get(code).cloned()));
    filler.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
    filler.set_formatter(|out, state, value| match value.is_integer() || !value.is_number() {
        true => minijinja::escape_formatter(out, state, value),
        false => Ok(write!(out, "{}", f64::try_from(value.clone())?)?),
    });
    filler.add_filter("digits", number::digits);
    filler.add_filter("fixed", number::fixed);
    filler.add_filter("significant", number::significant);
    filler.add_filter("apart", number::apart);
    filler.add_filter("unit", |unit: &str| match unit {
        "-" | "" => String::new(),
        unit => format!(" {unit}"),
    });
    filler.add_filter("count", |count: usize, none: &str, one: &str, many: &str| match count {
        0 => none.to_owned(),
        1 => one.to_owned(),
        _ => many.replace('#', &count.to_string()),
    });
    filler.add_filter("listed", |names: Vec<String>, most: usize, more: &str| {
        let rest = names.len().saturating_sub(most);
        let more = if rest == 0 { String::new() } else { more.replace('#', &rest.to_string()) };
        names[..names.len() - rest].join(", ") + &more
    });
    filler
});

/// The text of a value of a result: of its code, with its fields put in.
pub fn text(of: &impl Serialize) -> Text {
    Text(filled(&serde_json::to_value(of).unwrap_or_default()).to_string())
}

/// The text of a value of a result, or nothing.
pub fn or_nothing(of: Option<&impl Serialize>) -> String {
    of.map_or_else(String::new, |of| text(of).into())
}

/// The texts of data as they are in a file: of one value, of each of a list, or of nothing.
pub fn texts(data: &Json) -> Json {
    match data {
        Json::Array(all) => all.iter().map(texts).collect(),
        Json::Null => Json::Null,
        one => Json::String(filled(one).to_string()),
    }
}

/// A value with a code becomes its text; the parts of others stay as they are.
fn filled(data: &Json) -> Value {
    let inner = value(data, filled);
    match data.get("code").and_then(Json::as_str) {
        Some(code) => Value::from(
            FILLER
                .get_template(code)
                .and_then(|text| text.render(inner))
                // A test fills the text of every code.
                .unwrap_or_else(|_| data.to_string()),
        ),
        None => inner,
    }
}

/// Data as a value of the template engine, of parts that are made by `part`.
pub fn value(data: &Json, part: fn(&Json) -> Value) -> Value {
    match data {
        Json::Null => Value::from(()),
        Json::Bool(truth) => Value::from(*truth),
        Json::Number(number) => {
            number.as_i64().map_or_else(|| Value::from(number.as_f64()), Value::from)
        }
        Json::String(text) => Value::from(text.as_str()),
        Json::Array(items) => Value::from(items.iter().map(part).collect::<Vec<_>>()),
        Json::Object(map) => {
            Value::from_pairs(map.iter().map(|(key, item)| (key.clone(), part(item))))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use serde::de::DeserializeOwned;

    use super::*;
    use crate::result::{
        Channels, FindingData, Reason, Remark, Sections, Statement, Unmatched, VehicleValue,
    };

    /// A value for a field, whatever its type: the first that fits.
    const FITS: [&str; 15] = [
        "3",
        "\"word\"",
        "true",
        "2.5",
        "[\"a\", \"b\"]",
        "{\"code\": \"sections\", \"names\": [\"S01\"], \"all\": false}",
        "{\"code\": \"channels\", \"names\": [\"Y\"]}",
        "{\"code\": \"no-value\"}",
        "{\"code\": \"said\", \"says\": \"word\"}",
        "\"section\"",
        "[{\"name\": \"a\", \"value\": \"1\", \"unit\": \"m\", \"by\": -1.5, \"verdict\": \"a\", \"word\": \"b\", \"zone\": \"1\", \"used\": 2, \"section\": \"S\", \"reason\": \"c\", \"title\": \"a\", \"channel\": \"Y\", \"dynamic\": true, \"default\": \"2\", \"set_by\": \"campaign\", \"records\": \"a\", \"campaign\": \"b\", \"offset\": 1.5, \"channels\": [\"Y\"]}]",
        "[{\"vehicle\": \"a\", \"value\": {\"code\": \"si\", \"value\": 2.0}}]",
        "[]",
        "{\"code\": \"nothing-to-confirm\"}",
        "\"slope\"",
    ];

    /// Words in backticks of an error: the variants, or the field that is missing.
    fn quoted(error: &serde_json::Error) -> Vec<String> {
        error.to_string().split('`').skip(1).step_by(2).map(str::to_owned).collect()
    }

    /// An example of each variant, as its data.
    fn examples<T: DeserializeOwned + Serialize>() -> Vec<Json> {
        let unknown = serde_json::json!({ "code": "?" });
        let codes = quoted(&serde_json::from_value::<T>(unknown).err().expect("no such code"));
        let example = |code: &String| {
            let mut fields = serde_json::Map::from_iter([("code".into(), code.as_str().into())]);
            loop {
                let error = match serde_json::from_value::<T>(fields.clone().into()) {
                    Ok(found) => return serde_json::to_value(found).expect("data"),
                    Err(error) => error,
                };
                let field = quoted(&error).pop().unwrap_or_else(|| panic!("{code}: {error}"));
                let fits = FITS.iter().find(|value| {
                    fields.insert(field.clone(), serde_json::from_str(value).expect("JSON"));
                    let next = serde_json::from_value::<T>(fields.clone().into()).err();
                    next.is_none_or(|next| {
                        let missing = next.to_string().starts_with("missing field");
                        // The code that a value inside this one has not.
                        let next = quoted(&next).pop();
                        missing && next.is_some_and(|next| next != field && next != "code")
                    })
                });
                assert!(fits.is_some(), "{code}: no value fits {field}: {error}");
            }
        };
        codes[1..].iter().map(example).collect()
    }

    /// Each variant has a text, each text is of a variant or part of a text, and names only fields
    /// that its variant has; so every text can be filled.
    #[test]
    fn every_variant_has_a_text_with_its_fields() {
        let mut all = examples::<Reason>();
        all.extend(examples::<FindingData>());
        all.extend(examples::<Remark>());
        all.extend(examples::<Statement>());
        all.extend(examples::<Unmatched>());
        all.extend(examples::<VehicleValue>());
        all.push(serde_json::to_value(Sections::of(&["S01"], 2)).expect("data"));
        all.push(serde_json::json!({
            "code": "own-protocol", "extends": "a", "changed": 1, "relaxed": ["b"], "taken": null,
        }));
        all.push(serde_json::to_value(Channels::of(&["Y"])).expect("data"));
        all.push(serde_json::json!({
            "code": "suspected-factor", "by": 9.8, "of_unit": true, "units": ["kgf", "N"], "inverse": true,
        }));
        let mut used: BTreeSet<String> =
            ["and", "times-simulated", "titled", "usable-sections"].map(String::from).into();
        for example in &all {
            let code = example["code"].as_str().expect("a code");
            used.insert(code.to_owned());
            let template = FILLER.get_template(code).unwrap_or_else(|_| panic!("no text: {code}"));
            let fields: BTreeSet<&str> =
                example.as_object().expect("fields").keys().map(String::as_str).collect();
            // An option without a value is a field all the same.
            for name in template.undeclared_variables(false).into_iter().collect::<BTreeSet<_>>() {
                assert!(fields.contains(name.as_str()), "{code} has no {name}");
            }
            let rendered = template.render(match example {
                Json::Object(fields) => {
                    Value::from_pairs(fields.iter().map(|(key, item)| (key.clone(), filled(item))))
                }
                _ => Value::from(()),
            });
            let text = rendered.unwrap_or_else(|error| panic!("{code}: {error:#}"));
            assert!(!text.trim().is_empty() && !text.contains("  "), "{code}: {text}");
        }
        let texts: BTreeSet<String> = read(ENGLISH).into_keys().map(str::to_owned).collect();
        assert_eq!(used, texts);
    }
}
