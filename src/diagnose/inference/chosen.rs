//! Sets of effects: criteria for their members, and what is left.

use std::sync::Arc;

use crate::diagnose::inference::fit::{Fitted, Fitter, Member};
use crate::diagnose::levels::chosen::{CONFINED, TELLING, TOLD, UNDONE};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::uncertainty::metric::Metric;
use crate::diagnose::uncertainty::whiten::{dot, less};

/// Criteria for a member.
#[derive(Clone, Copy, Debug)]
pub struct Bars {
    /// Least evidence of a member.
    pub first: f64,
    /// The same for an operation on the signals, which has no model error.
    pub exact: f64,
    /// Additional evidence required of a confinement.
    pub confined: f64,
    /// Least distance from neutral of an effect on a tolerated parameter, in declared standard
    /// deviations.
    pub tolerance_sd: f64,
    pub most: usize,
}

impl Bars {
    /// Least evidence of a candidate.
    #[must_use]
    pub fn least(&self, candidate: &Candidate) -> f64 {
        if candidate.exact { self.exact } else { self.first }
    }
}

/// A set of effects fitted together, and the residual. `fall` and `evidence` of a member are what
/// the set loses without it.
#[derive(Clone, Debug)]
pub struct Chosen {
    pub members: Vec<Fitted>,
    /// The whitened residual.
    pub rest: Vec<f64>,
    /// Evidence of the whole set.
    pub evidence: f64,
    /// The model error of the members.
    pub metric: Arc<Metric>,
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
    pub fn refused(self, fitted: Fitted) -> Option<Refused> {
        let contradicted = matches!(self, Self::Contradicted(_));
        match self {
            Self::Refused(reason) | Self::Contradicted(reason) => {
                Some(Refused { fitted, reason, contradicted })
            }
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
        Self { members: Vec::new(), rest: z.to_vec(), evidence: 0.0, metric: Arc::default() }
    }

    /// The members, by candidate and mask.
    #[must_use]
    pub fn set(&self) -> Vec<Member> {
        self.members.iter().map(|member| (member.candidate, member.mask)).collect()
    }

    /// The residual weighted with the model error of the members, for the fit of a further effect.
    #[must_use]
    pub fn weighed(&self) -> Vec<f64> {
        self.metric.apply(&self.metric.apply(&self.rest))
    }

    /// The whitened difference less the changes of all members but one.
    #[must_use]
    pub fn left_by_others(&self, z: &[f64], at: usize) -> Vec<f64> {
        let others = self.members.iter().enumerate().filter(|(other, _)| *other != at);
        others.fold(z.to_vec(), |rest, (_, other)| less(&rest, &other.whitened))
    }
}

/// Whether a size is within the plausible range of the catalogue.
#[must_use]
pub fn plausible(candidate: &Candidate, size: f64) -> bool {
    (candidate.range.0..=candidate.range.1).contains(&size)
}

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

/// The member that the last one compensates.
pub fn undone(chosen: &Chosen) -> Option<usize> {
    let (last, others) = chosen.members.split_last()?;
    let length = |member: &Fitted| dot(&member.whitened, &member.whitened).sqrt();
    others.iter().position(|other| {
        dot(&other.whitened, &last.whitened) < UNDONE * length(other) * length(last)
    })
}

/// Whether the same cause is a member already: another size of the same effect on the same
/// channels, or of an inverted channel.
#[must_use]
pub fn taken(fitter: &Fitter<'_>, chosen: &Chosen, fit: &Fitted) -> bool {
    let of = &fitter.candidates[fit.candidate];
    chosen.members.iter().any(|member| {
        let known = &fitter.candidates[member.candidate];
        let turned = known.exact
            && of.exact
            && (known.discrete || of.discrete)
            && known.channels == of.channels;
        turned
            || known.effect == of.effect
                && (known.channels == of.channels || of.channels.is_empty())
    })
}

/// The candidates with the most evidence for the residual, one per effect; neither members nor
/// refused.
#[must_use]
pub fn nearest(fitter: &Fitter<'_>, chosen: &Chosen, refused: &[Refused]) -> Vec<Fitted> {
    let mut fits = fitter.all(&chosen.weighed());
    let effect = |fit: &Fitted| fitter.candidates[fit.candidate].effect.as_str();
    let known: Vec<&str> = chosen
        .members
        .iter()
        .chain(refused.iter().map(|refused| &refused.fitted))
        .map(effect)
        .collect();
    fits.retain(|fit| {
        fit.evidence >= TELLING
            && plausible(&fitter.candidates[fit.candidate], fit.size)
            && !known.contains(&effect(fit))
    });
    fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let mut told: Vec<Fitted> = Vec::new();
    for fit in fits {
        if told.len() < TOLD && told.iter().all(|one| effect(one) != effect(&fit)) {
            told.push(fit);
        }
    }
    told
}

/// A refused candidate with contradictory views that has more evidence for the residual than any
/// member: a difference is present that no effect explains.
#[must_use]
pub fn contradicting(
    fitter: &Fitter<'_>,
    chosen: &Chosen,
    refused: &[Refused],
) -> Option<(Refused, f64)> {
    let most = chosen.members.iter().map(|member| member.evidence).reduce(f64::max)?;
    let fits = refused.iter().filter(|refused| refused.contradicted).filter_map(|refused| {
        let left = fitter.fit(&chosen.weighed(), refused.fitted.candidate, refused.fitted.mask)?;
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
    use crate::diagnose::inference::sets::Sets;
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::response::mask::Mask;
    use crate::diagnose::uncertainty::response::ResponseError;
    use crate::diagnose::uncertainty::whiten::Covariance;

    /// Ten sections of two features of unit variance: one differs by 2, which a member explains,
    /// the other by 3, which a refused effect would explain.
    #[test]
    fn more_than_the_answer_that_views_contradict_is_told() {
        const SECTIONS: usize = 10;
        let per_section = |a: f64, b: f64| (0..SECTIONS).flat_map(|_| [a, b]).collect::<Vec<f64>>();
        let covariance = Covariance {
            diagonal: vec![1.0; 2 * SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 2,
            response: ResponseError::default(),
        };
        let path = |effect: &str, change: Vec<f64>| {
            Candidate::path(
                effect,
                vec![Node { size: 0.0, change: Vec::new() }, Node { size: 10.0, change }],
            )
        };
        let candidates =
            [path("named", per_section(10.0, 0.0)), path("refused", per_section(0.0, 10.0))];
        let whitener = covariance.whitener();
        let everywhere = Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None };
        let fitter = Fitter::new(&whitener, &candidates, vec![everywhere]);
        let told = |second: f64, contradicted: bool| {
            let z = per_section(2.0, second);
            let fit = |candidate: usize| fitter.fit(&z, candidate, 0).expect("a path");
            let chosen = Sets::new(&fitter, &z).chosen(&[(0, 0)]);
            let refused = Refused { contradicted, ..Refused::new(fit(1), "views differ") };
            contradicting(&fitter, &chosen, &[refused]).map(|(_, evidence)| evidence)
        };
        // 10 * 3^2 less the penalty of a path of 10 * 10^1/2 standard deviations: 2 ln (31.6 / (2
        // pi)^1/2) = 5.07.
        let evidence = told(3.0, true).expect("it has more");
        assert!((evidence - (90.0 - 5.07)).abs() < 0.01, "{evidence}");
        assert_eq!((told(3.0, false), told(1.9, true)), (None, None));
    }
}
