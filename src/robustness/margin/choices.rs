//! Other values of the parameters, other sections, other limits.

use super::search::Grid;
use crate::certify::Compiled;
use crate::check::{
    Overrides,
    plan::{Parameter, ParameterRange, Plan},
};
use crate::data::Campaigns;
use crate::problem::Problems;
use crate::result::{
    Reason, Verdict,
    margin::{Changed, Margin, Searched},
    study::Removal,
};
use crate::robustness::{Settings, case_of, parameters, unshifted};
use crate::run::{Evaluated, Judged, limit_changes};
use crate::study;

/// Steps from a number to each end of its range; of a count, the farthest. Every step reads the
/// records again.
const STEPS: f64 = 5.0;

/// A protocol that is evaluated with other values of its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Varied<'a> {
    pub compiled: &'a Compiled,
    pub overrides: &'a Overrides,
    pub campaigns: Campaigns<'a>,
}

impl Varied<'_> {
    /// The verdict with another value of a parameter.
    fn at(&self, parameter: &str, value: &str) -> Result<Verdict, Reason> {
        let said = |problems: Problems| {
            let first = problems.0.into_iter().next();
            Reason::Said { says: first.map_or_else(String::new, |problem| problem.says) }
        };
        let mut problems = Problems::default();
        let family = self.compiled.family.clone();
        let other = parameters::with(family, self.overrides, parameter, value, &mut problems);
        let Some(other) = other else { return Err(said(problems)) };
        let evaluated = unshifted(&other, self.campaigns, &|_: &str| {}).map_err(said)?;
        Ok(evaluated.judge(&other.plan).verdict)
    }

    /// The margins of all parameters that have other words, or a range.
    pub fn margins(&self, is: Verdict, progress: &dyn Fn(&str)) -> Vec<Margin> {
        let of = |parameter: &Parameter| {
            let varied = !parameter.choices.is_empty() || parameter.range.is_some();
            if varied {
                progress(&parameter.name);
            }
            match &parameter.range {
                Some(range) => Some(self.number(parameter, range, is)),
                None if varied => Some(self.words(parameter, is)),
                None => None,
            }
        };
        self.compiled.plan.parameters.iter().filter_map(of).collect()
    }

    fn words(&self, parameter: &Parameter, is: Verdict) -> Margin {
        let others = parameter.choices.iter().filter(|word| **word != parameter.value);
        let tried: Vec<(&String, Result<Verdict, Reason>)> =
            others.map(|word| (word, self.at(&parameter.name, word))).collect();
        let flips = |(word, found): &(&String, Result<Verdict, Reason>)| {
            found.as_ref().is_ok_and(|found| *found != is).then(|| (*word).clone())
        };
        Margin {
            as_it_is: Some(parameter.value.clone()),
            flips_with: tried.iter().filter_map(flips).collect(),
            tried: Some(tried.iter().filter(|(_, found)| found.is_ok()).count()),
            exact: tried.iter().all(|(_, found)| found.is_ok()),
            reason: tried.into_iter().find_map(|(_, found)| found.err()),
            ..Margin::new(Changed::Parameter, &parameter.name, "-")
        }
    }

    /// Each side has its own grid, from the number to the end of its range.
    fn number(&self, parameter: &Parameter, range: &ParameterRange, is: Verdict) -> Margin {
        let unit = if range.unit == "-" { "" } else { range.unit.as_str() };
        let at = |change: f64| {
            let value = format!("{} {unit}", range.value + change);
            self.at(&parameter.name, value.trim())
        };
        let new = || Margin {
            as_it_is: Some(parameter.value.clone()),
            ..Margin::new(Changed::Parameter, &parameter.name, &range.unit)
        };
        let side = |below: f64, above: f64| {
            let far = below.max(above);
            let step = if range.whole { 1.0 } else { far / STEPS };
            let most = |side: f64| if range.whole { side.min(STEPS) } else { side };
            let (below, above) = (most(below), most(above));
            match far > 0.0 {
                true => Grid { below, above, step, whole: range.whole }.margin(new(), is, &at),
                false => new(),
            }
        };
        let low = side(range.value - range.low, 0.0);
        let high = side(0.0, range.high - range.value);
        let (from, to) = (low.searched, high.searched);
        let step = |of: Option<Searched>| of.map_or(f64::INFINITY, |of| of.step);
        Margin {
            low: low.low.map(|change| range.value + change),
            high: high.high.map(|change| range.value + change),
            verdict_low: low.verdict_low,
            verdict_high: high.verdict_high,
            exact: range.whole,
            searched: Some(Searched {
                from: range.value + from.map_or(0.0, |from| from.from),
                to: range.value + to.map_or(0.0, |to| to.to),
                step: step(from).min(step(to)),
            })
            .filter(|searched| searched.step.is_finite()),
            reason: low.reason.or(high.reason),
            ..new()
        }
    }
}

/// How many sections can be left out, whichever they are.
pub fn sections(evaluated: &Evaluated, plan: &Plan, settings: &Settings) -> Margin {
    let margin = Margin::new(Changed::Sections, "sections", "-");
    let case = match case_of(evaluated, plan, settings) {
        Ok((case, _)) => case,
        Err(reason) => return Margin { reason: Some(reason), ..margin },
    };
    let Removal { sets, tried, complete, larger, .. } = study::smallest_removal(&case);
    let smallest = sets.into_iter().next();
    Margin {
        high: smallest.as_ref().map(|set| set.len() as f64 - 1.0),
        exact: smallest.is_some() || complete,
        flips_with: smallest.or(larger).unwrap_or_default(),
        tried: Some(tried),
        ..margin
    }
}

/// The limits, from the estimates: all together first.
pub fn limits(plan: &Plan, judged: &Judged) -> Vec<Margin> {
    let change = |factor: f64| 100.0 * (factor - 1.0);
    limit_changes(plan, judged)
        .into_iter()
        .map(|found| Margin {
            low: found.low.map(|flip| change(flip.factor)),
            high: found.high.map(|flip| change(flip.factor)),
            verdict_low: found.low.map(|flip| flip.verdict),
            verdict_high: found.high.map(|flip| flip.verdict),
            exact: true,
            ..Margin::new(Changed::Limit, found.of.as_deref().unwrap_or("every limit"), "%")
        })
        .collect()
}
