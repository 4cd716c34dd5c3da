//! Stretches of runs. A section is read with what is beside it, in which filters settle, so
//! neighbours read much in common: they share one stretch. It follows from the table of sections
//! alone, so that a section has the same values in every part of a campaign.

use super::unit::{Extent, Stretch, Unit};
use crate::check::plan::Plan;
use crate::data::Campaigns;

/// The longest stretch that sections share, in lengths of what the shortest of them reads by
/// itself. Of sections that touch, each with two lengths beside it on both sides, 16 share a
/// stretch of 20 lengths: a sample is filtered 1.25 times, and not five times. In longer stretches
/// it would be filtered less often by a few per cent, but they are evaluated by one worker each.
const LONGEST: f64 = 4.0;

/// Gives sections of runs the stretch that they share with others, whether they can be used or not.
///
/// Sections share a stretch if they follow each other in the table, are of one run, have the same
/// offset, and if what they read by themselves touches.
pub fn share(plan: &Plan, campaigns: Campaigns<'_>, units: &mut [Unit]) {
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
