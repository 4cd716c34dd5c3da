//! Checks wordings of the registry, of steps and metrics: their words, slots and options.

use super::prelude::*;
use crate::catalog::{Form, FormPart, METRICS, REDUCERS, Reducer};
use crate::problem::nearest;
use crate::syntax::phrase::{Item, Step as Written};

/// Smallest extent of a window or grid, in m or s. Smaller ones are mistakes: no record has so many
/// samples.
const SMALLEST_EXTENT: f64 = 1e-6;

/// The values of the slots and options of a wording.
#[derive(Debug, Default)]
pub struct Filled {
    pub numbers: Vec<(f64, Dimension, Span)>,
    /// The value of a sliding window.
    pub reducer: Option<Reducer>,
    /// In the order of the wording; `None` where an option is not stated and has no default.
    pub options: Vec<Option<(f64, Dimension)>>,
    pub choices: Vec<&'static str>,
    /// Where each option is stated, to report one that is stated twice.
    said: Vec<(&'static str, Span)>,
}

impl Filled {
    fn option_said(&mut self, name: &'static str, place: &Span) -> Result<(), Problem> {
        if let Some((_, first)) = self.said.iter().find(|(said, _)| *said == name) {
            return Err(problem!("duplicate-option", place, "`{name}` is stated twice")
                .also(first, "the first"));
        }
        self.said.push((name, place.clone()));
        Ok(())
    }
}

impl Checker<'_> {
    /// Where no wording fits, words that are choice parameters are replaced by their values.
    pub fn with_choices<'f>(
        &mut self,
        mut step: Written,
        mut forms: impl Iterator<Item = &'f Form>,
    ) -> Written {
        let Some(items) = step.parts.first_mut() else { return step };
        if forms.any(|form| fits(form, items)) {
            return step;
        }
        for item in items {
            if let Item::Word(word) = &item.node
                && let Some(choice) = self.choice_word(word, &item.place())
            {
                item.node = Item::Word(choice);
            }
        }
        step
    }

    /// The wording that fits the words.
    pub fn find_form<'f>(
        &mut self,
        step: &Written,
        span: &Span,
        what: &'static str,
        forms: impl Iterator<Item = &'f Form> + Clone,
    ) -> Option<usize> {
        let all = forms.clone();
        let items: &[At<Item>] = step.parts.first().map_or(&[], Vec::as_slice);
        if let Some(index) = forms.clone().position(|form| fits(form, items)) {
            return Some(index);
        }
        let said: Vec<&str> = items.iter().filter_map(|item| item.node.word()).collect();
        let heads: Vec<&str> = forms.clone().filter_map(Form::first_word).collect();
        // `low pass` for `low-pass`.
        let joined = said.iter().take(2).copied().collect::<Vec<_>>().join("-");
        let first = if heads.contains(&joined.as_str()) {
            joined.as_str()
        } else {
            said.first().copied().unwrap_or("")
        };
        let wordings: Vec<String> = forms
            .filter(|form| {
                let near = || nearest(first, heads.iter().copied());
                form.first_word().is_some_and(|word| word == first || near() == Some(word))
            })
            .map(|form| format!("`{}`", form.in_words()))
            .collect();
        let code = if what == "metric" { "unknown-metric" } else { "unknown-step" };
        let problem = error(code, format!("these words are not a known {what}"), span);
        let help = if wordings.is_empty() {
            let filters = self.names.filters.keys().filter(|_| what == "step").cloned();
            let known: Vec<String> = all.map(Form::in_words).chain(filters).collect();
            format!("known here: {}", known.join(", "))
        } else {
            format!("the wording is {}", wordings.join(" or "))
        };
        self.refuse(problem.help(help))
    }

    /// The values of the slots and options of a wording; a problem where one does not suit.
    pub fn fill_form(&mut self, form: &Form, step: &Written, span: &Span) -> Option<Filled> {
        let mut filled = Filled {
            options: form
                .numbers
                .iter()
                .map(|option| Some((option.default?, Dimension::ONE)))
                .collect(),
            choices: form.choices.iter().map(|choice| choice.words[0]).collect(),
            ..Filled::default()
        };
        let items = step.parts.first()?;
        for (part, item) in form.head.iter().zip(items) {
            if matches!(part, FormPart::Word(_) | FormPart::Signal(_)) {
                continue;
            }
            let place = item.place();
            if let FormPart::Reducer(_) = part {
                filled.reducer = Some(self.windowed(item)?);
                continue;
            }
            if let (FormPart::ExtentOrSample(_), Some("sample")) = (part, item.node.word()) {
                continue;
            }
            let (value, found) = self.constant_phrase(&item_phrase(item))?;
            match part {
                FormPart::Word(_) | FormPart::Signal(_) | FormPart::Reducer(_) => {}
                FormPart::Number(name, dimension) => {
                    self.suits(name, found == *dimension, &dimension.in_words(), found, &place)?;
                }
                FormPart::Extent(name) | FormPart::ExtentOrSample(name) => {
                    let extent = matches!(found, Dimension::LENGTH | Dimension::TIME);
                    self.suits(name, extent, "a length or a time", found, &place)?;
                    self.positive(name, value, &place)?;
                    if value < SMALLEST_EXTENT {
                        let unit = if found == Dimension::TIME { "µs" } else { "µm" };
                        return self.refuse(problem!(
                            "out-of-range",
                            &place,
                            "the {name} is below 1 {unit}, finer than the samples of a record"
                        ));
                    }
                }
                FormPart::Frequency(name) | FormPart::FrequencyOrZero(name) => {
                    let frequency = matches!(found, Dimension::FREQUENCY | Dimension::PER_LENGTH);
                    self.suits(name, frequency, "a frequency", found, &place)?;
                    if !matches!(part, FormPart::FrequencyOrZero(_)) || value != 0.0 {
                        self.positive(name, value, &place)?;
                    }
                }
            }
            filled.numbers.push((value, found, place));
        }
        for part in &step.parts[1..] {
            self.option(form, part, span, &mut filled)?;
        }
        Some(filled)
    }

    /// The value of a sliding window, also by a choice.
    fn windowed(&mut self, item: &At<Item>) -> Option<Reducer> {
        let phrase = match item.node.word() {
            Some(word) => {
                let word = self.choice_word(word, &item.place())?;
                let percent = word.strip_prefix('p').and_then(|percent| percent.parse().ok());
                item.with(percent.map_or(Node::Path(word), Node::Percentile))
            }
            None => item_phrase(item),
        };
        if let Node::Path(word) = &phrase.node
            && Reducer::named(word).is_none_or(|reducer| reducer.in_window().is_none())
        {
            let known = REDUCERS.iter().filter(|entry| entry.window.is_some());
            let known: Vec<&str> = known.map(|entry| entry.name).collect();
            let problem = problem!("unknown-reducer", item, "a sliding window has no `{word}`");
            return self.refuse(match nearest(word, known.iter().copied()) {
                Some(near) => problem.help(format!("did you mean `{near}`?")),
                None => problem.help(format!("it has {}, p<number>", known.join(", "))),
            });
        }
        self.reducer(&phrase, true)
    }

    /// Whether a value has the dimension that is needed; a problem if not.
    pub fn suits(
        &mut self,
        name: &str,
        ok: bool,
        needed: &str,
        found: Dimension,
        place: &Span,
    ) -> Option<()> {
        if ok {
            return Some(());
        }
        self.refuse(problem!(
            "unit-mismatch",
            place,
            "{name}: expected {needed}, this is {}",
            found.in_words()
        ))
    }

    /// Whether a number is above zero; a problem if not.
    pub fn positive(&mut self, name: &str, value: f64, place: &Span) -> Option<()> {
        if value > 0.0 && value.is_finite() {
            return Some(());
        }
        self.refuse(problem!("out-of-range", place, "the {name} must be above zero"))
    }

    /// An option: `order 4`, `50 points`, `zero-phase`, or the name of a choice parameter.
    fn option(
        &mut self,
        form: &Form,
        part: &[At<Item>],
        span: &Span,
        filled: &mut Filled,
    ) -> Option<()> {
        let place = part
            .first()
            .map_or_else(|| span.clone(), |first| first.to(&part[part.len() - 1], ()).place());
        match part {
            [one, other] => {
                let named = |item: &At<Item>| {
                    let word = item.node.word()?;
                    form.numbers.iter().position(|option| option.name == word)
                };
                let found = named(one).map(|index| (index, other));
                if let Some((index, value)) = found.or_else(|| Some((named(other)?, one))) {
                    let word = form.numbers[index].name;
                    self.note(filled.option_said(form.numbers[index].name, &place))?;
                    let (number, dimension) = self.constant_phrase(&item_phrase(value))?;
                    let suits = form.numbers[index].with_unit || dimension == Dimension::ONE;
                    self.suits(word, suits, "a plain number", dimension, &place)?;
                    filled.options[index] = Some((number, dimension));
                    return Some(());
                }
            }
            [At { node: Item::Word(word), .. }] => {
                let word = self.choice_word(word, &place)?;
                for (index, choice) in form.choices.iter().enumerate() {
                    if let Some(found) = choice.words.iter().find(|known| **known == word) {
                        self.note(filled.option_said(choice.name, &place))?;
                        filled.choices[index] = found;
                        return Some(());
                    }
                }
            }
            _ => {}
        }
        let mut known: Vec<String> =
            form.numbers.iter().map(|option| format!("{} <number>", option.name)).collect();
        let words = form.choices.iter().flat_map(|choice| choice.words);
        known.extend(words.map(|word| (*word).to_string()));
        let said = part.first().and_then(|item| item.node.word()).unwrap_or_default();
        let what = if METRICS.iter().any(|entry| entry.form.head == form.head) {
            "metric"
        } else {
            "step"
        };
        let problem = problem!("unknown-option", &place, "this is not an option of the {what}");
        self.refuse(match nearest(said, known.iter().map(String::as_str)) {
            Some(near) => problem.help(format!("did you mean `{near}`?")),
            None if known.is_empty() => problem.help("it has no option"),
            None => problem.help(format!("its options: {}", known.join(", "))),
        })
    }

    fn note(&mut self, result: Result<(), Problem>) -> Option<()> {
        result.map_err(|problem| self.tell(problem)).ok()
    }
}

/// Whether the items agree with the words and slots of the wording.
pub fn fits(form: &Form, items: &[At<Item>]) -> bool {
    form.head.len() == items.len()
        && form.head.iter().zip(items).all(|(part, item)| match (part, &item.node) {
            (FormPart::Word(word), Item::Word(found)) => word == found,
            (FormPart::Word(_), Item::Value(_)) => false,
            _ => true,
        })
}

/// A word or a value of a step as an expression.
pub fn item_phrase(item: &At<Item>) -> Phrase {
    match &item.node {
        Item::Value(phrase) => phrase.clone(),
        Item::Word(word) => item.with(Node::Path(word.clone())),
    }
}
