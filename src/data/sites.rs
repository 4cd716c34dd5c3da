//! Sections of the same site: the same stretch of track measured more than once. Sites are
//! independent, sections of one site are not.

use std::collections::HashMap;

use super::table::{Cell, Table};
use crate::data::prelude::*;

/// Columns of the section table that define the site of a section.
pub const SITE: &str = "site";
pub const REPEAT_OF: &str = "repeat of";
pub const TRACK: &str = "track";
/// Help where sections repeat each other.
const FIRST: &str = "leave `repeat of` empty for the section that was measured first";
/// Largest number of sections of a circle that are named.
const NAMED: usize = 5;
const START: &str = "start";
const END: &str = "end";
/// Two sections of one track are one site if they share at least this part of the shorter one.
/// Successive sections may share a few metres; sections that share most of their irregularities do
/// not count twice.
const SHARED: f64 = 0.5;

/// For each row, the first row of its site.
///
/// Rows belong to one site if the column `site` says so, if one is the other's `repeat of`, or if a
/// column `track` names the same track for both and they overlap by half. `site` has priority.
///
/// Problems: `unknown-section` if `repeat of` names no other row, `repeat-circle` if rows repeat
/// each other.
pub fn sites(table: &Table, problems: &mut Problems) -> Vec<usize> {
    let rows = table.rows.len();
    let site = Column::of(table, SITE);
    let mut sets = Sets((0..rows).collect());
    let mut firsts: HashMap<&str, usize> = HashMap::new();
    for (row, name) in (0..rows).filter_map(|row| Some((row, site.text(row)?))) {
        let first = *firsts.entry(name).or_insert(row);
        sets.join(first, row);
    }
    let apart =
        |a: usize, b: usize| matches!((site.text(a), site.text(b)), (Some(a), Some(b)) if a != b);
    let repeat = Column::of(table, REPEAT_OF);
    for row in 0..rows {
        let Some(cell) = repeat.cell(row) else { continue };
        match table.row_named(&cell.value) {
            Some(other) if other != row => {
                if !apart(row, other) {
                    sets.join(other, row);
                }
            }
            _ => problems.push(no_repeat(table, row, cell)),
        }
    }
    circles(table, problems);
    for (a, b) in overlaps(table) {
        if !apart(a, b) {
            sets.join(a, b);
        }
    }
    (0..rows).map(|row| sets.first(row)).collect()
}

/// What the column `site` says of a section.
pub fn site_text<'a>(table: &'a Table, section: &str) -> Option<&'a str> {
    Column::of(table, SITE).text(table.row_named(section)?)
}

/// For each row, the row that it repeats; none where `repeat of` is empty or names no other row.
pub fn originals(table: &Table) -> Vec<Option<usize>> {
    let repeat = Column::of(table, REPEAT_OF);
    let of = |row| table.row_named(&repeat.cell(row)?.value).filter(|other| *other != row);
    (0..table.rows.len()).map(of).collect()
}

/// A problem for each circle of rows, at the first of them: one of its sections must have been
/// measured first.
fn circles(table: &Table, problems: &mut Problems) {
    let originals = originals(table);
    let (names, repeat): (Vec<&Cell>, _) = (table.names().collect(), Column::of(table, REPEAT_OF));
    let name = |row: &usize| format!("`{}`", names[*row].value);
    // The walk that came to a row: 0 for none.
    let mut walked = vec![0; originals.len()];
    for row in 0..originals.len() {
        let (mut at, walk) = (row, row + 1);
        while walked[at] == 0 {
            walked[at] = walk;
            let Some(next) = originals[at] else { break };
            at = next;
        }
        if walked[at] != walk || originals[at].is_none() {
            continue;
        }
        let onwards = std::iter::successors(originals[at], |next| originals[*next]);
        let mut circle = vec![at];
        circle.extend(onwards.take_while(|next| *next != at));
        let first = (0..circle.len()).min_by_key(|place| circle[*place]).unwrap_or(0);
        circle.rotate_left(first);
        let mut told: Vec<String> = circle.iter().take(NAMED).map(name).collect();
        if circle.len() > NAMED {
            told.push(format!("... ({} sections)", circle.len()));
        }
        told.push(name(&circle[0]));
        let at = repeat.cell(circle[0]).map(|cell| cell.span.clone());
        problems.push(
            Problem {
                at,
                ..Problem::error(
                    "repeat-circle",
                    format!("sections repeat each other: {}", told.join(" repeats ")),
                )
            }
            .help(FIRST),
        );
    }
}

fn no_repeat(table: &Table, row: usize, cell: &Cell) -> Problem {
    let name = &cell.value;
    if table.row_named(name) == Some(row) {
        return problem!("repeat-circle", &cell.span, "`{name}` repeats itself").help(FIRST);
    }
    let others = table.names().enumerate().filter(|(other, _)| *other != row);
    let problem = problem!(
        "unknown-section",
        &cell.span,
        "`{REPEAT_OF}` names `{name}`, which is not another section"
    )
    .suggest(name, others.map(|(_, name)| &name.value));
    if problem.help.is_some() {
        return problem;
    }
    problem.help(format!("name the section that was measured before, or use a column `{SITE}`"))
}

/// Pairs of rows on the same named track that share at least [`SHARED`] of the shorter one.
fn overlaps(table: &Table) -> Vec<(usize, usize)> {
    let (track, start, end) =
        (Column::of(table, TRACK), Column::of(table, START), Column::of(table, END));
    let extent = |row| Some((track.text(row)?, start.number(row)?, end.number(row)?));
    let mut known: Vec<(usize, (&str, f64, f64))> =
        (0..table.rows.len()).filter_map(|row| Some((row, extent(row)?))).collect();
    known.sort_by(|(_, a), (_, b)| a.0.cmp(b.0).then(a.1.total_cmp(&b.1)));
    let mut found = Vec::new();
    for (at, (row, (name, low, high))) in known.iter().enumerate() {
        for (other, (track, start, end)) in &known[at + 1..] {
            if track != name || start >= high {
                break;
            }
            if high.min(*end) - start >= SHARED * (high - low).min(end - start) {
                found.push((*row.min(other), *row.max(other)));
            }
        }
    }
    found
}

/// An optional column.
struct Column<'a> {
    table: &'a Table,
    index: Option<usize>,
}

impl<'a> Column<'a> {
    fn of(table: &'a Table, name: &str) -> Self {
        Self { table, index: table.column(name) }
    }

    /// A non-empty cell.
    fn cell(&self, row: usize) -> Option<&'a Cell> {
        self.table.cell(row, self.index?).filter(|cell| !cell.value.trim().is_empty())
    }

    fn text(&self, row: usize) -> Option<&'a str> {
        self.cell(row).map(|cell| cell.value.trim())
    }

    fn number(&self, row: usize) -> Option<f64> {
        self.text(row)?.parse().ok().filter(|number: &f64| number.is_finite())
    }
}

/// Disjoint sets of rows, each named by its first row.
struct Sets(Vec<usize>);

impl Sets {
    fn first(&self, mut row: usize) -> usize {
        while self.0[row] != row {
            row = self.0[row];
        }
        row
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn of(text: &str) -> (Vec<usize>, Problems) {
        let mut problems = Problems::default();
        let table = Table::parse(
            Source::new("sections.csv", text),
            String::new(),
            Some("section"),
            &mut problems,
        )
        .expect("a table");
        let found = sites(&table, &mut problems);
        (found, problems)
    }

    #[test]
    fn a_repeat_of_a_repeat_is_no_circle() {
        let table = |of: [&str; 5]| {
            let rows = ["A", "B", "C", "D", "E"]
                .iter()
                .zip(of)
                .map(|(name, of)| format!("{name},{of}\n"))
                .collect::<String>();
            super::tests::of(&format!("section,repeat of\n{rows}")).1.0
        };
        assert_eq!(table(["", "A", "B", "B", ""]), []);
        let says = |of| {
            table(of).into_iter().map(|problem| (problem.code, problem.says)).collect::<Vec<_>>()
        };
        // C leads into a circle and is no part of it.
        let circle =
            |names: &str| ("repeat-circle", format!("sections repeat each other: {names}"));
        assert_eq!(
            says(["B", "A", "B", "E", "D"]),
            [circle("`A` repeats `B` repeats `A`"), circle("`D` repeats `E` repeats `D`")]
        );
        assert_eq!(
            says(["C", "A", "B", "A", ""]),
            [circle("`A` repeats `C` repeats `B` repeats `A`")]
        );
        assert_eq!(says(["C", "D", "D", "C", ""]), [circle("`C` repeats `D` repeats `C`")]);
        // A leads into it at D, and B stands first in the table.
        assert_eq!(says(["D", "D", "", "B", ""]), [circle("`B` repeats `D` repeats `B`")]);
        let all = (0..9).map(|row| format!("S{row},S{}\n", (row + 1) % 9)).collect::<String>();
        let found = of(&format!("section,repeat of\n{all}")).1.0;
        let says = found.first().map(|problem| problem.says.as_str());
        assert_eq!(
            says,
            Some(
                "sections repeat each other: `S0` repeats `S1` repeats `S2` repeats `S3` repeats `S4` repeats ... (9 sections) repeats `S0`"
            )
        );
    }

    #[test]
    fn without_a_column_for_it_each_section_is_a_site() {
        assert_eq!(of("section,start [m],end [m]\nA,0,9\nB,0,9\n").0, [0, 1]);
    }

    #[test]
    fn repeats_of_repeats_are_of_one_site() {
        let (found, problems) = of("section,repeat of\nA,B\nB,C\nC,\nD,\nE,D\n");
        assert_eq!((found, problems.0.len()), (vec![0, 0, 0, 3, 3], 0));
        // Repeats of each other are also one site.
        assert_eq!(of("section,repeat of\nA,B\nB,A\n").0, [0, 0]);
    }

    #[test]
    fn the_column_site_is_believed_before_the_others() {
        assert_eq!(of("section,site,repeat of\nA,x,\nB,y,A\nC,x,\nD,,B\n").0, [0, 1, 0, 1]);
    }

    #[test]
    fn sections_of_one_track_that_share_half_are_one_site() {
        let rows = "section,track,start [m],end [m]\nA,up,0,100\nB,up,50,200\nC,up,190,290\nD,down,0,100\nE,,0,100\n";
        assert_eq!(of(rows).0, [0, 0, 2, 3, 4]);
    }

    #[test]
    fn a_repeat_of_no_section_is_told() {
        for (text, code, help) in [
            ("section,repeat of\nS01,\nS02,S10\n", "unknown-section", "did you mean `S01`?"),
            ("section,repeat of\nS01,another\n", "unknown-section", "name the"),
            ("section,repeat of\nS01,S01\n", "repeat-circle", "leave `repeat of` empty"),
        ] {
            let problems = of(text).1.0;
            assert_eq!((problems.len(), problems[0].code), (1, code));
            assert!(
                problems[0].help.as_ref().is_some_and(|found| found.starts_with(help)),
                "{problems:?}"
            );
        }
    }
}
