//! Where a file of a campaign is.

use std::path::PathBuf;

/// A file or folder of the campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignPath {
    /// Path of the file.
    pub path: PathBuf,
    /// Name for messages: the folder as given by the user, and the path inside.
    pub shown: String,
    /// Path inside the campaign, with `/` on all systems; the name in results.
    pub inside: String,
}

impl CampaignPath {
    /// The path of a file in this folder, inside the campaign; the folder may be that of the
    /// campaign itself.
    pub fn below(&self, name: &str) -> String {
        if self.inside.is_empty() { name.to_string() } else { format!("{}/{name}", self.inside) }
    }
}
