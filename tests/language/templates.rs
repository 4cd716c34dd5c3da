//! The PDF's templates take texts of users as data: none of them may turn text into markup or code,
//! or read what the report was not given.

use std::fs;
use std::path::{Path, PathBuf};

use typst::syntax::{SyntaxKind, SyntaxNode};

fn templates(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            templates(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "typ") {
            found.push(path);
        }
    }
}

/// Words of the code of a template, and the texts of its strings.
fn words(node: &SyntaxNode, found: &mut Vec<(SyntaxKind, String)>) {
    if matches!(node.kind(), SyntaxKind::Ident | SyntaxKind::MathIdent | SyntaxKind::Str) {
        found.push((node.kind(), node.leaf_text().to_string()));
    }
    node.children().for_each(|child| words(child, found));
}

#[test]
fn no_template_evaluates_text() {
    let mut paths = Vec::new();
    templates(&Path::new(env!("CARGO_MANIFEST_DIR")).join("templates"), &mut paths);
    assert!(paths.len() >= 2, "{paths:?}");
    for path in paths {
        let text = fs::read_to_string(&path).expect("readable");
        let mut found = Vec::new();
        words(&typst::syntax::parse(&text), &mut found);
        for (kind, word) in found {
            let name = path.display();
            if kind == SyntaxKind::Str {
                assert!(!word.starts_with("\"@"), "{name} imports the package {word}");
            } else {
                assert!(!["eval", "plugin"].contains(&word.as_str()), "{name} calls `{word}`");
            }
        }
    }
}
