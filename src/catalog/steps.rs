//! Steps of a filter chain.

use super::forms::{
    Choice, Form,
    FormPart::{self, Extent, ExtentOrSample, Frequency, FrequencyOrZero, Number, Reducer, Word},
    NumberOption,
};
use crate::units::Dimension;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    LowPass,
    HighPass,
    BandPass,
    BandStop,
    TransferFunction,
    Sliding,
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

const BUTTERWORTH_NUMBERS: &[NumberOption] =
    &[NumberOption { name: "order", default: Some(4.0), with_unit: false }];
const BUTTERWORTH_CHOICES: &[Choice] = &[
    Choice {
        name: "phase",
        words: &["zero-phase", "causal", "causal-from-rest"],
        about: "Forward and backward; or one pass, starting from the steady state of the first sample; or one pass, starting from zero.",
    },
    Choice {
        name: "edge",
        words: &["as-applied", "per-pass"],
        about: "Whether the frequencies are the -3 dB points of the filter as applied or of each pass.",
    },
];
const WINDOW_CHOICES: &[Choice] = &[
    Choice {
        name: "ends",
        words: &["samples", "integral"],
        about: "For a sliding mean or rms: of the samples a <= x < a + window, or the integral of the linearly interpolated signal over the window, divided by its width.",
    },
    Choice {
        name: "short sections",
        words: &["whole-windows", "short-sections"],
        about: "Whether a section shorter than the window has no value, or is one window by itself, both ends included.",
    },
];

const fn butterworth(kind: StepKind, head: &'static [FormPart], about: &'static str) -> StepEntry {
    StepEntry {
        kind,
        form: Form { head, numbers: BUTTERWORTH_NUMBERS, choices: BUTTERWORTH_CHOICES },
        about,
    }
}

const GAIN: &[NumberOption] = &[NumberOption { name: "gain", default: Some(1.0), with_unit: true }];
const TRANSFER_CHOICES: &[Choice] = &[
    Choice {
        name: "phase",
        words: &["causal", "causal-from-rest", "zero-phase"],
        about: "For a transfer function: one pass, starting from the steady state of the first sample; or one pass, starting from zero; or forward and backward, which squares the magnitude but not the gain.",
    },
    Choice {
        name: "warping",
        words: &["pre-warped", "plain"],
        about: "Whether the frequency of each pole and zero is pre-warped, so that the bilinear transformation keeps it, or not, so that it becomes lower.",
    },
];

const fn transfer(head: &'static [FormPart], about: &'static str) -> StepEntry {
    StepEntry {
        kind: StepKind::TransferFunction,
        form: Form { head, numbers: GAIN, choices: TRANSFER_CHOICES },
        about,
    }
}

const ABOVE_ZERO: FormPart = Frequency("frequency");
const FROM_ZERO: FormPart = FrequencyOrZero("frequency");
const QUALITY: FormPart = Number("quality", Dimension::ONE);

const fn bare(kind: StepKind, head: &'static [FormPart], about: &'static str) -> StepEntry {
    StepEntry { kind, form: Form { head, numbers: &[], choices: &[] }, about }
}

/// The wording of two poles, and what follows it.
macro_rules! poles {
    ($($zeros:expr),*) => {
        &[Word("transfer"), Word("function"), Word("poles"), ABOVE_ZERO, Word("quality"), QUALITY, $($zeros),*]
    };
}

pub const STEPS: &[StepEntry] = &[
    butterworth(
        StepKind::LowPass,
        &[Word("low-pass"), Frequency("cut-off")],
        "Butterworth low-pass over the whole record.",
    ),
    butterworth(
        StepKind::HighPass,
        &[Word("high-pass"), Frequency("cut-off")],
        "Butterworth high-pass over the whole record.",
    ),
    butterworth(
        StepKind::BandPass,
        &[Word("band-pass"), Frequency("low"), Word("to"), Frequency("high")],
        "Butterworth band-pass over the whole record; the order is that of each edge.",
    ),
    butterworth(
        StepKind::BandStop,
        &[Word("band-stop"), Frequency("low"), Word("to"), Frequency("high")],
        "Butterworth band-stop over the whole record; the order is that of each edge.",
    ),
    transfer(
        &[Word("transfer"), Word("function"), Word("pole"), ABOVE_ZERO],
        "One real pole: 1/(1 + s/p), p = 2π times its frequency, over the whole record.",
    ),
    transfer(
        &[Word("transfer"), Word("function"), Word("pole"), ABOVE_ZERO, Word("zero"), FROM_ZERO],
        "One real pole and one real zero: (1 + s/z)/(1 + s/p); with the zero at 0 Hz (s/p)/(1 + s/p).",
    ),
    transfer(poles![], "Two poles: 1/P, P = 1 + s/(quality p) + (s/p)²."),
    transfer(
        poles![Word("zero"), FROM_ZERO],
        "Two poles and one real zero: (1 + s/z)/P; with the zero at 0 Hz (s/p)/P.",
    ),
    transfer(
        poles![Word("zeros"), FROM_ZERO],
        "Two poles and two zeros without damping: (1 + (s/z)²)/P; with the zeros at 0 Hz (s/p)²/P.",
    ),
    transfer(
        poles![Word("zeros"), ABOVE_ZERO, Word("quality"), QUALITY],
        "Two poles and two zeros: (1 + s/(quality z) + (s/z)²)/P.",
    ),
    StepEntry {
        kind: StepKind::Sliding,
        form: Form {
            head: &[
                Word("sliding"),
                Reducer("value"),
                Extent("window"),
                Word("every"),
                ExtentOrSample("step"),
            ],
            numbers: &[],
            choices: WINDOW_CHOICES,
        },
        about: "A value of each window that slides along the section, from its start; all windows are inside the section. The value is `mean`, `rms`, `rms_about_trend`, `std`, `minimum`, `maximum`, `peak`, `range`, `median`, `p<number>` or `slope`.",
    },
    bare(
        StepKind::Resample,
        &[Word("resample"), Word("every"), Extent("step")],
        "Linear interpolation of the whole record at equal steps; after resampling over a length, filters have frequencies in cycles per length.",
    ),
    bare(
        StepKind::RemoveMean,
        &[Word("remove"), Word("mean")],
        "Subtracts the mean of the section.",
    ),
    bare(StepKind::Magnitude, &[Word("magnitude")], "Absolute values, sample by sample."),
];
