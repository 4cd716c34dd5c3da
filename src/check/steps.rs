//! Checks filter chains: their steps, and the order of these.

use super::{evaluate::is_whole, prelude::*, wordings::Filled};
use crate::catalog::{FormPart, InWindow, STEPS, StepEntry, StepKind};
use crate::metrics::{
    filter::{Band, Cutoff, Phase},
    window::{self, Ends},
};
use crate::syntax::phrase::{Item, Step as WrittenStep};

/// Largest number of steps of a chain, including those of the filters that it names. Each is a pass
/// over every record and a signal in memory.
const MOST_STEPS: usize = 32;
/// Finest step of a grid along a length, in m. It is finer than the resolution of the distance in a
/// record.
const FINEST_LENGTH: f64 = 1e-4;
/// Finest step of a grid along the time, in s. Records of test runs have sampling rates up to about
/// 10 kHz.
const FINEST_TIME: f64 = 1e-5;

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

    /// The chain of a block; an empty one where it has no field `filter`.
    pub fn chain_of(&mut self, block: &Block) -> Option<Vec<Step>> {
        block.field("filter").map_or(Some(Vec::new()), |field| self.chain(&field.value))
    }

    fn steps(&mut self, text: &Text) -> Option<Vec<Step>> {
        let written = from_pest::chain(text, self.problems)?;
        self.steps_of(&written)
    }

    /// The steps of a chain as written.
    pub fn steps_of(&mut self, written: &[At<WrittenStep>]) -> Option<Vec<Step>> {
        self.few_steps(written, Self::step)
    }

    /// The steps that each of these gives, one after the other.
    fn few_steps<T: Located>(
        &mut self,
        written: &[T],
        steps_of: fn(&mut Self, &T) -> Option<Vec<Step>>,
    ) -> Option<Vec<Step>> {
        let mut all = Vec::new();
        let mut ok = true;
        for part in written {
            let Some(steps) = steps_of(self, part) else {
                ok = false;
                continue;
            };
            all.extend(steps);
            let count = all.len();
            if count > MOST_STEPS {
                let help = "filters that use each other twice double at every level";
                return self.refuse(
                    problem!(
                        "too-large",
                        part,
                        "the filter has {count} steps; there can be at most {MOST_STEPS}"
                    )
                    .help(help),
                );
            }
        }
        ok.then_some(all)
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
            return self.refuse(
                problem!("unknown-filter", span, "no filter is called `{name}`")
                    .suggest(name, known),
            );
        };
        let result = self.inside("filter", name, span, |checker| {
            checker.required(&block, "step")?;
            let fields: Vec<&Field> = block.fields_named("step").collect();
            let steps = checker.few_steps(&fields, |checker, field| checker.steps(&field.value))?;
            checker.step_order(&steps, true)?;
            Some(steps)
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
                let says =
                    "a filter over the whole record cannot follow a window inside the section";
                let problem = error("step-order", says, &step.span);
                let help = "put the filter before the window";
                return self.refuse(problem.also(&before.span, "the window").help(help));
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

    fn step(&mut self, step: &At<WrittenStep>) -> Option<Vec<Step>> {
        let span = step.place();
        let mut written = step.node.clone();
        if let Some(condition) = written.when.take() {
            let condition = self.condition(&condition, &mut Scope::constant())?;
            match condition.kind {
                Kind::Constant(Scalar::Flag(false)) => return Some(Vec::new()),
                Kind::Constant(_) => {}
                _ => {
                    let says = "the condition of a step can only depend on parameters";
                    return self.refuse(error("not-constant", says, &condition));
                }
            }
        }
        if let [part] = written.parts.as_slice()
            && let [item @ At { node: Item::Word(word), .. }] = part.as_slice()
            && !STEPS.iter().any(|entry| {
                entry.form.head == [FormPart::Word("magnitude")] && word == "magnitude"
            })
        {
            return self.filter_named(word, &item.place());
        }
        let forms = STEPS.iter().map(|entry| &entry.form);
        let written = self.with_choices(written, forms.clone());
        let entry = &STEPS[self.find_form(&written, &span, "step", forms)?];
        let filled = self.fill_form(&entry.form, &written, &span)?;
        Some(vec![self.spec(entry, &filled, &span)?])
    }

    fn not_too_fine(&mut self, (step, dimension, place): &(f64, Dimension, Span)) -> Option<()> {
        let finest = if *dimension == Dimension::TIME { FINEST_TIME } else { FINEST_LENGTH };
        // Tolerance for the rounding of a conversion of units.
        if *step >= finest * (1.0 - 1e-9) {
            return Some(());
        }
        let (finest, step) = (show_number(finest, *dimension), show_number(*step, *dimension));
        self.refuse(
            problem!("out-of-range", place, "the step of {step} is finer than {finest}")
                .help("a step far below the sample distance adds points but no information"),
        )
    }

    fn spec(&mut self, entry: &StepEntry, filled: &Filled, span: &Span) -> Option<Step> {
        let number = |index: usize| filled.numbers.get(index).map_or(0.0, |(value, _, _)| *value);
        let mut words = Vec::new();
        let mut next = 0;
        for part in entry.form.head {
            match part {
                FormPart::Word(word) => words.push((*word).to_string()),
                FormPart::Reducer(_) => words.push(filled.reducer?.in_words()),
                FormPart::ExtentOrSample(_) if next == filled.numbers.len() => {
                    words.push("sample".into());
                }
                _ => {
                    let (value, dimension, _) = filled.numbers.get(next)?;
                    words.push(show_number(*value, *dimension));
                    next += 1;
                }
            }
        }
        let mut factor = Dimension::ONE;
        let [first, second] = [0, 1].map(|at| filled.choices.get(at).copied().unwrap_or_default());
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
                        let says = "the lower frequency is not below the upper one";
                        return self.refuse(error("out-of-range", says, span));
                    }
                }
                let (order, _) = filled.options.first().copied().flatten()?;
                if !is_whole(order, 1.0..=20.0) {
                    return self.refuse(problem!(
                        "out-of-range",
                        span,
                        "the order must be a whole number from 1 to 20, this is {order}"
                    ));
                }
                words.push(format!(", order {order}, {first}, {second}"));
                let phase = phase(first);
                let cutoff = if second == "per-pass" { Cutoff::PerPass } else { Cutoff::AsApplied };
                StepSpec::Butterworth { band, order: order as usize, phase, cutoff }
            }
            StepKind::TransferFunction => {
                let (gain, unit) = filled.options.first().copied().flatten()?;
                factor = unit;
                words.push(format!(", gain {}, {first}, {second}", show_number(gain, unit)));
                self.transfer(entry, filled, span)?
            }
            StepKind::Sliding => {
                let reducer = filled.reducer?;
                let (_, axis, _) = filled.numbers.first()?;
                factor = reducer.gives(Dimension::ONE, *axis);
                if let Some(step) = filled.numbers.get(1) {
                    self.suits("step", *axis == step.1, &axis.in_words(), step.1, &step.2)?;
                    self.not_too_fine(step)?;
                }
                let of_sums = matches!(
                    reducer.in_window(),
                    Some(InWindow::Fast(window::Kind::Mean | window::Kind::Rms))
                );
                if of_sums {
                    words.push(format!(", {first}"));
                } else if first == "integral" {
                    let says = "only a sliding mean or rms can be an `integral`";
                    return self.refuse(error("unknown-option", says, span));
                }
                let short_sections = second == "short-sections";
                if short_sections {
                    words.push(format!(", {second}"));
                }
                StepSpec::Window {
                    reducer,
                    width: number(0),
                    step: filled.numbers.get(1).map(|(step, ..)| *step),
                    over_time: *axis == Dimension::TIME,
                    ends: if first == "integral" { Ends::Integral } else { Ends::Samples },
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
        let per_length =
            filled.numbers.iter().any(|(_, dimension, _)| *dimension == Dimension::PER_LENGTH);
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

/// A number in an engineering unit.
pub fn show_number(value: f64, dimension: Dimension) -> String {
    let unit = match dimension {
        Dimension::FREQUENCY => " Hz",
        Dimension::LENGTH => " m",
        Dimension::TIME => " s",
        Dimension::ONE => "",
        Dimension::PER_LENGTH => " 1/m",
        other => &format!(" {other}"),
    };
    // Rounded to six significant digits.
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}{unit}")
}
