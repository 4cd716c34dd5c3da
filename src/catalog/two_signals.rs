//! Metrics: one number from the simulated and the measured signal of a section, the measured one being the reference.

use super::forms::{Form, NumberOption, Part};
use crate::metrics::{coherence, hysteresis, pair};
use crate::units::Dimension;

/// The two signals, cut to the section and on common points unless the metric says otherwise; SI.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Where both have a sample, along the axis: only of metrics on common points.
    pub axis: &'a [f64],
    pub simulated: &'a [f64],
    pub measured: &'a [f64],
    /// Samples of the measured signal per second, or per metre where the record has no time.
    pub rate: f64,
    /// The frequencies that the wording names.
    pub band: Option<(f64, f64)>,
    /// The signal that the metric runs over, where its wording names one: simulated, measured.
    pub over: Option<(&'a [f64], &'a [f64])>,
}

/// Which values are good: what a limit has to leave in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Best {
    /// The nearer to this, from either side, the better.
    Near(f64),
    /// No value is below this; the smaller the better.
    Least(f64),
    /// No value is above this; the larger the better.
    Greatest(f64),
}

impl Best {
    pub fn value(self) -> f64 {
        match self {
            Self::Near(value) | Self::Least(value) | Self::Greatest(value) => value,
        }
    }

    /// `1, larger is better`
    pub fn in_words(self) -> String {
        let way = match self {
            Self::Near(_) => "nearer",
            Self::Least(_) => "smaller",
            Self::Greatest(_) => "larger",
        };
        format!("{}, {way} is better", self.value())
    }
}

/// An entry, and what its wording asks for besides.
#[derive(Clone, Copy, Debug)]
pub struct Metric(pub &'static MetricEntry, pub Asked);

/// What the wording of a metric has besides its words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// How many points both distributions are taken at.
    pub points: Option<usize>,
    /// The frequencies from the first up to the second, SI.
    pub band: Option<(f64, f64)>,
}

impl Metric {
    /// Whether the simulated signal is brought onto the points of the measured one before. Distributions need that nowhere, and are
    /// taken of windows and resampled signals as these are.
    pub fn on_common_points(self, chain_keeps_samples: bool) -> bool {
        self.0.common_points && (chain_keeps_samples || !self.0.of_distributions)
    }

    /// # Errors
    /// The reason where it is not defined.
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
    /// Dimension of the result from that of the signals and of the axis.
    pub gives: fn(Dimension, Dimension) -> Dimension,
    /// Whether the simulated signal is brought onto the points of the measured one before.
    pub common_points: bool,
    /// Whether it looks at the values regardless of their order, so that the sides may have different numbers of them.
    pub of_distributions: bool,
    pub best: Best,
    pub about: &'static str,
    pub source: &'static str,
    /// The reason where it is not defined.
    pub run: fn(&Pair<'_>) -> Result<f64, String>,
}

impl MetricEntry {
    /// The metric that expressions call by this name.
    pub fn called(name: &str) -> Option<&'static Self> {
        METRICS.iter().find(|entry| entry.function_name() == name)
    }

    /// Its words up to what it takes, joined: `theil_inequality`, `hysteresis_maximum`, `coherence`.
    pub fn function_name(&self) -> String {
        let head = self.form.head;
        let slot = head.iter().position(|part| !matches!(part, Part::Word(_)));
        // The last word before a slot only leads to it: `over`, `from`.
        let words = &head[..slot.map_or(head.len(), |slot| slot.saturating_sub(1))];
        let words: Vec<&str> = words.iter().filter_map(|part| if let Part::Word(word) = part { Some(*word) } else { None }).collect();
        words.join("_").replace('-', "_")
    }

    /// As expressions call it: `coherence(<low>, <high>)`, `matching_probability` with or without `(<points>)`.
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
        "Root of the ratio of the integrals of the squares, less 1; negative where the simulation is smaller.",
        SG,
        pair::sprague_geers_magnitude
    ),
    ratio!(
        &[Part::Word("sprague-geers"), Part::Word("phase")],
        Best::Least(0.0),
        "Angle between the two signals as vectors, over pi: 0 alike, 0.5 unrelated, 1 inverted.",
        SG,
        pair::sprague_geers_phase
    ),
    ratio!(
        &[Part::Word("sprague-geers"), Part::Word("comprehensive")],
        Best::Least(0.0),
        "Root of the sum of the squares of magnitude and phase.",
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
    ratio!(&[Part::Word("russell"), Part::Word("phase")], Best::Least(0.0), "As Sprague & Geers.", RUSSELL, pair::russell_phase),
    ratio!(
        &[Part::Word("russell"), Part::Word("comprehensive")],
        Best::Least(0.0),
        "Magnitude and phase together.",
        RUSSELL,
        pair::russell_comprehensive
    ),
    ratio!(
        &[Part::Word("theil"), Part::Word("inequality")],
        Best::Least(0.0),
        "Root mean square difference over the sum of the root mean squares: 0 to 1.",
        "Theil 1966",
        pair::theil_u1
    ),
    ratio!(
        &[Part::Word("weighted"), Part::Word("integrated"), Part::Word("factor")],
        Best::Greatest(1.0),
        "WIFac: 1 where the signals are alike, 0 where they have nothing in common.",
        "Ray et al., NCHRP 22-24",
        pair::weighted_integrated_factor
    ),
    ratio!(&[Part::Word("correlation")], Best::Greatest(1.0), "Pearson correlation of the samples.", "Pearson 1895", pair::correlation),
    ratio!(
        &[Part::Word("mirrored_correlation")],
        Best::Least(0.0),
        "Pearson correlation with the simulated samples read from the end: near 1 where a record is mirrored.",
        "definition",
        pair::mirrored_correlation
    ),
    MetricEntry {
        form: form(&[Part::Word("shift")]),
        gives: |_, axis| axis,
        common_points: true,
        of_distributions: false,
        best: Best::Near(0.0),
        about: "What is to be added to the measured axis for the best correlation, up to a quarter of the section.",
        source: "definition",
        run: |p| pair::shift(p.axis, p.simulated, p.measured).map_err(|undefined| undefined.to_string()),
    },
    MetricEntry {
        form: form(&[Part::Word("drift")]),
        gives: |signal, _| signal,
        common_points: true,
        of_distributions: false,
        best: Best::Near(0.0),
        about: "Rise of the regression line of measured less simulated samples over the section.",
        source: "definition",
        run: |p| pair::drift(p.axis, p.simulated, p.measured).map_err(|undefined| undefined.to_string()),
    },
    ratio!(
        &[Part::Word("misfit")],
        Best::Least(0.0),
        "Sum of the squared differences over the smaller of the sums of squares.",
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
        about: "Mean coherence of the lines from the one frequency to below the other: Welch, Hann windows of 256 samples, half overlapping.",
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
        about: "Largest matching error of the loop the signal draws over another: simulated against measured on the same branch.",
        source: "EN 15273-2, stationary sway test",
        run: |p| loop_error(p).map(|error| error.maximum),
    },
    MetricEntry {
        form: form(&[Part::Word("hysteresis"), Part::Word("mean"), Part::Word("over"), Part::Signal("axis")]),
        gives: |signal, _| signal,
        common_points: false,
        of_distributions: false,
        best: Best::Least(0.0),
        about: "Mean matching error of the loop the signal draws over another: simulated against measured on the same branch.",
        source: "EN 15273-2, stationary sway test",
        run: |p| loop_error(p).map(|error| error.mean),
    },
];

/// Of equal counts without a walk through both distributions.
fn area(simulated: &[f64], measured: &[f64]) -> Result<f64, pair::Undefined> {
    if simulated.len() == measured.len() { pair::area_metric(simulated, measured) } else { pair::area_between(simulated, measured) }
}

/// Share of the input's range by which it must turn back to count as a turning point.
const TURNING: f64 = 0.05;

fn loop_error(pair: &Pair<'_>) -> Result<hysteresis::Matching, String> {
    let (x_simulated, x_measured) = pair.over.ok_or("the signal of the loop's axis is missing")?;
    let simulated = hysteresis::Loop { x: x_simulated, y: pair.simulated };
    let measured = hysteresis::Loop { x: x_measured, y: pair.measured };
    hysteresis::matching(simulated, measured, TURNING).map_err(|undefined| undefined.to_string())
}
