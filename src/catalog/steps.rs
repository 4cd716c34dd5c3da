//! Steps of a filter chain.

use super::forms::{Choice, Form, Part};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    LowPass,
    HighPass,
    BandPass,
    BandStop,
    SlidingMean,
    SlidingRms,
    Resample,
    RemoveMean,
    Magnitude,
}

#[derive(Debug)]
pub struct StepEntry {
    pub kind: StepKind,
    pub form: Form,
    pub about: &'static str,
}

const BUTTERWORTH_NUMBERS: &[(&str, Option<f64>)] = &[("order", Some(4.0))];
const BUTTERWORTH_CHOICES: &[Choice] = &[
    Choice {
        name: "phase",
        words: &["zero-phase", "causal", "causal-from-rest"],
        about: "Forward and backward; or one pass from the steady state of the first sample; or one pass from rest.",
    },
    Choice {
        name: "edge",
        words: &["as-applied", "per-pass"],
        about: "Whether the frequencies are the -3 dB points of the filter as applied, or of each pass.",
    },
];
const WINDOW_CHOICES: &[Choice] = &[Choice {
    name: "ends",
    words: &["samples", "integral"],
    about: "Mean of the samples a <= x < a + window, or the trapezoidal integral over the window.",
}];

const fn butterworth(kind: StepKind, head: &'static [Part], about: &'static str) -> StepEntry {
    StepEntry { kind, form: Form { head, numbers: BUTTERWORTH_NUMBERS, choices: BUTTERWORTH_CHOICES }, about }
}

const fn window(kind: StepKind, head: &'static [Part], about: &'static str) -> StepEntry {
    StepEntry { kind, form: Form { head, numbers: &[], choices: WINDOW_CHOICES }, about }
}

const fn bare(kind: StepKind, head: &'static [Part], about: &'static str) -> StepEntry {
    StepEntry { kind, form: Form { head, numbers: &[], choices: &[] }, about }
}

pub const STEPS: &[StepEntry] = &[
    butterworth(StepKind::LowPass, &[Part::Word("low-pass"), Part::Frequency("cut-off")], "Butterworth low-pass over the whole record."),
    butterworth(StepKind::HighPass, &[Part::Word("high-pass"), Part::Frequency("cut-off")], "Butterworth high-pass over the whole record."),
    butterworth(
        StepKind::BandPass,
        &[Part::Word("band-pass"), Part::Frequency("low"), Part::Word("to"), Part::Frequency("high")],
        "Butterworth band-pass over the whole record; the order is that of each edge.",
    ),
    butterworth(
        StepKind::BandStop,
        &[Part::Word("band-stop"), Part::Frequency("low"), Part::Word("to"), Part::Frequency("high")],
        "Butterworth band-stop over the whole record; the order is that of each edge.",
    ),
    window(
        StepKind::SlidingMean,
        &[Part::Word("sliding"), Part::Word("mean"), Part::Extent("window"), Part::Word("every"), Part::Extent("step")],
        "Mean in a window that slides from the start of the section and stays inside it.",
    ),
    window(
        StepKind::SlidingRms,
        &[Part::Word("sliding"), Part::Word("rms"), Part::Extent("window"), Part::Word("every"), Part::Extent("step")],
        "Root mean square in a window that slides from the start of the section and stays inside it.",
    ),
    bare(
        StepKind::Resample,
        &[Part::Word("resample"), Part::Word("every"), Part::Extent("step")],
        "Linear interpolation of the whole record onto equal steps; over a length, filters that follow take cycles per length.",
    ),
    bare(StepKind::RemoveMean, &[Part::Word("remove"), Part::Word("mean")], "Takes the mean of the section away."),
    bare(StepKind::Magnitude, &[Part::Word("magnitude")], "Absolute values, sample by sample."),
];
