//! Requirements that the sections of a campaign meet together: the median of what is found in them,
//! and the slope of what is found over what is expected.

use indexmap::IndexMap;

use super::consequence::consequence;
use crate::check::evaluate::words;
use crate::metrics::{
    robust::{Estimate, level, slope},
    statistics::median,
};
use crate::result::OfSections;
use crate::run::{
    prelude::*,
    sections::Unit,
    values::{Pooled, SectionValues},
};

/// Least number of sections: of fewer, the scatter of a median is not known.
const FEWEST: usize = 5;

/// The rule, the position, the comparison, the record, and the campaign where there are several.
type Key<'a> = ([usize; 3], Option<&'a str>, Option<&'a str>);

/// A finding for each requirement that the used sections do not meet.
pub fn find(plan: &Plan, units: &[Unit], values: &[SectionValues]) -> Vec<Finding> {
    let mut groups: IndexMap<Key<'_>, Vec<&Pooled>> = IndexMap::new();
    for (unit, values) in units.iter().zip(values).filter(|(unit, _)| unit.fault.is_none()) {
        for one in &values.pooled {
            let key = (one.of, one.record.as_deref(), unit.campaign_name.as_deref());
            groups.entry(key).or_default().push(one);
        }
    }
    let mut all: Vec<_> = groups.into_iter().filter(|(_, of)| of.len() >= FEWEST).collect();
    all.sort_by_key(|((of, ..), _)| *of);
    all.into_iter().filter_map(|(key, of)| finding(plan, key, &of)).collect()
}

fn finding(
    plan: &Plan,
    ([rule, position, which], record, campaign): Key<'_>,
    of: &[&Pooled],
) -> Option<Finding> {
    let rule = plan.plausibility.get(rule)?;
    let Test::Require(requirement) = &rule.test else { return None };
    let compared = requirement.compared.get(which)?;
    let violated = violated(requirement.over_sections?, compared, of)?;
    let data = data((rule, compared), of.len(), &violated);
    let first = Occurrence {
        channel: rule.signals.get(position).map(|(name, _)| name.clone()),
        campaign: campaign.map(Into::into),
        record: record.map(Into::into),
        ..Occurrence::from(data)
    };
    Some(Finding {
        causes: rule.cause.clone().map(Reason::said).into_iter().collect(),
        consequence: consequence(rule.otherwise),
        ..Finding::note(&rule.name, first)
    })
}

/// What is not as it must be, SI, and the bounds.
struct Violated {
    what: OfSections,
    found: Estimate,
    least: Option<f64>,
    most: Option<f64>,
}

/// What is required and lies outside its bounds with its whole interval, the slope first. The
/// sections are in the order of their table.
fn violated(asked: OverSections, compared: &Comparison, of: &[&Pooled]) -> Option<Violated> {
    let list = |take: fn(&Pooled) -> f64| of.iter().map(|one| take(one)).collect::<Vec<f64>>();
    let (found, expected) = (list(|one| one.found), list(|one| one.expected));
    let bounds = median(&expected)?;
    let outside = |what: OfSections, found: Estimate, least: Option<f64>, most: Option<f64>| {
        let beyond = most.is_some_and(|most| found.low > most)
            || least.is_some_and(|least| found.high < least);
        beyond.then_some(Violated { what, found, least, most })
    };
    match &compared.relation {
        Relation::AtMost => outside(OfSections::Level, level(&found)?, None, Some(bounds)),
        Relation::AtLeast => outside(OfSections::Level, level(&found)?, Some(bounds), None),
        Relation::WithinFactor => None,
        Relation::Within(_) => {
            if let OverSections::Level { slope: Some((least, most)) } = asked
                && let Some(steep) = slope(&expected, &found)
                && let Some(violated) = outside(OfSections::Slope, steep, Some(least), Some(most))
            {
                return Some(violated);
            }
            let room = median(&list(|one| one.room))?;
            let beyond = list(|one| one.found - one.expected);
            let (what, all) = match asked {
                OverSections::Level { .. } => (OfSections::Level, level(&beyond)?),
                OverSections::Change => {
                    // From the first section to the last, where the line is.
                    let last = beyond.len() as f64 - 1.0;
                    let order: Vec<f64> = (0..beyond.len()).map(|at| at as f64 / last).collect();
                    (OfSections::Change, slope(&order, &beyond)?)
                }
            };
            outside(what, all, Some(-room), Some(room))
        }
    }
}

fn data(
    (rule, compared): (&Plausibility, &Comparison),
    sections: usize,
    of: &Violated,
) -> FindingData {
    let what = words(&compared.found);
    let is_slope = of.what == OfSections::Slope;
    let shown = |value: f64| if is_slope { value } else { compared.unit.from_si(value) };
    FindingData::OverSections {
        rule: rule.title.clone(),
        what: match compared.relation {
            Relation::Within(_) if !is_slope => format!("{what} - {}", words(&compared.expected)),
            _ => what,
        },
        of: of.what,
        value: shown(of.found.value),
        low: shown(of.found.low),
        high: shown(of.found.high),
        least: of.least.map(shown),
        most: of.most.map(shown),
        unit: if is_slope { String::new() } else { compared.unit.text.clone() },
        sections,
    }
}
