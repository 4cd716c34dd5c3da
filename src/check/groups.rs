//! Checks which rows a limit, a minimum or a report is of, and by what keys they form groups.

use super::{plan::Scope, prelude::*, scope::Scope as Names};
use crate::syntax::phrase::Scope as Written;

/// Keys of groups that every campaign has.
const KEYS: [&str; 5] = ["zone", "section", "site", "record", super::resolve::CAMPAIGN];

/// What is grouped.
#[derive(Clone, Debug, Default)]
pub struct Grouped {
    /// In words: "the values of `Y`".
    what: String,
    /// The places of the signals; `None` of sections, which have no place and no record.
    places: Option<Vec<String>>,
    /// Dimension of the compared values, where there are any.
    pub sides: Option<Dimension>,
}

impl Grouped {
    /// The values of a quantity.
    pub fn values(quantity: &Block, places: &[String], sides: Option<Dimension>) -> Self {
        Self {
            what: format!("the values of `{}`", quantity.name_text()),
            places: Some(places.to_vec()),
            sides,
        }
    }

    /// The sections used.
    pub fn sections() -> Self {
        Self { what: "the sections".into(), ..Self::default() }
    }
}

impl Checker<'_> {
    /// A scope by itself, or once for every zone if it says so, with the zone. One that was not
    /// understood is kept, so that what else there is in the rule is looked at.
    pub fn zone_by_zone(
        &self,
        scope: Option<(Scope, bool)>,
    ) -> Vec<(Option<Scope>, Option<String>)> {
        let Some((scope, true)) = scope else { return vec![(scope.map(|(scope, _)| scope), None)] };
        let zones =
            if scope.zones.is_empty() { self.zone_names.clone() } else { scope.zones.clone() };
        zones
            .into_iter()
            .map(|zone| (Some(Scope { zones: vec![zone.clone()], ..scope.clone() }), Some(zone)))
            .collect()
    }

    /// The rows that a limit or a minimum applies to, and whether there is one limit for every
    /// zone.
    pub fn scope_of(&mut self, written: &Written) -> Option<(Scope, bool)> {
        let zones = self.limit_zones(&written.zones);
        let (mut each_zone, mut each, mut ok) = (false, Vec::new(), true);
        for key in &written.each {
            if is_zone(key) && !self.only_a_column(key) {
                ok &= !each_zone || self.key_twice(&key.node, key);
                if self.zone_names.is_empty() {
                    ok = self.no_zones(key);
                }
                each_zone = true;
                continue;
            }
            match self.key(key) {
                Some(found) if !each.contains(&found) => each.push(found),
                Some(_) => ok = self.key_twice(&key.node, key),
                None => ok = false,
            }
        }
        let condition = if_written(written.condition.as_ref().map(|condition| {
            Some((self.condition(condition, &mut Names::section())?, condition.words()))
        }));
        let (zones, condition) = (zones?, condition?);
        ok.then_some((Scope { zones, each, condition }, each_zone))
    }

    fn limit_zones(&mut self, zones: &[At<String>]) -> Option<Vec<String>> {
        let mut found: Vec<String> = Vec::new();
        let mut ok = true;
        for zone in zones {
            if !self.zone_names.contains(&zone.node) {
                let help = match self.zone_names.join(", ") {
                    known if known.is_empty() => "the protocol has no zones".into(),
                    known => format!("known zones: {known}"),
                };
                self.tell(
                    problem!("unknown-zone", zone, "there is no zone {}", zone.node).help(help),
                );
                ok = false;
            } else if found.contains(&zone.node) {
                ok = self.key_twice(&format!("zone {}", zone.node), zone);
            } else {
                found.push(zone.node.clone());
            }
        }
        ok.then_some(found)
    }

    fn key_twice(&mut self, key: &str, at: &impl Located) -> bool {
        self.tell(problem!("duplicate-name", at, "`{key}` is named twice in the scope"));
        false
    }

    /// A key by which rows are grouped: section, site, record, a place of the signal, or a section
    /// column of words.
    fn key(&mut self, key: &At<String>) -> Option<Key> {
        let name = key.node.as_str();
        let Grouped { what, places, .. } = self.grouped.clone();
        match name {
            "section" => return Some(Key::Section),
            "site" => return Some(Key::Site),
            "record" if places.is_some() => return Some(Key::Record),
            _ => {}
        }
        if let Some(place) = places
            .iter()
            .flatten()
            .find(|place| *place == name || Some(place.as_str()) == name.strip_suffix('s'))
        {
            return Some(Key::Place(place.clone()));
        }
        if let Some(index) = self.campaign_column(name, &key.place()) {
            if matches!(self.names.columns[index].kind, DatumKind::Number(_)) {
                let help =
                    "declare the column with `one of ...`, or use it in an estimate: `mean of ...`";
                return self.refuse(
                    problem!(
                        "not-a-word",
                        key,
                        "`{name}` is a number; only a column of words can form groups"
                    )
                    .help(help),
                );
            }
            return Some(Key::Column(index));
        }
        if self.names.defines.contains_key(name) {
            let problem = problem!("unknown-key", key, "{what} cannot be grouped by `{name}`");
            return self.refuse(
                problem
                    .help(format!("`{name}` is a definition; only columns of words form groups")),
            );
        }
        let words =
            self.names.columns.iter().filter(|datum| !matches!(datum.kind, DatumKind::Number(_)));
        let columns = words.map(|datum| datum.name.as_str()).filter(|name| !KEYS.contains(name));
        let of_all = KEYS.into_iter().filter(|key| places.is_some() || *key != "record");
        let known = of_all.chain(places.iter().flatten().map(String::as_str)).chain(columns);
        self.refuse(
            problem!("unknown-key", key, "{what} cannot be grouped by `{name}`")
                .suggest(name, known),
        )
    }

    /// A key inside an estimate: there the zone is one like others.
    pub fn group_key(&mut self, key: &At<String>) -> Option<Key> {
        if !is_zone(key) {
            return self.key(key);
        }
        match self.zone.as_ref().map(|zone| &zone.kind) {
            Some(Kind::Column(index)) => Some(Key::Column(*index)),
            _ if self.only_a_column(key) => self.key(key),
            _ => {
                self.no_zones(key);
                None
            }
        }
    }

    /// Whether a key that may be the zone is a column of words like others, as the protocol has no
    /// zones.
    fn only_a_column(&self, key: &At<String>) -> bool {
        self.zone_names.is_empty() && self.names.columns.iter().any(|datum| datum.name == key.node)
    }

    fn no_zones(&mut self, key: &At<String>) -> bool {
        let help = "add `zone` blocks, and `zone zone` to `sections`; or declare a `section zone` with `one of ...`, whose words then form groups";
        self.tell(error("unknown-zone", "the protocol has no zones", key).help(help));
        false
    }
}

fn is_zone(key: &At<String>) -> bool {
    matches!(key.node.as_str(), "zone" | "zones")
}
