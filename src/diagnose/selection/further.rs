//! Further members, each simulated together with those found before. An effect may change the
//! features differently when a second effect is present, such as wind or shifted records.

use std::sync::Arc;

use crate::diagnose::features::bench::Runs;
use crate::diagnose::inference::chosen::{Chosen, Refused, plausible};
use crate::diagnose::inference::fit::{Fitted, Fitter};
use crate::diagnose::inference::sets::{Conditions, Sets, refit};
use crate::diagnose::levels::converge::WORTH;
use crate::diagnose::levels::further::{APART, FAR, MOVED, ROUNDS, TRIED};
use crate::diagnose::response::candidate::{Beside, Candidate, Node, Placed};
use crate::diagnose::response::mask::Mask;
use crate::diagnose::selection::converging::{Converged, Converging};
use crate::diagnose::selection::place::Place;
use crate::diagnose::selection::settle::refined;
use crate::diagnose::selection::tolerances::set;
use crate::effects::Action;

impl Converging<'_> {
    /// Searches for further members, one after the other: with the tolerances simulated together
    /// with the members found before, and with the strongest candidates simulated together with
    /// them.
    pub(super) fn beside(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        mut now: Converged,
        runs: &mut Runs,
    ) -> Converged {
        for count in 1..now.bars.most {
            if now.chosen.members.len() < count {
                break;
            }
            let mut first = now.chosen.clone();
            first.members.truncate(count);
            match self.placed((candidates, masks), &mut first, runs) {
                Some(place) => {
                    let own = std::mem::take(&mut now.known);
                    now = self.at(&place).further((candidates, masks), (now, first), runs);
                    now.known = own;
                }
                None => now = self.further((candidates, masks), (now, first), runs),
            }
        }
        now
    }

    /// Alternates between the fit of the members and the simulation of the tolerances with them
    /// until the sizes converge. Nothing where the members do not change the effect of the
    /// tolerances.
    fn placed(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        first: &mut Chosen,
        runs: &mut Runs,
    ) -> Option<Arc<Place>> {
        let mut place: Option<Arc<Place>> = None;
        for _ in 0..ROUNDS {
            let next = self.tolerances?.beside((candidates, masks), &first.members, runs)?;
            if place.as_ref().is_some_and(|known| Arc::ptr_eq(known, &next)) {
                break;
            }
            refined(self.workshop, (candidates, masks), (&next, first), runs);
            place = Some(next);
        }
        place
    }

    /// Searches for members in addition to the first.
    fn further(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        (mut now, mut first): (Converged, Chosen),
        runs: &mut Runs,
    ) -> Converged {
        let Place { whitener, z, .. } = self.place;
        let count = first.members.len();
        let fitter =
            Fitter::knowing(whitener, candidates, masks.to_vec(), std::mem::take(&mut now.known));
        refit(&fitter, z, &mut first);
        let mut near = Sets::new(&fitter, z).further(&first, &now.bars);
        now.known = fitter.whitened;
        near.retain(|fit| {
            let of = &candidates[fit.candidate];
            let far = (self.far)(of, fit.size) >= FAR * now.bars.tolerance_sd;
            fit.evidence >= WORTH && far && self.is_simulated(of) && plausible(of, fit.size)
        });
        near.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        near.truncate(TRIED);
        // Without new tolerances the search would give the same result.
        let anew = !self.place.is_alone();
        if near.is_empty() && !anew {
            return now;
        }
        let there = if near.is_empty() {
            None
        } else {
            self.there((candidates, masks), &first.members, runs)
        };
        let tried: Vec<(usize, Candidate)> =
            near.iter().map(|fit| (fit.candidate, candidates[fit.candidate].clone())).collect();
        if let Some(there) = there {
            near.iter().for_each(|fit| {
                self.place_beside(&mut candidates[fit.candidate], fit.size, &there, runs)
            });
        }
        let fitter =
            Fitter::knowing(whitener, candidates, masks.to_vec(), std::mem::take(&mut now.known));
        let tried_now =
            |refused: &Refused| anew || tried.iter().any(|(at, _)| *at == refused.fitted.candidate);
        let (again, refused) = now.refused.into_iter().partition::<Vec<_>, _>(tried_now);
        now.refused = refused;
        let barred = now.refused.iter().map(|refused| refused.fitted.candidate).collect();
        let guard = |fit: &Fitted, chosen: &Chosen| self.guard(&fitter, chosen, fit);
        let of = Conditions { bars: &now.bars, far: self.far, guard: &guard };
        now.chosen = Sets::new(&fitter, z).search(&first, barred, &of, &mut now.refused);
        now.known = fitter.whitened;
        // A candidate refused before stays refused unless it is named together with the first
        // member.
        let known: Vec<usize> = now
            .chosen
            .members
            .iter()
            .chain(now.refused.iter().map(|refused| &refused.fitted))
            .map(|fit| fit.candidate)
            .collect();
        now.refused
            .extend(again.into_iter().filter(|refused| !known.contains(&refused.fitted.candidate)));
        for (at, alone) in tried {
            if now.chosen.members.iter().all(|member| member.candidate != at) {
                candidates[at] = alone;
            }
        }
        now = self.simulated((candidates, masks), now, runs);
        self.settled((candidates, masks), (now, count), runs)
    }

    /// Simulates the last member again with the present sizes of the others, at its own size and at
    /// sizes to either side.
    fn settled(
        &self,
        (candidates, masks): (&mut [Candidate], &[Mask]),
        (mut now, count): (Converged, usize),
        runs: &mut Runs,
    ) -> Converged {
        for _ in 0..ROUNDS {
            let Some(last) = now.chosen.members.get(count) else { break };
            let (first, candidate) = (&now.chosen.members[..count], &candidates[last.candidate]);
            let Some(placed) = &candidate.beside else { break };
            let moved = first
                .iter()
                .zip(&placed.there.sizes)
                .any(|(member, from)| (member.size - from).abs() > MOVED * from.abs());
            let ends = [candidate.nodes.first(), candidate.nodes.last()]
                .into_iter()
                .flatten()
                .any(|node| node.size == last.size);
            let beyond = ends
                && around(&placed.alone, last.size)
                    .iter()
                    .any(|size| candidate.nodes.iter().all(|node| node.size != *size));
            if !(moved || beyond) {
                break;
            }
            let (at, size) = (last.candidate, last.size);
            let Some(there) = self.there((candidates, masks), first, runs) else { break };
            self.place_beside(&mut candidates[at], size, &there, runs);
            let fitter = Fitter::knowing(
                &self.place.whitener,
                candidates,
                masks.to_vec(),
                std::mem::take(&mut now.known),
            );
            refit(&fitter, &self.place.z, &mut now.chosen);
            now.known = fitter.whitened;
            now = self.simulated((candidates, masks), now, runs);
        }
        now
    }

    fn is_simulated(&self, candidate: &Candidate) -> bool {
        self.workshop
            .catalogue
            .effect(&candidate.effect)
            .is_some_and(|effect| matches!(effect.action, Action::Simulator))
    }

    /// The simulation with members; nothing where one of them cannot be set, or where the
    /// simulation fails.
    fn there(
        &self,
        (candidates, masks): (&[Candidate], &[Mask]),
        members: &[Fitted],
        runs: &mut Runs,
    ) -> Option<Arc<Beside>> {
        let bench = self.workshop.bench?;
        let set = members
            .iter()
            .map(|member| set(self.workshop, &candidates[member.candidate], masks, member))
            .collect::<Option<_>>()?;
        let (candidates, sizes) =
            members.iter().map(|member| (member.candidate, member.size)).unzip();
        let mut there = Beside { set, base: Vec::new(), members: candidates, sizes };
        runs.made += self.workshop.seen.sections.len();
        there.base = there.on(bench).features(&[]).ok()?;
        Some(Arc::new(there))
    }

    /// Simulates a candidate together with the members: at its fitted size, and at existing sizes
    /// to either side.
    fn place_beside(
        &self,
        candidate: &mut Candidate,
        size: f64,
        there: &Arc<Beside>,
        runs: &mut Runs,
    ) {
        let alone = match candidate.beside.take() {
            Some(placed) => placed.alone,
            None => Arc::new(candidate.nodes.clone()),
        };
        let sizes = around(&alone, size);
        candidate.nodes.retain(|node| node.change.is_empty());
        candidate.beside = Some(Placed { there: there.clone(), alone });
        sizes.into_iter().for_each(|size| self.workshop.add_size(candidate, size, runs));
    }
}

/// A size, and the nearest nodes below and above it that are on the same side of neutral and at
/// least [`APART`] away, or the last node.
fn around(nodes: &[Node], size: f64) -> Vec<f64> {
    let neutral = nodes.iter().find(|node| node.change.is_empty()).map_or(0.0, |node| node.size);
    let reach = APART * if neutral.is_finite() { (size - neutral).abs() } else { size.abs() };
    let alike = |node: &&Node| {
        node.size.is_finite() && node.size != neutral && (neutral < node.size) == (neutral < size)
    };
    let sizes: Vec<f64> = nodes.iter().filter(alike).map(|node| node.size).collect();
    let below = sizes
        .iter()
        .rev()
        .find(|other| **other < size - reach)
        .or(sizes.first().filter(|first| **first < size));
    let above = sizes
        .iter()
        .find(|other| **other > size + reach)
        .or(sizes.last().filter(|last| **last > size));
    below.into_iter().chain([&size]).chain(above).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(of: &[f64], neutral: f64, size: f64) -> Vec<f64> {
        let node = |size: &f64| Node {
            size: *size,
            change: if *size == neutral { Vec::new() } else { vec![1.0] },
        };
        around(&of.iter().map(node).collect::<Vec<_>>(), size)
    }

    #[test]
    fn sizes_to_either_side_are_some_way_off() {
        // 0.15 of 0.3 is 0.045: 0.52 and 0.48 are too close; 0.1 is on the other side of 0.2.
        let friction = [0.1, 0.2, 0.3, 0.4, 0.48, 0.5, 0.52, 0.6];
        assert_eq!(sizes(&friction, 0.2, 0.5), [0.4, 0.5, 0.6]);
        assert_eq!(sizes(&friction, 0.2, 0.59), [0.52, 0.59, 0.6]);
        assert_eq!(sizes(&friction, 0.2, 0.6), [0.52, 0.6]);
        assert_eq!(sizes(&friction, 0.2, 0.15), [0.1, 0.15]);
        // A low-pass has no influence at an infinite frequency.
        assert_eq!(sizes(&[4.0, 8.0, f64::INFINITY], f64::INFINITY, 7.5), [4.0, 7.5, 8.0]);
    }
}
