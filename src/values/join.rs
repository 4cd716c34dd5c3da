//! Files of values of one campaign together: each section once, whatever the order and number of
//! the files.

use serde_json::Value;

use super::{File, Head, rows::into_sections};
use crate::certify::{Compiled, certification};
use crate::problem::{Problem, Problems, problem};
use crate::result::{Certification, FileHash};
use crate::run::{self, Evaluated, Kept, Numbered, SectionValues, Settings, Signals};

/// The values of a campaign, or of the sections of it that are there.
#[derive(Debug)]
pub struct Joined {
    pub compiled: Compiled,
    pub head: Head,
    sections: Vec<Numbered>,
    traces: Vec<Kept>,
}

/// Puts files together. A file that is given twice is told and left out.
///
/// Problems: `values-differ`, `values-twice`, `values-unreadable`, and those of the protocol.
pub fn join(files: Vec<File>, problems: &mut Problems) -> Option<Joined> {
    let mut files = files.into_iter();
    let first = files.next()?;
    let compiled = first.head.rules.compiled(problems)?;
    if problems.any_error() {
        return None;
    }
    if let Err(why) = first.head.basis.check(&compiled.plan) {
        problems.push(unreadable(&first.shown, &why));
        return None;
    }
    let head = first.head.clone();
    let mut known: Vec<(String, String)> = Vec::new();
    let mut owners: Vec<Option<usize>> = vec![None; head.basis.units().len()];
    let mut all: Vec<Numbered> = Vec::new();
    let mut traces = Vec::new();
    for mut file in std::iter::once(first).chain(files) {
        if let Some((_, shown)) = known.iter().find(|(hash, _)| *hash == file.hash) {
            problems.push(Problem::warning(
                "values-twice",
                format!("`{}` has the same values as `{shown}`, and is left out", file.shown),
            ));
            continue;
        }
        let shown = known.first().map(|(_, shown)| shown.clone());
        if let Some(problem) = shown.and_then(|shown| differs((&head, &shown), &file)) {
            problems.push(problem);
            continue;
        }
        if let Err(why) =
            into_sections(&compiled.plan, head.basis.units(), &file.table, &mut file.sections)
        {
            problems.push(unreadable(&file.shown, &why));
            continue;
        }
        known.push((file.hash, file.shown.clone()));
        traces.extend(file.traces);
        for (number, values) in file.sections {
            match owners[number] {
                None => {
                    owners[number] = Some(all.len());
                    all.push((number, values));
                }
                Some(other) if same(&all[other].1, &values) => {}
                Some(_) => {
                    let unit = &head.basis.units()[number];
                    let problem = problem!(
                        "values-differ",
                        "`{}` has other values of section {} than a file before it",
                        file.shown,
                        unit.name
                    );
                    problems.push(problem.help(
                        "a record was changed between two runs of `reduce`: make the values again",
                    ));
                }
            }
        }
    }
    (!problems.any_error()).then_some(Joined { compiled, head, sections: all, traces })
}

impl Joined {
    /// The same result as `certify` of the whole campaign.
    ///
    /// # Errors
    /// As [`run::run`].
    pub fn certification(self, settings: Settings) -> Result<Certification, Problems> {
        let Self { compiled, head, sections, traces } = self;
        let signals = Signals::Kept(&traces);
        let outcome = run::judge(
            &compiled.plan,
            &compiled.graph,
            (&head.basis, sections),
            (settings, &signals),
        )?;
        Ok(Certification { found: head.found, ..certification(&compiled, &head.about, outcome) })
    }

    /// The sections that are there, by number.
    pub fn sections(&self) -> &[Numbered] {
        &self.sections
    }

    /// The values as those of an evaluated campaign.
    ///
    /// # Errors
    /// As [`run::run`].
    pub fn evaluated(&self) -> Result<Evaluated, Problems> {
        run::evaluated(&self.compiled.plan, &self.head.basis, self.sections.clone())
    }
}

fn unreadable(shown: &str, why: &str) -> Problem {
    problem!("values-unreadable", "`{shown}` does not fit its protocol: {why}")
}

fn same(a: &SectionValues, b: &SectionValues) -> bool {
    fn marks(of: &SectionValues) -> impl Iterator<Item = &Vec<u32>> {
        of.prints.iter().map(|print| &print.marks)
    }
    a.rows == b.rows && alike(a, b) && marks(a).eq(marks(b))
}

/// Why a file is not of the same campaign and protocol as the first one.
fn differs((head, shown): (&Head, &str), file: &File) -> Option<Problem> {
    let (own, other) = (&file.head, &file.shown);
    let name =
        |head: &Head| head.rules.files.first().map_or_else(String::new, |(name, _)| name.clone());
    let says = if own.rules.files != head.rules.files {
        match (name(head), name(own)) {
            (a, b) if a == b => {
                format!("`{shown}` and `{other}` are of different texts of the protocol {a}")
            }
            (a, b) => format!("`{shown}` is of the protocol {a}, `{other}` of {b}"),
        }
    } else if own.rules.parameters != head.rules.parameters {
        let changed = head.rules.parameters.iter().zip(&own.rules.parameters).find(|(a, b)| a != b);
        changed.map_or_else(
            || format!("`{shown}` and `{other}` are of different parameters"),
            |(a, b)| {
                let set = |by: &crate::certify::Setting| format!("{} ({})", by.value, by.set_by);
                format!(
                    "the parameter `{}` is {} in `{shown}`, {} in `{other}`",
                    a.name,
                    set(a),
                    set(b)
                )
            },
        )
    } else if !head.about.names().eq(own.about.names()) {
        let names = |head: &Head| head.about.names().collect::<Vec<_>>().join(" + ");
        format!("`{shown}` is of the campaign {}, `{other}` of {}", names(head), names(own))
    } else if let Some(path) = changed_file(head, own) {
        format!("the campaign was changed between `{shown}` and `{other}`: {path} differs")
    } else if !(alike(&head.basis, &own.basis)
        && alike(&head.about, &own.about)
        && alike(&head.found, &own.found))
    {
        format!(
            "the records of the campaign were changed between `{shown}` and `{other}`: their sections or columns differ"
        )
    } else {
        return None;
    };
    let help =
        "all files must be of one campaign, protocol and set of parameters; make the values again";
    Some(Problem::error("values-differ", says).help(help))
}

/// Whether both are the same, wherever the campaign was: machines may see it under different paths.
fn alike<T: serde::Serialize>(a: &T, b: &T) -> bool {
    let json = |of: &T| serde_json::to_string(of).ok();
    let elsewhere = |of: &T| serde_json::to_value(of).ok().map(without_folders);
    json(a) == json(b) || elsewhere(a) == elsewhere(b)
}

/// Without the folders in the names of the sources of places, which are objects as
/// [`crate::source::Span`] is stored.
fn without_folders(mut of: Value) -> Value {
    match &mut of {
        Value::Array(all) => all.iter_mut().for_each(|each| *each = without_folders(each.take())),
        Value::Object(all) => {
            let is_place = all.contains_key("first_line");
            for (key, each) in all.iter_mut() {
                *each = match each {
                    Value::String(name) if is_place && key == "name" => Value::String(
                        name.rsplit(['/', '\\']).next().unwrap_or_default().to_string(),
                    ),
                    _ => without_folders(each.take()),
                };
            }
        }
        _ => {}
    }
    of
}

fn changed_file(head: &Head, own: &Head) -> Option<String> {
    let hash = |head: &Head, path: &str| {
        let file = head.about.files().find(|file: &&FileHash| file.path == path);
        file.map(|file| file.sha256.clone())
    };
    let all = head.about.files().chain(own.about.files());
    all.map(|file| file.path.clone()).find(|path| hash(head, path) != hash(own, path))
}
