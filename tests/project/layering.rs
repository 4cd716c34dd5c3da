//! The structure stays as `docs/architecture.md` says: its table of imports is compared with the
//! code, and rules stay out of the code.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Source files below `src`, each with the module it belongs to.
fn sources() -> Vec<(String, PathBuf)> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                walk(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path);
            }
        }
    }
    let mut files = Vec::new();
    walk(&root().join("src"), &mut files);
    files.sort();
    let module = |path: &PathBuf| {
        let inside = path.strip_prefix(root().join("src")).expect("below src");
        let first =
            inside.components().next().expect("a part").as_os_str().to_string_lossy().into_owned();
        first.trim_end_matches(".rs").to_string()
    };
    files.into_iter().map(|path| (module(&path), path)).collect()
}

/// Code without its unit tests, which may use anything.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a source");
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// The sources by their path from the root, with their text.
pub fn texts() -> Vec<(String, String)> {
    let of = |(_, path): (String, PathBuf)| {
        let inside = path.strip_prefix(root()).expect("below the root");
        let name = inside.to_string_lossy().replace('\\', "/");
        (name, fs::read_to_string(&path).expect("a source"))
    };
    sources().into_iter().map(of).collect()
}

/// Modules named after a path such as `crate::`, in single and grouped imports.
fn imports(code: &str, after: &str) -> BTreeSet<String> {
    code.split(after)
        .skip(1)
        .map(|rest| {
            rest.chars().take_while(|c| c.is_ascii_lowercase() || *c == '_').collect::<String>()
        })
        .filter(|name| !name.is_empty())
        .collect()
}

/// A table of `docs/architecture.md`, in the order of its rows.
fn table(header: &str) -> Vec<(String, BTreeSet<String>)> {
    let text = fs::read_to_string(root().join("docs/architecture.md")).expect("the page");
    let rows = text
        .lines()
        .skip_while(|line| *line != header)
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let imports = cells[cells.len() - 2]
            .split(',')
            .map(|name| name.trim().to_string())
            .filter(|name| !name.is_empty());
        (cells[1].to_string(), imports.collect())
    })
    .collect()
}

#[test]
fn modules_import_what_the_table_says() {
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, path) in sources() {
        let uses = found.entry(module.clone()).or_default();
        uses.extend(imports(&code(&path), "crate::").into_iter().filter(|name| *name != module));
        // The program is a crate of its own and names the library by its name.
        if module == "main" {
            uses.extend(code(&path).split("fishplate::").skip(1).map(|rest| {
                rest.chars().take_while(|c| c.is_ascii_lowercase()).collect::<String>()
            }));
        }
    }
    compare(&found, MODULES);
}

/// Files and folders of the diagnosis, from what is observed to what is said of it.
#[test]
fn the_diagnosis_goes_one_way() {
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (_, path) in sources().into_iter().filter(|(module, _)| module == "diagnose") {
        let inside = path.strip_prefix(root().join("src/diagnose")).expect("below it");
        let parts: Vec<String> =
            inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        let part = parts[0].trim_end_matches(".rs").to_string();
        if part == "mod" {
            continue;
        }
        let uses = found.entry(part.clone()).or_default();
        uses.extend(
            imports(&code(&path), "crate::diagnose::").into_iter().filter(|name| *name != part),
        );
        if parts.len() == 1 {
            uses.extend(imports(&code(&path), "super::"));
        }
    }
    compare(&found, PARTS);
}

/// The paths of an import such as `super::{a, b::{C, D}}`.
fn spread(before: &str, tree: &str, found: &mut Vec<String>) {
    let Some((path, inside)) = tree.split_once('{') else {
        found.push(format!("{before}{}", tree.split(" as ").next().unwrap_or_default().trim()));
        return;
    };
    let before = format!("{before}{}", path.trim());
    let (mut depth, mut from) = (0, 0);
    let inside = inside.trim_end().strip_suffix('}').unwrap_or(inside);
    for (at, letter) in inside.char_indices().chain([(inside.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                let part = inside[from..at].trim();
                if !part.is_empty() {
                    spread(&before, part, found);
                }
                from = at + 1;
            }
            _ => {}
        }
    }
}

/// The paths that a file names, from the crate's root. `module` is the file's own.
fn paths(code: &str, module: &[String]) -> BTreeSet<String> {
    let mut found = Vec::new();
    let mut rest = String::new();
    for statement in code.split_inclusive(';') {
        match statement.rfind("use ").filter(|at| {
            statement[..*at].trim_end().is_empty() || statement[..*at].ends_with(['\n', ' '])
        }) {
            Some(at) => {
                rest.push_str(&statement[..at]);
                spread("", statement[at + 4..].trim_end_matches(';').trim(), &mut found);
            }
            None => rest.push_str(statement),
        }
    }
    for root in ["crate::", "super::"] {
        for (at, _) in rest.match_indices(root) {
            found.push(
                rest[at..]
                    .chars()
                    .take_while(|letter| letter.is_ascii_alphanumeric() || "_:".contains(*letter))
                    .collect(),
            );
        }
    }
    let absolute = |path: &String| {
        let mut parts: Vec<&str> = path.split("::").filter(|part| !part.is_empty()).collect();
        let ups = parts.iter().take_while(|part| **part == "super").count();
        if ups > 0 {
            parts.drain(..ups);
            let above = module.get(..module.len().checked_sub(ups)?)?;
            return Some(
                above.iter().map(String::as_str).chain(parts).collect::<Vec<_>>().join("::"),
            );
        }
        (parts.first() == Some(&"crate")).then(|| parts[1..].join("::"))
    };
    found.iter().filter_map(absolute).collect()
}

#[test]
fn imports_are_spread() {
    let module = ["a", "b"].map(str::to_string);
    let code = "pub use super::{c, d::{E, f::G as H}};\nuse crate::i;\nfn j() { super::k::l(crate::m::N) }\n";
    let wanted = ["a::c", "a::d::E", "a::d::f::G", "i", "a::k::l", "m::N"].map(str::to_string);
    assert_eq!(paths(code, &module), BTreeSet::from(wanted));
}

/// What a front (`mod.rs`, or the file with the folder's name) hands on: `a::Name` -> `a::b::Name`.
fn handed_on(code: &str, module: &[String]) -> Vec<(String, String)> {
    let statements = code.split(';').filter_map(|statement| {
        let tree = statement.rsplit_once("pub use ")?.1;
        (!tree.contains("fn ")).then(|| tree.trim().to_string())
    });
    let here = module.join("::");
    let mut found = Vec::new();
    for tree in statements {
        spread("", &tree, &mut found);
    }
    let absolute = |path: &String| {
        let below = path.strip_prefix("self::").unwrap_or(path);
        let target = match path.strip_prefix("crate::") {
            Some(rest) => rest.to_string(),
            None if here.is_empty() => below.to_string(),
            None => format!("{here}::{below}"),
        };
        let name = target.rsplit("::").next()?.to_string();
        Some((if here.is_empty() { name } else { format!("{here}::{name}") }, target))
    };
    found.iter().filter_map(absolute).filter(|(name, target)| name != target).collect()
}

/// Files and folders that lie side by side may be read after those that they import, down to ones
/// that import none. A folder imports what its front and its files import from outside of it; what
/// a front hands on is an import of the file that holds it.
#[test]
fn files_and_folders_make_no_circle() {
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut hands_on: BTreeMap<String, String> = BTreeMap::new();
    for (_, path) in sources() {
        let inside = path.strip_prefix(root().join("src")).expect("below it").with_extension("");
        let mut parts: Vec<String> =
            inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        let front =
            path.with_extension("").is_dir() || parts.last().is_some_and(|last| last == "mod");
        parts.retain(|part| part != "mod");
        if front {
            hands_on.extend(handed_on(&code(&path), &parts));
        }
        uses.insert(parts.join("::"), paths(&code(&path), &parts));
    }
    assert!(uses.len() > 300, "the files were not found");
    let names: BTreeSet<String> = uses.keys().cloned().collect();
    let ends = |path: &str| {
        let ends = path.match_indices("::").map(|(at, _)| at).chain([path.len()]);
        ends.collect::<Vec<_>>().into_iter().rev()
    };
    // The file that holds what a path names; the path may go on to what the file holds.
    let holder = |path: &String| {
        let mut path = path.clone();
        for _ in 0..8 {
            let known = ends(&path).find_map(|end| Some((end, hands_on.get(&path[..end])?)));
            match known {
                Some((end, target)) => path = format!("{target}{}", &path[end..]),
                None => break,
            }
        }
        ends(&path).map(|end| &path[..end]).find(|path| names.contains(*path)).map(str::to_string)
    };
    // Where two paths part: the folder they share, and the two that lie in it.
    let mut beside: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (name, used) in
        uses.iter().flat_map(|(name, used)| used.iter().map(move |path| (name, path)))
    {
        let Some(used) = holder(used) else { continue };
        let (one, other): (Vec<&str>, Vec<&str>) =
            (name.split("::").collect(), used.split("::").collect());
        let shared = one.iter().zip(&other).take_while(|(one, other)| one == other).count();
        if let (Some(one), Some(other)) = (one.get(shared), other.get(shared)) {
            let folder = beside.entry(name.split("::").take(shared).collect::<Vec<_>>().join("::"));
            folder.or_default().entry((*one).into()).or_default().insert((*other).into());
        }
    }
    let circles: Vec<String> = beside
        .into_iter()
        .filter_map(|(folder, mut left)| {
            // Neither one that imports none of the others, nor one that none of them imports, is
            // part of a circle.
            let end = |left: &BTreeMap<String, BTreeSet<String>>| {
                let used: BTreeSet<&String> = left.values().flatten().collect();
                let ends = |(name, uses): &(&String, &BTreeSet<String>)| {
                    !used.contains(name) || uses.iter().all(|used| !left.contains_key(used))
                };
                left.iter().find(ends).map(|(name, _)| name.clone())
            };
            while let Some(name) = end(&left) {
                left.remove(&name);
            }
            let others: BTreeSet<String> = left.keys().cloned().collect();
            left.values_mut().for_each(|uses| uses.retain(|used| others.contains(used)));
            let folder = format!("src/{}", folder.replace("::", "/"));
            (!left.is_empty()).then(|| format!("{folder}: {left:?}"))
        })
        .collect();
    assert!(circles.is_empty(), "each of these imports another of them: {circles:#?}");
}

/// What can change an answer stands in one file, with its unit and reason.
#[test]
fn constants_of_the_diagnosis_stand_in_one_file() {
    let types = ["f64", "usize", "u64", "i32", "[f64", "(f64"];
    for (_, path) in sources()
        .into_iter()
        .filter(|(module, path)| module == "diagnose" && !path.ends_with("levels.rs"))
    {
        let number = |line: &&str| {
            let said = line
                .trim_start()
                .trim_start_matches("pub ")
                .strip_prefix("const ")
                .and_then(|rest| rest.split_once(": "));
            said.is_some_and(|(_, kind)| types.iter().any(|one| kind.starts_with(one)))
        };
        if let Some(line) = code(&path).lines().find(number) {
            panic!("{}: `{}` belongs into levels.rs", path.display(), line.trim());
        }
    }
}

const MODULES: &str = "| module | imports |";
const PARTS: &str = "| part | what it is | imports |";

fn compare(found: &BTreeMap<String, BTreeSet<String>>, header: &str) {
    let said: BTreeMap<String, BTreeSet<String>> = table(header).into_iter().collect();
    assert!(said.len() > 5, "the table was not found");
    assert_eq!(found.keys().collect::<Vec<_>>(), said.keys().collect::<Vec<_>>(), "modules");
    for (module, uses) in found {
        assert_eq!(uses, &said[module], "imports of `{module}` (found, then said)");
    }
}

/// What goes around `disk` cannot be made to fail by a test.
#[test]
fn files_are_reached_through_one_module() {
    let ways = [
        "std::fs",
        "fs::File",
        "File::open",
        "File::create",
        "OpenOptions",
        "tempfile::",
        ".is_file()",
        ".is_dir()",
        ".exists()",
    ];
    let more = [".canonicalize()", ".metadata()", "read_dir("];
    for (module, path) in sources() {
        if module == "disk" || path.ends_with("tests.rs") {
            continue;
        }
        let code = code(&path);
        // The files that take what a program says have no name, and were made by `disk`.
        let code = if path.ends_with("process.rs") {
            code.replace("use std::fs::File;", "").replace("file.metadata()", "")
        } else {
            code
        };
        // What a Parquet file says of itself has the same name as what the file system says of a
        // path.
        let parquet = path.iter().any(|part| part == "columnar")
            || ["record/layout.rs", "values/read.rs"].iter().any(|end| path.ends_with(end));
        let code = if parquet { code.replace(".metadata()", "") } else { code };
        // Options of the readers of HDF5 and MDF files.
        let code = if path.ends_with("v73.rs") || path.ends_with("mdf4.rs") {
            code.replace("OpenOptions", "")
        } else {
            code
        };
        for way in ways.iter().chain(&more) {
            let line = code.lines().find(|line| line.contains(way));
            assert!(line.is_none(), "{}: `{}`", path.display(), line.unwrap_or_default().trim());
        }
    }
}

#[test]
fn imports_go_one_way() {
    for header in [MODULES, PARTS] {
        let rows = table(header);
        let place = |name: &str| rows.iter().position(|(module, _)| module == name);
        for (module, uses) in &rows {
            for used in uses {
                assert!(
                    place(used) < place(module),
                    "`{module}` imports `{used}`, which stands below it"
                );
            }
        }
    }
}

/// Quantities, channels, zones and limits are words of protocols.
#[test]
fn rules_live_in_protocols() {
    let words = [
        "Y_qst",
        "Q_qst",
        "SigmaY",
        "ay_I",
        "ay_max",
        "ay_rms",
        "az_max",
        "wheelset",
        "bogies",
        "freight",
        "cant_deficiency",
        "static_wheel_load",
    ];
    for (module, path) in sources() {
        // The library lists the shipped protocols by name; keys and forms show examples of the
        // language to its users. The reference vehicle model is one vehicle, not a rule.
        if module == "model"
            || module == "library"
            || path.to_string_lossy().contains("syntax/keys")
            || path.ends_with("tests.rs")
        {
            continue;
        }
        let code = code(&path);
        for word in words {
            let place = code.lines().find(|line| line.contains(word));
            let shown = place.is_some_and(|line| {
                line.contains("after_help")
                    || line.contains("default:")
                    || line.contains("[default")
                    || line.contains("help")
            });
            assert!(
                place.is_none() || shown,
                "{}: `{word}` in `{}`",
                path.display(),
                place.unwrap_or_default().trim()
            );
        }
    }
}

/// What a result means is in its data: its printed text is shown, and not looked into.
#[test]
fn printed_texts_are_not_looked_into() {
    let words = code(&root().join("src/words/mod.rs"));
    assert!(words.contains("pub struct Text(String);"), "its letters are its own");
    let of_text = words.lines().filter(|line| line.starts_with("impl") && line.contains("Text"));
    assert_eq!(
        of_text.collect::<Vec<_>>(),
        ["impl fmt::Display for Text {", "impl From<Text> for String {"],
        "a text can be written, or handed on whole"
    );
    let looks = [
        ".contains(",
        ".starts_with(",
        ".ends_with(",
        ".strip_",
        ".split",
        ".rsplit",
        ".find(",
        ".rfind(",
        ".replace",
        ".parse",
        ".trim",
        ".chars(",
        ".lines(",
        ".as_bytes(",
        ".matches(",
    ];
    let of_results = [
        "certify",
        "cli",
        "compare",
        "deliver",
        "diagnose",
        "provenance",
        "report",
        "robustness",
        "run",
        "study",
        "values",
    ];
    for (_, path) in
        sources().into_iter().filter(|(module, _)| of_results.contains(&module.as_str()))
    {
        let code: String = code(&path).split_whitespace().collect();
        // The text of a place in an input is another one.
        let code = code.replace("span.text()", "");
        for call in [".text()", "words::text(", "or_nothing("] {
            for (at, _) in code.match_indices(call) {
                let mut rest = &code[at + call.len()..];
                if call.ends_with('(') {
                    rest = behind_bracket(rest);
                }
                loop {
                    let next = rest.trim_start_matches([')', '?']);
                    match next.strip_prefix(".to_string()") {
                        Some(next) => rest = next,
                        None if next.len() < rest.len() => rest = next,
                        None => break,
                    }
                }
                let look = looks.iter().find(|look| rest.starts_with(**look));
                let shown: String = code[at..].chars().take(80).collect();
                assert!(look.is_none(), "{}: `{shown}`", path.display());
            }
        }
    }
}

/// The code behind the bracket that closes an open one.
fn behind_bracket(code: &str) -> &str {
    let mut depth = 1;
    let closes = |letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth == 0
    };
    code.find(closes).map_or("", |at| &code[at + 1..])
}

/// With the same features of all crates, the program and its tests share one build of them.
#[test]
fn tests_and_program_share_one_build() {
    let tree = |edges: &str| {
        let arguments = [
            "tree",
            "--locked",
            "--offline",
            "-p",
            "fishplate",
            "-e",
            edges,
            "-f",
            "{p} {f}",
            "--prefix",
            "none",
        ];
        let ran = std::process::Command::new(env!("CARGO"))
            .args(arguments)
            .current_dir(root())
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&ran.stdout).into_owned();
        ran.status.success().then(|| {
            text.lines()
                .map(|line| line.trim_end_matches(" (*)").to_string())
                .collect::<BTreeSet<_>>()
        })
    };
    let (Some(program), Some(tests)) = (tree("normal,build"), tree("normal,build,dev")) else {
        eprintln!("skipped: `cargo tree` cannot be run here");
        return;
    };
    assert!(program.len() > 100, "the crates were not found");
    let other: Vec<&String> = program.difference(&tests).collect();
    assert!(
        other.is_empty(),
        "tests compile these with more features; ask for the same in Cargo.toml: {other:#?}"
    );
}
