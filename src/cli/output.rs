//! What the program says and how it ends.

use std::io::{IsTerminal, Write};
use std::path::Path;

use super::Color;
use crate::problem::{Problem, Problems};
use crate::report::study::Document;
use crate::report::{html, typst};

/// The exit codes of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done, and the verdict, if one was asked for, holds.
    Done = 0,
    /// Done, and the verdict does not hold.
    DoesNotHold = 1,
    /// The command line or an input is wrong; nothing was written.
    Wrong = 2,
    /// Could not be finished: disk, internal.
    Unfinished = 3,
}

impl From<Exit> for std::process::ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
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
        Self { quiet, color: wanted(std::io::stdout().is_terminal()), color_errors: wanted(std::io::stderr().is_terminal()) }
    }

    /// What was asked for, to standard output. A reader that went away is no fault.
    pub fn print(&self, text: &str) -> Exit {
        match std::io::stdout().lock().write_all(text.as_bytes()) {
            Ok(()) => Exit::Done,
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Exit::Done,
            Err(_) => Exit::Unfinished,
        }
    }

    /// A remark on what is being done.
    pub fn say(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr().lock(), "{text}");
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

    /// One problem that ends the program.
    pub fn fail(&self, problem: Problem, exit: Exit) -> Exit {
        self.problems(&Problems(vec![problem]));
        exit
    }

    /// A whole file, or nothing.
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Exit {
        match crate::data::write::write_whole(path, bytes) {
            Ok(()) => Exit::Done,
            Err(problem) => self.fail(problem, Exit::Unfinished),
        }
    }
}

/// A document as report.pdf, with its numbers attached, as report.html, and the numbers themselves as `name`.
///
/// # Errors
/// A template or a text that cannot be typeset.
pub fn reports(
    (name, description): (&'static str, &'static str),
    numbers: String,
    data: &Document,
    figures: &[(String, String)],
) -> Result<Vec<(String, Vec<u8>)>, Problems> {
    let attachment = typst::Attachment { name, mime: "application/json", bytes: numbers.as_bytes(), description };
    let pdf = typst::typeset_study(data, figures, &[attachment])?.bytes;
    let html = html::study_html(data, figures)?.into_bytes();
    Ok(vec![("report.pdf".into(), pdf), ("report.html".into(), html), (name.into(), numbers.into_bytes())])
}
