//! What both reports print: sorted, rounded, worded; the templates get no number to calculate with.

#[path = "common/certification.rs"]
mod certification;

use fishplate::report::view::{ReportData, view};

fn data() -> ReportData {
    view(&certification::certification())
}

#[test]
fn numbers_reach_the_templates_as_text() {
    fn walk(path: &str, value: &serde_json::Value) {
        match value {
            serde_json::Value::Number(number) => {
                assert!(number.is_u64() && (path.ends_with("/number") || path.ends_with("/graph_nodes")), "{path}: {number}");
            }
            serde_json::Value::Array(items) => items.iter().for_each(|item| walk(path, item)),
            serde_json::Value::Object(map) => map.iter().for_each(|(key, item)| walk(&format!("{path}/{key}"), item)),
            _ => {}
        }
    }
    walk("", &serde_json::to_value(data()).expect("the view is plain data"));
    walk("", &serde_json::to_value(view(&certification::empty())).expect("the view is plain data"));
}

#[test]
fn the_summary_has_a_row_for_each_quantity_and_the_rest_stands_apart() {
    let data = data();
    assert_eq!(data.summary.len(), 12);
    assert_eq!(data.further.len(), 4, "one for each zone of the metric");
    let guiding = &data.summary[0];
    assert_eq!((guiding.limit_std.as_str(), guiding.limit_mean.as_str(), guiding.count.as_str()), ("5.00", "3.33", "124 / 62"));
    let fails: Vec<&str> = data.summary.iter().filter(|row| row.holds.class == "bad").map(|row| row.id.as_str()).collect();
    assert_eq!(fails, ["Y_max"]);
    let open = &data.summary[9];
    assert_eq!((open.mean.as_str(), open.normalised_std.as_str(), open.holds.word.as_str()), ("–", "–", "not assessed"));
}

#[test]
fn a_value_just_beyond_its_limit_is_printed_so() {
    let mut found = certification::certification();
    let statistic = &mut found.quantities[0].statistics[0];
    (statistic.value, statistic.normalised, statistic.holds) = (Some(5.00004), Some(1.000_008), Some(false));
    let row = &view(&found).summary[0];
    assert_eq!((row.std.as_str(), row.normalised_std.as_str()), ("5.00004", "1.00001"));
}

#[test]
fn worst_pairs_come_largest_first() {
    for quantity in data().quantities {
        let sizes: Vec<f64> =
            quantity.worst.iter().map(|pair| pair.difference.replace('−', "-").parse::<f64>().expect("a number").abs()).collect();
        assert!(sizes.is_sorted_by(|a, b| a >= b), "{}: {sizes:?}", quantity.id);
    }
    assert_eq!(data().quantities[0].worst_against.as_deref(), Some("limit of the standard deviation (n-1)"));
}

#[test]
fn every_value_stands_in_a_block() {
    let found = certification::certification();
    for (quantity, result) in data().quantities.iter().zip(&found.quantities) {
        let cells: usize = quantity.values.iter().flat_map(|block| &block.rows).map(|row| row.cells.len()).sum();
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
    let radius = straight.columns.iter().position(|column| column.title == "radius").expect("the column");
    assert_eq!(straight.rows[0].values[radius], "–", "straight track has no radius");
    assert!(data.section_tables[1].columns[radius].numeric);
}

#[test]
fn many_reasons_are_listed_in_the_summary_only() {
    let mut found = certification::certification();
    found.reasons = (0..20).map(|at| format!("reason {at}")).collect();
    let data = view(&found);
    assert_eq!((data.cover_reasons.len(), data.reasons.len()), (8, 20));
    assert_eq!(data.more_reasons.as_deref(), Some("All 20 reasons are listed in the summary."));
}
