//! Which positions were recorded, from the column headings of the records.

use std::collections::{BTreeMap, BTreeSet};

use indexmap::IndexMap;
use rayon::prelude::*;

use super::{
    facts::{Facts, needed},
    unit::Unit,
};
use crate::data::record::RecordSource;
use crate::graph::{PositionNodes, QuantityNodes, SignalNodes};
use crate::problem::nearest;
use crate::result::RecordsOf;
use crate::run::prelude::*;

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

/// A column that a kind of record lacks.
type Missing = (String, WhichRecord);

/// What of a quantity was recorded in a campaign.
#[derive(Clone, Debug)]
pub struct Present {
    /// For each position, whether it is evaluated.
    pub positions: Vec<bool>,
    /// Why none is, for want of an optional channel.
    pub absent: Option<Reason>,
}

/// The rules of a protocol against the columns of a campaign.
#[derive(Clone, Copy, Debug)]
pub struct Recorded<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    pub campaign: &'a Campaign,
    pub facts: &'a Facts,
    pub units: &'a [&'a Unit],
    pub seen: &'a Seen,
}

impl Recorded<'_> {
    /// Positions of plausibility rules whose columns are in the records; other positions are not
    /// checked. A rule without any, for want of an optional channel, is noted.
    pub fn plausibility(&self, notes: &mut Vec<Remark>) -> Vec<Vec<bool>> {
        let mut unchecked: Vec<(Reason, Vec<String>)> = Vec::new();
        let mut all = Vec::new();
        for (nodes, rule) in self.graph.plausibility.iter().zip(&self.plan.plausibility) {
            let missing = |position: &PositionNodes| -> Vec<Missing> {
                let inputs = position.inputs.iter().map(|input| input.node);
                let own = position.own.into_iter().chain(inputs);
                own.flat_map(|node| self.missing(node, |_| true)).collect()
            };
            let missing: Vec<Vec<Missing>> = nodes.positions.iter().map(missing).collect();
            let there: Vec<bool> = missing.iter().map(Vec::is_empty).collect();
            let absent = self.absent(missing).filter(|_| !there.contains(&true));
            if let Some(reason) = absent {
                match unchecked.iter_mut().find(|(known, _)| *known == reason) {
                    Some((_, rules)) if rules.contains(&rule.title) => {}
                    Some((_, rules)) => rules.push(rule.title.clone()),
                    None => unchecked.push((reason, vec![rule.title.clone()])),
                }
            }
            all.push(there);
        }
        let note = |(reason, rules)| Remark::RulesNotChecked { rules, reason };
        notes.extend(unchecked.into_iter().map(note));
        all
    }

    /// Why checks are not made, for want of an optional channel.
    pub fn checks(&self) -> Vec<Option<Reason>> {
        let of_check = |inputs: &Vec<InputNode>| {
            let missing = inputs.iter().flat_map(InputNode::nodes);
            self.absent(vec![missing.flat_map(|node| self.missing(node, |_| true)).collect()])
        };
        self.graph.checks.iter().map(of_check).collect()
    }

    /// Which signals of which quantities were recorded. A position missing from every record is
    /// left out and is not a fault of each section.
    pub fn quantities(&self, notes: &mut Vec<Remark>) -> Vec<Present> {
        let mut left_out = LeftOut::default();
        let mut of_quantity = |(nodes, rule): (&QuantityNodes, &Quantity)| {
            let read = |kind: RecordKind| {
                Side::ALL.into_iter().any(|side| side.kind() == kind && rule.evaluation.reads(side))
            };
            let missing = |signal: &SignalNodes| self.missing(signal.compare, read);
            let all: Vec<Vec<Missing>> = nodes.signals.iter().map(missing).collect();
            let mut positions: Vec<bool> = all.iter().map(Vec::is_empty).collect();
            let mut absent = None;
            if positions.contains(&true) {
                for (column, which) in all.iter().flatten() {
                    let record = self.records_of(*which);
                    let known = left_out.entry(column.clone()).or_default();
                    if !known.contains(&record) {
                        known.push(record);
                    }
                }
            } else {
                absent = self.absent(all);
                // If no position is recorded, and one should be, the name of the channel is wrong.
                // This is a fault and is reported.
                positions.fill(absent.is_none());
            }
            Present { positions, absent }
        };
        let quantities = self.graph.quantities.iter().zip(&self.plan.quantities);
        let present = quantities.map(&mut of_quantity).collect();
        notes.extend(lacking(left_out));
        present
    }

    /// The columns that a node needs and that records of a kind lack, in all sections.
    fn missing(&self, node: NodeId, reads: impl Fn(RecordKind) -> bool) -> Vec<Missing> {
        let track = self.graph.nodes[node].track;
        let of_kind = |which: WhichRecord| {
            (which.kind == RecordKind::Track) == track && (track || reads(which.kind))
        };
        let is_track = |(which, _): &(WhichRecord, _)| which.kind == RecordKind::Track;
        let no_track = track && !self.seen.iter().any(is_track);
        let mut found = Vec::new();
        for column in self.reads(node) {
            let kinds = self.seen.iter().filter(|(which, _)| of_kind(*which));
            let lacking = kinds.filter(|(_, columns)| !columns.contains(&column));
            found.extend(lacking.map(|(which, _)| (column.clone(), *which)));
            found.extend(no_track.then(|| (column, RecordKind::Track.into())));
        }
        found
    }

    /// Columns that a node needs in some section.
    fn reads(&self, node: NodeId) -> BTreeSet<String> {
        let Self { graph, facts, units, .. } = *self;
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
            for id in needed(graph, &BTreeSet::from([node]), &unit.known(facts)).unwrap_or_default()
            {
                if let Operation::Read { column } = &graph.nodes[id].operation {
                    read.insert(column.clone());
                }
            }
        }
        read
    }

    /// Why nothing is evaluated at positions with missing columns: those of one of them are all
    /// of optional channels.
    fn absent(&self, positions: Vec<Vec<Missing>>) -> Option<Reason> {
        let optional = |(column, which): &Missing| {
            let track = which.kind == RecordKind::Track;
            let all = self.plan.optional.iter().enumerate();
            let mut own = all.filter(|(_, channel)| channel.track == track);
            own.find(|(_, channel)| channel.columns.contains(column)).map(|(at, _)| at)
        };
        // Columns and records by channel.
        let mut channels: BTreeMap<usize, (Vec<String>, Vec<WhichRecord>)> = BTreeMap::new();
        let explained = |missing: &Vec<Missing>| {
            !missing.is_empty() && missing.iter().all(|one| optional(one).is_some())
        };
        for one in positions.into_iter().filter(explained).flatten() {
            let (columns, records) = channels.entry(optional(&one)?).or_default();
            if !columns.contains(&one.0) {
                columns.push(one.0);
            }
            if !records.contains(&one.1) {
                records.push(one.1);
            }
        }
        let reason = |(at, (columns, records)): (usize, (Vec<String>, Vec<WhichRecord>))| {
            let channel = &self.plan.optional[at];
            let others = self.seen.iter().filter(|(which, _)| records.contains(which));
            let near = columns.iter().find_map(|column| {
                nearest(column, others.clone().flat_map(|(_, all)| all).map(String::as_str))
            });
            channel.optional.told(Reason::NotRecorded {
                channel: channel.name.clone(),
                near: near.map(Into::into),
                records: records.iter().map(|which| self.records_of(*which)).collect(),
                columns,
            })
        };
        let both =
            |first, second| Reason::Both { first: Box::new(first), second: Box::new(second) };
        channels.into_iter().map(reason).reduce(both)
    }

    fn records_of(&self, which: WhichRecord) -> RecordsOf {
        let campaign = self.units.first().and_then(|unit| unit.campaign_name.clone());
        RecordsOf { records: self.campaign.record_in_words(which), campaign }
    }
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
