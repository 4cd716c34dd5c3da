//! What every record is evaluated with, and the reading of a record for its nodes: alone, from a
//! stretch that neighbours share, or from what several protocols share.

use std::{collections::BTreeSet, sync::Arc};

use super::{
    opened::{Fault, Opened, Reading, Stretched, clock, unreadable},
    section_records::Sharing,
    stretch::{Soundness, Stretches},
};
use crate::data::record::Wanted;
use crate::run::{
    prelude::*,
    sections::{Facts, Known, Stretch, Unit, columns::Present, needed},
};

/// Data used for every record.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    pub campaigns: Campaigns<'a>,
    pub facts: &'a Facts,
    /// All sections; a repeat needs that of its original.
    pub units: &'a [Unit],
    /// For each campaign and quantity, which positions were recorded.
    pub present: &'a [Vec<Present>],
    /// The same for each position of each plausibility rule.
    pub recorded: &'a [Vec<Vec<bool>>],
    /// For each campaign and check, why it is not made, if an optional channel is absent.
    pub unchecked: &'a [Vec<Option<Reason>>],
    /// What is shared with other protocols, of the section that is worked on.
    pub shared: Option<Sharing<'a>>,
    /// Which stretches are sound.
    pub soundness: &'a Soundness,
    /// The records of the stretch that the section that is worked on shares with its neighbours.
    pub stretches: Option<&'a Stretches>,
}

/// A section that is worked on, and what names stand for in it.
#[derive(Clone, Copy, Debug)]
pub struct SectionWork<'a> {
    pub work: &'a Work<'a>,
    pub unit: &'a Unit,
    pub known: Known<'a>,
}

impl<'a> SectionWork<'a> {
    pub fn new(work: &'a Work<'a>, unit: &'a Unit) -> Self {
        Self { work, unit, known: unit.known(work.facts) }
    }

    pub fn campaign(&self) -> &'a Campaign {
        self.work.campaigns.get(self.unit.campaign)
    }

    /// The checks with their inputs, and why one is not made for want of something optional.
    pub fn checks(
        &self,
    ) -> impl Iterator<Item = ((&'a Check, &'a Vec<InputNode>), Option<Reason>)> + use<'a> {
        let (section, Work { plan, graph, unchecked, .. }) = (*self, *self.work);
        let checks = plan.checks.iter().zip(&graph.checks).zip(&unchecked[self.unit.campaign]);
        checks.map(move |(of, absent)| {
            let nodes = of.1.iter().flat_map(InputNode::nodes).collect();
            (of, absent.clone().or_else(|| section.absent_case(&nodes)))
        })
    }

    /// Why it is not known which case of a signal applies, for want of something optional.
    pub fn absent_case(&self, nodes: &BTreeSet<NodeId>) -> Option<Reason> {
        let mut data = self.unit.columns.iter().chain(&self.known.vehicle.data);
        if !data.any(|datum| datum.as_ref().is_err_and(Reason::is_of_optional)) {
            return None;
        }
        needed(self.work.graph, nodes, &self.known).err().filter(Reason::is_of_optional)
    }

    /// What is shared of the section.
    pub fn sharing(&self) -> Option<Sharing<'a>> {
        self.work.shared.filter(|shared| shared.records.is_of(self.unit))
    }

    /// Reads and checks a record of the section, and evaluates the nodes that are wanted with
    /// `evaluate`.
    ///
    /// # Errors
    /// The record cannot be read or does not cover the section. What `evaluate` says stands beside
    /// the record.
    pub fn with_record<T>(
        &self,
        which: WhichRecord,
        wanted: &BTreeSet<NodeId>,
        evaluate: impl FnOnce(&Opened, &BTreeSet<NodeId>) -> Result<T, Reason>,
    ) -> Result<(Result<T, Fault>, Opened), Fault> {
        let needed = needed(self.work.graph, wanted, &self.known).map_err(Fault::new)?;
        let opened = self.open(which, &self.columns(which, &needed, true))?;
        let found = evaluate(&opened, &needed)
            .map_err(|reason| Fault::new(reason.about(Subject::File, &opened.file.path)));
        Ok((found, opened))
    }

    /// The columns of a record that nodes need; `required`: whether the record must have them all.
    fn columns(
        &self,
        which: WhichRecord,
        needed: &BTreeSet<NodeId>,
        required: bool,
    ) -> Vec<Wanted> {
        let Work { plan, graph, .. } = *self.work;
        let mut wanted = vec![Wanted::new(plan.axis.column.as_str(), plan.axis.unit.dimension)];
        if let Some(time) = clock(plan, which.kind) {
            wanted.push(Wanted::new(time.column.as_str(), time.unit.dimension));
        }
        for &id in needed {
            let node = &graph.nodes[id];
            if let Operation::Read { column } = &node.operation
                && node.track == (which.kind == RecordKind::Track)
                && !wanted.iter().any(|known| known.name == *column)
            {
                wanted.push(Wanted { required, ..Wanted::new(column.as_str(), node.dimension) });
            }
        }
        wanted
    }

    fn reading(&self, which: WhichRecord) -> Reading<'a> {
        let (plan, campaign, unit) = (self.work.plan, self.campaign(), self.unit);
        Reading { plan, campaign, unit, which }
    }

    fn open(&self, which: WhichRecord, wanted: &[Wanted]) -> Result<Opened, Fault> {
        let reading = self.reading(which);
        let Reading { plan, campaign, unit, .. } = reading;
        let failed = |problems| Fault::of(campaign, problems);
        let Some(sharing) = self.sharing() else {
            let has = |stretched: &Arc<Stretched>| {
                wanted.iter().all(|wanted| stretched.sampled.column(&wanted.name).is_some())
            };
            let stretched = self.stretched(&reading, wanted)?.filter(has);
            if let Some(opened) = stretched.and_then(|stretched| stretched.section(&reading)) {
                return Ok(opened);
            }
            let read = campaign.read(which, &unit.cell, wanted, unit.part(plan).as_ref());
            return Opened::new(&reading, read.map_err(failed)?);
        };
        let part = match unit.stretch {
            Some(stretch) if self.is_sound(&reading)? => Some(stretch.part(plan)),
            _ => unit.part(plan),
        };
        if let Some(opened) = sharing.records.open(&reading, wanted, part.as_ref()) {
            return opened;
        }
        let read = sharing.records.read(which, wanted, part.as_ref()).map_err(failed)?;
        Opened::new(&reading, read)
    }

    /// The stretch of the section, if it is sound. Once it is known to be, only the columns are
    /// read that are wanted, outside a group of sections.
    ///
    /// # Errors
    /// The record cannot be read at all, now.
    fn stretched(
        &self,
        reading: &Reading<'_>,
        wanted: &[Wanted],
    ) -> Result<Option<Arc<Stretched>>, Fault> {
        let Work { graph, soundness, stretches, .. } = *self.work;
        let Reading { plan, campaign, unit, which } = *reading;
        let Some(stretch) = unit.stretch else { return Ok(None) };
        let key = (stretch.number, which);
        let read = |wanted: &[Wanted]| match campaign.read(
            which,
            &unit.cell,
            wanted,
            Some(&stretch.part(plan)),
        ) {
            Ok(read) => Ok(Stretched::new(plan, which, read).map(Arc::new)),
            Err(problems) if unreadable(&problems) => Err(Fault::of(campaign, problems)),
            Err(_) => Ok(None),
        };
        match (soundness.known(key), stretches) {
            (Some(false), _) => Ok(None),
            (Some(true), None) => read(wanted),
            (_, stretches) => {
                let alone = Stretches::default();
                let found = stretches.unwrap_or(&alone).get(key, || {
                    let all = self.columns(which, &(0..graph.nodes.len()).collect(), false);
                    let sound = |stretched: &Arc<Stretched>| {
                        stretched.is_sound(reading, graph, &self.known)
                    };
                    Ok(read(&all)?.filter(sound))
                })?;
                soundness.keep(key, found.is_some());
                Ok(found)
            }
        }
    }

    /// Whether the stretch of the section is sound.
    ///
    /// # Errors
    /// As of [`Self::stretched`].
    fn is_sound(&self, reading: &Reading<'_>) -> Result<bool, Fault> {
        let known = |stretch: Stretch| self.work.soundness.known((stretch.number, reading.which));
        match reading.unit.stretch.and_then(known) {
            Some(known) => Ok(known),
            None => Ok(self.stretched(reading, &[])?.is_some()),
        }
    }
}
