//! What a statistic is of: which statistic, of which values, of which record.

use std::{fmt, sync::Arc};

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The values or sections that an estimate is of.
///
/// In files `scope` is its text, and `scope_data` the same as data.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(into = "ScopeInFile", from = "ScopeInFile")]
pub struct Scope {
    /// Only values of these zones; of all sections if empty.
    pub zones: Vec<String>,
    /// What else the values have in common: `wheelset` and `2`.
    pub keys: Vec<(String, String)>,
    /// A condition on them in the words of the protocol.
    pub condition: Option<String>,
}

impl Scope {
    /// The values of one zone.
    pub fn zone(name: &str) -> Self {
        Self { zones: vec![name.to_owned()], ..Self::default() }
    }

    /// Whether all values belong to it.
    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }

    /// Whether it contains a section of a zone, as far as zones decide.
    pub fn has_zone(&self, zone: Option<&str>) -> bool {
        self.zones.is_empty() || zone.is_some_and(|zone| self.zones.iter().any(|own| own == zone))
    }

    /// What tells it apart from other groups: each key with its member, one zone first.
    pub fn members(&self) -> Vec<(&str, &str)> {
        let zone = match self.zones.as_slice() {
            [zone] => Some(("zone", zone.as_str())),
            _ => None,
        };
        zone.into_iter()
            .chain(self.keys.iter().map(|(key, member)| (key.as_str(), member.as_str())))
            .collect()
    }

    /// [`Scope::members`] as they stand in files.
    pub fn owned_members(&self) -> Vec<(String, String)> {
        let owned = |(key, member): (&str, &str)| (key.to_owned(), member.to_owned());
        self.members().into_iter().map(owned).collect()
    }

    /// The text; nothing of all values.
    pub fn told(&self) -> Option<String> {
        (!self.is_all()).then(|| self.to_string())
    }

    /// The text after a title: `, zone 1`; nothing of all values.
    pub fn suffix(&self) -> String {
        if self.is_all() { String::new() } else { format!(", {self}") }
    }
}

/// `all`, `zones 2, 3`, `zone 1, wheelset 2, direction is left`.
impl fmt::Display for Scope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let zones = match self.zones.as_slice() {
            [] => None,
            [zone] => Some(format!("zone {zone}")),
            several => Some(format!("zones {}", several.join(", "))),
        };
        let keys = self.keys.iter().map(|(key, member)| format!("{key} {member}"));
        let words: Vec<String> =
            zones.into_iter().chain(keys).chain(self.condition.clone()).collect();
        f.write_str(if words.is_empty() { "all" } else { "" })?;
        f.write_str(&words.join(", "))
    }
}

/// A scope as it stands in files.
#[derive(Serialize, Deserialize, JsonSchema)]
struct ScopeInFile {
    /// In words: `all`, `zones 2, 3`, `zone 1, wheelset 2`.
    scope: String,
    #[serde(with = "ScopeData")]
    scope_data: Scope,
}

/// See [`Scope`].
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Scope")]
struct ScopeData {
    /// Only values of these zones; of all sections if empty.
    zones: Vec<String>,
    /// What else the values have in common.
    #[serde(with = "map")]
    #[schemars(with = "IndexMap<String, String>")]
    keys: Vec<(String, String)>,
    /// A condition on them in the words of the protocol.
    condition: Option<String>,
}

impl From<Scope> for ScopeInFile {
    fn from(found: Scope) -> Self {
        Self { scope: found.to_string(), scope_data: found }
    }
}

impl From<ScopeInFile> for Scope {
    fn from(file: ScopeInFile) -> Self {
        file.scope_data
    }
}

/// Pairs as a map that keeps their order.
pub mod map {
    use indexmap::IndexMap;
    use serde::{Deserialize, Deserializer, Serializer};

    /// # Errors
    /// Of the serialiser.
    pub fn serialize<S: Serializer>(pairs: &[(String, String)], to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(pairs.iter().map(|(key, value)| (key, value)))
    }

    /// # Errors
    /// It is no map of texts.
    pub fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Vec<(String, String)>, D::Error> {
        Ok(IndexMap::<String, String>::deserialize(from)?.into_iter().collect())
    }
}

/// Zones of a field (one, at most one, or a list) as they stand in files: numbers where they are
/// integers.
pub mod zones {
    use schemars::JsonSchema;
    use serde::de::{DeserializeOwned, Error};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use serde_json::Value;

    /// The name of a zone in a schema.
    #[derive(JsonSchema)]
    #[allow(dead_code, reason = "the schema describes it")]
    #[schemars(untagged)]
    pub(in crate::result) enum InFile {
        Number(i64),
        Name(String),
    }

    fn changed(zones: Value, name: fn(Value) -> Value) -> Value {
        match zones {
            Value::Array(all) => all.into_iter().map(|zone| changed(zone, name)).collect(),
            Value::Null => Value::Null,
            zone => name(zone),
        }
    }

    /// # Errors
    /// Of the serialiser.
    pub fn serialize<S: Serializer>(zones: &impl Serialize, to: S) -> Result<S::Ok, S::Error> {
        let number = |zone: Value| {
            let number = zone.as_str().and_then(|name| name.parse::<i64>().ok());
            let same = |number: &i64| zone.as_str() == Some(number.to_string().as_str());
            number.filter(same).map_or_else(|| zone.clone(), Value::from)
        };
        changed(serde_json::to_value(zones).unwrap_or_default(), number).serialize(to)
    }

    /// # Errors
    /// It is neither a number nor a text.
    pub fn deserialize<'de, D: Deserializer<'de>, T: DeserializeOwned>(
        from: D,
    ) -> Result<T, D::Error> {
        let name = |zone: Value| match zone {
            Value::Number(number) => number.to_string().into(),
            other => other,
        };
        serde_json::from_value(changed(Value::deserialize(from)?, name)).map_err(Error::custom)
    }
}

/// The name of a statistic in files: `mean`, `std`, `each`, `p95`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(into = "String", from = "String")]
pub enum StatisticName {
    Mean,
    StandardDeviation,
    /// Every value by itself; the worst decides.
    Each,
    /// Of the values, in percent.
    Percentile(f64),
    /// Another statistic, an estimate of the protocol, or an expression as written.
    Other(String),
}

/// The number of the outcome of a quantity whose protocol puts several in order.
pub const OUTCOME: &str = "outcome";

impl From<String> for StatisticName {
    fn from(name: String) -> Self {
        match name.as_str() {
            "mean" => Self::Mean,
            "std" => Self::StandardDeviation,
            "each" => Self::Each,
            _ => match name.strip_prefix('p').and_then(|percent| percent.parse().ok()) {
                Some(percent) if format!("p{percent}") == name => Self::Percentile(percent),
                _ => Self::Other(name),
            },
        }
    }
}

impl From<StatisticName> for String {
    fn from(name: StatisticName) -> Self {
        name.to_string()
    }
}

impl fmt::Display for StatisticName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mean => f.write_str("mean"),
            Self::StandardDeviation => f.write_str("std"),
            Self::Each => f.write_str("each"),
            Self::Percentile(percent) => write!(f, "p{percent}"),
            Self::Other(name) => f.write_str(name),
        }
    }
}

/// Which record a value is of, where a campaign has several of a side.
///
/// In files `record` is its text, and `records` the names.
#[derive(
    Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(into = "RecordInFile", from = "RecordInFile")]
pub enum RecordName {
    /// `simpack`
    Single(Arc<str>),
    /// A simulated and a measured record, or two of one side: `simpack, run1`.
    Pair(Arc<str>, Arc<str>),
}

impl RecordName {
    /// The name of those of two records of which there are several.
    pub fn joined(first: Option<&Arc<str>>, second: Option<&Arc<str>>) -> Option<Self> {
        match (first, second) {
            (Some(first), Some(second)) => Some(Self::Pair(first.clone(), second.clone())),
            (first, second) => first.or(second).cloned().map(Self::Single),
        }
    }

    /// The record itself, or the first of two.
    pub fn first(&self) -> &Arc<str> {
        let (Self::Single(first) | Self::Pair(first, _)) = self;
        first
    }

    /// Whether a record is the one, or one of both.
    pub fn has(&self, name: &str) -> bool {
        match self {
            Self::Single(single) => **single == *name,
            Self::Pair(first, second) => **first == *name || **second == *name,
        }
    }

    /// Whether a record of a side took part in a value; where there is one of the side, it has no
    /// name.
    pub fn took_part(of: Option<&Self>, simulated: bool, name: Option<&str>) -> bool {
        let (Some(of), Some(name)) = (of, name) else { return true };
        match of {
            Self::Single(single) => **single == *name,
            Self::Pair(first, second) => name == &**if simulated { first } else { second },
        }
    }
}

impl fmt::Display for RecordName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Single(name) => f.write_str(name),
            Self::Pair(first, second) => write!(f, "{first}, {second}"),
        }
    }
}

/// See [`RecordName`].
#[derive(Serialize, Deserialize, JsonSchema)]
struct RecordInFile {
    /// In words: `simpack`, `simpack, run1`.
    record: String,
    /// One or two names.
    records: Vec<String>,
}

impl From<RecordName> for RecordInFile {
    fn from(name: RecordName) -> Self {
        let records = match &name {
            RecordName::Single(single) => vec![single.to_string()],
            RecordName::Pair(first, second) => vec![first.to_string(), second.to_string()],
        };
        Self { record: name.to_string(), records }
    }
}

impl From<RecordInFile> for RecordName {
    fn from(RecordInFile { record, records }: RecordInFile) -> Self {
        match records.as_slice() {
            [first, second] => Self::Pair(first.as_str().into(), second.as_str().into()),
            _ => Self::Single(record.into()),
        }
    }
}
