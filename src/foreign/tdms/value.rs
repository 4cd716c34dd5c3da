//! Values of TDMS: numbers, texts, properties.

use super::super::NANOSECONDS;
use super::super::binary::{Cursor, Number};
use super::EPOCH;

// Types of values that are not plain numbers, by their numbers in the format.
pub const TEXT: u32 = 0x20;
pub const TIME: u32 = 0x44;
const COMPLEX_SINGLE: u32 = 0x08_000c;
const COMPLEX_DOUBLE: u32 = 0x10_000d;

/// The plain numbers of a type. Types with a unit are those of single and double numbers plus 16.
fn number(kind: u32) -> Option<Number> {
    Some(match kind {
        1..=4 => Number::Signed(1 << (kind - 1)),
        5..=8 => Number::Unsigned(1 << (kind - 5)),
        9 | 0x19 => Number::Float(4),
        10 | 0x1a => Number::Float(8),
        // A truth value.
        0x21 => Number::Unsigned(1),
        _ => return None,
    })
}

/// Bytes of a value; `None` for texts and unknown types.
pub fn size_of(kind: u32) -> Option<usize> {
    match kind {
        COMPLEX_SINGLE => Some(8),
        TIME | COMPLEX_DOUBLE => Some(16),
        _ => number(kind).map(Number::size),
    }
}

/// A type that is not numbers, in words.
pub fn what(kind: u32) -> &'static str {
    match kind {
        TEXT => "its values are texts",
        COMPLEX_SINGLE | COMPLEX_DOUBLE => "its values are complex numbers",
        _ => "its values are of an unknown type",
    }
}

/// Values as numbers; `None` if they are not plain numbers.
pub fn numbers(kind: u32, data: &[u8], big: bool) -> Option<Vec<f64>> {
    number(kind)?.read(data, big)
}

/// Times as seconds from the first of the file, which `since` keeps in ns since 1970: as seconds
/// since 1970 they have more digits than a double. NaN before 1677 and after 2262.
pub fn times(data: &[u8], big: bool, since: &mut Option<i64>) -> Vec<f64> {
    let seconds = |bytes: &[u8; 16]| {
        let (seconds, fraction) = time(&mut Cursor::new(bytes, big)).ok()?;
        let at = nanoseconds(seconds, fraction)?;
        Some(at.checked_sub(*since.get_or_insert(at))? as f64 / NANOSECONDS as f64)
    };
    data.as_chunks().0.iter().map(seconds).map(|time| time.unwrap_or(f64::NAN)).collect()
}

fn nanoseconds(seconds: i64, fraction: f64) -> Option<i64> {
    seconds.checked_mul(NANOSECONDS)?.checked_add((fraction * NANOSECONDS as f64).round() as i64)
}

/// A property of an object.
#[derive(Clone, Debug, PartialEq)]
pub enum Property {
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

    /// A time in ns since 1970. LabVIEW writes the beginning of its epoch where there is none.
    pub fn instant(&self) -> Option<i64> {
        match self {
            Self::Time(seconds, fraction) if *seconds != -EPOCH => nanoseconds(*seconds, *fraction),
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

/// A text after its length.
///
/// # Errors
/// It is longer than what is left.
pub fn text(bytes: &mut Cursor<'_>) -> Result<String, String> {
    let length = bytes.u32()? as usize;
    Ok(String::from_utf8_lossy(bytes.take(length)?).into_owned())
}

/// Seconds since 1970 and a part of a second, which comes first in a file of little-endian numbers.
fn time(bytes: &mut Cursor<'_>) -> Result<(i64, f64), String> {
    let (first, second) = (bytes.u64()?, bytes.u64()?);
    let (seconds, fraction) = if bytes.big { (first, second) } else { (second, first) };
    Ok((seconds.cast_signed().saturating_sub(EPOCH), fraction as f64 / 2f64.powi(64)))
}

/// A property after its type.
///
/// # Errors
/// An unknown type; it is longer than what is left.
pub fn property(bytes: &mut Cursor<'_>) -> Result<Property, String> {
    let kind = bytes.u32()?;
    if kind == TEXT {
        return text(bytes).map(Property::Text);
    }
    if kind == TIME {
        return time(bytes).map(|(seconds, fraction)| Property::Time(seconds, fraction));
    }
    let size = size_of(kind).ok_or_else(|| format!("a property of the unknown type {kind:#x}"))?;
    numbers(kind, bytes.take(size)?, bytes.big)
        .and_then(|numbers| numbers.first().copied())
        .map(Property::Number)
        .ok_or_else(|| "a property that is not a number".into())
}
