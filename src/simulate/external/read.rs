//! Reads `sim.yaml`, which describes how an external simulator is called.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::words::{Hole, Word};
use crate::disk;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span};
use crate::units::{Dimension, Unit};
use crate::yaml::{self, Node, Value};

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

const KEYS: [&str; 13] = [
    "simulator",
    "title",
    "command",
    "python",
    "interpreter",
    "set",
    "speed unit",
    "timeout",
    "retries",
    "environment",
    "channels",
    "inputs",
    "tolerance",
];
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
    let mut reader = Reader { folder: &folder, problems };
    if !matches!(tree.value, Value::Map(_)) {
        reader.fault(
            "wrong-kind",
            format!("a simulator must be a map of keys and values, not {}", tree.kind_in_words()),
            &tree.span,
        );
        return None;
    }
    reader.keys(&tree);
    let name = reader.text(&tree, "simulator");
    if tree.get("simulator").is_none() {
        reader.fault("key-missing", "`simulator` is missing", &tree.span.part(0..0));
    }
    reader.one_way(&tree);
    let python = tree.get("python").and_then(|node| reader.python(node, tree.get("interpreter")));
    let command =
        tree.get("command").map(|node| reader.words(node, &Hole::OF_COMMAND)).unwrap_or_default();
    let set = tree.get("set").map(|node| reader.words(node, &Hole::OF_SET)).unwrap_or_default();
    let speed_unit = tree
        .get("speed unit")
        .and_then(|node| reader.unit(node, Dimension::LENGTH / Dimension::TIME));
    let timeout = tree.get("timeout").and_then(|node| reader.seconds(node));
    let retries =
        tree.get("retries").and_then(|node| reader.number(node, "retries", 0.0, MOST_RETRIES));
    let tolerance = tree.get("tolerance").and_then(|node| reader.share(node));
    let environment = reader.environment(&tree);
    let channels =
        tree.get("channels").map(|node| reader.texts(node, "channels")).unwrap_or_default();
    let inputs = tree.get("inputs").map(|node| reader.inputs(node)).unwrap_or_default();
    if let Some(node) = tree.get("command") {
        reader.command(node, &command, &set);
    }
    if problems.errors() > before {
        return None;
    }
    let name = name?;
    Some(Program {
        title: tree.get("title").and_then(Node::scalar_text).unwrap_or(&name).to_string(),
        name,
        source: Arc::clone(source),
        folder,
        launch: Vec::new(),
        command,
        python,
        set,
        speed_unit: speed_unit.or_else(|| Unit::parse("m/s").ok())?,
        timeout: timeout.unwrap_or(TIMEOUT),
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        retries: retries.unwrap_or(0.0) as u32,
        environment,
        channels,
        inputs,
        tolerance: tolerance.unwrap_or(TOLERANCE),
        span: tree
            .get("command")
            .or_else(|| tree.get("python"))
            .map_or_else(|| tree.span.clone(), |node| node.span.clone()),
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
    #[must_use]
    pub fn executable(&self) -> PathBuf {
        let word = self.command.first().and_then(Word::plain).unwrap_or_default();
        if word.contains(['/', '\\']) { self.folder.join(word) } else { PathBuf::from(word) }
    }
}

struct Reader<'a> {
    folder: &'a Path,
    problems: &'a mut Problems,
}

impl Reader<'_> {
    fn fault(&mut self, code: &'static str, says: impl Into<String>, at: &Span) {
        self.problems.push(Problem::error(code, says).at(at));
    }

    fn keys(&mut self, tree: &Node) {
        for (key, _) in tree.entries().iter().filter(|(key, _)| !KEYS.contains(&key.text.as_str()))
        {
            let problem =
                Problem::error("unknown-key", format!("a simulator has no key `{}`", key.text))
                    .at(&key.span);
            self.problems.push(problem.suggest(&key.text, KEYS));
        }
    }

    /// A command or a Python function, with the keys that belong to it.
    fn one_way(&mut self, tree: &Node) {
        let others = match (tree.get("command"), tree.get("python")) {
            (None, None) => {
                let problem =
                    Problem::error("key-missing", "`command` is missing").at(&tree.span.part(0..0));
                return self.problems.push(
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

    fn python(&mut self, node: &Node, interpreter: Option<&Node>) -> Option<Python> {
        let Some(text) = node.scalar_text().filter(|text| !text.trim().is_empty()) else {
            self.fault(
                "wrong-kind",
                format!("`python` must be the path of a file, not {}", node.kind_in_words()),
                &node.span,
            );
            return None;
        };
        let file = self.folder.join(text);
        if !disk::may_be_file(&file) {
            self.fault(
                "file-missing",
                format!("there is no file `{text}` in the folder of this file"),
                &node.span,
            );
        }
        let name = interpreter.map_or(Some(INTERPRETER), Node::scalar_text).unwrap_or_default();
        let span = interpreter.map_or(&node.span, |node| &node.span);
        self.program(name, span);
        let interpreter =
            if name.contains(['/', '\\']) { self.folder.join(name) } else { PathBuf::from(name) };
        Some(Python { interpreter, file })
    }

    fn text(&mut self, tree: &Node, key: &str) -> Option<String> {
        let node = tree.get(key)?;
        match node.scalar_text().map(str::trim).filter(|text| !text.is_empty()) {
            Some(text) => Some(text.to_string()),
            None => {
                let says = match node.scalar_text() {
                    Some(_) => format!("`{key}` is empty"),
                    None => format!("`{key}` must be text, not {}", node.kind_in_words()),
                };
                self.fault("wrong-kind", says, &node.span);
                None
            }
        }
    }

    fn texts(&mut self, node: &Node, key: &str) -> Vec<String> {
        let texts: Vec<String> =
            node.items().iter().filter_map(|item| Some(item.scalar_text()?.to_string())).collect();
        if texts.is_empty() || texts.len() != node.items().len() {
            self.fault("wrong-kind", format!("`{key}` must be a list of names"), &node.span);
        }
        texts
    }

    fn words(&mut self, node: &Node, allowed: &[Hole]) -> Vec<Word> {
        if node.items().is_empty() {
            let says = match node.value {
                Value::List(_) => "the list of words is empty".to_string(),
                _ => format!("expected a list of words, not {}", node.kind_in_words()),
            };
            let help =
                "the command is not split by a shell: write `[program, --option, \"{out}\"]`";
            self.problems.push(Problem::error("wrong-kind", says).at(&node.span).help(help));
        }
        node.items().iter().filter_map(|item| Word::read(item, allowed, self.problems)).collect()
    }

    fn unit(&mut self, node: &Node, dimension: Dimension) -> Option<Unit> {
        let text = node.scalar_text().unwrap_or_default();
        match Unit::parse(text) {
            Ok(unit) if unit.dimension == dimension => Some(unit),
            Ok(unit) => {
                self.fault(
                    "unit-mismatch",
                    format!("{unit} does not have the required dimension"),
                    &node.span,
                );
                None
            }
            Err(unknown) => {
                let problem = Problem::error(
                    "unknown-unit",
                    format!("`{}` is not a known unit", unknown.word),
                )
                .at(&node.span);
                self.problems.push(match unknown.near {
                    Some(near) => problem.meant(near),
                    None => problem,
                });
                None
            }
        }
    }

    /// A number with or without a unit; without one it is in SI units.
    fn quantity(&mut self, node: &Node, dimension: Dimension, example: &str) -> Option<f64> {
        let text = node.scalar_text().unwrap_or_default().trim();
        let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
        let (digits, written) = (&text[..end], text[end..].trim());
        let number: Option<f64> = digits.parse().ok();
        let unit = if written.is_empty() { None } else { Unit::parse(written).ok() };
        match (number, unit) {
            (Some(number), None) if written.is_empty() => Some(number),
            (Some(number), Some(unit)) if unit.dimension == dimension => Some(unit.to_si(number)),
            _ => {
                self.fault(
                    "wrong-kind",
                    format!("`{text}` is not valid here; expected a value such as `{example}`"),
                    &node.span,
                );
                None
            }
        }
    }

    fn seconds(&mut self, node: &Node) -> Option<Duration> {
        let seconds = self.quantity(node, Dimension::TIME, "90 s")?;
        if !(0.001..=1e6).contains(&seconds) {
            self.fault("range", "a time-out must be between 1 ms and 1000000 s", &node.span);
            return None;
        }
        Some(Duration::from_secs_f64(seconds))
    }

    fn share(&mut self, node: &Node) -> Option<f64> {
        let share = self.quantity(node, Dimension::ONE, "5 %")?;
        if !(0.0..=1.0).contains(&share) {
            self.fault("range", "a tolerance must be a share between 0 and 1", &node.span);
            return None;
        }
        Some(share)
    }

    fn number(&mut self, node: &Node, key: &str, low: f64, high: f64) -> Option<f64> {
        match node.number() {
            Some(number) if (low..=high).contains(&number) && number.fract() == 0.0 => Some(number),
            Some(_) => {
                self.fault(
                    "range",
                    format!("`{key}` must be a whole number from {low} to {high}"),
                    &node.span,
                );
                None
            }
            None => {
                self.fault(
                    "wrong-kind",
                    format!("`{key}` must be a number, not {}", node.kind_in_words()),
                    &node.span,
                );
                None
            }
        }
    }

    fn environment(&mut self, tree: &Node) -> Vec<(String, String)> {
        let Some(node) = tree.get("environment") else { return Vec::new() };
        if !matches!(node.value, Value::Map(_)) {
            self.fault(
                "wrong-kind",
                format!(
                    "`environment` must be a map of names and texts, not {}",
                    node.kind_in_words()
                ),
                &node.span,
            );
        }
        let mut found = Vec::new();
        for (key, value) in node.entries() {
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

    fn inputs(&mut self, node: &Node) -> Vec<PathBuf> {
        let texts = self.texts(node, "inputs");
        let paths: Vec<PathBuf> = texts.iter().map(|text| self.folder.join(text)).collect();
        for (text, _) in texts.iter().zip(&paths).filter(|(_, path)| !disk::may_be_file(path)) {
            self.fault(
                "file-missing",
                format!("there is no file `{text}` in the folder of this file"),
                &node.span,
            );
        }
        paths
    }

    /// Checks the command as a whole.
    fn command(&mut self, node: &Node, command: &[Word], set: &[Word]) {
        if command.len() != node.items().len() {
            return;
        }
        let Some((first, place)) = command.first().zip(node.items().first()) else { return };
        if !command.iter().any(|word| word.has(Hole::Out)) {
            let problem = Problem::error(
                "placeholder-missing",
                "the command does not contain the path of the record to be written",
            );
            self.problems.push(problem.at(&node.span).help("add a word with `{out}`"));
        }
        if !set.is_empty() && !command.iter().any(|word| word.is(Hole::Set)) {
            let problem = Problem::error(
                "placeholder-missing",
                "the command has no placeholder for the words of `set`",
            );
            self.problems.push(
                problem
                    .at(&node.span)
                    .help("add the word `{set}`, without other text in that word"),
            );
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
            if !disk::may_be_file(&self.folder.join(name)) {
                self.fault(
                    "no-such-program",
                    format!("there is no program `{name}` relative to the folder of this file"),
                    at,
                );
            }
        } else if !on_path(name) {
            let problem =
                Problem::error("no-such-program", format!("the system finds no program `{name}`"))
                    .at(at);
            self.problems.push(
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
