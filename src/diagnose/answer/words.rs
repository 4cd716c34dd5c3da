//! Text and numbers of the answer.

use super::causes::{cause, title};
use super::detectable::detectable;
use super::rivals::{ambiguity, discriminating, neither, probabilities};
use super::verdict::{self, Facts, Verdict};
use crate::diagnose::checks::{
    channels::{Lack, unexplained},
    further::Free,
    heterogeneity::{Heterogeneity, certain},
};
use crate::diagnose::fit::{
    fitter::Fitted,
    set::{Refused, plausible},
};
use crate::diagnose::inputs::Inputs;
use crate::diagnose::levels::{
    channels::LACK,
    common::NINETY,
    further::{LEFT, TOLERANCE},
    search::{MOST, TOLERANCE_SD},
    words::{TELLING, TOLD, TOLD_NEAREST},
};
use crate::diagnose::observe::layout::Kind;
use crate::diagnose::run::{Found, chi, deviations};
use crate::effects::CHANNEL;
use crate::result::{
    FORMAT, OutlyingSection, RemainsOf, Remark, Statement, THIS, Verdict as OfProtocol,
    diagnosis::{
        Cause, Diagnosis, Drift, Fault, HeldOut, How, Nearest, Shrink, UsedTolerance, Vetoed,
    },
};
use crate::simulate::Units;
use crate::words;

/// The verdict of the protocol without the effects and, where effects are named, with them.
pub type Protocol = (OfProtocol, Option<OfProtocol>);

/// The gap on held-out sections.
fn on_held_out(held: &HeldOut) -> Option<Statement> {
    Some(Statement::OnHeldOutSections {
        what: held.what.clone(),
        sections: held.sections.len(),
        before: held.before?,
        after: held.after?,
        removed: held.fraction_removed?,
        low: held.low,
        high: held.high,
    })
}

/// Converts the results into the diagnosis of the report.
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
        held_out: held_out
            .fraction_removed
            .filter(|_| held_out.before != held_out.after)
            .map(|removed| (removed, held_out.high.unwrap_or(removed))),
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
    let beyond = |used: &&UsedTolerance| used.deviations.abs() >= TOLERANCE_SD;
    says.extend(found.answer.used.iter().filter(beyond).map(|used| Statement::ToleranceUsed {
        parameter: used.parameter.clone(),
        tolerance: used.tolerance.clone(),
        deviations: used.deviations.abs(),
    }));
    let trends_tested = trends.len();
    trends.retain(|trend| trend.before.p_value.min(trend.after.p_value) < TOLD);
    if verdict == Verdict::Unexplained {
        says.extend(heterogeneous.map(|test| no_single_size(inputs, found, test)));
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
        let title = title(inputs, &of.effect);
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
            () if found.answer.chosen.members.len() >= MOST => {
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

fn no_single_size(inputs: &Inputs<'_>, found: &Found, test: &Heterogeneity) -> Statement {
    let Drift { effect, signals, parameter, unit, covariate, from, to, change, low, high, .. } =
        drift(found, test);
    let title = title(inputs, &effect).to_owned();
    let signals = if signals.len() > 2 { Vec::new() } else { signals };
    Statement::NoSingleSize {
        title,
        signals,
        covariate,
        parameter,
        unit,
        change,
        low,
        high,
        from,
        to,
    }
}

fn says(
    inputs: &Inputs<'_>,
    found: &Found,
    (verdict, left, reason): (Verdict, bool, Option<Statement>),
    causes: &[Cause],
    shrink: Option<&Shrink>,
    unexplained: f64,
) -> Vec<Statement> {
    let faulty = |fault: &Fault| Statement::FaultyRecording {
        says: fault.says.clone(),
        sections: fault.sections.clone(),
    };
    let mut lines: Vec<Statement> = found.seen.faults.iter().map(faulty).collect();
    match verdict {
        Verdict::NoSignificantGap => lines.push(Statement::WithinTheAllowed),
        Verdict::Ambiguous if reason.is_none() => {
            lines.extend(not_distinguished(inputs, found, causes));
        }
        Verdict::Explained | Verdict::Ambiguous => {
            lines.push(Statement::Explained { cause: causes[0].says.clone() });
        }
        Verdict::Unexplained => {
            lines.extend(remaining(inputs, found, left, reason.as_ref()));
            lines.extend(causes.first().map(|first| Statement::PartlyExplained {
                cause: first.says.clone(),
                remains: unexplained,
            }));
        }
    }
    let known = |reason: &Statement| lines.contains(reason);
    let reason = reason.filter(|reason| !known(reason));
    lines.extend(reason);
    lines.extend(shrink.map(|shrink| Statement::OnExcludedSections {
        before: shrink.before,
        after: shrink.after,
        removed: shrink.fraction_removed,
        low: shrink.low,
        high: shrink.high,
    }));
    lines
}

/// An ambiguous answer: what could replace it, and members that other effects beat in resamples.
fn not_distinguished(inputs: &Inputs<'_>, found: &Found, causes: &[Cause]) -> Vec<Statement> {
    let possible = causes.iter().filter(|cause| cause.in_ambiguity_set);
    let mut all: Vec<String> = possible.map(|cause| cause.says.clone()).collect();
    let in_place = |free: &Free| {
        let (parameter, tolerance) = (free.parameter.clone(), free.tolerance.clone());
        let Free { deviations, evidence, .. } = *free;
        words::text(&Statement::InPlaceOf { parameter, tolerance, deviations, evidence }).into()
    };
    all.extend(found.answer.further.suspect().map(in_place));
    let members = found.answer.chosen.members.iter().zip(&found.answer.stability);
    let beaten = members.filter(|(_, stability)| stability.fails()).map(|(member, stability)| {
        let title = title(inputs, &found.candidate(member).effect).to_owned();
        Statement::BeatenInResamples { title, share: 1.0 - stability.first }
    });
    [Statement::NotDistinguished { causes: all }].into_iter().chain(beaten).collect()
}

/// What an unexplained gap leaves: a tolerance in place of a member, a further candidate, a
/// tolerance beyond its declared size, channels.
fn remaining(
    inputs: &Inputs<'_>,
    found: &Found,
    left: bool,
    reason: Option<&Statement>,
) -> Vec<Statement> {
    let mut lines = Vec::new();
    let mut worst: Vec<&Lack> =
        found.answer.lack_after.iter().filter(|lack| lack.sigma_with_them > LACK).collect();
    worst.sort_by(|a, b| b.sigma_with_them.total_cmp(&a.sigma_with_them));
    let named = !found.answer.chosen.members.is_empty();
    let further = &found.answer.further;
    let suspect = further.instead.as_ref().filter(|_| further.refutes());
    lines.extend(suspect.map(|free| Statement::OutsideTheCatalogue {
        parameter: free.parameter.clone(),
        tolerance: free.tolerance.clone(),
        deviations: free.deviations,
        evidence: free.evidence,
    }));
    let near = nearest(inputs, found).into_iter().next();
    let near = near.filter(|_| named && further.evidence > LEFT);
    lines.extend(near.map(|near| Statement::Beside {
        says: near.says,
        wants: near.wants,
        evidence: near.evidence,
    }));
    let tolerance = further.tolerance.as_ref().filter(|_| suspect.is_none() && left);
    lines.extend(tolerance.map(|free| Statement::ToleranceExceeded {
        parameter: free.parameter.clone(),
        tolerance: free.tolerance.clone(),
        deviations: free.deviations.abs(),
    }));
    let catalogue = inputs.catalogue.name.clone();
    lines.push(match reason {
        _ if !worst.is_empty() => {
            let of = |lack: &&Lack| RemainsOf {
                channel: lack.channel.clone(),
                dynamic: lack.kind != Kind::Level,
            };
            Statement::RemainsIn { catalogue, channels: worst.iter().take(4).map(of).collect() }
        }
        _ if suspect.is_some() => Statement::NothingExceedsTheAllowed,
        _ if left => Statement::Systematic { catalogue },
        Some(reason) => reason.clone(),
        None => Statement::NothingElseRemains { catalogue },
    });
    lines
}
