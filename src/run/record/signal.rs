//! Signals along a record, and the operations of the graph on them.

use std::{ops::Range, sync::Arc};

use crate::catalog::InWindow;
use crate::check::values::Values;
use crate::metrics::{
    along,
    filter::Filter,
    percentile::Method,
    rainflow::half_cycles,
    resample,
    sampling::Traits,
    window::{Kind, Sliding},
};
use crate::run::{prelude::*, sections::Extent};

/// The axis of the samples, and their time, in SI; both increase strictly.
#[derive(Debug)]
pub struct Along {
    pub axis: Arc<Vec<f64>>,
    pub time: Option<Arc<Vec<f64>>>,
    pub rate: Rate,
    /// Row of the file of the first sample; `None` where the samples are not those of the file.
    pub first_row: Option<usize>,
}

/// Samples per second, or per metre after resampling over a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    PerTime(f64),
    PerLength(f64),
}

#[derive(Clone, Debug)]
pub struct Samples {
    pub along: Arc<Along>,
    pub values: Arc<Vec<f64>>,
}

/// Value of a signal node; a number that is constant along the record is stored once.
#[derive(Clone, Debug)]
pub enum Signal {
    Samples(Samples),
    Constant(f64),
}

/// A column over the time or the axis, at some points of that.
fn interpolated(over: &[f64], column: &[f64], points: &[f64]) -> Result<Vec<f64>, Reason> {
    resample::interpolate(over, column, points).map_err(Reason::method)
}

impl Along {
    /// The time, as far as there is one, or the axis.
    fn over(&self, over_time: bool) -> &Arc<Vec<f64>> {
        self.time.as_ref().filter(|_| over_time).unwrap_or(&self.axis)
    }

    /// The samples with start <= axis <= end.
    pub fn inside(&self, (start, end): Extent) -> Range<usize> {
        let from = self.axis.partition_point(|&x| x < start);
        let to = self.axis.partition_point(|&x| x <= end);
        from..to.max(from)
    }

    /// The same, of a section or of all; there must be one sample.
    pub fn part_inside(&self, extent: Option<Extent>) -> Result<Range<usize>, Reason> {
        let Some((start, end)) = extent else { return Ok(0..self.axis.len()) };
        let range = self.inside((start, end));
        if range.is_empty() {
            Err(Reason::NoSampleBetween { from: start, to: end })
        } else {
            Ok(range)
        }
    }

    pub fn part(&self, range: Range<usize>) -> Self {
        let part = |of: &[f64]| Arc::new(of[range.clone()].to_vec());
        Self {
            axis: part(&self.axis),
            time: self.time.as_deref().map(|time| part(time)),
            rate: self.rate,
            first_row: self.first_row.map(|row| row + range.start),
        }
    }

    /// The same samples, moved along the axis by `shift`.
    pub fn moved(&self, shift: f64) -> Self {
        Self {
            axis: Arc::new(self.axis.iter().map(|x| x + shift).collect()),
            time: self.time.clone(),
            rate: self.rate,
            first_row: self.first_row,
        }
    }

    /// The row of a sample in its file, or else where it is on the axis.
    fn place(&self, sample: usize) -> (Option<usize>, Option<f64>) {
        match self.first_row {
            Some(row) => (Some(row + sample), None),
            None => (None, Some(self.axis[sample])),
        }
    }
}

/// Cuts signals to one section. Signals of a record share their axis, whose part is cut once for
/// all of them.
#[derive(Clone, Debug)]
pub struct Cutter {
    extent: Extent,
    known: Vec<(Arc<Along>, Range<usize>, Arc<Along>)>,
}

impl Cutter {
    pub fn new(extent: Extent) -> Self {
        Self { extent, known: Vec::new() }
    }

    pub fn cut(&mut self, samples: &Samples) -> Result<Samples, Reason> {
        let cut = match self.known.iter().position(|(whole, ..)| Arc::ptr_eq(whole, &samples.along))
        {
            Some(known) => &self.known[known],
            None => {
                let range = samples.along.part_inside(Some(self.extent))?;
                let part = Arc::new(samples.along.part(range.clone()));
                self.known.push((Arc::clone(&samples.along), range, part));
                &self.known[self.known.len() - 1]
            }
        };
        let (_, range, part) = cut;
        Ok(Samples {
            along: Arc::clone(part),
            values: Arc::new(samples.values[range.clone()].to_vec()),
        })
    }
}

impl Samples {
    pub fn with(&self, values: Vec<f64>) -> Self {
        Self { along: Arc::clone(&self.along), values: Arc::new(values) }
    }

    /// Whether both have their samples at the same points.
    fn along_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.along, &other.along) || self.along.axis == other.along.axis
    }

    /// The samples that there are: [`choose`] leaves some out.
    ///
    /// # Errors
    /// There is none.
    pub fn present(&self) -> Result<Self, Reason> {
        let there: Vec<usize> =
            (0..self.values.len()).filter(|&sample| !self.values[sample].is_nan()).collect();
        if there.is_empty() {
            return Err(Reason::NoSampleSatisfies);
        }
        let of = |values: &[f64]| Arc::new(there.iter().map(|&at| values[at]).collect::<Vec<_>>());
        let along = Along {
            axis: of(&self.along.axis),
            time: self.along.time.as_deref().map(|time| of(time)),
            rate: self.along.rate,
            first_row: None,
        };
        Ok(Self { along: Arc::new(along), values: of(&self.values) })
    }

    pub fn cut(&self, extent: Extent) -> Result<Self, Reason> {
        Cutter::new(extent).cut(self)
    }

    pub fn designed(&self, spec: &StepSpec) -> Result<Filter, Reason> {
        let (Rate::PerTime(rate) | Rate::PerLength(rate)) = self.along.rate;
        let designed = match spec {
            StepSpec::Butterworth { band, order, phase, cutoff } => {
                Filter::design(*band, *order, rate, *phase, *cutoff)
            }
            StepSpec::Transfer { function, phase, warping } => {
                Filter::transfer(function, rate, *phase, *warping)
            }
            _ => return Err(Reason::Internal),
        };
        designed.map_err(Reason::method)
    }

    /// A step over the whole record that is not a filter.
    pub fn stepped(&self, spec: &StepSpec) -> Result<Self, Reason> {
        match spec {
            StepSpec::Magnitude => {
                Ok(self.with(self.values.iter().map(|value| value.abs()).collect()))
            }
            StepSpec::Resample { step, over_time } => self.resampled(*step, *over_time),
            _ => Err(Reason::Internal),
        }
    }

    fn resampled(&self, step: f64, over_time: bool) -> Result<Self, Reason> {
        let over = self.along.over(over_time);
        let (grid, values) =
            resample::resample(over, &self.values, step).map_err(Reason::method)?;
        let time = self.along.time.as_ref().filter(|_| !over_time);
        let time = time.map(|time| interpolated(over, time, &grid)).transpose()?;
        self.at_points(grid, values, step, over_time, time)
    }

    /// Values at points of the time or of the axis, `step` apart; `time` is that of points of the
    /// axis.
    fn at_points(
        &self,
        points: Vec<f64>,
        values: Vec<f64>,
        step: f64,
        over_time: bool,
        time: Option<Vec<f64>>,
    ) -> Result<Self, Reason> {
        let (axis, time, rate) = if over_time {
            let axis = interpolated(self.along.over(true), &self.along.axis, &points)?;
            (axis, Some(points), Rate::PerTime(1.0 / step))
        } else {
            (points, time, Rate::PerLength(1.0 / step))
        };
        let along = Along { axis: Arc::new(axis), time: time.map(Arc::new), rate, first_row: None };
        Ok(Self { along: Arc::new(along), values: Arc::new(values) })
    }

    /// A step inside the section. A window uses the samples of the record and stays inside the
    /// section.
    pub fn windowed(
        &self,
        spec: &StepSpec,
        extent: Extent,
        method: Method,
    ) -> Result<Self, Reason> {
        match spec {
            StepSpec::RemoveMean => {
                let mean =
                    crate::metrics::statistics::mean(&self.values).ok_or(Reason::MeanOfNothing)?;
                Ok(self.with(self.values.iter().map(|value| value - mean).collect()))
            }
            StepSpec::Magnitude => self.stepped(spec),
            StepSpec::Window { reducer, width, step, over_time, ends, short_sections } => {
                let (over, (start, end)) = self.window_axis(*over_time, extent)?;
                let itself = |axis: &[f64], x: &[f64]| reducer.run(axis, &Traits::of(x), method);
                let kind = match reducer.in_window() {
                    Some(InWindow::Fast(kind)) => kind,
                    _ => Kind::Reduced(&itself),
                };
                let sliding = Sliding {
                    width: *width,
                    step: *step,
                    kind,
                    ends: *ends,
                    short_sections: *short_sections,
                };
                let values = sliding.over(over, &self.values, start, end).map_err(|error| {
                    Reason::method(error.in_words(if *over_time { "s" } else { "m" }))
                })?;
                let starts = sliding.starts(over, start, end).map_err(Reason::method)?;
                let middle: Vec<f64> =
                    starts.iter().map(|from| from + width.min(end - start) / 2.0).collect();
                let between = (starts[starts.len() - 1] - starts[0]) / (starts.len() - 1) as f64;
                let step = step.or((between > 0.0).then_some(between)).unwrap_or(*width);
                self.at_points(middle, values, step, *over_time, None)
            }
            _ => Err(Reason::Internal),
        }
    }

    /// A signal shifted, differentiated or integrated. A shift needs a record that extends beyond
    /// the section by the same distance.
    pub fn over_axis(
        &self,
        operation: &AxisOperation,
        known: &dyn Values,
        extent: Extent,
    ) -> Result<Self, Reason> {
        let values = match operation {
            AxisOperation::Derivative { over_time } => {
                along::derivative(self.along.over(*over_time), &self.values)
                    .ok_or(Reason::TooFewSamples)?
            }
            AxisOperation::Integral { over_time } => {
                along::integral(self.along.over(*over_time), &self.values)
                    .ok_or(Reason::TooFewSamples)?
            }
            AxisOperation::Shifted(distance) => {
                let distance = number(distance, known)?;
                let axis = &self.along.axis;
                let (first, last) = (
                    axis.first().copied().unwrap_or(f64::NAN),
                    axis.last().copied().unwrap_or(f64::NAN),
                );
                let (from, to) = (extent.0 - distance, extent.1 - distance);
                let slack = 1e-9 * (last - first);
                if !(first <= from + slack && to <= last + slack) {
                    return Err(Reason::RecordTooShort { first, last, from, to });
                }
                along::moved(axis, &self.values, distance).map_err(Reason::method)?
            }
        };
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(self.with(values)),
            Some(sample) => {
                let (row, at) = self.along.place(sample);
                Err(Reason::NotFiniteSample { row, at })
            }
        }
    }

    /// What is computed of the samples of a section as a whole, at points of its own.
    pub fn of_section(&self, operation: &SectionOperation) -> Result<Self, Reason> {
        let (axis, values) = match operation {
            SectionOperation::Frequencies => return Ok(self.with(self.along.axis.to_vec())),
            SectionOperation::Spectrum(density) => {
                let Rate::PerTime(rate) = self.along.rate else {
                    return Err(Reason::Internal);
                };
                density.of(&self.values, rate).map_err(Reason::method)?
            }
            SectionOperation::CycleRanges => {
                let ranges = half_cycles(&self.values);
                ((1..=ranges.len()).map(|number| number as f64).collect(), ranges)
            }
        };
        let axis = Arc::new(axis);
        let along = Along { axis, time: None, rate: self.along.rate, first_row: None };
        Ok(Self { along: Arc::new(along), values: Arc::new(values) })
    }

    fn window_axis(&self, over_time: bool, extent: Extent) -> Result<(&[f64], Extent), Reason> {
        if !over_time {
            return Ok((&self.along.axis, extent));
        }
        let time = self.along.over(true);
        let inside = self.along.inside(extent);
        let (Some(first), Some(last)) =
            (time.get(inside.start), time.get(inside.end.wrapping_sub(1)))
        else {
            return Err(Reason::NoSampleInside);
        };
        Ok((time, (*first, *last)))
    }
}

/// `left op right`, sample by sample; of a condition 1 where it holds and else 0.
///
/// # Errors
/// The signals have different samples, or a result is not finite: which sample, and why.
pub fn arithmetic(operator: Operator, left: &Signal, right: &Signal) -> Result<Signal, Reason> {
    let told = f64::from;
    match operator {
        Operator::Add => each_pair(left, right, |a, b| a + b),
        Operator::Subtract => each_pair(left, right, |a, b| a - b),
        Operator::Multiply => each_pair(left, right, |a, b| a * b),
        Operator::Divide => each_pair(left, right, |a, b| a / b),
        Operator::Less => each_pair(left, right, |a, b| told(a < b)),
        Operator::LessEqual => each_pair(left, right, |a, b| told(a <= b)),
        Operator::Greater => each_pair(left, right, |a, b| told(a > b)),
        Operator::GreaterEqual => each_pair(left, right, |a, b| told(a >= b)),
        Operator::And => each_pair(left, right, |a, b| a * b),
        Operator::Or => each_pair(left, right, f64::max),
        Operator::Is | Operator::IsNot => Err(Reason::Internal),
    }
}

/// For each sample the value of the first signal whose condition holds, else that of the signal
/// behind them; not a number where there is none.
///
/// # Errors
/// The signals have different samples.
pub fn choose(values: &[&Signal], conditions: &[&Signal]) -> Result<Signal, Reason> {
    let at = |signal: &Signal, sample: usize| match signal {
        Signal::Constant(value) => *value,
        Signal::Samples(samples) => samples.values[sample],
    };
    let sampled = values.iter().chain(conditions).filter_map(|signal| match signal {
        Signal::Samples(samples) => Some(samples),
        Signal::Constant(_) => None,
    });
    let mut sampled = sampled.cloned();
    let first = sampled.next().ok_or(Reason::Internal)?;
    if sampled.any(|other| !other.along_with(&first)) {
        return Err(Reason::DifferentSampling);
    }
    let one = |sample: usize| {
        let holds = conditions.iter().position(|condition| at(condition, sample) != 0.0);
        let value = values.get(holds.unwrap_or(conditions.len()));
        value.map_or(f64::NAN, |value| at(value, sample))
    };
    Ok(Signal::Samples(first.with((0..first.values.len()).map(one).collect())))
}

/// A function of one or two signals, sample by sample.
///
/// # Errors
/// As [`arithmetic`].
pub fn apply(inputs: &[&Signal], run: fn(&[f64]) -> f64) -> Result<Signal, Reason> {
    match *inputs {
        [of] => each(of, |value| run(&[value])),
        [left, right] => each_pair(left, right, |a, b| run(&[a, b])),
        _ => Err(Reason::Internal),
    }
}

/// A function of each sample.
///
/// # Errors
/// As [`arithmetic`].
pub fn each(of: &Signal, run: impl Fn(f64) -> f64) -> Result<Signal, Reason> {
    match of {
        Signal::Constant(value) => constant(run(*value)),
        Signal::Samples(samples) => {
            finite(samples, samples.values.iter().map(|value| run(*value)).collect())
        }
    }
}

/// A power or the value in a table, of each sample. `of` names the signal.
///
/// # Errors
/// As [`arithmetic`]; a sample outside the table.
pub fn mapped(
    signal: &Signal,
    mapping: &Mapping,
    of: impl Fn() -> String,
) -> Result<Signal, Reason> {
    each(signal, |value| mapping.of(value)).map_err(|reason| match (mapping, reason) {
        (Mapping::Table(_), Reason::NotFiniteResult { row, at }) => {
            Reason::OutsideTable { of: of(), row, at }
        }
        (Mapping::Table(_), Reason::NotFiniteNumber) => {
            Reason::OutsideTable { of: of(), row: None, at: None }
        }
        (_, reason) => reason,
    })
}

// One loop for each operation, so that the compiler vectorises it.
fn each_pair(
    left: &Signal,
    right: &Signal,
    run: impl Fn(f64, f64) -> f64,
) -> Result<Signal, Reason> {
    match (left, right) {
        (Signal::Constant(a), Signal::Constant(b)) => constant(run(*a, *b)),
        (Signal::Samples(left), Signal::Constant(b)) => {
            finite(left, left.values.iter().map(|a| run(*a, *b)).collect())
        }
        (Signal::Constant(a), Signal::Samples(right)) => {
            finite(right, right.values.iter().map(|b| run(*a, *b)).collect())
        }
        (Signal::Samples(left), Signal::Samples(right)) => {
            if !left.along_with(right) {
                return Err(Reason::DifferentSampling);
            }
            finite(
                left,
                left.values.iter().zip(right.values.iter()).map(|(a, b)| run(*a, *b)).collect(),
            )
        }
    }
}

fn constant(value: f64) -> Result<Signal, Reason> {
    if value.is_finite() { Ok(Signal::Constant(value)) } else { Err(Reason::NotFiniteNumber) }
}

fn finite(along: &Samples, values: Vec<f64>) -> Result<Signal, Reason> {
    // The loop checks all values without an early exit, which is faster.
    if values.iter().fold(true, |all, value| all & value.is_finite()) {
        return Ok(Signal::Samples(along.with(values)));
    }
    let sample = values.iter().position(|value| !value.is_finite()).unwrap_or(0);
    let (row, at) = along.along.place(sample);
    Err(Reason::NotFiniteResult { row, at })
}
