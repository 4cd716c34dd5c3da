//! Slips that YAML reads as something else: decimal commas in a map, and braces without quotes.

use crate::problem::{Problems, error};
use crate::source::{Source, Span};
use crate::yaml::{Key, Node, Value, quoted};

/// `{offset: 0,3 kN}` is a map with a key `3 kN` for YAML. The comma is told, and the number is
/// read as it was meant, so that nothing else is said of it.
pub fn decimal_commas(node: Node, problems: &mut Problems) -> Node {
    let value = match node.value {
        Value::List(items) => {
            Value::List(items.into_iter().map(|item| decimal_commas(item, problems)).collect())
        }
        Value::Map(entries) => {
            let mut mended: Vec<(Key, Node)> = Vec::new();
            for (key, value) in entries {
                match mended.last_mut() {
                    Some((number, whole)) if is_rest(&key, &value) && is_whole(whole) => {
                        let text = format!("{}.{}", whole.raw, key.text);
                        let span = whole.span.to(&key.span);
                        let says = format!(
                            "`{}: {},{}` has a decimal comma; numbers are written with a point",
                            number.text, whole.raw, key.text
                        );
                        problems.push(
                            error("decimal-comma", says, &span)
                                .help(format!("write `{}: {text}`", number.text)),
                        );
                        *whole = Node {
                            value: Value::Text(text.clone()),
                            raw: text,
                            span,
                            exact: false,
                        };
                    }
                    _ => mended.push((key, decimal_commas(value, problems))),
                }
            }
            Value::Map(mended)
        }
        value => value,
    };
    Node { value, ..node }
}

fn is_rest(key: &Key, value: &Node) -> bool {
    key.text.starts_with(|letter: char| letter.is_ascii_digit())
        && matches!(value.value, Value::Null)
}

fn is_whole(node: &Node) -> bool {
    let digits = node.raw.trim_start_matches(['+', '-']);
    node.scalar_text().is_some()
        && !digits.is_empty()
        && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Help for a line such as `files: {section}.csv`, at which YAML stops.
pub fn unquoted(source: &Source, at: &Span) -> Option<String> {
    if at.source.name != source.name {
        return None;
    }
    let before = source.text.get(..at.start)?;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let (key, value) = source.text[start..].lines().next()?.split_once(':')?;
    let (key, value) = (key.trim(), value.trim());
    let (_, rest) = value.strip_prefix('{')?.split_once('}')?;
    // A comment or a comma may follow a map.
    (!rest.is_empty() && !rest.starts_with([' ', ',', '}'])).then(|| quoted(key, value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yaml;

    #[test]
    fn a_decimal_comma_is_one_fault() {
        let mut problems = Problems::default();
        let source = Source::new("m", "a: {offset: 0,3 kN, factor: -1,02}\nb: {S01: 1, S02: }\n");
        let tree = decimal_commas(yaml::load(&source, &mut problems).expect("YAML"), &mut problems);
        let entry =
            |key: &str| tree.get("a").and_then(|node| node.get(key)).map(|node| node.raw.clone());
        assert_eq!(
            (entry("offset").as_deref(), entry("factor").as_deref()),
            (Some("0.3 kN"), Some("-1.02"))
        );
        let said: Vec<_> = problems.0.iter().filter_map(|problem| problem.help.clone()).collect();
        assert_eq!(said, ["write `offset: 0.3 kN`", "write `factor: -1.02`"]);
        assert_eq!(tree.get("b").map_or(0, |node| node.entries().len()), 2);
    }

    #[test]
    fn braces_without_quotes_are_seen() {
        let of = |text: &str, at: usize| {
            let source = Source::new("m", text);
            unquoted(&source, &source.span(at..at + 1))
        };
        let help = "a value that begins with `{` needs quotes: `files: \"{section}.csv\"`";
        assert_eq!(of("a: 1\n  files: {section}.csv\n", 20).as_deref(), Some(help));
        assert_eq!(of("files: {a: 1} # x\n", 7), None);
        assert_eq!(of("files: raw/{section}.csv\n", 7), None);
    }
}
