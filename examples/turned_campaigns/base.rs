//! A campaign with known deficiencies of its model.

use std::path::Path;

use fishplate::data::{Campaign, RecordKind};
use fishplate::effects::{Applied, Catalogue, Operator, Signals};
use fishplate::model::Vehicle;
use fishplate::problem::{Problem, Problems};
use fishplate::simulate::{Builtin, Plan, Section, Simulator, Task, in_units, recorded, sections};
use serde_json::Value;

/// A campaign, and the corrections of its known deficiencies.
#[derive(Debug)]
pub struct Base {
    pub campaign: Campaign,
    pub sections: Vec<Section>,
    /// The vehicle as measured.
    pub vehicle: Vehicle,
    /// Parameters that are missing in the vehicle file.
    pub settings: Vec<(String, f64)>,
    /// Operations to be removed from the records.
    chain: Vec<(Operator, f64, Vec<String>)>,
}

impl Base {
    /// Opens a campaign with its `truth.json`, if it has one.
    ///
    /// # Errors
    /// It cannot be read, or contains an effect that cannot be removed.
    pub fn open(folder: &Path, catalogue: &Catalogue) -> Result<Self, String> {
        let shown = folder.display();
        let mut problems = Problems::default();
        let campaign = Campaign::open(folder, &mut problems).ok_or_else(|| all(&problems))?;
        let sections = sections(&campaign, &mut problems).ok_or_else(|| all(&problems))?;
        let truth = folder.join("truth.json");
        let hidden = match std::fs::read_to_string(&truth) {
            Ok(text) => {
                let truth: Value = serde_json::from_str(&text)
                    .map_err(|error| format!("{}: {error}", truth.display()))?;
                let effects = truth["effects"].as_array().cloned().unwrap_or_default();
                effects.iter().map(|effect| applied(catalogue, effect)).collect::<Option<Vec<_>>>()
            }
            Err(_) => Some(Vec::new()),
        };
        let plan =
            hidden.and_then(|hidden| Plan::new(catalogue, &hidden, &Section::nowhere(), None).ok());
        let can_go = |(operator, ..): &(Operator, f64, Vec<String>)| {
            matches!(operator, Operator::Gain | Operator::Offset | Operator::Polarity)
        };
        let plan =
            plan.filter(|plan| plan.formulas.is_empty() && plan.operators.iter().all(can_go));
        let Plan { settings, operators: chain, .. } =
            plan.ok_or_else(|| format!("{shown} hides what cannot be taken off"))?;
        let mut vehicle = Vehicle::from_values(|key| {
            campaign.vehicle.lookup(key).and_then(|node| fishplate::simulate::number_of(node, key))
        })
        .map_err(|_| format!("{shown}: the vehicle file is not whole"))?;
        for (key, value) in &settings {
            vehicle
                .set(key, *value)
                .map_err(|_| format!("{shown}: the vehicle has no `{key}` of {value}"))?;
        }
        Ok(Self { campaign, sections, vehicle, settings, chain })
    }

    /// The record of a section without the effects of its truth, in the units of the model.
    pub fn measured(&self, simulator: &Builtin<'_>, section: &Section) -> Result<Signals, String> {
        let (mut signals, units, _) = recorded(&self.campaign, RecordKind::Measurement, section)
            .map_err(|found| all(&Problems(found)))?;
        in_units(&mut signals, &units, &|channel| simulator.unit(channel))
            .map_err(|problem| problem.says)?;
        for (operator, value, channels) in &self.chain {
            for channel in
                signals.channels.iter_mut().filter(|channel| channels.contains(&channel.name))
            {
                let without = |recorded: f64| match operator {
                    Operator::Offset => recorded - value,
                    _ => recorded / value,
                };
                channel.values.iter_mut().for_each(|recorded| *recorded = without(*recorded));
            }
        }
        Ok(signals)
    }

    /// The simulation of a section with further parameters set.
    pub fn simulated(
        &self,
        simulator: &Builtin<'_>,
        section: &Section,
        further: &[(String, f64)],
    ) -> Result<Signals, String> {
        let settings: Vec<(String, f64)> = self.settings.iter().chain(further).cloned().collect();
        simulator
            .run(&Task { section, settings: &settings, shift: 0.0, inside_only: false })
            .map_err(|problem: Problem| problem.says)
    }

    /// A parameter of the vehicle as measured.
    pub fn value(&self, key: &str) -> f64 {
        self.vehicle.get(key).unwrap_or(0.0)
    }

    /// Whether the vehicle has a secondary suspension.
    pub fn sprung(&self) -> bool {
        self.campaign.vehicle.lookup("secondary_suspension").and_then(|node| node.scalar_text())
            == Some("true")
    }

    /// One declared standard deviation; 0 if the campaign declares none.
    pub fn declared(&self, name: &str) -> f64 {
        let declared = self
            .campaign
            .tree
            .get("declared_tolerances")
            .and_then(|tolerances| tolerances.get(name));
        declared.and_then(fishplate::yaml::Node::number).unwrap_or(0.0)
    }
}

/// An effect in the form of a truth; none if it is not in the catalogue, or is confined.
fn applied(catalogue: &Catalogue, effect: &Value) -> Option<Applied> {
    let known = catalogue.effect(effect["name"].as_str()?)?;
    if effect.as_object()?.keys().any(|key| !["name", "parameters"].contains(&key.as_str())) {
        return None;
    }
    let (mut values, mut channels) = (Vec::new(), Vec::new());
    for (name, value) in effect["parameters"].as_object()? {
        let (name, channel) = known.parameters.iter().find_map(|parameter| {
            match parameter.name.split_once("<channel>") {
                Some((before, _)) => name
                    .strip_prefix(before)
                    .map(|channel| (parameter.name.clone(), Some(channel.to_string()))),
                None => (parameter.name == *name).then(|| (name.clone(), None)),
            }
        })?;
        values.push((name, value.as_f64()?));
        channels.extend(channel);
    }
    Some(Applied { effect: known.name.clone(), values, channels, confined: None })
}

pub fn all(problems: &Problems) -> String {
    problems.0.iter().map(|problem| problem.says.clone()).collect::<Vec<_>>().join("; ")
}
