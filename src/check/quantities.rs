//! Checks quantities: positions, chain, value, difference or metric, limits.

use super::Checker;
use super::evaluate::{Nothing, Values, number, words};
use super::names::{Assignment, bare_word, normalised};
use super::plan::{Axis, DatumKind, Evaluation, Expr, Input, InputSide, Kind, Quantity, QuantityWords, Scalar, Signal, Step};
use super::scalars::Scope;
use super::steps::after;
use crate::catalog::{Best, DIFFERENCES};
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::phrase::{At, Node};
use crate::units::{Dimension, Unit};

/// What a quantity's value and difference, or its metric, come to.
struct Compared {
    evaluation: Evaluation,
    dimension: Dimension,
    processing: String,
    comparison: String,
    /// Which values are good and what says so, where that can be told.
    best: Option<(Best, Span)>,
    /// What the dimension comes from, where it is not that of the signal.
    from: Option<Span>,
}

impl Checker<'_> {
    pub(super) fn quantity(&mut self, block: &Block) -> Option<Quantity> {
        self.in_quantity = true;
        let only = block.field("where").map(|field| self.section_condition(field));
        self.assumed.extend(only.clone().flatten());
        let found = self.quantity_where(block, only);
        self.assumed.clear();
        self.in_quantity = false;
        found
    }

    /// Everything is looked at, whatever fails: an author wants all faults in one go.
    fn quantity_where(&mut self, block: &Block, only: Option<Option<Expr>>) -> Option<Quantity> {
        let metric = block.field("metric");
        self.all_required(block, if metric.is_some() { &["of"] } else { &["of", "value", "difference"] });
        if let (Some(metric), Some(other)) = (metric, block.field("value").or(block.field("difference"))) {
            self.problems.push(
                Problem::error("metric-and-value", "a quantity has either a metric, or a value and a difference")
                    .at(&other.key.span)
                    .also(&metric.key.span, "the metric"),
            );
        }
        let of = block.field("of").map(|field| field.value.clone());
        let chain = block.field("filter").map_or(Some(Vec::new()), |field| self.chain(&field.value));
        let signals = of.as_ref().and_then(|of| self.signals_of(of));
        let dimension = signals.as_ref().and_then(|signals| signals.first()).map(|(_, signal, _)| signal.dimension);
        let dimension = dimension.map(|dimension| after(chain.as_deref().unwrap_or_default(), dimension));
        let compared = match metric {
            Some(field) => self.compared_by_metric(field, signals.as_deref(), chain.as_deref()),
            None => self.compared_by_values(block, dimension),
        };
        let result = compared.as_ref().map(|compared| compared.dimension);
        let unit = result.zip(of.as_ref()).and_then(|(result, of)| self.quantity_unit(block, of, result));
        let from = compared.as_ref().and_then(|compared| compared.from.as_ref()).or_else(|| of.as_ref().map(|of| &of.span));
        let best = compared.as_ref().and_then(|compared| compared.best.as_ref());
        let limits = self.limits(block, unit.as_ref().zip(from), best);
        if block.field("limit").is_none() {
            self.problems.push(
                Problem::warning("no-limit", format!("quantity `{}` has no limit: it is reported, and decides nothing", block.name_text()))
                    .at(block.span()),
            );
        }
        if let (Some(only), None, 2..) = (block.field("where"), block.field("minimum pairs"), self.minimum_pairs) {
            let says = format!(
                "quantity `{}` takes only some of the sections and needs {} pairs all the same",
                block.name_text(),
                self.minimum_pairs
            );
            let problem = Problem::warning("minimum-inherited", says).at(&only.value.span);
            self.problems.push(problem.help("say how many it needs itself: `minimum pairs ...`"));
        }
        let minimum_signals = self.count(block, "minimum signals", self.minimum_signals);
        let minimum_pairs = self.count(block, "minimum pairs", self.minimum_pairs);
        let (of, chain, signals, compared, unit) = (of?, chain?, signals?, compared?, unit?);
        let signal_unit = from_pest::of_places(&of, self.problems)
            .map(|written| self.own_unit(&written.signal.node, after(&chain, signals[0].1.dimension)))?;
        let text = |key: &str| block.field(key).map(|field| field.value.text.clone());
        let filter =
            if chain.is_empty() { "none".into() } else { chain.iter().map(|step| step.words.as_str()).collect::<Vec<_>>().join(", then ") };
        Some(Quantity {
            id: block.name_text().to_string(),
            title: block.title.as_ref().map_or_else(|| block.name_text().to_string(), |title| title.text.clone()),
            symbol: text("symbol").unwrap_or_else(|| block.name_text().to_string()),
            words: QuantityWords {
                of: self.with_values(&normalised(&of.text)),
                filter,
                processing: compared.processing,
                comparison: compared.comparison,
            },
            clause: text("clause"),
            source: text("source"),
            notes: block.fields_named("note").map(|note| note.value.text.clone()).collect(),
            unit,
            signal_unit,
            signals: signals.into_iter().map(|(name, signal, _)| (name, signal)).collect(),
            chain,
            evaluation: compared.evaluation,
            only: match only {
                Some(only) => Some(only?),
                None => None,
            },
            limits: limits?,
            minimum_signals: minimum_signals?,
            minimum_pairs: minimum_pairs?,
            span: block.span().clone(),
        })
    }

    fn compared_by_metric(
        &mut self,
        field: &Field,
        signals: Option<&[(String, Signal, Assignment)]>,
        chain: Option<&[Step]>,
    ) -> Option<Compared> {
        let (metric, over) = self.metric(&field.value)?;
        let over_name = over.as_ref().and_then(|over| bare_word(&over.phrase)).map(str::to_string);
        let signals = signals?;
        let over = match over {
            None => Vec::new(),
            Some(over) => signals
                .iter()
                .map(|(_, _, at)| self.signal_where(&over.phrase, &over.text, at, &over.text.span))
                .collect::<Option<Vec<_>>>()?,
        };
        let chain = chain?;
        if let (true, Some(step)) = (metric.on_common_points(false), chain.iter().find(|step| !step.kind.keeps_samples())) {
            self.problems.push(
                Problem::error("metric-of-window", "this metric compares samples and cannot follow a window or resampling")
                    .at(&field.value.span)
                    .also(&step.span, "this step"),
            );
            return None;
        }
        let over_axis = over_name
            .zip(over.first())
            .map(|(name, signal)| Axis { unit: self.own_unit(&name, after(chain, signal.dimension)), column: name });
        let words = normalised(&field.value.text);
        let (_, first, _) = signals.first()?;
        Some(Compared {
            evaluation: Evaluation::Metric { metric, over, over_axis },
            dimension: (metric.0.gives)(
                after(chain, first.dimension),
                self.axis.as_ref().map_or(Dimension::LENGTH, |axis| axis.unit.dimension),
            ),
            processing: words.clone(),
            comparison: words,
            best: Some((metric.0.best, field.value.span.clone())),
            from: Some(field.value.span.clone()),
        })
    }

    /// Every position with its name, its signal and its assignment.
    pub(super) fn signals_of(&mut self, of: &Text) -> Option<Vec<(String, Signal, Assignment)>> {
        let written = from_pest::of_places(of, self.problems)?;
        let positions = self.positions(&written.signal, &written.picks, of)?;
        let name = &written.signal.node;
        let (pattern, places, span) = match (self.names.channels.get(name), self.names.signals.get(name)) {
            (Some(channel), _) => (channel.column.clone(), channel.places.clone(), channel.span.clone()),
            (_, Some(signal)) => (signal.named.clone(), signal.places.clone(), signal.span.clone()),
            _ => return None,
        };
        let phrase = At { node: Node::Path(name.clone()), range: written.signal.range.clone() };
        let used = of.place(written.signal.range.clone());
        let mut found: Vec<(String, Signal, Assignment)> = Vec::new();
        for position in positions {
            let filled = self.fill(name, &pattern, &places, &span, &used, &position)?;
            if found.iter().any(|(known, _, _)| *known == filled) {
                continue;
            }
            let signal = self.signal_where(&phrase, of, &position, &of.span)?;
            if signal.track {
                self.problems
                    .push(Problem::error("track-quantity", "the track record has no simulated and measured side to compare").at(&used));
                return None;
            }
            found.push((filled, signal, position));
        }
        Some(found)
    }

    fn compared_by_values(&mut self, block: &Block, dimension: Option<Dimension>) -> Option<Compared> {
        let value = block.field("value").and_then(|field| self.value(field, dimension));
        let result = value.as_ref().map(|(_, _, dimension)| *dimension);
        let difference = block.field("difference").and_then(|field| self.difference(field, result));
        let ((value, inputs, result), (difference, compared)) = (value?, difference?);
        let (processing, comparison) = (words(&value), words(&difference));
        let key = if compared != result { "difference" } else { "value" };
        let from = block.field(key).filter(|_| Some(compared) != dimension).map(|field| field.value.span.clone());
        let span = block.field("difference").map(|field| field.value.span.clone());
        let best = of_equal_sides(&difference).map(Best::Near).zip(span);
        let evaluation = Evaluation::Sides { value, inputs, difference };
        Some(Compared { evaluation, dimension: compared, processing, comparison, best, from })
    }

    fn value(&mut self, field: &Field, dimension: Option<Dimension>) -> Option<(Expr, Vec<Input>, Dimension)> {
        let axis = self.axis.as_ref().map_or(Dimension::LENGTH, |axis| axis.unit.dimension);
        let phrase = from_pest::expression(&field.value, self.problems)?;
        let mut scope = Scope::reducing(Some(dimension?), axis);
        let expr = self.expr(&phrase, &field.value, &mut scope)?;
        let result = self.number_type(&expr)?;
        if scope.inputs.is_empty() {
            self.problems.push(
                Problem::error("value-of-nothing", "this takes nothing from the signal")
                    .at(&field.value.span)
                    .help("for instance `median`, `rms`, `|p99.85|`"),
            );
            return None;
        }
        Some((expr, scope.inputs, result))
    }

    /// A named difference, a choice parameter that names one, or an expression; of values of unknown dimension, only its name is looked at.
    fn difference(&mut self, field: &Field, dimension: Option<Dimension>) -> Option<(Expr, Dimension)> {
        let written = from_pest::expression(&field.value, self.problems)?;
        let mut phrase = written.clone();
        let mut text = field.value.clone();
        if let Some(word) = bare_word(&written) {
            let choice = self.choice_phrase(&written, &field.value)?;
            if let Some((name, expression)) = DIFFERENCES.iter().find(|(name, _)| *name == choice) {
                let source = crate::source::Source::new(format!("difference `{name}`"), *expression);
                text = Text { text: (*expression).to_string(), span: source.whole(), exact: true };
                phrase = from_pest::expression(&text, self.problems)?;
            } else if choice != word
                || !(matches!(word, "simulated" | "measured") || self.names.defines.contains_key(word) || self.is_failed(word))
            {
                let differences = DIFFERENCES.iter().map(|(name, _)| *name);
                let problem =
                    Problem::error("unknown-difference", format!("`{choice}` is no way to compare two values")).at(&field.value.span);
                self.problems.push(problem.suggest(&choice, differences));
                return None;
            }
        }
        let expr = self.expr(&phrase, &text, &mut Scope::pair(dimension?))?;
        let dimension = self.number_type(&expr)?;
        Some((expr, dimension))
    }

    /// The unit values are printed in: said, or that of the signal, or SI.
    fn quantity_unit(&mut self, block: &Block, of: &Text, dimension: Dimension) -> Option<Unit> {
        if let Some(field) = block.field("in") {
            let unit = self.unit(&field.value)?;
            if unit.dimension != dimension {
                self.problems.push(
                    Problem::error(
                        "unit-mismatch",
                        format!("the values are {}, the unit is one of {}", dimension.in_words(), unit.dimension.in_words()),
                    )
                    .at(&field.value.span)
                    .also(&of.span, dimension.in_words()),
                );
                return None;
            }
            return Some(unit);
        }
        let signal = from_pest::of_places(of, self.problems)?.signal.node;
        Some(self.own_unit(&signal, dimension))
    }

    /// The unit that a column of sections or a vehicle datum is declared in, of the first in an expression that has a dimension.
    pub(super) fn datum_unit(&self, expr: &Expr, dimension: Dimension) -> Option<Unit> {
        let datum = match &expr.kind {
            Kind::Column(index) => self.names.columns.get(*index)?,
            Kind::Vehicle(index) => self.names.vehicle.get(*index)?,
            Kind::Negative(inner) | Kind::Power(inner, _) => return self.datum_unit(inner, dimension),
            Kind::Binary(_, left, right) => return self.datum_unit(left, dimension).or_else(|| self.datum_unit(right, dimension)),
            Kind::Call(_, arguments) => return arguments.iter().find_map(|argument| self.datum_unit(argument, dimension)),
            _ => return None,
        };
        match &datum.kind {
            DatumKind::Number(unit) if unit.dimension == dimension => Some(unit.clone()),
            _ => None,
        }
    }

    /// The unit of a channel or signal if it suits, else that of SI.
    pub(super) fn own_unit(&self, name: &str, dimension: Dimension) -> Unit {
        let channel = self.names.channels.get(name).map(|channel| channel.unit.clone());
        let own = channel.or_else(|| self.names.signals.get(name).and_then(|signal| signal.unit.clone()));
        match own {
            Some(unit) if unit.dimension == dimension => unit,
            _ if dimension == Dimension::ONE => Unit::one(),
            _ => Unit { text: dimension.to_string(), factor: 1.0, dimension },
        }
    }

    pub(super) fn section_condition(&mut self, field: &Field) -> Option<Expr> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        let expr = self.expr(&phrase, &field.value, &mut Scope::section())?;
        self.flag_type(&expr)?;
        Some(expr)
    }

    /// A whole number that constants decide.
    pub(super) fn count(&mut self, block: &Block, key: &str, default: usize) -> Option<usize> {
        let Some(field) = block.field(key) else { return Some(default) };
        let (value, dimension) = self.constant(&field.value)?;
        if dimension != Dimension::ONE || value.fract() != 0.0 || !(0.0..=1e6).contains(&value) {
            self.problems.push(
                Problem::error("not-a-count", format!("`{key}` is a whole number, this is {}", normalised(&field.value.text)))
                    .at(&field.value.span),
            );
            return None;
        }
        Some(value as usize)
    }
}

/// What a comparison comes to where both sides are alike: 0 of a difference, 1 of a ratio; `None` where that depends on the side.
fn of_equal_sides(difference: &Expr) -> Option<f64> {
    /// Values of both signs and of no round ratio.
    const TRIED: [f64; 3] = [1.0, -1.7, 2.9];
    let mut found = TRIED.iter().map(|&side| number(difference, &Alike(side)));
    let first = found.next()?.ok()?;
    found.all(|other| other == Ok(first)).then_some(first)
}

/// Both sides of a pair have this value, and nothing else is known.
struct Alike(f64);

impl Values for Alike {
    fn vehicle(&self, index: usize) -> Result<Scalar, String> {
        Nothing.vehicle(index)
    }
    fn column(&self, index: usize) -> Result<Scalar, String> {
        Nothing.column(index)
    }
    fn extent(&self) -> Result<(f64, f64), String> {
        Nothing.extent()
    }
    fn input(&self, index: usize) -> Result<f64, String> {
        Nothing.input(index)
    }
    fn sides(&self) -> Result<(f64, f64), String> {
        Ok((self.0, self.0))
    }
    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        Nothing.limit_of(statistic)
    }
}

impl InputSide {
    pub fn resolve(self, own: Self) -> Self {
        if self == Self::Own { own } else { self }
    }
}
