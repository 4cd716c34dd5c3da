//! What a diagnosis found: plain data, in the form of `diagnosis.json`.

use indexmap::IndexMap;
use serde::Serialize;

/// The answer.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    pub fishplate: &'static str,
    pub campaign: String,
    /// `explained`, `ambiguous`, `unexplained` or `no significant gap`.
    pub verdict: &'static str,
    /// The verdict in a sentence or two.
    pub says: Vec<String>,
    /// Faults of the recording; the channels are left out of everything else.
    pub faults: Vec<Fault>,
    pub r#where: Vec<Where>,
    pub invariants: Vec<Invariant>,
    /// Those with a probability of less than 0.05 before or after, the least probable first.
    pub trends: Vec<Trend>,
    /// How many were looked at.
    pub trends_tested: usize,
    /// Covariates that go together, so that the campaign cannot tell which of them a trend follows.
    pub together: Vec<String>,
    /// How the sizes of operations on the signals change over the campaign: one size should do.
    pub drifts: Vec<Drift>,
    pub shapes: Vec<Shape>,
    pub causes: Vec<Cause>,
    pub vetoed: Vec<Vetoed>,
    pub shrink: Option<Shrink>,
    /// Share of the gap beyond what is allowed for that the answer leaves.
    pub unexplained_share: f64,
    pub discriminating_measurement: Option<String>,
    /// Per effect, the smallest size that would have been seen.
    pub detectable: Vec<Detectable>,
    /// What would be named next, for what the named effects leave.
    pub nearest: Vec<Nearest>,
    pub how: How,
    pub notes: Vec<String>,
    pub simulations_run: usize,
    /// Simulated time of all runs in s, inside the sections. Not the clock's, so that the same input gives the same bytes.
    pub seconds: f64,
    /// Signals of the worst sections, for figures.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
}

/// Signals of one section, three states of each.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    pub section: String,
    /// Where it is, in words.
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

/// A channel that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// `dropout` or `clipping`.
    pub fault: &'static str,
    pub channel: String,
    pub sections: Vec<String>,
    pub says: String,
}

/// A place where the gap lies.
#[derive(Clone, Debug, Serialize)]
pub struct Where {
    pub quantity: String,
    pub signals: Vec<String>,
    #[serde(serialize_with = "as_numbers")]
    pub zones: Vec<String>,
    pub sections: Vec<String>,
    pub wavelength_or_band: String,
    /// Mean difference, simulated - measured: levels in the unit of the channel, towards the side of the measured one, that is
    /// sign(measured) (simulated - measured); bands as rms simulated over measured, less one.
    pub difference: f64,
    /// Root mean square of the same differences: more than their mean where they are not alike in all its sections and wheels.
    pub difference_rms: f64,
    pub unit: String,
    pub share_of_gap: f64,
    pub p_value: f64,
    /// Below the limit of the false discovery rate.
    pub significant: bool,
    pub says: String,
}

/// A sum of quasi-static values that only some causes can move, mean over the sections, simulated - measured.
#[derive(Clone, Debug, Serialize)]
pub struct Invariant {
    pub name: String,
    /// Off to the same side in all sections, or turning with the curve.
    pub parity: &'static str,
    pub unit: String,
    pub before: f64,
    /// With the causes added.
    pub after: f64,
    /// One standard deviation of what is allowed for.
    pub allowed: f64,
    /// The same beside the causes.
    pub allowed_after: f64,
}

/// How a difference changes with something that the section table says, over all sections: generalised least squares on that alone.
#[derive(Clone, Debug, Serialize)]
pub struct Trend {
    pub quantity: String,
    pub position: String,
    pub signals: Vec<String>,
    pub wavelength_or_band: String,
    pub covariate: String,
    /// What the table says where it is least, and where it is most.
    pub from: String,
    pub to: String,
    /// Of the changes; `-` for ratios.
    pub unit: String,
    pub before: Slope,
    /// With the causes added.
    pub after: Slope,
}

/// What the size of an effect changes by over the range of a covariate, with a 90 % interval.
#[derive(Clone, Debug, Serialize)]
pub struct Drift {
    pub effect: String,
    pub signals: Vec<String>,
    pub parameter: String,
    /// Of the change.
    pub unit: String,
    pub covariate: String,
    /// What the table says where it is least, and where it is most.
    pub from: String,
    pub to: String,
    pub change: f64,
    pub low: f64,
    pub high: f64,
    /// That the size is the same everywhere.
    pub p_value: f64,
}

/// What simulated - measured grows by over the range of a covariate, with a 90 % interval: levels in their unit, in curves turned to one
/// side where they turn with the curve; bands as rms simulated over measured, less one.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Slope {
    pub change: f64,
    pub low: f64,
    pub high: f64,
    /// Of the differences themselves with the covariate, whatever may differ.
    pub correlation: f64,
    /// That there is no such trend.
    pub p_value: f64,
    /// Below the limit of the false discovery rate.
    pub significant: bool,
}

/// How the dynamic content of a group of channels differs, over all sections.
#[derive(Clone, Debug, Serialize)]
pub struct Shape {
    pub quantity: String,
    pub signals: Vec<String>,
    /// Measured over simulated.
    pub rms: Ratio,
    /// Of the percentile that is called the peak, to the larger side of the median.
    pub peak: Ratio,
    /// Of peak over rms.
    pub crest: Ratio,
    /// What the differences of spectra keep to from section to section, if either: `frequency` or `wavelength`.
    pub keeps_to: Option<&'static str>,
    /// Why it is not said; where it is, nothing.
    pub reason: Option<&'static str>,
    /// Share of their scatter that is alike in all sections, compared at the same frequency, and at the same wavelength.
    pub alike_by_frequency: Option<f64>,
    pub alike_by_wavelength: Option<f64>,
    pub strongest: Option<Strongest>,
    pub says: String,
}

/// A ratio with the interval that 90 % of resamples of the sections lie in.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Ratio {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// Where spectra differ most for sure.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Strongest {
    /// Amplitude, measured over simulated.
    pub ratio: f64,
    /// In Hz at the mean speed.
    pub frequency: f64,
    /// In m.
    pub wavelength: Option<f64>,
    /// Waves to one turn of a wheel.
    pub per_wheel_turn: Option<f64>,
}

/// Effects that together may be the cause.
#[derive(Clone, Debug, Serialize)]
pub struct Cause {
    pub rank: usize,
    pub effects: Vec<NamedEffect>,
    pub probability: f64,
    pub in_ambiguity_set: bool,
    /// Twice the logarithm of the Bayes factor against no effect.
    pub evidence: f64,
    pub says: String,
}

#[derive(Clone, Debug, Serialize)]
pub struct NamedEffect {
    pub name: String,
    pub title: String,
    pub parameters: IndexMap<String, Value>,
    /// Channels that it acts on.
    #[serde(skip)]
    pub channels: Vec<String>,
    pub confined_to: Option<IndexMap<String, serde_json::Value>>,
    /// How it was added: by which simulator, or an operation on the signals.
    pub added_by: String,
    /// Share of resamples of the sections in which no other effect has more evidence; of the answer, not of its rivals.
    pub stability: Option<f64>,
}

/// Parameters as they are told: what several channels have alike is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Told<'a> {
    pub parameter: String,
    pub value: &'a Value,
    /// Channels that it is of.
    pub channels: Vec<String>,
}

impl NamedEffect {
    /// Its parameters, to be read.
    #[must_use]
    pub fn told(&self) -> Vec<Told<'_>> {
        let mut told: Vec<Told<'_>> = Vec::new();
        for (name, value) in &self.parameters {
            // A list of names says on which channels the one before acts.
            if let (Some(names), Some(last)) = (value.names(), told.last_mut()) {
                last.channels = names;
                continue;
            }
            match (name.rsplit_once('.').filter(|(_, channel)| self.channels.iter().any(|known| known == channel)), told.last_mut()) {
                (Some((of, channel)), Some(last)) if last.parameter == of && last.value == value => last.channels.push(channel.into()),
                (Some((of, channel)), _) => told.push(Told { parameter: of.into(), value, channels: vec![channel.into()] }),
                (None, _) => told.push(Told { parameter: name.clone(), value, channels: Vec::new() }),
            }
        }
        told
    }

    /// Where it is confined to, such as `, only in zones 3, 4`; nothing where it is everywhere.
    #[must_use]
    pub fn only_in(&self) -> String {
        let parts = self.confined_to.iter().flatten().map(|(column, values)| format!("{column} {}", flat(values)));
        let parts = parts.collect::<Vec<_>>().join(", ");
        if parts.is_empty() { parts } else { format!(", only in {parts}") }
    }
}

impl Told<'_> {
    /// Its channels, such as ` on Y_1R, Y_1L`; nothing where it has none.
    #[must_use]
    pub fn on(&self) -> String {
        if self.channels.is_empty() { String::new() } else { format!(" on {}", self.channels.join(", ")) }
    }
}

impl Value {
    /// What it says where it is no number.
    #[must_use]
    pub fn text(&self) -> String {
        flat(&self.value)
    }

    /// The names that it lists.
    fn names(&self) -> Option<Vec<String>> {
        self.value.as_array()?.iter().map(|name| name.as_str().map(str::to_owned)).collect()
    }
}

/// What a list holds, lists in it as well, with commas.
fn flat(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Array(all) => all.iter().map(flat).collect::<Vec<_>>().join(", "),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A parameter with its interval (90 %).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    pub value: serde_json::Value,
    pub unit: String,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// An effect that improves something and contradicts something else.
#[derive(Clone, Debug, Serialize)]
pub struct Vetoed {
    pub name: String,
    pub size: f64,
    pub parameter: String,
    pub evidence: f64,
    pub says: String,
}

/// How far the gap shrinks on sections that the fit did not see.
#[derive(Clone, Debug, Serialize)]
pub struct Shrink {
    pub measure: String,
    pub before: f64,
    pub after: f64,
    pub fraction_removed: f64,
    /// 90 %, by resampling sections.
    pub low: f64,
    pub high: f64,
    pub held_out: bool,
    pub quantities: Vec<QuantityShrink>,
    pub verdict_before: String,
    pub verdict_after: String,
    /// The same over the quantities that the effects change.
    pub touched: Option<Touched>,
    /// Share of the whitened excess that each effect removes, if several act.
    pub shares: Vec<(String, f64)>,
}

/// How far the gap shrinks where the effects act.
#[derive(Clone, Debug, Serialize)]
pub struct Touched {
    pub quantities: Vec<String>,
    pub before: f64,
    pub after: f64,
    pub fraction_removed: f64,
    /// 90 %, by resampling sections.
    pub low: f64,
    pub high: f64,
    /// Share removed of the squared differences of all values, each divided by the limit of its quantity's standard deviation.
    pub variance_explained: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct QuantityShrink {
    pub id: String,
    pub normalised_std_before: Option<f64>,
    pub normalised_std_after: Option<f64>,
    pub normalised_mean_before: Option<f64>,
    pub normalised_mean_after: Option<f64>,
    /// Of the sum of squared differences, the share removed.
    pub variance_explained: Option<f64>,
    /// Share of the sum of squared differences that the declared noise of the channels makes by itself; nothing where none is declared.
    pub noise_floor: Option<f64>,
    /// The share removed of what is above the noise; nothing where nothing is.
    pub variance_explained_above_noise: Option<f64>,
    /// Share removed of the root mean square of its normalised values, 90 % by resampling sections.
    pub fraction_removed: f64,
    pub low: f64,
    pub high: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct Detectable {
    pub effect: String,
    pub parameter: String,
    pub unit: String,
    /// The size at which nothing changes.
    pub neutral: f64,
    /// Change from neutral at which the whitened change is 5 long; nothing if the range ends before. Of an effect on one of several
    /// channels, where that takes most: on any of them so much would have been seen.
    pub smallest: Option<f64>,
    /// The same on either side of neutral.
    pub below: Option<f64>,
    pub above: Option<f64>,
}

/// An effect that is nearly named.
#[derive(Clone, Debug, Serialize)]
pub struct Nearest {
    pub effect: String,
    pub says: String,
    pub evidence: f64,
    /// What it wants for being looked at further.
    pub wants: String,
}

/// With what the answer was found.
#[derive(Clone, Debug, Serialize)]
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

/// Names that are whole numbers are written as such.
fn as_numbers<S: serde::Serializer>(names: &[String], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(names.iter().map(|name| name.parse::<i64>().map_or_else(|_| name.as_str().into(), serde_json::Value::from)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn effect(parameters: &[(&str, serde_json::Value)]) -> NamedEffect {
        let value = |value: &serde_json::Value| Value { value: value.clone(), unit: "-".into(), low: None, high: None };
        NamedEffect {
            name: "effect".into(),
            title: "Effect".into(),
            channels: vec!["Y_1R".into(), "Y_1L".into(), "Q_1R".into()],
            parameters: parameters.iter().map(|(name, of)| ((*name).to_owned(), value(of))).collect(),
            confined_to: Some(IndexMap::from([("zones".into(), json!([3, 4]))])),
            added_by: String::new(),
            stability: None,
        }
    }

    #[test]
    fn what_channels_have_alike_is_told_once() {
        let told = |parameters: &[(&str, serde_json::Value)]| {
            let effect = effect(parameters);
            let one = |told: Told<'_>| format!("{} {}{}", told.parameter, told.value.text(), told.on());
            effect.told().into_iter().map(one).collect::<Vec<_>>()
        };
        let alike = [("measurement.gain.Y_1R", json!(0.8)), ("measurement.gain.Y_1L", json!(0.8)), ("measurement.gain.Q_1R", json!(0.8))];
        assert_eq!(told(&alike), ["measurement.gain 0.8 on Y_1R, Y_1L, Q_1R"]);
        assert_eq!(told(&alike[..1]), ["measurement.gain 0.8 on Y_1R"]);
        // What only has the same value is another parameter.
        let others = [("out_of_roundness.wheelset", json!(2)), ("out_of_roundness.harmonic", json!(2))];
        assert_eq!(told(&others), ["out_of_roundness.wheelset 2", "out_of_roundness.harmonic 2"]);
        let low_pass = [("measurement.lowpass", json!(6)), ("measurement.lowpass_channels", json!(["Y_1R", "Y_1L"]))];
        assert_eq!(told(&low_pass), ["measurement.lowpass 6 on Y_1R, Y_1L"]);
        assert_eq!(told(&[("measurement.swap", json!([["Y_1R", "Y_2R"]]))]), ["measurement.swap Y_1R, Y_2R"]);
        assert_eq!(effect(&[]).only_in(), ", only in zones 3, 4");
        assert_eq!(NamedEffect { confined_to: None, ..effect(&[]) }.only_in(), "");
    }
}
