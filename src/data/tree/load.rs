//! From parser events to the tree.
//!
//! The events are those of the parser below `serde-saphyr`: serde would hide quotes, aliases and every problem after the first.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use serde_saphyr::granit_parser::{self as yaml, ErrorKind, Event, Parser, ScalarStyle, ScanError};

use super::{Key, Node, Value, scalar};
use crate::data::faults::Faults;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span};

/// Aliases can make a small file a huge tree; no protocol or vehicle comes near this.
const NODES: usize = 100_000;
const DEPTH: usize = 64;

/// The one document of a YAML text; an empty text is [`Value::Null`].
///
/// Repeated keys, tags and endless numbers are problems too, the first of them told and the others counted; after a syntax error nothing more is read.
pub fn load(source: &Arc<Source>, problems: &mut Problems) -> Option<Node> {
    let events = Parser::new_from_str(&source.text);
    let mut loader = Loader { source, events, anchors: HashMap::new(), nodes: 0, depth: 0, faults: Faults::new(&source.name) };
    let root = loader.document();
    let mut faults = loader.faults;
    let root = root.map_err(|problem| faults.push(|| *problem)).ok().filter(|_| faults.is_empty());
    faults.add_to(problems);
    root
}

/// A comment of a YAML text.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// Without the `#` and one leading blank.
    pub text: String,
    /// With the `#`.
    pub span: Span,
    /// Whether something else stands before it on its line.
    pub beside: bool,
}

/// The comments of a text in their order, up to the first syntax error.
pub fn remarks(source: &Arc<Source>) -> Vec<Remark> {
    Parser::new_from_str(&source.text)
        .map_while(Result::ok)
        .filter_map(|(event, place)| {
            let Event::Comment(text, _) = event else { return None };
            let span = source.span(bytes(&place)?);
            let line = source.text[..span.start].rfind('\n').map_or(0, |at| at + 1);
            let beside = !source.text[line..span.start].trim_start_matches('\u{feff}').trim().is_empty();
            Some(Remark { text: text.strip_prefix(' ').unwrap_or(&text).trim_end().to_string(), span, beside })
        })
        .collect()
}

/// Boxed, as a problem is large beside the values that travel the same way.
type Fault = Box<Problem>;

struct Loader<'a> {
    source: &'a Arc<Source>,
    events: Parser<'a, yaml::StrInput<'a>>,
    /// Complete anchored values only, so that a value cannot hold itself. Each with its number of nodes.
    anchors: HashMap<usize, (Node, usize)>,
    nodes: usize,
    depth: usize,
    faults: Faults<'a>,
}

impl<'a> Loader<'a> {
    fn document(&mut self) -> Result<Node, Fault> {
        let mut root = None;
        while let Some((event, span)) = self.next()? {
            match event {
                Event::StreamStart | Event::DocumentEnd => {}
                Event::StreamEnd => break,
                Event::DocumentStart(..) if root.is_some() => {
                    return Err(Box::new(syntax("a second YAML document begins here", &span).help("one file holds one document")));
                }
                Event::DocumentStart(..) => {}
                event => root = Some(self.node(event, span)?),
            }
        }
        Ok(root.unwrap_or_else(|| Node { value: Value::Null, span: self.source.whole(), raw: String::new(), exact: false }))
    }

    /// The next event that is not a comment.
    fn next(&mut self) -> Result<Option<(Event<'a>, Span)>, Fault> {
        loop {
            match self.events.next_event() {
                None => return Ok(None),
                Some(Ok((Event::Comment(..), _))) => {}
                Some(Ok((event, place))) => return Ok(Some((event, self.source.span(bytes(&place).unwrap_or(0..0))))),
                Some(Err(error)) => return Err(Box::new(self.scan_error(&error))),
            }
        }
    }

    fn inside(&mut self) -> Result<(Event<'a>, Span), Fault> {
        self.next()?.ok_or_else(|| {
            Box::new(syntax("the text ends inside a value", &self.source.span(self.source.text.len()..self.source.text.len())))
        })
    }

    fn node(&mut self, event: Event<'a>, span: Span) -> Result<Node, Fault> {
        self.count(1, &span)?;
        let before = self.nodes;
        let (anchor, node) = match event {
            Event::Scalar(text, style, anchor, tag) => (anchor, self.scalar(text, style, tag.as_deref(), span)),
            Event::Alias(anchor) => {
                let Some((node, size)) = self.anchors.get(&anchor).cloned() else {
                    return Err(Box::new(syntax("this alias stands inside the value it refers to", &span)));
                };
                self.count(size, &span)?;
                return Ok(node);
            }
            Event::SequenceStart(_, anchor, tag) => {
                self.tag(tag.as_deref(), &span);
                (anchor, self.list(span)?)
            }
            Event::MappingStart(_, anchor, tag) => {
                self.tag(tag.as_deref(), &span);
                (anchor, self.map(span)?)
            }
            _ => return Err(Box::new(syntax("a value is missing here", &span))),
        };
        if anchor != 0 {
            self.anchors.insert(anchor, (node.clone(), self.nodes - before + 1));
        }
        Ok(node)
    }

    fn count(&mut self, nodes: usize, span: &Span) -> Result<(), Fault> {
        self.nodes += nodes;
        if self.nodes > NODES {
            return Err(Box::new(
                Problem::error("yaml-too-large", format!("with its aliases written out, the file has more than {NODES} values")).at(span),
            ));
        }
        Ok(())
    }

    fn deeper(&mut self, span: &Span) -> Result<(), Fault> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(Box::new(Problem::error("yaml-too-deep", format!("values are nested more than {DEPTH} deep")).at(span)));
        }
        Ok(())
    }

    fn list(&mut self, start: Span) -> Result<Node, Fault> {
        self.deeper(&start)?;
        let mut items: Vec<Node> = Vec::new();
        let end = loop {
            match self.inside()? {
                (Event::SequenceEnd, end) => break end,
                (event, span) => items.push(self.node(event, span)?),
            }
        };
        self.depth -= 1;
        let span = around(&start, items.last().map(|item| &item.span), &end);
        Ok(Node { value: Value::List(items), span, raw: String::new(), exact: false })
    }

    fn map(&mut self, start: Span) -> Result<Node, Fault> {
        self.deeper(&start)?;
        let mut entries: Vec<(Key, Node)> = Vec::new();
        // Only to find repeated keys; a map of 100 000 keys must not take their square.
        let mut places: HashMap<String, usize> = HashMap::new();
        let end = loop {
            let (event, span) = self.inside()?;
            let key = match event {
                Event::MappingEnd => break span,
                Event::Scalar(text, style, _, tag) => {
                    self.count(1, &span)?;
                    self.tag(tag.as_deref(), &span);
                    let (text, span, exact) = written(text, style, span);
                    Key { text, span, exact }
                }
                _ => return Err(Box::new(Problem::error("yaml-key", "a key must be a single word or text").at(&span))),
            };
            let (event, span) = self.inside()?;
            let value = self.node(event, span)?;
            if let Some(first) = places.get(&key.text).and_then(|at| entries.get(*at)) {
                self.faults.push(|| {
                    Problem::error("duplicate-key", format!("the key `{}` is given twice", key.text))
                        .at(&key.span)
                        .also(&first.0.span, "first given here")
                });
            } else {
                places.insert(key.text.clone(), entries.len());
                entries.push((key, value));
            }
        };
        self.depth -= 1;
        let span = around(&start, entries.last().map(|(_, value)| &value.span), &end);
        Ok(Node { value: Value::Map(entries), span, raw: String::new(), exact: false })
    }

    fn scalar(&mut self, text: Cow<'a, str>, style: ScalarStyle, tag: Option<&yaml::Tag>, span: Span) -> Node {
        let as_text = self.tag(tag, &span) || style != ScalarStyle::Plain;
        let (raw, span, exact) = written(text, style, span);
        let value = if as_text {
            Value::Text(raw.clone())
        } else {
            scalar::resolve(&raw).unwrap_or_else(|number| {
                let says = format!("`{raw}` is {}", if number.is_nan() { "no number" } else { "no finite number" });
                self.faults.push(|| Problem::error("not-finite", says).at(&span));
                Value::Null
            })
        };
        Node { value, span, raw, exact }
    }

    /// Whether the tag makes a scalar text. Any other tag asks for a type that is not known here.
    fn tag(&mut self, tag: Option<&yaml::Tag>, span: &Span) -> bool {
        let Some(tag) = tag else { return false };
        if tag.is_yaml_core_schema_tag("str") || tag.original() == "!" {
            return true;
        }
        let written = tag.original();
        let before = self.source.text.get(..span.start).and_then(|before| before.rfind(&written));
        let at = before.map_or_else(|| span.clone(), |at| self.source.span(at..at + written.len()));
        self.faults.push(|| Problem::error("yaml-tag", format!("the tag `{written}` has no meaning here")).at(&at));
        false
    }

    fn scan_error(&self, error: &ScanError) -> Problem {
        let text = &self.source.text;
        let marker = error.marker();
        let at = marker.byte_offset().unwrap_or_else(|| text.char_indices().nth(marker.index()).map_or(text.len(), |(at, _)| at));
        // A tab in the indentation shows up as many faults, some of them a line early.
        let (at, (says, help)) = match indenting_tab(text, at) {
            Some(tab) => (tab, in_words(&ErrorKind::TabInIndentation)),
            None => (at, in_words(error.kind())),
        };
        let problem = syntax(says, &self.source.span(at..at));
        match help {
            Some(help) => problem.help(help),
            None => problem,
        }
    }
}

/// The first tab in the indentation of the line at an offset or of the line after it.
fn indenting_tab(text: &str, at: usize) -> Option<usize> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |before| before + 1);
    let mut from = start;
    text[start..].split('\n').take(2).find_map(|line| {
        let indent = line.len() - line.trim_start_matches([' ', '\t']).len();
        let tab = line[..indent].find('\t').map(|tab| from + tab);
        from += line.len() + 1;
        tab
    })
}

fn syntax(says: impl Into<String>, span: &Span) -> Problem {
    Problem::error("yaml-syntax", says).at(span)
}

fn bytes(place: &yaml::Span) -> Option<Range<usize>> {
    place.byte_range()
}

/// From the start of a list or map to its bracket, or, where there is none, to the end of what it holds.
fn around(start: &Span, last: Option<&Span>, end: &Span) -> Span {
    // In block style the end event lies where the next token begins and covers nothing.
    let to = if end.end > end.start { end } else { last.unwrap_or(start) };
    // An alias lies where its anchor is, which may be before the list.
    if to.end < start.end { start.clone() } else { start.to(to) }
}

/// Text, place and exactness of a scalar: quotes are left out where the bytes between them are the text.
fn written(text: Cow<'_, str>, style: ScalarStyle, span: Span) -> (String, Span, bool) {
    let inner = match style {
        ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted => span.part(1..(span.end - span.start).saturating_sub(1)),
        _ => span.clone(),
    };
    let exact = inner.text() == text;
    (text.into_owned(), if exact { inner } else { span }, exact)
}

/// The fact and the remedy for the faults people make; the parser's own words for the rest.
fn in_words(kind: &ErrorKind) -> (String, Option<&'static str>) {
    let (says, help) = match kind {
        ErrorKind::TabNotAllowed | ErrorKind::TabInBlockIndentation | ErrorKind::TabInIndentation => {
            ("a tab stands in the indentation", Some("YAML is indented with blanks"))
        }
        ErrorKind::UnclosedQuotedScalar => ("a quote is opened and never closed", None),
        ErrorKind::InvalidQuotedScalarIndent => (
            "the quoted text begun above goes on in this line, which is not indented",
            Some("close the quote on the line where it is opened"),
        ),
        ErrorKind::InvalidTrailingSingleQuotedScalar | ErrorKind::InvalidTrailingDoubleQuotedScalar => {
            ("text follows a closing quote", Some("quote the whole value"))
        }
        ErrorKind::UnknownQuotedScalarEscape => {
            ("a `\\` in double quotes begins an escape, and there is none such", Some("use single quotes for text that holds `\\`"))
        }
        ErrorKind::MappingValueNotAllowed => {
            ("a `key: value` cannot begin here", Some("the keys of one map begin in the same column; quote a value that holds `: `"))
        }
        ErrorKind::ExpectedBlockMappingKey | ErrorKind::InvalidIndentation | ErrorKind::SimpleKeyExpected => {
            ("a line `key: value` is expected here", Some("the keys of one map begin in the same column, each followed by `: `"))
        }
        ErrorKind::ExpectedBlockSequenceEntry => {
            ("an item beginning with `- ` is expected here", Some("the items of one list begin in the same column"))
        }
        ErrorKind::UnknownAnchor => ("this alias refers to no anchor above it", Some("quote a text that begins with `*`")),
        ErrorKind::ExpectedFlowMappingSeparator => ("`,` or `}` is expected here", None),
        ErrorKind::ExpectedFlowSequenceSeparator => ("`,` or `]` is expected here", None),
        ErrorKind::UnexpectedEofFlowSequence | ErrorKind::UnexpectedEofFlowMapping | ErrorKind::UnexpectedEofImplicitFlowMapping => {
            ("the text ends inside brackets", None)
        }
        ErrorKind::UnexpectedCharacter { character: '@' | '`' | '%' } => {
            ("a value cannot begin with this character", Some("quote the value"))
        }
        ErrorKind::RecursionLimitExceeded => ("brackets or indentation are nested too deep", None),
        ErrorKind::UnclosedFlowCollection { open } => return (format!("`{open}` is opened and never closed"), None),
        other => return (format!("this is no valid YAML: {other}"), None),
    };
    (says.to_string(), help)
}
