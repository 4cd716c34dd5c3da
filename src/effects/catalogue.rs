//! A catalogue of effects that a simulation may lack, and how each is added.

use std::sync::Arc;

use super::{expression::Formula, operators::Operator};
use crate::source::{Source, Span};
use crate::units::Unit;
use crate::yaml::{Node, Words};

/// A catalogue as declared in a text file.
#[derive(Clone, Debug)]
pub struct Catalogue {
    pub name: String,
    pub title: String,
    pub source: Arc<Source>,
    /// Named groups of channels.
    pub groups: Vec<Group>,
    /// Units of the channels in expressions.
    pub units: Vec<(String, Unit)>,
    pub effects: Vec<Effect>,
    /// The part for the diagnosis: features, tolerances, discrepancies. Interpreted by the
    /// diagnosis.
    pub diagnosis: Option<Node>,
}

/// Channels of the same kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    pub name: String,
    pub channels: Vec<String>,
}

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    Vehicle,
    Track,
    Environment,
    MeasuringChain,
}

impl Words for Acts {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("vehicle", Self::Vehicle),
        ("track", Self::Track),
        ("environment", Self::Environment),
        ("measuring chain", Self::MeasuringChain),
    ];
}

/// One effect.
#[derive(Clone, Debug)]
pub struct Effect {
    pub name: String,
    pub title: String,
    /// Physical meaning, one line.
    pub means: String,
    pub acts: Acts,
    pub parameters: Vec<Parameter>,
    pub action: Action,
    /// Sets of parameters that are fitted together; each set is a candidate.
    pub fits: Vec<Fit>,
    /// Whether the diagnosis may name it.
    pub candidate: bool,
    /// Whether it may be confined to some of the sections.
    pub confinable: bool,
    /// The measurement that discriminates it from other effects.
    pub settled_by: Option<String>,
    /// The declared tolerance of the same parameter.
    pub tolerance: Option<String>,
    pub span: Span,
}

/// A numeric parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name in model and reports; `<channel>` is replaced by the channel.
    pub name: String,
    pub unit: Unit,
    /// Its value without the effect; `None`: the value of the vehicle file.
    pub neutral: Option<f64>,
    /// Its value if the effect is given without a size.
    pub default: f64,
    /// Plausible range, in the unit.
    pub low: f64,
    pub high: f64,
    /// The values that a diagnosis tries, in increasing order.
    pub trials: Vec<f64>,
    pub meaning: String,
    /// Whether the effect vanishes towards the upper end of the range.
    pub vanishes_high: bool,
    /// The parameter of the model, and the factor to its unit.
    pub model: Option<(String, f64)>,
    /// The parameters of other simulators: simulator, parameter, factor.
    pub simulators: Vec<(String, String, f64)>,
}

/// How an effect is added.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// By parameters of the simulator.
    Simulator,
    /// By an operation on the signals, with the channels on which it may act.
    Signals(Operator, Vec<String>),
    /// By formulas of channels of the same record.
    Formulas(Vec<Formula>),
}

/// Parameters that are fitted together, with the values tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Index of the parameter, and its values in increasing order.
    pub axes: Vec<(usize, Vec<f64>)>,
    /// Lists of channels on which an operator acts together; one candidate per list.
    pub channels: Vec<Vec<String>>,
}

impl Catalogue {
    pub fn effect(&self, name: &str) -> Option<&Effect> {
        self.effects.iter().find(|effect| effect.name == name)
    }

    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// The channels of a group or a single channel.
    pub fn channels(&self, name: &str) -> Option<Vec<String>> {
        if let Some(group) = self.group(name) {
            return Some(group.channels.clone());
        }
        let mut channels = self.groups.iter().flat_map(|group| &group.channels);
        channels.any(|channel| channel == name).then(|| vec![name.to_string()])
    }
}

impl Effect {
    /// The names of its parameters, with `<channel>` where a channel is chosen.
    pub fn parameter_names(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|parameter| parameter.name.as_str())
    }
}
