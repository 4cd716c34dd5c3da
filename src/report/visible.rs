//! Makes hidden characters visible, so that no name can hide text or look like another.

/// Text with white space as spaces and every character without a visible glyph spelled out:
/// `a\u{202e}b` becomes `a⟨U+202E⟩b`.
///
/// These are control characters, changes of writing direction, characters of zero width, private
/// and noncharacters, which include those that XML and HTML forbid.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\t' | '\n' | '\r' => shown.push(' '),
            c if hidden(c) => shown.push_str(&format!("⟨U+{:04X}⟩", u32::from(c))),
            c => shown.push(c),
        }
    }
    shown
}

fn hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}' | '\u{180b}'..='\u{180f}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}'
            | '\u{e000}'..='\u{f8ff}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}' | '\u{fdd0}'..='\u{fdef}'
            | '\u{e0000}'..='\u{10ffff}')
        || u32::from(c) & 0xfffe == 0xfffe
}

#[cfg(test)]
mod tests {
    use super::visible;

    #[test]
    fn what_cannot_be_seen_is_spelled_out() {
        assert_eq!(visible("Straße 中 שלום z̈ ✓ 🚆"), "Straße 中 שלום z̈ ✓ 🚆");
        assert_eq!(
            visible("a\u{202e}b\u{0}c\u{200b}d\u{feff}\u{e000}\u{ffff}"),
            "a⟨U+202E⟩b⟨U+0000⟩c⟨U+200B⟩d⟨U+FEFF⟩⟨U+E000⟩⟨U+FFFF⟩"
        );
        assert_eq!(visible("two\nlines\tand"), "two lines and");
    }
}
