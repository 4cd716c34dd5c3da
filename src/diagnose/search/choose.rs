//! Forward selection of a set of effects.

use super::candidates::Candidate;
use super::fit::{Fitted, Fitter};
use crate::diagnose::allowed::whiten::{dot, less, plus};

/// Declared standard deviations from which an effect on a tolerated parameter is named: the declared value is itself an estimate.
pub const TOLERANCE_SD: f64 = 3.5;

/// Criteria for a member.
#[derive(Clone, Copy, Debug)]
pub struct Bars {
    /// Least evidence of a member.
    pub first: f64,
    /// The same for an operation on the signals, which has no model error.
    pub exact: f64,
    /// Additional evidence required of a confinement.
    pub confined: f64,
    /// Least distance from neutral of an effect on a tolerated parameter, in declared standard deviations.
    pub tolerance_sd: f64,
    /// Least fall of chi-squared of a further member, as a share of that of the strongest simulated member.
    pub share: f64,
    pub most: usize,
}

impl Bars {
    /// Least evidence of a candidate.
    #[must_use]
    pub fn least(&self, candidate: &Candidate) -> f64 {
        if candidate.exact { self.exact } else { self.first }
    }
}

/// A set of effects and the residual.
#[derive(Clone, Debug)]
pub struct Chosen {
    pub members: Vec<Fitted>,
    /// The whitened residual.
    pub rest: Vec<f64>,
}

/// Result of a guard for a fit as a further member.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Judged {
    Sound,
    /// It must also reduce the gap in cross-validation.
    Doubtful,
    /// Views of the data give contradictory sizes.
    Contradicted(String),
    Refused(String),
}

impl Judged {
    /// The fit with the reason why it was refused; nothing if it was not.
    fn refused(self, fitted: Fitted) -> Option<Refused> {
        let contradicted = matches!(self, Self::Contradicted(_));
        match self {
            Self::Refused(reason) | Self::Contradicted(reason) => Some(Refused { fitted, reason, contradicted }),
            Self::Sound | Self::Doubtful => None,
        }
    }
}

/// Judges a fit as a further member.
pub type Guard<'a> = &'a (dyn Fn(&Fitted, &Chosen) -> Judged + Sync);

/// A refused fit with the reason.
#[derive(Clone, Debug)]
pub struct Refused {
    pub fitted: Fitted,
    pub reason: String,
    /// Whether views contradict each other.
    pub contradicted: bool,
}

impl Refused {
    #[must_use]
    pub fn new(fitted: Fitted, reason: impl Into<String>) -> Self {
        Self { fitted, reason: reason.into(), contradicted: false }
    }
}

impl Chosen {
    /// The empty set.
    #[must_use]
    pub fn none(z: &[f64]) -> Self {
        Self { members: Vec::new(), rest: z.to_vec() }
    }

    /// Evidence of the set: the fall of chi-squared with all members together, less the penalty of each. Members that are alike explain
    /// little given the others, but much together.
    #[must_use]
    pub fn evidence(&self) -> f64 {
        let whole = self.members.iter().fold(self.rest.clone(), |sum, member| plus(&sum, &member.whitened));
        let penalties: f64 = self.members.iter().map(|member| member.fall - member.evidence).sum();
        chi_squared(&whole) - chi_squared(&self.rest) - penalties
    }

    /// The whitened difference less the changes of all members but one.
    #[must_use]
    pub fn left_by_others(&self, z: &[f64], at: usize) -> Vec<f64> {
        let others = self.members.iter().enumerate().filter(|(other, _)| *other != at);
        others.fold(z.to_vec(), |rest, (_, other)| less(&rest, &other.whitened))
    }
}

/// Searches for further members of `chosen`, without the candidates that are `barred`. `z` is the whitened difference. `far` gives the
/// distance of a size from neutral in declared standard deviations. `channels` gives the channel of each feature of a section.
pub fn search(
    fitter: &Fitter<'_>,
    z: &[f64],
    (mut chosen, mut barred): (Chosen, Vec<usize>),
    (bars, channels): (&Bars, &[usize]),
    far: &(dyn Fn(&Candidate, f64) -> f64 + Sync),
    guard: Guard<'_>,
    refused: &mut Vec<Refused>,
) -> Chosen {
    while chosen.members.len() < bars.most {
        let alone = chosen.members.is_empty();
        let bar = |fit: &Fitted| bars.least(&fitter.candidates[fit.candidate]);
        let mut fits = fitter.all(&chosen.rest);
        fits.iter_mut().for_each(|fit| unconfine(fitter, &chosen.rest, fit, bars));
        if !alone {
            fits = together(fitter, z, &chosen, fits);
        }
        fits.retain(|fit| fit.evidence >= bar(fit) && !barred.contains(&fit.candidate) && !taken(fitter, &chosen, fit));
        fits.retain(|fit| far(&fitter.candidates[fit.candidate], fit.size) >= bars.tolerance_sd + fitter.masks[fit.mask].picked());
        fits.retain(|fit| plausible(&fitter.candidates[fit.candidate], fit.size));
        // A confinement to sections selected from the data needs twice the evidence.
        fits.retain(|fit| fitter.masks[fit.mask].asked_by.is_none() || fit.evidence >= 2.0 * bar(fit));
        // The model error of a simulated change, in the channels that it changes, may resemble another effect. Operations on the signals
        // have no such error.
        let simulated = chosen.members.iter().filter(|member| !fitter.candidates[member.candidate].exact);
        let wrong = |fit: &Fitted, member: &Fitted| bars.share * member.fall * in_common(channels, &fit.whitened, &member.whitened);
        fits.retain(|fit| simulated.clone().all(|member| fit.fall >= wrong(fit, member)));
        fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let Some(mut best) = fits.into_iter().next() else { break };
        let mut others = with(fitter, z, &chosen, best.clone());
        others.rest = others.left_by_others(z, chosen.members.len());
        others.members.pop();
        match guard(&best, &others) {
            Judged::Sound => {}
            Judged::Doubtful => best.doubtful = true,
            judged @ (Judged::Refused(_) | Judged::Contradicted(_)) => {
                barred.push(best.candidate);
                refused.extend(judged.refused(best));
                continue;
            }
        }
        chosen.members.push(best);
        refit(fitter, z, &mut chosen);
        if let Some(other) = undone(&chosen) {
            let last = chosen.members.pop().expect("just pushed");
            barred.push(last.candidate);
            let reason = format!("it mostly cancels the effect of {}", fitter.candidates[chosen.members[other].candidate].effect);
            refused.push(Refused::new(last, reason));
            refit(fitter, z, &mut chosen);
            continue;
        }
        // A member that the others make redundant is dropped.
        if let Some(weak) = chosen.members.iter().position(|member| member.evidence < bar(member)) {
            barred.push(chosen.members[weak].candidate);
            chosen.members.remove(weak);
            refit(fitter, z, &mut chosen);
        }
    }
    chosen
}

/// Number of candidates that are fitted jointly with the members, and their least evidence with the members fixed.
const TOGETHER: usize = 12;
const WORTH: f64 = 5.0;

/// Candidates as further members, fitted jointly with the members. With the members fixed, correlated candidates have little evidence left.
#[must_use]
pub fn together(fitter: &Fitter<'_>, z: &[f64], chosen: &Chosen, mut fits: Vec<Fitted>) -> Vec<Fitted> {
    fits.retain(|fit| fit.evidence >= WORTH && !taken(fitter, chosen, fit));
    fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    fits.truncate(TOGETHER);
    let before = chi_squared(&chosen.rest);
    let one = |fit: Fitted| {
        let price = fit.fall - fit.evidence;
        let Chosen { mut members, rest } = with(fitter, z, chosen, fit);
        let fall = before - chi_squared(&rest);
        Some(Fitted { fall, evidence: fall - price, ..members.pop()? })
    };
    fits.into_iter().filter_map(one).collect()
}

/// A set with one more member, all refitted.
fn with(fitter: &Fitter<'_>, z: &[f64], chosen: &Chosen, fit: Fitted) -> Chosen {
    let mut more = chosen.clone();
    more.members.push(fit);
    refit(fitter, z, &mut more);
    more
}

/// Whether a size is within the plausible range of the catalogue.
#[must_use]
pub fn plausible(candidate: &Candidate, size: f64) -> bool {
    (candidate.range.0..=candidate.range.1).contains(&size)
}

/// Share of the evidence that a confinement must add: excluding the sections that fit worst always adds some.
const CONFINED: f64 = 0.15;

/// Removes a confinement that does not add enough evidence to the same candidate in all sections.
pub fn unconfine(fitter: &Fitter<'_>, rest: &[f64], fit: &mut Fitted, bars: &Bars) {
    if fit.mask == 0 {
        return;
    }
    let Some(whole) = fitter.fit(rest, fit.candidate, 0) else { return };
    if fit.evidence < whole.evidence + bars.confined.max(CONFINED * whole.evidence) {
        *fit = whole;
    }
}

/// Cosine of two whitened changes below which the members compensate each other.
const UNDONE: f64 = -0.6;

/// The member that the last one compensates.
fn undone(chosen: &Chosen) -> Option<usize> {
    let (last, others) = chosen.members.split_last()?;
    let length = |member: &Fitted| dot(&member.whitened, &member.whitened).sqrt();
    others.iter().position(|other| dot(&other.whitened, &last.whitened) < UNDONE * length(other) * length(last))
}

/// Similarity of the distribution of two whitened changes over the channels: 1 for the same distribution, 0 without a common channel.
fn in_common(channels: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let squares = |of: &[f64]| {
        let mut sums = vec![0.0; channels.iter().max().map_or(0, |most| most + 1)];
        of.iter().zip(channels.iter().cycle()).for_each(|(x, channel)| sums[*channel] += x * x);
        sums
    };
    let (a, b) = (squares(a), squares(b));
    let both: f64 = a.iter().zip(&b).map(|(a, b)| (a * b).sqrt()).sum();
    let lengths = a.iter().sum::<f64>() * b.iter().sum::<f64>();
    if lengths > 0.0 { both * both / lengths } else { 0.0 }
}

/// Whether the same cause is a member already: another size of the same effect on the same channels, or of an inverted channel.
#[must_use]
pub fn taken(fitter: &Fitter<'_>, chosen: &Chosen, fit: &Fitted) -> bool {
    let of = &fitter.candidates[fit.candidate];
    chosen.members.iter().any(|member| {
        let known = &fitter.candidates[member.candidate];
        let turned = known.exact && of.exact && (known.discrete || of.discrete) && known.channels == of.channels;
        turned || known.effect == of.effect && (known.channels == of.channels || of.channels.is_empty())
    })
}

/// Maximum number of iterations of the refit, and its convergence criterion as a share of chi-squared. Correlated changes converge slowly.
const TURNS: usize = 100;
const SETTLED: f64 = 1e-6;

/// Fits every member to the residual of the others, in turn, until chi-squared converges.
pub fn refit(fitter: &Fitter<'_>, z: &[f64], chosen: &mut Chosen) {
    let mut before = f64::INFINITY;
    for _ in 0..TURNS {
        for at in 0..chosen.members.len() {
            let rest = chosen.left_by_others(z, at);
            let (candidate, mask) = (chosen.members[at].candidate, chosen.members[at].mask);
            if let Some(fitted) = fitter.fit(&rest, candidate, mask) {
                chosen.members[at] = Fitted { doubtful: chosen.members[at].doubtful, ..fitted };
            }
        }
        chosen.rest = chosen.members.iter().fold(z.to_vec(), |rest, member| less(&rest, &member.whitened));
        let now = chi_squared(&chosen.rest);
        if chosen.members.len() < 2 || before - now <= SETTLED * now {
            break;
        }
        before = now;
    }
}

/// For every candidate, the set with the most evidence in which it replaces a member: that member, the fit, the loss of evidence.
#[must_use]
pub fn rivals(fitter: &Fitter<'_>, z: &[f64], chosen: &Chosen, at: usize) -> Vec<(usize, Fitted, f64)> {
    let less = |fit: Fitted| {
        let less = chosen.members[at].evidence - fit.evidence;
        (at, fit, less)
    };
    fitter.all(&chosen.left_by_others(z, at)).into_iter().map(less).collect()
}

/// Number of unnamed candidates that are reported, and their least evidence.
const TOLD: usize = 3;
const TELLING: f64 = 10.0;

/// The candidates with the most evidence for the residual, one per effect; neither members nor refused.
#[must_use]
pub fn nearest(fitter: &Fitter<'_>, chosen: &Chosen, refused: &[Refused]) -> Vec<Fitted> {
    let mut fits = fitter.all(&chosen.rest);
    let effect = |fit: &Fitted| fitter.candidates[fit.candidate].effect.as_str();
    let known: Vec<&str> = chosen.members.iter().chain(refused.iter().map(|refused| &refused.fitted)).map(effect).collect();
    fits.retain(|fit| fit.evidence >= TELLING && plausible(&fitter.candidates[fit.candidate], fit.size) && !known.contains(&effect(fit)));
    fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let mut told: Vec<Fitted> = Vec::new();
    for fit in fits {
        if told.len() < TOLD && told.iter().all(|one| effect(one) != effect(&fit)) {
            told.push(fit);
        }
    }
    told
}

/// A refused candidate with contradictory views that has more evidence for the residual than any member: a difference is present that no
/// effect explains.
#[must_use]
pub fn contradicting(fitter: &Fitter<'_>, chosen: &Chosen, refused: &[Refused]) -> Option<(Refused, f64)> {
    let most = chosen.members.iter().map(|member| member.evidence).reduce(f64::max)?;
    let fits = refused.iter().filter(|refused| refused.contradicted).filter_map(|refused| {
        let left = fitter.fit(&chosen.rest, refused.fitted.candidate, refused.fitted.mask)?;
        (left.evidence > most).then(|| (refused.clone(), left.evidence))
    });
    fits.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Chi-squared of a whitened difference.
#[must_use]
pub fn chi_squared(z: &[f64]) -> f64 {
    dot(z, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::allowed::whiten::Covariance;
    use crate::diagnose::search::candidates::Node;
    use crate::diagnose::search::fit::Mask;

    /// Ten sections of two features of unit variance: one differs by 2, which a member explains, the other by 3, which a refused effect
    /// would explain.
    #[test]
    fn more_than_the_answer_that_views_contradict_is_told() {
        const SECTIONS: usize = 10;
        let per_section = |a: f64, b: f64| (0..SECTIONS).flat_map(|_| [a, b]).collect::<Vec<f64>>();
        let covariance = Covariance { diagonal: vec![1.0; 2 * SECTIONS], inside: Vec::new(), shared: Vec::new(), size: 2 };
        let path = |effect: &str, change: Vec<f64>| {
            Candidate::path(effect, vec![Node { size: 0.0, change: Vec::new() }, Node { size: 10.0, change }])
        };
        let candidates = [path("named", per_section(10.0, 0.0)), path("refused", per_section(0.0, 10.0))];
        let whitener = covariance.whitener();
        let everywhere = Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None };
        let fitter = Fitter::new(&whitener, &candidates, vec![everywhere]);
        let told = |second: f64, contradicted: bool| {
            let z = per_section(2.0, second);
            let fit = |candidate: usize| fitter.fit(&z, candidate, 0).expect("a path");
            let mut chosen = Chosen { members: vec![fit(0)], rest: z.clone() };
            refit(&fitter, &z, &mut chosen);
            let refused = Refused { contradicted, ..Refused::new(fit(1), "views differ") };
            contradicting(&fitter, &chosen, &[refused]).map(|(_, evidence)| evidence)
        };
        // 10 * 3^2 less the penalty of a path of 10 * 10^1/2 standard deviations: 2 ln (31.6 / (2 pi)^1/2) = 5.07.
        let evidence = told(3.0, true).expect("it has more");
        assert!((evidence - (90.0 - 5.07)).abs() < 0.01, "{evidence}");
        assert_eq!((told(3.0, false), told(1.9, true)), (None, None));
    }

    /// Ten sections of two features of unit variance, with differences of 30 and 3: falls of 9000 and 90. The model error of a simulated
    /// first change may be as large as the second difference; an operation on the signals has none.
    #[test]
    fn what_a_large_effect_may_be_wrong_by_is_not_named_beside_it() {
        const SECTIONS: usize = 10;
        let per_section = |a: f64, b: f64| (0..SECTIONS).flat_map(|_| [a, b]).collect::<Vec<f64>>();
        let covariance = Covariance { diagonal: vec![1.0; 2 * SECTIONS], inside: Vec::new(), shared: Vec::new(), size: 2 };
        let path = |effect: &str, change: Vec<f64>, exact: bool| Candidate {
            exact,
            range: (0.0, 100.0),
            ..Candidate::path(effect, vec![Node { size: 0.0, change: Vec::new() }, Node { size: 100.0, change }])
        };
        let whitener = covariance.whitener();
        let everywhere = Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None };
        let bars = Bars { first: 30.0, exact: 15.0, confined: 15.0, tolerance_sd: 3.5, share: 0.08, most: 3 };
        let z = per_section(30.0, 3.0);
        let named = |exact: bool, channels: &[usize]| {
            let candidates = [path("large", per_section(100.0, 0.0), exact), path("small", per_section(0.0, 100.0), false)];
            let fitter = Fitter::new(&whitener, &candidates, vec![everywhere.clone()]);
            let found = search(
                &fitter,
                &z,
                (Chosen::none(&z), Vec::new()),
                (&bars, channels),
                &|_, _| 100.0,
                &|_, _| Judged::Sound,
                &mut Vec::new(),
            );
            found.members.iter().map(|member| (member.candidate, member.fall.round())).collect::<Vec<_>>()
        };
        assert_eq!(named(false, &[0, 0]), [(0, 9000.0)]);
        assert_eq!(named(true, &[0, 0]), [(0, 9000.0), (1, 90.0)]);
        // There is no model error in features that it does not change.
        assert_eq!(named(false, &[0, 1]), [(0, 9000.0), (1, 90.0)]);
        assert!((in_common(&[0, 1], &[3.0, 4.0, 0.0, 0.0], &[4.0, 0.0, 0.0, 0.0]) - 9.0 / 25.0).abs() < 1e-12);
    }

    /// Ten sections of two features of unit variance. Two changes with a cosine of 0.9 are present with size 0.3 each. With the first
    /// fixed at its size when fitted alone, the second explains 1 - 0.9^2 of the residual; jointly they explain all of it, with the true
    /// sizes.
    #[test]
    fn what_is_alike_is_weighed_together() {
        const SECTIONS: usize = 10;
        let per_section = |a: f64, b: f64| (0..SECTIONS).flat_map(|_| [a, b]).collect::<Vec<f64>>();
        let side = 0.19_f64.sqrt();
        let path = |effect: &str, change: Vec<f64>| {
            Candidate::path(effect, vec![Node { size: 0.0, change: Vec::new() }, Node { size: 1.0, change }])
        };
        let candidates = [path("first", per_section(10.0, 0.0)), path("second", per_section(9.0, 10.0 * side))];
        let covariance = Covariance { diagonal: vec![1.0; 2 * SECTIONS], inside: Vec::new(), shared: Vec::new(), size: 2 };
        let whitener = covariance.whitener();
        let everywhere = Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None };
        let fitter = Fitter::new(&whitener, &candidates, vec![everywhere]);
        let z = per_section(3.0 + 2.7, 3.0 * side);
        let first = fitter.fit(&z, 0, 0).expect("a path");
        let chosen = Chosen { rest: less(&z, &first.whitened), members: vec![first] };
        let left = SECTIONS as f64 * 9.0 * 0.19;
        assert!((chi_squared(&chosen.rest) - left).abs() < 1e-9);
        let beside = fitter.fit(&chosen.rest, 1, 0).expect("a path");
        assert!((beside.fall - 0.19 * left).abs() < 1e-9, "{}", beside.fall);
        let second = Fitted { evidence: beside.evidence.max(WORTH), ..beside };
        let price = second.fall - second.evidence;
        let found = together(&fitter, &z, &chosen, vec![second]);
        let [both] = &found[..] else { panic!("{} fits", found.len()) };
        assert!((both.fall - left).abs() < 1e-3 && (both.size - 0.3).abs() < 1e-3, "{} {}", both.fall, both.size);
        assert!((both.fall - both.evidence - price).abs() < 1e-9);
        // Together they explain all of chi-squared, 10 (5.7^2 + 0.19 * 9) = 342; one after the other, 325 and 17.
        let set = with(&fitter, &z, &chosen, both.clone());
        let penalties: f64 = set.members.iter().map(|member| member.fall - member.evidence).sum();
        assert!((set.evidence() + penalties - 342.0).abs() < 1e-2, "{}", set.evidence() + penalties);
    }
}
