//! Estimates without a limit, and values that no record can change: numbers, places in the results,
//! consequences.

use std::fs;
use std::path::{Path, PathBuf};

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::report::{html, tables, view};
use fishplate::result::text;
use fishplate::result::{Certification, Reported, Verdict};
use fishplate::run::Settings;
use fishplate::source::Source;
use serde_json::Value;

fn coach() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good")
}

fn compiled(text: &str) -> Compiled {
    let mut problems = Problems::default();
    let family = family::read(&Source::new("variant.fp", text), &library::parent, &mut problems);
    let found = compile(family, &Overrides::new(), &mut problems).filter(|_| !problems.any_error());
    found.unwrap_or_else(|| panic!("{}", problems.render(false)))
}

fn certified(text: &str) -> Certification {
    let mut problems = Problems::default();
    let campaign = Campaign::open(&coach(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    certify(&compiled(text), &campaign, Settings { traces: 1 }, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

/// Rows of the table of sections: zone, direction, length and radius.
fn sections() -> Vec<(String, String, f64, Option<f64>)> {
    let table = fs::read_to_string(coach().join("sections.csv")).expect("a table");
    let mut lines = table.lines();
    let head: Vec<&str> = lines
        .next()
        .expect("a head")
        .split(',')
        .map(|name| name.split(" [").next().unwrap_or(name))
        .collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |name: &str| cells[head.iter().position(|known| *known == name).expect(name)];
        let number = |name: &str| cell(name).parse::<f64>().ok();
        let length = number("end").expect("an end") - number("start").expect("a start");
        (cell("zone").to_owned(), cell("direction").to_owned(), length, number("radius"))
    };
    lines.map(row).collect()
}

fn mean(all: &[f64]) -> f64 {
    all.iter().sum::<f64>() / all.len() as f64
}

const VARIANT: &str = "protocol variant \"Estimates without a limit\"
  extends  en14363-2016-annex-t

estimate total_length \"Total length\"
  is  total of length

sections
  report  total_length in km for each zone
  report  mean of radius for each zone where direction is not straight
  report  share of sections where direction is right

quantity Y_max
  report  maximum for each zone and wheelset
  report  mean + 3 * std in N
  report  n
";

fn near(found: Option<f64>, wanted: f64) -> bool {
    found.is_some_and(|found| (found - wanted).abs() <= 1e-9 * wanted.abs().max(1e-9))
}

fn named<'a>(all: &'a [Reported], name: &'a str) -> impl Iterator<Item = &'a Reported> {
    all.iter().filter(move |one| one.name.to_string() == name)
}

/// The numbers of the table of sections, summed up here by hand.
#[test]
fn numbers_of_the_sections_are_those_of_their_table() {
    let found = certified(VARIANT);
    let rows = sections();
    assert!(found.sections.iter().all(|section| section.used));
    for zone in ["1", "2", "3", "4"] {
        let of_zone = || rows.iter().filter(|(of, ..)| of == zone);
        let length: f64 = of_zone().map(|(_, _, length, _)| length).sum();
        let one = named(&found.reported, "total_length")
            .find(|one| one.scope.to_string() == format!("zone {zone}"))
            .expect("a zone");
        assert!(near(one.value, length / 1000.0), "{one:?}");
        assert_eq!(
            (one.unit.as_str(), one.title.as_str(), one.count.number()),
            ("km", "Total length", of_zone().count())
        );
        assert_eq!(one.scope.members(), [("zone", zone)]);
        let radii: Vec<f64> = of_zone()
            .filter(|(_, direction, ..)| direction != "straight")
            .filter_map(|(.., radius)| *radius)
            .collect();
        let one = named(&found.reported, "mean of radius")
            .find(|one| one.scope.to_string() == format!("zone {zone}"));
        match one {
            Some(one) => assert!(
                near(one.value, mean(&radii))
                    && one.condition.as_deref() == Some("direction is not straight"),
                "{one:?}"
            ),
            None => assert!(radii.is_empty(), "zone {zone}"),
        }
    }
    let right = rows.iter().filter(|(_, direction, ..)| direction == "right").count();
    let share = found.reported.last().expect("a share");
    assert!(
        near(share.value, right as f64 / rows.len() as f64) && share.scope.is_all(),
        "{share:?}"
    );
}

/// The numbers of a quantity, from the values of the result.
#[test]
fn numbers_of_a_quantity_are_those_of_its_values() {
    let found = certified(VARIANT);
    let quantity =
        found.quantities.iter().find(|quantity| quantity.id == "Y_max").expect("a quantity");
    for one in named(&quantity.reported, "maximum") {
        let of = |key: &str| {
            one.scope
                .members()
                .into_iter()
                .find(|(known, _)| *known == key)
                .map(|(_, member)| member.to_owned())
                .expect("a key")
        };
        let (zone, wheelset) = (of("zone"), format!("Y_{}", of("wheelset")));
        let inside = quantity.values.iter().filter(|pair| {
            pair.zone.as_deref() == Some(&zone) && pair.signal.starts_with(&wheelset)
        });
        let all: Vec<f64> = inside.map(|pair| pair.difference).collect();
        assert_eq!(one.count.number(), all.len());
        assert!(near(one.value, all.iter().copied().fold(f64::NEG_INFINITY, f64::max)), "{one:?}");
    }
    let groups: std::collections::BTreeSet<_> =
        quantity.values.iter().map(|pair| (&pair.zone, &pair.signal[..3])).collect();
    assert_eq!(named(&quantity.reported, "maximum").count(), groups.len());
    let all: Vec<f64> = quantity.values.iter().map(|pair| pair.difference).collect();
    let m = mean(&all);
    let std = (all.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (all.len() - 1) as f64).sqrt();
    let one = named(&quantity.reported, "mean + 3 * std").next().expect("an estimate");
    assert!(near(one.value, 1000.0 * (m + 3.0 * std)) && one.unit == "N", "{one:?}");
    assert!(near(named(&quantity.reported, "n").next().expect("a count").value, quantity.n as f64));
}

/// They decide nothing: limits, verdict and reasons are those of the parent; in the results they
/// stand beside the other keys.
#[test]
fn reports_decide_nothing_and_stand_in_all_outputs() {
    let (with, without) = (
        certified(VARIANT),
        certified("protocol variant \"The parent\"\n  extends  en14363-2016-annex-t\n"),
    );
    assert_eq!((with.verdict, &with.reasons), (without.verdict, &without.reasons));
    assert_eq!(with.verdict, Verdict::Validated);
    let read = |found: &Certification| serde_json::from_str::<Value>(&text(found)).expect("JSON");
    let (mut more, less) = (read(&with), read(&without));
    assert!(
        less.get("reported").is_none()
            && less["quantities"]
                .as_array()
                .expect("a list")
                .iter()
                .all(|one| one.get("reported").is_none())
    );
    let first = &more["reported"][0];
    assert_eq!(
        (&first["keys"]["zone"], &first["estimate"], &first["unit"]),
        (&"1".into(), &"total_length".into(), &"km".into())
    );
    assert!(
        first["value"].is_f64() && first["sections"].is_u64() && first["rule"]["line"] == 8,
        "{first}"
    );
    more.as_object_mut().expect("keys").remove("reported");
    for one in more["quantities"].as_array_mut().expect("a list") {
        one.as_object_mut().expect("keys").remove("reported");
        assert_eq!(one["holds"], true);
    }
    assert_eq!(more["quantities"][0]["values"], less["quantities"][0]["values"]);
    let files = tables::certification(&with).expect("tables");
    let (_, bytes) = files.iter().find(|(name, _)| name.contains("reported")).expect("a table");
    let lines = String::from_utf8_lossy(bytes).lines().count();
    let all =
        with.reported.len() + with.quantities.iter().map(|one| one.reported.len()).sum::<usize>();
    assert_eq!(lines, 1 + all);
    let printed = view::document(&with);
    let table = printed
        .tables()
        .find(|table| table.caption.letters() == "Data of the sections used")
        .expect("a table");
    assert_eq!(
        table.columns.iter().map(|column| column.title.as_str()).collect::<Vec<_>>(),
        ["Zone", "Sections", "Total length", "Mean of radius, direction is not straight"]
    );
    assert_eq!(table.rows.len(), 4);
}

/// A group without a number has a reason, and nothing else changes.
#[test]
fn a_report_without_a_number_says_why() {
    let found = certified(
        "protocol variant \"No radius on straight track\"\n  extends  en14363-2016-annex-t\n\nsections\n  report  mean of radius for each zone\n",
    );
    let one = found.reported.iter().find(|one| one.scope.to_string() == "zone 1").expect("zone 1");
    assert!(
        one.value.is_none()
            && one
                .reason
                .as_ref()
                .is_some_and(|reason| reason.text().to_string().contains("radius")),
        "{one:?}"
    );
    assert_eq!(found.verdict, Verdict::Validated);
    let page = html::html(&view::document(&found), &[]).expect("a page");
    assert!(page.contains("<li>Mean of radius, zone 1: "));
}

/// A weight of 0 in the vehicle file makes every value of a metric 0: that is no agreement.
#[test]
fn values_that_no_record_can_change_are_not_assessable() {
    let text = |metric: &str, limit: &str| {
        format!(
            "protocol variant \"Weighted by the vehicle\"\n  extends  en14363-2016-annex-t\n\nremove\n  quantity  every\n\nvehicle weight \"A weight\"\n  \
             in       -\n  default  0\n\nquantity weighted \"Weighted metric\"\n  of      Y at wheelset 1\n  filter  LP20\n  metric  {metric}\n  limit   {limit}\n"
        )
    };
    let found = certified(&text("weight * (1 - correlation)", "each 0.5"));
    let reason = found.quantities[0].reason.as_ref().expect("a reason").text().to_string();
    assert!(reason.starts_with("every value is 0 whatever the records are"), "{reason}");
    assert_eq!(found.verdict, Verdict::NotAssessable);
    // Where the records decide a little, they decide.
    let found = certified(&text("(1 + weight) * (1 - correlation)", "each 2"));
    assert_eq!((found.verdict, &found.quantities[0].reason), (Verdict::Validated, &None));
}
