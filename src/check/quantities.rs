//! Checks quantities: positions, chain, value, difference or metric, limits.

use super::evaluate::words;
use super::names::{Assignment, bare_word, normalised};
use super::plan::{
    Axis, Evaluation, Expr, InputSide, Kind, Limit, Quantity, QuantityWords, Scalar, Scope as LimitScope, Signal, Step, Type,
};
use super::scalars::{Scope, fold};
use super::{Checker, overlap};
use crate::catalog::{STATISTICS, Statistic};
use crate::problem::Problem;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::phrase::{At, Node, Scope as WrittenScope};
use crate::units::{Dimension, Unit};

/// Comparisons with a name, so that protocols need not spell them out.
pub const DIFFERENCES: [(&str, &str); 3] = [
    ("oriented", "sign(measured) * (simulated - measured)"),
    ("magnitudes", "|simulated| - |measured|"),
    ("signed", "simulated - measured"),
];

impl Checker<'_> {
    pub(super) fn quantity(&mut self, block: &Block) -> Option<Quantity> {
        let of = self.required(block, "of").map(|field| field.value.clone());
        let chain = match block.field("filter") {
            Some(field) => self.chain(&field.value),
            None => Some(Vec::new()),
        };
        let metric = block.field("metric");
        let value = if metric.is_some() { None } else { self.required(block, "value") };
        if let (Some(metric), Some(other)) = (metric, block.field("value").or(block.field("difference"))) {
            self.problems.push(
                Problem::error("metric-and-value", "a quantity has either a metric, or a value and a difference")
                    .at(&other.key.span)
                    .also(&metric.key.span, "the metric"),
            );
        }
        let of = of?;
        let signals = self.signals_of(&of);
        let (chain, signals) = (chain?, signals?);
        let (_, first, _) = signals.first()?;
        let dimension = first.dimension;
        let of_words = normalised(&of.text);
        let (evaluation, result, processing, comparison) = match metric {
            Some(field) => {
                let (metric, over) = self.metric(&field.value)?;
                let over_axis = over.as_ref().and_then(|over| bare_word(&over.phrase)).map(str::to_string);
                let over = match over {
                    None => Vec::new(),
                    Some(over) => signals.iter().map(|(_, _, at)| self.signal(&over.phrase, &over.text, at)).collect::<Option<Vec<_>>>()?,
                };
                if let (true, Some(step)) = (metric.0.common_points, chain.iter().find(|step| !step.kind.keeps_samples())) {
                    self.problems.push(
                        Problem::error("metric-of-window", "this metric compares samples and cannot follow a window or resampling")
                            .at(&field.value.span)
                            .also(&step.span, "this step"),
                    );
                    return None;
                }
                let over_axis =
                    over_axis.zip(over.first()).map(|(name, signal)| Axis { unit: self.own_unit(&name, signal.dimension), column: name });
                let words = normalised(&field.value.text);
                (Evaluation::Metric { metric, over, over_axis }, (metric.0.gives)(dimension), words.clone(), words)
            }
            None => {
                let value = value?;
                self.sides(block, value, dimension)?
            }
        };
        let unit = self.quantity_unit(block, &of, result)?;
        let signal_unit = from_pest::of_places(&of, self.problems).map(|of| self.own_unit(&of.signal.node, dimension))?;
        let limits = self.limits(block, &unit, result);
        if limits.is_empty() && block.field("limit").is_none() {
            self.problems.push(
                Problem::warning("no-limit", format!("quantity `{}` has no limit: it is reported, and decides nothing", block.name_text()))
                    .at(block.span()),
            );
        }
        let filter = filter_words(&chain);
        let only = match block.field("where") {
            Some(field) => Some(self.section_condition(field)?),
            None => None,
        };
        let minimum_signals = self.count(block, "minimum signals", self.minimum_signals)?;
        let minimum_pairs = self.count(block, "minimum pairs", self.minimum_pairs)?;
        let text = |key: &str| block.field(key).map(|field| field.value.text.clone());
        Some(Quantity {
            id: block.name_text().to_string(),
            title: block.title.as_ref().map_or_else(|| block.name_text().to_string(), |title| title.text.clone()),
            symbol: text("symbol").unwrap_or_else(|| block.name_text().to_string()),
            words: QuantityWords { of: of_words, filter, processing, comparison },
            clause: text("clause"),
            source: text("source"),
            notes: block.fields_named("note").map(|note| note.value.text.clone()).collect(),
            unit,
            signal_unit,
            signals: signals.into_iter().map(|(name, signal, _)| (name, signal)).collect(),
            chain,
            evaluation,
            only,
            limits,
            minimum_signals,
            minimum_pairs,
            span: block.span().clone(),
        })
    }

    /// Every position with its name, its signal and its assignment.
    fn signals_of(&mut self, of: &Text) -> Option<Vec<(String, Signal, Assignment)>> {
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
            let signal = self.signal(&phrase, of, &position)?;
            if signal.track {
                self.problems
                    .push(Problem::error("track-quantity", "the track record has no simulated and measured side to compare").at(&used));
                return None;
            }
            found.push((filled, signal, position));
        }
        Some(found)
    }

    fn sides(&mut self, block: &Block, value: &Field, dimension: Dimension) -> Option<(Evaluation, Dimension, String, String)> {
        let axis = self.axis.as_ref().map_or(Dimension::LENGTH, |axis| axis.unit.dimension);
        let phrase = from_pest::expression(&value.value, self.problems)?;
        let mut scope = Scope::reducing(Some(dimension), axis);
        let expr = self.expr(&phrase, &value.value, &mut scope)?;
        let result = self.number_type(&expr)?;
        if scope.inputs.is_empty() {
            self.problems.push(
                Problem::error("value-of-nothing", "the value takes nothing from the signal")
                    .at(&value.value.span)
                    .help("for instance `median`, `rms`, `|p99.85|`"),
            );
            return None;
        }
        let processing = words(&expr);
        let difference = self.required(block, "difference")?;
        let (phrase, text) = self.difference_phrase(difference)?;
        let mut pair = Scope::pair(result);
        let compared = self.expr(&phrase, &text, &mut pair)?;
        let compared_dimension = self.number_type(&compared)?;
        let comparison = words(&compared);
        let evaluation = Evaluation::Sides { value: expr, inputs: scope.inputs, difference: compared };
        Some((evaluation, compared_dimension, processing, comparison))
    }

    /// A named difference, a choice parameter that names one, or an expression.
    fn difference_phrase(&mut self, field: &Field) -> Option<(crate::syntax::phrase::Phrase, Text)> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        if let Some(word) = bare_word(&phrase) {
            let word = match self.names.parameters.get(word).map(|parameter| &parameter.value) {
                Some(Scalar::Word(choice)) => choice.clone(),
                _ => word.to_string(),
            };
            if let Some((name, expression)) = DIFFERENCES.iter().find(|(name, _)| *name == word) {
                let source = crate::source::Source::new(format!("difference `{name}`"), *expression);
                let text = Text { text: (*expression).to_string(), span: source.whole(), exact: true };
                let phrase = from_pest::expression(&text, self.problems)?;
                return Some((phrase, text));
            }
        }
        Some((phrase, field.value.clone()))
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

    /// The unit of a channel or signal if it suits, else that of SI.
    fn own_unit(&self, name: &str, dimension: Dimension) -> Unit {
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

    fn limits(&mut self, block: &Block, unit: &Unit, dimension: Dimension) -> Vec<Limit> {
        let fields: Vec<&Field> = block.fields_named("limit").collect();
        let mut names = Vec::new();
        for field in &fields {
            // A quiet first look for the names that the other limits may refer to.
            if let Some(limit) = from_pest::limit(&field.value, &mut crate::problem::Problems::default()) {
                names.push(limit.statistic.node);
            }
        }
        let mut limits = Vec::new();
        for field in fields {
            if let Some(limit) = self.limit(field, &names, unit, dimension) {
                limits.push(limit);
            }
        }
        overlap::find(&limits, &self.zone_names, block, self.problems);
        self.limit_loops(&limits);
        limits
    }

    /// `mean 2/3 of std` with `std 3/2 of mean` has no value.
    fn limit_loops(&mut self, limits: &[Limit]) {
        for limit in limits {
            let mut at = limit;
            for _ in 0..limits.len() {
                let Some(next) = referred(&at.bound).and_then(|name| limits.iter().find(|limit| limit.statistic.name() == name)) else {
                    break;
                };
                if next.span == limit.span {
                    self.problems.push(
                        Problem::error("limit-loop", "this limit depends on itself").at(&limit.span).also(&at.span, "by way of this one"),
                    );
                    return;
                }
                at = next;
            }
        }
    }

    fn limit(&mut self, field: &Field, names: &[String], unit: &Unit, dimension: Dimension) -> Option<Limit> {
        let text = &field.value;
        let written = from_pest::limit(text, self.problems)?;
        let statistic_span = text.place(written.statistic.range.clone());
        let Some(statistic) = Statistic::named(&written.statistic.node) else {
            let known: Vec<&str> = STATISTICS.iter().map(|entry| entry.name).chain(["each"]).collect();
            self.problems.push(
                Problem::error("unknown-statistic", format!("`{}` is no statistic", written.statistic.node))
                    .at(&statistic_span)
                    .suggest(&written.statistic.node, known),
            );
            return None;
        };
        let mut scope = Scope::vehicle();
        // Every value by itself, or of one zone or class, may have a limit that depends on the section.
        scope.section = statistic == Statistic::Each;
        scope.limits = Some((dimension, names.iter().filter(|name| **name != written.statistic.node).cloned().collect()));
        let bound = self.expr(&written.bound, text, &mut scope)?;
        if bound.ty != Type::Number(dimension) {
            let found = super::scalars::in_words(&bound.ty);
            self.problems.push(
                Problem::error(
                    "unit-mismatch",
                    format!("the values of `{}` are {}, the limit is {found}", names_of(field), dimension.in_words()),
                )
                .at(&bound.span)
                .label(found)
                .also(&self.of_span(field), dimension.in_words())
                .help(format!("write the limit in {unit}")),
            );
            return None;
        }
        if let Kind::Constant(Scalar::Number(value)) = bound.kind {
            if value <= 0.0 && !written.at_least {
                self.problems.push(Problem::error("out-of-range", "a limit must be above zero").at(&bound.span));
                return None;
            }
        }
        let mut factors = Vec::new();
        for (factor, condition) in &written.factors {
            let factor = self.expr(factor, text, &mut Scope::vehicle())?;
            let number = self.number_type(&factor)?;
            if number != Dimension::ONE {
                self.problems.push(
                    Problem::error("unit-mismatch", format!("a factor is a plain number, this is {}", number.in_words())).at(&factor.span),
                );
                return None;
            }
            let condition = self.expr(condition, text, &mut Scope::vehicle())?;
            self.flag_type(&condition)?;
            factors.push((factor, condition));
        }
        let only_when = match &written.only_when {
            None => None,
            Some(condition) => {
                let condition = fold(self.expr(condition, text, &mut Scope::vehicle())?);
                self.flag_type(&condition)?;
                Some(condition)
            }
        };
        let scope = self.limit_scope(&written.scope, text)?;
        Some(Limit {
            statistic,
            ddof: self.ddof,
            at_least: written.at_least,
            bound,
            factors,
            only_when,
            scope,
            words: self.with_values(&normalised(&text.text[written.statistic.range.end..])),
            span: text.span.clone(),
        })
    }

    /// The words of a limit with the values of parameters in place of their names: `2/3 of std`, not `share of std`.
    fn with_values(&self, words: &str) -> String {
        let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let mut out = String::new();
        let mut rest = words;
        while !rest.is_empty() {
            let name = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
            if name == 0 {
                let next = rest.find(is_name).unwrap_or(rest.len());
                out.push_str(&rest[..next]);
                rest = &rest[next..];
                continue;
            }
            let word = &rest[..name];
            out.push_str(self.names.parameters.get(word).map_or(word, |parameter| parameter.value_words.as_str()));
            rest = &rest[name..];
        }
        out
    }

    fn limit_scope(&mut self, scope: &At<WrittenScope>, text: &Text) -> Option<LimitScope> {
        Some(match &scope.node {
            WrittenScope::All => LimitScope::All,
            WrittenScope::EachZone => LimitScope::EachZone,
            WrittenScope::Zones(zones) => {
                for zone in zones {
                    if !self.zone_names.contains(&zone.node) {
                        let known = self.zone_names.clone();
                        self.problems.push(
                            Problem::error("unknown-zone", format!("there is no zone {}", zone.node))
                                .at(&text.place(zone.range.clone()))
                                .suggest(&zone.node, known.iter().map(String::as_str)),
                        );
                        return None;
                    }
                }
                LimitScope::Zones(zones.iter().map(|zone| zone.node.clone()).collect())
            }
            WrittenScope::Where(condition) => {
                let words = normalised(&text.text[condition.range.clone()]);
                let condition = self.expr(condition, text, &mut Scope::section())?;
                self.flag_type(&condition)?;
                LimitScope::Where(Box::new(condition), words)
            }
        })
    }

    fn of_span(&self, field: &Field) -> crate::source::Span {
        self.blocks
            .iter()
            .find(|block| block.fields.iter().any(|other| other.value.span == field.value.span))
            .and_then(|block| block.field("of"))
            .map_or_else(|| field.key.span.clone(), |of| of.value.span.clone())
    }
}

fn filter_words(chain: &[Step]) -> String {
    if chain.is_empty() { "none".into() } else { chain.iter().map(|step| step.words.as_str()).collect::<Vec<_>>().join(", then ") }
}

fn names_of(field: &Field) -> String {
    normalised(&field.value.text).split(' ').next().unwrap_or("").to_string()
}

/// The statistic whose limit an expression refers to.
fn referred(expr: &Expr) -> Option<String> {
    match &expr.kind {
        Kind::LimitOf(name) => Some(name.clone()),
        Kind::Negative(inner) | Kind::Not(inner) | Kind::Power(inner, _) => referred(inner),
        Kind::Binary(_, left, right) => referred(left).or_else(|| referred(right)),
        Kind::Call(_, arguments) => arguments.iter().find_map(referred),
        Kind::Cases(arms, otherwise) => {
            arms.iter().find_map(|(value, _)| referred(value)).or_else(|| otherwise.as_deref().and_then(referred))
        }
        _ => None,
    }
}

impl InputSide {
    pub fn resolve(self, own: Self) -> Self {
        if self == Self::Own { own } else { self }
    }
}
