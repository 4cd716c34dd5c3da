//! The marks of zones: the same zone looks the same in every figure of a report.

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
    /// Zones the protocol names, then those only the sections name.
    pub fn of(found: &Certification) -> Self {
        let named = found.zones.iter().map(|zone| zone.zone.clone());
        let given = found.sections.iter().filter_map(|section| section.zone.clone());
        named.chain(given).collect()
    }

    /// Shape and colour; those of no zone are the first.
    pub fn mark(&self, zone: Option<&str>) -> (Mark, RGBColor) {
        let n = zone.and_then(|zone| self.names.get_index_of(zone)).unwrap_or(0);
        (Mark::nth(n), style::color(n))
    }

    /// Legend of those zones that are there, in their order.
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
