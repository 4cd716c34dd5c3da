//! Checks the values of a quantity and how they are compared: what gives its rows.

use super::{
    evaluate::{number, words},
    idle::Pair,
    names::bare_word,
    prelude::*,
    records::Compare,
    steps::after,
};
use crate::catalog::{Best, DIFFERENCES};

/// The result of checking value and difference, or the metric, of a quantity.
pub struct Compared {
    pub evaluation: Evaluation,
    pub dimension: Dimension,
    /// Dimension of the two compared values, where there are any.
    pub sides: Option<Dimension>,
    pub processing: String,
    pub comparison: String,
    /// Best value and the text that decides it, where it is known.
    pub best: Option<(Best, Span)>,
    /// The text that decides the dimension, where it is not that of the signal.
    pub from: Option<Span>,
}

impl Checker<'_> {
    /// The metric, or the values, of a quantity.
    pub fn compared_of(
        &mut self,
        block: &Block,
        positions: Option<&[Position]>,
        chain: Option<&[Step]>,
    ) -> Option<Compared> {
        match block.field("metric") {
            Some(field) => self.by_metric(field, block.field("compare"), positions, chain),
            None => self.by_values(block, positions, chain.unwrap_or_default()),
        }
    }

    /// Numbers of each record, assessed or compared.
    fn by_values(
        &mut self,
        block: &Block,
        positions: Option<&[Position]>,
        chain: &[Step],
    ) -> Option<Compared> {
        let first = positions.and_then(|positions| positions.first());
        let dimension = first.map(|first| after(chain, first.signal.dimension()));
        let fields: Vec<&Field> = block.fields_named("value").collect();
        self.partial = fields.len() > 1;
        let values: Vec<Option<(Valued, Dimension)>> = fields
            .iter()
            .map(|field| {
                let phrase = from_pest::expression(&field.value, self.problems)?;
                self.valued(&phrase, field, positions?, chain, Scope::reducing)
            })
            .collect();
        self.partial = false;
        let result = values.iter().flatten().map(|(_, dimension)| *dimension).next();
        for (field, (_, other)) in
            fields.iter().zip(&values).filter_map(|(field, value)| Some((field, value.as_ref()?)))
        {
            if Some(*other) != result {
                let wanted = result.map_or_else(String::new, Dimension::in_words);
                return self.refuse(problem!("unit-mismatch", field, "the values of one quantity must have the same dimension: the first is {wanted}, this is {}",
                    other.in_words())
                        .also(fields[0], wanted));
            }
        }
        for (at, field) in fields.iter().enumerate() {
            // Fields are compared by their words.
            if let Some(first) = fields[..at].iter().find(|first| **first == *field) {
                let says = "this value is written twice and would count twice";
                return self
                    .refuse(error("value-twice", says, field).also(first, "the same value"));
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
        let values: Vec<Valued> = values.into_iter().map(|(value, _)| value).collect();
        let processing: Vec<String> =
            values.iter().map(|value| self.with_values(&words(&value.expr))).collect();
        let processing = processing.join("; ");
        let field_of = |key: &str| block.field(key).map(Field::place);
        let Some(difference) = difference else {
            let of = from??;
            let side = of.side.in_words();
            let other = match of.side {
                Side::Measured => InputSide::Simulated,
                Side::Simulated => InputSide::Measured,
            };
            let mut inputs = values.iter().flat_map(|value| value.inputs.iter().flatten());
            if let Some(input) = inputs.find(|input| input.side == other) {
                return self.refuse(problem!(
                    "record-not-read",
                    &input.span,
                    "the values are {side}; the other record is not read"
                ));
            }
            let comparison = match of.record {
                None => format!("{side} values"),
                Some(_) => format!("values of {}", self.chosen_in_words(of)),
            };
            return Some(Compared {
                evaluation: Evaluation::Values { values, records: Records::Of(of) },
                dimension: result,
                sides: None,
                processing,
                comparison,
                best: None,
                from: field_of("value").filter(|_| Some(result) != dimension),
            });
        };
        let (difference, compared) = difference?;
        let place = |key: &str| field_of(key).unwrap_or_else(|| block.place());
        self.depends_on_values(&difference, &place("difference"))?;
        self.of_both_records(&values, &difference, &place("value"))?;
        // An error in it was reported; the limits are checked all the same.
        let compare = compare.flatten().unwrap_or(Compare::Pairs(Pairing::SIDES));
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
                let mut words = comparison
                    .replace("measured", &format!("{} of {all}", center.in_words()))
                    .replace("simulated", of.side.in_words());
                if of.record.is_some() {
                    words = words.replace("simulated", self.chosen_in_words(of));
                }
                (Records::Spread { of, among, center, difference }, words)
            }
        };
        let evaluation = Evaluation::Values { values, records };
        let (dimension, sides) = (compared, Some(result));
        Some(Compared { evaluation, dimension, sides, processing, comparison, best, from })
    }

    /// An expression of values taken from the own signal and from named signals, at every position.
    pub fn valued(
        &mut self,
        phrase: &Phrase,
        field: &Field,
        positions: &[Position],
        chain: &[Step],
        scope: fn(Option<Dimension>, Dimension) -> Scope,
    ) -> Option<(Valued, Dimension)> {
        let axis = self.axis_dimension();
        let first = positions.first()?;
        let dimension = after(chain, first.signal.dimension());
        let factor = after(chain, Dimension::ONE);
        // A value at one position, in the sections in which the position is evaluated.
        let value_at = |checker: &mut Self, position: &Position| {
            let at = position.places.clone();
            let mut scope = Scope { at, factor, ..scope(Some(dimension), axis) };
            let only = position.only.clone();
            let expr = checker.assuming(only, |checker| checker.expr(phrase, &mut scope))?;
            Some((expr, scope.inputs))
        };
        let (expr, own) = value_at(self, first)?;
        let result = self.number_type(&expr)?;
        if own.is_empty() {
            return self.refuse(
                error("value-of-nothing", "this expression uses no value of the signal", field)
                    .help("for instance `median`, `rms`, `|p99.85|`"),
            );
        }
        self.can_vary(&field.key.text, &expr, &own, field)?;
        // Only named signals differ between positions.
        let alike = own.iter().all(|input| input.signal.is_none() && input.over.is_none());
        let mut inputs = vec![own];
        for position in &positions[1..] {
            inputs.push(if alike { inputs[0].clone() } else { value_at(self, position)?.1 });
        }
        Some((Valued { expr, inputs }, result))
    }

    /// A named difference, a choice parameter that names one, or an expression. If the dimension of
    /// the values is not known, only the name is checked.
    fn difference(
        &mut self,
        field: &Field,
        dimension: Option<Dimension>,
    ) -> Option<(Expr, Dimension)> {
        let mut phrase = from_pest::expression(&field.value, self.problems)?;
        if let Some(word) = bare_word(&phrase) {
            let choice = self.choice_word(word, &phrase.place())?;
            if DIFFERENCES.iter().any(|(name, _)| *name == choice) {
                phrase.node = Node::Path(choice);
            } else if choice != word
                || !(matches!(word, "simulated" | "measured")
                    || self.names.defines.contains_key(word)
                    || self.is_failed(word))
            {
                let differences = DIFFERENCES.iter().map(|(name, _)| *name);
                return self.refuse(
                    problem!(
                        "unknown-difference",
                        field,
                        "`{choice}` is not a difference of two values"
                    )
                    .suggest(&choice, differences),
                );
            }
        }
        let expr = self.expr(&phrase, &mut Scope::pair(dimension?))?;
        let dimension = self.number_type(&expr)?;
        Some((expr, dimension))
    }
}

/// The value of a comparison where both sides are equal: 0 for a difference, 1 for a ratio; `None`
/// where it depends on the value.
fn of_equal_sides(difference: &Expr) -> Option<f64> {
    /// Values of both signs, without a simple ratio.
    const TRIED: [f64; 3] = [1.0, -1.7, 2.9];
    let mut found =
        TRIED.iter().map(|&side| number(difference, &Pair { simulated: side, measured: side }));
    let first = found.next()?.ok()?;
    found.all(|other| other == Ok(first)).then_some(first)
}
