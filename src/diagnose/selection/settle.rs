//! Refit of the answer with the tolerances simulated together with it: part of the difference may
//! then be due to a tolerance.

use std::sync::Arc;

use crate::diagnose::features::bench::Runs;
use crate::diagnose::features::layout::Kind;
use crate::diagnose::inference::chosen::{Bars, Chosen, Refused};
use crate::diagnose::inference::fit::{Fitted, Fitter, alone_again};
use crate::diagnose::inference::sets::refit;
use crate::diagnose::levels::covariance::NOTHING;
use crate::diagnose::levels::settle::{ALIKE, JUMP, ROUNDS};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::mask::Mask;
use crate::diagnose::response::workshop::Workshop;
use crate::diagnose::selection::lack::{Lack, lack_after, unexplained};
use crate::diagnose::selection::place::Place;
use crate::diagnose::selection::tolerances::Tolerances;

/// A set of effects and its weighing.
#[derive(Clone)]
pub struct Weighed {
    pub place: Arc<Place>,
    pub chosen: Chosen,
}

impl Weighed {
    fn at(self, place: Arc<Place>) -> Self {
        Self { place, ..self }
    }

    /// A size in sections selected from the data, less the size of the other sections if it has the
    /// same sign: the selection is not justified by a change common to all sections. The size
    /// itself where the sections were not selected from the data.
    fn beside_the_others(&self, of: &Candidate, mask: &Mask, size: f64) -> f64 {
        let Some(neutral) = of.neutral().filter(|_| mask.asked_by.is_some()) else { return size };
        let others = Mask {
            confined: None,
            sections: mask.sections.iter().map(|inside| !inside).collect(),
            asked_by: None,
        };
        let fitter = Fitter::new(&self.place.whitener, std::slice::from_ref(of), vec![others]);
        let elsewhere = fitter.fit(&self.chosen.rest, 0, 0).map_or(0.0, |fit| fit.size - neutral);
        let here = size - neutral;
        neutral + here.signum() * (here.abs() - (here.signum() * elsewhere).clamp(0.0, here.abs()))
    }
}

/// Inputs of the refit.
pub struct Settled<'a> {
    pub tolerances: &'a Tolerances<'a>,
    /// Distance of a size from neutral in declared standard deviations.
    pub far: &'a dyn Fn(&Candidate, f64) -> f64,
}

impl Settled<'_> {
    /// The refitted members and two weighings: one for the residual, and one for the sizes, without
    /// outlying sections.
    pub fn answer(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        first: Weighed,
        lack_before: &[Lack],
        bars: &Bars,
        refused: &mut Vec<Refused>,
        runs: &mut Runs,
    ) -> (Arc<Place>, Weighed) {
        let lack = |candidates: &[Candidate], now: &Weighed| {
            lack_after(
                &now.place.covariance,
                self.tolerances.workshop.seen,
                (candidates, masks),
                &now.place.difference,
                &now.chosen,
            )
        };
        let before = refused.len();
        let mut now = self.settle((candidates, masks), first.clone(), bars, refused, runs);
        // With most of the gap unexplained, the tolerances are not simulated again.
        if unexplained(lack_before, &lack(candidates, &now)).1 {
            refused.truncate(before);
            now = first;
        }
        let (beside, left) = (now.place.clone(), lack(candidates, &now));
        (beside, self.sized((candidates, masks), now, &left, runs))
    }

    /// Weighs with the tolerances simulated together with the first member, then with the first
    /// two, and so on. A member may be replaced by a tolerance to which it or another member makes
    /// the vehicle sensitive.
    fn settle(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        mut now: Weighed,
        bars: &Bars,
        refused: &mut Vec<Refused>,
        runs: &mut Runs,
    ) -> Weighed {
        let without = now.place.clone();
        let mut count = 1;
        while count <= now.chosen.members.len() {
            if let Some(place) =
                self.tolerances.beside((candidates, masks), &now.chosen.members[..count], runs)
            {
                now = now.at(place);
            }
            self.refined((candidates, masks), &mut now, runs);
            while now
                .chosen
                .members
                .get(count)
                .is_some_and(|next| next.evidence < bars.least(&candidates[next.candidate]))
            {
                let reason = "with the tolerances evaluated together with the effects found before, it has too little evidence";
                refused.push(Refused::new(now.chosen.members.remove(count), reason));
                alone_again(candidates, &now.chosen.members);
                self.refined((candidates, masks), &mut now, runs);
            }
            let members = &now.chosen.members;
            let weak = |at: usize| {
                let (member, of) = (&members[at], &candidates[members[at].candidate]);
                let contrast = now.beside_the_others(of, &masks[member.mask], member.size);
                let (away, needed) =
                    ((self.far)(of, contrast), bars.tolerance_sd + masks[member.mask].picked());
                let from = if masks[member.mask].asked_by.is_some() {
                    " from that of the other sections"
                } else {
                    ""
                };
                let reason = match () {
                    () if member.evidence < bars.least(of) => {
                        "it has too little evidence".to_string()
                    }
                    () if away < needed => {
                        format!(
                            "its value is only {away:.1} declared standard deviations away{from}; {needed:.1} are required"
                        )
                    }
                    () => return None,
                };
                Some((at, format!("with the tolerances evaluated together with it, {reason}")))
            };
            let Some((weak, reason)) = (0..count).find_map(weak) else {
                count += 1;
                continue;
            };
            refused.push(Refused::new(now.chosen.members.remove(weak), reason));
            alone_again(candidates, &now.chosen.members);
            now = now.at(without.clone());
            self.refined((candidates, masks), &mut now, runs);
            count = 1;
        }
        now
    }

    /// Refits the members with the covariance for sizes: without outlying sections, and without
    /// lags that jump to another period between sizes.
    fn sized(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        mut now: Weighed,
        lack: &[Lack],
        runs: &mut Runs,
    ) -> Weighed {
        let (seen, settings) = (self.tolerances.workshop.seen, self.tolerances.settings);
        let mut covariance = now.place.covariance.clone();
        for one in lack {
            let level = one.kind == Kind::Level;
            for (at, feature) in seen.features.iter().enumerate() {
                if seen.layout.channels[feature.channel].name == one.channel
                    && (feature.kind == Kind::Level) == level
                {
                    one.alone.iter().for_each(|section| {
                        covariance.diagonal[seen.place(*section, at)] = NOTHING
                    });
                }
            }
        }
        for member in now.chosen.members.iter().filter(|member| !candidates[member.candidate].exact)
        {
            for (at, feature) in
                seen.features.iter().enumerate().filter(|(_, feature)| feature.kind == Kind::Lag)
            {
                let sd = settings.groups[seen.layout.channels[feature.channel].group].lag_sd;
                for place in (0..seen.sections.len()).map(|section| seen.place(section, at)) {
                    if candidates[member.candidate].range_near(member.size, place) > JUMP * sd {
                        covariance.diagonal[place] = NOTHING;
                    }
                }
            }
        }
        now.place = Arc::new(Place::new(covariance, now.place.difference.clone()));
        self.refined((candidates, masks), &mut now, runs);
        now
    }

    fn refined(&self, of: (&mut [Candidate], &[Mask]), now: &mut Weighed, runs: &mut Runs) {
        refined(self.tolerances.workshop, of, (&now.place, &mut now.chosen), runs);
    }
}

/// Refits the members with their fitted sizes simulated. The last step is a fit, so that the judged
/// sizes are those of the answer.
pub fn refined(
    workshop: &Workshop<'_>,
    (candidates, masks): (&mut [Candidate], &[Mask]),
    (place, chosen): (&Place, &mut Chosen),
    runs: &mut Runs,
) {
    for round in 0..=ROUNDS {
        let fitter = Fitter::of(&place.whitener, candidates, masks.to_vec(), &chosen.members);
        refit(&fitter, &place.z, chosen);
        if round == ROUNDS || !polish(workshop, candidates, &chosen.members, runs) {
            break;
        }
    }
}

/// Simulates the fitted sizes where no close size exists; returns whether there was any.
pub fn polish(
    workshop: &Workshop<'_>,
    candidates: &mut [Candidate],
    fits: &[Fitted],
    runs: &mut Runs,
) -> bool {
    let mut added = false;
    for member in fits {
        let candidate = &mut candidates[member.candidate];
        let known = candidate
            .nodes
            .iter()
            .any(|node| (node.size - member.size).abs() <= ALIKE * member.size.abs());
        if !candidate.discrete && member.size.is_finite() && !known {
            workshop.add_size(candidate, member.size, runs);
            added = true;
        }
    }
    added
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::uncertainty::response::ResponseError;
    use crate::diagnose::uncertainty::whiten::Covariance;
    use crate::diagnose::uncertainty::whiten::less;

    /// One feature in each of eight sections, of unit variance: three selected sections have the
    /// size 5, the others 2 or -2.
    #[test]
    fn what_all_sections_have_is_no_reason_to_choose_some() {
        let covariance = Covariance {
            diagonal: vec![1.0; 8],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 1,
            response: ResponseError::default(),
        };
        let nodes = [-10.0, 0.0, 10.0].map(|size| Node {
            size,
            change: if size == 0.0 { Vec::new() } else { vec![size; 8] },
        });
        let candidates = [Candidate::path("effect", nodes.to_vec())];
        let size = |others: f64, asked_by: Option<usize>| {
            let difference: Vec<f64> = (0..8).map(|at| if at < 3 { 5.0 } else { others }).collect();
            let mask =
                Mask { confined: None, sections: (0..8).map(|at| at < 3).collect(), asked_by };
            let whitener = covariance.whitener();
            let member = Fitter::new(&whitener, &candidates, vec![mask.clone()])
                .fit(&difference, 0, 0)
                .expect("a path");
            let chosen = Chosen {
                members: vec![member.clone()],
                ..Chosen::none(&less(&difference, &member.whitened))
            };
            let weighed =
                Weighed { place: Arc::new(Place::new(covariance.clone(), difference)), chosen };
            weighed.beside_the_others(&candidates[0], &mask, member.size)
        };
        for (others, asked_by, wanted) in
            [(2.0, Some(0), 3.0), (-2.0, Some(0), 5.0), (6.0, Some(0), 0.0), (2.0, None, 5.0)]
        {
            let found = size(others, asked_by);
            assert!((found - wanted).abs() < 1e-9, "{found} for {wanted}");
        }
    }
}
