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
            Self::Float(4) => each!(f32),
            Self::Float(8) => each!(f64),
            _ => return None,
        })
    }
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
