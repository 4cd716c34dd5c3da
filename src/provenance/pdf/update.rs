//! What follows the end of a PDF as it was written: a signature that is not shown on a page, or
//! anything else.
//!
//! A signature is an update of the file (ISO 32000-1, clauses 7.5.6 and 12.8): new objects, and the
//! catalogue and a page that name its field. Programs mend damaged files in different ways. Every byte
//! must therefore belong to an update, and every object be where the table of the update has it.

use std::collections::BTreeMap;

use super::{
    Broken,
    document::{Document, ObjectPosition},
    object::{Dict, Object, Parser, is_space},
};

/// What a signature changes in the catalogue; none of it is painted.
const OF_CATALOGUE: [&str; 5] = ["AcroForm", "DSS", "Extensions", "Perms", "Version"];
/// The keys of the field of a signature, which is an annotation at the same time.
const OF_FIELD: [&str; 12] =
    ["AP", "F", "FT", "Lock", "MK", "P", "Rect", "SV", "Subtype", "T", "Type", "V"];
const OF_TRAILER: [&str; 5] = ["ID", "Info", "Prev", "Root", "Size"];
const END: &[u8] = b"%%EOF";

/// A PDF to which nothing but signatures was added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Where it ended when it was written.
    pub end: usize,
    /// Whether a signature follows.
    pub signed: bool,
}

/// Where the first version of a file ends, and what follows.
///
/// # Errors
/// In words: what follows is not a signature, or more than one.
pub fn written(bytes: &[u8]) -> Result<Written, String> {
    let told = |Broken(says)| says.to_string();
    let end = first_end(bytes).ok_or("its end is missing")?;
    if end == bytes.len() {
        return Ok(Written { end, signed: false });
    }
    let before = Document::open(&bytes[..end]).map_err(told)?;
    let after = Document::open(bytes).map_err(told)?;
    let (objects, starts, ends) = (BTreeMap::new(), before.starts.clone(), Vec::new());
    let mut update = Update { bytes, before, after, objects, starts, ends };
    update.read(end).map_err(|Broken(says)| {
        format!("{} bytes after the end are no update: {says}", bytes.len() - end)
    })?;
    update.check()?;
    Ok(Written { end, signed: true })
}

/// Behind the first `startxref`, number, `%%EOF` and line break.
fn first_end(bytes: &[u8]) -> Option<usize> {
    const START: &[u8] = b"startxref";
    let end = |at: usize| {
        let rest = bytes.get(at + START.len()..)?;
        let digits = rest.iter().take_while(|byte| is_space(**byte) || byte.is_ascii_digit());
        let length = digits.count();
        let behind = rest[length..].strip_prefix(END)?;
        let line = [&b"\r\n"[..], b"\n", b"\r"].into_iter().find(|line| behind.starts_with(line));
        let length = length + END.len() + line.map_or(0, <[u8]>::len);
        Some(at + START.len() + length)
    };
    memchr::memmem::find_iter(bytes, START).find_map(end)
}

/// All that follows the first end.
struct Update<'a> {
    bytes: &'a [u8],
    before: Document<'a>,
    after: Document<'a>,
    /// Every version of each object in the order of the file.
    objects: BTreeMap<u32, Vec<Version>>,
    /// Where the tables begin, the newest first.
    starts: Vec<usize>,
    /// Where each update ends.
    ends: Vec<usize>,
}

/// An object of an update.
struct Version {
    at: usize,
    object: Object,
    /// Data follow, which are not compared.
    is_stream: bool,
}

impl Update<'_> {
    /// Reads updates to the end of the file.
    fn read(&mut self, from: usize) -> Result<(), Broken> {
        let bytes = self.bytes;
        let blank = |at: usize| at + bytes[at..].iter().take_while(|byte| is_space(**byte)).count();
        let mut at = blank(from);
        while at < bytes.len() {
            let mut parser = self.after.parser(at);
            if parser.word("xref") {
                self.table(&mut parser, at)?;
                let end = blank(parser.at);
                self.starts.insert(0, at);
                if !bytes[end..].starts_with(END) {
                    return Err(Broken("its end is missing"));
                }
                at = end + END.len();
                self.ends.push(at);
            } else {
                let (number, object, is_stream) = object(&mut parser)?;
                let end = parser.at;
                let version = Version { at, object, is_stream };
                self.objects.entry(number).or_default().push(version);
                at = end;
            }
            at = blank(at);
        }
        if self.ends.is_empty() { Err(Broken("it has no table of places")) } else { Ok(()) }
    }

    /// A table of places, which leaves the root of the file where it is.
    fn table(&self, parser: &mut Parser<'_>, at: usize) -> Result<(), Broken> {
        while !parser.word("trailer") {
            let (_, count) = (parser.integer()?, parser.integer()?);
            parser.space();
            parser.at = parser.at.saturating_add(count.saturating_mul(20));
        }
        let Object::Dict(trailer) = parser.object(0)? else {
            return Err(Broken("its trailer is missing"));
        };
        let same = trailer.get("Root") == self.before.trailer.get("Root");
        if !trailer.only(&OF_TRAILER) || !same {
            return Err(Broken("its trailer changes more than a signature does"));
        }
        if !parser.word("startxref") || parser.integer()? != at {
            return Err(Broken("its table is not where it says"));
        }
        Ok(())
    }

    /// Whether only signatures were added.
    fn check(&self) -> Result<(), String> {
        let told = |Broken(says)| says.to_string();
        if self.starts != self.after.starts {
            return Err("its tables of places do not follow each other".into());
        }
        for number in self.after.updated(&self.before).map_err(told)? {
            let number = u32::try_from(number).map_err(|_| "an object has no number")?;
            let there = self.after.place(number).map_err(told)?;
            let found = self.objects.get(&number).and_then(|all| all.last());
            let moved = match (there, found) {
                (ObjectPosition::At(at), Some(version)) => at != version.at,
                (ObjectPosition::Free, None) => self.is_known(number)?,
                _ => true,
            };
            if moved {
                return Err(format!("object {number} is not where it was, nor in the update"));
            }
        }
        let mut signatures = 0;
        for (number, versions) in &self.objects {
            for version in versions {
                if self.is_known(*number)? {
                    self.changed(*number, version)?;
                }
                if self.after.place(*number).map_err(told)? == ObjectPosition::Free {
                    return Err(format!("object {number} is in no table"));
                }
                signatures += usize::from(self.is_signature(&version.object));
            }
        }
        if signatures == 0 { Err("no signature is added".into()) } else { Ok(()) }
    }

    /// Whether an object was there before.
    fn is_known(&self, number: u32) -> Result<bool, String> {
        let place = self.before.place(number).map_err(|Broken(says)| says)?;
        Ok(place != ObjectPosition::Free)
    }

    /// Whether a new version of an object differs by what a signature needs only.
    fn changed(&self, number: u32, version: &Version) -> Result<(), String> {
        let told = |Broken(says)| says.to_string();
        let is = |object: Option<&Object>| object == Some(&Object::Reference(number));
        let old = self.before.object(number).map_err(told)?;
        let root = self.before.get(&self.before.trailer, "Root").map_err(told)?;
        let metadata = if let Object::Dict(root) = &root { root.get("Metadata") } else { None };
        // Producer and times; neither is on a page.
        if is(self.before.trailer.get("Info")) || is(metadata) {
            return Ok(());
        }
        let (Object::Dict(old), Object::Dict(new), false) =
            (&old, &version.object, version.is_stream)
        else {
            return Err(format!("an object is changed (object {number})"));
        };
        let (what, allowed) = if is(self.before.trailer.get("Root")) {
            let form = self.form_is_of_signatures(new)?;
            ("the catalogue", form && new.same_but(old, &OF_CATALOGUE))
        } else if old.get("Type").is_some_and(|kind| kind.is_name("Page")) {
            ("a page", self.adds_fields(old, new)? && new.same_but(old, &["Annots"]))
        } else {
            ("an object", false)
        };
        if allowed { Ok(()) } else { Err(format!("{what} is changed (object {number})")) }
    }

    /// Whether the annotations of a page are those before, and fields of signatures.
    fn adds_fields(&self, old: &Dict, new: &Dict) -> Result<bool, String> {
        let list = |document: &Document<'_>, page: &Dict| match document.get(page, "Annots") {
            Ok(Object::Array(all)) => Ok(all),
            Ok(_) => Ok(Vec::new()),
            Err(Broken(says)) => Err(says.to_string()),
        };
        let (old, new) = (list(&self.before, old)?, list(&self.after, new)?);
        let more = new.strip_prefix(old.as_slice()).unwrap_or_default();
        Ok(new.starts_with(&old) && more.iter().all(|field| self.is_field(field)))
    }

    fn form_is_of_signatures(&self, catalogue: &Dict) -> Result<bool, String> {
        let told = |Broken(says)| says.to_string();
        let Object::Dict(form) = self.after.get(catalogue, "AcroForm").map_err(told)? else {
            return Ok(catalogue.get("AcroForm").is_none());
        };
        let Object::Array(fields) = self.after.get(&form, "Fields").map_err(told)? else {
            return Ok(false);
        };
        Ok(form.only(&["Fields", "SigFlags"]) && fields.iter().all(|field| self.is_field(field)))
    }

    /// Whether an object is the field of a signature that is not shown: it has no area.
    fn is_field(&self, object: &Object) -> bool {
        let Ok(Object::Dict(field)) = self.after.resolved(object) else { return false };
        let is = |key: &str, name: &str| field.get(key).is_some_and(|value| value.is_name(name));
        let zero = |side: &Object| *side == Object::Integer(0) || *side == Object::Real(0.0);
        let empty = match field.get("Rect") {
            Some(Object::Array(sides)) => sides.len() == 4 && sides.iter().all(zero),
            _ => false,
        };
        field.only(&OF_FIELD) && is("FT", "Sig") && is("Subtype", "Widget") && empty
    }

    /// Whether an object is a signature over all bytes of the file up to the end of its update.
    fn is_signature(&self, object: &Object) -> bool {
        let Object::Dict(dict) = object else { return false };
        let Some(Object::Array(range)) = dict.get("ByteRange") else { return false };
        let range: Option<Vec<usize>> = range.iter().map(Object::integer).collect();
        let Some([0, first, second, length]) = range.as_deref() else { return false };
        let gap = self.bytes.get(*first..*second).unwrap_or_default();
        let hexadecimal = |byte: &u8| byte.is_ascii_hexdigit();
        let content = gap.strip_prefix(b"<").and_then(|gap| gap.strip_suffix(b">"));
        let end = second.saturating_add(*length);
        content.is_some_and(|digits| digits.iter().all(hexadecimal))
            && self.ends.iter().any(|known| (*known..=known + 2).contains(&end))
    }
}

/// An object with its number, and whether it is a stream.
fn object(parser: &mut Parser<'_>) -> Result<(u32, Object, bool), Broken> {
    let (number, _) = (parser.integer()?, parser.integer()?);
    let number = u32::try_from(number).map_err(|_| Broken("an object has no number"))?;
    if !parser.word("obj") {
        return Err(Broken("it has something else than objects"));
    }
    let object = parser.object(0)?;
    if !object.is_unique() {
        return Err(Broken("a key stands twice in a dictionary"));
    }
    let is_stream = parser.word("stream");
    if is_stream {
        let length = match &object {
            Object::Dict(dict) => dict.get("Length").and_then(Object::integer),
            _ => None,
        };
        let start = parser.at;
        let line = [&b"\r\n"[..], b"\n"];
        let rest = parser.bytes.get(start..).unwrap_or_default();
        let line = line.iter().find(|line| rest.starts_with(line));
        let (line, length) = line.zip(length).ok_or(Broken("a stream has no length"))?;
        parser.at = start.saturating_add(line.len()).saturating_add(length);
        if !parser.word("endstream") {
            return Err(Broken("a stream does not end where it says"));
        }
    }
    if parser.word("endobj") {
        Ok((number, object, is_stream))
    } else {
        Err(Broken("an object does not end"))
    }
}
