//! Stability of an answer under resampling of the sections, stratum by stratum.
//!
//! No simulation is needed, since whitened changes are known by section.

use rayon::prelude::*;

use crate::diagnose::fit::{fitter::Fitter, set::Chosen};
use crate::diagnose::levels::{
    common::RESAMPLES,
    stability::{FIRST, NEAR},
};
use crate::diagnose::linearise::path::BySection;
use crate::effects::Gauss;

/// Results of a member over resamples of the sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// Share of the resamples in which no other effect has more evidence.
    pub first: f64,
    /// 5 % and 95 % quantiles of the size.
    pub sizes: (f64, f64),
    /// Candidates that are first in place of the member in some resamples, and their shares.
    pub instead: Vec<(usize, f64)>,
}

impl Stability {
    /// Whether another effect has more evidence in most of the resamples.
    pub fn fails(&self) -> bool {
        self.first < FIRST
    }

    /// Share of the resamples in which a candidate is first in place of the member.
    pub fn instead_of(&self, candidate: usize) -> f64 {
        self.instead.iter().find(|(other, _)| *other == candidate).map_or(0.0, |(_, share)| *share)
    }

    /// Whether a candidate is reported together with a member that fails: at least half as often
    /// first as the most frequent one.
    pub fn as_well(&self, candidate: usize) -> bool {
        let share = self.instead_of(candidate);
        let most = self.instead.iter().fold(self.first, |most, (_, share)| most.max(*share));
        self.fails() && share >= 0.5 * most
    }
}

/// Resamples one member with the others fixed: its size, and its evidence against that of its
/// rivals.
pub fn stability(
    fitter: &Fitter<'_>,
    z: &[f64],
    chosen: &Chosen,
    at: usize,
    strata: &[Vec<usize>],
    seed: u64,
) -> Stability {
    let sections = fitter.masks[0].sections.len();
    let member = &chosen.members[at];
    let rest = chosen.left_by_others(z, at);
    let effect = |candidate: usize| &fitter.candidates[candidate].effect;
    let near = fitter.all(&rest).into_iter().filter(|fit| {
        fit.evidence >= NEAR * member.evidence && effect(fit.candidate) != effect(member.candidate)
    });
    let rivals: Vec<(BySection, f64, usize)> = near
        .filter_map(|fit| {
            let by_section = fitter.by_section(&rest, fit.candidate, fit.mask)?;
            Some((by_section, fit.fall - fit.evidence, fit.candidate))
        })
        .collect();
    let own = fitter.by_section(&rest, member.candidate, member.mask);
    let price = member.fall - member.evidence;
    let one = |draw: usize| {
        let times = resample(strata, sections, seed.wrapping_add(draw as u64));
        // If none of its sections is drawn, it explains nothing and has no size.
        let (fall, size) =
            own.as_ref().and_then(|own| own.fit(&times)).unwrap_or((0.0, member.size));
        let others = rivals
            .iter()
            .filter_map(|(rival, cost, candidate)| Some((rival.fit(&times)?.0 - cost, *candidate)));
        let beaten_by =
            others.filter(|(other, _)| *other > fall - price).max_by(|a, b| a.0.total_cmp(&b.0));
        (beaten_by.map(|(_, candidate)| candidate), size)
    };
    let drawn: Vec<(Option<usize>, f64)> = (0..RESAMPLES).into_par_iter().map(one).collect();
    let share = |of: Option<usize>| {
        drawn.iter().filter(|(by, _)| *by == of).count() as f64 / drawn.len().max(1) as f64
    };
    let mut instead: Vec<(usize, f64)> = Vec::new();
    for (_, _, candidate) in &rivals {
        if instead.iter().all(|(known, _)| known != candidate) {
            instead.push((*candidate, share(Some(*candidate))));
        }
    }
    instead.retain(|(_, share)| *share > 0.0);
    let mut sizes: Vec<f64> = drawn.iter().map(|(_, size)| *size).collect();
    sizes.sort_by(f64::total_cmp);
    let quantile = |share: f64| sizes[((sizes.len() - 1) as f64 * share) as usize];
    Stability { first: share(None), sizes: (quantile(0.05), quantile(0.95)), instead }
}

/// Number of times each section is drawn, with the size of each stratum fixed.
fn resample(strata: &[Vec<usize>], sections: usize, seed: u64) -> Vec<f64> {
    let mut random = Gauss::new(seed);
    let mut times = vec![0.0; sections];
    for stratum in strata {
        for _ in stratum {
            times[stratum[random.below(stratum.len())]] += 1.0;
        }
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::levels::common::NINETY;
    use crate::diagnose::linearise::candidate::{Candidate, Node};
    use crate::diagnose::linearise::mask::Mask;
    use crate::diagnose::linearise::response::ResponseError;
    use crate::diagnose::linearise::whiten::Covariance;
    use crate::diagnose::linearise::whiten::less;

    fn candidate(effect: &str, change: Vec<f64>) -> Candidate {
        Candidate::path(
            effect,
            vec![Node { size: 0.0, change: Vec::new() }, Node { size: 10.0, change }],
        )
    }

    /// One feature in each of 20 sections that an effect changes equally: its size is the mean of
    /// the differences, whose bootstrap has the standard error sqrt(sum (x - mean)^2) / n (Efron
    /// and Tibshirani 1993, eq. 5.12) and is nearly normal.
    #[test]
    fn sizes_scatter_like_a_resampled_mean() {
        const SECTIONS: usize = 20;
        let covariance = Covariance {
            diagonal: vec![1.0; SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 1,
            response: ResponseError::default(),
        };
        let whitener = covariance.whitener();
        let z: Vec<f64> =
            (0..SECTIONS).map(|at| 5.0 + ((at * 7) % SECTIONS) as f64 * 0.1).collect();
        let mean = z.iter().sum::<f64>() / SECTIONS as f64;
        let error = z.iter().map(|x| (x - mean).powi(2)).sum::<f64>().sqrt() / SECTIONS as f64;
        // An effect in a single section is never first; a copy of the first effect is never beaten
        // either.
        let mut once = vec![0.0; SECTIONS];
        once[3] = 10.0;
        let candidates = [candidate("everywhere", vec![10.0; SECTIONS]), candidate("once", once)];
        let mask = Mask::everywhere(SECTIONS);
        let fitter = Fitter::new(&whitener, &candidates, vec![mask]);
        let member = fitter.fit(&z, 0, 0).expect("a path");
        assert!((member.size - mean).abs() < 1e-9, "{}", member.size);
        let chosen =
            Chosen { rest: less(&z, &member.whitened), members: vec![member], ..Chosen::none(&z) };
        let found = stability(&fitter, &z, &chosen, 0, &[(0..SECTIONS).collect()], 1);
        assert_eq!(found.first, 1.0);
        for (bound, away) in [(found.sizes.0, -NINETY * error), (found.sizes.1, NINETY * error)] {
            assert!((bound - mean - away).abs() < 0.25 * away.abs(), "{bound} for {}", mean + away);
        }
    }

    /// All evidence for one effect is in one section, 25 per draw; the other effect has 1.75 in
    /// each of the other 19. The first one has more where its section is drawn at least twice: 1 -
    /// 0.95^20 - 20 * 0.05 * 0.95^19 = 0.264 of the resamples (binomial).
    #[test]
    fn an_effect_that_one_section_carries_is_not_told_from_one_that_all_others_show() {
        const SECTIONS: usize = 20;
        let covariance = Covariance {
            diagonal: vec![1.0; SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 1,
            response: ResponseError::default(),
        };
        let whitener = covariance.whitener();
        let (mut once, mut others) = (vec![0.0; SECTIONS], vec![10.0; SECTIONS]);
        (once[3], others[3]) = (10.0, 0.0);
        let z: Vec<f64> =
            (0..SECTIONS).map(|at| if at == 3 { 5.0 } else { 1.75_f64.sqrt() }).collect();
        let candidates = [candidate("once", once), candidate("others", others)];
        let mask = Mask::everywhere(SECTIONS);
        let fitter = Fitter::new(&whitener, &candidates, vec![mask]);
        let of = |candidate: usize| {
            let member = fitter.fit(&z, candidate, 0).expect("a path");
            let chosen = Chosen {
                rest: less(&z, &member.whitened),
                members: vec![member],
                ..Chosen::none(&z)
            };
            stability(&fitter, &z, &chosen, 0, &[(0..SECTIONS).collect()], 1)
        };
        let (once, others) = (of(0), of(1));
        let (wanted, error) = (0.264, (0.264 * 0.736 / RESAMPLES as f64).sqrt());
        assert!((once.first - wanted).abs() < 3.0 * error, "{once:?}");
        assert!(
            once.fails()
                && once.as_well(1)
                && (once.instead_of(1) + once.first - 1.0).abs() < 1e-12,
            "{once:?}"
        );
        assert!(
            !others.fails()
                && !others.as_well(0)
                && (others.instead_of(0) - once.first).abs() < 1e-12,
            "{others:?}"
        );
    }
}
