//! Findings about the data, with the value found and the expected value.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FindingData, Reason, told};
use crate::words::{self, Text};

/// A finding for the attention of the assessor, wherever the data show it for the same cause.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// Kind of finding: the name of the protocol's rule, or a code of the program in kebab case.
    pub code: String,
    /// The first of its places.
    #[serde(flatten)]
    pub first: Occurrence,
    /// The causes that it may have, the likeliest first; empty if none is known.
    #[serde(flatten, with = "told::causes")]
    #[schemars(with = "told::Causes<Reason>")]
    pub causes: Vec<Reason>,
    pub consequence: Consequence,
    /// Findings of other rules at the same places, which probably have the same cause.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub explains: Vec<Self>,
    /// All places; empty until the findings of a campaign are joined.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<Occurrence>,
}

/// Where a finding is, and what is found there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Occurrence {
    /// The channel, position or field concerned; `None` if it concerns a section or the campaign.
    pub channel: Option<String>,
    /// Which of several campaigns it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub campaign: Option<String>,
    /// `None` if it concerns the campaign.
    pub section: Option<String>,
    /// The kind of record: `simulation`, `measurement` or `track`.
    pub record: Option<String>,
    /// The value found, in `unit`.
    pub value: Option<f64>,
    /// The expected value, or the bound that is exceeded, in `unit`.
    pub expected: Option<f64>,
    pub unit: Option<String>,
    /// What it says.
    #[serde(flatten, with = "told::says")]
    #[schemars(with = "told::Says<FindingData>")]
    pub data: FindingData,
}

/// Influence of a finding on the verdict.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Consequence {
    /// Reported only.
    Note,
    /// The section is not used.
    NotUsed,
    /// The campaign is not assessable.
    NotAssessable,
}

impl Consequence {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Note => "noted",
            Self::NotUsed => "section not used",
            Self::NotAssessable => "not assessable",
        }
    }
}

impl From<FindingData> for Occurrence {
    /// Of the campaign.
    fn from(data: FindingData) -> Self {
        Self {
            channel: None,
            campaign: None,
            section: None,
            record: None,
            value: None,
            expected: None,
            unit: None,
            data,
        }
    }
}

impl Occurrence {
    /// What is found there, as a sentence without a full stop.
    pub fn text(&self) -> Text {
        words::text(&self.data)
    }
}

impl Finding {
    /// A finding that is reported only.
    pub fn note(code: impl Into<String>, first: impl Into<Occurrence>) -> Self {
        Self {
            code: code.into(),
            first: first.into(),
            causes: Vec::new(),
            consequence: Consequence::Note,
            explains: Vec::new(),
            places: Vec::new(),
        }
    }

    /// One finding for all that differ in places and values alone, in the order of the first ones.
    pub fn joined(all: Vec<Self>) -> Vec<Self> {
        let mut joined: Vec<Self> = Vec::new();
        for mut finding in all {
            let alike = |known: &&mut Self| {
                (&known.code, &known.causes, known.consequence)
                    == (&finding.code, &finding.causes, finding.consequence)
                    && known.first.data.alike(&finding.first.data)
            };
            match joined.iter_mut().find(alike) {
                Some(known) => known.places.push(finding.first),
                None => {
                    finding.places = vec![finding.first.clone()];
                    joined.push(finding);
                }
            }
        }
        joined
    }

    /// Title of the plausibility rule that it comes from.
    pub fn rule(&self) -> Option<&str> {
        self.first.data.rule()
    }

    /// The finding, and those that it explains.
    pub fn with_explained(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.explains)
    }

    /// All places.
    pub fn places(&self) -> &[Occurrence] {
        if self.places.is_empty() { std::slice::from_ref(&self.first) } else { &self.places }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_with_one_cause_are_one_with_its_places() {
        let finding = |section: &str, channel: &str, value: f64, cause: &str| {
            let data = FindingData::Required {
                rule: "Wheel load".into(),
                what: Some(format!("mean of {channel}")),
                value: Some(value),
                expected: Some(50.0),
                unit: "kN".into(),
                required: "it is near the static one".into(),
            };
            let first = Occurrence {
                section: Some(section.into()),
                channel: Some(channel.into()),
                value: Some(value),
                ..data.into()
            };
            let causes = vec![Reason::said(cause), Reason::said("noise")];
            Finding { causes, ..Finding::note("wheel-load", first) }
        };
        let note = Finding::note("unit-assumed", FindingData::Said { says: "a fact".into() });
        let all = vec![
            finding("S01", "Q_1R", 25.0, "a factor of 2"),
            finding("S01", "Q_1L", 24.0, "a factor of 2"),
            note.clone(),
            finding("S02", "Q_1R", 26.0, "a factor of 2"),
            finding("S02", "Q_1L", 0.0, "no signal"),
        ];
        let joined = Finding::joined(all.clone());
        let places = |finding: &Finding| {
            let place = |at: &Occurrence| (at.section.clone(), at.channel.clone(), at.value);
            finding.places.iter().map(place).collect::<Vec<_>>()
        };
        assert_eq!(joined.len(), 3);
        let of = |at: usize| places(&Finding::joined(vec![all[at].clone()])[0]);
        assert_eq!(places(&joined[0]), [of(0), of(1), of(3)].concat());
        assert_eq!((joined[0].first.clone(), places(&joined[1])), (all[0].first.clone(), of(2)));
        assert_eq!(joined[2].places(), all[4].places());
        let text = serde_json::to_string(&joined).expect("JSON");
        assert_eq!(serde_json::from_str::<Vec<Finding>>(&text).expect("findings"), joined);
        let causes =
            r#""cause":"a factor of 2","causes":["a factor of 2","noise"],"causes_data":[{"#;
        assert!(text.contains(causes), "{text}");
    }
}
