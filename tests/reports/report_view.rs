//! What both reports print: sorted, rounded, worded; the templates get no number to calculate with.

// Each test file uses a part of what they share.

use crate::common::{assessment, certification};
use fishplate::report::figure::figures;
use fishplate::report::html::html;
use fishplate::report::view::{ReportData, view};
use fishplate::result::{Certification, Kind, Outcome, RulePlace, Verdict, VerdictResult};

fn data() -> ReportData {
    view(&certification::certification())
}

#[test]
fn numbers_reach_the_templates_as_text() {
    fn walk(path: &str, value: &serde_json::Value) {
        match value {
            serde_json::Value::Number(number) => {
                assert!(
                    number.is_u64()
                        && (path.ends_with("/number") || path.ends_with("/graph_nodes")),
                    "{path}: {number}"
                );
            }
            serde_json::Value::Array(items) => items.iter().for_each(|item| walk(path, item)),
            serde_json::Value::Object(map) => {
                map.iter().for_each(|(key, item)| walk(&format!("{path}/{key}"), item))
            }
            _ => {}
        }
    }
    walk("", &serde_json::to_value(data()).expect("the view is plain data"));
    walk(
        "",
        &serde_json::to_value(view(&assessment::certification())).expect("the view is plain data"),
    );
    walk("", &serde_json::to_value(view(&certification::empty())).expect("the view is plain data"));
}

#[test]
fn the_summary_has_a_row_for_each_quantity_and_the_rest_stands_apart() {
    let data = data();
    assert_eq!(data.summary.len(), 12);
    assert_eq!(data.further.len(), 4, "one for each zone of the metric");
    let guiding = &data.summary[0];
    assert_eq!(
        (guiding.limit_std.as_str(), guiding.limit_mean.as_str(), guiding.count.as_str()),
        ("5.00", "3.33", "124 / 62")
    );
    let fails: Vec<&str> = data
        .summary
        .iter()
        .filter(|row| row.holds.class == "bad")
        .map(|row| row.id.as_str())
        .collect();
    assert_eq!(fails, ["Y_max"]);
    let open = &data.summary[9];
    assert_eq!(
        (open.mean.as_str(), open.normalised_std.as_str(), open.holds.word.as_str()),
        ("–", "–", "not assessed")
    );
}

#[test]
fn a_value_just_beyond_its_limit_is_printed_so() {
    let mut found = certification::certification();
    let statistic = &mut found.quantities[0].statistics[0];
    (statistic.value, statistic.normalised, statistic.holds) =
        (Some(5.00004), Some(1.000_008), Some(false));
    let row = &view(&found).summary[0];
    assert_eq!((row.std.as_str(), row.normalised_std.as_str()), ("5.00004", "1.00001"));
}

#[test]
fn worst_pairs_come_largest_first() {
    for quantity in data().quantities {
        let sizes: Vec<f64> = quantity
            .worst
            .iter()
            .map(|pair| pair.difference.replace('−', "-").parse::<f64>().expect("a number").abs())
            .collect();
        assert!(sizes.is_sorted_by(|a, b| a >= b), "{}: {sizes:?}", quantity.id);
    }
    assert_eq!(
        data().quantities[0].worst_against.as_deref(),
        Some("limit of the standard deviation (n-1)")
    );
}

#[test]
fn every_value_stands_in_a_block() {
    let found = certification::certification();
    for (quantity, result) in data().quantities.iter().zip(&found.quantities) {
        let cells: usize =
            quantity.values.iter().flat_map(|block| &block.rows).map(|row| row.cells.len()).sum();
        assert_eq!(cells, result.values.len(), "{}", quantity.id);
    }
}

#[test]
fn sections_are_gathered_by_zone() {
    let data = data();
    let titles: Vec<&str> = data.section_tables.iter().map(|table| table.title.as_str()).collect();
    assert_eq!(
        titles,
        [
            "Zone 1: Straight track and very large radius",
            "Zone 2: Large radius curves",
            "Zone 3: Small radius curves",
            "Zone 4: Very small radius curves"
        ]
    );
    assert_eq!(data.section_tables.iter().map(|table| table.rows.len()).sum::<usize>(), 33);
    let straight = &data.section_tables[0];
    let radius =
        straight.columns.iter().position(|column| column.title == "radius").expect("the column");
    assert_eq!(straight.rows[0].values[radius], "–", "straight track has no radius");
    assert!(data.section_tables[1].columns[radius].numeric);
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
        reasons: vec![
            if outcome == Outcome::NotAssessable {
                "no section is used"
            } else {
                "to be judged by the engineer"
            }
            .into(),
        ],
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
    let viewed = |overall: Outcome, part: Outcome| view(&of(overall, part));
    // A verdict over others that is not assessable only since one of them is open.
    let mut over = of(Outcome::NotAssessable, Outcome::Open);
    over.verdicts[0].reasons = vec!["part: to be judged by the engineer".into()];
    over.reasons = over.verdicts[0].reasons.clone();
    assert_eq!(view(&over).verdict.word, "to be judged");
    let open = viewed(Outcome::Open, Outcome::Open);
    assert_eq!(
        (open.verdict.sign, open.verdict.word.as_str(), open.verdicts[1].finding.sign),
        ("○", "to be judged", "○")
    );
    assert!(
        open.verdict_sentence.contains("a person has yet to judge")
            && open.notation.findings.len() == 4
    );
    let lacking = viewed(Outcome::NotAssessable, Outcome::NotAssessable);
    assert_eq!((lacking.verdict.sign, lacking.verdict.word.as_str()), ("?", "not assessable"));
    assert!(
        lacking.verdict_sentence.ends_with("are missing.") && lacking.notation.findings.len() == 3
    );
    assert!(
        viewed(Outcome::NotAssessable, Outcome::Open)
            .verdict_sentence
            .ends_with("Judgements are open as well.")
    );
}

/// Units, signs and limits read the same in sentences and in tables.
#[test]
fn sentences_are_printed_as_tables_are() {
    let mut found = certification::certification();
    found.notes = vec!["0.2 m/s^2 where -3 1/m <= x".into()];
    found.quantities[0].statistics[0].normalised = Some(3e40);
    let data = view(&found);
    assert_eq!(data.notes, ["0.2 m/s² where −3 m⁻¹ ≤ x"]);
    let statistics = &data.quantities[0].statistics;
    assert_eq!(statistics[0].normalised, ">\u{a0}1000");
    assert!(statistics.iter().any(|one| one.limit_text == "2/3 of the limit of std"));
    // Of wanted operation, the cover tells how much is covered.
    assert!(
        data.key_facts
            .iter()
            .any(|fact| fact.name == "Wanted operation" && fact.value == "1 of 4 points inside")
    );
}

#[test]
fn many_reasons_are_listed_in_the_summary_only() {
    let mut found = certification::certification();
    found.reasons = (0..20).map(|at| format!("reason {at}")).collect();
    let data = view(&found);
    assert_eq!((data.cover_reasons.len(), data.reasons.len()), (8, 20));
    assert_eq!(data.more_reasons.as_deref(), Some("All 20 reasons are listed in the summary."));
}

#[test]
fn an_assessment_has_a_row_for_each_limit_and_a_table_for_each_with_groups() {
    let data = view(&assessment::certification());
    assert!(data.summary.is_empty() && data.further.is_empty());
    let rows: Vec<(&str, &str, &str, &str)> = data
        .estimates
        .iter()
        .map(|row| {
            (
                row.holding.as_str(),
                row.place.as_str(),
                row.limited.normalised.as_str(),
                row.limited.holds.word.as_str(),
            )
        })
        .collect();
    let expected = [
        ("15 of 16", assessment::FAILS, "1.09", "not met"),
        ("15 of 16; 1 not assessed", "zone 1, wheelset 1", "0.65", "not assessed"),
        ("1 of 1", "all", "0.58", "met"),
    ];
    assert_eq!(rows, expected);
    let quantity = &data.quantities[0];
    assert_eq!(quantity.statistics.len(), 1, "the limit of every value");
    assert_eq!(quantity.groups.iter().map(|table| table.rows.len()).collect::<Vec<_>>(), [16, 16]);
    let table = &quantity.groups[0];
    assert_eq!(
        (table.keys.join(", "), table.rows[8].of.join(", ")),
        ("Zone, Wheelset".into(), "3, 1".into())
    );
    assert_eq!(
        (table.rows[8].mean.as_str(), table.rows[8].std.as_str(), table.rows[8].value.as_str()),
        ("23.25", "2.00", "50.00")
    );
    assert_eq!(data.title.split_once(':').map(|(report, _)| report), Some("Assessment report"));
    assert_eq!(
        (data.verdict.word.as_str(), data.simulation_statement),
        ("requirements not met", None)
    );
}

#[test]
fn values_of_several_records_have_a_row_each() {
    let found = assessment::certification();
    let data = view(&found);
    let blocks = &data.quantities[0].values;
    let cells: usize = blocks.iter().flat_map(|block| &block.rows).map(|row| row.cells.len()).sum();
    assert_eq!(cells, found.quantities[0].values.len());
    assert_eq!([0, 1].map(|at| blocks[0].rows[at].record.as_str()), ["first run", "second run"]);
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
    let tables = |found: &Certification| {
        view(found).quantities[0].values.iter().map(|block| block.signals.len()).collect::<Vec<_>>()
    };
    assert_eq!(tables(&found), [signals.len()]);
    let last = signals.last().expect("a signal");
    found.quantities[0].values.retain(|pair| (&pair.signal == last) == (pair.section == first));
    assert_eq!(tables(&found), [1, signals.len() - 1]);
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
    let data = view(&found);
    assert_eq!(
        (data.words.over.as_str(), &data.simulation_statement),
        ("Comparison of measured records", &None)
    );
    assert_eq!(data.quantities[0].sides.each_ref().map(String::as_str), ["Repeat", "Original"]);
    assert_eq!(data.quantities[0].short_sides, ["rep.", "orig."]);
    assert!(
        data.quantities[0]
            .figure
            .as_ref()
            .is_some_and(|figure| figure.caption.contains("repeats against originals"))
    );
    assert!(
        data.traces.iter().all(|trace| trace.figure.alt.starts_with("Repeat and original")),
        "{:?}",
        data.traces
    );
    assert_eq!(data.notation.comparisons.len(), 1);
    assert!(
        data.notation.comparisons[0]
            .meaning
            .starts_with("Positive: the magnitude of the repeat is larger.")
    );
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
    let word = |found: &fishplate::result::Certification| {
        let data = view(found);
        (
            data.words.report,
            data.verdict.word,
            data.key_facts.iter().map(|fact| fact.name.clone()).collect::<Vec<_>>().join(", "),
        )
    };
    let facts = |rows: &str| {
        format!("Criteria by quantity, Sections, {rows}, Wanted operation, Test zones")
    };
    assert_eq!(
        word(&found),
        ("Validation report", "not validated".into(), facts("Compared pairs"))
    );
    found.quantities.extend(assessment::certification().quantities);
    assert_eq!(
        word(&found),
        (
            "Validation and assessment report",
            "requirements not met".into(),
            facts("Compared pairs, Assessed values")
        )
    );
    found.quantities.truncate(2);
    found.quantities.iter_mut().for_each(|quantity| quantity.among = Some("simulated".into()));
    assert_eq!(
        word(&found),
        ("Comparison report", "requirements not met".into(), facts("Compared values"))
    );
    let data = view(&found);
    assert_eq!(data.words.over, "Comparison of simulation codes");
    assert_eq!(data.quantities[0].sides.each_ref().map(String::as_str), ["Record", "All records"]);
    assert_eq!(data.measurement_statement, None);
}
