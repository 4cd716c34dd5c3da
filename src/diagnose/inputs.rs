//! Inputs of a diagnosis.

use super::settings::Settings;
use crate::data::Campaign;
use crate::diagnose::observe::cache::Cache;
use crate::effects::Catalogue;
use crate::model::parameter;
use crate::simulate::Simulator;

/// Progress callback: called with the name of the current step.
pub type Trying<'a> = &'a (dyn Fn(&str) + Sync);

/// A campaign of known state, and its simulator.
pub struct Reference<'a> {
    pub campaign: &'a Campaign,
    pub simulator: Option<&'a dyn Simulator>,
    pub cache: Option<Cache>,
}

impl std::fmt::Debug for Reference<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reference").field("campaign", &self.campaign.name).finish_non_exhaustive()
    }
}

/// Inputs of a diagnosis.
pub struct Inputs<'a> {
    pub campaign: &'a Campaign,
    pub catalogue: &'a Catalogue,
    pub settings: &'a Settings,
    pub simulator: Option<&'a dyn Simulator>,
    pub cache: Option<Cache>,
    /// Campaigns of known state.
    pub references: &'a [Reference<'a>],
    pub seed: u64,
    pub trying: Trying<'a>,
}

impl std::fmt::Debug for Inputs<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Inputs").field("campaign", &self.campaign.name).finish_non_exhaustive()
    }
}

/// The value of a simulator parameter without any effect: from the vehicle file, else its neutral
/// value.
pub fn value_of(campaign: &Campaign, key: &str) -> Option<f64> {
    campaign
        .vehicle
        .lookup(key)
        .and_then(|node| crate::simulate::number_of(node, key))
        .or_else(|| parameter(key)?.neutral)
}
