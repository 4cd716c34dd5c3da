//! Weighing of differences with the tolerances simulated together with members. A vehicle with low damping is sensitive to a stiffness
//! that has no influence otherwise, and short waves matter less where others are present.

use std::sync::{Arc, Mutex, MutexGuard};

use super::beside::set;
use super::candidates::{Candidate, Workshop};
use super::fit::{Fitted, Mask};
use crate::diagnose::allowed::covariance::{Sensitivity, covariance, expect};
use crate::diagnose::allowed::sensitivity::sensitivities;
use crate::diagnose::allowed::whiten::{Covariance, Whitener, dot};
use crate::diagnose::observe::bench::{Bench, Runs, Set};
use crate::diagnose::settings::Settings;
use crate::effects::Action;

/// A tolerance whose change of the features is below this, in standard deviations of all else, is not simulated again: the scatter of
/// contact solutions alone reaches about one.
const MATTERS: f64 = 1.5;

/// Relative difference of sizes up to which the simulated tolerances are reused.
const ALIKE: f64 = 0.1;

/// A weighing: difference and covariance with members, or without effects.
#[derive(Debug)]
pub struct Place {
    /// The members that are simulated with it: candidate, mask and size.
    members: Vec<(usize, usize, f64)>,
    /// Measured - simulated, without the expected deviation of the tolerances simulated with the members.
    pub difference: Vec<f64>,
    pub covariance: Covariance,
    pub whitener: Whitener,
    /// The whitened difference.
    pub z: Vec<f64>,
}

impl Place {
    /// The weighing without effects.
    #[must_use]
    pub fn new(covariance: Covariance, difference: Vec<f64>) -> Self {
        let whitener = covariance.whitener();
        Self { members: Vec::new(), z: whitener.apply(&difference), difference, covariance, whitener }
    }

    #[must_use]
    pub fn is_alone(&self) -> bool {
        self.members.is_empty()
    }

    /// Whether it is for these members, of any size.
    fn is_beside(&self, members: &[Fitted]) -> bool {
        let same = |((candidate, mask, _), member): (&(usize, usize, f64), &Fitted)| (*candidate, *mask) == (member.candidate, member.mask);
        self.members.len() == members.len() && self.members.iter().zip(members).all(same)
    }

    /// Whether it is for these members, of about these sizes.
    fn is_near(&self, members: &[Fitted]) -> bool {
        let near = |((.., size), member): (&(usize, usize, f64), &Fitted)| (size - member.size).abs() <= ALIKE * size.abs();
        self.is_beside(members) && self.members.iter().zip(members).all(near)
    }
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

/// Weighings with members, in order of computation.
#[derive(Clone, Debug, Default)]
pub struct Places(Vec<Arc<Place>>);

impl Places {
    /// The last one for these members, of any size.
    #[must_use]
    pub fn beside(&self, members: &[Fitted]) -> Option<Arc<Place>> {
        self.0.iter().rev().find(|place| place.is_beside(members)).cloned()
    }

    fn near(&self, members: &[Fitted]) -> Option<Arc<Place>> {
        self.0.iter().rev().find(|place| place.is_near(members)).cloned()
    }
}

impl Tolerances<'_> {
    /// The weighing with members; nothing where none of them changes the effect of the tolerances, or where a simulation fails.
    #[must_use]
    pub fn beside(&self, of: (&[Candidate], &[Mask]), members: &[Fitted], runs: &mut Runs) -> Option<Arc<Place>> {
        if let Some(known) = self.looked_at().near(members) {
            return Some(known);
        }
        let (covariance, difference) = self.simulated(of, members, runs)?;
        let mut place = Place::new(covariance, difference);
        place.members = members.iter().map(|member| (member.candidate, member.mask, member.size)).collect();
        let place = Arc::new(place);
        self.looked_at().0.push(place.clone());
        Some(place)
    }

    /// The weighings computed so far.
    pub fn looked_at(&self) -> MutexGuard<'_, Places> {
        self.places.lock().expect("no thread stops with it")
    }

    /// Simulates the tolerances with the members set: covariance, and the difference without the expected deviation. Nothing where no
    /// member can be set, or where a simulation fails.
    fn simulated(
        &self,
        (candidates, masks): (&[Candidate], &[Mask]),
        members: &[Fitted],
        runs: &mut Runs,
    ) -> Option<(Covariance, Vec<f64>)> {
        let bench = self.workshop.bench?;
        let added: Vec<Set> = members.iter().filter_map(|member| self.set(&candidates[member.candidate], masks, member)).collect();
        if added.is_empty() {
            return None;
        }
        (self.workshop.trying)("sensitivities to the tolerances, with the effects");
        let set = bench.set.iter().cloned().chain(added).collect();
        let there = Bench { set, cache: bench.cache.clone(), ..*bench };
        let base = there.features(&[]).ok()?;
        let matters = self.matter();
        let again = sensitivities(&there, self.settings, &base, self.value, self.declared, &|at| matters[at], runs);
        let mut columns: Vec<Sensitivity> =
            again.into_iter().zip(&self.workshop.ground.columns).filter_map(|(again, first)| again.or(first.clone())).collect();
        // A tolerance whose size a member of all sections gives is fixed, except for its scatter between sections.
        for member in members.iter().filter(|member| member.mask == 0) {
            let given = candidates[member.candidate].tolerance.as_ref();
            columns.iter_mut().filter(|column| Some(&column.tolerance) == given).for_each(|column| column.shared = 0.0);
        }
        let mut difference = self.workshop.ground.whole.clone();
        expect(&columns, &mut difference);
        Some((self.of(&columns), difference))
    }

    fn of(&self, columns: &[Sensitivity]) -> Covariance {
        let ground = self.workshop.ground;
        covariance(self.workshop.seen, self.settings, &ground.simulated, columns, self.declared, Some(&ground.standing))
    }

    /// Which columns are relevant.
    fn matter(&self) -> Vec<bool> {
        let others = self.of(&[]).whitener();
        let long = |column: &Sensitivity| {
            let z = others.apply(&column.column);
            dot(&z, &z) >= MATTERS * MATTERS
        };
        self.workshop.ground.columns.iter().map(|column| column.as_ref().is_some_and(long)).collect()
    }

    /// The settings of a member, or its exchange or inversion of signals: the guiding force of another wheel depends on other tolerances.
    /// Other operations on the signals do not change the effect of the tolerances.
    fn set(&self, candidate: &Candidate, masks: &[Mask], member: &Fitted) -> Option<Set> {
        let effect = self.workshop.catalogue.effect(&candidate.effect)?;
        let moves = matches!(effect.action, Action::Simulator) || candidate.discrete;
        if moves { set(self.workshop, candidate, masks, member) } else { None }
    }
}
