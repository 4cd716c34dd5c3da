//! What every record is evaluated with, and the reading of a record for its nodes: alone, from a
//! stretch that neighbours share, or from what several protocols share.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::opened::{Fault, Opened, Stretched, clock, opened};
use super::section_records::Sharing;
use super::stretch::{Soundness, Stretches};
use crate::check::plan::{Plan, Side};
use crate::data::record::Wanted;
use crate::data::{Campaign, Campaigns, RecordKind, WhichRecord};
use crate::graph::{Graph, NodeId, Operation};
use crate::result::{Reason, Subject};
use crate::run::sections::{Facts, Known, Unit, needed};

/// Data used for every record.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    pub campaigns: Campaigns<'a>,
    pub facts: &'a Facts,
    /// All sections; a repeat needs that of its original.
    pub units: &'a [Unit],
    /// For each campaign and each position of each quantity, whether its channels were recorded.
    pub present: &'a [Vec<Vec<bool>>],
    /// The same for each position of each plausibility rule.
    pub recorded: &'a [Vec<Vec<bool>>],
    /// What is shared with other protocols, of the section that is worked on.
    pub shared: Option<Sharing<'a>>,
    /// Which stretches are sound.
    pub soundness: &'a Soundness,
    /// The records of the stretch that the section that is worked on shares with its neighbours.
    pub stretches: Option<&'a Stretches>,
}

impl<'a> Work<'a> {
    /// The campaign of a section.
    pub fn campaign(&self, unit: &Unit) -> &'a Campaign {
        self.campaigns.get(unit.campaign)
    }

    /// What is shared of a section.
    pub fn sharing(&self, unit: &Unit) -> Option<Sharing<'a>> {
        self.shared.filter(|shared| shared.records.is_of(unit))
    }

    /// Whether the protocol evaluates records of a side.
    pub fn reads(&self, side: Side) -> bool {
        self.plan.reads(side)
    }
}

/// Reads and checks a record of one section, and evaluates the nodes that are wanted with
/// `evaluate`.
///
/// # Errors
/// The record cannot be read or does not cover the section. What `evaluate` says stands beside the
/// record.
pub fn with_record<T>(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    evaluate: impl FnOnce(&Opened, &BTreeSet<NodeId>) -> Result<T, Reason>,
) -> Result<(Result<T, Fault>, Opened), Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, which, &columns(work, which, &needed, true))?;
    let found = evaluate(&opened, &needed)
        .map_err(|reason| Fault::new(reason.about(Subject::File, &opened.file.path)));
    Ok((found, opened))
}

/// The columns of a record that nodes need; `required`: whether the record must have them all.
fn columns(
    work: &Work<'_>,
    which: WhichRecord,
    needed: &BTreeSet<NodeId>,
    required: bool,
) -> Vec<Wanted> {
    let axis = &work.plan.axis;
    let mut wanted = vec![Wanted::new(axis.column.as_str(), axis.unit.dimension)];
    if let Some(time) = clock(work.plan, which.kind) {
        wanted.push(Wanted::new(time.column.as_str(), time.unit.dimension));
    }
    for &id in needed {
        let node = &work.graph.nodes[id];
        if let Operation::Read { column } = &node.operation
            && node.track == (which.kind == RecordKind::Track)
            && !wanted.iter().any(|known| known.name == *column)
        {
            wanted.push(Wanted { required, ..Wanted::new(column.as_str(), node.dimension) });
        }
    }
    wanted
}

fn open(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &[Wanted],
) -> Result<Opened, Fault> {
    let (plan, campaign) = (work.plan, work.campaign(unit));
    let failed = |problems| Fault::of(campaign, problems);
    let Some(sharing) = work.sharing(unit) else {
        let has = |stretched: &Arc<Stretched>| {
            wanted.iter().all(|wanted| stretched.sampled.column(&wanted.name).is_some())
        };
        if let Some(opened) = stretched(work, unit, which, wanted)?
            .filter(has)
            .and_then(|stretched| stretched.section(plan, campaign, unit, which))
        {
            return Ok(opened);
        }
        let read = campaign.read(which, &unit.cell, wanted, unit.part(plan).as_ref());
        return opened(plan, campaign, unit, which, read.map_err(failed)?);
    };
    let part = match unit.stretch {
        Some(stretch) if is_sound(work, unit, which)? => Some(stretch.part(plan)),
        _ => unit.part(plan),
    };
    if let Some(opened) = sharing.records.open(plan, unit, which, wanted, part.as_ref()) {
        return opened;
    }
    let read = sharing.records.read(which, wanted, part.as_ref()).map_err(failed)?;
    opened(plan, campaign, unit, which, read)
}

/// The stretch of a section, if it is sound. Once it is known to be, only the columns are read that
/// are wanted, outside a group of sections.
///
/// # Errors
/// The record cannot be read at all, now.
fn stretched(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &[Wanted],
) -> Result<Option<Arc<Stretched>>, Fault> {
    let Some(stretch) = unit.stretch else { return Ok(None) };
    let key = (stretch.number, which);
    let read = |wanted: &[Wanted]| match work.campaign(unit).read(
        which,
        &unit.cell,
        wanted,
        Some(&stretch.part(work.plan)),
    ) {
        Ok(read) => Ok(Stretched::new(work.plan, which, read).map(Arc::new)),
        Err(problems) if problems.iter().any(|problem| problem.code == "file-unreadable") => {
            Err(Fault::of(work.campaign(unit), problems))
        }
        Err(_) => Ok(None),
    };
    match (work.soundness.known(key), work.stretches) {
        (Some(false), _) => Ok(None),
        (Some(true), None) => read(wanted),
        (_, stretches) => {
            let alone = Stretches::default();
            let found = stretches.unwrap_or(&alone).get(key, || {
                let all =
                    read(&columns(work, which, &(0..work.graph.nodes.len()).collect(), false))?;
                let of = (work.plan, work.graph, work.facts);
                let campaign = work.campaign(unit);
                Ok(all.filter(|stretched| stretched.is_sound(of, campaign, unit, which)))
            })?;
            work.soundness.keep(key, found.is_some());
            Ok(found)
        }
    }
}

/// Whether the stretch of a section is sound.
///
/// # Errors
/// As of [`stretched`].
fn is_sound(work: &Work<'_>, unit: &Unit, which: WhichRecord) -> Result<bool, Fault> {
    match unit.stretch.and_then(|stretch| work.soundness.known((stretch.number, which))) {
        Some(known) => Ok(known),
        None => stretched(work, unit, which, &[]).map(|found| found.is_some()),
    }
}
