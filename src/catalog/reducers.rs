//! Values of one signal in one section, and statistics over all section x signal pairs.

use std::fmt;

use crate::metrics::{
    cluster::{mean_interval, standard_deviation_interval},
    percentile::{Method, percentile},
    sampling::{self, Traits},
    statistics::{self, Divisor},
    window,
};
use crate::units::Dimension;

/// Confidence level of the intervals printed with statistics.
const CONFIDENCE: f64 = 0.95;

/// An operation that reduces a signal to a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reducer {
    Percentile(f64),
    Named(&'static ReducerEntry),
}

pub struct ReducerEntry {
    pub name: &'static str,
    pub about: &'static str,
    /// Dimension of the result, from those of the signal and of the axis.
    pub gives: fn(Dimension, Dimension) -> Dimension,
    /// From the axis and the samples, both in SI; `None` where it is not defined.
    pub run: fn(&[f64], &Traits<'_>) -> Option<f64>,
    /// How it is computed in a sliding window, where it makes sense there.
    pub window: Option<InWindow>,
}

/// How a reducer is computed in a sliding window.
#[derive(Clone, Copy, Debug)]
pub enum InWindow {
    /// By a way that is faster than to read every window.
    Fast(window::Kind<'static>),
    /// By itself.
    Itself,
}

/// By its name: two runs print the same.
impl fmt::Debug for ReducerEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl PartialEq for ReducerEntry {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

const fn same(
    name: &'static str,
    about: &'static str,
    run: fn(&[f64], &Traits<'_>) -> Option<f64>,
) -> ReducerEntry {
    ReducerEntry { name, about, gives: |signal, _| signal, run, window: None }
}

/// A reducer that a sliding window has, too.
const fn windowed(window: InWindow, entry: ReducerEntry) -> ReducerEntry {
    ReducerEntry { window: Some(window), ..entry }
}

macro_rules! share {
    ($name:literal, $about:literal, $run:expr) => {
        ReducerEntry {
            name: $name,
            about: $about,
            gives: |_, _| Dimension::ONE,
            run: |_, x| ($run)(x),
            window: None,
        }
    };
}

use InWindow::{Fast, Itself};
use window::Kind;

/// Reducers by name; percentiles are written as `p99.85`.
pub const REDUCERS: &[ReducerEntry] = &[
    windowed(Itself, same("median", "The 50 % value.", |_, x| statistics::median(x))),
    windowed(
        Fast(Kind::Mean),
        same("mean", "Arithmetic mean of the samples.", |_, x| statistics::mean(x)),
    ),
    windowed(
        Fast(Kind::Rms),
        same("rms", "Root mean square; the mean is not removed.", |_, x| statistics::rms(x)),
    ),
    windowed(
        Itself,
        same(
            "rms_about_trend",
            "Root mean square about the regression line over the axis.",
            |axis, x| statistics::rms_about_trend(axis, x),
        ),
    ),
    windowed(
        Itself,
        same("std", "Standard deviation of the samples (n-1).", |_, x| {
            statistics::standard_deviation(x, Divisor::Sample)
        }),
    ),
    windowed(
        Fast(Kind::Extremes(|low, _| low)),
        same("minimum", "Smallest sample.", |_, x| statistics::minimum(x)),
    ),
    windowed(
        Fast(Kind::Extremes(|_, high| high)),
        same("maximum", "Largest sample.", |_, x| statistics::maximum(x)),
    ),
    windowed(
        Fast(Kind::Extremes(|low, high| high.abs().max(low.abs()))),
        same("peak", "Largest magnitude.", |_, x| statistics::peak_magnitude(x)),
    ),
    windowed(
        Fast(Kind::Extremes(|low, high| high - low)),
        same("range", "Largest minus smallest sample.", |_, x| statistics::range(x)),
    ),
    share!(
        "held",
        "Share of the samples in the longest run of equal values.",
        sampling::longest_held_share
    ),
    share!(
        "at_extreme",
        "Share of the samples at the largest or at the smallest value, the larger of both.",
        sampling::share_at_extreme
    ),
    same(
        "resolution",
        "Smallest change between consecutive samples: the quantisation step of a signal that varies.",
        |_, x| sampling::resolution(x),
    ),
    same(
        "noise_floor",
        "Standard deviation of the part that changes from sample to sample: for white noise its standard deviation, near 0 for a smooth signal.",
        |_, x| sampling::noise_floor(x),
    ),
    same(
        "spike",
        "Largest height of a single sample above or below what its neighbours lead to; of a jump the half.",
        |_, x| sampling::spike(x),
    ),
    share!(
        "smooth_stretch",
        "Number of samples of the longest stretch that follows a straight line or a smooth curve, where the signal as a whole does not.",
        sampling::smooth_stretch
    ),
    share!(
        "repeated",
        "Share of the samples that repeat the one before, where the signal else changes by more than a step of its resolution.",
        sampling::repeated_share
    ),
    share!(
        "piled_up",
        "Share of the samples piled up at the largest or smallest value, beyond what the values next to it hold.",
        sampling::piled_up
    ),
    share!(
        "line",
        "Largest peak of the spectrum that is a single line, over the median of the lines around it.",
        |x: &Traits<'_>| Some(x.line()?.0)
    ),
    ReducerEntry {
        name: "line_length",
        about: "Wavelength of that line, in the unit of the axis.",
        gives: |_, axis| axis,
        run: |axis, x| {
            let (_, frequency) = x.line()?;
            let step = (axis.last()? - axis.first()?) / (axis.len() - 1) as f64;
            Some(step / frequency).filter(|length| length.is_finite())
        },
        window: None,
    },
    same("first", "First sample of the section.", |_, x| x.first().copied()),
    same("last", "Last sample of the section.", |_, x| x.last().copied()),
    ReducerEntry {
        name: "slope",
        about: "Slope of the regression line over the axis.",
        gives: |signal, axis| signal / axis,
        run: |axis, x| statistics::regression(axis, x).map(|line| line.slope),
        window: Some(Itself),
    },
];

/// `share where Q < 10 kN`, of a signal that is 1 where the condition holds and else 0.
pub static SHARE_OF_SAMPLES: ReducerEntry =
    share!("share where", "Share of the samples that satisfy a condition.", |x: &Traits<'_>| {
        statistics::mean(x)
    });

/// `crossings where Q > 60 kN`: how often the condition comes to hold.
pub static CROSSINGS: ReducerEntry = share!(
    "crossings where",
    "How often a condition comes to hold from one sample to the next.",
    |x: &Traits<'_>| sampling::onsets(x)
);

/// `total of`, and the number of those that satisfy a condition, over cycles: of half cycles.
pub static TOTAL: ReducerEntry =
    same("total", "Sum over the cycles, a half cycle counting half.", |_, x| {
        Some(x.iter().sum::<f64>() / 2.0)
    });

/// `longest run where Q < 10 kN`: from the first to the last sample of the longest run.
pub static LONGEST_RUN: ReducerEntry = ReducerEntry {
    name: "longest run where",
    about: "Longest stretch of samples one after the other that satisfy a condition.",
    gives: |_, axis| axis,
    run: |axis, x| sampling::longest_run(axis, x),
    window: None,
};

impl Reducer {
    pub fn named(name: &str) -> Option<Self> {
        REDUCERS.iter().find(|entry| entry.name == name).map(Self::Named)
    }

    /// How it is computed in a sliding window; `None` where it makes no sense there.
    pub fn in_window(self) -> Option<InWindow> {
        match self {
            Self::Percentile(_) => Some(Itself),
            Self::Named(entry) => entry.window,
        }
    }

    pub fn gives(self, signal: Dimension, axis: Dimension) -> Dimension {
        match self {
            Self::Percentile(_) => signal,
            Self::Named(entry) => (entry.gives)(signal, axis),
        }
    }

    /// Whether the order of the samples, or their number, does not matter: cycles have such values.
    pub fn of_cycles(self) -> bool {
        let Self::Named(entry) = self else { return true };
        const OTHERS: [&str; 4] = ["rms_about_trend", "slope", "first", "last"];
        entry.window.is_some() && !OTHERS.contains(&entry.name)
            || [TOTAL.name, SHARE_OF_SAMPLES.name].contains(&entry.name)
    }

    /// `None` where the value is not defined, such as for no samples or the slope of one sample.
    pub fn run(self, axis: &[f64], samples: &Traits<'_>, method: Method) -> Option<f64> {
        match self {
            Self::Percentile(percent) => percentile(samples, percent, method).ok(),
            Self::Named(entry) => (entry.run)(axis, samples),
        }
    }

    /// By which factor and offset the value follows where every sample `x` becomes
    /// `factor * x + offset`, with a factor above zero; `None` where it must be computed again.
    pub fn of_line(self, (factor, offset): (f64, f64)) -> Option<(f64, f64)> {
        let Self::Named(entry) = self else { return Some((factor, offset)) };
        match entry.name {
            "median" | "mean" | "minimum" | "maximum" | "first" | "last" => Some((factor, offset)),
            "std" | "range" | "slope" => Some((factor, 0.0)),
            "rms" | "peak" if offset == 0.0 => Some((factor, 0.0)),
            _ => None,
        }
    }

    pub fn in_words(self) -> String {
        match self {
            Self::Percentile(percent) => format!("p{percent}"),
            Self::Named(entry) => entry.name.to_string(),
        }
    }
}

/// A statistic over pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Statistic {
    /// Every value separately; the worst decides.
    Each,
    Percentile(f64),
    Named(&'static StatisticEntry),
}

/// Lower and upper end of a confidence interval, from values and the index of the site of each.
pub type Interval = fn(&[f64], &[usize]) -> Option<(f64, f64)>;

#[derive(Debug)]
pub struct StatisticEntry {
    pub name: &'static str,
    pub title: &'static str,
    /// Whether it measures scatter. The best value is then 0 for every quantity.
    pub of_scatter: bool,
    /// From the values and `ddof` (divisor n - `ddof`).
    pub run: fn(&[f64], usize) -> Option<f64>,
    /// 95 % confidence interval for normal values that are independent between sites, where there
    /// is one.
    pub interval: Option<Interval>,
}

impl PartialEq for StatisticEntry {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

const fn plain(
    name: &'static str,
    title: &'static str,
    run: fn(&[f64], usize) -> Option<f64>,
) -> StatisticEntry {
    StatisticEntry { name, title, of_scatter: false, run, interval: None }
}

pub const STATISTICS: &[StatisticEntry] = &[
    StatisticEntry {
        name: "mean",
        title: "mean",
        of_scatter: false,
        run: |x, _| statistics::mean(x),
        interval: Some(|x, site| {
            mean_interval(x, site, CONFIDENCE).map(|interval| (interval.low, interval.high))
        }),
    },
    StatisticEntry {
        name: "std",
        title: "standard deviation",
        of_scatter: true,
        run: |x, ddof| {
            statistics::standard_deviation(
                x,
                if ddof == 0 { Divisor::Population } else { Divisor::Sample },
            )
        },
        interval: Some(|x, site| {
            standard_deviation_interval(x, site, CONFIDENCE)
                .map(|interval| (interval.low, interval.high))
        }),
    },
    plain("rms", "root mean square", |x, _| statistics::rms(x)),
    plain("median", "median", |x, _| statistics::median(x)),
    plain("minimum", "smallest value", |x, _| statistics::minimum(x)),
    plain("maximum", "largest value", |x, _| statistics::maximum(x)),
    plain("peak", "largest magnitude", |x, _| statistics::peak_magnitude(x)),
    StatisticEntry { of_scatter: true, ..plain("range", "range", |x, _| statistics::range(x)) },
];

impl Statistic {
    pub fn named(word: &str) -> Option<Self> {
        if word == "each" {
            return Some(Self::Each);
        }
        if let Some(percent) = word.strip_prefix('p').and_then(|percent| percent.parse().ok()) {
            return (0.0..=100.0).contains(&percent).then_some(Self::Percentile(percent));
        }
        STATISTICS.iter().find(|entry| entry.name == word).map(Self::Named)
    }

    /// Name in result files: `mean`, `std`, `p95`, `each`.
    pub fn name(self) -> String {
        match self {
            Self::Each => "each".into(),
            Self::Percentile(percent) => format!("p{percent}"),
            Self::Named(entry) => entry.name.into(),
        }
    }

    /// Whether it measures scatter.
    pub fn of_scatter(self) -> bool {
        matches!(self, Self::Named(entry) if entry.of_scatter)
    }

    pub fn title(self, ddof: usize) -> String {
        match self {
            Self::Each => "each value".into(),
            Self::Percentile(percent) => format!("{percent} % value"),
            Self::Named(entry) if entry.name == "std" => {
                format!("{} ({})", entry.title, if ddof == 1 { "n-1" } else { "n" })
            }
            Self::Named(entry) => entry.title.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_follows_a_straight_line_as_if_it_were_computed_again() {
        let axis: Vec<f64> = (0..101).map(f64::from).collect();
        let samples: Vec<f64> = axis.iter().map(|x| (0.3 * x).sin() + 0.01 * x - 0.4).collect();
        let all = REDUCERS.iter().map(Reducer::Named).chain([Reducer::Percentile(99.85)]);
        let mut followed = 0;
        for reducer in all {
            for (factor, offset) in [(1.3, 0.0), (0.7, 2.5), (2.0, -40.0)] {
                let Some((by, plus)) = reducer.of_line((factor, offset)) else { continue };
                let changed: Vec<f64> = samples.iter().map(|x| factor * x + offset).collect();
                let of = |samples: &[f64]| {
                    reducer.run(&axis, &Traits::of(samples), Method::Linear).expect("defined")
                };
                let (follows, again) = (by * of(&samples) + plus, of(&changed));
                assert!((follows - again).abs() < 1e-12 * again.abs().max(1.0), "{reducer:?}");
                followed += 1;
            }
        }
        assert_eq!(followed, 3 * 10 + 2);
    }
}
