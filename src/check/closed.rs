//! Checks the parts of a protocol that no quantity uses, so that a mistake in them is reported now
//! and not at their first use.

use std::collections::BTreeSet;

use super::{functions::is_signal_function, prelude::*};
use crate::catalog::{MetricEntry, Reducer, Statistic};

impl Checker<'_> {
    /// Checks aliases, signals, estimates and definitions that nothing uses.
    pub fn unused_parts(&mut self) {
        let names = self.names.clone();
        for alias in names.places.values().flat_map(|place| &place.aliases) {
            for (_, condition) in &alias.cases {
                self.condition(condition, &mut Scope::section());
            }
        }
        for (name, signal) in names.signals.iter().filter(|(_, signal)| signal.is.is_some()) {
            let at = self.first_position(&signal.places);
            let span = Origin { span: signal.span.of_which(0..0), words: "".into() };
            self.samples_named(name, &span, &mut Scope::samples(&at, None));
        }
        for (name, written) in &names.estimates {
            if self.used_defines.contains(&format!("estimate {name}")) {
                continue;
            }
            // The dimension of the values of an unused estimate is not known. Mismatches of units
            // are therefore not reported.
            let before = self.problems.0.len();
            let mut scope = Scope::vehicle().of_group(Some(Dimension::ONE));
            self.inside("estimate", name, &written.text.span, |checker| {
                checker.expr(written, &mut scope)
            });
            let told = self.problems.0.split_off(before);
            self.problems
                .0
                .extend(told.into_iter().filter(|problem| problem.code != "unit-mismatch"));
        }
        let places: Vec<String> = names.places.keys().cloned().collect();
        for (name, define) in &names.defines {
            let meaning = self.stands_for(define, &mut BTreeSet::new());
            let checked = self.used_defines.contains(name) || names.arguments.contains_key(name);
            if checked || meaning == Meaning::Open {
                continue;
            }
            let at = self.first_position(&places);
            self.inside("define", name, &define.text.span, |checker| match meaning {
                Meaning::Signal => checker.signal(define, &at),
                _ => checker.expr(define, &mut Scope::section()),
            });
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
        let of = |phrase: &Phrase| self.stands_for(phrase, seen);
        match &phrase.node {
            Node::Number(_) | Node::Quoted(_) => Meaning::Closed,
            // Values of a signal, of one side or of other limits have no meaning before they are
            // used.
            Node::Percentile(_)
            | Node::PercentileBy(_)
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
            Node::Path(path) if self.is_signal(path) || self.is_frequency(path) => Meaning::Signal,
            Node::Path(path) => match self.names.defines.get(path) {
                Some(define) if seen.insert(path.clone()) => self.stands_for(define, seen),
                _ => Meaning::Closed,
            },
            Node::PlaceOf(..) | Node::Through(..) => Meaning::Signal,
            Node::Call(name, _) if matches!(name.node.as_str(), "simulated" | "measured") => {
                Meaning::Open
            }
            Node::Call(name, _)
                if MetricEntry::called(&name.node).is_some()
                    || self.names.arguments.contains_key(&name.node) =>
            {
                Meaning::Open
            }
            Node::Call(name, arguments) if is_signal_function(&name.node) => {
                Meaning::Signal.with(arguments.first().map_or(Meaning::Closed, of))
            }
            _ => phrase.parts().into_iter().map(of).fold(Meaning::Closed, Meaning::with),
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
