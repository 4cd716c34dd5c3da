//! Groups of rows that a limit applies to.

use std::collections::HashMap;

use indexmap::IndexSet;

use super::table::Member;
use crate::check::evaluate::flag;
use crate::check::plan::{Key, Limit, Plan, Position, Quantity, Scalar, Scope};
use crate::result::{self, Reason};
use crate::run::sections::{Facts, Unit};

/// The group of rows of an estimate.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    scope: &'a Scope,
    /// The zones of the scope, or the zone of one section.
    zones: Vec<String>,
    /// Each key with its printed name and the member of the group.
    keys: Vec<(&'a Key, String, String)>,
    /// Indices of its rows among those of the quantity, where keys define the groups.
    rows: Vec<usize>,
}

/// What the rows that are grouped are of.
#[derive(Clone, Copy, Debug)]
pub struct Grouped<'a> {
    pub positions: &'a [Position],
    /// Whether a zone without rows has none because of the rules of the quantity.
    selective: bool,
}

impl<'a> Grouped<'a> {
    pub fn values(quantity: &'a Quantity) -> Self {
        Self {
            positions: &quantity.positions,
            selective: quantity.only.is_some() || quantity.evaluation.of_repeats(),
        }
    }

    /// Sections by themselves, each of which is one row.
    pub fn sections() -> Self {
        Self { positions: &[], selective: true }
    }
}

/// The groups of a limit, a minimum or a report.
///
/// Left out are: zones that need no section and have none; zones that the condition of the quantity
/// excludes or that have no repeats, unless all are excluded; groups in which a condition leaves no
/// row, unless it leaves none in any group. A group of a place exists wherever the place was
/// recorded.
pub fn parts<'a>(
    plan: &Plan,
    of: Grouped<'_>,
    scope: &'a Scope,
    members: &[Member<'_>],
    facts: &Facts,
) -> Vec<Part<'a>> {
    let selective = of.selective && !members.is_empty();
    let needed = |name: &str| {
        !selective && plan.zones.iter().any(|zone| zone.name == name && zone.minimum_sections > 0)
    };
    let filled =
        |zone: &str| members.iter().any(|member| member.unit.zone.as_deref() == Some(zone));
    if !scope.zones.is_empty() && !scope.zones.iter().any(|zone| needed(zone) || filled(zone)) {
        return Vec::new();
    }
    let whole = Part { scope, zones: scope.zones.clone(), keys: Vec::new(), rows: Vec::new() };
    let inside: Vec<Result<bool, Reason>> =
        members.iter().map(|member| whole.has_section(member.unit, facts)).collect();
    // Where it cannot be determined which rows belong to it, the limit is not assessable, and the
    // reason is given.
    if inside.iter().any(Result::is_err) {
        return vec![whole];
    }
    let everywhere = Part { zones: Vec::new(), ..whole.clone() };
    let meets = |member: &Member<'_>| everywhere.has_section(member.unit, facts) == Ok(true);
    if scope.condition.is_some() && !members.iter().any(meets) {
        return vec![whole];
    }
    let rows: Vec<usize> = (0..members.len()).filter(|&at| inside[at] == Ok(true)).collect();
    if scope.each.is_empty() {
        let excluded = scope.condition.is_some() && !scope.zones.is_empty() && rows.is_empty();
        return if excluded { Vec::new() } else { vec![whole] };
    }
    let groups = whole.by_keys(plan, of.positions, members, &rows);
    // Missing groups are reported for the group of all rows.
    if groups.is_empty() && scope.condition.is_none() { vec![whole] } else { groups }
}

/// The printed name of a key, and its member that a row belongs to.
pub(in crate::run) fn of_key(
    plan: &Plan,
    positions: &[Position],
    key: &Key,
    member: &Member<'_>,
) -> (String, String) {
    let named = |key: &str, member: String| (key.to_owned(), member);
    match key {
        Key::Section => named("section", member.unit.name.clone()),
        Key::Site => named("site", member.unit.site_name.clone()),
        Key::Record => {
            named("record", member.row.record.as_ref().map_or("1".into(), ToString::to_string))
        }
        Key::Place(place) => {
            let places =
                positions.get(member.row.position).map_or(&[][..], |position| &position.places);
            let of = places
                .iter()
                .find(|(known, _)| known == place)
                .map_or(String::new(), |(_, member)| member.clone());
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
    /// Groups of rows by keys. For places, every recorded position has a group; for sections, the
    /// groups that occur.
    fn by_keys(
        &self,
        plan: &Plan,
        positions: &[Position],
        members: &[Member<'_>],
        rows: &[usize],
    ) -> Vec<Self> {
        let keys = &self.scope.each;
        let of = |member: &Member<'_>, key: &Key| of_key(plan, positions, key, member);
        let mut rows_of: HashMap<Vec<String>, Vec<usize>> = HashMap::new();
        // Combinations of the section keys, in order of occurrence.
        let mut of_sections: IndexSet<Vec<Option<(String, String)>>> = IndexSet::new();
        for &row in rows {
            let found: Vec<(String, String)> =
                keys.iter().map(|key| of(&members[row], key)).collect();
            rows_of
                .entry(found.iter().map(|(_, member)| member.clone()).collect())
                .or_default()
                .push(row);
            let by_section = keys
                .iter()
                .zip(found)
                .map(|(key, found)| (!matches!(key, Key::Place(_))).then_some(found));
            of_sections.insert(by_section.collect());
        }
        if rows.is_empty()
            && self.scope.condition.is_none()
            && keys.iter().all(|key| matches!(key, Key::Place(_)))
        {
            of_sections.insert(vec![None; keys.len()]);
        }
        let places: Vec<IndexSet<(String, String)>> = keys
            .iter()
            .map(|key| {
                if let Key::Place(_) = key {
                    members.iter().map(|member| of(member, key)).collect()
                } else {
                    IndexSet::new()
                }
            })
            .collect();
        let mut groups = Vec::new();
        for section in &of_sections {
            let mut all = vec![Self { keys: Vec::new(), ..self.clone() }];
            for (at, key) in keys.iter().enumerate() {
                let choices: Vec<(String, String)> = section[at]
                    .clone()
                    .map_or_else(|| places[at].iter().cloned().collect(), |of| vec![of]);
                let with = |group: &Self, (name, member): &(String, String)| {
                    let mut group = group.clone();
                    group.keys.push((key, name.clone(), member.clone()));
                    group
                };
                all = all
                    .iter()
                    .flat_map(|group| choices.iter().map(move |choice| with(group, choice)))
                    .collect();
            }
            groups.extend(all);
        }
        for group in &mut groups {
            let names: Vec<String> = group.keys.iter().map(|(.., member)| member.clone()).collect();
            group.rows = rows_of.remove(&names).unwrap_or_default();
        }
        groups
    }

    /// The group for a limit of a single value: the zone of its section.
    pub fn of_section(plan: &Plan, limit: &'a Limit, unit: &Unit) -> Self {
        let zones = unit.zone.iter().filter(|_| !plan.zones.is_empty()).cloned().collect();
        Self { scope: &limit.scope, zones, keys: Vec::new(), rows: Vec::new() }
    }

    /// The group as it stands in results.
    pub fn scope(&self) -> result::Scope {
        result::Scope {
            zones: self.zones.clone(),
            keys: self.keys.iter().map(|(_, name, of)| (name.clone(), of.clone())).collect(),
            condition: self.scope.condition.as_ref().map(|(_, words)| words.clone()),
        }
    }

    /// The rows of the group.
    ///
    /// # Errors
    /// It cannot be determined whether a section belongs to it.
    pub fn members<'m>(
        &self,
        facts: &Facts,
        all: &[Member<'m>],
    ) -> Result<Vec<Member<'m>>, Reason> {
        if !self.keys.is_empty() {
            return Ok(self.rows.iter().map(|&row| all[row]).collect());
        }
        let mut inside = Vec::new();
        for member in all {
            if self.has_section(member.unit, facts)? {
                inside.push(*member);
            }
        }
        Ok(inside)
    }

    /// Whether rows of a section belong to it, at any position.
    pub fn has_section(&self, unit: &Unit, facts: &Facts) -> Result<bool, Reason> {
        if !self.zones.is_empty()
            && !unit.zone.as_ref().is_some_and(|zone| self.zones.contains(zone))
        {
            return Ok(false);
        }
        let Some((condition, _)) = &self.scope.condition else { return Ok(true) };
        flag(condition, &unit.known(facts)).map_err(|reason| Reason::GroupUnknown {
            section: unit.name.clone(),
            reason: Box::new(reason),
        })
    }

    /// Whether keys of sections distinguish it from other groups.
    pub fn by_section(&self) -> bool {
        self.keys.iter().any(|(key, ..)| !matches!(key, Key::Place(_)))
    }

    /// Which positions of the quantity belong to it.
    pub fn positions(&self, quantity: &Quantity) -> Vec<bool> {
        let of_place =
            |key: &Key| if let Key::Place(place) = key { Some(place.clone()) } else { None };
        let asked: Vec<(String, &String)> =
            self.keys.iter().filter_map(|(key, _, of)| Some((of_place(key)?, of))).collect();
        let at = |places: &[(String, String)], place: &str, of: &str| {
            places.iter().any(|(known, member)| known == place && member == of)
        };
        quantity
            .positions
            .iter()
            .map(|position| asked.iter().all(|(place, of)| at(&position.places, place, of)))
            .collect()
    }

    /// Whether a limit of this scope also applies to the group, and how specific it is.
    pub fn covered_by(&self, scope: &Scope) -> Option<Closeness> {
        let condition = |scope: &Scope| scope.condition.as_ref().map(|(_, words)| words.clone());
        let within = scope.zones.is_empty()
            || !self.zones.is_empty() && self.zones.iter().all(|zone| scope.zones.contains(zone));
        let alike = scope.each.iter().eq(self.keys.iter().map(|(key, ..)| *key))
            && condition(scope) == condition(self.scope);
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
