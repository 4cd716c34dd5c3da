//! A campaign that is being opened: its folder, and the files that were read in it.

use std::sync::Arc;

use crate::data::{folder::Folder, place::CampaignPath, prelude::*, table::Table};
use crate::yaml;

/// A file that was read, and its fingerprint.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadFile {
    /// Inside the campaign, with `/`.
    pub path: String,
    pub sha256: String,
    pub bytes: u64,
    /// How the record differs from the one that an import wrote.
    pub changed: Option<Changed>,
}

/// A record that is not as an import wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// The import wrote a record in this place.
    pub imported: bool,
    /// What `campaign.yaml` says of it.
    pub reason: Option<String>,
}

/// The folder of a campaign that is being opened, and what was read in it so far.
#[derive(Debug)]
pub struct Opening<'a> {
    pub folder: Folder,
    pub files: Vec<ReadFile>,
    /// The whole of `campaign.yaml`.
    pub tree: Option<&'a Node>,
}

/// Reads what `campaign.yaml` says.
pub type Reader<'a, 'o> = yaml::Reader<'a, Opening<'o>>;

impl Reader<'_, '_> {
    /// The tree of a YAML file. `named`: where the file is named, if it is.
    pub fn yaml(
        &mut self,
        place: &CampaignPath,
        named: Option<&Span>,
    ) -> Option<(Arc<Source>, Node)> {
        let read = self.with.folder.read_text(place).map_err(|problem| match named {
            Some(span) => problem.or_at(span),
            None => problem,
        });
        let (source, sha256, bytes) = self.keep(read)?;
        self.with.files.push(ReadFile { path: place.inside.clone(), sha256, bytes, changed: None });
        let tree = yaml::load(&source, self.problems)?;
        Some((source, tree))
    }

    /// Where a file is that `campaign.yaml` names, and the place of its name.
    fn named(&mut self, key: &Key, node: &Node) -> Option<(CampaignPath, Span)> {
        let Spanned { value, span } = Spanned::<String>::from_node(self, key, node)?;
        let place = self.with.folder.place(&value, &span);
        Some((self.keep(place)?, span))
    }

    /// The tree of a YAML file that `campaign.yaml` names.
    pub fn named_yaml(&mut self, key: &Key, node: &Node) -> Option<Node> {
        let (place, span) = self.named(key, node)?;
        Some(self.yaml(&place, Some(&span))?.1)
    }

    /// A table that `campaign.yaml` names; `names`: the column with the names of its rows.
    pub fn table(&mut self, key: &Key, node: &Node, names: Option<&str>) -> Option<Table> {
        let (place, span) = self.named(key, node)?;
        let mut found = Problems::default();
        let read = self.with.folder.read_text(&place).map_err(|problem| found.push(problem)).ok();
        let table = read.and_then(|(source, sha256, bytes)| {
            Some((Table::parse(source, sha256, names, &mut found)?, bytes))
        });
        self.problems.add(found.0.into_iter().map(|problem| problem.or_at(&span)));
        let (table, bytes) = table?;
        let sha256 = table.sha256.clone();
        self.with.files.push(ReadFile { path: place.inside, sha256, bytes, changed: None });
        Some(table)
    }
}
