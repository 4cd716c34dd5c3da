//! What the protocols made of a campaign.

use super::metric::Number;
use crate::check::plan::Plan;
use crate::result::{
    FileHash, Reason,
    comparison::{Applicability, Cell, Ratio, Score},
};
use crate::run::{Counts, Evaluated, Judged};

/// What all protocols made of a campaign.
#[derive(Debug)]
pub struct CampaignComparison {
    pub campaign: String,
    pub files: Vec<FileHash>,
    /// One for each protocol.
    pub judgements: Vec<Judgement>,
    /// The first protocol with each changed rule, where that is a protocol.
    pub changed: Vec<Option<Judgement>>,
    pub scores: Vec<Score>,
    /// For each protocol, each disturbance and each size what its metrics did.
    pub moved: Vec<Vec<Vec<Moved>>>,
    /// For each protocol; none where it cannot be evaluated.
    pub applicability: Vec<Vec<Applicability>>,
    pub counts: Counts,
}

/// A verdict with the ratios it rests on.
#[derive(Clone, Debug)]
pub struct Judgement {
    pub cell: Cell,
    pub ratios: Vec<Ratio>,
}

/// What the metrics of a protocol did at one size of one disturbance, in one campaign.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moved {
    pub metrics: Vec<OfMetric>,
    pub verdicts: usize,
    pub verdicts_changed: usize,
    /// Why nothing is known.
    pub reason: Option<Reason>,
}

/// What a metric did at one size of one disturbance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OfMetric {
    pub metric: String,
    pub limited: bool,
    /// Sum of squared changes of its numbers.
    pub squares: f64,
    pub count: usize,
    pub largest: Option<f64>,
}

/// A protocol on the records of a campaign as they are.
pub struct Base<'a> {
    pub campaign: &'a str,
    pub protocol: &'a str,
    pub plan: &'a Plan,
    pub evaluated: &'a Evaluated,
    pub judged: Judged,
    pub numbers: Vec<Number>,
}
