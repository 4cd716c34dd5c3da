//! Sentences in which symbols of quantities and names of the protocol stand.

use super::{
    symbol::Symbol,
    text::{Run, Text},
};

/// The symbols that a document knows, longest first.
#[derive(Clone, Debug, Default)]
pub struct Symbols(Vec<String>);

impl Symbols {
    pub fn new<'a>(all: impl IntoIterator<Item = &'a str>) -> Self {
        let with_subscript = |symbol: &&str| symbol.contains('_') && symbol.len() >= 3;
        let mut known: Vec<String> =
            all.into_iter().filter(with_subscript).map(str::to_owned).collect();
        known.sort_by_key(|symbol| std::cmp::Reverse(symbol.len()));
        Self(known)
    }

    /// A sentence with every known symbol in it, and each name between backticks as code.
    pub fn text(&self, sentence: &str) -> Text {
        let mut found = Text::default();
        let mut rest = sentence;
        while let Some((before, (name, after))) =
            rest.split_once('`').and_then(|(before, after)| Some((before, after.split_once('`')?)))
        {
            found = found.with(self.symbols_in(before));
            let is_name = name.split(' ').all(|word| {
                !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "_.-".contains(c))
            });
            found = if is_name {
                found.then(Run::Code(name.to_owned()))
            } else {
                found.and("`").with(self.symbols_in(name)).and("`")
            };
            rest = after;
        }
        found.with(self.symbols_in(rest))
    }

    fn symbols_in(&self, text: &str) -> Text {
        let (mut found, mut plain, mut rest, mut before) =
            (Text::default(), String::new(), text, None);
        while let Some(first) = rest.chars().next() {
            // A symbol within a longer name is not typeset: `Y_qst` in `SigmaY_qst` or
            // `Y_qst_simulated`.
            let in_name = |c: char| c.is_alphanumeric() || c == '_';
            let whole = |symbol: &str| {
                let (start, end) = (symbol.starts_with(in_name), symbol.ends_with(in_name));
                !(start && before.is_some_and(in_name)
                    || end && rest[symbol.len()..].starts_with(in_name))
            };
            match self.0.iter().find(|symbol| rest.starts_with(symbol.as_str()) && whole(symbol)) {
                Some(symbol) => {
                    found = found
                        .and(std::mem::take(&mut plain))
                        .then(Run::Symbol(Symbol::new(symbol)));
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
        found.and(plain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A symbol as `<i>`, `<sub>`, code as `<code>`.
    fn marked(text: &Text) -> String {
        let run = |run: &Run| match run {
            Run::Symbol(symbol) => {
                let piece = |(text, slanted): &(String, bool)| {
                    if *slanted { format!("<i>{text}</i>") } else { text.clone() }
                };
                let base: String = symbol.base.iter().map(piece).collect();
                format!("{base}<sub>{}</sub>", symbol.subscript).replace("<sub></sub>", "")
            }
            Run::Code(name) => format!("<code>{name}</code>"),
            Run::Plain(text) => text.clone(),
            other => format!("{other:?}"),
        };
        text.0.iter().map(run).collect()
    }

    #[test]
    fn symbols_get_subscripts() {
        let typeset = |symbol: &str| marked(&Text::symbol(symbol));
        assert_eq!(typeset("(Y/Q)_qst"), "(<i>Y</i>/<i>Q</i>)<sub>qst</sub>");
        assert_eq!(typeset("z\u{308}*_rms"), "<i>z\u{308}</i>*<sub>rms</sub>");
        assert_eq!(typeset("a_b_c<"), "a_b_c<");
        assert_eq!(typeset("<_>"), "<<sub>></sub>");
        assert_eq!((typeset("ab1"), typeset("_a")), ("<i>ab</i>1".into(), "_a".into()));
    }

    #[test]
    fn symbols_and_names_are_found_in_sentences() {
        let known = Symbols::new(["Y_max", "ΣY_max", "ab", "_a"]);
        let text = |text: &str| marked(&known.text(text));
        assert_eq!(text("`Y_max` `b` `<` `"), "<code>Y_max</code> <code>b</code> `<` `");
        assert_eq!(text("aY_max Y_max_b (Y_max)"), "aY_max Y_max_b (<i>Y</i><sub>max</sub>)");
        assert_eq!(text("`a name` `a  b`"), "<code>a name</code> `a  b`");
        assert_eq!(text("<ΣY_max: Y_max"), "<Σ<i>Y</i><sub>max</sub>: <i>Y</i><sub>max</sub>");
    }
}
