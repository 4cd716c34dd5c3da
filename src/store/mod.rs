//! Objects in a store: `s3://`, `az://`, `gs://`, `http://`, `https://`, `file://`. A part of an
//! object is read by itself.
//!
//! | file | content |
//! |---|---|
//! | `mod` | what a URL is |
//! | `remote` | objects, read through the crate `object_store`; with the feature `store` |
//! | `allowed` | which URLs the user allows |
//! | `none` | the same without this feature: no object is found |
//!
//! A campaign may come from anyone. No URL in it is opened unless the environment of the program
//! allows it.

#[cfg(feature = "store")]
mod allowed;
#[cfg(not(feature = "store"))]
mod none;
#[cfg(feature = "store")]
mod remote;

#[cfg(not(feature = "store"))]
pub use none::Object;
#[cfg(feature = "store")]
pub use remote::Object;

/// Why an object cannot be used: a code, what is wrong, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    pub code: &'static str,
    pub says: String,
    pub help: Option<String>,
}

/// Whether a text is the URL of an object. Other schemes are too; they are refused when they are
/// opened.
pub fn is_url(text: &str) -> bool {
    text.split_once("://").is_some_and(|(scheme, _)| {
        scheme.len() > 1
            && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_url_has_a_scheme_of_more_than_a_letter() {
        for url in ["s3://b/a.parquet", "https://x", "ftp://x"] {
            assert!(is_url(url), "{url}");
        }
        for path in ["C://x", "runs/a.parquet", "a/s3://b", "://x", "s 3://x", ""] {
            assert!(!is_url(path), "{path}");
        }
    }
}
