//! Cells of tables: what they contain, and how it is printed.

use super::{
    finding::{Finding, Tone},
    symbol::Symbol,
    text::{Run, Text},
};
use crate::report::number;
use crate::result::{Reason, Scope, StatisticName};

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
    /// A number in full precision.
    Number(f64, Format),
    /// A number or a word as the campaign states it.
    Given(String),
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

    /// A formula or condition as written; printed with true signs.
    pub fn formula(formula: impl AsRef<str>) -> Self {
        Self::text(number::formula(formula.as_ref()))
    }

    /// A sentence as written; its numbers and units are printed as in tables.
    pub fn sentence(sentence: impl Into<String>) -> Self {
        Self::text(number::raised(sentence.into()))
    }

    /// The symbol of a quantity, and its title if that is not beside it.
    pub fn symbol(symbol: &str, title: &str) -> Self {
        Self::text(Run::Symbol(Symbol::new(symbol).titled(title)))
    }

    /// As the campaign states it.
    pub fn given(text: String) -> Self {
        Self::new(Content::Given(text))
    }

    /// A dash for none.
    pub fn number(value: impl Into<Option<f64>>, format: Format) -> Self {
        value.into().map_or(Self::MISSING, |value| Self::new(Content::Number(value, format)))
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
            Content::Number(value, format) => format.print(*value).into(),
            Content::Given(text) => number::given(text).into(),
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

impl From<Reason> for Cell {
    fn from(reason: Reason) -> Self {
        Self::text(reason.text().to_string())
    }
}

impl From<Finding> for Cell {
    fn from(finding: Finding) -> Self {
        Self::text(Run::Finding(finding))
    }
}

impl From<Scope> for Cell {
    fn from(scope: Scope) -> Self {
        Self::text(scope.to_string())
    }
}

impl From<StatisticName> for Cell {
    fn from(name: StatisticName) -> Self {
        Self::text(name.to_string())
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::number(count as f64, Format::Fixed(0))
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::number(count as f64, Format::Count)
    }
}

/// Nothing for none.
impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(some: Option<T>) -> Self {
        some.map_or(Self::BLANK, Into::into)
    }
}

impl<T: Clone + Into<Self>> From<&T> for Cell {
    fn from(of: &T) -> Self {
        of.clone().into()
    }
}

/// The cells of a row, each from anything that a cell can be made of.
macro_rules! cells {
    ($($cell:expr),* $(,)?) => { vec![$($crate::report::document::Cell::from(&$cell)),*] };
}

pub(crate) use cells;
