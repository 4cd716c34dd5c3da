//! The wording of a step or metric: fixed words with slots, then options in any order.

use crate::units::Dimension;

/// A part of a wording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormPart {
    /// A fixed word.
    Word(&'static str),
    /// A number of the given dimension.
    Number(&'static str, Dimension),
    /// A time or a length; its dimension decides the axis that is used.
    Extent(&'static str),
    /// The same, or the word `sample`.
    ExtentOrSample(&'static str),
    /// A reducer that a sliding window has.
    Reducer(&'static str),
    /// A frequency: in time, or in cycles per length after resampling over a length.
    Frequency(&'static str),
    /// A frequency or 0 Hz.
    FrequencyOrZero(&'static str),
    /// Another signal.
    Signal(&'static str),
}

impl FormPart {
    /// The word, where it is a fixed one.
    pub fn word(&self) -> Option<&'static str> {
        if let Self::Word(word) = self { Some(word) } else { None }
    }
}

/// An option with a few possible words; the first is the default.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    pub name: &'static str,
    pub words: &'static [&'static str],
    pub about: &'static str,
}

/// An option of a word and a number.
#[derive(Clone, Copy, Debug)]
pub struct NumberOption {
    pub name: &'static str,
    /// `None`: without the option, nothing is done.
    pub default: Option<f64>,
    /// Whether it may have a unit. The signal is then multiplied by this unit.
    pub with_unit: bool,
}

/// A wording.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    pub head: &'static [FormPart],
    /// Options of a word and a number, in either order: `order 4`, `50 points`.
    pub numbers: &'static [NumberOption],
    pub choices: &'static [Choice],
}

impl Form {
    /// The word that it begins with.
    pub fn first_word(&self) -> Option<&'static str> {
        self.head.first()?.word()
    }

    /// The wording as text: `band-pass <low: a frequency> to <high: a frequency>`.
    pub fn in_words(&self) -> String {
        let parts: Vec<String> = self
            .head
            .iter()
            .map(|part| match part {
                FormPart::Word(word) => (*word).to_string(),
                FormPart::Number(name, dimension) => format!("<{name}: {}>", dimension.in_words()),
                FormPart::Extent(name) => format!("<{name}: a length or a time>"),
                FormPart::ExtentOrSample(name) => {
                    format!("<{name}: a length, a time or the word sample>")
                }
                FormPart::Reducer(name) => format!("<{name}: a reducer>"),
                FormPart::Frequency(name) => format!("<{name}: a frequency>"),
                FormPart::FrequencyOrZero(name) => format!("<{name}: a frequency or 0 Hz>"),
                FormPart::Signal(name) => format!("<{name}: a signal>"),
            })
            .collect();
        parts.join(" ")
    }
}
