//! The hash of a file inside the file, and binary contents as text.

use std::io::{Read, Write as _};

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{read::DeflateDecoder, write::DeflateEncoder};

use crate::data::hash::{Hasher, sha256};

/// Stands before the hash, once in a file.
const MARK: &str = "SHA-256 with this hash as zeros: ";
/// Digits of a hash.
const DIGITS: usize = 64;
/// Bytes that the contents of any file may have when they are unpacked, and those for each byte of
/// the file. What all parts of a campaign repeat packs by about 15, and takes 20 MB for 13 000
/// sections; the rest packs by 1 to 3, and zeros by 1000. Contents that are read take up to ten
/// times as much memory.
const ALWAYS_UNPACKED: u64 = 64 << 20;
const MOST_EXPANSION: u64 = 8;
/// Maximum size of all unpacked contents in bytes: the marks of 10 000 km take 0.5 GB.
const LARGEST: u64 = 4 << 30;

/// What stands in a file until its hash is known.
pub fn blank() -> String {
    format!("{MARK}{}", "0".repeat(DIGITS))
}

/// Puts the hash of a file into the file; nothing if it has no place for one.
pub fn close(bytes: &mut [u8]) {
    let hash = sha256(bytes);
    if let Some(at) = place(bytes) {
        bytes[at..at + DIGITS].copy_from_slice(hash.as_bytes());
    }
}

/// The hash in a file.
///
/// # Errors
/// It has none, or is not as it was written.
pub fn check(bytes: &[u8]) -> Result<String, Broken> {
    let at = place(bytes).ok_or(Broken::NoSeal)?;
    let mut hasher = Hasher::default();
    hasher.add(&bytes[..at]);
    hasher.add(&[b'0'; DIGITS]);
    hasher.add(&bytes[at + DIGITS..]);
    let (written, found) = (&bytes[at..at + DIGITS], hasher.finish());
    if written == found.as_bytes() { Ok(found) } else { Err(Broken::Changed) }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Broken {
    NoSeal,
    Changed,
}

fn place(bytes: &[u8]) -> Option<usize> {
    let at = memchr::memmem::rfind(bytes, MARK.as_bytes())? + MARK.len();
    (at + DIGITS <= bytes.len()).then_some(at)
}

/// Compressed, as text.
pub fn packed(bytes: &[u8]) -> String {
    deflated(bytes, flate2::Compression::fast())
}

/// In the same form, for contents that compression does not make shorter.
pub fn stored(bytes: &[u8]) -> String {
    deflated(bytes, flate2::Compression::none())
}

fn deflated(bytes: &[u8], level: flate2::Compression) -> String {
    let mut compressed = DeflateEncoder::new(Vec::new(), level);
    // Writing to memory cannot fail.
    let _ = compressed.write_all(bytes);
    STANDARD.encode(compressed.finish().unwrap_or_default())
}

/// What the contents of a file may still take in memory.
#[derive(Debug)]
pub struct Budget {
    most: u64,
    left: u64,
}

impl Budget {
    /// Of a file of this size in bytes.
    pub fn of(size: usize) -> Self {
        let most = (size as u64).saturating_mul(MOST_EXPANSION).saturating_add(ALWAYS_UNPACKED);
        let most = most.min(LARGEST);
        Self { most, left: most }
    }

    /// Bytes that are left.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// Takes bytes.
    ///
    /// # Errors
    /// There are not so many left.
    pub fn take(&mut self, bytes: u64) -> Result<(), String> {
        let left = self.left.checked_sub(bytes);
        self.left = left.ok_or_else(|| {
            format!(
                "its contents unpack to more than {} MB, the maximum for its size",
                self.most >> 20
            )
        })?;
        Ok(())
    }

    /// Unpacks contents.
    ///
    /// # Errors
    /// They are not packed, or too large.
    pub fn unpacked(&mut self, text: &str) -> Result<Vec<u8>, String> {
        let compressed = STANDARD.decode(text).map_err(|error| error.to_string())?;
        let mut bytes = Vec::new();
        let mut decoder = DeflateDecoder::new(compressed.as_slice()).take(self.left + 1);
        let size = decoder.read_to_end(&mut bytes).map_err(|error| error.to_string())?;
        self.take(size as u64).map(|()| bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_changed_byte_breaks_the_seal() {
        let mut bytes = format!("before {} after", blank()).into_bytes();
        close(&mut bytes);
        assert!(check(&bytes).is_ok());
        for at in 0..bytes.len() {
            let mut other = bytes.clone();
            other[at] ^= 1;
            assert!(check(&other).is_err(), "{at}");
            assert!(check(&bytes[..at]).is_err(), "{at}");
        }
        assert_eq!(check(b"no file of values"), Err(Broken::NoSeal));
    }

    #[test]
    fn packed_contents_are_unpacked() {
        for bytes in [&b""[..], b"abc", &[7; 100_000]] {
            for text in [packed(bytes), stored(bytes)] {
                assert_eq!(Budget::of(0).unpacked(&text).as_deref(), Ok(bytes));
            }
        }
        assert!(Budget::of(0).unpacked("!").is_err() && Budget::of(0).unpacked("AAAA").is_err());
    }

    /// All contents together count, and a file may hold a multiple of its size.
    #[test]
    fn contents_unpack_to_a_bounded_size() {
        let packed = packed(&vec![0; 48 << 20]);
        let mut budget = Budget::of(packed.len());
        assert!(budget.unpacked(&packed).is_ok());
        let why = budget.unpacked(&packed).expect_err("too large");
        assert!(why.contains("more than 68 MB"), "{why}");
        let mut larger = Budget::of(10 << 20);
        assert!((0..3).all(|_| larger.unpacked(&packed).is_ok()));
    }
}
