//! Metrics: one number from the simulated and the measured signal of a section. The measured signal
//! is the reference.

use std::cell::OnceCell;

use super::forms::{
    Form,
    FormPart::{self, Frequency, Signal, Word},
    NumberOption,
};
use crate::metrics::{coherence, hysteresis, pair};
use crate::units::Dimension;

/// The two signals, cut to the section and at common points unless the metric needs none; SI.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Axis values at which both have a sample; only for metrics at common points.
    pub axis: &'a [f64],
    pub simulated: &'a [f64],
    pub measured: &'a [f64],
    /// Samples of the measured signal per second, or per metre where the record has no time.
    pub rate: f64,
    /// The frequency band of the wording.
    pub band: Option<(f64, f64)>,
    /// The simulated and the measured signal used in place of the axis, where the wording names
    /// one.
    pub over: Option<(&'a [f64], &'a [f64])>,
    /// The shift at which both agree best, once a metric has looked for it.
    pub best_shift: &'a OnceCell<isize>,
}

/// The best value of a metric. A limit must admit it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Best {
    /// The nearer to this value, from either side, the better.
    Near(f64),
    /// No value is below this; smaller is better.
    Least(f64),
    /// No value is above this; larger is better.
    Greatest(f64),
}

impl Best {
    pub fn value(self) -> f64 {
        match self {
            Self::Near(value) | Self::Least(value) | Self::Greatest(value) => value,
        }
    }

    /// As text: `1, larger is better`.
    pub fn in_words(self) -> String {
        let way = match self {
            Self::Near(_) => "nearer",
            Self::Least(_) => "smaller",
            Self::Greatest(_) => "larger",
        };
        format!("{}, {way} is better", self.value())
    }
}

/// A metric with the parameters of its wording.
#[derive(Clone, Copy, Debug)]
pub struct Metric(pub &'static MetricEntry, pub Asked);

/// The parameters that the wording of a metric has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// Number of points of both distributions.
    pub points: Option<usize>,
    /// The frequency band from the first value up to the second, SI.
    pub band: Option<(f64, f64)>,
}

impl Metric {
    /// Whether the simulated signal is first interpolated at the points of the measured one.
    /// Metrics of distributions do not need that after a window or resampling.
    pub fn on_common_points(self, chain_keeps_samples: bool) -> bool {
        self.0.common_points && (chain_keeps_samples || !self.0.of_distributions)
    }

    /// Number of points of both distributions, of which the metric is then computed in place of the
    /// samples.
    pub fn points(self) -> Option<usize> {
        self.1.points
    }

    /// # Errors
    /// The reason why it is not defined.
    pub fn run(self, pair: &Pair<'_>) -> Result<f64, String> {
        (self.0.run)(&Pair { band: self.1.band, ..*pair })
    }
}

impl PartialEq for Metric {
    fn eq(&self, other: &Self) -> bool {
        self.0.form.head == other.0.form.head && self.1 == other.1
    }
}

/// What is said of a metric that is [`MetricEntry::unverified`].
pub const NOT_CHECKED: &str = "not checked against a reference implementation";

#[derive(Debug)]
pub struct MetricEntry {
    pub form: Form,
    /// Dimension of the result, from those of the signals and of the axis.
    pub gives: fn(Dimension, Dimension) -> Dimension,
    /// Whether the simulated signal is first interpolated at the points of the measured one.
    pub common_points: bool,
    /// Whether it uses the values regardless of their order, so that both sides may have different
    /// numbers of values.
    pub of_distributions: bool,
    pub best: Best,
    pub about: &'static str,
    pub source: &'static str,
    /// Not checked against a reference implementation: reports say so beside its numbers.
    pub unverified: bool,
    /// The error gives the reason why it is not defined.
    pub run: fn(&Pair<'_>) -> Result<f64, String>,
}

impl MetricEntry {
    /// The metric with this name in expressions.
    pub fn called(name: &str) -> Option<&'static Self> {
        METRICS.iter().find(|entry| entry.function_name() == name)
    }

    /// Its words before the first slot, joined: `theil_inequality`, `hysteresis_maximum`,
    /// `coherence`.
    pub fn function_name(&self) -> String {
        let head = self.form.head;
        let slot = head.iter().position(|part| !matches!(part, FormPart::Word(_)));
        // The last word before a slot is a preposition: `over`, `from`.
        let words = &head[..slot.map_or(head.len(), |slot| slot.saturating_sub(1))];
        words.iter().filter_map(FormPart::word).collect::<Vec<_>>().join("_").replace('-', "_")
    }

    /// The call in expressions: `coherence(<low>, <high>)`, `matching_probability` with or without
    /// `(<points>)`.
    pub fn call_in_words(&self) -> String {
        let slots = self.form.head.iter().filter_map(|part| match part {
            FormPart::Word(_) => None,
            FormPart::Number(name, _)
            | FormPart::Extent(name)
            | FormPart::Frequency(name)
            | FormPart::FrequencyOrZero(name)
            | FormPart::ExtentOrSample(name)
            | FormPart::Reducer(name)
            | FormPart::Signal(name) => Some(format!("<{name}>")),
        });
        let slots: Vec<String> = slots
            .chain(self.form.numbers.iter().map(|option| format!("<{}>", option.name)))
            .collect();
        let name = self.function_name();
        if slots.is_empty() { name } else { format!("{name}({})", slots.join(", ")) }
    }
}

const fn form(head: &'static [FormPart]) -> Form {
    Form { head, numbers: &[], choices: &[] }
}

/// A plain number from the samples at common points.
const fn entry(
    head: &'static [FormPart],
    best: Best,
    about: &'static str,
    source: &'static str,
    run: fn(&Pair<'_>) -> Result<f64, String>,
) -> MetricEntry {
    MetricEntry {
        form: form(head),
        gives: |_, _| Dimension::ONE,
        common_points: true,
        of_distributions: false,
        best,
        about,
        source,
        unverified: false,
        run,
    }
}

/// Of the loops of the signal over another one.
const fn of_loops(
    head: &'static [FormPart],
    about: &'static str,
    run: fn(&Pair<'_>) -> Result<f64, String>,
) -> MetricEntry {
    MetricEntry {
        gives: |signal, _| signal,
        common_points: false,
        ..entry(head, Best::Least(0.0), about, "EN 15273-2, stationary sway test", run)
    }
}

/// Words, best value, description, source and function of both signals.
macro_rules! ratio {
    ([$($word:literal)*], $way:ident($best:literal), $about:expr, $source:expr, $run:ident) => {
        entry(&[$(Word($word)),*], Best::$way($best), $about, $source, |p| {
            said(pair::$run(p.simulated, p.measured))
        })
    };
}

macro_rules! of_distributions {
    ([$($word:literal)*], $way:ident($best:literal), $about:expr, $source:expr, $run:ident) => {
        MetricEntry {
            form: Form { numbers: POINTS, ..form(&[$(Word($word)),*]) },
            of_distributions: true,
            ..ratio!([], $way($best), $about, $source, $run)
        }
    };
}

macro_rules! unverified {
    ($part:literal, $about:expr, $run:ident) => {
        MetricEntry {
            unverified: true,
            ..ratio!(["cora" $part], Greatest(1.0), $about, CORA, $run)
        }
    };
}

/// Option of metrics of distributions.
const POINTS: &[NumberOption] = &[NumberOption { name: "points", default: None, with_unit: false }];

const SG: &str = "Sprague & Geers 2004";
const RUSSELL: &str = "Russell 1997";
const THEIL: &str = "Theil 1966";
const ISO: &str = "ISO/TS 18571:2014";
const CORA: &str = "Gehre, Gades & Wernicke 2009, as described for Altair HyperGraph";
const BOGOJEVIC: &str = "Bogojevic & Lucanin 2014, as described by Goetz & Polach";

pub const METRICS: &[MetricEntry] = &[
    ratio!(
        ["sprague-geers" "magnitude"], Near(0.0),
        "Square root of the ratio of the sums of squares, minus 1; negative where the simulation is smaller.",
        SG,
        sprague_geers_magnitude
    ),
    ratio!(
        ["sprague-geers" "phase"], Least(0.0),
        "Angle between the two signals as vectors, divided by pi: 0 for proportional signals, 0.5 for orthogonal ones, 1 for inverted ones.",
        SG,
        sprague_geers_phase
    ),
    ratio!(
        ["sprague-geers" "comprehensive"], Least(0.0),
        "Square root of the sum of the squares of the magnitude and phase errors.",
        SG,
        sprague_geers_comprehensive
    ),
    ratio!(
        ["russell" "magnitude"], Near(0.0),
        "Logarithmic magnitude error.",
        RUSSELL,
        russell_magnitude
    ),
    ratio!(
        ["russell" "phase"], Least(0.0),
        "The same as the Sprague & Geers phase error.",
        RUSSELL,
        russell_phase
    ),
    ratio!(
        ["russell" "comprehensive"], Least(0.0),
        "Square root of pi/4 times the sum of the squares of the magnitude and phase errors.",
        RUSSELL,
        russell_comprehensive
    ),
    ratio!(
        ["theil" "inequality"], Least(0.0),
        "Root mean square difference divided by the sum of the root mean squares, from 0 to 1.",
        THEIL,
        theil_u1
    ),
    ratio!(
        ["theil" "bias"], Least(0.0),
        "Share of the mean square difference that is a difference of the means.",
        THEIL,
        theil_bias
    ),
    ratio!(
        ["theil" "variance"], Least(0.0),
        "Share of the mean square difference that is a difference of the standard deviations.",
        THEIL,
        theil_variance
    ),
    ratio!(
        ["theil" "covariance"], Greatest(1.0),
        "Share of the mean square difference that is a lack of correlation: what is neither bias nor variance.",
        THEIL,
        theil_covariance
    ),
    ratio!(
        ["weighted" "integrated" "factor"], Greatest(1.0),
        "WIFac: 1 for equal signals, 0 for signals of opposite sign throughout.",
        "Ray et al., NCHRP 22-24",
        weighted_integrated_factor
    ),
    ratio!(
        ["correlation"],
        Greatest(1.0),
        "Pearson correlation of the samples.",
        "Pearson 1895",
        correlation
    ),
    ratio!(
        ["mirrored_correlation"],
        Least(0.0),
        "Pearson correlation with the simulated samples in reverse order: near 1 if a record is mirrored.",
        "definition",
        mirrored_correlation
    ),
    ratio!(
        ["iso18571" "corridor"], Greatest(1.0),
        "Agreement with two corridors about the measurement: 5 % and 50 % of its largest magnitude either way.",
        ISO,
        iso18571_corridor
    ),
    ratio!(
        ["iso18571" "phase"], Greatest(1.0),
        "Rating of the shift with the best correlation: 1 at none, 0 at 20 % of the samples.",
        ISO,
        iso18571_phase
    ),
    ratio!(
        ["iso18571" "magnitude"], Greatest(1.0),
        "Rating of the amplitudes after the shift and dynamic time warping.",
        ISO,
        iso18571_magnitude
    ),
    ratio!(
        ["iso18571" "slope"], Greatest(1.0),
        "Rating of the smoothed slopes after the shift.",
        ISO,
        iso18571_slope
    ),
    ratio!(
        ["iso18571" "overall"], Greatest(1.0),
        "0.4 corridor + 0.2 (phase + magnitude + slope).",
        ISO,
        iso18571_overall
    ),
    unverified!("corridor", "Corridor rating, with the corridors of ISO/TS 18571.", cora_corridor),
    unverified!(
        "progression",
        "Rating of the shape at the best shift: ((cosine + 1) / 2)^10.",
        cora_progression
    ),
    unverified!(
        "size",
        "Rating of the size at the best shift: the smaller over the larger sum of squares.",
        cora_size
    ),
    unverified!(
        "phase",
        "Rating of the best shift: 1 up to 1 %, 0 from 12 % of the interval.",
        cora_phase
    ),
    unverified!("total", "(corridor + 0.5 progression + 0.25 size + 0.25 phase) / 2.", cora_total),
    MetricEntry {
        gives: |_, axis| axis,
        ..entry(
            &[Word("shift")],
            Best::Near(0.0),
            "Shift to be added to the measured axis for the largest correlation, up to a quarter of the section.",
            "definition",
            |p| said(pair::shift(p.axis, p.simulated, p.measured)),
        )
    },
    MetricEntry {
        gives: |signal, _| signal,
        ..entry(
            &[Word("drift")],
            Best::Near(0.0),
            "Change over the section of the regression line of measured minus simulated samples.",
            "definition",
            |p| said(pair::drift(p.axis, p.simulated, p.measured)),
        )
    },
    ratio!(
        ["misfit"],
        Least(0.0),
        "Sum of the squared differences divided by the smaller of the sums of squares.",
        "Kraft et al. 2013, as described by Goetz & Polach",
        kraft_misfit
    ),
    of_distributions!(
        ["matching" "probability"], Greatest(1.0),
        "Probability of equal variances (F test) times the agreement of the means.",
        BOGOJEVIC,
        bogojevic
    ),
    of_distributions!(
        ["fisher" "probability"], Greatest(1.0),
        "Two-sided probability of the F test that the variances are equal, for independent values; n - 1 degrees of freedom each.",
        BOGOJEVIC,
        bogojevic_variance_probability
    ),
    of_distributions!(
        ["variance" "ratio"], Near(1.0),
        "Variance (n - 1) of the simulation over that of the measurement.",
        BOGOJEVIC,
        bogojevic_variance_ratio
    ),
    of_distributions!(
        ["agreement" "in" "mean"], Greatest(1.0),
        "1 less the difference of the means over the larger magnitude of them; below 0 where their signs differ.",
        BOGOJEVIC,
        bogojevic_mean_term
    ),
    MetricEntry {
        gives: |signal, _| signal,
        ..ratio!(["root-mean-square" "difference"], Least(0.0), "Root mean square of the differences of the samples.", "definition", root_mean_square_error)
    },
    ratio!(
        ["normalised" "root-mean-square" "difference"], Least(0.0),
        "The same over the root mean square of the measurement: Theil's U2.",
        THEIL,
        theil_u2
    ),
    ratio!(
        ["range-normalised" "root-mean-square" "difference"], Least(0.0),
        "The same over the range of the measurement.",
        "definition",
        relative_to_range
    ),
    MetricEntry {
        common_points: false,
        of_distributions: true,
        ..ratio!(
        ["root-mean-square" "ratio"], Near(1.0),
            "Root mean square of the simulation over that of the measurement; behind a band-pass filter that of the band.",
            "definition",
            rms_ratio
        )
    },
    MetricEntry {
        gives: |signal, _| signal,
        form: Form {
            numbers: POINTS,
            ..form(&[Word("area"), Word("between"), Word("distributions")])
        },
        of_distributions: true,
        ..entry(
            &[],
            Best::Least(0.0),
            "Area between the two cumulative distributions of the samples.",
            "Ferson, Oberkampf & Ginzburg 2008",
            |p| said(area(p.simulated, p.measured)),
        )
    },
    entry(
        &[Word("coherence"), Word("from"), Frequency("low"), Word("to"), Frequency("high")],
        Best::Greatest(1.0),
        "Mean coherence of the spectral lines from the first frequency to below the second: Welch's method, Hann windows of 256 samples, 50 % overlap.",
        "Welch 1967",
        |p| said(coherence::in_band(p.simulated, p.measured, p.rate, in_band(p)?)),
    ),
    entry(
        &[
            Word("shared"),
            Word("content"),
            Word("from"),
            Frequency("low"),
            Word("to"),
            Frequency("high"),
        ],
        Best::Greatest(1.0),
        "Share of the content of the band that both signals have in common at their best shift, less what unrelated signals have by chance: about 0 for two noises, 1 where one signal is made from the other.",
        "Carter, Knapp & Nuttall 1973",
        |p| said(coherence::shared((p.simulated, p.measured, p.best_shift), p.rate, in_band(p)?)),
    ),
    entry(
        &[
            Word("unexplained"),
            Word("content"),
            Word("from"),
            Frequency("low"),
            Word("to"),
            Frequency("high"),
        ],
        Best::Least(0.0),
        "What the other signal does not explain of the band: its share of the content times the ratio of its spectral density to that in the upper 40 % of the spectrum, the smaller one of both signals. Below 0.1 where one signal is the other one with noise.",
        "definition",
        |p| {
            said(coherence::unexplained(
                (p.simulated, p.measured, p.best_shift),
                p.rate,
                in_band(p)?,
            ))
        },
    ),
    entry(
        &[
            Word("least"),
            Word("ratio"),
            Word("of"),
            Word("spectra"),
            Word("from"),
            Frequency("low"),
            Word("to"),
            Frequency("high"),
        ],
        Best::Greatest(1.0),
        "Smallest ratio of the spectral densities of both signals at a line of the band, of the smaller one over the larger one: near 0 where one signal lacks what the other one has.",
        "definition",
        |p| said(coherence::least_ratio((p.simulated, p.measured), p.rate, in_band(p)?)),
    ),
    of_loops(
        &[Word("hysteresis"), Word("maximum"), Word("over"), Signal("axis")],
        "Largest difference of the hysteresis loops of the signal over another one: simulated and measured on the same branch.",
        |p| loop_error(p).map(|error| error.maximum),
    ),
    of_loops(
        &[Word("hysteresis"), Word("mean"), Word("over"), Signal("axis")],
        "Mean difference of the hysteresis loops of the signal over another one: simulated and measured on the same branch.",
        |p| loop_error(p).map(|error| error.mean),
    ),
];

/// The frequencies of the wording.
fn in_band(pair: &Pair<'_>) -> Result<(f64, f64), String> {
    pair.band.ok_or_else(|| "the frequencies are missing".into())
}

/// Why it is not defined, in words.
fn said<T>(value: Result<T, impl std::fmt::Display>) -> Result<T, String> {
    value.map_err(|undefined| undefined.to_string())
}

/// The area metric; for equal numbers of values the faster form.
fn area(simulated: &[f64], measured: &[f64]) -> Result<f64, pair::Undefined> {
    if simulated.len() == measured.len() {
        pair::area_metric(simulated, measured)
    } else {
        pair::area_between(simulated, measured)
    }
}

/// Share of the input's range by which it must reverse to count as a turning point.
const TURNING: f64 = 0.05;

fn loop_error(pair: &Pair<'_>) -> Result<hysteresis::Matching, String> {
    let (x_simulated, x_measured) = pair.over.ok_or("the signal for the loop's axis is missing")?;
    let simulated = hysteresis::Loop { x: x_simulated, y: pair.simulated };
    let measured = hysteresis::Loop { x: x_measured, y: pair.measured };
    said(hysteresis::matching(simulated, measured, TURNING))
}
