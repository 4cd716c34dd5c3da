//! What is opened and checked before any record is read; then each section to its values. Sections do
//! not depend on each other, so that they can be evaluated in parts, on other machines, in any order.

use std::ops::Range;

use rayon::prelude::*;

use super::section;
use crate::data::campaign::OFFSET;
use crate::result::SectionOffset;
use crate::run::{
    data_rules::stop_on_fault,
    prelude::*,
    record::{Soundness, Stretches, Work},
    sections::{
        Basis, Facts, Unit,
        columns::{self, Present, Recorded},
        requirements, share_stretches, units, wanted,
    },
    values::{SectionValues, Shifts},
};

/// Called after each record, from any thread.
pub type Progress<'a> = &'a (dyn Fn(&str) + Sync);

/// Data read before any record, for one protocol.
#[derive(Debug)]
pub struct Prepared<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    campaigns: Campaigns<'a>,
    pub basis: Basis,
    present: Vec<Vec<Present>>,
    recorded: Vec<Vec<Vec<bool>>>,
    unchecked: Vec<Vec<Option<Reason>>>,
    pub soundness: Soundness,
}

impl<'a> Prepared<'a> {
    /// # Errors
    /// The campaigns do not have what the protocol asks for; a section is faulty, and the protocol
    /// states `stop`.
    pub fn new(
        plan: &'a Plan,
        graph: &'a Graph,
        campaigns: Campaigns<'a>,
    ) -> Result<Self, Problems> {
        let mut problems = Problems::default();
        campaigns.check(&mut problems);
        for asked in &plan.campaigns {
            let names = || campaigns.iter().map(|campaign| campaign.short_name.value.as_str());
            if !names().any(|name| name == asked.value) {
                let says = format!("none of the campaigns is called `{}`", asked.value);
                let problem = Problem::error("unknown-campaign", says)
                    .at(&asked.span)
                    .suggest(&asked.value, names());
                let known = names().collect::<Vec<_>>().join("; ");
                problems.push(if problem.help.is_some() {
                    problem
                } else {
                    problem.help(format!("there is {known}"))
                });
            }
        }
        members(plan, campaigns, &mut problems);
        let facts = Facts::read(plan, campaigns, &mut problems);
        let mut units = units::units(plan, campaigns, &facts, &mut problems);
        let wanted = wanted::points(plan, campaigns, &facts, &mut problems);
        if problems.any_error() {
            return Err(problems);
        }
        let mut notes = Vec::new();
        let (mut present, mut recorded, mut unchecked) = (Vec::new(), Vec::new(), Vec::new());
        for (number, campaign) in campaigns.iter().enumerate() {
            let units: Vec<&Unit> = units.iter().filter(|unit| unit.campaign == number).collect();
            let seen = columns::seen_columns(plan, campaign, &units);
            let of = Recorded { plan, graph, campaign, facts: &facts, units: &units, seen: &seen };
            present.push(of.quantities(&mut notes));
            recorded.push(of.plausibility(&mut notes));
            unchecked.push(of.checks());
            if plan.reads(Side::Measured) {
                notes.extend(shifted(campaign));
            }
        }
        requirements::check_data(plan, &facts, &mut units);
        stop_on_fault(plan, &units, &[])?;
        share_stretches(plan, campaigns, &mut units);
        Ok(Self {
            plan,
            graph,
            campaigns,
            basis: Basis { facts, units, wanted, notes },
            present,
            recorded,
            unchecked,
            soundness: Soundness::default(),
        })
    }

    /// What records are evaluated with, each alone.
    pub fn work(&self) -> Work<'_> {
        Work {
            plan: self.plan,
            graph: self.graph,
            campaigns: self.campaigns,
            facts: &self.basis.facts,
            units: &self.basis.units,
            present: &self.present,
            recorded: &self.recorded,
            unchecked: &self.unchecked,
            shared: None,
            soundness: &self.soundness,
            stretches: None,
        }
    }
}

/// What the table of sections adds to the axis of the measurement.
fn shifted(campaign: &Campaign) -> Option<Remark> {
    let (_, axis, _) = campaign.offsets().next()?;
    let of =
        |(section, _, offset): (&str, &str, f64)| SectionOffset { section: section.into(), offset };
    Some(Remark::Shifted {
        axis: axis.into(),
        unit: if axis == "distance" { "m" } else { "s" }.into(),
        column: OFFSET.into(),
        offsets: campaign.offsets().map(of).collect(),
    })
}

/// What a protocol calls by name must be in every campaign.
fn members(plan: &Plan, campaigns: Campaigns<'_>, problems: &mut Problems) {
    for (number, campaign) in campaigns.iter().enumerate() {
        let of = campaigns.name_of(number).map_or_else(String::new, |name| format!(" {name}"));
        for record in &plan.records {
            let kind = record.side.kind();
            let all = campaign.records(kind);
            let names: Vec<&str> = all
                .iter()
                .filter_map(|which| campaign.record_called(*which).map(AsRef::as_ref))
                .collect();
            for member in
                record.members.iter().filter(|member| !names.contains(&member.value.as_str()))
            {
                let says = format!("the campaign{of} has no {} `{}`", kind.key(), member.value);
                let problem = Problem::error("unknown-record", says)
                    .at(&member.span)
                    .suggest(&member.value, names.iter().copied());
                let named = campaign.tree.get(kind.key()).map(|node| node.span.clone());
                let problem = named
                    .map_or(problem.clone(), |at| problem.also(&at, "the records of the campaign"));
                problems.push(match (&problem.help, names.is_empty()) {
                    (Some(_), _) => problem,
                    (None, true) => problem.help(format!(
                        "give its records names in campaign.yaml: `{}: {{{}: folder}}`",
                        kind.key(),
                        member.value
                    )),
                    (None, false) => problem.help(format!("there is {}", names.join(", "))),
                });
            }
        }
    }
}

/// A part of the sections: number `number` of `of`, counted from 0. Sections that follow each other
/// are in one part, so that a part reads one stretch of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub number: usize,
    pub of: usize,
}

impl Shard {
    pub const WHOLE: Self = Self { number: 0, of: 1 };

    /// `2/8`
    ///
    /// # Errors
    /// It has another form, or the number is not below that of all parts.
    pub fn parse(text: &str) -> Result<Self, String> {
        let form = || "a shard is `NUMBER/ALL`, the number from 0, such as `0/8`".to_string();
        let (number, of) = text.split_once('/').ok_or_else(form)?;
        let (number, of) =
            (number.trim().parse().map_err(|_| form())?, of.trim().parse().map_err(|_| form())?);
        if number >= of {
            return Err(format!("there is no shard {number} of {of}; {}", form()));
        }
        Ok(Self { number, of })
    }

    /// The numbers of its sections, of so many in all.
    pub fn range(self, sections: usize) -> Range<usize> {
        let from =
            |number: usize| (number as u128 * sections as u128 / self.of.max(1) as u128) as usize;
        from(self.number)..from(self.number + 1)
    }
}

/// The values of a section and its number.
pub type Numbered = (usize, SectionValues);

impl Prepared<'_> {
    /// The values of the sections of a shard, in the order of the sections.
    pub fn sections(&self, shard: Shard, progress: Progress<'_>) -> Vec<Numbered> {
        self.numbered(shard.range(self.basis.units.len()), progress)
    }

    /// The values of some sections, by their numbers.
    pub fn numbered(
        &self,
        sections: impl Iterator<Item = usize>,
        progress: Progress<'_>,
    ) -> Vec<Numbered> {
        let of_section = |(number, mut values): (usize, Vec<SectionValues>)| {
            (number, values.pop().unwrap_or_default())
        };
        self.some(sections, &Shifts::NONE, progress).into_iter().map(of_section).collect()
    }

    /// The same with one value for each shift.
    pub fn shifted(
        &self,
        shard: Shard,
        shifts: &Shifts<'_>,
        progress: Progress<'_>,
    ) -> Vec<(usize, Vec<SectionValues>)> {
        self.some(shard.range(self.basis.units.len()), shifts, progress)
    }

    fn some(
        &self,
        sections: impl Iterator<Item = usize>,
        shifts: &Shifts<'_>,
        progress: Progress<'_>,
    ) -> Vec<(usize, Vec<SectionValues>)> {
        let units: Vec<(usize, &Unit)> =
            sections.map(|number| (number, &self.basis.units[number])).collect();
        let stretch = |(_, unit): &(usize, &Unit)| unit.stretch.map(|stretch| stretch.number);
        // A stretch is read by one worker. Sections by themselves differ in length: distributed one
        // by one, they keep all workers busy.
        let groups: Vec<&[(usize, &Unit)]> =
            units.chunk_by(|a, b| stretch(a).is_some() && stretch(a) == stretch(b)).collect();
        let of_group = |group: &[(usize, &Unit)]| {
            let stretches = Stretches::default();
            let work = Work { stretches: Some(&stretches), ..self.work() };
            let one = |(number, unit): &(usize, &Unit)| {
                let faulty = || vec![SectionValues::default(); shifts.offsets.len()];
                let values = if unit.fault.is_some() {
                    faulty()
                } else {
                    section::of_section(&work, unit, shifts)
                };
                progress(&unit.name);
                (*number, values)
            };
            group.iter().map(one).collect::<Vec<_>>()
        };
        groups.into_par_iter().with_max_len(1).flat_map_iter(of_group).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_all_sections_once() {
        for sections in [0, 1, 7, 412] {
            for of in 1..9 {
                let all: Vec<usize> =
                    (0..of).flat_map(|number| Shard { number, of }.range(sections)).collect();
                assert_eq!(all, (0..sections).collect::<Vec<_>>());
                let longest =
                    (0..of).map(|number| Shard { number, of }.range(sections).len()).max();
                assert!(longest <= Some(sections.div_ceil(of)), "{sections} in {of}");
            }
        }
    }

    #[test]
    fn a_shard_is_read() {
        assert_eq!(Shard::parse("2/8"), Ok(Shard { number: 2, of: 8 }));
        for wrong in ["", "8", "8/8", "1/0", "-1/8", "a/b", "1/8/2"] {
            assert!(Shard::parse(wrong).is_err(), "{wrong}");
        }
    }
}
