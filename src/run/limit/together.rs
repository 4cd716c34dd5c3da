//! Several simulations under a protocol that does not tell them apart: a good one must not hide a
//! bad one.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use super::limits::Judging;
use crate::run::{
    estimate::{Group, Member, Table},
    prelude::*,
};

impl Judging<'_> {
    /// Why limits that all simulations together meet do not decide the quantity: the first simulation
    /// that does not meet one by itself. Only for values of simulations, by themselves or with
    /// measurements, where neither quantity nor limit names a record: otherwise the protocol knows of
    /// several.
    pub fn fails_alone(&self) -> Option<Reason> {
        let (quantity, Group { plan, members, table, .. }) = (self.quantity, self.rows);
        let by_record = |limit: &Limit| limit.scope.each.contains(&Key::Record);
        let several = members.iter().any(|member| member.row.record.is_some());
        if !several || quantity.limits.iter().all(|limit| by_record(limit)) {
            return None;
        }
        let simulations = match quantity.evaluation.as_ref() {
            Evaluation::Values {
                records: Records::Of(Chosen { side: Side::Simulated, record: None }),
                ..
            } => names_of(members),
            evaluation if evaluation.pairing() == Some(Pairing::SIDES) => simulations(plan, table),
            _ => return None,
        };
        simulations.iter().find_map(|simulation| {
            let own: Vec<Member<'_>> = members
                .iter()
                .copied()
                .filter(|member| {
                    member.row.record.as_ref().map(RecordName::first) == Some(*simulation)
                })
                .collect();
            let alone = Judging { quantity, rows: self.rows.with(&own), too_few: &[] };
            let fails = alone
                .compared()
                .into_iter()
                .filter(|compared| {
                    compared.result.scope.keys.iter().all(|(key, _)| key != "record")
                })
                .find_map(|compared| compared.fails)?;
            // The result is that of a quantity, which is not named once more.
            let reason = match fails {
                Reason::About { reason, .. } => reason,
                other => Box::new(other),
            };
            Some(Reason::FailsAlone {
                simulations: simulations.len(),
                simulation: simulation.to_string(),
                reason,
            })
        })
    }
}

fn names_of<'a>(members: &[Member<'a>]) -> BTreeSet<&'a Arc<str>> {
    members.iter().filter_map(|member| member.row.record.as_ref().map(RecordName::first)).collect()
}

/// The names of the simulations, if there are several.
fn simulations<'a>(plan: &Plan, table: &Table<'a>) -> BTreeSet<&'a Arc<str>> {
    let mut names = BTreeSet::new();
    let quantities = plan
        .quantities
        .iter()
        .zip(table)
        .filter(|(quantity, _)| quantity.evaluation.pairing() == Some(Pairing::SIDES));
    for (_, members) in quantities {
        // With several of one side only, records have the names of that side: of the simulation, if
        // the simulated values differ.
        let mut seen: BTreeMap<(&str, usize, usize), u64> = BTreeMap::new();
        let mut differ = false;
        for member in members.iter().copied().flatten() {
            match (&member.row.record, member.row.simulated) {
                (Some(RecordName::Pair(simulation, _)), _) => {
                    names.insert(simulation);
                }
                (Some(RecordName::Single(_)), Some(value)) => {
                    let first = seen
                        .entry((&member.unit.name, member.row.position, member.row.which))
                        .or_insert(value.to_bits());
                    differ |= *first != value.to_bits();
                }
                _ => {}
            }
        }
        if differ {
            names.extend(members.iter().flat_map(|members| names_of(members)));
        }
    }
    if names.len() < 2 { BTreeSet::new() } else { names }
}
