//! Files attached to a report: its numbers and the protocol, so that the evaluation can be repeated
//! from the report alone.

use super::pdf::Attachment;
use crate::result::{Certification, ProtocolFile};

/// Name of the results attached to a PDF.
pub const RESULTS: &str = "results.json";

/// All attachments of a certification report.
pub fn attachments<'a>(found: &'a Certification, results: &'a str) -> Vec<Attachment<'a>> {
    let numbers = Attachment {
        name: RESULTS,
        mime: "application/json",
        bytes: results.as_bytes(),
        description: "Every number of this report",
    };
    let protocol = |(at, file): (usize, &'a ProtocolFile)| Attachment {
        name: &file.attached,
        mime: if file.name.ends_with(".fp") { "text/plain" } else { "application/yaml" },
        bytes: file.text.as_bytes(),
        description: match at {
            0 => "The protocol that was evaluated",
            _ => "A text that the protocol extends or uses",
        },
    };
    std::iter::once(numbers).chain(found.protocol.files.iter().enumerate().map(protocol)).collect()
}
