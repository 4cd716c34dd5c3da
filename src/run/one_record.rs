//! One record of a section through the graph.

use std::collections::BTreeSet;

use super::facts::Known;
use super::margins::note_margins;
use super::record::{Fault, Found, Opened, Work, needed, open};
use super::section_values::SectionValues;
use super::unit::Unit;
use crate::data::WhichRecord;
use crate::graph::NodeId;

/// The nodes that are wanted, of one record.
pub fn one_record(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<(Vec<(NodeId, Found)>, Opened), Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, which, &needed)?;
    values.files.push(opened.file.clone());
    let keys = work.sharing(unit).map(|sharing| sharing.keys);
    let found = opened
        .evaluate(work.graph, &needed, wanted, known, work.plan.sections.percentiles, keys)
        .map_err(|says| Fault::new(format!("{}: {says}", opened.file.path)))?;
    note_margins(work, unit, &needed, &opened, values);
    Ok((found, opened))
}
