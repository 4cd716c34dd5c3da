//! The documentation says what is so: generated parts are current, protocols check, commands print
//! what is shown, tests and links that are named exist.
//!
//! `UPDATE_EXPECT=1 cargo test --release --test project docs::` rewrites the generated parts and the problems
//! of what fails.
//!
//! Code blocks say by the words after the fence what they are:
//!
//! | words | what |
//! |---|---|
//! | `fp` | rules that check without a problem: a protocol, or blocks added to a variant of Annex T |
//! | `fp extends NAME` | blocks added to a variant of another shipped protocol |
//! | `fp from PATH` | an excerpt, paragraph by paragraph, of a file |
//! | `fp fails` | a protocol whose problems stand in the next block |
//! | `... file=NAME` | is there as this file when the page's commands run |
//! | `console` | commands after `$` and what they print; a line `...` stands for any lines |

mod generate;
mod page;

use std::fs;
use std::path::Path;
use std::process::Command;

use fishplate::check::{self, Overrides, family};
use fishplate::problem::Problems;
use fishplate::source::Source;
use fishplate::{graph, library};
use page::{Block, Page, beside, pages, root};

#[test]
fn made_parts_are_current() {
    let update = std::env::var_os("UPDATE_EXPECT").is_some();
    let mut faults = 0;
    for page in pages() {
        let anew = page.regenerated(generate::part);
        let page_anew = Page { text: anew, path: page.path.clone() };
        let anew = page_anew.with_answers(|block| {
            let fails = is_fp(block) && block.info.iter().any(|word| word == "fails");
            fails.then(|| {
                let found = problems_of(file_of(block).unwrap_or("variant.fp"), &block.text);
                assert!(found.any_error(), "{}, line {} has no error", page.name(), block.line);
                faults += 1;
                format!("{}\n", found.render(false).trim_end())
            })
        });
        if update && anew != page.text {
            fs::write(&page.path, anew).expect("a writable page");
        } else {
            let differs = page.text.lines().zip(anew.lines()).find(|(old, new)| old != new);
            assert!(
                anew == page.text,
                "{}: run with UPDATE_EXPECT=1; first difference: {differs:#?}",
                page.name()
            );
        }
    }
    assert!(faults > 3, "{faults} faults are shown");
}

#[test]
fn everything_in_the_tables_is_described() {
    let there: Vec<String> = pages().iter().flat_map(Page::generated).collect();
    let missing: Vec<String> =
        generate::wanted().into_iter().filter(|part| !there.contains(part)).collect();
    assert!(missing.is_empty(), "on no page: {missing:?}");
}

/// The problems of a protocol, of the file name given.
fn problems_of(name: &str, text: &str) -> Problems {
    let mut problems = Problems::default();
    let family = family::read(&Source::new(name, text), &library::parent, &mut problems);
    if let Some(plan) = check::check(&family, &Overrides::new(), &mut problems) {
        graph::from_plan(&plan);
    }
    problems
}

fn is_protocol(text: &str) -> bool {
    text.lines().any(|line| line.starts_with("protocol "))
}

/// A block's file name, if it has one.
fn file_of(block: &Block) -> Option<&str> {
    block.info.iter().find_map(|word| word.strip_prefix("file="))
}

fn is_fp(block: &Block) -> bool {
    block.info.first().is_some_and(|word| word == "fp")
}

#[test]
fn protocols_check() {
    let mut count = 0;
    for page in pages() {
        for block in page.blocks().iter().filter(|block| is_fp(block)) {
            let at = format!("{}, line {}", page.name(), block.line);
            let info: Vec<&str> = block.info[1..]
                .iter()
                .map(String::as_str)
                .filter(|word| !word.starts_with("file="))
                .collect();
            let text = match info.as_slice() {
                ["fails"] => continue,
                ["from", path] => {
                    excerpt(&at, &block.text, path);
                    continue;
                }
                [] if is_protocol(&block.text) => block.text.clone(),
                [] => format!(
                    "protocol snippet \"Snippet\"\n  extends {}\n\n{}",
                    library::SHIPPED[0].name,
                    block.text
                ),
                ["extends", name] => {
                    format!("protocol snippet \"Snippet\"\n  extends {name}\n\n{}", block.text)
                }
                other => panic!("{at}: what is {other:?}?"),
            };
            let problems = problems_of("snippet.fp", &text);
            assert!(problems.0.is_empty(), "{at}\n{}", problems.render(false));
            count += 1;
        }
    }
    assert!(count > 10, "{count} protocols were checked");
}

/// The steps of the guide, one after the other, are the file with which its commands run.
#[test]
fn the_guide_is_one_file() {
    let guide = pages()
        .into_iter()
        .find(|page| page.name().ends_with("write-your-own.md"))
        .expect("the guide");
    let (whole, steps): (Vec<Block>, Vec<Block>) =
        guide.blocks().into_iter().filter(is_fp).partition(|block| file_of(block).is_some());
    let steps: Vec<String> = steps.into_iter().map(|block| block.text).collect();
    assert_eq!((whole.len(), steps.len()), (1, 5));
    assert_eq!(whole[0].text, steps.join("\n"));
}

#[track_caller]
fn excerpt(at: &str, text: &str, path: &str) {
    let whole = fs::read_to_string(root().join(path)).expect("a readable file");
    for paragraph in text.trim_end().split("\n\n") {
        assert!(whole.contains(paragraph), "{at}: not in {path}:\n{paragraph}");
    }
}

/// Where commands of a page run: a folder with the examples and protocols of the repository and the
/// files of the page.
fn workplace(page: &Page) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::create_dir(folder.path().join("target")).expect("made");
    for shared in ["examples", "protocols"] {
        copy(&root().join(shared), &folder.path().join(shared));
    }
    for block in page.blocks() {
        if let Some(name) = file_of(&block) {
            fs::write(folder.path().join(name), &block.text).expect("written");
        }
    }
    folder
}

fn copy(from: &Path, to: &Path) {
    if from.is_dir() {
        fs::create_dir_all(to).expect("made");
        for entry in fs::read_dir(from).expect("a folder") {
            let path = entry.expect("readable").path();
            copy(&path, &to.join(path.file_name().expect("a name")));
        }
    } else {
        fs::copy(from, to).expect("copied");
    }
}

#[test]
fn commands_print_what_is_shown() {
    let mut count = 0;
    for page in pages() {
        let blocks: Vec<Block> = page
            .blocks()
            .into_iter()
            .filter(|block| block.info.first().is_some_and(|word| word == "console"))
            .collect();
        if blocks.is_empty() {
            continue;
        }
        let folder = workplace(&page);
        for block in blocks {
            count += console(&page, &block, folder.path());
        }
    }
    assert!(count >= 8, "{count} commands ran");
}

/// Runs the commands of a block; how many there were.
fn console(page: &Page, block: &Block, folder: &Path) -> usize {
    let mut code = 0;
    let mut count = 0;
    let shown = format!("\n{}", block.text);
    for part in shown.split("\n$ ").skip(1) {
        let (line, expected) = part.split_once('\n').unwrap_or((part, ""));
        let at = format!("{}, line {}: {line}", page.name(), block.line);
        let found =
            if line == "echo $?" { format!("{code}\n") } else { run(line, folder, &mut code, &at) };
        assert!(code <= 2, "{at}: {found}");
        assert!(matches(&found, expected), "{at}\nprints:\n{found}\nshown:\n{expected}");
        count += 1;
    }
    count
}

/// The words of a line, as a shell takes them apart: what stands in double quotes is one word.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (at, part) in line.split('"').enumerate() {
        match at % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_string)),
            _ => words.push(part.to_string()),
        }
    }
    words
}

/// Runs the program as a line of a shell would; what it prints, errors last.
fn run(line: &str, folder: &Path, code: &mut i32, at: &str) -> String {
    let line = line.replace("cargo run --release -- ", "fishplate ");
    let (line, to) =
        line.split_once(" > ").map_or((line.as_str(), None), |(line, to)| (line, Some(to)));
    let mut words = words(line).into_iter();
    assert_eq!(words.next().as_deref(), Some("fishplate"), "{at}: only the program itself is run");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fishplate"));
    command.current_dir(folder).args(words);
    // A page may call the program by its name in a file of its own.
    let program = Path::new(env!("CARGO_BIN_EXE_fishplate")).parent().expect("a folder");
    let others = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(
        std::iter::once(program.to_path_buf()).chain(std::env::split_paths(&others)),
    );
    command.env("PATH", path.expect("folders without separators"));
    if line.contains(" certify ") && !line.contains("--only") {
        command.args(["--only", "results"]);
    }
    let output = command.output().expect("the program runs");
    *code = output.status.code().unwrap_or(-1);
    let mut text = String::from_utf8(output.stdout).expect("UTF-8");
    if let Some(to) = to {
        fs::write(folder.join(to), std::mem::take(&mut text)).expect("written");
    }
    text + &String::from_utf8(output.stderr).expect("UTF-8")
}

/// Whether a text is as shown, where a line `...` stands for any lines.
fn matches(found: &str, shown: &str) -> bool {
    let shown: Vec<&str> = shown.trim_end().lines().collect();
    let mut rest: &[&str] = &found.trim_end().lines().collect::<Vec<_>>();
    let mut parts = shown.split(|line| *line == "...");
    let first = parts.next().unwrap_or(&[]);
    if !rest.starts_with(first) {
        return false;
    }
    rest = &rest[first.len()..];
    let mut parts: Vec<&[&str]> = parts.collect();
    let Some(last) = parts.pop() else { return rest.is_empty() };
    for part in parts {
        let Some(place) = (0..=rest.len()).find(|&place| rest[place..].starts_with(part)) else {
            return false;
        };
        rest = &rest[place + part.len()..];
    }
    rest.ends_with(last)
}

#[test]
fn elisions_stand_for_any_lines() {
    assert!(
        matches("a\nb\nc\nd\n", "a\n...\nd\n")
            && matches("a\nb\n", "a\nb\n")
            && matches("a\nb\n", "a\n...\n")
    );
    assert!(
        !matches("a\nb\n", "a\n")
            && !matches("a\nb\nc\n", "...\nb\n")
            && matches("a\nb\nc\n", "...\nb\n...\n")
    );
}

/// `tests/evaluation/metrics/filter.rs::agrees_with_scipy` names a test.
#[test]
fn named_tests_exist() {
    let mut count = 0;
    for page in pages() {
        for word in
            page.prose().split('`').filter(|word| word.contains(".rs::") && !word.contains(' '))
        {
            let (file, test) = word.split_once("::").expect("a path and a name");
            let text = fs::read_to_string(root().join(file))
                .unwrap_or_else(|_| panic!("{}: no file {file}", page.name()));
            assert!(text.contains(&format!("fn {test}(")), "{}: no test {word}", page.name());
            count += 1;
        }
    }
    assert!(count > 20, "{count} tests are named");
}

/// Files and folders of the source that pages name by their path are there.
#[test]
fn named_files_exist() {
    let mut count = 0;
    for page in pages() {
        let prose = page.prose();
        let path = |word: &&str| {
            (word.ends_with(".rs") || word.ends_with(".pest") || word.ends_with('/'))
                && !word.contains([' ', ':', '*'])
        };
        for word in prose.split('`').skip(1).step_by(2).filter(path) {
            let there = ["", "src"].iter().any(|folder| root().join(folder).join(word).exists());
            // A file named beside another of its folder stands without the folder.
            assert!(there || !word.contains('/'), "{}: no {word}", page.name());
            count += usize::from(there);
        }
    }
    assert!(count > 10, "{count} files are named");
}

#[test]
fn links_lead_somewhere() {
    let pages = pages();
    for page in &pages {
        for link in page.links() {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let path = if file.is_empty() { page.path.clone() } else { beside(&page.path, file) };
            assert!(path.exists(), "{}: {link}", page.name());
            if let (false, Some(target)) =
                (anchor.is_empty(), pages.iter().find(|other| other.path == path))
            {
                assert!(
                    target.anchors().iter().any(|known| known == anchor),
                    "{}: {link}; there are {:?}",
                    page.name(),
                    target.anchors()
                );
            }
        }
    }
}

/// Codes of problems stand in code font in the first column of tables headed `code`.
#[test]
fn named_codes_exist() {
    let mut sources = String::new();
    gather(&root().join("src"), &mut sources);
    let mut count = 0;
    for page in pages() {
        let mut inside = false;
        for line in page.prose().lines() {
            inside = line.starts_with("| code |") || inside && line.starts_with('|');
            if let (true, Some((codes, _))) =
                (inside, line.strip_prefix("| `").and_then(|rest| rest.split_once(" |")))
            {
                for code in codes.trim_end_matches('`').split("`, `") {
                    assert!(
                        sources.contains(&format!("\"{code}\"")),
                        "{}: no problem has the code {code}",
                        page.name()
                    );
                    count += 1;
                }
            }
        }
    }
    assert!(count > 20, "{count} codes are named");
}

fn gather(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            gather(&path, text);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            *text += &fs::read_to_string(&path).expect("readable");
        }
    }
}
