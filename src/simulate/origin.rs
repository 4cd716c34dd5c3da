//! Origin of a simulated campaign.

use crate::data::{
    Campaign, RecordKind,
    hash::sha256,
    origin::{Origin, OriginEffect, OriginFile, OriginParameter},
};
use crate::disk;
use crate::effects::{Applied, Catalogue};
use crate::problem::Problem;
use crate::yaml::Literal;

/// Maximum size of a record in bytes.
const LARGEST: u64 = 1 << 30;

/// Description of how simulated records were made.
#[derive(Clone, Debug)]
pub struct Made<'a> {
    /// The command that made them.
    pub command: &'static str,
    /// The simulator, if one was used.
    pub simulator: Option<&'a str>,
    /// See [`effects_of_origin`].
    pub effects: Vec<OriginEffect>,
    /// The effects were added to the campaign's own simulation and its existing effects.
    pub added: bool,
    /// Their sizes were fitted to the campaign's measurement.
    pub fitted: bool,
}

impl Made<'_> {
    /// The origin of the new records; with `added`, including the origin of the campaign's own
    /// simulation.
    ///
    /// # Errors
    /// A file of the campaign cannot be read.
    pub fn origin(
        &self,
        campaign: &Campaign,
        copied: &[(String, Vec<u8>)],
    ) -> Result<Origin, Problem> {
        let fingerprint = |(path, bytes): &(String, Vec<u8>)| OriginFile {
            path: path.clone(),
            sha256: sha256(bytes),
        };
        let mut sources: Vec<OriginFile> = campaign
            .files
            .iter()
            .map(|file| OriginFile { path: file.path.clone(), sha256: file.sha256.clone() })
            .collect();
        for file in copied.iter().map(fingerprint) {
            if !sources.iter().any(|known| known.path == file.path) {
                sources.push(file);
            }
        }
        let mut fitted_to = Vec::new();
        for name in &campaign.names {
            if self.added {
                let place = campaign.record_place(RecordKind::Simulation, name)?;
                let bytes = disk::read(&place.path, LARGEST).map_err(|error| {
                    Problem::error("unreadable", format!("{}: {error}", place.shown))
                })?;
                sources.push(OriginFile { path: place.inside, sha256: sha256(&bytes) });
            }
            if self.fitted {
                let inside = campaign.record_place(RecordKind::Measurement, name)?.inside;
                fitted_to.extend(sources.iter().find(|file| file.path == inside).cloned());
            }
        }
        let mut effects = self.effects.clone();
        if let (Some(before), true) = (&campaign.origin, self.added) {
            effects = before.effects.iter().chain(&effects).cloned().collect();
            let earlier: Vec<OriginFile> =
                before.fitted_to.iter().filter(|file| !fitted_to.contains(file)).cloned().collect();
            fitted_to.extend(earlier);
        }
        let before = campaign.origin.as_ref().map(|origin| &origin.campaign.0);
        let first = before.filter(|name| !name.is_empty());
        let mut imported = campaign.origin.as_ref().and_then(|origin| origin.imported.clone());
        let records = imported.iter_mut().flat_map(|imported| &mut imported.records);
        for record in records.filter(|record| record.side == RecordKind::Simulation.key()) {
            record.written = None;
        }
        Ok(Origin {
            program: Literal(concat!("fishplate ", env!("CARGO_PKG_VERSION")).to_string()),
            command: Literal(self.command.to_string()),
            campaign: Literal(first.unwrap_or(&campaign.name).clone()),
            simulator: self.simulator.map(str::to_string),
            effects,
            fitted_to,
            sources,
            imported,
        })
    }
}

/// Effects for an origin, with the units of the catalogue.
pub fn effects_of_origin(effects: &[Applied], catalogue: &Catalogue) -> Vec<OriginEffect> {
    effects.iter().map(|applied| effect(applied, catalogue)).collect()
}

fn effect(applied: &Applied, catalogue: &Catalogue) -> OriginEffect {
    let known = catalogue.effect(&applied.effect);
    // A parameter of a channel is named `gain.Y_3R` where the catalogue has `gain.<channel>`.
    let unit = |name: &str| {
        let parameters = known.into_iter().flat_map(|effect| &effect.parameters);
        let head =
            |pattern: &str| pattern.split_once('<').is_some_and(|(head, _)| name.starts_with(head));
        let found = parameters
            .into_iter()
            .find(|parameter| parameter.name == name || head(&parameter.name));
        found.map_or("-".to_string(), |parameter| parameter.unit.text.clone())
    };
    OriginEffect {
        effect: applied.effect.clone(),
        parameters: applied
            .values
            .iter()
            .map(|(name, value)| OriginParameter {
                name: name.clone(),
                value: *value,
                unit: unit(name),
            })
            .collect(),
        channels: applied.channels.clone(),
        confined_to: applied
            .confined
            .as_ref()
            .map(|place| format!("{} {}", place.column, place.values.join(", "))),
    }
}
