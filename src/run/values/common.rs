//! Both sides of a section at common points, and values of expressions over their samples.

use std::{
    borrow::Cow,
    cell::{OnceCell, RefCell},
    ops::Range,
    rc::Rc,
    sync::Arc,
};

use crate::catalog::Reducer;
use crate::check::evaluate::words;
use crate::metrics::{
    percentile::Method,
    resample::{self, Located},
    sampling::Traits,
};
use crate::run::{
    prelude::*,
    record::{Along, Samples, Signal, apply, arithmetic, choose, each, mapped},
    sections::{Extent, Known},
};

/// Where the samples of two records meet. It is the same for all signals of the two.
#[derive(Debug)]
pub struct Meeting {
    /// The measured samples of the section.
    along: Arc<Along>,
    inside: Range<usize>,
    onto: Onto,
}

/// The simulated values at the measured samples.
#[derive(Debug)]
enum Onto {
    /// These samples lie there already.
    Samples(Range<usize>),
    Interpolated(Located),
}

/// What all comparisons of the records of one section need, each computed once.
#[derive(Debug, Default)]
pub struct Meetings {
    met: RefCell<Vec<Met>>,
    sorted: RefCell<Vec<Sorted>>,
    shifts: RefCell<Vec<Shifted>>,
}

/// Two signals, and the shift at which they agree best, once it was looked for.
type Shifted = (Arc<Vec<f64>>, Arc<Vec<f64>>, Rc<OnceCell<isize>>);

/// The values of a signal that a meeting has of one side, sorted.
#[derive(Debug)]
struct Sorted {
    of: (Arc<Vec<f64>>, Option<Rc<Meeting>>, Side),
    values: Rc<Vec<f64>>,
}

/// A meeting, and of what: both axes and the shift between them.
#[derive(Debug)]
struct Met {
    of: (Arc<Along>, Arc<Along>, u64),
    found: Result<Rc<Meeting>, Reason>,
}

impl Meetings {
    /// The simulated axis is moved by `shift` (SI). Simulated values are interpolated at the
    /// measured samples of the section, unless their own lie there already. The section is the same
    /// for all meetings.
    pub fn of(
        &self,
        simulated: &Samples,
        measured: &Samples,
        extent: Option<Extent>,
        shift: f64,
    ) -> Result<Rc<Meeting>, Reason> {
        let mut all = self.met.borrow_mut();
        let (s, m) = (&simulated.along, &measured.along);
        let same = |met: &&Met| {
            Arc::ptr_eq(&met.of.0, s) && Arc::ptr_eq(&met.of.1, m) && met.of.2 == shift.to_bits()
        };
        if let Some(met) = all.iter().find(same) {
            return met.found.clone();
        }
        let found = Meeting::of(s, m, extent, shift).map(Rc::new);
        all.push(Met { of: (Arc::clone(s), Arc::clone(m), shift.to_bits()), found: found.clone() });
        found
    }

    /// Where metrics keep the shift at which two signals agree best.
    pub fn best_shift(&self, (simulated, measured): (&Samples, &Samples)) -> Rc<OnceCell<isize>> {
        let mut all = self.shifts.borrow_mut();
        let (s, m) = (&simulated.values, &measured.values);
        if let Some((.., shift)) =
            all.iter().find(|(of, with, _)| Arc::ptr_eq(of, s) && Arc::ptr_eq(with, m))
        {
            return Rc::clone(shift);
        }
        let shift = Rc::new(OnceCell::new());
        all.push((Arc::clone(s), Arc::clone(m), Rc::clone(&shift)));
        shift
    }

    /// The values that a meeting has of a signal, sorted: several metrics take their distribution,
    /// at several numbers of points.
    pub fn sorted(
        &self,
        (samples, meeting, side): (&Samples, Option<&Rc<Meeting>>, Side),
        values: &[f64],
    ) -> Rc<Vec<f64>> {
        let mut all = self.sorted.borrow_mut();
        let same = |known: &&Sorted| {
            let (of, met, from) = &known.of;
            Arc::ptr_eq(of, &samples.values)
                && met.as_ref().map(Rc::as_ptr) == meeting.map(Rc::as_ptr)
                && *from == side
        };
        if let Some(known) = all.iter().find(same) {
            return Rc::clone(&known.values);
        }
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let sorted = Rc::new(sorted);
        all.push(Sorted {
            of: (Arc::clone(&samples.values), meeting.cloned(), side),
            values: Rc::clone(&sorted),
        });
        sorted
    }
}

impl Meeting {
    fn of(
        simulated: &Along,
        measured: &Arc<Along>,
        extent: Option<Extent>,
        shift: f64,
    ) -> Result<Self, Reason> {
        let inside = measured.part_inside(extent)?;
        let along = if inside.len() == measured.axis.len() {
            Arc::clone(measured)
        } else {
            Arc::new(measured.part(inside.clone()))
        };
        let own = if shift == 0.0 { Some(simulated.part_inside(extent)?) } else { None };
        let there = |own: &Range<usize>| {
            let (s, m) = (&simulated.axis[own.clone()], &along.axis);
            s.len() == m.len()
                && s.iter().zip(m.iter()).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()))
        };
        let onto = match own.filter(there) {
            Some(own) => Onto::Samples(own),
            None => Onto::Interpolated(located(simulated, &along.axis, shift)?),
        };
        Ok(Self { along, inside, onto })
    }

    /// Axis values at which both have a sample.
    pub fn axis(&self) -> &[f64] {
        &self.along.axis
    }

    pub fn simulated<'a>(&self, samples: &'a Samples) -> Cow<'a, [f64]> {
        match &self.onto {
            Onto::Samples(own) => Cow::Borrowed(&samples.values[own.clone()]),
            Onto::Interpolated(located) => Cow::Owned(located.values(&samples.values)),
        }
    }

    pub fn measured<'a>(&self, samples: &'a Samples) -> &'a [f64] {
        &samples.values[self.inside.clone()]
    }
}

/// Both signals at the measured samples of the section.
struct Common {
    simulated: Vec<f64>,
    measured: Samples,
}

impl Common {
    fn of(both: &Both<'_>) -> Result<Self, Reason> {
        let meeting = both.meetings.of(both.simulated, both.measured, both.extent, both.shift)?;
        let measured = Samples {
            along: Arc::clone(&meeting.along),
            values: Arc::new(meeting.measured(both.measured).to_vec()),
        };
        Ok(Self { simulated: meeting.simulated(both.simulated).into_owned(), measured })
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
fn number_of(reducer: Reducer, samples: &Samples, method: Method) -> Result<f64, Reason> {
    let value = reducer.run(&samples.along.axis, &Traits::of(&samples.values), method);
    let value = value.filter(|value| value.is_finite());
    let samples = samples.values.len();
    value.ok_or_else(|| Reason::ReducerUndefined { reducer: reducer.in_words(), samples })
}

/// Points on the simulated axis, moved along by `shift`.
fn located(simulated: &Along, points: &[f64], shift: f64) -> Result<Located, Reason> {
    let own = &simulated.axis;
    let located = match shift {
        0.0 => Located::on(own, points),
        _ => Located::on(&own.iter().map(|at| at + shift).collect::<Vec<_>>(), points),
    };
    located
        .map_err(|error| Reason::NotInterpolated { repeat: shift != 0.0, says: error.to_string() })
}

/// The filtered signals of both records, from which an expression takes its samples.
pub struct Both<'a> {
    pub simulated: &'a Samples,
    pub measured: &'a Samples,
    pub known: &'a Known<'a>,
    pub extent: Option<Extent>,
    /// Added to the axis of the simulated signal, SI.
    pub shift: f64,
    pub meetings: &'a Meetings,
}

impl Both<'_> {
    /// The value of a reduced expression over both sides, and the number of samples.
    pub fn reduced(
        &self,
        reducer: Reducer,
        method: Method,
        of: &Expr,
    ) -> Result<(f64, usize), Reason> {
        let common = Common::of(self)?;
        let mut samples = common.filled(self.signal(of, &common, method)?);
        if of.may_miss_samples() {
            samples = samples.present()?;
        }
        Ok((number_of(reducer, &samples, method)?, samples.values.len()))
    }

    fn signal(&self, of: &Expr, common: &Common, method: Method) -> Result<Signal, Reason> {
        let inner = |signal: &Expr| self.signal(signal, common, method);
        match &of.kind {
            _ if of.ty == Type::Flag => Ok(Signal::Constant(f64::from(flag(of, self.known)?))),
            Kind::Side(Side::Simulated) => {
                Ok(Signal::Samples(common.measured.with(common.simulated.clone())))
            }
            Kind::Side(Side::Measured) => Ok(Signal::Samples(common.measured.clone())),
            Kind::Binary(operator, left, right) => {
                arithmetic(*operator, &inner(left)?, &inner(right)?)
            }
            Kind::Negative(signal) => each(&inner(signal)?, |value| -value),
            Kind::Mapped(signal, mapping) => mapped(&inner(signal)?, mapping, || words(signal)),
            Kind::Call(function, arguments) => {
                let arguments = arguments.iter().map(inner).collect::<Result<Vec<_>, _>>()?;
                apply(&arguments.iter().collect::<Vec<_>>(), function.run)
            }
            Kind::OverAxis(AxisOperation::Shifted(distance), signal) => {
                let (of_record, moved) = match signal.kind {
                    Kind::Side(Side::Simulated) => (self.simulated, self.shift),
                    _ => (self.measured, 0.0),
                };
                let distance = number(distance, self.known)?;
                let points: Vec<f64> =
                    common.measured.along.axis.iter().map(|x| x - distance - moved).collect();
                let moved =
                    resample::interpolate(&of_record.along.axis, &of_record.values, &points)
                        .map_err(|error| Reason::TooShortForShift { says: error.to_string() })?;
                Ok(Signal::Samples(common.measured.with(moved)))
            }
            Kind::OverAxis(operation, signal) => match inner(signal)? {
                Signal::Samples(samples) => {
                    let axis = &samples.along.axis;
                    let extent =
                        (axis.first().copied().unwrap_or(0.0), axis.last().copied().unwrap_or(0.0));
                    Ok(Signal::Samples(samples.over_axis(operation, self.known, extent)?))
                }
                Signal::Constant(_) => Err(Reason::NoSamplesOfConstant),
            },
            Kind::OfSection(operation, signal) => match inner(signal)? {
                Signal::Samples(samples) => Ok(Signal::Samples(samples.of_section(operation)?)),
                Signal::Constant(_) => Err(Reason::NoSamplesOfConstant),
            },
            Kind::Level(reducer, signal) => {
                Ok(Signal::Constant(number_of(*reducer, &common.filled(inner(signal)?), method)?))
            }
            Kind::Not(condition) => each(&inner(condition)?, |holds| 1.0 - holds),
            Kind::Cases(arms, otherwise) if matches!(of.ty, Type::Samples { .. }) => {
                let values = arms.iter().map(|(value, _)| value).chain(otherwise.as_deref());
                let values = values.map(inner).collect::<Result<Vec<_>, _>>()?;
                let conditions = arms.iter().map(|(_, condition)| inner(condition));
                let conditions = conditions.collect::<Result<Vec<_>, _>>()?;
                choose(&values.iter().collect::<Vec<_>>(), &conditions.iter().collect::<Vec<_>>())
            }
            // The checker does not allow these here.
            Kind::Channel { .. } | Kind::Filtered(..) => Err(Reason::Internal),
            _ => Ok(Signal::Constant(number(of, self.known)?)),
        }
    }
}
