//! Texts with their styles.

use serde::{Serialize, Serializer};

use super::{finding::Finding, symbol::Symbol};

/// What stands in a paragraph, a cell or a caption.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text(pub Vec<Run>);

/// A piece of a text in one style.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "style", content = "it", rename_all = "lowercase")]
pub enum Run {
    Plain(String),
    Strong(String),
    Emphasis(String),
    /// As typed: names of the protocol, commands.
    Code(String),
    /// Less important.
    Quiet(String),
    /// A hash, which is copied whole.
    Hash(String),
    Symbol(Symbol),
    /// Sign and word.
    Finding(Finding),
    /// The sign of a finding.
    Mark(Finding),
    /// A new line.
    Break(()),
}

impl Text {
    pub fn symbol(symbol: &str) -> Self {
        Run::Symbol(Symbol::new(symbol)).into()
    }

    /// With a further piece.
    pub fn then(mut self, run: Run) -> Self {
        self.0.push(run);
        self
    }

    /// With a further text in the same style as the text around it.
    pub fn and(self, text: impl Into<String>) -> Self {
        let text = text.into();
        if text.is_empty() { self } else { self.then(Run::Plain(text)) }
    }

    /// Both, one after the other.
    pub fn with(mut self, other: impl Into<Self>) -> Self {
        self.0.extend(other.into().0);
        self
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The letters without their styles.
    pub fn letters(&self) -> String {
        let run = |run: &Run| match run {
            Run::Plain(text)
            | Run::Strong(text)
            | Run::Emphasis(text)
            | Run::Code(text)
            | Run::Quiet(text)
            | Run::Hash(text) => text.clone(),
            Run::Symbol(symbol) => symbol.letters.clone(),
            Run::Finding(finding) => format!("{} {}", finding.sign, finding.word),
            Run::Mark(finding) => finding.sign.to_owned(),
            Run::Break(()) => "\n".to_owned(),
        };
        self.0.iter().map(run).collect()
    }

    /// Several texts, a line each.
    pub fn lines(texts: impl IntoIterator<Item = Self>) -> Self {
        texts.into_iter().fold(Self::default(), |all, text| {
            if all.is_empty() { text } else { all.then(Run::Break(())).with(text) }
        })
    }
}

impl From<Run> for Text {
    fn from(run: Run) -> Self {
        Self(vec![run])
    }
}

impl From<String> for Text {
    fn from(text: String) -> Self {
        if text.is_empty() { Self::default() } else { Run::Plain(text).into() }
    }
}

impl From<&str> for Text {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<&String> for Text {
    fn from(text: &String) -> Self {
        text.clone().into()
    }
}

impl From<&Option<String>> for Text {
    fn from(text: &Option<String>) -> Self {
        text.clone().unwrap_or_default().into()
    }
}

/// A plain text as a string, others as a list of pieces.
impl Serialize for Text {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.0.as_slice() {
            [] => to.serialize_str(""),
            [Run::Plain(text)] => to.serialize_str(text),
            runs => runs.serialize(to),
        }
    }
}
