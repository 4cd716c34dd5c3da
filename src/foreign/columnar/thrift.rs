//! Checks what a Parquet file declares, before its reader allocates it: sizes of the lists in the footer, and of the pages.
//!
//! The footer and the headers of pages are structs of Thrift's compact protocol (Apache Thrift, "Thrift Compact protocol encoding";
//! Parquet format, `parquet.thrift`).

use parquet::file::metadata::ParquetMetaData;

use super::super::Format;
use super::super::guard::damaged;
use super::super::load::{most_unpacked, unpacks_to_more};
use crate::problem::Problem;

/// Largest list in a footer: columns, row groups, or chunks of all of them. Each entry takes some hundred bytes of memory.
const LONGEST_LIST: u64 = 1 << 20;
/// Depth of structs and lists; the format has six levels.
const DEEPEST: usize = 16;

// Types of the compact protocol.
const STOP: u8 = 0;
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I32: u8 = 5;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const MAP: u8 = 11;
const STRUCT: u8 = 12;

/// Fields of the header of a page.
const UNCOMPRESSED: i64 = 2;
const COMPRESSED: i64 = 3;

/// Checks frame and footer.
pub(super) fn check(bytes: &[u8], shown: &str) -> Result<(), Problem> {
    let bad = |why: String| damaged(Format::Parquet, shown, "the footer", why);
    let Some((body, end)) = bytes.split_last_chunk::<8>().filter(|(_, end)| end[4..] == *b"PAR1") else {
        return Err(bad("the file does not end as it should".into()));
    };
    let length = u32::from_le_bytes([end[0], end[1], end[2], end[3]]) as usize;
    let footer = body.len().checked_sub(length).and_then(|from| body.get(from..));
    let footer = footer.ok_or_else(|| bad(format!("{length} bytes are declared, {} are there", body.len())))?;
    Walk { bytes: footer }.fields(0, &mut |_, _| {}).map_err(bad)
}

/// Checks the pages of every column.
pub(super) fn check_pages(bytes: &[u8], metadata: &ParquetMetaData, shown: &str) -> Result<(), Problem> {
    let most = most_unpacked(bytes.len());
    let mut total = 0usize;
    for (group, row_group) in metadata.row_groups().iter().enumerate() {
        for (column, chunk) in row_group.columns().iter().enumerate() {
            let place = format!("row group {}, column {} (`{}`)", group + 1, column + 1, chunk.column_path().string());
            let bad = |why: String| damaged(Format::Parquet, shown, &place, why);
            let start = chunk.dictionary_page_offset().filter(|at| *at > 0).unwrap_or(i64::MAX).min(chunk.data_page_offset());
            let part = usize::try_from(start).ok().zip(usize::try_from(chunk.compressed_size()).ok());
            let part = part.and_then(|(start, size)| bytes.get(start..start.checked_add(size)?));
            let part = part.ok_or_else(|| bad(format!("{} bytes at byte {start} are beyond the file", chunk.compressed_size())))?;
            let mut walk = Walk { bytes: part };
            let mut page = 0;
            while !walk.bytes.is_empty() {
                page += 1;
                let (mut unpacked, mut packed) = (-1, -1);
                walk.fields(0, &mut |field, number| match field {
                    UNCOMPRESSED => unpacked = number,
                    COMPRESSED => packed = number,
                    _ => {}
                })
                .map_err(|why| bad(format!("page {page}: {why}")))?;
                let sizes = usize::try_from(unpacked).ok().zip(usize::try_from(packed).ok());
                let (unpacked, packed) = sizes.ok_or_else(|| bad(format!("page {page} declares no size")))?;
                total = total.saturating_add(unpacked);
                if total > most {
                    return Err(unpacks_to_more(shown, &place, bytes.len()));
                }
                walk.bytes = walk.bytes.get(packed..).ok_or_else(|| bad(format!("page {page} ends beyond the column")))?;
            }
        }
    }
    Ok(())
}

struct Walk<'a> {
    bytes: &'a [u8],
}

impl Walk<'_> {
    fn byte(&mut self) -> Result<u8, String> {
        let (first, rest) = self.bytes.split_first().ok_or("it ends within a value")?;
        self.bytes = rest;
        Ok(*first)
    }

    fn skip(&mut self, count: u64) -> Result<(), String> {
        let rest = usize::try_from(count).ok().and_then(|count| self.bytes.get(count..));
        self.bytes = rest.ok_or_else(|| format!("{count} bytes are declared, {} are left", self.bytes.len()))?;
        Ok(())
    }

    fn varint(&mut self) -> Result<u64, String> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err("a number has more than ten bytes".into())
    }

    fn integer(&mut self) -> Result<i64, String> {
        let number = self.varint()?;
        Ok((number >> 1).cast_signed() ^ -(number & 1).cast_signed())
    }

    /// The fields of a struct; integers of the outermost one are given to `seen` with the number of their field.
    fn fields(&mut self, depth: usize, seen: &mut dyn FnMut(i64, i64)) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("it is nested too deep".into());
        }
        let mut field = 0;
        loop {
            let head = self.byte()?;
            let kind = head & 0x0f;
            if kind == STOP {
                return Ok(());
            }
            field = match head >> 4 {
                0 => self.integer()?,
                step => field + i64::from(step),
            };
            match kind {
                I16 | I32 | I64 => {
                    let number = self.integer()?;
                    if depth == 0 {
                        seen(field, number);
                    }
                }
                // The value of a field is in its type.
                TRUE | FALSE => {}
                kind => self.value(kind, depth)?,
            }
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("it is nested too deep".into());
        }
        match kind {
            TRUE | FALSE | BYTE => self.skip(1),
            I16 | I32 | I64 => self.varint().map(|_| ()),
            DOUBLE => self.skip(8),
            BINARY => {
                let length = self.varint()?;
                self.skip(length)
            }
            LIST | SET => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
                self.holds(count)?;
                (0..count).try_for_each(|_| self.value(head & 0x0f, depth + 1))
            }
            MAP => {
                let count = self.varint()?;
                self.holds(count)?;
                let kinds = if count == 0 { 0 } else { self.byte()? };
                (0..count).try_for_each(|_| {
                    self.value(kinds >> 4, depth + 1)?;
                    self.value(kinds & 0x0f, depth + 1)
                })
            }
            STRUCT => self.fields(depth + 1, &mut |_, _| {}),
            other => Err(format!("a value of the unknown type {other}")),
        }
    }

    /// Refuses a list that the bytes cannot hold: each entry has one byte at least.
    fn holds(&self, count: u64) -> Result<(), String> {
        if count > LONGEST_LIST || count > self.bytes.len() as u64 {
            return Err(format!("a list of {count} entries is declared, {} bytes are left", self.bytes.len()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_structs_are_walked() {
        // Field 1: i32 5; field 2: a list of two i32; stop.
        let mut found = Vec::new();
        let mut walk = Walk { bytes: &[0x15, 10, 0x19, 0x25, 2, 4, 0, 99] };
        assert_eq!(walk.fields(0, &mut |field, number| found.push((field, number))), Ok(()));
        assert_eq!((found, walk.bytes), (vec![(1, 5)], &[99][..]));
    }

    #[test]
    fn what_is_declared_must_be_there() {
        // A list of 2^31 entries, a text of 200 bytes, structs without end.
        for bytes in [&[0x19, 0xf5, 0x80, 0x80, 0x80, 0x80, 8][..], &[0x18, 0xc8, 1, 0], &[0x1c; 40], &[0x15, 0xff, 0xff]] {
            assert!(Walk { bytes }.fields(0, &mut |_, _| {}).is_err(), "{bytes:?}");
        }
    }
}
