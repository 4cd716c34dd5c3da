//! Terminal output and exit codes.

use std::{
    io::{IsTerminal, Write},
    path::Path,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Color;
use crate::data::write::{Outputs, write_whole};
use crate::deliver::Files;
use crate::disk::SetKind;
use crate::problem::{Problem, Problems, acts, plain};
use crate::run::Progress;
use crate::terminal::Lines;

/// Exit codes, as documented.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done; the verdict, if any, is positive.
    Done = 0,
    /// Done; the verdict is negative.
    DoesNotHold = 1,
    /// The command line or an input is wrong; nothing was written.
    Wrong = 2,
    /// Could not be completed: a disk error or an internal error.
    Unfinished = 3,
}

impl From<Exit> for std::process::ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a command ends early: the problems that are told at last, and its exit code.
#[derive(Debug)]
pub struct Ended {
    pub problems: Problems,
    pub exit: Exit,
}

/// How a command ends.
pub type Done = Result<Exit, Ended>;

impl Ended {
    /// What could not be completed, though the inputs are right.
    pub fn unfinished(problems: impl Into<Problems>) -> Self {
        Self { problems: problems.into(), exit: Exit::Unfinished }
    }

    /// Inputs that are wrong, or a file that could not be written.
    pub fn wrong_or_unwritten(problems: impl Into<Problems>) -> Self {
        let problems = problems.into();
        let failed = problems.0.iter().any(|problem| problem.code == "write-failed");
        Self { problems, exit: if failed { Exit::Unfinished } else { Exit::Wrong } }
    }
}

/// Inputs that are wrong.
impl<T: Into<Problems>> From<T> for Ended {
    fn from(problems: T) -> Self {
        Self { problems: problems.into(), exit: Exit::Wrong }
    }
}

#[derive(Debug)]
pub struct Console {
    pub quiet: bool,
    pub color: bool,
    color_errors: bool,
}

impl Console {
    pub fn new(quiet: bool, color: Color) -> Self {
        let wanted = |terminal: bool| match color {
            Color::Always => true,
            Color::Never => false,
            Color::Auto => terminal && std::env::var_os("NO_COLOR").is_none(),
        };
        Self {
            quiet,
            color: wanted(std::io::stdout().is_terminal()),
            color_errors: wanted(std::io::stderr().is_terminal()),
        }
    }

    /// Prints a result to standard output.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print(&self, lines: &Lines) -> Done {
        self.put(&painted(lines.text()))
    }

    /// Prints the text of a protocol at a stage. Control characters are made visible.
    ///
    /// # Errors
    /// As [`Self::print`].
    pub fn print_text(&self, text: &str) -> Done {
        self.put(&readable(text))
    }

    /// Prints the text of a file: unchanged if redirected, with visible control characters on a
    /// terminal.
    pub fn print_file(&self, text: &str) -> Done {
        if std::io::stdout().is_terminal() { self.put(&readable(text)) } else { self.put(text) }
    }

    /// Prints JSON with control characters escaped.
    pub fn print_json(&self, text: &str) -> Done {
        self.put(&escaped(text))
    }

    /// A closed pipe is not an error.
    fn put(&self, text: &str) -> Done {
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                let says = format!("standard output cannot be written: {error}");
                Err(Ended::unfinished(Problem::error("write-failed", says)))
            }
            _ => Ok(Exit::Done),
        }
    }

    /// Prints a progress message.
    pub fn say(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr().lock(), "{}", plain(text));
        }
    }

    /// Text in the colour of a positive or a negative result.
    pub fn paint(&self, text: String, holds: Option<bool>) -> String {
        match holds.filter(|_| self.color) {
            Some(holds) => format!("{}{text}{PLAIN}", if holds { GOOD } else { BAD }),
            None => text,
        }
    }

    pub fn problems(&self, problems: &Problems) {
        for problem in &problems.0 {
            if !self.quiet || problem.severity == crate::problem::Severity::Error {
                let _ = writeln!(std::io::stderr().lock(), "{}", problem.render(self.color_errors));
            }
        }
        let count = problems.errors();
        if count > 1 {
            let _ = writeln!(std::io::stderr().lock(), "{count} errors");
        }
    }

    /// Prints problems; an input that was read, unless one of them is an error.
    ///
    /// # Errors
    /// An input is wrong.
    pub fn sound<T>(&self, input: Option<T>, problems: &Problems) -> Result<T, Ended> {
        self.problems(problems);
        input.filter(|_| !problems.any_error()).ok_or(Problems::default().into())
    }

    /// Reads inputs and prints their problems, as [`Self::sound`] does.
    ///
    /// # Errors
    /// An input is wrong.
    pub fn read<T>(&self, read: impl FnOnce(&mut Problems) -> Option<T>) -> Result<T, Ended> {
        let mut problems = Problems::default();
        let input = read(&mut problems);
        self.sound(input, &problems)
    }

    /// Does work of so many steps beside a progress bar on a terminal; nothing is shown if the
    /// output is redirected.
    pub fn with_progress<T>(&self, steps: usize, work: impl FnOnce(Progress<'_>) -> T) -> T {
        let bar = self.bar(ProgressBar::new(steps as u64), "{bar:30} {pos}/{len} {msg}");
        let done = work(&|step| {
            bar.set_message(plain(step));
            bar.inc(1);
        });
        bar.finish_and_clear();
        done
    }

    /// A progress bar, which is not shown if quiet.
    pub fn bar(&self, bar: ProgressBar, template: &str) -> ProgressBar {
        if self.quiet {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        match ProgressStyle::with_template(template) {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    }

    /// Tells what was found, and where it was written.
    ///
    /// # Errors
    /// Standard output cannot be written. The files are there, and this is told too.
    pub fn written(&self, summary: &Lines, out: &Path) -> Done {
        if self.quiet {
            return Ok(Exit::Done);
        }
        let printed = self.print(summary);
        self.say(&format!("written: {}", out.display()));
        printed
    }

    /// Writes a report, all of its files or none, and tells what was found.
    ///
    /// # Errors
    /// A file could not be made or cannot be written.
    pub fn report(&self, files: Result<Files, Problems>, summary: &Lines, out: &Path) -> Done {
        self.write_all(SetKind::Report, out, &files.map_err(Ended::unfinished)?)?;
        self.written(summary, out)
    }

    /// Writes a set of files, all or none.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write_all(
        &self,
        kind: SetKind,
        folder: &Path,
        files: &[(String, Vec<u8>)],
    ) -> Result<(), Ended> {
        let mut outputs = Outputs::of(kind, folder);
        let added = files.iter().try_for_each(|(name, bytes)| outputs.add(name, bytes));
        self.commit(added.map(|()| outputs))
    }

    /// Completes [`Console::write_all`] for files that were added elsewhere.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn commit(&self, outputs: Result<Outputs, Problem>) -> Result<(), Ended> {
        let outputs = outputs.map_err(Ended::unfinished)?;
        self.problems(&Problems(outputs.mended().into_iter().collect()));
        outputs.commit().map_err(Ended::unfinished)
    }

    /// Writes a file completely or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Done {
        write_whole(path, bytes).map(|()| Exit::Done).map_err(Ended::unfinished)
    }
}

/// Marks of colours: noncharacters that Unicode reserves for internal use.
const GOOD: char = '\u{fdd0}';
const BAD: char = '\u{fdd1}';
const PLAIN: char = '\u{fdd2}';

fn painted(text: &str) -> String {
    text.replace(GOOD, "\u{1b}[32m").replace(BAD, "\u{1b}[31;1m").replace(PLAIN, "\u{1b}[0m")
}

/// The text of a file for a terminal; lines and tabs are kept.
fn readable(text: &str) -> String {
    text.chars()
        .map(|c| if acts(c) && !matches!(c, '\n' | '\t') { '\u{fffd}' } else { c })
        .collect()
}

/// JSON with control characters as `\uXXXX`; outside of strings it contains only line breaks.
fn escaped(json: &str) -> String {
    let escape = |c: char| {
        if acts(c) && c != '\n' { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() }
    };
    json.chars().map(escape).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_acts_reaches_a_terminal() {
        let nasty = "a\u{1b}[31mb\u{202e}c\u{9b}d\r\te\n";
        assert_eq!(readable(nasty), "a\u{fffd}[31mb\u{fffd}c\u{fffd}d\u{fffd}\te\n");
        let json = serde_json::to_string(nasty).expect("JSON");
        let text = escaped(&json);
        assert!(!text.chars().any(acts), "{text}");
        assert_eq!(serde_json::from_str::<String>(&text).expect("JSON"), nasty);
        let console = Console { quiet: false, color: true, color_errors: true };
        let mut lines = Lines::default();
        lines += &console.paint("x".into(), Some(true));
        assert_eq!(painted(lines.text()), "\u{1b}[32mx\u{1b}[0m\n");
    }
}
