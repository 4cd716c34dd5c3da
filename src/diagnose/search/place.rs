//! The tolerances as they act beside members: a body that sways hardly damped moves with a stiffness of which it took no notice before,
//! and short waves matter less where others are added.

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

/// A tolerance that moves the features by less than so many standard deviations of everything else stays as it was: branches of contact
/// alone move them by about one.
const MATTERS: f64 = 1.5;

/// Sizes by which so much of themselves they differ at most have the same tolerances beside them.
const ALIKE: f64 = 0.1;

/// What a difference is weighed by, beside members or beside none.
#[derive(Debug)]
pub struct Place {
    /// The members that it is beside: candidate, mask and size.
    members: Vec<(usize, usize, f64)>,
    /// Measured - simulated, without what is expected of the tolerances as they act here.
    pub difference: Vec<f64>,
    pub covariance: Covariance,
    pub whitener: Whitener,
    /// The whitened difference.
    pub z: Vec<f64>,
}

impl Place {
    /// Beside none.
    #[must_use]
    pub fn new(covariance: Covariance, difference: Vec<f64>) -> Self {
        let whitener = covariance.whitener();
        Self { members: Vec::new(), z: whitener.apply(&difference), difference, covariance, whitener }
    }

    #[must_use]
    pub fn is_alone(&self) -> bool {
        self.members.is_empty()
    }

    /// Whether it is beside these, be it other sizes of them.
    fn is_beside(&self, members: &[Fitted]) -> bool {
        let same = |((candidate, mask, _), member): (&(usize, usize, f64), &Fitted)| (*candidate, *mask) == (member.candidate, member.mask);
        self.members.len() == members.len() && self.members.iter().zip(members).all(same)
    }

    /// Whether it is beside these, of about these sizes.
    fn is_near(&self, members: &[Fitted]) -> bool {
        let near = |((.., size), member): (&(usize, usize, f64), &Fitted)| (size - member.size).abs() <= ALIKE * size.abs();
        self.is_beside(members) && self.members.iter().zip(members).all(near)
    }
}

/// How places are found, and those that were looked at.
#[allow(missing_debug_implementations)]
pub struct Tolerances<'a> {
    pub workshop: &'a Workshop<'a>,
    pub settings: &'a Settings,
    /// What a parameter has where nothing is set.
    pub value: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    pub declared: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    /// Those that were looked at.
    pub places: Mutex<Places>,
}

/// Places beside members, in the order in which they were looked at.
#[derive(Clone, Debug, Default)]
pub struct Places(Vec<Arc<Place>>);

impl Places {
    /// The last that is beside these members, whatever their sizes.
    #[must_use]
    pub fn beside(&self, members: &[Fitted]) -> Option<Arc<Place>> {
        self.0.iter().rev().find(|place| place.is_beside(members)).cloned()
    }

    fn near(&self, members: &[Fitted]) -> Option<Arc<Place>> {
        self.0.iter().rev().find(|place| place.is_near(members)).cloned()
    }
}

impl Tolerances<'_> {
    /// The place beside members as they are in the simulation; nothing where none of them moves what the tolerances do, or where one fails.
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

    /// The places that were looked at.
    pub fn looked_at(&self) -> MutexGuard<'_, Places> {
        self.places.lock().expect("no thread stops with it")
    }

    /// The covariance with the members in the simulation, and the difference without what is expected there; nothing where no member is,
    /// or where one fails.
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
        (self.workshop.trying)("what the tolerances change beside the effects");
        let set = bench.set.iter().cloned().chain(added).collect();
        let there = Bench { set, cache: bench.cache.clone(), ..*bench };
        let base = there.features(&[]).ok()?;
        let matters = self.matter();
        let again = sensitivities(&there, self.settings, &base, self.value, self.declared, &|at| matters[at], runs);
        let mut columns: Vec<Sensitivity> =
            again.into_iter().zip(&self.workshop.ground.columns).filter_map(|(again, first)| again.or(first.clone())).collect();
        // What a member gives the size of is not free any more, but for the scatter of single sections.
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

    /// Which columns matter.
    fn matter(&self) -> Vec<bool> {
        let others = self.of(&[]).whitener();
        let long = |column: &Sensitivity| {
            let z = others.apply(&column.column);
            dot(&z, &z) >= MATTERS * MATTERS
        };
        self.workshop.ground.columns.iter().map(|column| column.as_ref().is_some_and(long)).collect()
    }

    /// What a member sets in the simulator, or exchanges or turns round of its signals: another wheel's guiding force differs by other
    /// tolerances. What else is done to signals leaves them as they are.
    fn set(&self, candidate: &Candidate, masks: &[Mask], member: &Fitted) -> Option<Set> {
        let effect = self.workshop.catalogue.effect(&candidate.effect)?;
        let moves = matches!(effect.action, Action::Simulator) || candidate.discrete;
        if moves { set(self.workshop, candidate, masks, member) } else { None }
    }
}
