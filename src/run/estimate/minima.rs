//! Groups of a quantity that have fewer pairs than the protocol requires.

use std::collections::BTreeSet;

use super::groups::{Grouped, parts};
use super::table::{Member, independent};
use crate::check::plan::{Plan, Quantity};
use crate::result::{Reason, Scope};
use crate::run::sections::Facts;
use crate::run::values::Row;

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
        members
            .iter()
            .all(|member| self.rows.contains(&std::ptr::from_ref(member.row)))
            .then(|| self.reason.clone())
    }
}

/// Pairs of members: of one unit of independence and signal, repeats are no further pairs.
pub fn pairs(plan: &Plan, members: &[Member<'_>]) -> usize {
    independent(plan, members)
        .into_iter()
        .zip(members.iter().map(|member| member.signal))
        .collect::<BTreeSet<_>>()
        .len()
}

/// The groups of a quantity with too few pairs.
pub fn too_few(
    plan: &Plan,
    quantity: &Quantity,
    members: &[Member<'_>],
    facts: &Facts,
) -> Vec<TooFew> {
    let mut found = Vec::new();
    for minimum in &quantity.minimum_of_groups {
        for part in parts(plan, Grouped::values(quantity), &minimum.scope, members, facts) {
            let (reason, inside) = match part.members(facts, members) {
                Ok(inside) => {
                    let pairs = pairs(plan, &inside);
                    if pairs >= minimum.needed {
                        continue;
                    }
                    let (rows, minimum) = (inside.len(), minimum.needed);
                    (Reason::TooFewPairs { pairs, rows, minimum }, inside)
                }
                Err(reason) => (reason, Vec::new()),
            };
            let rows = inside.iter().map(|member| std::ptr::from_ref(member.row)).collect();
            found.push(TooFew { group: part.scope(), reason, rows });
        }
    }
    found
}

/// Why the quantity is not assessable: the first of its groups in full.
pub fn reason(too_few: &[TooFew]) -> Option<Reason> {
    let (first, others) = too_few.split_first()?;
    Some(Reason::TooFewInGroups {
        group: first.group.to_string(),
        reason: Box::new(first.reason.clone()),
        others: others.len(),
    })
}
