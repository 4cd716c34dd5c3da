//! Both sides of a section at common points, and values of expressions over their samples.

use super::facts::Known;
use super::signal::{Extent, Samples, Signal, apply, arithmetic, each};
use crate::catalog::Reducer;
use crate::check::evaluate::number;
use crate::check::plan::{self, AxisOperation, Side, SignalKind};
use crate::metrics::percentile::Method;
use crate::metrics::resample;

/// Both signals at the measured samples of the section.
pub struct Common {
    pub simulated: Vec<f64>,
    pub measured: Samples,
}

impl Common {
    /// The simulated signal is moved along the axis by `shift` (SI) and interpolated at the measured points, unless its samples lie
    /// there already.
    pub fn of(simulated: &Samples, measured: &Samples, extent: Option<Extent>, shift: f64) -> Result<Self, String> {
        let cut = |samples: &Samples| match extent {
            Some(extent) => samples.cut(extent),
            None => Ok(samples.clone()),
        };
        if shift != 0.0 {
            let measured = cut(measured)?;
            return Ok(Self { simulated: at(simulated, &measured.along.axis, shift)?, measured });
        }
        let (s, m) = (cut(simulated)?, cut(measured)?);
        let same = s.along.axis.len() == m.along.axis.len()
            && s.along.axis.iter().zip(m.along.axis.iter()).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()));
        let onto = if same { s.values.to_vec() } else { at(simulated, &m.along.axis, shift)? };
        Ok(Self { simulated: onto, measured: m })
    }

    /// Samples of a signal that may be one number all along.
    fn filled(&self, signal: Signal) -> Samples {
        match signal {
            Signal::Samples(samples) => samples,
            Signal::Constant(value) => self.measured.with(vec![value; self.measured.values.len()]),
        }
    }
}

/// # Errors
/// It is not defined for these samples.
fn number_of(reducer: Reducer, samples: &Samples, method: Method) -> Result<f64, String> {
    let value = reducer.run(&samples.along.axis, &samples.values, method).filter(|value| value.is_finite());
    value.ok_or_else(|| format!("the {} of {} samples is not defined", reducer.in_words(), samples.values.len()))
}

/// The simulated signal, moved along the axis by `shift`, at the given points.
fn at(simulated: &Samples, points: &[f64], shift: f64) -> Result<Vec<f64>, String> {
    let own = &simulated.along.axis;
    let interpolated = match shift {
        0.0 => resample::interpolate(own, &simulated.values, points),
        _ => resample::interpolate(&own.iter().map(|at| at + shift).collect::<Vec<_>>(), &simulated.values, points),
    };
    interpolated.map_err(|error| match shift {
        0.0 => format!("the simulation cannot be interpolated at the measured points: {error}"),
        _ => format!("the repeat cannot be interpolated at the points of its original: {error}"),
    })
}

/// The filtered signals of both records, from which an expression takes its samples.
pub struct Both<'a> {
    pub simulated: &'a Samples,
    pub measured: &'a Samples,
    pub known: &'a Known<'a>,
    pub extent: Option<Extent>,
    /// Added to the axis of the simulated signal, SI.
    pub shift: f64,
}

impl Both<'_> {
    /// The value of a reduced expression over both sides, and the number of samples.
    pub fn reduced(&self, reducer: Reducer, method: Method, of: &plan::Signal) -> Result<(f64, usize), String> {
        let common = Common::of(self.simulated, self.measured, self.extent, self.shift)?;
        let samples = common.filled(self.signal(of, &common, method)?);
        Ok((number_of(reducer, &samples, method)?, samples.values.len()))
    }

    fn signal(&self, of: &plan::Signal, common: &Common, method: Method) -> Result<Signal, String> {
        let inner = |signal: &plan::Signal| self.signal(signal, common, method);
        match &of.kind {
            SignalKind::Side(Side::Simulated) => Ok(Signal::Samples(common.measured.with(common.simulated.clone()))),
            SignalKind::Side(Side::Measured) => Ok(Signal::Samples(common.measured.clone())),
            SignalKind::Scalar(expr) => Ok(Signal::Constant(number(expr, self.known)?)),
            SignalKind::Binary(operator, left, right) => arithmetic(*operator, &inner(left)?, &inner(right)?),
            SignalKind::Negative(signal) => each(&inner(signal)?, |value| -value),
            SignalKind::Power(signal, exponent) => each(&inner(signal)?, |value| value.powi(i32::from(*exponent))),
            SignalKind::Call(function, arguments) => {
                let arguments = arguments.iter().map(inner).collect::<Result<Vec<_>, _>>()?;
                apply(&arguments.iter().collect::<Vec<_>>(), function.run)
            }
            SignalKind::OverAxis(AxisOperation::Shifted(distance), signal) => {
                let (of_record, moved) = match signal.kind {
                    SignalKind::Side(Side::Simulated) => (self.simulated, self.shift),
                    _ => (self.measured, 0.0),
                };
                let distance = number(distance, self.known)?;
                let points: Vec<f64> = common.measured.along.axis.iter().map(|x| x - distance - moved).collect();
                let moved = resample::interpolate(&of_record.along.axis, &of_record.values, &points)
                    .map_err(|error| format!("the record is too short beyond the section for this shift: {error}"))?;
                Ok(Signal::Samples(common.measured.with(moved)))
            }
            SignalKind::OverAxis(operation, signal) => match inner(signal)? {
                Signal::Samples(samples) => {
                    let axis = &samples.along.axis;
                    let extent = (axis.first().copied().unwrap_or(0.0), axis.last().copied().unwrap_or(0.0));
                    Ok(Signal::Samples(samples.over_axis(operation, self.known, extent)?))
                }
                Signal::Constant(_) => Err("a constant number has no samples along the axis".into()),
            },
            SignalKind::Level(reducer, signal) => Ok(Signal::Constant(number_of(*reducer, &common.filled(inner(signal)?), method)?)),
            // The checker does not allow these here.
            SignalKind::Column { .. } | SignalKind::Filtered(..) | SignalKind::Select(..) => Err("this signal has other samples".into()),
        }
    }
}
