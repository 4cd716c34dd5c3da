//! Values of the names in an expression.

use crate::result::Reason;
use std::cell::RefCell;

use super::plan::{Kind, LimitName, Scalar, Side};

/// Values of the names in an expression. Each method may return an error that states why the value
/// is missing; by default it is missing.
pub trait Values {
    fn vehicle(&self, _: usize) -> Result<Scalar, Reason> {
        Err(Reason::VehicleDataUnknown)
    }
    fn column(&self, _: usize) -> Result<Scalar, Reason> {
        Err(Reason::SectionDataUnknown)
    }
    /// Start and end of the section on the axis, SI.
    fn extent(&self) -> Result<(f64, f64), Reason> {
        Err(Reason::NoSectionHere)
    }
    fn input(&self, _: usize) -> Result<f64, Reason> {
        Err(Reason::NoSignalHere)
    }
    /// Simulated and measured value of a pair, in this order.
    fn sides(&self) -> Result<(f64, f64), Reason> {
        Err(Reason::NoPairHere)
    }
    fn limit_of(&self, name: &LimitName) -> Result<f64, Reason> {
        Err(Reason::LimitUnknown { estimate: name.to_string() })
    }
    /// By what share of the right side `<=` and `>=` may be missed: the rounding of numbers that
    /// were converted to SI and subtracted.
    fn rounding(&self) -> f64 {
        0.0
    }
}

/// No name has a value: only constants can be evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Nothing;

impl Values for Nothing {}

/// Passes values on and records which section columns were used.
#[derive(Debug)]
pub struct Watched<'a, V: Values> {
    values: &'a V,
    columns: RefCell<Vec<usize>>,
}

impl<'a, V: Values> Watched<'a, V> {
    /// Nothing is used yet.
    pub fn new(values: &'a V) -> Self {
        Self { values, columns: RefCell::default() }
    }

    /// Indices of the columns used, in the order of first use.
    pub fn columns(&self) -> Vec<usize> {
        self.columns.borrow().clone()
    }
}

impl<V: Values> Values for Watched<'_, V> {
    fn vehicle(&self, index: usize) -> Result<Scalar, Reason> {
        self.values.vehicle(index)
    }
    fn column(&self, index: usize) -> Result<Scalar, Reason> {
        let mut columns = self.columns.borrow_mut();
        if !columns.contains(&index) {
            columns.push(index);
        }
        self.values.column(index)
    }
    fn extent(&self) -> Result<(f64, f64), Reason> {
        self.values.extent()
    }
    fn input(&self, index: usize) -> Result<f64, Reason> {
        self.values.input(index)
    }
    fn sides(&self) -> Result<(f64, f64), Reason> {
        self.values.sides()
    }
    fn limit_of(&self, name: &LimitName) -> Result<f64, Reason> {
        self.values.limit_of(name)
    }
    fn rounding(&self) -> f64 {
        self.values.rounding()
    }
}

/// The value of a constant or a name.
///
/// # Errors
/// The name has no value; an expression of parts is not evaluated here.
pub fn leaf(kind: &Kind, values: &dyn Values) -> Result<Scalar, Reason> {
    match kind {
        Kind::Constant(value) => Ok(value.clone()),
        Kind::NotStated(parameter, optional) => {
            Err(optional.told(Reason::ParameterNotStated { parameter: parameter.clone() }))
        }
        Kind::Vehicle(index) => values.vehicle(*index),
        Kind::Column(index) => values.column(*index),
        Kind::Start => values.extent().map(|(start, _)| Scalar::Number(start)),
        Kind::End => values.extent().map(|(_, end)| Scalar::Number(end)),
        Kind::Input(index) => values.input(*index).map(Scalar::Number),
        Kind::Side(side) => values.sides().map(|(simulated, measured)| {
            Scalar::Number(if *side == Side::Simulated { simulated } else { measured })
        }),
        Kind::LimitOf(name) => values.limit_of(name).map(Scalar::Number),
        _ => Err(Reason::Internal),
    }
}
