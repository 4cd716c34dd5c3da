//! Gauss-Newton: search, then responses and tolerances again at the fitted point, until names and
//! sizes stand still.

pub mod point;

use std::sync::Arc;

use crate::diagnose::fit::{
    fitter::{Fitted, Fitter, Known, Member},
    set::{Bars, Chosen, Refused, plausible},
};
use crate::diagnose::iterate::point::{Linearisation, Linearise};
use crate::diagnose::levels::{
    iterate::{FLOOR, FLOOR_EXACT, NEAR, NEAREST, POLISHED, REFUSED, ROUNDS, STILL, WORTH},
    search::{TOLERANCE_SD, TRIED},
};
use crate::diagnose::linearise::candidate::Candidate;
use crate::diagnose::observe::bench::Runs;
use crate::diagnose::search::{
    Far, Fault, Search,
    calibration::{Draws, limit},
};
use crate::result::diagnosis::Calibration;

/// What the iteration needs.
#[allow(missing_debug_implementations)]
pub struct Iterate<'a> {
    pub linearise: &'a Linearise<'a>,
    pub far: Far<'a>,
    /// Share of the campaigns with nothing hidden in which an effect may reach the required
    /// evidence.
    pub false_name_rate: f64,
    pub seed: u64,
}

/// Its result.
#[allow(missing_debug_implementations)]
pub struct Iterated {
    /// The linearisation without effects, and the one at the answer.
    pub alone: Arc<Linearisation>,
    pub fitted: Arc<Linearisation>,
    pub chosen: Chosen,
    pub refused: Vec<Refused>,
    pub bars: Bars,
    /// Share of drawn campaigns with nothing hidden in which a cause has enough evidence.
    pub false_name_rate: f64,
    pub calibration: Calibration,
    /// Whether names and sizes stand still.
    pub still: bool,
}

/// The search without effects, and what is kept of it.
struct First {
    alone: Arc<Linearisation>,
    known: Known,
    bars: Bars,
    chosen: Chosen,
    near: Vec<Fitted>,
}

impl Iterate<'_> {
    /// From the linearisation without effects to the answer.
    pub fn run(&self, alone: Linearisation, runs: &mut Runs) -> Iterated {
        let First { alone, known, bars, chosen, near } = self.first(alone, runs);
        let masks = self.linearise.masks.to_vec();
        (self.linearise.workshop.trying)("calibration on drawn campaigns");
        let nominal = Fitter::knowing(&alone.whitener, &alone.candidates, masks, known);
        let draws = Draws { fitter: &nominal, bars: &bars, far: self.far, seed: self.seed };
        let (false_name_rate, calibration) = (draws.falsely_named(), draws.calibrate());
        let mut now = Iterated {
            alone: alone.clone(),
            fitted: alone.clone(),
            chosen,
            refused: Vec::new(),
            bars,
            false_name_rate,
            calibration,
            still: false,
        };
        let (mut near, mut before): (Vec<Fitted>, Vec<Member>) = (near, Vec::new());
        // A round that rejects a member is not counted: the member does not come back.
        let mut rounds = 0;
        while rounds < ROUNDS && now.refused.len() < REFUSED {
            let mut set = now.chosen.set();
            set.sort_unstable();
            let again = (set == before).then(|| now.fitted.clone());
            before = set;
            let from = (&*alone, again.as_deref());
            let next = self.linearise.at(from, &all(&now.chosen), &near, runs);
            let Some(mut next) = next else {
                now.still = true;
                break;
            };
            let barred = barred(&now.refused);
            let start = now.chosen.set();
            let (chosen, further) = self.search(&mut next, (&start, &barred), &bars, runs);
            let gone = self.gone(&next, &now.chosen, &chosen, &bars);
            let stands = |errors| {
                gone.is_empty() && stand_still(&now.chosen.members, &chosen.members, errors)
            };
            // What moves by less than its error still moves, and is followed while rounds are left,
            // as are members that are not named.
            let mut set = chosen.set();
            set.sort_unstable();
            let (exactly, within_errors) = (stands(0.0) && set == before, stands(1.0));
            now.still = within_errors;
            rounds += usize::from(gone.is_empty());
            now.refused.extend(gone);
            (now.fitted, now.chosen, near) = (Arc::new(next), chosen, further);
            if exactly {
                break;
            }
            if now.chosen.set().is_empty() {
                let refused = self::barred(&now.refused);
                let search = Search::new(&nominal, &alone.z, &bars, self.far);
                now.chosen = search.chosen(&search.run(&[], &refused));
                now.fitted = alone.clone();
                before.clear();
            }
        }
        now
    }

    /// Searches without effects until no relevant candidate has sizes left to simulate.
    fn first(&self, mut alone: Linearisation, runs: &mut Runs) -> First {
        let (masks, workshop) = (self.linearise.masks, self.linearise.workshop);
        let (mut known, mut chance) = (Known::new(), None);
        loop {
            (workshop.trying)("search");
            let fitter = Fitter::knowing(&alone.whitener, &alone.candidates, masks.to_vec(), known);
            let limit =
                *chance.get_or_insert_with(|| limit(&fitter, self.seed, self.false_name_rate));
            let bars = Bars { first: limit.max(FLOOR), exact: limit.max(FLOOR_EXACT) };
            let search = Search::new(&fitter, &alone.z, &bars, self.far);
            let set = search.run(&[], &[]);
            let chosen = search.chosen(&set);
            let near = self.near(&search, &set, &[]);
            let wanted = promising(&fitter, &alone.z, &chosen);
            known = fitter.whitened;
            let refined = !wanted.is_empty();
            for (at, size) in wanted {
                workshop.refine(&mut alone.candidates[at], size, runs);
            }
            let polished = self.linearise.polish(&mut alone.candidates, &all(&chosen), runs);
            if !refined && !polished {
                return First { alone: Arc::new(alone), known, bars, chosen, near };
            }
        }
    }

    /// Searches from a set at a point, with the fitted sizes simulated: the answer there, and the
    /// nearest further candidates.
    fn search(
        &self,
        at: &mut Linearisation,
        (start, barred): (&[Member], &[usize]),
        bars: &Bars,
        runs: &mut Runs,
    ) -> (Chosen, Vec<Fitted>) {
        let mut start = start.to_vec();
        for round in 0.. {
            let masks = self.linearise.masks.to_vec();
            let fitter = Fitter::new(&at.whitener, &at.candidates, masks);
            let search = Search::new(&fitter, &at.z, bars, self.far);
            start = search.run(&start, barred);
            let chosen = search.chosen(&start);
            let near = self.near(&search, &start, barred);
            drop(search);
            drop(fitter);
            let last = round == POLISHED;
            if last || !self.linearise.polish(&mut at.candidates, &all(&chosen), runs) {
                return (chosen, near);
            }
        }
        unreachable!("the last round returns")
    }

    /// The candidates nearest to being named beside a set.
    fn near(&self, search: &Search<'_>, set: &[Member], barred: &[usize]) -> Vec<Fitted> {
        if set.is_empty() {
            return Vec::new();
        }
        let mut near = search.further(set, barred, TRIED);
        near.retain(|fit| {
            let of = &search.fitter.candidates[fit.candidate];
            let far = (self.far)(of, fit.size) >= 0.5 * TOLERANCE_SD;
            fit.evidence >= WORTH && far && plausible(of, fit.size)
        });
        near.truncate(NEAREST);
        near
    }

    /// The members that are not named any more at their own point, and why.
    fn gone(
        &self,
        at: &Linearisation,
        before: &Chosen,
        after: &Chosen,
        bars: &Bars,
    ) -> Vec<Refused> {
        let kept = |member: &&Fitted| after.all().all(|other| other.candidate != member.candidate);
        let gone: Vec<&Fitted> = before.members.iter().filter(kept).collect();
        if gone.is_empty() {
            return Vec::new();
        }
        let masks = self.linearise.masks.to_vec();
        let fitter = Fitter::of(&at.whitener, &at.candidates, masks, &all(before));
        let search = Search::new(&fitter, &at.z, bars, self.far);
        let set = before.set();
        let reason = |member: &Fitted| {
            let place = set.iter().position(|one| *one == (member.candidate, member.mask));
            match place.and_then(|place| search.fault(&set, place)) {
                Some(Fault::Evidence(evidence, needed)) => {
                    format!("it has an evidence of {evidence:.0}; {needed:.0} are required")
                }
                Some(Fault::Range) => "it requires an implausible value".into(),
                Some(Fault::Confinement) | None => "another effect has more evidence".into(),
            }
        };
        gone.into_iter()
            .map(|member| Refused {
                reason: format!(
                    "with responses and tolerances at the fitted point, {}",
                    reason(member)
                ),
                fitted: member.clone(),
            })
            .collect()
    }
}

/// Whether the same effects are named with about the same sizes: within a tenth, or within so many
/// standard errors.
fn stand_still(before: &[Fitted], after: &[Fitted], errors: f64) -> bool {
    let alike = |a: &Fitted, b: &Fitted| {
        let within = (STILL * a.size.abs().max(b.size.abs())).max(errors * b.error());
        (a.candidate, a.mask) == (b.candidate, b.mask) && (a.size - b.size).abs() <= within
    };
    before.len() == after.len() && after.iter().all(|b| before.iter().any(|a| alike(a, b)))
}

/// All that is fitted.
fn all(chosen: &Chosen) -> Vec<Fitted> {
    chosen.all().cloned().collect()
}

fn barred(refused: &[Refused]) -> Vec<usize> {
    refused.iter().map(|refused| refused.fitted.candidate).collect()
}

/// Candidates whose remaining sizes are simulated, and on which side: the members, and those close
/// to the best for the whole difference or for the residual.
fn promising(fitter: &Fitter<'_>, z: &[f64], chosen: &Chosen) -> Vec<(usize, f64)> {
    let candidate = |fit: &Fitted| -> &Candidate { &fitter.candidates[fit.candidate] };
    let pending = |fit: &&Fitted| candidate(fit).pending_towards(fit.size);
    let towards = |fit: &Fitted| (fit.candidate, fit.size);
    let mut found: Vec<(usize, f64)> = chosen.all().filter(pending).map(towards).collect();
    for rest in [z.to_vec(), chosen.weighed()] {
        let fits = fitter.all(&rest);
        let best = fits.iter().map(|fit| fit.evidence).fold(0.0, f64::max);
        let near = |fit: &&Fitted| fit.evidence >= (NEAR * best).max(WORTH) && pending(fit);
        found.extend(fits.iter().filter(near).map(towards));
    }
    // In the order of the catalogue; a second request for the same side has nothing to simulate.
    found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    found
}
