//! A YAML text as a tree in which every key and value has its place and its original text.
//!
//! One YAML 1.2 document, core schema: only `true` and `false` are booleans; `no` and `1.2.3` are
//! text.

mod fields;
mod load;
mod scalar;

pub(crate) use fields::fields;
pub use fields::{
    Entries, FromNode, Hertz, Literal, Metres, OneOrMore, OtherKeys, Quantity, Ratio, Reader,
    Seconds, Words, quoted, span_of_value, unknown_unit,
};
pub use load::{Remark, load, load_as_written, remarks};

use std::ops::Range;

use crate::source::Span;

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub value: Value,
    /// Span of the value without anchor, tag and, if [`Node::exact`], without quotes. For an alias,
    /// the span of the anchored value.
    pub span: Span,
    /// A scalar as text, whatever its type: `1.50`, `no`, `5 kN`; with escapes resolved and folded
    /// lines joined. Empty for lists and maps.
    pub raw: String,
    /// Whether byte `n` of `raw` is at byte `n` of `span`.
    pub exact: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Null,
    Bool(bool),
    /// Always finite: `.inf`, `.nan` and `1e999` are refused when loading.
    Number(f64),
    Text(String),
    List(Vec<Node>),
    /// In the order written; keys are unique unless loaded as written.
    Map(Vec<(Key, Node)>),
}

/// A key of a map, always text.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub text: String,
    /// Without quotes if [`Key::exact`].
    pub span: Span,
    /// Whether byte `n` of `text` is at byte `n` of `span`.
    pub exact: bool,
}

impl Node {
    /// The entries of a map; empty for any other value.
    pub fn entries(&self) -> &[(Key, Node)] {
        if let Value::Map(entries) = &self.value { entries } else { &[] }
    }

    /// The items of a list; empty for any other value.
    pub fn items(&self) -> &[Node] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }

    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|(_, node)| node)
    }

    pub fn entry(&self, key: &str) -> Option<&(Key, Node)> {
        self.entries().iter().find(|(known, _)| known.text == key)
    }

    /// The place of the value of a key; of one that is not there, that of the map.
    pub fn span_of(&self, key: &str) -> &Span {
        self.get(key).map_or(&self.span, |node| &node.span)
    }

    /// The place where the value begins.
    pub fn start(&self) -> Span {
        self.span.part(0..0)
    }

    /// The place of the value of a key; of one that is not there, the beginning of the map.
    pub fn span_or_start(&self, key: &str) -> Span {
        self.get(key).map_or_else(|| self.start(), |node| node.span.clone())
    }

    /// Looks up `a.b.c` in nested maps. A key that contains a dot is found by its full text first.
    pub fn lookup(&self, path: &str) -> Option<&Node> {
        if let Some(node) = self.get(path) {
            return Some(node);
        }
        path.match_indices('.').find_map(|(at, _)| self.get(&path[..at])?.lookup(&path[at + 1..]))
    }

    pub fn is_scalar(&self) -> bool {
        !matches!(self.value, Value::List(_) | Value::Map(_))
    }

    pub fn number(&self) -> Option<f64> {
        if let Value::Number(number) = self.value { Some(number) } else { None }
    }

    /// The text of a scalar other than null, as written.
    pub fn scalar_text(&self) -> Option<&str> {
        (self.is_scalar() && self.value != Value::Null).then_some(self.raw.as_str())
    }

    /// The span of a part of [`Node::raw`], as precise as possible.
    pub fn place(&self, range: Range<usize>) -> Span {
        if self.exact { self.span.part(range) } else { self.span.clone() }
    }

    /// "a list", "a number": for messages.
    pub fn kind_in_words(&self) -> &'static str {
        match self.value {
            Value::Null => "nothing",
            Value::Bool(_) => "a truth value",
            Value::Number(_) => "a number",
            Value::Text(_) => "text",
            Value::List(_) => "a list",
            Value::Map(_) => "a map",
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::problem::{Problem, Problems};
    use crate::source::{Source, Spanned};

    fn read(text: &str) -> Node {
        let mut problems = Problems::default();
        let node = load(&Source::new("t.yaml", text), &mut problems);
        node.unwrap_or_else(|| panic!("{}", problems.render(false)))
    }

    /// Code and `line:column` of each problem.
    fn faults(text: &str) -> Vec<(&'static str, String)> {
        let mut problems = Problems::default();
        assert!(load(&Source::new("t", text), &mut problems).is_none(), "{text}");
        problems
            .0
            .iter()
            .map(|problem| {
                (
                    problem.code,
                    problem.at.as_ref().map_or(String::new(), |at| at.to_string()[2..].to_string()),
                )
            })
            .collect()
    }

    #[test]
    fn every_scalar_keeps_its_words_and_its_place() {
        let text = "\u{feff}# head\r\nname: Köln 7  # end\r\n\"a key\": 1.50\r\nflag: no\r\nlist: [ 'it', \"x\\ty\", ~, true ]\r\nsub:\r\n  - 0x10\r\n  - k: two\r\n      lines\r\n";
        let root = read(text);
        let raw = |path: &str| {
            root.lookup(path).map(|node| (node.raw.as_str(), node.exact, node.span.text()))
        };
        assert_eq!(raw("name"), Some(("Köln 7", true, "Köln 7")));
        assert_eq!(raw("a key"), Some(("1.50", true, "1.50")));
        assert_eq!(raw("flag"), Some(("no", true, "no")));
        assert_eq!(root.get("flag").map(|node| &node.value), Some(&Value::Text("no".into())));
        assert_eq!(root.entries()[1].0.span.text(), "a key");
        let list = root.get("list").map_or(&[][..], Node::items);
        assert_eq!((list[0].raw.as_str(), list[0].exact, list[0].span.text()), ("it", true, "it"));
        assert_eq!(
            (list[1].raw.as_str(), list[1].exact, list[1].span.text()),
            ("x\ty", false, "\"x\\ty\"")
        );
        assert_eq!((&list[2].value, &list[3].value), (&Value::Null, &Value::Bool(true)));
        assert_eq!(
            root.get("list").map(|node| node.span.text()),
            Some("[ 'it', \"x\\ty\", ~, true ]")
        );
        let sub = root.get("sub").map_or(&[][..], Node::items);
        assert_eq!(sub[0].number(), Some(16.0));
        assert_eq!(
            (sub[1].items().len(), sub[1].lookup("k").map(|node| (node.raw.as_str(), node.exact))),
            (0, Some(("two lines", false)))
        );
        assert_eq!(sub[1].get("k").map(|node| node.span.to_string()), Some("t.yaml:8:8".into()));
    }

    #[test]
    fn dotted_paths_find_nested_values_and_dotted_keys() {
        let root = read("a:\n  b:\n    c: 1\n  b.d: 2\na.x: 3\n");
        assert_eq!(root.lookup("a.b.c").and_then(Node::number), Some(1.0));
        assert_eq!(root.lookup("a.b.d").and_then(Node::number), Some(2.0));
        assert_eq!(root.lookup("a.x").and_then(Node::number), Some(3.0));
        assert!(
            root.lookup("a.q").is_none() && root.lookup("").is_none() && root.lookup(".").is_none()
        );
    }

    #[test]
    fn block_scalars_and_empty_texts() {
        let root = read("note: |\n  one\n  two\nfold: >-\n  one\n  two\nnone:\n");
        assert_eq!(root.get("note").map(|node| node.raw.as_str()), Some("one\ntwo\n"));
        assert_eq!(
            root.get("fold").map(|node| (node.raw.as_str(), node.exact)),
            Some(("one two", false))
        );
        assert_eq!(root.get("none").map(|node| &node.value), Some(&Value::Null));
        for empty in ["", "\n\n", "# only a comment\n", "---\n", "\u{feff}"] {
            assert_eq!(read(empty).value, Value::Null, "{empty:?}");
        }
    }

    #[test]
    fn aliases_are_written_out() {
        let root = read("base: &b {x: 1}\nsame: *b\n");
        assert_eq!(root.lookup("same.x").and_then(Node::number), Some(1.0));
        assert_eq!(root.get("same").map(|node| node.span.text()), Some("{x: 1}"));
        assert_eq!(
            read("v: !!str 5\nw: ! 7").get("v").map(|node| &node.value),
            Some(&Value::Text("5".into()))
        );
    }

    #[test]
    fn problems_are_at_their_place() {
        for (text, code, at) in [
            ("a: 1\nb: [1, 2\n", "yaml-syntax", "2:4"),
            ("a: 1\n\tb: 2\n", "tab-indentation", "2:1"),
            ("a: b: c\n", "yaml-syntax", "1:5"),
            ("a: 'open\nb: 1\n", "yaml-syntax", "2:1"),
            ("a: 1\nb: 2\na: 3\n", "duplicate-key", "3:1"),
            ("a: 1\n'a': 3\n", "duplicate-key", "2:2"),
            ("x: *none\n", "yaml-syntax", "1:4"),
            ("x: &a [*a]\n", "yaml-syntax", "1:8"),
            ("a: 1\n---\nb: 2\n", "yaml-syntax", "2:1"),
            ("? [1, 2]\n: 3\n", "yaml-key", "1:3"),
            ("max: .inf\n", "not-finite", "1:6"),
            ("max: 1e999\n", "not-finite", "1:6"),
            ("max: !limit 5\n", "yaml-tag", "1:13"),
            ("a: 1\n  b: 2\n", "yaml-syntax", "2:4"),
            ("a: @x\n", "yaml-syntax", "1:4"),
        ] {
            assert_eq!(faults(text), [(code, at.to_string())], "{text}");
        }
        assert_eq!(faults("a: .nan\nb: 1\nb: 2\nc: !x 1\n").len(), 3);
    }

    #[test]
    fn a_tree_as_written_keeps_repeated_keys() {
        let mut problems = Problems::default();
        let tree = load_as_written(&Source::new("t", "a: 1\nb: .nan\na: 3\n"), &mut problems)
            .expect("a tree");
        assert_eq!(
            tree.entries().iter().map(|(key, _)| key.text.as_str()).collect::<Vec<_>>(),
            ["a", "b", "a"]
        );
        assert_eq!(
            problems.0.iter().map(|problem| problem.code).collect::<Vec<_>>(),
            ["not-finite"]
        );
    }

    #[test]
    fn an_alias_bomb_is_refused_at_once() {
        let mut bomb = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x]\n");
        for n in 1..9 {
            let again = format!("*a{}, ", n - 1).repeat(9);
            bomb += &format!("a{n}: &a{n} [{again}]\n");
        }
        assert_eq!(faults(&bomb)[0].0, "yaml-too-large");
        assert_eq!(faults(&("[".repeat(100) + &"]".repeat(100)))[0].0, "yaml-too-deep");
        assert_eq!(faults(&"- ".repeat(100_000)).len(), 1);
    }

    #[test]
    fn remarks_tell_beside_from_above() {
        let source = Source::new("t", "# head\na: 1  # why\n\n#tail\n");
        let found: Vec<_> = remarks(&source)
            .into_iter()
            .map(|remark| (remark.text, remark.beside, remark.span.line()))
            .collect();
        assert_eq!(
            found,
            [("head".into(), false, 1), ("why".into(), true, 2), ("tail".into(), false, 4)]
        );
    }

    const SAMPLE: &str = "name: &n Köln\nlist: [1, 'two', \"th\\tree\", {a: *n}]\nmap:\n  - k: |\n      text\n    v: 1e3\n  - # none\n? x\n: y\n";

    /// Whatever the bytes, loading ends with a value or a problem, and every span lies on the text.
    fn survives(text: &str) {
        fn spans(node: &Node, source: &Arc<Source>) {
            assert!(
                source.text.get(node.span.start..node.span.end).is_some(),
                "{:?} {:?}",
                source.text,
                node.span
            );
            node.items().iter().for_each(|item| spans(item, source));
            node.entries().iter().for_each(|(_, value)| spans(value, source));
        }
        let source = Source::new("t", text);
        let mut problems = Problems::default();
        match load(&source, &mut problems) {
            Some(node) => spans(&node, &source),
            None => assert!(problems.any_error(), "{text:?}"),
        }
        let _ = (remarks(&source), problems.render(false));
    }

    #[test]
    fn every_prefix_is_survived() {
        (0..=SAMPLE.len())
            .filter(|at| SAMPLE.is_char_boundary(*at))
            .for_each(|at| survives(&SAMPLE[..at]));
    }

    proptest! {
        #[test]
        fn flipped_bytes_are_survived(flips in prop::collection::vec((0..SAMPLE.len(), any::<u8>()), 1..6)) {
            let mut bytes = SAMPLE.as_bytes().to_vec();
            for (at, byte) in flips {
                bytes[at] = byte;
            }
            survives(&String::from_utf8_lossy(&bytes));
        }

        #[test]
        fn any_text_is_survived(text in r#"[ \n\t:#'"\[\]{},&*!|>%@a0-9.\-?é]{0,40}"#) {
            survives(&text);
        }
    }

    fields! {
        /// A table with a key of each kind.
        struct Row: "a row" {
            "name" name: Option<String> => "what it is called",
            "length" length: Option<Spanned<Metres>>,
            "list" list: Vec<f64>,
            "names" names: OneOrMore<String>,
            "inner" inner: Option<Inner>,
            "share" share: Ratio = Ratio(0.5),
        } also {
            span: Span = span_of_value,
        }
    }

    fields! {
        /// A map below it.
        #[derive(PartialEq)]
        struct Inner: "`{key}`" or Free {
            "side" side: Side,
        }
    }

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Side {
        Left,
        Right,
    }

    impl Words for Side {
        const WORDS: &'static [(&'static str, Self)] =
            &[("left", Self::Left), ("right", Self::Right)];
    }

    /// Code, place and help of a problem.
    type Told = (&'static str, String, Option<String>);

    fn row(text: &str) -> (Option<Row>, Vec<Told>) {
        let mut problems = Problems::default();
        let source = Source::new("t", text);
        let tree = load(&source, &mut problems).expect("YAML");
        let row = Reader { with: (), problems: &mut problems }.file(&tree);
        let told = |problem: &Problem| {
            let at = problem.at.as_ref().map(ToString::to_string).unwrap_or_default();
            (problem.code, at, problem.help.clone())
        };
        (row, problems.0.iter().map(told).collect())
    }

    #[test]
    fn fields_are_read_by_their_kinds() {
        let (row, told) = row(
            "name: ' x '\nlength: 2 km\nlist: [1, 2.5]\nnames: a\ninner: {side: left, other: 1}\nshare: 20 %\n",
        );
        let row = row.expect("a row");
        assert_eq!(told, []);
        assert_eq!(row.name.as_deref(), Some("x"));
        assert_eq!(row.length.map(|length| length.value), Some(Metres(2000.0)));
        assert_eq!((row.list, row.names.0), (vec![1.0, 2.5], vec!["a".to_string()]));
        assert_eq!((row.inner, row.share), (Some(Inner { side: Side::Left }), Ratio(0.2)));
        assert_eq!(Row::KEYS, ["name", "length", "list", "names", "inner", "share"]);
    }

    #[test]
    fn every_fault_is_told_with_its_place() {
        let some = |help: &str| Some(help.to_string());
        let (read, told) = row(
            "nmae: x\nside: left\nlength: 2\nlist: [a]\nnames: [[], b]\ninner: {side: lft, sid: 1}\nshare: 5 kg\n",
        );
        assert_eq!(
            told,
            [
                ("unknown-key", "t:1:1".into(), some("did you mean `name`?")),
                (
                    "unknown-key",
                    "t:2:1".into(),
                    some("`side` stands in `inner`: `inner: {side: left}`")
                ),
                ("key-missing", "t:1:1".into(), some("write `name: ...`")),
                ("unit-missing", "t:3:9".into(), some("write `2 m`, if that is meant")),
                ("wrong-kind", "t:4:8".into(), None),
                ("wrong-kind", "t:5:9".into(), None),
                ("unknown-key", "t:6:20".into(), some("did you mean `side`?")),
                ("unknown-word", "t:6:15".into(), some("did you mean `left`?")),
                ("wrong-number", "t:7:8".into(), None),
            ]
        );
        // What is right is read all the same.
        let read = read.expect("a row");
        assert_eq!(
            (read.names.0, read.inner, read.share),
            (vec!["b".to_string()], None, Ratio(0.5))
        );
        assert_eq!(row("[]").1, [("wrong-kind", "t:1:1".into(), None)]);
    }
}
