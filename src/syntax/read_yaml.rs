//! Reads the YAML form: the same blocks and fields as maps.

use std::sync::Arc;

use super::{
    document::{Block, Comments, Document, Field, Text},
    keys::{Key, Kind, Sort},
    layout::Quotes,
    nesting,
    remarks::Remarks,
    rules::{self, Form, Reader},
};
use crate::problem::{Problems, error, problem};
use crate::source::{Source, Span};
use crate::yaml::{self, Node, Value};

/// Reads the YAML form, with the same problems as [`super::read_text`] reports for the text form.
pub fn read_yaml(source: &Arc<Source>, problems: &mut Problems) -> Document {
    let earlier = problems.0.len();
    let mut document = Document::empty(source);
    if let Some(root) = yaml::load_as_written(source, problems) {
        let mut reader =
            YamlReader { remarks: Remarks::new(source), reader: Reader::new(Form::Yaml, problems) };
        document.leading = reader
            .remarks
            .leading(root.entries().first().map_or(root.span.start, |(key, _)| key.span.start));
        reader.read_root(&root);
        document.trailing = reader.remarks.rest();
        document.blocks = reader.reader.finish();
    }
    rules::in_reading_order(problems, earlier);
    document
}

struct YamlReader<'a> {
    remarks: Remarks,
    reader: Reader<'a>,
}

impl YamlReader<'_> {
    fn read_root(&mut self, root: &Node) {
        if root.value == Value::Null
            || !self.is_map(
                root,
                "a protocol must be a map with the keys `protocol`, `quantities` and so on",
            )
        {
            return;
        }
        let mut groups = root.entries().iter().peekable();
        while let Some((key, node)) = groups.next() {
            let end = groups.peek().map_or(usize::MAX, |(next, _)| next.span.start);
            self.remarks.pass(key.span.start);
            let margin = nesting::block_at_margin(&key.text, node)
                .filter(|_| rules::meant_kind(Form::Yaml, &key.text).is_none());
            if let Some(help) = margin {
                self.reader.problems.push(
                    problem!(
                        "unknown-block",
                        &key.span,
                        "`{}` is not a block of a protocol",
                        key.text
                    )
                    .help(help),
                );
                self.remarks.pass(end);
                continue;
            }
            let Some(kind) = self.reader.kind(&key.text, &key.span) else {
                self.remarks.pass(end);
                continue;
            };
            let word = Text {
                text: kind.word.to_owned(),
                span: key.span.clone(),
                exact: key.text == kind.word,
            };
            if kind.single {
                self.read_block(kind, word, None, node, end);
            } else {
                self.remarks.pass_beside(key.span.end);
                self.read_group(kind, &word, node, end);
            }
        }
    }

    /// Blocks of one kind, by name.
    fn read_group(&mut self, kind: &'static Kind, word: &Text, node: &Node, end: usize) {
        if node.value == Value::Null {
            self.wrong_shape(
                &word.span,
                format!("`{}` is empty", kind.group),
                "write blocks by their names below it, or remove the line",
            );
            return;
        }
        if !self.is_map(node, &format!("`{}` must be a map from names to fields", kind.group)) {
            return;
        }
        let mut blocks = node.entries().iter().peekable();
        while let Some((key, node)) = blocks.next() {
            let end = blocks.peek().map_or(end, |(next, _)| next.span.start);
            self.remarks.pass(key.span.start);
            if let Some(help) = nesting::too_deep(&key.text, node) {
                self.wrong_shape(
                    &key.span,
                    format!("`{}` is written among the names of `{}`", key.text, kind.group),
                    &help,
                );
                self.remarks.pass(end);
                continue;
            }
            let name = Text { text: key.text.clone(), span: key.span.clone(), exact: key.exact };
            self.read_block(kind, word.clone(), Some(name), node, end);
        }
    }

    fn read_block(
        &mut self,
        kind: &'static Kind,
        word: Text,
        name: Option<Text>,
        node: &Node,
        end: usize,
    ) {
        let head = name.as_ref().map_or(&word.span, |name| &name.span).clone();
        let comments = Comments {
            before: self.remarks.above(),
            beside: self.remarks.beside(head.end),
            ..Comments::default()
        };
        let nameless = name.as_ref().is_some_and(|name| name.text.trim().is_empty());
        let kind_place = if nameless { Text { span: head.clone(), ..word } } else { word };
        let mut block = Block {
            kind: kind_place,
            name: name.filter(|_| !nameless),
            title: None,
            fields: Vec::new(),
            comments,
        };
        let what = if kind.single {
            format!("`{}` is a map of fields", kind.group)
        } else {
            format!("a `{}` must be a map of fields", kind.word)
        };
        if node.value != Value::Null && !matches!(node.value, Value::Map(_)) {
            let help = block
                .name
                .as_ref()
                .and_then(|name| nesting::field_among_names(kind, &name.text))
                .unwrap_or_default();
            self.wrong_shape(&node.span, format!("{what}, not {}", node.kind_in_words()), &help);
            self.remarks.pass(end);
            return;
        }
        if node.value == Value::Null && kind.single {
            self.wrong_shape(
                &head,
                format!("`{}` is empty", kind.group),
                "write fields below it, or remove the line",
            );
        }
        for (key, node) in node.entries() {
            self.remarks.pass(key.span.start);
            let key = Text { text: key.text.clone(), span: key.span.clone(), exact: key.exact };
            match key.text.as_str() {
                "title" => self.plain(&key, node, &mut block.title, &mut block.comments),
                "name" if kind.single && kind.named => {
                    self.plain(&key, node, &mut block.name, &mut block.comments);
                }
                _ => self.read_field(kind, key, node, &mut block),
            }
        }
        block.comments.after = self.remarks.deeper(&head, end);
        self.reader.block(kind, block);
    }

    /// A text that is not a field: a name or title. Its comments belong to the block.
    fn plain(
        &mut self,
        key: &Text,
        node: &Node,
        found: &mut Option<Text>,
        comments: &mut Comments,
    ) {
        comments.before.extend(self.remarks.above());
        comments.put_beside(self.remarks.beside(node.span.end));
        if let Some(first) = found {
            self.reader.problems.push(
                problem!("duplicate-field", key, "a block can have only one `{}`", key.text)
                    .also(&*first, "the first"),
            );
        } else if node.is_scalar() {
            *found = Some(text(node));
        } else {
            let says = format!("the {} is {}", key.text, node.kind_in_words());
            self.wrong_shape(&node.span, says, "expected one text");
        }
    }

    fn read_field(&mut self, kind: &'static Kind, key: Text, node: &Node, block: &mut Block) {
        let words: Vec<&str> = key.text.split(' ').collect();
        let known = rules::key(kind, &words).filter(|(_, count)| *count == words.len());
        if known.is_none() {
            let beside = block.name.as_ref().map(|name| name.text.as_str());
            let nested = nesting::too_deep(&key.text, node)
                .or_else(|| nesting::block_among_fields(kind, &key.text, node, beside));
            if let Some(help) = nested {
                self.reader.problems.push(
                    problem!(
                        "unknown-field",
                        &key,
                        "a `{}` has no field `{}`",
                        kind.word,
                        key.text
                    )
                    .help(help),
                );
                return;
            }
        }
        let Some((known, _)) = known.or_else(|| self.reader.unknown_field(kind, &words, &key.span))
        else {
            return;
        };
        let key = Text {
            exact: key.exact && key.text == known.word,
            text: known.word.to_owned(),
            span: key.span,
        };
        let above = Comments {
            before: self.remarks.above(),
            beside: self.remarks.beside(key.span.end),
            ..Comments::default()
        };
        match &node.value {
            Value::List(items) if known.many && !items.is_empty() => {
                let mut above = Some(above);
                for item in items {
                    let mut comments = above.take().unwrap_or_default();
                    comments.put_beside(self.remarks.pass_to_item(item.span.start));
                    self.read_value(kind, known, &key, item, comments, block);
                }
            }
            Value::List(_) if known.many => self.reader.field(
                kind,
                known,
                block,
                Field { key, value: nothing(node), comments: above },
            ),
            _ => self.read_value(kind, known, &key, node, above, block),
        }
    }

    fn read_value(
        &mut self,
        kind: &'static Kind,
        known: &'static Key,
        key: &Text,
        node: &Node,
        above: Comments,
        block: &mut Block,
    ) {
        let list = listed(node).filter(|_| known.list);
        if !node.is_scalar() && list.is_none() {
            let help = match known.sort {
                Sort::Phrase => format!("for example: {}: {}", known.word, known.example),
                Sort::Text => "expected one text".to_owned(),
            };
            let help = nesting::field_below_field(kind, known.word, node).unwrap_or(help);
            let says = format!("`{}` is {}", known.word, node.kind_in_words());
            return self.wrong_shape(&node.span, says, &help);
        }
        let value = list.unwrap_or_else(|| text(node));
        if known.sort == Sort::Phrase {
            self.check_phrase(&value);
        }
        let mut comments = above;
        comments.before.extend(self.remarks.above());
        comments.put_beside(self.remarks.beside(node.span.end));
        self.reader.field(kind, known, block, Field { key: key.clone(), value, comments });
    }

    /// Checks that a phrase is also one in the text form: quotes are closed, and `#` outside them
    /// would begin a comment.
    fn check_phrase(&mut self, phrase: &Text) {
        if phrase.text.starts_with([':', '=']) {
            self.reader.problems.push(error(
                "unexpected-text",
                "a phrase cannot begin with this sign",
                &phrase.place(0..1),
            ));
        }
        let mut quotes = Quotes::default();
        let mut opened = 0;
        for (at, c) in phrase.text.char_indices() {
            let inside = quotes.inside;
            quotes.pass(c);
            if quotes.inside && !inside {
                opened = at;
            }
            if c == '#' && !inside {
                let (says, place) = ("`#` is not allowed outside quotes", phrase.place(at..at + 1));
                let help = "in the text form it begins a comment";
                self.reader.problems.push(error("unexpected-text", says, &place).help(help));
            }
        }
        if quotes.inside {
            self.reader
                .problems
                .push(rules::unterminated(&phrase.place(opened..phrase.text.len())));
        }
    }

    fn is_map(&mut self, node: &Node, expected: &str) -> bool {
        let is = matches!(node.value, Value::Map(_));
        if !is {
            self.wrong_shape(&node.span, format!("{expected}, not {}", node.kind_in_words()), "");
        }
        is
    }

    fn wrong_shape(&mut self, at: &Span, says: String, help: &str) {
        let mut problem = error("wrong-shape", says, at);
        problem.help = Some(help.to_owned()).filter(|help| !help.is_empty());
        self.reader.problems.push(problem);
    }
}

/// A scalar as written; empty for null.
fn text(node: &Node) -> Text {
    if node.value == Value::Null {
        nothing(node)
    } else {
        Text { text: node.raw.clone(), span: node.span.clone(), exact: node.exact }
    }
}

/// The items of a list as a phrase: `[right, left]` is `right, left`.
fn listed(node: &Node) -> Option<Text> {
    let items: Option<Vec<&str>> = node.items().iter().map(Node::scalar_text).collect();
    let text = items.filter(|items| !items.is_empty())?.join(", ");
    Some(Text { text, span: node.span.clone(), exact: false })
}

fn nothing(node: &Node) -> Text {
    Text { text: String::new(), span: node.span.clone(), exact: false }
}
