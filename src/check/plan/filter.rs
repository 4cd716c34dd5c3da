//! Filters and their steps.

use crate::catalog::Reducer;
use crate::metrics::{
    filter::{Band, Cutoff, Phase, TransferFunction, Warping},
    window::Ends,
};
use crate::source::Span;
use crate::units::Dimension;

/// A filter that the protocol declares.
#[derive(Clone, Debug)]
pub struct NamedFilter {
    pub name: String,
    pub title: String,
    pub steps: Vec<Step>,
    pub source: Option<String>,
}

/// A step of a filter chain.
#[derive(Clone, Debug)]
pub struct Step {
    pub kind: StepSpec,
    /// As printed: `low-pass 20 Hz, order 4, zero-phase, as-applied`.
    pub words: String,
    /// Whether its frequencies are in cycles per length, so that it must follow a resampling over a
    /// length.
    pub per_length: bool,
    /// Dimension of the output divided by that of the input.
    pub factor: Dimension,
    pub span: Span,
}

/// Steps with numbers in SI. A length or time step states the axis it is used over.
#[derive(Clone, Debug, PartialEq)]
pub enum StepSpec {
    Butterworth {
        band: Band,
        order: usize,
        phase: Phase,
        cutoff: Cutoff,
    },
    Transfer {
        function: TransferFunction,
        phase: Phase,
        warping: Warping,
    },
    Window {
        reducer: Reducer,
        width: f64,
        /// `None`: a window begins at every sample.
        step: Option<f64>,
        over_time: bool,
        ends: Ends,
        short_sections: bool,
    },
    Resample {
        step: f64,
        over_time: bool,
    },
    RemoveMean,
    Magnitude,
}
