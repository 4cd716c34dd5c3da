//! The search with simulation of the fitted sizes, so that neither an answer nor a refusal is based
//! on interpolation.

use crate::diagnose::features::bench::Runs;
use crate::diagnose::inference::chosen::{Bars, Chosen, Refused};
use crate::diagnose::inference::fit::{Fitted, Fitter, Known};
use crate::diagnose::inference::sets::{Conditions, Sets};
use crate::diagnose::levels::chosen::TOLERANCE_SD;
use crate::diagnose::levels::converge::{CONFINED, FLOOR, FLOOR_EXACT, MOST, NEAR, WORTH};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::mask::Mask;
use crate::diagnose::selection::calibration::{Draws, limit};
use crate::diagnose::selection::converging::{Converged, Converging};
use crate::diagnose::selection::masks::section_masks;
use crate::diagnose::selection::place::Place;
use crate::diagnose::selection::settle::polish;

impl Converging<'_> {
    /// Searches until no relevant candidate has sizes left to simulate.
    pub fn search(
        &self,
        candidates: &mut [Candidate],
        masks: &mut Vec<Mask>,
        runs: &mut Runs,
    ) -> Converged {
        let (workshop, Place { whitener, z, .. }) = (self.workshop, self.place);
        let mut refused = Vec::new();
        let mut known = Known::new();
        let mut chance = None;
        let mut reconsidered: Vec<usize> = Vec::new();
        let (chosen, bars) = loop {
            let fitter =
                Fitter::knowing(whitener, candidates, masks.clone(), std::mem::take(&mut known));
            let bars = bars(
                *chance.get_or_insert_with(|| limit(&fitter, self.seed, self.false_name_rate)),
            );
            refused.clear();
            let guard = |fit: &Fitted, chosen: &Chosen| self.guard(&fitter, chosen, fit);
            let of = Conditions { bars: &bars, far: self.far, guard: &guard };
            let found =
                Sets::new(&fitter, z).search(&Chosen::none(z), Vec::new(), &of, &mut refused);
            let wanted = promising(&fitter, z, &found);
            let more = if wanted.is_empty() {
                section_masks(&fitter, z, &found, workshop.seen)
            } else {
                Vec::new()
            };
            known = fitter.whitened;
            if wanted.is_empty() && more.is_empty() {
                // A refusal must not be based on interpolation either: refused candidates are
                // judged again at the simulated size.
                let again: Vec<Fitted> = refused
                    .iter()
                    .map(|refused: &Refused| refused.fitted.clone())
                    .filter(|fit| {
                        fit.evidence >= NEAR * found.evidence
                            && !reconsidered.contains(&fit.candidate)
                    })
                    .collect();
                reconsidered.extend(again.iter().map(|fit| fit.candidate));
                if !polish(workshop, candidates, &again, runs) {
                    break (found, bars);
                }
            }
            masks.extend(more);
            wanted
                .into_iter()
                .for_each(|(at, size)| workshop.refine(&mut candidates[at], size, runs));
            (workshop.trying)("weighing");
        };
        let fitter = Fitter::knowing(whitener, candidates, masks.clone(), known);
        (workshop.trying)("calibration on drawn campaigns");
        let draws = Draws { fitter: &fitter, bars: &bars, far: self.far, seed: self.seed };
        let (false_name_rate, calibration) = (draws.falsely_named(), draws.calibrate());
        let known = fitter.whitened;
        let now = self.simulated(
            (candidates, masks),
            Converged { chosen, refused, bars, false_name_rate, calibration, known },
            runs,
        );
        self.beside((candidates, masks), now, runs)
    }

    /// Searches again after a member was refused: members are added, replaced and dropped. The
    /// weighing is that with the tolerances simulated together with the first members, where
    /// computed.
    pub fn again(
        &self,
        (candidates, masks): (&[Candidate], &[Mask]),
        now: &mut Chosen,
        bars: &Bars,
        refused: &mut Vec<Refused>,
    ) -> bool {
        let place = self.tolerances.and_then(|tolerances| {
            tolerances.looked_at().beside(&now.members[..now.members.len().min(1)])
        });
        match place {
            Some(place) => self.at(&place).searched_again((candidates, masks), now, bars, refused),
            None => self.searched_again((candidates, masks), now, bars, refused),
        }
    }

    fn searched_again(
        &self,
        (candidates, masks): (&[Candidate], &[Mask]),
        now: &mut Chosen,
        bars: &Bars,
        refused: &mut Vec<Refused>,
    ) -> bool {
        let Place { whitener, z, .. } = self.place;
        let fitter = Fitter::new(whitener, candidates, masks.to_vec());
        let guard = |fit: &Fitted, chosen: &Chosen| self.guard(&fitter, chosen, fit);
        let of = Conditions { bars, far: self.far, guard: &guard };
        let alike = |at: &usize| {
            refused
                .iter()
                .any(|refused| candidates[refused.fitted.candidate].is_like(&candidates[*at]))
        };
        let barred = (0..candidates.len()).filter(alike).collect();
        let before = now.set();
        *now = Sets::new(&fitter, z).replaced(now, barred, &of, refused);
        now.set() != before
    }
}

/// Criteria from the evidence that occurs by chance.
fn bars(chance: f64) -> Bars {
    let first = chance.max(FLOOR);
    Bars {
        first,
        exact: chance.max(FLOOR_EXACT),
        confined: CONFINED,
        tolerance_sd: TOLERANCE_SD,
        most: MOST,
    }
}

/// Candidates whose remaining sizes are simulated, and on which side: those close to the best for
/// the whole difference, for the residual of a first set, or for the residual of that set without
/// one member; and the members of that set.
fn promising(fitter: &Fitter<'_>, z: &[f64], chosen: &Chosen) -> Vec<(usize, f64)> {
    let pending = |fit: &&Fitted| fitter.candidates[fit.candidate].pending_towards(fit.size);
    let towards = |fit: &Fitted| (fit.candidate, fit.size);
    let mut found: Vec<(usize, f64)> = chosen.members.iter().filter(pending).map(towards).collect();
    let without = |member: &Fitted| {
        chosen.rest.iter().zip(&member.whitened).map(|(rest, own)| rest + own).collect()
    };
    let mut rests: Vec<Vec<f64>> = vec![z.to_vec(), chosen.weighed()];
    if chosen.members.len() > 1 {
        rests.extend(chosen.members.iter().map(without));
    }
    for rest in rests {
        let fits = fitter.all(&rest);
        let best = fits.iter().map(|fit| fit.evidence).fold(0.0, f64::max);
        let near = |fit: &&Fitted| fit.evidence >= (NEAR * best).max(WORTH) && pending(fit);
        found.extend(fits.iter().filter(near).map(towards));
    }
    // In the order of the catalogue; a second request for the same side has nothing to simulate.
    found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::features::layout::Layout;
    use crate::diagnose::features::observations::Observations;
    use crate::diagnose::inference::chosen::Judged;
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::response::ground::Ground;
    use crate::diagnose::response::workshop::Workshop;
    use crate::diagnose::selection::guards::View;
    use crate::diagnose::uncertainty::response::ResponseError;
    use crate::diagnose::uncertainty::whiten::Covariance;
    use crate::effects::Catalogue;
    use crate::source::Source;
    use std::sync::OnceLock;

    const SECTIONS: usize = 10;

    /// Runs `work` with a search for a weighing and these views.
    fn at_place<R>(
        place: &Place,
        families: &[Vec<View>],
        work: impl FnOnce(&Converging<'_>) -> R,
    ) -> R {
        let layout =
            Layout { channels: Vec::new(), edges: Vec::new(), alike: (0.0, 1.0), furthest: 1.0 };
        let (noise, left_out, faults) = (Vec::new(), Vec::new(), Vec::new());
        let seen = Observations {
            layout,
            features: Vec::new(),
            sections: Vec::new(),
            noise,
            left_out,
            faults,
            hashed: OnceLock::new(),
        };
        let (groups, units, effects) = (Vec::new(), Vec::new(), Vec::new());
        let source = Source::new("", "");
        let catalogue = Catalogue {
            name: String::new(),
            title: String::new(),
            source,
            groups,
            units,
            effects,
            diagnosis: None,
        };
        let (ground, trying, neutral) = (Ground::default(), |_: &str| {}, |_: &str| None);
        let workshop = Workshop {
            seen: &seen,
            catalogue: &catalogue,
            bench: None,
            ground: &ground,
            neutral: &neutral,
            trying: &trying,
        };
        work(&Converging {
            workshop: &workshop,
            place,
            tolerances: None,
            families,
            far: &|_, _| 100.0,
            false_name_rate: 0.04,
            seed: 1,
        })
    }

    fn per_section(of: &[f64]) -> Vec<f64> {
        (0..SECTIONS).flat_map(|_| of.to_vec()).collect()
    }

    /// A path from no change at size 0 to a change of each section at size 10.
    fn path(effect: &str, change: &[f64]) -> Candidate {
        Candidate::path(
            effect,
            vec![
                Node { size: 0.0, change: Vec::new() },
                Node { size: 10.0, change: per_section(change) },
            ],
        )
    }

    fn of_unit_variance(features: usize) -> Covariance {
        Covariance {
            diagonal: vec![1.0; features * SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: features,
            response: ResponseError::default(),
        }
    }

    fn everywhere() -> [Mask; 1] {
        [Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None }]
    }

    /// Ten sections of three features of unit variance; the second differs by 3. A member that also
    /// changes the first feature was chosen with a second one that compensated it. Alone it
    /// explains 10 * 3^2 / 2. Another candidate changes only the second feature and explains all of
    /// 10 * 3^2. The penalties are equal.
    #[test]
    fn where_a_member_has_gone_another_takes_the_place_of_what_was_chosen_beside_it() {
        let side = 10.0 / 2_f64.sqrt();
        let candidates = [
            path("both", &[side, side, 0.0]),
            path("gone", &[-10.0, 0.0, 0.0]),
            path("second", &[0.0, 10.0, 0.0]),
        ];
        let masks = everywhere();
        let exchanged = |second: f64, refused: &[usize]| {
            let difference = per_section(&[0.0, second, 0.0]);
            let place = Place::new(of_unit_variance(3), difference.clone());
            let fitter = Fitter::new(&place.whitener, &candidates, masks.to_vec());
            let fit = |candidate: usize| fitter.fit(&difference, candidate, 0).expect("a path");
            let mut now = Chosen { members: vec![fit(0)], ..Chosen::none(&difference) };
            let mut refused: Vec<Refused> =
                refused.iter().map(|at| Refused::new(fit(*at), "gone")).collect();
            let again = |search: &Converging<'_>| {
                search.again((&candidates, &masks), &mut now, &bars(0.0), &mut refused)
            };
            let any = at_place(&place, &[], again);
            let [member] = &now.members[..] else { panic!("{} members", now.members.len()) };
            (any, member.candidate, member.size, member.fall)
        };
        let (any, candidate, size, fall) = exchanged(3.0, &[1]);
        assert!(any && candidate == 2, "{candidate}");
        assert!((size - 3.0).abs() < 1e-9 && (fall - 90.0).abs() < 1e-9, "{size}, {fall}");
        // A refused candidate replaces no member; nor does one below the first threshold: 10 *
        // 1.8^2 is 32.4, less the penalty 28.
        assert_eq!(exchanged(3.0, &[1, 2]).1, 0);
        assert_eq!(exchanged(1.8, &[1]).1, 0);
        assert_eq!(exchanged(2.0, &[1]).1, 2);
    }

    /// Two features of unit variance, each a view. The first member changes the second feature by
    /// 60, with a model error of a fifth, 12. A further one changes both by 6, which the second
    /// feature does not show. With the model error the second view has the standard error (1 +
    /// 12^2)^1/2 / (6 * 10^1/2) = 0.63 and does not contradict; without it, 1 / (6 * 10^1/2) =
    /// 0.05, and contradicts.
    #[test]
    fn what_a_member_is_wrong_by_contradicts_no_other() {
        let mut candidates = [path("first", &[0.0, 100.0]), path("further", &[10.0, 10.0])];
        let masks = everywhere();
        let mut response = ResponseError::default();
        response.each = 0.2;
        let place =
            Place::new(Covariance { response, ..of_unit_variance(2) }, per_section(&[6.0, 60.0]));
        let view = |feature: usize| View {
            says: format!("view {feature}"),
            sections: (0..SECTIONS).collect(),
            features: vec![feature],
        };
        let families = [vec![view(0), view(1)]];
        let mut judged = |exact: bool| {
            candidates[0].exact = exact;
            let fitter = Fitter::new(&place.whitener, &candidates, masks.to_vec());
            let first = fitter.fit(&per_section(&[0.0, 60.0]), 0, 0).expect("a path");
            let others = Chosen {
                members: vec![first.clone()],
                ..Chosen::none(&crate::diagnose::uncertainty::whiten::less(
                    &place.z,
                    &first.whitened,
                ))
            };
            let further = fitter.fit(&per_section(&[6.0, 6.0]), 1, 0).expect("a path");
            at_place(&place, &families, |search| search.guard(&fitter, &others, &further))
        };
        assert!(matches!(judged(true), Judged::Contradicted(_)));
        assert_eq!(judged(false), Judged::Sound);
    }
}
