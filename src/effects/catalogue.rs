//! A catalogue of effects: what a simulation may lack, and how each is added.

use std::sync::Arc;

use super::operators::Operator;
use crate::source::{Source, Span};
use crate::units::Unit;
use crate::yaml::Node;

/// Effects as a text file declares them.
#[derive(Clone, Debug)]
pub struct Catalogue {
    pub name: String,
    pub title: String,
    pub source: Arc<Source>,
    /// Named groups of channels.
    pub groups: Vec<Group>,
    pub effects: Vec<Effect>,
    /// What the diagnosis needs to know: features, tolerances, discrepancies. Read by the diagnosis.
    pub diagnosis: Option<Node>,
}

/// Channels that belong together.
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

impl Acts {
    pub const ALL: [Self; 4] = [Self::Vehicle, Self::Track, Self::Environment, Self::MeasuringChain];

    #[must_use]
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Vehicle => "vehicle",
            Self::Track => "track",
            Self::Environment => "environment",
            Self::MeasuringChain => "measuring chain",
        }
    }
}

/// One effect.
#[derive(Clone, Debug)]
pub struct Effect {
    pub name: String,
    pub title: String,
    /// The physics in a line.
    pub means: String,
    pub acts: Acts,
    pub parameters: Vec<Parameter>,
    pub action: Action,
    /// Parameters that are fitted together, each set a candidate of its own.
    pub fits: Vec<Fit>,
    /// Whether the diagnosis may name it.
    pub candidate: bool,
    /// Whether it may be confined to some of the sections.
    pub confinable: bool,
    /// What measurement would tell it from others.
    pub settled_by: Option<String>,
    /// The declared tolerance that it is the blown form of.
    pub tolerance: Option<String>,
    pub span: Span,
}

/// A number of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// As in model and reports; `<channel>` stands for the channel it acts on.
    pub name: String,
    pub unit: Unit,
    /// What it is where the effect does not act; `None`: what the vehicle file says.
    pub neutral: Option<f64>,
    /// What it is where an effect is asked for without saying how large.
    pub default: f64,
    /// Plausible values, in the unit.
    pub low: f64,
    pub high: f64,
    pub meaning: String,
    /// The parameter of the model that it sets, and the factor to its unit.
    pub model: Option<(String, f64)>,
    /// The parameters of other simulators that it sets: simulator, parameter, factor.
    pub simulators: Vec<(String, String, f64)>,
}

/// How an effect is added.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// By parameters of the simulator.
    Simulator,
    /// By an operation on the signals; channels it may act on.
    Signals(Operator, Vec<String>),
}

/// A set of parameters that a fit varies, with the values that are tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Parameter by its number, values in its unit, in increasing order.
    pub axes: Vec<(usize, Vec<f64>)>,
    /// What operators act on together: one candidate for each list.
    pub channels: Vec<Vec<String>>,
}

impl Catalogue {
    #[must_use]
    pub fn effect(&self, name: &str) -> Option<&Effect> {
        self.effects.iter().find(|effect| effect.name == name)
    }

    #[must_use]
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// The channels of a group or a single channel.
    #[must_use]
    pub fn channels(&self, name: &str) -> Option<Vec<String>> {
        if let Some(group) = self.group(name) {
            return Some(group.channels.clone());
        }
        self.groups.iter().any(|group| group.channels.iter().any(|channel| channel == name)).then(|| vec![name.to_string()])
    }
}

impl Effect {
    /// The names that its parameters can have, with `<channel>` where one is chosen.
    pub fn parameter_names(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|parameter| parameter.name.as_str())
    }
}
