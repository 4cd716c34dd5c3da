//! Texts of a family with `{variable}`, and their form for each member.

use std::{ops::Range, sync::Arc};

use super::each::Word;
use crate::problem::{Problem, Problems, error, nearest, problem};
use crate::source::{Filled, Member, Piece, Span, Spanned};
use crate::syntax::document::Text;

/// Kind of a text. It decides how a member is inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// The name of a block: characters that a name cannot contain become `_`.
    Name,
    /// Words of the language. Braces next to a name are part of the name.
    Phrase,
    Prose,
    /// Prose in which places of the vehicle are also written in braces.
    Pattern,
}

/// A text split at its variables once for all members.
#[derive(Debug)]
pub struct Template<'a> {
    text: &'a Text,
    pieces: Vec<(Range<usize>, Option<Braces>)>,
}

#[derive(Clone, Copy, Debug)]
struct Braces {
    variable: usize,
    in_name: bool,
}

impl<'a> Template<'a> {
    /// Finds the variables in a text; `None` after a problem if braces contain no variable.
    pub fn new(
        text: &'a Text,
        of: Use,
        variables: &[Spanned<String>],
        problems: &mut Problems,
    ) -> Option<Self> {
        let written = text.text.as_str();
        let mut pieces: Vec<(Range<usize>, Option<Braces>)> = Vec::new();
        let (mut start, mut at, mut sound) = (0, 0, true);
        while let Some(found) = written[at..].find(['{', '}']).map(|found| at + found) {
            let end = written[found..].find('}').map_or(found + 1, |end| found + end + 1);
            let inside =
                written[found..end].strip_prefix('{').and_then(|rest| rest.strip_suffix('}'));
            let variable = inside
                .and_then(|inside| variables.iter().position(|variable| variable.value == inside));
            at = if of == Use::Pattern { found + 1 } else { end };
            if let Some(variable) = variable {
                at = end;
                pieces.push((start..found, None));
                let in_name = of == Use::Name || of == Use::Phrase && touches(written, found..end);
                pieces.push((found..end, Some(Braces { variable, in_name })));
                start = end;
            } else if of != Use::Pattern {
                sound = false;
                problems.push(stands_for_nothing(inside, variables, &text.place(found..end)));
            }
        }
        pieces.push((start..written.len(), None));
        pieces.retain(|(range, _)| !range.is_empty());
        sound.then_some(Self { text, pieces })
    }

    pub fn uses(&self, variable: usize) -> bool {
        self.pieces
            .iter()
            .any(|(_, braces)| braces.is_some_and(|braces| braces.variable == variable))
    }

    /// The text for a member; `words` has a word for each variable.
    pub fn text(&self, words: &[Word]) -> String {
        self.pieces.iter().map(|(range, braces)| self.piece(range, *braces, words).0).collect()
    }

    /// Approximate number of bytes that [`Self::fill`] uses.
    pub fn cost(&self, words: &[Word]) -> usize {
        self.pieces
            .iter()
            .map(|(range, braces)| size_of::<Piece>() + self.piece(range, *braces, words).0.len())
            .sum()
    }

    fn piece(
        &self,
        range: &Range<usize>,
        braces: Option<Braces>,
        words: &[Word],
    ) -> (String, Option<Word>) {
        match braces.and_then(|braces| Some((braces, words.get(braces.variable)?))) {
            Some((braces, word)) => (
                if braces.in_name { in_name(&word.value) } else { word.value.clone() },
                Some(Arc::clone(word)),
            ),
            None => (self.text.text[range.clone()].to_owned(), None),
        }
    }

    /// The text for a member, with its place.
    pub fn fill(&self, words: &[Word], member: &Arc<Member>) -> Text {
        let mut text = String::new();
        let mut pieces = Vec::with_capacity(self.pieces.len());
        for (range, braces) in &self.pieces {
            let (piece, put_in) = self.piece(range, *braces, words);
            pieces.push(Piece {
                text: text.len()..text.len() + piece.len(),
                from: range.clone(),
                put_in,
            });
            text.push_str(&piece);
        }
        let filled = Filled { text: text.clone(), member: Arc::clone(member), pieces };
        Text {
            text,
            span: Span { filled: Some(Arc::new(filled)), ..self.text.span.clone() },
            exact: self.text.exact,
        }
    }
}

/// Whether the braces are next to a part of a name: `{part}_limit`, `{channel}_{part}`.
fn touches(text: &str, braces: Range<usize>) -> bool {
    let name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text[..braces.start].ends_with(|c| name(c) || c == '}')
        || text[braces.end..].starts_with(|c| name(c) || c == '{')
}

/// The form of a word in a name: `0.4_Hz_to_2_Hz`.
fn in_name(word: &str) -> String {
    let mut name = String::with_capacity(word.len());
    for c in word.chars() {
        if c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.') {
            name.push(c);
        } else if !name.ends_with('_') {
            name.push('_');
        }
    }
    name.trim_end_matches('_').to_owned()
}

fn stands_for_nothing(inside: Option<&str>, variables: &[Spanned<String>], at: &Span) -> Problem {
    let Some(inside) = inside else {
        return error("unknown-variable", "this brace has no partner", at)
            .help("write the name of a variable in braces: `{part}`");
    };
    let names = || variables.iter().map(|variable| variable.value.as_str());
    let word = inside.trim();
    let problem = problem!("unknown-variable", at, "`{{{inside}}}` is not a variable");
    match names().find(|name| *name == word).or_else(|| nearest(word, names())) {
        Some(near) => problem.help(format!("did you mean `{{{near}}}`?")),
        None => problem.help(format!(
            "variables here: {}",
            names().map(|name| format!("`{{{name}}}`")).collect::<Vec<_>>().join(", ")
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn spanned(words: &str) -> Spanned<String> {
        Spanned::new(words.to_string(), Source::new("word", words).whole())
    }

    fn filled(of: Use, words: &str, value: &str) -> String {
        let text =
            Text { text: words.to_string(), span: Source::new("text", words).whole(), exact: true };
        let mut problems = Problems::default();
        let variables = [spanned("x")];
        let template = Template::new(&text, of, &variables, &mut problems)
            .unwrap_or_else(|| panic!("{}", problems.render(false)));
        template.text(&[Arc::new(spanned(value))])
    }

    #[test]
    fn a_member_is_put_in_as_the_text_needs_it() {
        for (of, text, value, wanted) in [
            (Use::Name, "ay_{x}", "0.4 Hz to 2 Hz", "ay_0.4_Hz_to_2_Hz"),
            (Use::Name, "ay_{x}", "m/s^2", "ay_m_s_2"),
            (Use::Name, "ay_{x}", "zero-phase", "ay_zero-phase"),
            (
                Use::Phrase,
                "band-pass {x}, order 4",
                "0.4 Hz to 2 Hz",
                "band-pass 0.4 Hz to 2 Hz, order 4",
            ),
            (Use::Phrase, "LP_{x}, then {x}", "2 Hz", "LP_2_Hz, then 2 Hz"),
            (Use::Phrase, "|p{x}|", "99.85", "|p99.85|"),
            (Use::Prose, "In {x}.", "kN*m", "In kN*m."),
            (Use::Pattern, "Y_{x}{side}", "1", "Y_1{side}"),
            (Use::Pattern, "{x", "1", "{x"),
        ] {
            assert_eq!(filled(of, text, value), wanted, "{text}");
        }
    }

    #[test]
    fn braces_that_stand_for_nothing_are_told() {
        let text = Text {
            text: "{y} { x } {".to_string(),
            span: Source::new("text", "{y} { x } {").whole(),
            exact: true,
        };
        let mut problems = Problems::default();
        assert!(Template::new(&text, Use::Prose, &[spanned("x")], &mut problems).is_none());
        let said: Vec<_> = problems
            .0
            .iter()
            .map(|problem| (problem.says.as_str(), problem.help.as_deref().unwrap_or("")))
            .collect();
        assert_eq!(
            said,
            [
                ("`{y}` is not a variable", "variables here: `{x}`"),
                ("`{ x }` is not a variable", "did you mean `{x}`?"),
                ("this brace has no partner", "write the name of a variable in braces: `{part}`"),
            ]
        );
    }
}
