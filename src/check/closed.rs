//! Checks the parts of a protocol that no quantity uses, so that a mistake in them is reported now
//! and not at their first use.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Checker;
use super::functions::is_signal_function;
use super::names::Assignment;
use super::scope::{Group, Scope};
use crate::catalog::{MetricEntry, Reducer, Statistic};
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase};
use crate::units::Dimension;

impl Checker<'_> {
    /// Checks aliases, signals, estimates and definitions that nothing uses.
    pub fn unused_parts(&mut self) {
        let aliases = self.names.places.values().flat_map(|place| &place.aliases);
        let conditions: Vec<Phrase> = aliases
            .flat_map(|alias| alias.cases.iter().map(|(_, condition)| condition.clone()))
            .collect();
        for condition in conditions {
            self.condition(&condition, &mut Scope::section());
        }
        let signals: Vec<_> = self
            .names
            .signals
            .iter()
            .map(|(name, signal)| (name.clone(), signal.clone()))
            .collect();
        for (name, signal) in signals {
            let at = self.first_position(&signal.places);
            let text = Text { text: String::new(), span: signal.span.clone(), exact: false };
            let text = Arc::new(text);
            self.signal(&At { node: Node::Path(name), text, range: 0..0 }, &at);
        }
        let estimates: Vec<_> = self
            .names
            .estimates
            .iter()
            .map(|(name, written)| (name.clone(), written.clone()))
            .collect();
        for (name, written) in estimates {
            if self.used_defines.contains(&format!("estimate {name}")) {
                continue;
            }
            // The dimension of the values of an unused estimate is not known. Mismatches of units
            // are therefore not reported.
            let before = self.problems.0.len();
            let mut scope = Scope {
                group: Some(Group { values: Some(Dimension::ONE), taken: Vec::new() }),
                ..Scope::vehicle()
            };
            self.inside("estimate", &name, &written.text.span, |checker| {
                checker.expr(&written, &mut scope)
            });
            let told = self.problems.0.split_off(before);
            self.problems
                .0
                .extend(told.into_iter().filter(|problem| problem.code != "unit-mismatch"));
        }
        let defines: Vec<_> = self
            .names
            .defines
            .iter()
            .map(|(name, define)| (name.clone(), define.clone()))
            .collect();
        for (name, define) in defines {
            if self.used_defines.contains(&name) {
                continue;
            }
            match self.stands_for(&define, &mut BTreeSet::new()) {
                Meaning::Closed => {
                    drop(self.inside("define", &name, &define.text.span, |checker| {
                        checker.expr(&define, &mut Scope::section())
                    }))
                }
                Meaning::Signal => {
                    let places: Vec<String> = self.names.places.keys().cloned().collect();
                    let at = self.first_position(&places);
                    drop(self.inside("define", &name, &define.text.span, |checker| {
                        checker.signal(&define, &at)
                    }));
                }
                Meaning::Open => {}
            }
        }
    }

    fn first_position(&self, places: &[String]) -> Assignment {
        let first = |place: &String| {
            Some((place.clone(), self.names.places.get(place)?.members.first()?.clone()))
        };
        places.iter().filter_map(first).collect()
    }

    /// How a definition can be checked without the place where it is used.
    fn stands_for(&self, phrase: &Phrase, seen: &mut BTreeSet<String>) -> Meaning {
        let mut of = |phrase: &Phrase| self.stands_for(phrase, seen);
        match &phrase.node {
            Node::Number(_) | Node::Quoted(_) => Meaning::Closed,
            // Values of a signal, of one side or of other limits have no meaning before they are
            // used.
            Node::Percentile(_)
            | Node::Reduced(..)
            | Node::Over(..)
            | Node::Bound { .. }
            | Node::Share { .. }
            | Node::Fit(_)
            | Node::Weighted(..)
            | Node::ForEach(..) => Meaning::Open,
            Node::Path(path)
                if Reducer::named(path).is_some()
                    || MetricEntry::called(path).is_some()
                    || Statistic::named(path).is_some()
                    || self.names.estimates.contains_key(path)
                    || matches!(path.as_str(), "simulated" | "measured") =>
            {
                Meaning::Open
            }
            Node::Path(path)
                if self.names.channels.contains_key(path)
                    || self.names.signals.contains_key(path) =>
            {
                Meaning::Signal
            }
            Node::Path(path) => match self.names.defines.get(path) {
                Some(define) if seen.insert(path.clone()) => self.stands_for(&define, seen),
                _ => Meaning::Closed,
            },
            Node::PlaceOf(..) | Node::Through(..) => Meaning::Signal,
            Node::Binary(_, left, right) => of(left).with(of(right)),
            Node::Near { value, target, tolerance, .. } => {
                of(value).with(of(target)).with(of(tolerance))
            }
            Node::Negative(inner)
            | Node::Not(inner)
            | Node::Magnitude(inner)
            | Node::Power(inner, _) => of(inner),
            Node::Call(name, _) if matches!(name.node.as_str(), "simulated" | "measured") => {
                Meaning::Open
            }
            Node::Call(name, _) if MetricEntry::called(&name.node).is_some() => Meaning::Open,
            Node::Call(name, arguments) if is_signal_function(&name.node) => {
                Meaning::Signal.with(arguments.first().map_or(Meaning::Closed, of))
            }
            Node::Call(_, arguments) => {
                arguments.iter().map(&mut of).fold(Meaning::Closed, Meaning::with)
            }
            Node::Cases(arms, otherwise) => {
                let mut all = Meaning::Closed;
                for (value, condition) in arms {
                    all = all.with(of(value));
                    if of(condition) == Meaning::Open {
                        all = Meaning::Open;
                    }
                }
                otherwise.as_deref().map_or(all, |value| all.with(of(value)))
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meaning {
    Closed,
    Signal,
    Open,
}

impl Meaning {
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Open, _) | (_, Self::Open) => Self::Open,
            (Self::Signal, _) | (_, Self::Signal) => Self::Signal,
            _ => Self::Closed,
        }
    }
}
