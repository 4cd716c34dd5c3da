//! Whether the pairs notice that a number of the protocol is another one.

use std::ops::Range;

use super::{
    bench::{Bench, Said},
    search::Found,
};
use crate::certify::{Compiled, compile};
use crate::check::{Overrides, family};
use crate::problem::Problems;
use crate::result::exercise::Mutated;
use crate::source::Source;

/// What a number is multiplied by.
const FACTORS: [f64; 2] = [1.01, 1.0 / 1.01];

/// Fields whose numbers decide nothing: what a parameter may be set to, and words.
const WITHOUT_EFFECT: [&str; 7] =
    ["range", "edition", "source", "clause", "note", "title", "scope"];

/// Changes each number of the text of the protocol by one per cent, up and down, and tells which
/// changes some pair notices: its limit then judges one of its campaigns otherwise. Changes that
/// give no valid protocol are left out. Texts that it extends or uses stay.
pub fn mutations(
    bench: &Bench<'_>,
    with_texts: (&Overrides, family::Find<'_>),
    (base, pairs): (&Said, &[(usize, Found)]),
) -> Vec<Mutated> {
    let Some(source) = bench.compiled.family.sources.first() else { return Vec::new() };
    let mut found = Vec::new();
    for number in numbers(&source.text) {
        let text = &source.text[number.at.clone()];
        let Ok(value) = text.parse::<f64>() else { continue };
        for factor in FACTORS.into_iter().filter(|_| value != 0.0) {
            let new = value * factor;
            let Some(compiled) = with(source, &number.at, new, with_texts) else { continue };
            let by = noticed(bench, &compiled, (base, pairs));
            found.push(Mutated {
                line: source.text[..number.at.start].matches('\n').count() + 1,
                field: number.field.clone(),
                from: text.to_string(),
                to: new,
                noticed_by: by.map(|limit| bench.limits[limit].rule.clone()),
            });
        }
    }
    found
}

/// The limit whose pair notices that the protocol is another one.
fn noticed(
    bench: &Bench<'_>,
    compiled: &Compiled,
    (base, pairs): (&Said, &[(usize, Found)]),
) -> Option<usize> {
    let now = bench.judged_by((compiled, &[]), None);
    // What moves nothing in the campaign as it is moves nothing in one that differs a little.
    let moved =
        |limit: usize| now.as_ref().is_none_or(|now| now.limits[limit] != base.limits[limit]);
    let notices = |(limit, found): &&(usize, Found)| {
        let both = [(found.inside.size, true), (found.outside.size, false)];
        both.into_iter().any(|(size, held)| {
            let now = bench.judged_by((compiled, &[]), Some((&found.by, size)));
            now.is_none_or(|now| now.limits[*limit].holds != Some(held))
        })
    };
    let moved = pairs.iter().filter(|(limit, _)| moved(*limit));
    moved.into_iter().find(notices).map(|(limit, _)| *limit)
}

fn with(
    source: &Source,
    at: &Range<usize>,
    new: f64,
    (overrides, find): (&Overrides, family::Find<'_>),
) -> Option<Compiled> {
    let text = format!("{}{new}{}", &source.text[..at.start], &source.text[at.end..]);
    let mut problems = Problems::default();
    let source = Source::new(source.name.clone(), text);
    let family = family::read(&source, find, &mut problems);
    let compiled = compile(family, overrides, &mut problems);
    compiled.filter(|_| !problems.any_error())
}

/// A number as it is written, and the field that it stands in.
#[derive(Debug, PartialEq)]
struct Written {
    at: Range<usize>,
    field: String,
}

/// The numbers of a text outside names, quotes, comments and exponents of units.
fn numbers(text: &str) -> Vec<Written> {
    let mut found = Vec::new();
    let (mut start, mut field) = (0, "");
    for line in text.split_inclusive('\n') {
        let inner = line.trim_start();
        let indent = line.len() - inner.len();
        let key = inner.split(' ').next().unwrap_or_default().trim_end();
        // Further lines of a field stand below its value.
        if (indent == 0 || indent == 2) && !key.is_empty() {
            field = key;
        }
        if indent > 0 && !WITHOUT_EFFECT.contains(&field) {
            let of = |at: Range<usize>| Written {
                at: start + at.start..start + at.end,
                field: field.to_string(),
            };
            found.extend(in_line(line).into_iter().map(of));
        }
        start += line.len();
    }
    found
}

fn in_line(line: &str) -> Vec<Range<usize>> {
    let bytes = line.as_bytes();
    let is_name =
        |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | b'^' | b'{');
    let (mut found, mut quoted, mut at) = (Vec::new(), false, 0);
    while at < bytes.len() {
        match bytes[at] {
            b'"' => quoted = !quoted,
            b'#' if !quoted => break,
            byte if !quoted && byte.is_ascii_digit() && (at == 0 || !is_name(bytes[at - 1])) => {
                let more =
                    bytes[at..].iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.');
                let end = at + more.count();
                let end = if bytes[end - 1] == b'.' { end - 1 } else { end };
                if !bytes.get(end).is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_')
                {
                    found.push(at..end);
                }
                at = end;
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_outside_names_words_and_units() {
        let text = "parameter a \"of 3\"\n  default 2.5 m/s^2\n  range 1 to 2\nquantity Y_1\n  \
                    limit p99.5 4 kN, 1/3 of Y_2 # 7\n          and 12.\n";
        let found = numbers(text);
        let read: Vec<(&str, &str)> =
            found.iter().map(|of| (&text[of.at.clone()], of.field.as_str())).collect();
        let expected =
            [("2.5", "default"), ("4", "limit"), ("1", "limit"), ("3", "limit"), ("12", "limit")];
        assert_eq!(read, expected);
    }
}
