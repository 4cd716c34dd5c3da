//! Data of results in files: the text under one key, as files had it before there were data, and
//! the data under a key beside it.

use schemars::JsonSchema;
use serde::{
    de::{Deserialize, DeserializeOwned, Deserializer, Error},
    ser::{Error as _, Serialize, Serializer},
};
use serde_json::{Map, Value, json};

use crate::words;

/// Writes the texts of some data and, where there are some, the data.
fn write<S: Serializer>(
    of: &impl Serialize,
    [text, data]: [&str; 2],
    to: S,
) -> Result<S::Ok, S::Error> {
    let found = serde_json::to_value(of).map_err(S::Error::custom)?;
    let texts = words::texts(&found);
    let some = !found.is_null() && found.as_array().is_none_or(|all| !all.is_empty());
    to.collect_map([(text, texts)].into_iter().chain(some.then_some((data, found))))
}

/// Reads data, or the texts of a version without data.
fn read<'de, T: DeserializeOwned, D: Deserializer<'de>>(
    [text, data]: [&str; 2],
    from: D,
) -> Result<T, D::Error> {
    let mut fields = Map::deserialize(from)?;
    let found =
        fields.remove(data).unwrap_or_else(|| said(fields.remove(text).unwrap_or(Value::Null)));
    serde_json::from_value(found).map_err(D::Error::custom)
}

fn said(texts: Value) -> Value {
    match texts {
        Value::String(says) => json!({ "code": "said", "says": says }),
        Value::Array(all) => all.into_iter().map(said).collect(),
        other => other,
    }
}

/// For `#[serde(flatten, with = "told::...")]`, and, for `#[schemars(with = "told::...")]` beside it,
/// the keys in a schema. Data may be missing where a function says so.
macro_rules! keys {
    ($($(#[$of:meta])* $module:ident $name:ident<$each:ident> {
        $text:ident: $texts:ty, $data:ident: $all:ty $(, missing if $none:literal)?
    })*) => {$(
        pub mod $module {
            use super::*;

            pub fn serialize<S: Serializer>(of: &impl Serialize, to: S) -> Result<S::Ok, S::Error> {
                write(of, [stringify!($text), stringify!($data)], to)
            }

            pub fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
                from: D,
            ) -> Result<T, D::Error> {
                read([stringify!($text), stringify!($data)], from)
            }
        }

        $(#[$of])*
        #[derive(JsonSchema)]
        #[allow(dead_code, reason = "the schema describes it")]
        pub struct $name<$each> {
            $text: $texts,
            $(#[schemars(default, skip_serializing_if = $none)])?
            $data: $all,
        }
    )*};
}

keys! {
    /// A reason, or none.
    reason NoneOrReason<R> {
        reason: Option<String>, reason_data: Option<R>, missing if "Option::is_none"
    }
    /// Any number of reasons.
    reasons Reasons<R> { reasons: Vec<String>, reasons_data: Vec<R>, missing if "Vec::is_empty" }
    /// What a check or a finding says.
    says Says<D> { says: String, data: D }
    /// Any number of sentences.
    statements Statements<S> {
        says: Vec<String>, says_data: Vec<S>, missing if "Vec::is_empty"
    }
    /// Why a factor applies.
    because Because<R> { because: String, because_data: R }
    /// Any number of remarks.
    notes Notes<R> { notes: Vec<String>, notes_data: Vec<R>, missing if "Vec::is_empty" }
    /// A remark on the verdict, or none.
    verdict_note NoneOrNote<R> {
        verdict_note: Option<String>, verdict_note_data: Option<R>, missing if "Option::is_none"
    }
    /// A remark on what is lacking, or none.
    lacking NoneOrLacking<R> {
        lacking: Option<String>, lacking_data: Option<R>, missing if "Option::is_none"
    }
    /// Any number of changes of a verdict.
    changes Changes<R> {
        verdict_changes: Vec<String>, verdict_changes_data: Vec<R>, missing if "Vec::is_empty"
    }
    /// Sections that are not used, each with the reason.
    not_used NotUsed<R> {
        not_used: Vec<(String, String)>, not_used_data: Vec<(String, R)>,
        missing if "Vec::is_empty"
    }
}

/// Causes, with the likeliest one alone beside them. Files of before have that one alone.
pub mod causes {
    use super::*;

    pub fn serialize<S: Serializer>(of: &impl Serialize, to: S) -> Result<S::Ok, S::Error> {
        let found = serde_json::to_value(of).map_err(S::Error::custom)?;
        let texts = words::texts(&found);
        let data = texts.get(0).is_some().then_some(("causes_data", found));
        let likeliest = texts.get(0).cloned().unwrap_or_default();
        to.collect_map([("cause", likeliest), ("causes", texts)].into_iter().chain(data))
    }

    pub fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
        from: D,
    ) -> Result<T, D::Error> {
        let mut fields = Map::deserialize(from)?;
        let mut only = |key| fields.remove(key).filter(|found| !found.is_null());
        let data = only("causes_data").or_else(|| only("causes").map(said));
        let before = only("cause_data").or_else(|| only("cause").map(said));
        let found = data.unwrap_or_else(|| before.into_iter().collect());
        serde_json::from_value(found).map_err(D::Error::custom)
    }
}

/// Causes, as [`causes`] writes them.
#[derive(JsonSchema)]
#[allow(dead_code, reason = "the schema describes it")]
pub struct Causes<R> {
    cause: Option<String>,
    causes: Vec<String>,
    #[schemars(default, skip_serializing_if = "Vec::is_empty")]
    causes_data: Vec<R>,
}

/// A reason, as [`reason`] writes it where there is always one.
#[derive(JsonSchema)]
#[allow(dead_code, reason = "the schema describes it")]
pub struct OneReason<R> {
    reason: String,
    reason_data: R,
}

/// Of each value a reason, or none, as [`reasons`] writes them.
#[derive(JsonSchema)]
#[allow(dead_code, reason = "the schema describes it")]
pub struct EachReason<R> {
    reasons: Vec<Option<String>>,
    #[schemars(default, skip_serializing_if = "Vec::is_empty")]
    reasons_data: Vec<Option<R>>,
}
