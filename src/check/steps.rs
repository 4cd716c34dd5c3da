//! Checks filter chains: wordings of the registry, dimensions of numbers, order of the steps.

use super::Checker;
use super::plan::{Kind, Scalar, Step, StepSpec};
use super::scope::Scope;
use crate::catalog::{Form, METRICS, Part, STEPS, StepEntry, StepKind};
use crate::metrics::filter::{Band, Cutoff, Phase};
use crate::metrics::window::Ends;
use crate::problem::{Problem, error, nearest};
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::from_pest;
use crate::syntax::phrase::{At, Item, Node, Phrase, Step as Written_};
use crate::units::Dimension;

/// Largest number of steps of a chain, including those of the filters that it names. Each is a pass
/// over every record and a signal in memory.
const MOST_STEPS: usize = 32;
/// Finest step of a grid along a length, in m. It is finer than the resolution of the distance in a
/// record.
const FINEST_LENGTH: f64 = 1e-4;
/// Finest step of a grid along the time, in s. Records of test runs have sampling rates up to about
/// 10 kHz.
const FINEST_TIME: f64 = 1e-5;

/// The values of the slots and options of a wording.
#[derive(Debug, Default)]
pub struct Filled {
    pub numbers: Vec<(f64, Dimension, Span)>,
    /// In the order of the wording; `None` where an option is not stated and has no default.
    pub options: Vec<Option<(f64, Dimension)>>,
    pub choices: Vec<&'static str>,
    /// Where each option is stated, to report one that is stated twice.
    said: Vec<(&'static str, Span)>,
}

impl Filled {
    fn option_said(&mut self, name: &'static str, place: &Span) -> Result<(), Problem> {
        if let Some((_, first)) = self.said.iter().find(|(said, _)| *said == name) {
            return Err(error("duplicate-option", format!("`{name}` is stated twice"), place)
                .also(first, "the first"));
        }
        self.said.push((name, place.clone()));
        Ok(())
    }
}

/// Smallest extent of a window or grid, in m or s. Smaller ones are mistakes: no record has so many
/// samples.
const SMALLEST_EXTENT: f64 = 1e-6;

impl StepSpec {
    /// Whether every sample of the record has a value after the step.
    pub fn keeps_samples(&self) -> bool {
        self.is_filter() || *self == Self::Magnitude
    }

    /// Whether it is a filter in the frequency domain, over time or, after resampling, over length.
    pub fn is_filter(&self) -> bool {
        matches!(self, Self::Butterworth { .. } | Self::Transfer { .. })
    }
}

impl Checker<'_> {
    /// The chain of a `filter` field, with the order of its steps checked.
    pub fn chain(&mut self, text: &Text) -> Option<Vec<Step>> {
        let steps = self.steps(text)?;
        self.step_order(&steps, false)?;
        Some(steps)
    }

    fn steps(&mut self, text: &Text) -> Option<Vec<Step>> {
        let steps = from_pest::chain(text, self.problems)?;
        let mut all = Vec::new();
        let mut ok = true;
        for step in &steps {
            match self.step(step) {
                Some(steps) => {
                    self.few_steps(all.len() + steps.len(), &step.place())?;
                    all.extend(steps);
                }
                None => ok = false,
            }
        }
        ok.then_some(all)
    }

    fn few_steps(&mut self, count: usize, at: &Span) -> Option<()> {
        if count <= MOST_STEPS {
            return Some(());
        }
        self.refuse(
            error(
                "too-large",
                format!("the filter has {count} steps; there can be at most {MOST_STEPS}"),
                at,
            )
            .help("filters that use each other twice double at every level"),
        )
    }

    /// The steps of a declared filter.
    pub fn filter_named(&mut self, name: &str, span: &Span) -> Option<Vec<Step>> {
        if let Some(steps) = self.filter_steps.get(name) {
            return steps.clone();
        }
        let Some(block) = self.names.filters.get(name).cloned() else {
            let steps = STEPS.iter().filter_map(|entry| entry.form.first_word());
            let mut known: Vec<&str> =
                self.names.filters.keys().map(String::as_str).chain(steps).collect();
            known.dedup();
            let problem = error("unknown-filter", format!("no filter is called `{name}`"), span)
                .suggest(name, known);
            return self.refuse(problem);
        };
        let result = self.inside("filter", name, span, |checker| {
            let mut steps = Vec::new();
            let mut ok = checker.required(&block, "step").is_some();
            for field in block.fields_named("step") {
                match checker.steps(&field.value) {
                    Some(found) => {
                        checker.few_steps(steps.len() + found.len(), &field.value.span)?;
                        steps.extend(found);
                    }
                    None => ok = false,
                }
            }
            (ok && checker.step_order(&steps, true).is_some()).then_some(steps)
        });
        self.filter_steps.insert(name.to_string(), result.clone());
        result
    }

    /// Checks the order of steps. After a window, the samples of the whole record are no longer
    /// available for a filter. After resampling over a length, frequencies are in cycles per
    /// length. A named filter (`part`) may be used after a resampling elsewhere.
    pub fn step_order(&mut self, steps: &[Step], part: bool) -> Option<()> {
        let mut window: Option<&Step> = None;
        let mut resampled: Option<&Step> = None;
        for step in steps {
            let whole_record =
                step.kind.is_filter() || matches!(step.kind, StepSpec::Resample { .. });
            if let Some(before) = window.filter(|_| whole_record) {
                return self.refuse(
                    error(
                        "step-order",
                        "a filter over the whole record cannot follow a window inside the section",
                        &step.span,
                    )
                    .also(&before.span, "the window")
                    .help("put the filter before the window"),
                );
            }
            match &step.kind {
                StepSpec::Window { .. } | StepSpec::RemoveMean => window = Some(step),
                StepSpec::Resample { .. } => resampled = Some(step),
                StepSpec::Butterworth { .. } | StepSpec::Transfer { .. } => {
                    let over_length = resampled.filter(|step| {
                        matches!(step.kind, StepSpec::Resample { over_time: false, .. })
                    });
                    match over_length {
                        Some(before) if !step.per_length => {
                            return self.refuse(error("step-order", "after resampling over a length there are no frequencies in time", &step.span)
                                    .also(&before.span, "resampled here")
                                    .help("write cycles per length: `0.33 1/m`"));
                        }
                        None if step.per_length && !(part && resampled.is_none()) => {
                            return self.refuse(error("step-order", "cycles per length need a record with equal steps of length", &step.span).help(
                                "put `resample every 0.25 m` before it, or write a frequency in Hz",
                            ));
                        }
                        _ => {}
                    }
                }
                StepSpec::Magnitude => {}
            }
        }
        Some(())
    }

    fn step(&mut self, step: &At<Written_>) -> Option<Vec<Step>> {
        let span = step.place();
        let mut written = step.node.clone();
        if let Some(condition) = written.when.take() {
            let condition = self.expr(&condition, &mut Scope::constant())?;
            self.flag_type(&condition)?;
            match condition.kind {
                Kind::Constant(Scalar::Flag(false)) => return Some(Vec::new()),
                Kind::Constant(_) => {}
                _ => {
                    return self.refuse(error(
                        "not-constant",
                        "the condition of a step can only depend on parameters",
                        &condition.span,
                    ));
                }
            }
        }
        if let [part] = written.parts.as_slice()
            && let [item @ At { node: Item::Word(word), .. }] = part.as_slice()
            && !STEPS
                .iter()
                .any(|entry| entry.form.head == [Part::Word("magnitude")] && word == "magnitude")
        {
            return self.filter_named(word, &item.place());
        }
        let written = self.with_choices(written, STEPS.iter().map(|entry| &entry.form));
        let entry =
            self.find_form(&written, &span, "step", STEPS.iter().map(|entry| &entry.form))?;
        let entry = &STEPS[entry];
        let filled = self.fill_form(&entry.form, &written, &span)?;
        Some(vec![self.spec(entry, &filled, &span)?])
    }

    /// Where no wording fits, words that are choice parameters are replaced by their values.
    pub fn with_choices<'f>(
        &mut self,
        mut step: Written_,
        mut forms: impl Iterator<Item = &'f Form>,
    ) -> Written_ {
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
        step: &Written_,
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
    pub fn fill_form(&mut self, form: &Form, step: &Written_, span: &Span) -> Option<Filled> {
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
            if matches!(part, Part::Word(_) | Part::Signal(_)) {
                continue;
            }
            let place = item.place();
            let (value, found) = self.constant_phrase(&item_phrase(item))?;
            match part {
                Part::Word(_) | Part::Signal(_) => {}
                Part::Number(name, dimension) => {
                    self.suits(name, found == *dimension, &dimension.in_words(), found, &place)?;
                }
                Part::Extent(name) => {
                    let extent = matches!(found, Dimension::LENGTH | Dimension::TIME);
                    self.suits(name, extent, "a length or a time", found, &place)?;
                    self.positive(name, value, &place)?;
                    if value < SMALLEST_EXTENT {
                        let unit = if found == Dimension::TIME { "µs" } else { "µm" };
                        let says = format!(
                            "the {name} is below 1 {unit}, finer than the samples of a record"
                        );
                        return self.refuse(error("out-of-range", says, &place));
                    }
                }
                Part::Frequency(name) | Part::FrequencyOrZero(name) => {
                    let per_length = Dimension::ONE / Dimension::LENGTH;
                    let frequency = found == Dimension::FREQUENCY || found == per_length;
                    self.suits(name, frequency, "a frequency", found, &place)?;
                    if !matches!(part, Part::FrequencyOrZero(_)) || value != 0.0 {
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
        self.refuse(error(
            "unit-mismatch",
            format!("{name}: expected {needed}, this is {}", found.in_words()),
            place,
        ))
    }

    /// Whether a number is above zero; a problem if not.
    pub fn positive(&mut self, name: &str, value: f64, place: &Span) -> Option<()> {
        if value > 0.0 && value.is_finite() {
            return Some(());
        }
        self.refuse(error("out-of-range", format!("the {name} must be above zero"), place))
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
            [At { node: Item::Word(word), .. }, value]
            | [value @ At { node: Item::Value(_), .. }, At { node: Item::Word(word), .. }] => {
                if let Some(index) = form.numbers.iter().position(|option| option.name == word) {
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
        known.extend(
            form.choices
                .iter()
                .flat_map(|choice| choice.words.iter().map(|word| (*word).to_string())),
        );
        let said = part.first().map_or(String::new(), |item| {
            if let Item::Word(word) = &item.node { word.clone() } else { String::new() }
        });
        let what = if METRICS.iter().any(|entry| entry.form.head == form.head) {
            "metric"
        } else {
            "step"
        };
        let problem =
            error("unknown-option", format!("this is not an option of the {what}"), &place);
        self.refuse(match nearest(&said, known.iter().map(String::as_str)) {
            Some(near) => problem.help(format!("did you mean `{near}`?")),
            None if known.is_empty() => problem.help("it has no option"),
            None => problem.help(format!("its options: {}", known.join(", "))),
        })
    }

    fn note(&mut self, result: Result<(), Problem>) -> Option<()> {
        result.map_err(|problem| self.problems.push(problem)).ok()
    }

    fn not_too_fine(&mut self, (step, dimension, place): &(f64, Dimension, Span)) -> Option<()> {
        let finest = if *dimension == Dimension::TIME { FINEST_TIME } else { FINEST_LENGTH };
        // Tolerance for the rounding of a conversion of units.
        if *step >= finest * (1.0 - 1e-9) {
            return Some(());
        }
        let (finest, step) = (show_number(finest, *dimension), show_number(*step, *dimension));
        self.refuse(
            error("out-of-range", format!("the step of {step} is finer than {finest}"), place)
                .help("a step far below the sample distance adds points but no information"),
        )
    }

    fn spec(&mut self, entry: &StepEntry, filled: &Filled, span: &Span) -> Option<Step> {
        let number = |index: usize| filled.numbers.get(index).map_or(0.0, |(value, _, _)| *value);
        let mut words = Vec::new();
        let mut next = 0;
        for part in entry.form.head {
            match part {
                Part::Word(word) => words.push((*word).to_string()),
                _ => {
                    let (value, dimension, _) = filled.numbers.get(next)?;
                    words.push(show_number(*value, *dimension));
                    next += 1;
                }
            }
        }
        let mut factor = Dimension::ONE;
        let kind = match entry.kind {
            StepKind::LowPass | StepKind::HighPass | StepKind::BandPass | StepKind::BandStop => {
                let band = match entry.kind {
                    StepKind::LowPass => Band::LowPass(number(0)),
                    StepKind::HighPass => Band::HighPass(number(0)),
                    StepKind::BandPass => Band::BandPass(number(0), number(1)),
                    _ => Band::BandStop(number(0), number(1)),
                };
                if let (Some((low, a, _)), Some((high, b, place))) =
                    (filled.numbers.first(), filled.numbers.get(1))
                {
                    self.suits("upper frequency", a == b, &a.in_words(), *b, place)?;
                    if low >= high {
                        return self.refuse(error(
                            "out-of-range",
                            "the lower frequency is not below the upper one",
                            span,
                        ));
                    }
                }
                let (order, _) = filled.options.first().copied().flatten()?;
                if order.fract() != 0.0 || !(1.0..=20.0).contains(&order) {
                    return self.refuse(error(
                        "out-of-range",
                        format!("the order must be a whole number from 1 to 20, this is {order}"),
                        span,
                    ));
                }
                words
                    .push(format!(", order {order}, {}, {}", filled.choices[0], filled.choices[1]));
                let phase = phase(filled.choices[0]);
                let cutoff = if filled.choices[1] == "per-pass" {
                    Cutoff::PerPass
                } else {
                    Cutoff::AsApplied
                };
                StepSpec::Butterworth { band, order: order as usize, phase, cutoff }
            }
            StepKind::TransferFunction => {
                let (gain, unit) = filled.options.first().copied().flatten()?;
                factor = unit;
                words.push(format!(
                    ", gain {}, {}, {}",
                    show_number(gain, unit),
                    filled.choices[0],
                    filled.choices[1]
                ));
                self.transfer(entry, filled, span)?
            }
            StepKind::SlidingMean | StepKind::SlidingRms => {
                let (_, a, _) = filled.numbers.first()?;
                let (_, b, place) = filled.numbers.get(1)?;
                self.suits("step", a == b, &a.in_words(), *b, place)?;
                words.push(format!(", {}", filled.choices[0]));
                let short_sections = filled.choices[1] == "short-sections";
                if short_sections {
                    words.push(format!(", {}", filled.choices[1]));
                }
                self.not_too_fine(filled.numbers.get(1)?)?;
                let ends =
                    if filled.choices[0] == "integral" { Ends::Integral } else { Ends::Samples };
                StepSpec::Window {
                    rms: entry.kind == StepKind::SlidingRms,
                    width: number(0),
                    step: number(1),
                    over_time: *a == Dimension::TIME,
                    ends,
                    short_sections,
                }
            }
            StepKind::Resample => {
                self.not_too_fine(filled.numbers.first()?)?;
                StepSpec::Resample {
                    step: number(0),
                    over_time: filled.numbers.first()?.1 == Dimension::TIME,
                }
            }
            StepKind::RemoveMean => StepSpec::RemoveMean,
            StepKind::Magnitude => StepSpec::Magnitude,
        };
        let per_length = filled
            .numbers
            .iter()
            .any(|(_, dimension, _)| *dimension == Dimension::ONE / Dimension::LENGTH);
        Some(Step {
            kind,
            words: words.join(" ").replace(" ,", ","),
            per_length,
            factor,
            span: span.clone(),
        })
    }
}

/// The phase that a word of the wording stands for.
pub fn phase(word: &str) -> Phase {
    match word {
        "causal" => Phase::Causal,
        "causal-from-rest" => Phase::CausalFromRest,
        _ => Phase::Zero,
    }
}

/// Dimension of a signal after the steps.
pub fn after(steps: &[Step], dimension: Dimension) -> Dimension {
    steps.iter().fold(dimension, |dimension, step| dimension * step.factor)
}

/// Whether the items agree with the words and slots of the wording.
pub fn fits(form: &Form, items: &[At<Item>]) -> bool {
    form.head.len() == items.len()
        && form.head.iter().zip(items).all(|(part, item)| match (part, &item.node) {
            (Part::Word(word), Item::Word(found)) => word == found,
            (Part::Word(_), Item::Value(_)) => false,
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

/// A number in an engineering unit.
pub fn show_number(value: f64, dimension: Dimension) -> String {
    let unit = match dimension {
        Dimension::FREQUENCY => " Hz",
        Dimension::LENGTH => " m",
        Dimension::TIME => " s",
        Dimension::ONE => "",
        _ if dimension == Dimension::ONE / Dimension::LENGTH => " 1/m",
        other => &format!(" {other}"),
    };
    // Rounded to six significant digits.
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}{unit}")
}
