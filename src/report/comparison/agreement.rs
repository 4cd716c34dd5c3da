//! Agreement of protocols and of metrics.

use super::three;
use crate::report::document::*;
use crate::result::comparison::{Agreement, Comparison};

pub fn chapter(found: &Comparison) -> Option<Chapter> {
    if found.agreement.is_empty() {
        return None;
    }
    let mut blocks = vec![Block::text(
        "The score of a section is the largest ratio of its values and their limits; a value without a ratio, which does not reach its limit, is worse than any. The limit of a pooled estimate stands for the values of the section too. Up to 1, the section meets the requirement. Spearman's rank correlation compares the order of the scores; the sections of all campaigns are taken together. The last column counts the campaigns with the same verdict.",
    )];
    for (of, caption) in [
        ("protocols", "Agreement of protocols over the sections"),
        ("metrics", "Agreement of the metrics of a protocol over the sections"),
    ] {
        let rows: Vec<Vec<Cell>> =
            found.agreement.iter().filter(|one| one.of == of).map(row).collect();
        if !rows.is_empty() {
            let table = Table::new(caption)
                .when(of == "metrics", |table| table.text("Protocol"))
                .text("A")
                .text("B")
                .numbers(["Sections", "Both met", "A only", "B only", "Neither", "Spearman"])
                .when(of == "protocols", |table| table.number("Same verdict"))
                .rows(rows);
            blocks.push(table.into());
        }
    }
    Some(Chapter::new("agreement", "Agreement", blocks))
}

fn row(one: &Agreement) -> Vec<Cell> {
    let mut row = Vec::new();
    if one.of == "metrics" {
        row.push((&one.protocol).into());
    }
    row.extend([Cell::sentence(&one.a), Cell::sentence(&one.b), one.sections.into()]);
    match one.contingency {
        Some([[both, a], [b, neither]]) => row.extend([both, a, b, neither].map(Cell::from)),
        None => row.extend([Cell::MISSING; 4]),
    }
    row.push(match (one.spearman, &one.reason) {
        (None, Some(reason)) => Cell::sentence(reason.text()),
        (spearman, _) => three(spearman),
    });
    if let Some(verdicts) = one.verdicts {
        let (same, all) = (
            (0..3).map(|at| verdicts[at][at]).sum::<usize>(),
            verdicts.iter().flatten().sum::<usize>(),
        );
        row.push(format!("{same} of {all}").into());
    }
    row
}
