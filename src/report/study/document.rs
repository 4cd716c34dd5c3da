//! What a study's templates are filled from. They place and do not calculate; texts of users are data in it.

use serde::Serialize;

use crate::report::view::{CampaignView, Fact, FigureView, Finding, ProtocolView};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    pub title: String,
    /// What was studied.
    pub kind: String,
    pub program: String,
    pub headline: Finding,
    pub sentence: String,
    pub key_facts: Vec<Fact>,
    /// Symbols of the quantities, which the PDF and the page set with subscripts.
    pub symbols: Vec<String>,
    pub campaign: CampaignView,
    pub protocol: ProtocolView,
    pub chapters: Vec<Chapter>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chapter {
    /// Anchor; program text only.
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

    pub fn figure(name: impl Into<String>, caption: impl Into<String>, alt: impl Into<String>) -> Self {
        Self::Figure { figure: FigureView { name: name.into(), caption: caption.into(), alt: alt.into() } }
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
    /// Set to the right.
    pub numeric: bool,
    /// Takes the room that is left.
    pub wide: bool,
}

impl Head {
    pub fn text(title: &str) -> Self {
        Self { title: title.into(), numeric: false, wide: true }
    }

    /// No wider than its texts.
    pub fn short(title: &str) -> Self {
        Self { title: title.into(), numeric: false, wide: false }
    }

    pub fn number(title: &str) -> Self {
        Self { title: title.into(), numeric: true, wide: false }
    }
}
