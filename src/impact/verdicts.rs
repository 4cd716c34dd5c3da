//! The verdict of a campaign under any set of changed rules, put together from what its parts come
//! to under the rules that touch them.

use std::{collections::HashMap, sync::Arc};

use super::{
    source::Made,
    touched::{Mask, Touched},
    variants::{Cover, Variant, Variants},
};
use crate::check::plan::Plan;
use crate::result::{Outcome, QuantityResult, Reason};
use crate::run::{Evaluated, Given, Judged, overall};

/// What is the same for every campaign.
#[derive(Debug)]
pub struct Frame<'a> {
    pub touched: &'a Touched,
    pub variants: &'a Variants<'a>,
    pub cover: &'a Cover,
    /// What touches each part: first all sections, then each quantity, at last what decides.
    pub parts: &'a [Mask],
}

/// The parts of a verdict.
pub fn parts(touched: &Touched) -> Vec<Mask> {
    let quantities = touched.quantities.values().copied();
    std::iter::once(touched.everywhere).chain(quantities).chain([touched.verdicts]).collect()
}

/// What a part comes to, as far as a verdict depends on it.
#[derive(Clone, Debug)]
enum State {
    /// All sections: why no verdict can be given.
    Sections(Vec<Reason>),
    /// The campaign cannot be evaluated.
    Nothing,
    Quantity(Box<(QuantityResult, Vec<Reason>)>),
    /// What decides, by the number of its protocol.
    Decides(usize),
}

impl State {
    /// Whether every verdict is the same with both.
    fn same(&self, other: &Self) -> bool {
        let counts = |of: &QuantityResult| {
            let reason = of.reason.as_ref().map(Reason::is_of_optional);
            let limits = of.statistics.iter().map(|one| one.holds);
            (of.holds, reason, limits.collect::<Vec<_>>())
        };
        match (self, other) {
            (Self::Sections(a), Self::Sections(b)) => a.is_empty() == b.is_empty(),
            (Self::Quantity(a), Self::Quantity(b)) => {
                counts(&a.0) == counts(&b.0) && a.1.is_empty() == b.1.is_empty()
            }
            (Self::Decides(a), Self::Decides(b)) => a == b,
            (a, b) => matches!((a, b), (Self::Nothing, Self::Nothing)),
        }
    }
}

/// The states of a part, and the number of its state under each combination.
#[derive(Debug, Default)]
struct Table {
    states: Vec<State>,
    under: HashMap<Mask, u8>,
}

impl Table {
    fn put(&mut self, mask: Mask, state: State) {
        let known = self.states.iter().position(|known| known.same(&state));
        let number = known.unwrap_or_else(|| {
            self.states.push(state);
            self.states.len() - 1
        });
        self.under.entry(mask).or_insert(u8::try_from(number).unwrap_or(u8::MAX));
    }

    /// Whether the state depends on a rule.
    fn depends(&self, bit: Mask) -> bool {
        self.states.len() > 1
            && self.under.iter().any(|(mask, state)| {
                self.under.get(&(mask ^ bit)).is_none_or(|other| other != state)
            })
    }
}

/// The verdicts of one campaign.
#[derive(Debug)]
pub struct Verdicts<'a> {
    frame: &'a Frame<'a>,
    made: &'a Made,
    tables: Vec<Table>,
    deciding: Vec<Arc<Variant>>,
    known: HashMap<Vec<u8>, Outcome>,
}

/// What is known of a set of rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    Verdict(Outcome),
    /// The protocol is not valid with it.
    Refused,
    Unknown,
}

impl<'a> Verdicts<'a> {
    pub fn new(frame: &'a Frame<'a>, made: &'a Made) -> Self {
        let tables = frame.parts.iter().map(|_| Table::default()).collect();
        let (deciding, known) = Default::default();
        let mut all = Self { frame, made, tables, deciding, known };
        frame.cover.masks.iter().for_each(|mask| all.look(*mask));
        all
    }

    /// Judges the campaign by a protocol, and keeps what each part comes to.
    fn look(&mut self, mask: Mask) {
        let Frame { touched, variants, parts, .. } = *self.frame;
        let Ok(variant) = variants.get(mask) else { return };
        let everywhere = mask & touched.everywhere;
        let Some(evaluated) = self.made.evaluated(&variant, everywhere) else { return };
        let last = parts.len() - 1;
        let own = |at: usize| mask & parts[at];
        match evaluated.as_ref() {
            Err(_) => self.tables[0].put(own(0), State::Nothing),
            Ok(evaluated) => {
                let Judged { barred, fails, quantities, .. } =
                    evaluated.judge(&variant.compiled.plan);
                self.tables[0].put(own(0), State::Sections(barred));
                for (mut quantity, fails) in quantities.into_iter().zip(fails) {
                    let Some(at) = touched.quantities.get_index_of(&quantity.id) else { continue };
                    quantity.values = Vec::new();
                    let state = State::Quantity(Box::new((quantity, fails)));
                    self.tables[1 + at].put(own(1 + at), state);
                }
            }
        }
        if !self.tables[last].under.contains_key(&own(last)) {
            self.deciding.push(variant);
            self.tables[last].put(own(last), State::Decides(self.deciding.len() - 1));
        }
    }

    /// All changed rules.
    pub fn all(&self) -> Mask {
        self.frame.touched.all()
    }

    /// The rules on which some part depends.
    pub fn relevant(&self) -> Vec<Mask> {
        let all = self.all();
        let bits = (0..Mask::BITS).map(|at| 1 << at).filter(|bit| all & bit != 0);
        let depends = |bit: &Mask| {
            self.tables
                .iter()
                .zip(self.frame.parts)
                .any(|(table, part)| part & bit != 0 && table.depends(*bit))
        };
        bits.filter(depends).collect()
    }

    /// The verdict under a set of rules.
    pub fn of(&mut self, mask: Mask) -> Found {
        let refused = |(part, refused): (&Mask, &std::collections::BTreeSet<Mask>)| {
            refused.contains(&(mask & part))
        };
        if self.frame.parts.iter().zip(&self.frame.cover.refused).any(refused) {
            return Found::Refused;
        }
        self.put_together(mask).map_or_else(|| self.whole(mask), Found::Verdict)
    }

    /// `None` where a part was not seen under it.
    fn put_together(&mut self, mask: Mask) -> Option<Outcome> {
        let (frame, last) = (self.frame, self.frame.parts.len() - 1);
        let state = |at: usize| self.tables[at].under.get(&(mask & frame.parts[at])).copied();
        let (sections, decides) = (state(0)?, state(last)?);
        let State::Decides(number) = self.tables[last].states[usize::from(decides)] else {
            return None;
        };
        let plan = &self.deciding[number].compiled.plan;
        let place = |id: &String| Some(1 + frame.touched.quantities.get_index_of(id)?);
        let barred = match &self.tables[0].states[usize::from(sections)] {
            State::Sections(barred) => barred,
            _ => return Some(Outcome::NotAssessable),
        };
        let mut key = vec![sections, decides];
        let mut some = Vec::new();
        for quantity in &plan.quantities {
            let at = place(&quantity.id)?;
            let number = state(at)?;
            key.push(number);
            some.push((at, number));
        }
        if let Some(known) = self.known.get(&key) {
            return Some(*known);
        }
        let of = |(at, number): &(usize, u8)| match &self.tables[*at].states[usize::from(*number)] {
            State::Quantity(of) => Some(of.as_ref().clone()),
            _ => None,
        };
        let all: Vec<(QuantityResult, Vec<Reason>)> = some.iter().map(of).collect::<Option<_>>()?;
        let (quantities, fails): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        let found = overall(
            plan,
            &Given { barred: barred.clone(), quantities: &quantities, fails, sample: None },
        );
        self.known.insert(key, found);
        Some(found)
    }

    /// The verdict of the whole protocol with a set of rules.
    pub fn whole(&self, mask: Mask) -> Found {
        let Ok(variant) = self.frame.variants.get(mask) else { return Found::Refused };
        let everywhere = mask & self.frame.touched.everywhere;
        match self.made.evaluated(&variant, everywhere).as_deref() {
            None => Found::Unknown,
            Some(evaluated) => {
                Found::Verdict(outcome(&variant.compiled.plan, evaluated.as_ref().ok()))
            }
        }
    }
}

/// The outcome of the overall verdict; of a campaign that cannot be evaluated, not assessable.
pub fn outcome(plan: &Plan, evaluated: Option<&Evaluated>) -> Outcome {
    evaluated.map_or(Outcome::NotAssessable, |evaluated| decided(plan, &evaluated.judge(plan)))
}

pub fn decided(plan: &Plan, judged: &Judged) -> Outcome {
    let (barred, fails) = (judged.barred.clone(), judged.fails.clone());
    overall(plan, &Given { barred, quantities: &judged.quantities, fails, sample: None })
}
