//! Parameters: values from defaults, campaign or command line; numbers that follow from constants
//! only.

use super::{Override, evaluate::words, names::ParameterDef, prelude::*};
use crate::syntax::keys::{NOT_ASSESSABLE, NOT_STATED, OPTIONAL};
use crate::units::number::significant;

/// What follows for a rule where something optional is absent, if others are assessed.
const NOT_ASSESSED: &str = "not assessed";

impl Checker<'_> {
    /// The parameter of a name. It is checked when it is first used, as its default may use
    /// parameters further down.
    pub fn parameter(&mut self, name: &str, at: &crate::source::Span) -> Option<ParameterDef> {
        if !self.names.parameters.contains_key(name) {
            let block = self.names.parameter_blocks.get(name)?.clone();
            let found =
                self.inside("parameter", name, at, |checker| checker.parameter_of(name, &block))?;
            self.names.parameters.insert(name.to_string(), found);
        }
        let found = self.names.parameters.get(name)?.clone();
        self.unconfirmed |= self.values.open(name);
        Some(found)
    }

    fn parameter_of(&mut self, name: &str, block: &Block) -> Option<ParameterDef> {
        let optional = self.optional(block)?;
        let title = block.title_text().unwrap_or_default();
        let given = self.overrides.get(name).cloned();
        if let Some(optional) = optional {
            return self.without_default(block, title, given, optional);
        }
        let default = self.required(block, "default")?;
        let default_words = normalised(&default.value.text);
        let (source, set_by) = match &given {
            Some(Override { text, set_by }) => (text.clone(), *set_by),
            None => (default.value.clone(), SetBy::Default),
        };
        let mut selects = None;
        let (value, ty) = match (block.field("at"), block.field("one of")) {
            (Some(place), _) => {
                let selected = self.selection(name, place, &default.value, &source)?;
                let words = selected.1.join(", ");
                selects = Some(selected);
                (Scalar::Word(words), Type::Word(Vec::new()))
            }
            (None, Some(choices)) => {
                if let Some(range) = block.field("range") {
                    self.tell(
                        problem!(
                            "unknown-field",
                            &range.key,
                            "`{name}` is a choice of words and cannot have a range"
                        )
                        .also(&choices.key, "the choice"),
                    );
                }
                self.choice(name, choices, &default.value, &source)?
            }
            (None, None) => {
                let value = self.constant(&default.value)?;
                if let Some(range) = block.field("range") {
                    self.within_range(name, value.0, value.1, &default.value, range);
                }
                let set = given.is_some().then_some(&source);
                self.number(name, block, (value, Some(&default.value)), set)?
            }
        };
        let value_words = normalised(&source.text);
        let range = match (block.field("range"), &ty) {
            (Some(range), Type::Number(dimension)) => {
                // What is wrong with it was told when the value was looked at.
                let told = self.problems.0.len();
                let ends = self.range_ends(name, *dimension, range, None);
                self.problems.0.truncate(told);
                ends
            }
            _ => None,
        };
        Some(ParameterDef {
            title,
            value: Ok(value),
            ty,
            value_words,
            default_words,
            set_by,
            selects,
            range,
        })
    }

    /// A parameter that has no value unless it is set: a number, and its range says what it is.
    fn without_default(
        &mut self,
        block: &Block,
        title: String,
        given: Option<Override>,
        optional: Optional,
    ) -> Option<ParameterDef> {
        let name = block.name_text();
        let choice = block.field("one of").or_else(|| block.field("at"));
        if let Some(choice) = choice {
            let says = "only a number can be an optional parameter";
            return self
                .refuse(problem!("unknown-choice", block, "{says}").also(choice, "a choice"));
        }
        let Some(range) = block.field("range") else {
            let says = format!("`{name}` has no default and no range, so its unit is not known");
            let problem = problem!("missing-field", block, "{says}");
            return self.refuse(problem.help("add a line `range 0.1 mrad to 10 mrad`"));
        };
        let (low, _) = from_pest::range(&range.value, self.problems)?;
        let (_, dimension) = self.constant_phrase(&low)?;
        let ends = self.range_ends(name, dimension, range, None)?;
        let (value, set_by) = match &given {
            None => (Err(optional), SetBy::Default),
            Some(Override { text, set_by }) => {
                // Any number of the range stands for a default.
                let (value, _) =
                    self.number(name, block, ((ends[0], dimension), None), Some(text))?;
                (Ok(value), *set_by)
            }
        };
        let value_words = given.map_or(NOT_STATED.into(), |given| normalised(&given.text.text));
        Some(ParameterDef {
            title,
            value,
            ty: Type::Number(dimension),
            value_words,
            default_words: NOT_STATED.into(),
            set_by,
            selects: None,
            range: None,
        })
    }

    /// Whether a block is of something that may be absent, and what follows then.
    pub fn optional(&mut self, block: &Block) -> Option<Option<Optional>> {
        let Some(field) = block.field(OPTIONAL) else { return Some(None) };
        if let Some(default) = block.field("default") {
            let says = "what is absent has its default or, if it is optional, no value";
            return self.refuse(
                error("duplicate-field", says, &field.key).also(&default.key, "a default"),
            );
        }
        let word = normalised(&field.value.text);
        match word.as_str() {
            NOT_ASSESSED => Some(Some(Optional::NotAssessed)),
            NOT_ASSESSABLE => Some(Some(Optional::NotAssessable)),
            _ => self.refuse(
                problem!(
                    "unknown-choice",
                    field,
                    "`{word}` is not what follows where it is absent"
                )
                .help(format!("write `{NOT_ASSESSED}` or `{NOT_ASSESSABLE}`")),
            ),
        }
    }

    fn choice(
        &mut self,
        name: &str,
        choices: &Field,
        default: &Text,
        source: &Text,
    ) -> Option<(Scalar, Type)> {
        let choices = from_pest::list(&choices.value, self.problems)?;
        let choices: Vec<String> = choices.into_iter().map(|choice| choice.node).collect();
        let words = all([default, source].map(|text| {
            let word = text.text.trim();
            if choices.iter().any(|choice| choice == word) {
                return Some(word);
            }
            self.refuse(
                problem!("unknown-choice", text, "`{word}` is not one of the choices of `{name}`")
                    .suggest(word, &choices),
            )
        }))?;
        Some((Scalar::Word(words.last()?.to_string()), Type::Word(choices)))
    }

    /// Positions of a place: checks the default and the given value.
    fn selection(
        &mut self,
        name: &str,
        place: &Field,
        default: &Text,
        source: &Text,
    ) -> Option<(String, Vec<String>)> {
        let written = normalised(&place.value.text);
        let Some(place_name) = self.place_called(&written) else {
            return self.refuse(
                problem!("unknown-place", place, "`{written}` is not a place")
                    .suggest(&written, self.names.places.keys()),
            );
        };
        let members = self.names.places.get(&place_name)?.members.clone();
        let mut positions = |text: &Text| {
            let mut positions: Vec<String> = Vec::new();
            for word in from_pest::list(text, self.problems)? {
                if !members.contains(&word.node) {
                    let problem = problem!(
                        "unknown-place",
                        &word,
                        "`{}` is not a position of `{place_name}`; `{name}` selects such positions",
                        word.node
                    );
                    return self.refuse(problem.suggest(&word.node, &members));
                }
                if !positions.contains(&word.node) {
                    positions.push(word.node);
                }
            }
            Some(positions)
        };
        let by_default = positions(default)?;
        // As of a number outside its range: the rules are checked on with the default.
        let chosen = positions(source).unwrap_or(by_default);
        Some((place_name, chosen))
    }

    /// The value that is set, or else the default, whose text is given if it has one.
    fn number(
        &mut self,
        name: &str,
        block: &Block,
        ((default_value, dimension), default): ((f64, Dimension), Option<&Text>),
        given: Option<&Text>,
    ) -> Option<(Scalar, Type)> {
        let as_default = Some((Scalar::Number(default_value), Type::Number(dimension)));
        let Some(text) = given else { return as_default };
        let (value, found) = self.constant(text)?;
        if found != dimension {
            let help = default.filter(|_| found == Dimension::ONE).map(|default| {
                format!("write its unit, as its default does: `{}`", default.text.trim())
            });
            return self.refuse(
                problem!(
                    "unit-mismatch",
                    text,
                    "parameter `{name}` is {}, the given value is {}",
                    dimension.in_words(),
                    found.in_words()
                )
                .label(found.in_words())
                .also_if(default, "its default")
                .help_if(help),
            );
        }
        match block.field("range") {
            // The rules are checked on with the default: what would follow from a wrong value is
            // not told.
            Some(range) if !self.within_range(name, value, dimension, text, range) => as_default,
            _ => Some((Scalar::Number(value), Type::Number(dimension))),
        }
    }

    /// Whether a value is inside a range; a problem if it is not, or if the range itself is wrong.
    pub fn within_range(
        &mut self,
        name: &str,
        value: f64,
        dimension: Dimension,
        source: &Text,
        range: &Field,
    ) -> bool {
        let Some(ends) = self.range_ends(name, dimension, range, Some(source)) else {
            return false;
        };
        let inside = (ends[0]..=ends[1]).contains(&value);
        if !inside {
            self.tell(
                problem!(
                    "out-of-range",
                    source,
                    "`{}` is outside the range of `{name}`",
                    normalised(&source.text)
                )
                .also(range, "the range")
                .help(format!("allowed: {}", normalised(&range.value.text))),
            );
        }
        inside
    }

    /// Both ends of a range in SI. They must have the dimension of the value that the range is of.
    pub fn range_ends(
        &mut self,
        name: &str,
        dimension: Dimension,
        range: &Field,
        of_value: Option<&Text>,
    ) -> Option<[f64; 2]> {
        let (low, high) = from_pest::range(&range.value, self.problems)?;
        let mut ends = [0.0; 2];
        for (end, phrase) in ends.iter_mut().zip([low, high]) {
            let (found, of) = self.constant_phrase(&phrase)?;
            if of != dimension {
                let problem = problem!(
                    "unit-mismatch",
                    &phrase,
                    "`{name}` is {}, its range is {}",
                    dimension.in_words(),
                    of.in_words()
                )
                .label(of.in_words());
                return self.refuse(problem.also_if(of_value, dimension.in_words()));
            }
            *end = found;
        }
        Some(ends)
    }

    /// A number that follows from constants only, with its dimension.
    pub fn constant(&mut self, text: &Text) -> Option<(f64, Dimension)> {
        let phrase = from_pest::expression(text, self.problems)?;
        self.constant_phrase(&phrase)
    }

    /// A constant of this dimension, which `needed` says.
    pub fn constant_of(
        &mut self,
        what: &str,
        dimension: Dimension,
        needed: &str,
        written: &Phrase,
    ) -> Option<f64> {
        let (value, found) = self.constant_phrase(written)?;
        self.suits(what, found == dimension, needed, found, &written.place())?;
        Some(value)
    }

    /// As [`Self::constant`], for a part of a field.
    pub fn constant_phrase(&mut self, phrase: &Phrase) -> Option<(f64, Dimension)> {
        let expr = self.expr(phrase, &mut Scope::constant())?;
        let dimension = self.number_type(&expr)?;
        if let Kind::Constant(Scalar::Number(value)) = expr.kind {
            return Some((value, dimension));
        }
        self.refuse(
            problem!("not-constant", &expr, "`{}` is not a constant", words(&expr))
                .help("write a number with its unit, a parameter or an expression of these"),
        )
    }

    /// A percentile by a constant, as one by its number: `percentile level` with 95 % as `p95`.
    pub fn with_percentile(&mut self, phrase: &Phrase) -> Option<Phrase> {
        let Node::PercentileBy(of) = &phrase.node else { return Some(phrase.clone()) };
        let share = self.constant_of("percentile", Dimension::ONE, "a share", of)?;
        if (0.0..=1.0).contains(&share) {
            // As it is written: 99.85 % and not what its share becomes by rounding.
            return Some(phrase.with(Node::Percentile(significant(100.0 * share, 12))));
        }
        let says = "a percentile must be from 0 % to 100 %";
        let problem = error("out-of-range", says, &**of).also_if(self.set_at(of), "its value");
        self.refuse(problem.help("write it as a percentage: `99.85 %`"))
    }

    /// Where the value of a parameter is set, if the phrase is one.
    pub fn set_at(&self, phrase: &Phrase) -> Option<Span> {
        let Node::Path(name) = &phrase.node else { return None };
        let block = self.names.parameter_blocks.get(name)?;
        let given = self.overrides.get(name).map(|given| given.text.span.clone());
        given.or_else(|| block.field("default").map(Located::place))
    }

    /// An expression in which a percentile by a constant stands first: `percentile level of Q`.
    pub fn by_percentile(&mut self, phrase: &Phrase, scope: &mut Scope) -> Option<Expr> {
        let mut found = |of: &Phrase| self.with_percentile(of).map(Box::new);
        let node = match &phrase.node {
            Node::Reduced(by, of) => Node::Reduced(found(by)?, of.clone()),
            Node::Weighted(of, by) => Node::Weighted(found(of)?, by.clone()),
            _ => found(phrase)?.node,
        };
        self.expr(&phrase.with(node), scope)
    }
}
