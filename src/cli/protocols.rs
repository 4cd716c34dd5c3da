//! Subcommands for protocol texts.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    output::{Console, Done, Exit},
    places::{check_file, check_out},
};
use crate::check::{self, Overrides};
use crate::disk::SetKind;
use crate::library;
pub use crate::prepare::load;
use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::syntax;
use crate::terminal::Lines;

pub fn check(names: &[String], console: &Console) -> Done {
    let mut exit = Exit::Done;
    for name in names {
        let mut problems = Problems::default();
        let plan = load(name, &mut problems)
            .and_then(|family| check::check(&family, &Overrides::new(), &mut problems));
        console.problems(&problems);
        match plan {
            Some(plan) if plan.quantities.is_empty() => console.say(&format!(
                "{name}: {} for protocols that use it: no errors",
                counted(plan.plausibility.len(), "plausibility rule", "plausibility rules")
            )),
            Some(plan) => console.say(&format!(
                "{name}: {}, {}, {}: no errors",
                counted(plan.quantities.len(), "quantity", "quantities"),
                counted(
                    plan.quantities.iter().map(|quantity| quantity.limits_written()).sum(),
                    "limit",
                    "limits"
                ),
                counted(plan.zones.len(), "zone", "zones")
            )),
            None => exit = Exit::Wrong,
        }
    }
    Ok(exit)
}

fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// Writes nothing before all texts have been read.
pub fn fmt(paths: &[PathBuf], only_check: bool, console: &Console) -> Done {
    let mut exit = Exit::Done;
    let mut changed = Vec::new();
    for path in paths {
        let source = match library::read(path) {
            Ok(source) => source,
            Err(problem) => {
                console.problems(&problem.into());
                exit = Exit::Wrong;
                continue;
            }
        };
        let mut problems = Problems::default();
        let text = canonical(&source, &mut problems, syntax::is_yaml(&source.name));
        // A text with errors is not rewritten, since its unreadable parts would be lost.
        if problems.any_error() {
            console.problems(&problems);
            exit = Exit::Wrong;
            continue;
        }
        if text == source.text {
            continue;
        }
        if only_check {
            console.say(&format!("{}: not in canonical form", path.display()));
            if exit == Exit::Done {
                exit = Exit::DoesNotHold;
            }
        } else {
            changed.push((path, text));
        }
    }
    if exit != Exit::Wrong {
        for (path, text) in changed {
            console.write(path, text.as_bytes())?;
        }
    }
    Ok(exit)
}

fn canonical(source: &Arc<Source>, problems: &mut Problems, yaml: bool) -> String {
    let document = syntax::read(source, problems);
    if yaml { syntax::print_yaml(&document) } else { syntax::print_text(&document) }
}

pub fn convert(name: &str, yaml: bool, output: Option<&Path>, console: &Console) -> Done {
    output.map_or(Ok(()), |output| check_file(output, &[Path::new(name)]))?;
    let source = library::find(name, None)?;
    let mut problems = Problems::default();
    let text = canonical(&source, &mut problems, yaml);
    let text = console.sound(Some(text), &problems)?;
    match output {
        Some(path) => console.write(path, text.as_bytes()),
        None => console.print_file(&text),
    }
}

pub fn diff(before: &str, after: &str, console: &Console) -> Done {
    let mut problems = Problems::default();
    let (before, after) = (load(before, &mut problems), load(after, &mut problems));
    let (before, after) = console.sound(before.zip(after), &problems)?;
    let found = check::diff::diff(&before.merged, &after.merged);
    if found.is_empty() {
        return console.print_file("no rule differs\n");
    }
    let mut text = Lines::default();
    for deviation in found {
        text += &format!("{}\n", deviation.rule);
        if let Some(before) = deviation.before {
            text += &format!("  - {before}\n");
        }
        if let Some(after) = deviation.after {
            text += &format!("  + {after}\n");
        }
    }
    console.print(&text)
}

pub fn list(name: Option<&str>, console: &Console) -> Done {
    match name {
        Some(name) => match library::shipped(name) {
            Some(source) => console.print_file(&source.text),
            None => {
                let problem = Problem::error(
                    "no-such-protocol",
                    format!("no shipped protocol is called `{name}`"),
                );
                Err(problem.suggest(name, library::names()).into())
            }
        },
        None => {
            let width =
                library::SHIPPED.iter().map(|shipped| shipped.name.len()).max().unwrap_or(0);
            let text: Lines = library::SHIPPED
                .iter()
                .map(|shipped| {
                    let source = Source::new(shipped.name, shipped.text);
                    let document = syntax::read_text(&source, &mut Problems::default());
                    let title = document
                        .blocks
                        .iter()
                        .find(|block| block.kind.text == "protocol")
                        .and_then(|block| block.title.clone());
                    format!(
                        "{:width$}  {}\n",
                        shipped.name,
                        title.map_or(String::new(), |title| title.text)
                    )
                })
                .collect();
            console.print(&text)
        }
    }
}

/// One page for the program and one for each subcommand.
pub fn man(out: &Path, console: &Console) -> Done {
    check_out(out)?;
    let command = <super::Arguments as clap::CommandFactory>::command();
    let mut pages = vec![("fishplate.1".to_string(), clap_mangen::Man::new(command.clone()))];
    for sub in command.get_subcommands() {
        let name = format!("fishplate-{}", sub.get_name());
        // clap_mangen uses the command's name as the title, which must be static.
        let named = sub.clone().name(String::leak(name.clone()) as &'static str);
        pages.push((format!("{name}.1"), clap_mangen::Man::new(named)));
    }
    let mut files = Vec::new();
    for (name, page) in pages {
        let mut bytes = Vec::new();
        if page.render(&mut bytes).is_err() {
            return Ok(Exit::Unfinished);
        }
        files.push((name, bytes));
    }
    console.write_all(SetKind::Manual, out, &files).map(|()| Exit::Done)
}
