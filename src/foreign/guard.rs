//! Calls readers of other projects: a panic in one of them becomes an error.

use super::Format;
use crate::data::record::guarded;
use crate::problem::Problem;

/// Calls a reader.
///
/// # Errors
/// `format-damaged` if it panics: its authors did not expect the content.
pub(super) fn call<T>(
    format: Format,
    shown: &str,
    reader: impl FnOnce() -> Result<T, Vec<Problem>>,
) -> Result<T, Vec<Problem>> {
    guarded(|| Ok(reader()))
        .unwrap_or_else(|why| Err(damaged(format, shown, "the file", why).into()))
}

/// A file that is not as its format prescribes, at a place in it.
pub(super) fn damaged(
    format: Format,
    shown: &str,
    place: &str,
    why: impl std::fmt::Display,
) -> Problem {
    let why = why.to_string();
    let why: String =
        why.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST_REASON).collect();
    Problem::error(
        "format-damaged",
        format!("`{shown}`, {} is damaged or not complete, at {place}: {why}", format.title()),
    )
    .help("copy or export the file again; if it opens in its own program, export it there as CSV")
}

/// Longest reason of a reader in a message.
const LONGEST_REASON: usize = 200;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error() {
        let found: Result<(), _> = call(Format::Mdf4, "f", || panic!("index out of bounds"));
        assert_eq!(found.map_err(|problems| problems[0].code), Err("format-damaged"));
        assert_eq!(call(Format::Mdf4, "f", || Ok(1)), Ok(1));
    }
}
