//! Symbols, signs and terms used in tables and figures.

use serde::Serialize;

use super::Finding;
use crate::report::number;
use crate::result::{Certification, Kind};

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NotationView {
    pub channels: Vec<ChannelRow>,
    pub symbols: Vec<SymbolRow>,
    pub comparisons: Vec<Term>,
    pub words: Vec<Term>,
    pub findings: Vec<(Finding, String)>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChannelRow {
    pub name: String,
    pub title: String,
    pub unit: String,
    pub note: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SymbolRow {
    pub symbol: String,
    pub title: String,
    pub unit: String,
    pub of: String,
    pub comparison: String,
}

/// A term and its meaning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Term {
    pub word: String,
    pub meaning: String,
}

/// Comparisons with an explanation of their sign. Others are self-explanatory.
const COMPARISONS: [(&str, &str); 3] = [
    (
        "sign(measured) * (simulated - measured)",
        "Positive: the simulated value is larger in the direction of the measured value. A wrong sign of the simulation gives a large \
         negative difference.",
    ),
    ("|simulated| - |measured|", "Positive: the magnitude of the simulated value is larger. The signs of both values are not compared."),
    ("simulated - measured", "Positive: the simulated value is larger, with its sign."),
];

/// Terms of a comparison of simulated with measured records.
const COMPARED: [(&str, &str); 4] = [
    ("Pair", "The simulated and the measured value of one quantity, in one section, for one signal."),
    ("n", "Number of sites of the pairs: repeats and positions of one section are not independent of each other."),
    ("Mean", "Arithmetic mean of the differences of the pairs."),
    ("Standard deviation", "Scatter of the differences about their mean. The divisor, n − 1 or n, is stated with it."),
];

/// Terms of an assessment.
const ASSESSED: [(&str, &str); 4] = [
    ("Value", "The number of one record, in one section, for one signal."),
    ("Values / n", "Number of values of a group, and of its independent units: sites, if the protocol does not say otherwise."),
    ("Mean, s", "Arithmetic mean and standard deviation (divisor n − 1) of the values of a group."),
    ("Estimate", "What is compared with the limit: a statistic of the values of a group, or a value predicted from them."),
];

/// Terms of a comparison of records of one side.
const AMONG: [(&str, &str); 3] = [
    ("Record, all records", "The number of one record, and the mean or the median of all records of the section."),
    ("Values / n", "Number of values of a statistic, and of their independent sites."),
    ("Mean", "Arithmetic mean of the differences."),
];

/// Terms explained in every report.
const WORDS: [(&str, &str); 4] = [
    ("95 % interval", "Confidence interval of the statistic. The mean: Student's t; the standard deviation: chi-square."),
    ("|Value| / limit", "Magnitude of the statistic divided by its limit; the criterion is met up to 1."),
    ("p0.15, p99.85", "Value below which 0.15 % or 99.85 % of the samples of a section lie; other percentiles likewise."),
    ("rms", "Root of the mean of the squares of the samples."),
];

fn terms(found: &Certification) -> impl Iterator<Item = &'static (&'static str, &'static str)> {
    let (compared, assessed, among): (&[_], &[_], &[_]) = match found.kind() {
        Kind::Validation => (&COMPARED, &[], &[]),
        Kind::Assessment => (&[], &ASSESSED, &[]),
        Kind::Comparison => (&[], &[], &AMONG),
        Kind::Mixed => (&COMPARED, &ASSESSED, &[]),
    };
    compared.iter().chain(assessed).chain(among).chain(&WORDS)
}

pub(super) fn view(found: &Certification) -> NotationView {
    let term = |(word, meaning): &(&str, &str)| Term { word: (*word).to_owned(), meaning: (*meaning).to_owned() };
    let finding = |holds, says: &str| (Finding::of(holds), says.to_owned());
    let used = |words: &str| found.quantities.iter().any(|quantity| quantity.comparison == words);
    NotationView {
        channels: found
            .protocol
            .channels
            .iter()
            .map(|channel| ChannelRow {
                name: channel.name.clone(),
                title: channel.title.clone(),
                unit: number::unit(&channel.unit),
                note: channel.note.clone(),
            })
            .collect(),
        symbols: found
            .quantities
            .iter()
            .map(|quantity| SymbolRow {
                symbol: super::symbol(&quantity.symbol),
                title: quantity.title.clone(),
                unit: number::unit(&quantity.unit),
                of: quantity.of.clone(),
                comparison: number::formula(&quantity.comparison),
            })
            .collect(),
        comparisons: COMPARISONS
            .iter()
            .filter(|(words, _)| used(words))
            .map(|(words, meaning)| Term { word: number::formula(words), meaning: (*meaning).to_owned() })
            .collect(),
        words: if found.quantities.is_empty() { Vec::new() } else { terms(found).map(term).collect() },
        findings: vec![
            finding(Some(true), "The acceptance criterion or requirement is met."),
            finding(Some(false), "It is not met."),
            finding(None, "It could not be assessed; the reason is stated."),
        ],
    }
}
