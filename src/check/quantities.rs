//! Checks quantities: positions, filter, value, difference or metric, limits.

use std::sync::Arc;

use super::conditions::impossible;
use super::evaluate::{number, words};
use super::expressions::whole;
use super::names::{Assignment, bare_word, normalised};
use super::plan::{
    Evaluation, Expr, InputSide, Pairing, Position, Quantity, QuantityWords, Records, Side, Step,
    Valued,
};
use super::records::Compare;
use super::scope::Scope;
use super::steps::after;
use super::values::Values;
use super::{Checker, if_written};
use crate::catalog::{Best, DIFFERENCES, NOT_CHECKED};
use crate::problem::{error, warning};
use crate::result::Reason;
use crate::source::Span;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::phrase::{Node, Phrase};
use crate::units::Dimension;

/// The result of checking value and difference, or the metric, of a quantity.
pub struct Compared {
    pub evaluation: Evaluation,
    pub dimension: Dimension,
    pub processing: String,
    pub comparison: String,
    /// Best value and the text that decides it, where it is known.
    pub best: Option<(Best, Span)>,
    /// The text that decides the dimension, where it is not that of the signal.
    pub from: Option<Span>,
}

impl Checker<'_> {
    /// A quantity with its limits and reports.
    pub fn quantity(&mut self, block: &Block) -> Option<Quantity> {
        self.in_quantity = true;
        let only = block.field("where").map(|field| self.section_condition(field));
        self.assumed.extend(only.clone().flatten());
        let found = self.quantity_where(block, only);
        self.assumed.clear();
        self.in_quantity = false;
        found
    }

    /// Dimension of its values, for other quantities. Errors are reported only where the quantity
    /// itself is checked.
    pub fn dimension_of(&mut self, block: &Block) -> Option<Dimension> {
        let problems = self.problems.0.len();
        let (assumed, partial) = (std::mem::take(&mut self.assumed), self.partial);
        if let Some(Some(only)) = block.field("where").map(|field| self.section_condition(field)) {
            self.assumed.push(only);
        }
        let chain =
            block.field("filter").map_or(Some(Vec::new()), |field| self.chain(&field.value));
        let positions = self.positions_of_quantity(block);
        let compared = self.compared_of(block, positions.as_deref(), chain.as_deref());
        (self.assumed, self.partial) = (assumed, partial);
        self.problems.0.truncate(problems);
        compared.map(|compared| compared.dimension)
    }

    fn compared_of(
        &mut self,
        block: &Block,
        positions: Option<&[(Position, Assignment)]>,
        chain: Option<&[Step]>,
    ) -> Option<Compared> {
        match block.field("metric") {
            Some(field) => self.by_metric(field, block.field("compare"), positions, chain),
            None => self.by_values(block, positions, chain.unwrap_or_default()),
        }
    }

    /// Checks all fields even after an error, so that an author sees all errors in one run.
    fn quantity_where(&mut self, block: &Block, only: Option<Option<Expr>>) -> Option<Quantity> {
        let metric = block.field("metric");
        let assessed = block.field("from");
        let needed: &[&str] = match (metric, assessed) {
            (Some(_), _) => &["of"],
            (None, Some(_)) => &["of", "value"],
            (None, None) => &["of", "value", "difference"],
        };
        // What it should be like was not found, as was told: its other fields may be there.
        let incomplete = block.field("like").is_some();
        if !incomplete {
            self.all_required(block, needed);
        }
        if let (Some(metric), Some(other)) =
            (metric, block.field("value").or(block.field("difference")))
        {
            self.problems.push(
                error(
                    "metric-and-value",
                    "a quantity has either `metric`, or `value` and `difference`",
                    &other.key,
                )
                .also(&metric.key, "the metric"),
            );
        }
        if let (Some(from), Some(other)) =
            (assessed, block.field("difference").or(metric).or(block.field("compare")))
        {
            self.problems.push(
                error("from-and-compared", "values of one record cannot be compared", &other.key)
                    .also(&from.key, "the record")
                    .help(format!("remove `from` or `{}`", other.key.text)),
            );
        }
        let chain =
            block.field("filter").map_or(Some(Vec::new()), |field| self.chain(&field.value));
        let positions = self.positions_of_quantity(block);
        let of = block.field("of").map(|field| field.value.clone());
        let dimension = positions
            .as_ref()
            .and_then(|positions| positions.first())
            .map(|(position, _)| position.signal.dimension());
        let dimension =
            dimension.map(|dimension| after(chain.as_deref().unwrap_or_default(), dimension));
        let compared = self.compared_of(block, positions.as_deref(), chain.as_deref());
        let result = compared.as_ref().map(|compared| compared.dimension);
        let unit =
            result.zip(of.as_ref()).and_then(|(result, of)| self.quantity_unit(block, of, result));
        let from = compared
            .as_ref()
            .and_then(|compared| compared.from.as_ref())
            .or_else(|| of.as_ref().map(|of| &of.span));
        let best = compared.as_ref().and_then(|compared| compared.best.as_ref());
        let places: Vec<String> = positions
            .iter()
            .flatten()
            .next()
            .map_or_else(Vec::new, |(_, at)| at.keys().cloned().collect());
        let limits = self.limits(block, unit.as_ref().zip(from), best, &places);
        let reports = self.reports(block, unit.as_ref().map(|unit| unit.dimension), &places);
        let minima = self.minima(block);
        if let (Some(reported), Some(limit)) = (block.field("reported"), block.field("limit")) {
            self.problems.push(
                error(
                    "reported-and-limit",
                    "a quantity is either reported without a limit, or has one",
                    &reported.key,
                )
                .also(&limit.key, "the limit"),
            );
        }
        let meant = block.field("reported").or(block.field("report")).is_some()
            || self.is_referred_to(block.name_text());
        if block.field("limit").is_none() && !incomplete && !meant {
            self.problems.push(
                warning(
                    "no-limit",
                    format!(
                        "quantity `{}` has no limit: it is reported and has no effect on a verdict",
                        block.name_text()
                    ),
                    block,
                )
                .help("if that is meant, say why: `reported \"...\"`"),
            );
        }
        if let (Some(only), None, 2..) = (block.field("where"), minima.all, self.minimum_pairs) {
            self.problems.push(
                warning(
                    "minimum-inherited",
                    format!(
                        "quantity `{}` uses only some of the sections but needs {} pairs",
                        block.name_text(),
                        self.minimum_pairs
                    ),
                    only,
                )
                .help("state the number for this quantity: `minimum pairs ...`"),
            );
        }
        let minimum_signals = self.count(block, "minimum signals", self.minimum_signals);
        let minimum_pairs = minima.all.unwrap_or(Some(self.minimum_pairs));
        let of_groups = if minima.of_groups.is_empty() {
            self.minimum_of_groups.clone()
        } else {
            minima.of_groups
        };
        let minimum_of_groups = self.minimum_of_groups(&of_groups, block, &places);
        let (of, chain, positions, compared, unit) = (of?, chain?, positions?, compared?, unit?);
        let dimension = dimension?;
        let signal_unit = from_pest::of_places(&of, self.problems)
            .map(|written| self.own_unit(&written.signal.node, dimension))?;
        let all: Vec<String> = block
            .fields_named("of")
            .map(|field| self.with_values(&normalised(&field.value.text)))
            .collect();
        let filter = if chain.is_empty() {
            "none".into()
        } else {
            chain.iter().map(|step| step.words.as_str()).collect::<Vec<_>>().join(", then ")
        };
        let unverified = compared.evaluation.unverified();
        let reported = block.text("reported").map(|why| format!("Reported without a limit. {why}"));
        let notes = reported.into_iter().chain(block.notes());
        let notes = notes
            .chain(
                unverified.iter().map(|metric| format!("Unverified: `{metric}` is {NOT_CHECKED}.")),
            )
            .collect();
        let comparison = if unverified.is_empty() {
            compared.comparison
        } else {
            format!("{} (unverified)", compared.comparison)
        };
        Some(Quantity {
            id: block.name_text().to_string(),
            title: block.title_text().unwrap_or_else(|| block.name_text().to_string()),
            symbol: block.text("symbol").unwrap_or_else(|| block.name_text().to_string()),
            words: QuantityWords {
                of: all.join("; "),
                filter,
                processing: compared.processing,
                comparison,
            },
            clause: block.text("clause"),
            source: block.text("source"),
            notes,
            unit,
            signal_unit,
            positions: positions.into_iter().map(|(position, _)| position).collect(),
            chain,
            evaluation: Arc::new(compared.evaluation),
            only: if_written(only)?,
            limits: limits?.into_iter().map(Arc::new).collect(),
            reports: reports?.into_iter().map(Arc::new).collect(),
            minimum_signals: minimum_signals?,
            minimum_pairs: minimum_pairs?,
            minimum_of_groups: minimum_of_groups?,
            span: block.span().clone(),
        })
    }

    /// The positions of all fields `of`. Their signals must have the same dimension and places.
    fn positions_of_quantity(&mut self, block: &Block) -> Option<Vec<(Position, Assignment)>> {
        let mut found: Vec<(Position, Assignment)> = Vec::new();
        let mut ok = true;
        for field in block.fields_named("of") {
            let written = from_pest::of_places(&field.value, self.problems);
            let when = written.and_then(|written| written.when);
            let only = when.as_ref().map(|when| self.condition(when, &mut Scope::section()));
            let only = if_written(only);
            let known = self.assumed.len();
            self.assumed.extend(only.clone().flatten());
            let signals = self.signals_of(&field.value);
            self.assumed.truncate(known);
            let (Some(signals), Some(only)) = (signals, only) else {
                ok = false;
                continue;
            };
            for (name, signal, at) in signals {
                if let Some((first, _)) = found.first()
                    && first.signal.dimension() != signal.dimension()
                {
                    return self.refuse(error("unit-mismatch", format!(
                        "the signals of one quantity must have the same dimension: another is {}",
                        first.signal.dimension().in_words()
                    ), field)
                            .label(signal.dimension().in_words()));
                }
                let again = found
                    .iter()
                    .find(|(known, _)| known.name == name && both_apply(&known.only, &only));
                if again.is_some() {
                    return self.refuse(
                        error(
                            "position-twice",
                            format!("`{name}` is evaluated twice, so its values would count twice"),
                            field,
                        )
                        .help(
                            "add conditions that exclude each other to the fields `of`: `when ...`",
                        ),
                    );
                }
                let places =
                    at.iter().map(|(place, member)| (place.clone(), member.clone())).collect();
                found.push((Position { name, signal, places, only: only.clone() }, at));
            }
        }
        (ok && !found.is_empty()).then_some(found)
    }

    /// Every position with its name, signal and assignment.
    pub fn signals_of(&mut self, of: &Text) -> Option<Vec<(String, Expr, Assignment)>> {
        let written = from_pest::of_places(of, self.problems)?;
        let positions = self.positions(&written.signal, &written.picks)?;
        let name = &written.signal.node;
        let (pattern, places, span) =
            match (self.names.channels.get(name), self.names.signals.get(name)) {
                (Some(channel), _) => {
                    (channel.column.clone(), channel.places.clone(), channel.span.clone())
                }
                (_, Some(signal)) => {
                    (signal.named.clone(), signal.places.clone(), signal.span.clone())
                }
                _ => return None,
            };
        let phrase = written.signal.with(Node::Path(name.clone()));
        let used = written.signal.place();
        let mut found: Vec<(String, Expr, Assignment)> = Vec::new();
        for position in positions {
            let filled = self.fill(name, &pattern, &places, &span, &used, &position)?;
            if found.iter().any(|(known, _, _)| *known == filled) {
                continue;
            }
            let signal = self.signal_where(&phrase, &position, &whole(of))?;
            if signal.track() {
                return self.refuse(error(
                    "track-quantity",
                    "the track record has no simulated and measured side to compare",
                    &used,
                ));
            }
            found.push((filled, signal, position));
        }
        Some(found)
    }

    /// Numbers of each record, assessed or compared.
    fn by_values(
        &mut self,
        block: &Block,
        positions: Option<&[(Position, Assignment)]>,
        chain: &[Step],
    ) -> Option<Compared> {
        let first = positions.and_then(|positions| positions.first());
        let dimension = first.map(|(position, _)| after(chain, position.signal.dimension()));
        let fields: Vec<&Field> = block.fields_named("value").collect();
        self.partial = fields.len() > 1;
        let values: Vec<Option<(Valued, Dimension)>> =
            fields.iter().map(|field| self.value(field, positions, chain)).collect();
        self.partial = false;
        let result = values.iter().flatten().map(|(_, dimension)| *dimension).next();
        for (field, (_, other)) in
            fields.iter().zip(&values).filter_map(|(field, value)| Some((field, value.as_ref()?)))
        {
            if Some(*other) != result {
                let wanted = result.map_or_else(String::new, Dimension::in_words);
                return self.refuse(error("unit-mismatch", format!(
                    "the values of one quantity must have the same dimension: the first is {wanted}, this is {}",
                    other.in_words()
                ), field)
                        .also(fields[0], wanted));
            }
        }
        for (at, field) in fields.iter().enumerate() {
            if let Some(first) = fields[..at]
                .iter()
                .find(|first| normalised(&first.value.text) == normalised(&field.value.text))
            {
                return self.refuse(
                    error(
                        "value-twice",
                        "this value is written twice and would count twice",
                        field,
                    )
                    .also(first, "the same value"),
                );
            }
        }
        let from = block.field("from").map(|field| self.from(field));
        let compare = block.field("compare").map(|field| self.compare(field));
        let difference = match from {
            Some(_) => None,
            None => {
                Some(block.field("difference").and_then(|field| self.difference(field, result)))
            }
        };
        let values: Vec<(Valued, Dimension)> = values.into_iter().collect::<Option<_>>()?;
        let result = result?;
        let processing = values
            .iter()
            .map(|(value, _)| self.with_values(&words(&value.expr)))
            .collect::<Vec<_>>()
            .join("; ");
        let values: Vec<Valued> = values.into_iter().map(|(value, _)| value).collect();
        let field_of = |key: &str| block.field(key).map(|field| field.value.span.clone());
        let Some(difference) = difference else {
            let of = from??;
            let side = of.side;
            let other =
                if side == Side::Measured { InputSide::Simulated } else { InputSide::Measured };
            if let Some(input) = values
                .iter()
                .flat_map(|value| value.inputs.iter().flatten())
                .find(|input| input.side == other)
            {
                return self.refuse(error(
                    "record-not-read",
                    format!("the values are {}; the other record is not read", side.in_words()),
                    &input.span,
                ));
            }
            let from = field_of("value").filter(|_| Some(result) != dimension);
            let evaluation = Evaluation::Values { values, records: Records::Of(of) };
            let comparison = match of.record {
                None => format!("{} values", side.in_words()),
                Some(_) => format!("values of {}", self.chosen_in_words(of)),
            };
            return Some(Compared {
                evaluation,
                dimension: result,
                processing,
                comparison,
                best: None,
                from,
            });
        };
        let (difference, compared) = difference?;
        let place = |key: &str| {
            block.field(key).map_or_else(|| block.span().clone(), |field| field.value.span.clone())
        };
        self.depends_on_values(&difference, &place("difference"))?;
        self.of_both_records(&values, &difference, &place("value"))?;
        let compare = match compare {
            // An error in it was reported; the limits are checked all the same.
            Some(compare) => compare.unwrap_or(Compare::Pairs(Pairing::SIDES)),
            None => Compare::Pairs(Pairing::SIDES),
        };
        let comparison = self.with_values(&words(&difference));
        let key = if compared != result { "difference" } else { "value" };
        let from = field_of(key).filter(|_| Some(compared) != dimension);
        let best = of_equal_sides(&difference).map(Best::Near).zip(field_of("difference"));
        let (records, comparison) = match compare {
            Compare::Pairs(pairing) => {
                let comparison = self.paired_words(pairing, &comparison);
                (Records::Compared { pairing, difference }, comparison)
            }
            Compare::With(of, among, center) => {
                let all = if among.record.is_some() { self.chosen_in_words(among) } else { "all" };
                let words = comparison
                    .replace("measured", &format!("{} of {all}", center.in_words()))
                    .replace("simulated", of.side.in_words());
                let words = if of.record.is_some() {
                    words.replace("simulated", self.chosen_in_words(of))
                } else {
                    words
                };
                (Records::Spread { of, among, center, difference }, words)
            }
        };
        let evaluation = Evaluation::Values { values, records };
        Some(Compared { evaluation, dimension: compared, processing, comparison, best, from })
    }

    fn value(
        &mut self,
        field: &Field,
        positions: Option<&[(Position, Assignment)]>,
        chain: &[Step],
    ) -> Option<(Valued, Dimension)> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        self.valued(&phrase, field, positions?, chain, Scope::reducing)
    }

    /// An expression of values taken from the own signal and from named signals, at every position.
    pub fn valued(
        &mut self,
        phrase: &Phrase,
        field: &Field,
        positions: &[(Position, Assignment)],
        chain: &[Step],
        scope: fn(Option<Dimension>, Dimension) -> Scope,
    ) -> Option<(Valued, Dimension)> {
        let axis = self.axis_dimension();
        let (first, at) = positions.first()?;
        let dimension = after(chain, first.signal.dimension());
        let factor = after(chain, Dimension::ONE);
        let scope_at =
            |at: &Assignment| Scope { at: at.clone(), factor, ..scope(Some(dimension), axis) };
        let mut scope = scope_at(at);
        let expr = self.value_at(phrase, &first.only, &mut scope)?;
        let result = self.number_type(&expr)?;
        if scope.inputs.is_empty() {
            return self.refuse(
                error("value-of-nothing", "this expression uses no value of the signal", field)
                    .help("for instance `median`, `rms`, `|p99.85|`"),
            );
        }
        self.can_vary(&field.key.text, &expr, &scope.inputs, &field.value.span)?;
        let mut inputs = vec![scope.inputs];
        for (position, at) in &positions[1..] {
            // Only named signals differ between positions.
            if inputs[0].iter().all(|input| input.signal.is_none() && input.over.is_none()) {
                inputs.push(inputs[0].clone());
                continue;
            }
            let mut scope = scope_at(at);
            self.value_at(phrase, &position.only, &mut scope)?;
            inputs.push(scope.inputs);
        }
        Some((Valued { expr, inputs }, result))
    }

    /// A value at one position, in the sections in which the position is evaluated.
    fn value_at(
        &mut self,
        phrase: &Phrase,
        only: &Option<Expr>,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let known = self.assumed.len();
        self.assumed.extend(only.clone());
        let found = self.expr(phrase, scope);
        self.assumed.truncate(known);
        found
    }

    /// A named difference, a choice parameter that names one, or an expression. If the dimension of
    /// the values is not known, only the name is checked.
    fn difference(
        &mut self,
        field: &Field,
        dimension: Option<Dimension>,
    ) -> Option<(Expr, Dimension)> {
        let written = from_pest::expression(&field.value, self.problems)?;
        let mut phrase = written.clone();
        if let Some(word) = bare_word(&written) {
            let choice = self.choice_phrase(&written)?;
            if let Some((name, expression)) = DIFFERENCES.iter().find(|(name, _)| *name == choice) {
                let source =
                    crate::source::Source::new(format!("difference `{name}`"), *expression);
                let text =
                    Text { text: (*expression).to_string(), span: source.whole(), exact: true };
                phrase = from_pest::expression(&text, self.problems)?;
            } else if choice != word
                || !(matches!(word, "simulated" | "measured")
                    || self.names.defines.contains_key(word)
                    || self.is_failed(word))
            {
                let differences = DIFFERENCES.iter().map(|(name, _)| *name);
                return self.refuse(
                    error(
                        "unknown-difference",
                        format!("`{choice}` is not a difference of two values"),
                        field,
                    )
                    .suggest(&choice, differences),
                );
            }
        }
        let expr = self.expr(&phrase, &mut Scope::pair(dimension?))?;
        let dimension = self.number_type(&expr)?;
        Some((expr, dimension))
    }

    /// A field with a condition on the section.
    pub fn section_condition(&mut self, field: &Field) -> Option<Expr> {
        let condition = self.expression(&field.value, &mut Scope::section())?;
        self.flag_type(&condition)?;
        Some(condition)
    }

    /// A whole number that follows from constants.
    pub fn count(&mut self, block: &Block, key: &str, default: usize) -> Option<usize> {
        let Some(field) = block.field(key) else { return Some(default) };
        let (value, dimension) = self.constant(&field.value)?;
        if dimension != Dimension::ONE || value.fract() != 0.0 || !(0.0..=1e6).contains(&value) {
            self.no_count(
                key,
                &normalised(&field.value.text),
                (value, dimension),
                &field.value.span,
            );
            return None;
        }
        Some(value as usize)
    }

    /// `words` are no whole number: their value is told.
    pub fn no_count(
        &mut self,
        key: &str,
        words: &str,
        (value, dimension): (f64, Dimension),
        at: &Span,
    ) {
        let evident = dimension != Dimension::ONE || words.parse() == Ok(value);
        let value = if evident { String::new() } else { format!(" = {value}") };
        self.problems.push(error(
            "not-a-count",
            format!("`{key}` must be a whole number, this is {words}{value}"),
            at,
        ));
    }
}

/// Whether there may be sections in which both positions are evaluated.
fn both_apply(a: &Option<Expr>, b: &Option<Expr>) -> bool {
    let conditions: Vec<(&Expr, bool)> =
        a.iter().chain(b).map(|condition| (condition, true)).collect();
    !impossible(&conditions)
}

/// The value of a comparison where both sides are equal: 0 for a difference, 1 for a ratio; `None`
/// where it depends on the value.
fn of_equal_sides(difference: &Expr) -> Option<f64> {
    /// Values of both signs, without a simple ratio.
    const TRIED: [f64; 3] = [1.0, -1.7, 2.9];
    let mut found = TRIED.iter().map(|&side| number(difference, &Alike(side)));
    let first = found.next()?.ok()?;
    found.all(|other| other == Ok(first)).then_some(first)
}

/// Both sides of a pair have this value; nothing else is known.
struct Alike(f64);

impl Values for Alike {
    fn sides(&self) -> Result<(f64, f64), Reason> {
        Ok((self.0, self.0))
    }
}

impl InputSide {
    /// The side of the input, where the expression is evaluated for the side `own`.
    pub fn resolve(self, own: Self) -> Self {
        if self == Self::Own { own } else { self }
    }
}
