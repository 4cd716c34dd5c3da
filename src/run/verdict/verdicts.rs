//! Verdicts: from limits of quantities, from other verdicts, or left to a person.

use std::collections::BTreeMap;

use indexmap::{IndexMap, IndexSet};

use super::draws::{OfDraws, Sample};
use crate::check::plan::{Decision, Over, Plan, Rule};
use crate::result::{
    GivenVerdict, InDraws, OftenNotMet, Outcome, QuantityResult, Reason, Scope, StatisticName,
    StatisticResult, Subject, VerdictResult,
};
use crate::run::limit::rule_place;

/// What verdicts depend on.
#[derive(Debug)]
pub struct Given<'a> {
    /// Why no verdict on limits can be given: missing sections, implausible data.
    pub barred: Vec<Reason>,
    pub quantities: &'a [QuantityResult],
    /// For each quantity, a reason for each limit that is not met.
    pub fails: Vec<Vec<Reason>>,
    /// What rules by draws need: the values of the sections.
    pub sample: Option<Sample<'a>>,
}

#[derive(Clone, Debug)]
pub struct Decided {
    pub outcome: Outcome,
    /// Of several outcomes in order the word of the one that applies.
    pub word: Option<String>,
    pub reasons: Vec<Reason>,
    /// Its rules that were judged in draws.
    pub drawn: Vec<InDraws>,
}

impl Default for Decided {
    fn default() -> Self {
        Self::not_assessable(vec![Reason::NoVerdict])
    }
}

impl Decided {
    fn not_assessable(reasons: Vec<Reason>) -> Self {
        Self::plain(Outcome::NotAssessable, reasons)
    }

    fn holds() -> Self {
        Self::plain(Outcome::Holds, Vec::new())
    }

    fn fails(reasons: Vec<Reason>) -> Self {
        Self::plain(Outcome::DoesNotHold, reasons)
    }

    fn plain(outcome: Outcome, reasons: Vec<Reason>) -> Self {
        Self { outcome, word: None, reasons, drawn: Vec::new() }
    }

    /// The outcome in words.
    pub fn word<'w>(&'w self, words: &'w [String; 2]) -> &'w str {
        self.word.as_deref().unwrap_or_else(|| self.outcome.word(words))
    }
}

/// One result for each verdict of the plan.
pub fn decide(plan: &Plan, given: &Given<'_>) -> Vec<Decided> {
    let mut decided = BTreeMap::new();
    (0..plan.verdicts.len()).for_each(|at| decide_one(plan, given, at, &mut decided));
    decided.into_values().collect()
}

/// What the overall verdict of the plan comes to.
pub fn overall(plan: &Plan, given: &Given<'_>) -> Outcome {
    decide(plan, given).first().map_or(Outcome::NotAssessable, |overall| overall.outcome)
}

/// A verdict, after those that it uses. The checker has excluded verdicts that depend on
/// themselves.
fn decide_one(plan: &Plan, given: &Given<'_>, at: usize, decided: &mut BTreeMap<usize, Decided>) {
    if decided.contains_key(&at) {
        return;
    }
    let decision = &plan.verdicts[at].decision;
    decision.verdicts().into_iter().for_each(|of| decide_one(plan, given, of, decided));
    let found = by(plan, given, decision, decided);
    decided.insert(at, found);
}

/// What a decision comes to, after the verdicts that it uses.
fn by(
    plan: &Plan,
    given: &Given<'_>,
    decision: &Decision,
    decided: &BTreeMap<usize, Decided>,
) -> Decided {
    match decision {
        Decision::Limits { rule, quantities, draws } => {
            let of = |&at: &usize| (&given.quantities[at], given.fails[at].as_slice());
            let found: Vec<Found<'_>> = quantities.iter().map(of).collect();
            let once = by_limits(plan, &given.barred, *rule, quantities, &found);
            match draws {
                Some(share) if once.outcome.holds().is_some() => in_draws(
                    plan,
                    given.sample,
                    (*rule, quantities),
                    *share,
                    (&found, once.reasons),
                ),
                _ => once,
            }
        }
        Decision::Verdicts(over) => by_verdicts(plan, over, decided),
        Decision::Person(person) => {
            Decided::plain(Outcome::Open, vec![Reason::ToBeJudged { person: person.clone() }])
        }
        Decision::Ordered(grades) => {
            // Why the outcome is not a better one.
            let (mut reasons, mut drawn) = (Vec::new(), Vec::new());
            for grade in grades {
                let mut found = grade.when.as_deref().map(|when| by(plan, given, when, decided));
                drawn.extend(found.iter_mut().flat_map(|found| std::mem::take(&mut found.drawn)));
                match found.as_ref().map_or(Some(true), |found| found.outcome.holds()) {
                    Some(false) => reasons = found.map_or(reasons, |found| found.reasons),
                    None => return Decided { drawn, ..found.unwrap_or_default() },
                    Some(true) => {
                        let outcome =
                            if grade.holds { Outcome::Holds } else { Outcome::DoesNotHold };
                        let word = Some(grade.word.clone());
                        return Decided { outcome, word, reasons, drawn };
                    }
                }
            }
            Decided::default()
        }
    }
}

/// The results of the verdicts with a name.
pub fn named(plan: &Plan, decided: &[Decided]) -> Vec<VerdictResult> {
    let all = plan.verdicts.iter().zip(decided).enumerate();
    let result = |(at, (rule, found)): (usize, (&crate::check::plan::VerdictRule, &Decided))| {
        Some(VerdictResult {
            name: rule.name.clone()?,
            title: rule.title.clone(),
            overall: at == 0,
            outcome: found.outcome,
            word: found.word(&rule.words).to_string(),
            words: rule.words.clone(),
            criterion: rule.criterion.clone(),
            reasons: found.reasons.clone(),
            judged_by: match &rule.decision {
                Decision::Person(person) => Some(person.clone()),
                _ => None,
            },
            clause: rule.clause.clone(),
            source: rule.source.clone(),
            notes: rule.notes.clone(),
            rule: rule_place(&rule.span),
        })
    };
    all.filter_map(result).collect()
}

/// Of each verdict the rules that were judged in draws.
pub fn drawn(plan: &Plan, decided: &[Decided]) -> Vec<InDraws> {
    let of_verdict = |(rule, found): (&crate::check::plan::VerdictRule, &Decided)| {
        let named = |drawn: &InDraws| InDraws { verdict: rule.name.clone(), ..drawn.clone() };
        found.drawn.iter().map(named).collect::<Vec<InDraws>>()
    };
    plan.verdicts.iter().zip(decided).flat_map(of_verdict).collect()
}

/// A result of a quantity, and a reason for each limit that is not met.
type Found<'q> = (&'q QuantityResult, &'q [Reason]);

/// A scope with the names that sections and sites have in the campaign.
fn drawn_once(scope: &Scope) -> Scope {
    let mut scope = scope.clone();
    for (key, member) in &mut scope.keys {
        if ["section", "site"].contains(&key.as_str())
            && let Some((name, copy)) = member.rsplit_once(" (")
            && copy.trim_end_matches(')').bytes().all(|byte| byte.is_ascii_digit())
        {
            *member = name.to_owned();
        }
    }
    scope
}

/// A rule over limits in draws of the sections. It holds in so many of them, or does not, whatever
/// those come to in which a limit has no value, or a group that it is for has no section. `whole` and
/// `once` are the quantities and the reasons of the sections as they are.
fn in_draws(
    plan: &Plan,
    sample: Option<Sample<'_>>,
    (rule, about): (Rule, &[usize]),
    share: f64,
    (whole, mut once): (&[Found<'_>], Vec<Reason>),
) -> Decided {
    let judge = |quantities: &[(QuantityResult, Vec<Reason>)]| {
        let found: Vec<Found<'_>> =
            quantities.iter().map(|(result, fails)| (result, fails.as_slice())).collect();
        let decided = by_limits(plan, &[], rule, about, &found);
        let limits = |(result, _): &Found<'_>| {
            let failed = result.statistics.iter().filter(|one| one.holds == Some(false));
            let scope = |one: &StatisticResult| drawn_once(&one.scope).told();
            let of = failed.map(|one| (result.id.clone(), one.title.clone(), scope(one)));
            of.collect::<Vec<_>>()
        };
        let failed: IndexSet<_> = found.iter().flat_map(limits).collect();
        let lacks = |((all, _), (some, _)): (&Found<'_>, &Found<'_>)| {
            some.statistics.len() < all.statistics.len()
        };
        let reason = decided.reasons.into_iter().next();
        match decided.outcome.holds() {
            Some(true) if whole.iter().zip(&found).any(lacks) => {
                (None, failed, Some(Reason::NoValueInGroup))
            }
            None => (None, failed, reason),
            holds => (holds, failed, None),
        }
    };
    let found = sample.ok_or(Reason::DrawsNeedValues).and_then(|one| one.each(about, judge));
    let OfDraws { found, units } = match found {
        Ok(found) => found,
        Err(reason) => return Decided::not_assessable(vec![reason]),
    };
    let count = |what: Option<bool>| found.iter().filter(|(holds, ..)| *holds == what).count();
    let mut often: IndexMap<_, usize> = IndexMap::new();
    for limit in found.iter().flat_map(|(_, failed, _)| failed) {
        *often.entry(limit).or_default() += 1;
    }
    // Of several the one that fails first.
    let often = often.into_iter().rev().max_by_key(|(_, draws)| *draws);
    let drawn = InDraws {
        verdict: None,
        held: count(Some(true)),
        undefined: count(None),
        draws: found.len(),
        required: 100.0 * share,
        units,
        most_often: often.map(|((quantity, estimate, scope), draws)| OftenNotMet {
            quantity: quantity.clone(),
            estimate: estimate.clone(),
            scope: scope.clone(),
            draws,
        }),
    };
    let told = Reason::InDraws(drawn.clone());
    let decided = match drawn.holds() {
        // A rule that the sections as they are do not meet holds in no share of draws.
        Some(true) if once.is_empty() => Decided::holds(),
        Some(_) => {
            once.insert(0, told);
            Decided::fails(once)
        }
        None => {
            let first = found.iter().find_map(|(.., reason)| reason.clone());
            let second = Box::new(first.unwrap_or(Reason::NoValueInGroup));
            Decided::not_assessable(vec![Reason::Both { first: Box::new(told), second }])
        }
    };
    Decided { drawn: vec![drawn], ..decided }
}

/// A rule over the limits of some quantities; `about` has their indices.
fn by_limits(
    plan: &Plan,
    barred: &[Reason],
    rule: Rule,
    about: &[usize],
    found: &[Found<'_>],
) -> Decided {
    let quantities = || found.iter().map(|(result, _)| *result);
    let mut missing = barred.to_vec();
    // A quantity without limits is reported and has no effect.
    let without = |quantity: &&QuantityResult| quantity.statistics.is_empty();
    // What needs something optional that is absent is not assessed, and the rest is.
    let with_reason = quantities().filter(|quantity| !without(quantity)).filter_map(|quantity| {
        Some(quantity.reason.clone()?.about(Subject::Quantity, &quantity.id))
    });
    let (absent, lacking): (Vec<Reason>, Vec<Reason>) =
        with_reason.partition(Reason::is_of_optional);
    missing.extend(lacking);
    if quantities().all(|quantity| without(&quantity)) {
        missing.push(without_criterion(plan, about));
    }
    let is_open = |quantity: &&QuantityResult| quantity.holds.is_none() && !without(quantity);
    let open_limits = quantities().flat_map(|quantity| &quantity.statistics);
    let open_limits = open_limits.filter(|one| one.holds.is_none()).count();
    let assessed = quantities().flat_map(|one| &one.statistics).any(|one| one.holds.is_some());
    if missing.is_empty() && !assessed {
        missing.extend(absent.iter().cloned());
    }
    if !missing.is_empty() {
        return Decided::not_assessable(missing);
    }
    let holding =
        quantities().filter(|quantity| quantity.holds == Some(true) && !without(quantity)).count();
    let limits_holding: usize = quantities().map(limits_holding).sum();
    let mut reasons: Vec<Reason> =
        found.iter().flat_map(|(_, fails)| fails.iter().cloned()).collect();
    let holds = match rule {
        Rule::EveryLimit => reasons.is_empty(),
        Rule::AtLeastQuantities(needed) => holding >= needed,
        Rule::AtLeastLimits(needed) => limits_holding >= needed,
    };
    if holds {
        return Decided::holds();
    }
    // With what is not assessed, it might.
    let might = match rule {
        Rule::EveryLimit => false,
        Rule::AtLeastQuantities(needed) => holding + quantities().filter(is_open).count() >= needed,
        Rule::AtLeastLimits(needed) => limits_holding + open_limits >= needed,
    };
    if might {
        return Decided::not_assessable(absent);
    }
    match rule {
        Rule::EveryLimit => {}
        Rule::AtLeastQuantities(minimum) => {
            let quantities = about.len();
            reasons.insert(0, Reason::TooFewQuantities { met: holding, quantities, minimum });
        }
        Rule::AtLeastLimits(minimum) => {
            reasons.insert(0, Reason::TooFewLimits { met: limits_holding, minimum });
        }
    }
    Decided::fails(reasons)
}

/// Why no verdict can be given: it needs at least one limit that applies.
fn without_criterion(plan: &Plan, about: &[usize]) -> Reason {
    Reason::NoCriterion {
        stated: about.iter().any(|&at| !plan.quantities[at].limits.is_empty()),
        protocol: about.len() == plan.quantities.len(),
    }
}

/// A verdict that uses others can be given when all of them are given.
fn by_verdicts(plan: &Plan, over: &Over, decided: &BTreeMap<usize, Decided>) -> Decided {
    let title = |at: usize| plan.verdicts[at].title.as_str();
    let undecided =
        over.verdicts().into_iter().filter(|&at| decided[&at].outcome.holds().is_none());
    let missing: Vec<Reason> = undecided
        .flat_map(|at| {
            let reasons = decided[&at].reasons.iter().cloned();
            reasons.map(move |reason| reason.about(Subject::Verdict, title(at)))
        })
        .collect();
    if !missing.is_empty() {
        return Decided::not_assessable(missing);
    }
    if holds(over, decided) {
        return Decided::holds();
    }
    let parts = match over {
        Over::All(parts) => parts.iter().collect(),
        other => vec![other],
    };
    let reason = |part: &Over| {
        let given = |at: usize| GivenVerdict {
            verdict: title(at).to_owned(),
            word: decided[&at].word(&plan.verdicts[at].words).to_owned(),
        };
        Reason::VerdictsRequired {
            verdicts: part.verdicts().into_iter().map(given).collect(),
            required: in_words(part, plan),
        }
    };
    Decided::fails(parts.into_iter().filter(|part| !holds(part, decided)).map(reason).collect())
}

/// Whether the condition holds, for verdicts that are all given.
fn holds(over: &Over, decided: &BTreeMap<usize, Decided>) -> bool {
    let is = |at: &usize| decided[at].outcome == Outcome::Holds;
    match over {
        Over::Holds(at) => is(at),
        Over::Same(one, other) => is(one) == is(other),
        Over::AtLeast(needed, of) => of.iter().filter(|at| is(at)).count() >= *needed,
        Over::Not(inner) => !holds(inner, decided),
        Over::All(parts) => parts.iter().all(|part| holds(part, decided)),
        Over::Any(parts) => parts.iter().any(|part| holds(part, decided)),
    }
}

/// The condition as it is written in a protocol.
fn in_words(over: &Over, plan: &Plan) -> String {
    let name = |at: &usize| plan.verdicts[*at].name.clone().unwrap_or_default();
    let joined = |parts: &[Over], between: &str| {
        let one = |part: &Over| match part {
            Over::All(_) | Over::Any(_) => format!("({})", in_words(part, plan)),
            _ => in_words(part, plan),
        };
        parts.iter().map(one).collect::<Vec<_>>().join(between)
    };
    match over {
        Over::Holds(at) => format!("{} holds", name(at)),
        Over::Same(one, other) => format!("{} is {}", name(one), name(other)),
        Over::AtLeast(needed, of) => format!(
            "at least {needed} of {} hold",
            of.iter().map(name).collect::<Vec<_>>().join(", ")
        ),
        Over::Not(inner) => match inner.as_ref() {
            Over::Holds(at) => format!("{} does not hold", name(at)),
            Over::Same(one, other) => format!("{} is not {}", name(one), name(other)),
            inner => format!("not ({})", in_words(inner, plan)),
        },
        Over::All(parts) => joined(parts, " and "),
        Over::Any(parts) => joined(parts, " or "),
    }
}

/// Number of limits of a quantity that are met. A limit of several groups is met if all groups meet
/// it, and counts once.
fn limits_holding(quantity: &QuantityResult) -> usize {
    let mut limits: Vec<(&StatisticName, Option<&str>, usize, bool)> = Vec::new();
    for one in &quantity.statistics {
        let zone = match one.scope.zones.as_slice() {
            [zone] => Some(zone.as_str()),
            _ => None,
        };
        let holds = one.holds == Some(true);
        match limits
            .iter_mut()
            .find(|(name, of, line, _)| (*name, *of, *line) == (&one.name, zone, one.rule.line))
        {
            Some((.., all)) => *all &= holds,
            None => limits.push((&one.name, zone, one.rule.line, holds)),
        }
    }
    limits.into_iter().filter(|(.., holds)| *holds).count()
}
