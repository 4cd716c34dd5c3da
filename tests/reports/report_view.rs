//! What both reports print: sorted, rounded, worded; the templates get no number to calculate with.

use crate::common::document::{
    figures as drawings, key_facts, of_part, on_screen, parts, row, sentences, table, tables,
    titles,
};
use crate::common::{assessment, certification};
use fishplate::report::document::{Document, Medium, Tone};
use fishplate::report::figure::figures;
use fishplate::report::html::html;
use fishplate::report::view::document;
use fishplate::result::{
    Certification, Kind, Outcome, Reason, Remark, RulePlace, Subject, Verdict, VerdictResult,
};

fn data() -> Document {
    on_screen(&certification::certification())
}

/// What templates get as numbers is about the layout: sizes, widths, spans.
#[test]
fn numbers_reach_the_templates_as_text() {
    const LAYOUT: [&str; 7] = ["size", "inset", "widths", "breaks", "across", "down", "height"];
    fn walk(key: &str, value: &serde_json::Value) {
        match value {
            serde_json::Value::Number(number) => {
                assert!(LAYOUT.contains(&key), "{key}: {number}");
            }
            serde_json::Value::Array(items) => items.iter().for_each(|item| walk(key, item)),
            serde_json::Value::Object(map) => map.iter().for_each(|(key, item)| walk(key, item)),
            _ => {}
        }
    }
    for found in
        [certification::certification(), assessment::certification(), certification::empty()]
    {
        for medium in [Medium::Paper, Medium::Screen] {
            let value = serde_json::to_value(document(&found).on(medium)).expect("plain data");
            walk("", &value);
        }
    }
}

const SUMMARY: &str = "Mean and standard deviation of the differences";

#[test]
fn the_summary_has_a_row_for_each_quantity_and_the_rest_stands_apart() {
    let data = data();
    let summary = table(&data, SUMMARY);
    assert_eq!(summary.rows.len(), 12);
    assert_eq!(table(&data, "Further statistics").rows.len(), 4, "one for each zone of the metric");
    let column = |title: &str| summary.printed(title);
    assert_eq!(
        (
            column("Limit std")[0].as_str(),
            column("Limit mean")[0].as_str(),
            column("Pairs / n")[0].as_str()
        ),
        ("5.00", "3.33", "124 / 62")
    );
    let fails: Vec<String> = summary
        .rows
        .iter()
        .filter(|row| row.tone == Some(Tone::Bad))
        .map(|row| row.cells[0].printed().letters())
        .collect();
    assert_eq!(fails, [certification::certification().quantities[4].symbol.clone()]);
    assert_eq!(certification::certification().quantities[4].id, "Y_max");
    assert_eq!((column("Mean")[9].as_str(), column("Std / limit")[9].as_str()), ("–", "–"));
    assert!(column("Criterion")[9].starts_with("? not assessed"), "{:?}", column("Criterion"));
}

#[test]
fn a_value_just_beyond_its_limit_is_printed_so() {
    let mut found = certification::certification();
    let statistic = &mut found.quantities[0].statistics[0];
    (statistic.value, statistic.normalised, statistic.holds) =
        (Some(5.00004), Some(1.000_008), Some(false));
    let data = on_screen(&found);
    let summary = table(&data, SUMMARY);
    assert_eq!(
        (summary.printed("Std")[0].as_str(), summary.printed("Std / limit")[0].as_str()),
        ("5.00004", "1.00001")
    );
}

#[test]
fn worst_pairs_come_largest_first() {
    let data = data();
    let all = tables(&data, "Largest ");
    assert!(all.len() > 10);
    for worst in &all {
        let title = if titles(worst).contains(&"Value") { "Value" } else { "Difference" };
        let size = |text: &String| text.replace('−', "-").parse::<f64>().expect("a number").abs();
        let sizes: Vec<f64> = worst.printed(title).iter().map(size).collect();
        assert!(sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
    }
    let caption = all[0].caption.letters();
    assert!(caption.ends_with("and divided by the limit of the standard deviation (n-1)"));
}

/// How many values the tables of a quantity have.
fn cells_of_values(of: &Document) -> usize {
    tables(of, "All values")
        .iter()
        .map(|table| {
            let before =
                titles(table).into_iter().filter(|it| ["Section", "Record", "Zone"].contains(it));
            let numbers = table.columns.len() - before.count();
            let signals = if titles(table).contains(&"diff.") { numbers / 3 } else { numbers };
            signals * table.rows.len()
        })
        .sum()
}

#[test]
fn every_value_stands_in_a_block() {
    let (data, found) = (data(), certification::certification());
    for (part, result) in parts(&data).into_iter().zip(&found.quantities) {
        assert_eq!(cells_of_values(&of_part(part)), result.values.len(), "{}", part.title);
    }
}

#[test]
fn sections_are_gathered_by_zone() {
    let data = data();
    let page = html(&data, &[]).expect("a page");
    for title in [
        "Zone 1: Straight track and very large radius",
        "Zone 2: Large radius curves",
        "Zone 3: Small radius curves",
        "Zone 4: Very small radius curves",
    ] {
        assert!(page.contains(&format!("<h3>{title}</h3>")), "{title}");
    }
    let zones = tables(&data, "Sections of this zone");
    assert_eq!(zones.iter().map(|table| table.rows.len()).collect::<Vec<_>>().len(), 4);
    assert_eq!(zones.iter().map(|table| table.rows.len()).sum::<usize>(), 33);
    assert_eq!(zones[0].printed("radius")[0], "–", "straight track has no radius");
    let heads = page.split("<caption>Sections of this zone</caption>").nth(2).unwrap_or_default();
    assert!(heads.contains("<th scope=\"col\" class=\"number\">radius"), "{heads:.600}");
}

/// A judgement that is open is told apart from data that are missing, by sign, word and sentence.
#[test]
fn what_a_person_decides_is_no_lack_of_data() {
    let verdict = |name: &str, outcome: Outcome| VerdictResult {
        name: name.into(),
        title: name.into(),
        overall: name == "model",
        outcome,
        word: outcome.word(&["sufficient".into(), "not sufficient".into()]).into(),
        words: ["sufficient".into(), "not sufficient".into()],
        criterion: String::new(),
        reasons: vec![if outcome == Outcome::NotAssessable {
            Reason::NoSectionUsed { group: None }
        } else {
            Reason::ToBeJudged { person: "the engineer".into() }
        }],
        judged_by: (outcome == Outcome::Open).then(|| "the engineer".into()),
        clause: None,
        source: None,
        notes: Vec::new(),
        rule: RulePlace { file: "protocol.fp".into(), line: 7 },
    };
    let of = |overall: Outcome, part: Outcome| {
        let mut found = certification::certification();
        found.verdict = Verdict::NotAssessable;
        found.own_word = Some(overall.word(&["sufficient".into(), "not sufficient".into()]).into());
        found.verdicts = vec![verdict("model", overall), verdict("part", part)];
        found.reasons = found.verdicts[0].reasons.clone();
        found
    };
    let viewed = |overall: Outcome, part: Outcome| on_screen(&of(overall, part));
    let result = |data: &Document| {
        let result = data.cover.clone().expect("a cover").result;
        (result.finding.sign, result.finding.word, result.sentence)
    };
    let findings = |data: &Document| table(data, "Findings").rows.len();
    // A verdict over others that is not assessable only since one of them is open.
    let mut over = of(Outcome::NotAssessable, Outcome::Open);
    over.verdicts[0].reasons =
        vec![Reason::ToBeJudged { person: "the engineer".into() }.about(Subject::Verdict, "part")];
    over.reasons = over.verdicts[0].reasons.clone();
    assert_eq!(result(&on_screen(&over)).1, "to be judged");
    let open = viewed(Outcome::Open, Outcome::Open);
    let (sign, word, sentence) = result(&open);
    assert_eq!((sign, word.as_str()), ("○", "to be judged"));
    assert!(table(&open, "Verdicts").printed("Result")[1].starts_with('○'));
    assert!(sentence.contains("a person has yet to judge") && findings(&open) == 4);
    let lacking = viewed(Outcome::NotAssessable, Outcome::NotAssessable);
    let (sign, word, sentence) = result(&lacking);
    assert_eq!((sign, word.as_str()), ("?", "not assessable"));
    assert!(sentence.ends_with("are missing.") && findings(&lacking) == 3);
    let both = result(&viewed(Outcome::NotAssessable, Outcome::Open)).2;
    assert!(both.ends_with("Judgements are open as well."), "{both}");
}

/// Units, signs and limits read the same in sentences and in tables.
#[test]
fn sentences_are_printed_as_tables_are() {
    let mut found = certification::certification();
    found.notes = vec![Remark::Said { says: "0.2 m/s^2 where -3 1/m <= x".into() }];
    found.quantities[0].statistics[0].normalised = Some(3e40);
    let data = on_screen(&found);
    assert!(sentences(&data).contains(&"0.2 m/s² where −3 m⁻¹ ≤ x".to_owned()));
    let statistics = table(&data, "Statistics of");
    assert_eq!(statistics.printed("|Value| / limit")[0], ">\u{a0}1000");
    let limits = statistics.printed("Limit as worded");
    assert!(limits.iter().any(|limit| limit == "2/3 of the limit of std"), "{limits:?}");
    // Of wanted operation, the cover tells how much is covered.
    let wanted = ("Wanted operation".to_owned(), "1 of 4 points inside".to_owned());
    assert!(key_facts(&data).contains(&wanted));
}

#[test]
fn many_reasons_are_listed_in_the_summary_only() {
    let mut found = certification::certification();
    found.reasons = (0..20).map(|at| Reason::said(format!("reason {at}"))).collect();
    let mut paper = document(&found).on(Medium::Paper);
    let reasons =
        |data: &Document| sentences(data).iter().filter(|says| says.starts_with("reason ")).count();
    assert!(sentences(&paper).contains(&"All 20 reasons are listed in the summary.".to_owned()));
    assert_eq!(reasons(&paper), 8 + 20, "cover and summary");
    paper.chapters.clear();
    assert_eq!(reasons(&paper), 8);
    assert_eq!(reasons(&on_screen(&found)), 20, "a page has them on its cover");
}

#[test]
fn an_assessment_has_a_row_for_each_limit_and_a_table_for_each_with_groups() {
    let data = on_screen(&assessment::certification());
    assert!(tables(&data, SUMMARY).is_empty() && tables(&data, "Further statistics").is_empty());
    let estimates = table(&data, "Estimates and their limits");
    let of = |at: usize| {
        let column = |title: &str| estimates.printed(title)[at].clone();
        let criterion = column("Criterion");
        let word = criterion.split(':').next().unwrap_or_default().to_owned();
        [column("Groups met"), column("Where"), column("|Value| / limit"), word]
    };
    let expected = [
        ["15 of 16", assessment::FAILS, "1.09", "✗ not met"],
        ["15 of 16; 1 not assessed", "zone 1, wheelset 1", "0.65", "? not assessed"],
        ["1 of 1", "all", "0.58", "✓ met"],
    ];
    assert_eq!(estimates.rows.len(), 3);
    for (at, expected) in expected.into_iter().enumerate() {
        assert_eq!(of(at), expected);
    }
    let quantity = of_part(parts(&data)[0]);
    assert_eq!(table(&quantity, "Statistics of").rows.len(), 1, "the limit of every value");
    let groups = tables(&quantity, ", limit ");
    assert_eq!(groups.iter().map(|table| table.rows.len()).collect::<Vec<_>>(), [16, 16]);
    assert_eq!(titles(groups[0])[..2], ["Zone", "Wheelset"]);
    assert_eq!(row(groups[0], 8)[..2], ["3", "1"]);
    let column = |title: &str| groups[0].printed(title)[8].clone();
    assert_eq!([column("Mean"), column("s"), column("Estimate")], ["23.25", "2.00", "50.00"]);
    assert_eq!(data.title.split_once(':').map(|(report, _)| report), Some("Assessment report"));
    let cover = data.cover.as_ref().expect("a cover");
    assert_eq!(cover.result.finding.word, "requirements not met");
    assert!(!sentences(&data).iter().any(|says| says.starts_with("Simulation: ")));
}

#[test]
fn values_of_several_records_have_a_row_each() {
    let found = assessment::certification();
    let quantity = of_part(parts(&on_screen(&found))[0]);
    assert_eq!(cells_of_values(&quantity), found.quantities[0].values.len());
    assert_eq!(table(&quantity, "All values").printed("Record")[..2], ["first run", "second run"]);
}

/// Signals that are evaluated in different sections have a table each.
#[test]
fn a_table_of_values_is_not_half_empty() {
    let mut found = certification::certification();
    let quantity = &mut found.quantities[0];
    let first = quantity.values[0].section.clone();
    let signals: Vec<String> = quantity
        .values
        .iter()
        .filter(|pair| pair.section == first)
        .map(|pair| pair.signal.clone())
        .collect();
    let signals_by_table = |found: &Certification| {
        let quantity = of_part(parts(&on_screen(found))[0]);
        let count = |title: &&&str| **title == "diff.";
        let all = tables(&quantity, "All values");
        all.into_iter().map(|table| titles(table).iter().filter(count).count()).collect::<Vec<_>>()
    };
    assert_eq!(signals_by_table(&found), [signals.len()]);
    let last = signals.last().expect("a signal");
    found.quantities[0].values.retain(|pair| (&pair.signal == last) == (pair.section == first));
    assert_eq!(signals_by_table(&found), [1, signals.len() - 1]);
}

/// Repeats are compared with originals, and nothing says that the one is simulated.
#[test]
fn repeats_and_originals_are_called_so() {
    let mut found = certification::certification();
    found.quantities.truncate(2);
    for quantity in &mut found.quantities {
        quantity.repeats = true;
        // Notes are words of the protocol.
        quantity.notes.clear();
        quantity.comparison = "|repeat| - |original|".into();
    }
    found.traces.retain(|trace| {
        trace.quantity == found.quantities[0].id || trace.quantity == found.quantities[1].id
    });
    assert_eq!((found.kind(), found.verdict_words()), (Kind::Comparison, "requirements not met"));
    let data = on_screen(&found);
    assert_eq!(data.cover.as_ref().expect("a cover").over, "Comparison of measured records");
    assert!(!sentences(&data).iter().any(|says| says.starts_with("Simulation: ")));
    let heads = titles(table(&data, "Largest "));
    assert!(heads.contains(&"Repeat") && heads.contains(&"Original"), "{heads:?}");
    let heads = titles(table(&data, "All values"));
    assert!(heads.contains(&"rep.") && heads.contains(&"orig."), "{heads:?}");
    let named = |name: &'static str| {
        drawings(&data).into_iter().filter(move |figure| figure.name.starts_with(name))
    };
    let caption = named("pairs-0").next().expect("a figure").caption.letters();
    assert!(caption.contains("repeats against originals"), "{caption}");
    assert!(named("trace").all(|figure| figure.alt.starts_with("Repeat and original")));
    let meanings = table(&data, "Sign of the differences").printed("Meaning");
    assert_eq!(meanings.len(), 1);
    assert!(meanings[0].starts_with("Positive: the magnitude of the repeat is larger."));
    for (name, drawing) in figures(&found)
        .into_iter()
        .filter(|(name, _)| name.starts_with("pairs") || name.starts_with("trace"))
    {
        let words = [">repeat", ">original", ": repeat ", ", original "];
        assert!(
            words[..2].iter().all(|word| drawing.contains(word))
                || words[2..].iter().all(|word| drawing.contains(word)),
            "{name}"
        );
        assert!(!drawing.contains(">simulated") && !drawing.contains(">measured"), "{name}");
    }
    let page = html(&data, &figures(&found)).expect("a page");
    // The class of a curve is for scripts.
    let told =
        page.split("id=\"protocol\"").next().unwrap_or_default().replace("\"curve simulated\"", "");
    for word in ["simulated", "Simulated", ">sim.<"] {
        assert!(
            !told.contains(word),
            "{word}: {:?}",
            told.find(word).map(|at| &told[at.saturating_sub(120)..at + 80])
        );
    }
}

/// The kind follows from the quantities: several of different kinds are mixed; records among
/// themselves are no validation.
#[test]
fn words_follow_what_the_quantities_are() {
    let mut found = certification::certification();
    let word = |found: &Certification| {
        let data = on_screen(found);
        let facts: Vec<String> = key_facts(&data).into_iter().map(|(name, _)| name).collect();
        let report = data.title.split(':').next().unwrap_or_default().to_owned();
        let word = data.cover.expect("a cover").result.finding.word;
        [report, word, facts.join(", ")]
    };
    let facts = |rows: &str| {
        format!("Criteria by quantity, Sections, {rows}, Wanted operation, Test zones")
    };
    assert_eq!(
        word(&found),
        ["Validation report".into(), "not validated".into(), facts("Pairs per quantity")]
    );
    found.quantities.extend(assessment::certification().quantities);
    assert_eq!(
        word(&found),
        [
            "Validation and assessment report".into(),
            "requirements not met".into(),
            facts("Pairs per quantity, Assessed values")
        ]
    );
    found.quantities.truncate(2);
    found.quantities.iter_mut().for_each(|quantity| quantity.among = Some("simulated".into()));
    assert_eq!(
        word(&found),
        ["Comparison report".into(), "requirements not met".into(), facts("Compared values")]
    );
    let data = on_screen(&found);
    assert_eq!(data.cover.as_ref().expect("a cover").over, "Comparison of simulation codes");
    let heads = titles(table(&data, "Largest "));
    assert!(heads.contains(&"Record") && heads.contains(&"All records"), "{heads:?}");
    assert!(!sentences(&data).iter().any(|says| says.starts_with("Measurement: ")));
}

/// A table on paper and on a screen: columns of one medium, columns that are empty, cells that are
/// the same as above.
#[test]
fn each_medium_prints_its_columns() {
    let found = certification::certification();
    let (paper, screen) = (document(&found).on(Medium::Paper), on_screen(&found));
    let [on_paper, on_screen] =
        [&paper, &screen].map(|data| titles(table(data, "Statistics of")).join("; "));
    assert!(on_paper.contains("95 % interval; Limit") && !on_paper.contains("Unit"), "{on_paper}");
    assert!(on_screen.contains("Unit") && on_screen.contains("interval, low; high"), "{on_screen}");
    let worst = titles(table(&screen, "Largest "));
    assert!(!worst.contains(&"Record") && worst.contains(&"Zone"), "{worst:?}");
    let filters = |data: &Document| table(data, "Further statistics").printed("Filter");
    assert!(filters(&screen).iter().all(|filter| !filter.is_empty()));
    assert!(filters(&paper)[1..].iter().all(String::is_empty), "{:?}", filters(&paper));
}
