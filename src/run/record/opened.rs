//! A record that was read and checked for a section, and why one cannot be used.

use std::sync::{Arc, Mutex};

use super::{
    memo::{Memo, Numbers},
    signal::{Along, Rate, Samples},
};
use crate::data::{
    Record,
    campaign::{Changed, ReadFile},
    checks::{Section, check_axis, whole},
    qualified,
};
use crate::result::{self, RecordOf};
use crate::run::{
    prelude::*,
    sections::{Extent, Unit},
};
use crate::units::Dimension;

/// Whether a file of a record cannot be read.
pub fn unreadable(problems: &[Problem]) -> bool {
    problems.iter().any(|problem| problem.code == "file-unreadable")
}

/// A reason why a record cannot be used, and the problems that caused it.
#[derive(Debug)]
pub struct Fault {
    pub reason: Reason,
    pub problems: Vec<Problem>,
}

impl Fault {
    pub fn new(reason: Reason) -> Self {
        Self { reason, problems: Vec::new() }
    }

    /// What is wrong with a record of a campaign.
    pub fn of(campaign: &Campaign, problems: Vec<Problem>) -> Self {
        let says = said(campaign, &problems);
        let reason = match unreadable(&problems) {
            true => Reason::Unreadable { says },
            false => Reason::Said { says },
        };
        Self { reason, problems }
    }

    /// The faults of both records of a section.
    pub fn and(mut self, other: Self) -> Self {
        if self.reason != other.reason {
            self.reason =
                Reason::Both { first: Box::new(self.reason), second: Box::new(other.reason) };
        }
        self.problems.extend(other.problems);
        self
    }
}

/// A record that was read and covers the section.
#[derive(Clone, Debug)]
pub struct Opened {
    pub sampled: Sampled,
    pub extent: Extent,
    pub file: FileHash,
    /// Time recorded before and after the section, in s, where records have a time.
    pub margins: Option<(f64, f64)>,
    /// What protocols that share the record have computed of it.
    pub memo: Option<Arc<Memo>>,
    /// Of a stretch that sections share: the part of it that this section would read by itself.
    pub own: Option<Extent>,
    /// The stretch, with what its sections have computed of it.
    pub stretch: Option<Arc<Stretched>>,
}

/// The samples of a record.
#[derive(Clone, Debug)]
pub struct Sampled {
    columns: Arc<Vec<(String, Arc<Vec<f64>>)>>,
    pub along: Arc<Along>,
    /// Whether the record has a time.
    pub in_time: bool,
}

/// A record of a stretch, and the values of nodes on it.
#[derive(Debug)]
pub struct Stretched {
    pub sampled: Sampled,
    pub read: ReadFile,
    pub numbers: Mutex<Numbers>,
    pub results: Memo,
}

/// The time of a record that runs along something else.
pub fn clock(plan: &Plan, kind: RecordKind) -> Option<&Axis> {
    plan.time.as_ref().filter(|time| kind != RecordKind::Track && time.column != plan.axis.column)
}

impl Sampled {
    /// `rate`: samples per unit of the clock, from its values.
    fn new(
        plan: &Plan,
        kind: RecordKind,
        columns: impl Iterator<Item = (String, Vec<f64>)>,
        first_row: usize,
        rate: impl FnOnce(&[f64]) -> f64,
    ) -> Self {
        let columns: Vec<_> = columns.map(|(name, values)| (name, Arc::new(values))).collect();
        let values = |name: &str| {
            columns.iter().find(|(known, _)| known == name).map(|(_, values)| Arc::clone(values))
        };
        let clock = clock(plan, kind);
        let in_time = clock.is_some() || plan.axis.unit.dimension == Dimension::TIME;
        let axis = values(&plan.axis.column).unwrap_or_default();
        let time = clock.and_then(|time| values(&time.column));
        let rate = rate(time.as_ref().unwrap_or(&axis));
        let rate = if in_time { Rate::PerTime(rate) } else { Rate::PerLength(rate) };
        let along = Arc::new(Along { axis, time, rate, first_row: Some(first_row) });
        Self { columns: Arc::new(columns), along, in_time }
    }

    /// Of a record whose axes are sound.
    pub fn of_record(plan: &Plan, kind: RecordKind, record: Record, rate: f64) -> Self {
        let first_row = record.row_shown(0);
        let columns = record.columns.into_iter().map(|column| (column.name, column.values));
        Self::new(plan, kind, columns, first_row, |_| rate)
    }

    /// The same with other values of some columns.
    pub fn with_columns(&self, other: impl Fn(&str, &[f64]) -> Option<Vec<f64>>) -> Self {
        let column = |(name, values): &(String, Arc<Vec<f64>>)| {
            (name.clone(), other(name, values).map_or_else(|| Arc::clone(values), Arc::new))
        };
        let columns = Arc::new(self.columns.iter().map(column).collect());
        Self { columns, ..self.clone() }
    }

    pub fn column(&self, name: &str) -> Option<&Arc<Vec<f64>>> {
        self.columns.iter().find(|(known, _)| known == name).map(|(_, values)| values)
    }

    /// From the first to the last sample.
    pub fn extent(&self) -> Option<Extent> {
        Some((*self.along.axis.first()?, *self.along.axis.last()?))
    }
}

/// A file as results state it; of several campaigns with that of the file.
pub fn file_hash(read: &ReadFile, campaign: Option<&str>, record: Option<RecordOf>) -> FileHash {
    let path = qualified(campaign, &read.path);
    let changed = read.changed.clone();
    let changed = changed.map(|Changed { imported, reason }| result::Changed { imported, reason });
    FileHash { path, sha256: read.sha256.clone(), bytes: read.bytes, record, changed }
}

/// A record of a section that is read.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    pub plan: &'a Plan,
    pub campaign: &'a Campaign,
    pub unit: &'a Unit,
    pub which: WhichRecord,
}

impl Reading<'_> {
    /// The file of the record, as results state it.
    pub fn file(&self, read: &ReadFile) -> FileHash {
        let name = self.campaign.record_name(self.which).map(ToString::to_string);
        let (kind, section) = (self.which.kind.key().into(), self.unit.name.clone());
        let record = RecordOf { kind, section, name };
        file_hash(read, self.unit.campaign_name.as_deref(), Some(record))
    }

    /// The part of a run that the section reads by itself.
    pub fn own(&self) -> Option<Extent> {
        self.unit.part(self.plan).map(|part| (part.from, part.to))
    }
}

impl Opened {
    /// A record that was read, checked for the section.
    ///
    /// # Errors
    /// Its axes are not sound, or it does not cover the section.
    pub fn new(reading: &Reading<'_>, (record, read): (Record, ReadFile)) -> Result<Self, Fault> {
        let Reading { plan, campaign, unit, which } = *reading;
        let axis = &plan.axis.column;
        let place = unit.extent.map(|(start, end)| Section { start, end, at: unit.span.clone() });
        let time = clock(plan, which.kind).map_or(axis, |time| &time.column);
        let checked = check_axis(&record, time, axis, place.as_ref())
            .map_err(|problems| Fault::of(campaign, problems))?;
        let sampled = Sampled::of_record(plan, which.kind, record, checked.sampling_rate);
        Ok(Self {
            extent: unit.extent.or(sampled.extent()).unwrap_or_default(),
            file: reading.file(&read),
            margins: sampled.in_time.then_some((checked.before, checked.after)),
            memo: None,
            own: unit.stretch.and_then(|_| reading.own()),
            stretch: None,
            sampled,
        })
    }

    /// A piece of a run, in which sections are looked for.
    pub fn piece(
        plan: &Plan,
        kind: RecordKind,
        columns: impl Iterator<Item = (String, Vec<f64>)>,
        first_row: usize,
    ) -> Self {
        let rate = |clock: &[f64]| match clock {
            [first, .., last] => whole((clock.len() - 1) as f64 / (last - first)),
            _ => 1.0,
        };
        let sampled = Sampled::new(plan, kind, columns, first_row, rate);
        Self {
            extent: sampled.extent().unwrap_or_default(),
            file: FileHash {
                path: String::new(),
                sha256: String::new(),
                bytes: 0,
                record: None,
                changed: None,
            },
            margins: None,
            memo: None,
            own: None,
            stretch: None,
            sampled,
        }
    }

    /// A signal, no longer than what the section would read by itself.
    pub fn around_section(&self, samples: Samples) -> Samples {
        match self.own.map(|own| samples.cut(own)) {
            Some(Ok(cut)) => cut,
            _ => samples,
        }
    }

    /// First and last row of the file inside the section, and of all that was read and is filtered;
    /// the header is row 1.
    pub fn rows(&self) -> [(usize, usize); 2] {
        let first = self.sampled.along.first_row.unwrap_or(1);
        let inside = self.sampled.along.inside(self.extent);
        [
            (first + inside.start, first + inside.end.saturating_sub(1)),
            (first, first + self.sampled.along.axis.len().saturating_sub(1)),
        ]
    }
}

/// Several problems in one line, each with its place unless the text already names it, and with its
/// help.
fn said(campaign: &Campaign, problems: &[Problem]) -> String {
    let mut told: Vec<(&Problem, usize)> = Vec::new();
    for problem in problems {
        // The same problem in several rows is stated once.
        match told.iter_mut().find(|(first, _)| first.says == problem.says) {
            Some((_, more)) => *more += 1,
            None => told.push((problem, 0)),
        }
    }
    let sentence = |(problem, more): &(&Problem, usize)| {
        let fact = match &problem.at {
            Some(at) => placed(&problem.says, campaign.inside(&at.source.name), at.line(), *more),
            None => problem.says.clone(),
        };
        problem.help.as_ref().map_or(fact.clone(), |help| format!("{fact}: {help}"))
    };
    told.iter().map(sentence).collect::<Vec<_>>().join("; ")
}

/// Adds the place to a text. A text that names file and row needs none; one that names the file
/// needs none in the header.
fn placed(says: &str, file: &str, row: usize, more: usize) -> String {
    let names_file = says.contains(&format!("`{file}`"));
    let names_row =
        row == 1 || says.split(|c: char| !c.is_ascii_digit()).any(|word| word.parse() == Ok(row));
    match more {
        0 if names_file && names_row => says.to_string(),
        0 => format!("{says} ({file}, row {row})"),
        _ => format!("{says} ({file}, row {row} and {more} more)"),
    }
}
