//! Positions of the objects of a PDF: cross-reference tables and streams (ISO 32000-1, clause 7.5),
//! the newest first.

use std::{
    cell::{Cell, RefCell},
    collections::BTreeMap,
};

use super::{
    Broken,
    object::{Dict, Object, Parser},
    stream::unpacked,
};

/// Maximum number of objects read; the path to the attachments of a report has about fifty.
const OBJECTS: usize = 200_000;
/// Maximum unpacked size of all cross-reference and object streams in bytes.
const STRUCTURE: usize = 64 << 20;
/// Maximum number of incremental updates of a file; a signature adds one.
const VERSIONS: usize = 64;
/// Maximum length of a chain of references.
const STEPS: usize = 8;

#[derive(Debug)]
pub struct Document<'a> {
    bytes: &'a [u8],
    budget: Cell<usize>,
    structure: Cell<usize>,
    /// Depth of nested reads.
    depth: Cell<usize>,
    tables: Vec<Table>,
    /// Where the tables begin, the newest first.
    pub starts: Vec<usize>,
    pub trailer: Dict,
    /// Unpacked object streams.
    groups: RefCell<BTreeMap<u32, Vec<u8>>>,
}

/// Cross-references of one update.
#[derive(Debug)]
enum Table {
    /// First number, count, and position of the first line of 20 bytes.
    Lines(Vec<(usize, usize, usize)>),
    Packed {
        rows: Vec<u8>,
        widths: [usize; 3],
        numbers: Vec<(usize, usize)>,
    },
}

/// Position of one object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObjectPosition {
    Free,
    At(usize),
    /// In an object stream, at this index.
    In(u32, usize),
}

impl<'a> Document<'a> {
    pub fn open(bytes: &'a [u8]) -> Result<Self, Broken> {
        let mut document = Self {
            bytes,
            budget: Cell::new(OBJECTS),
            structure: Cell::new(STRUCTURE),
            depth: Cell::new(0),
            tables: Vec::new(),
            starts: Vec::new(),
            trailer: Dict::default(),
            groups: RefCell::default(),
        };
        // The last `startxref` is in the last kilobyte of the file.
        let tail = bytes.len().saturating_sub(2048);
        let last = memchr::memmem::rfind(&bytes[tail..], b"startxref")
            .ok_or(Broken("its end is missing"))?;
        let mut next = Some(document.parser(tail + last + b"startxref".len()).integer()?);
        while let Some(at) = next {
            if document.starts.contains(&at) || document.starts.len() >= VERSIONS {
                return Err(Broken("its tables of places lead in a circle"));
            }
            document.starts.push(at);
            let trailer = document.table(at)?;
            if let Some(both) = trailer.get("XRefStm").and_then(Object::integer) {
                document.table(both)?;
            }
            next = trailer.get("Prev").and_then(Object::integer);
            document.trailer.fill(trailer);
        }
        Ok(document)
    }

    /// The numbers in the tables of all updates that another one of the same file does not have.
    ///
    /// # Errors
    /// A table is not one of lines, whose size is bounded by that of the file.
    pub fn updated(&self, before: &Self) -> Result<Vec<usize>, Broken> {
        let newer = self.tables.len().saturating_sub(before.tables.len());
        let mut numbers = Vec::new();
        for table in &self.tables[..newer] {
            let Table::Lines(parts) = table else {
                return Err(Broken("an update has a compressed table of places"));
            };
            parts
                .iter()
                .for_each(|(first, count, _)| numbers.extend(*first..first.saturating_add(*count)));
        }
        Ok(numbers)
    }

    pub fn parser(&self, at: usize) -> Parser<'_> {
        Parser { bytes: self.bytes, at, budget: &self.budget }
    }

    /// Reads the cross-references at a position; returns their dictionary.
    fn table(&mut self, at: usize) -> Result<Dict, Broken> {
        let mut parser = self.parser(at);
        if !parser.word("xref") {
            return self.packed(at);
        }
        let mut parts = Vec::new();
        while !parser.word("trailer") {
            let (first, count) = (parser.integer()?, parser.integer()?);
            parser.space();
            parts.push((first, count, parser.at));
            parser.at = count
                .checked_mul(20)
                .and_then(|length| parser.at.checked_add(length))
                .ok_or(Broken("a table is too long"))?;
        }
        let Object::Dict(trailer) = parser.object(0)? else {
            return Err(Broken("its trailer is missing"));
        };
        self.tables.push(Table::Lines(parts));
        Ok(trailer)
    }

    fn packed(&mut self, at: usize) -> Result<Dict, Broken> {
        let (dict, data) = self.stream_at(at, None)?;
        if !dict.get("Type").is_some_and(|kind| kind.is_name("XRef")) {
            return Err(Broken("its table of places is missing"));
        }
        let rows = self.structural(data, &dict)?;
        let integers = |key: &str| match dict.get(key) {
            Some(Object::Array(all)) => all.iter().map(Object::integer).collect::<Option<Vec<_>>>(),
            _ => None,
        };
        let widths = integers("W").ok_or(Broken("its table of places is damaged"))?;
        let &[a, b, c] = widths.as_slice() else {
            return Err(Broken("its table of places is damaged"));
        };
        if widths.iter().any(|width| *width > 8) || a + b + c == 0 {
            return Err(Broken("its table of places is damaged"));
        }
        let size = dict.get("Size").and_then(Object::integer).unwrap_or(0);
        let numbers = integers("Index")
            .unwrap_or_else(|| vec![0, size])
            .chunks_exact(2)
            .map(|pair| (pair[0], pair[1]))
            .collect();
        self.tables.push(Table::Packed { rows, widths: [a, b, c], numbers });
        Ok(dict)
    }

    /// Unpacks a cross-reference or object stream, within the common limit.
    fn structural(&self, data: &[u8], dict: &Dict) -> Result<Vec<u8>, Broken> {
        let found = unpacked(data, dict, self.structure.get())?;
        self.structure.set(self.structure.get() - found.len());
        Ok(found)
    }

    pub fn place(&self, number: u32) -> Result<ObjectPosition, Broken> {
        for table in &self.tables {
            if let Some(place) = table.place(number, self.bytes)? {
                return Ok(place);
            }
        }
        Ok(ObjectPosition::Free)
    }

    /// An object by its number.
    pub fn object(&self, number: u32) -> Result<Object, Broken> {
        // An object stream could contain its own length.
        if self.depth.get() >= STEPS {
            return Err(Broken("its references lead in a circle"));
        }
        self.depth.set(self.depth.get() + 1);
        let found = self.object_there(number);
        self.depth.set(self.depth.get() - 1);
        found
    }

    fn object_there(&self, number: u32) -> Result<Object, Broken> {
        match self.place(number)? {
            ObjectPosition::Free => Ok(Object::Null),
            ObjectPosition::At(at) => {
                let mut parser = self.parser(at);
                if parser.integer()? != number as usize {
                    return Err(Broken("an object is not where it should be"));
                }
                parser.integer()?;
                if !parser.word("obj") {
                    return Err(Broken("an object is not where it should be"));
                }
                parser.object(0)
            }
            ObjectPosition::In(group, index) => self.grouped(group, index),
        }
    }

    fn grouped(&self, group: u32, index: usize) -> Result<Object, Broken> {
        let ObjectPosition::At(at) = self.place(group)? else {
            return Err(Broken("a group of objects is missing"));
        };
        let (dict, data) = self.stream_at(at, Some(group))?;
        if !self.groups.borrow().contains_key(&group) {
            let found = self.structural(data, &dict)?;
            self.groups.borrow_mut().insert(group, found);
        }
        let groups = self.groups.borrow();
        let data = groups.get(&group).map_or(&[][..], Vec::as_slice);
        let first = dict
            .get("First")
            .and_then(Object::integer)
            .ok_or(Broken("a group of objects is damaged"))?;
        let mut header = Parser { bytes: data, at: 0, budget: &self.budget };
        for _ in 0..index {
            header.integer()?;
            header.integer()?;
        }
        let (_, at) = (header.integer()?, header.integer()?);
        let at = first.checked_add(at).ok_or(Broken("a group of objects is damaged"))?;
        Parser { bytes: data, at, budget: &self.budget }.object(0)
    }

    /// The target of a reference; any other object unchanged.
    pub fn resolved(&self, object: &Object) -> Result<Object, Broken> {
        let mut object = object.clone();
        for _ in 0..STEPS {
            let Object::Reference(number) = object else { return Ok(object) };
            object = self.object(number)?;
        }
        Err(Broken("its references lead in a circle"))
    }

    /// A value of a dictionary, with a reference resolved.
    pub fn get(&self, dict: &Dict, key: &str) -> Result<Object, Broken> {
        dict.get(key).map_or(Ok(Object::Null), |value| self.resolved(value))
    }

    /// The unpacked data of a stream, of at most `most` bytes.
    pub fn stream(&self, number: u32, most: usize) -> Result<Vec<u8>, Broken> {
        let ObjectPosition::At(at) = self.place(number)? else {
            return Err(Broken("the data of an attached file are missing"));
        };
        let (dict, data) = self.stream_at(at, Some(number))?;
        unpacked(data, &dict, most)
    }

    fn stream_at(&self, at: usize, number: Option<u32>) -> Result<(Dict, &'a [u8]), Broken> {
        let mut parser = self.parser(at);
        let (found, _) = (parser.integer()?, parser.integer()?);
        if number.is_some_and(|number| number as usize != found) || !parser.word("obj") {
            return Err(Broken("an object is not where it should be"));
        }
        let Object::Dict(dict) = parser.object(0)? else {
            return Err(Broken("a stream has no dictionary"));
        };
        if !parser.word("stream") {
            return Err(Broken("a stream is missing"));
        }
        let mut start = parser.at;
        start += usize::from(self.bytes.get(start) == Some(&b'\r'));
        start += usize::from(self.bytes.get(start) == Some(&b'\n'));
        let length =
            self.get(&dict, "Length")?.integer().ok_or(Broken("a stream has no length"))?;
        let end = start
            .checked_add(length)
            .filter(|end| *end <= self.bytes.len())
            .ok_or(Broken("it ends in the middle of a stream"))?;
        Ok((dict, &self.bytes[start..end]))
    }
}

impl Table {
    fn place(&self, number: u32, bytes: &[u8]) -> Result<Option<ObjectPosition>, Broken> {
        let number = number as usize;
        let damaged = Broken("its table of places is damaged");
        match self {
            Self::Lines(parts) => {
                let Some((first, _, at)) = parts
                    .iter()
                    .find(|(first, count, _)| number >= *first && number - first < *count)
                else {
                    return Ok(None);
                };
                let line = bytes
                    .get(at + 20 * (number - first)..)
                    .and_then(|rest| rest.get(..18))
                    .ok_or(damaged)?;
                let text = std::str::from_utf8(line)
                    .map_err(|_| Broken("its table of places is damaged"))?;
                let offset = text
                    .get(..10)
                    .and_then(|digits| digits.parse().ok())
                    .ok_or(Broken("its table of places is damaged"))?;
                Ok(Some(if text.as_bytes().get(17) == Some(&b'n') {
                    ObjectPosition::At(offset)
                } else {
                    ObjectPosition::Free
                }))
            }
            Self::Packed { rows, widths, numbers } => {
                let mut row = 0_usize;
                for (first, count) in numbers {
                    if number >= *first && number - first < *count {
                        let width: usize = widths.iter().sum();
                        let at = row
                            .checked_add(number - first)
                            .and_then(|row| row.checked_mul(width))
                            .ok_or(damaged)?;
                        let fields = rows
                            .get(at..)
                            .and_then(|rest| rest.get(..width))
                            .ok_or(Broken("its table of places is damaged"))?;
                        return Ok(Some(packed_place(fields, widths)));
                    }
                    row = row.saturating_add(*count);
                }
                Ok(None)
            }
        }
    }
}

fn packed_place(fields: &[u8], widths: &[usize; 3]) -> ObjectPosition {
    let number = |from: usize, width: usize| {
        fields[from..from + width]
            .iter()
            .fold(0_usize, |value, byte| value << 8 | usize::from(*byte))
    };
    let kind = if widths[0] == 0 { 1 } else { number(0, widths[0]) };
    let (second, third) = (number(widths[0], widths[1]), number(widths[0] + widths[1], widths[2]));
    match (kind, u32::try_from(second)) {
        (1, _) => ObjectPosition::At(second),
        (2, Ok(group)) => ObjectPosition::In(group, third),
        _ => ObjectPosition::Free,
    }
}
