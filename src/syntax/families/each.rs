//! The field `for each`: variables and their members.

use std::{ops::Range, sync::Arc};

use super::{Places, place_called};
use crate::problem::{Problems, error, nearest, problem};
use crate::source::Spanned;
use crate::syntax::{document::Text, keys::EACH, layout::Quotes, phrase::normalised};

/// The word of a member for one variable, with its place.
pub type Word = Arc<Spanned<String>>;

/// Variables whose members belong together: `band, name in (0.4 Hz to 2 Hz, low), (2 Hz to 10 Hz,
/// high)`.
#[derive(Debug)]
pub struct Group {
    pub variables: Vec<Spanned<String>>,
    /// A word for each variable.
    pub rows: Vec<Vec<Word>>,
}

/// Reads a field `for each`; groups are separated by `and`.
pub fn read(text: &Text, places: &Places, problems: &mut Problems) -> Option<Vec<Group>> {
    let mut heads: Vec<Head> = Vec::new();
    let open = open_places(&text.text);
    for at in word_starts(&text.text).filter(|at| !open[*at]) {
        let joined = text.text[at..].strip_prefix("and").map(|rest| text.text.len() - rest.len());
        let from = if at == first(&text.text) { Some(at) } else { joined };
        let Some(mut head) = from.and_then(|from| head(&text.text, from)) else { continue };
        head.at = at;
        heads.push(head);
    }
    if heads.first().is_none_or(|head| head.at != first(&text.text)) {
        let help = format!(
            "write `{EACH}  part in magnitude, phase`, and `{{part}}` where a member is inserted"
        );
        problems.push(
            problem!("syntax", text, "`{EACH}` needs a variable, `in` and members").help(help),
        );
        return None;
    }
    let ends = heads.iter().skip(1).map(|head| head.at).chain([text.text.len()]);
    let groups: Vec<Option<Group>> = heads
        .iter()
        .zip(ends)
        .map(|(head, end)| group(text, head, end, &open, places, problems))
        .collect();
    groups.into_iter().collect()
}

/// The start of a group: `band, name in`.
struct Head {
    at: usize,
    variables: Vec<Range<usize>>,
    end: usize,
}

fn first(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

/// For each byte, whether it is inside quotes or parentheses.
fn open_places(text: &str) -> Vec<bool> {
    let mut quotes = Quotes::default();
    let mut open = Vec::with_capacity(text.len());
    for c in text.chars() {
        let before = quotes.open();
        quotes.pass(c);
        open.extend(std::iter::repeat_n(before || quotes.open(), c.len_utf8()));
    }
    open
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn word_starts(text: &str) -> impl Iterator<Item = usize> {
    let mut last = ' ';
    text.char_indices().filter_map(move |(at, c)| {
        let starts = is_word(c) && last.is_whitespace();
        last = c;
        starts.then_some(at)
    })
}

fn head(text: &str, from: usize) -> Option<Head> {
    let mut variables = Vec::new();
    let mut at = from;
    loop {
        let start = at + first(&text[at..]);
        let end = start + text[start..].find(|c| !is_word(c)).unwrap_or(text.len() - start);
        if !text[start..].starts_with(|c: char| c.is_ascii_alphabetic()) {
            return None;
        }
        variables.push(start..end);
        at = end + first(&text[end..]);
        match text[at..].strip_prefix(',') {
            Some(_) => at += 1,
            None => break,
        }
    }
    let rest = text[at..].strip_prefix("in").filter(|rest| !rest.starts_with(is_word))?;
    // `and`, the first variable and `in` are separate words.
    let apart = |at: usize| text[..at].ends_with(char::is_whitespace);
    let begins = variables.first().is_some_and(|first| from == first.start || apart(first.start));
    (begins && apart(at)).then(|| Head { at: from, variables, end: text.len() - rest.len() })
}

fn group(
    text: &Text,
    head: &Head,
    end: usize,
    open: &[bool],
    places: &Places,
    problems: &mut Problems,
) -> Option<Group> {
    let variables: Vec<Spanned<String>> = head
        .variables
        .iter()
        .map(|range| Spanned::new(text.text[range.clone()].to_owned(), text.place(range.clone())))
        .collect();
    let items = items(&text.text, head.end..end, open);
    let at = text.place(head.variables.first()?.start..head.end);
    if let [only] = items.as_slice()
        && only.is_empty()
    {
        problems.push(problem!("no-members", &at, "`{}` has no members", variables[0].value).help("write members after `in`, separated by commas, or the name of a place for all its members"));
        return None;
    }
    let mut rows = Vec::new();
    for item in &items {
        if item.is_empty() {
            let place = text.place(item.start.saturating_sub(1)..item.start);
            let problem = error("no-members", "a member is missing at this comma", &place);
            problems.push(problem.help("remove the comma or write the member"));
            return None;
        }
        rows.push(match variables.len() {
            1 => vec![word(text, item.clone(), true, problems)?],
            several => row(text, item.clone(), several, open, problems)?,
        });
    }
    if let ([_], [only]) = (variables.as_slice(), rows.as_slice())
        && let [word] = only.as_slice()
        && !text.text[items[0].clone()].starts_with('"')
    {
        rows = of_place(word, places, problems)?;
    }
    Some(Group { variables, rows })
}

/// The pieces between commas, without leading and trailing blanks.
fn items(text: &str, within: Range<usize>, open: &[bool]) -> Vec<Range<usize>> {
    let commas =
        text[within.clone()].bytes().enumerate().map(|(at, byte)| (within.start + at, byte));
    let mut ends: Vec<usize> =
        commas.filter(|(at, byte)| *byte == b',' && !open[*at]).map(|(at, _)| at).collect();
    ends.push(within.end);
    let mut start = within.start;
    let mut found = Vec::new();
    for end in ends {
        let item = &text[start..end];
        let from = start + first(item);
        found.push(from..from.max(start + item.trim_end().len()));
        start = end + 1;
    }
    found
}

/// The words of a member in parentheses: `(0.4 Hz to 2 Hz, low)`, one for each variable.
fn row(
    text: &Text,
    item: Range<usize>,
    count: usize,
    open: &[bool],
    problems: &mut Problems,
) -> Option<Vec<Word>> {
    let written = &text.text[item.clone()];
    let inside = item.start + 1..item.end.saturating_sub(1).max(item.start + 1);
    let whole = written.starts_with('(')
        && written.ends_with(')')
        && open[item.clone()].iter().take(written.len() - 1).all(|open| *open);
    let words = if whole {
        let nested: Vec<bool> = open_places(&text.text[inside.clone()]);
        let parts = items(&text.text[inside.clone()], 0..inside.len(), &nested);
        parts
            .into_iter()
            .map(|part| inside.start + part.start..inside.start + part.end)
            .filter(|part| !part.is_empty())
            .collect()
    } else {
        vec![item.clone()]
    };
    if !whole || words.len() != count {
        let here = match words.len() {
            1 => "is one word".to_owned(),
            several => format!("are {several} words"),
        };
        let help = "write words that belong together in parentheses: `(Y, kN), (az, m/s^2)`";
        problems.push(
            problem!(
                "member-count",
                &text.place(item),
                "{count} variables belong together, but here {here}"
            )
            .help(help),
        );
        return None;
    }
    words.into_iter().map(|part| word(text, part, false, problems)).collect()
}

/// A member as written, without its quotes. A single member (`alone`) with `and` outside quotes is
/// an error.
fn word(text: &Text, range: Range<usize>, alone: bool, problems: &mut Problems) -> Option<Word> {
    let written = &text.text[range.clone()];
    let place = text.place(range.clone());
    if let Some(inside) = written.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        let value = unescaped(inside);
        if value.trim().is_empty() {
            let problem = error("no-members", "the quotes are empty", &place);
            problems.push(problem.help("write the member inside the quotes"));
            return None;
        }
        return Some(Arc::new(Spanned::new(value, place)));
    }
    if let Some(at) = joined(written).filter(|_| alone) {
        let and = text.place(range.start + at..range.start + at + 3);
        let help = "separate members by commas; write a member that contains `and` in quotes";
        let problem = error("syntax", "`and` must be followed by a variable and `in`", &and);
        problems.push(problem.help(help));
        return None;
    }
    Some(Arc::new(Spanned::new(normalised(written), place)))
}

fn unescaped(quoted: &str) -> String {
    let mut value = String::new();
    let mut escaped = false;
    for c in quoted.chars() {
        if c == '\\' && !escaped {
            escaped = true;
        } else {
            value.push(c);
            escaped = false;
        }
    }
    value
}

/// The position of an `and` in a member, outside parentheses and quotes.
fn joined(written: &str) -> Option<usize> {
    let open = open_places(written);
    let is_and = |at: &usize| {
        written[*at..].strip_prefix("and").is_some_and(|rest| !rest.starts_with(is_word))
    };
    word_starts(written).filter(|at| !open[*at]).find(is_and)
}

/// The members of a place, if the word is the name of one.
fn of_place(word: &Word, places: &Places, problems: &mut Problems) -> Option<Vec<Vec<Word>>> {
    let name = word.value.replace(' ', "_");
    let known = || places.keys().map(String::as_str);
    if let Some(members) = place_called(&name, known()).and_then(|place| places.get(place)) {
        let put_in =
            |member: &String| vec![Arc::new(Spanned::new(member.clone(), word.span.clone()))];
        return Some(members.iter().map(put_in).collect());
    }
    // A word similar to the name of a place is probably a misspelling of it.
    if let Some(near) = nearest(&name, known()) {
        let help =
            format!("did you mean `{near}`? Write a single member that is not a place in quotes");
        problems.push(
            problem!("unknown-place", &**word, "no place is called `{}`", word.value).help(help),
        );
        return None;
    }
    Some(vec![vec![Arc::clone(word)]])
}
