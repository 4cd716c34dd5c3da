//! What every step of the search needs, and the checks of a member.

use crate::diagnose::features::bench::Runs;
use crate::diagnose::inference::chosen::{Bars, Chosen, Judged, Refused, plausible};
use crate::diagnose::inference::fit::{Fitted, Fitter, Known, alone_again};
use crate::diagnose::inference::sets::refit;
use crate::diagnose::levels::settle::ROUNDS;
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::mask::Mask;
use crate::diagnose::response::workshop::Workshop;
use crate::diagnose::selection::guards::{View, carried, contradiction};
use crate::diagnose::selection::lack::{left, with_room};
use crate::diagnose::selection::place::Place;
use crate::diagnose::selection::settle::polish;
use crate::diagnose::selection::tolerances::Tolerances;
use crate::result::diagnosis::Calibration;

/// Inputs of the search.
pub struct Converging<'a> {
    pub workshop: &'a Workshop<'a>,
    pub place: &'a Place,
    /// Simulation of the tolerances together with members; absent in a search with fixed
    /// tolerances.
    pub tolerances: Option<&'a Tolerances<'a>>,
    pub families: &'a [Vec<View>],
    /// Distance of a size from neutral in declared standard deviations.
    pub far: &'a (dyn Fn(&Candidate, f64) -> f64 + Sync),
    /// Share of the campaigns with nothing hidden in which an effect may reach the required
    /// evidence.
    pub false_name_rate: f64,
    pub seed: u64,
}

/// Result of the search.
pub struct Converged {
    pub chosen: Chosen,
    pub refused: Vec<Refused>,
    pub bars: Bars,
    /// Share of drawn campaigns with nothing hidden in which a cause has enough evidence.
    pub false_name_rate: f64,
    pub calibration: Calibration,
    pub known: Known,
}

impl Converging<'_> {
    /// The same with another weighing.
    pub(super) fn at<'b>(&'b self, place: &'b Place) -> Converging<'b> {
        Converging { place, ..*self }
    }

    /// Refits the members with their fitted sizes simulated. A member whose evidence was sufficient
    /// only by interpolation is dropped.
    pub(super) fn simulated(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        mut now: Converged,
        runs: &mut Runs,
    ) -> Converged {
        let Place { whitener, z, .. } = self.place;
        for _ in 0..ROUNDS {
            if !polish(self.workshop, candidates, &now.chosen.members, runs) {
                break;
            }
            let fitter = Fitter::knowing(whitener, candidates, masks.to_vec(), now.known);
            refit(&fitter, z, &mut now.chosen);
            now.known = fitter.whitened;
        }
        let fitter = Fitter::knowing(whitener, candidates, masks.to_vec(), now.known);
        let fault = |member: &Fitted| {
            if member.evidence < now.bars.least(&fitter.candidates[member.candidate]) {
                return Some("when simulated at the estimated value, it has too little evidence");
            }
            (!plausible(&fitter.candidates[member.candidate], member.size))
                .then_some("together with the other effects it requires an implausible value")
        };
        let first_fault = |members: &[Fitted]| {
            members.iter().enumerate().find_map(|(at, member)| Some((at, fault(member)?)))
        };
        while let Some((at, reason)) = first_fault(&now.chosen.members) {
            let fitted = now.chosen.members.remove(at);
            now.refused.push(Refused::new(fitted, reason));
            refit(&fitter, z, &mut now.chosen);
        }
        now.known = fitter.whitened;
        if alone_again(candidates, &now.chosen.members) {
            let fitter = Fitter::knowing(whitener, candidates, masks.to_vec(), now.known);
            refit(&fitter, z, &mut now.chosen);
            now.known = fitter.whitened;
        }
        now
    }

    /// Refuses a member with contradictory views, or whose evidence is in a single section.
    pub(super) fn guard(&self, fitter: &Fitter<'_>, chosen: &Chosen, fit: &Fitted) -> Judged {
        let rest = left(fitter.candidates, &fitter.masks, &self.place.difference, chosen);
        let fitted = (&fitter.candidates[fit.candidate], &fitter.masks[fit.mask], fit);
        let mut judged = Judged::Sound;
        // The model error of the other simulated changes must not count against this one.
        let beside = with_room(&self.place.covariance, fitter.candidates, &fitter.masks, chosen);
        for family in self.families {
            match contradiction(&beside, family, fitted, &rest) {
                Judged::Sound => {}
                Judged::Doubtful => judged = Judged::Doubtful,
                refused @ (Judged::Refused(_) | Judged::Contradicted(_)) => return refused,
            }
        }
        let change = fit.change(fitter.candidates, &fitter.masks);
        carried(&self.place.covariance, &fitter.masks[fit.mask], &change, &rest).map_or(
            judged,
            |(at, share)| {
                let section = self.workshop.seen.sections[at].section.name();
                Judged::Refused(format!(
                    "without section {section} only {:.0} % of the evidence remains",
                    100.0 * share
                ))
            },
        )
    }
}
