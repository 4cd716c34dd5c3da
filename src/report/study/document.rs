//! Input of the templates of a study. The templates place it and do not calculate; user texts are
//! data.

use serde::Serialize;

use crate::report::view::{CampaignView, Fact, FigureView, Finding, ProtocolView};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    pub title: String,
    /// Subject of the study.
    pub kind: String,
    pub program: String,
    pub headline: Finding,
    pub sentence: String,
    pub key_facts: Vec<Fact>,
    /// Symbols of the quantities, which are printed with subscripts.
    pub symbols: Vec<String>,
    pub campaign: CampaignView,
    pub protocol: ProtocolView,
    pub chapters: Vec<Chapter>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chapter {
    /// Anchor; not user text.
    pub id: String,
    pub title: String,
    pub items: Vec<Item>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Item {
    Text { text: String },
    Heading { text: String },
    List { entries: Vec<String> },
    Figure { figure: FigureView },
    Table { table: Table },
}

impl Item {
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text { text: text.into() }
    }

    pub fn figure(
        name: impl Into<String>,
        caption: impl Into<String>,
        alt: impl Into<String>,
    ) -> Self {
        Self::Figure {
            figure: FigureView { name: name.into(), caption: caption.into(), alt: alt.into() },
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Table {
    pub caption: String,
    pub head: Vec<Head>,
    pub rows: Vec<Vec<String>>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Head {
    pub title: String,
    /// Aligned to the right.
    pub numeric: bool,
    /// Takes the remaining width.
    pub wide: bool,
}

impl Head {
    pub fn text(title: &str) -> Self {
        Self { title: title.into(), numeric: false, wide: true }
    }

    /// Not wider than its texts.
    pub fn short(title: &str) -> Self {
        Self { title: title.into(), numeric: false, wide: false }
    }

    pub fn number(title: &str) -> Self {
        Self { title: title.into(), numeric: true, wide: false }
    }
}
