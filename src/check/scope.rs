//! The names that an expression can use, by where it stands.

use super::plan::{Assignment, Expr, Input, InputSide, Kind, Origin, Taken, Taking, Type};
use crate::source::Span;
use crate::units::Dimension;

/// The names that an expression can use, and the values taken from signals that it contains.
#[derive(Debug, Default)]
pub struct Scope {
    pub vehicle: bool,
    pub section: bool,
    /// Whether it is an expression over the samples of records.
    pub samples: bool,
    /// Whether samples may be missing: a number is taken of the others.
    pub may_miss: bool,
    /// Dimension of the own signal, where `simulated` and `measured` stand for its samples.
    pub own_of_both: Option<Dimension>,
    /// Whether, and from what, values of signals can be taken.
    pub reduce: Option<Reduce>,
    /// Dimension of `simulated` and `measured`, where they can be used.
    pub pair: Option<Dimension>,
    /// In the bound of a limit: the quantity, whose limits and those of others can be used.
    pub limits: Option<Bounded>,
    /// The zone of the sections, where it is a single one.
    pub zone: Option<String>,
    /// The rows of a group.
    pub group: Option<Group>,
    /// Dimension of `value`, the value of one row, where it can be used.
    pub value: Option<Dimension>,
    /// Statistics of other quantities that can be used beside `value`.
    pub others: Vec<Taking>,
    /// Arguments of the functions that are being looked at, by name.
    pub arguments: Vec<(String, Expr)>,
    /// The position at which named signals are taken.
    pub at: Assignment,
    /// Dimension of the own signal after its filter divided by that before.
    pub factor: Dimension,
    pub inputs: Vec<Input>,
    /// Whether there are other positions, of which a value can be taken.
    pub siblings: bool,
    /// Words that stand for themselves, where the value is one of them.
    pub words: Vec<String>,
}

/// The quantity whose values a bound limits.
#[derive(Clone, Debug)]
pub struct Bounded {
    pub quantity: String,
    /// The names of the estimates that it has limits of.
    pub estimates: Vec<String>,
}

/// From what values of signals are taken.
#[derive(Clone, Copy, Debug)]
pub struct Reduce {
    /// Dimension of the own processed signal of the quantity; `None` where there is no such signal.
    pub own: Option<Dimension>,
    pub axis: Dimension,
    pub side: InputSide,
    /// Whether metrics of the own signal can be used by name.
    pub metrics: bool,
}

impl Scope {
    /// Parameters and numbers only.
    pub fn constant() -> Self {
        Self::default()
    }

    /// Parameters and the data of the vehicle.
    pub fn vehicle() -> Self {
        Self { vehicle: true, ..Self::default() }
    }

    /// As [`Self::vehicle`], in one zone where it is for each.
    pub fn zone(zone: Option<&str>) -> Self {
        Self { zone: zone.map(str::to_string), ..Self::vehicle() }
    }

    /// As [`Self::vehicle`], with the data of a section.
    pub fn section() -> Self {
        Self { section: true, ..Self::vehicle() }
    }

    /// Samples at these positions; `own_of_both` where those of both sides can be used.
    pub fn samples(at: &Assignment, own_of_both: Option<Dimension>) -> Self {
        Self { samples: true, own_of_both, at: at.clone(), ..Self::section() }
    }

    /// The data of a section, in the same zone as this scope.
    pub fn of_section(&self) -> Self {
        let arguments = self.arguments.clone();
        Self { zone: self.zone.clone(), arguments, ..Self::section() }
    }

    /// The data of a section and its value, with those of both sides where it has any.
    pub fn of_row(&self, value: Option<Dimension>, sides: Option<Dimension>) -> Self {
        Self { value, pair: sides, ..self.of_section() }
    }

    /// The rows of a group, in the same zone as this scope. `values` is the dimension of the values;
    /// `None` where only data of the sections are available.
    pub fn of_group(&self, values: Option<Dimension>) -> Self {
        let group = Some(Group { values, taken: Vec::new() });
        Self { zone: self.zone.clone(), group, ..Self::vehicle() }
    }

    /// As [`Self::section`], with values of signals; `own` is the dimension of the own signal.
    pub fn reducing(own: Option<Dimension>, axis: Dimension) -> Self {
        Self {
            reduce: Some(Reduce { own, axis, side: InputSide::Own, metrics: false }),
            ..Self::section()
        }
    }

    /// As [`Self::reducing`], with metrics of the own signal.
    pub fn comparing(own: Option<Dimension>, axis: Dimension) -> Self {
        Self {
            reduce: Some(Reduce { own, axis, side: InputSide::Own, metrics: own.is_some() }),
            ..Self::section()
        }
    }

    /// As [`Self::section`], with the two compared values of this dimension.
    pub fn pair(dimension: Dimension) -> Self {
        Self { pair: Some(dimension), ..Self::section() }
    }

    /// Dimension of the values of a group, where there are any.
    pub fn values(&self) -> Option<Dimension> {
        self.group.as_ref()?.values
    }

    /// What the argument of a function stands for.
    pub fn argument(&self, name: &str) -> Option<&Expr> {
        self.arguments.iter().find(|(known, _)| known == name).map(|(_, found)| found)
    }

    /// Asks for a number that is taken from signals.
    pub fn input(&mut self, input: Input, dimension: Dimension, span: &Origin) -> Expr {
        self.inputs.push(input);
        number(self.inputs.len() - 1, dimension, span)
    }

    /// Asks for a number that is taken from the rows of a group.
    pub fn take(&mut self, taking: Taking, dimension: Dimension, span: &Origin) -> Option<Expr> {
        let taken = &mut self.group.as_mut()?.taken;
        taken.push(taking);
        Some(number(taken.len() - 1, dimension, span))
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
pub struct Group {
    /// Dimension of the values; `None` where only data of the sections are available.
    pub values: Option<Dimension>,
    pub taken: Vec<Taking>,
}

fn number(index: usize, dimension: Dimension, span: &Origin) -> Expr {
    Expr { kind: Kind::Input(index), ty: Type::Number(dimension), span: span.clone() }
}

impl Input {
    /// A number that is taken from the own signal.
    pub fn own(taken: Taken, side: InputSide, span: &Span) -> Self {
        let (signal, chain, over, span) = (None, Vec::new(), None, span.clone());
        Self { taken, signal, chain, over, side, siblings: false, span }
    }
}
