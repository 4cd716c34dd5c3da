//! Symbols of quantities.

use serde::Serialize;

/// A symbol with letters in italics, and what follows its single underscore as a subscript:
/// `(Y/Q)_qst`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Symbol {
    /// As written.
    pub letters: String,
    /// Title of the quantity; empty where it stands beside the symbol.
    title: String,
    /// Pieces of the part before the subscript, and whether they are in italics.
    pub base: Vec<(String, bool)>,
    pub subscript: String,
}

impl Symbol {
    pub fn new(symbol: &str) -> Self {
        let (base, subscript) = symbol
            .split_once('_')
            .filter(|(base, sub)| !base.is_empty() && !sub.is_empty() && !sub.contains('_'))
            .unwrap_or((symbol, ""));
        let mut pieces: Vec<(String, bool)> = Vec::new();
        for letter in base.chars() {
            let accent = ('\u{300}'..='\u{36f}').contains(&letter);
            // A symbol with several underscores is a name.
            let slanted = (letter.is_ascii_alphabetic() || letter == 'ÿ') && !base.contains('_');
            match pieces.last_mut() {
                Some((piece, style)) if accent || *style == slanted => piece.push(letter),
                _ => pieces.push((letter.to_string(), slanted)),
            }
        }
        let (letters, title) = (symbol.to_owned(), String::new());
        Self { letters, title, base: pieces, subscript: subscript.to_owned() }
    }

    /// With the title of its quantity.
    pub fn titled(self, title: &str) -> Self {
        Self { title: title.to_owned(), ..self }
    }
}
