//! Text and numbers of the answer.

use super::causes::{cause, short};
use super::detectable::detectable;
use super::rivals::{ambiguity, discriminating, neither, probabilities};
use super::verdict::{self, Facts, Verdict};
use crate::diagnose::checks::channels::unexplained;
use crate::diagnose::checks::further::Free;
use crate::diagnose::checks::heterogeneity::{Heterogeneity, certain};
use crate::diagnose::fit::fitter::Fitted;
use crate::diagnose::fit::set::{Refused, plausible};
use crate::diagnose::inputs::Inputs;
use crate::diagnose::levels::channels::LACK;
use crate::diagnose::levels::common::NINETY;
use crate::diagnose::levels::further::{LEFT, TOLERANCE};
use crate::diagnose::levels::search::{MOST, TOLERANCE_SD};
use crate::diagnose::levels::words::{TELLING, TOLD, TOLD_NEAREST};
use crate::diagnose::observe::layout::Kind;
use crate::diagnose::run::{Found, chi, deviations};
use crate::effects::CHANNEL;
use crate::result::diagnosis::{
    Cause, Diagnosis, Drift, Fault, HeldOut, How, Nearest, Shrink, Vetoed,
};
use crate::result::{FORMAT, OutlyingSection, Remark, THIS, Verdict as OfProtocol};
use crate::simulate::Units;

/// The verdict of the protocol without the effects and, where effects are named, with them.
pub type Protocol = (OfProtocol, Option<OfProtocol>);

/// The gap on held-out sections, in a sentence.
fn on_held_out(held: &HeldOut) -> Option<String> {
    let (before, after, removed) = (held.before?, held.after?, 100.0 * held.fraction_removed?);
    let interval = held.low.zip(held.high).map_or(String::new(), |(low, high)| {
        format!(" ({:.0} to {:.0} %)", 100.0 * low, 100.0 * high)
    });
    let changes = if after <= before { "decreases" } else { "increases" };
    Some(format!(
        "On the {} sections held out by the campaign ({}) the gap {changes} from {before:.3} to {after:.3}: {removed:.0} % is removed{interval}.",
        held.sections.len(),
        held.what
    ))
}

/// Converts the results into the diagnosis of the report.
#[must_use]
pub fn diagnosis(
    inputs: &Inputs<'_>,
    found: &Found,
    units: &Units,
    protocol: Protocol,
    (shrink, held_out): (Option<Shrink>, HeldOut),
) -> Diagnosis {
    let (before, after) = chi(found);
    let (unexplained_share, too_much) =
        unexplained(&found.answer.lack_before, &found.answer.lack_after);
    // An outlying section does not refute an answer, but without an answer it is a significant
    // difference.
    let lacking = found.answer.lack_after.iter().any(|lack| lack.sigma_with_them > LACK);
    let ambiguous = ambiguity(inputs, found);
    let named = !found.answer.chosen.members.is_empty();
    let invariants =
        crate::diagnose::describe::invariants::invariants(inputs.settings, found, units);
    let (mut trends, together) =
        crate::diagnose::describe::trends::trends(inputs.settings, found, units);
    let further = &found.answer.further;
    let heterogeneous = certain(&found.answer.heterogeneity);
    let left = heterogeneous.is_some()
        || further.evidence > if named { LEFT } else { found.rates.bars.first }
        || !named && further.tolerance.as_ref().is_some_and(|free| free.evidence > TOLERANCE)
        || !named && crate::diagnose::describe::trends::certain(&trends);
    // The smallest share of resamples in which a member has the most evidence, where that share is
    // too small.
    let least = found
        .answer
        .stability
        .iter()
        .filter(|stability| stability.fails())
        .map(|stability| stability.first)
        .reduce(f64::min);
    let fit = verdict::fit(found);
    let facts = Facts {
        named,
        faulty: !found.seen.faults.is_empty(),
        lacking,
        systematic: left,
        much_left: too_much || further.refutes(),
        moving: !found.answer.still,
        tied: further.suspect().is_some()
            || least.is_some()
            || ambiguous.iter().any(|rival| rival.in_ambiguity_set),
        protocol_fails: verdict::fails(protocol.0),
        removed: verdict::removed(shrink.as_ref()),
        held_out: held_out.fraction_removed,
        misfit: fit.chi2_per_feature,
    };
    let (verdict, reason) = verdict::verdict(&facts);
    let mut causes = vec![];
    if named {
        causes.push(Cause {
            evidence: found.answer.chosen.evidence,
            ..cause(inputs, found, &found.answer.chosen.members, 1)
        });
        // Where the gap remains, the candidate with more evidence than the answer was refused. It
        // is reported there and is not a rival.
        let best = causes[0].evidence;
        causes.extend(
            ambiguous
                .into_iter()
                .filter(|rival| verdict != Verdict::Unexplained || rival.evidence <= best),
        );
        causes.iter_mut().enumerate().for_each(|(at, cause)| cause.rank = at + 1);
    }
    probabilities(&mut causes, verdict, further.suspect().is_some(), least);
    let discriminating_measurement = discriminating(inputs, found, &causes, verdict);
    let radius = |key: &str| crate::diagnose::inputs::value_of(inputs.campaign, key);
    let shapes = crate::diagnose::describe::shapes::shapes(
        inputs.settings,
        &found.seen,
        &radius,
        inputs.seed,
    );
    let mut says =
        says(inputs, found, (verdict, left, reason), &causes, shrink.as_ref(), unexplained_share);
    says.extend(on_held_out(&held_out));
    let trends_tested = trends.len();
    trends.retain(|trend| trend.before.p_value.min(trend.after.p_value) < TOLD);
    if verdict == Verdict::Unexplained {
        says.extend(heterogeneous.map(|test| heterogeneous_in_words(inputs, found, test)));
        says.extend(crate::diagnose::describe::trends::worth_a_word(&trends));
        says.extend(crate::diagnose::describe::invariants::worst(&invariants));
        says.extend(crate::diagnose::describe::shapes::worth_a_word(&shapes));
    }
    says.extend(neither(inputs, found, &causes, verdict));
    let noted =
        found.runs.failed.iter().map(|failed| Remark::SimulationFailed { says: failed.clone() });
    let left_out = found.seen.left_out.iter().map(|(section, says)| Remark::SectionExcluded {
        section: section.clone(),
        says: says.clone(),
    });
    let again = found
        .seen
        .sections
        .iter()
        .filter(|observed| observed.again)
        .map(|observed| Remark::SectionRepeats { section: observed.section.name().into() });
    let mut notes: Vec<Remark> = noted.chain(left_out).chain(again).collect();
    let unknown = found.declared.unknown.iter();
    notes.extend(unknown.map(|name| Remark::UnknownTolerance { name: name.clone() }));
    let tolerances = if found.declared.any {
        "declared by the campaign"
    } else {
        notes.push(Remark::NoToleranceDeclared);
        "documented defaults"
    };
    notes.extend(alone(found));
    notes.extend(verdict::remark(&fit));
    if !inputs.references.is_empty() {
        let names = inputs.references.iter().map(|reference| reference.campaign.name.clone());
        notes.push(Remark::StandingDiscrepancyFrom { campaigns: names.collect() });
    }
    if inputs.simulator.is_none() {
        notes.push(Remark::NoSimulator);
    }
    Diagnosis {
        fishplate: THIS.into(),
        format: FORMAT,
        campaign: inputs.campaign.name.clone(),
        verdict: verdict.word().into(),
        says,
        fit,
        mirrored: inputs.settings.mirror.is_some(),
        false_name_rate: found.rates.false_name_rate,
        calibration: found.rates.calibration,
        protocol_before: protocol.0,
        protocol_after: protocol.1,
        faults: found.seen.faults.clone(),
        r#where: crate::diagnose::describe::locate::locate(inputs.settings, found, units),
        invariants,
        trends,
        trends_tested,
        together,
        drifts: found.answer.heterogeneity.iter().map(|test| drift(found, test)).collect(),
        shapes,
        causes,
        vetoed: vetoed(inputs, found),
        shrink,
        held_out,
        unexplained_share,
        discriminating_measurement,
        detectable: detectable(found),
        nearest: nearest(inputs, found),
        tolerances: found.answer.used.clone(),
        how: How {
            catalogue: inputs.catalogue.name.clone(),
            simulator: inputs
                .simulator
                .map_or("none".into(), |simulator| simulator.name().to_string()),
            mode: "increments on the recorded simulation".into(),
            tolerances: tolerances.into(),
            sections: found.seen.sections.len(),
            features: found.seen.len(),
            seed: inputs.seed,
            threshold: found.rates.bars.first,
            chi_squared_before: before,
            chi_squared_after: after,
        },
        notes,
        simulations_run: found.runs.made,
        seconds: simulated_time(found),
        pictures: Vec::new(),
    }
}

/// Simulated time in s. Wall-clock time would differ from run to run.
fn simulated_time(found: &Found) -> f64 {
    let all: f64 = (0..found.seen.sections.len()).map(|at| found.seen.extent(at).1).sum();
    all * found.runs.made as f64 / found.seen.sections.len().max(1) as f64
}

/// Outlying sections with the channels concerned.
fn alone(found: &Found) -> Option<Remark> {
    let one = |at: usize| {
        let mut channels: Vec<String> = found
            .answer
            .lack_after
            .iter()
            .filter(|lack| lack.alone.contains(&at))
            .map(|lack| lack.channel.clone())
            .collect();
        channels.dedup();
        let section = found.seen.sections[at].section.name().into();
        (!channels.is_empty()).then_some(OutlyingSection { section, channels })
    };
    let sections: Vec<_> = (0..found.seen.sections.len()).filter_map(one).collect();
    let told = !sections.is_empty() && !found.answer.chosen.members.is_empty();
    told.then_some(Remark::Outlying { sections })
}

fn vetoed(inputs: &Inputs<'_>, found: &Found) -> Vec<Vetoed> {
    let one = |refused: &Refused| {
        let of = found.candidate(&refused.fitted);
        let title = inputs
            .catalogue
            .effect(&of.effect)
            .map_or(of.effect.as_str(), |effect| effect.title.as_str());
        let on = if of.channels.is_empty() || of.channels.len() > 2 {
            String::new()
        } else {
            format!(" ({})", of.channels.join(", "))
        };
        Vetoed {
            name: of.effect.clone(),
            size: refused.fitted.size,
            parameter: of.size.clone(),
            evidence: refused.fitted.evidence,
            says: format!("{title}{on} improves the overall fit, but: {}", refused.reason),
        }
    };
    found.answer.refused.iter().map(one).collect()
}

/// The closest candidates that are not named, and the criterion that each does not meet.
fn nearest(inputs: &Inputs<'_>, found: &Found) -> Vec<Nearest> {
    let one = |fit: &Fitted| {
        let of = &found.fitted.candidates[fit.candidate];
        let needed = found.rates.bars.least(of);
        let away = deviations(of, fit.size, inputs.settings, &found.declared);
        let wants = match () {
            () if fit.evidence < needed => format!("evidence of at least {needed:.1}"),
            () if away < TOLERANCE_SD => {
                format!(
                    "larger deviation from the declared value: {away:.1} of {TOLERANCE_SD:.1} standard deviations"
                )
            }
            () if !plausible(of, fit.size) => "a value inside the range of the catalogue".into(),
            () if found.answer.chosen.members.len() == MOST => {
                format!("an answer with fewer effects: at most {MOST} are named")
            }
            () => "more evidence of all effects together".into(),
        };
        Nearest {
            effect: of.effect.clone(),
            says: cause(inputs, found, std::slice::from_ref(fit), 0).says,
            evidence: fit.evidence,
            wants,
        }
    };
    let worth = found.answer.nearest.iter().filter(|fit| fit.evidence >= TELLING);
    let mut told: Vec<Nearest> = Vec::new();
    for near in worth.map(one) {
        if told.iter().all(|known| known.effect != near.effect) {
            told.push(near);
        }
    }
    told.truncate(TOLD_NEAREST);
    told
}

/// A tolerance that explains more than a member does.
fn in_place_of(free: &Free) -> String {
    format!(
        "`{}` ({}) at {:.1} declared standard deviations explains more than a named effect (evidence larger by {:.0})",
        free.parameter, free.tolerance, free.deviations, free.evidence
    )
}

/// The parts of a view between which the size of a member differs most: the difference and its
/// standard error, in units of the size.
fn drift(found: &Found, test: &Heterogeneity) -> Drift {
    let member = &found.answer.chosen.members[test.member];
    let of = found.candidate(member);
    let scale = of
        .neutral()
        .filter(|neutral| neutral.is_finite())
        .map_or(1.0, |neutral| member.size - neutral);
    let by_size =
        |a: &&(String, f64, f64), b: &&(String, f64, f64)| (scale * a.1).total_cmp(&(scale * b.1));
    let low = test.parts.iter().min_by(by_size);
    let high = test.parts.iter().max_by(by_size);
    let part = |of: Option<&(String, f64, f64)>| {
        of.map_or_else(|| (String::new(), 0.0, 0.0), Clone::clone)
    };
    let ((from, least, one), (to, most, other)) = (part(low), part(high));
    let (change, error) = (scale * (most - least), scale.abs() * one.hypot(other));
    Drift {
        effect: of.effect.clone(),
        signals: of.channels.clone(),
        parameter: of.size.replace(&format!(".{CHANNEL}"), ""),
        unit: of.unit.to_string(),
        covariate: test.view.clone(),
        from,
        to,
        change,
        low: change - NINETY * error,
        high: change + NINETY * error,
        p_value: test.p_value,
    }
}

fn heterogeneous_in_words(inputs: &Inputs<'_>, found: &Found, test: &Heterogeneity) -> String {
    let Drift { effect, signals, parameter, unit, covariate, from, to, change, low, high, .. } =
        drift(found, test);
    let title = inputs.catalogue.effect(&effect).map_or(effect.as_str(), |effect| &effect.title);
    let on = if signals.len() > 2 || signals.is_empty() {
        String::new()
    } else {
        format!(" ({})", signals.join(", "))
    };
    let unit = if unit == "-" { String::new() } else { format!(" {unit}") };
    format!(
        "{title}{on}: no single size fits all data. By {covariate}, {parameter} differs by {}{unit} ({} to {}) between {from} and {to}.",
        short(change),
        short(low),
        short(high)
    )
}

fn says(
    inputs: &Inputs<'_>,
    found: &Found,
    (verdict, left, reason): (Verdict, bool, Option<&str>),
    causes: &[Cause],
    shrink: Option<&Shrink>,
    unexplained: f64,
) -> Vec<String> {
    let faulty = |fault: &Fault| {
        format!("Fault of the recording: {} (sections {}).", fault.says, fault.sections.join(", "))
    };
    let mut lines: Vec<String> = found.seen.faults.iter().map(faulty).collect();
    match verdict {
        Verdict::NoSignificantGap => {
            lines.push("The differences are within noise, declared tolerances and the allowed model discrepancy.".into())
        }
        Verdict::Explained => lines.push(format!("{}.", causes[0].says)),
        Verdict::Ambiguous => {
            let mut set: Vec<String> = causes.iter().filter(|cause| cause.in_ambiguity_set).map(|cause| cause.says.clone()).collect();
            set.extend(found.answer.further.suspect().map(in_place_of));
            lines.push(match &set[..] {
                [alone] => format!("{alone}; the data do not distinguish it from all alternatives."),
                all => format!("The data do not distinguish between these causes: {}.", all.join(" | ")),
            });
            let failing = found.answer.chosen.members.iter().zip(&found.answer.stability).filter(|(_, stability)| stability.fails());
            lines.extend(failing.map(|(member, stability)| {
                let effect = &found.fitted.candidates[member.candidate].effect;
                let title = inputs.catalogue.effect(effect).map_or(effect, |effect| &effect.title);
                let beaten = 100.0 * (1.0 - stability.first);
                format!("{title}: when the sections are resampled, another effect has more evidence in {beaten:.0} % of the resamples.")
            }));
        }
        _ => {
            let mut worst: Vec<_> = found.answer.lack_after.iter().filter(|lack| lack.sigma_with_them > LACK).collect();
            worst.sort_by(|a, b| b.sigma_with_them.total_cmp(&a.sigma_with_them));
            let named: Vec<String> = worst
                .iter()
                .take(4)
                .map(|lack| format!("{} ({})", lack.channel, if lack.kind == Kind::Level { "quasi-static" } else { "dynamic" }))
                .collect();
            let catalogue = &inputs.catalogue.name;
            let further = &found.answer.further;
            let named_any = !found.answer.chosen.members.is_empty();
            let suspect = further.instead.as_ref().filter(|_| further.refutes());
            lines.extend(suspect.map(|free| format!("Outside the catalogue: {}.", in_place_of(free))));
            let near = nearest(inputs, found).into_iter().next();
            let near = near.filter(|_| named_any && further.evidence > LEFT);
            lines.extend(near.map(|near| {
                format!(
                    "Beside the named effects, a further one has an evidence of {:.0}: {}. It lacks {}.",
                    near.evidence, near.says, near.wants
                )
            }));
            let tolerance = further.tolerance.as_ref().filter(|_| suspect.is_none() && left);
            lines.extend(tolerance.map(|free| {
                let (parameter, tolerance) = (&free.parameter, &free.tolerance);
                format!(
                    "`{parameter}` ({tolerance}) would have to differ by {:.1} declared standard deviations.",
                    free.deviations.abs()
                )
            }));
            lines.push(match named.is_empty() {
                true if suspect.is_some() => {
                    "With the closest effects, no remaining difference exceeds the allowed one.".into()
                }
                true if left => {
                    format!("No effect of the catalogue `{catalogue}` explains the gap: the remaining difference is systematic.")
                }
                true if reason.is_some() => reason.unwrap_or_default().into(),
                true => {
                    format!("Apart from that, no difference remains that an effect of the catalogue `{catalogue}` would have to explain.")
                }
                false => format!("No effect of the catalogue `{catalogue}` explains the gap. It remains in {}.", named.join(", ")),
            });
            if let Some(first) = causes.first() {
                lines.push(format!("Partly explained: {}; {:.0} % of the excess remains.", first.says, 100.0 * unexplained));
            }
        }
    }
    lines.extend(
        reason
            .map(str::to_string)
            .filter(|reason| !lines.contains(reason))
            .into_iter()
            .collect::<Vec<_>>(),
    );
    if let Some(shrink) = shrink {
        let (before, after, low, high) =
            (shrink.before, shrink.after, 100.0 * shrink.low, 100.0 * shrink.high);
        let removed = 100.0 * shrink.fraction_removed;
        lines.push(match removed < 0.0 {
            false => format!(
                "On sections excluded from the fit the gap decreases from {before:.3} to {after:.3}: {removed:.0} % is removed ({low:.0} to {high:.0} %)."
            ),
            true => format!(
                "On sections excluded from the fit the gap increases from {before:.3} to {after:.3}: by {:.0} % ({:.0} to {:.0} %).",
                -removed, -high, -low
            ),
        });
    }
    lines
}
