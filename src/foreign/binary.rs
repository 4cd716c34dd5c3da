//! Bytes of a binary file, read from the front within their bounds, and the numbers in them.

/// Type of the numbers of an array, with the bytes of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Number {
    /// Bytes of a number.
    pub fn size(self) -> usize {
        let (Self::Signed(size) | Self::Unsigned(size) | Self::Float(size)) = self;
        size
    }

    /// The numbers in an array, whose first byte is the highest of a number if `big`; `None` if
    /// there are no numbers of this size.
    pub fn read(self, data: &[u8], big: bool) -> Option<Vec<f64>> {
        macro_rules! each {
            ($type:ty) => {{
                let (numbers, _) = data.as_chunks::<{ size_of::<$type>() }>();
                let read = if big { <$type>::from_be_bytes } else { <$type>::from_le_bytes };
                numbers.iter().map(|bytes| read(*bytes) as f64).collect()
            }};
        }
        Some(match self {
            Self::Signed(1) => each!(i8),
            Self::Signed(2) => each!(i16),
            Self::Signed(4) => each!(i32),
            Self::Signed(8) => each!(i64),
            Self::Unsigned(1) => each!(u8),
            Self::Unsigned(2) => each!(u16),
            Self::Unsigned(4) => each!(u32),
            Self::Unsigned(8) => each!(u64),
            Self::Float(2) => {
                let bits = if big { u16::from_be_bytes } else { u16::from_le_bytes };
                data.as_chunks().0.iter().map(|bytes| half(bits(*bytes))).collect()
            }
            Self::Float(4) => each!(f32),
            Self::Float(8) => each!(f64),
            _ => return None,
        })
    }
}

/// The number of a 16-bit float (IEEE 754 binary16).
pub fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let size = match exponent {
        0 => fraction * 2f64.powi(-24),
        0x1f if fraction == 0.0 => f64::INFINITY,
        0x1f => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    };
    if bits >> 15 == 0 { size } else { -size }
}

/// Bytes that are read from the front.
#[derive(Clone, Copy, Debug)]
pub struct Cursor<'a> {
    /// What is left.
    pub rest: &'a [u8],
    /// Whether the first byte of a number is its highest.
    pub big: bool,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8], big: bool) -> Self {
        Self { rest: bytes, big }
    }

    /// The next bytes, so many.
    ///
    /// # Errors
    /// How many are left.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self
            .rest
            .split_at_checked(count)
            .ok_or_else(|| format!("{count} bytes are declared, {} are left", self.rest.len()))?;
        self.rest = rest;
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_have_their_values() {
        // By `numpy.array([...], "u2").view("f2")`.
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x3555, 0.333_251_953_125),
            (0x7bff, 65_504.0),
            (0x0400, 6.103_515_625e-5),
            (0x0001, 5.960_464_477_539_063e-8),
            (0x8000, 0.0),
            (0x7c00, f64::INFINITY),
            (0xfc00, f64::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan());
        assert_eq!(Number::Float(2).read(&[0xc0, 0], true), Some(vec![-2.0]));
    }
}
