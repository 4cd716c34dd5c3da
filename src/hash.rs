//! Hashes of files.

use std::io::{self, ErrorKind, Read};

use base64::{Engine, engine::general_purpose::STANDARD};
use sha2::{Digest, Sha256};

/// Bytes read at a time; it does not change the result.
const READ: usize = 1 << 16;

/// SHA-256 of bytes that come in parts.
#[derive(Clone, Debug, Default)]
pub struct Hasher(Sha256);

impl Hasher {
    /// Adds the next part.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Adds all that is read; returns the number of bytes.
    ///
    /// # Errors
    /// Of reading.
    pub fn add_all(&mut self, file: &mut impl Read) -> io::Result<u64> {
        let (mut bytes, mut block) = (0, vec![0_u8; READ]);
        loop {
            match file.read(&mut block) {
                Ok(0) => return Ok(bytes),
                Ok(count) => {
                    self.add(&block[..count]);
                    bytes += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// In lower-case hexadecimal digits.
    pub fn finish(self) -> String {
        self.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// SHA-256 in lower-case hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    let mut hash = Hasher::default();
    hash.add(bytes);
    hash.finish()
}

/// SHA-256 in base64 with padding, as web pages have it.
pub fn sha256_base64(bytes: &[u8]) -> String {
    STANDARD.encode(Sha256::digest(bytes))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_examples_of_fips_180() {
        // FIPS 180-4 example values (NIST, Cryptographic Standards and Guidelines: SHA-256).
        assert_eq!(
            super::sha256(b""),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
        );
        assert_eq!(
            super::sha256(b"abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
