//! The rows of a quantity over all sections used, and why they are not sufficient.

use std::collections::BTreeSet;

use super::groups::Group;
use super::table::{Member, independent};
use crate::check::constant;
use crate::check::plan::{Evaluation, Plan, Quantity, Records, Valued};
use crate::result::{Reason, Scope};
use crate::run::sections::{Facts, Unit};
use crate::run::values::{Row, SectionValues};

/// The sections that are used, with their values.
pub type Used<'a> = [(&'a Unit, &'a SectionValues)];

/// The sections that are used.
pub fn used<'a>(
    units: &'a [Unit],
    values: &'a [SectionValues],
) -> Vec<(&'a Unit, &'a SectionValues)> {
    units.iter().zip(values).filter(|(unit, _)| unit.fault.is_none()).collect()
}

/// Pairs of members: of one unit of independence and signal, repeats are no further pairs.
fn pairs(plan: &Plan, members: &[Member<'_>]) -> usize {
    let units = independent(plan, members).into_iter();
    units.zip(members.iter().map(|member| member.signal)).collect::<BTreeSet<_>>().len()
}

/// The rows of a quantity over all sections used, or the reason why they are not sufficient.
pub struct Rows<'a> {
    pub members: Vec<Member<'a>>,
    pub too_few: Vec<TooFew>,
    pub reason: Option<Reason>,
}

impl<'a> Rows<'a> {
    /// Of each quantity.
    pub fn of_all(plan: &'a Plan, facts: &'a Facts, used: &Used<'a>) -> Vec<Self> {
        (0..plan.quantities.len()).map(|index| Self::of(plan, facts, index, used)).collect()
    }

    /// The rows of a draw of the sections. What is asked of their number is asked of all of them:
    /// `reason` is why those are not sufficient.
    pub fn drawn(plan: &'a Plan, index: usize, used: &Used<'a>, reason: Option<Reason>) -> Self {
        let members = members(&plan.quantities[index], index, used);
        Self { members, too_few: Vec::new(), reason }
    }

    fn of(plan: &'a Plan, facts: &'a Facts, index: usize, used: &Used<'a>) -> Self {
        let quantity = &plan.quantities[index];
        let members = members(quantity, index, used);
        let recorded = members.iter().map(|member| member.signal).collect::<BTreeSet<_>>().len();
        let pairs = pairs(plan, &members);
        let group = Group { plan, facts, quantity: Some(quantity), members: &members, table: &[] };
        let too_few = too_few(quantity, &group);
        let absent = || absent(index, used).filter(|_| members.is_empty());
        let reason = if let Some(reason) = impossible(index, used).or_else(absent) {
            Some(reason)
        } else if members.is_empty() && quantity.evaluation.of_repeats() {
            Some(Reason::NoRepeats)
        } else if recorded < quantity.minimum_signals {
            Some(Reason::TooFewSignals { signals: recorded, minimum: quantity.minimum_signals })
        } else if pairs < quantity.minimum_pairs {
            let (rows, minimum) = (members.len(), quantity.minimum_pairs);
            Some(Reason::TooFewPairs { pairs, rows, minimum })
        } else {
            in_groups(&too_few).or_else(|| whatever_the_records(quantity, &members, facts))
        };
        Self { members, too_few, reason }
    }

    /// The rows, for a quantity or limit that uses numbers of this one.
    pub fn usable(&'a self) -> Result<&'a [Member<'a>], Reason> {
        self.reason.clone().map_or(Ok(&self.members), Err)
    }
}

/// The rows of a quantity, given with its index.
fn members<'a>(quantity: &'a Quantity, index: usize, used: &Used<'a>) -> Vec<Member<'a>> {
    let mut members = Vec::new();
    for (unit, values) in used {
        for row in values.rows.get(index).into_iter().flatten() {
            members.push(Member { unit, signal: &quantity.positions[row.position].name, row });
        }
    }
    members
}

/// A group with too few pairs.
#[derive(Debug)]
pub struct TooFew {
    group: Scope,
    reason: Reason,
    /// Its rows, by where they are kept.
    rows: Vec<*const Row>,
}

impl TooFew {
    /// Why nothing is estimated of some rows: all of them are of this group.
    pub fn reason(&self, members: &[Member<'_>]) -> Option<Reason> {
        let inside = |member: &Member<'_>| self.rows.contains(&std::ptr::from_ref(member.row));
        members.iter().all(inside).then(|| self.reason.clone())
    }
}

/// The groups of a quantity with fewer pairs than the protocol requires.
fn too_few(quantity: &Quantity, all: &Group<'_>) -> Vec<TooFew> {
    let mut found = Vec::new();
    for minimum in &quantity.minimum_of_groups {
        for part in all.parts(&minimum.scope) {
            let (reason, inside) = match &part.members {
                Ok(inside) => {
                    let pairs = pairs(all.plan, inside);
                    if pairs >= minimum.needed {
                        continue;
                    }
                    let (rows, minimum) = (inside.len(), minimum.needed);
                    (Reason::TooFewPairs { pairs, rows, minimum }, inside.as_slice())
                }
                Err(reason) => (reason.clone(), &[][..]),
            };
            let rows = inside.iter().map(|member| std::ptr::from_ref(member.row)).collect();
            found.push(TooFew { group: part.scope(), reason, rows });
        }
    }
    found
}

/// Why the quantity is not assessable: the first of its groups in full.
fn in_groups(too_few: &[TooFew]) -> Option<Reason> {
    let (first, others) = too_few.split_first()?;
    Some(Reason::TooFewInGroups {
        group: first.group.to_string(),
        reason: Box::new(first.reason.clone()),
        others: others.len(),
    })
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
    let mut found = used.iter().filter_map(|(unit, values)| {
        let mut own = values.impossible.iter().filter(|(quantity, _)| *quantity == index);
        let (_, reason) = own.find(|(_, reason)| !reason.is_of_optional())?;
        Some((unit.name.clone(), Box::new(reason.clone())))
    });
    let (section, reason) = found.next()?;
    Some(Reason::NotEvaluated { section, reason, others: found.count() })
}

/// Why a quantity is not evaluated in some of the sections, for want of something optional.
pub fn absent(index: usize, used: &Used<'_>) -> Option<Reason> {
    let all = used.iter().flat_map(|(_, values)| &values.impossible);
    let mut own = all.filter(|(quantity, reason)| *quantity == index && reason.is_of_optional());
    own.next().map(|(_, reason)| reason.clone())
}
