//! The words of a command: text with placeholders in braces.

use crate::problem::{Problems, error};
use crate::yaml::{Node, Words};

/// A placeholder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hole {
    /// Path of the vehicle file.
    Vehicle,
    /// Path of the section's track file.
    Track,
    /// Speed in the program's unit.
    Speed,
    /// Path of the record to be written.
    Out,
    /// Name of the section.
    Section,
    /// Start and end of the evaluated section on the axis of the record.
    Start,
    End,
    /// Words repeated for each parameter.
    Set,
    /// Name and value of a parameter, in the repeated words.
    Name,
    Value,
}

impl Words for Hole {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("vehicle", Self::Vehicle),
        ("track", Self::Track),
        ("speed", Self::Speed),
        ("out", Self::Out),
        ("section", Self::Section),
        ("start", Self::Start),
        ("end", Self::End),
        ("set", Self::Set),
        ("name", Self::Name),
        ("value", Self::Value),
    ];
}

impl Hole {
    /// Whether it may stand in the words repeated for each parameter; others stand in a command.
    pub fn is_of_set(self) -> bool {
        matches!(self, Self::Name | Self::Value)
    }
}

/// A part of a word.
#[derive(Clone, Debug, PartialEq)]
enum WordPart {
    Text(String),
    Hole(Hole),
}

/// One word of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    parts: Vec<WordPart>,
}

impl Word {
    /// Reads a word; `{{` and `}}` are literal braces.
    /// `of_set`: one that is repeated for each parameter.
    ///
    /// Problems: `unknown-placeholder` with the nearest, `unclosed-brace`, `wrong-kind`.
    pub fn read(node: &Node, of_set: bool, problems: &mut Problems) -> Option<Self> {
        let Some(text) = node.scalar_text() else {
            problems.push(error(
                "wrong-kind",
                format!("a word must be text, not {}", node.kind_in_words()),
                &node.span,
            ));
            return None;
        };
        let mut parts = Vec::new();
        let mut plain = String::new();
        let mut at = 0;
        while let Some(found) = text[at..].find(['{', '}']).map(|found| at + found) {
            plain.push_str(&text[at..found]);
            if text[found..].starts_with("{{") || text[found..].starts_with("}}") {
                plain.push_str(&text[found..=found]);
                at = found + 2;
                continue;
            }
            let Some(end) = text[found..]
                .find('}')
                .map(|end| found + end)
                .filter(|_| text[found..].starts_with('{'))
            else {
                let says = "this brace has no matching brace";
                let help = "write `{{` or `}}` for a literal brace";
                problems
                    .push(error("unclosed-brace", says, &node.place(found..found + 1)).help(help));
                return None;
            };
            let name = &text[found + 1..end];
            let allowed = Hole::WORDS.iter().filter(|(_, hole)| hole.is_of_set() == of_set);
            let Some((_, hole)) = allowed.clone().find(|(word, _)| *word == name) else {
                let says = format!("there is no `{{{name}}}` here");
                let known = allowed.map(|(word, _)| *word);
                problems.push(
                    error("unknown-placeholder", says, &node.place(found + 1..end))
                        .suggest(name, known),
                );
                return None;
            };
            if !plain.is_empty() {
                parts.push(WordPart::Text(std::mem::take(&mut plain)));
            }
            parts.push(WordPart::Hole(*hole));
            at = end + 1;
        }
        plain.push_str(&text[at..]);
        if !plain.is_empty() || parts.is_empty() {
            parts.push(WordPart::Text(plain));
        }
        Some(Self { parts })
    }

    pub fn has(&self, hole: Hole) -> bool {
        self.parts.contains(&WordPart::Hole(hole))
    }

    /// Whether the word is only this placeholder.
    pub fn is(&self, hole: Hole) -> bool {
        self.parts == [WordPart::Hole(hole)]
    }

    /// The text of a word without placeholders.
    pub fn plain(&self) -> Option<&str> {
        if let [WordPart::Text(text)] = &self.parts[..] { Some(text) } else { None }
    }

    /// The word with its placeholders replaced.
    pub fn filled(&self, with: &dyn Fn(Hole) -> String) -> String {
        let part = |part: &WordPart| match part {
            WordPart::Text(plain) => plain.clone(),
            WordPart::Hole(hole) => with(*hole),
        };
        self.parts.iter().map(part).collect()
    }
}

/// The words of a call. `{set}` is repeated for every parameter, in the form of `set` if given,
/// else `name=value`.
pub fn fill(
    command: &[Word],
    set: &[Word],
    settings: &[(String, f64)],
    with: &dyn Fn(Hole) -> String,
) -> Vec<String> {
    let mut words = Vec::new();
    for word in command {
        if !word.has(Hole::Set) {
            words.push(word.filled(with));
            continue;
        }
        for (name, value) in settings {
            let parameter = |hole: Hole| match hole {
                Hole::Name => name.clone(),
                Hole::Value => value.to_string(),
                Hole::Set => format!("{name}={value}"),
                other => with(other),
            };
            if set.is_empty() {
                words.push(word.filled(&parameter));
            } else {
                words.extend(set.iter().map(|word| word.filled(&parameter)));
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use crate::yaml;

    fn words(text: &str, of_set: bool) -> Result<Vec<Word>, Vec<(&'static str, String)>> {
        let mut problems = Problems::default();
        let tree = yaml::load(&Source::new("sim.yaml", text), &mut problems).expect("YAML");
        let words: Vec<Word> = tree
            .items()
            .iter()
            .filter_map(|node| Word::read(node, of_set, &mut problems))
            .collect();
        let place = |problem: &crate::problem::Problem| {
            problem.at.as_ref().map_or("", |span| span.text()).to_string()
        };
        if problems.0.is_empty() {
            Ok(words)
        } else {
            Err(problems.0.iter().map(|problem| (problem.code, place(problem))).collect())
        }
    }

    #[test]
    fn parameters_repeat_their_words() {
        let command = words("[run, '--to={out}', '{set}', '{{x}}']", false).expect("right");
        let set = words("[-p, '{name}={value}']", true).expect("right");
        let settings = [("mu".to_string(), 0.5), ("m".to_string(), -3e4)];
        let with = |hole: Hole| hole.word().to_uppercase();
        assert_eq!(
            fill(&command, &set, &settings, &with),
            ["run", "--to=OUT", "-p", "mu=0.5", "-p", "m=-30000", "{x}"]
        );
        assert_eq!(fill(&command, &set, &[], &with), ["run", "--to=OUT", "{x}"]);
        let command = words("[run, '-D{set}']", false).expect("right");
        assert_eq!(fill(&command, &[], &settings, &with), ["run", "-Dmu=0.5", "-Dm=-30000"]);
    }

    #[test]
    fn faults_are_placed() {
        assert_eq!(
            words("['{trak}']", false),
            Err(vec![("unknown-placeholder", "trak".to_string())])
        );
        assert_eq!(words("['a{out']", false), Err(vec![("unclosed-brace", "{".to_string())]));
        assert_eq!(words("['a}']", false), Err(vec![("unclosed-brace", "}".to_string())]));
        assert_eq!(
            words("['{name}']", false),
            Err(vec![("unknown-placeholder", "name".to_string())])
        );
        assert_eq!(words("[[a]]", false), Err(vec![("wrong-kind", "[a]".to_string())]));
    }
}
