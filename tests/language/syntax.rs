//! Both surfaces of the language: what they refuse and how it is said, what they print, and that
//! nothing is lost between.
//!
//! Expected output lies beside each case as `<case>.out`; `UPDATE_EXPECT=1 cargo test` rewrites it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fishplate::check::diff::diff;
use fishplate::problem::Problems;
use fishplate::source::Source;
use fishplate::syntax::document::Document;
use fishplate::syntax::{self, in_order, print_text, print_yaml, schema};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Protocol files of a folder, in order of their names.
fn files(folder: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(root().join(folder))
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    files.retain(|path| {
        path.extension().is_some_and(|extension| extension == "fp" || extension == "yaml")
    });
    files.sort();
    files
}

fn name(path: &Path) -> String {
    path.file_name().expect("a file").to_string_lossy().into_owned()
}

fn source(path: &Path) -> Arc<Source> {
    Source::new(name(path), fs::read_to_string(path).expect("a readable case"))
}

fn read(source: &Arc<Source>) -> (Document, Problems) {
    let mut problems = Problems::default();
    let document = syntax::read(source, &mut problems);
    (document, problems)
}

/// The document, which must be without problems.
#[track_caller]
fn clean(name: &str, text: &str) -> Document {
    let (document, problems) = read(&Source::new(name, text));
    assert!(problems.0.is_empty(), "{}\n{text}", problems.render(false));
    document
}

fn compare_or_update(case: &Path, found: &str) {
    let mut out = case.as_os_str().to_owned();
    out.push(".out");
    let out = PathBuf::from(out);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(&out, found).expect("a writable case");
    } else {
        let expected = fs::read_to_string(&out).unwrap_or_default();
        assert!(expected == found, "{} differs from what is found:\n{found}", out.display());
    }
}

#[test]
fn bad_files_are_refused_in_words() {
    for path in files("tests/cases/syntax/bad") {
        let (_, problems) = read(&source(&path));
        assert!(problems.any_error(), "{} is taken for good", path.display());
        compare_or_update(&path, &problems.render(false));
    }
}

#[test]
fn both_forms_name_a_fault_alike() {
    let mut codes: BTreeMap<String, Vec<Vec<&str>>> = BTreeMap::new();
    for path in files("tests/cases/syntax/bad") {
        let (_, problems) = read(&source(&path));
        let mut found: Vec<&str> = problems.0.iter().map(|problem| problem.code).collect();
        found.sort();
        let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
        codes.entry(stem).or_default().push(found);
    }
    let pairs: Vec<_> = codes.iter().filter(|(_, forms)| forms.len() == 2).collect();
    assert!(pairs.len() >= 8, "few faults are tried in both forms");
    for (stem, forms) in pairs {
        assert_eq!(forms[0], forms[1], "{stem}");
    }
}

#[test]
fn good_files_print_canonically() {
    for path in files("tests/cases/syntax/good") {
        let text = fs::read_to_string(&path).expect("a readable case");
        let document = clean(&name(&path), &text);
        let printed = if name(&path).ends_with(".yaml") {
            print_yaml(&document)
        } else {
            print_text(&document)
        };
        if name(&path).starts_with("untidy") {
            compare_or_update(&path, &printed);
        } else {
            assert_eq!(printed, text, "{} is not canonical", path.display());
        }
        keeps_everything(&document);
    }
}

#[test]
fn shipped_protocols_are_clean_and_convert() {
    for path in files("protocols") {
        keeps_everything(&clean(
            &name(&path),
            &fs::read_to_string(&path).expect("a readable protocol"),
        ));
    }
}

/// Nothing is lost in either form, and printing what was printed changes nothing.
#[track_caller]
fn keeps_everything(document: &Document) {
    let wanted = in_order(document);
    let (text, yaml) = (print_text(document), print_yaml(document));
    let (from_text, from_yaml) = (clean("printed.fp", &text), clean("printed.yaml", &yaml));
    for read in [&from_text, &from_yaml] {
        let differs = diff(&wanted, read);
        assert!(differs.is_empty(), "{differs:?}\n{text}");
        assert_eq!(read.blocks.len(), wanted.blocks.len());
    }
    assert_eq!(print_text(&from_text), text);
    assert_eq!(print_yaml(&from_yaml), yaml);
    assert_eq!(print_text(&from_yaml), text);
    assert_eq!(print_yaml(&from_text), yaml);
}

/// What means the same has one text, whatever its blanks, signs and zeros are.
#[test]
fn one_text_for_one_meaning() {
    let head = "protocol p \"P\"\n  axis  distance in m\n\nquantity q\n";
    let first = "  of Y at wheelsets 1,3\n  value larger of |p0.15|,|p99.85|\n  limit std 1.0 kN doubled when a>=2\n";
    let second = "  of  Y at wheelsets 1, 3\n  value  larger of |p0.15|, |p99.85|\n  limit  std 1 kN, doubled when a ≥ 2.0\n";
    let [first, second] = [first, second].map(|fields| clean("a.fp", &format!("{head}{fields}")));
    assert!(diff(&first, &second).is_empty());
    assert_eq!(print_text(&first), print_text(&second));
    assert_eq!(print_yaml(&first), print_yaml(&second));
}

#[test]
fn comments_stay_beside_their_case() {
    let text = "protocol p \"P\"\n  axis  distance in m\n\nquantity q\n  # above\n  limit  each 9 kN when v > 120 km/h,  # fast\n         8 kN when v > 100 km/h,  # middle\n         otherwise 7 kN  # slow\n";
    let document = clean("a.fp", text);
    assert_eq!(print_text(&document), text);
    let yaml = print_yaml(&document);
    assert!(["# above", "# fast", "# middle", "# slow"].iter().all(|one| yaml.contains(one)));
}

#[test]
fn lists_of_words_are_lists_in_yaml_too() {
    let yaml = |words: &str| {
        clean(
            "a.yaml",
            &format!("protocol: {{name: p}}\nsection data:\n  c:\n    one of: {words}\n"),
        )
    };
    assert_eq!(yaml("[IT, FR, 3]"), yaml("IT, FR, 3"));
    assert_eq!(print_yaml(&yaml("[IT, FR, 3]")), print_yaml(&yaml("IT, FR, 3")));
}

#[test]
fn both_forms_say_the_same() {
    let folder = root().join("tests/cases/syntax/good");
    for case in ["wheel_forces", "families"] {
        let text = fs::read_to_string(folder.join(format!("{case}.fp"))).expect("a readable case");
        let yaml =
            fs::read_to_string(folder.join(format!("{case}.yaml"))).expect("a readable case");
        assert_eq!(print_yaml(&clean("a.fp", &text)), yaml);
        assert_eq!(print_text(&clean("a.yaml", &yaml)), text);
    }
}

/// The page on the two forms shows one protocol in both.
#[test]
fn the_manual_shows_what_is_read() {
    let page =
        fs::read_to_string(root().join("docs/language-surfaces.md")).expect("a readable page");
    let block = |language: &str| {
        let (_, rest) = page.split_once(&format!("```{language}\n")).expect("an example");
        rest.split_once("```").expect("its end").0.to_owned()
    };
    let (text, yaml) = (block("text"), block("yaml"));
    assert_eq!(clean("a.fp", &text), clean("a.yaml", &yaml));
    assert_eq!(print_yaml(&clean("a.fp", &text)), yaml);
}

#[test]
fn line_ends_and_marks_of_editors_do_not_matter() {
    let text = fs::read_to_string(root().join("tests/cases/syntax/good/wheel_forces.fp"))
        .expect("a readable case");
    let document = clean("a.fp", &format!("\u{feff}{}", text.replace('\n', "\r\n")));
    assert_eq!(print_text(&document), text);
    let yaml = fs::read_to_string(root().join("tests/cases/syntax/good/wheel_forces.yaml"))
        .expect("a readable case");
    let document = clean("a.yaml", &format!("\u{feff}{}", yaml.replace('\n', "\r\n")));
    assert_eq!(print_yaml(&document), yaml);
}

/// Values know where they stand, byte by byte, across lines and comments too.
#[test]
fn places_are_exact() {
    let text = "protocol p \"A \\\" title\"\n  axis  distance # where\n        in m\n  edition  \"EN 14363\"\n";
    let document = clean("a.fp", text);
    let block = &document.blocks[0];
    let axis = &block.field("axis").expect("the axis").value;
    assert!(axis.exact);
    assert_eq!(axis.place(axis.text.find("m").expect("m")..axis.text.len()).text(), "m");
    assert_eq!(axis.text.split_whitespace().collect::<Vec<_>>(), ["distance", "in", "m"]);
    let edition = &block.field("edition").expect("the edition").value;
    assert_eq!((edition.exact, edition.place(3..8).text()), (true, "14363"));
    let title = block.title.as_ref().expect("a title");
    assert_eq!(
        (title.exact, title.text.as_str(), title.span.text()),
        (false, "A \" title", "\"A \\\" title\"")
    );

    let yaml = "protocol:\n  name: p\nzones:\n  1:\n    minimum sections: 1.50\n    where: 'a is b'\nparameters:\n  x: {default: no}\n";
    let document = clean("a.yaml", yaml);
    let zone = document.blocks.iter().find(|block| block.kind.text == "zone").expect("a zone");
    let minimum = &zone.field("minimum sections").expect("the minimum").value;
    assert_eq!((minimum.text.as_str(), minimum.exact, minimum.span.text()), ("1.50", true, "1.50"));
    let condition = &zone.field("where").expect("the condition").value;
    assert_eq!(condition.place(2..4).text(), "is");
    let parameter =
        document.blocks.iter().find(|block| block.kind.text == "parameter").expect("a parameter");
    assert_eq!(parameter.field("default").expect("its default").value.text, "no");
}

#[test]
fn no_prefix_and_no_lost_character_brings_the_readers_down() {
    for path in files("tests/cases/syntax/good").into_iter().chain(files("tests/cases/syntax/bad"))
    {
        let text = fs::read_to_string(&path).expect("a readable case");
        for (at, c) in text.char_indices() {
            for damaged in
                [text[..at].to_owned(), format!("{}{}", &text[..at], &text[at + c.len_utf8()..])]
            {
                let (document, problems) = read(&Source::new(name(&path), damaged));
                problems.render(false);
                // What was read in spite of the damage can be printed.
                print_text(&document);
                print_yaml(&document);
            }
        }
    }
}

mod round_trip {
    use super::*;
    use fishplate::syntax::document::{Block, Comments, Field, Text};
    use fishplate::syntax::keys::{KINDS, Key, Kind, Sort, of_block};
    use proptest::collection::vec;
    use proptest::option;
    use proptest::prelude::*;
    use proptest::sample::{Index, select};

    fn text(text: String) -> Text {
        Text { text, span: Source::new("made", "").whole(), exact: false }
    }

    fn prose() -> impl Strategy<Value = String> {
        let pieces = select(vec![
            "word",
            " ",
            "  ",
            "\n",
            "\t",
            "\"",
            "'",
            "\\",
            "#",
            " # ",
            ": ",
            "- ",
            "|",
            ">",
            "[",
            "}",
            "%",
            "true",
            "12",
            "1.50",
            "é",
            "\u{1f682}",
            ",",
            "\r",
            "\u{7}",
            "a rather long piece of text, so that lines are broken ",
        ]);
        prop_oneof![
            vec(pieces, 1..12).prop_map(|pieces| pieces.concat()),
            "\\PC{1,20}",
            select(vec!["null", "~", "no", "2026-01-01", "1e5", "-", "?", "a:", "=", "<<"])
                .prop_map(str::to_owned),
        ]
        .prop_filter("blank text is no text", |text| !text.trim().is_empty())
    }

    fn phrase() -> impl Strategy<Value = String> {
        let words = select(vec![
            "std",
            "9",
            "kN",
            "|p99.85|",
            "and",
            "or",
            "when",
            "otherwise",
            "a,",
            "b",
            "<=",
            "-",
            "%",
            "*",
            "2/3",
            "1.50",
            "(c)",
            "\"q  # x\"",
            "\"a\\\"b\"",
            "true",
            "null",
            "no",
            "[x]",
            "{y}",
            "p{x}_limit",
            "(a, b), (c and d, e)",
            "&",
            "!",
            "'s'",
            "some_rather_long_name",
            "a:",
            "?",
        ]);
        vec(words, 1..24).prop_map(|words| words.join(" "))
    }

    fn comments() -> impl Strategy<Value = Comments> {
        let line = || {
            select(vec!["", "a comment", "# twice", "key: value", "  indented", "\"open", "- item"])
                .prop_map(str::to_owned)
        };
        (vec(line(), 0..2), option::weighted(0.2, line())).prop_map(|(before, beside)| Comments {
            rows: Vec::new(),
            before,
            beside,
            after: Vec::new(),
        })
    }

    fn field(key: &'static Key) -> BoxedStrategy<Field> {
        let value = match key.sort {
            Sort::Text => prose().boxed(),
            Sort::Phrase => phrase().boxed(),
        };
        (value, comments())
            .prop_map(|(value, comments)| Field {
                key: text(key.word.to_owned()),
                value: text(value),
                comments,
            })
            .boxed()
    }

    fn block(kind: &'static Kind) -> impl Strategy<Value = Block> {
        let mut names = vec!["Y_max", "1", "1.5", "null", "n-1", "_x", "007", "1e5", "true", "y"];
        if kind.has_families() {
            names.extend(["{q}_{m}", "{x}", "Y_{part}"]);
        }
        let name = select(names);
        let fields = vec(any::<Index>(), 0..5).prop_flat_map(|picks| {
            let mut keys: Vec<&'static Key> = Vec::new();
            for pick in picks {
                let key = pick.get(kind.keys);
                if key.many || !keys.iter().any(|known| known.word == key.word) {
                    keys.push(key);
                }
            }
            keys.into_iter().map(field).collect::<Vec<_>>()
        });
        (
            name,
            option::of(prose()),
            fields,
            comments(),
            vec(select(vec!["after", ""]).prop_map(str::to_owned), 0..2),
        )
            .prop_map(|(name, title, fields, mut comments, after)| {
                comments.after = after;
                let name = kind.named.then(|| text(name.to_owned()));
                Block {
                    kind: text(kind.word.to_owned()),
                    name,
                    title: title.map(text),
                    fields,
                    comments,
                }
            })
    }

    fn document() -> impl Strategy<Value = Document> {
        vec(
            select((0..KINDS.len()).collect::<Vec<_>>()).prop_flat_map(|kind| block(&KINDS[kind])),
            0..6,
        )
        .prop_map(|made| {
            let mut blocks: Vec<Block> = Vec::new();
            for block in made {
                let kind = |block: &Block| of_block(block).expect("a kind");
                let same = |known: &Block| {
                    kind(known).group == kind(&block).group
                        && (kind(known).single || known.name == block.name)
                };
                if !blocks.iter().any(same) {
                    blocks.push(block);
                }
            }
            Document {
                source: Source::new("made", ""),
                leading: Vec::new(),
                blocks,
                trailing: Vec::new(),
            }
        })
    }

    /// Prose to the letter; [`PartialEq`] leaves blanks aside.
    fn letters(document: &Document) -> Vec<String> {
        let mut letters = Vec::new();
        for block in &document.blocks {
            letters.extend(block.title.iter().map(|title| title.text.clone()));
            let kind = of_block(block).expect("a kind");
            let prose = block.fields.iter().filter(|field| {
                kind.key(&field.key.text).is_some_and(|key| key.sort == Sort::Text)
            });
            letters.extend(prose.map(|field| field.value.text.clone()));
        }
        letters
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn random_documents_pass_through_both_forms(document in document()) {
            keeps_everything(&document);
            let wanted = letters(&in_order(&document));
            prop_assert_eq!(&letters(&clean("a.fp", &print_text(&document))), &wanted);
            prop_assert_eq!(&letters(&clean("a.yaml", &print_yaml(&document))), &wanted);
        }

        /// An independent YAML reader finds the same texts where they are written.
        #[test]
        fn printed_yaml_is_yaml_to_others(document in document()) {
            let loaded: serde_yaml::Value = serde_yaml::from_str(&print_yaml(&document)).expect("YAML");
            for block in &document.blocks {
                let kind = of_block(block).expect("a kind");
                let group = &loaded[kind.group];
                let fields = match &block.name {
                    Some(name) if !kind.single => group.get(name.text.as_str()).or_else(|| group.get(name.text.parse::<usize>().ok()?)),
                    _ => Some(group),
                };
                let fields = fields.expect("the block");
                if let Some(title) = &block.title {
                    prop_assert_eq!(fields["title"].as_str(), Some(title.text.as_str()));
                }
                for key in kind.keys.iter().filter(|key| key.sort == Sort::Text) {
                    let wanted: Vec<&str> = block.fields_named(key.word).map(|field| field.value.text.as_str()).collect();
                    let found: Vec<&str> = match &fields[key.word] {
                        serde_yaml::Value::Sequence(items) => items.iter().filter_map(|item| item.as_str()).collect(),
                        one => one.as_str().into_iter().collect(),
                    };
                    prop_assert_eq!(found, wanted);
                }
            }
        }
    }
}

mod schema_of_yaml {
    use super::*;

    fn validator() -> jsonschema::Validator {
        jsonschema::validator_for(&schema::json_schema()).expect("the schema is a schema")
    }

    fn json(yaml: &str) -> serde_json::Value {
        serde_yaml::from_str(yaml).expect("YAML that another reader loads")
    }

    #[test]
    fn the_shipped_file_is_the_function() {
        let file = root().join("protocols/protocol.schema.json");
        let made = serde_json::to_string_pretty(&schema::json_schema()).expect("JSON") + "\n";
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            fs::write(&file, &made).expect("a writable schema");
        }
        assert!(
            fs::read_to_string(&file).unwrap_or_default() == made,
            "protocols/protocol.schema.json is not up to date"
        );
    }

    #[test]
    fn good_protocols_satisfy_it() {
        let validator = validator();
        for path in files("tests/cases/syntax/good").into_iter().chain(files("protocols")) {
            let document =
                clean(&name(&path), &fs::read_to_string(&path).expect("a readable case"));
            let yaml = print_yaml(&document);
            let errors: Vec<String> = validator
                .iter_errors(&json(&yaml))
                .map(|error| format!("{}: {error}", error.instance_path))
                .collect();
            assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
        }
    }

    #[test]
    fn it_refuses_what_the_reader_refuses() {
        let validator = validator();
        for case in [
            "unknown_block",
            "group_and_kind_mixed_up",
            "unknown_field",
            "missing_name",
            "bad_name",
            "missing_value",
            "wrong_shape",
            "not_a_map",
        ] {
            let yaml =
                fs::read_to_string(root().join(format!("tests/cases/syntax/bad/{case}.yaml")))
                    .expect("a readable case");
            assert!(!validator.is_valid(&json(&yaml)), "{case}");
        }
    }
}
