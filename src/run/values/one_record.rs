//! One record of a section through the graph.

use std::collections::BTreeSet;

use super::margins::{note_margins, slow};
use super::section_values::SectionValues;
use super::sides::RecordOfSide;
use crate::data::WhichRecord;
use crate::graph::NodeId;
use crate::result::Reason;
use crate::run::record::{Fault, Opened, Work, with_record};
use crate::run::sections::{Known, Unit};

/// The nodes that are wanted, of one record.
///
/// # Errors
/// As of [`read_record`].
pub fn one_record(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<RecordOfSide, Fault> {
    let keys = work.sharing(unit).map(|sharing| sharing.keys);
    let evaluate = |opened: &Opened, needed: &BTreeSet<NodeId>| {
        let found = opened.evaluate((work.plan, work.graph), needed, wanted, known, keys)?;
        Ok(RecordOfSide::new(work, unit, which, opened, found))
    };
    read_record(work, unit, which, wanted, known, values, evaluate)
}

/// Evaluates a record with `evaluate`, and notes its file, and a margin that is too short for slow
/// filters.
///
/// # Errors
/// The record cannot be read or does not cover the section; and what `evaluate` says.
pub fn read_record<T>(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
    evaluate: impl FnOnce(&Opened, &BTreeSet<NodeId>) -> Result<T, Reason>,
) -> Result<T, Fault> {
    let with_slow = |opened: &Opened, needed: &BTreeSet<NodeId>| {
        evaluate(opened, needed).map(|found| (found, slow(work, needed)))
    };
    let (found, opened) = with_record(work, unit, which, wanted, known, with_slow)?;
    values.files.push(opened.file.clone());
    let (found, slow) = found?;
    note_margins(unit, slow, &opened, values);
    Ok(found)
}
