//! A mapping: what the channels of foreign records are in a campaign, as an engineer states it in a
//! YAML file.

pub mod agree;
mod channels;
mod convention;
mod distance;
mod paths;
mod read;
mod runs;
mod sections;
mod side;
mod slips;
mod stated;

use std::sync::Arc;

pub use channels::{ChannelMap, Channels, Term};
pub use convention::{
    Common, Convention, Opposite, Order, Quantity, Turning, find as find_convention,
};
pub use distance::{Distance, Jumps, Match, Time};
pub use paths::Paths;
pub use read::read;
pub use runs::{Drift, Runs};
pub use sections::{Sections, record_path};
pub use side::{Side, Turned};
pub use stated::Stated;

use crate::data::{CampaignPath, RecordKind};
use crate::problem::Problem;
use crate::source::{Source, Span, Spanned};
use crate::yaml::{Key, Node};

/// A checked mapping. Nothing of the records has been read yet.
#[derive(Debug)]
pub struct Mapping {
    pub source: Arc<Source>,
    /// What paths are relative to.
    pub paths: Paths,
    /// Name of the campaign.
    pub name: Spanned<String>,
    pub protocol: Option<Spanned<String>>,
    /// Further keys of `campaign.yaml`, as written.
    pub campaign: Vec<(Key, Node)>,
    /// What is imported: sections, or whole runs.
    pub sections: Sections,
    /// Where whole runs are imported.
    pub runs: Option<Runs>,
    /// The vehicle file as written, and its content.
    pub vehicle: Option<(Spanned<String>, Node)>,
    /// Files copied as they are.
    pub copies: Vec<Spanned<String>>,
    /// Path of the track file of a section or run, with `{section}` or `{run}`.
    pub track: Option<Spanned<String>>,
    /// Distance kept before and after each section, in m; the whole record where it is not stated.
    pub margin: Option<f64>,
    pub turning: Option<Turning>,
    pub sides: Vec<Side>,
}

impl Mapping {
    pub fn side(&self, kind: RecordKind) -> Option<&Side> {
        self.sides.iter().find(|side| side.kind == kind)
    }

    /// The file of a section or run, by a pattern of the mapping.
    ///
    /// # Errors
    /// As [`Paths::place`].
    pub fn place_of(
        &self,
        pattern: &Spanned<String>,
        section: &str,
    ) -> Result<CampaignPath, Problem> {
        self.paths.place(&self.sections.fill(&pattern.value, section), &pattern.span)
    }

    /// Start of the text, for problems of what is missing.
    pub fn top(&self) -> Span {
        self.source.span(0..0)
    }
}
