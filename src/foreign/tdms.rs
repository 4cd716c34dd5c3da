//! TDMS of National Instruments, version 2 ("TDMS File Format Internal Structure").
//!
//! A file is a list of segments: a lead-in, the objects of the segment with their properties, and
//! raw data in one or more chunks. A reader of another project was tried (`tdms-rs` 2.0): it
//! allocates what the file declares, and reads one chunk of each segment.

use indexmap::IndexMap;

use super::binary::Cursor;
use super::guard::Failure;
use super::load::{Budget, MOST_CHANNELS};
use super::{Channel, Input, NANOSECONDS, Read, Table, conflict, filled};
use crate::problem::Problem;

mod scale;
mod value;

use value::Property;

/// Bytes of a lead-in.
const LEAD_IN: usize = 28;

// Bits of the table of contents of a segment.
const META_DATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// Seconds from 1904, from which LabVIEW counts, to 1970.
const EPOCH: i64 = 2_082_844_800;

/// What an object has in the raw data of a segment.
#[derive(Clone, Copy, Debug)]
struct Index {
    kind: u32,
    count: usize,
    /// Bytes in each chunk.
    size: usize,
}

#[derive(Debug, Default)]
struct Object {
    properties: IndexMap<String, Property>,
    index: Option<Index>,
    /// It is in the list of the present segment.
    listed: bool,
    has_data: bool,
    values: Vec<f64>,
    /// Of times: the first.
    since: Option<i64>,
    /// Why its data are not read.
    left_out: Option<String>,
}

struct Reader<'a> {
    objects: IndexMap<String, Object>,
    /// Objects of the present segment, in the order of their data; some have none.
    active: Vec<usize>,
    budget: Budget<'a>,
    /// The present segment, for messages.
    place: String,
}

/// The groups of a file as tables.
pub fn read(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let mut reader = Reader {
        objects: IndexMap::new(),
        active: Vec::new(),
        budget: input.budget(),
        place: String::new(),
    };
    let (mut at, mut segment) = (0, 0);
    while at < input.bytes.len() {
        segment += 1;
        reader.place = format!("segment {segment} (byte {})", at + 1);
        at += reader
            .segment(&input.bytes[at..])
            .map_err(|failure| input.failed(&reader.place, failure))?;
    }
    input.with_channels(tables(reader.objects), "channels of numbers")
}

impl Reader<'_> {
    /// Reads the segment at the start of the bytes that are left; returns its length.
    fn segment(&mut self, rest: &[u8]) -> Result<usize, Failure> {
        let mut lead =
            Cursor::new(rest.get(..LEAD_IN).ok_or("the file ends within its lead-in")?, false);
        if lead.take(4)? != b"TDSm" {
            return Err("it does not begin with `TDSm`".into());
        }
        let contents = lead.u32()?;
        lead.big = contents & BIG_ENDIAN != 0;
        let _version = lead.u32()?;
        let (next, raw) = (lead.u64()?, lead.u64()?);
        // LabVIEW writes all ones if it was interrupted; what is there is then the last segment.
        let end = if next == u64::MAX { rest.len() } else { position(next)? };
        let raw = position(raw)?;
        if end > rest.len() {
            let (declared, left) = (end - LEAD_IN, rest.len() - LEAD_IN);
            return Err(format!("{declared} bytes are declared, {left} are left").into());
        }
        if raw > end {
            return Err("its raw data begin after its end".into());
        }
        if contents & META_DATA != 0 {
            if contents & NEW_LIST != 0 {
                let objects = &mut self.objects;
                self.active.drain(..).for_each(|at| objects[at].listed = false);
            }
            self.meta_data(Cursor::new(&rest[LEAD_IN..raw], lead.big))?;
        }
        if contents & RAW_DATA != 0 && raw < end {
            if contents & DAQMX != 0 {
                for index in &self.active {
                    self.objects[*index].left_out =
                        Some("raw data of DAQmx; save the file again in LabVIEW or DIAdem".into());
                }
            } else {
                self.raw_data(Cursor::new(&rest[raw..end], lead.big), contents)?;
            }
        }
        Ok(end)
    }

    fn meta_data(&mut self, mut bytes: Cursor<'_>) -> Result<(), Failure> {
        let objects = bytes.u32()?;
        for _ in 0..objects {
            let path = value::text(&mut bytes)?;
            let length = bytes.u32()?;
            if self.objects.len() > MOST_CHANNELS {
                return Err(format!("more than {MOST_CHANNELS} objects").into());
            }
            let entry = self.objects.entry(path.clone());
            let at = entry.index();
            let object = entry.or_default();
            let has_data = match length {
                u32::MAX => false,
                0 => object.index.is_some(),
                // DAQmx: the raw data are those of a card; see `segment`.
                0x1269 | 0x126a | 0x1369 => {
                    return Err(
                        format!("`{path}` holds raw data of DAQmx, which are not read; save the file again in LabVIEW or DIAdem").into()
                    );
                }
                _ => {
                    object.index = Some(index(&path, &mut bytes)?);
                    true
                }
            };
            let properties = bytes.u32()?;
            for _ in 0..properties {
                let name = value::text(&mut bytes)?;
                let value = value::property(&mut bytes)?;
                object.properties.insert(name, value);
            }
            object.has_data = has_data;
            if !object.listed {
                object.listed = true;
                self.active.push(at);
            }
        }
        Ok(())
    }

    fn raw_data(&mut self, data: Cursor<'_>, contents: u32) -> Result<(), Failure> {
        let parts: Vec<(usize, Index)> = self
            .active
            .iter()
            .filter(|at| self.objects[**at].has_data)
            .filter_map(|at| Some((*at, self.objects[*at].index?)))
            .filter(|(_, index)| index.size > 0)
            .collect();
        let chunk = parts
            .iter()
            .try_fold(0usize, |sum, (_, index)| sum.checked_add(index.size))
            .ok_or("its chunks are beyond any memory")?;
        if chunk == 0 {
            let bytes = data.rest.len();
            return Err(format!("it has {bytes} bytes of raw data and no channel for them").into());
        }
        for part in data.rest.chunks(chunk) {
            if contents & INTERLEAVED != 0 {
                self.interleaved(part, &parts, data.big)?;
                continue;
            }
            let last = part.len();
            if last < chunk {
                return Err(format!(
                    "a chunk of raw data has {chunk} bytes; the last one has {last}"
                )
                .into());
            }
            let mut part = Cursor::new(part, data.big);
            for (at, index) in &parts {
                self.add(*at, *index, part.take(index.size)?, data.big)?;
            }
        }
        Ok(())
    }

    /// One value of each channel after the other.
    fn interleaved(
        &mut self,
        part: &[u8],
        parts: &[(usize, Index)],
        big: bool,
    ) -> Result<(), Failure> {
        let widths: Option<Vec<usize>> =
            parts.iter().map(|(_, index)| value::size_of(index.kind)).collect();
        let widths = widths.ok_or("it has interleaved texts")?;
        let row: usize = widths.iter().sum();
        if !part.len().is_multiple_of(row)
            || parts.iter().any(|(_, index)| index.count != parts[0].1.count)
        {
            return Err(format!("its rows have {row} bytes, its data {}", part.len()).into());
        }
        let mut from = 0;
        for ((at, index), width) in parts.iter().zip(widths) {
            let column: Vec<u8> =
                part.chunks_exact(row).flat_map(|row| &row[from..from + width]).copied().collect();
            from += width;
            self.add(*at, *index, &column, big)?;
        }
        Ok(())
    }

    fn add(&mut self, at: usize, index: Index, data: &[u8], big: bool) -> Result<(), Failure> {
        let object = &mut self.objects[at];
        let numbers = match index.kind {
            value::TIME => Some(value::times(data, big, &mut object.since)),
            kind => value::numbers(kind, data, big),
        };
        let Some(numbers) = numbers else {
            object.left_out = Some(value::what(index.kind).into());
            return Ok(());
        };
        self.budget.add(numbers.len(), &self.place)?;
        object.values.extend(numbers);
        Ok(())
    }
}

/// What the object with a path has in the raw data.
fn index(path: &str, bytes: &mut Cursor<'_>) -> Result<Index, String> {
    let kind = bytes.u32()?;
    let _dimension = bytes.u32()?;
    let count = size(bytes.u64()?)?;
    let size = match value::size_of(kind) {
        Some(width) => {
            count.checked_mul(width).ok_or_else(|| format!("`{path}` declares {count} values"))?
        }
        None if kind == value::TEXT => size(bytes.u64()?)?,
        None => return Err(format!("`{path}` has values of the unknown type {kind:#x}")),
    };
    Ok(Index { kind, count, size })
}

fn size(number: u64) -> Result<usize, String> {
    usize::try_from(number)
        .ok()
        .filter(|number| *number < usize::MAX / 2)
        .ok_or_else(|| format!("a size of {number} bytes"))
}

/// A distance from the end of the lead-in as one from its start.
fn position(number: u64) -> Result<usize, String> {
    size(number).map(|number| number + LEAD_IN)
}

/// `/'group'/'channel'`, with doubled quotes.
fn names(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut rest = path;
    while let Some(inside) = rest.find('\'').map(|open| &rest[open + 1..]) {
        let mut name = String::new();
        let mut letters = inside.char_indices().peekable();
        let mut end = inside.len();
        while let Some((at, letter)) = letters.next() {
            if letter != '\'' {
                name.push(letter);
            } else if letters.next_if(|(_, next)| *next == '\'').is_some() {
                name.push('\'');
            } else {
                end = at + 1;
                break;
            }
        }
        names.push(name);
        rest = &inside[end..];
    }
    names
}

/// Channels of a group with the same time base: number of values, step, offset, start.
type Base = (usize, u64, u64, Option<i64>);

/// The tables of a group, and what belongs to none of them.
#[derive(Default)]
struct Group {
    tables: IndexMap<Base, Table>,
    facts: Vec<(String, String)>,
    left_out: Vec<(String, String)>,
}

fn tables(objects: IndexMap<String, Object>) -> Read {
    let mut read = Read::default();
    let mut groups: IndexMap<String, Group> = IndexMap::new();
    for (path, mut object) in objects {
        let facts = |wanted: &str| -> Vec<(String, String)> {
            let all = object.properties.iter().filter(|(name, _)| name.starts_with(wanted));
            all.map(|(name, value)| (name.clone(), value.text())).collect()
        };
        let mut names = names(&path).into_iter();
        let (Some(group), channel) = (names.next(), names.next()) else {
            read.facts.extend(facts(""));
            continue;
        };
        let group = groups.entry(group).or_default();
        let Some(name) = channel else {
            group.facts.extend(facts(""));
            continue;
        };
        let number = |name: &str| object.properties.get(name).and_then(Property::number);
        let (step, offset) =
            (number("wf_increment").unwrap_or(0.0), number("wf_start_offset").unwrap_or(0.0));
        let start = object.properties.get("wf_start_time").and_then(Property::instant);
        let start =
            start.and_then(|start| start.checked_add((offset * NANOSECONDS as f64).round() as i64));
        let text = |name: &str| object.properties.get(name).and_then(|value| filled(&value.text()));
        let time = object.index.is_some_and(|index| index.kind == value::TIME);
        let (waveform, comment) = (facts("wf_"), text("description"));
        let (unit, described) = (text("unit_string"), text("NI_UnitDescription"));
        let other_unit = conflict(unit.as_deref(), described.clone());
        let unit = unit.or(described).or_else(|| time.then(|| "s".into()));
        if let Err(why) = scale::apply(&object.properties, &mut object.values) {
            object.left_out = Some(why);
        }
        let rows = object.values.len();
        let why = object.left_out.or_else(|| (rows == 0).then(|| "it has no values".into()));
        if let Some(why) = why {
            group.left_out.push((name, why));
            continue;
        }
        let table =
            group.tables.entry((rows, step.to_bits(), offset.to_bits(), start)).or_default();
        if table.channels.is_empty() {
            table.rate = (step > 0.0 && step.is_finite()).then(|| 1.0 / step);
            table.start = start;
            table.facts = waveform;
        }
        let Object { values, since, .. } = object;
        table.channels.push(Channel { name, unit, other_unit, comment, values, since });
    }
    for (group, Group { tables, facts, mut left_out }) in groups {
        let several = tables.len() > 1;
        for (index, (_, table)) in tables.into_iter().enumerate() {
            let name = if several { format!("{group} ({})", index + 1) } else { group.clone() };
            let facts = facts.iter().cloned().chain(table.facts).collect();
            let left_out = std::mem::take(&mut left_out);
            read.tables.push(Table { name, facts, first_row: 1, left_out, ..table });
        }
    }
    read
}
