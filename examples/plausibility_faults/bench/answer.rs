//! What a file of results tells of a campaign: verdict, findings, sections that are not used.

use std::collections::BTreeMap;

use serde_json::Value;

/// Remarks of the program on what a campaign does not state, or on estimates that reach beyond its
/// data; they name no fault of its data.
const REMARKS: [&str; 8] = [
    "vehicle-data-not-stated",
    "plausibility-not-checked",
    "unit-assumed",
    "limit-factor",
    "outside-domain",
    "no-domain",
    "extrapolated",
    "beyond-measured",
];

/// The code under which records that the table of sections leaves out are told.
pub const LEFT_OUT: &str = "not-in-table";

/// An evaluation, in the words of `results.json`.
#[derive(Clone, Debug, Default)]
pub struct Answer {
    /// One of the three of the file, or `refused`.
    pub verdict: String,
    pub reasons: Vec<String>,
    /// In the order of the file; then what removes sections without a finding.
    pub findings: Vec<Found>,
    /// Statistics as shares of their limits.
    pub shares: BTreeMap<String, f64>,
}

/// A finding, an error, or a reason for which sections are not used.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The rule of the protocol, or the program's own code.
    pub code: String,
    /// The program puts a guess of its own, as a wrong unit, before the cause of the rule.
    pub guessed: bool,
    pub places: Vec<Place>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    pub section: String,
    pub channel: String,
    pub record: String,
    /// All names and words of its data.
    words: Vec<String>,
    /// The sentence, to be printed.
    pub says: String,
}

impl Answer {
    /// From a file of results.
    pub fn read(results: &Value) -> Self {
        let of_rules = |finding: &Found| !REMARKS.contains(&finding.code.as_str());
        let mut findings: Vec<Found> =
            list(&results["findings"]).map(Found::read).filter(of_rules).collect();
        let of_finding = |reason: &Value| reason["code"] == "finding";
        for section in list(&results["sections"]).filter(|section| section["used"] == false) {
            if !of_finding(&section["reason_data"]) {
                findings.push(Found::removed(section));
            }
        }
        let mut shares = BTreeMap::new();
        for quantity in list(&results["quantities"]) {
            for statistic in list(&quantity["statistics"]) {
                let name = [&quantity["id"], &statistic["name"], &statistic["scope"]].map(text);
                if let Some(share) = statistic["normalised"].as_f64() {
                    shares.insert(name.join(" "), share);
                }
            }
        }
        let reasons = list(&results["reasons"]).map(text).collect();
        Self { verdict: text(&results["verdict"]), reasons, findings, shares }
    }

    /// Each error of a refused campaign, of which no file tells, as a finding.
    pub fn refused(text: &str) -> Self {
        let found = |error: &str| {
            let (code, says) = error.split_once(']').unwrap_or(("refused", error));
            let says = says.trim_start_matches(':').trim();
            let place = Place { words: words(says), says: says.into(), ..Place::default() };
            Found { code: code.into(), guessed: false, places: vec![place] }
        };
        let errors = text.split("error[").skip(1);
        Self { verdict: "refused".into(), findings: errors.map(found).collect(), ..Self::default() }
    }

    /// The findings that another campaign does not have as well.
    pub fn beyond(&self, sound: &Self) -> Vec<Found> {
        let known = |code: &str, place: &Place| {
            let at =
                |place: &Place| [&place.section, &place.channel, &place.record].map(String::clone);
            let same = sound.findings.iter().filter(|found| found.code == code);
            same.flat_map(|found| &found.places).any(|other| at(other) == at(place))
        };
        let new = |found: &Found| {
            let new = |place: &&Place| !known(&found.code, place);
            let places: Vec<Place> = found.places.iter().filter(new).cloned().collect();
            (!places.is_empty()).then(|| Found { places, ..found.clone() })
        };
        self.findings.iter().filter_map(new).collect()
    }

    /// The largest change of a share of a limit.
    pub fn moved(&self, from: &Self) -> f64 {
        let change = |(name, share): (&String, &f64)| Some((share - from.shares.get(name)?).abs());
        self.shares.iter().filter_map(change).fold(0.0, f64::max)
    }
}

impl Found {
    fn read(finding: &Value) -> Self {
        // Samples for which no rule can be checked are told with their own reason.
        let of_samples = &finding["data"]["reason"]["code"];
        let mut places: Vec<Place> = list(&finding["places"]).map(Place::read).collect();
        if places.is_empty() {
            places.push(Place::read(finding));
        }
        Self {
            code: text(if of_samples.is_string() { of_samples } else { &finding["code"] }),
            guessed: finding["causes"].get(1).is_some(),
            places,
        }
    }

    fn removed(section: &Value) -> Self {
        let mut place = Place::read(section);
        place.says = text(&section["reason"]);
        let mut said = Vec::new();
        strings(&section["reason_data"], &mut said);
        place.words.extend(said.iter().flat_map(|text| words(text)));
        Self { code: text(&section["reason_data"]["code"]), guessed: false, places: vec![place] }
    }
}

impl Place {
    fn read(place: &Value) -> Self {
        let mut said = Vec::new();
        ["section", "channel", "record", "data"]
            .iter()
            .for_each(|key| strings(&place[*key], &mut said));
        Self {
            section: text(&place["section"]),
            channel: text(&place["channel"]),
            record: text(&place["record"]),
            words: said.iter().flat_map(|text| words(text)).collect(),
            says: text(&place["says"]),
        }
    }

    /// Whether it has the name of a section.
    pub fn has(&self, section: &str) -> bool {
        self.section == section || self.words.iter().any(|word| word == section)
    }

    /// Whether it has a name that begins so.
    pub fn has_name(&self, begins: &str) -> bool {
        self.words.iter().any(|word| word.starts_with(begins))
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_string()
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// All texts of some data.
fn strings(value: &Value, into: &mut Vec<String>) {
    match value {
        Value::String(text) => into.push(text.clone()),
        Value::Array(all) => all.iter().for_each(|value| strings(value, into)),
        Value::Object(fields) => fields.values().for_each(|value| strings(value, into)),
        _ => {}
    }
}

fn words(text: &str) -> Vec<String> {
    let part = |c: char| !c.is_alphanumeric() && c != '_';
    text.split(part).filter(|word| !word.is_empty()).map(str::to_string).collect()
}
