//! Result of a diagnosis: plain data, in the form of `diagnosis.json`.

pub use super::shrink::{HeldOut, QuantityShrink, Shrink, Touched};
use std::borrow::Cow;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Remark, Statement, Verdict, told, zones};

/// A diagnosis.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Diagnosis {
    pub fishplate: String,
    pub format: u32,
    pub campaign: String,
    /// `explained`, `ambiguous`, `unexplained` or `no significant gap`.
    pub verdict: Cow<'static, str>,
    /// The verdict in sentences.
    #[serde(flatten, with = "told::statements")]
    #[schemars(with = "told::Statements<Statement>")]
    pub says: Vec<Statement>,
    pub fit: Fit,
    /// The verdict of the protocol on the campaign as it is, and with the effects by
    /// cross-validation.
    pub protocol_before: Verdict,
    pub protocol_after: Option<Verdict>,
    /// Share of campaigns drawn from what is allowed, with nothing hidden, in which an effect would
    /// be named.
    pub false_name_rate: f64,
    pub calibration: Calibration,
    /// Faults of the recording; their channels are excluded.
    pub faults: Vec<Fault>,
    pub r#where: Vec<Where>,
    pub invariants: Vec<Invariant>,
    /// Trends with a p-value below 0.05 before or after, in increasing order of p-value.
    pub trends: Vec<Trend>,
    /// Number of trends tested.
    pub trends_tested: usize,
    /// Correlated covariates, between which the campaign does not discriminate.
    pub together: Vec<String>,
    /// Variation of the sizes of operations on the signals over the campaign; a correct effect has
    /// one size.
    pub drifts: Vec<Drift>,
    pub shapes: Vec<Shape>,
    pub causes: Vec<Cause>,
    pub vetoed: Vec<Vetoed>,
    pub shrink: Option<Shrink>,
    pub held_out: HeldOut,
    /// Share of the excess of the gap that remains with the answer.
    pub unexplained_share: f64,
    pub discriminating_measurement: Option<String>,
    /// Per effect, the smallest detectable size.
    pub detectable: Vec<Detectable>,
    /// Closest candidates for the residual that are not named.
    pub nearest: Vec<Nearest>,
    /// Deviations of the tolerances that the fit used, the largest first.
    pub tolerances: Vec<UsedTolerance>,
    pub how: How,
    #[serde(flatten, with = "told::notes")]
    #[schemars(with = "told::Notes<Remark>")]
    pub notes: Vec<Remark>,
    pub simulations_run: usize,
    /// Simulated time of all runs in s, inside the sections. Not wall-clock time, so that the same
    /// input gives the same bytes.
    pub seconds: f64,
    /// Whether sections may be mirrored: left and right curves.
    pub mirrored: bool,
    /// Signals of the sections with the largest gap, for figures.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
}

/// The deviation of a tolerance that the fit used: the mean of its posterior.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct UsedTolerance {
    pub tolerance: String,
    pub parameter: String,
    /// In declared standard deviations.
    pub deviations: f64,
}

/// What the search names in campaigns drawn on the basis of this one, with known effects. The
/// consistency checks are left out.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Calibration {
    /// Single effects that are named, and nothing else.
    pub single: Share,
    /// Pairs of which both are named, and nothing else.
    pub pair: Share,
    /// Effects that the search does not know, for which another one is named.
    pub outside: Share,
    /// Answers that name an effect that is not hidden.
    pub further: Share,
    /// 90 % intervals that contain the hidden size.
    pub intervals: Share,
    /// Length of the change in standard deviations from which nine of ten single effects are named.
    pub length: Option<f64>,
}

/// A number of cases among others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Share {
    pub count: usize,
    pub of: usize,
}

/// Chi-squared of what is left with the answer, against noise, tolerances and model discrepancy.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Fit {
    /// Near 1 where these describe what is left.
    pub chi2_per_feature: f64,
    /// Probability of a larger chi-squared if they do.
    pub p_value: f64,
    /// The factor by which they would have to be multiplied, with its standard deviation.
    pub allowance_scale: f64,
    pub allowance_scale_sd: f64,
}

/// Signals of one section.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    pub section: String,
    /// Description of the section.
    pub says: String,
    pub axis: String,
    pub start: f64,
    pub end: f64,
    pub panels: Vec<Panel>,
}

/// One channel: measured, simulated, simulated with the effects.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    pub channel: String,
    pub unit: String,
    pub measured: super::Curve,
    pub simulated: super::Curve,
    pub improved: super::Curve,
}

/// A faulty channel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Fault {
    /// `dropout` or `clipping`.
    pub fault: Cow<'static, str>,
    pub channel: String,
    pub sections: Vec<String>,
    pub says: String,
}

/// A cell of the gap.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Where {
    pub quantity: String,
    pub signals: Vec<String>,
    #[serde(with = "zones")]
    #[schemars(with = "Vec<zones::InFile>")]
    pub zones: Vec<String>,
    pub sections: Vec<String>,
    pub wavelength_or_band: String,
    /// Lower edge of the band, in Hz.
    #[serde(skip)]
    pub frequency: Option<f64>,
    /// Mean difference, simulated - measured. Levels in the unit of the channel, as sign(measured)
    /// (simulated - measured); bands as the ratio of the rms, simulated / measured - 1.
    pub difference: f64,
    /// Root mean square of the same differences; larger than the mean where they vary between
    /// sections and wheels.
    pub difference_rms: f64,
    pub unit: String,
    pub share_of_gap: f64,
    pub p_value: f64,
    /// At the false discovery rate of the diagnosis.
    pub significant: bool,
    /// Where on the vehicle.
    #[serde(skip)]
    pub position: String,
    pub says: String,
}

/// A sum of quasi-static values that only some causes can change: mean over the sections, simulated
/// - measured.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Invariant {
    pub name: String,
    /// Whether the deviation has the same sign in all sections, or changes sign with the curve.
    pub parity: Cow<'static, str>,
    pub unit: String,
    pub before: f64,
    /// With the effects added.
    pub after: f64,
    /// One standard deviation of the allowed difference.
    pub allowed: f64,
    /// The same with the effects.
    pub allowed_after: f64,
}

/// Trend of a difference over a column of the section table: generalised least squares on that
/// column alone.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Trend {
    pub quantity: String,
    pub position: String,
    pub signals: Vec<String>,
    pub wavelength_or_band: String,
    pub covariate: String,
    /// The table's text for its minimum and its maximum.
    pub from: String,
    pub to: String,
    /// The first without its unit, where both have one.
    #[serde(skip)]
    pub from_without_unit: String,
    /// Unit of the changes; `-` for ratios.
    pub unit: String,
    pub before: Slope,
    /// With the effects added.
    pub after: Slope,
}

/// Change of the size of an effect over the range of a covariate, with a 90 % interval.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Drift {
    pub effect: String,
    pub signals: Vec<String>,
    pub parameter: String,
    /// Unit of the change.
    pub unit: String,
    pub covariate: String,
    /// The table's text for its minimum and its maximum.
    pub from: String,
    pub to: String,
    pub change: f64,
    pub low: f64,
    pub high: f64,
    /// Probability of the data if the size is the same everywhere.
    pub p_value: f64,
}

/// Change of simulated - measured over the range of a covariate, with a 90 % interval. Levels in
/// their unit, turned to one direction if they change sign with the curve; bands as the ratio of
/// the rms, simulated / measured - 1.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Slope {
    pub change: f64,
    pub low: f64,
    pub high: f64,
    /// Correlation of the differences with the covariate, without weighting.
    pub correlation: f64,
    /// Probability of the data if there is no trend.
    pub p_value: f64,
    /// At the false discovery rate of the diagnosis.
    pub significant: bool,
}

/// Difference of the dynamic content of a group of channels, over all sections.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Shape {
    pub quantity: String,
    pub signals: Vec<String>,
    /// Measured / simulated.
    pub rms: Ratio,
    /// Ratio of the peaks, the percentiles farthest from the median.
    pub peak: Ratio,
    /// Ratio of peak / rms.
    pub crest: Ratio,
    /// The scaling of the differences of spectra between sections, if significant: `frequency` or
    /// `wavelength`.
    pub keeps_to: Option<Cow<'static, str>>,
    /// The reason if `keeps_to` is missing.
    pub reason: Option<Cow<'static, str>>,
    /// Share of their variance that is common to all sections, compared at equal frequency, and at
    /// equal wavelength.
    pub alike_by_frequency: Option<f64>,
    pub alike_by_wavelength: Option<f64>,
    pub strongest: Option<Strongest>,
    pub says: String,
}

/// A ratio with its 90 % interval by resampling sections.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Ratio {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// The most significant difference of the spectra.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Strongest {
    /// Ratio of amplitudes, measured / simulated.
    pub ratio: f64,
    /// In Hz, at the mean speed.
    pub frequency: f64,
    /// In m.
    pub wavelength: Option<f64>,
    /// Number of waves per wheel revolution.
    pub per_wheel_turn: Option<f64>,
}

/// Effects that together are a possible cause.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Cause {
    pub rank: usize,
    pub effects: Vec<NamedEffect>,
    pub probability: f64,
    pub in_ambiguity_set: bool,
    /// Twice the logarithm of the Bayes factor against no effect.
    pub evidence: f64,
    pub says: String,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct NamedEffect {
    pub name: String,
    pub title: String,
    pub parameters: IndexMap<String, Value>,
    /// Channels on which it acts.
    pub channels: Vec<String>,
    pub confined_to: Option<IndexMap<String, serde_json::Value>>,
    /// How it is added: by which simulator, or by an operation on the signals.
    pub added_by: String,
    /// Share of resamples of the sections in which no other effect has more evidence; only for
    /// members of the answer.
    pub stability: Option<f64>,
}

/// A parameter as reported; equal parameters of several channels are combined.
#[derive(Clone, Debug, PartialEq)]
pub struct Told<'a> {
    pub parameter: String,
    pub value: &'a Value,
    /// Channels to which it applies.
    pub channels: Vec<String>,
}

impl NamedEffect {
    /// Its parameters for a report.
    pub fn told(&self) -> Vec<Told<'_>> {
        let mut told: Vec<Told<'_>> = Vec::new();
        for (name, value) in &self.parameters {
            // A list of names gives the channels of the preceding parameter.
            if let (Some(names), Some(last)) = (value.names(), told.last_mut()) {
                last.channels = names;
                continue;
            }
            match (
                name.rsplit_once('.')
                    .filter(|(_, channel)| self.channels.iter().any(|known| known == channel)),
                told.last_mut(),
            ) {
                (Some((of, channel)), Some(last))
                    if last.parameter == of && last.value == value =>
                {
                    last.channels.push(channel.into())
                }
                (Some((of, channel)), _) => {
                    told.push(Told { parameter: of.into(), value, channels: vec![channel.into()] })
                }
                (None, _) => {
                    told.push(Told { parameter: name.clone(), value, channels: Vec::new() })
                }
            }
        }
        told
    }

    /// Its confinement, such as `, only in zones 3, 4`; empty if it acts in all sections.
    pub fn only_in(&self) -> String {
        let parts = self
            .confined_to
            .iter()
            .flatten()
            .map(|(column, values)| format!("{column} {}", flat(values)));
        let parts = parts.collect::<Vec<_>>().join(", ");
        if parts.is_empty() { parts } else { format!(", only in {parts}") }
    }
}

impl Told<'_> {
    /// Its channels, such as ` on Y_1R, Y_1L`; empty if there are none.
    pub fn on(&self) -> String {
        if self.channels.is_empty() {
            String::new()
        } else {
            format!(" on {}", self.channels.join(", "))
        }
    }
}

impl Value {
    /// Its text if it is not a number.
    pub fn text(&self) -> String {
        flat(&self.value)
    }

    /// Its list of names.
    fn names(&self) -> Option<Vec<String>> {
        self.value.as_array()?.iter().map(|name| name.as_str().map(str::to_owned)).collect()
    }
}

/// The elements of a nested list, separated by commas.
fn flat(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Array(all) => all.iter().map(flat).collect::<Vec<_>>().join(", "),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A parameter with its 90 % interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Value {
    pub value: serde_json::Value,
    pub unit: String,
    /// The value that the simulation assumes; nothing where the parameter is not a size.
    pub assumed: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// An effect that improves the overall fit but is contradicted by a part of the data.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Vetoed {
    pub name: String,
    pub size: f64,
    pub parameter: String,
    pub evidence: f64,
    pub says: String,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Detectable {
    pub effect: String,
    pub parameter: String,
    pub unit: String,
    /// The size without influence.
    pub neutral: f64,
    /// Distance from neutral at which the whitened change has length 5; nothing if the range ends
    /// before. For an effect on one of several channels, the largest of these distances.
    pub smallest: Option<f64>,
    /// The same on either side of neutral.
    pub below: Option<f64>,
    pub above: Option<f64>,
}

/// An effect that is close to being named.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Nearest {
    pub effect: String,
    pub says: String,
    pub evidence: f64,
    /// The criterion it does not meet.
    pub wants: String,
}

/// Settings of the diagnosis.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct How {
    pub catalogue: String,
    pub simulator: String,
    pub mode: String,
    pub tolerances: String,
    pub sections: usize,
    pub features: usize,
    pub seed: u64,
    pub threshold: f64,
    pub chi_squared_before: f64,
    pub chi_squared_after: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn effect(parameters: &[(&str, serde_json::Value)]) -> NamedEffect {
        let value = |value: &serde_json::Value| Value {
            value: value.clone(),
            unit: "-".into(),
            assumed: None,
            low: None,
            high: None,
        };
        NamedEffect {
            name: "effect".into(),
            title: "Effect".into(),
            channels: vec!["Y_1R".into(), "Y_1L".into(), "Q_1R".into()],
            parameters: parameters
                .iter()
                .map(|(name, of)| ((*name).to_owned(), value(of)))
                .collect(),
            confined_to: Some(IndexMap::from([("zones".into(), json!([3, 4]))])),
            added_by: String::new(),
            stability: None,
        }
    }

    #[test]
    fn what_channels_have_alike_is_told_once() {
        let told = |parameters: &[(&str, serde_json::Value)]| {
            let effect = effect(parameters);
            let one =
                |told: Told<'_>| format!("{} {}{}", told.parameter, told.value.text(), told.on());
            effect.told().into_iter().map(one).collect::<Vec<_>>()
        };
        let alike = [
            ("measurement.gain.Y_1R", json!(0.8)),
            ("measurement.gain.Y_1L", json!(0.8)),
            ("measurement.gain.Q_1R", json!(0.8)),
        ];
        assert_eq!(told(&alike), ["measurement.gain 0.8 on Y_1R, Y_1L, Q_1R"]);
        assert_eq!(told(&alike[..1]), ["measurement.gain 0.8 on Y_1R"]);
        // Equal values of different parameters are not combined.
        let others =
            [("out_of_roundness.wheelset", json!(2)), ("out_of_roundness.harmonic", json!(2))];
        assert_eq!(told(&others), ["out_of_roundness.wheelset 2", "out_of_roundness.harmonic 2"]);
        let low_pass = [
            ("measurement.lowpass", json!(6)),
            ("measurement.lowpass_channels", json!(["Y_1R", "Y_1L"])),
        ];
        assert_eq!(told(&low_pass), ["measurement.lowpass 6 on Y_1R, Y_1L"]);
        assert_eq!(
            told(&[("measurement.swap", json!([["Y_1R", "Y_2R"]]))]),
            ["measurement.swap Y_1R, Y_2R"]
        );
        assert_eq!(effect(&[]).only_in(), ", only in zones 3, 4");
        assert_eq!(NamedEffect { confined_to: None, ..effect(&[]) }.only_in(), "");
    }
}
