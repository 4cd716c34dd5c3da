//! Positions of signals: `Y at side R` in expressions, `Y at wheelsets 1, 3 and side outer` in
//! quantities.

use indexmap::IndexMap;

use super::{names::Place, prelude::*};
use crate::syntax::{
    is_each,
    phrase::{Alias, Pick},
};

/// Largest number of positions of one quantity. Each is a column of every record and a signal in
/// memory.
const MOST_POSITIONS: usize = 2000;

impl Place {
    fn alias(&self, name: &str) -> Option<&Alias> {
        self.aliases.iter().find(|alias| alias.name.node == name)
    }
}

impl Checker<'_> {
    /// A signal at a position such as `Y at side R`, or at an alias that depends on the section.
    pub fn placed(
        &mut self,
        name: &At<String>,
        words: &[At<String>],
        span: &Origin,
        scope: &Scope,
    ) -> Option<Expr> {
        let bare = name.with(Node::Path(name.node.clone()));
        // Words alternate: place, member, place, member, ... A place name of several words is
        // joined by `_`.
        let mut assignment = scope.at.clone();
        let mut from = 0;
        while from < words.len() {
            let named = (from + 1..words.len()).find_map(|end| {
                self.place_called(&joined(&words[from..end])).map(|place| (place, end))
            });
            let Some((place, member_at)) = named else {
                if let Some(place) = self.place_called(&joined(&words[from..])) {
                    self.tell(
                        problem!(
                            "open-place",
                            &extent(&words[from..])?,
                            "the {place} is not stated"
                        )
                        .help(self.members_help(&place)),
                    );
                } else {
                    self.unknown_place(&words[from..words.len().max(from + 2) - 1], name);
                }
                return None;
            };
            let member = &words[member_at];
            let known = self.names.places.get(&place)?;
            if !known.members.contains(&member.node) && known.alias(&member.node).is_none() {
                self.unknown_member(member, &place);
                return None;
            }
            assignment.insert(place, member.node.clone());
            from = member_at + 1;
        }
        let found = self.signal_where(&bare, &assignment, span)?;
        Some(Expr { span: span.clone(), ..found })
    }

    /// A signal at positions that may be aliases. The position then depends on the section.
    pub fn signal_where(
        &mut self,
        phrase: &Phrase,
        at: &Assignment,
        span: &Origin,
    ) -> Option<Expr> {
        let mut cases: Vec<(Option<Expr>, Assignment)> = vec![(None, at.clone())];
        for (place, member) in at {
            let Some(alias) =
                self.names.places.get(place).and_then(|known| known.alias(member)).cloned()
            else {
                continue;
            };
            let mut split = Vec::new();
            let mut conditions = Vec::new();
            for (target, condition) in &alias.cases {
                let condition = self.condition(condition, &mut Scope::section())?;
                for (before, assignment) in &cases {
                    let mut assignment = assignment.clone();
                    assignment.insert(place.clone(), target.node.clone());
                    split.push((Some(both(before.as_ref(), &condition)), assignment));
                }
                conditions.push(condition);
            }
            self.alias_covers(&alias.name.node, place, &conditions, span);
            cases = split;
        }
        let mut arms = Vec::new();
        for (condition, assignment) in cases {
            let signal = self.signal(phrase, &assignment)?;
            match condition {
                None => return Some(signal),
                Some(condition) => arms.push((signal, condition)),
            }
        }
        self.select(arms, None, span, None)
    }

    /// In a quantity, sections in which an alias has no position cannot be used. This is a warning
    /// unless a condition excludes them.
    fn alias_covers(&mut self, alias: &str, place: &str, conditions: &[Expr], span: &Span) {
        if !self.in_quantity {
            return;
        }
        if !self.always_one(conditions.iter()) {
            self.tell(
                warning("alias-gap", format!("in some sections `{alias}` stands for no position of `{place}`; they cannot be used"), span)
                .help("exclude them from this quantity with `where ...`"),
            );
        }
    }

    /// Reports words that name no place.
    pub fn unknown_place(&mut self, words: &[At<String>], within: &impl Located) {
        let name = joined(words);
        if self.names.failed.contains(&name)
            || self.names.failed.contains(name.strip_suffix('s').unwrap_or(&name))
        {
            return;
        }
        let names = self.names.places.keys().map(|place| place.replace('_', " "));
        let shown = name.replace('_', " ");
        let at = extent(words).unwrap_or_else(|| within.place());
        self.tell(
            problem!("unknown-place", &at, "`{shown}` is not a place").suggest(&shown, names),
        );
    }

    fn unknown_member(&mut self, member: &At<String>, place: &str) {
        let Some(known) = self.names.places.get(place) else { return };
        let aliases = known.aliases.iter().map(|alias| alias.name.node.as_str());
        let all: Vec<&str> = known.members.iter().map(String::as_str).chain(aliases).collect();
        self.tell(
            problem!(
                "unknown-place",
                member,
                "`{}` is not a position of `{}`",
                member.node,
                place.replace('_', " ")
            )
            .suggest(&member.node, all),
        );
    }

    fn members_help(&self, place: &str) -> String {
        let members =
            self.names.places.get(place).map_or(String::new(), |place| place.members.join(", "));
        format!("one of {members}")
    }

    /// All positions of a selection, in the order of the signal's places.
    pub fn positions(&mut self, signal: &At<String>, picks: &[Pick]) -> Option<Vec<Assignment>> {
        let Some(declared) = self.names.signals.get(&signal.node) else {
            self.unknown_signal(&signal.node, &signal.place());
            return None;
        };
        let places = declared.places.clone();
        let mut chosen: IndexMap<String, Vec<String>> = IndexMap::new();
        let mut ok = true;
        for pick in picks {
            ok &= self.one_pick(pick, signal, &places, &mut chosen).is_some();
        }
        if !ok {
            return None;
        }
        let mut all = vec![Assignment::new()];
        for place in &places {
            let members = match chosen.shift_remove(place) {
                Some(members) => members,
                None => self.names.places.get(place)?.members.clone(),
            };
            if all.len().saturating_mul(members.len()) > MOST_POSITIONS {
                return self.refuse(
                    problem!(
                        "too-large",
                        signal,
                        "`{}` has more than {MOST_POSITIONS} positions here",
                        signal.node
                    )
                    .help("choose positions: `at wheelset 1 and side R`"),
                );
            }
            let with = |before: &Assignment, member: &String| {
                let mut next = before.clone();
                next.insert(place.clone(), member.clone());
                next
            };
            all = all
                .iter()
                .flat_map(|before| members.iter().map(move |member| with(before, member)))
                .collect();
        }
        Some(all)
    }

    /// The positions of the place that a parameter of this name selects.
    fn selected(&mut self, name: &str, place: &str, at: &Span) -> Option<Vec<String>> {
        let (of, positions) = self.parameter(name, at)?.selects?;
        (of == place).then_some(positions)
    }

    fn one_pick(
        &mut self,
        pick: &Pick,
        signal: &At<String>,
        places: &[String],
        chosen: &mut IndexMap<String, Vec<String>>,
    ) -> Option<()> {
        let mut words = pick.words.clone();
        words.retain(|word| !is_each(&word.node));
        let named = (1..=words.len())
            .rev()
            .find_map(|end| self.place_called(&joined(&words[..end])).map(|place| (place, end)));
        let Some((place, end)) = named else {
            // The last word is a member, unless it is the only word.
            let of_place = if words.is_empty() {
                &pick.words[..]
            } else {
                &words[..(words.len().max(2) - 1).min(words.len())]
            };
            self.unknown_place(of_place, signal);
            return None;
        };
        if !places.contains(&place) {
            let problem = problem!(
                "unknown-place",
                &extent(&words[..end])?,
                "`{}` has no place `{}`",
                signal.node,
                place.replace('_', " ")
            );
            let help = if places.is_empty() {
                "it has no places".to_string()
            } else {
                format!("its places: {}", places.join(", ").replace('_', " "))
            };
            return self.refuse(problem.help(help));
        }
        let known = self.names.places.get(&place)?.clone();
        let members: Vec<&At<String>> = words[end..].iter().chain(&pick.more).collect();
        let found = chosen.entry(place.clone()).or_default();
        if members.is_empty() {
            // `at wheelsets` and `at each wheelset` select all members.
            found.clone_from(&known.members);
        }
        let mut ok = true;
        for member in members {
            if let Some(selected) = self.selected(&member.node, &place, &member.place()) {
                selected.into_iter().for_each(|member| {
                    if !found.contains(&member) {
                        found.push(member)
                    }
                });
            } else if !known.members.contains(&member.node) && known.alias(&member.node).is_none() {
                self.unknown_member(member, &place);
                ok = false;
            } else if !found.contains(&member.node) {
                found.push(member.node.clone());
            }
        }
        ok.then_some(())
    }
}

pub fn joined(words: &[At<String>]) -> String {
    words.iter().map(|word| word.node.as_str()).collect::<Vec<_>>().join("_")
}

/// From the first word to the last.
fn extent(words: &[At<String>]) -> Option<Span> {
    Some(words.first()?.to(words.last()?, ()).place())
}

fn both(before: Option<&Expr>, condition: &Expr) -> Expr {
    match before {
        None => condition.clone(),
        Some(before) => {
            Expr::flag(Operator::And, before.clone(), condition.clone(), &condition.span)
        }
    }
}
