//! Plausibility rules that cannot be asked of a section, because a cell of the table of sections is
//! empty: sound data and data that were never looked at must not look alike.

use indexmap::{IndexMap, IndexSet};

use crate::result::Sections;
use crate::run::{
    prelude::*,
    sections::{Facts, Known, Unit},
};

/// Code of the finding about rules that were not asked. It does not change the verdict.
const NOT_ASKED: &str = "plausibility-not-checked";

/// One finding for each column that is empty in used sections, with the rules that need it there.
pub fn findings(plan: &Plan, facts: &Facts, units: &[Unit]) -> Vec<Finding> {
    let mut found: IndexMap<usize, [IndexSet<&str>; 2]> = IndexMap::new();
    for unit in units.iter().filter(|unit| unit.fault.is_none()) {
        for rule in &plan.plausibility {
            let Some(column) = missing(rule, facts, unit) else { continue };
            let [names, rules] = found.entry(column).or_default();
            names.insert(&unit.name);
            rules.insert(&rule.title);
        }
    }
    let finding = |(column, [names, rules]): (usize, [IndexSet<&str>; 2])| {
        let key = &plan.columns[column].key;
        let data = FindingData::RulesWithoutColumn {
            column: key.clone(),
            sections: Sections::of(&names.into_iter().collect::<Vec<_>>(), units.len()),
            rules: rules.into_iter().map(Into::into).collect(),
        };
        Finding::note(NOT_ASKED, Occurrence { channel: Some(key.clone()), ..data.into() })
    };
    found.into_iter().map(finding).collect()
}

/// The column without which the rule has no answer in this section.
fn missing(rule: &Plausibility, facts: &Facts, unit: &Unit) -> Option<usize> {
    let Test::Require(requirement) = &rule.test else { return None };
    let of = |reason: Reason| {
        unit.columns.iter().position(|column| column.as_ref().err() == Some(&reason))
    };
    let known = unit.known(facts);
    match rule.unless.as_ref().map(|unless| flag(unless, &known)) {
        Some(Ok(true)) => return None,
        Some(Err(reason)) => return of(reason),
        _ => {}
    }
    // Whatever the signals are: only data can be missing here.
    let inputs: Vec<Result<f64, Reason>> = vec![Ok(1.0); requirement.inputs.len()];
    flag(&requirement.holds, &Known { inputs: &inputs, ..known }).err().and_then(of)
}
