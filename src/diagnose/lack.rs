//! What a set of causes leaves beyond what is allowed for.

use super::candidates::Candidate;
use super::features::Kind;
use super::fit::{Fitter, Mask, less};
use super::guards::{View, part};
use super::observe::Observations;
use super::search::{Chosen, Refused, refit};
use super::whiten::Covariance;

/// Lack of fit, in standard deviations of chi-squared of a channel, beyond which something is not explained.
pub const LACK: f64 = 5.0;

/// With a member the excess of the channels may be this share of what it was without it, at the most: some effects show elsewhere.
const WORSE: f64 = 1.1;
/// And this much more of chi-squared, which is nothing beside some thousand features.
const LITTLE: f64 = 10.0;

/// Of the change that an effect makes, what the model that makes it is wrong by, feature by feature.
const WRONG: f64 = 0.2;

impl Covariance {
    /// With room for what is wrong in changes that are taken off.
    #[must_use]
    pub fn allowing<'a>(&self, changes: impl Iterator<Item = &'a Vec<f64>>) -> Self {
        let mut wider = self.clone();
        for change in changes {
            wider.diagonal.iter_mut().zip(change).for_each(|(variance, change)| *variance += (WRONG * change).powi(2));
        }
        wider
    }
}

/// How far what is left goes beyond what is allowed for, channel by channel and kind by kind: standard deviations of chi-squared.
#[must_use]
pub fn lack_of_fit(covariance: &Covariance, seen: &Observations, rest: &[f64]) -> Vec<(String, Kind, f64, f64)> {
    use rayon::prelude::*;
    let all: Vec<usize> = seen.first_runs();
    let mut views = Vec::new();
    for (channel, of) in seen.layout.channels.iter().enumerate() {
        for level in [true, false] {
            let keep = |kind: Kind| (kind == Kind::Level) == level;
            let features: Vec<usize> =
                seen.features.iter().enumerate().filter(|(_, f)| f.channel == channel && keep(f.kind)).map(|(at, _)| at).collect();
            if !features.is_empty() {
                let kind = if level { Kind::Level } else { Kind::Band(0) };
                views.push((of.name.clone(), kind, View { says: String::new(), sections: all.clone(), features }));
            }
        }
    }
    let each = |(name, kind, view): (String, Kind, View)| {
        let rest = part(rest, covariance.size, &view);
        let n = rest.len() as f64;
        let (chi, _) = covariance.part(&view.sections, &view.features).products().of(&rest, &rest, false)[0];
        (name, kind, (chi - n) / (2.0 * n).sqrt(), chi - n)
    };
    views.into_par_iter().map(each).collect()
}

/// What is beyond what is allowed for, over all channels.
pub fn excess(lack: &[(String, Kind, f64, f64)]) -> f64 {
    lack.iter().map(|(.., excess)| excess.max(0.0)).sum()
}

/// What is left of the excess, and whether that is too much to call the gap explained: more than half of it, in more than one kind of
/// one channel or far beyond. One among some forty may be a little beyond without anything being missing.
#[must_use]
pub fn unexplained(before: &[(String, Kind, f64, f64)], after: &[(String, Kind, f64, f64)]) -> (f64, bool) {
    let (gap, rest) = (excess(before), excess(after));
    let share = if gap > 0.0 { (rest / gap).clamp(0.0, 1.0) } else { 0.0 };
    let beyond: Vec<f64> = after.iter().map(|(_, _, sigma, _)| *sigma).filter(|sigma| *sigma > LACK).collect();
    (share, share > 0.5 && (beyond.len() > 1 || beyond.iter().any(|sigma| *sigma > 3.0 * LACK)))
}

/// A member that makes channels go further beyond what is allowed for is no cause. Gives what is left.
pub fn drop_what_harms(
    fitter: &Fitter<'_>,
    (covariance, seen): (&Covariance, &Observations),
    (difference, z): (&[f64], &[f64]),
    chosen: &mut Chosen,
    refused: &mut Vec<Refused>,
    before: &[(String, Kind, f64, f64)],
) -> Vec<(String, Kind, f64, f64)> {
    loop {
        let lack = |chosen: &Chosen| lack_after(covariance, seen, (fitter.candidates, &fitter.masks), difference, chosen);
        let now = lack(chosen);
        let Some(last) = chosen.members.len().checked_sub(1) else { return now };
        let mut without = chosen.clone();
        without.members.remove(last);
        refit(fitter, z, &mut without, 4);
        let then = if without.members.is_empty() { before.to_vec() } else { lack(&without) };
        if excess(&now) <= WORSE * excess(&then) + LITTLE {
            return now;
        }
        let reason = format!("what channels show beyond what is allowed for grows from {:.0} to {:.0}", excess(&then), excess(&now));
        refused.push(Refused { fitted: chosen.members[last].clone(), reason });
        *chosen = without;
    }
}

/// What the members leave of the difference, in the features' own units.
#[must_use]
pub fn left(candidates: &[Candidate], masks: &[Mask], difference: &[f64], chosen: &Chosen) -> Vec<f64> {
    chosen.members.iter().fold(difference.to_vec(), |rest, member| less(&rest, &member.change(candidates, masks)))
}

/// Where what the members leave is more than is allowed for.
#[must_use]
pub fn lack_after(
    covariance: &Covariance,
    seen: &Observations,
    (candidates, masks): (&[Candidate], &[Mask]),
    difference: &[f64],
    chosen: &Chosen,
) -> Vec<(String, Kind, f64, f64)> {
    let changes: Vec<Vec<f64>> = chosen.members.iter().map(|member| member.change(candidates, masks)).collect();
    let rest = changes.iter().fold(difference.to_vec(), |rest, change| less(&rest, change));
    lack_of_fit(&covariance.allowing(changes.iter()), seen, &rest)
}
