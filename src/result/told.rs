//! Data of results in files: the text under one key, as files had it before there were data, and
//! the data under a key beside it.

use schemars::JsonSchema;
use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error};
use serde::ser::{Error as _, Serialize, Serializer};
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

/// For `#[serde(flatten, with = "told::...")]`.
macro_rules! keys {
    ($($module:ident: $text:literal, $data:literal;)*) => {$(
        pub mod $module {
            use super::*;

            pub fn serialize<S: Serializer>(of: &impl Serialize, to: S) -> Result<S::Ok, S::Error> {
                write(of, [$text, $data], to)
            }

            pub fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
                from: D,
            ) -> Result<T, D::Error> {
                read([$text, $data], from)
            }
        }
    )*};
}

keys! {
    reason: "reason", "reason_data";
    reasons: "reasons", "reasons_data";
    says: "says", "data";
    cause: "cause", "cause_data";
    because: "because", "because_data";
    notes: "notes", "notes_data";
    lacking: "lacking", "lacking_data";
    changes: "verdict_changes", "verdict_changes_data";
    not_used: "not_used", "not_used_data";
}

/// The keys of a field in a schema, for `#[schemars(with = "told::...")]` beside it.
macro_rules! in_schema {
    ($($(#[$of:meta])* pub struct $name:ident<$data:ident> { $($fields:tt)* })*) => {$(
        $(#[$of])*
        #[derive(JsonSchema)]
        #[allow(dead_code, reason = "the schema describes it")]
        pub struct $name<$data> { $($fields)* }
    )*};
}

in_schema! {
    /// A reason, or none.
    pub struct NoneOrReason<R> {
        reason: Option<String>,
        #[schemars(default, skip_serializing_if = "Option::is_none")]
        reason_data: Option<R>,
    }

    /// A reason.
    pub struct OneReason<R> {
        reason: String,
        reason_data: R,
    }

    /// Any number of reasons.
    pub struct Reasons<R> {
        reasons: Vec<String>,
        #[schemars(default, skip_serializing_if = "Vec::is_empty")]
        reasons_data: Vec<R>,
    }

    /// Of each value a reason, or none.
    pub struct EachReason<R> {
        reasons: Vec<Option<String>>,
        #[schemars(default, skip_serializing_if = "Vec::is_empty")]
        reasons_data: Vec<Option<R>>,
    }

    /// What a check or a finding says.
    pub struct Says<D> {
        says: String,
        data: D,
    }

    /// A cause, or none.
    pub struct NoneOrCause<R> {
        cause: Option<String>,
        #[schemars(default, skip_serializing_if = "Option::is_none")]
        cause_data: Option<R>,
    }

    /// Why a factor applies.
    pub struct Because<R> {
        because: String,
        because_data: R,
    }

    /// Any number of remarks.
    pub struct Notes<R> {
        notes: Vec<String>,
        #[schemars(default, skip_serializing_if = "Vec::is_empty")]
        notes_data: Vec<R>,
    }

    /// A remark on what is lacking, or none.
    pub struct NoneOrLacking<R> {
        lacking: Option<String>,
        #[schemars(default, skip_serializing_if = "Option::is_none")]
        lacking_data: Option<R>,
    }

    /// Any number of changes of a verdict.
    pub struct Changes<R> {
        verdict_changes: Vec<String>,
        #[schemars(default, skip_serializing_if = "Vec::is_empty")]
        verdict_changes_data: Vec<R>,
    }

    /// Sections that are not used, each with the reason.
    pub struct NotUsed<R> {
        not_used: Vec<(String, String)>,
        #[schemars(default, skip_serializing_if = "Vec::is_empty")]
        not_used_data: Vec<(String, R)>,
    }
}
