//! One record of a section through the graph.

use std::collections::BTreeSet;

use super::margins::{note_margins, slow};
use super::section_values::SectionValues;
use crate::data::WhichRecord;
use crate::graph::NodeId;
use crate::run::record::{Fault, Found, Opened, Work, with_record};
use crate::run::sections::{Known, Unit};

/// The nodes that are wanted, of one record.
pub fn one_record(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<(Vec<(NodeId, Found)>, Opened), Fault> {
    let keys = work.sharing(unit).map(|sharing| sharing.keys);
    let evaluate = |opened: &Opened, needed: &BTreeSet<NodeId>| {
        opened
            .evaluate(work.graph, needed, wanted, known, work.plan.sections.percentiles, keys)
            .map(|found| (found, slow(work, needed)))
    };
    let (found, opened) = with_record(work, unit, which, wanted, known, evaluate)?;
    values.files.push(opened.file.clone());
    let (found, slow) = found?;
    note_margins(unit, slow, &opened, values);
    Ok((found, opened))
}
