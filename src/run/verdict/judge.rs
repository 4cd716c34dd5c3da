//! From the rows of all sections to results of quantities and verdicts: the nodes of the graph
//! after the table of values.

use std::collections::BTreeSet;

use indexmap::IndexMap;

use super::draws::Sample;
use super::quantities::of_quantities;
use super::verdicts;
use crate::check::evaluate::flag;
use crate::check::plan::{Plan, Zone};
use crate::result::{
    Consequence, Finding, InDraws, QuantityResult, Reason, Reported, Verdict, VerdictResult,
    ZoneResult,
};
use crate::run::data_rules::changed;
use crate::run::describe::reports;
use crate::run::estimate::used;
use crate::run::sections::requirements::{self, Unchecked};
use crate::run::sections::{Facts, Unit};
use crate::run::values::SectionValues;

#[derive(Debug)]
pub struct Judged {
    pub verdict: Verdict,
    /// The overall verdict in the words of the protocol, if it states them.
    pub own_word: Option<String>,
    /// Of several outcomes of the overall verdict the one that applies.
    pub outcome: Option<String>,
    pub reasons: Vec<Reason>,
    /// Verdicts with a name.
    pub verdicts: Vec<VerdictResult>,
    /// The rules of verdicts that were judged in draws of the sections.
    pub drawn: Vec<InDraws>,
    pub quantities: Vec<QuantityResult>,
    pub zones: Vec<ZoneResult>,
    /// Numbers of the data of the sections.
    pub reported: Vec<Reported>,
    /// Why no verdict on limits can be given.
    pub barred: Vec<Reason>,
    /// Of each quantity, a reason for each limit that is not met.
    pub fails: Vec<Vec<Reason>>,
}

/// What was told before anything is judged.
#[derive(Debug)]
pub struct Told<'a> {
    pub findings: &'a [Finding],
    /// Why nothing can be assessed, beside findings of plausibility.
    pub barred: Vec<Reason>,
}

/// Results of quantities and verdicts from the values of sections.
pub fn judge(
    plan: &Plan,
    facts: &Facts,
    (units, values): (&[Unit], &[SectionValues]),
    told: Told<'_>,
) -> Judged {
    let used = used(units, values);
    let mut missing: Vec<Reason> = Vec::new();
    let zones: Vec<ZoneResult> = plan.zones.iter().map(|zone| zone_result(zone, units)).collect();
    missing.extend(zones.iter().filter_map(ZoneResult::lack));
    let sites = sites(used.iter().map(|(unit, _)| *unit));
    if sites < plan.sections.minimum {
        let (used, minimum) = (used.len(), plan.sections.minimum);
        missing.push(Reason::TooFewSections { used, sites, minimum });
    }
    missing.extend(without_sections(units));
    missing.extend(too_many_removed(plan, facts, units));
    missing.extend(not_plausible(plan, told.findings, missing.is_empty()));
    missing.extend(changed::reason(told.findings));
    missing.extend(told.barred);
    missing.extend(parameters_not_stated(plan));
    let required = requirements::unchecked(plan, units).into_iter().filter(|one| one.required);
    missing.extend(required.map(|Unchecked { title, says, sections, .. }| {
        Reason::RequiredNotChecked { check: title.into(), reason: Box::new(says.clone()), sections }
    }));
    let (quantities, fails): (Vec<QuantityResult>, Vec<Vec<Reason>>) =
        of_quantities(plan, facts, &used, 0..plan.quantities.len()).into_iter().unzip();
    let sample = Some(Sample { plan, facts, used: &used });
    let given = verdicts::Given { barred: missing, quantities: &quantities, fails, sample };
    let decided = verdicts::decide(plan, &given);
    let verdicts = verdicts::named(plan, &decided);
    let drawn = verdicts::drawn(plan, &decided);
    let (rule, overall) = (plan.overall(), decided.into_iter().next().unwrap_or_default());
    let verdict = overall.outcome.overall();
    let own_word = rule.has_words().then(|| match verdict {
        Verdict::NotAssessable => verdict.in_words().to_string(),
        _ => overall.word(&rule.words).to_string(),
    });
    let outcome = overall.word.clone();
    let reported = reports::of_sections(plan, facts, used.iter().map(|(unit, _)| *unit));
    let reasons = overall.reasons;
    let verdicts::Given { barred, fails, .. } = given;
    Judged {
        verdict,
        own_word,
        outcome,
        reasons,
        verdicts,
        drawn,
        barred,
        fails,
        quantities,
        zones,
        reported,
    }
}

/// One reason for all parameters that have no value.
fn parameters_not_stated(plan: &Plan) -> Option<Reason> {
    let names = plan.parameters.iter().filter(|one| one.lacking).map(|one| one.name.clone());
    let parameters: Vec<String> = names.collect();
    (!parameters.is_empty()).then_some(Reason::ParametersNotStated { parameters })
}

/// One reason for each of several campaigns of which no section is used: the verdict names it, but
/// nothing of it was assessed.
fn without_sections(units: &[Unit]) -> Vec<Reason> {
    let mut used: IndexMap<&str, bool> = IndexMap::new();
    for unit in units {
        let Some(name) = unit.campaign_name.as_deref() else { continue };
        *used.entry(name).or_default() |= unit.fault.is_none();
    }
    let unused = used.into_iter().filter(|(_, any)| !any);
    unused.map(|(name, _)| Reason::NoSectionOfCampaign { campaign: name.into() }).collect()
}

/// Relative tolerance for the number of sections that a share allows.
const ROUNDING: f64 = 1e-9;

/// More sections are removed than the protocol allows: not used, and neither deselected by it nor
/// left out by a reduction.
fn too_many_removed(plan: &Plan, facts: &Facts, units: &[Unit]) -> Option<Reason> {
    let most = plan.sections.most_removed?;
    let given = |unit: &&Unit| {
        let only = plan.sections.only.as_ref();
        only.is_none_or(|only| flag(only, &unit.known(facts)) != Ok(false))
            && unit.fault.as_ref().is_none_or(|fault| !fault.is_choice())
    };
    let given: Vec<&Unit> = units.iter().filter(given).collect();
    let removed = given.iter().filter(|unit| unit.fault.is_some());
    let removed: Vec<String> = removed.map(|unit| unit.name.clone()).collect();
    let allowed = most * given.len() as f64 * (1.0 + ROUNDING);
    (removed.len() as f64 > allowed).then_some(Reason::TooManyRemoved {
        removed: removed.len(),
        sections: given.len(),
        most: 100.0 * most,
        names: removed,
    })
}

/// Number of different sites of the sections.
fn sites<'a>(units: impl Iterator<Item = &'a Unit>) -> usize {
    units.map(|unit| unit.site).collect::<BTreeSet<_>>().len()
}

/// One reason for each plausibility rule that makes the campaign not assessable. If sections are
/// missing, also one for each rule that excluded sections.
fn not_plausible(plan: &Plan, findings: &[Finding], complete: bool) -> Vec<Reason> {
    let mut reasons: Vec<Reason> = Vec::new();
    for rule in &plan.plausibility {
        let sections = |consequence: Consequence| {
            let own = findings
                .iter()
                .flat_map(Finding::with_explained)
                .filter(|finding| finding.code == rule.name && finding.consequence == consequence);
            let places = own.flat_map(Finding::places);
            places.map(|place| place.section.as_deref()).collect::<BTreeSet<_>>().len()
        };
        let (barred, taken) =
            (sections(Consequence::NotAssessable), sections(Consequence::NotUsed));
        let rule = rule.title.clone();
        let reason = match (barred, taken) {
            (0, taken) if taken > 0 && !complete => Reason::NotUsedFor { rule, sections: taken },
            (0, _) => continue,
            (barred, _) => Reason::Implausible { rule, sections: barred },
        };
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    reasons
}

fn zone_result(zone: &Zone, units: &[Unit]) -> ZoneResult {
    let given: Vec<&Unit> =
        units.iter().filter(|unit| unit.zone.as_deref() == Some(zone.name.as_str())).collect();
    let used: Vec<&Unit> = given.iter().copied().filter(|unit| unit.fault.is_none()).collect();
    let sites = sites(used.iter().copied());
    ZoneResult {
        zone: zone.name.clone(),
        title: zone.title.clone(),
        condition: zone.condition_words.clone(),
        used: used.len(),
        sites,
        given: given.len(),
        minimum: zone.minimum_sections,
        holds: sites >= zone.minimum_sections,
    }
}
