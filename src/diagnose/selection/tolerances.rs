//! Tolerances simulated together with the members of an answer.

use std::sync::{Arc, Mutex, MutexGuard};

use crate::diagnose::features::bench::{Bench, Runs, Set};
use crate::diagnose::features::observations::Observations;
use crate::diagnose::inference::fit::Fitted;
use crate::diagnose::inputs::{Inputs, value_of};
use crate::diagnose::levels::place::MATTERS;
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::ground::{Ground, bench};
use crate::diagnose::response::mask::Mask;
use crate::diagnose::response::workshop::{Workshop, applied};
use crate::diagnose::selection::place::{Place, Places};
use crate::diagnose::settings::Settings;
use crate::diagnose::uncertainty::covariance::{Sensitivity, covariance, expect};
use crate::diagnose::uncertainty::declared::Declared;
use crate::diagnose::uncertainty::sensitivity::sensitivities;
use crate::diagnose::uncertainty::whiten::{Covariance, dot};
use crate::effects::{Action, Applied};
use crate::simulate::Plan;

/// A member as a common setting of all simulations: parameters of the simulator, or operations on
/// its signals.
#[must_use]
pub fn set(
    workshop: &Workshop<'_>,
    candidate: &Candidate,
    masks: &[Mask],
    member: &Fitted,
) -> Option<Set> {
    let effect = workshop
        .catalogue
        .effect(&candidate.effect)
        .filter(|effect| !matches!(effect.action, Action::Formulas(_)))?;
    if !member.size.is_finite() {
        return None;
    }
    let mut values = candidate.fixed.clone();
    values.push((candidate.size.clone(), member.size));
    let effects = [Applied { channels: candidate.channels.clone(), ..applied(effect, values) }];
    let simulator = workshop.bench?.simulator.catalogue_name();
    let plan =
        Plan::new(workshop.catalogue, &effects, &workshop.seen.sections[0].section, simulator)
            .ok()?;
    Some(Set { plan, sections: (member.mask != 0).then(|| masks[member.mask].sections.clone()) })
}

/// Computation of weighings with members, and those computed so far.
#[allow(missing_debug_implementations)]
pub struct Tolerances<'a> {
    pub workshop: &'a Workshop<'a>,
    pub settings: &'a Settings,
    /// The value of a parameter where no setting changes it.
    pub value: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    pub declared: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    /// Weighings computed so far.
    pub places: Mutex<Places>,
}

impl Tolerances<'_> {
    /// The weighing with members; nothing where none of them changes the effect of the tolerances,
    /// or where a simulation fails.
    #[must_use]
    pub fn beside(
        &self,
        of: (&[Candidate], &[Mask]),
        members: &[Fitted],
        runs: &mut Runs,
    ) -> Option<Arc<Place>> {
        if let Some(known) = self.looked_at().near(members) {
            return Some(known);
        }
        let (covariance, difference) = self.simulated(of, members, runs)?;
        let mut place = Place::new(covariance, difference);
        place.members =
            members.iter().map(|member| (member.candidate, member.mask, member.size)).collect();
        let place = Arc::new(place);
        self.looked_at().push(place.clone());
        Some(place)
    }

    /// The weighings computed so far.
    pub fn looked_at(&self) -> MutexGuard<'_, Places> {
        self.places.lock().expect("no thread stops with it")
    }

    /// Simulates the tolerances with the members set: covariance, and the difference without the
    /// expected deviation. Nothing where no member can be set, or where a simulation fails.
    fn simulated(
        &self,
        (candidates, masks): (&[Candidate], &[Mask]),
        members: &[Fitted],
        runs: &mut Runs,
    ) -> Option<(Covariance, Vec<f64>)> {
        let bench = self.workshop.bench?;
        let added: Vec<Set> = members
            .iter()
            .filter_map(|member| self.set(&candidates[member.candidate], masks, member))
            .collect();
        if added.is_empty() {
            return None;
        }
        (self.workshop.trying)("sensitivities to the tolerances, with the effects");
        let set = bench.set.iter().cloned().chain(added).collect();
        let there = Bench { set, cache: bench.cache.clone(), ..*bench };
        let base = there.features(&[]).ok()?;
        let matters = self.matter();
        let again = sensitivities(
            &there,
            self.settings,
            &base,
            self.value,
            self.declared,
            &|at| matters[at],
            runs,
        );
        let mut columns: Vec<Sensitivity> = again
            .into_iter()
            .zip(&self.workshop.ground.columns)
            .filter_map(|(again, first)| again.or(first.clone()))
            .collect();
        // A tolerance whose size a member of all sections gives is fixed, except for its scatter
        // between sections.
        for member in members.iter().filter(|member| member.mask == 0) {
            let given = candidates[member.candidate].tolerance.as_ref();
            columns
                .iter_mut()
                .filter(|column| Some(&column.tolerance) == given)
                .for_each(|column| column.shared = 0.0);
        }
        let mut difference = self.workshop.ground.whole.clone();
        expect(&columns, &mut difference);
        Some((self.of(&columns), difference))
    }

    fn of(&self, columns: &[Sensitivity]) -> Covariance {
        let ground = self.workshop.ground;
        covariance(
            self.workshop.seen,
            self.settings,
            &ground.simulated,
            columns,
            self.declared,
            Some(&ground.standing),
        )
    }

    /// Which columns are relevant.
    fn matter(&self) -> Vec<bool> {
        let others = self.of(&[]).whitener();
        let long = |column: &Sensitivity| {
            let z = others.apply(&column.column);
            dot(&z, &z) >= MATTERS * MATTERS
        };
        self.workshop
            .ground
            .columns
            .iter()
            .map(|column| column.as_ref().is_some_and(long))
            .collect()
    }

    /// The settings of a member, or its exchange or inversion of signals: the guiding force of
    /// another wheel depends on other tolerances. Other operations on the signals do not change the
    /// effect of the tolerances.
    fn set(&self, candidate: &Candidate, masks: &[Mask], member: &Fitted) -> Option<Set> {
        let effect = self.workshop.catalogue.effect(&candidate.effect)?;
        let moves = matches!(effect.action, Action::Simulator) || candidate.discrete;
        if moves { set(self.workshop, candidate, masks, member) } else { None }
    }
}

impl Ground {
    /// The weighing without effects, and the covariance of noise and tolerances alone.
    #[must_use]
    pub fn alone(
        &self,
        settings: &Settings,
        seen: &Observations,
        admitted: &Declared,
    ) -> (Place, Covariance) {
        let columns: Vec<Sensitivity> = self.columns.iter().flatten().cloned().collect();
        let mut difference = self.whole.clone();
        expect(&columns, &mut difference);
        let declared = |name: &str| admitted.get(name);
        let with =
            |standing| covariance(seen, settings, &self.simulated, &columns, &declared, standing);
        (Place::new(with(Some(&self.standing)), difference), with(None))
    }

    /// Runs `R` with candidates and weighings on this basis.
    pub fn work<R>(
        &self,
        inputs: &Inputs<'_>,
        seen: &Observations,
        admitted: &Declared,
        places: Places,
        with: impl FnOnce(&Tolerances<'_>) -> R,
    ) -> R {
        let declared = |name: &str| admitted.get(name);
        let value = |key: &str| value_of(inputs.campaign, key);
        let bench = bench(inputs, seen);
        let (catalogue, trying) = (inputs.catalogue, inputs.trying);
        let workshop = Workshop {
            seen,
            catalogue,
            bench: bench.as_ref(),
            ground: self,
            neutral: &value,
            trying,
        };
        let (settings, places) = (inputs.settings, Mutex::new(places));
        with(&Tolerances {
            workshop: &workshop,
            settings,
            value: &value,
            declared: &declared,
            places,
        })
    }
}
