//! Symbols of quantities as HTML: letters in italics, the part after the underscore as a subscript.

use minijinja::HtmlEscape;

/// `(Y/Q)_qst` as HTML, escaped.
pub(super) fn typeset(symbol: &str) -> String {
    let parts: Vec<&str> = symbol.split('_').collect();
    let (base, sub) = match parts[..] {
        [base] => (base, None),
        [base, sub] if !base.is_empty() && !sub.is_empty() => (base, Some(sub)),
        _ => return HtmlEscape(symbol).to_string(),
    };
    let mut out = String::new();
    let mut letters = base.chars().peekable();
    while let Some(letter) = letters.next() {
        if !(letter.is_ascii_alphabetic() || letter == 'ÿ') {
            out += &HtmlEscape(&letter.to_string()).to_string();
            continue;
        }
        out += &format!("<i>{letter}");
        while let Some(accent) = letters.next_if(|c| ('\u{300}'..='\u{36f}').contains(c)) {
            out.push(accent);
        }
        out += "</i>";
    }
    if let Some(sub) = sub {
        out += &format!("<sub>{}</sub>", HtmlEscape(sub));
    }
    out
}

/// A text, escaped, with every known symbol in it typeset and each name between backticks as code.
pub(super) fn typeset_in(text: &str, known: &[String]) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, (name, after))) =
        rest.split_once('`').and_then(|(before, after)| Some((before, after.split_once('`')?)))
    {
        out += &symbols_in(before, known);
        let is_name = name.split(' ').all(|word| {
            !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "_.-".contains(c))
        });
        out += &if is_name {
            format!("<code>{name}</code>")
        } else {
            format!("`{}`", symbols_in(name, known))
        };
        rest = after;
    }
    out + &symbols_in(rest, known)
}

fn symbols_in(text: &str, known: &[String]) -> String {
    let mut known: Vec<&str> = known
        .iter()
        .map(String::as_str)
        .filter(|symbol| symbol.contains('_') && symbol.len() >= 3)
        .collect();
    known.sort_by_key(|symbol| std::cmp::Reverse(symbol.len()));
    let (mut out, mut plain, mut rest, mut before) = (String::new(), String::new(), text, None);
    while let Some(first) = rest.chars().next() {
        // A symbol within a longer name is not typeset: `Y_qst` in `SigmaY_qst` or
        // `Y_qst_simulated`.
        let in_name = |c: char| c.is_alphanumeric() || c == '_';
        let whole = |symbol: &str| {
            let (start, end) = (symbol.starts_with(in_name), symbol.ends_with(in_name));
            !(start && before.is_some_and(in_name)
                || end && rest[symbol.len()..].starts_with(in_name))
        };
        match known.iter().find(|symbol| rest.starts_with(**symbol) && whole(symbol)) {
            Some(symbol) => {
                out += &format!("{}{}", HtmlEscape(&plain), typeset(symbol));
                plain.clear();
                rest = &rest[symbol.len()..];
                before = symbol.chars().last();
            }
            None => {
                plain.push(first);
                before = Some(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    out + &HtmlEscape(&plain).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_get_subscripts_and_stay_escaped() {
        assert_eq!(typeset("(Y/Q)_qst"), "(<i>Y</i>&#x2f;<i>Q</i>)<sub>qst</sub>");
        assert_eq!(typeset("z\u{308}*_rms"), "<i>z\u{308}</i>*<sub>rms</sub>");
        assert_eq!(typeset("a_b_c<"), "a_b_c&lt;");
        assert_eq!(typeset("<_>"), "&lt;<sub>&gt;</sub>");
        let known = ["Y_max".to_owned(), "ΣY_max".to_owned()];
        assert_eq!(
            typeset_in("`Y_max` `b` `<` `", &known),
            "<code>Y_max</code> <code>b</code> `&lt;` `"
        );
        assert_eq!(
            typeset_in("aY_max Y_max_b (Y_max)", &known),
            "aY_max Y_max_b (<i>Y</i><sub>max</sub>)"
        );
        assert_eq!(typeset_in("`a name` `a  b`", &known), "<code>a name</code> `a  b`");
        assert_eq!(
            typeset_in("<ΣY_max: Y_max", &known),
            "&lt;Σ<i>Y</i><sub>max</sub>: <i>Y</i><sub>max</sub>"
        );
    }
}
