//! The `diagnosis` part of a catalogue: features, tolerances, and the allowed discrepancy of the
//! simulation.

mod read;

use crate::simulate::Section;
use crate::source::Span;
use crate::units::Unit;

/// Prefix of a covariate that stands for its reciprocal.
pub const INVERSE: &str = "1 / ";

/// The `diagnosis` part of a catalogue.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Edges of the bands in Hz.
    pub edges: Vec<f64>,
    /// Band in Hz in which gains and lags are estimated.
    pub alike: (f64, f64),
    /// The largest lag searched, in the unit of the axis.
    pub furthest: f64,
    pub groups: Vec<GroupFeatures>,
    pub tolerances: Vec<Tolerance>,
    pub discrepancies: Vec<Discrepancy>,
    pub response: Response,
    /// Share of the campaigns with nothing hidden in which some effect may reach the required
    /// evidence by chance.
    pub false_name_rate: f64,
    /// Columns of the section table by which an effect may be confined.
    pub confine: Vec<String>,
    /// Columns of the section table tested as covariates of the residual; with the prefix `1 / `
    /// the reciprocal.
    pub covariates: Vec<String>,
    /// The column that distinguishes left and right curves, and the value of mirrored sections.
    pub mirror: Option<(String, String)>,
    /// The column that defines the strata of the sections.
    pub stratum: Option<String>,
    /// Every column of the section table named above, with its place in the catalogue.
    pub columns: Vec<(String, Span)>,
    pub positions: Vec<Position>,
    /// Sums of channels with weights, by name.
    pub invariants: Vec<(String, Vec<(String, f64)>)>,
    /// Description of the dynamic content in addition to the features.
    pub shape: Option<Shape>,
}

/// Relative error of the change that a simulated effect causes: one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Common to all levels, and common to all other features; each other feature has the latter a
    /// second time by itself.
    pub levels: f64,
    pub others: f64,
    /// In addition for a group of channels, and for a group in one stratum.
    pub groups: f64,
    /// Common to all features. It cannot be distinguished from another size of the effect: it
    /// widens the interval of the size only.
    pub common: f64,
}

impl Default for Response {
    /// For a vehicle model (judgement; `common` from campaigns of another code, see the catalogue):
    /// levels follow from equilibrium, dynamic content from contact and dampers as well.
    fn default() -> Self {
        Self { levels: 0.05, others: 0.2, groups: 0.1, common: 0.15 }
    }
}

/// Description of the dynamic content of the groups of channels.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Frequency range in Hz in which spectra are compared line by line.
    pub range: (f64, f64),
    /// Percentile in % of a record, to either side of its median, that defines its peak.
    pub percentile: f64,
    /// Key of the wheel radius in m in the vehicle file.
    pub wheel_radius: Option<String>,
}

/// Features of a group of channels.
#[derive(Clone, Debug)]
pub struct GroupFeatures {
    pub name: String,
    pub level: bool,
    pub bands: usize,
    pub alike: bool,
    /// Whether the records are compared sample by sample as well.
    pub samples: bool,
    /// Standard deviation of a level in addition to the scatter of the record, in the unit of the
    /// channels.
    pub level_sd: f64,
    /// Standard deviation of the logarithm of a band's rms.
    pub band_sd: f64,
    pub gain_sd: f64,
    pub lag_sd: f64,
    /// The unit of its channels, in which tolerances are declared.
    pub unit: Unit,
    /// Names of the declared tolerances of these channels.
    pub noise: Option<String>,
    pub offset: Option<String>,
    pub gain: Option<String>,
    /// Axis of motion. Groups with the same axis share discrepancies.
    pub axis: String,
    /// Name in reports.
    pub says: String,
}

/// A parameter that the campaign may declare with a standard deviation.
#[derive(Clone, Debug)]
pub struct Tolerance {
    /// Its key in `declared_tolerances`, without unit.
    pub name: String,
    /// Unit of the standard deviation.
    pub unit: Unit,
    /// One standard deviation where the campaign declares none.
    pub default: f64,
    /// Parameters that are multiplied by 1 + x, each independently.
    pub scales: Vec<String>,
    /// Parameters to which x is added: the factor from the declared unit to theirs.
    pub adds: Vec<(String, f64)>,
    /// Parameters that are set together as in an alternative model, whose difference counts as one
    /// standard deviation.
    pub sets: Vec<(String, f64)>,
    /// Every parameter of the tolerance, with its place in the catalogue.
    pub named: Vec<(String, Span)>,
    /// For a quantity that is never negative: its expected value as a share of the declared one; 0
    /// for a quantity of either sign.
    pub expected: f64,
    /// Whether the deviation differs between sections.
    pub per_section: bool,
    /// Share of a standard deviation that is common to all sections, from 0 to 1.
    pub shared: f64,
    /// A further standard deviation for the same parameter, independent of the declared one. An
    /// effect must exceed both.
    pub besides: f64,
}

/// Allowed discrepancy of the simulation without an effect: one standard deviation.
#[derive(Clone, Debug)]
pub struct Discrepancy {
    pub feature: FeatureKind,
    /// Weights by channel for levels; otherwise all channels of the groups.
    pub channels: Vec<(String, f64)>,
    /// In the unit of the channel, or of the logarithm; one value, or one per band.
    pub sd: Vec<f64>,
    pub moves: Moves,
    pub over: Over,
    pub times: Times,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    Level,
    /// Each band independently.
    Bands,
    /// All bands together.
    Amplitude,
    Gain,
    Lag,
}

/// Channels that are fully correlated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    All,
    Group,
    Channel,
}

/// Sections that are fully correlated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    All,
    Strata,
    Sections,
}

/// Factor of the discrepancy in each section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Times {
    One,
    /// This number divided by the value of a column, with the sign of the mirrored column.
    Over(f64),
    /// 1, or -1 in mirrored sections.
    Side,
    /// As `Over`, without a sign.
    Unsigned(f64),
}

/// A position in the report's terms, with its channels in sections that are not mirrored and in
/// those that are.
#[derive(Clone, Debug)]
pub struct Position {
    pub name: String,
    pub straight: Vec<String>,
    pub mirrored: Vec<String>,
}

impl Settings {
    /// 1 in a curve, -1 in a mirrored one, 0 on straight track.
    pub fn side(&self, section: &Section) -> f64 {
        match (section.number("radius").filter(|radius| *radius > 0.0), &self.mirror) {
            (None, _) => 0.0,
            (Some(_), Some((column, value))) if section.fact(column) == Some(value) => -1.0,
            (Some(_), _) => 1.0,
        }
    }

    /// All quantities that a campaign may declare, with their units.
    pub fn tolerated(&self) -> Vec<(&str, Unit)> {
        let mut all: Vec<(&str, Unit)> =
            self.tolerances.iter().map(|one| (one.name.as_str(), one.unit.clone())).collect();
        for group in &self.groups {
            all.extend(group.gain.as_deref().map(|name| (name, Unit::one())));
            all.extend(
                [&group.noise, &group.offset]
                    .into_iter()
                    .flatten()
                    .map(|name| (name.as_str(), group.unit.clone())),
            );
        }
        all
    }
}
