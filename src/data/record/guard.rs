//! Sizes that a Parquet file declares, checked before the decoder sees them.
//!
//! The decoder reserves memory for as many elements, values and bytes as a footer or a page header
//! declares. A declared size of terabytes would end the process, which no handler can prevent.
//! Footers and page headers are therefore walked first. They are structures of the Thrift compact
//! protocol: each declared length is compared with the bytes that follow, and sizes of pages with
//! the limits below.

use std::ops::Range;

use parquet::basic::{Compression, Type};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};

/// Maximum nesting of a footer, and of the columns of its schema. The deepest part of a footer is
/// the statistics of a column, level 6.
const DEEPEST: usize = 16;
/// Maximum number of elements of all lists of a footer: 1000 channels in 250 row groups, with about
/// four list elements each. The decoder takes up to 1 kB for an element.
const MOST_ELEMENTS: usize = 1 << 20;
/// Maximum size of a page in bytes after decompression: eight million numbers. Writers make pages
/// of 1 MB.
pub const LARGEST_PAGE: u64 = 64 << 20;

const STOP: u8 = 0;
/// The schema in a footer, and the number of children in one of its elements.
const SCHEMA: [i64; 1] = [2];
const CHILDREN: [i64; 3] = [2, 0, 5];
const DICTIONARY_PAGE: i64 = 2;
/// Encodings of Parquet that are read, by number: plain, dictionary (both forms), run lengths,
/// deltas of integers, split bytes. Those of texts by deltas declare sizes inside the page.
const ENCODINGS: [i64; 6] = [0, 2, 3, 5, 8, 9];

/// Whether values with a compression are read.
pub fn is_read(codec: Compression) -> bool {
    use Compression::{SNAPPY, UNCOMPRESSED, ZSTD};
    matches!(codec, UNCOMPRESSED | SNAPPY | ZSTD(_))
}

/// The name of a compression, without its level.
pub fn codec_name(codec: Compression) -> String {
    codec.to_string().chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect()
}

/// Walks the bytes of a structure.
struct Walk<'a> {
    bytes: &'a [u8],
    at: usize,
    elements: usize,
    /// Numbers of the fields, as the ids of the fields that lead to them.
    path: Vec<i64>,
    fields: Vec<(Vec<i64>, i64)>,
    /// Fields deeper than this are not kept.
    kept: usize,
    /// Numbers of children of the columns of a schema that are still to come, from the root; only
    /// in a footer.
    open: Option<Vec<u64>>,
}

type Checked<T> = Result<T, String>;

impl<'a> Walk<'a> {
    fn new(bytes: &'a [u8], kept: usize) -> Self {
        Self { bytes, at: 0, elements: 0, path: Vec::new(), fields: Vec::new(), kept, open: None }
    }

    fn byte(&mut self) -> Checked<u8> {
        let byte = self.bytes.get(self.at).copied().ok_or("it ends inside a structure")?;
        self.at += 1;
        Ok(byte)
    }

    /// Bytes that are still to come.
    fn left(&self) -> u64 {
        (self.bytes.len() - self.at) as u64
    }

    fn variable(&mut self) -> Checked<u64> {
        let mut number = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err("a number has more than 64 bits".into())
    }

    /// A signed number in zigzag form.
    fn signed(&mut self) -> Checked<i64> {
        let number = self.variable()?;
        Ok((number >> 1) as i64 ^ -((number & 1) as i64))
    }

    fn skip(&mut self, count: u64) -> Checked<()> {
        let left = self.left();
        if count > left {
            return Err(format!("it declares {count} bytes where {left} follow"));
        }
        self.at += usize::try_from(count).map_err(|_| "a length is too large")?;
        Ok(())
    }

    fn bounded(&self) -> Checked<()> {
        if self.path.len() > DEEPEST {
            return Err(format!("its structures are nested more than {DEEPEST} deep"));
        }
        Ok(())
    }

    fn structure(&mut self) -> Checked<()> {
        self.bounded()?;
        let mut id = 0_i64;
        loop {
            let head = self.byte()?;
            if head == STOP {
                return Ok(());
            }
            id = match head >> 4 {
                0 => self.signed()?,
                step => id.saturating_add(i64::from(step)),
            };
            self.path.push(id);
            self.value(head & 15, true)?;
            self.path.pop();
        }
    }

    /// In a structure, a truth value is in its type; in a list it has a byte.
    fn value(&mut self, kind: u8, field: bool) -> Checked<()> {
        match kind {
            1 | 2 if field => Ok(()),
            1..=3 => self.skip(1),
            4..=6 => {
                let number = self.signed()?;
                if self.path.len() <= self.kept || self.open.is_some() && self.path == CHILDREN {
                    self.fields.push((self.path.clone(), number));
                }
                Ok(())
            }
            7 => self.skip(8),
            8 => {
                let length = self.variable()?;
                self.skip(length)
            }
            9 | 10 => self.list(),
            12 => self.structure(),
            _ => Err(format!("a field has the unknown type {kind}")),
        }
    }

    fn list(&mut self) -> Checked<()> {
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.variable()? } else { u64::from(head >> 4) };
        // An element has one byte at least.
        let left = self.left();
        if count > left {
            return Err(format!("it declares {count} elements where {left} bytes follow"));
        }
        self.elements += usize::try_from(count).map_err(|_| "a list is too long")?;
        if self.elements > MOST_ELEMENTS {
            return Err(format!("its lists have more than {MOST_ELEMENTS} elements"));
        }
        let schema = self.open.is_some() && self.path == SCHEMA;
        self.path.push(0);
        self.bounded()?;
        for index in 0..count {
            self.value(head & 15, false)?;
            if schema {
                self.column(count - index - 1)?;
            }
        }
        self.path.pop();
        Ok(())
    }

    /// A column of the schema, which is a tree: each column is followed by its children. The
    /// decoder calls itself for each level, and reserves memory for as many children as a column
    /// declares.
    fn column(&mut self, left: u64) -> Checked<()> {
        let children = self.fields.pop().map_or(0, |(_, number)| number);
        self.fields.clear();
        let children = u64::try_from(children).ok().filter(|children| *children <= left);
        let children = children.ok_or_else(|| {
            format!(
                "a column of its schema declares more children than the {left} columns that follow"
            )
        })?;
        let open = self.open.get_or_insert_default();
        open.push(children);
        if open.len() > DEEPEST {
            return Err(format!("the columns of its schema are nested more than {DEEPEST} deep"));
        }
        // A column without children left is complete, and one child less of the column above.
        while open.last() == Some(&0) {
            open.pop();
            if let Some(above) = open.last_mut() {
                *above -= 1;
            }
        }
        Ok(())
    }

    fn field(&self, path: &[i64]) -> Option<i64> {
        self.fields.iter().find(|(at, _)| at == path).map(|(_, number)| *number)
    }
}

/// Checks the lengths in a footer.
pub fn footer(bytes: &[u8]) -> Checked<()> {
    Walk { open: Some(Vec::new()), ..Walk::new(bytes, 0) }.structure()
}

/// The same of a whole file.
pub fn footer_of(file: &[u8]) -> Checked<()> {
    let inside = || {
        let (before, tail) = file.split_last_chunk::<8>()?;
        let length = u32::from_le_bytes(*tail.first_chunk()?);
        before.get(before.len().checked_sub(usize::try_from(length).ok()?)?..)
    };
    footer(inside().ok_or("its footer is not in the file")?)
}

/// Checks the pages of all columns of a whole file, as [`pages`] does. Gives the bytes of the
/// largest column of pages.
pub fn all_pages(file: &[u8], metadata: &ParquetMetaData) -> Checked<u64> {
    let mut largest = 0;
    for chunk in metadata.row_groups().iter().flat_map(RowGroupMetaData::columns) {
        let place = range(chunk).and_then(|place| {
            file.get(usize::try_from(place.start).ok()?..usize::try_from(place.end).ok()?)
        });
        largest = pages(place.ok_or("a part of it lies outside the file")?, chunk)?.max(largest);
    }
    Ok(largest)
}

/// Where the bytes of a column of a row group are declared to be.
pub fn range(chunk: &ColumnChunkMetaData) -> Option<Range<u64>> {
    let start = chunk.dictionary_page_offset().filter(|at| *at > 0);
    let start = u64::try_from(start.unwrap_or(chunk.data_page_offset())).ok()?;
    Some(start..start.checked_add(u64::try_from(chunk.compressed_size()).ok()?)?)
}

/// Checks the headers of the pages of a column of a row group, which are in these bytes. Gives the
/// bytes of the largest page and of the dictionary, which are in memory at the same time.
pub fn pages(bytes: &[u8], chunk: &ColumnChunkMetaData) -> Checked<u64> {
    let width = match chunk.column_type() {
        Type::DOUBLE | Type::INT64 => 8,
        Type::FLOAT | Type::INT32 => 4,
        // A truth value takes a bit, which has no dictionary.
        _ => 1,
    };
    pages_of(bytes, u64::try_from(chunk.num_values()).unwrap_or(0), width)
}

/// The same of a column of `values` numbers of `width` bytes.
fn pages_of(chunk: &[u8], values: u64, width: u64) -> Checked<u64> {
    let (mut largest, mut dictionary, mut at) = (0, 0, 0);
    while at < chunk.len() {
        let mut walk = Walk::new(&chunk[at..], 2);
        walk.structure().map_err(|why| format!("the header of a page: {why}"))?;
        let size = |field: i64| {
            let size = walk.field(&[field]).and_then(|size| u64::try_from(size).ok());
            size.ok_or("the header of a page lacks a size")
        };
        let (inflated, stored) = (size(2)?, size(3)?);
        if inflated > LARGEST_PAGE {
            let (size, most) = (inflated >> 20, LARGEST_PAGE >> 20);
            return Err(format!("a page of {size} MB, where {most} MB are the maximum"));
        }
        // Fields 5, 7 and 8 are the headers of data pages, dictionary pages and data pages of
        // version 2.
        let counts = [5, 7, 8].into_iter().filter_map(|kind| walk.field(&[kind, 1]));
        let count = counts.map(|count| u64::try_from(count).unwrap_or(u64::MAX)).max().unwrap_or(0);
        let encoding =
            [[5, 2], [7, 2], [8, 4]].into_iter().find_map(|path| walk.field(&path)).unwrap_or(0);
        if !ENCODINGS.contains(&encoding) {
            return Err(format!(
                "a page has the encoding {encoding} of Parquet, which is not read; write it with dictionaries or plain"
            ));
        }
        if walk.field(&[1]) == Some(DICTIONARY_PAGE) {
            if count.saturating_mul(width) > inflated {
                return Err(format!("a dictionary of {count} values in {inflated} bytes"));
            }
            dictionary = inflated;
        } else {
            if count > values {
                return Err(format!("a page of {count} values, where the column has {values}"));
            }
            largest = inflated.max(largest);
        }
        at += walk.at;
        let left = (chunk.len() - at) as u64;
        if stored > left {
            return Err(format!("a page of {stored} bytes, where {left} follow"));
        }
        at += usize::try_from(stored).map_err(|_| "a page is too large")?;
    }
    Ok(largest + dictionary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declared_lengths_are_compared_with_the_bytes() {
        assert_eq!(footer(&[0x15, 2, 0]), Ok(()));
        // Field 4, a list of 2^30 structures.
        assert!(
            footer(&[0x49, 0xfc, 0x80, 0x80, 0x80, 0x80, 0x04, 0])
                .is_err_and(|why| why.contains("1073741824 elements"))
        );
        // Field 1, a text of 2^40 bytes.
        assert!(
            footer(&[0x18, 0x80, 0x80, 0x80, 0x80, 0x80, 0x20, 0])
                .is_err_and(|why| why.contains("1099511627776 bytes"))
        );
        assert!(footer(&[0x1c; 1000]).is_err_and(|why| why.contains("nested")));
        assert!(footer(&[0x19, 0x19, 0x19, 0x19].repeat(9)).is_err());
        assert!(footer(&[0x15]).is_err());
        assert!(
            footer(&[0x15, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff])
                .is_err()
        );
    }

    #[test]
    fn the_schema_is_a_tree_of_bounded_depth() {
        // Field 2 of the footer: a list of structures with field 5, the number of children.
        let walk = |children: &[u8]| {
            let elements: Vec<u8> =
                children.iter().flat_map(|count| [0x55, 2 * count, 0]).collect();
            footer(&[&[0x29, 0xfc, children.len() as u8][..], &elements, &[0]].concat())
        };
        assert_eq!(walk(&[2, 0, 1, 0]), Ok(()));
        assert!(
            walk(&[9, 0, 0]).is_err_and(|why| why.contains("more children than the 2 columns"))
        );
        let deep: Vec<u8> = std::iter::repeat_n(1, DEEPEST + 4).chain([0]).collect();
        assert!(walk(&deep).is_err_and(|why| why.contains("nested")));
    }

    #[test]
    fn a_page_that_inflates_to_gigabytes_is_refused() {
        // Fields 1 to 3: a data page (0) of 2^30 bytes, stored in 4; field 5.1: 10 values.
        let page = |inflated: &[u8], count: u8| {
            [&[0x15, 0, 0x15][..], inflated, &[0x15, 8, 0x2c, 0x15, 2 * count, 0, 0], &[0; 4]]
                .concat()
        };
        assert_eq!(pages_of(&page(&[80], 10), 10, 8), Ok(40));
        assert!(
            pages_of(&page(&[0x80, 0x80, 0x80, 0x80, 0x08], 10), 10, 8)
                .is_err_and(|why| why.contains("1024 MB"))
        );
        assert!(pages_of(&page(&[80], 11), 10, 8).is_err_and(|why| why.contains("11 values")));
        assert!(pages_of(&page(&[80], 10)[..14], 10, 8).is_err_and(|why| why.contains("4 bytes")));
    }
}
