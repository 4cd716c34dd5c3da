//! Reads `sim.yaml`, which describes how an external simulator is called.

use std::{
    ops::RangeInclusive,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use super::words::{Hole, Word};
use crate::disk;
use crate::problem::{Problems, error};
use crate::source::{Source, Span, Spanned};
use crate::units::{Dimension, Unit, number};
use crate::yaml::{self, Entries, Key, Node, Reader, Value, fields};

/// An external simulator as described by its file.
#[derive(Clone, Debug)]
pub struct Program {
    /// Name under which catalogues list its parameters.
    pub name: String,
    pub title: String,
    pub source: Arc<Source>,
    /// Working folder: the folder of its file.
    pub folder: PathBuf,
    /// Words before each call, which start it on another machine; empty: it runs here.
    pub launch: Vec<String>,
    /// Empty for a Python function.
    pub command: Vec<Word>,
    /// The function that is called in place of a command.
    pub python: Option<Python>,
    /// Words that replace `{set}` for each parameter; empty: `name=value`.
    pub set: Vec<Word>,
    pub speed_unit: Unit,
    pub timeout: Duration,
    /// Number of retries of a failed call.
    pub retries: u32,
    pub environment: Vec<(String, String)>,
    /// Channels that its records must have; empty: those of the campaign's simulation.
    pub channels: Vec<String>,
    /// Further files on whose content the results depend.
    pub inputs: Vec<PathBuf>,
    /// Largest deviation from the campaign's simulation: rms of the difference / rms of the
    /// channel.
    pub tolerance: f64,
    /// The place of the command or of the function's file.
    pub span: Span,
}

/// Where and how a Python function runs.
#[derive(Clone, Debug)]
pub struct Python {
    pub interpreter: PathBuf,
    /// The file with the function.
    pub file: PathBuf,
}

fields! {
    /// `sim.yaml` as it is written.
    struct Written: "a simulator" {
        "simulator" name: Option<String> => "its name",
        "title" title: Option<String>,
        "command" command: Option<Node>,
        "python" python: Option<Spanned<String>>,
        "interpreter" interpreter: Option<Spanned<String>>,
        "set" set: Option<Node>,
        "speed unit" speed_unit: Option<Spanned<Unit>>,
        "timeout" timeout: Option<Spanned<String>>,
        "retries" retries: Option<Spanned<f64>>,
        "environment" environment: Entries<Node>,
        "channels" channels: Vec<String>,
        "inputs" inputs: Vec<Spanned<String>>,
        "tolerance" tolerance: Option<Spanned<String>>,
    }
}

/// Keys that a command has and a Python function has not, and the reverse.
const OF_COMMAND: [&str; 2] = ["set", "speed unit"];
const OF_PYTHON: [&str; 1] = ["interpreter"];
/// The interpreter of a Python function where none is named.
const INTERPRETER: &str = if cfg!(windows) { "python" } else { "python3" };
const TIMEOUT: Duration = Duration::from_secs(600);
const MOST_RETRIES: f64 = 10.0;
const TOLERANCE: f64 = 0.05;

/// Reads a description; `folder` is the folder of its file.
///
/// Problems: `unknown-key`, `key-missing`, `wrong-kind`, `range`, `unknown-unit`, `unit-mismatch`,
/// `unknown-placeholder`, `unclosed-brace`, `placeholder-missing`, `no-such-program`,
/// `file-missing`.
pub fn read_program(
    source: &Arc<Source>,
    folder: &Path,
    problems: &mut Problems,
) -> Option<Program> {
    let before = problems.errors();
    let tree = yaml::load(source, problems)?;
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
    let mut reader = Reader { with: folder.as_path(), problems };
    let written: Option<Written> = reader.file(&tree);
    reader.one_way(&tree);
    let written = written?;
    let python = written.python.as_ref();
    let python = python.map(|file| reader.python(file, written.interpreter.as_ref()));
    let command = reader.words(written.command.as_ref(), false);
    let set = reader.words(written.set.as_ref(), true);
    if let Some(unit) = &written.speed_unit
        && unit.value.dimension != Dimension::SPEED
    {
        let says = format!("{} does not have the required dimension", unit.value);
        reader.fault("unit-mismatch", says, &unit.span);
    }
    let timeout = written.timeout.as_ref().and_then(|written| {
        let range = "a time-out must be between 1 ms and 1000000 s";
        reader.number(written, ("s", "90 s"), (0.001..=1e6, range))
    });
    if let Some(retries) = &written.retries
        && !((0.0..=MOST_RETRIES).contains(&retries.value) && retries.value.fract() == 0.0)
    {
        let says = format!("`retries` must be a whole number from 0 to {MOST_RETRIES}");
        reader.fault("range", says, &retries.span);
    }
    let tolerance = written.tolerance.as_ref().and_then(|written| {
        let range = "a tolerance must be a share between 0 and 1";
        reader.number(written, ("-", "5 %"), (0.0..=1.0, range))
    });
    let environment = reader.environment(&written.environment.0);
    let inputs = written.inputs.iter().map(|file| reader.input(file)).collect();
    if let Some(node) = &written.command {
        reader.command(node, &command, &set);
    }
    if problems.errors() > before {
        return None;
    }
    let of_python = written.python.map(|file| file.span);
    Some(Program {
        title: written.title.or(written.name.clone())?,
        name: written.name?,
        source: Arc::clone(source),
        folder,
        launch: Vec::new(),
        command,
        python,
        set,
        speed_unit: written
            .speed_unit
            .map(|unit| unit.value)
            .or_else(|| Unit::parse("m/s").ok())?,
        timeout: timeout.map_or(TIMEOUT, Duration::from_secs_f64),
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        retries: written.retries.map_or(0, |retries| retries.value as u32),
        environment,
        channels: written.channels,
        inputs,
        tolerance: tolerance.unwrap_or(TOLERANCE),
        span: written.command.map(|node| node.span).or(of_python).unwrap_or(tree.span),
    })
}

impl Program {
    /// Why a call did not begin.
    pub(super) fn not_started(&self, error: &std::io::Error) -> String {
        match self.launch.as_slice() {
            [] => format!("could not be started: {error}"),
            launch => format!("could not be started by `{}`: {error}", launch.join(" ")),
        }
    }

    /// The file of the program if the command gives its path, else its name, which the system
    /// searches.
    pub fn executable(&self) -> PathBuf {
        executable(&self.folder, self.command.first().and_then(Word::plain).unwrap_or_default())
    }

    /// Whether the command has a placeholder.
    pub(super) fn asks(&self, hole: Hole) -> bool {
        self.command.iter().any(|word| word.has(hole))
    }
}

/// A program by its path from a folder, or by its name, which the system searches.
fn executable(folder: &Path, name: &str) -> PathBuf {
    if name.contains(['/', '\\']) { folder.join(name) } else { PathBuf::from(name) }
}

impl Reader<'_, &Path> {
    /// A command or a Python function, with the keys that belong to it.
    fn one_way(&mut self, tree: &Node) {
        let others = match (tree.get("command"), tree.get("python")) {
            (None, None) if !matches!(tree.value, Value::Map(_)) => return,
            (None, None) => {
                let problem = error("key-missing", "`command` is missing", &tree.span.part(0..0));
                return self.tell(
                    problem.help("a simulator is a `command`, or a function in a `python` file"),
                );
            }
            (Some(_), Some(both)) => {
                let says = "a simulator is either a `command` or a `python` function, not both";
                return self.fault("contradiction", says, &both.span);
            }
            (Some(_), None) => &OF_PYTHON[..],
            (None, Some(_)) => &OF_COMMAND[..],
        };
        for (key, _) in tree.entries().iter().filter(|(key, _)| others.contains(&key.text.as_str()))
        {
            let with = if others == OF_PYTHON { "python" } else { "command" };
            self.fault(
                "contradiction",
                format!("`{}` belongs to a `{with}`, which is not given", key.text),
                &key.span,
            );
        }
    }

    fn python(&mut self, file: &Spanned<String>, interpreter: Option<&Spanned<String>>) -> Python {
        let file_path = self.input(file);
        let (name, span) = interpreter
            .map_or((INTERPRETER, &file.span), |named| (named.value.as_str(), &named.span));
        self.program(name, span);
        Python { interpreter: executable(self.with, name), file: file_path }
    }

    fn words(&mut self, node: Option<&Node>, of_set: bool) -> Vec<Word> {
        let Some(node) = node else { return Vec::new() };
        if node.items().is_empty() {
            let says = match node.value {
                Value::List(_) => "the list of words is empty".to_string(),
                _ => format!("expected a list of words, not {}", node.kind_in_words()),
            };
            let help =
                "the command is not split by a shell: write `[program, --option, \"{out}\"]`";
            self.tell(error("wrong-kind", says, &node.span).help(help));
        }
        node.items().iter().filter_map(|item| Word::read(item, of_set, self.problems)).collect()
    }

    /// A number in a range, in SI with or without a unit.
    fn number(
        &mut self,
        written: &Spanned<String>,
        (unit, example): (&str, &str),
        (range, says): (RangeInclusive<f64>, &str),
    ) -> Option<f64> {
        let text = &written.value;
        let Ok(read) = number::read(text, &Unit::parse(unit).ok()?) else {
            let says = format!("`{text}` is not valid here; expected a value such as `{example}`");
            self.fault("wrong-kind", says, &written.span);
            return None;
        };
        if !range.contains(&read.si) {
            self.fault("range", says, &written.span);
        }
        Some(read.si)
    }

    fn environment(&mut self, entries: &[(Key, Node)]) -> Vec<(String, String)> {
        let mut found = Vec::new();
        for (key, value) in entries {
            match value.scalar_text().filter(|text| !text.contains('\0')) {
                Some(text) if !key.text.is_empty() && !key.text.contains(['=', '\0']) => {
                    found.push((key.text.clone(), text.to_string()))
                }
                _ => self.fault(
                    "wrong-kind",
                    "a variable must have a name without `=`, and a text",
                    &key.span,
                ),
            }
        }
        found
    }

    /// The path of a file, which must be there.
    fn input(&mut self, file: &Spanned<String>) -> PathBuf {
        let path = self.with.join(&file.value);
        if !disk::may_be_file(&path) {
            let says = format!("there is no file `{}` in the folder of this file", file.value);
            self.fault("file-missing", says, &file.span);
        }
        path
    }

    /// Checks the command as a whole.
    fn command(&mut self, node: &Node, command: &[Word], set: &[Word]) {
        if command.len() != node.items().len() {
            return;
        }
        let Some((first, place)) = command.first().zip(node.items().first()) else { return };
        let mut missing = |says: &str, help: &str| {
            self.tell(error("placeholder-missing", says, &node.span).help(help));
        };
        if !command.iter().any(|word| word.has(Hole::Out)) {
            let says = "the command does not contain the path of the record to be written";
            missing(says, "add a word with `{out}`");
        }
        if !set.is_empty() && !command.iter().any(|word| word.is(Hole::Set)) {
            let says = "the command has no placeholder for the words of `set`";
            missing(says, "add the word `{set}`, without other text in that word");
        }
        let Some(name) = first.plain() else {
            return self.fault(
                "wrong-kind",
                "the first word must be the program, without placeholders",
                &place.span,
            );
        };
        self.program(name, &place.span);
    }

    /// Checks that a program is there, or that the system finds it.
    fn program(&mut self, name: &str, at: &Span) {
        if name.contains(['/', '\\']) {
            if !disk::may_be_file(&self.with.join(name)) {
                self.fault(
                    "no-such-program",
                    format!("there is no program `{name}` relative to the folder of this file"),
                    at,
                );
            }
        } else if !on_path(name) {
            let problem =
                error("no-such-program", format!("the system finds no program `{name}`"), at);
            self.tell(
                problem.help(format!("write `./{name}` for a program in the folder of this file")),
            );
        }
    }
}

fn on_path(name: &str) -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let endings: &[&str] = if cfg!(windows) { &["", ".exe", ".bat", ".cmd"] } else { &[""] };
    std::env::split_paths(&folders).any(|folder| {
        endings.iter().any(|ending| disk::may_be_file(&folder.join(format!("{name}{ending}"))))
    })
}
