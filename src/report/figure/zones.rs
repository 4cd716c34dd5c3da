//! Marks of zones: a zone has the same mark in all figures of a report.

use indexmap::IndexSet;
use plotters::style::RGBColor;

use super::legend::Entry;
use super::style::{self, Mark};
use crate::result::Certification;

/// The zones of a campaign in the order of the protocol.
#[derive(Clone, Debug, Default)]
pub struct Zones {
    names: IndexSet<String>,
}

impl Zones {
    /// Zones of the protocol, then further zones of the sections.
    pub fn of(found: &Certification) -> Self {
        let named = found.zones.iter().map(|zone| zone.zone.clone());
        let given = found.sections.iter().filter_map(|section| section.zone.clone());
        named.chain(given).collect()
    }

    /// Shape and colour; without a zone, the first ones.
    pub fn mark(&self, zone: Option<&str>) -> (Mark, RGBColor) {
        let n = zone.and_then(|zone| self.names.get_index_of(zone)).unwrap_or(0);
        (Mark::nth(n), style::color(n))
    }

    /// Legend of the given zones, in order.
    pub fn legend<'a>(&self, there: impl Iterator<Item = Option<&'a str>>) -> Vec<Entry> {
        let there: IndexSet<&str> = there.flatten().collect();
        self.names
            .iter()
            .filter(|name| there.contains(name.as_str()))
            .map(|name| {
                let (mark, color) = self.mark(Some(name));
                Entry::mark(mark, color, format!("zone {name}"))
            })
            .collect()
    }
}

impl FromIterator<String> for Zones {
    fn from_iter<T: IntoIterator<Item = String>>(names: T) -> Self {
        Self { names: names.into_iter().collect() }
    }
}
