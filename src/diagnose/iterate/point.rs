//! The linearisation at a point: difference, allowed difference and candidates, simulated together
//! with the effects found so far. A vehicle with low damping is sensitive to a stiffness that has
//! no influence otherwise, and a body on its bump stops answers to cant and track in another way.

use std::sync::Arc;

use crate::diagnose::fit::fitter::Fitted;
use crate::diagnose::levels::{
    covariance::NOTHING,
    further::SAME,
    point::{ALIKE, APART, JUMP, MATTERS},
};
use crate::diagnose::linearise::{
    candidate::{Beside, Candidate, Node},
    covariance::{Sensitivity, covariance, expect},
    mask::Mask,
    sensitivity::sensitivities,
    whiten::{Covariance, Whitener, dot, less, plus},
    workshop::{Workshop, applied},
};
use crate::diagnose::observe::{
    bench::{Bench, Runs, Set},
    layout::Kind,
};
use crate::diagnose::settings::Settings;
use crate::effects::{Action, Applied};
use crate::simulate::Plan;

/// The linearisation at a point.
#[derive(Debug)]
pub struct Linearisation {
    pub candidates: Vec<Candidate>,
    /// Sensitivities to the tolerances.
    pub columns: Vec<Option<Sensitivity>>,
    /// Measured - simulated, without the expected deviation of the tolerances. The changes of the
    /// members at their sizes add up to the change of the simulation with all of them.
    pub difference: Vec<f64>,
    pub covariance: Covariance,
    pub whitener: Whitener,
    /// The whitened difference.
    pub z: Vec<f64>,
}

impl Linearisation {
    pub fn new(
        candidates: Vec<Candidate>,
        columns: Vec<Option<Sensitivity>>,
        covariance: Covariance,
        difference: Vec<f64>,
    ) -> Self {
        let whitener = covariance.whitener();
        let z = whitener.apply(&difference);
        Self { candidates, columns, difference, covariance, whitener, z }
    }
}

/// What a linearisation is computed from.
#[allow(missing_debug_implementations)]
pub struct Linearise<'a> {
    pub workshop: &'a Workshop<'a>,
    pub settings: &'a Settings,
    /// The value of a parameter where no setting changes it.
    pub value: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    pub declared: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    pub masks: &'a [Mask],
}

impl Linearise<'_> {
    /// Without effects.
    pub fn without_effects(&self, candidates: Vec<Candidate>) -> Linearisation {
        let ground = self.workshop.ground;
        let columns = ground.columns.clone();
        let mut difference = ground.whole.clone();
        let sensitivities: Vec<Sensitivity> = columns.iter().flatten().cloned().collect();
        expect(&sensitivities, &mut difference);
        Linearisation::new(candidates, columns, self.covariance(&sensitivities), difference)
    }

    /// At the members of a fit, with `further` candidates simulated beside them as well. `near` is
    /// at the same members with other sizes: it has the tolerances already. Nothing where no member
    /// changes the response to others, or where a simulation fails.
    pub fn at(
        &self,
        (nominal, near): (&Linearisation, Option<&Linearisation>),
        members: &[Fitted],
        further: &[Fitted],
        runs: &mut Runs,
    ) -> Option<Linearisation> {
        let bench = self.workshop.bench?;
        let of = |fit: &Fitted| &nominal.candidates[fit.candidate];
        // An operation on the signals that is no exchange or inversion does not change the effect
        // of a tolerance.
        let moves = |fit: &Fitted| of(fit).discrete || self.is_simulated(of(fit));
        if !members.iter().any(moves) {
            return None;
        }
        (self.workshop.trying)("responses and tolerances with the effects");
        let sets: Vec<(&Fitted, Option<Set>)> =
            members.iter().map(|member| (member, self.set(of(member), member))).collect();
        let present = |keep: &dyn Fn(&Fitted) -> bool, runs: &mut Runs| -> Option<Arc<Beside>> {
            let kept = sets.iter().filter(|(member, _)| keep(member));
            let mut beside =
                Beside { set: kept.filter_map(|(_, set)| set.clone()).collect(), base: Vec::new() };
            if beside.set.is_empty() {
                return None;
            }
            runs.made += self.workshop.seen.sections.len();
            beside.base = beside.on(bench).features(&[]).ok()?;
            Some(Arc::new(beside))
        };
        let all = present(&|_| true, runs)?;
        let mut candidates = nominal.candidates.clone();
        let mut interaction = all.base.clone();
        let simulated: Vec<&Fitted> =
            members.iter().filter(|member| self.is_simulated(of(member))).collect();
        for member in &simulated {
            let others = present(&|other| other.candidate != member.candidate, runs);
            let base = others.as_ref().map_or(&self.workshop.ground.base, |others| &others.base);
            // f(all) - f(none simulated) - sum of [f(all) - f(all but one)]
            interaction = plus(&less(&interaction, &all.base), base);
            if others.is_some() {
                self.place(&mut candidates[member.candidate], member.size, others, runs);
            }
        }
        let operations = present(&|member| !self.is_simulated(of(member)), runs);
        let base = operations.as_ref().map_or(&self.workshop.ground.base, |of| &of.base);
        interaction = less(&interaction, base);
        let beside = further.iter().filter(|fit| self.is_simulated(of(fit)));
        for fit in beside.filter(|fit| members.iter().all(|one| one.candidate != fit.candidate)) {
            self.place(&mut candidates[fit.candidate], fit.size, Some(all.clone()), runs);
        }
        let columns = match near {
            Some(near) => near.columns.clone(),
            None => self.tolerances(&all.on(bench), &all.base, (nominal, members), runs),
        };
        let mut difference = less(&self.workshop.ground.whole, &interaction);
        let sensitivities: Vec<Sensitivity> = columns.iter().flatten().cloned().collect();
        expect(&sensitivities, &mut difference);
        let mut covariance = self.covariance(&sensitivities);
        self.leave_out_jumps(&mut covariance, &candidates, &simulated);
        Some(Linearisation::new(candidates, columns, covariance, difference))
    }

    /// Simulates the fitted sizes where no close size exists; returns whether there was any.
    pub fn polish(&self, candidates: &mut [Candidate], fits: &[Fitted], runs: &mut Runs) -> bool {
        let mut added = false;
        for member in fits {
            let candidate = &mut candidates[member.candidate];
            let known = candidate
                .nodes
                .iter()
                .any(|node| (node.size - member.size).abs() <= ALIKE * member.size.abs());
            if !candidate.discrete && member.size.is_finite() && !known {
                self.workshop.add_size(candidate, member.size, runs);
                added = true;
            }
        }
        added
    }

    fn is_simulated(&self, candidate: &Candidate) -> bool {
        let effect = self.workshop.catalogue.effect(&candidate.effect);
        effect.is_some_and(|effect| matches!(effect.action, Action::Simulator))
    }

    /// A member as a common setting of all simulations: parameters of the simulator, or operations
    /// on its signals.
    fn set(&self, candidate: &Candidate, member: &Fitted) -> Option<Set> {
        let effect = self
            .workshop
            .catalogue
            .effect(&candidate.effect)
            .filter(|effect| !matches!(effect.action, Action::Formulas(_)))?;
        if !member.size.is_finite() {
            return None;
        }
        let mut values = candidate.fixed.clone();
        values.push((candidate.size.clone(), member.size));
        let effects = [Applied { channels: candidate.channels.clone(), ..applied(effect, values) }];
        let simulator = self.workshop.bench?.simulator.catalogue_name();
        let section = &self.workshop.seen.sections[0].section;
        let plan = Plan::new(self.workshop.catalogue, &effects, section, simulator).ok()?;
        let sections = (member.mask != 0).then(|| self.masks[member.mask].sections.clone());
        Some(Set { plan, sections })
    }

    /// Simulates a candidate together with others: at its fitted size, and at existing sizes to
    /// either side.
    fn place(
        &self,
        candidate: &mut Candidate,
        size: f64,
        others: Option<Arc<Beside>>,
        runs: &mut Runs,
    ) {
        let sizes = around(&candidate.nodes, size);
        candidate.nodes.retain(|node| node.change.is_empty());
        candidate.beside = others;
        candidate.pending.clear();
        sizes.into_iter().for_each(|size| self.workshop.add_size(candidate, size, runs));
    }

    /// The sensitivities to the tolerances that matter, simulated again.
    fn tolerances(
        &self,
        there: &Bench<'_>,
        base: &[f64],
        (nominal, members): (&Linearisation, &[Fitted]),
        runs: &mut Runs,
    ) -> Vec<Option<Sensitivity>> {
        let others = self.covariance(&[]).whitener();
        let long = |column: &Sensitivity| {
            let z = others.apply(&column.column);
            dot(&z, &z) >= MATTERS * MATTERS
        };
        let matters: Vec<bool> =
            nominal.columns.iter().map(|column| column.as_ref().is_some_and(long)).collect();
        let (value, declared) = (self.value, self.declared);
        let wanted = |at: usize| matters[at];
        let again = sensitivities(there, self.settings, base, value, declared, &wanted, runs);
        let mut columns: Vec<Option<Sensitivity>> = again
            .into_iter()
            .zip(&nominal.columns)
            .map(|(again, nominal)| again.or(nominal.clone()))
            .collect();
        // A tolerance whose size a member of all sections gives is fixed, except for its scatter
        // between sections: of several parameters with one name, those with the same change.
        let z = |change: &[f64]| others.apply(change);
        let long = |z: &[f64]| dot(z, z).sqrt();
        for member in members.iter().filter(|member| member.mask == 0) {
            let of = &nominal.candidates[member.candidate];
            let given = of.tolerance.as_ref();
            let far = |node: &&Node| (node.size - member.size).abs();
            let changed = of.nodes.iter().filter(|node| !node.change.is_empty());
            let nearest = changed.min_by(|a, b| far(a).total_cmp(&far(b)));
            let change = nearest.map_or_else(Vec::new, |node| z(&node.change));
            let of_name = |column: &&mut Sensitivity| Some(&column.tolerance) == given;
            let several = columns.iter_mut().flatten().filter(of_name).count() > 1;
            for column in columns.iter_mut().flatten().filter(of_name) {
                let own = z(&column.column);
                let alike = dot(&own, &change).abs() > SAME * long(&own) * long(&change);
                if alike || !several {
                    column.shared = 0.0;
                }
            }
        }
        columns
    }

    fn covariance(&self, columns: &[Sensitivity]) -> Covariance {
        let (ground, seen) = (self.workshop.ground, self.workshop.seen);
        let standing = Some(&ground.standing);
        covariance(seen, self.settings, &ground.simulated, columns, self.declared, standing)
    }

    /// Excludes lags that jump to another period near the size of a member.
    fn leave_out_jumps(
        &self,
        covariance: &mut Covariance,
        candidates: &[Candidate],
        members: &[&Fitted],
    ) {
        let seen = self.workshop.seen;
        let lags = seen.features.iter().enumerate().filter(|(_, of)| of.kind == Kind::Lag);
        for (at, feature) in lags {
            let sd = self.settings.groups[seen.layout.channels[feature.channel].group].lag_sd;
            for place in (0..seen.sections.len()).map(|section| seen.place(section, at)) {
                let jumps = |member: &&Fitted| {
                    candidates[member.candidate].range_near(member.size, place) > JUMP * sd
                };
                if members.iter().any(jumps) {
                    covariance.diagonal[place] = NOTHING;
                }
            }
        }
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
