//! The lines of the text form, read with `lines.pest`. The only file of the text form that names pest.

use std::ops::Range;

use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};
use pest::iterators::Pair;

mod grammar {
    /// Made by pest from the grammar file; kept apart because what it makes cannot carry our lints.
    #[derive(Debug, pest_derive::Parser)]
    #[grammar = "syntax/lines.pest"]
    pub struct Lines;
}
use grammar::{Lines, Rule};

/// One line of the file, as byte ranges in it.
#[derive(Debug, PartialEq, Eq)]
pub struct Line {
    pub indent: Range<usize>,
    /// What stands on the line, without blanks around it.
    pub body: Range<usize>,
    /// Text of the comment, without `#` and the blank after it.
    pub comment: Option<String>,
    /// Where a quote opens that no quote closes.
    pub unclosed: Option<usize>,
}

/// A block's first line, as byte ranges in it.
#[derive(Debug, PartialEq, Eq)]
pub struct Header {
    pub kind: Range<usize>,
    pub name: Option<Range<usize>>,
    /// With its quotes.
    pub title: Option<Range<usize>>,
}

/// What the grammar wanted instead of what stands there.
#[derive(Debug, PartialEq, Eq)]
pub struct Fault {
    pub at: Range<usize>,
    pub says: String,
    pub help: Option<String>,
}

/// Takes a line apart. Every text is a line.
pub fn line(text: &str) -> Line {
    let mut line = Line { indent: 0..0, body: 0..0, comment: None, unclosed: None };
    for pair in Lines::parse(Rule::line, text).into_iter().flatten().flat_map(Pair::into_inner) {
        let range = range(&pair);
        match pair.as_rule() {
            Rule::indent => line.indent = range,
            Rule::comment => line.comment = Some(comment(pair.as_str())),
            Rule::body => {
                line.body = range.start..range.start + pair.as_str().trim_end().len();
                line.unclosed = pair.into_inner().find(|part| part.as_rule() == Rule::unclosed).map(|part| part.as_span().start());
            }
            _ => {}
        }
    }
    line
}

/// Text of a comment, without `#` and the blank after it.
pub fn comment(written: &str) -> String {
    let text = written.strip_prefix('#').unwrap_or(written);
    text.strip_prefix(' ').unwrap_or(text).trim_end().to_owned()
}

/// Reads a block's first line; beside a fault comes what could be read before it, if at least the kind.
pub fn header(text: &str) -> (Option<Header>, Option<Fault>) {
    let (parsed, fault) = match Lines::parse(Rule::header, text) {
        Ok(pairs) => (Some(pairs), None),
        Err(error) => (Lines::parse(Rule::start, text).ok(), Some(in_words(text, &error))),
    };
    let mut header = None;
    for pair in parsed.into_iter().flatten().flat_map(Pair::into_inner) {
        let range = range(&pair);
        match (pair.as_rule(), &mut header) {
            (Rule::kind, _) => header = Some(Header { kind: range, name: None, title: None }),
            (Rule::name, Some(header)) => header.name = Some(range),
            (Rule::title, Some(header)) => header.title = Some(range),
            _ => {}
        }
    }
    (header, fault)
}

/// Whether a text can be the name of a block.
pub fn is_name(text: &str) -> bool {
    Lines::parse(Rule::alone, text).is_ok()
}

/// Whether a text can be the name of a family of blocks: a name, or one with `{variable}` in it.
pub fn is_family_name(text: &str) -> bool {
    Lines::parse(Rule::family, text).is_ok()
}

/// The words a field begins with, more than its key if its value begins with words too.
pub fn words(text: &str) -> Result<Vec<Range<usize>>, Fault> {
    let pairs = Lines::parse(Rule::field, text).map_err(|error| in_words(text, &error))?;
    Ok(pairs.flat_map(Pair::into_inner).filter(|pair| pair.as_rule() == Rule::word).map(|pair| range(&pair)).collect())
}

/// The quoted pieces of prose, each with its quotes.
pub fn prose(text: &str) -> Result<Vec<Range<usize>>, Fault> {
    let pairs = Lines::parse(Rule::prose, text).map_err(|error| in_words(text, &error))?;
    Ok(pairs.flat_map(Pair::into_inner).filter(|pair| pair.as_rule() == Rule::quoted).map(|pair| range(&pair)).collect())
}

fn range(pair: &Pair<'_, Rule>) -> Range<usize> {
    pair.as_span().start()..pair.as_span().end()
}

const END: &str = "the end of the line";
const BLANKS: [char; 4] = [' ', '\t', '\r', '\n'];

/// Turns pest's error into a sentence without rule names, and underlines the whole word it stumbled on.
fn in_words(text: &str, error: &pest::error::Error<Rule>) -> Fault {
    let start = match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    };
    // Only plain blanks part words: a special blank is then a part of the word that is shown.
    let rest = text.get(start..).unwrap_or("");
    let blank = rest.len() - rest.trim_start_matches(BLANKS).len();
    let word = rest[blank..].split(BLANKS).next().unwrap_or("");
    let at = start + blank..start + blank + word.len();
    let mut wanted: Vec<&str> = match &error.variant {
        ErrorVariant::ParsingError { positives, .. } => positives.iter().copied().map(name_of).collect(),
        ErrorVariant::CustomError { .. } => Vec::new(),
    };
    wanted.sort_by_key(|what| *what == END);
    wanted.dedup();
    let wanted = match wanted.as_slice() {
        [] => END.to_owned(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    };
    let says = if word.is_empty() { format!("{wanted} is expected here") } else { format!("{wanted} is expected, not `{word}`") };
    Fault { at, says, help: slip(word) }
}

/// Help with what an office program puts in place of plain characters.
pub fn slip(word: &str) -> Option<String> {
    word.chars().find_map(|c| match c {
        '\u{201c}' | '\u{201d}' | '\u{201e}' | '\u{ab}' | '\u{bb}' => {
            Some(format!("`{c}` is a typographic quote; quotes here are plain: \""))
        }
        _ if !c.is_ascii() && c.is_whitespace() => {
            Some("the blank is a special one (such as a no-break space); a plain one is needed".to_owned())
        }
        _ => None,
    })
}

/// What a rule is called in messages.
fn name_of(rule: Rule) -> &'static str {
    match rule {
        Rule::EOI | Rule::comment => END,
        Rule::kind => "the word of a block such as `quantity`",
        Rule::name | Rule::alone | Rule::family | Rule::letter | Rule::braces => "a name of letters, digits, `_`, `-` and `.`",
        Rule::title => "a title in quotes",
        Rule::quoted | Rule::prose => "text in quotes",
        Rule::inner | Rule::unclosed => "the closing quote",
        Rule::word | Rule::field => "the word of a field such as `limit`",
        Rule::header | Rule::start => "the first line of a block",
        Rule::line | Rule::body | Rule::plain => "a line",
        Rule::indent | Rule::gap | Rule::space => "a blank",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_in_quotes_is_no_comment() {
        let text = r##"  note "no. #3 \" #4"  # beside "##;
        let line = line(text);
        assert_eq!(&text[line.body.clone()], r##"note "no. #3 \" #4""##);
        assert_eq!(line.comment.as_deref(), Some("beside"));
        assert_eq!(line.unclosed, None);
    }

    #[test]
    fn an_open_quote_takes_the_rest_of_its_line() {
        let line = line(r#"note "a # b"#);
        assert_eq!((line.unclosed, line.comment), (Some(5), None));
    }

    #[test]
    fn faults_are_said_without_rule_names() {
        let (header, fault) = header("quantity Y max");
        assert_eq!(header.and_then(|header| header.name), Some(9..10));
        let fault = fault.expect("a second name is a fault");
        assert_eq!((fault.at, fault.says.as_str()), (11..14, "a title in quotes or the end of the line is expected, not `max`"));
    }

    #[test]
    fn names_are_plain() {
        assert!(["1", "Y_max", "en14363-2016-annex-t", "v1.2", "_x"].into_iter().all(is_name));
        assert!(!["", "-x", "a b", "Y/Q", "\u{3c3}", "Y_{m}"].into_iter().any(is_name));
        assert!(["Y_max", "{q}_{m}", "{q}", "a{q}.b"].into_iter().all(is_family_name));
        assert!(!["", "{q", "q}", "{}", "{a b}", "{{q}}", "Y/{q}"].into_iter().any(is_family_name));
    }
}
