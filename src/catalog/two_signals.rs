//! Metrics: one number from the simulated and the measured signal of a section. The measured signal is the reference.

use super::forms::{Form, NumberOption, Part};
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
    /// The simulated and the measured signal used in place of the axis, where the wording names one.
    pub over: Option<(&'a [f64], &'a [f64])>,
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
    /// Whether the simulated signal is first interpolated at the points of the measured one. Metrics of distributions do not need
    /// that after a window or resampling.
    pub fn on_common_points(self, chain_keeps_samples: bool) -> bool {
        self.0.common_points && (chain_keeps_samples || !self.0.of_distributions)
    }

    /// # Errors
    /// The reason why it is not defined.
    pub fn run(self, pair: &Pair<'_>) -> Result<f64, String> {
        let pair = &Pair { band: self.1.band, ..*pair };
        let Some(points) = self.1.points else { return (self.0.run)(pair) };
        let of = |signal: &[f64]| pair::quantiles(signal, points).map_err(|undefined| undefined.to_string());
        let (simulated, measured) = (of(pair.simulated)?, of(pair.measured)?);
        (self.0.run)(&Pair { simulated: &simulated, measured: &measured, ..*pair })
    }
}

impl PartialEq for Metric {
    fn eq(&self, other: &Self) -> bool {
        self.0.form.head == other.0.form.head && self.1 == other.1
    }
}

#[derive(Debug)]
pub struct MetricEntry {
    pub form: Form,
    /// Dimension of the result, from those of the signals and of the axis.
    pub gives: fn(Dimension, Dimension) -> Dimension,
    /// Whether the simulated signal is first interpolated at the points of the measured one.
    pub common_points: bool,
    /// Whether it uses the values regardless of their order, so that both sides may have different numbers of values.
    pub of_distributions: bool,
    pub best: Best,
    pub about: &'static str,
    pub source: &'static str,
    /// The error gives the reason why it is not defined.
    pub run: fn(&Pair<'_>) -> Result<f64, String>,
}

impl MetricEntry {
    /// The metric with this name in expressions.
    pub fn called(name: &str) -> Option<&'static Self> {
        METRICS.iter().find(|entry| entry.function_name() == name)
    }

    /// Its words before the first slot, joined: `theil_inequality`, `hysteresis_maximum`, `coherence`.
    pub fn function_name(&self) -> String {
        let head = self.form.head;
        let slot = head.iter().position(|part| !matches!(part, Part::Word(_)));
        // The last word before a slot is a preposition: `over`, `from`.
        let words = &head[..slot.map_or(head.len(), |slot| slot.saturating_sub(1))];
        let words: Vec<&str> = words.iter().filter_map(|part| if let Part::Word(word) = part { Some(*word) } else { None }).collect();
        words.join("_").replace('-', "_")
    }

    /// The call in expressions: `coherence(<low>, <high>)`, `matching_probability` with or without `(<points>)`.
    pub fn call_in_words(&self) -> String {
        let slots = self.form.head.iter().filter_map(|part| match part {
            Part::Word(_) => None,
            Part::Number(name, _) | Part::Extent(name) | Part::Frequency(name) | Part::FrequencyOrZero(name) | Part::Signal(name) => {
                Some(format!("<{name}>"))
            }
        });
        let slots: Vec<String> = slots.chain(self.form.numbers.iter().map(|option| format!("<{}>", option.name))).collect();
        let name = self.function_name();
        if slots.is_empty() { name } else { format!("{name}({})", slots.join(", ")) }
    }
}

const fn form(head: &'static [Part]) -> Form {
    Form { head, numbers: &[], choices: &[] }
}

macro_rules! ratio {
    ($head:expr, $best:expr, $about:expr, $source:expr, $run:path) => {
        MetricEntry {
            form: form($head),
            gives: |_, _| Dimension::ONE,
            common_points: true,
            of_distributions: false,
            best: $best,
            about: $about,
            source: $source,
            run: |p| $run(p.simulated, p.measured).map_err(|undefined| undefined.to_string()),
        }
    };
}

macro_rules! of_signal {
    ($head:expr, $common:expr, $about:expr, $source:expr, $run:path) => {
        MetricEntry { gives: |signal, _| signal, common_points: $common, ..ratio!($head, Best::Least(0.0), $about, $source, $run) }
    };
}

/// Option of metrics of distributions.
const POINTS: &[NumberOption] = &[NumberOption { name: "points", default: None, with_unit: false }];

const SG: &str = "Sprague & Geers 2004";
const RUSSELL: &str = "Russell 1997";

pub const METRICS: &[MetricEntry] = &[
    ratio!(
        &[Part::Word("sprague-geers"), Part::Word("magnitude")],
        Best::Near(0.0),
        "Square root of the ratio of the sums of squares, minus 1; negative where the simulation is smaller.",
        SG,
        pair::sprague_geers_magnitude
    ),
    ratio!(
        &[Part::Word("sprague-geers"), Part::Word("phase")],
        Best::Least(0.0),
        "Angle between the two signals as vectors, divided by pi: 0 for proportional signals, 0.5 for orthogonal ones, 1 for inverted ones.",
        SG,
        pair::sprague_geers_phase
    ),
    ratio!(
        &[Part::Word("sprague-geers"), Part::Word("comprehensive")],
        Best::Least(0.0),
        "Square root of the sum of the squares of the magnitude and phase errors.",
        SG,
        pair::sprague_geers_comprehensive
    ),
    ratio!(
        &[Part::Word("russell"), Part::Word("magnitude")],
        Best::Near(0.0),
        "Logarithmic magnitude error.",
        RUSSELL,
        pair::russell_magnitude
    ),
    ratio!(
        &[Part::Word("russell"), Part::Word("phase")],
        Best::Least(0.0),
        "The same as the Sprague & Geers phase error.",
        RUSSELL,
        pair::russell_phase
    ),
    ratio!(
        &[Part::Word("russell"), Part::Word("comprehensive")],
        Best::Least(0.0),
        "Square root of pi/4 times the sum of the squares of the magnitude and phase errors.",
        RUSSELL,
        pair::russell_comprehensive
    ),
    ratio!(
        &[Part::Word("theil"), Part::Word("inequality")],
        Best::Least(0.0),
        "Root mean square difference divided by the sum of the root mean squares, from 0 to 1.",
        "Theil 1966",
        pair::theil_u1
    ),
    ratio!(
        &[Part::Word("weighted"), Part::Word("integrated"), Part::Word("factor")],
        Best::Greatest(1.0),
        "WIFac: 1 for equal signals, 0 for signals of opposite sign throughout.",
        "Ray et al., NCHRP 22-24",
        pair::weighted_integrated_factor
    ),
    ratio!(&[Part::Word("correlation")], Best::Greatest(1.0), "Pearson correlation of the samples.", "Pearson 1895", pair::correlation),
    ratio!(
        &[Part::Word("mirrored_correlation")],
        Best::Least(0.0),
        "Pearson correlation with the simulated samples in reverse order: near 1 if a record is mirrored.",
        "definition",
        pair::mirrored_correlation
    ),
    MetricEntry {
        form: form(&[Part::Word("shift")]),
        gives: |_, axis| axis,
        common_points: true,
        of_distributions: false,
        best: Best::Near(0.0),
        about: "Shift to be added to the measured axis for the largest correlation, up to a quarter of the section.",
        source: "definition",
        run: |p| pair::shift(p.axis, p.simulated, p.measured).map_err(|undefined| undefined.to_string()),
    },
    MetricEntry {
        form: form(&[Part::Word("drift")]),
        gives: |signal, _| signal,
        common_points: true,
        of_distributions: false,
        best: Best::Near(0.0),
        about: "Change over the section of the regression line of measured minus simulated samples.",
        source: "definition",
        run: |p| pair::drift(p.axis, p.simulated, p.measured).map_err(|undefined| undefined.to_string()),
    },
    ratio!(
        &[Part::Word("misfit")],
        Best::Least(0.0),
        "Sum of the squared differences divided by the smaller of the sums of squares.",
        "Kraft et al. 2013, as described by Goetz & Polach",
        pair::kraft_misfit
    ),
    MetricEntry {
        form: Form { numbers: POINTS, ..form(&[Part::Word("matching"), Part::Word("probability")]) },
        of_distributions: true,
        ..ratio!(
            &[],
            Best::Greatest(1.0),
            "Probability of equal variances (F test) times the agreement of the means.",
            "Bogojevic & Lucanin 2014, as described by Goetz & Polach",
            pair::bogojevic
        )
    },
    of_signal!(
        &[Part::Word("root-mean-square"), Part::Word("difference")],
        true,
        "Root mean square of the differences of the samples.",
        "definition",
        pair::root_mean_square_error
    ),
    MetricEntry {
        form: Form { numbers: POINTS, ..form(&[Part::Word("area"), Part::Word("between"), Part::Word("distributions")]) },
        of_distributions: true,
        ..of_signal!(&[], false, "Area between the two cumulative distributions of the samples.", "Ferson, Oberkampf & Ginzburg 2008", area)
    },
    MetricEntry {
        form: form(&[Part::Word("coherence"), Part::Word("from"), Part::Frequency("low"), Part::Word("to"), Part::Frequency("high")]),
        gives: |_, _| Dimension::ONE,
        common_points: true,
        of_distributions: false,
        best: Best::Greatest(1.0),
        about: "Mean coherence of the spectral lines from the first frequency to below the second: Welch's method, Hann windows of 256 samples, 50 % overlap.",
        source: "Welch 1967",
        run: |p| {
            let band = p.band.ok_or("the frequencies are missing")?;
            coherence::in_band(p.simulated, p.measured, p.rate, band).map_err(|undefined| undefined.to_string())
        },
    },
    MetricEntry {
        form: form(&[Part::Word("hysteresis"), Part::Word("maximum"), Part::Word("over"), Part::Signal("axis")]),
        gives: |signal, _| signal,
        common_points: false,
        of_distributions: false,
        best: Best::Least(0.0),
        about: "Largest difference of the hysteresis loops of the signal over another one: simulated and measured on the same branch.",
        source: "EN 15273-2, stationary sway test",
        run: |p| loop_error(p).map(|error| error.maximum),
    },
    MetricEntry {
        form: form(&[Part::Word("hysteresis"), Part::Word("mean"), Part::Word("over"), Part::Signal("axis")]),
        gives: |signal, _| signal,
        common_points: false,
        of_distributions: false,
        best: Best::Least(0.0),
        about: "Mean difference of the hysteresis loops of the signal over another one: simulated and measured on the same branch.",
        source: "EN 15273-2, stationary sway test",
        run: |p| loop_error(p).map(|error| error.mean),
    },
];

/// The area metric; for equal numbers of values the faster form.
fn area(simulated: &[f64], measured: &[f64]) -> Result<f64, pair::Undefined> {
    if simulated.len() == measured.len() { pair::area_metric(simulated, measured) } else { pair::area_between(simulated, measured) }
}

/// Share of the input's range by which it must reverse to count as a turning point.
const TURNING: f64 = 0.05;

fn loop_error(pair: &Pair<'_>) -> Result<hysteresis::Matching, String> {
    let (x_simulated, x_measured) = pair.over.ok_or("the signal for the loop's axis is missing")?;
    let simulated = hysteresis::Loop { x: x_simulated, y: pair.simulated };
    let measured = hysteresis::Loop { x: x_measured, y: pair.measured };
    hysteresis::matching(simulated, measured, TURNING).map_err(|undefined| undefined.to_string())
}
