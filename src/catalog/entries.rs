//! The whole registry as text, for `explain` and the language reference.

use std::fmt::Write;

use super::{
    Best, DIFFERENCES, FUNCTIONS, Form, METRICS, NOT_CHECKED, NumberOption, REDUCERS,
    SIGNAL_FUNCTIONS, STATISTICS, STEPS, Signature,
};
use crate::units::Dimension;

/// One operation of the language on signals or numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// `step`, `reducer`, `metric`, `difference`, `statistic`, `function` or `signal-function`.
    pub kind: &'static str,
    /// How it is written: `low-pass <cut-off: a frequency>`.
    pub wording: String,
    /// Arguments and result; `D` is any dimension.
    pub signature: &'static str,
    pub about: String,
    /// The best value, where it is known: `1, larger is better`.
    pub best: Option<String>,
    /// Words and numbers that may follow a comma, each with its default.
    pub options: Vec<String>,
    /// Publication, if there is one.
    pub source: Option<&'static str>,
}

impl Entry {
    fn new(
        kind: &'static str,
        wording: impl Into<String>,
        signature: &'static str,
        about: impl Into<String>,
    ) -> Self {
        Self {
            kind,
            wording: wording.into(),
            signature,
            about: about.into(),
            best: None,
            options: Vec::new(),
            source: None,
        }
    }

    /// The complete description, in one line.
    pub fn in_words(&self) -> String {
        let mut text = self.about.clone();
        if let Some(best) = &self.best {
            let _ = write!(text, " Best value {best}.");
        }
        for option in &self.options {
            let _ = write!(text, " Option {option}.");
        }
        if let Some(source) = self.source {
            let _ = write!(text, " {source}");
        }
        text
    }
}

/// All entries of the registry, kind by kind.
pub fn entries() -> Vec<Entry> {
    let mut all = Vec::new();
    for entry in STEPS {
        all.push(Entry {
            options: options(&entry.form),
            ..Entry::new("step", entry.form.in_words(), step_signature(&entry.form), entry.about)
        });
    }
    all.push(Entry::new(
        "reducer",
        "p<number>",
        "signal<D> -> D",
        "The value below which this percentage of the samples lies.",
    ));
    for entry in REDUCERS {
        let signature = match (entry.gives)(Dimension::LENGTH, Dimension::TIME) {
            Dimension::LENGTH => "signal<D> -> D",
            Dimension::ONE => "signal<D> -> plain number",
            _ => "signal<D> -> D per axis",
        };
        all.push(Entry::new("reducer", entry.name, signature, entry.about));
    }
    for entry in METRICS {
        let signature = match (entry.gives)(Dimension::TIME, Dimension::LENGTH) {
            Dimension::TIME => "(signal<D>, signal<D>) -> D",
            Dimension::LENGTH => "(signal<D>, signal<D>) -> axis",
            _ => "(signal<D>, signal<D>) -> plain number",
        };
        let best = Some(entry.best.in_words());
        let options = options(&entry.form);
        let about = if entry.unverified {
            format!("{} Unverified: {NOT_CHECKED}.", entry.about)
        } else {
            entry.about.to_string()
        };
        all.push(Entry {
            source: Some(entry.source),
            best,
            options,
            ..Entry::new("metric", entry.form.in_words(), signature, about)
        });
    }
    for (name, expression) in DIFFERENCES {
        let best = Some(Best::Near(0.0).in_words());
        all.push(Entry {
            best,
            ..Entry::new("difference", name, "(D, D) -> D", format!("`{expression}`"))
        });
    }
    for entry in STATISTICS {
        let best = entry.of_scatter.then(|| Best::Least(0.0).in_words());
        let about = format!("The {} of all pairs.", entry.title);
        all.push(Entry { best, ..Entry::new("statistic", entry.name, "pairs of D -> D", about) });
    }
    all.push(Entry::new(
        "statistic",
        "p<number>",
        "pairs of D -> D",
        "A percentile of all pairs, with linear interpolation.",
    ));
    all.push(Entry::new(
        "statistic",
        "each",
        "each pair of D",
        "Every pair separately; the worst decides.",
    ));
    for function in FUNCTIONS {
        all.push(Entry::new(
            "function",
            function.name,
            signature(function.signature),
            function.about,
        ));
    }
    for (name, signature, about) in SIGNAL_FUNCTIONS {
        all.push(Entry::new("signal-function", name, signature, about));
    }
    all
}

fn options(form: &Form) -> Vec<String> {
    let numbers = form.numbers.iter().map(|NumberOption { name, default, .. }| match default {
        Some(default) => format!("`{name}` (default {default})"),
        None => format!("`<number> {name}`"),
    });
    let choices = form.choices.iter().map(|choice| {
        let words: Vec<String> = choice.words.iter().map(|word| format!("`{word}`")).collect();
        words.join(" | ")
    });
    numbers.chain(choices).collect()
}

fn step_signature(form: &Form) -> &'static str {
    if form.numbers.iter().any(|option| option.with_unit) {
        "signal<D> -> signal<D times the gain's unit>"
    } else {
        "signal<D> -> signal<D>"
    }
}

fn signature(signature: Signature) -> &'static str {
    match signature {
        Signature::Same => "(D) -> D",
        Signature::ToPlain => "(D) -> plain number",
        Signature::Plain => "(plain number) -> plain number",
        Signature::Root => "(D) -> square root of D",
        Signature::PairSame => "(D, D) -> D",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_wording_stands_once_and_is_explained() {
        let mut seen = BTreeSet::new();
        for entry in entries() {
            assert!(seen.insert((entry.kind, entry.wording.clone())), "{entry:?}");
            assert!(entry.about.len() > 5, "{entry:?}");
        }
    }
}
