//! Files attached to a PDF of any origin, also a damaged one, in bounded time and memory and
//! without a panic.
//!
//! Existing PDF libraries read more, but unpack streams without a limit. This module reads only the
//! path to the attachments (ISO 32000-1, clause 7.11.4), with a limit for every step.

mod document;
mod object;
mod stream;
mod update;

use document::Document;
use object::{Dict, Object};
pub use update::{Written, written};

use crate::problem::Problem;

/// Maximum number of nodes of the name tree; a report has one.
const BRANCHES: usize = 1000;

/// The fault of a PDF, as text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Broken(&'static str);

/// The attachments of a PDF.
#[derive(Debug)]
pub struct Attachments<'a> {
    document: Document<'a>,
    /// Name without folders, and the object number of its data.
    found: Vec<(String, u32)>,
    shown: String,
}

impl<'a> Attachments<'a> {
    /// Finds the attachments; none is unpacked yet.
    ///
    /// # Errors
    /// `pdf-unreadable`: not a PDF, damaged, or encrypted.
    pub fn of(bytes: &'a [u8], shown: &str) -> Result<Self, Problem> {
        if bytes
            .get(..1024.min(bytes.len()))
            .is_none_or(|head| memchr::memmem::find(head, b"%PDF-").is_none())
        {
            return Err(Problem::error("pdf-unreadable", format!("`{shown}` is not a PDF")));
        }
        let broken = |broken: Broken| {
            Problem::error("pdf-unreadable", format!("`{shown}` cannot be read: {}", broken.0))
                .help("the file may be truncated or damaged; compare its size with the original, or give results.json instead")
        };
        let document = Document::open(bytes).map_err(broken)?;
        if document.trailer.get("Encrypt").is_some() {
            let problem = Problem::error("pdf-unreadable", format!("`{shown}` is encrypted"));
            return Err(problem.help("give the report as it was written; it is never encrypted"));
        }
        let found = listed(&document).map_err(broken)?;
        Ok(Self { document, found, shown: shown.to_string() })
    }

    /// Each name once: a file is listed by its name and as an associated file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let first = |at: usize| self.found[..at].iter().all(|(name, _)| *name != self.found[at].0);
        self.found
            .iter()
            .enumerate()
            .filter(move |(at, _)| first(*at))
            .map(|(_, (name, _))| name.as_str())
    }

    /// The data of the first attachment with a name; `None` if there is none.
    ///
    /// # Errors
    /// `pdf-unreadable`, including data of more than `most` bytes.
    pub fn read(&self, name: &str, most: usize) -> Result<Option<Vec<u8>>, Problem> {
        let Some((_, number)) = self.found.iter().find(|(known, _)| known == name) else {
            return Ok(None);
        };
        let unreadable = |broken: Broken| {
            Problem::error(
                "pdf-unreadable",
                format!("`{name}` inside `{}` cannot be read: {}", self.shown, broken.0),
            )
        };
        self.document.stream(*number, most).map(Some).map_err(unreadable)
    }
}

/// The files of the name tree, and those in the list of associated files.
fn listed(document: &Document<'_>) -> Result<Vec<(String, u32)>, Broken> {
    let Object::Dict(catalogue) = document.get(&document.trailer, "Root")? else {
        return Err(Broken("its catalogue is missing"));
    };
    let mut found = Vec::new();
    let mut open = Vec::new();
    if let Object::Dict(names) = document.get(&catalogue, "Names")? {
        open.push(document.get(&names, "EmbeddedFiles")?);
    }
    let mut looked_at = 0;
    while let Some(branch) = open.pop() {
        looked_at += 1;
        if looked_at > BRANCHES {
            return Err(Broken("its list of attached files is too long"));
        }
        let Object::Dict(branch) = branch else { continue };
        if let Object::Array(kids) = document.get(&branch, "Kids")? {
            for kid in kids.iter().take(BRANCHES) {
                open.push(document.resolved(kid)?);
            }
        }
        if let Object::Array(pairs) = document.get(&branch, "Names")? {
            for file in pairs.chunks_exact(2) {
                found.extend(file_of(document, &file[1])?);
            }
        }
    }
    if let Object::Array(files) = document.get(&catalogue, "AF")? {
        for file in &files {
            found.extend(file_of(document, file)?);
        }
    }
    Ok(found)
}

fn file_of(document: &Document<'_>, object: &Object) -> Result<Option<(String, u32)>, Broken> {
    let Object::Dict(file) = document.resolved(object)? else { return Ok(None) };
    let name = name_of(document, &file)?;
    let Object::Dict(embedded) = document.get(&file, "EF")? else { return Ok(None) };
    let data = embedded.get("F").or(embedded.get("UF"));
    Ok(match (name, data) {
        (Some(name), Some(Object::Reference(number))) => Some((name, *number)),
        _ => None,
    })
}

fn name_of(document: &Document<'_>, file: &Dict) -> Result<Option<String>, Broken> {
    for key in ["UF", "F"] {
        if let Object::Text(text) = document.get(file, key)? {
            let text = match text.strip_prefix(b"\xfe\xff") {
                Some(wide) => {
                    let units: Vec<u16> = wide
                        .chunks_exact(2)
                        .map(|pair| u16::from_be_bytes([pair[0], pair[1]]))
                        .collect();
                    String::from_utf16_lossy(&units)
                }
                None => String::from_utf8_lossy(&text).into_owned(),
            };
            return Ok(text.rsplit(['/', '\\']).next().map(str::to_string));
        }
    }
    Ok(None)
}
