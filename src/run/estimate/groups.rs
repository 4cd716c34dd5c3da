//! Groups of rows that a limit applies to.

use std::collections::HashMap;

use indexmap::IndexSet;

use super::table::{Member, Table};
use crate::check::evaluate::flag;
use crate::check::plan::{Key, Limit, Plan, Position, Quantity, Scalar, Scope};
use crate::result::{self, Reason};
use crate::run::sections::{Facts, Unit};

/// Rows that are looked at together, with the rules and vehicles that they are looked at by.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a> {
    pub plan: &'a Plan,
    pub facts: &'a Facts,
    /// What the rows are of; `None` of sections by themselves, each of which is one row.
    pub quantity: Option<&'a Quantity>,
    pub members: &'a [Member<'a>],
    pub table: &'a Table<'a>,
}

/// The group of rows of an estimate.
#[derive(Clone, Debug)]
pub struct RowGroup<'a> {
    scope: &'a Scope,
    /// The zones of the scope, or the zone of one section.
    zones: Vec<String>,
    /// Each key with its printed name and the member of the group.
    keys: Vec<(&'a Key, String, String)>,
    /// Its rows; an error where it cannot be determined which ones belong to it.
    pub members: Result<Vec<Member<'a>>, Reason>,
}

impl<'a> Group<'a> {
    /// The same with other rows.
    pub fn with<'g>(&self, members: &'g [Member<'g>]) -> Group<'g>
    where
        'a: 'g,
    {
        Group { members, ..*self }
    }

    /// The positions of the rows.
    pub fn positions(&self) -> &'a [Position] {
        self.quantity.map_or(&[], |quantity| &quantity.positions)
    }

    /// The groups of a limit, a minimum or a report.
    ///
    /// Left out are: zones that need no section and have none; zones that the condition of the
    /// quantity excludes or that have no repeats, unless all are excluded; groups in which a
    /// condition leaves no row, unless it leaves none in any group. A group of a place exists
    /// wherever the place was recorded.
    pub fn parts<'s>(&self, scope: &'s Scope) -> Vec<RowGroup<'s>>
    where
        'a: 's,
    {
        let members = self.members;
        // A zone without rows has none because of the rules of the quantity.
        let selective = !members.is_empty()
            && self
                .quantity
                .is_none_or(|quantity| quantity.only.is_some() || quantity.evaluation.of_repeats());
        let needed = |name: &str| {
            let mut zones = self.plan.zones.iter();
            !selective && zones.any(|zone| zone.name == name && zone.minimum_sections > 0)
        };
        let filled =
            |zone: &str| members.iter().any(|member| member.unit.zone.as_deref() == Some(zone));
        if !scope.zones.is_empty() && !scope.zones.iter().any(|zone| needed(zone) || filled(zone)) {
            return Vec::new();
        }
        let empty = RowGroup {
            scope,
            zones: scope.zones.clone(),
            keys: Vec::new(),
            members: Ok(Vec::new()),
        };
        let mut inside: Vec<Member<'s>> = Vec::new();
        for member in members {
            match empty.has_section(member.unit, self.facts) {
                Ok(true) => inside.push(*member),
                Ok(false) => {}
                // Where it cannot be determined which rows belong to it, the limit is not
                // assessable, and the reason is given.
                Err(reason) => return vec![RowGroup { members: Err(reason), ..empty }],
            }
        }
        if let Some(reason) = absent_key(&scope.each, &inside) {
            return vec![RowGroup { members: Err(reason), ..empty }];
        }
        let everywhere = RowGroup { zones: Vec::new(), ..empty.clone() };
        let meets =
            |member: &Member<'_>| everywhere.has_section(member.unit, self.facts) == Ok(true);
        let met = scope.condition.is_none() || members.iter().any(meets);
        if met && !scope.each.is_empty() {
            let groups = self.by_keys(&empty, &inside);
            // Missing groups are reported for the group of all rows.
            if !groups.is_empty() || scope.condition.is_some() {
                return groups;
            }
        } else if met && scope.condition.is_some() && !scope.zones.is_empty() && inside.is_empty() {
            return Vec::new();
        }
        vec![RowGroup { members: Ok(inside), ..empty }]
    }

    /// The rows of a group by its keys. For places, every recorded position has a group; for
    /// sections, the groups that occur.
    fn by_keys<'s>(&self, empty: &RowGroup<'s>, inside: &[Member<'s>]) -> Vec<RowGroup<'s>> {
        let keys = &empty.scope.each;
        let is_place = |key: &Key| matches!(key, Key::Place(_));
        let mut rows_of: HashMap<Vec<String>, Vec<Member<'s>>> = HashMap::new();
        // Combinations of the section keys, in order of occurrence.
        let mut of_sections: IndexSet<Vec<Option<(String, String)>>> = IndexSet::new();
        for member in inside {
            let found: Vec<(String, String)> =
                keys.iter().map(|key| self.of_key(key, member)).collect();
            let names = found.iter().map(|(_, name)| name.clone()).collect();
            rows_of.entry(names).or_default().push(*member);
            let by_section = keys.iter().zip(found);
            of_sections
                .insert(by_section.map(|(key, found)| (!is_place(key)).then_some(found)).collect());
        }
        if inside.is_empty() && empty.scope.condition.is_none() && keys.iter().all(is_place) {
            of_sections.insert(vec![None; keys.len()]);
        }
        let mut groups = Vec::new();
        for section in &of_sections {
            let mut all = vec![empty.clone()];
            for (key, of_section) in keys.iter().zip(section) {
                let choices: IndexSet<(String, String)> = match of_section {
                    Some(found) => IndexSet::from([found.clone()]),
                    None => self.members.iter().map(|member| self.of_key(key, member)).collect(),
                };
                let with = |group: &RowGroup<'s>, (name, member): &(String, String)| {
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
            group.members = Ok(rows_of.remove(&names).unwrap_or_default());
        }
        groups
    }

    /// The printed name of a key, and its member that a row belongs to.
    pub fn of_key(&self, key: &Key, member: &Member<'_>) -> (String, String) {
        let named = |key: &str, member: String| (key.to_owned(), member);
        match key {
            Key::Section => named("section", member.unit.name.clone()),
            Key::Site => named("site", member.unit.site_name.clone()),
            Key::Record => {
                named("record", member.row.record.as_ref().map_or("1".into(), ToString::to_string))
            }
            Key::Place(place) => {
                let position = self.positions().get(member.row.position);
                let of = position.and_then(|position| position.places.get(place));
                named(&place.replace('_', " "), of.cloned().unwrap_or_default())
            }
            Key::Column(index) => {
                let datum = &self.plan.columns[*index];
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
}

/// Why rows form no groups: an optional column that keys name is absent.
fn absent_key(keys: &[Key], inside: &[Member<'_>]) -> Option<Reason> {
    let columns = || {
        keys.iter().filter_map(|key| match key {
            Key::Column(index) => Some(*index),
            _ => None,
        })
    };
    let of = |member: &Member<'_>| {
        let mut reasons =
            columns().filter_map(|index| member.unit.columns[index].as_ref().err().cloned());
        reasons.find(Reason::is_of_optional)
    };
    inside.iter().find_map(of)
}

impl<'a> RowGroup<'a> {
    /// The group for a limit of a single value: the zone of its section.
    pub fn of_section(plan: &Plan, limit: &'a Limit, unit: &Unit) -> Self {
        let zones = unit.zone.iter().filter(|_| !plan.zones.is_empty()).cloned().collect();
        Self { scope: &limit.scope, zones, keys: Vec::new(), members: Ok(Vec::new()) }
    }

    /// The group as it stands in results.
    pub fn scope(&self) -> result::Scope {
        result::Scope {
            zones: self.zones.clone(),
            keys: self.keys.iter().map(|(_, name, of)| (name.clone(), of.clone())).collect(),
            condition: self.scope.condition.as_ref().map(|(_, words)| words.clone()),
        }
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
        quantity
            .positions
            .iter()
            .map(|position| asked.iter().all(|(place, of)| position.places.get(place) == Some(*of)))
            .collect()
    }

    /// The rows of another quantity that a limit with this scope takes together where this group
    /// is: all of them, or those with the same zones and keys.
    pub fn rows_of<'m>(&self, other: &Group<'m>, scope: &Scope) -> Result<Vec<Member<'m>>, Reason> {
        let mut rows = Vec::new();
        for member in other.members {
            let alike = |(key, _, of): &(&Key, String, String)| other.of_key(key, member).1 == *of;
            if scope.is_all()
                || self.has_section(member.unit, other.facts)? && self.keys.iter().all(alike)
            {
                rows.push(*member);
            }
        }
        Ok(rows)
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
