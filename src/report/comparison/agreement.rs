//! Agreement of protocols and of metrics.

use super::{table, three};
use crate::report::number;
use crate::report::study::{Chapter, Head, Item};
use crate::result::comparison::{Agreement, Comparison};

pub fn chapter(found: &Comparison) -> Option<Chapter> {
    if found.agreement.is_empty() {
        return None;
    }
    let mut items = vec![Item::text(
        "The score of a section is the largest ratio of its values and their limits. The limit of a pooled estimate stands for the values of the section too. Up to 1, the section meets the requirement. Spearman's rank correlation compares the order of the scores; the sections of all campaigns are taken together. The last column counts the campaigns with the same verdict.",
    )];
    for (of, caption) in [
        ("protocols", "Agreement of protocols over the sections"),
        ("metrics", "Agreement of the metrics of a protocol over the sections"),
    ] {
        let rows: Vec<Vec<String>> =
            found.agreement.iter().filter(|one| one.of == of).map(row).collect();
        if !rows.is_empty() {
            items.push(table(caption, head(of), rows));
        }
    }
    Some(Chapter { id: "agreement".into(), title: "Agreement".into(), items })
}

fn head(of: &str) -> Vec<Head> {
    let mut head = vec![];
    if of == "metrics" {
        head.push(Head::text("Protocol"));
    }
    head.extend([
        Head::text("A"),
        Head::text("B"),
        Head::number("Sections"),
        Head::number("Both met"),
        Head::number("A only"),
        Head::number("B only"),
        Head::number("Neither"),
        Head::number("Spearman"),
    ]);
    if of == "protocols" {
        head.push(Head::number("Same verdict"));
    }
    head
}

fn row(one: &Agreement) -> Vec<String> {
    let mut row: Vec<String> = if one.of == "metrics" {
        vec![one.protocol.clone().unwrap_or_default()]
    } else {
        Vec::new()
    };
    row.extend([one.a.clone(), one.b.clone(), one.sections.to_string()]);
    match one.contingency {
        Some([[both, a], [b, neither]]) => {
            row.extend([both, a, b, neither].map(|count| count.to_string()))
        }
        None => row.extend([number::NONE; 4].map(str::to_owned)),
    }
    row.push(if one.spearman.is_some() {
        three(one.spearman)
    } else {
        one.reason.clone().unwrap_or_else(|| number::NONE.to_owned())
    });
    if let Some(verdicts) = one.verdicts {
        let (same, all) = (
            (0..3).map(|at| verdicts[at][at]).sum::<usize>(),
            verdicts.iter().flatten().sum::<usize>(),
        );
        row.push(format!("{same} of {all}"));
    }
    row
}
