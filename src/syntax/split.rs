//! Splits the text form into blocks and fields by indentation, with their comments.

use std::{mem::take, ops::Range, sync::Arc};

use super::{
    document::Comments,
    keys::{self, Kind},
    lines,
    rules::{self, Form},
};
use crate::problem::{Problems, error};
use crate::source::Source;

/// A header or a field with its continuation lines.
#[derive(Debug)]
pub struct Item {
    /// From the first to the last character in the source.
    pub range: Range<usize>,
    pub comments: Comments,
    /// Whether a quote in it is not closed; this has been reported.
    pub unclosed: bool,
    /// Ranges between its lines, which may contain comments.
    holes: Vec<Range<usize>>,
    /// Comments beside its further lines, each with where its line ends.
    rows: Vec<(usize, String)>,
}

#[derive(Debug)]
pub struct RawBlock {
    pub header: Item,
    pub fields: Vec<Item>,
    /// Comments below the last field.
    pub after: Vec<String>,
    kind: Option<&'static Kind>,
    /// Indentation of its fields, known from the first field on.
    column: Option<usize>,
}

/// A source split into its parts.
#[derive(Debug)]
pub struct Parts {
    /// Comments at the top, separated by a blank line.
    pub leading: Vec<String>,
    pub blocks: Vec<RawBlock>,
    /// Comments after the last block.
    pub trailing: Vec<String>,
}

pub fn split(source: &Arc<Source>, problems: &mut Problems) -> Parts {
    let mut splitter = Splitter {
        source,
        problems,
        leading: Vec::new(),
        blocks: Vec::new(),
        comments: Vec::new(),
        tabs: Vec::new(),
    };
    let mut start = if source.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    for text in source.text[start..].split_inclusive('\n') {
        splitter.line(start, text.trim_end_matches(['\n', '\r']));
        start += text.len();
    }
    splitter.finish()
}

/// A line without its indentation.
struct Rest {
    body: Range<usize>,
    beside: Option<String>,
    unclosed: bool,
}

struct Splitter<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Problems,
    leading: Vec<String>,
    blocks: Vec<RawBlock>,
    /// Comment lines that belong to the next item, each with its indentation.
    comments: Vec<(usize, String)>,
    /// Indentations that contain a tab.
    tabs: Vec<Range<usize>>,
}

impl Splitter<'_> {
    fn line(&mut self, offset: usize, text: &str) {
        let line = lines::line(text);
        let indent = width(&text[line.indent.clone()]);
        if line.body.is_empty() {
            match line.comment {
                Some(comment) => self.comments.push((indent, comment)),
                None if self.blocks.is_empty() => {
                    let above = self.waiting();
                    self.leading.extend(above);
                }
                None => {}
            }
            return;
        }
        let body = offset + line.body.start..offset + line.body.end;
        if text[line.indent.clone()].contains('\t') {
            self.tabs.push(offset..offset + line.indent.end);
        }
        if let Some(at) = line.unclosed {
            self.problems.push(rules::unterminated(&self.source.span(offset + at..body.end)));
        }
        let rest = Rest { body, beside: line.comment, unclosed: line.unclosed.is_some() };
        let word = text[line.body].split([' ', '\t', '"']).next().unwrap_or("");
        let word_at = rest.body.start..rest.body.start + word.len();
        let kind = keys::kind(word);
        let above = self.blocks.last().and_then(|block| block.column);
        if indent == 0
            && kind.is_none()
            && self.blocks.last().is_some_and(|block| block.may_hold(word))
        {
            self.problem(
                "indentation",
                &format!("`{word}` is a field but is not indented"),
                word_at,
                "indent the fields of a block by two blanks",
            );
            self.add(above.unwrap_or(2), rest);
        } else if indent == 0 {
            self.begin(rules::meant_kind(Form::Lines, word), rest);
        } else if above.is_some_and(|column| indent > column) {
            self.carry_on(rest);
        } else if kind.is_some()
            && self.blocks.last().is_none_or(|block| block.kind.is_some() && !block.may_hold(word))
        {
            self.problem(
                "indentation",
                &format!("`{word}` begins a block and is indented"),
                word_at,
                "write blocks from the first column on",
            );
            self.begin(kind, rest);
        } else {
            if let Some(column) = above.filter(|column| *column != indent) {
                let help = format!(
                    "align the fields of a block; here they begin in column {}",
                    column + 1
                );
                self.problem(
                    "indentation",
                    "the field is not aligned with those above",
                    word_at,
                    &help,
                );
            }
            self.add(indent, rest);
        }
    }

    fn begin(&mut self, kind: Option<&'static Kind>, line: Rest) {
        self.close();
        let header = Item::new(line, self.waiting());
        self.blocks.push(RawBlock {
            header,
            fields: Vec::new(),
            after: Vec::new(),
            kind,
            column: None,
        });
    }

    fn add(&mut self, indent: usize, line: Rest) {
        let before = self.waiting();
        match self.blocks.last_mut() {
            Some(block) => {
                block.column = Some(indent);
                block.fields.push(Item::new(line, before));
            }
            None => self.problem(
                "field-outside-block",
                "there is a field before the first block",
                line.body,
                "write blocks from the first column on, the first one with `protocol`",
            ),
        }
    }

    /// Adds a continuation line to the last field.
    fn carry_on(&mut self, line: Rest) {
        let before = self.waiting();
        let Some(field) = self.blocks.last_mut().and_then(|block| block.fields.last_mut()) else {
            return;
        };
        field.holes.push(field.range.end..line.body.start);
        field.range.end = line.body.end;
        field.unclosed |= line.unclosed;
        field.comments.before.extend(before);
        field.rows.extend(line.beside.map(|comment| (field.range.end, comment)));
    }

    /// Indented comments at the end of a block belong to it and not to the next block.
    fn close(&mut self) {
        if let Some(block) = self.blocks.last_mut() {
            let inside = self.comments.iter().take_while(|(indent, _)| *indent > 0).count();
            block.after = self.comments.drain(..inside).map(|(_, text)| text).collect();
        }
    }

    fn waiting(&mut self) -> Vec<String> {
        take(&mut self.comments).into_iter().map(|(_, text)| text).collect()
    }

    fn problem(&mut self, code: &'static str, says: &str, at: Range<usize>, help: &str) {
        self.problems.push(error(code, says, &self.source.span(at)).help(help));
    }

    fn finish(mut self) -> Parts {
        if let [first, others @ ..] = take(&mut self.tabs).as_slice() {
            let says = match others.len() {
                0 => "a line is indented with a tab".to_owned(),
                more => format!("lines are indented with tabs, this one and {more} more"),
            };
            self.problem(
                "tab-indentation",
                &says,
                first.clone(),
                "indent fields by two blanks, and continuation lines by more",
            );
        }
        self.close();
        let trailing = self.waiting();
        Parts { leading: self.leading, blocks: self.blocks, trailing }
    }
}

impl RawBlock {
    /// Whether a field of the block can begin with this word.
    fn may_hold(&self, word: &str) -> bool {
        let holds =
            |kind: &Kind| kind.keys.iter().any(|key| key.word.split(' ').next() == Some(word));
        self.kind
            .is_some_and(|kind| [true, false].into_iter().any(|named| holds(kind.with_name(named))))
    }
}

impl Item {
    fn new(line: Rest, before: Vec<String>) -> Self {
        let comments = Comments { before, beside: line.beside, ..Comments::default() };
        let (holes, rows) = (Vec::new(), Vec::new());
        Self { range: line.body, comments, unclosed: line.unclosed, holes, rows }
    }

    /// The comments with those of further lines: of cases, each at its case; of others, one next to
    /// the field and the rest above it. `case` is the case at a place in the source.
    pub fn comments(&self, case: impl Fn(usize) -> Option<usize>) -> Comments {
        let mut all = self.comments.clone();
        for (end, comment) in &self.rows {
            match case(*end) {
                Some(case) if case > 0 && all.rows.iter().all(|(row, _)| *row != case) => {
                    all.rows.push((case, comment.clone()))
                }
                _ if all.beside.is_none() => all.beside = Some(comment.clone()),
                _ => all.before.push(comment.clone()),
            }
        }
        all
    }

    /// The text with comments replaced by blanks, so that every byte keeps its place in the source.
    pub fn text(&self, source: &Source) -> String {
        let mut text = source.text[self.range.clone()].to_owned();
        for hole in &self.holes {
            let hole = hole.start - self.range.start..hole.end - self.range.start;
            let blank: String = text[hole.clone()]
                .bytes()
                .map(|byte| if byte == b'\n' { '\n' } else { ' ' })
                .collect();
            text.replace_range(hole, &blank);
        }
        text
    }
}

/// Columns of an indentation. A tab, which is an error, counts up to the next multiple of four.
fn width(indent: &str) -> usize {
    indent.chars().fold(0, |width, c| if c == '\t' { width / 4 * 4 + 4 } else { width + 1 })
}
