//! The names that an expression can use, by where it stands.

use super::names::Assignment;
use super::plan::{Input, InputSide, Kind, Taking};
use crate::units::Dimension;

/// The names that an expression can use, and the values taken from signals that it contains.
#[derive(Debug)]
pub(super) struct Scope {
    pub vehicle: bool,
    pub section: bool,
    /// Whether, and from what, values of signals can be taken.
    pub reduce: Option<Reduce>,
    /// Dimension of `simulated` and `measured`, where they can be used.
    pub pair: Option<Dimension>,
    /// Dimension of the limits of other statistics, and the names of these.
    pub limits: Option<(Dimension, Vec<String>)>,
    /// The zone of the sections, where it is a single one.
    pub zone: Option<String>,
    /// The rows of a group.
    pub group: Option<Group>,
    /// Dimension of `value`, the value of one row, where it can be used.
    pub value: Option<Dimension>,
    /// Statistics of other quantities that can be used beside `value`.
    pub others: Vec<Taking>,
    /// The position at which named signals are taken.
    pub at: Assignment,
    /// Dimension of the own signal after its filter divided by that before.
    pub factor: Dimension,
    pub inputs: Vec<Input>,
    /// Words that stand for themselves, where the value is one of them.
    pub words: Vec<String>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Reduce {
    /// Dimension of the own processed signal of the quantity; `None` where there is no such signal.
    pub own: Option<Dimension>,
    pub axis: Dimension,
    pub side: InputSide,
    /// Whether metrics of the own signal can be used by name.
    pub metrics: bool,
}

impl Scope {
    fn new(vehicle: bool, section: bool) -> Self {
        Self {
            vehicle,
            section,
            reduce: None,
            pair: None,
            limits: None,
            zone: None,
            group: None,
            value: None,
            others: Vec::new(),
            at: Assignment::new(),
            factor: Dimension::ONE,
            inputs: Vec::new(),
            words: Vec::new(),
        }
    }

    /// Parameters and numbers only.
    pub fn constant() -> Self {
        Self::new(false, false)
    }

    pub fn vehicle() -> Self {
        Self::new(true, false)
    }

    pub fn section() -> Self {
        Self::new(true, true)
    }

    pub fn reducing(own: Option<Dimension>, axis: Dimension) -> Self {
        Self {
            reduce: Some(Reduce { own, axis, side: InputSide::Own, metrics: false }),
            ..Self::new(true, true)
        }
    }

    /// As [`Self::reducing`], with metrics of the own signal.
    pub fn comparing(own: Option<Dimension>, axis: Dimension) -> Self {
        Self {
            reduce: Some(Reduce { own, axis, side: InputSide::Own, metrics: own.is_some() }),
            ..Self::new(true, true)
        }
    }

    pub fn pair(dimension: Dimension) -> Self {
        Self { pair: Some(dimension), ..Self::new(true, true) }
    }

    /// How much is asked of the records and of the group so far.
    pub fn asked(&self) -> (usize, usize) {
        (self.inputs.len(), self.group.as_ref().map_or(0, |group| group.taken.len()))
    }

    /// Takes back what was asked since.
    pub fn forget(&mut self, (inputs, taken): (usize, usize)) {
        self.inputs.truncate(inputs);
        if let Some(group) = &mut self.group {
            group.taken.truncate(taken);
        }
    }
}

/// What an expression over a group can use.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Dimension of the values; `None` where only data of the sections are available.
    pub values: Option<Dimension>,
    pub taken: Vec<Taking>,
}

impl Group {
    pub fn take(&mut self, taking: Taking) -> Kind {
        self.taken.push(taking);
        Kind::Input(self.taken.len() - 1)
    }
}
