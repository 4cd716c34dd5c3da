//! Reads `results.json`, as far as needed for checks.

use serde::{Deserialize, Deserializer};
use serde_json::Value;

use crate::certify::Setting;
use crate::check::plan::Plan;
use crate::result::{DomainResult, Finding};
use crate::run::replay::{Recorded, RecordedSection, RecordedValue};

#[derive(Clone, Debug, Deserialize)]
pub struct Results {
    /// Version of the program that wrote them.
    pub fishplate: String,
    pub protocol: Protocol,
    pub campaign: Campaign,
    pub verdict: String,
    /// The verdict in the protocol's own words, if it has some.
    #[serde(default)]
    pub verdict_word: Option<String>,
    pub quantities: Vec<Quantity>,
    pub sections: Vec<Section>,
    #[serde(default)]
    pub findings: Vec<Finding>,
    #[serde(default)]
    pub application: Vec<DomainResult>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Protocol {
    pub name: String,
    pub title: String,
    pub sha256: String,
    pub parameters: Vec<Setting>,
    pub files: Vec<ProtocolFile>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct ProtocolFile {
    pub name: String,
    pub sha256: String,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Campaign {
    pub name: String,
    /// The campaigns of a pool.
    #[serde(default)]
    pub members: Vec<Member>,
    pub files: Vec<File>,
    pub vehicle: Vec<Item>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Member {
    pub short_name: String,
}

#[derive(Clone, Debug, Deserialize)]
pub struct File {
    pub path: String,
    pub sha256: String,
    pub bytes: u64,
    pub record: Option<Record>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Record {
    pub kind: String,
    pub section: String,
    /// Where the campaign has several of the kind.
    #[serde(default)]
    pub name: Option<String>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Item {
    pub value: String,
    pub used: bool,
    /// Whose it is, where there are several vehicles.
    #[serde(default)]
    pub of: Option<String>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Section {
    #[serde(default)]
    pub campaign: Option<String>,
    #[serde(default)]
    pub vehicle: Option<String>,
    pub section: String,
    /// The first section of its site.
    #[serde(default)]
    pub site: Option<String>,
    #[serde(default, deserialize_with = "word")]
    pub zone: Option<String>,
    pub used: bool,
    pub reason: Option<String>,
    pub start: f64,
    pub end: f64,
    pub axis_unit: String,
    pub columns: Vec<Item>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Quantity {
    pub id: String,
    pub title: String,
    pub unit: String,
    pub statistics: Vec<Statistic>,
    pub values: Vec<Pair>,
    pub rule: Option<Place>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Statistic {
    pub title: String,
    pub scope: String,
    pub count: usize,
    pub unit: String,
    pub value: Option<f64>,
    pub limit: Option<f64>,
    pub normalised: Option<f64>,
    pub holds: Option<bool>,
    pub limit_text: String,
    pub reason: Option<String>,
    pub rule: Option<Place>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Pair {
    pub section: String,
    #[serde(default, deserialize_with = "word")]
    pub zone: Option<String>,
    pub signal: String,
    /// Which record, where there are several of a side.
    pub record: Option<String>,
    /// Which of several values, in words.
    pub taken: Option<String>,
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    #[serde(alias = "value")]
    pub difference: f64,
    pub samples: usize,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Place {
    pub file: String,
    pub line: usize,
}

/// The name of a zone, which is a number in the file if it is an integer.
fn word<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    Ok(match Value::deserialize(from)? {
        Value::Null => None,
        Value::String(text) => Some(text),
        other => Some(other.to_string()),
    })
}

impl Results {
    /// The verdict as the report says it.
    pub fn verdict_in_words(&self) -> &str {
        self.verdict_word.as_deref().unwrap_or(&self.verdict)
    }

    /// # Errors
    /// A key is missing or has another type; a message.
    pub fn of(value: &Value) -> Result<Self, String> {
        Self::deserialize(value).map_err(|error| error.to_string())
    }

    /// The recorded values, in the form needed by the rules.
    ///
    /// # Errors
    /// A quantity of the protocol is missing.
    pub fn recorded(&self, plan: &Plan) -> Result<Recorded, String> {
        let used = || self.campaign.vehicle.iter().filter(|item| item.used);
        let mut of: Vec<Option<String>> = Vec::new();
        for vehicle in
            self.sections.iter().map(|section| &section.vehicle).chain(used().map(|item| &item.of))
        {
            if !of.contains(vehicle) {
                of.push(vehicle.clone());
            }
        }
        let data = |of: Option<String>| {
            (
                of.clone(),
                used().filter(|item| item.of == of).map(|item| item.value.clone()).collect(),
            )
        };
        let vehicles = of.into_iter().map(data).collect();
        let section = |section: &Section| RecordedSection {
            name: section.section.clone(),
            campaign: section.campaign.clone(),
            vehicle: section.vehicle.clone(),
            site: section.site.clone().unwrap_or_else(|| section.section.clone()),
            zone: section.zone.clone(),
            fault: (!section.used).then(|| section.reason.clone().unwrap_or_default()),
            start: section.start,
            end: section.end,
            columns: section.columns.iter().map(|item| item.value.clone()).collect(),
        };
        let value = |pair: &Pair| RecordedValue {
            section: pair.section.clone(),
            signal: pair.signal.clone(),
            record: pair.record.clone(),
            taken: pair.taken.clone(),
            simulated: pair.simulated,
            measured: pair.measured,
            difference: pair.difference,
            samples: pair.samples,
        };
        let mut values = Vec::new();
        for quantity in &plan.quantities {
            let found = self.quantities.iter().find(|found| found.id == quantity.id);
            let found =
                found.ok_or_else(|| format!("the result has no quantity `{}`", quantity.id))?;
            values.push(found.values.iter().map(value).collect());
        }
        let sections = self.sections.iter().map(section).collect();
        Ok(Recorded {
            vehicles,
            sections,
            values,
            findings: self.findings.clone(),
            application: self.application.clone(),
        })
    }
}
