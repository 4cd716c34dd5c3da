//! Checksums in a Parquet file that this program writes. The library can check those of pages and
//! writes none.
//!
//! An entry of the file's metadata has CRC-32 numbers in hexadecimal digits: that of the footer, in
//! which these digits are zeros, then that of each column of each row group, as its bytes are in the
//! file.

use flate2::Crc;

/// The key of the entry.
pub const KEY: &str = "fishplate.crc32";
/// Who writes such files. Another program that writes the file again may keep the entry, and gives
/// itself as the writer.
pub const WRITER: &str = "fishplate, crc32";
/// Stands before the checksums.
const MARK: &str = "CRC-32 of the footer with this one as zeros, and of columns: ";
/// Digits of a checksum.
const DIGITS: usize = 8;

fn sum(parts: &[&[u8]]) -> String {
    let mut crc = Crc::new();
    parts.iter().for_each(|part| crc.update(part));
    format!("{:08x}", crc.sum())
}

/// The value of the entry before the footer is known.
pub fn blank() -> String {
    format!("{MARK}{}", "0".repeat(DIGITS))
}

/// The checksum of a column of a row group.
pub fn of_column(bytes: &[u8]) -> String {
    sum(&[bytes])
}

/// A footer before its digits, its digits, and behind them.
fn parts(footer: &[u8]) -> Option<[&[u8]; 3]> {
    let at = memchr::memmem::rfind(footer, MARK.as_bytes())? + MARK.len();
    let (before, rest) = footer.split_at(at);
    let (digits, behind) = rest.split_at_checked(DIGITS)?;
    Some([before, digits, behind])
}

fn of_footer(before: &[u8], behind: &[u8]) -> String {
    sum(&[before, &[b'0'; DIGITS], behind])
}

/// Puts the checksum of a footer into it.
pub fn close(footer: &mut [u8]) {
    let Some([before, _, behind]) = parts(footer) else { return };
    let (at, sum) = (before.len(), of_footer(before, behind));
    footer[at..at + DIGITS].copy_from_slice(sum.as_bytes());
}

/// Whether a footer is the one that was written.
pub fn is_sound(footer: &[u8]) -> bool {
    parts(footer)
        .is_some_and(|[before, digits, behind]| of_footer(before, behind).as_bytes() == digits)
}

/// The checksums of columns, row group by row group.
#[derive(Debug, Default)]
pub struct Sums(String);

impl Sums {
    pub fn of_entry(value: &str) -> Self {
        Self(value.get(MARK.len() + DIGITS..).unwrap_or_default().to_string())
    }

    /// Whether the bytes of a column, by its number over all row groups, are those that were written.
    pub fn holds(&self, number: usize, bytes: &[u8]) -> bool {
        let digits = self.0.get(number * DIGITS..(number + 1) * DIGITS);
        self.0.is_empty() || digits == Some(&of_column(bytes))
    }
}
