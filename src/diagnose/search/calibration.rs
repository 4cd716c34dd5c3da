//! Calibration on the campaign itself: the search on campaigns drawn with a known cause.
//!
//! A drawn campaign is a random difference from the covariance, plus the changes of hidden effects,
//! which were simulated before: nothing is simulated again. The same search over sets names effects
//! in it. What it gets right shows what this campaign can show.

use rayon::prelude::*;

use crate::diagnose::fit::{
    fitter::{Fitted, Fitter},
    set::{Bars, plausible},
};
use crate::diagnose::levels::{
    calibration::{NAMED, NOTHING_HIDDEN, OUTSIDE, PAIRS, SINGLES, TRIES},
    common::NINETY,
    search::TOLERANCE_SD,
};
use crate::diagnose::linearise::whiten::plus;
use crate::diagnose::search::{Far, Search};
use crate::effects::Gauss;
use crate::result::diagnosis::{Calibration, Share};

/// Campaigns drawn on the basis of this one.
#[allow(missing_debug_implementations)]
pub struct Draws<'a> {
    pub fitter: &'a Fitter<'a>,
    pub bars: &'a Bars,
    pub far: Far<'a>,
    pub seed: u64,
}

/// What is hidden in a drawn campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hidden {
    One,
    Two,
    /// An effect that the search does not know.
    Outside,
}

/// One drawn campaign.
#[derive(Clone, Debug)]
struct Drawn {
    hidden: Hidden,
    /// Length of the change of all hidden effects, in standard deviations.
    length: f64,
    /// Of the hidden effects, how many are named.
    right: usize,
    /// How many others are named.
    wrong: usize,
    /// For each named hidden effect with a size, whether its 90 % interval contains the hidden one.
    inside: Vec<bool>,
}

/// A random whitened difference: independent, of unit variance.
fn noise(fitter: &Fitter<'_>, seed: u64, draw: usize) -> Vec<f64> {
    let mut random = Gauss::new(seed ^ (draw as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    (0..fitter.whitener.features()).map(|_| random.next()).collect()
}

/// Evidence that the best candidate exceeds in this share of the campaigns with nothing hidden.
pub fn limit(fitter: &Fitter<'_>, seed: u64, share: f64) -> f64 {
    let mut most: Vec<f64> = (0..NOTHING_HIDDEN)
        .into_par_iter()
        .map(|draw| fitter.most(&noise(fitter, seed, draw)))
        .collect();
    most.sort_by(f64::total_cmp);
    let rank = ((1.0 - share) * NOTHING_HIDDEN as f64).floor() as usize;
    most[rank.min(NOTHING_HIDDEN - 1)]
}

impl Draws<'_> {
    /// Share of campaigns with nothing hidden in which some candidate meets the criteria of a first
    /// member.
    pub fn falsely_named(&self) -> f64 {
        let (fitter, bars) = (self.fitter, self.bars);
        let named = |draw: &usize| {
            let z = noise(fitter, self.seed.wrapping_add(1), *draw);
            let fits = fitter.all(&z).into_iter();
            let strong: Vec<Fitted> = fits
                .filter(|fit| fit.evidence >= bars.least(&fitter.candidates[fit.candidate]))
                .collect();
            let search = Search::new(fitter, &z, bars, self.far);
            let named = |fit: &Fitted| {
                search.fault(&[(fit.candidate, fit.mask)], 0).is_none() && search.is_named(fit)
            };
            strong.iter().any(named)
        };
        (0..NOTHING_HIDDEN).into_par_iter().filter(named).count() as f64 / NOTHING_HIDDEN as f64
    }

    /// Searches campaigns with a single effect, with two, and with an effect that the search does
    /// not know.
    pub fn calibrate(&self) -> Calibration {
        let cases: Vec<Hidden> =
            [(Hidden::One, SINGLES), (Hidden::Two, PAIRS), (Hidden::Outside, OUTSIDE)]
                .into_iter()
                .flat_map(|(of, n)| vec![of; n])
                .collect();
        let drawn: Vec<Drawn> = cases
            .into_par_iter()
            .enumerate()
            .filter_map(|(at, hidden)| self.one(at, hidden))
            .collect();
        let of = |hidden: Hidden| drawn.iter().filter(move |drawn| drawn.hidden == hidden);
        let share = |hidden: Hidden, right: fn(&Drawn) -> bool| Share {
            count: of(hidden).filter(|one| right(one)).count(),
            of: of(hidden).count(),
        };
        let inside: Vec<bool> =
            drawn.iter().flat_map(|drawn| drawn.inside.iter().copied()).collect();
        let singles: Vec<(f64, bool)> =
            of(Hidden::One).map(|one| (one.length, one.right == 1 && one.wrong == 0)).collect();
        let named: Vec<&Drawn> = drawn
            .iter()
            .filter(|one| one.hidden != Hidden::Outside && one.right + one.wrong > 0)
            .collect();
        Calibration {
            single: share(Hidden::One, |one| one.right == 1 && one.wrong == 0),
            pair: share(Hidden::Two, |one| one.right == 2 && one.wrong == 0),
            outside: share(Hidden::Outside, |one| one.wrong > 0),
            further: Share {
                count: named.iter().filter(|one| one.wrong > 0).count(),
                of: named.len(),
            },
            intervals: Share {
                count: inside.iter().filter(|inside| **inside).count(),
                of: inside.len(),
            },
            length: length_named(singles, NAMED),
        }
    }

    fn one(&self, at: usize, hidden: Hidden) -> Option<Drawn> {
        let mut random =
            Gauss::new(self.seed.wrapping_add(2) ^ (at as u64).wrapping_mul(0xD134_2543_DE82_EF95));
        let first = self.effect(&mut random, &[])?;
        let mut members = vec![first];
        if hidden == Hidden::Two {
            members.push(self.effect(&mut random, &members)?);
        }
        let changes: Vec<Vec<f64>> =
            members.iter().map(|member| self.change(member, &mut random)).collect();
        let change = changes
            .iter()
            .fold(vec![0.0; self.fitter.whitener.features()], |sum, change| plus(&sum, change));
        let length = change.iter().map(|x| x * x).sum::<f64>().sqrt();
        let z = plus(&noise(self.fitter, self.seed.wrapping_add(3), at), &change);
        let candidates = self.fitter.candidates;
        let known = |member: &Fitted| &candidates[member.candidate];
        let barred = match hidden {
            Hidden::Outside => (0..candidates.len())
                .filter(|other| candidates[*other].effect == known(&members[0]).effect)
                .collect(),
            _ => Vec::new(),
        };
        let search = Search::new(self.fitter, &z, self.bars, self.far);
        let found = search.chosen(&search.run(&[], &barred));
        let is_hidden =
            |named: &Fitted| members.iter().find(|member| known(member).is_like(known(named)));
        let right = found.members.iter().filter(|named| is_hidden(named).is_some()).count();
        let inside = |named: &Fitted| {
            let truth = is_hidden(named).filter(|truth| known(truth).size == known(named).size)?;
            let error =
                named.error().hypot(named.common_error(candidates, self.fitter.whitener.common()));
            (!known(named).discrete && named.size.is_finite())
                .then(|| (truth.size - named.size).abs() <= NINETY * error)
        };
        let inside = found.members.iter().filter_map(inside).collect();
        Some(Drawn { hidden, length, right, wrong: found.members.len() - right, inside })
    }

    /// A random effect with a size that may be named, in all sections. Nothing if a number of tries
    /// gives none.
    fn effect(&self, random: &mut Gauss, beside: &[Fitted]) -> Option<Fitted> {
        let candidates = self.fitter.candidates;
        if candidates.is_empty() {
            return None;
        }
        (0..TRIES).find_map(|_| {
            let at = random.below(candidates.len());
            let of = &candidates[at];
            let segment =
                random.below(of.nodes.len().checked_sub(1).filter(|segments| *segments > 0)?);
            let share = if of.discrete {
                if of.nodes[segment].change.is_empty() { 1.0 } else { 0.0 }
            } else {
                random.uniform()
            };
            let fit = self.fitter.at((at, 0), (segment, share));
            let other = beside.iter().all(|known| candidates[known.candidate].effect != of.effect);
            let may = plausible(of, fit.size) && (self.far)(of, fit.size) >= TOLERANCE_SD;
            (other && may && fit.whitened.iter().any(|x| *x != 0.0)).then_some(fit)
        })
    }

    /// The whitened change of an effect with a random error of the response.
    fn change(&self, member: &Fitted, random: &mut Gauss) -> Vec<f64> {
        let columns = self
            .fitter
            .model_error((member.candidate, member.mask), (member.segment, member.share));
        let exact = self.fitter.candidates[member.candidate].exact;
        let common = if exact { 0.0 } else { self.fitter.whitener.common() * random.next() };
        let mut change: Vec<f64> =
            member.whitened.iter().map(|change| (1.0 + common) * change).collect();
        for column in columns.column_iter() {
            let times = random.next();
            change
                .iter_mut()
                .zip(column.iter())
                .for_each(|(change, error)| *change += times * error);
        }
        change
    }
}

/// The length from which on a share of the single effects is named: isotonic regression of the
/// outcomes by length, by pooling adjacent violators (Ayer et al. 1955). Nothing if no length
/// reaches the share.
fn length_named(mut outcomes: Vec<(f64, bool)>, share: f64) -> Option<f64> {
    outcomes.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Pools: the least length, right ones, all.
    let mut pools: Vec<(f64, usize, usize)> = Vec::new();
    for (length, right) in outcomes {
        pools.push((length, usize::from(right), 1));
        while let [.., (_, right, all), (_, more_right, more)] = pools[..]
            && right * more >= more_right * all
            && pools.len() > 1
        {
            let last = pools.pop()?;
            let pool = pools.last_mut()?;
            (pool.1, pool.2) = (pool.1 + last.1, pool.2 + last.2);
        }
    }
    pools
        .into_iter()
        .find(|(_, right, all)| *right as f64 >= share * *all as f64)
        .map(|(length, ..)| length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::candidate::{Candidate, Node};
    use crate::diagnose::linearise::mask::Mask;
    use crate::diagnose::linearise::response::ResponseError;
    use crate::diagnose::linearise::whiten::Covariance;

    /// Outcomes 0 0 1 0 1 1 1 1 1 1 1 1: the third and fourth violate the order and pool to 0.5,
    /// from the fifth on all are named.
    #[test]
    fn the_least_length_is_that_from_which_on_the_share_is_named() {
        let outcomes = |named: &[u8]| {
            named.iter().enumerate().map(|(at, named)| (at as f64, *named == 1)).collect::<Vec<_>>()
        };
        assert_eq!(length_named(outcomes(&[0, 0, 1, 0, 1, 1, 1, 1]), 0.9), Some(4.0));
        assert_eq!(length_named(outcomes(&[0, 0, 1, 0, 1, 1, 1, 1]), 0.5), Some(2.0));
        assert_eq!(length_named(outcomes(&[1, 0, 1, 0]), 0.9), None);
        assert_eq!(length_named(outcomes(&[1, 1]), 0.9), Some(0.0));
        assert_eq!(length_named(Vec::new(), 0.9), None);
    }

    /// Three effects, each on a feature of its own in ten sections of unit variance, up to 10 per
    /// section: the length of a change is 10^1/2 times its size, the evidence its square less the
    /// price 2 ln (31.6 / (2 pi)^1/2) = 5.07. 30 are reached at a length of 35.07^1/2 = 5.9. A
    /// response without error is fitted with an error of 1 / 10^1/2, so that nine of ten intervals
    /// contain the size, and an effect that the search does not know has none to be mistaken for.
    #[test]
    fn drawn_campaigns_show_what_can_be_named() {
        const SECTIONS: usize = 10;
        let path = |effect: &str, feature: usize| {
            let change =
                (0..3 * SECTIONS).map(|at| if at % 3 == feature { 10.0 } else { 0.0 }).collect();
            Candidate::path(
                effect,
                vec![Node { size: 0.0, change: Vec::new() }, Node { size: 10.0, change }],
            )
        };
        let candidates = [path("one", 0), path("two", 1), path("three", 2)];
        let covariance = Covariance {
            diagonal: vec![1.0; 3 * SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 3,
            response: ResponseError::default(),
        };
        let whitener = covariance.whitener();
        let everywhere = Mask::everywhere(SECTIONS);
        let fitter = Fitter::new(&whitener, &candidates, vec![everywhere]);
        let bars = Bars { first: 30.0, exact: 30.0 };
        let draws = Draws { fitter: &fitter, bars: &bars, far: &|_, _| f64::INFINITY, seed: 1 };
        let of = draws.calibrate();
        assert_eq!((of.outside.count, of.further.count), (0, 0), "{of:?}");
        assert!(
            of.single.of == SINGLES && of.pair.of == PAIRS && of.outside.of == OUTSIDE,
            "{of:?}"
        );
        let length = of.length.expect("large ones are named");
        assert!((5.0..7.5).contains(&length), "{of:?}");
        // A uniform size is below the length 5.9 in 0.19 of the draws: two standard errors are 0.1.
        let share = of.single.count as f64 / of.single.of as f64;
        assert!((share - 0.81).abs() < 0.1, "{of:?}");
        let inside = of.intervals.count as f64 / of.intervals.of as f64;
        assert!((0.83..=0.97).contains(&inside), "{of:?}");
        assert_eq!(draws.falsely_named(), 0.0);
        // Chance reaches more than the 4 % limit in 4 % of the draws: a chi-squared of one degree
        // above 5.07 plus the limit.
        assert!(limit(&fitter, 1, 0.04) < 5.0);
        // Without effects there is nothing to draw.
        let none = Fitter::new(&whitener, &[], Vec::new());
        let of = Draws { fitter: &none, ..draws }.calibrate();
        assert!(of.single.of == 0 && of.length.is_none(), "{of:?}");
    }
}
