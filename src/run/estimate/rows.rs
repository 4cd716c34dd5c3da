//! The rows of a quantity over all sections, and why they are not sufficient.

use std::collections::BTreeSet;

use super::minima::{self, TooFew};
use super::table::Member;
use crate::check::constant;
use crate::check::plan::{Evaluation, Plan, Quantity, Records, Valued};
use crate::result::Reason;
use crate::run::sections::{Facts, Unit};
use crate::run::values::SectionValues;

/// The sections that are used, with their values.
pub type Used<'a> = [(&'a Unit, &'a SectionValues)];

/// The rows of a quantity over all sections used.
pub fn members<'a>(quantity: &'a Quantity, index: usize, used: &Used<'a>) -> Vec<Member<'a>> {
    let mut members = Vec::new();
    for (unit, values) in used {
        for row in values.rows.get(index).into_iter().flatten() {
            members.push(Member { unit, signal: &quantity.positions[row.position].name, row });
        }
    }
    members
}

/// The rows of a quantity, or the reason why they are not sufficient.
pub struct Rows<'a> {
    pub members: Vec<Member<'a>>,
    pub too_few: Vec<TooFew>,
    pub reason: Option<Reason>,
}

impl<'a> Rows<'a> {
    /// Of each quantity.
    pub fn of_all(plan: &'a Plan, facts: &Facts, used: &Used<'a>) -> Vec<Self> {
        let of = |(index, quantity)| rows(plan, quantity, index, used, facts);
        plan.quantities.iter().enumerate().map(of).collect()
    }

    /// The rows, for a quantity or limit that uses numbers of this one.
    pub fn usable(&'a self) -> Result<&'a [Member<'a>], Reason> {
        self.reason.clone().map_or(Ok(&self.members), Err)
    }
}

fn rows<'a>(
    plan: &Plan,
    quantity: &'a Quantity,
    index: usize,
    used: &Used<'a>,
    facts: &Facts,
) -> Rows<'a> {
    let members = members(quantity, index, used);
    let recorded = members.iter().map(|member| member.signal).collect::<BTreeSet<_>>().len();
    let pairs = minima::pairs(plan, &members);
    let too_few = minima::too_few(plan, quantity, &members, facts);
    let impossible = impossible(index, used);
    let reason = if impossible.is_some() {
        impossible
    } else if members.is_empty() && quantity.evaluation.of_repeats() {
        Some(Reason::NoRepeats)
    } else if recorded < quantity.minimum_signals {
        Some(Reason::TooFewSignals { signals: recorded, minimum: quantity.minimum_signals })
    } else if pairs < quantity.minimum_pairs {
        let (rows, minimum) = (members.len(), quantity.minimum_pairs);
        Some(Reason::TooFewPairs { pairs, rows, minimum })
    } else {
        minima::reason(&too_few).or_else(|| whatever_the_records(quantity, &members, facts))
    };
    Rows { members, too_few, reason }
}

/// Why the values say nothing of the records: with the data of these sections and vehicles, each is
/// the same number whatever the records are.
fn whatever_the_records(
    quantity: &Quantity,
    members: &[Member<'_>],
    facts: &Facts,
) -> Option<Reason> {
    let (first, others) = members.split_first()?;
    if others.iter().any(|member| member.row.value != first.row.value) {
        return None;
    }
    let fixed = |member: &Member<'_>| {
        let known = member.unit.known(facts);
        let of = |valued: &Valued| {
            let inputs = valued.inputs.get(member.row.position)?;
            constant::whatever_the_records(&valued.expr, inputs, &known)
        };
        match quantity.evaluation.as_ref() {
            Evaluation::Combined { of: valued, .. } => of(valued),
            Evaluation::Values { values, records } => match records {
                Records::Compared { difference, .. } | Records::Spread { difference, .. } => {
                    constant::whatever_the_records(difference, &[], &known)
                        .or_else(|| of(values.get(member.row.which)?))
                }
                Records::Of(_) => of(values.get(member.row.which)?),
            },
            Evaluation::Metric { .. } => None,
        }
    };
    let reason = || Reason::SameWhateverRecords {
        value: quantity.unit.from_si(first.row.value),
        unit: quantity.unit.text.clone(),
    };
    members.iter().all(|member| fixed(member).is_some()).then(reason)
}

/// Why a quantity cannot be evaluated in some of the sections: the first of them in full.
fn impossible(index: usize, used: &Used<'_>) -> Option<Reason> {
    let of_section = |values: &SectionValues| {
        values
            .impossible
            .iter()
            .find(|(quantity, _)| *quantity == index)
            .map(|(_, reason)| reason.clone())
    };
    let mut found =
        used.iter().filter_map(|(unit, values)| Some((&unit.name, of_section(values)?)));
    let (section, reason) = found.next()?;
    let (section, reason) = (section.clone(), Box::new(reason));
    Some(Reason::NotEvaluated { section, reason, others: found.count() })
}
