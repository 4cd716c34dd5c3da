//! Cells of tables: what they contain, how it is printed and how it stands in a file.

use std::borrow::Cow;

use super::finding::{Finding, Tone};
use super::symbol::Symbol;
use super::text::{Run, Text};
use crate::report::number;
use crate::result::{Reason, RecordName, Scope, StatisticName};

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    pub content: Content,
    /// Colour of what it contains.
    pub tone: Option<Tone>,
    pub strong: bool,
    /// Number of columns and of rows that it takes.
    pub across: usize,
    pub down: usize,
}

/// What a cell contains.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Nothing, printed as a dash.
    Missing,
    /// Nothing, printed as nothing.
    Blank,
    Text(Text),
    /// A formula or condition as written; printed with true signs.
    Formula(String),
    /// A sentence as written; its numbers and units are printed as in tables.
    Sentence(String),
    /// The symbol of a quantity, and its title.
    Symbol(String, String),
    /// A number in full precision.
    Number(f64, Format),
    /// A number or a word as the campaign states it.
    Given(String),
    /// Yes or no, in words of a file.
    Flag(bool),
}

/// How a number is printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Format {
    /// With this number of decimals.
    Fixed(usize),
    /// With this number of significant digits.
    Significant(usize),
    /// With decimals until it compares with the limit as it does in full precision.
    Beside { limit: f64, decimals: usize },
    /// With this number of significant digits, and a plus sign.
    Change(usize),
    /// A value divided by its limit.
    Ratio,
    /// A count, exact up to a size.
    Count,
}

impl Format {
    /// A ratio with its limit 1, and this number of decimals.
    pub fn beside_one(decimals: usize) -> Self {
        Self::Beside { limit: 1.0, decimals }
    }

    /// A number as printed.
    pub fn print(self, value: f64) -> String {
        match self {
            Self::Fixed(decimals) => number::fixed(value, decimals),
            Self::Significant(digits) => number::significant(value, digits),
            Self::Beside { limit, decimals } => number::beside(value, limit, decimals),
            Self::Change(digits) if value > 0.0 => {
                format!("+{}", number::significant(value, digits))
            }
            Self::Change(digits) => number::significant(value, digits),
            Self::Ratio => number::ratio(value),
            Self::Count => number::large(value),
        }
    }
}

impl Cell {
    /// Printed as a dash.
    pub const MISSING: Self = Self::new(Content::Missing);
    /// Printed as nothing.
    pub const BLANK: Self = Self::new(Content::Blank);

    const fn new(content: Content) -> Self {
        Self { content, tone: None, strong: false, across: 1, down: 1 }
    }

    pub fn text(text: impl Into<Text>) -> Self {
        let text = text.into();
        if text.is_empty() { Self::BLANK } else { Self::new(Content::Text(text)) }
    }

    pub fn formula(formula: impl Into<String>) -> Self {
        Self::new(Content::Formula(formula.into()))
    }

    pub fn sentence(sentence: impl Into<String>) -> Self {
        Self::new(Content::Sentence(sentence.into()))
    }

    /// The symbol of a quantity, and its title if that is not beside it.
    pub fn symbol(symbol: &str, title: &str) -> Self {
        Self::new(Content::Symbol(symbol.to_owned(), title.to_owned()))
    }

    /// As the campaign states it.
    pub fn given(text: String) -> Self {
        Self::new(Content::Given(text))
    }

    /// A dash for none.
    pub fn number(value: impl Into<Option<f64>>, format: Format) -> Self {
        value.into().map_or(Self::MISSING, |value| Self::new(Content::Number(value, format)))
    }

    pub fn finding(finding: Finding) -> Self {
        Self::text(Run::Finding(finding))
    }

    /// A dash for none.
    pub fn or_missing<T: Into<Self>>(value: Option<T>) -> Self {
        value.map_or(Self::MISSING, Into::into)
    }

    pub fn toned(self, tone: Tone) -> Self {
        Self { tone: Some(tone), ..self }
    }

    pub fn strong(self) -> Self {
        Self { strong: true, ..self }
    }

    pub fn across(self, columns: usize) -> Self {
        Self { across: columns, ..self }
    }

    pub fn down(self, rows: usize) -> Self {
        Self { down: rows, ..self }
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        matches!(self.content, Content::Missing | Content::Blank)
    }

    /// As printed.
    pub fn printed(&self) -> Text {
        match &self.content {
            Content::Missing => number::NONE.into(),
            Content::Blank => Text::default(),
            Content::Text(text) => text.clone(),
            Content::Formula(formula) => number::formula(formula).into(),
            Content::Sentence(sentence) => number::raised(sentence).into(),
            Content::Symbol(symbol, title) => Run::Symbol(Symbol::new(symbol).titled(title)).into(),
            Content::Number(value, format) => format.print(*value).into(),
            Content::Given(text) => number::given(text).into(),
            Content::Flag(flag) => if *flag { "yes" } else { "no" }.into(),
        }
    }

    /// As in a file: numbers in full precision.
    pub fn in_file(&self) -> String {
        match &self.content {
            Content::Missing | Content::Blank => String::new(),
            Content::Text(text) => text.letters(),
            Content::Formula(text)
            | Content::Sentence(text)
            | Content::Symbol(text, _)
            | Content::Given(text) => text.clone(),
            Content::Number(value, _) => value.to_string(),
            Content::Flag(flag) => flag.to_string(),
        }
    }
}

impl From<Text> for Cell {
    fn from(text: Text) -> Self {
        Self::text(text)
    }
}

impl From<Run> for Cell {
    fn from(run: Run) -> Self {
        Self::text(run)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::text(text)
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::text(text)
    }
}

impl From<Option<String>> for Cell {
    fn from(text: Option<String>) -> Self {
        text.map_or(Self::BLANK, Self::text)
    }
}

impl From<Reason> for Cell {
    fn from(reason: Reason) -> Self {
        Self::text(String::from(reason.text()))
    }
}

impl From<Option<Reason>> for Cell {
    fn from(reason: Option<Reason>) -> Self {
        reason.map_or(Self::BLANK, Self::from)
    }
}

impl From<Finding> for Cell {
    fn from(finding: Finding) -> Self {
        Self::finding(finding)
    }
}

impl From<bool> for Cell {
    fn from(flag: bool) -> Self {
        Self::new(Content::Flag(flag))
    }
}

impl From<Option<bool>> for Cell {
    fn from(flag: Option<bool>) -> Self {
        flag.map_or(Self::BLANK, Self::from)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::number(count as f64, Format::Fixed(0))
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::number(value, Format::Significant(DIGITS))
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        Self::number(value, Format::Significant(DIGITS))
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::number(count as f64, Format::Count)
    }
}

impl From<Cow<'_, str>> for Cell {
    fn from(text: Cow<'_, str>) -> Self {
        text.into_owned().into()
    }
}

/// From what is printed in one way.
macro_rules! from_printed {
    ($($kind:ty),*) => {
        $(impl From<$kind> for Cell {
            fn from(from: $kind) -> Self {
                from.to_string().into()
            }
        })*
    };
}

from_printed!(Scope, StatisticName, RecordName);

impl From<Option<RecordName>> for Cell {
    fn from(name: Option<RecordName>) -> Self {
        name.map(|name| name.to_string()).into()
    }
}

/// Digits of a number of which nothing else is known.
const DIGITS: usize = 6;

/// From what is borrowed.
macro_rules! from_borrowed {
    ($($kind:ty),*) => {
        $(impl From<&$kind> for Cell {
            fn from(from: &$kind) -> Self {
                from.clone().into()
            }
        })*
    };
}

from_borrowed!(
    Reason,
    Option<Reason>,
    Cell,
    Text,
    Run,
    Finding,
    &str,
    &String,
    String,
    Option<String>,
    f64,
    Option<f64>,
    bool,
    Option<bool>,
    usize,
    u64,
    Cow<'_, str>,
    Scope,
    StatisticName,
    RecordName,
    Option<RecordName>
);

/// The cells of a row, each from anything that a cell can be made of.
macro_rules! cells {
    ($($cell:expr),* $(,)?) => { vec![$($crate::report::document::Cell::from(&$cell)),*] };
}

pub(crate) use cells;
