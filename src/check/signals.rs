//! Types expressions over signals: channels at positions, sample by sample arithmetic, filters inside expressions.

use super::Checker;
use super::names::{Assignment, Channel, SignalDef};
use super::plan::{Kind, Operator, Scalar, Signal, SignalKind};
use super::scalars::{Scope, function};
use crate::problem::{Problem, nearest};
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase, Pick};
use crate::units::Dimension;

/// Signals may be made of signals, but not for ever.
const DEEPEST_SIGNAL: usize = 24;

impl Checker<'_> {
    /// The signal an expression stands for at the given positions.
    pub(super) fn signal(&mut self, phrase: &Phrase, text: &Text, at: &Assignment) -> Option<Signal> {
        if self.signal_depth >= DEEPEST_SIGNAL {
            self.problems.push(Problem::error("signal-loop", "this signal is made of itself").at(&text.place(phrase.range.clone())));
            return None;
        }
        self.signal_depth += 1;
        let found = self.signal_inner(phrase, text, at);
        self.signal_depth -= 1;
        found
    }

    fn signal_inner(&mut self, phrase: &Phrase, text: &Text, at: &Assignment) -> Option<Signal> {
        let span = text.place(phrase.range.clone());
        match &phrase.node {
            Node::Path(name) => self.signal_named(name, &span, phrase, text, at),
            Node::PlaceOf(name, words) => self.placed(name, words, text, &span, at),
            Node::Negative(inner) => {
                let inner = self.signal(inner, text, at)?;
                Some(Signal { dimension: inner.dimension, track: inner.track, kind: SignalKind::Negative(Box::new(inner)), span })
            }
            Node::Magnitude(inner) => {
                let inner = self.signal(inner, text, at)?;
                Some(Signal {
                    dimension: inner.dimension,
                    track: inner.track,
                    kind: SignalKind::Call(function("magnitude")?, vec![inner]),
                    span,
                })
            }
            Node::Power(inner, exponent) => {
                let inner = self.signal(inner, text, at)?;
                let dimension = inner.dimension.power(*exponent)?;
                Some(Signal { dimension, track: inner.track, kind: SignalKind::Power(Box::new(inner), *exponent), span })
            }
            Node::Binary(operator @ (Operator::Add | Operator::Subtract | Operator::Multiply | Operator::Divide), left, right) => {
                let (left, right) = (self.signal(left, text, at), self.signal(right, text, at));
                let (left, right) = (left?, right?);
                let dimension = match operator {
                    Operator::Multiply => left.dimension * right.dimension,
                    Operator::Divide => left.dimension / right.dimension,
                    _ if left.dimension == right.dimension => left.dimension,
                    _ => {
                        self.problems.push(
                            Problem::error(
                                "unit-mismatch",
                                format!("{} and {} cannot be added", left.dimension.in_words(), right.dimension.in_words()),
                            )
                            .at(&right.span)
                            .label(right.dimension.in_words())
                            .also(&left.span, left.dimension.in_words()),
                        );
                        return None;
                    }
                };
                let track = self.one_record(&[&left, &right])?;
                Some(Signal { dimension, track, kind: SignalKind::Binary(*operator, Box::new(left), Box::new(right)), span })
            }
            Node::Call(name, arguments) => {
                let function = self.function(name, arguments.len(), text)?;
                let arguments: Vec<Option<Signal>> = arguments.iter().map(|argument| self.signal(argument, text, at)).collect();
                let arguments = arguments.into_iter().collect::<Option<Vec<_>>>()?;
                let dimensions: Vec<Dimension> = arguments.iter().map(|argument| argument.dimension).collect();
                let spans: Vec<Span> = arguments.iter().map(|argument| argument.span.clone()).collect();
                let dimension = self.function_type(function, &dimensions, &spans)?;
                let track = self.one_record(&arguments.iter().collect::<Vec<_>>())?;
                Some(Signal { dimension, track, kind: SignalKind::Call(function, arguments), span })
            }
            Node::Through(inner, filter) => {
                let inner = self.signal(inner, text, at)?;
                let steps = self.filter_named(&filter.node, &text.place(filter.range.clone()))?;
                if let Some(window) = steps.iter().find(|step| !step.kind.keeps_samples()) {
                    self.problems.push(
                        Problem::error(
                            "window-in-signal",
                            "a filter inside a signal must keep its samples, this one has a window or resamples",
                        )
                        .at(&text.place(filter.range.clone()))
                        .also(&window.span, "this step"),
                    );
                    return None;
                }
                Some(Signal { dimension: inner.dimension, track: inner.track, kind: SignalKind::Filtered(Box::new(inner), steps), span })
            }
            Node::Cases(arms, otherwise) => self.signal_cases(arms, otherwise.as_deref(), text, &span, at),
            _ => self.scalar_signal(phrase, text, span),
        }
    }

    /// A number that stays the same along the record.
    fn scalar_signal(&mut self, phrase: &Phrase, text: &Text, span: Span) -> Option<Signal> {
        let expr = self.expr(phrase, text, &mut Scope::section())?;
        let dimension = self.number_type(&expr)?;
        Some(Signal { dimension, track: false, kind: SignalKind::Scalar(expr), span })
    }

    fn signal_cases(
        &mut self,
        arms: &[(Phrase, Option<Phrase>)],
        otherwise: Option<&Phrase>,
        text: &Text,
        span: &Span,
        at: &Assignment,
    ) -> Option<Signal> {
        let mut select = Vec::new();
        for (value, condition) in arms {
            let condition = match condition {
                None => None,
                Some(condition) => {
                    let condition = self.expr(condition, text, &mut Scope::section())?;
                    self.flag_type(&condition)?;
                    Some(condition)
                }
            };
            match condition.as_ref().map(|condition| &condition.kind) {
                Some(Kind::Constant(Scalar::Flag(false))) => {}
                None | Some(Kind::Constant(Scalar::Flag(true))) => {
                    let last = self.signal(value, text, at)?;
                    return if select.is_empty() { Some(last) } else { self.select(select, Some(last), span) };
                }
                _ => {
                    let value = self.signal(value, text, at)?;
                    select.push((condition?, value));
                }
            }
        }
        let otherwise = match otherwise {
            Some(value) => Some(self.signal(value, text, at)?),
            None => None,
        };
        self.select(select, otherwise, span)
    }

    fn select(&mut self, arms: Vec<(super::plan::Expr, Signal)>, otherwise: Option<Signal>, span: &Span) -> Option<Signal> {
        if arms.is_empty() {
            if otherwise.is_none() {
                self.problems.push(Problem::error("no-case", "no case of this can apply with the parameters as set").at(span));
            }
            return otherwise;
        }
        let all: Vec<&Signal> = arms.iter().map(|(_, signal)| signal).chain(otherwise.as_ref()).collect();
        let first = all[0];
        for other in &all[1..] {
            if other.dimension != first.dimension {
                self.problems.push(
                    Problem::error(
                        "unit-mismatch",
                        format!("one case is {}, another {}", first.dimension.in_words(), other.dimension.in_words()),
                    )
                    .at(&other.span)
                    .also(&first.span, first.dimension.in_words()),
                );
                return None;
            }
        }
        let dimension = first.dimension;
        let track = self.one_record(&all)?;
        Some(Signal { dimension, track, kind: SignalKind::Select(arms, otherwise.map(Box::new)), span: span.clone() })
    }

    /// Whether all come from the track record; track and vehicle records have different samples and cannot be mixed.
    fn one_record(&mut self, signals: &[&Signal]) -> Option<bool> {
        let of_records: Vec<&&Signal> = signals.iter().filter(|signal| !matches!(signal.kind, SignalKind::Scalar(_))).collect();
        let track = of_records.first().is_some_and(|signal| signal.track);
        if let Some(other) = of_records.iter().find(|signal| signal.track != track) {
            self.problems.push(
                Problem::error(
                    "mixed-records",
                    "a channel of the track record cannot be combined with one of simulation and measurement, sample by sample",
                )
                .at(&other.span)
                .also(&of_records[0].span, "the other record"),
            );
            return None;
        }
        Some(track)
    }

    fn signal_named(&mut self, name: &str, span: &Span, phrase: &Phrase, text: &Text, at: &Assignment) -> Option<Signal> {
        if let Some(channel) = self.names.channels.get(name).cloned() {
            return self.channel_at(name, &channel, span, at);
        }
        if let Some(signal) = self.names.signals.get(name).cloned() {
            return self.signal_at(name, &signal, span, at);
        }
        if let Some(define) = self.names.defines.get(name).cloned() {
            return self.signal(&define.phrase, &define.text, at);
        }
        let known = self.names.parameters.contains_key(name)
            || self.names.columns.iter().any(|datum| datum.name == name)
            || name.contains('.')
            || self.names.vehicle.iter().any(|datum| datum.name == name)
            || crate::units::Unit::parse(name).is_ok();
        if known {
            return self.scalar_signal(phrase, text, span.clone());
        }
        self.unknown_signal(name, span);
        None
    }

    pub(super) fn unknown_signal(&mut self, name: &str, span: &Span) {
        if self.is_block(name) {
            return;
        }
        let known: Vec<String> = self.names.channels.keys().chain(self.names.signals.keys()).cloned().collect();
        self.problems.push(
            Problem::error("unknown-signal", format!("no channel or signal is called `{name}`"))
                .at(span)
                .suggest(name, known.iter().map(String::as_str)),
        );
    }

    fn channel_at(&mut self, name: &str, channel: &Channel, span: &Span, at: &Assignment) -> Option<Signal> {
        let column = self.fill(name, &channel.column, &channel.places, &channel.span, span, at)?;
        Some(Signal {
            kind: SignalKind::Column { column, channel: name.to_string() },
            dimension: channel.unit.dimension,
            track: channel.track,
            span: span.clone(),
        })
    }

    fn signal_at(&mut self, name: &str, signal: &SignalDef, span: &Span, at: &Assignment) -> Option<Signal> {
        self.fill(name, &signal.named, &signal.places, &signal.span, span, at)?;
        let own: Assignment =
            signal.places.iter().filter_map(|place| at.get(place).map(|member| (place.clone(), member.clone()))).collect();
        let found = self.signal(&signal.is.phrase, &signal.is.text, &own)?;
        if let Some(unit) = &signal.unit {
            if unit.dimension != found.dimension {
                self.problems.push(
                    Problem::error(
                        "unit-mismatch",
                        format!("signal `{name}` is said to be in {unit}, but is {}", found.dimension.in_words()),
                    )
                    .at(&signal.span)
                    .also(&found.span, found.dimension.in_words()),
                );
                return None;
            }
        }
        Some(found)
    }

    /// The name with its places put in; a problem if one is open.
    pub(super) fn fill(
        &mut self,
        name: &str,
        pattern: &str,
        places: &[String],
        defined: &Span,
        used: &Span,
        at: &Assignment,
    ) -> Option<String> {
        let mut filled = pattern.to_string();
        for place in places {
            let Some(member) = at.get(place) else {
                self.problems.push(
                    Problem::error("open-place", format!("`{name}` is measured at each {place}, and which one is not said"))
                        .at(used)
                        .also(defined, format!("at each {place}"))
                        .help(format!("write `{name} at {place} ...`")),
                );
                return None;
            };
            filled = filled.replace(&format!("{{{place}}}"), member);
        }
        Some(filled)
    }

    /// `Y at side R`, or at an alias that the section decides.
    fn placed(&mut self, name: &At<String>, words: &[At<String>], text: &Text, span: &Span, at: &Assignment) -> Option<Signal> {
        let bare = At { node: Node::Path(name.node.clone()), range: name.range.clone() };
        // Words come as place, member, place, member, ...; place names of several words are joined by `_`.
        let mut assignments: Vec<(Option<super::plan::Expr>, Assignment)> = vec![(None, at.clone())];
        let mut from = 0;
        while from < words.len() {
            let Some((place, member_at)) = (from + 1..words.len()).find_map(|end| {
                self.place_called(&words[from..end].iter().map(|word| word.node.as_str()).collect::<Vec<_>>().join("_"))
                    .map(|place| (place, end))
            }) else {
                self.unknown_place(&words[from], text);
                return None;
            };
            let member = &words[member_at];
            let definition = self.names.places.get(&place)?.clone();
            if definition.members.contains(&member.node) {
                for (_, assignment) in &mut assignments {
                    assignment.insert(place.clone(), member.node.clone());
                }
            } else if let Some((alias, alias_text)) = definition.aliases.iter().find(|(alias, _)| alias.name.node == member.node) {
                let mut split = Vec::new();
                for (target, condition) in &alias.cases {
                    let condition = self.expr(condition, alias_text, &mut Scope::section())?;
                    self.flag_type(&condition)?;
                    for (before, assignment) in &assignments {
                        let mut assignment = assignment.clone();
                        assignment.insert(place.clone(), target.node.clone());
                        let both = match before {
                            None => condition.clone(),
                            Some(before) => super::plan::Expr {
                                kind: Kind::Binary(Operator::And, Box::new(before.clone()), Box::new(condition.clone())),
                                ty: super::plan::Type::Flag,
                                span: condition.span.clone(),
                            },
                        };
                        split.push((Some(both), assignment));
                    }
                }
                assignments = split;
            } else {
                self.unknown_member(member, &place, text);
                return None;
            }
            from = member_at + 1;
        }
        let mut arms = Vec::new();
        for (condition, assignment) in assignments {
            let signal = self.signal(&bare, text, &assignment)?;
            match condition {
                None => return Some(signal),
                Some(condition) => arms.push((condition, signal)),
            }
        }
        self.select(arms, None, span)
    }

    fn unknown_place(&mut self, word: &At<String>, text: &Text) {
        let names: Vec<String> = self.names.places.keys().cloned().collect();
        self.problems.push(
            Problem::error("unknown-place", format!("`{}` is no place", word.node))
                .at(&text.place(word.range.clone()))
                .suggest(&word.node, names.iter().map(String::as_str)),
        );
    }

    fn unknown_member(&mut self, member: &At<String>, place: &str, text: &Text) {
        let Some(definition) = self.names.places.get(place) else { return };
        let mut known: Vec<String> = definition.members.clone();
        known.extend(definition.aliases.iter().map(|(alias, _)| alias.name.node.clone()));
        self.problems.push(
            Problem::error("unknown-place", format!("`{}` is no {place}", member.node))
                .at(&text.place(member.range.clone()))
                .suggest(&member.node, known.iter().map(String::as_str)),
        );
    }

    /// All positions of a selection, in the order of the places of the signal, each with its assignment.
    pub(super) fn positions(&mut self, signal: &At<String>, picks: &[Pick], text: &Text) -> Option<Vec<Assignment>> {
        let places = match (self.names.channels.get(&signal.node), self.names.signals.get(&signal.node)) {
            (Some(channel), _) => channel.places.clone(),
            (_, Some(signal)) => signal.places.clone(),
            _ => {
                self.unknown_signal(&signal.node, &text.place(signal.range.clone()));
                return None;
            }
        };
        let mut chosen: Assignments = Assignments::new();
        for pick in picks {
            self.one_pick(pick, signal, &places, text, &mut chosen)?;
        }
        let mut all = vec![Assignment::new()];
        for place in &places {
            let members = match chosen.shift_remove(place) {
                Some(members) => members,
                None => self.names.places.get(place)?.members.clone(),
            };
            all = all
                .iter()
                .flat_map(|before| {
                    members.iter().map(move |member| {
                        let mut next = before.clone();
                        next.insert(place.clone(), member.clone());
                        next
                    })
                })
                .collect();
        }
        Some(all)
    }

    fn one_pick(&mut self, pick: &Pick, signal: &At<String>, places: &[String], text: &Text, chosen: &mut Assignments) -> Option<()> {
        let words: Vec<&At<String>> = pick.words.iter().filter(|word| !matches!(word.node.as_str(), "each" | "every" | "all")).collect();
        let every = words.len() < pick.words.len();
        let joined = |words: &[&At<String>]| words.iter().map(|word| word.node.as_str()).collect::<Vec<_>>().join("_");
        let split = (1..=words.len()).rev().find_map(|end| self.place_called(&joined(&words[..end])).map(|place| (place, end)));
        let Some((place, end)) = split else {
            if let Some(word) = words.first() {
                self.unknown_place(word, text);
            }
            return None;
        };
        let place_span = text.place(words[0].range.start..words[end - 1].range.end);
        if !places.contains(&place) {
            let problem = Problem::error("unknown-place", format!("`{}` is not measured at a {place}", signal.node)).at(&place_span);
            self.problems.push(problem.suggest(&place, places.iter().map(String::as_str)));
            return None;
        }
        let mut members: Vec<&At<String>> = words[end..].to_vec();
        members.extend(&pick.more);
        let definition = self.names.places.get(&place)?.clone();
        if members.is_empty() {
            if !every && !pick.words.is_empty() {
                // `at wheelsets` without numbers means all of them.
                chosen.insert(place, definition.members.clone());
            }
            return Some(());
        }
        let mut found = Vec::new();
        for member in members {
            if definition.members.contains(&member.node) {
                found.push(member.node.clone());
            } else {
                let near = nearest(&member.node, definition.members.iter().map(String::as_str)).map(str::to_string);
                let problem =
                    Problem::error("unknown-place", format!("`{}` is no {place}", member.node)).at(&text.place(member.range.clone()));
                self.problems.push(match near {
                    Some(near) => problem.help(format!("did you mean `{near}`?")),
                    None => problem.help(format!("known here: {}", definition.members.join(", "))),
                });
                return None;
            }
        }
        chosen.insert(place, found);
        Some(())
    }
}

type Assignments = indexmap::IndexMap<String, Vec<String>>;
