//! Marks of zones and records: a zone has the same mark in all figures of a report.

use indexmap::IndexSet;

use super::kit::*;
use crate::result::{Certification, PairValue, RecordName};

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
    pub fn mark(&self, zone: Option<&str>) -> (Mark, Color) {
        look(zone.and_then(|zone| self.names.get_index_of(zone)).unwrap_or(0))
    }

    /// Legend of the given zones, in order.
    pub fn legend<'a>(&self, there: impl Iterator<Item = Option<&'a str>>) -> Vec<Entry> {
        let there: IndexSet<&str> = there.flatten().collect();
        self.names
            .iter()
            .filter(|name| there.contains(name.as_str()))
            .map(|name| Entry::mark(self.mark(Some(name)), format!("zone {name}")))
            .collect()
    }
}

/// Marks of the values of a quantity: one for each record where there are several, else one for
/// each zone.
#[derive(Clone, Debug)]
pub struct Marks<'a> {
    zones: &'a Zones,
    /// Empty where there is one record of each side.
    records: IndexSet<&'a RecordName>,
}

impl<'a> Marks<'a> {
    /// Of the values of one quantity or of several.
    pub fn of(values: impl Iterator<Item = &'a PairValue>, zones: &'a Zones) -> Self {
        Self { zones, records: values.filter_map(|value| value.record.as_ref()).collect() }
    }

    /// Shape and colour of a value.
    pub fn mark(&self, value: &PairValue) -> (Mark, Color) {
        match value.record.as_ref().and_then(|record| self.records.get_index_of(record)) {
            Some(n) => look(n),
            None => self.zones.mark(value.zone.as_deref()),
        }
    }

    /// Legend of the given values.
    pub fn legend(&self, values: impl Iterator<Item = &'a PairValue>) -> Vec<Entry> {
        if self.records.is_empty() {
            return self.zones.legend(values.map(|value| value.zone.as_deref()));
        }
        self.records
            .iter()
            .enumerate()
            .map(|(n, record)| Entry::mark(look(n), record.to_string()))
            .collect()
    }
}

impl FromIterator<String> for Zones {
    fn from_iter<T: IntoIterator<Item = String>>(names: T) -> Self {
        Self { names: names.into_iter().collect() }
    }
}
