//! The parts of the documentation that are made from the program's own tables.

use std::collections::BTreeMap;
use std::path::Path;

use clap::CommandFactory;
use fishplate::catalog::{self, STEPS};
use fishplate::cli::Arguments;
use fishplate::effects::{Acts, Effect, Parameter};
use fishplate::library::{CATALOGUES, SHIPPED, parent_catalogue};
use fishplate::metrics::percentile::Method;
use fishplate::problem::Problems;
use fishplate::simulate::model_parameters;
use fishplate::source::Source;
use fishplate::syntax::keys::{KINDS, Kind, Sort};
use fishplate::syntax::read_text;
use fishplate::units::{Dimension, SYMBOLS};
use fishplate::yaml::Words;
use serde_json::Value;

/// The part of a name such as `block quantity` or `registry step`.
pub fn part(name: &str) -> String {
    match name.split_once(' ').unwrap_or((name, "")) {
        ("block", word) => block(
            KINDS
                .iter()
                .find(|kind| part_of(kind) == word)
                .unwrap_or_else(|| panic!("no block `{word}`")),
        ),
        ("blocks", "") => blocks(),
        ("registry", "step") => steps(),
        ("registry", kind) => registry(kind),
        ("units", "") => units(),
        ("percentile", "rules") => percentile_rules(),
        ("protocols", "") => protocols(),
        ("commands", "") => commands(),
        ("results.json", "") => results(),
        ("platforms", "") => platforms(),
        ("effects", acts) => effects(acts),
        _ => panic!("nothing is generated as `{name}`"),
    }
}

/// Parts that some page must have, so that nothing new in the tables stays undescribed.
pub fn wanted() -> Vec<String> {
    let mut all: Vec<String> =
        KINDS.iter().map(|kind| format!("block {}", part_of(kind))).collect();
    for entry in catalog::entries() {
        let name = format!("registry {}", entry.kind);
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all.extend(
        [
            "blocks",
            "units",
            "percentile rules",
            "platforms",
            "protocols",
            "commands",
            "results.json",
        ]
        .map(str::to_string),
    );
    all.extend(Acts::WORDS.iter().map(|(word, _)| format!("effects {word}")));
    all
}

/// Where the sources have code for single systems.
fn platforms() -> String {
    let mut found: BTreeMap<(String, String), usize> = BTreeMap::new();
    for (path, text) in crate::layering::texts() {
        let conditions = text.lines().filter_map(|line| {
            let condition = line.trim().strip_prefix("#[cfg(")?.strip_suffix(")]")?;
            let system = ["unix", "windows", "target_os", "target_family"];
            system.iter().any(|word| condition.contains(word)).then_some(condition)
        });
        for condition in conditions {
            *found.entry((path.clone(), condition.to_owned())).or_default() += 1;
        }
    }
    let row = |((path, condition), count): (&(String, String), &usize)| {
        format!("| `{path}` | `{condition}` | {count} |\n")
    };
    let rows: String = found.iter().map(row).collect();
    format!("| file | compiled for | places |\n|---|---|---|\n{rows}")
}

/// A block is called by its word; the second kind of a word by what it is in YAML.
fn part_of(kind: &Kind) -> &'static str {
    let first = KINDS
        .iter()
        .find(|known| known.word == kind.word)
        .is_some_and(|known| known.group == kind.group);
    if first { kind.word } else { kind.group }
}

fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| {
        format!(
            "| {} |\n",
            cells.iter().map(|cell| cell.replace('|', "\\|")).collect::<Vec<_>>().join(" | ")
        )
    };
    let header: Vec<String> = header.iter().map(|cell| (*cell).to_string()).collect();
    let rule = format!("|{}\n", "---|".repeat(header.len()));
    let rows: String = rows.into_iter().map(|row| line(&row)).collect();
    format!("\n{}{rule}{rows}\n", line(&header))
}

fn code(text: &str) -> String {
    format!("`{text}`")
}

fn blocks() -> String {
    let head = |kind: &Kind| {
        if kind.named { format!("{} *name*", code(kind.word)) } else { code(kind.word) }
    };
    let count = |kind: &Kind| if kind.single { "one" } else { "any number" }.to_string();
    table(
        &["block", "in YAML", "how many", "what it is"],
        KINDS.iter().map(|kind| vec![head(kind), code(kind.group), count(kind), kind.about.into()]),
    )
}

fn block(kind: &Kind) -> String {
    let rows = kind.keys.iter().map(|key| {
        let example = if key.sort == Sort::Text {
            format!("{} \"{}\"", key.word, key.example)
        } else {
            format!("{} {}", key.word, key.example)
        };
        let about = if key.many {
            format!("{} May be repeated.", key.about)
        } else {
            key.about.to_string()
        };
        vec![code(key.word), about, code(&example)]
    });
    format!("\n{}\n{}", kind.about, table(&["field", "what it says", "for example"], rows))
}

fn steps() -> String {
    let rows = STEPS.iter().map(|entry| {
        let numbers = entry.form.numbers.iter().map(|option| {
            let unless = option
                .default
                .map_or_else(String::new, |default| format!(" (unless said: {default})"));
            format!("{}{unless}", code(&format!("{} …", option.name)))
        });
        let choices = entry.form.choices.iter().map(|choice| {
            choice.words.iter().map(|word| code(word)).collect::<Vec<_>>().join(" or ")
        });
        vec![
            code(&entry.form.in_words()),
            entry.about.to_string(),
            numbers.chain(choices).collect::<Vec<_>>().join("; "),
        ]
    });
    let mut seen = Vec::new();
    let mut notes = String::new();
    for choice in STEPS.iter().flat_map(|entry| entry.form.choices) {
        if !seen.contains(&choice.words) {
            seen.push(choice.words);
            notes += &format!(
                "- {}: {}\n",
                choice.words.iter().map(|word| code(word)).collect::<Vec<_>>().join(", "),
                choice.about
            );
        }
    }
    format!(
        "{}The first word of an option is what holds unless another is said:\n\n{notes}\n",
        table(&["step", "what it does", "options"], rows)
    )
}

fn registry(kind: &str) -> String {
    let entries: Vec<_> =
        catalog::entries().into_iter().filter(|entry| entry.kind == kind).collect();
    assert!(!entries.is_empty(), "nothing in the registry is a {kind}");
    let sourced = entries.iter().any(|entry| entry.source.is_some());
    let directed = entries.iter().any(|entry| entry.best.is_some());
    let rows = entries.iter().map(|entry| {
        let options: String =
            entry.options.iter().map(|option| format!(" Option: {option}.")).collect();
        let mut row =
            vec![code(&entry.wording), code(entry.signature), format!("{}{options}", entry.about)];
        if directed {
            row.push(entry.best.clone().unwrap_or_else(|| "that of its values".into()));
        }
        if sourced {
            row.push(entry.source.unwrap_or_default().to_string());
        }
        row
    });
    let mut header = vec![kind, "takes and gives", "what it is"];
    header.extend(directed.then_some("best value"));
    header.extend(sourced.then_some("source"));
    table(&header, rows)
}

/// Units that measure the same in one row.
fn units() -> String {
    let mut dimensions: Vec<Dimension> = Vec::new();
    for symbol in SYMBOLS.iter() {
        if !dimensions.contains(&symbol.dimension) {
            dimensions.push(symbol.dimension);
        }
    }
    let rows = dimensions.into_iter().map(|dimension| {
        let of = SYMBOLS.iter().filter(|symbol| symbol.dimension == dimension);
        let symbols: Vec<String> =
            of.map(|symbol| format!("{} {}", code(symbol.symbol), symbol.name)).collect();
        vec![dimension.in_words(), dimension.to_string(), symbols.join(", ")]
    });
    table(&["measures", "in SI base units", "symbols"], rows)
}

fn percentile_rules() -> String {
    let names: Vec<String> = Method::NAMES.iter().map(|(_, name)| code(name)).collect();
    format!("\n{}\n\n", names.join(", "))
}

fn protocols() -> String {
    let rows = SHIPPED.iter().map(|shipped| {
        let document =
            read_text(&Source::new(shipped.name, shipped.text), &mut Problems::default());
        let head = document
            .blocks
            .iter()
            .find(|block| block.kind.text == "protocol")
            .expect("a protocol says what it is");
        let title = head.title.as_ref().map_or(String::new(), |title| title.text.clone());
        vec![format!("[`{0}`](protocols/{0}.fp)", shipped.name), title]
    });
    table(&["name", "what it is"], rows)
}

/// The effects of the first shipped catalogue that act on something.
fn effects(acts: &str) -> String {
    let shipped = &CATALOGUES[0];
    let source = Source::new(shipped.name, shipped.text);
    let catalogue = fishplate::effects::read(
        &source,
        &parent_catalogue,
        &model_parameters(),
        &mut Problems::default(),
    );
    let parameter = |one: &Parameter| {
        format!("{} {} to {}{}", code(&one.name), one.low, one.high, one.unit.suffix())
    };
    let row = |effect: &Effect| {
        let parameters: Vec<String> = effect.parameters.iter().map(parameter).collect();
        vec![
            code(&effect.name),
            format!("{}: {}", effect.title, effect.means),
            parameters.join(", "),
        ]
    };
    let found = catalogue.expect("right").effects;
    table(
        &["effect", "what it is", "parameters"],
        found.iter().filter(|effect| effect.acts.word() == acts).map(row),
    )
}

fn commands() -> String {
    let mut command = Arguments::command();
    command.build();
    let rows = command.get_subcommands().filter(|sub| sub.get_name() != "help").map(|sub| {
        let about = sub.get_about().map_or(String::new(), ToString::to_string);
        let arguments: Vec<String> = sub
            .get_positionals()
            .map(|argument| {
                let name = argument
                    .get_value_names()
                    .and_then(|names| names.first())
                    .map_or_else(|| argument.get_id().to_string(), ToString::to_string);
                let name = if argument.is_required_set() { name } else { format!("[{name}]") };
                let many = argument.get_num_args().is_some_and(|range| range.max_values() > 1);
                if many { format!("{name}…") } else { name }
            })
            .collect();
        let options = sub.get_opts().filter(|option| option.is_required_set()).map(|option| {
            let name = option
                .get_value_names()
                .and_then(|names| names.first())
                .map_or_else(String::new, ToString::to_string);
            format!("--{} {name}", option.get_long().unwrap_or_default())
        });
        let words: Vec<String> =
            std::iter::once(sub.get_name().to_string()).chain(arguments).chain(options).collect();
        vec![code(&words.join(" ")), about]
    });
    table(&["command", "does"], rows)
}

/// Keys of the result of a real run, nested as they are, each with what stands there first.
fn results() -> String {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let (campaign, out) = (temp.path().join("coach"), temp.path().join("out"));
    copy(&super::page::root().join("examples/coach"), &campaign);
    // A number without a unit is a finding.
    let vehicle = std::fs::read_to_string(campaign.join("vehicle.yaml")).expect("a vehicle");
    let bare = vehicle.replace("static_wheel_load: 54.546 kN", "static_wheel_load: 54.546");
    assert_ne!(bare, vehicle);
    std::fs::write(campaign.join("vehicle.yaml"), bare).expect("written");
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .arg("certify")
        .arg(&campaign)
        .args(["--only", "results", "--quiet", "--set", "sections_per_zone=3", "--out"])
        .arg(&out)
        .status()
        .expect("the program runs");
    assert_eq!(status.code(), Some(1));
    format!("\n```text\n{}```\n\n", outline(&out.join("results.json")))
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let place = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy(&path, &place);
        } else {
            std::fs::copy(&path, &place).expect("a copy");
        }
    }
}

fn outline(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("a result");
    let value: Value = serde_json::from_str(&text).expect("JSON");
    let mut out = String::new();
    keys(&value, 0, &mut out);
    out
}

fn keys(value: &Value, depth: usize, out: &mut String) {
    let Value::Object(entries) = value else { return };
    for (key, value) in entries {
        let (what, inner) = match value {
            Value::Array(items) => ("list of", items.first()),
            value => ("", Some(value)),
        };
        let sort = match inner {
            None => "",
            Some(Value::Null) => "null",
            Some(Value::Bool(_)) => "true or false",
            Some(Value::Number(_)) => "number",
            Some(Value::String(_)) => "text",
            Some(Value::Array(_)) => "lists",
            Some(Value::Object(_)) => "keys",
        };
        let sort = if sort == "keys" { String::new() } else { sort.to_string() };
        let says = format!("{what} {sort}").trim().to_string();
        let says = if says.is_empty() {
            String::new()
        } else {
            format!(": {}", says.trim_end_matches(" of"))
        };
        out.push_str(&format!("{}{key}{says}\n", "  ".repeat(depth)));
        if let Some(inner @ Value::Object(_)) = inner {
            keys(inner, depth + 1, out);
        }
    }
}
