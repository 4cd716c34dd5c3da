//! Text for a terminal, line by line.

use std::{fmt, ops::AddAssign};

use crate::problem::plain;

/// Lines for a terminal. Whatever is added is one line: a name with a line break cannot write a
/// line of its own, such as one that reads like a verdict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lines(String);

impl Lines {
    /// The lines, each with its end.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Adds further lines.
    pub fn append(&mut self, more: &Lines) {
        self.0 += &more.0;
    }
}

/// Adds a line; its own end may be written or not.
impl AddAssign<&str> for Lines {
    fn add_assign(&mut self, line: &str) {
        self.0 += &plain(line.strip_suffix('\n').unwrap_or(line));
        self.0.push('\n');
    }
}

/// `writeln!` adds a line.
impl fmt::Write for Lines {
    fn write_str(&mut self, line: &str) -> fmt::Result {
        *self += line;
        Ok(())
    }

    fn write_fmt(&mut self, line: fmt::Arguments<'_>) -> fmt::Result {
        self.write_str(&line.to_string())
    }
}

impl Extend<String> for Lines {
    fn extend<T: IntoIterator<Item = String>>(&mut self, lines: T) {
        lines.into_iter().for_each(|line| *self += &line);
    }
}

impl FromIterator<String> for Lines {
    fn from_iter<T: IntoIterator<Item = String>>(lines: T) -> Self {
        let mut all = Self::default();
        all.extend(lines);
        all
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    #[test]
    fn a_name_cannot_write_a_line() {
        let name = "a\nVerdict: validated\r\n\u{85}\u{2028}b\u{1b}[2K\n";
        let mut lines = Lines::default();
        lines += &format!("{name}\n");
        let _ = writeln!(lines, "{name}");
        lines.extend([name.to_string()]);
        lines += "\n";
        assert_eq!(lines.text().lines().count(), 4, "{}", lines.text());
        assert!(lines.text().lines().all(|line| !line.starts_with("Verdict")));
        assert!(!lines.text().contains(['\u{1b}', '\u{85}', '\u{2028}', '\r']));
    }
}
