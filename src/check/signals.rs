//! Determines types of expressions over signals: channels at positions, arithmetic sample by
//! sample, filters inside expressions.

use super::Checker;
use super::functions::{function, is_signal_function};
use super::names::{Assignment, Channel, SignalDef};
use super::plan::{AxisOperation, Expr, Kind, Operator, Scalar, Side, Signal, SignalKind};
use super::scope::Scope;
use super::steps::after;
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase};
use crate::units::Dimension;

impl Checker<'_> {
    /// The signal that an expression stands for at the given positions.
    pub(super) fn signal(
        &mut self,
        phrase: &Phrase,
        text: &Text,
        at: &Assignment,
    ) -> Option<Signal> {
        let span = text.place(phrase.range.clone());
        let found =
            self.deeper(&span.clone(), |checker| checker.signal_inside(phrase, text, span, at))?;
        self.finite(&found).then_some(found)
    }

    /// Checks that constants have a value and that nothing is divided by a constant zero.
    fn finite(&mut self, signal: &Signal) -> bool {
        let problem = match &signal.kind {
            SignalKind::Binary(Operator::Divide, _, right) if constant(right) == Some(0.0) => {
                Problem::error("not-finite", "this is a division by zero")
                    .at(&signal.span)
                    .also(&right.span, "zero")
            }
            _ if constant(signal).is_some_and(|value| !value.is_finite()) => Problem::error(
                "not-finite",
                format!("`{}` is not a finite number", signal.span.text()),
            )
            .at(&signal.span),
            _ => return true,
        };
        self.problems.push(problem);
        false
    }

    fn signal_inside(
        &mut self,
        phrase: &Phrase,
        text: &Text,
        span: Span,
        at: &Assignment,
    ) -> Option<Signal> {
        match &phrase.node {
            Node::Path(name) => self.signal_named(name, &span, phrase, text, at),
            Node::PlaceOf(name, words) => self.placed(name, words, text, &span, at),
            Node::Negative(inner) => {
                let inner = self.signal(inner, text, at)?;
                Some(Signal {
                    dimension: inner.dimension,
                    track: inner.track,
                    kind: SignalKind::Negative(Box::new(inner)),
                    span,
                })
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
                let dimension = self.power(inner.dimension, *exponent, &span)?;
                Some(Signal {
                    dimension,
                    track: inner.track,
                    kind: SignalKind::Power(Box::new(inner), *exponent),
                    span,
                })
            }
            Node::Binary(
                operator @ (Operator::Add
                | Operator::Subtract
                | Operator::Multiply
                | Operator::Divide),
                left,
                right,
            ) => {
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
                                format!(
                                    "{} and {} cannot be added",
                                    left.dimension.in_words(),
                                    right.dimension.in_words()
                                ),
                            )
                            .at(&right.span)
                            .label(right.dimension.in_words())
                            .also(&left.span, left.dimension.in_words()),
                        );
                        return None;
                    }
                };
                let track = self.one_record(&[&left, &right])?;
                Some(Signal {
                    dimension,
                    track,
                    kind: SignalKind::Binary(*operator, Box::new(left), Box::new(right)),
                    span,
                })
            }
            Node::Call(name, arguments) if is_signal_function(&name.node) => {
                self.over_axis(name, arguments, text, span, at)
            }
            Node::Call(name, arguments) => {
                let function = self.function(name, arguments.len(), text)?;
                let arguments: Vec<Option<Signal>> =
                    arguments.iter().map(|argument| self.signal(argument, text, at)).collect();
                let arguments = arguments.into_iter().collect::<Option<Vec<_>>>()?;
                let dimensions: Vec<Dimension> =
                    arguments.iter().map(|argument| argument.dimension).collect();
                let spans: Vec<Span> =
                    arguments.iter().map(|argument| argument.span.clone()).collect();
                let dimension = self.function_type(function, &dimensions, &spans)?;
                let track = self.one_record(&arguments.iter().collect::<Vec<_>>())?;
                Some(Signal { dimension, track, kind: SignalKind::Call(function, arguments), span })
            }
            Node::Through(inner, filter) => {
                let inner = self.signal(inner, text, at);
                let steps = self.filter_named(&filter.node, &text.place(filter.range.clone()));
                let (inner, steps) = (inner?, steps?);
                self.step_order(&steps, false)?;
                if let Some(window) = steps.iter().find(|step| !step.kind.keeps_samples()) {
                    self.problems.push(
                        Problem::error(
                            "window-in-signal",
                            "a filter inside a signal must keep the samples; this one has a window or resampling",
                        )
                        .at(&text.place(filter.range.clone()))
                        .also(&window.span, "this step"),
                    );
                    return None;
                }
                let dimension = after(&steps, inner.dimension);
                Some(Signal {
                    dimension,
                    track: inner.track,
                    kind: SignalKind::Filtered(Box::new(inner), steps),
                    span,
                })
            }
            // `2 of Y` and `share of Y` are products.
            Node::Reduced(factor, of) if self.is_number_name(factor) => {
                let product = Node::Binary(Operator::Multiply, factor.clone(), of.clone());
                self.signal(&At { node: product, range: phrase.range.clone() }, text, at)
            }
            Node::Reduced(reducer, of) => self.level(reducer, of, text, span, at),
            Node::Cases(arms, otherwise) => {
                self.signal_cases(arms, otherwise.as_deref(), text, &span, at)
            }
            _ => self.scalar_signal(phrase, text, span),
        }
    }

    /// An operation along the axis: `shifted(X, 2 m)`, `derivative(X)`, `integral(X, time)`.
    fn over_axis(
        &mut self,
        name: &At<String>,
        arguments: &[Phrase],
        text: &Text,
        span: Span,
        at: &Assignment,
    ) -> Option<Signal> {
        let shifted = name.node == "shifted";
        let (of, second) = match arguments {
            [of] if !shifted => (of, None),
            [of, second] => (of, Some(second)),
            _ => {
                let takes = if shifted {
                    "a signal and a distance"
                } else {
                    "a signal and optionally `time`"
                };
                let says = format!(
                    "`{}` needs {takes}; number of arguments: {}",
                    name.node,
                    arguments.len()
                );
                self.problems
                    .push(Problem::error("arguments", says).at(&text.place(name.range.clone())));
                return None;
            }
        };
        let signal = self.signal(of, text, at);
        let axis = self.axis_dimension();
        if let (true, Some(distance)) = (shifted, second) {
            let distance = self.expr(distance, text, &mut Scope::section())?;
            let found = self.number_type(&distance)?;
            self.suits(
                "distance",
                found == axis,
                &format!("a distance along the axis ({})", axis.in_words()),
                found,
                &distance.span,
            )?;
            let signal = signal?;
            let (dimension, track) = (signal.dimension, signal.track);
            return Some(Signal {
                dimension,
                track,
                kind: SignalKind::OverAxis(AxisOperation::Shifted(distance), Box::new(signal)),
                span,
            });
        }
        let over_time = second.is_some();
        if let Some(second) = second
            && !(matches!(&second.node, Node::Path(path) if path == "time")
                && (self.has_time || axis == Dimension::TIME))
        {
            let problem = Problem::error(
                "arguments",
                format!("`{}` is computed over the axis or over `time`", name.node),
            );
            let problem = problem.at(&text.place(second.range.clone()));
            self.problems.push(if self.has_time {
                problem
            } else {
                problem.help("the protocol has no field `time`")
            });
            return None;
        }
        let signal = signal?;
        if over_time && signal.track {
            let problem = Problem::error("arguments", "the track record has no time").at(&span);
            self.problems.push(problem.help("remove `time`: it is then computed over the axis"));
            return None;
        }
        let axis = if over_time { Dimension::TIME } else { axis };
        let (operation, dimension) = match name.node.as_str() {
            "derivative" => (AxisOperation::Derivative { over_time }, signal.dimension / axis),
            _ => (AxisOperation::Integral { over_time }, signal.dimension * axis),
        };
        let track = signal.track;
        Some(Signal {
            dimension,
            track,
            kind: SignalKind::OverAxis(operation, Box::new(signal)),
            span,
        })
    }

    /// `mean of Y` among samples: the number of the section, taken from each of them.
    fn level(
        &mut self,
        reducer: &Phrase,
        of: &Phrase,
        text: &Text,
        span: Span,
        at: &Assignment,
    ) -> Option<Signal> {
        let reducer = self.reducer(reducer, text, true)?;
        let of = self.signal(of, text, at)?;
        let axis = self.axis_dimension();
        let (dimension, track) = (reducer.gives(of.dimension, axis), of.track);
        Some(Signal { dimension, track, kind: SignalKind::Level(reducer, Box::new(of)), span })
    }

    /// A number that is constant along the record.
    fn scalar_signal(&mut self, phrase: &Phrase, text: &Text, span: Span) -> Option<Signal> {
        let expr = self.expr(phrase, text, &mut Scope::section())?;
        let dimension = self.number_type(&expr)?;
        Some(Signal { dimension, track: false, kind: SignalKind::Scalar(expr), span })
    }

    fn signal_cases(
        &mut self,
        arms: &[(Phrase, Phrase)],
        otherwise: Option<&Phrase>,
        text: &Text,
        span: &Span,
        at: &Assignment,
    ) -> Option<Signal> {
        let mut found = Vec::new();
        let mut last = None;
        // Cases that parameters exclude are checked too.
        let mut all = Vec::new();
        for (value, condition) in arms {
            let condition = self
                .expr(condition, text, &mut Scope::section())
                .filter(|condition| self.flag_type(condition).is_some());
            let value = self.signal(value, text, at);
            let known = condition.as_ref().map(|condition| condition.kind.clone());
            all.push(value.as_ref().map(|value| (value.dimension, value.span.clone())));
            match (known, value, condition) {
                _ if last.is_some() => {}
                (Some(Kind::Constant(Scalar::Flag(false))), ..) => {}
                (Some(Kind::Constant(Scalar::Flag(true))), value, _) => last = Some(value?),
                (_, Some(value), Some(condition)) => found.push((condition, value)),
                _ => all.push(None),
            }
        }
        if let Some(otherwise) = otherwise {
            let value = self.signal(otherwise, text, at);
            all.push(value.as_ref().map(|value| (value.dimension, value.span.clone())));
            if last.is_none() {
                last = value;
            }
        }
        let all: Vec<(Dimension, Span)> = all.into_iter().collect::<Option<_>>()?;
        self.cases_alike(&all)?;
        if last.is_none() && !found.is_empty() {
            self.covered(&found.iter().map(|(condition, _)| condition).collect::<Vec<_>>(), span);
        }
        self.select(found, last, span)
    }

    fn cases_alike(&mut self, all: &[(Dimension, Span)]) -> Option<()> {
        let (first, first_span) = all.first()?;
        let Some((other, span)) = all.iter().find(|(dimension, _)| dimension != first) else {
            return Some(());
        };
        self.problems.push(
            Problem::error(
                "unit-mismatch",
                format!("one case is {}, another {}", first.in_words(), other.in_words()),
            )
            .at(span)
            .label(other.in_words())
            .also(first_span, first.in_words()),
        );
        None
    }

    pub(super) fn select(
        &mut self,
        arms: Vec<(Expr, Signal)>,
        otherwise: Option<Signal>,
        span: &Span,
    ) -> Option<Signal> {
        if arms.is_empty() {
            if otherwise.is_none() {
                self.problems.push(
                    Problem::error(
                        "no-case",
                        "no case of this can apply with the parameters as set",
                    )
                    .at(span),
                );
            }
            return otherwise;
        }
        let all: Vec<&Signal> =
            arms.iter().map(|(_, signal)| signal).chain(otherwise.as_ref()).collect();
        let dimension = all[0].dimension;
        let track = self.one_record(&all)?;
        Some(Signal {
            dimension,
            track,
            kind: SignalKind::Select(arms, otherwise.map(Box::new)),
            span: span.clone(),
        })
    }

    /// Whether all come from the track record. Track and vehicle records have different samples and
    /// cannot be combined.
    fn one_record(&mut self, signals: &[&Signal]) -> Option<bool> {
        let of_records: Vec<&&Signal> =
            signals.iter().filter(|signal| !matches!(signal.kind, SignalKind::Scalar(_))).collect();
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

    fn signal_named(
        &mut self,
        name: &str,
        span: &Span,
        phrase: &Phrase,
        text: &Text,
        at: &Assignment,
    ) -> Option<Signal> {
        if let Some(side) =
            Side::ALL.into_iter().find(|side| side.in_words() == name && !self.is_signal(name))
        {
            return self.side_of_own(side, span);
        }
        if let Some(channel) = self.names.channels.get(name).cloned() {
            return self.channel_at(name, &channel, span, at);
        }
        if let Some(signal) = self.names.signals.get(name).cloned() {
            return self.signal_at(name, &signal, span, at);
        }
        if let Some(define) = self.names.defines.get(name).cloned() {
            self.used_defines.insert(name.to_string());
            return self.inside("define", name, span, |checker| {
                checker.signal(&define.phrase, &define.text, at)
            });
        }
        let known = self.names.parameter_blocks.contains_key(name)
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

    pub(super) fn is_signal(&self, name: &str) -> bool {
        self.names.channels.contains_key(name) || self.names.signals.contains_key(name)
    }

    /// The samples of one side: `simulated`, `measured`.
    fn side_of_own(&mut self, side: Side, span: &Span) -> Option<Signal> {
        let Some(dimension) = self.own_of_both else {
            let says = format!(
                "`{}` can only be used as samples in the `metric` of a quantity and in plausibility rules",
                side.in_words()
            );
            let problem = Problem::error("side", says).at(span);
            self.problems.push(
                problem.help(
                    "elsewhere an expression is evaluated for simulation and measurement alike",
                ),
            );
            return None;
        };
        Some(Signal { dimension, track: false, kind: SignalKind::Side(side), span: span.clone() })
    }

    pub(super) fn unknown_signal(&mut self, name: &str, span: &Span) {
        if self.is_failed(name) {
            return;
        }
        let known: Vec<String> =
            self.names.channels.keys().chain(self.names.signals.keys()).cloned().collect();
        let problem =
            Problem::error("unknown-signal", format!("no channel or signal is called `{name}`"))
                .at(span);
        // `ay_I` is a column of the records: the channel at a position.
        let column = name.rsplit_once('_').and_then(|(channel, member)| {
            let places = &self.names.channels.get(channel)?.places;
            let place = places.iter().find(|place| {
                self.names
                    .places
                    .get(*place)
                    .is_some_and(|known| known.members.iter().any(|own| own == member))
            })?;
            Some(format!("`{channel}` at a position: `{channel} at {place} {member}`"))
        });
        self.problems.push(match column {
            Some(help) => problem.help(help),
            None => problem.suggest(name, known.iter().map(String::as_str)),
        });
    }

    fn channel_at(
        &mut self,
        name: &str,
        channel: &Channel,
        span: &Span,
        at: &Assignment,
    ) -> Option<Signal> {
        let column = self.fill(name, &channel.column, &channel.places, &channel.span, span, at)?;
        Some(Signal {
            kind: SignalKind::Column {
                column,
                channel: name.to_string(),
                unit: channel.unit.clone(),
            },
            dimension: channel.unit.dimension,
            track: channel.track,
            span: span.clone(),
        })
    }

    fn signal_at(
        &mut self,
        name: &str,
        signal: &SignalDef,
        span: &Span,
        at: &Assignment,
    ) -> Option<Signal> {
        self.fill(name, &signal.named, &signal.places, &signal.span, span, at)?;
        let own: Assignment = signal
            .places
            .iter()
            .filter_map(|place| at.get(place).map(|member| (place.clone(), member.clone())))
            .collect();
        let found = self.inside("signal", name, span, |checker| {
            checker.signal(&signal.is.phrase, &signal.is.text, &own)
        })?;
        if let Some(unit) = &signal.unit
            && unit.dimension != found.dimension
        {
            self.problems.push(
                Problem::error(
                    "unit-mismatch",
                    format!(
                        "signal `{name}` is declared in {unit}, but is {}",
                        found.dimension.in_words()
                    ),
                )
                .at(&signal.span)
                .also(&found.span, found.dimension.in_words()),
            );
            return None;
        }
        Some(found)
    }

    /// The name with its places inserted; a problem if one is not stated.
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
                    Problem::error(
                        "open-place",
                        format!(
                            "`{name}` has a position for each {place}; the {place} is not stated"
                        ),
                    )
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
}

/// The value, where the signal consists of constants only.
fn constant(signal: &Signal) -> Option<f64> {
    match &signal.kind {
        SignalKind::Scalar(Expr { kind: Kind::Constant(Scalar::Number(value)), .. }) => {
            Some(*value)
        }
        SignalKind::Negative(inner) => Some(-constant(inner)?),
        SignalKind::Power(inner, exponent) => Some(constant(inner)?.powi(i32::from(*exponent))),
        SignalKind::Binary(operator, left, right) => {
            let (left, right) = (constant(left)?, constant(right)?);
            match operator {
                Operator::Add => Some(left + right),
                Operator::Subtract => Some(left - right),
                Operator::Multiply => Some(left * right),
                Operator::Divide => Some(left / right),
                _ => None,
            }
        }
        SignalKind::Call(function, arguments) => {
            let arguments = arguments.iter().map(constant).collect::<Option<Vec<_>>>()?;
            Some((function.run)(&arguments))
        }
        _ => None,
    }
}
