//! A section as it is evaluated, and the stretches of runs that sections share.
//!
//! A section of a run is read with what is beside it, in which filters settle, so neighbours read much
//! in common: they share one stretch. It follows from the table of sections alone, so that a section
//! has the same values in every part of a campaign.

use serde::{Deserialize, Serialize};

use crate::data::{campaign::RunStretch, table::Cell};
use crate::result::CheckResult;
use crate::run::prelude::*;
use crate::source::Span;

/// Start and end of a section on the axis, SI.
pub type Extent = (f64, f64);

/// A section, or a whole record where there are no sections.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unit {
    /// Of its own; in a pool with the campaign's: `series 2/S01`.
    pub name: String,
    /// Number of its campaign, and what that is called where there are several.
    pub campaign: usize,
    pub campaign_name: Option<String>,
    /// Number of its vehicle in [`crate::run::Facts::vehicles`].
    pub vehicle: usize,
    /// The section name with its place in the table; it is also the name of the records.
    pub cell: Cell,
    pub zone: Option<String>,
    /// Index of its site: sections of the same stretch of track have the same.
    pub site: usize,
    /// Name of the first section of the site.
    pub site_name: String,
    /// Index of the section that it repeats.
    pub original: Option<usize>,
    /// In a draw of sections with repetition, how often it was drawn before: each is a unit of its
    /// own there.
    #[serde(skip)]
    pub copy: usize,
    /// `None` for a whole record.
    pub extent: Option<Extent>,
    /// Of a section of a run: what is read for it and its neighbours.
    #[serde(skip)]
    pub stretch: Option<Stretch>,
    /// The range that a report states: that of the section, or of the measured record.
    pub covered: Option<Extent>,
    /// One for each [`crate::check::plan::Plan::columns`].
    pub columns: Vec<Result<Scalar, Reason>>,
    pub checks: Vec<CheckResult>,
    /// Why it is not used.
    pub fault: Option<Reason>,
    /// Whether the fault is in the data and not in a requirement.
    pub faulty: bool,
    /// Row of the table of sections.
    pub span: Option<Span>,
}

/// A part of a run that is read for the sections inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    pub number: usize,
    pub extent: Extent,
}

impl Stretch {
    /// What is read.
    pub fn part(&self, plan: &Plan) -> RunStretch {
        RunStretch { axis: plan.axis.column.clone(), from: self.extent.0, to: self.extent.1 }
    }
}

impl Unit {
    /// A whole record, of which nothing else is known.
    pub fn new(name: &Cell, site: usize, columns: Vec<Result<Scalar, Reason>>) -> Self {
        Self {
            name: name.value.clone(),
            campaign: 0,
            campaign_name: None,
            vehicle: 0,
            cell: name.clone(),
            zone: None,
            site,
            site_name: name.value.clone(),
            original: None,
            copy: 0,
            extent: None,
            stretch: None,
            covered: None,
            columns,
            checks: Vec::new(),
            fault: None,
            faulty: false,
            span: None,
        }
    }

    /// The part of a run that the section reads by itself; `None` of a whole record.
    pub fn part(&self, plan: &Plan) -> Option<RunStretch> {
        self.extent
            .map(|extent| RunStretch::around(&plan.axis.column, extent, plan.sections.margin))
    }

    /// The same drawn once more.
    #[must_use]
    pub fn drawn_again(&self, copy: usize) -> Self {
        let named = |name: &str| match copy {
            0 => name.to_owned(),
            copy => format!("{name} ({})", copy + 1),
        };
        let (name, site_name) = (named(&self.name), named(&self.site_name));
        Self { copy, name, site_name, ..self.clone() }
    }

    /// Records the first reason not to use it.
    pub fn refuse(&mut self, reason: Reason, faulty: bool) {
        if self.fault.is_none() {
            self.fault = Some(reason);
            self.faulty = faulty;
        }
    }
}

/// The longest stretch that sections share, in lengths of what the shortest of them reads by
/// itself. Of sections that touch, each with two lengths beside it on both sides, 16 share a
/// stretch of 20 lengths: a sample is filtered 1.25 times, and not five times. In longer stretches
/// it would be filtered less often by a few per cent, but they are evaluated by one worker each.
const LONGEST: f64 = 4.0;

/// Gives sections of runs the stretch that they share with others, whether they can be used or not.
///
/// Sections share a stretch if they follow each other in the table, are of one run, have the same
/// offset, and if what they read by themselves touches.
pub fn share_stretches(plan: &Plan, campaigns: Campaigns<'_>, units: &mut [Unit]) {
    let mut found: Vec<Growing<'_>> = Vec::new();
    let mut of_unit: Vec<(usize, usize)> = Vec::new();
    for (at, unit) in units.iter().enumerate() {
        let campaign = campaigns.get(unit.campaign);
        let (Some(own), Some(run)) = (unit.part(plan), campaign.run_of(&unit.cell)) else {
            continue;
        };
        let Ok(offset) = campaign.offset(&unit.cell) else { continue };
        let of = Of {
            campaign: unit.campaign,
            run: &run.name.value,
            offset: offset.map_or(0.0, |(_, offset)| offset),
        };
        let one = Growing { of, extent: (own.from, own.to), shortest: own.to - own.from };
        match found.last_mut() {
            Some(last) if let Some(both) = last.with(&one) => *last = both,
            _ => found.push(one),
        }
        of_unit.push((at, found.len() - 1));
    }
    for (at, number) in of_unit {
        units[at].stretch = Some(Stretch { number, extent: found[number].extent });
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Of<'a> {
    campaign: usize,
    run: &'a str,
    offset: f64,
}

/// A stretch to which sections are added.
#[derive(Clone, Copy, Debug)]
struct Growing<'a> {
    of: Of<'a>,
    extent: Extent,
    /// The shortest of what its sections read by themselves.
    shortest: f64,
}

impl Growing<'_> {
    /// Both as one stretch, if it is not too long and has no part that no section asks for.
    fn with(&self, other: &Self) -> Option<Self> {
        let touch = self.extent.0 <= other.extent.1 && other.extent.0 <= self.extent.1;
        let extent = (self.extent.0.min(other.extent.0), self.extent.1.max(other.extent.1));
        let shortest = self.shortest.min(other.shortest);
        (self.of == other.of && touch && extent.1 - extent.0 <= LONGEST * shortest)
            .then_some(Self { extent, shortest, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn growing(run: &str, from: f64, to: f64) -> Growing<'_> {
        Growing {
            of: Of { campaign: 0, run, offset: 0.0 },
            extent: (from, to),
            shortest: to - from,
        }
    }

    /// Sections of 100 m, each with 200 m beside it.
    #[test]
    fn touching_sections_share_a_stretch_of_limited_length() {
        let of = |number: u32| {
            growing("R1", 100.0 * f64::from(number), 100.0 * f64::from(number) + 500.0)
        };
        let mut stretch = of(0);
        let mut shared = 1;
        while let Some(longer) = stretch.with(&of(shared)) {
            stretch = longer;
            shared += 1;
        }
        assert_eq!((shared, stretch.extent), (16, (0.0, 2000.0)));
    }

    #[test]
    fn others_have_their_own() {
        let one = growing("R1", 0.0, 500.0);
        assert!(one.with(&growing("R2", 100.0, 600.0)).is_none(), "of another run");
        assert!(
            one.with(&growing("R1", 501.0, 1001.0)).is_none(),
            "no section asks for what is between"
        );
        let moved = Growing { of: Of { offset: 0.1, ..one.of }, ..growing("R1", 100.0, 600.0) };
        assert!(one.with(&moved).is_none(), "another offset");
        assert_eq!(
            one.with(&growing("R1", -400.0, 100.0)).map(|both| both.extent),
            Some((-400.0, 500.0)),
            "in any order"
        );
        assert_eq!(one.with(&growing("R1", 400.0, 1600.0)).map(|both| both.shortest), Some(500.0));
        assert!(
            one.with(&growing("R1", 400.0, 2401.0)).is_none(),
            "more than four times what one of them needs"
        );
    }
}
