//! Groups of rows: which a limit is about.

use super::facts::Facts;
use super::sections::Unit;
use super::table::Member;
use crate::check::evaluate::flag;
use crate::check::plan::{Key, Limit, Plan, Quantity, Scalar, Scope};

/// What an estimate is taken over.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    scope: &'a Scope,
    /// The zones of the scope, or that of one section.
    zones: Vec<String>,
    /// Each key with the member that the group is of, and what it is called.
    keys: Vec<(&'a Key, String, String)>,
}

/// The groups of a limit. Its zones that need no section and have none are left out; so are zones that the quantity leaves out by its own
/// condition, unless it leaves out all, and groups of which a condition leaves no row. A group of a place is there wherever the place was
/// recorded.
pub fn parts<'a>(plan: &Plan, quantity: &Quantity, limit: &'a Limit, members: &[Member<'_>], facts: &Facts) -> Vec<Part<'a>> {
    let scope = &limit.scope;
    let selective = quantity.only.is_some() && !members.is_empty();
    let needed = |name: &str| !selective && plan.zones.iter().any(|zone| zone.name == name && zone.minimum_sections > 0);
    let filled = |zone: &str| members.iter().any(|member| member.unit.zone.as_deref() == Some(zone));
    if !scope.zones.is_empty() && !scope.zones.iter().any(|zone| needed(zone) || filled(zone)) {
        return Vec::new();
    }
    let whole = Part { scope, zones: scope.zones.clone(), keys: Vec::new() };
    if scope.each.is_empty() {
        let excluded =
            scope.condition.is_some() && !scope.zones.is_empty() && members.iter().all(|member| whole.has(member, facts) == Ok(false));
        return if excluded { Vec::new() } else { vec![whole] };
    }
    // What differs by place is expected in every zone that has rows at all; what differs by section is what there is.
    let in_scope: Vec<&Member<'_>> = members.iter().filter(|member| whole.has(member, facts) == Ok(true)).collect();
    let mut groups = vec![whole];
    for key in &scope.each {
        let mut found: Vec<(String, String)> = Vec::new();
        let all: &mut dyn Iterator<Item = &Member<'_>> =
            if matches!(key, Key::Place(_)) { &mut members.iter() } else { &mut in_scope.iter().copied() };
        for member in all {
            let of = of_key(plan, quantity, key, member);
            if !found.contains(&of) {
                found.push(of);
            }
        }
        let with = |group: &Part<'a>, (member, words): &(String, String)| {
            let mut group = group.clone();
            group.keys.push((key, member.clone(), words.clone()));
            group
        };
        groups = groups.iter().flat_map(|group| found.iter().map(move |member| with(group, member))).collect();
    }
    let there = |group: &Part<'_>| in_scope.iter().any(|member| group.has_keys_of_section(plan, quantity, member));
    groups.retain(|group| there(group) || in_scope.is_empty() && scope.condition.is_none());
    // What should be there and is not is told by the group of all.
    if groups.is_empty() && scope.condition.is_none() {
        return vec![Part { scope, zones: scope.zones.clone(), keys: Vec::new() }];
    }
    groups
}

/// The member of a key that a row is of, and what the group is called.
fn of_key(plan: &Plan, quantity: &Quantity, key: &Key, member: &Member<'_>) -> (String, String) {
    let named = |of: &str, name: String| (name.clone(), format!("{of} {name}"));
    match key {
        Key::Section => named("section", member.unit.name.clone()),
        Key::Site => named("site", (member.unit.site + 1).to_string()),
        Key::Record => named("record", member.row.record.as_deref().unwrap_or("1").to_string()),
        Key::Place(place) => {
            let places = &quantity.positions[member.row.position].places;
            let of = places.iter().find(|(known, _)| known == place).map_or(String::new(), |(_, member)| member.clone());
            named(&place.replace('_', " "), of)
        }
        Key::Column(index) => {
            let datum = &plan.columns[*index];
            let of = match &member.unit.columns[*index] {
                Ok(Scalar::Word(word)) => word.clone(),
                Ok(Scalar::Flag(flag)) => flag.to_string(),
                Ok(Scalar::Number(number)) => format!("{number}"),
                Err(_) => "not stated".into(),
            };
            named(&datum.key, of)
        }
    }
}

impl<'a> Part<'a> {
    /// What a limit of a single value is about: the zone of its section.
    pub fn of_section(plan: &Plan, limit: &'a Limit, unit: &Unit) -> Self {
        let zones = unit.zone.iter().filter(|_| !plan.zones.is_empty()).cloned().collect();
        Self { scope: &limit.scope, zones, keys: Vec::new() }
    }

    /// `all`, `zones 2, 3`, `zone 1, wheelset 2`
    pub fn in_words(&self) -> String {
        let mut words: Vec<String> = Vec::new();
        if !self.zones.is_empty() {
            words.push(format!("{} {}", if self.zones.len() == 1 { "zone" } else { "zones" }, self.zones.join(", ")));
        }
        words.extend(self.keys.iter().map(|(_, _, words)| words.clone()));
        words.extend(self.scope.condition.iter().map(|(_, words)| words.clone()));
        if words.is_empty() { "all".into() } else { words.join(", ") }
    }

    /// Each key with its member, the zone first; none where the zone alone tells groups apart.
    pub fn keys(&self) -> Vec<(String, String)> {
        if self.keys.is_empty() {
            return Vec::new();
        }
        let zone = match self.zones.as_slice() {
            [one] => Some(("zone".to_string(), one.clone())),
            _ => None,
        };
        let of_key = |(_, member, words): &(&Key, String, String)| {
            (words.strip_suffix(member.as_str()).unwrap_or(words).trim_end().to_string(), member.clone())
        };
        zone.into_iter().chain(self.keys.iter().map(of_key)).collect()
    }

    /// The rows of the group.
    ///
    /// # Errors
    /// It cannot be told whether a section belongs to it.
    pub fn members<'m>(&self, plan: &Plan, quantity: &Quantity, facts: &Facts, all: &[Member<'m>]) -> Result<Vec<Member<'m>>, String> {
        let mut inside = Vec::new();
        for member in all {
            if self.has(member, facts)? && self.has_keys(plan, quantity, member) {
                inside.push(*member);
            }
        }
        Ok(inside)
    }

    /// Whether rows of a section belong to it, whatever their position.
    pub fn has_section(&self, unit: &Unit, facts: &Facts) -> Result<bool, String> {
        if !self.zones.is_empty() && !unit.zone.as_ref().is_some_and(|zone| self.zones.contains(zone)) {
            return Ok(false);
        }
        let Some((condition, _)) = &self.scope.condition else { return Ok(true) };
        flag(condition, &unit.known(facts))
            .map_err(|reason| format!("it cannot be determined whether section {} belongs to this group: {reason}", unit.name))
    }

    /// Which positions of the quantity belong to it.
    pub fn positions(&self, quantity: &Quantity) -> Vec<bool> {
        let of_place = |key: &Key| if let Key::Place(place) = key { Some(place.clone()) } else { None };
        let asked: Vec<(String, &String)> = self.keys.iter().filter_map(|(key, of, _)| Some((of_place(key)?, of))).collect();
        let at = |places: &[(String, String)], place: &str, of: &str| places.iter().any(|(known, member)| known == place && member == of);
        quantity.positions.iter().map(|position| asked.iter().all(|(place, of)| at(&position.places, place, of))).collect()
    }

    fn has(&self, member: &Member<'_>, facts: &Facts) -> Result<bool, String> {
        self.has_section(member.unit, facts)
    }

    pub fn has_keys(&self, plan: &Plan, quantity: &Quantity, member: &Member<'_>) -> bool {
        self.keys.iter().all(|(key, of, _)| of_key(plan, quantity, key, member).0 == *of)
    }

    /// As [`Self::has_keys`], whatever the position.
    fn has_keys_of_section(&self, plan: &Plan, quantity: &Quantity, member: &Member<'_>) -> bool {
        let mut of_section = self.keys.iter().filter(|(key, ..)| !matches!(key, Key::Place(_)));
        of_section.all(|(key, of, _)| of_key(plan, quantity, key, member).0 == *of)
    }

    /// Whether a limit of this scope is the limit of the group, too; how closely it was meant for it.
    pub fn covered_by(&self, scope: &Scope) -> Option<Closeness> {
        let condition = |scope: &Scope| scope.condition.as_ref().map(|(_, words)| words.clone());
        let within = scope.zones.is_empty() || !self.zones.is_empty() && self.zones.iter().all(|zone| scope.zones.contains(zone));
        let alike = scope.each.iter().eq(self.keys.iter().map(|(key, ..)| *key)) && condition(scope) == condition(self.scope);
        if alike && within && scope.zones.is_empty() == self.zones.is_empty() {
            return Some(Closeness::Same);
        }
        scope.is_all().then_some(Closeness::General)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Closeness {
    General,
    Same,
}
