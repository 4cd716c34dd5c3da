//! The format of MATLAB 5 to 7 (MathWorks, "MAT-File Format", version 5).
//!
//! An element is a tag (type, number of bytes) and data; a matrix is an element of elements. Sizes
//! are checked against the bytes that are there before anything is allocated.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::super::binary::{Cursor, Number};
use super::super::guard::damaged;
use super::super::load::{Budget, most_unpacked, unpacks_to_more};
use super::super::{Format, Input};
use super::{DEEPEST, OBJECT, Value};
use crate::problem::Problem;

/// Bytes of the header of a file.
const HEADER: usize = 128;

// Types of elements.
const INT8: u32 = 1;
const UINT8: u32 = 2;
const INT16: u32 = 3;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const SINGLE: u32 = 7;
const DOUBLE: u32 = 9;
const INT64: u32 = 12;
const UINT64: u32 = 13;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const UTF8: u32 = 16;
const UTF16: u32 = 17;
const UTF32: u32 = 18;

// Classes of arrays.
const CELL: u8 = 1;
const STRUCT: u8 = 2;
const CHAR: u8 = 4;
const SPARSE: u8 = 5;
/// Double, single and the integers.
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;

/// Why an element cannot be read.
type Reason = String;

/// The variables of a file in their order.
pub(super) fn variables(
    input: &Input<'_>,
    budget: &mut Budget<'_>,
) -> Result<Vec<(String, Value)>, Problem> {
    let shown = input.shown;
    let bad = |place: String, why: &str| damaged(Format::Mat, shown, &place, why);
    let big = input.bytes.get(126..128) == Some(b"MI");
    let mut rest = Cursor::new(input.bytes.get(HEADER..).unwrap_or(&[]), big);
    let mut found = Vec::new();
    let mut unpacked = 0usize;
    while !rest.rest.is_empty() {
        let place = format!(
            "variable {} (byte {})",
            found.len() + 1,
            input.bytes.len() - rest.rest.len() + 1
        );
        // Some writers fill the end with zeros.
        if rest.rest.iter().all(|byte| *byte == 0) {
            break;
        }
        let (kind, data) = element(&mut rest, false).map_err(|why| bad(place.clone(), &why))?;
        let most = most_unpacked(input.bytes.len()).saturating_sub(unpacked);
        let (matrix, inflated);
        match kind {
            MATRIX => matrix = Cursor::new(data, big),
            COMPRESSED => {
                inflated = inflate(data, most).map_err(|why| match why {
                    Some(why) => bad(place.clone(), &why),
                    None => unpacks_to_more(shown, &place, input.bytes.len()),
                })?;
                unpacked += inflated.len();
                let mut packed = Cursor::new(&inflated, big);
                let (kind, data) =
                    element(&mut packed, true).map_err(|why| bad(place.clone(), &why))?;
                if kind != MATRIX {
                    return Err(bad(
                        place,
                        &format!("an element of type {kind} in place of an array"),
                    ));
                }
                matrix = Cursor::new(data, big);
            }
            other => {
                return Err(bad(
                    place,
                    &format!("an element of type {other} in place of an array"),
                ));
            }
        }
        let mut names = String::new();
        let (name, value) =
            array(matrix, 0, budget, &mut names, &place).map_err(|why| match why {
                Failure::Budget(problem) => problem,
                Failure::Reason(why) => bad(
                    if names.is_empty() { place.clone() } else { format!("{place}, `{names}`") },
                    &why,
                ),
            })?;
        // MATLAB keeps functions and objects in a variable without a name.
        if !name.is_empty() {
            found.push((name, value));
        }
    }
    Ok(found)
}

/// Unpacks an element, up to a limit. The error is `None` if it has more.
fn inflate(data: &[u8], most: usize) -> Result<Vec<u8>, Option<Reason>> {
    let mut unpacked = Vec::new();
    let mut decoder = ZlibDecoder::new(data).take(most as u64 + 1);
    match decoder.read_to_end(&mut unpacked) {
        Ok(_) if unpacked.len() > most => Err(None),
        Ok(_) => Ok(unpacked),
        Err(error) => Err(Some(format!("the compressed data cannot be unpacked ({error})"))),
    }
}

enum Failure {
    Budget(Problem),
    Reason(Reason),
}

impl From<&str> for Failure {
    fn from(why: &str) -> Self {
        Self::Reason(why.into())
    }
}

impl From<Reason> for Failure {
    fn from(why: Reason) -> Self {
        Self::Reason(why)
    }
}

/// The name and value of an array. `names` keeps the path to a failure.
fn array(
    mut bytes: Cursor<'_>,
    depth: usize,
    budget: &mut Budget<'_>,
    names: &mut String,
    place: &str,
) -> Result<(String, Value), Failure> {
    if depth > DEEPEST {
        return Err(format!("cells or structs nested more than {DEEPEST} deep").into());
    }
    // An empty cell may have no content at all.
    if bytes.rest.is_empty() {
        return Ok((String::new(), Value::Numbers { rows: 0, columns: 0, values: Vec::new() }));
    }
    let big = bytes.big;
    let (_, flags) = element(&mut bytes, true)?;
    let word =
        Cursor::new(flags, big).u32().map_err(|_| "the flags of the array are not complete")?;
    let (class, complex) = (word as u8, word & 0x0800 != 0);
    if matches!(class, 16..=18)
        || !(NUMERIC.contains(&class) || matches!(class, CELL | STRUCT | CHAR | SPARSE | 3))
    {
        return Ok((names_of_object(bytes), Value::Other(OBJECT)));
    }
    let (kind, sizes) = element(&mut bytes, true)?;
    let sizes: Vec<usize> = numbers(kind, sizes, big)?
        .into_iter()
        .map(|size| if size >= 0.0 { size as usize } else { 0 })
        .collect();
    let count = sizes.iter().try_fold(1usize, |product, size| product.checked_mul(*size));
    let count = count.ok_or("the declared size of the array is beyond any memory")?;
    let rows = sizes.first().copied().unwrap_or(0);
    let columns = count.checked_div(rows).unwrap_or(0);
    let (_, name) = element(&mut bytes, true)?;
    let name = latin(name);
    let before = names.len();
    if !name.is_empty() {
        names.push_str(&name);
    }
    let value = match class {
        CHAR => Value::Text(text(&mut bytes, rows, columns)?),
        CELL => {
            // Each cell has a tag of eight bytes at least.
            holds(&bytes, count, 8, "cells")?;
            let mut cells = Vec::with_capacity(count);
            for index in 0..count {
                let length = names.len();
                names.push_str(&format!("{{{}}}", index + 1));
                let (_, data) = element(&mut bytes, true)?;
                cells.push(array(Cursor::new(data, big), depth + 1, budget, names, place)?.1);
                names.truncate(length);
            }
            Value::Cells(cells)
        }
        STRUCT => Value::Structs(structs(&mut bytes, count, depth, budget, names, place)?),
        SPARSE => Value::Other("a sparse matrix; save it with `full(...)`"),
        3 => Value::Other(OBJECT),
        _ if complex => Value::Other("complex numbers; save their parts as arrays of their own"),
        _ => {
            let (kind, data) = element(&mut bytes, true)?;
            let size = number(kind)?.size();
            if data.len() / size != count || data.len() % size != 0 {
                let has = data.len() / size;
                return Err(format!(
                    "the array is declared with {rows} x {columns} values and holds {has}"
                )
                .into());
            }
            budget.take(1, count, place).map_err(Failure::Budget)?;
            Value::Numbers { rows, columns, values: numbers(kind, data, big)? }
        }
    };
    names.truncate(before);
    Ok((name, value))
}

/// The name of an object, which follows its flags; empty if it cannot be found.
fn names_of_object(mut bytes: Cursor<'_>) -> String {
    let name = element(&mut bytes, true).map(|(_, name)| latin(name)).unwrap_or_default();
    let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if plain { name } else { String::new() }
}

type Fields = Vec<(String, Value)>;

fn structs(
    bytes: &mut Cursor<'_>,
    count: usize,
    depth: usize,
    budget: &mut Budget<'_>,
    names: &mut String,
    place: &str,
) -> Result<Vec<Fields>, Failure> {
    let big = bytes.big;
    let (kind, length) = element(bytes, true)?;
    let length = numbers(kind, length, big)?.first().map_or(0, |length| *length as usize);
    let (_, list) = element(bytes, true)?;
    if length == 0 || length > 1024 {
        return Err(format!("a length of {length} for names of fields").into());
    }
    let fields: Vec<String> = list.chunks(length).map(latin).collect();
    let total = fields
        .len()
        .checked_mul(count)
        .ok_or("the declared size of the struct is beyond any memory")?;
    holds(bytes, total, 8, "fields")?;
    if fields.is_empty() {
        return Ok(vec![Vec::new(); count.min(1)]);
    }
    let mut found = Vec::with_capacity(count);
    for _ in 0..count {
        let mut values = Vec::with_capacity(fields.len());
        for field in &fields {
            let before = names.len();
            names.push_str(&format!(".{field}"));
            let (_, data) = element(bytes, true)?;
            values.push((
                field.clone(),
                array(Cursor::new(data, big), depth + 1, budget, names, place)?.1,
            ));
            names.truncate(before);
        }
        found.push(values);
    }
    Ok(found)
}

/// A char array; the rows of a matrix are joined by line breaks.
fn text(bytes: &mut Cursor<'_>, rows: usize, columns: usize) -> Result<String, Reason> {
    let big = bytes.big;
    if rows == 0 || columns == 0 {
        return Ok(String::new());
    }
    let (kind, data) = element(bytes, true)?;
    if kind == UTF8 && rows == 1 {
        return Ok(String::from_utf8_lossy(data).into_owned());
    }
    let code = |number: f64| char::from_u32(number as u32).unwrap_or('\u{fffd}');
    let letters: Vec<char> = match kind {
        UTF16 | UINT16 if rows == 1 => {
            let units: Vec<u16> =
                numbers(UINT16, data, big)?.into_iter().map(|unit| unit as u16).collect();
            char::decode_utf16(units).map(|letter| letter.unwrap_or('\u{fffd}')).collect()
        }
        UTF8 => String::from_utf8_lossy(data).chars().collect(),
        UTF16 => numbers(UINT16, data, big)?.into_iter().map(code).collect(),
        UTF32 => numbers(UINT32, data, big)?.into_iter().map(code).collect(),
        kind => numbers(kind, data, big)?.into_iter().map(code).collect(),
    };
    if rows == 1 {
        return Ok(letters.into_iter().collect());
    }
    if letters.len() != rows.saturating_mul(columns) {
        return Err(format!(
            "a text is declared with {rows} x {columns} letters and holds {}",
            letters.len()
        ));
    }
    let line = |row: usize| -> String {
        letters.iter().skip(row).step_by(rows).collect::<String>().trim_end().to_string()
    };
    Ok((0..rows).map(line).collect::<Vec<_>>().join("\n"))
}

fn latin(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.split(|byte| *byte == 0).next().unwrap_or(&[])).into_owned()
}

/// The numbers of a type of elements.
fn number(kind: u32) -> Result<Number, Reason> {
    Ok(match kind {
        INT8 => Number::Signed(1),
        UINT8 | UTF8 => Number::Unsigned(1),
        INT16 => Number::Signed(2),
        UINT16 | UTF16 => Number::Unsigned(2),
        INT32 => Number::Signed(4),
        UINT32 | UTF32 => Number::Unsigned(4),
        INT64 => Number::Signed(8),
        UINT64 => Number::Unsigned(8),
        SINGLE => Number::Float(4),
        DOUBLE => Number::Float(8),
        other => return Err(format!("numbers of the unknown type {other}")),
    })
}

/// Numbers of an element. MATLAB stores doubles that are small integers as bytes.
fn numbers(kind: u32, data: &[u8], big: bool) -> Result<Vec<f64>, Reason> {
    Ok(number(kind)?.read(data, big).unwrap_or_default())
}

/// Type and data of the next element; inside an array they are padded to eight bytes.
fn element<'a>(bytes: &mut Cursor<'a>, padded: bool) -> Result<(u32, &'a [u8]), Reason> {
    let cut = |_: String| "the file ends within an element".to_string();
    let tag = bytes.u32().map_err(cut)?;
    // A small element has its size in the upper half of the tag and up to four bytes of data.
    if tag >> 16 != 0 {
        let size = (tag >> 16) as usize;
        let data = bytes.take(4).map_err(cut)?.get(..size);
        return Ok((tag & 0xffff, data.ok_or_else(|| format!("a small element of {size} bytes"))?));
    }
    let size = bytes.u32().map_err(cut)? as usize;
    let left = bytes.rest.len();
    let data = bytes
        .take(size)
        .map_err(|_| format!("an element is declared with {size} bytes; {left} are left"))?;
    let padding = if padded { size.next_multiple_of(8) - size } else { 0 };
    bytes.rest = bytes.rest.get(padding..).unwrap_or(&[]);
    Ok((tag, data))
}

/// Refuses a number of parts that the bytes cannot hold.
fn holds(bytes: &Cursor<'_>, count: usize, each: usize, what: &str) -> Result<(), Reason> {
    let most = bytes.rest.len() / each;
    if count > most {
        return Err(format!("{count} {what} are declared; the file has bytes for {most}"));
    }
    Ok(())
}
