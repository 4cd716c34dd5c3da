//! What a catalogue says about diagnosing: features, tolerances, and what the simulation is allowed to be wrong in.

mod read;

use crate::simulate::Section;
use crate::source::Span;
use crate::units::Unit;

/// Before a covariate: its reciprocal.
pub const INVERSE: &str = "1 / ";

/// The `diagnosis` part of a catalogue.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Edges of the bands in Hz.
    pub edges: Vec<f64>,
    /// Band in Hz for gains and lags.
    pub alike: (f64, f64),
    /// The largest lag that is looked for, in the unit of the axis.
    pub furthest: f64,
    pub groups: Vec<GroupFeatures>,
    pub tolerances: Vec<Tolerance>,
    pub discrepancies: Vec<Discrepancy>,
    /// Columns of the section table whose values an effect may be confined to.
    pub confine: Vec<String>,
    /// Columns of the section table that what is left may follow; `1 / ` before one for its reciprocal.
    pub covariates: Vec<String>,
    /// The column whose sign folds left and right, and the value that is mirrored.
    pub mirror: Option<(String, String)>,
    /// The column that sections are stratified by.
    pub stratum: Option<String>,
    /// Every column of the section table that is named above, and where.
    pub columns: Vec<(String, Span)>,
    pub positions: Vec<Position>,
    /// Sums of channels with weights, by name.
    pub invariants: Vec<(String, Vec<(String, f64)>)>,
    /// How the dynamic content is described beside the features.
    pub shape: Option<Shape>,
}

/// How the dynamic content of a group of channels is described.
#[derive(Clone, Debug)]
pub struct Shape {
    /// In Hz: where spectra are compared line by line.
    pub range: (f64, f64),
    /// In %: what is called the peak of a record, to either side of its median.
    pub percentile: f64,
    /// The number of the vehicle file that is the radius of a wheel in m.
    pub wheel_radius: Option<String>,
}

/// Features of a group of channels.
#[derive(Clone, Debug)]
pub struct GroupFeatures {
    pub name: String,
    pub level: bool,
    pub bands: usize,
    pub alike: bool,
    /// Standard deviation of a level beyond what the record itself shows, in the unit of the channels.
    pub level_sd: f64,
    /// Of the logarithm of a band's rms.
    pub band_sd: f64,
    pub gain_sd: f64,
    pub lag_sd: f64,
    /// The unit of its channels, in which tolerances are declared.
    pub unit: Unit,
    /// Names of the declared tolerances of these channels.
    pub noise: Option<String>,
    pub offset: Option<String>,
    pub gain: Option<String>,
    /// Which axis of motion: groups of one axis share discrepancies.
    pub axis: String,
    /// What an engineer calls it.
    pub says: String,
}

/// Something that the test engineer admits not to know.
#[derive(Clone, Debug)]
pub struct Tolerance {
    /// As in `declared_tolerances`, without unit.
    pub name: String,
    /// The unit that it is read in.
    pub unit: Unit,
    /// One standard deviation where the campaign declares none.
    pub default: f64,
    /// Parameters that are scaled, each on its own.
    pub scales: Vec<String>,
    /// Parameters that are added to: the factor from the declared unit to theirs.
    pub adds: Vec<(String, f64)>,
    /// Parameters that are set together, as another model of the same thing would have them: that model is one standard deviation.
    pub sets: Vec<(String, f64)>,
    /// Every parameter that is named, and where.
    pub named: Vec<(String, Span)>,
    /// Of a size that is never negative: the share of what is declared that is expected to be there; 0 for a size that may lie on either
    /// side.
    pub expected: f64,
    /// Whether each section has its own.
    pub per_section: bool,
    /// How much of one standard deviation all sections have in common, from 0 to 1.
    pub shared: f64,
    /// One standard deviation of what may be off in the same way besides, whatever is declared: an effect must be further out than both.
    pub besides: f64,
    /// Whether each parameter that it scales is looked at alone, as a cause that no effect stands for.
    pub suspects: bool,
}

/// What the simulation may be wrong in without an effect being missing: one standard deviation.
#[derive(Clone, Debug)]
pub struct Discrepancy {
    pub feature: FeatureKind,
    /// Weights by channel for levels; all channels of the groups otherwise.
    pub channels: Vec<(String, f64)>,
    /// In the unit of the channel, or of the logarithm; one number, or one per band.
    pub sd: Vec<f64>,
    pub moves: Moves,
    pub over: Over,
    pub times: Times,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    Level,
    /// Each band on its own.
    Bands,
    /// All bands alike.
    Amplitude,
    Gain,
    Lag,
}

/// Which channels move together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    All,
    Group,
    Channel,
}

/// Which sections move together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    All,
    Strata,
    Sections,
}

/// What it grows with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Times {
    One,
    /// The number in a column over this number; and its sign by the mirrored column.
    Over(f64),
    /// 1, or -1 in mirrored sections.
    Side,
    /// As `Over`, without the sign.
    Unsigned(f64),
}

/// A position as an engineer speaks of it: channels where the section is not mirrored, and where it is.
#[derive(Clone, Debug)]
pub struct Position {
    pub name: String,
    pub straight: Vec<String>,
    pub mirrored: Vec<String>,
}

impl Settings {
    /// 1 in a curve, -1 in a mirrored one, 0 on straight track.
    #[must_use]
    pub fn side(&self, section: &Section) -> f64 {
        match (section.number("radius").filter(|radius| *radius > 0.0), &self.mirror) {
            (None, _) => 0.0,
            (Some(_), Some((column, value))) if section.fact(column) == Some(value) => -1.0,
            (Some(_), _) => 1.0,
        }
    }

    /// Everything that a campaign may declare, with the unit that it is read in.
    #[must_use]
    pub fn tolerated(&self) -> Vec<(&str, Unit)> {
        let mut all: Vec<(&str, Unit)> = self.tolerances.iter().map(|one| (one.name.as_str(), one.unit.clone())).collect();
        for group in &self.groups {
            all.extend(group.gain.as_deref().map(|name| (name, Unit::one())));
            all.extend([&group.noise, &group.offset].into_iter().flatten().map(|name| (name.as_str(), group.unit.clone())));
        }
        all
    }
}
