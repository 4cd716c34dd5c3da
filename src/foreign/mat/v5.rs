//! The format of MATLAB 5 to 7 (MathWorks, "MAT-File Format", version 5).
//!
//! An element is a tag (type, number of bytes) and data; a matrix is an element of elements. Sizes
//! are checked against the bytes that are there before anything is allocated.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::super::Input;
use super::super::binary::{Cursor, Number};
use super::super::guard::Failure;
use super::super::load::{Budget, most_unpacked};
use super::{DEEPEST, Fields, OBJECT, Value};
use crate::problem::Problem;

/// Bytes of the header of a file.
const HEADER: usize = 128;

// Types of elements that are not plain numbers.
const UINT16: u32 = 4;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const UTF8: u32 = 16;
const UTF16: u32 = 17;
const UTF32: u32 = 18;

// Classes of arrays.
const CELL: u8 = 1;
const STRUCT: u8 = 2;
const OLD_OBJECT: u8 = 3;
const CHAR: u8 = 4;
const SPARSE: u8 = 5;
/// Double, single and the integers are 6 to 15, the last that is read.
const LAST: u8 = 15;

/// Why an element cannot be read.
type Reason = String;

/// Reads arrays.
struct Reader<'a, 'b> {
    budget: &'a mut Budget<'b>,
    /// The present variable, for messages.
    place: String,
    /// The path to the present array below it.
    names: String,
}

/// The variables of a file in their order.
pub fn variables(input: &Input<'_>, budget: &mut Budget<'_>) -> Result<Fields, Problem> {
    let big = input.bytes.get(126..128) == Some(b"MI");
    let mut rest = Cursor::new(input.bytes.get(HEADER..).unwrap_or(&[]), big);
    let mut reader = Reader { budget, place: String::new(), names: String::new() };
    let mut found: Fields = Vec::new();
    let mut left = most_unpacked(input.bytes.len());
    // Some writers fill the end with zeros.
    while rest.rest.iter().any(|byte| *byte != 0) {
        let at = input.bytes.len() - rest.rest.len() + 1;
        reader.place = format!("variable {} (byte {at})", found.len() + 1);
        reader.names.clear();
        let (name, value) = reader.variable(&mut rest, &mut left).map_err(|failure| {
            let place = match reader.names.as_str() {
                "" => reader.place.clone(),
                names => format!("{}, `{names}`", reader.place),
            };
            input.failed(&place, failure)
        })?;
        // MATLAB keeps functions and objects in a variable without a name.
        if !name.is_empty() {
            found.push((name, value));
        }
    }
    Ok(found)
}

/// Unpacks an element, up to a limit.
fn inflate(data: &[u8], most: usize) -> Result<Vec<u8>, Failure> {
    let mut unpacked = Vec::new();
    let mut decoder = ZlibDecoder::new(data).take(most as u64 + 1);
    match decoder.read_to_end(&mut unpacked) {
        Ok(_) if unpacked.len() > most => Err(Failure::Unpacked),
        Ok(_) => Ok(unpacked),
        Err(error) => Err(format!("the compressed data cannot be unpacked ({error})").into()),
    }
}

impl Reader<'_, '_> {
    /// The next variable; `left` are the bytes that may still be unpacked.
    fn variable(
        &mut self,
        rest: &mut Cursor<'_>,
        left: &mut usize,
    ) -> Result<(String, Value), Failure> {
        let (mut kind, mut data) = element(rest, false)?;
        let inflated;
        if kind == COMPRESSED {
            inflated = inflate(data, *left)?;
            *left -= inflated.len();
            (kind, data) = element(&mut Cursor::new(&inflated, rest.big), true)?;
        }
        if kind != MATRIX {
            return Err(format!("an element of type {kind} in place of an array").into());
        }
        self.array(Cursor::new(data, rest.big), 0)
    }

    /// The next element, an array below the present one.
    fn inner(
        &mut self,
        name: &str,
        bytes: &mut Cursor<'_>,
        depth: usize,
    ) -> Result<Value, Failure> {
        let before = self.names.len();
        self.names.push_str(name);
        let (_, data) = element(bytes, true)?;
        let (_, value) = self.array(Cursor::new(data, bytes.big), depth + 1)?;
        self.names.truncate(before);
        Ok(value)
    }

    /// The name and value of an array.
    fn array(&mut self, mut bytes: Cursor<'_>, depth: usize) -> Result<(String, Value), Failure> {
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
        if !(CELL..=LAST).contains(&class) {
            return Ok((name_of_object(bytes), Value::Other(OBJECT)));
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
        let before = self.names.len();
        self.names.push_str(&name);
        let value = match class {
            CHAR => Value::Text(text(&mut bytes, rows, columns)?),
            CELL => {
                holds(&bytes, count, "cells")?;
                let cell = |at: usize| self.inner(&format!("{{{}}}", at + 1), &mut bytes, depth);
                Value::Cells((0..count).map(cell).collect::<Result<_, _>>()?)
            }
            STRUCT => Value::Structs(self.structs(&mut bytes, count, depth)?),
            SPARSE => Value::Other("a sparse matrix; save it with `full(...)`"),
            OLD_OBJECT => Value::Other(OBJECT),
            _ if complex => {
                Value::Other("complex numbers; save their parts as arrays of their own")
            }
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
                self.budget.take(1, count, &self.place)?;
                Value::Numbers { rows, columns, values: numbers(kind, data, big)? }
            }
        };
        self.names.truncate(before);
        Ok((name, value))
    }

    /// The elements of a struct array.
    fn structs(
        &mut self,
        bytes: &mut Cursor<'_>,
        count: usize,
        depth: usize,
    ) -> Result<Vec<Fields>, Failure> {
        let (kind, length) = element(bytes, true)?;
        let length = numbers(kind, length, bytes.big)?.first().map_or(0, |length| *length as usize);
        let (_, list) = element(bytes, true)?;
        if length == 0 || length > 1024 {
            return Err(format!("a length of {length} for names of fields").into());
        }
        let fields: Vec<String> = list.chunks(length).map(latin).collect();
        let total = fields
            .len()
            .checked_mul(count)
            .ok_or("the declared size of the struct is beyond any memory")?;
        holds(bytes, total, "fields")?;
        if fields.is_empty() {
            return Ok(vec![Vec::new(); count.min(1)]);
        }
        let mut field = |name: &String| -> Result<(String, Value), Failure> {
            Ok((name.clone(), self.inner(&format!(".{name}"), bytes, depth)?))
        };
        (0..count).map(|_| fields.iter().map(&mut field).collect()).collect()
    }
}

/// The name of an object, which follows its flags; empty if it cannot be found.
fn name_of_object(mut bytes: Cursor<'_>) -> String {
    let name = element(&mut bytes, true).map(|(_, name)| latin(name)).unwrap_or_default();
    let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if plain { name } else { String::new() }
}

/// A char array; the rows of a matrix are joined by line breaks.
fn text(bytes: &mut Cursor<'_>, rows: usize, columns: usize) -> Result<String, Reason> {
    if rows == 0 || columns == 0 {
        return Ok(String::new());
    }
    let (kind, data) = element(bytes, true)?;
    let letters: Vec<char> = match kind {
        UTF8 => String::from_utf8_lossy(data).chars().collect(),
        UTF16 | UINT16 if rows == 1 => {
            let units = numbers(kind, data, bytes.big)?.into_iter().map(|unit| unit as u16);
            char::decode_utf16(units).map(|letter| letter.unwrap_or('\u{fffd}')).collect()
        }
        kind => numbers(kind, data, bytes.big)?
            .into_iter()
            .map(|code| char::from_u32(code as u32).unwrap_or('\u{fffd}'))
            .collect(),
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
        1 => Number::Signed(1),
        2 | UTF8 => Number::Unsigned(1),
        3 => Number::Signed(2),
        UINT16 | UTF16 => Number::Unsigned(2),
        5 => Number::Signed(4),
        6 | UTF32 => Number::Unsigned(4),
        7 => Number::Float(4),
        9 => Number::Float(8),
        12 => Number::Signed(8),
        13 => Number::Unsigned(8),
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

/// Refuses a number of arrays that the bytes cannot hold: each has a tag of eight bytes at least.
fn holds(bytes: &Cursor<'_>, count: usize, what: &str) -> Result<(), Reason> {
    let most = bytes.rest.len() / 8;
    if count > most {
        return Err(format!("{count} {what} are declared; the file has bytes for {most}"));
    }
    Ok(())
}
