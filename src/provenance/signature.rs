//! Detached signatures in the format of minisign: Ed25519 over BLAKE2b of the file, in a separate
//! file next to it.

use std::{
    io::Cursor,
    path::{Path, PathBuf},
};

use minisign::{KeyPair, PublicKeyBox, SecretKeyBox, SignatureBox};
pub use minisign::{PublicKey, SecretKey};

use super::check::Check;
use crate::data::{hash::sha256, text::read_bytes};
use crate::disk;
use crate::problem::Problem;

/// Environment variable with the password; if it is not set, the password is requested on the
/// terminal. It is not accepted on the command line, which other users can see.
pub const PASSWORD: &str = "FISHPLATE_KEY_PASSWORD";

/// Maximum size of a key or signature file in bytes; typical ones have a few hundred.
const SMALL: u64 = 64 << 10;
/// Maximum size of a file to be signed or checked, in bytes: that of a report.
const LARGE: u64 = 512 << 20;

/// Default path of the signature of a file.
pub fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(disk::SIGNATURE);
    path.with_file_name(name)
}

fn text(path: &Path) -> Result<String, Problem> {
    let shown = path.display().to_string();
    crate::data::text::decode(&read_bytes(path, &shown, SMALL)?, &shown).map(str::to_string)
}

/// Reads a file to be signed or checked.
///
/// # Errors
/// `file-missing`, `file-unreadable`, `file-empty`, `file-too-large`.
pub fn content(path: &Path) -> Result<Vec<u8>, Problem> {
    read_bytes(path, &path.display().to_string(), LARGE)
}

/// A new pair of keys as the texts of two files, secret and public.
///
/// # Errors
/// `key-failed`: no random numbers, or no terminal to ask for a password.
pub fn new_keys(password: Option<String>, protected: bool) -> Result<(String, String), Problem> {
    let failed = |error: minisign::PError| {
        let problem = Problem::error("key-failed", format!("no key could be generated: {error}"));
        problem.help(format!(
            "give a password on the terminal or in {PASSWORD}, or use `--no-password`"
        ))
    };
    let keys = if protected {
        KeyPair::generate_encrypted_keypair(password)
    } else {
        KeyPair::generate_unencrypted_keypair()
    };
    let keys = keys.map_err(failed)?;
    let secret = keys.sk.to_box(Some("fishplate secret key")).map_err(failed)?.into_string();
    let public = keys.pk.to_box().map_err(failed)?.into_string();
    Ok((secret, public))
}

/// Reads a secret key, with its password if it is protected.
///
/// # Errors
/// `key-unreadable`: not a secret key, or a wrong password.
pub fn secret_key(path: &Path, password: Option<String>) -> Result<SecretKey, Problem> {
    let shown = path.display();
    let text = text(path)?;
    let unreadable = |error: minisign::PError| {
        let problem = Problem::error(
            "key-unreadable",
            format!("`{shown}` cannot be used as a secret key: {error}"),
        );
        problem.help(format!(
            "give a secret key of `fishplate keygen`, or of minisign with a password; the password is requested, or read from {PASSWORD}"
        ))
    };
    let boxed = SecretKeyBox::from_string(&text).map_err(unreadable)?;
    match boxed.clone().into_unencrypted_secret_key() {
        Ok(key) => Ok(key),
        // The crate has no other way to detect that a password is needed.
        Err(error) if error.to_string().contains("encrypted") => {
            boxed.into_secret_key(password).map_err(unreadable)
        }
        Err(error) => Err(unreadable(error)),
    }
}

/// Reads a public key: a file, or the key itself as one word.
///
/// # Errors
/// `key-unreadable`.
pub fn public_key(given: &str) -> Result<PublicKey, Problem> {
    let path = Path::new(given);
    let unreadable = |error: minisign::PError| {
        let problem =
            Problem::error("key-unreadable", format!("`{given}` is not a public key: {error}"));
        problem.help(
            "give the `.pub` file of the secret key, or the key as one word beginning with `RW`",
        )
    };
    if disk::may_be_file(path) {
        let text = text(path)?;
        let key = PublicKeyBox::from_string(&text).and_then(|key| key.into_public_key());
        return key.or_else(|_| PublicKey::from_base64(text.trim())).map_err(unreadable);
    }
    PublicKey::from_base64(given).map_err(unreadable)
}

/// The signature of data, as the text of its file. Its signed comment contains the file name and no
/// time.
///
/// # Errors
/// `sign-failed`.
pub fn sign(key: &SecretKey, name: &str, bytes: &[u8]) -> Result<String, Problem> {
    let plain: String =
        name.chars().map(|sign| if sign.is_control() { '_' } else { sign }).collect();
    let comment = format!("file:{plain} sha256:{}", sha256(bytes));
    let failed = |error: minisign::PError| {
        Problem::error("sign-failed", format!("`{plain}` cannot be signed: {error}"))
    };
    let public = PublicKey::from_secret_key(key).map_err(failed)?;
    let untrusted = concat!("signature by fishplate ", env!("CARGO_PKG_VERSION"));
    let signed =
        minisign::sign(Some(&public), key, Cursor::new(bytes), Some(&comment), Some(untrusted))
            .map_err(failed)?;
    Ok(signed.into_string())
}

/// The key number as printed by minisign.
fn number(key: &[u8]) -> String {
    key.iter().rev().map(|byte| format!("{byte:02X}")).collect()
}

const NOT_OF_THIS: &str =
    "the signature is not one of this file, but of an earlier report or another file";

/// The name of a file without its folder.
fn shown(path: &Path) -> std::borrow::Cow<'_, str> {
    path.file_name().unwrap_or_default().to_string_lossy()
}

/// What file a signature says it is of, if that is not the one it lies beside.
fn of_another_file(comment: &str, bytes: &[u8]) -> Option<String> {
    let (_, signed) = comment.split_once("sha256:")?;
    let own = sha256(bytes);
    let is_hash = signed.len() == own.len() && signed.bytes().all(|sign| sign.is_ascii_hexdigit());
    (is_hash && signed != own)
        .then(|| format!("signed: SHA-256 {signed}; this file: SHA-256 {own}; sign this file, if it is the one meant"))
}

/// Checks the signature of a file.
///
/// # Errors
/// The given signature cannot be read.
pub fn check(
    path: &Path,
    signature: Option<&Path>,
    key: Option<&PublicKey>,
) -> Result<Check, Problem> {
    const NAME: &str = "signature";
    let own = beside(path);
    let at = signature.unwrap_or(&own);
    if signature.is_none() && disk::is_link(at).unwrap_or(true) {
        let says = format!("`{}` is a symbolic link, which is not followed", at.display());
        return Ok(Check::differs(NAME, says, Vec::new()));
    }
    if signature.is_none() && !disk::may_be_file(at) {
        return Ok(match key {
            None => Check::not_asked(NAME, format!("there is no `{}`", shown(at))),
            Some(_) => {
                Check::differs(NAME, format!("there is no signature `{}`", shown(at)), Vec::new())
            }
        });
    }
    let text = text(at)?;
    let unreadable = |why: &dyn std::fmt::Display| {
        Ok(Check::differs(
            NAME,
            format!("`{}` is not a signature", at.display()),
            vec![why.to_string()],
        ))
    };
    // Lengths are checked here, since the signing crate would panic.
    let signed = match minisign_verify::Signature::decode(&text) {
        Ok(signed) => signed,
        Err(error) => return unreadable(&error),
    };
    let by = match SignatureBox::from_string(&text) {
        Ok(signed) => number(signed.keynum()),
        Err(error) => return unreadable(&error),
    };
    let bytes = content(path)?;
    let other = of_another_file(signed.trusted_comment(), &bytes);
    let Some(key) = key else {
        if other.is_some() {
            return Ok(Check::differs(NAME, NOT_OF_THIS, other.into_iter().collect()));
        }
        let says = format!(
            "{} is signed with key {by}; give its public key with `--public-key` to check it",
            shown(path)
        );
        return Ok(Check::not_asked(NAME, says));
    };
    let checked = minisign_verify::PublicKey::from_base64(&key.to_base64())
        .and_then(|key| key.verify(&bytes, &signed, false));
    Ok(match checked {
        Ok(()) => {
            Check::agrees(NAME, format!("signed with key {by}: {}", signed.trusted_comment()))
        }
        Err(error) => {
            let keys =
                format!("signed with key {by}, checked with key {}: {error}", number(key.keynum()));
            match other.filter(|_| by == number(key.keynum())) {
                Some(says) => Check::differs(NAME, NOT_OF_THIS, vec![says]),
                None => Check::differs(
                    NAME,
                    "the signature is not one of this file with this key",
                    vec![keys],
                ),
            }
        }
    })
}
