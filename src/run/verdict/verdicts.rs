//! Verdicts: from limits of quantities, from other verdicts, or left to a person.

use std::collections::BTreeMap;

use crate::check::plan::{Decision, Over, Plan, Rule};
use crate::result::{
    GivenVerdict, Outcome, QuantityResult, Reason, StatisticName, Subject, VerdictResult,
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
}

#[derive(Clone, Debug)]
pub struct Decided {
    pub outcome: Outcome,
    /// Of several outcomes in order the word of the one that applies.
    pub word: Option<String>,
    pub reasons: Vec<Reason>,
}

impl Default for Decided {
    fn default() -> Self {
        Self::not_assessable(vec![Reason::NoVerdict])
    }
}

impl Decided {
    fn not_assessable(reasons: Vec<Reason>) -> Self {
        Self { outcome: Outcome::NotAssessable, word: None, reasons }
    }

    fn holds() -> Self {
        Self { outcome: Outcome::Holds, word: None, reasons: Vec::new() }
    }

    fn fails(reasons: Vec<Reason>) -> Self {
        Self { outcome: Outcome::DoesNotHold, word: None, reasons }
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
        Decision::Limits { rule, quantities } => by_limits(plan, given, *rule, quantities),
        Decision::Verdicts(over) => by_verdicts(plan, over, decided),
        Decision::Person(person) => Decided {
            outcome: Outcome::Open,
            word: None,
            reasons: vec![Reason::ToBeJudged { person: person.clone() }],
        },
        Decision::Ordered(grades) => {
            // Why the outcome is not a better one.
            let mut reasons = Vec::new();
            for grade in grades {
                let found = grade.when.as_deref().map(|when| by(plan, given, when, decided));
                match found.as_ref().map_or(Some(true), |found| found.outcome.holds()) {
                    Some(false) => reasons = found.map_or(reasons, |found| found.reasons),
                    None => return found.unwrap_or_default(),
                    Some(true) => {
                        let outcome =
                            if grade.holds { Outcome::Holds } else { Outcome::DoesNotHold };
                        return Decided { outcome, word: Some(grade.word.clone()), reasons };
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

fn by_limits(plan: &Plan, given: &Given<'_>, rule: Rule, about: &[usize]) -> Decided {
    let quantities = || about.iter().map(|&at| &given.quantities[at]);
    let mut missing = given.barred.clone();
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
        about.iter().flat_map(|&at| given.fails[at].iter().cloned()).collect();
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
