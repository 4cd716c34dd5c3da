//! Files attached to a report: its numbers and the protocol, so that the evaluation can be repeated
//! from the report alone.

use super::pdf::Attachment;
use crate::result::{Certification, ProtocolFile};

/// Name of the results attached to a PDF.
pub const RESULTS: &str = "results.json";

/// Name of an attached file of the protocol; number 0 is the protocol, 1 its parent, and so on. The
/// number distinguishes files of the same name from different folders.
pub fn protocol_name(at: usize, name: &str) -> String {
    let plain = |sign: char| sign.is_ascii_alphanumeric() || matches!(sign, '.' | '-' | '_');
    let plain: String = name.chars().map(|sign| if plain(sign) { sign } else { '_' }).collect();
    format!("protocol-{}-{plain}", at + 1)
}

/// All attachments of a certification report.
pub fn attachments<'a>(
    found: &'a Certification,
    results: &'a str,
    names: &'a [String],
) -> Vec<Attachment<'a>> {
    let numbers = Attachment {
        name: RESULTS,
        mime: "application/json",
        bytes: results.as_bytes(),
        description: "Every number of this report",
    };
    let protocol = |(at, (name, file)): (usize, (&'a String, &'a ProtocolFile))| Attachment {
        name,
        mime: if file.name.ends_with(".fp") { "text/plain" } else { "application/yaml" },
        bytes: file.text.as_bytes(),
        description: match at {
            0 => "The protocol that was evaluated",
            1 => "The protocol that it extends",
            _ => "A protocol that its parent extends",
        },
    };
    std::iter::once(numbers)
        .chain(names.iter().zip(&found.protocol.files).enumerate().map(protocol))
        .collect()
}

/// The names of the protocol's files for [`attachments`].
pub fn protocol_names(found: &Certification) -> Vec<String> {
    found
        .protocol
        .files
        .iter()
        .enumerate()
        .map(|(at, file)| protocol_name(at, &file.name))
        .collect()
}
