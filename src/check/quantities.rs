//! Checks quantities: their fields together, and their positions.

use std::sync::Arc;

use super::{
    conditions::impossible, evaluate::is_whole, expressions::whole, groups::Grouped, prelude::*,
    steps::after,
};
use crate::catalog::NOT_CHECKED;

/// The largest number that a protocol may require.
pub const MOST_COUNTED: f64 = 1e6;

impl Checker<'_> {
    /// A quantity with its limits and reports.
    pub fn quantity(&mut self, block: &Block) -> Option<Quantity> {
        self.in_quantity = true;
        let only = block.field("where").map(|field| self.section_condition(field));
        let assumed = only.clone().flatten();
        let found = self.assuming(assumed, |checker| checker.quantity_where(block, only));
        self.in_quantity = false;
        found
    }

    /// Dimension of its values, for other quantities. Errors are reported only where the quantity
    /// itself is checked.
    pub fn values_of(&mut self, block: &Block) -> Option<(Dimension, Grouped)> {
        let problems = self.problems.0.len();
        let (assumed, partial) = (std::mem::take(&mut self.assumed), self.partial);
        if let Some(Some(only)) = block.field("where").map(|field| self.section_condition(field)) {
            self.assumed.push(only);
        }
        let chain = self.chain_of(block);
        let positions = self.positions_of_quantity(block);
        let compared = self.compared_of(block, positions.as_deref(), chain.as_deref());
        (self.assumed, self.partial) = (assumed, partial);
        self.problems.0.truncate(problems);
        let (compared, first) = (compared?, positions.as_ref()?.first()?);
        let places: Vec<String> = first.places.keys().cloned().collect();
        Some((compared.dimension, Grouped::values(block, &places, compared.sides)))
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
            self.tell(
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
            self.tell(
                error("from-and-compared", "values of one record cannot be compared", &other.key)
                    .also(&from.key, "the record")
                    .help(format!("remove `from` or `{}`", other.key.text)),
            );
        }
        let chain = self.chain_of(block);
        let positions = self.positions_of_quantity(block);
        let of = block.field("of").map(|field| field.value.clone());
        let first = positions.as_deref().and_then(<[Position]>::first);
        let places: Vec<String> =
            first.map_or_else(Vec::new, |first| first.places.keys().cloned().collect());
        let compared = self.compared_of(block, positions.as_deref(), chain.as_deref());
        let result = compared.as_ref().map(|compared| compared.dimension);
        let unit =
            result.zip(of.as_ref()).and_then(|(result, of)| self.quantity_unit(block, of, result));
        let from = compared
            .as_ref()
            .and_then(|compared| compared.from.as_ref())
            .or_else(|| of.as_ref().map(|of| &of.span));
        let best = compared.as_ref().and_then(|compared| compared.best.as_ref());
        let sides = compared.as_ref().and_then(|compared| compared.sides);
        let grouped = Grouped::values(block, &places, sides);
        let limits = self.limits(block, unit.as_ref().zip(from), best, grouped);
        let reports = self.reports(block, unit.as_ref().map(|unit| unit.dimension));
        let outcomes = self.outcomes_of(block, unit.as_ref().map(|unit| unit.dimension));
        let limits = limits.zip(outcomes.as_ref()).map(|(mut limits, (_, outcome))| {
            limits.extend(outcome.clone());
            limits
        });
        let minima = self.minima(block);
        if let (Some(reported), Some(limit)) = (block.field("reported"), block.field("limit")) {
            self.tell(
                error(
                    "reported-and-limit",
                    "a quantity is either reported without a limit, or has one",
                    &reported.key,
                )
                .also(&limit.key, "the limit"),
            );
        }
        let fields = ["reported", "report", "outcome"];
        let meant = fields.iter().any(|key| block.field(key).is_some())
            || self.is_referred_to(block.name_text());
        if block.field("limit").is_none() && !incomplete && !meant {
            self.tell(
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
            self.tell(
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
        let dimension = after(&chain, positions.first()?.signal.dimension());
        let signal = from_pest::of_places(&of, self.problems)?.signal;
        let signal_unit = self.own_unit(&signal.node, dimension);
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
        let mut notes: Vec<String> = reported.into_iter().chain(block.notes()).collect();
        let mut comparison = compared.comparison;
        for metric in &unverified {
            notes.push(format!("Unverified: `{metric}` is {NOT_CHECKED}."));
        }
        if !unverified.is_empty() {
            comparison += " (unverified)";
        }
        Some(Quantity {
            id: block.own_name(),
            title: block.title_or_name(),
            symbol: block.text("symbol").unwrap_or_else(|| block.own_name()),
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
            positions,
            chain,
            evaluation: Arc::new(compared.evaluation),
            best: compared.best.map(|(best, _)| best.value()),
            only: if_written(only)?,
            outcomes: outcomes?.0,
            limits: limits?.into_iter().map(Arc::new).collect(),
            reports: reports?.into_iter().map(Arc::new).collect(),
            minimum_signals: minimum_signals?,
            minimum_pairs: minimum_pairs?,
            minimum_of_groups: minimum_of_groups?,
            span: block.place(),
        })
    }

    /// The positions of all fields `of`. Their signals must have the same dimension and places.
    fn positions_of_quantity(&mut self, block: &Block) -> Option<Vec<Position>> {
        let mut found: Vec<Position> = Vec::new();
        let mut ok = true;
        for field in block.fields_named("of") {
            let written = from_pest::of_places(&field.value, self.problems);
            let when = written.and_then(|written| written.when);
            let only = if_written(when.map(|when| self.condition(&when, &mut Scope::section())));
            let signals =
                self.assuming(only.clone().flatten(), |checker| checker.signals_of(&field.value));
            let (Some(signals), Some(only)) = (signals, only) else {
                ok = false;
                continue;
            };
            for position in signals {
                let (name, dimension) = (&position.name, position.signal.dimension());
                if let Some(first) = found.first()
                    && first.signal.dimension() != dimension
                {
                    return self
                        .refuse(problem!("unit-mismatch", field, "the signals of one quantity must have the same dimension: another is {}",
                        first.signal.dimension().in_words()).label(dimension.in_words()));
                }
                let again =
                    |known: &Position| known.name == *name && both_apply(&known.only, &only);
                if found.iter().any(again) {
                    let help =
                        "add conditions that exclude each other to the fields `of`: `when ...`";
                    return self.refuse(
                        problem!(
                            "position-twice",
                            field,
                            "`{name}` is evaluated twice, so its values would count twice"
                        )
                        .help(help),
                    );
                }
                found.push(Position { only: only.clone(), ..position });
            }
        }
        (ok && !found.is_empty()).then_some(found)
    }

    /// Every position with its signal.
    pub fn signals_of(&mut self, of: &Text) -> Option<Vec<Position>> {
        let written = from_pest::of_places(of, self.problems)?;
        let signal = written.signal;
        let positions = self.positions(&signal, &written.picks)?;
        let declared = self.names.signals.get(&signal.node)?.clone();
        let phrase = signal.with(Node::Path(signal.node.clone()));
        let mut found: Vec<Position> = Vec::new();
        for places in positions {
            let name = self.fill(&signal.node, &declared, &signal.place(), &places)?;
            if found.iter().any(|known| known.name == name) {
                continue;
            }
            let samples = self.signal_where(&phrase, &places, &whole(of))?;
            self.of_record(&samples, &of.span)?;
            if samples.track() {
                return self.refuse(error(
                    "track-quantity",
                    "the track record has no simulated and measured side to compare",
                    &signal,
                ));
            }
            found.push(Position { name, signal: samples, places, only: None });
        }
        Some(found)
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
        let phrase = from_pest::expression(&field.value, self.problems)?;
        self.whole_number(&phrase, field)
    }

    /// A whole number that follows from constants, in a field or a part of it.
    pub fn whole_number(&mut self, phrase: &Phrase, field: &Field) -> Option<usize> {
        let (value, dimension) = self.constant_phrase(phrase)?;
        let plain = dimension == Dimension::ONE;
        if plain && is_whole(value, 0.0..=MOST_COUNTED) {
            return Some(value as usize);
        }
        let (key, words) = (&field.key.text, phrase.words());
        let evident = !plain || words.parse() == Ok(value);
        let value = if evident { String::new() } else { format!(" = {value}") };
        self.refuse(problem!(
            "not-a-count",
            field,
            "`{key}` must be a whole number, this is {words}{value}"
        ))
    }
}

/// Whether there may be sections in which both positions are evaluated.
fn both_apply(a: &Option<Expr>, b: &Option<Expr>) -> bool {
    let conditions: Vec<(&Expr, bool)> =
        a.iter().chain(b).map(|condition| (condition, true)).collect();
    !impossible(&conditions)
}

impl InputSide {
    /// The side of the input, where the expression is evaluated for the side `own`.
    pub fn resolve(self, own: Self) -> Self {
        if self == Self::Own { own } else { self }
    }
}
