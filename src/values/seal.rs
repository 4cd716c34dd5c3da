//! The hash of a file inside the file, and binary contents as text.

use std::io::{Read, Write as _};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;

use crate::data::hash::{Hasher, sha256};

/// Stands before the hash, once in a file.
const MARK: &str = "SHA-256 with this hash as zeros: ";
/// Digits of a hash.
const DIGITS: usize = 64;
/// Maximum size of unpacked contents in bytes: the marks of 10 000 km take 0.5 GB.
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

/// # Errors
/// It is not packed, or larger than `LARGEST`.
pub fn unpacked(text: &str) -> Result<Vec<u8>, String> {
    let compressed = STANDARD.decode(text).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    let read = DeflateDecoder::new(compressed.as_slice()).take(LARGEST + 1).read_to_end(&mut bytes);
    match read {
        Ok(size) if size as u64 <= LARGEST => Ok(bytes),
        Ok(_) => Err(format!("more than {} GB", LARGEST >> 30)),
        Err(error) => Err(error.to_string()),
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
            assert_eq!(unpacked(&packed(bytes)).as_deref(), Ok(bytes));
            assert_eq!(unpacked(&stored(bytes)).as_deref(), Ok(bytes));
        }
        assert!(unpacked("!").is_err() && unpacked("AAAA").is_err());
    }
}
