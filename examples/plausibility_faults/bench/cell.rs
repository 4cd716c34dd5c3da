//! Faults of single cells of the files.

use super::Kind;
use super::fault::{Draw, Fault, Size, Told, own};
use super::folder::{Folder, SECTIONS, Side};
use super::signal::each;

/// Codes of a cell that is not a number, in records and tables, and of a section whose record
/// cannot be read.
const NUL: &[&str] = &["not-a-number", "unreadable", "said", "wrong-cell", "nul-bytes"];
const CELL: &[&str] = &["not-a-number", "unreadable", "said"];
const SPIKES: &[&str] = &["spikes"];
const NEAR_ZERO: &[&str] = &["unloaded", "interrupted", "spikes"];

pub const KINDS: &[Kind] = &[
    ("NUL bytes in a cell", |draw, folder| {
        in_cell(draw, folder, "NUL bytes in a cell of", NUL, |cell| {
            let middle = cell.len() / 2;
            format!("{}\0{}", &cell[..middle], &cell[middle + 1..])
        })
    }),
    ("NUL bytes for a number", |draw, folder| {
        in_cell(draw, folder, "NUL bytes for a number of", NUL, |cell| "\0".repeat(cell.len()))
    }),
    ("NUL bytes behind a number", |draw, folder| {
        in_cell(draw, folder, "NUL bytes behind a number of", NUL, |cell| format!("{cell}\0\0"))
    }),
    ("NUL bytes in the table", |draw, folder| {
        let section = draw.of(&folder.sections("")).clone();
        let column = *draw.of(&["speed", "cant", "end"]);
        Fault {
            says: format!("NUL bytes behind {column} of {section}"),
            size: Size::Fact(1.0),
            told: Told { sections: vec![section.clone(), SECTIONS.into()], channels: Vec::new() },
            right: NUL,
            put: Box::new(move |folder, _| folder.cell(&section, column).push('\0')),
        }
    }),
    ("Q near zero", |draw, folder| near_zero(draw, folder, 0.6)),
    ("Q near zero in a section", |draw, folder| near_zero(draw, folder, 0.0)),
    ("a lost decimal point", |draw, folder| {
        let seed = draw.seed();
        let (channel, side, sections) = (draw.channel(), draw.side(), draw.sections(folder, 0.6));
        Fault {
            says: format!(
                "{channel} {} in {} section(s): decimal points lost in cells",
                side.in_words(),
                sections.len()
            ),
            size: Size::Drawn((1 + draw.0.below(6)) as f64),
            told: super::fault::concerned(folder, &sections, own(&channel)),
            right: SPIKES,
            put: Box::new(move |folder, count| {
                folder.channel(side, &sections, &channel, |values, _, n| {
                    let mut random = fishplate::effects::Gauss::new(seed + n as u64);
                    let mut changed = values.to_vec();
                    for _ in 0..count as usize {
                        let at = values.len() / 4 + random.below(values.len() / 2);
                        changed[at] *= 100.0;
                    }
                    changed
                });
            }),
        }
    }),
    ("an empty cell", |draw, folder| {
        in_cell(draw, folder, "an empty cell of", CELL, |_| String::new())
    }),
    ("a word for a number", |draw, folder| {
        let word = *draw.of(&["NaN", "inf", "-", "#REF!", "OVL", "1e999", "---"]);
        in_cell(draw, folder, &format!("{word} in a cell of"), CELL, move |_| word.to_string())
    }),
    ("turned cells", |draw, folder| {
        let seed = draw.seed();
        let (kind, side, sections) =
            (*draw.of(&["Q", "Y"]), draw.side(), draw.sections(folder, 0.6));
        let channel = draw.channel_of(kind);
        Fault {
            says: format!(
                "{channel} {} in {} section(s): signs lost in cells",
                side.in_words(),
                sections.len()
            ),
            size: Size::Drawn((2 + draw.0.below(20)) as f64),
            told: super::fault::concerned(folder, &sections, own(&channel)),
            right: SPIKES,
            put: Box::new(move |folder, count| {
                folder.channel(side, &sections, &channel, |values, _, n| {
                    let mut random = fishplate::effects::Gauss::new(seed + n as u64);
                    let cells: Vec<usize> = (0..count as usize)
                        .map(|_| values.len() / 4 + random.below(values.len() / 2))
                        .collect();
                    each(values, |n, value| if cells.contains(&n) { -value } else { value })
                });
            }),
        }
    }),
];

/// A cell of a channel inside a section.
fn in_cell(
    draw: &mut Draw,
    folder: &Folder,
    says: &str,
    right: &'static [&'static str],
    change: impl Fn(&str) -> String + Send + Sync + 'static,
) -> Fault {
    let (side, section, channel) =
        (draw.side(), draw.of(&folder.sections("")).clone(), draw.channel());
    let place = draw.between(0.3, 0.7);
    Fault {
        says: format!("{says} {channel} {} in {section}", side.in_words()),
        size: Size::Fact(1.0),
        told: Told { sections: vec![section.clone()], channels: Vec::new() },
        right,
        put: Box::new(move |folder, _| {
            let record = folder.record_mut(&format!("{}/{section}.csv", side.folders()[0]));
            let row = (place * record.rows() as f64) as usize;
            let column = record.column(&channel).expect("a channel");
            let decimals = record.decimals[column];
            let cell = change(&format!("{:.decimals$}", record.columns[column][row]));
            record.cells.push((row, column, cell));
        }),
    }
}

/// A vertical force falls near zero for a moment, so that Y/Q grows without bound.
fn near_zero(draw: &mut Draw, folder: &Folder, all: f64) -> Fault {
    let channel = draw.channel_of("Q");
    let (side, sections) = (
        if draw.chance(0.7) { Side::Measurement } else { Side::Simulation },
        draw.sections(folder, all),
    );
    let (place, rest) = (draw.between(0.35, 0.65), draw.log_between(0.002, 0.04));
    Fault {
        says: format!(
            "{channel} {} near zero in {} section(s) for s",
            side.in_words(),
            sections.len()
        ),
        size: Size::Sought { from: 0.06, most: 0.5 },
        told: super::fault::concerned(folder, &sections, own(&channel)),
        right: NEAR_ZERO,
        put: Box::new(move |folder, seconds| {
            folder.channel(side, &sections, &channel, |values, rate, _| {
                let from = (place * values.len() as f64) as usize;
                let long = ((seconds * rate).round() as usize).max(1);
                each(
                    values,
                    |n, value| if (from..from + long).contains(&n) { rest * value } else { value },
                )
            });
        }),
    }
}
