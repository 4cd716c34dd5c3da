//! From parser events to the tree.
//!
//! The events are those of the parser of `serde-saphyr`: serde would hide quotes, aliases and all
//! problems after the first.

use std::{borrow::Cow, collections::HashMap, sync::Arc};

use serde_saphyr::granit_parser::{self as yaml, ErrorKind, Event, Parser, ScalarStyle, ScanError};

use super::{Key, Node, Value, scalar};
use crate::problem::{Problem, Problems, error, problem};
use crate::source::{Source, Span};

/// Limit of nodes: aliases can expand a small file to a very large tree. Real protocols and
/// vehicles are far below it.
const NODES: usize = 100_000;
const DEPTH: usize = 64;

/// The single document of a YAML text; an empty text is [`Value::Null`].
///
/// Repeated keys, tags and numbers that are not finite are also problems, and all are reported.
/// Reading stops at a syntax error.
pub fn load(source: &Arc<Source>, problems: &mut Problems) -> Option<Node> {
    let before = problems.errors();
    read(source, problems, false).filter(|_| problems.errors() == before)
}

/// As [`load`], but the tree is returned in spite of all problems except a syntax error, and
/// repeated keys are kept without a problem, for readers that interpret them.
pub fn load_as_written(source: &Arc<Source>, problems: &mut Problems) -> Option<Node> {
    read(source, problems, true)
}

fn read(source: &Arc<Source>, problems: &mut Problems, repeats: bool) -> Option<Node> {
    let mut loader = Loader {
        source,
        events: Parser::new_from_str(&source.text),
        anchors: HashMap::new(),
        nodes: 0,
        depth: 0,
        repeats,
        problems,
    };
    match loader.document() {
        Ok(node) => Some(node),
        Err(problem) => {
            problems.push(problem);
            None
        }
    }
}

/// A comment of a YAML text.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// Without the `#` and one leading space.
    pub text: String,
    /// Including the `#`.
    pub span: Span,
    /// Whether it follows other text on its line.
    pub beside: bool,
}

/// The comments of a text in order, up to the first syntax error.
pub fn remarks(source: &Arc<Source>) -> Vec<Remark> {
    Parser::new_from_str(&source.text)
        .map_while(Result::ok)
        .filter_map(|(event, place)| {
            let Event::Comment(text, _) = event else { return None };
            let span = source.span(place.byte_range()?);
            let line = source.text[..span.start].rfind('\n').map_or(0, |at| at + 1);
            let beside =
                !source.text[line..span.start].trim_start_matches('\u{feff}').trim().is_empty();
            Some(Remark {
                text: text.strip_prefix(' ').unwrap_or(&text).trim_end().to_string(),
                span,
                beside,
            })
        })
        .collect()
}

struct Loader<'a> {
    source: &'a Arc<Source>,
    events: Parser<'a, yaml::StrInput<'a>>,
    /// Complete anchored values with their number of nodes; an incomplete one is not included, so
    /// that a value cannot contain itself.
    anchors: HashMap<usize, (Node, usize)>,
    nodes: usize,
    depth: usize,
    /// Whether repeated keys are kept.
    repeats: bool,
    problems: &'a mut Problems,
}

impl<'a> Loader<'a> {
    fn document(&mut self) -> Result<Node, Problem> {
        let mut root = None;
        while let Some((event, span)) = self.next()? {
            match event {
                Event::StreamStart | Event::DocumentEnd => {}
                Event::StreamEnd => break,
                Event::DocumentStart(..) if root.is_some() => {
                    return Err(syntax("a second YAML document begins here", &span)
                        .help("a file must contain one document"));
                }
                Event::DocumentStart(..) => {}
                event => root = Some(self.node(event, span)?),
            }
        }
        Ok(root.unwrap_or_else(|| whole(Value::Null, self.source.whole())))
    }

    /// The next event that is not a comment.
    fn next(&mut self) -> Result<Option<(Event<'a>, Span)>, Problem> {
        while let Some(next) = self.events.next_event() {
            let (event, place) = next.map_err(|fault| self.scan_error(&fault))?;
            if !matches!(event, Event::Comment(..)) {
                return Ok(Some((event, self.source.span(place.byte_range().unwrap_or(0..0)))));
            }
        }
        Ok(None)
    }

    fn inside(&mut self) -> Result<(Event<'a>, Span), Problem> {
        self.next()?.ok_or_else(|| {
            let end = self.source.text.len();
            syntax("the text ends inside a value", &self.source.span(end..end))
        })
    }

    fn node(&mut self, event: Event<'a>, span: Span) -> Result<Node, Problem> {
        self.count(1, &span)?;
        let before = self.nodes;
        let (anchor, node) = match event {
            Event::Scalar(text, style, anchor, tag) => {
                (anchor, self.scalar(text, style, tag.as_deref(), span))
            }
            Event::Alias(anchor) => {
                let Some((node, size)) = self.anchors.get(&anchor).cloned() else {
                    return Err(syntax("this alias is inside the value it refers to", &span));
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
            _ => return Err(syntax("a value is missing here", &span)),
        };
        if anchor != 0 {
            self.anchors.insert(anchor, (node.clone(), self.nodes - before + 1));
        }
        Ok(node)
    }

    fn count(&mut self, nodes: usize, span: &Span) -> Result<(), Problem> {
        self.nodes += nodes;
        if self.nodes <= NODES {
            return Ok(());
        }
        Err(problem!(
            "yaml-too-large",
            span,
            "with its aliases written out, the file has more than {NODES} values"
        ))
    }

    fn deeper(&mut self, span: &Span) -> Result<(), Problem> {
        self.depth += 1;
        if self.depth <= DEPTH {
            return Ok(());
        }
        Err(problem!("yaml-too-deep", span, "values are nested more than {DEPTH} deep"))
    }

    fn list(&mut self, start: Span) -> Result<Node, Problem> {
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
        Ok(whole(Value::List(items), span))
    }

    fn map(&mut self, start: Span) -> Result<Node, Problem> {
        self.deeper(&start)?;
        let mut entries: Vec<(Key, Node)> = Vec::new();
        // For repeated keys only; keeps the time linear for large maps.
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
                _ => return Err(error("yaml-key", "a key must be a single word or text", &span)),
            };
            let (event, span) = self.inside()?;
            let value = self.node(event, span)?;
            let first = places.get(&key.text).filter(|_| !self.repeats);
            if let Some((first, _)) = first.and_then(|at| entries.get(*at)) {
                let problem =
                    problem!("duplicate-key", &key.span, "the key `{}` is given twice", key.text);
                self.problems.push(problem.also(&first.span, "first given here"));
            } else {
                places.insert(key.text.clone(), entries.len());
                entries.push((key, value));
            }
        };
        self.depth -= 1;
        let span = around(&start, entries.last().map(|(_, value)| &value.span), &end);
        Ok(whole(Value::Map(entries), span))
    }

    fn scalar(
        &mut self,
        text: Cow<'a, str>,
        style: ScalarStyle,
        tag: Option<&yaml::Tag>,
        span: Span,
    ) -> Node {
        let as_text = self.tag(tag, &span) || style != ScalarStyle::Plain;
        let (raw, span, exact) = written(text, style, span);
        let value = if as_text {
            Value::Text(raw.clone())
        } else {
            scalar::resolve(&raw).unwrap_or_else(|number| {
                let what = if number.is_nan() { "no number" } else { "no finite number" };
                self.problems.push(problem!("not-finite", &span, "`{raw}` is {what}"));
                Value::Null
            })
        };
        Node { value, span, raw, exact }
    }

    /// Whether the tag makes a scalar text. All other tags are unknown.
    fn tag(&mut self, tag: Option<&yaml::Tag>, span: &Span) -> bool {
        let Some(tag) = tag else { return false };
        let text = tag.is_yaml_core_schema_tag("str") || tag.original() == "!";
        if !text {
            self.problems.push(problem!(
                "yaml-tag",
                span,
                "the tag `{}` has no meaning here",
                tag.original()
            ));
        }
        text
    }

    fn scan_error(&self, fault: &ScanError) -> Problem {
        let (kind, marker, text) = (fault.kind(), fault.marker(), &self.source.text);
        let at = marker.byte_offset().unwrap_or_else(|| {
            text.char_indices().nth(marker.index()).map_or(text.len(), |(at, _)| at)
        });
        let tab = is_tab(kind);
        // The parser points to the value that contains the tab.
        let to_tab = text.get(at..).and_then(|rest| rest.find('\t')).filter(|_| tab);
        let at = at + to_tab.unwrap_or(0);
        let (says, help) = in_words(kind);
        let help = self
            .begins_deeper(kind, at)
            .or_else(|| self.begins_with_sign(at))
            .or_else(|| help.map(str::to_string));
        let code = match kind {
            _ if tab => "tab-indentation",
            ErrorKind::RecursionLimitExceeded => "yaml-too-deep",
            _ => "yaml-syntax",
        };
        error(code, says, &self.source.span(at..at)).help_if(help)
    }

    /// A value such as `|p0.15|`, which to YAML begins a text of several lines.
    fn begins_with_sign(&self, at: usize) -> Option<String> {
        let value = self.source.text.get(at..)?.lines().next()?.trim_end();
        let sign = value.chars().next().filter(|sign| matches!(sign, '|' | '>'))?;
        Some(format!("quote a value that begins with `{sign}`: `\"{value}\"`"))
    }

    /// `key: value` below a key that has its value already, and deeper: to the parser it goes on
    /// that value.
    fn begins_deeper(&self, kind: &ErrorKind, at: usize) -> Option<String> {
        let text = self.source.text.get(..at)?;
        let indent = |line: &str| line.len() - line.trim_start_matches(' ').len();
        let mut lines = text.rsplit('\n');
        let this = lines.next()?;
        let above =
            lines.find(|line| !line.trim().is_empty() && !line.trim_start().starts_with('#'))?;
        let value = above.split_once(": ").is_some_and(|(_, value)| !value.trim().is_empty());
        let (here, there) = (indent(this), indent(above));
        let meant = matches!(kind, ErrorKind::MappingValueNotAllowed) && value;
        (meant && !this.contains(": ") && here > there).then(|| {
            let (here, there) = (here + 1, there + 1);
            format!("this line begins in column {here}; the key above has its value, and begins in column {there}")
        })
    }
}

/// A value without a text of its own.
fn whole(value: Value, span: Span) -> Node {
    Node { value, span, raw: String::new(), exact: false }
}

fn syntax(says: impl Into<String>, span: &Span) -> Problem {
    error("yaml-syntax", says, span)
}

/// From the start of a list or map to its closing bracket, or to the end of its last element.
fn around(start: &Span, last: Option<&Span>, end: &Span) -> Span {
    // In block style the end event is at the next token and is empty.
    let to = if end.end > end.start { end } else { last.unwrap_or(start) };
    // An alias has the span of its anchor, which may be before the list.
    if to.end < start.end { start.clone() } else { start.to(to) }
}

/// Text, span and exactness of a scalar; quotes are excluded if the bytes between them are the
/// text.
fn written(text: Cow<'_, str>, style: ScalarStyle, span: Span) -> (String, Span, bool) {
    let inner = match style {
        ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted => {
            span.part(1..(span.end - span.start).saturating_sub(1))
        }
        _ => span.clone(),
    };
    let exact = inner.text() == text;
    (text.into_owned(), if exact { inner } else { span }, exact)
}

fn is_tab(kind: &ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::TabNotAllowed
            | ErrorKind::TabInBlockIndentation
            | ErrorKind::TabInIndentation
            | ErrorKind::TabInPlainScalar
            | ErrorKind::TabAtBlockScalarStart
    )
}

/// Message and help for frequent errors; the parser's own message for all others.
fn in_words(kind: &ErrorKind) -> (String, Option<&'static str>) {
    let (says, help) = match kind {
        kind if is_tab(kind) => ("the indentation contains a tab", Some("indent YAML with spaces")),
        ErrorKind::UnclosedQuotedScalar => ("this quote is not closed", None),
        ErrorKind::MappingValueNotAllowed => (
            "a second `:` where a value is expected",
            Some("quote a value that contains `: `, and write each key on its own line"),
        ),
        ErrorKind::ExpectedBlockMappingKey
        | ErrorKind::InvalidIndentation
        | ErrorKind::SimpleKeyExpected => (
            "a line `key: value` is expected here",
            Some("the keys of one map begin in the same column, each followed by `: `"),
        ),
        ErrorKind::ExpectedBlockSequenceEntry => (
            "an item beginning with `- ` is expected here",
            Some("the items of one list begin in the same column"),
        ),
        ErrorKind::UnknownAnchor => {
            ("this alias refers to no anchor above it", Some("quote a text that begins with `*`"))
        }
        ErrorKind::ExpectedFlowMappingSeparator => ("`,` or `}` is expected here", None),
        ErrorKind::ExpectedFlowSequenceSeparator => ("`,` or `]` is expected here", None),
        ErrorKind::UnexpectedEofFlowSequence
        | ErrorKind::UnexpectedEofFlowMapping
        | ErrorKind::UnexpectedEofImplicitFlowMapping => ("the text ends inside brackets", None),
        ErrorKind::UnexpectedCharacter { character: '@' | '`' | '%' } => {
            ("a value cannot begin with this character", Some("quote the value"))
        }
        ErrorKind::RecursionLimitExceeded => ("brackets or indentation are nested too deep", None),
        other => return (format!("this is not valid YAML: {other}"), None),
    };
    (says.to_string(), help)
}
