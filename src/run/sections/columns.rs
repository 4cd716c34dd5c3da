//! Which positions were recorded, from the column headings of the records.

use std::collections::BTreeSet;

use indexmap::IndexMap;
use rayon::prelude::*;

use super::facts::{Facts, needed};
use super::unit::Unit;
use crate::check::plan::{Plan, Side};
use crate::data::record::RecordSource;
use crate::data::{Campaign, RecordKind, WhichRecord};
use crate::graph::{Graph, NodeId, Operation};
use crate::result::{RecordsOf, Remark};

impl Side {
    /// The kind of its records.
    pub fn kind(self) -> RecordKind {
        match self {
            Self::Simulated => RecordKind::Simulation,
            Self::Measured => RecordKind::Measurement,
        }
    }
}

/// The columns that occur in some section, for each kind of record.
pub type Seen = Vec<(WhichRecord, BTreeSet<String>)>;

/// Reads the headings of every record.
pub fn seen_columns(plan: &Plan, campaign: &Campaign, units: &[&Unit]) -> Seen {
    let sides = Side::ALL.into_iter().filter(|side| plan.reads(*side)).map(Side::kind);
    let kinds = sides.chain(Some(RecordKind::Track).filter(|kind| campaign.has(*kind)));
    let seen = |which: WhichRecord| {
        // A record that cannot be read is a fault of its section and is reported when it is opened.
        let all: Vec<RecordSource> = units
            .par_iter()
            .filter_map(|unit| campaign.source_of(which, &unit.cell).ok())
            .collect();
        // Sections of a run are in one file.
        let mut read = BTreeSet::new();
        let files: Vec<RecordSource> =
            all.into_iter().filter(|source| read.insert(source.inside().to_string())).collect();
        let names = |source: &RecordSource| {
            source.headings().into_iter().flatten().map(|heading| heading.name)
        };
        (which, files.par_iter().flat_map_iter(names).collect())
    };
    kinds.flat_map(|kind| campaign.records(kind)).map(seen).collect()
}

/// Positions of plausibility rules whose columns are in the records; other positions are not
/// checked.
pub fn recorded_positions(
    graph: &Graph,
    seen: &Seen,
    facts: &Facts,
    units: &[&Unit],
) -> Vec<Vec<bool>> {
    let there = |node: NodeId| {
        let track = graph.nodes[node].track;
        let of_kind =
            || seen.iter().filter(|(which, _)| (which.kind == RecordKind::Track) == track);
        reads(graph, node, facts, units)
            .iter()
            .all(|column| of_kind().all(|(_, columns)| columns.contains(column)))
    };
    graph
        .plausibility
        .iter()
        .map(|rule| {
            rule.positions
                .iter()
                .map(|position| {
                    position
                        .own
                        .into_iter()
                        .chain(position.inputs.iter().map(|input| input.node))
                        .all(there)
                })
                .collect()
        })
        .collect()
}

/// Which signals of which quantities were recorded. A position missing from every record is left
/// out and is not a fault of each section.
pub fn present_columns(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    seen: &Seen,
    facts: &Facts,
    units: &[&Unit],
    notes: &mut Vec<Remark>,
) -> Vec<Vec<bool>> {
    let called = units.first().and_then(|unit| unit.campaign_name.as_ref());
    let mut left_out = LeftOut::default();
    let present = graph
        .quantities
        .iter()
        .zip(&plan.quantities)
        .map(|(quantity, rule)| {
            let read = |kind: RecordKind| {
                Side::ALL.into_iter().any(|side| side.kind() == kind && rule.evaluation.reads(side))
            };
            let all: Vec<Vec<(String, WhichRecord)>> = quantity
                .signals
                .iter()
                .map(|signal| {
                    let mut missing: Vec<(String, WhichRecord)> = Vec::new();
                    for column in reads(graph, signal.compare, facts, units) {
                        for (which, columns) in seen.iter().filter(|(which, _)| read(which.kind)) {
                            if !columns.contains(&column) {
                                missing.push((column.clone(), *which));
                            }
                        }
                    }
                    missing
                })
                .collect();
            // If no position is recorded, the name of the channel is wrong. This is a fault and is
            // reported.
            let none = all.iter().all(|missing| !missing.is_empty());
            all.iter()
                .map(|missing| {
                    if !none {
                        for (column, which) in missing {
                            let records = campaign.record_in_words(*which);
                            let record = RecordsOf { records, campaign: called.cloned() };
                            let known = left_out.entry(column.clone()).or_default();
                            if !known.contains(&record) {
                                known.push(record);
                            }
                        }
                    }
                    none || missing.is_empty()
                })
                .collect()
        })
        .collect();
    notes.extend(lacking(left_out));
    present
}

/// Columns that are in no record of some records, in the order of the protocol.
type LeftOut = IndexMap<String, Vec<RecordsOf>>;

/// One note for all columns that the same records lack.
fn lacking(left_out: LeftOut) -> Vec<Remark> {
    let mut groups: Vec<(Vec<String>, Vec<RecordsOf>)> = Vec::new();
    for (column, records) in left_out {
        match groups.iter_mut().find(|(_, known)| *known == records) {
            Some((columns, _)) => columns.push(column),
            None => groups.push((vec![column], records)),
        }
    }
    let remark = |(channels, records)| Remark::LackingChannels { channels, records };
    groups.into_iter().map(remark).collect()
}

/// Columns that a node needs in some section.
fn reads(graph: &Graph, node: NodeId, facts: &Facts, units: &[&Unit]) -> BTreeSet<String> {
    let mut read = BTreeSet::new();
    let most = graph
        .columns_of([node])
        .into_iter()
        .map(|(column, _)| column)
        .collect::<BTreeSet<_>>()
        .len();
    for unit in units {
        // Most nodes need the same columns in all sections.
        if read.len() == most {
            break;
        }
        // Where it cannot be determined which signal applies, the section is refused when it is
        // evaluated.
        for id in needed(graph, &BTreeSet::from([node]), &unit.known(facts)).unwrap_or_default() {
            if let Operation::Read { column } = &graph.nodes[id].operation {
                read.insert(column.clone());
            }
        }
    }
    read
}
