//! Results of quantities in draws of the sections: how far a verdict rests on which of them were
//! tested.

use std::collections::BTreeSet;

use indexmap::IndexMap;
use rayon::prelude::*;

use super::quantities::{Tells, of_rows};
use crate::check::plan::Plan;
use crate::metrics::cluster::{Draws, REPLICATES, SEED};
use crate::result::{QuantityResult, Reason};
use crate::run::estimate::{Rows, Used, independent_of};
use crate::run::sections::{Facts, Unit};

/// The sections used, of which draws are made.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    pub plan: &'a Plan,
    pub facts: &'a Facts,
    pub used: &'a Used<'a>,
}

/// What the draws came to, one after the other, and the number of independent units.
#[derive(Debug)]
pub struct OfDraws<T> {
    pub found: Vec<T>,
    pub units: usize,
}

impl Sample<'_> {
    /// What is found of some quantities in each of [`REPLICATES`] draws with replacement.
    ///
    /// The independent units are drawn, each with all its sections, as many as there are: those with
    /// sections in the same zones for each other, so that every zone keeps the number of its units.
    /// One that is drawn twice counts as two units.
    ///
    /// # Errors
    /// A unit that no other can be drawn for.
    pub fn each<T: Send>(
        &self,
        about: &[usize],
        find: impl Fn(&[(QuantityResult, Vec<Reason>)]) -> T + Sync,
    ) -> Result<OfDraws<T>, Reason> {
        let Self { plan, facts, used } = *self;
        let strata = self.strata();
        if let Some((zones, _)) = strata.iter().find(|(_, units)| units.len() < 2) {
            let zones = zones.iter().flatten().map(|zone| (*zone).to_owned()).collect();
            return Err(Reason::TooFewToDraw { zones });
        }
        let sizes: Vec<usize> = strata.values().map(IndexMap::len).collect();
        let sections: Vec<&Vec<usize>> = strata.values().flat_map(IndexMap::values).collect();
        let draws = Draws::within(&sizes, REPLICATES, SEED).map_err(Reason::method)?;
        let draws: Vec<&[usize]> = draws.iter().collect();
        let times = |draw: &&[usize]| {
            let mut times = vec![0; sections.len()];
            draw.iter().for_each(|unit| times[*unit] += 1);
            times
        };
        let draws: Vec<Vec<usize>> = draws.iter().map(times).collect();
        let most = draws.iter().flatten().max().copied().unwrap_or(0);
        let copies: Vec<Vec<Unit>> = (0..most)
            .map(|copy| used.iter().map(|(unit, _)| unit.drawn_again(copy)).collect())
            .collect();
        let reasons: Vec<Option<Reason>> =
            Rows::of_all(plan, facts, used).into_iter().map(|rows| rows.reason).collect();
        let in_draw = |times: &Vec<usize>| {
            let mut drawn = Vec::new();
            for (of_unit, times) in sections.iter().zip(times) {
                for copies in &copies[..*times] {
                    drawn.extend(of_unit.iter().map(|&at| (&copies[at], used[at].1)));
                }
            }
            let rows = |(at, reason): (usize, &Option<Reason>)| {
                Rows::drawn(plan, at, &drawn, reason.clone())
            };
            let all: Vec<Rows<'_>> = reasons.iter().enumerate().map(rows).collect();
            find(&of_rows(plan, facts, &all, Tells::Limits, about.iter().copied()))
        };
        Ok(OfDraws { found: draws.par_iter().map(in_draw).collect(), units: sections.len() })
    }

    /// The independent units by the zones of their sections, each with its sections.
    fn strata(&self) -> IndexMap<BTreeSet<Option<&str>>, IndexMap<usize, Vec<usize>>> {
        let of_section = independent_of(self.plan, self.used.iter().map(|(unit, _)| *unit));
        let mut units: IndexMap<usize, Vec<usize>> = IndexMap::new();
        for (section, unit) in of_section.into_iter().enumerate() {
            units.entry(unit).or_default().push(section);
        }
        let mut strata: IndexMap<_, IndexMap<_, _>> = IndexMap::new();
        for (unit, sections) in units {
            let zones = sections.iter().map(|&at| self.used[at].0.zone.as_deref()).collect();
            strata.entry(zones).or_default().insert(unit, sections);
        }
        strata
    }
}
