//! A campaign in memory that is judged again and again with other records.

use std::sync::Arc;

use super::disturb::{rms, shape};
use crate::certify::Compiled;
use crate::check::plan::Side;
use crate::data::campaign::{CAMPAIGN_FILE, Memory};
use crate::data::write::{
    Entry, FileColumn, Outputs, Values, campaign_yaml, campaign_yaml_with, parquet,
};
use crate::data::{Campaign, RecordKind};
use crate::effects::Signals;
use crate::impact::Written;
use crate::metrics::resample::Located;
use crate::problem::{Problem, Problems};
use crate::result::exercise::Disturbance;
use crate::result::{EdgeResult, Finding};
use crate::run::{self, Numbered};
use crate::simulate::{Section, columns, frame, recorded, sections};
use crate::units::Unit;

/// The records of one kind, by section.
#[derive(Debug)]
pub struct Records {
    pub side: Side,
    pub kind: RecordKind,
    of: Vec<(Signals, Vec<(String, Unit)>)>,
}

/// A disturbance of measurement and simulation alike.
pub const BOTH: &str = "both";

/// How a limit stands in a campaign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// How far the value that is nearest to the limit has come to it: above 1 it is not met. It
    /// grows in proportion with a value.
    pub reach: Option<f64>,
    pub holds: Option<bool>,
}

/// What a judgement says: of each limit, and what else is told of the data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    pub limits: Vec<State>,
    pub findings: Vec<String>,
}

#[derive(Debug)]
pub struct Bench<'a> {
    pub compiled: &'a Compiled,
    pub limits: &'a [Written],
    pub campaign: Campaign,
    /// As it is on the disk.
    original: &'a Campaign,
    pub sections: Vec<Section>,
    /// The values of the sections as the campaign is.
    values: Vec<Numbered>,
    /// Those that the protocol reads: the measured ones first.
    pub records: Vec<Records>,
}

impl<'a> Bench<'a> {
    /// # Errors
    /// Of reading records.
    pub fn new(
        compiled: &'a Compiled,
        limits: &'a [Written],
        original: &'a Campaign,
    ) -> Result<Self, Problems> {
        let mut problems = Problems::default();
        let sections = sections(original, &mut problems).ok_or(problems)?;
        let mut records = Vec::new();
        for side in [Side::Measured, Side::Simulated] {
            let kind = side.kind();
            if compiled.plan.reads(side) {
                original.only_one(kind)?;
                let of = sections.iter().map(|section| {
                    let (signals, units, _) =
                        recorded(original, kind, section).map_err(Problems)?;
                    Ok((signals, units))
                });
                records.push(Records { side, kind, of: of.collect::<Result<_, Problems>>()? });
            }
        }
        let campaign = original.clone();
        let values = Vec::new();
        let mut bench = Self { compiled, limits, campaign, original, sections, values, records };
        let numbers: Vec<(usize, usize)> = bench.all_records();
        bench.campaign =
            bench.with(numbers.into_iter().map(|(kind, section)| {
                (kind, section, bench.records[kind].of[section].0.clone())
            }))?;
        Ok(bench)
    }

    fn all_records(&self) -> Vec<(usize, usize)> {
        let kinds = 0..self.records.len();
        kinds.flat_map(|kind| (0..self.sections.len()).map(move |at| (kind, at))).collect()
    }

    /// Keeps a share of the difference between measurement and simulation, which is taken at the
    /// same places of the axis; beyond the simulated record its end counts.
    ///
    /// # Errors
    /// Of opening the campaign; an axis that does not increase.
    pub fn narrow(&mut self, share: f64) -> Result<(), Problems> {
        let [measured, simulated] = &mut self.records[..] else { return Ok(()) };
        for ((measured, _), (simulated, _)) in measured.of.iter_mut().zip(&simulated.of) {
            let [Some(first), Some(last)] = [simulated.axis.first(), simulated.axis.last()] else {
                continue;
            };
            let places: Vec<f64> = measured.axis.iter().map(|x| x.clamp(*first, *last)).collect();
            let located = Located::on(&simulated.axis, &places)
                .map_err(|error| Problem::error("axis-not-increasing", error.to_string()))?;
            for channel in &mut measured.channels {
                let Some(other) = simulated.channel(&channel.name) else { continue };
                for (value, other) in channel.values.iter_mut().zip(located.values(&other.values)) {
                    *value = other + share * (*value - other);
                }
            }
        }
        let changed = (0..self.sections.len()).map(|at| (0, at, self.records[0].of[at].0.clone()));
        self.campaign = self.with(changed)?;
        Ok(())
    }

    /// The campaign with some records replaced: the number of their kind, of their section, and
    /// what they hold.
    fn with(
        &self,
        changed: impl Iterator<Item = (usize, usize, Signals)>,
    ) -> Result<Campaign, Problems> {
        let mut memory = Memory::default();
        for (kind, at, signals) in changed {
            let records = &self.records[kind];
            let name = format!("{}/{}", records.kind.key(), self.sections[at].name());
            let unit = |name: &str| Unit::of(name, &records.of[at].1);
            let frame = frame(&name, &signals, &unit)?;
            memory.records.insert(name, Arc::new(frame));
        }
        let text = self.text(&self.original.name);
        memory.texts.insert(CAMPAIGN_FILE.to_string(), text.into_bytes());
        let mut problems = Problems::default();
        self.campaign.replaced(memory, &mut problems).ok_or(problems)
    }

    /// `campaign.yaml` with the records in the folders of their kinds.
    fn text(&self, name: &str) -> String {
        let kinds: Vec<&str> = self.records.iter().map(|records| records.kind.key()).collect();
        let own: Vec<&str> = ["name"].into_iter().chain(kinds.iter().copied()).collect();
        let new: Vec<_> = kinds.iter().map(|kind| (*kind, Entry::Text(kind))).collect();
        campaign_yaml(&[("name", Entry::Text(name))])
            + &campaign_yaml_with(&self.original.tree, &own, &new)
    }

    /// The rms value of the fluctuation of a column, the largest of all records.
    fn scale(&self, column: &str) -> f64 {
        let all = self.records.iter().flat_map(|records| &records.of);
        let of = |(signals, _): &(Signals, Vec<(String, Unit)>)| {
            signals.channel(column).map(|channel| rms(&channel.values))
        };
        all.filter_map(of).fold(0.0, f64::max)
    }

    /// Whether records of a kind have a column.
    pub fn has(&self, kind: RecordKind, column: &str) -> bool {
        let of = self.records.iter().find(|records| records.kind == kind);
        of.is_some_and(|records| {
            records.of.iter().any(|(signals, _)| signals.channel(column).is_some())
        })
    }

    /// The records that a disturbance changes.
    fn disturbed(&self, by: &Disturbance, size: f64) -> Vec<(usize, usize, Signals)> {
        let changed = |(kind, at): (usize, usize)| {
            let size = size * by.weight(at);
            let mut signals = self.records[kind].of[at].0.clone();
            let whole = signals.clone();
            for channel in signals.channels.iter_mut().filter(|of| by.columns.contains(&of.name)) {
                let scale = self.scale(&channel.name);
                let added = shape(by.shape, &whole, &channel.values, scale);
                let both = channel.values.iter_mut().zip(added);
                both.for_each(|(value, added)| *value += size * added);
            }
            (size != 0.0).then_some((kind, at, signals))
        };
        let of_record = |(kind, _): &(usize, usize)| {
            by.record == BOTH || by.record == self.records[*kind].kind.key()
        };
        self.all_records().into_iter().filter(of_record).filter_map(changed).collect()
    }

    /// What is said of the campaign as it is.
    ///
    /// # Errors
    /// It cannot be judged.
    pub fn base(&mut self) -> Result<Said, Problems> {
        let Compiled { plan, graph, .. } = self.compiled;
        let (values, outcome) = run::again(plan, graph, &self.campaign, &[], &|_| true)?;
        self.values = values;
        Ok(said(self.limits, &outcome))
    }

    /// What is said of the campaign with a disturbance. `None` where it cannot be judged.
    pub fn judged(&self, by: &Disturbance, size: f64) -> Option<Said> {
        self.judged_by((self.compiled, &self.values), Some((by, size)))
    }

    /// The same by another protocol with the same limits, for which the values of unchanged
    /// sections are known, or are none.
    pub fn judged_by(
        &self,
        (compiled, known): (&Compiled, &[Numbered]),
        by: Option<(&Disturbance, f64)>,
    ) -> Option<Said> {
        let changed = by.map_or_else(Vec::new, |(by, size)| self.disturbed(by, size));
        let names: Vec<&str> = changed.iter().map(|of| self.sections[of.1].name()).collect();
        let is_changed = |name: &str| names.contains(&name);
        let campaign = self.with(changed.iter().cloned()).ok()?;
        let Compiled { plan, graph, .. } = compiled;
        let (_, outcome) = run::again(plan, graph, &campaign, known, &is_changed).ok()?;
        Some(said(self.limits, &outcome))
    }

    /// Adds the campaign with a disturbance to files, in a folder of them.
    ///
    /// # Errors
    /// Of reading the other files, or of writing.
    pub fn write(
        &self,
        (outputs, folder): (&mut Outputs, &str),
        name: &str,
        (by, size): (&Disturbance, f64),
    ) -> Result<(), Problem> {
        let changed = self.disturbed(by, size);
        for (kind, at) in self.all_records() {
            let records = &self.records[kind];
            let (signals, units) = &records.of[at];
            let new = changed.iter().find(|of| (of.0, of.1) == (kind, at)).map(|of| &of.2);
            let name = format!("{}/{}", records.kind.key(), self.sections[at].name());
            let columns = columns(&name, new.unwrap_or(signals), &|name| Unit::of(name, units))?;
            let column = |(heading, values)| FileColumn {
                heading,
                values: Values::Numbers(values),
                digits: None,
            };
            let bytes = parquet(&columns.into_iter().map(column).collect::<Vec<_>>())?;
            outputs.add(&format!("{folder}/{name}.parquet"), &bytes)?;
        }
        outputs.add(&format!("{folder}/{CAMPAIGN_FILE}"), self.text(name).as_bytes())?;
        let own: Vec<RecordKind> = self.records.iter().map(|records| records.kind).collect();
        for (inside, bytes) in self.original.other_files(&own)? {
            outputs.add(&format!("{folder}/{inside}"), &bytes)?;
        }
        Ok(())
    }
}

/// What a judgement says of limits.
pub fn said(limits: &[Written], outcome: &run::Outcome) -> Said {
    let limits = limits.iter().map(|limit| {
        let rows: Vec<EdgeResult> =
            limit.rows(&outcome.judged.quantities).map(|(_, edge)| edge).collect();
        let reach = rows.iter().filter_map(|edge| {
            let limit = edge.limit.filter(|limit| *limit != 0.0)?;
            Some(1.0 - edge.direction.distance(edge.value?, limit) / limit.abs())
        });
        let holds = rows.iter().map(|edge| edge.holds).reduce(|a, b| Some(a? && b?));
        State { reach: reach.reduce(f64::max), holds: holds.flatten() }
    });
    Said { limits: limits.collect(), findings: outcome.findings.iter().map(named).collect() }
}

/// A finding without its numbers: what it is, and where.
fn named(finding: &Finding) -> String {
    let first = &finding.first;
    let place = [&first.channel, &first.section, &first.record];
    let place: Vec<&str> = place.into_iter().flatten().map(String::as_str).collect();
    format!("{} {}", finding.code, place.join(" ")).trim_end().to_string()
}
