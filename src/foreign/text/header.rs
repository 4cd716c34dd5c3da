//! Names and units of the columns, and what the lines before the numbers say besides.

use std::ops::Range;

use super::dialect::{Line, Separator, comment, split};
use super::{Text, at};
use crate::foreign::{conflict, filled};
use crate::problem::Problem;
use crate::source::Span;
use crate::units::Unit;

/// The heading of a column.
#[derive(Clone, Debug, Default)]
pub struct Heading {
    pub name: String,
    pub unit: Option<String>,
    /// Another unit that is stated of it.
    pub other_unit: Option<String>,
    pub comment: Option<String>,
    pub span: Option<Span>,
}

#[derive(Debug, Default)]
pub struct Header {
    pub columns: Vec<Heading>,
    pub facts: Vec<(String, String)>,
}

/// Reads the lines before the first row.
///
/// # Errors
/// `header-line`.
pub fn read(
    text: &Text<'_>,
    before: &[Line<'_>],
    first: Option<Line<'_>>,
) -> Result<Header, Problem> {
    let Text { options, dialect, .. } = text;
    let mut header = Header::default();
    let (comments, others): (Vec<Line<'_>>, Vec<Line<'_>>) =
        before.iter().copied().partition(|line| comment(line.text, options).is_some());
    let comments: Vec<(Line<'_>, &str)> = comments
        .into_iter()
        .filter_map(|line| Some((line, comment(line.text, options)?)))
        .collect();
    header.facts.extend(comments.iter().filter_map(|(_, said)| fact(said)).take(MOST_FACTS));
    let (rows, others): (Vec<Line<'_>>, Vec<Line<'_>>) = others.into_iter().partition(|line| {
        let cells = cells_of(text, line.text);
        cells.len() == dialect.columns && cells.iter().any(|cell| !cell.is_empty())
    });
    let left = MOST_FACTS - header.facts.len();
    header.facts.extend(others.iter().filter_map(|line| fact(line.text)).take(left));
    let units = line_of_units(text, &rows)?;
    let names = match options.names_line {
        Some(number) => Some(said(text, before, number, "names")?),
        None => {
            let mut above =
                rows.iter().rev().filter(|row| units.is_none_or(|units| row.number < units.number));
            // A row of numbers has no names, unless there is no other.
            let last = above.clone().next();
            let has_words = |row: &&Line<'_>| {
                cells_of(text, row.text).into_iter().any(|cell| has_letters(&row.text[cell]))
            };
            above.find(has_words).or(last).copied()
        }
    };
    // The names after a comment mark: `# time Y Q`.
    let are_names = |(_, said): &&(Line<'_>, &str)| {
        let cells = cells_of(text, said);
        cells.len() == dialect.columns && cells.into_iter().all(|cell| has_letters(&said[cell]))
    };
    let mut in_lines = false;
    let both = units.zip(first).filter(|_| options.names_line.is_none());
    if let Some(names) = both.and_then(|(units, first)| stacked(text, before, units, first)) {
        header.columns = names;
        in_lines = true;
    } else if let Some(names) = names {
        header.columns = headings(text, names, names.text);
        let above = rows.iter().rev().find(|row| row.number < names.number);
        if let Some(above) = above.filter(|above| above.number + 1 == names.number) {
            let upper = headings(text, *above, above.text);
            let upper: Vec<Option<String>> =
                upper.into_iter().map(|column| named(&column.name)).collect();
            let lower: Vec<Option<String>> =
                header.columns.iter().map(|column| named(&column.name)).collect();
            for (column, name) in header.columns.iter_mut().zip(over_two_rows(&upper, &lower)) {
                column.name = name.unwrap_or(column.name.clone());
            }
        }
    } else if let Some(columns) = listed(text, &comments) {
        header.columns = columns;
    } else if let Some((line, said)) = comments.iter().rev().find(are_names) {
        header.columns = headings(text, *line, said);
    } else {
        let numbered =
            |column: usize| Heading { name: format!("column {column}"), ..Heading::default() };
        header.columns = (1..=dialect.columns).map(numbered).collect();
        header.facts.push(("names".into(), "none in the file; columns are numbered".into()));
    }
    if let Some(units) = units {
        for (column, cell) in header.columns.iter_mut().zip(cells_of(text, units.text)) {
            let (of_line, of_name) = (unbracketed(&units.text[cell]), column.unit.take());
            column.other_unit = conflict(of_line.as_deref(), of_name.clone());
            column.unit = of_line.or(of_name);
        }
    }
    let used = [names, units].map(|line| line.map(|line| line.number));
    for row in rows.iter().filter(|row| !in_lines && !used.contains(&Some(row.number))) {
        for (column, cell) in header.columns.iter_mut().zip(cells_of(text, row.text)) {
            let Some(more) = filled(&row.text[cell]) else { continue };
            column.comment = Some(match column.comment.take() {
                Some(before) => format!("{before}, {more}"),
                None => more,
            });
        }
    }
    Ok(header)
}

fn has_letters(text: &str) -> bool {
    text.contains(char::is_alphabetic)
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

/// A line that was named by its number.
fn said<'a>(
    text: &Text<'_>,
    before: &[Line<'a>],
    number: usize,
    what: &str,
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
    let (found, wanted) = (cells_of(text, line.text).len(), text.dialect.columns);
    if found == wanted {
        return Ok(*line);
    }
    let says = format!(
        "line {number}, said to have the {what}, has {found} cells; the rows of numbers have {wanted}"
    );
    Err(text.fault("header-line", says, *line, 0..line.text.len()))
}

/// The line of units: said, or the last line of the header if most of its cells are units.
fn line_of_units<'a>(text: &Text<'_>, rows: &[Line<'a>]) -> Result<Option<Line<'a>>, Problem> {
    let are_units = |row: &&Line<'_>| {
        most_are_units(cells_of(text, row.text).into_iter().map(|cell| &row.text[cell]))
    };
    match text.options.units_line {
        Some(0) => Ok(None),
        Some(number) => said(text, rows, number, "units").map(Some),
        None => Ok(rows.iter().skip(1).rev().find(are_units).copied()),
    }
}

/// Whether at least half of the cells that are filled are units.
pub fn most_are_units<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
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
pub fn unbracketed(text: &str) -> Option<String> {
    let text = text.trim();
    let within = |open: char, close: char| text.strip_prefix(open)?.strip_suffix(close);
    filled(within('[', ']').or_else(|| within('(', ')')).unwrap_or(text))
}

/// `Y_1R [kN]`, or `Y_1R (kN)` and `Y_1R / kN` if the part is a unit.
pub fn name_and_unit(text: &str) -> (String, Option<String>) {
    let text = text.trim();
    if let Some((name, rest)) = text.rsplit_once('[')
        && let Some(unit) = rest.strip_suffix(']')
        && !name.trim().is_empty()
        && !is_index(name, unit)
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

/// `r[1]`, `a[2,3]`: an index stands right after the name, and belongs to it.
fn is_index(name: &str, inside: &str) -> bool {
    let digits = inside.chars().all(|c| c.is_ascii_digit() || matches!(c, ',' | ' ' | ':'));
    digits && !inside.trim().is_empty() && !name.ends_with(char::is_whitespace)
}

/// The unit at the end of a name that is kept as it is: in square brackets, or in round ones if it
/// is of the dimension of another unit that is stated.
pub fn unit_of_name(name: &str, stated: &str) -> Option<String> {
    let unit = name_and_unit(name).1?;
    let dimension = |text: &str| Unit::parse(text).ok().map(|unit| unit.dimension);
    let square = name.trim_end().ends_with(']');
    (square || dimension(&unit) == dimension(stated)).then_some(unit)
}

/// The headings in the cells of a line, or of its end.
fn headings(text: &Text<'_>, line: Line<'_>, end: &str) -> Vec<Heading> {
    let start = line.text.len() - end.len();
    let heading = |(index, cell): (usize, Range<usize>)| {
        let (name, unit) = name_and_unit(&end[cell.clone()]);
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
        let name = if name.is_empty() { format!("column {}", index + 1) } else { name };
        let span = at(text.shown, line, start + cell.start..start + cell.end);
        Heading { name, unit, span: Some(span), ..Heading::default() }
    };
    cells_of(text, end).into_iter().enumerate().map(heading).collect()
}

/// A name of the file, not that of a column without one.
fn named(name: &str) -> Option<String> {
    filled(name).filter(|name| !name.starts_with("column "))
}

/// Names that stand over two rows, where the lower row lacks some: `Zeit | Weg | Radsatz 1 |` above
/// ` | | Y re | Q re`. A name of the upper row holds for the columns to its right that have none.
pub fn over_two_rows(upper: &[Option<String>], lower: &[Option<String>]) -> Vec<Option<String>> {
    let lacks = upper.iter().zip(lower).any(|(upper, lower)| upper.is_some() && lower.is_none());
    if !lacks {
        return lower.to_vec();
    }
    let mut group: Option<&String> = None;
    let each = lower.iter().enumerate().map(|(at, lower)| {
        group = upper.get(at).and_then(Option::as_ref).or(group.filter(|_| lower.is_some()));
        match (group, lower) {
            (Some(group), Some(lower)) => Some(format!("{group} {lower}")),
            (group, lower) => group.or(lower.as_ref()).cloned(),
        }
    });
    each.collect()
}

/// The cells of a line of the header. Between blanks, a unit in brackets belongs to the name before
/// it, and names may have blanks if two at least separate them.
fn cells_of(text: &Text<'_>, line: &str) -> Vec<Range<usize>> {
    let cells = text.cells(line);
    if text.dialect.separator != Separator::Blanks || cells.len() == text.dialect.columns {
        return cells;
    }
    let mut joined: Vec<Range<usize>> = Vec::new();
    for cell in &cells {
        match joined.last_mut() {
            Some(last) if line[cell.clone()].starts_with(['[', '(']) => last.end = cell.end,
            _ => joined.push(cell.clone()),
        }
    }
    let wide = apart(line);
    [joined, wide].into_iter().find(|other| other.len() == text.dialect.columns).unwrap_or(cells)
}

/// The parts of a line between two blanks or more.
fn apart(line: &str) -> Vec<Range<usize>> {
    let mut parts: Vec<Range<usize>> = Vec::new();
    for cell in split(line, Separator::Blanks) {
        match parts.last_mut() {
            Some(last) if line[last.end..cell.start] == *" " => last.end = cell.end,
            _ => parts.push(cell),
        }
    }
    parts
}

/// Names over several lines above the units, each part above the numbers of its column, as programs
/// write columns of fixed width.
fn stacked(
    text: &Text<'_>,
    before: &[Line<'_>],
    units: Line<'_>,
    first: Line<'_>,
) -> Option<Vec<Heading>> {
    if text.dialect.separator != Separator::Blanks {
        return None;
    }
    // Columns are counted in letters: names have letters of several bytes.
    let letters = |line: &str, at: usize| line[..at].chars().count();
    let cells = text.cells(first.text);
    let ends: Vec<usize> = cells.iter().map(|cell| letters(first.text, cell.end)).collect();
    let mut names: Vec<Vec<&str>> = vec![Vec::new(); ends.len()];
    let (mut lines, mut next) = (0, units.number);
    for line in before.iter().rev().skip_while(|line| line.number >= units.number) {
        if line.number + 1 != next || line.text.trim().is_empty() {
            break;
        }
        let mut taken: Vec<usize> = Vec::new();
        for part in apart(line.text) {
            let [start, end] = [part.start, part.end].map(|at| letters(line.text, at));
            let at = ends.iter().position(|of| end <= *of)?;
            let from = at.checked_sub(1).map_or(0, |before| ends[before]);
            if start < from || taken.contains(&at) {
                return None;
            }
            taken.push(at);
            names[at].insert(0, &line.text[part]);
        }
        (lines, next) = (lines + 1, line.number);
    }
    let heading = |parts: Vec<&str>| Heading { name: parts.join(" "), ..Heading::default() };
    let all = lines > 1 && names.iter().all(|parts| !parts.is_empty());
    all.then(|| names.into_iter().map(heading).collect())
}

/// A list of channels in comments, one a line: `Channel 3: Y_11 [N]`, `3 Y_11 N`.
fn listed(text: &Text<'_>, comments: &[(Line<'_>, &str)]) -> Option<Vec<Heading>> {
    let columns = text.dialect.columns;
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
        let span = Some(at(text.shown, *line, start..start + rest.len()));
        found.push(Heading { name, unit, span, ..Heading::default() });
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
            ("r[1]", ("r[1]", None)),
            ("a[1,2]", ("a[1,2]", None)),
            ("a[2] [m]", ("a[2]", Some("m"))),
            ("slip [1]", ("slip", Some("1"))),
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
