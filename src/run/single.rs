//! One value by itself, with what it was made of: for who asks where a number of a result comes from.

use super::pairs::{self, PairSi};
use super::record::Opened;
use super::{Found, Prepared};
use crate::check::plan::Plan;
use crate::data::Campaign;
use crate::graph::Graph;
use crate::problem::{Problem, Problems};
use crate::result::FileHash;

/// One section and signal of a quantity, computed anew.
#[derive(Debug)]
pub struct Single {
    pub simulated: Side,
    pub measured: Side,
    /// In the unit of the quantity.
    pub difference: f64,
    /// Samples or windows of the measured value.
    pub samples: usize,
}

/// What one record gave.
#[derive(Debug)]
pub struct Side {
    pub file: FileHash,
    /// First and last row of the file that lie in the section, the header being row 1.
    pub inside: (usize, usize),
    /// The last row of the file.
    pub last: usize,
    /// Reduced signals by the node of the graph that gives them, in SI, and of how many samples or windows.
    pub reduced: Vec<(usize, f64, usize)>,
    /// The value of this side, in the unit of the quantity; `None` where a metric gives one number of both.
    pub value: Option<f64>,
}

/// Reads both records of a section and computes one value of one quantity.
///
/// # Errors
/// What makes the campaign unusable; `no-such-section`; `not-evaluated` with the reason.
pub fn single(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    (quantity, signal): (usize, usize),
    section: &str,
) -> Result<Single, Problems> {
    let prepared = Prepared::new(plan, graph, campaign)?;
    let unit = prepared.units.iter().find(|unit| unit.name == section).ok_or_else(|| {
        let problem = Problem::error("no-such-section", format!("the campaign has no section `{section}`"));
        one(problem.suggest(section, prepared.units.iter().map(|unit| unit.name.as_str())))
    })?;
    if let Some(fault) = &unit.fault {
        return Err(one(Problem::error("not-evaluated", format!("section {section} is not used: {fault}"))));
    }
    let found = pairs::single(&prepared.work(), unit, quantity, signal).map_err(|fault| {
        let mut problems = Problems(fault.problems);
        problems.push(Problem::error("not-evaluated", format!("section {section} cannot be evaluated: {}", fault.says)));
        problems
    })?;
    let pairs::Computed { pair: PairSi { simulated, measured, difference, samples }, sides: [of_simulated, of_measured] } = found;
    let of = &plan.quantities[quantity].unit;
    let side = |(found, opened): (Vec<(usize, Found)>, Opened), value: Option<f64>| {
        let reduced = found.iter().filter_map(|(node, found)| match found {
            Found::Number(value, samples) => Some((*node, *value, *samples)),
            Found::Samples(_) | Found::Failed(_) => None,
        });
        let (inside, last) = opened.rows();
        Side { reduced: reduced.collect(), inside, last, value: value.map(|value| of.from_si(value)), file: opened.file }
    };
    Ok(Single {
        simulated: side(of_simulated, simulated),
        measured: side(of_measured, measured),
        difference: of.from_si(difference),
        samples,
    })
}

fn one(problem: Problem) -> Problems {
    Problems(vec![problem])
}
