//! The disturbance that brings one limit to both sides, and no other.

use std::collections::BTreeMap;

use indexmap::{IndexMap, IndexSet};
use rayon::prelude::*;

use super::{
    bench::{BOTH, Bench, Said},
    disturb::shapes,
};
use crate::result::exercise::{Disturbance, NoPair, Over, Sized};
use crate::run::needs::Needs;

/// How close both campaigns of a pair come to the limit, as a share of it.
pub const CLOSE: f64 = 1e-3;

/// The least distance, as a share of [`CLOSE`]: far above the rounding of the numbers of a record.
const ROUNDING: f64 = 0.01;

/// Largest size that is tried, in rms values of the fluctuation of the channel: beyond it a record
/// is nothing that a machine does.
const LARGEST: f64 = 1e3;

/// A size grows by this factor until the limit is crossed.
const GROWTH: f64 = 1.7;

/// Evaluations after the limit was crossed. Of a value that grows with the size six are enough; of
/// one that jumps (a count) none is.
const STEPS: usize = 40;

/// Disturbances that are followed to the limit, the most promising first: of all sections, and of
/// each section alone.
const FOLLOWED: [usize; 2] = [12, 3];

/// Two campaigns.
#[derive(Debug)]
pub struct Found {
    pub by: Disturbance,
    pub inside: Sized,
    pub outside: Sized,
}

/// A campaign with a disturbance of some size.
#[derive(Debug)]
struct Point {
    size: f64,
    reach: f64,
    said: Said,
}

/// Whether it is near to the limit, and not so near that rounding decides.
fn close(point: &Point, inside: bool) -> bool {
    let distance = if inside { 1.0 - point.reach } else { point.reach - 1.0 };
    (CLOSE * ROUNDING..=CLOSE).contains(&distance)
}

/// What each disturbance does with a size of one and of minus one, made once for all limits.
#[derive(Debug)]
pub struct Search<'a> {
    bench: &'a Bench<'a>,
    needs: &'a Needs,
    base: &'a Said,
    tried: BTreeMap<String, [Option<Said>; 2]>,
}

/// A disturbance with a sign, and what it promises.
#[derive(Clone, Debug)]
struct Candidate {
    by: Disturbance,
    sign: f64,
    /// Where the limit is crossed, if the share grows as between 0 and 1.
    size: f64,
    /// The largest share of another limit there.
    others: f64,
}

impl<'a> Search<'a> {
    pub fn new(bench: &'a Bench<'a>, needs: &'a Needs, base: &'a Said) -> Self {
        Self { bench, needs, base, tried: BTreeMap::new() }
    }

    /// The pair of a limit, by its number.
    ///
    /// # Errors
    /// Why there is none.
    pub fn pair(&mut self, limit: usize) -> Result<Found, NoPair> {
        if self.base.limits[limit].reach.is_none() {
            return Err(NoPair::NotInForce);
        }
        let mut fewest: Option<Vec<String>> = None;
        let single = (0..self.bench.sections.len()).map(|section| Over::Section { section });
        for over in [Over::All, Over::Alternating].into_iter().chain(single) {
            let mut candidates = self.candidates(limit, over);
            candidates.sort_by(|a, b| a.others.total_cmp(&b.others));
            let followed = FOLLOWED[usize::from(matches!(over, Over::Section { .. }))];
            for candidate in candidates.iter().take(followed) {
                let others = match self.follow(limit, candidate) {
                    Ok(found) => return Ok(found),
                    Err(others) => others,
                };
                let fewer = fewest.as_ref().is_none_or(|fewest| others.len() < fewest.len());
                if fewer && !others.is_empty() {
                    fewest = Some(others);
                }
            }
        }
        Err(fewest.map_or(NoPair::OutOfReach, |others| NoPair::NotAlone { others }))
    }

    /// All disturbances of the columns that the quantity of a limit reads.
    fn candidates(&mut self, limit: usize, over: Over) -> Vec<Candidate> {
        let with = |(record, columns): (String, Vec<String>)| {
            let of = move |shape| {
                let (record, columns) = (record.clone(), columns.clone());
                let by = Disturbance { record, columns, shape, over };
                (format!("{by:?}"), by)
            };
            shapes().into_iter().map(of)
        };
        let all: Vec<(String, Disturbance)> =
            self.columns(limit).into_iter().flat_map(with).collect();
        let new: Vec<_> = all.iter().filter(|(key, _)| !self.tried.contains_key(key)).collect();
        let try_out = |(key, by): &&(String, Disturbance)| {
            let said = [1.0, -1.0].map(|size| self.bench.judged(by, size));
            (key.clone(), said)
        };
        let new: Vec<_> = new.par_iter().map(try_out).collect();
        self.tried.extend(new);
        let mut found = Vec::new();
        for (key, by) in &all {
            for (said, sign) in self.tried[key].iter().zip([1.0, -1.0]) {
                let promised = said.as_ref().and_then(|said| self.promised(limit, said));
                let with = |(size, others)| Candidate { by: by.clone(), sign, size, others };
                found.extend(promised.map(with));
            }
        }
        found
    }

    /// The size that crosses the limit, and the largest share of another one there, where each
    /// grows in proportion.
    fn promised(&self, limit: usize, said: &Said) -> Option<(f64, f64)> {
        let grown = |limit: usize| {
            let (from, to) = (self.base.limits[limit].reach?, said.limits[limit].reach?);
            Some((from, to - from))
        };
        let (from, growth) = grown(limit)?;
        let size = (1.0 - from) / growth;
        if !(growth > 1e-9 && size < LARGEST) {
            return None;
        }
        let at = |other: usize| grown(other).map_or(0.0, |(from, growth)| from + size * growth);
        let others = (0..self.base.limits.len()).filter(|other| *other != limit).map(at);
        Some((size, others.fold(0.0, f64::max)))
    }

    /// The columns of each channel that a limit depends on: those of one position, all together,
    /// each alone.
    fn columns(&self, limit: usize) -> Vec<(String, Vec<String>)> {
        let number = self.bench.limits[limit].quantity;
        let quantity = &self.bench.compiled.plan.quantities[number].id;
        let at = self.needs.positions[number].columns.first();
        let mut found: Vec<(String, Vec<String>)> = Vec::new();
        for records in &self.bench.records {
            let mut channels: IndexMap<&str, Vec<String>> = IndexMap::new();
            let needs = self.needs.channels.iter().filter(|need| {
                need.users.quantities.contains(quantity)
                    && need.record == records.side.in_words()
                    && self.bench.has(records.kind, &need.column)
            });
            for need in needs {
                let Some(channel) = &need.channel else { continue };
                channels.entry(channel).or_default().push(need.column.clone());
            }
            for all in channels.into_values() {
                let inside = |column: &&String| at.is_some_and(|at| at.contains(*column));
                let one: Vec<String> = all.iter().filter(inside).cloned().collect();
                let each = all.iter().map(|column| vec![column.clone()]);
                for columns in [one, all.clone()].into_iter().chain(each) {
                    let of = (records.kind.key().to_string(), columns);
                    if !of.1.is_empty() && !found.contains(&of) {
                        found.push(of);
                    }
                }
            }
        }
        // A value of one record may be compared with that of the other, too.
        let there = |column: &String| {
            self.bench.records.iter().all(|records| self.bench.has(records.kind, column))
        };
        if self.bench.records.len() > 1 {
            let both = found.iter().filter(|(_, columns)| columns.iter().all(there));
            let both: IndexSet<_> =
                both.map(|(_, columns)| (BOTH.to_string(), columns.clone())).collect();
            found.extend(both);
        }
        found
    }

    /// The pair with a disturbance.
    ///
    /// # Errors
    /// What else differs from the base at it; nothing if the limit is not crossed.
    fn follow(&self, limit: usize, candidate: &Candidate) -> Result<Found, Vec<String>> {
        let Candidate { by, sign, .. } = candidate;
        let at = |size: f64| {
            let said = self.bench.judged(by, sign * size).unwrap_or_default();
            match said.limits.get(limit).and_then(|state| state.reach) {
                Some(reach) => Ok(Point { size, reach, said }),
                // Its sections are not used: a finding says why.
                None => Err(self.new_findings(&said)),
            }
        };
        let start = self.base.limits[limit].reach.unwrap_or_default();
        let mut points = vec![Point { size: 0.0, reach: start, said: self.base.clone() }];
        let mut size = candidate.size.max(1e-6);
        loop {
            let point = at(size)?;
            let met = point.reach <= 1.0;
            points.push(point);
            if !met {
                break;
            }
            if size > LARGEST {
                return Err(Vec::new());
            }
            size *= GROWTH;
        }
        // Regula falsi, with a bisection in every third step.
        for step in 0..STEPS {
            let wanted = [-1.0, 1.0].into_iter().map(|side| 1.0 + side * CLOSE / 2.0);
            let found = |aim: &f64| points.iter().any(|point| close(point, *aim < 1.0));
            let Some(aim) = wanted.into_iter().find(|aim| !found(aim)) else { break };
            let Some(before) = points.iter().rposition(|point| point.reach < aim) else { break };
            let (low, Some(high)) = (&points[before], points.get(before + 1)) else { break };
            let part = (aim - low.reach) / (high.reach - low.reach);
            let part = match step % 3 == 2 || !part.is_finite() {
                true => 0.5,
                false => part.clamp(0.001, 0.999),
            };
            let new = at(low.size + part * (high.size - low.size))?;
            points.insert(before + 1, new);
        }
        let nearest = |inside: bool| {
            let side =
                points.iter().filter(|point| point.size > 0.0 && inside == (point.reach <= 1.0));
            let near = |point: &&Point| (point.reach - 1.0).abs();
            side.clone()
                .find(|point| close(point, inside))
                .or_else(|| side.min_by(|a, b| near(a).total_cmp(&near(b))))
        };
        let (Some(inside), Some(outside)) = (nearest(true), nearest(false)) else {
            return Err(Vec::new());
        };
        let sized = |of: &Point| Sized { size: sign * of.size, distance: 1.0 - of.reach };
        let found = Found { by: by.clone(), inside: sized(inside), outside: sized(outside) };
        let others = self.others(limit, &inside.said, &outside.said);
        if others.is_empty() { Ok(found) } else { Err(others) }
    }

    /// What differs from the base on either side, but for the limit itself.
    fn others(&self, limit: usize, inside: &Said, outside: &Said) -> Vec<String> {
        let mut others = Vec::new();
        for (number, of) in self.bench.limits.iter().enumerate() {
            let base = self.base.limits[number].holds;
            let right = match number == limit {
                true => {
                    inside.limits[number].holds == base
                        && outside.limits[number].holds == Some(false)
                }
                false => {
                    inside.limits[number].holds == base && outside.limits[number].holds == base
                }
            };
            if !right {
                others.push(of.rule.clone());
            }
        }
        for finding in [inside, outside].into_iter().flat_map(|said| self.new_findings(said)) {
            if !others.contains(&finding) {
                others.push(finding);
            }
        }
        others
    }

    fn new_findings(&self, said: &Said) -> Vec<String> {
        let new = |finding: &&String| !self.base.findings.contains(*finding);
        said.findings.iter().filter(new).cloned().collect()
    }
}
