//! The old protocol with sets of changed rules, compiled when they are asked for.

use std::{
    collections::{BTreeSet, HashMap},
    sync::{Arc, Mutex, PoisonError},
};

use super::touched::{Key, MOST, Mask, Touched, bit};
use crate::certify::{Compiled, compile};
use crate::check::{Overrides, family::Family};
use crate::compare::of_protocol;
use crate::problem::{Problem, Problems, Severity};

/// So many rules that touch one part of a verdict are combined in all ways; of more, each alone and
/// all together. Each combination is a protocol that is checked and judged.
const MOST_COMBINED: u32 = 10;

/// A protocol, and how it makes its values.
#[derive(Debug)]
pub struct Variant {
    pub compiled: Compiled,
    pub key: Key,
}

/// The protocols between the old and the new one, with the same parameters.
#[derive(Debug)]
pub struct Variants<'a> {
    touched: &'a Touched,
    old: &'a Family,
    overrides: Overrides,
    /// Why one is not valid: the first problem.
    known: Mutex<HashMap<Mask, Result<Arc<Variant>, String>>>,
}

impl<'a> Variants<'a> {
    /// # Errors
    /// The old or the new protocol is not valid with these parameters.
    pub fn new(
        touched: &'a Touched,
        [old, new]: [&'a Family; 2],
        overrides: Overrides,
        problems: &mut Problems,
    ) -> Option<Self> {
        let found = Self { touched, old, overrides, known: Mutex::default() };
        for (family, mask) in [(old, 0), (new, touched.all())] {
            let mut own = Problems::default();
            let compiled =
                compile(family.clone(), &of_protocol(family, &found.overrides), &mut own);
            // A warning is told once, not for each campaign.
            let again = |says: &String| problems.0.iter().any(|known| known.says == *says);
            let new: Vec<_> = own
                .0
                .into_iter()
                .filter(|one| one.severity == Severity::Error || !again(&one.says))
                .collect();
            problems.add(new);
            let compiled = compiled?;
            if let Some(rule) = compiled.plan.by_draws() {
                let says = "`impact` puts verdicts together from single limits, and this one is \
                            decided by draws of the sections";
                problems.push(Problem::error("impact-verdict", says).at(&rule.span).help(
                    "compare the texts without `in ... of draws`; `fishplate compare` takes them \
                     as they are",
                ));
                return None;
            }
            drop(found.keep(mask, Ok(compiled)));
        }
        Some(found)
    }

    fn keep(&self, mask: Mask, found: Result<Compiled, String>) -> Result<Arc<Variant>, String> {
        let found = found
            .map(|compiled| Arc::new(Variant { key: Key::of(&compiled.family.merged), compiled }));
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        // Two threads that make the same one keep the first.
        known.entry(mask).or_insert(found).clone()
    }

    /// The old protocol with a set of changed rules.
    ///
    /// # Errors
    /// It is not valid, since a rule needs another one: the first problem.
    pub fn get(&self, mask: Mask) -> Result<Arc<Variant>, String> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&mask).cloned();
        if let Some(known) = known {
            return known;
        }
        let mut merged = self.old.merged.clone();
        for (at, change) in self.touched.changes.iter().enumerate() {
            if mask & bit(at) != 0 {
                merged = change.applied(&merged);
            }
        }
        let family = Family { merged, ..self.old.clone() };
        let (overrides, mut problems) =
            (of_protocol(&family, &self.overrides), Problems::default());
        let compiled = compile(family, &overrides, &mut problems);
        let error = problems.0.into_iter().find(|problem| problem.severity == Severity::Error);
        let found = match (compiled, error) {
            (Some(compiled), None) => Ok(compiled),
            (_, error) => Err(error.map_or_else(String::new, |error| error.says)),
        };
        self.keep(mask, found)
    }

    /// Number of protocols that were compiled.
    pub fn compiled(&self) -> usize {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}

/// Protocols that show every part of a verdict under every combination of the rules that touch it.
#[derive(Debug)]
pub struct Cover {
    /// Valid ones, the old and the new one first.
    pub masks: Vec<Mask>,
    /// Whether all combinations are looked at.
    pub complete: bool,
    /// Of each part, the combinations that are refused for the same reason whether all other rules
    /// are the old or the new ones.
    pub refused: Vec<BTreeSet<Mask>>,
}

/// The combinations of a set of rules, and whether these are all.
fn combinations(of: Mask) -> (BTreeSet<Mask>, bool) {
    let all = of.count_ones() <= MOST_COMBINED;
    if !all {
        let alone = (0..Mask::BITS).map(|at| 1 << at).filter(|bit| of & bit != 0);
        return (alone.chain([0, of]).collect(), false);
    }
    let next = |found: &Mask| (*found != of).then(|| found.wrapping_sub(of) & of);
    (std::iter::successors(Some(0), next).collect(), true)
}

/// One protocol shows several parts at once, each under a combination that was not yet seen.
pub fn cover(parts: &[Mask], variants: &Variants<'_>) -> Cover {
    let all = variants.touched.all();
    let (mut pending, complete): (Vec<BTreeSet<Mask>>, Vec<bool>) =
        parts.iter().map(|part| combinations(*part)).unzip();
    let mut refused = vec![BTreeSet::new(); parts.len()];
    let mut masks = Vec::new();
    let mut take = |mask: Mask, pending: &mut Vec<BTreeSet<Mask>>| {
        masks.push(mask);
        for (pending, part) in pending.iter_mut().zip(parts) {
            pending.remove(&(mask & part));
        }
    };
    take(0, &mut pending);
    if all != 0 {
        take(all, &mut pending);
    }
    while let Some((at, first)) =
        pending.iter().enumerate().find_map(|(at, left)| Some((at, *left.first()?)))
    {
        let (mut mask, mut fixed) = (first, parts[at]);
        for (left, part) in pending.iter().zip(parts) {
            let fits = |one: &&Mask| **one & fixed == mask & part;
            if let Some(more) = left.iter().find(fits) {
                mask |= more;
                fixed |= part;
            }
        }
        // What the part does not depend on may not be valid with it.
        let tries = [mask, first, first | all & !parts[at]];
        match tries.into_iter().find(|mask| variants.get(*mask).is_ok()) {
            Some(mask) => take(mask, &mut pending),
            None => {
                pending[at].remove(&first);
                if variants.get(first).err() == variants.get(tries[2]).err() {
                    refused[at].insert(first);
                }
            }
        }
    }
    let apart = variants.touched.changes.len() <= MOST;
    Cover { masks, refused, complete: apart && complete.into_iter().all(|complete| complete) }
}
