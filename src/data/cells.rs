//! One line of a CSV file: its cells with their places, and column headings `name [unit]`.
//!
//! The `csv` crate gives the row of a field but not its column, which messages need. Tests compare
//! the cells with those of the crate.

use std::ops::Range;

use super::faults::Faults;
use crate::data::prelude::*;

/// A cell without surrounding blanks.
#[derive(Clone, Debug, PartialEq)]
pub struct RawCell {
    pub text: String,
    /// Bytes in the line, without quotes.
    pub place: Range<usize>,
}

/// Splits a line without its line break. Quoted cells may contain commas and doubled quotes, but no
/// line breaks.
///
/// # Errors
/// The place of a quote that is not closed, or of text after it.
pub fn split(line: &str) -> Result<Vec<RawCell>, Range<usize>> {
    let mut cells = Vec::new();
    let mut from = 0;
    loop {
        let (cell, end) = if line[from..].trim_start_matches([' ', '\t']).starts_with('"') {
            quoted(line, from + line[from..].find('"').unwrap_or(0))?
        } else {
            let end = line[from..].find(',').map_or(line.len(), |at| from + at);
            (trimmed(line, from..end), end)
        };
        cells.push(cell);
        if end >= line.len() {
            return Ok(cells);
        }
        from = end + 1;
    }
}

fn trimmed(line: &str, place: Range<usize>) -> RawCell {
    let text = line[place.clone()].trim();
    let start = place.start + line[place].find(text).unwrap_or(0);
    RawCell { text: text.to_string(), place: start..start + text.len() }
}

/// The cell with its opening quote at `open`, and the place of its comma or of the end of the line.
fn quoted(line: &str, open: usize) -> Result<(RawCell, usize), Range<usize>> {
    let mut close = open + 1;
    loop {
        close += line[close..].find('"').ok_or(open..line.len())?;
        if !line[close + 1..].starts_with('"') {
            break;
        }
        close += 2;
    }
    let end = line[close..].find(',').map_or(line.len(), |at| close + at);
    if !line[close + 1..end].trim().is_empty() {
        return Err(close + 1..end);
    }
    let mut cell = trimmed(line, open + 1..close);
    cell.text = cell.text.replace("\"\"", "\"");
    Ok((cell, end))
}

/// The heading of a column: `Y_1R [kN]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    pub name: String,
    /// Absent where the heading has no brackets.
    pub unit: Option<HeadingUnit>,
    /// The whole cell.
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub struct HeadingUnit {
    /// As written between the brackets.
    pub text: String,
    pub span: Span,
}

impl Heading {
    /// The unit of the column, of the wanted dimension if one is given.
    ///
    /// # Errors
    /// `unit-missing`, `unknown-unit`, `unit-mismatch`, each with its place in the header.
    pub fn unit(&self, wanted: Option<Dimension>) -> Result<Unit, Problem> {
        let name = &self.name;
        let Some(HeadingUnit { text, span }) = &self.unit else {
            let needed = wanted.map(|wanted| format!("; {} is needed", wanted.in_words()));
            return Err(problem!("unit-missing", &self.span, "the column `{name}` has no unit{}", needed.unwrap_or_default())
                .help(format!("write the unit in square brackets: `{name} [...]`, or `{name} [-]` for a plain number")));
        };
        let unit = Unit::parse(text).map_err(|unknown| {
            let word = unknown.word;
            let problem = problem!(
                "unknown-unit",
                span,
                "the unit of the column `{name}`: `{word}` is not a known unit"
            );
            match unknown.near {
                Some(near) => problem.meant(near),
                None => problem,
            }
        })?;
        match wanted {
            Some(wanted) if wanted != unit.dimension => {
                let (is, wanted) = (unit.dimension.in_words(), wanted.in_words());
                Err(problem!(
                    "unit-mismatch",
                    span,
                    "the column `{name}` is in {}, which is {is}; {wanted} is needed",
                    unit.text
                ))
            }
            _ => Ok(unit),
        }
    }

    /// Of the text of a cell `name [unit]`, and its place.
    pub fn read(text: &str, span: Span) -> Self {
        let (name, unit) = name_and_unit(text);
        let unit = unit.map(|range| {
            let text = text[range.clone()].trim().to_string();
            HeadingUnit { text, span: span.part(range) }
        });
        Self { name: name.to_string(), unit, span }
    }
}

/// The names of columns.
pub fn names(headings: &[Heading]) -> Vec<String> {
    headings.iter().map(|heading| heading.name.clone()).collect()
}

/// As [`name_and_unit`], with the text of the unit.
pub fn name_and_unit_text(text: &str) -> (String, Option<String>) {
    let (name, unit) = name_and_unit(text);
    (name.to_string(), unit.map(|range| text[range].trim().to_string()))
}

/// Splits `cant deficiency [mm]` into the name and the range of the unit.
pub fn name_and_unit(text: &str) -> (&str, Option<Range<usize>>) {
    let inner = text.strip_suffix(']').and_then(|inner| Some((inner.rfind('[')?, inner.len())));
    match inner {
        Some((open, close)) => (text[..open].trim_end(), Some(open + 1..close)),
        None => (text, None),
    }
}

/// The headings in the first line of a file, whose place is given.
pub fn headings(line: &Span, problems: &mut Vec<Problem>) -> Option<Vec<Heading>> {
    if let Some(problem) = carriage_returns(line).or_else(|| other_separator(line)) {
        problems.push(problem);
        return None;
    }
    let cells = split(line.text());
    let cells = cells.map_err(|at| problems.push(stray_quote(&line.part(at)))).ok()?;
    let heading = |cell: &RawCell| Heading::read(&cell.text, line.part(cell.place.clone()));
    let headings: Vec<Heading> = cells.iter().map(heading).collect();
    let twice = duplicates(&headings);
    if twice.is_empty() {
        return Some(headings);
    }
    problems.extend(unit_in_cell(&headings).map_or(twice, |problem| vec![problem]));
    None
}

/// Lines that end with a carriage return alone: the whole file is one line, of which only the
/// header is shown.
fn carriage_returns(line: &Span) -> Option<Problem> {
    let end = line.text().trim_end_matches('\r').find('\r')?;
    let header = Source::excerpt(line.source.name.clone(), &line.text()[..end], line.line());
    let problem =
        error("line-ends", "the lines end with a carriage return (CR) alone", &header.whole());
    Some(problem.help("save the file with the line ends of Windows (CR LF) or Linux (LF)"))
}

/// The first columns with the name of another one, and how many there are more.
pub fn duplicates(headings: &[Heading]) -> Vec<Problem> {
    let mut sorted: Vec<&Heading> =
        headings.iter().filter(|heading| !heading.name.is_empty()).collect();
    sorted.sort_by(|a, b| (&a.name, a.span.start).cmp(&(&b.name, b.span.start)));
    let file = headings.first().map_or("", |heading| heading.span.source.name.as_str());
    let mut faults = Faults::new(file);
    for pair in sorted.windows(2).filter(|pair| pair[0].name == pair[1].name) {
        faults.push(|| {
            problem!(
                "duplicate-column",
                &pair[1].span,
                "two columns are called `{}`",
                shortened(&pair[1].name)
            )
            .also(&pair[0].span, "the first of them")
        });
    }
    faults.into_vec()
}

/// `Y_1R,kN,Q_1R,kN`: a cell that is a unit and nothing else, behind a name that has none.
pub fn unit_in_cell(headings: &[Heading]) -> Option<Problem> {
    let is_unit = |heading: &Heading| heading.unit.is_none() && Unit::parse(&heading.name).is_ok();
    let [name, unit] = headings
        .windows(2)
        .find(|pair| pair[0].unit.is_none() && !is_unit(&pair[0]) && is_unit(&pair[1]))?
    else {
        return None;
    };
    let (first, unit_name) = (shortened(&name.name), &unit.name);
    let help =
        format!("write the unit behind the name, in one cell: `{} [{unit_name}]`", name.name);
    Some(
        problem!(
            "units-in-cell",
            &unit.span,
            "the unit of `{first}` stands in a cell of its own: the comma parts columns"
        )
        .also(&name.span, "its name")
        .help(help),
    )
}

/// A header without a comma that is parted by something else.
fn other_separator(line: &Span) -> Option<Problem> {
    let text = line.text();
    let others = [(';', "semicolon-separated", "semicolons"), ('\t', "tab-separated", "tabs")];
    others.into_iter().filter(|_| !text.contains(',')).find_map(|(separator, code, word)| {
        let at = text.find(separator)?;
        let problem = problem!(
            code,
            &line.part(at..at + 1),
            "the columns are separated by {word}, not by commas"
        );
        Some(problem.help("write a comma between the columns and a point in the numbers"))
    })
}

pub fn stray_quote(span: &Span) -> Problem {
    error("stray-quote", "a quoted cell is not closed, or text follows its closing quote", span)
}

/// A line with too few or too many cells; too many are most likely due to decimal commas.
pub fn ragged(line: &Span, cells: &[RawCell], columns: usize) -> Problem {
    let whole = |cell: &RawCell| {
        cell.text.trim_start_matches(['-', '+']).bytes().all(|byte| byte.is_ascii_digit())
    };
    let counts = format!("the row has {} values, the header {columns} columns", cells.len());
    // With decimal commas there is an additional cell for most numbers, and no cell contains a
    // point.
    let excess = cells.len().saturating_sub(columns);
    if 2 * excess >= columns && excess <= columns && cells.iter().rev().take(columns).all(whole) {
        return problem!(
            "decimal-comma",
            line,
            "{counts}: the numbers seem to have decimal commas"
        )
        .help("write numbers with a point");
    }
    let (place, label) = match (cells.get(columns), cells.last()) {
        (Some(extra), _) => (extra.place.start..line.end - line.start, "beyond the last column"),
        (None, Some(last)) => (last.place.clone(), "the last value"),
        (None, None) => (0..line.end - line.start, "the last value"),
    };
    error("ragged-row", counts, &line.part(place)).label(label)
}

/// A finite number as written in a cell.
///
/// # Errors
/// Code and fact: `not-a-number`, `not-finite` or `decimal-comma`.
pub fn number(text: &str) -> Result<f64, (&'static str, String)> {
    let parse = |text: &str| fast_float2::parse::<f64, _>(text);
    let comma = || text.matches(',').count() == 1 && parse(&text.replace(',', ".")).is_ok();
    Err(match parse(text) {
        Ok(number) if number.is_finite() => return Ok(number),
        Ok(_) => ("not-finite", format!("`{text}` is not a finite number")),
        Err(_) if text.is_empty() => {
            ("not-a-number", "the cell is empty; expected a number".to_string())
        }
        Err(_) if comma() => (
            "decimal-comma",
            format!("`{text}` has a decimal comma; numbers are written with a point"),
        ),
        Err(_) => ("not-a-number", format!("`{}` is not a number", shortened(text))),
    })
}

/// Cell text for a message, shortened, since a cell can be as long as the file.
pub fn shortened(text: &str) -> String {
    const MOST: usize = 40;
    if text.chars().count() <= MOST {
        text.to_string()
    } else {
        text.chars().take(MOST).chain(['…']).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn places_leave_out_quotes_and_blanks() {
        let line = "a, \"b, c\" ,,\"d \"\"e\"\"\"";
        let cells = split(line).expect("well formed");
        let text: Vec<_> =
            cells.iter().map(|cell| (cell.text.as_str(), &line[cell.place.clone()])).collect();
        assert_eq!(text, [("a", "a"), ("b, c", "b, c"), ("", ""), ("d \"e\"", "d \"\"e\"\"")]);
        assert!(split("\"a").is_err() && split("\"a\"b,c").is_err());
        assert_eq!(split("").map(|cells| cells.len()), Ok(1));
        assert_eq!(split("a,").map(|cells| cells.len()), Ok(2));
    }

    #[test]
    fn names_and_units() {
        let unit = |text| name_and_unit(text).1.map(|range: Range<usize>| &text[range]);
        assert_eq!((name_and_unit("Y_1R [kN]").0, unit("Y_1R [kN]")), ("Y_1R", Some("kN")));
        assert_eq!((name_and_unit("v[0] [m/s]").0, unit("v[0] [m/s]")), ("v[0]", Some("m/s")));
        assert_eq!((name_and_unit("plain").0, unit("plain")), ("plain", None));
        assert_eq!((name_and_unit("[").0, unit("[")), ("[", None));
        assert_eq!((name_and_unit("]").0, unit("]")), ("]", None));
    }

    proptest! {
        /// Lines written by the `csv` crate are split as the crate reads them.
        #[test]
        fn splits_as_the_csv_crate(cells in prop::collection::vec(r#"[a-z",; é]{0,6}"#, 1..6)) {
            let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
            writer.write_record(&cells).expect("in memory");
            let bytes = writer.into_inner().expect("in memory");
            let line = String::from_utf8(bytes).expect("UTF-8");
            let found: Vec<String> = split(line.trim_end_matches('\n')).expect("well formed").into_iter().map(|cell| cell.text).collect();
            let expected: Vec<String> = cells.iter().map(|cell| cell.trim().to_string()).collect();
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn any_line_is_survived(line in r#"[a,";\t \[\]é]{0,24}"#) {
            if let Ok(cells) = split(&line) {
                for cell in cells {
                    prop_assert!(line.get(cell.place.clone()).is_some());
                }
            }
            let source = crate::source::Source::new("t", line);
            headings(&source.whole(), &mut Vec::new());
        }
    }
}
