//! The answer in words and numbers: verdict, causes, rivals, what to measure next.

use super::causes::cause;
use super::features::Kind;
use super::fit::Fitted;
use super::lack::{LACK, unexplained};
use super::run::{Found, Inputs, chi, deviations, length};
use super::search::{TOLERANCE_SD, plausible};
use crate::effects::Effect;
use crate::result::diagnosis::{Cause, Detectable, Diagnosis, Fault, How, Nearest, Shrink, Vetoed};
use crate::simulate::Units;

/// Whitened length of a change that can be identified.
const SEEN: f64 = 5.0;
/// Rivals with so much less evidence cannot be told from the answer.
const NEAREST: f64 = 8.0;
/// Evidence is divided by this before it becomes a probability: real discrepancies are not those of the covariance.
const TEMPERATURE: f64 = 4.0;

/// Puts what was found into an answer.
#[must_use]
pub fn diagnosis(inputs: &Inputs<'_>, found: &Found, units: &Units, shrink: Option<Shrink>) -> Diagnosis {
    let (before, after) = chi(found);
    let (unexplained_share, too_much) = unexplained(&found.lack_before, &found.lack_after);
    // What stands out in a section or two alone makes no answer wrong, but is no agreement either.
    let lacking = found.lack_after.iter().any(|lack| lack.sigma_with_them > LACK);
    let ambiguous = ambiguity(inputs, found);
    let named = !found.chosen.members.is_empty();
    let verdict = match () {
        () if !named && !lacking && found.seen.faults.is_empty() => "no significant gap",
        () if !named => "unexplained",
        () if too_much || found.suspect.is_some() || found.contradicting.is_some() => "unexplained",
        () if ambiguous.iter().any(|rival| rival.in_ambiguity_set) => "ambiguous",
        () => "explained",
    };
    let mut causes = vec![];
    if named {
        causes.push(cause(inputs, found, &found.chosen.members, 1));
        // Where the gap stays, what would have more evidence than the answer was refused: it is told there, and is no rival.
        let best = causes[0].evidence;
        causes.extend(ambiguous.into_iter().filter(|rival| verdict != "unexplained" || rival.evidence <= best));
        causes.iter_mut().enumerate().for_each(|(at, cause)| cause.rank = at + 1);
    }
    probabilities(&mut causes, verdict);
    let discriminating_measurement = discriminating(inputs, found, &causes, verdict);
    let invariants = super::invariants::invariants(inputs.settings, found, units);
    let radius = |key: &str| super::run::value_of(inputs.campaign, key);
    let shapes = super::shapes::shapes(inputs.settings, &found.seen, &radius, inputs.seed);
    let mut says = says(inputs, found, verdict, &causes, shrink.as_ref(), unexplained_share);
    let (trends, together) = super::trends::trends(inputs.settings, found, units);
    if verdict == "unexplained" {
        says.extend(super::trends::worth_a_word(&trends));
        says.extend(super::invariants::worst(&invariants));
        says.extend(super::shapes::worth_a_word(&shapes));
    }
    let noted = found.runs.failed.iter().map(|failed| format!("a run failed and was left out: {failed}"));
    let left_out = found.seen.left_out.iter().map(|(section, reason)| format!("section {section} was left out: {reason}"));
    let again = found.seen.sections.iter().filter(|observed| observed.again).map(|observed| observed.section.name());
    let again = again.map(|name| format!("section {name} is another one measured again: it does not count twice"));
    let mut notes: Vec<String> = noted.chain(left_out).chain(again).collect();
    let unknown = found.declared.unknown.iter();
    notes.extend(
        unknown.map(|name| format!("the catalogue knows no tolerance `{name}`: what the campaign declares there is not allowed for")),
    );
    let tolerances = if found.declared.any {
        "declared by the campaign"
    } else {
        notes.push("the campaign declares no tolerances: documented defaults were taken, and the verdict is the weaker for it".into());
        "documented defaults"
    };
    notes.extend(alone(found));
    if !inputs.references.is_empty() {
        let names: Vec<&str> = inputs.references.iter().map(|reference| reference.campaign.name.as_str()).collect();
        notes.push(format!("what the simulation is wrong in anyway was learnt from: {}", names.join(", ")));
    }
    if inputs.simulator.is_none() {
        notes.push("no simulator could be run: only effects of the measuring chain were tried".into());
    }
    Diagnosis {
        fishplate: env!("CARGO_PKG_VERSION"),
        campaign: inputs.campaign.name.clone(),
        verdict,
        says,
        faults: found.seen.faults.clone(),
        r#where: super::locate::locate(inputs.settings, found, units),
        invariants,
        trends,
        together,
        shapes,
        causes,
        vetoed: vetoed(inputs, found),
        shrink,
        unexplained_share,
        discriminating_measurement,
        detectable: detectable(found),
        nearest: nearest(inputs, found),
        how: How {
            catalogue: inputs.catalogue.name.clone(),
            simulator: inputs.simulator.map_or("none".into(), |simulator| simulator.name().to_string()),
            mode: "increments on the recorded simulation".into(),
            tolerances: tolerances.into(),
            sections: found.seen.sections.len(),
            features: found.seen.len(),
            seed: inputs.seed,
            threshold: found.bars.first,
            chi_squared_before: before,
            chi_squared_after: after,
        },
        notes,
        simulations_run: found.runs.made,
        seconds: simulated_time(found),
        pictures: Vec::new(),
    }
}

/// Simulated time in s: what a clock shows would make every answer another text.
fn simulated_time(found: &Found) -> f64 {
    let all: f64 = (0..found.seen.sections.len()).map(|at| found.seen.extent(at).1).sum();
    all * found.runs.made as f64 / found.seen.sections.len().max(1) as f64
}

/// Sets in which another effect takes the place of a member, and that the data cannot tell from the answer.
/// Sections that stand out alone beside an answer, with the channels that they do so in.
fn alone(found: &Found) -> Option<String> {
    let one = |at: usize| {
        let mut channels: Vec<&str> =
            found.lack_after.iter().filter(|lack| lack.alone.contains(&at)).map(|lack| lack.channel.as_str()).collect();
        channels.dedup();
        (!channels.is_empty()).then(|| format!("{} in {}", found.seen.sections[at].section.name(), channels.join(", ")))
    };
    let all: Vec<String> = (0..found.seen.sections.len()).filter_map(one).collect();
    let told = !all.is_empty() && !found.chosen.members.is_empty();
    told.then(|| format!("sections that stand out alone, and do not decide whether the gap is explained: {}", all.join("; ")))
}

fn ambiguity(inputs: &Inputs<'_>, found: &Found) -> Vec<Cause> {
    let best = found.chosen.evidence();
    let mut causes: Vec<Cause> = Vec::new();
    let own = |at: usize| &found.candidates[found.chosen.members[at].candidate];
    for (at, fit, fall) in &found.rivals {
        let of = &found.candidates[fit.candidate];
        // The same on another channel is another cause, where the data cannot tell which channel it is.
        let elsewhere = of.effect == own(*at).effect && of.channels != own(*at).channels && !of.channels.is_empty() && *fall <= NEAREST;
        let named = found.chosen.members.iter().any(|member| found.candidates[member.candidate].effect == of.effect);
        if named && !elsewhere {
            continue;
        }
        if causes.len() >= 5 || causes.iter().any(|cause| cause.effects.iter().any(|effect| effect.name == of.effect)) {
            continue;
        }
        // What a guard refused is told as such; it is no rival.
        if found.refused.iter().any(|refused| found.candidates[refused.fitted.candidate].is_like(of)) || !plausible(of, fit.size) {
            continue;
        }
        // What is within a declared tolerance is allowed for already.
        if deviations(of, fit.size, inputs.settings, &found.declared) < TOLERANCE_SD {
            continue;
        }
        let near = *fall <= (0.12 * found.chosen.members[*at].evidence).max(NEAREST)
            && fit.evidence > if of.exact { found.bars.exact } else { found.bars.first };
        let mut members = found.chosen.members.clone();
        members[*at] = fit.clone();
        let mut cause = cause(inputs, found, &members, causes.len() + 2);
        cause.in_ambiguity_set = near;
        cause.evidence = best - fall;
        causes.push(cause);
    }
    causes
}

fn probabilities(causes: &mut [Cause], verdict: &str) {
    // A rival may have more evidence than an answer that was chosen with the tolerances as they act beside it: then it is as probable.
    let best = causes.first().map_or(0.0, |answer| answer.evidence);
    let weights: Vec<f64> = causes.iter().map(|cause| ((cause.evidence - best).min(0.0) / (2.0 * TEMPERATURE)).exp()).collect();
    // Something outside the catalogue is possible as well; more so where something is left.
    let outside = if verdict == "unexplained" { 4.0 } else { 0.05 };
    let all = weights.iter().sum::<f64>() + outside;
    causes.iter_mut().zip(weights).for_each(|(cause, weight)| cause.probability = weight / all);
    if verdict == "unexplained" {
        causes.iter_mut().for_each(|cause| cause.in_ambiguity_set = false);
    }
}

fn discriminating(inputs: &Inputs<'_>, found: &Found, causes: &[Cause], verdict: &str) -> Option<String> {
    if verdict != "ambiguous" {
        return None;
    }
    let effects = causes.iter().filter(|cause| cause.in_ambiguity_set).flat_map(|cause| &cause.effects);
    let mut measurements: Vec<String> = Vec::new();
    for effect in effects {
        let known: Option<&Effect> = inputs.catalogue.effect(&effect.name);
        if let Some(settled) = known.and_then(|known| known.settled_by.clone())
            && !measurements.contains(&settled)
        {
            measurements.push(settled);
        }
    }
    measurements.extend(more_sections(inputs, found, causes));
    (!measurements.is_empty()).then(|| measurements.join("; or "))
}

/// More sections of the kind that tells the answer from its nearest rival best.
fn more_sections(inputs: &Inputs<'_>, found: &Found, causes: &[Cause]) -> Option<String> {
    let near =
        |name: &str| causes.iter().skip(1).any(|cause| cause.in_ambiguity_set && cause.effects.iter().any(|effect| effect.name == name));
    let (at, rival, _) = found.rivals.iter().find(|(at, fit, _)| {
        let effect = |fit: &Fitted| found.candidates[fit.candidate].effect.as_str();
        near(effect(fit)) && effect(fit) != effect(&found.chosen.members[*at])
    })?;
    let apart = super::apart::apart(found, &found.chosen.members[*at], rival)?;
    let sections: Vec<&str> = apart.sections.iter().map(|at| found.seen.sections[*at].section.name()).collect();
    let stratum = inputs.settings.stratum.as_deref();
    let kind = apart.sections.first().zip(stratum).and_then(|(at, column)| found.seen.sections[*at].section.says(column));
    Some(format!(
        "as many sections again like {} ({}): the two nearest causes, {:.1} standard deviations apart now, would be {:.1}",
        sections.join(", "),
        kind.unwrap_or_else(|| "the kind that helps most".into()),
        apart.now,
        apart.then
    ))
}

fn vetoed(inputs: &Inputs<'_>, found: &Found) -> Vec<Vetoed> {
    let one = |refused: &super::search::Refused| {
        let of = &found.candidates[refused.fitted.candidate];
        let title = inputs.catalogue.effect(&of.effect).map_or(of.effect.as_str(), |effect| effect.title.as_str());
        let on = if of.channels.is_empty() || of.channels.len() > 2 { String::new() } else { format!(" ({})", of.channels.join(", ")) };
        Vetoed {
            name: of.effect.clone(),
            size: refused.fitted.size,
            parameter: of.size.clone(),
            evidence: refused.fitted.evidence,
            says: format!("{title}{on} improves the fit as a whole, but: {}", refused.reason),
        }
    };
    found.refused.iter().map(one).collect()
}

fn detectable(found: &Found) -> Vec<Detectable> {
    let mut list: Vec<Detectable> = Vec::new();
    for candidate in found.candidates.iter().filter(|candidate| !candidate.discrete && candidate.fixed.is_empty()) {
        let Some(neutral) = candidate.neutral().filter(|neutral| neutral.is_finite()) else { continue };
        let mut nodes: Vec<(f64, f64)> = candidate
            .nodes
            .iter()
            .filter(|node| !node.change.is_empty())
            .map(|node| (node.size - neutral, length(&found.whitener, &node.change)))
            .collect();
        nodes.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let below = nodes.iter().copied().filter(|(away, _)| *away < 0.0);
        let above = nodes.iter().copied().filter(|(away, _)| *away > 0.0);
        let (below, above) = (long_enough(below), long_enough(above));
        let nearer = |a: f64, b: f64| if a.abs() <= b.abs() { a } else { b };
        let made = Detectable {
            effect: candidate.effect.clone(),
            parameter: candidate.size.clone(),
            unit: candidate.unit.text.clone(),
            neutral,
            smallest: below.zip(above).map(|(a, b)| nearer(a, b)).or(below).or(above),
            below,
            above,
        };
        let alike = |known: &&mut Detectable| known.effect == made.effect && known.parameter == made.parameter && known.unit == made.unit;
        match list.iter_mut().find(alike) {
            Some(_) if candidate.channels.is_empty() => {}
            Some(known) => {
                let farther = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| if a.abs() >= b.abs() { a } else { b });
                known.smallest = farther(known.smallest, made.smallest);
                (known.below, known.above) = (farther(known.below, made.below), farther(known.above, made.above));
            }
            None => list.push(made),
        }
    }
    list
}

/// Where the whitened change on one side of neutral grows to what can be seen: `nodes` are distances and lengths, in order, linear in
/// between. Nothing if it does not.
fn long_enough(nodes: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let mut before = (0.0, 0.0);
    for (away, long) in nodes {
        if long >= SEEN {
            return Some(before.0 + (away - before.0) * (SEEN - before.1) / (long - before.1));
        }
        before = (away, long);
    }
    None
}

/// What would have been named next, and what it wants for that.
fn nearest(inputs: &Inputs<'_>, found: &Found) -> Vec<Nearest> {
    let one = |fit: &Fitted| {
        let of = &found.candidates[fit.candidate];
        let bar = if found.chosen.members.is_empty() { found.bars.alone(of) } else { found.bars.next };
        let needed = if found.masks[fit.mask].asked_by.is_some() { 2.0 * bar } else { bar };
        let away = deviations(&found.candidates[fit.candidate], fit.size, inputs.settings, &found.declared);
        let wants = match () {
            () if fit.evidence < needed => format!("evidence of {needed:.1}"),
            () if away < TOLERANCE_SD => {
                format!("a size further from what is declared: {away:.1} of {TOLERANCE_SD:.1} standard deviations")
            }
            () => "a larger share of what is named".into(),
        };
        Nearest { effect: of.effect.clone(), says: cause(inputs, found, std::slice::from_ref(fit), 0).says, evidence: fit.evidence, wants }
    };
    found.nearest.iter().map(one).collect()
}

fn says(inputs: &Inputs<'_>, found: &Found, verdict: &str, causes: &[Cause], shrink: Option<&Shrink>, unexplained: f64) -> Vec<String> {
    let faulty = |fault: &Fault| format!("Fault of the recording: {} (sections {}).", fault.says, fault.sections.join(", "));
    let mut lines: Vec<String> = found.seen.faults.iter().map(faulty).collect();
    match verdict {
        "no significant gap" => {
            lines.push("What differs is within noise, declared tolerances and what a model of this kind is allowed to be wrong in.".into())
        }
        "explained" => lines.push(format!("{}.", causes[0].says)),
        "ambiguous" => {
            let set: Vec<&str> = causes.iter().filter(|cause| cause.in_ambiguity_set).map(|cause| cause.says.as_str()).collect();
            lines.push(format!("The data cannot tell apart: {}.", set.join(" | ")));
        }
        _ => {
            let mut worst: Vec<_> = found.lack_after.iter().filter(|lack| lack.sigma_with_them > LACK).collect();
            worst.sort_by(|a, b| b.sigma_with_them.total_cmp(&a.sigma_with_them));
            let named: Vec<String> = worst
                .iter()
                .take(4)
                .map(|lack| format!("{} ({})", lack.channel, if lack.kind == Kind::Level { "quasi-static" } else { "dynamic" }))
                .collect();
            let catalogue = &inputs.catalogue.name;
            if let Some(suspect) = &found.suspect {
                lines.push(format!(
                    "Outside the catalogue: `{}` times {:.2} explains more than any effect does (evidence {:.0} against {:.0}).",
                    suspect.key, suspect.factor, suspect.evidence, suspect.answer
                ));
            }
            if let Some((refused, evidence)) = &found.contradicting {
                let looks = cause(inputs, found, std::slice::from_ref(&refused.fitted), 0).says;
                let reason = &refused.reason;
                lines.push(format!(
                    "What is left looks in part like another effect, with more evidence ({evidence:.0}) than any that is named, and contradicts it: {looks}, but {reason}."
                ));
            }
            lines.push(match named.is_empty() {
                true if found.suspect.is_some() || found.contradicting.is_some() => {
                    "Beside the effects that come nearest, nothing is left that is more than is allowed for.".into()
                }
                true => format!("Beside that, nothing is left that an effect of the catalogue `{catalogue}` should explain."),
                false => format!("No effect of the catalogue `{catalogue}` explains the gap. It is left in {}.", named.join(", ")),
            });
            if let Some(first) = causes.first() {
                lines.push(format!("Explained in part: {}; {:.0} % of the excess is left.", first.says, 100.0 * unexplained));
            }
        }
    }
    if let Some(shrink) = shrink {
        lines.push(format!(
            "On sections kept out of the fit the gap falls from {:.3} to {:.3}: {:.0} % is removed ({:.0} to {:.0} %).",
            shrink.before,
            shrink.after,
            100.0 * shrink.fraction_removed,
            100.0 * shrink.low,
            100.0 * shrink.high
        ));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths 2 at 1 and 6 at 3: five at 1 + 2 * 3 / 4.
    #[test]
    fn what_can_be_seen_lies_between_the_sizes_that_were_tried() {
        assert_eq!(long_enough([(1.0, 2.0), (3.0, 6.0)].into_iter()), Some(2.5));
        assert_eq!(long_enough([(-2.0, 10.0)].into_iter()), Some(-1.0));
        assert_eq!(long_enough([(1.0, 2.0), (3.0, 4.0)].into_iter()), None);
    }
}
