//! Reads the values of a mapping's keys, and reports what they cannot be.

use super::slips;
use crate::problem::{Problem, Problems};
use crate::source::{Span, Spanned};
use crate::units::{Unit, number};
use crate::yaml::{Key, Node, Value};

pub(super) fn at(problem: Problem, span: &Span) -> Problem {
    if problem.at.is_some() { problem } else { problem.at(span) }
}

pub(super) fn metre() -> Unit {
    Unit { text: "m".into(), factor: 1.0, dimension: crate::units::Dimension::LENGTH }
}

pub(super) fn second() -> Unit {
    Unit { text: "s".into(), factor: 1.0, dimension: crate::units::Dimension::TIME }
}

pub(super) fn hertz() -> Unit {
    Unit { text: "Hz".into(), factor: 1.0, dimension: crate::units::Dimension::FREQUENCY }
}

pub(super) struct Reader<'a> {
    pub problems: &'a mut Problems,
}

impl Reader<'_> {
    pub fn fault(&mut self, code: &'static str, says: impl Into<String>, span: &Span) {
        self.problems.push(Problem::error(code, says).at(span));
    }

    /// Whether the node is a map; unknown keys are reported.
    pub fn keys(&mut self, node: &Node, known: &[&str], what: &str) -> bool {
        self.keys_or(node, known, what, |_, _| None)
    }

    /// As [`Self::keys`], with what is to be said of keys that stand elsewhere.
    pub fn keys_or(
        &mut self,
        node: &Node,
        known: &[&str],
        what: &str,
        elsewhere: impl Fn(&Key, &Node) -> Option<String>,
    ) -> bool {
        if !matches!(node.value, Value::Map(_)) {
            self.fault(
                "wrong-kind",
                format!("{what} must be a map of keys and values, not {}", node.kind_in_words()),
                &node.span,
            );
            return false;
        }
        for (key, value) in node.entries() {
            if !known.contains(&key.text.as_str()) {
                let problem =
                    Problem::error("unknown-key", format!("{what} has no key `{}`", key.text))
                        .at(&key.span);
                self.problems.push(match elsewhere(key, value) {
                    Some(help) => problem.help(help),
                    None => problem.suggest(&key.text, known.iter().copied()),
                });
            }
        }
        true
    }

    pub fn text_of(&mut self, node: &Node, key: &str) -> Option<Spanned<String>> {
        match node.scalar_text().map(str::trim) {
            Some(text) if !text.is_empty() => {
                Some(Spanned::new(text.to_string(), node.span.clone()))
            }
            _ => {
                let problem = Problem::error(
                    "wrong-kind",
                    format!("`{key}` must be text, not {}", node.kind_in_words()),
                )
                .at(&node.span);
                // `{section}` alone is a map for YAML.
                let braces =
                    matches!(node.entries(), [(_, value)] if matches!(value.value, Value::Null));
                self.problems.push(if braces {
                    problem.help(slips::quoted(key, node.span.text()))
                } else {
                    problem
                });
                None
            }
        }
    }

    pub fn text(&mut self, node: &Node, key: &str) -> Option<Spanned<String>> {
        let found = node.get(key)?;
        self.text_of(found, key)
    }

    pub fn need_text(&mut self, node: &Node, key: &str, means: &str) -> Option<Spanned<String>> {
        if node.get(key).is_none() {
            let problem = Problem::error("key-missing", format!("`{key}` is missing: {means}"))
                .at(&node.span.part(0..0));
            self.problems.push(problem.help(format!("write `{key}: ...`")));
            return None;
        }
        self.text(node, key)
    }

    /// A text or a list of texts.
    pub fn texts(&mut self, node: &Node, key: &str) -> Vec<Spanned<String>> {
        let Some(found) = node.get(key) else { return Vec::new() };
        match &found.value {
            Value::List(items) => items.iter().filter_map(|item| self.text_of(item, key)).collect(),
            _ => self.text_of(found, key).into_iter().collect(),
        }
    }

    /// A number with its unit, in SI.
    pub fn number(&mut self, node: &Node, key: &str, unit: &Unit) -> Option<f64> {
        let found = node.get(key)?;
        self.number_of(found, key, unit)
    }

    pub fn number_of(&mut self, node: &Node, key: &str, unit: &Unit) -> Option<f64> {
        let written = self.text_of(node, key)?;
        match number::read(&written.value, unit) {
            Ok(read) if read.unit_stated || unit.dimension == Unit::one().dimension => {
                Some(read.si)
            }
            Ok(_) => {
                let problem = Problem::error(
                    "unit-missing",
                    format!("`{key}` has no unit; it is {}", unit.dimension.in_words()),
                );
                self.problems.push(
                    problem
                        .at(&written.span)
                        .help(format!("write `{} {unit}`, if that is meant", written.value)),
                );
                None
            }
            Err(refused) => {
                let problem = Problem::error("wrong-number", format!("`{key}`: {}", refused.says))
                    .at(&written.span);
                self.problems.push(match refused.help {
                    Some(help) => problem.help(help),
                    None => problem,
                });
                None
            }
        }
    }

    pub fn unit(&mut self, written: &Spanned<String>) -> Option<Unit> {
        Unit::parse(&written.value)
            .map_err(|unknown| {
                let problem = Problem::error(
                    "unknown-unit",
                    format!("`{}` is not a known unit", unknown.word),
                )
                .at(&written.span);
                self.problems.push(match unknown.near {
                    Some(near) => problem.help(format!("did you mean `{near}`?")),
                    None => problem,
                });
            })
            .ok()
    }
}

/// The names in braces of a text.
pub(super) fn placeholders(text: &str) -> Vec<&str> {
    text.split('{').skip(1).filter_map(|rest| rest.split_once('}').map(|(name, _)| name)).collect()
}
