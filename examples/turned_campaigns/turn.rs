//! Writes one campaign as a folder.

use std::path::Path;

use fishplate::data::RecordKind;
use fishplate::data::record::Format;
use fishplate::data::write::Outputs;
use fishplate::disk::SetKind;
use fishplate::effects::{Applied, Catalogue, Signals};
use fishplate::problem::Problems;
use fishplate::simulate::{Builtin, Plan, Section, Simulator, incremented, record_file};
use fishplate::units::Unit;
use serde_json::{Value, json};

use super::base::{Base, all};
use super::cases::Case;
use super::hidden::{chosen, told};

/// Writes a campaign with hidden effects.
///
/// # Errors
/// A file cannot be read or written, or the model diverges.
pub fn campaign(out: &Path, base: &Base, case: &Case, catalogue: &Catalogue) -> Result<(), String> {
    let campaign = &base.campaign;
    let mut problems = Problems::default();
    let simulator = Builtin::new(campaign, &mut problems).ok_or_else(|| all(&problems))?;
    let (effects, added) =
        (chosen(catalogue, &case.hidden.effects)?, chosen(catalogue, &case.hidden.added)?);
    let moved: Vec<(String, f64)> = case
        .hidden
        .vehicle
        .iter()
        .chain(case.fault.iter().flat_map(|fault| &fault.vehicle))
        .cloned()
        .collect();
    let text = |key: &str| {
        campaign.tree.lookup(key).and_then(|node| node.scalar_text()).unwrap_or(key).to_string()
    };
    let (measurement, simulation, vehicle) =
        (text("measurement"), text("simulation"), text("vehicle"));

    let mut files = vec![("campaign.yaml".to_string(), campaign.source.text.clone().into_bytes())];
    files.extend(campaign.other_files(&[RecordKind::Simulation]).map_err(|problem| problem.says)?);
    files.retain(|(inside, _)| !inside.starts_with(&format!("{measurement}/")));
    for (inside, bytes) in &mut files {
        if *inside == vehicle {
            let said = base
                .settings
                .iter()
                .chain(&moved)
                .map(|(key, value)| (key.split('.').collect(), *value));
            let load = static_load(base, &moved).map(|load| (vec!["static_wheel_load"], load));
            *bytes = edited(bytes, said.chain(load))?;
        } else if inside == "campaign.yaml" {
            let friction = base.settings.iter().chain(&moved).rfind(|(key, _)| key == "friction");
            *bytes = edited(
                bytes,
                friction.map(|(_, value)| (vec!["assumed_friction [-]"], *value)).into_iter(),
            )?;
        }
    }

    let mut outputs = Outputs::of(SetKind::Campaign, out);
    let mut add =
        |inside: &str, bytes: &[u8]| outputs.add(inside, bytes).map_err(|problem| problem.says);
    files.iter().try_for_each(|(inside, bytes)| add(inside, bytes))?;
    for (at, section) in base.sections.iter().enumerate() {
        let mut signals = measured(base, &simulator, section, catalogue, (&effects, &added))?;
        if let Some(fault) = &case.fault {
            (fault.does)(&mut signals, section, at);
        }
        let unit = |channel: &str| simulator.unit(channel).unwrap_or_else(Unit::one);
        let bytes = |signals: &Signals| {
            record_file(Format::Csv, signals, &unit).map_err(|problem| problem.says)
        };
        add(&format!("{measurement}/{}.csv", section.name()), &bytes(&signals)?)?;
        let simulated = base.simulated(&simulator, section, &moved)?;
        add(&format!("{simulation}/{}.csv", section.name()), &bytes(&simulated)?)?;
    }
    add("truth.json", truth(base, case, &effects).as_bytes())?;
    outputs.commit().map_err(|problem| problem.says)
}

/// The record of a section with the hidden effects.
fn measured(
    base: &Base,
    simulator: &Builtin<'_>,
    section: &Section,
    catalogue: &Catalogue,
    (effects, added): (&[Applied], &[Applied]),
) -> Result<Signals, String> {
    let plan = |effects: &[Applied]| {
        Plan::new(catalogue, effects, section, None).map_err(|problem| problem.says)
    };
    let mut signals = base.measured(simulator, section)?;
    if !added.is_empty() {
        let with = base.simulated(simulator, section, &plan(added)?.settings)?;
        signals = incremented(&signals, &with, &base.simulated(simulator, section, &[])?);
    }
    plan(effects)?.operate(&mut signals, section).map_err(|problem| problem.says)?;
    Ok(signals)
}

/// The static wheel load in kN, if the mass of the car body in the vehicle file changes.
fn static_load(base: &Base, moved: &[(String, f64)]) -> Option<f64> {
    let mut vehicle = base.vehicle.clone();
    let (_, mass) = moved.iter().find(|(key, _)| key == "car_body.mass")?;
    let before: f64 = base
        .campaign
        .vehicle
        .lookup("static_wheel_load")?
        .scalar_text()?
        .split(' ')
        .next()?
        .parse()
        .ok()?;
    let load = base.vehicle.static_wheel_load();
    vehicle.set("car_body.mass", *mass).ok()?;
    Some(before + (vehicle.static_wheel_load() - load) * 1e-3)
}

/// YAML with numbers set, in the units that stand behind those before; maps that are not there are
/// made.
fn edited<'a>(
    bytes: &[u8],
    numbers: impl Iterator<Item = (Vec<&'a str>, f64)>,
) -> Result<Vec<u8>, String> {
    let mut tree: serde_yaml::Value =
        serde_yaml::from_slice(bytes).map_err(|error| error.to_string())?;
    for (path, number) in numbers {
        let place = path.iter().fold(&mut tree, |place, key| &mut place[*key]);
        *place = match place.as_str().and_then(|before| before.split_once(' ')) {
            Some((_, unit)) => serde_yaml::Value::from(format!("{number} {unit}")),
            None => serde_yaml::Value::from(number),
        };
    }
    serde_yaml::to_string(&tree).map(String::into_bytes).map_err(|error| error.to_string())
}

fn truth(base: &Base, case: &Case, effects: &[Applied]) -> String {
    let mut list: Vec<Value> = effects.iter().map(told).collect();
    list.extend(case.fault.iter().map(|_| json!({"name": "outside", "parameters": {}})));
    let note = case.fault.as_ref().map_or(String::new(), |fault| fault.says.clone());
    let truth =
        json!({"kind": case.kind, "effects": list, "campaign": base.campaign.name, "note": note});
    serde_json::to_string_pretty(&truth).unwrap_or_default() + "\n"
}
