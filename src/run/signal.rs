//! Signals along a record, and the operations of the graph on them.

use std::sync::Arc;

use crate::check::plan::{Operator, StepSpec};
use crate::metrics::filter::Filter;
use crate::metrics::resample;
use crate::metrics::window::{Kind, Sliding};

/// What samples run along, in SI; axis and time increase strictly.
#[derive(Debug)]
pub struct Along {
    pub axis: Vec<f64>,
    pub time: Option<Vec<f64>>,
    pub rate: Rate,
    /// Row of the file that the first sample was read from; `None` where samples are not those of the file.
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

/// Value of a signal node: a number along the record stays one number.
#[derive(Clone, Debug)]
pub enum Signal {
    Samples(Samples),
    Constant(f64),
}

/// The section on the axis, SI.
pub type Extent = (f64, f64);

impl Along {
    /// The samples with start <= axis <= end.
    pub fn inside(&self, (start, end): Extent) -> std::ops::Range<usize> {
        let from = self.axis.partition_point(|&x| x < start);
        let to = self.axis.partition_point(|&x| x <= end);
        from..to.max(from)
    }

    fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self {
            axis: self.axis[range.clone()].to_vec(),
            time: self.time.as_ref().map(|time| time[range.clone()].to_vec()),
            rate: self.rate,
            first_row: self.first_row.map(|row| row + range.start),
        }
    }

    /// Where a sample is, in words.
    fn place(&self, sample: usize) -> String {
        match self.first_row {
            Some(row) => format!("in row {}", row + sample),
            None => format!("at {:.3} on the axis", self.axis[sample]),
        }
    }
}

impl Samples {
    pub fn with(&self, values: Vec<f64>) -> Self {
        Self { along: Arc::clone(&self.along), values: Arc::new(values) }
    }

    pub fn cut(&self, extent: Extent) -> Result<Self, String> {
        let range = self.along.inside(extent);
        if range.is_empty() {
            return Err(format!("no sample lies between {} and {}", extent.0, extent.1));
        }
        Ok(Self { along: Arc::new(self.along.part(range.clone())), values: Arc::new(self.values[range].to_vec()) })
    }

    pub fn designed(&self, spec: &StepSpec) -> Result<Filter, String> {
        let StepSpec::Butterworth { band, order, phase, cutoff } = spec else { return Err("not a filter".into()) };
        match self.along.rate {
            Rate::PerTime(rate) | Rate::PerLength(rate) => {
                Filter::design(*band, *order, rate, *phase, *cutoff).map_err(|error| error.to_string())
            }
        }
    }

    /// A step over the whole record other than a filter.
    pub fn stepped(&self, spec: &StepSpec) -> Result<Self, String> {
        match spec {
            StepSpec::Magnitude => Ok(self.with(self.values.iter().map(|value| value.abs()).collect())),
            StepSpec::Resample { step, over_time } => self.resampled(*step, *over_time),
            _ => Err("this step works inside the section".into()),
        }
    }

    fn resampled(&self, step: f64, over_time: bool) -> Result<Self, String> {
        let error = |error: resample::ResampleError| error.to_string();
        let axis = &self.along.axis;
        let along_time = if over_time { self.along.time.as_ref().or(Some(axis)) } else { None };
        let over = along_time.unwrap_or(axis);
        let (grid, values) = resample::resample(over, &self.values, step).map_err(error)?;
        let along = if over_time {
            Along {
                axis: resample::interpolate(over, axis, &grid).map_err(error)?,
                time: Some(grid),
                rate: Rate::PerTime(1.0 / step),
                first_row: None,
            }
        } else {
            let time = self.along.time.as_ref().map(|time| resample::interpolate(over, time, &grid)).transpose().map_err(error)?;
            Along { axis: grid, time, rate: Rate::PerLength(1.0 / step), first_row: None }
        };
        Ok(Self { along: Arc::new(along), values: Arc::new(values) })
    }

    /// A step inside the section. A window works on the samples of the record and stays inside the section by itself.
    pub fn windowed(&self, spec: &StepSpec, extent: Extent) -> Result<Self, String> {
        match spec {
            StepSpec::RemoveMean => {
                let mean = crate::metrics::statistics::mean(&self.values).ok_or("a mean of no samples")?;
                Ok(self.with(self.values.iter().map(|value| value - mean).collect()))
            }
            StepSpec::Magnitude => self.stepped(spec),
            StepSpec::Window { rms, width, step, over_time, ends } => {
                let sliding = Sliding { width: *width, step: *step, kind: if *rms { Kind::Rms } else { Kind::Mean }, ends: *ends };
                let (over, (start, end)) = self.window_axis(*over_time, extent)?;
                let values = sliding.over(over, &self.values, start, end).map_err(|error| error.to_string())?;
                let starts = sliding.starts(start, end).map_err(|error| error.to_string())?;
                let middle: Vec<f64> = starts.iter().map(|start| start + width / 2.0).collect();
                let along = if *over_time {
                    let axis = resample::interpolate(over, &self.along.axis, &middle).map_err(|error| error.to_string())?;
                    Along { axis, time: Some(middle), rate: Rate::PerTime(1.0 / step), first_row: None }
                } else {
                    Along { axis: middle, time: None, rate: Rate::PerLength(1.0 / step), first_row: None }
                };
                Ok(Self { along: Arc::new(along), values: Arc::new(values) })
            }
            _ => Err("this step works on the whole record".into()),
        }
    }

    fn window_axis(&self, over_time: bool, extent: Extent) -> Result<(&[f64], Extent), String> {
        if !over_time {
            return Ok((&self.along.axis, extent));
        }
        let time = self.along.time.as_deref().unwrap_or(&self.along.axis);
        let inside = self.along.inside(extent);
        let (Some(first), Some(last)) = (time.get(inside.start), time.get(inside.end.wrapping_sub(1))) else {
            return Err("no sample lies in the section".into());
        };
        Ok((time, (*first, *last)))
    }
}

/// `left op right`, sample by sample.
///
/// # Errors
/// Where the samples do not belong together or the result is not finite: which sample, and why.
pub fn arithmetic(operator: Operator, left: &Signal, right: &Signal) -> Result<Signal, String> {
    let run = match operator {
        Operator::Add => |a: f64, b: f64| a + b,
        Operator::Subtract => |a: f64, b: f64| a - b,
        Operator::Multiply => |a: f64, b: f64| a * b,
        _ => |a: f64, b: f64| a / b,
    };
    apply(&[left, right], &|of| run(of[0], of[1]))
}

/// A function of signals, sample by sample.
///
/// # Errors
/// As [`arithmetic`].
pub fn apply(inputs: &[&Signal], run: &dyn Fn(&[f64]) -> f64) -> Result<Signal, String> {
    let base = inputs.iter().find_map(|input| if let Signal::Samples(samples) = input { Some(samples) } else { None });
    let Some(base) = base else {
        let of: Vec<f64> = inputs.iter().map(|input| if let Signal::Constant(value) = input { *value } else { f64::NAN }).collect();
        let value = run(&of);
        return if value.is_finite() { Ok(Signal::Constant(value)) } else { Err("a number is not finite".into()) };
    };
    for input in inputs {
        if let Signal::Samples(samples) = input {
            if !Arc::ptr_eq(&samples.along, &base.along) && samples.along.axis != base.along.axis {
                return Err("signals of different sampling are combined; resample both alike".into());
            }
        }
    }
    let mut of = vec![0.0; inputs.len()];
    let mut values = Vec::with_capacity(base.values.len());
    for index in 0..base.values.len() {
        for (slot, input) in of.iter_mut().zip(inputs) {
            *slot = match input {
                Signal::Samples(samples) => samples.values[index],
                Signal::Constant(value) => *value,
            };
        }
        values.push(run(&of));
    }
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(Signal::Samples(base.with(values))),
        Some(at) => Err(format!("no finite number {}: a division by zero, or a value a function is not defined for", base.along.place(at))),
    }
}
