//! Values of TDMS: numbers, texts, properties.

use super::EPOCH;

// Types of values, by their numbers in the format.
const I8: u32 = 1;
const I16: u32 = 2;
const I32: u32 = 3;
const I64: u32 = 4;
const U8: u32 = 5;
const U16: u32 = 6;
const U32: u32 = 7;
const U64: u32 = 8;
const SINGLE: u32 = 9;
const DOUBLE: u32 = 10;
const SINGLE_WITH_UNIT: u32 = 0x19;
const DOUBLE_WITH_UNIT: u32 = 0x1a;
pub(super) const TEXT: u32 = 0x20;
const BOOLEAN: u32 = 0x21;
pub(super) const TIME: u32 = 0x44;
const COMPLEX_SINGLE: u32 = 0x08_000c;
const COMPLEX_DOUBLE: u32 = 0x10_000d;

/// Bytes of a value; `None` for texts and unknown types.
pub(super) fn size_of(kind: u32) -> Option<usize> {
    match kind {
        I8 | U8 | BOOLEAN => Some(1),
        I16 | U16 => Some(2),
        I32 | U32 | SINGLE | SINGLE_WITH_UNIT => Some(4),
        I64 | U64 | DOUBLE | DOUBLE_WITH_UNIT | COMPLEX_SINGLE => Some(8),
        TIME | COMPLEX_DOUBLE => Some(16),
        _ => None,
    }
}

/// A type that is not numbers, in words.
pub(super) fn what(kind: u32) -> &'static str {
    match kind {
        TEXT => "its values are texts",
        COMPLEX_SINGLE | COMPLEX_DOUBLE => "its values are complex numbers",
        _ => "its values are of an unknown type",
    }
}

/// Values as numbers; `None` if they are not numbers. Times are seconds since 1970.
pub(super) fn numbers(kind: u32, data: &[u8], big: bool) -> Option<Vec<f64>> {
    macro_rules! each {
        ($type:ty) => {
            data.as_chunks::<{ size_of::<$type>() }>()
                .0
                .iter()
                .map(|bytes| if big { <$type>::from_be_bytes(*bytes) } else { <$type>::from_le_bytes(*bytes) } as f64)
                .collect()
        };
    }
    use std::mem::size_of;
    Some(match kind {
        I8 => each!(i8),
        U8 | BOOLEAN => each!(u8),
        I16 => each!(i16),
        U16 => each!(u16),
        I32 => each!(i32),
        U32 => each!(u32),
        I64 => each!(i64),
        U64 => each!(u64),
        SINGLE | SINGLE_WITH_UNIT => each!(f32),
        DOUBLE | DOUBLE_WITH_UNIT => each!(f64),
        TIME => data
            .as_chunks::<16>()
            .0
            .iter()
            .map(|bytes| {
                let mut time = Bytes::new(bytes, big);
                time.time().map_or(f64::NAN, |(seconds, fraction)| {
                    seconds.saturating_sub(EPOCH) as f64 + fraction
                })
            })
            .collect(),
        _ => return None,
    })
}

/// A property of an object.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Property {
    Number(f64),
    Text(String),
    /// Seconds since 1970 and a part of a second.
    Time(i64, f64),
}

impl Property {
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    pub fn text(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Text(text) => text.clone(),
            Self::Time(seconds, fraction) => {
                format!("{:.6} s since 1970-01-01 UTC", *seconds as f64 + fraction)
            }
        }
    }
}

/// Bytes that are read from the front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    pub big: bool,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], big: bool) -> Self {
        Self { bytes, big }
    }

    pub fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self
            .bytes
            .split_at_checked(count)
            .ok_or_else(|| format!("{count} bytes are declared, {} are left", self.bytes.len()))?;
        self.bytes = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        if self.big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub fn u32(&mut self) -> Result<u32, String> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn u64(&mut self) -> Result<u64, String> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub fn text(&mut self) -> Result<String, String> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// Seconds since 1904 and a part of a second, which comes first in a file of little-endian
    /// numbers.
    fn time(&mut self) -> Result<(i64, f64), String> {
        let (seconds, fraction) = if self.big {
            let seconds = self.u64()?;
            (seconds, self.u64()?)
        } else {
            let fraction = self.u64()?;
            (self.u64()?, fraction)
        };
        Ok((seconds.cast_signed(), fraction as f64 / 2f64.powi(64)))
    }

    pub fn property(&mut self) -> Result<Property, String> {
        let kind = self.u32()?;
        if kind == TEXT {
            return self.text().map(Property::Text);
        }
        if kind == TIME {
            let (seconds, fraction) = self.time()?;
            return Ok(Property::Time(seconds.saturating_sub(EPOCH), fraction));
        }
        let size =
            size_of(kind).ok_or_else(|| format!("a property of the unknown type {kind:#x}"))?;
        let numbers = numbers(kind, self.take(size)?, self.big);
        numbers
            .and_then(|numbers| numbers.first().copied())
            .map(Property::Number)
            .ok_or_else(|| "a property that is not a number".into())
    }
}
