//! Names and units of the columns, and what the lines before the numbers say besides.

use super::dialect::{self, Dialect, Line};
use super::{Text, at};
use crate::problem::Problem;
use crate::source::Span;
use crate::units::Unit;

/// The heading of a column.
#[derive(Clone, Debug, Default)]
pub(super) struct Heading {
    pub name: String,
    pub unit: Option<String>,
    pub comment: Option<String>,
    pub span: Option<Span>,
}

#[derive(Debug, Default)]
pub(super) struct Header {
    pub columns: Vec<Heading>,
    pub facts: Vec<(String, String)>,
}

/// Reads the lines before the first row.
///
/// # Errors
/// `header-line`.
pub(super) fn read(
    text: &Text<'_>,
    before: &[Line<'_>],
    dialect: Dialect,
) -> Result<Header, Problem> {
    let mut header = Header::default();
    let options = text.options;
    let comments: Vec<(Line<'_>, &str)> = before
        .iter()
        .filter_map(|line| Some((*line, dialect::comment(line.text, options)?)))
        .collect();
    header.facts.extend(comments.iter().filter_map(|(_, said)| fact(said)).take(MOST_FACTS));
    let rows: Vec<Line<'_>> = before
        .iter()
        .filter(|line| {
            dialect::comment(line.text, options).is_none()
                && cells(line.text, dialect).len() == dialect.columns
        })
        .filter(|line| cells(line.text, dialect).iter().any(|cell| !cell.is_empty()))
        .copied()
        .collect();
    for line in before.iter().filter(|line| dialect::comment(line.text, options).is_none()) {
        if header.facts.len() < MOST_FACTS && !rows.iter().any(|row| row.number == line.number) {
            header.facts.extend(fact(line.text));
        }
    }
    let units = line_of_units(text, &rows, dialect)?;
    let names = match options.names_line {
        Some(number) => Some(said(text, before, number, "names", dialect)?),
        None => {
            let mut above =
                rows.iter().rev().filter(|row| units.is_none_or(|units| row.number < units.number));
            // A row of numbers has no names, unless there is no other.
            let last = above.clone().next();
            above.find(|row| has_words(row.text, dialect)).or(last).copied()
        }
    };
    if let Some(names) = names {
        header.columns = headings(text, names, dialect);
    } else if let Some(columns) = listed(text, &comments, dialect.columns) {
        header.columns = columns;
    } else if let Some(columns) =
        comments.iter().rev().find_map(|(line, said)| commented(text, *line, said, dialect))
    {
        header.columns = columns;
    } else {
        let numbered =
            |column: usize| Heading { name: format!("column {column}"), ..Heading::default() };
        header.columns = (1..=dialect.columns).map(numbered).collect();
        header.facts.push(("names".into(), "none in the file; columns are numbered".into()));
    }
    if let Some(units) = units {
        for (column, cell) in header.columns.iter_mut().zip(cells(units.text, dialect)) {
            column.unit = unbracketed(&units.text[cell]).or(column.unit.take());
        }
    }
    let used = [names, units].map(|line| line.map(|line| line.number));
    for row in rows.iter().filter(|row| !used.contains(&Some(row.number))) {
        for (column, cell) in header.columns.iter_mut().zip(cells(row.text, dialect)) {
            let more = row.text[cell].trim();
            if !more.is_empty() {
                column.comment = Some(
                    column
                        .comment
                        .take()
                        .map_or_else(|| more.into(), |before| format!("{before}, {more}")),
                );
            }
        }
    }
    Ok(header)
}

/// Maximum number of facts kept of a header, which can be as long as the file.
const MOST_FACTS: usize = 100;
/// Longest text of a fact.
const LONGEST_FACT: usize = 200;

/// `Section: S01`, `Fahrzeug = Wagen 5`.
fn fact(line: &str) -> Option<(String, String)> {
    let line = line
        .trim()
        .trim_start_matches(['#', '%', '!', '*', '/'])
        .trim()
        .trim_end_matches([';', ',', '\t']);
    let (name, value) = line.split_once([':', '=']).or_else(|| line.split_once([';', '\t']))?;
    let (name, value) = (name.trim().trim_matches('"'), value.trim().trim_matches(['"', ';']));
    let short = !name.is_empty() && !value.is_empty() && line.len() <= LONGEST_FACT;
    (short && !name.starts_with(|c: char| c.is_ascii_digit()) && numbered(line).is_none())
        .then(|| (name.into(), value.into()))
}

/// Cells of a header line; a separator at its end makes no cell if there is one too many.
fn cells(line: &str, dialect: Dialect) -> Vec<std::ops::Range<usize>> {
    let mut cells = dialect::split(line, dialect.separator);
    if cells.len() == dialect.columns + 1 && cells.last().is_some_and(std::ops::Range::is_empty) {
        cells.pop();
    }
    cells
}

/// A line that was named by its number.
fn said<'a>(
    text: &Text<'_>,
    before: &[Line<'a>],
    number: usize,
    what: &str,
    dialect: Dialect,
) -> Result<Line<'a>, Problem> {
    let Some(line) = before.iter().find(|line| line.number == number) else {
        let says = format!(
            "line {number} of `{}` is not before the numbers; it was said to have the {what}",
            text.shown
        );
        let last = before.last().map_or(0, |line| line.number);
        return Err(Problem::error("header-line", says)
            .help(format!("the numbers begin in line {}", last + 1)));
    };
    let found = cells(line.text, dialect).len();
    if found == dialect.columns {
        return Ok(*line);
    }
    let says = format!(
        "line {number}, said to have the {what}, has {found} cells; the rows of numbers have {}",
        dialect.columns
    );
    Err(Problem::error("header-line", says).at(&at(text.shown, *line, 0..line.text.len())))
}

/// The line of units: said, or the last line of the header if most of its cells are units.
fn line_of_units<'a>(
    text: &Text<'_>,
    rows: &[Line<'a>],
    dialect: Dialect,
) -> Result<Option<Line<'a>>, Problem> {
    match text.options.units_line {
        Some(0) => return Ok(None),
        Some(number) => return said(text, rows, number, "units", dialect).map(Some),
        None => {}
    }
    Ok(rows.iter().skip(1).rev().find(|row| are_units(row.text, dialect)).copied())
}

fn has_words(line: &str, dialect: Dialect) -> bool {
    cells(line, dialect).into_iter().any(|cell| line[cell].contains(char::is_alphabetic))
}

fn are_units(line: &str, dialect: Dialect) -> bool {
    most_are_units(cells(line, dialect).into_iter().map(|cell| &line[cell]))
}

/// Whether at least half of the cells that are filled are units.
pub(in crate::foreign) fn most_are_units<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
    let filled: Vec<&str> = cells.filter(|cell| !cell.trim().is_empty()).collect();
    let known = filled
        .iter()
        .filter(|cell| unbracketed(cell).is_some_and(|unit| Unit::parse(&unit).is_ok()))
        .count();
    // `1` is a unit, but a line of numbers only is a row.
    let worded = filled.iter().any(|cell| cell.parse::<f64>().is_err());
    worded && 2 * known >= filled.len()
}

/// `kN`, `[kN]`, `(kN)`, as the unit inside; none if it is empty.
pub(in crate::foreign) fn unbracketed(text: &str) -> Option<String> {
    let text = text.trim();
    let inside = text.strip_prefix('[').and_then(|text| text.strip_suffix(']'));
    let inside = inside
        .or_else(|| text.strip_prefix('(').and_then(|text| text.strip_suffix(')')))
        .unwrap_or(text)
        .trim();
    (!inside.is_empty()).then(|| inside.to_string())
}

/// `Y_1R [kN]`, or `Y_1R (kN)` and `Y_1R / kN` if the part is a unit.
pub(in crate::foreign) fn name_and_unit(text: &str) -> (String, Option<String>) {
    let text = text.trim();
    if let Some((name, rest)) = text.rsplit_once('[')
        && let Some(unit) = rest.strip_suffix(']')
        && !name.trim().is_empty()
    {
        return (name.trim().to_string(), unbracketed(unit));
    }
    let round =
        text.rsplit_once('(').and_then(|(name, rest)| Some((name, rest.strip_suffix(')')?)));
    let parts = round.or_else(|| text.rsplit_once(" / ")).or_else(|| text.rsplit_once(" in "));
    if let Some((name, unit)) = parts
        && !name.trim().is_empty()
        && Unit::parse(unit.trim()).is_ok()
    {
        return (name.trim().to_string(), Some(unit.trim().to_string()));
    }
    (text.to_string(), None)
}

fn headings(text: &Text<'_>, line: Line<'_>, dialect: Dialect) -> Vec<Heading> {
    let heading = |(index, cell): (usize, std::ops::Range<usize>)| {
        let (name, unit) = name_and_unit(&line.text[cell.clone()]);
        let name = if name.is_empty() { format!("column {}", index + 1) } else { name };
        Heading { name, unit, comment: None, span: Some(at(text.shown, line, cell)) }
    };
    cells(line.text, dialect).into_iter().enumerate().map(heading).collect()
}

/// The names after a comment mark: `# time Y Q`.
fn commented(
    text: &Text<'_>,
    line: Line<'_>,
    said: &str,
    dialect: Dialect,
) -> Option<Vec<Heading>> {
    let start = line.text.len() - said.len();
    let found = cells(said, dialect);
    let words = found.len() == dialect.columns
        && found.iter().all(|cell| said[cell.clone()].contains(|c: char| c.is_alphabetic()));
    words.then(|| {
        let heading = |cell: std::ops::Range<usize>| {
            let (name, unit) = name_and_unit(&said[cell.clone()]);
            Heading {
                name,
                unit,
                comment: None,
                span: Some(at(text.shown, line, start + cell.start..start + cell.end)),
            }
        };
        found.into_iter().map(heading).collect()
    })
}

/// A list of channels in comments, one a line: `Channel 3: Y_11 [N]`, `3 Y_11 N`.
fn listed(text: &Text<'_>, comments: &[(Line<'_>, &str)], columns: usize) -> Option<Vec<Heading>> {
    let mut found: Vec<Heading> = Vec::new();
    for (line, said) in comments {
        let Some((number, rest)) = numbered(said) else { continue };
        if number == 1 && found.len() != columns {
            found.clear();
        }
        if number != found.len() + 1 || found.len() == columns {
            continue;
        }
        let (mut name, mut unit) = name_and_unit(rest);
        // Without brackets the unit is the last word.
        if unit.is_none()
            && let Some((first, last)) = name.rsplit_once(char::is_whitespace)
            && Unit::parse(last).is_ok()
        {
            unit = Some(last.to_string());
            name = first.trim().to_string();
        }
        let start = line.text.rfind(rest).unwrap_or(0);
        found.push(Heading {
            name,
            unit,
            comment: None,
            span: Some(at(text.shown, *line, start..start + rest.len())),
        });
    }
    (found.len() == columns).then_some(found)
}

/// The number of a channel and what follows: of `Channel   3: Y_11 [N]` these are 3 and `Y_11 [N]`.
fn numbered(said: &str) -> Option<(usize, &str)> {
    let said = said.trim().trim_start_matches(['#', '%', '!', '*', '/']).trim_start();
    let word = said.find(|c: char| !c.is_alphabetic()).unwrap_or(said.len());
    let rest = said[word..].trim_start_matches([' ', '\t', '.', '#', '_', '[', '(', ':']);
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let number = rest[..digits].parse().ok()?;
    let after = &rest[digits..];
    let name = after.trim_start_matches([' ', '\t', ':', '.', '=', ')', ']', '-', ';', ',']).trim();
    (after.len() != name.len() && !name.is_empty()).then_some((number, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_from_units() {
        let owned =
            |(name, unit): (&str, Option<&str>)| (name.to_string(), unit.map(str::to_string));
        for (text, parts) in [
            ("Y_1R [kN]", ("Y_1R", Some("kN"))),
            ("a[0] [m/s²]", ("a[0]", Some("m/s²"))),
            ("v (km/h)", ("v", Some("km/h"))),
            ("Weg / m", ("Weg", Some("m"))),
            ("speed in m/s", ("speed", Some("m/s"))),
            ("ST1 Y (re)", ("ST1 Y (re)", None)),
            ("[kN]", ("[kN]", None)),
            ("x []", ("x", None)),
        ] {
            assert_eq!(name_and_unit(text), owned(parts), "{text}");
        }
    }

    #[test]
    fn channels_of_a_list_are_numbered() {
        assert_eq!(numbered("# Channel   3: $R_Y11   [N]"), Some((3, "$R_Y11   [N]")));
        assert_eq!(numbered(" 12 Y_111 N"), Some((12, "Y_111 N")));
        assert_eq!(numbered("Kanal 2 = Weg [m]"), Some((2, "Weg [m]")));
        assert_eq!(numbered("Number of rows: 1794"), None);
        assert_eq!(numbered("3"), None);
        assert_eq!(numbered("10.5 kN"), Some((10, "5 kN")));
    }

    #[test]
    fn facts_have_a_name() {
        assert_eq!(fact("# Section: S01"), Some(("Section".into(), "S01".into())));
        assert_eq!(fact("Fahrzeug;Wagen 5;;"), Some(("Fahrzeug".into(), "Wagen 5".into())));
        assert_eq!(fact("# Channel 1: time [s]"), None);
        assert_eq!(fact("Number of rows: 1794"), Some(("Number of rows".into(), "1794".into())));
    }
}
