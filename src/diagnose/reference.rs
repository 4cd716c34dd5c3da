//! What the simulation is wrong in anyway, learnt from campaigns whose state is known.

use super::covariance::strata;
use super::features::Kind;
use super::fit::less;
use super::observe::Observations;
use super::settings::{FeatureKind, Settings};

/// Mean difference of a campaign without effects, by stratum, channel and kind of feature. Levels are left out: they depend on the
/// sections themselves.
#[derive(Clone, Debug, Default)]
pub struct Reference {
    means: Vec<(String, String, Kind, f64)>,
    campaigns: usize,
}

/// Share of a discrepancy's standard deviation that stays once a reference is taken off: campaigns differ.
const STAYS: f64 = 0.5;

impl Reference {
    /// Learns from one campaign more.
    pub fn learn(&mut self, seen: &Observations, settings: &Settings) {
        let measured = seen.all(false, |observed| &observed.measured);
        let simulated = seen.all(true, |observed| &observed.simulated);
        let difference = less(&measured, &simulated);
        for sections in strata(seen, settings) {
            let stratum = stratum(seen, settings, sections[0]);
            for (at, feature) in seen.features.iter().enumerate().filter(|(_, feature)| feature.kind != Kind::Level) {
                let sum: f64 = sections.iter().map(|section| difference[seen.place(*section, at)]).sum();
                let name = seen.layout.channels[feature.channel].name.clone();
                self.means.push((stratum.clone(), name, feature.kind, sum / sections.len() as f64));
            }
        }
        self.campaigns += 1;
    }

    #[must_use]
    pub fn campaigns(&self) -> usize {
        self.campaigns
    }

    /// Takes what was learnt off a difference.
    pub fn take_off(&self, seen: &Observations, settings: &Settings, difference: &mut [f64]) {
        for section in 0..seen.sections.len() {
            let stratum = stratum(seen, settings, section);
            for (at, feature) in seen.features.iter().enumerate() {
                let name = &seen.layout.channels[feature.channel].name;
                let known: Vec<f64> = self
                    .means
                    .iter()
                    .filter(|(of, channel, kind, _)| *of == stratum && channel == name && *kind == feature.kind)
                    .map(|(.., mean)| *mean)
                    .collect();
                if !known.is_empty() {
                    difference[seen.place(section, at)] -= known.iter().sum::<f64>() / known.len() as f64;
                }
            }
        }
    }

    /// The settings with what remains of the discrepancies.
    #[must_use]
    pub fn narrowed(&self, settings: &Settings) -> Settings {
        let mut narrowed = settings.clone();
        let learnt = |kind: FeatureKind| kind != FeatureKind::Level;
        for discrepancy in narrowed.discrepancies.iter_mut().filter(|discrepancy| self.campaigns > 0 && learnt(discrepancy.feature)) {
            discrepancy.sd.iter_mut().for_each(|sd| *sd *= STAYS);
        }
        narrowed
    }
}

fn stratum(seen: &Observations, settings: &Settings, section: usize) -> String {
    settings.stratum.as_deref().and_then(|column| seen.sections[section].section.fact(column)).unwrap_or("").to_string()
}
