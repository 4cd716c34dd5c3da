//! Diagnosis of a campaign: identification of effects, the corrected simulation, and the protocol
//! evaluated again.

use super::answer::decrease::{
    applied, compare, folds, improved, of_sections, shares, trained, within,
};
use super::held_out::HeldOut;
use super::inputs::Inputs;
use super::run::{Found, find};
use super::settings::Settings;
use crate::certify::{Compiled, certify};
use crate::data::{Campaign, origin::OriginEffect, record::Format, write::Outputs};
use crate::diagnose::linearise::whiten::{dot, less};
use crate::diagnose::observe::{observations::Observations, observed::Observed};
use crate::effects::{Applied, Catalogue, Gauss, Signals};
use crate::problem::{Problem, Problems};
use crate::result::{
    Certification, Reason,
    diagnosis::{Diagnosis, HeldOut as OnHeldOut},
};
use crate::run::Settings as RunSettings;
use crate::simulate::{
    Made, Section, Simulator, Units, effects_of_origin, record_file, recorded, with_records,
    write_campaign,
};
use crate::units::Unit;
use crate::words;

/// The diagnosis and the data it was derived from.
#[derive(Debug)]
pub struct Outcome {
    pub diagnosis: Diagnosis,
    pub found: Found,
    /// The protocol evaluated on the campaign as it is.
    pub before: Certification,
    /// The same with the effects added, by cross-validation; absent where no effect is named.
    pub after: Option<Certification>,
    /// Records with the effects at the sizes fitted to all sections, one per section of `found`.
    pub improved: Vec<Signals>,
    /// Sections that the fit did not see, and their records with the same effects.
    pub held: Vec<(Observed, Signals)>,
    /// Units of the channels of `improved`.
    pub units: Units,
    /// The effects in `improved` and their sizes.
    pub added: Vec<OriginEffect>,
    /// Name of the simulator, if one was used.
    pub simulator: Option<String>,
    /// Data that could not be taken into account.
    pub warnings: Problems,
}

/// Diagnoses a campaign with a protocol.
///
/// # Errors
/// The campaign cannot be compared or evaluated, or a simulation fails.
pub fn diagnose(
    inputs: &Inputs<'_>,
    compiled: &Compiled,
    mut sections: Vec<Section>,
) -> Result<Outcome, Problems> {
    let compiled = &compiled.only_telling();
    let mut problems = Problems::default();
    crate::diagnose::observe::columns::in_words_of(
        compiled,
        inputs.settings,
        inputs.campaign,
        &mut sections,
        &mut problems,
    );
    let (_, mut units, _) = match sections.first() {
        Some(first) => recorded(inputs.campaign, crate::data::RecordKind::Simulation, first)
            .map_err(Problems)?,
        None => {
            return Err(Problem::error("no-sections", "the campaign has no sections").into());
        }
    };
    if let Some(simulator) = inputs.simulator {
        units
            .iter_mut()
            .for_each(|(name, unit)| *unit = simulator.unit(name).unwrap_or_else(|| unit.clone()));
    }
    let (sections, held) = HeldOut::split(inputs.campaign, sections)?;
    let Some(found) = find(inputs, sections, &mut problems) else { return Err(problems) };
    let (what, held) = match held {
        Some((held, sections)) => {
            (Some(held), unseen_sections(inputs, &found, sections, &mut problems)?)
        }
        None => (None, Vec::new()),
    };
    let fitted: Vec<String> =
        found.seen.sections.iter().map(|observed| observed.section.name().to_string()).collect();
    let fitted: Vec<&str> = fitted.iter().map(String::as_str).collect();
    (inputs.trying)("the protocol");
    let quiet = |_: &str| {};
    let settings = RunSettings { traces: 0 };
    let before = certify(compiled, inputs.campaign, settings, &quiet)?;
    // The records were read before by `find`: both must compare the same sections.
    let unread = |section: &&crate::result::SectionResult| {
        section.reason.as_ref().is_some_and(Reason::is_unreadable)
    };
    if let Some(section) = before.sections.iter().find(unread) {
        let says = format!(
            "section {} could not be read again: {}",
            section.section,
            words::or_nothing(section.reason.as_ref())
        );
        return Err(Problem::error("file-unreadable", says).into());
    }
    let mut after = None;
    let mut shrink = None;
    let mut records = Vec::new();
    let mut added = Vec::new();
    let mut held_records: Vec<Signals> =
        held.iter().map(|observed| observed.simulated.clone()).collect();
    let with = |found: &Found, records: &[Signals], held_records: &[Signals]| {
        let named = named(found, records)
            .chain(held.iter().map(|observed| observed.section.name()).zip(held_records));
        evaluated(inputs.campaign, compiled, named, &units, settings)
    };
    let as_recorded = held_records.clone();
    let evaluate = |found: &Found, records: &[Signals]| with(found, records, &as_recorded);
    let mut held_out = OnHeldOut {
        named: what.is_some(),
        what: what.map_or("cross-validation".into(), |what| what.to_string()),
        sections: held.iter().map(|observed| observed.section.name().to_string()).collect(),
        before: None,
        after: None,
        fraction_removed: None,
        low: None,
        high: None,
    };
    if !found.answer.chosen.members.is_empty() {
        (inputs.trying)("the protocol with the effects");
        let all = applied(&found, &found.answer.chosen.members);
        held_records = improved(&held, inputs.catalogue, inputs.simulator, &|_| all.clone())?;
        let made = with(&found, &unseen(inputs, &found)?, &held_records)?;
        let fit_before = of_sections(&before, &fitted);
        let noise =
            noisy(&found, inputs.seed).map(|records| evaluate(&found, &records)).transpose()?;
        if held_out.named {
            let names: Vec<&str> = held_out.sections.iter().map(String::as_str).collect();
            let there = within(&before, &made, &names, inputs.seed);
            (held_out.before, held_out.after) = (Some(there.before), Some(there.after));
            (held_out.fraction_removed, held_out.low, held_out.high) =
                (Some(there.fraction_removed), Some(there.low), Some(there.high));
        }
        shrink = Some(compare(
            &fit_before,
            &of_sections(&made, &fitted),
            noise.as_ref(),
            inputs.seed,
            shares(&found),
        ));
        after = Some(made);
        records =
            improved(&found.seen.sections, inputs.catalogue, inputs.simulator, &|_| all.clone())?;
        added = effects_of_origin(&all, inputs.catalogue);
    }
    let protocol = (before.verdict, after.as_ref().map(|after: &Certification| after.verdict));
    let mut diagnosis =
        super::answer::words::diagnosis(inputs, &found, &units, protocol, (shrink, held_out));
    diagnosis.pictures =
        super::answer::pictures::pictures(inputs.settings, &found, &records, &units);
    let simulator = inputs.simulator.map(|simulator| simulator.name().to_string());
    let held = held.into_iter().zip(held_records).collect();
    Ok(Outcome {
        diagnosis,
        found,
        before,
        after,
        improved: records,
        held,
        units,
        added,
        simulator,
        warnings: problems,
    })
}

/// Reads the held-out sections.
fn unseen_sections(
    inputs: &Inputs<'_>,
    found: &Found,
    sections: Vec<Section>,
    problems: &mut Problems,
) -> Result<Vec<Observed>, Problems> {
    let declared = |name: &str| found.declared.get(name);
    let unit = |channel: &str| inputs.simulator?.unit(channel);
    let read = Observations::read(
        inputs.campaign,
        sections,
        inputs.catalogue,
        inputs.settings,
        &declared,
        &unit,
        problems,
    );
    read.map(|seen| seen.sections).ok_or_else(|| Problems(std::mem::take(&mut problems.0)))
}

/// Records by the name of their section.
fn named<'a>(
    found: &'a Found,
    records: &'a [Signals],
) -> impl Iterator<Item = (&'a str, &'a Signals)> {
    found.seen.sections.iter().map(|observed| observed.section.name()).zip(records)
}

/// Records with the effects. The sizes for a section are fitted to the other folds.
fn unseen(inputs: &Inputs<'_>, found: &Found) -> Result<Vec<Signals>, Problems> {
    let folds = folds(&found.strata);
    let effects = |fold: &Vec<usize>| applied(found, &trained(found, fold));
    let fitted: Vec<Vec<Applied>> = folds.iter().map(effects).collect();
    let of = |at: usize| {
        folds
            .iter()
            .position(|fold| fold.contains(&at))
            .map_or_else(Vec::new, |fold| fitted[fold].clone())
    };
    Ok(improved(&found.seen.sections, inputs.catalogue, inputs.simulator, &of)?)
}

/// The measured records with the declared white noise added once more; nothing where no noise is
/// declared.
fn noisy(found: &Found, seed: u64) -> Option<Vec<Signals>> {
    let seen = &found.seen;
    seen.noise.iter().any(|sd| *sd > 0.0).then(|| {
        let mut random = Gauss::new(seed);
        let mut with_noise = |observed: &Observed| {
            let mut signals = observed.measured.clone();
            for (channel, sd) in seen.layout.channels.iter().zip(&seen.noise) {
                let values = signals
                    .channels
                    .iter_mut()
                    .filter(|known| known.name == channel.name)
                    .flat_map(|known| &mut known.values);
                values.for_each(|value| *value += sd * random.next());
            }
            signals
        };
        seen.sections.iter().map(&mut with_noise).collect()
    })
}

/// Influence of effects that are known to be true.
#[derive(Clone, Debug)]
pub struct Really {
    /// Length of the whitened change, in standard deviations.
    pub detectability: f64,
    /// With several effects: the smallest part of one effect that no size of the others reproduces,
    /// in standard deviations.
    pub weakest: Option<f64>,
    /// Share of the gap that the effects remove.
    pub removed: f64,
    /// Cells of the map that the effects change.
    pub cells: Vec<String>,
}

/// Influence of effects that are known to be true, added to the simulation. Nothing if they cannot
/// be added.
pub fn effect_of_truth(
    campaign: &Campaign,
    compiled: &Compiled,
    outcome: &Outcome,
    catalogue: &Catalogue,
    effects: &[Applied],
) -> Option<Really> {
    let found = &outcome.found;
    let model = crate::simulate::Builtin::new(campaign, &mut Problems::default());
    let simulator = model.as_ref().map(|model| model as &dyn Simulator);
    let records =
        improved(&found.seen.sections, catalogue, simulator, &|_| effects.to_vec()).ok()?;
    let changed = |records: &[Signals]| -> Vec<f64> {
        let features: Vec<f64> = records
            .iter()
            .enumerate()
            .flat_map(|(at, signals)| found.seen.of(at, signals, true))
            .collect();
        less(&features, &found.ground.simulated)
    };
    let change = changed(&records);
    let beside = |at: usize| {
        let others: Vec<Applied> = effects
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at)
            .map(|(_, one)| one.clone())
            .collect();
        let records =
            improved(&found.seen.sections, catalogue, simulator, &|_| others.clone()).ok()?;
        let others = changed(&records);
        Some(across(
            &found.alone.whitener.apply(&less(&change, &others)),
            &found.alone.whitener.apply(&others),
        ))
    };
    let several = if effects.len() > 1 { 0..effects.len() } else { 0..0 };
    let held =
        outcome.held.iter().map(|(observed, _)| (observed.section.name(), &observed.simulated));
    let made = named(found, &records).chain(held);
    let made = evaluated(
        campaign,
        &compiled.only_telling(),
        made,
        &outcome.units,
        RunSettings { traces: 0 },
    )
    .ok()?;
    let fitted: Vec<&str> =
        found.seen.sections.iter().map(|observed| observed.section.name()).collect();
    let (before, made) = (of_sections(&outcome.before, &fitted), of_sections(&made, &fitted));
    let settings = Settings::read(catalogue, &mut Problems::default())?;
    Some(Really {
        detectability: super::run::length(&found.alone.whitener, &change),
        weakest: several.filter_map(beside).reduce(f64::min),
        removed: compare(&before, &made, None, 1, Vec::new()).fraction_removed,
        cells: crate::diagnose::describe::locate::moved(&settings, found, &change),
    })
}

/// Length of the component of a whitened change that is orthogonal to another.
fn across(change: &[f64], other: &[f64]) -> f64 {
    let along = dot(change, other) / dot(other, other).max(f64::MIN_POSITIVE);
    change
        .iter()
        .zip(other)
        .map(|(change, other)| (change - along * other).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// The protocol evaluated on the campaign with other simulated records, in memory.
fn evaluated<'a>(
    campaign: &Campaign,
    compiled: &Compiled,
    records: impl Iterator<Item = (&'a str, &'a Signals)>,
    units: &Units,
    settings: RunSettings,
) -> Result<Certification, Problems> {
    let copy = with_records(campaign, records, &|name| Unit::of(name, units))?;
    certify(compiled, &copy, settings, &|_| {})
}

/// Writes the campaign with the named effects added to its simulation, and with an origin that
/// states them. Without a named effect, the simulation is written as it was read. No file is in
/// place before the outputs are committed.
///
/// # Errors
/// A file cannot be written.
pub fn write_improved(
    outputs: &mut Outputs,
    campaign: &Campaign,
    outcome: &Outcome,
    format: Format,
) -> Result<(), Problem> {
    let as_read =
        || outcome.found.seen.sections.iter().map(|observed| observed.simulated.clone()).collect();
    let records: Vec<Signals> =
        if outcome.improved.is_empty() { as_read() } else { outcome.improved.clone() };
    let held = outcome.held.iter().map(|(observed, signals)| (observed.section.name(), signals));
    let records = named(&outcome.found, &records).chain(held);
    let made = Made {
        command: "diagnose",
        simulator: outcome.simulator.as_deref().filter(|_| !outcome.added.is_empty()),
        effects: outcome.added.clone(),
        added: true,
        fitted: !outcome.added.is_empty(),
    };
    write_records(outputs, campaign, (format, records, &outcome.units), Some(&made))
}

/// Writes a copy of a campaign with other simulated records.
fn write_records<'a>(
    outputs: &mut Outputs,
    campaign: &Campaign,
    (format, records, units): (Format, impl Iterator<Item = (&'a str, &'a Signals)>, &Units),
    made: Option<&Made<'_>>,
) -> Result<(), Problem> {
    let files: Result<Vec<(&str, Vec<u8>)>, Problem> = records
        .map(|(section, signals)| {
            Ok((section, record_file(format, signals, &|name| Unit::of(name, units))?))
        })
        .collect();
    write_campaign(outputs, campaign, (format, files?.into_iter()), made)
}

#[cfg(test)]
mod tests {
    /// A change with components 3 along and 4 across another has the orthogonal length 4; a
    /// parallel change has 0.
    #[test]
    fn what_no_size_of_another_adds_is_across_it() {
        assert!((super::across(&[3.0, 4.0, 0.0], &[2.0, 0.0, 0.0]) - 4.0).abs() < 1e-12);
        assert!(super::across(&[1.0, 2.0], &[2.0, 4.0]) < 1e-12);
        assert!((super::across(&[3.0, 4.0], &[0.0, 0.0]) - 5.0).abs() < 1e-12);
    }
}
