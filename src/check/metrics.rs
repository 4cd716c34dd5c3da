//! Checks the `metric` of a quantity: a wording of the registry, or an expression of metrics and of
//! the signals of both sides.

use super::{
    compared::Compared,
    evaluate::is_whole,
    expressions::whole,
    names::bare_word,
    prelude::*,
    scope::Reduce,
    steps::{after, show_number},
    wordings::{fits, item_phrase},
};
use crate::catalog::{Asked, Form, FormPart, METRICS, Metric, MetricEntry, Reducer};
use crate::syntax::phrase::{Item, Step as WrittenStep};

/// Smallest number of points of a distribution: one point has no scatter.
const LEAST_POINTS: f64 = 2.0;
const MOST_POINTS: f64 = 10_000.0;

impl Checker<'_> {
    /// A quantity with a field `metric`: its wording or expression, and the records compared.
    pub fn by_metric(
        &mut self,
        field: &Field,
        compare: Option<&Field>,
        positions: Option<&[Position]>,
        chain: Option<&[Step]>,
    ) -> Option<Compared> {
        let of_pairs = compare
            .map_or(Some(Pairing::SIDES), |compare| self.of_metric(compare, &field.key.span));
        let compared = if self.is_wording(&field.value) {
            self.by_wording(field, positions, chain)
        } else {
            self.by_expression(field, positions, chain)
        };
        let (of_pairs, mut compared) = (of_pairs?, compared?);
        if of_pairs != Pairing::SIDES {
            if let Evaluation::Metric { pairing, .. } | Evaluation::Combined { pairing, .. } =
                &mut compared.evaluation
            {
                *pairing = of_pairs;
            }
            let words = self.paired_words(of_pairs, &compared.comparison);
            let both = self.paired_words(of_pairs, "simulated and measured");
            compared.comparison =
                if words == compared.comparison { format!("{words} of {both}") } else { words };
        }
        Some(compared)
    }

    /// Whether a field is a wording of a metric, and not an expression.
    fn is_wording(&mut self, text: &Text) -> bool {
        let mut unheard = Problems::default();
        let step = from_pest::step_alone(text, &mut unheard);
        if let Some(step) = &step {
            let step = self.with_choices(step.node.clone(), forms());
            if step.parts.first().is_some_and(|items| forms().any(|form| fits(form, items))) {
                return true;
            }
        }
        match from_pest::expression(text, &mut unheard) {
            // A word without another meaning is reported as an unknown metric.
            Some(At { node: Node::Path(word), .. }) => {
                let named = self.names.defines.contains_key(&word)
                    || self.names.parameter_blocks.contains_key(&word);
                !named && MetricEntry::called(&word).is_none()
            }
            Some(_) => step.is_some_and(|step| step.node.when.is_some()),
            None => !text.text.contains(['+', '*', '/', '|', '(']),
        }
    }

    fn by_wording(
        &mut self,
        field: &Field,
        positions: Option<&[Position]>,
        chain: Option<&[Step]>,
    ) -> Option<Compared> {
        let (metric, over) = self.metric(&field.value)?;
        self.by_one(metric, over, field, positions?, chain?)
    }

    /// A single metric.
    fn by_one(
        &mut self,
        metric: Metric,
        over: Option<Phrase>,
        field: &Field,
        positions: &[Position],
        chain: &[Step],
    ) -> Option<Compared> {
        let over_name = over.as_ref().and_then(|over| bare_word(over)).map(str::to_string);
        let over = match over {
            None => Vec::new(),
            Some(over) => positions
                .iter()
                .map(|position| self.signal_where(&over, &position.places, &whole(&over.text)))
                .collect::<Option<Vec<_>>>()?,
        };
        self.samples_are_kept(Taken::Compared(metric), chain, &field.value.span)?;
        let over_axis = over_name.zip(over.first()).map(|(name, signal)| Axis {
            unit: self.own_unit(&name, after(chain, signal.dimension())),
            column: name,
            span: field.value.span.clone(),
        });
        let words = self.with_values(&normalised(&field.value.text));
        let first = positions.first()?;
        Some(Compared {
            evaluation: Evaluation::Metric { metric, over, over_axis, pairing: Pairing::SIDES },
            dimension: (metric.0.gives)(
                after(chain, first.signal.dimension()),
                self.axis_dimension(),
            ),
            sides: None,
            processing: words.clone(),
            comparison: words,
            best: Some((metric.0.best, field.value.span.clone())),
            from: Some(field.value.span.clone()),
        })
    }

    /// Whether the filter leaves the samples that a metric compares; a problem if not.
    pub fn samples_are_kept(&mut self, taken: Taken, chain: &[Step], at: &Span) -> Option<()> {
        let Some(step) =
            chain.iter().find(|step| !step.kind.keeps_samples()).filter(|_| taken.needs_samples())
        else {
            return Some(());
        };
        self.refuse(
            error(
                "metric-of-window",
                "this metric compares samples and cannot follow a window or resampling",
                at,
            )
            .also(&step.span, "this step"),
        )
    }

    /// An expression. Its best value is known only if it is a single metric.
    fn by_expression(
        &mut self,
        field: &Field,
        positions: Option<&[Position]>,
        chain: Option<&[Step]>,
    ) -> Option<Compared> {
        let phrase = self.metric_expression(&field.value)?;
        let (positions, chain) = (positions?, chain?);
        let (mut valued, dimension) =
            self.valued(&phrase, field, positions, chain, Scope::comparing)?;
        if chain.iter().any(|step| !step.kind.keeps_samples()) {
            valued.inputs.iter_mut().flatten().for_each(of_one_side);
        }
        let inputs = valued.inputs.first()?;
        for input in inputs {
            if let (Taken::Reduced(reducer), InputSide::Own) = (input.taken, input.side) {
                let words = normalised(input.span.text());
                let help = if reducer.in_words() == words {
                    format!("write `{words} of measured` or `{words} of simulated`")
                } else {
                    format!("write `measured({words})` or `simulated({words})`")
                };
                return self.refuse(
                    problem!(
                        "side",
                        &input.span,
                        "`{words}` does not say which side it is computed from"
                    )
                    .help(help),
                );
            }
            self.samples_are_kept(input.taken, chain, &input.span)?;
        }
        if let (Kind::Input(0), [Input { taken: Taken::Compared(metric), over: None, .. }]) =
            (&valued.expr.kind, inputs.as_slice())
        {
            return self.by_one(*metric, None, field, positions, chain);
        }
        let words = self.with_values(&normalised(&field.value.text));
        Some(Compared {
            evaluation: Evaluation::Combined { of: valued, pairing: Pairing::SIDES },
            dimension,
            sides: None,
            processing: words.clone(),
            comparison: words,
            best: None,
            from: Some(field.value.span.clone()),
        })
    }

    /// The expression in a field. If it cannot be parsed because a metric is written in words, the
    /// message says so.
    fn metric_expression(&mut self, text: &Text) -> Option<Phrase> {
        let mut problems = Problems::default();
        let found = from_pest::expression(text, &mut problems);
        let words = normalised(&text.text);
        let spelt = METRICS
            .iter()
            .filter(|entry| entry.form.head.len() > 1)
            .find(|entry| words.contains(&leading_words(entry)));
        let help = spelt.map(|entry| {
            let (form, call) = (entry.form.in_words(), entry.call_in_words());
            format!("in an expression `{form}` is written `{call}`")
        });
        self.problems.add(problems.0.into_iter().map(|problem| problem.help_if(help.as_deref())));
        found
    }

    /// A metric and the signal that its wording names, at given positions.
    fn metric(&mut self, text: &Text) -> Option<(Metric, Option<Phrase>)> {
        let step = from_pest::step_alone(text, self.problems)?;
        let span = step.place();
        let step = step.with(self.with_choices(step.node.clone(), forms()));
        let index = self.find_form(&step.node, &span, "metric", forms())?;
        let entry = &METRICS[index];
        let extra = step.node.parts.get(1).and_then(|part| part.first());
        if let Some(extra) = extra.filter(|_| entry.form.numbers.is_empty()) {
            return self.refuse(error("unknown-option", "this metric has no option", extra));
        }
        if let Some(condition) = &step.node.when {
            return self.refuse(
                error("unknown-option", "a metric has no condition", condition)
                    .help("sections are left out of a quantity by its field `where`"),
            );
        }
        self.metric_filled(entry, &step.node, &span)
    }

    /// A metric with its slots and options filled.
    fn metric_filled(
        &mut self,
        entry: &'static MetricEntry,
        step: &WrittenStep,
        span: &Span,
    ) -> Option<(Metric, Option<Phrase>)> {
        let slot = entry.form.head.iter().position(|part| matches!(part, FormPart::Signal(_)));
        let over = match slot {
            None => None,
            Some(slot) => Some(item_phrase(step.parts.first()?.get(slot)?)),
        };
        let filled = self.fill_form(&entry.form, step, span)?;
        let points = filled.options.first().copied().flatten().map(|(points, _)| points);
        if let Some(points) = points.filter(|points| !is_whole(*points, LEAST_POINTS..=MOST_POINTS))
        {
            return self.refuse(problem!("out-of-range", span, "the number of points must be a whole number from {LEAST_POINTS} to {MOST_POINTS}, this is {points}"));
        }
        let mut asked = Asked { points: points.map(|points| points as usize), band: None };
        if let [(low, of_low, at_low), (high, of_high, at_high)] = filled.numbers.as_slice() {
            let in_time = self.time.is_some()
                || self.axis.as_ref().is_some_and(|axis| axis.unit.dimension == Dimension::TIME);
            let wanted = if in_time { Dimension::FREQUENCY } else { Dimension::PER_LENGTH };
            for (found, at) in [(of_low, at_low), (of_high, at_high)] {
                let of = if in_time {
                    "a frequency in Hz"
                } else {
                    "a frequency in cycles per length, as records have no time"
                };
                self.suits("frequency", *found == wanted, of, *found, at)?;
            }
            if low >= high {
                let (low, high) = (show_number(*low, wanted), show_number(*high, wanted));
                return self.refuse(problem!(
                    "out-of-range",
                    at_high,
                    "the band from {low} to {high} is empty"
                ));
            }
            asked.band = Some((*low, *high));
        }
        Some((Metric(entry, asked), over))
    }

    /// Whether a call is that of a metric.
    pub fn metric_called(&self, name: &At<String>, scope: &Scope) -> bool {
        scope.reduce.is_some_and(|reduce| reduce.metrics)
            && MetricEntry::called(&name.node).is_some()
    }

    /// A metric in an expression: `coherence(1 Hz, 3 Hz)`, `matching_probability(50)`. The
    /// arguments are the slots of its wording, then its options.
    pub fn metric_call(
        &mut self,
        name: &At<String>,
        given: &[Phrase],
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let entry = MetricEntry::called(&name.node)?;
        let item = |phrase: &Phrase| phrase.with(Item::Value(phrase.clone()));
        let word = |word: &str| name.with(Item::Word(word.into()));
        let mut rest = given.iter();
        let head: Option<Vec<At<Item>>> = entry
            .form
            .head
            .iter()
            .map(|part| {
                if let FormPart::Word(fixed) = part {
                    Some(word(fixed))
                } else {
                    rest.next().map(item)
                }
            })
            .collect();
        let options = entry
            .form
            .numbers
            .iter()
            .zip(&mut rest)
            .map(|(option, value)| vec![item(value), word(option.name)]);
        let parts = head.map(|head| std::iter::once(head).chain(options).collect::<Vec<_>>());
        let (Some(parts), None) = (parts, rest.next()) else {
            return self.refuse(problem!(
                "arguments",
                name,
                "`{}` is written `{}`; number of arguments: {}",
                name.node,
                entry.call_in_words(),
                given.len()
            ));
        };
        let (metric, over) = self.metric_filled(entry, &WrittenStep { parts, when: None }, span)?;
        let over = if_written(over.map(|over| self.record_signal(&over, &scope.at)))?;
        self.metric_input(metric, over, span, scope)
    }

    /// A metric without arguments.
    pub fn metric_named(
        &mut self,
        entry: &'static MetricEntry,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        if entry.form.head.iter().any(|part| !matches!(part, FormPart::Word(_))) {
            return self.refuse(
                problem!("arguments", span, "`{}` needs arguments", entry.function_name())
                    .help(format!("write `{}`", entry.call_in_words())),
            );
        }
        self.metric_input(Metric(entry, Asked::default()), None, span, scope)
    }

    fn metric_input(
        &mut self,
        metric: Metric,
        over: Option<Expr>,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(Reduce { own: Some(dimension), axis, side, .. }) = scope.reduce else {
            return None;
        };
        if side != InputSide::Own {
            return self.refuse(
                problem!("side", span, "`{}` takes both sides", span.words)
                    .help("leave `measured(...)` or `simulated(...)` out"),
            );
        }
        let input = Input { over, ..Input::own(Taken::Compared(metric), side, span) };
        let dimension = input.taken.gives(dimension, axis);
        Some(scope.input(input, dimension, span))
    }

    /// The slope of the own signal: `slope over cant_angle`.
    pub fn slope_over(
        &mut self,
        value: &Phrase,
        over: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(reducer) = bare_word(value).and_then(Reducer::named) else {
            let says = "only a slope can be computed over another signal";
            let help = "write `slope over SIGNAL` or `slope of SIGNAL over SIGNAL`";
            return self.refuse(error("unknown-reducer", says, value).help(help));
        };
        let over = self.slope_axis(reducer, over, value, &scope.at)?;
        let Some(Reduce { own: Some(dimension), side, .. }) = scope.reduce else {
            return self.own_reducer(reducer, span.clone(), scope);
        };
        let dimension = reducer.gives(dimension, over.dimension() * scope.factor);
        let input = Input { over: Some(over), ..Input::own(Taken::Reduced(reducer), side, span) };
        Some(scope.input(input, dimension, span))
    }

    /// The signal that a slope is computed over.
    pub fn slope_axis(
        &mut self,
        reducer: Reducer,
        over: &Phrase,
        place: &Phrase,
        at: &Assignment,
    ) -> Option<Expr> {
        let name = reducer.in_words();
        if name != "slope" {
            let help = "write `slope over SIGNAL`";
            return self.refuse(
                problem!(
                    "unknown-reducer",
                    place,
                    "`{name}` cannot be computed over another signal; only a slope can"
                )
                .help(help),
            );
        }
        self.record_signal(over, at)
    }

    /// A value taken from the samples of both sides: `rms of (simulated - measured)`.
    pub fn of_both(
        &mut self,
        reducer: Reducer,
        signal: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Reduce { own, axis, metrics, side } = scope.reduce?;
        if metrics && side != InputSide::Own {
            return self.refuse(
                problem!("side", span, "`{}` names its sides already", span.words)
                    .help("remove the outer `measured(...)` or `simulated(...)`"),
            );
        }
        let own = own.filter(|_| metrics);
        let mut samples = Scope { may_miss: true, ..Scope::samples(&scope.at, own) };
        let signal = self.expr(signal, &mut samples)?;
        let signal = self.at_frequencies(signal)?;
        self.only_both(&signal)?;
        self.suits_points(reducer, &signal, span)?;
        let dimension = reducer.gives(signal.dimension(), signal.along(axis));
        let own = Input::own(Taken::OfBoth(reducer), InputSide::Own, span);
        Some(scope.input(Input { signal: Some(signal), ..own }, dimension, span))
    }
}

impl Checker<'_> {
    /// Refuses other signals among the samples of both sides.
    pub fn only_both(&mut self, signal: &Expr) -> Option<()> {
        let Some(other) = not_of_both(signal) else { return Some(()) };
        let says = "samples of both sides can only be combined with numbers: other signals and filters have other samples";
        let help = match other.kind {
            Kind::Filtered(..) => {
                "write it in the field `filter` of the quantity: both signals pass it before they are combined"
            }
            _ => "`shifted` can only be applied to `simulated` and `measured`",
        };
        self.refuse(error("mixed-records", says, other).help(help))
    }
}

/// `rms of simulated` after a window: the sides have no common points, and none are needed.
fn of_one_side(input: &mut Input) {
    let (Taken::OfBoth(reducer), Some(Expr { kind: Kind::Side(side), .. })) =
        (input.taken, &input.signal)
    else {
        return;
    };
    input.side = match side {
        Side::Simulated => InputSide::Simulated,
        Side::Measured => InputSide::Measured,
    };
    input.taken = Taken::Reduced(reducer);
    input.signal = None;
}

/// The first part of an expression over both sides that is not allowed in it.
fn not_of_both(expr: &Expr) -> Option<&Expr> {
    match &expr.kind {
        Kind::OverAxis(AxisOperation::Shifted(_), inner) => {
            Some(expr).filter(|_| !matches!(inner.kind, Kind::Side(_)))
        }
        Kind::Channel { .. } | Kind::Filtered(..) => Some(expr),
        _ => expr.parts().into_iter().find_map(not_of_both),
    }
}

/// The wordings of all metrics.
fn forms() -> impl Iterator<Item = &'static Form> + Clone {
    METRICS.iter().map(|entry| &entry.form)
}

/// The words of a wording before its first slot: `theil inequality`, `coherence from`.
fn leading_words(entry: &MetricEntry) -> String {
    entry.form.head.iter().map_while(FormPart::word).collect::<Vec<_>>().join(" ")
}
