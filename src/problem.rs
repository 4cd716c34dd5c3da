//! Problems of an input: code, place, message, help; collected, and printed in one format.

use std::{
    collections::BTreeSet,
    sync::{Arc, Mutex},
};

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

use crate::source::{Located, Member, Span};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Severity {
    Error,
    Warning,
}

/// One problem in a protocol or a data file.
#[must_use]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Problem {
    pub severity: Severity,
    /// Stable code such as `unit-mismatch`, for tests and scripts.
    #[serde(deserialize_with = "code")]
    pub code: Code,
    /// The message.
    pub says: String,
    /// The span to underline.
    pub at: Option<Span>,
    /// Text next to the underline.
    pub label: Option<String>,
    /// Other spans involved, each with a text.
    pub also: Vec<(Span, String)>,
    /// The correction.
    pub help: Option<String>,
    /// The known word that the help proposes.
    pub near: Option<String>,
    /// For a family of blocks: the other members with the same problem, each with its message.
    pub members: Vec<(String, String)>,
}

/// A name for the type, since a plain `&str` would be taken for a part of the text that is read.
type Code = &'static str;

/// A code that was read. There are few different ones; each is kept once, for as long as the
/// program runs.
fn code<'de, D: Deserializer<'de>>(from: D) -> Result<Code, D::Error> {
    static KNOWN: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let text = String::deserialize(from)?;
    let Ok(mut known) = KNOWN.lock() else {
        return Err(D::Error::custom("the codes are not accessible"));
    };
    if let Some(code) = known.get(text.as_str()) {
        return Ok(code);
    }
    if text.len() > LONGEST_CODE || known.len() >= MOST_CODES {
        return Err(D::Error::custom(format!("`{text}` is no code of a problem")));
    }
    let code: &'static str = Box::leak(text.into_boxed_str());
    known.insert(code);
    Ok(code)
}

/// Bounds of the codes that are read from a file, in characters and in number; the program itself
/// has some hundred of at most 30.
const LONGEST_CODE: usize = 64;
const MOST_CODES: usize = 4096;

/// A list of members longer than this is cut off.
const MOST_LISTED: usize = 8;

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self(vec![problem])
    }
}

impl Problem {
    pub fn error(code: &'static str, says: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            says: says.into(),
            at: None,
            label: None,
            also: Vec::new(),
            help: None,
            near: None,
            members: Vec::new(),
        }
    }

    pub fn warning(code: &'static str, says: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, says) }
    }

    pub fn at(mut self, place: &impl Located) -> Self {
        self.at = Some(place.place());
        self
    }

    /// At a place, if it has none yet: a problem of a file as a whole is shown where it is named.
    pub fn or_at(self, place: &impl Located) -> Self {
        if self.at.is_some() { self } else { self.at(place) }
    }

    pub fn label(mut self, text: impl Into<String>) -> Self {
        self.label = Some(text.into());
        self
    }

    pub fn also(mut self, place: &impl Located, text: impl Into<String>) -> Self {
        self.also.push((place.place(), text.into()));
        self
    }

    /// Adds a further place if there is one.
    pub fn also_if(self, place: Option<impl Located>, text: impl Into<String>) -> Self {
        match place {
            Some(place) => self.also(&place, text),
            None => self,
        }
    }

    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Adds help if there is some.
    pub fn help_if(self, help: Option<impl Into<String>>) -> Self {
        match help {
            Some(help) => self.help(help),
            None => self,
        }
    }

    /// Adds the help "did you mean ...?" with a known word.
    pub fn meant(mut self, near: &str) -> Self {
        self.help = Some(format!("did you mean `{near}`?"));
        self.near = Some(near.to_owned());
        self
    }

    /// Adds the help "did you mean ...?" if a candidate is similar, else the list of candidates if
    /// it is short.
    pub fn suggest(
        mut self,
        word: &str,
        candidates: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Self {
        let all: Vec<_> = candidates.into_iter().collect();
        let all: Vec<&str> = all.iter().map(AsRef::as_ref).collect();
        if let Some(near) = nearest(word, all.iter().copied()) {
            return self.meant(near);
        } else if !all.is_empty() && all.len() <= 16 {
            self.help = Some(format!("known here: {}", all.join(", ")));
        }
        self
    }

    /// The message with its source lines underlined, ending in a line break.
    pub fn render(&self, color: bool) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let mut group = level
            .primary_title(plain(&self.says))
            .id(self.code)
            .elements(Vec::<Snippet<'_, annotate_snippets::Annotation<'_>>>::new());
        let put_in = self.at.as_ref().and_then(|at| at.filled.as_ref()?.put_in());
        let put_in = put_in.map(|word| (word.span.clone(), format!("the member `{}`", word.value)));
        let name = |span: &Span| plain(&span.source.name);
        if let Some(at) = &self.at {
            let mut same = Snippet::source(at.source.text.as_str())
                .path(name(at))
                .line_start(at.source.first_line)
                .annotation(
                    AnnotationKind::Primary
                        .span(range(at))
                        .label(self.label.clone().map(|text| plain(&text))),
                );
            let mut others: Vec<Snippet<'_, _>> = Vec::new();
            for (span, text) in self.also.iter().chain(&put_in) {
                let annotation = AnnotationKind::Context.span(range(span)).label(plain(text));
                if span.source == at.source {
                    same = same.annotation(annotation);
                } else {
                    others.push(
                        Snippet::source(span.source.text.as_str())
                            .path(name(span))
                            .line_start(span.source.first_line)
                            .annotation(annotation),
                    );
                }
            }
            group = group.element(same);
            for other in others {
                group = group.element(other);
            }
        }
        if let Some(members) = self.in_members() {
            group = group.element(Level::NOTE.message(plain(&members)));
        }
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(plain(help)));
        }
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let mut text = renderer.render(&[group]).to_string();
        text.push('\n');
        // The renderer replaces ASCII control characters only; a terminal interprets U+009B as the
        // start of a command.
        text.replace(|c: char| matches!(c, '\u{80}'..='\u{9f}'), "\u{fffd}")
    }
}

impl Problem {
    fn member(&self) -> Option<&Arc<Member>> {
        Some(&self.at.as_ref()?.filled.as_ref()?.member)
    }

    /// `in `Y_phase` and `Q_phase` of the family `{channel}_{part}``
    fn in_members(&self) -> Option<String> {
        let member = self.member()?;
        let names: Vec<String> = std::iter::once(&member.name)
            .chain(self.members.iter().map(|(name, _)| name))
            .map(|name| format!("`{name}`"))
            .collect();
        let listed = match names.split_last() {
            Some((last, first)) if !first.is_empty() && names.len() <= MOST_LISTED => {
                format!("{} and {last}", first.join(", "))
            }
            _ if names.len() > MOST_LISTED => format!(
                "{} and {} more",
                names[..MOST_LISTED].join(", "),
                names.len() - MOST_LISTED
            ),
            _ => names.concat(),
        };
        Some(format!("in {listed} of the family `{}`", member.family))
    }

    /// Adds the same problem of another member of the family; returns the other problem if it is a
    /// different one.
    fn takes_in(&mut self, other: Problem) -> Option<Problem> {
        let (Some(own), Some(its), Some(at), Some(there)) =
            (self.member(), other.member(), &self.at, &other.at)
        else {
            return Some(other);
        };
        if self.code != other.code
            || own.family != its.family
            || (at.start, at.end) != (there.start, there.end)
            || at.source != there.source
        {
            return Some(other);
        }
        let known = |problem: &Problem, name: &str| {
            problem.members.iter().find(|(known, _)| known == name).map(|(_, says)| says.clone())
        };
        let said =
            if own.name == its.name { Some(self.says.clone()) } else { known(self, &its.name) };
        if let Some(said) = said {
            return if said == other.says { None } else { Some(other) };
        }
        let put_in = |span: &Span| span.filled.as_ref().and_then(|filled| filled.put_in().cloned());
        let same_word = put_in(at) == put_in(there);
        let without_name = |says: &str, member: &Member| says.replace(&member.name, &member.family);
        if !same_word && without_name(&self.says, own) != without_name(&other.says, its) {
            return Some(other);
        }
        self.members.push((its.name.clone(), other.says));
        // What differs between members is not part of the problem.
        if let Some(filled) =
            self.at.as_mut().filter(|_| !same_word).and_then(|at| at.filled.as_mut())
        {
            Arc::make_mut(filled).pieces.clear();
        }
        None
    }
}

/// Byte range inside the text on character boundaries; not empty where a character can be
/// underlined.
fn range(span: &Span) -> std::ops::Range<usize> {
    let text = &span.source.text;
    let start = text.floor_char_boundary(span.start);
    let mut end = span.end.clamp(start, text.len());
    if end == start {
        let next = text[start..].chars().next().filter(|c| *c != '\n');
        end += next.map_or(0, char::len_utf8);
    }
    start..text.ceil_char_boundary(end)
}

/// One line of text without characters that act on a terminal: ends of lines and tabs are spaces,
/// so that no name of a user can begin a line; other characters that act are replaced.
pub fn plain(text: &str) -> String {
    let shown = |c| match c {
        '\n' | '\r' | '\t' | '\u{2028}' | '\u{2029}' => ' ',
        c if acts(c) => '\u{fffd}',
        c => c,
    };
    text.chars().map(shown).collect()
}

/// Whether a terminal interprets a character, or whether it changes the order of the text: the
/// controls of bidirectional text (Unicode Standard Annex #9, Table 4).
pub fn acts(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A reader that ends at its first problem, in one that collects them.
impl From<Problem> for Vec<Problem> {
    fn from(problem: Problem) -> Self {
        vec![problem]
    }
}

/// An error with its code and message, at a place.
pub fn error(code: &'static str, says: impl Into<String>, at: &impl Located) -> Problem {
    Problem::error(code, says).at(at)
}

/// An error with its code, where there is one its place, and its message as `format!` has it:
/// `problem!("unknown-run", &cell.span, "the campaign has no run `{name}`")`.
macro_rules! problem {
    ($code:expr, $says:literal $($with:tt)*) => {
        $crate::problem::Problem::error($code, format!($says $($with)*))
    };
    ($code:expr, $at:expr, $says:literal $($with:tt)*) => {
        $crate::problem::error($code, format!($says $($with)*), $at)
    };
}
pub(crate) use problem;

/// A warning with its code and message, at a place.
pub fn warning(code: &'static str, says: impl Into<String>, at: &impl Located) -> Problem {
    Problem::warning(code, says).at(at)
}

/// The problems of one stage or input, in the order found.
#[derive(Clone, Debug, Default)]
pub struct Problems(pub Vec<Problem>);

impl Problems {
    /// Adds problems, each as [`Problems::push`] does.
    pub fn add(&mut self, problems: impl IntoIterator<Item = Problem>) {
        problems.into_iter().for_each(|problem| self.push(problem));
    }

    pub fn push(&mut self, problem: Problem) {
        // The same problem at the same place is reported once, also for several members of a
        // family.
        if self.0.contains(&problem) {
            return;
        }
        let mut left = Some(problem);
        for known in &mut self.0 {
            left = left.and_then(|problem| known.takes_in(problem));
        }
        self.0.extend(left);
    }

    /// The value of a result; if there is none, its problems are added.
    pub fn value<T>(&mut self, found: Result<T, impl Into<Vec<Problem>>>) -> Option<T> {
        found.map_err(|problems| self.add(problems.into())).ok()
    }

    pub fn any_error(&self) -> bool {
        self.errors() > 0
    }

    pub fn errors(&self) -> usize {
        self.0.iter().filter(|problem| problem.severity == Severity::Error).count()
    }

    pub fn render(&self, color: bool) -> String {
        self.0.iter().map(|problem| problem.render(color) + "\n").collect()
    }
}

/// All of them, or nothing if one is missing; each is looked at, so that all problems are told.
pub fn all<T>(found: impl IntoIterator<Item = Option<T>>) -> Option<Vec<T>> {
    found.into_iter().collect::<Vec<_>>().into_iter().collect()
}

/// The most similar candidate of a word: the only one that begins with it, or one with a small edit
/// distance.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// A shorter prefix is ambiguous: `max` suggests `maximum`, but `Y` nothing.
    const SHORTEST_BEGINNING: usize = 3;
    let lower = word.to_lowercase();
    let candidates: Vec<&str> =
        candidates.into_iter().filter(|candidate| *candidate != word).collect();
    let slips = candidates.iter().filter_map(|candidate| {
        let other = candidate.to_lowercase();
        let longer = word.chars().count().max(candidate.chars().count());
        let distance = strsim::damerau_levenshtein(&lower, &other);
        // A completely different word is not suggested: zone 7 is not a misspelling of zone 1. One
        // letter in three may differ.
        let near = distance <= longer.max(SHORTEST_BEGINNING) / 3
            && distance < longer
            && same_symbol(&lower, &other);
        let alike = lower.chars().zip(other.chars()).take_while(|(a, b)| a == b).count();
        near.then_some((distance, std::cmp::Reverse(alike), *candidate))
    });
    let slip = slips.min_by_key(|(distance, alike, _)| (*distance, *alike));
    if let Some((1, _, slip)) = slip {
        return Some(slip);
    }
    let mut begun = candidates.iter().filter(|candidate| {
        let rest = candidate.to_lowercase().strip_prefix(&lower).map(str::to_string);
        lower.chars().count() >= SHORTEST_BEGINNING
            && rest.is_some_and(|rest| rest.starts_with(char::is_alphabetic))
    });
    match (begun.next(), begun.next()) {
        (Some(only), None) => Some(only),
        _ => slip.map(|(.., slip)| slip),
    }
}

/// Whether two names can have the same symbol, the part before the first `_`. `Q_1R` is another
/// force than `Y_1R`, and `az_max` another acceleration than `ay_max`. A longer symbol may contain
/// a misspelling.
fn same_symbol(a: &str, b: &str) -> bool {
    match (a.split_once('_'), b.split_once('_')) {
        (Some((a, _)), Some((b, _))) => {
            strsim::damerau_levenshtein(a, b) <= a.chars().count().max(b.chars().count()) / 3
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    #[test]
    fn nearest_finds_a_slip_and_refuses_a_stranger() {
        assert_eq!(nearest("SigmaY_mx", ["Y_max", "SigmaY_max"]), Some("SigmaY_max"));
        assert_eq!(nearest("friction", ["Y_max", "SigmaY_max"]), None);
        assert_eq!(nearest("7", ["1", "2"]), None);
        assert_eq!(nearest("max", ["mean", "median", "maximum"]), Some("maximum"));
        assert_eq!(nearest("Y_1R", ["Q_1R", "Y_2R", "Y_1L"]), Some("Y_1L"));
        assert_eq!(nearest("Y_1R", ["Q_1R", "YQ_1R"]), None);
        assert_eq!(nearest("ay_max", ["az_max"]), None);
        assert_eq!(nearest("y_1r", ["Q_1R", "Y_1R"]), Some("Y_1R"));
        assert_eq!(nearest("min", ["minimum", "minimum pairs"]), None);
    }

    #[test]
    fn both_places_are_underlined() {
        let source = Source::new("p.fp", "of Y\nlimit std 2 m/s^2\n");
        let text =
            Problem::error("unit-mismatch", "the values are forces, the limit is an acceleration")
                .at(&source.span(15..22))
                .also(&source.span(3..4), "kN")
                .help("write the limit in kN")
                .render(false);
        assert!(text.contains("p.fp:2:11"), "{text}");
        assert!(
            text.contains("1 | of Y") && text.contains("help: write the limit in kN"),
            "{text}"
        );
    }
}
