//! `impact`: against every subset of the changed rules, each certified by itself; from values as from
//! records; what cannot be replayed.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::Overrides;
use fishplate::check::diff::{self, Change};
use fishplate::check::family::{self, Family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::run::Settings;
use fishplate::source::Source;
use serde_json::{Value, json};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(arguments)
        .current_dir(root())
        .output()
        .expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

fn impact([old, new]: [&str; 2], over: &[String], out: &Path) -> Value {
    let out_text = out.display().to_string();
    let over: Vec<&str> = over.iter().map(String::as_str).collect();
    let first = ["impact", old, new, "--quiet", "--no-report", "--out", &out_text, "--over"];
    let (code, _, said) = run(&[&first[..], &over].concat());
    assert_eq!(code, 0, "{said}");
    serde_json::from_str(&fs::read_to_string(out.join("impact.json")).expect("impact.json"))
        .expect("JSON")
}

/// Records of three channels at 20 Hz and 20 m/s, 70 m longer than their section. The simulation is
/// the measurement with an offset and a wave of 1.5 Hz, both drawn.
fn campaign(folder: &Path, number: usize) -> String {
    let folder = folder.join(format!("campaign-{number}"));
    let mut draw = fastrand::Rng::with_seed(number as u64);
    let size = 1.8 + 0.1 * number as f64;
    let write = |name: String, text: String| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    };
    let paths = "vehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n";
    write(
        "campaign.yaml".into(),
        format!("name: campaign {number}\n{paths}sampling_rate [Hz]: 20\n"),
    );
    let category = ["light", "heavy"][number % 2];
    write("vehicle.yaml".into(), format!("name: vehicle\ncategory: {category}\n"));
    let mut table = "section,start [m],end [m],country\n".to_string();
    for (section, length) in [("S1", 60), ("S2", 80), ("S3", 100), ("S4", 100)] {
        let country = ["A", "B"][number / 2 % 2];
        writeln!(table, "{section},35,{},{country}", 35 + length).expect("a string");
        let mut records = ["simulation", "measurement"]
            .map(|kind| (kind, "time [s],distance [m],a [kN],b [kN],c [kN]\n".to_string()));
        let drawn: Vec<(f64, f64)> =
            (0..3).map(|_| (size * (draw.f64() - 0.5), 0.6 * size * draw.f64())).collect();
        for sample in 0..=(length + 70) {
            let (x, time) = (f64::from(sample), f64::from(sample) / 20.0);
            let slow = |channel: f64| 5.0 + (time + channel).sin();
            for (side, (_, record)) in records.iter_mut().enumerate() {
                write!(record, "{time},{x}").expect("a string");
                for (channel, (offset, wave)) in drawn.iter().enumerate() {
                    let fast = wave * (9.42 * time).sin();
                    let more = if side == 0 { offset + fast } else { 0.0 };
                    write!(record, ",{}", slow(channel as f64) + more).expect("a string");
                }
                record.push('\n');
            }
        }
        records.into_iter().for_each(|(kind, text)| write(format!("{kind}/{section}.csv"), text));
    }
    write("sections.csv".into(), table);
    folder.display().to_string()
}

fn case(name: &str) -> String {
    root().join(format!("tests/cases/impact/{name}.fp")).display().to_string()
}

fn read(path: &str) -> Family {
    let mut problems = Problems::default();
    let source = library::find(path, None).expect("a protocol");
    family::read(&source, &library::parent, &mut problems)
}

/// The verdict of every subset of the changes on a campaign, by the number of the subset; `None` where
/// it is no protocol.
fn by_brute_force(old: &Family, changes: &[Change], campaign: &str) -> Vec<Option<String>> {
    let mut problems = Problems::default();
    let campaign = Campaign::open(Path::new(campaign), &mut problems).expect("a campaign");
    let compiled = |set: usize| -> Option<Compiled> {
        let mut family = old.clone();
        for (_, change) in changes.iter().enumerate().filter(|(at, _)| set >> at & 1 == 1) {
            family.merged = change.applied(&family.merged);
        }
        let mut problems = Problems::default();
        compile(family, &Overrides::new(), &mut problems).filter(|_| !problems.any_error())
    };
    let verdict = |set: usize| {
        let compiled = compiled(set)?;
        let found = certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {});
        Some(found.map_or("not assessable".into(), |found| found.verdict.in_words().to_string()))
    };
    (0..1 << changes.len()).map(verdict).collect()
}

/// The inclusion-minimal subsets with the verdict of all changes.
fn minimal(verdicts: &[Option<String>]) -> BTreeSet<usize> {
    let wanted = verdicts.last().expect("all changes");
    let giving: Vec<usize> = (0..verdicts.len()).filter(|set| verdicts[*set] == *wanted).collect();
    let contains = |set: usize| giving.iter().any(|part| *part != set && part & set == *part);
    giving.iter().copied().filter(|set| !contains(*set)).collect()
}

/// The flips and all their minimal sets are those of brute force over all subsets of the changed
/// rules: of three campaigns that flip, and of one that does not.
#[track_caller]
fn is_as_by_brute_force(old: &str, new: &str, campaigns: usize) -> Value {
    let temp = tempfile::tempdir().expect("a folder");
    let archive: Vec<String> = (0..campaigns).map(|number| campaign(temp.path(), number)).collect();
    let found = impact([old, new], &archive, &temp.path().join("out"));
    let before = read(old);
    let all = diff::changes(&before.merged, &read(new).merged);
    let changes: Vec<Change> = all.into_iter().filter(|change| !change.only_words()).collect();
    let name = |at: usize| changes[at].deviation.rule.as_str();
    let flips = found["flips"].as_array().expect("a list");
    let (mut flipped, mut stayed) = (0, 0);
    for (number, folder) in archive.iter().enumerate() {
        let campaign = format!("campaign {number}");
        let flip = flips.iter().find(|flip| flip["campaign"] == json!(campaign));
        let seen = if flip.is_some() { &mut flipped } else { &mut stayed };
        *seen += 1;
        if *seen > if flip.is_some() { 3 } else { 1 } {
            continue;
        }
        let verdicts = by_brute_force(&before, &changes, folder);
        assert_eq!(flip.is_some(), verdicts.first() != verdicts.last(), "{campaign}");
        let Some(flip) = flip else { continue };
        assert_eq!(json!([verdicts[0], verdicts.last()]), json!([flip["before"], flip["after"]]));
        assert_eq!(flip["exact"], true);
        let names = |set: usize| -> BTreeSet<&str> {
            (0..changes.len()).filter(|at| set >> at & 1 == 1).map(name).collect()
        };
        let wanted: BTreeSet<BTreeSet<&str>> = minimal(&verdicts).into_iter().map(names).collect();
        let sets = flip["minimal"].as_array().expect("a list").iter();
        let set = |set: &'_ Value| -> BTreeSet<String> {
            let rules = set.as_array().expect("a list").iter();
            rules.map(|rule| rule.as_str().expect("a rule").to_string()).collect()
        };
        let own: Vec<BTreeSet<String>> = sets.map(set).collect();
        let own: BTreeSet<BTreeSet<&str>> =
            own.iter().map(|set| set.iter().map(String::as_str).collect()).collect();
        assert_eq!(own, wanted, "{campaign}");
    }
    assert!(flipped > 1 && stayed > 0, "{flipped} of {campaigns} flip");
    found
}

#[test]
fn minimal_sets_are_those_of_all_subsets() {
    let found = is_as_by_brute_force(&case("old"), &case("new"), 20);
    // The limit needs the definition; a change of a title touches no verdict.
    let alone = |rule: &str| {
        let rules = found["rules"].as_array().expect("a list");
        rules.iter().find(|one| one["rule"] == json!(rule)).expect("a rule")["reason"].clone()
    };
    assert!(
        alone("quantity qa, limit std").as_str().is_some_and(|why| why.contains("scatter_limit"))
    );
    assert_eq!(alone("quantity qc, limit each"), Value::Null);
    assert_eq!(found["only_words"], 1);
    // Shares by the words of vehicle and sections, counted by hand from the verdicts.
    let holds = |key: &str, among: &[usize]| {
        let archive = found["archive"].as_array().expect("a list");
        let held = among.iter().filter(|at| archive[**at][key] == "validated").count();
        held as f64 / among.len() as f64
    };
    let which = |of: fn(usize) -> bool| (0..20).filter(|at| of(*at)).collect::<Vec<usize>>();
    for (by, group, among) in [
        ("all", "all", which(|_| true)),
        ("category", "light", which(|at| at % 2 == 0)),
        ("category", "heavy", which(|at| at % 2 == 1)),
        ("country", "A", which(|at| at / 2 % 2 == 0)),
        ("country", "B", which(|at| at / 2 % 2 == 1)),
    ] {
        let shares = found["shares"].as_array().expect("a list");
        let share = shares.iter().find(|one| one["by"] == by && one["group"] == group);
        let share = share.expect("a share");
        assert_eq!(share["campaigns"], among.len());
        assert_eq!(share["before"], holds("before", &among), "{group}");
        assert_eq!(share["after"], holds("after", &among), "{group}");
    }
}

/// Five ways of making values differ, more than are taken together.
#[test]
fn values_that_are_made_apart_are_put_together() {
    let temp = tempfile::tempdir().expect("a folder");
    let protocol = |name: &str, new: bool| {
        let mut text = fs::read_to_string(case("old")).expect("a protocol");
        let (head, quantities) = text.split_at(text.find("quantity qa").expect("a quantity"));
        let verdict = &quantities[quantities.find("verdict").expect("a verdict")..];
        let mut own = head.replace(
            "define most \"Largest mean\"\n  is  0.9 kN when category is heavy, otherwise 0.7 kN\n",
            "",
        );
        own =
            own.replace("filter LP \"Low-pass\"\n  step  low-pass 2 Hz, order 2, zero-phase\n", "");
        for (at, channel) in ["a", "b", "c", "a", "b"].into_iter().enumerate() {
            let percent = [99, 95, 90, 10, 5][at];
            let filter = if new { 0.8 } else { 3.0 };
            let limit = if new && at < 3 { 0.6 } else { 0.9 };
            write!(own, "quantity q{at} \"Q\"\n  of  {channel}\n  filter  low-pass {filter} Hz, order 2, zero-phase\n  value  p{percent}\n  difference  signed\n  limit  mean {limit} kN\n\n").expect("a string");
        }
        own.push_str(verdict);
        text = own.replace("protocol small ", &format!("protocol {name} "));
        let path = temp.path().join(format!("{name}.fp"));
        fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    is_as_by_brute_force(&protocol("apart-old", false), &protocol("apart-new", true), 12);
}

/// Values give what records give; with changes of how values are made they are not replayed, and the
/// quantities are named.
#[test]
fn values_give_what_records_give() {
    let temp = tempfile::tempdir().expect("a folder");
    let archive: Vec<String> = (0..4).map(|number| campaign(temp.path(), number)).collect();
    let text = fs::read_to_string(case("old")).expect("a protocol");
    let variant = |name: &str, changes: &[(&str, &str)]| {
        let text = changes.iter().fold(text.clone(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replacen(old, new, 1)
        });
        let path = temp.path().join(format!("{name}.fp"));
        fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    let values: Vec<String> = archive
        .iter()
        .enumerate()
        .flat_map(|(number, campaign)| {
            ["0/2", "1/2"].map(|shard| {
                let path = temp.path().join(format!("{number}-{}.parquet", &shard[..1]));
                let path = path.display().to_string();
                let (code, _, said) = run(&[
                    "reduce",
                    campaign,
                    "--protocol",
                    &case("old"),
                    "--shard",
                    shard,
                    "--out",
                    &path,
                    "--quiet",
                ]);
                assert_eq!(code, 0, "{said}");
                path
            })
        })
        .collect();
    let limits = variant(
        "limits",
        &[("std 1 kN", "std 0.5 kN"), ("each 2 kN", "each 1.2 kN"), ("0.7 kN", "0.4 kN")],
    );
    let [records, from_values] =
        [(&archive, "records"), (&values, "values")].map(|(over, from)| {
            let mut found = impact([&case("old"), &limits], over, &temp.path().join(from));
            for one in found["archive"].as_array_mut().expect("a list") {
                assert_eq!(one["from"], from);
                one["from"] = Value::Null;
            }
            found
        });
    assert_eq!(records, from_values);
    assert!(records["flips"].as_array().is_some_and(|flips| !flips.is_empty()));
    let processing = variant("processing", &[("p95", "p90"), ("std 1 kN", "std 0.5 kN")]);
    let found = impact([&case("old"), &processing], &values, &temp.path().join("processing"));
    assert_eq!(found["campaigns"], 0);
    let missing = found["not_replayed"].as_array().expect("a list");
    assert_eq!(missing.len(), 4);
    assert!(
        missing.iter().all(|one| one["quantities"] == json!(["qb"]) && one["sections"] == false)
    );
    let checked = variant("checked", &[("length >= 50 m", "length >= 70 m")]);
    let found = impact([&case("old"), &checked], &values[..2], &temp.path().join("checked"));
    let missing = &found["not_replayed"][0];
    assert_eq!(missing["quantities"], json!(["qa", "qb", "qc"]));
    assert_eq!(missing["sections"], true);
}

/// The limit at which a verdict becomes another one: certified a little on both sides of it.
#[test]
fn a_margin_is_where_the_verdict_changes() {
    let temp = tempfile::tempdir().expect("a folder");
    let archive: Vec<String> = (0..4).map(|number| campaign(temp.path(), number)).collect();
    let text = fs::read_to_string(case("old")).expect("a protocol");
    let new = temp.path().join("new.fp");
    let edges = "each between -1.9 kN and 1.9 kN";
    fs::write(&new, text.replace("each 2 kN", edges).replace("std 1 kN", "std 0.9 kN"))
        .expect("written");
    let found =
        impact([&case("old"), &new.display().to_string()], &archive, &temp.path().join("out"));
    let list = |key: &str| found[key].as_array().expect("a list").iter();
    let near = list("near").map(|near| (&near["campaign"], &near["verdict"], near));
    let flips = list("flips").flat_map(|flip| {
        let margins = flip["margin"].as_array().expect("a list");
        margins.iter().map(|margin| (&flip["campaign"], &flip["after"], margin))
    });
    let mut looked_at = 0;
    for (campaign, verdict, margin) in near.chain(flips) {
        if margin["rule"] == "quantity qb, limit mean"
            || margin["rule"] == "quantity qa, limit mean"
        {
            assert_eq!(margin["changed"], false);
            continue;
        }
        let number = list("archive").position(|one| one["name"] == *campaign).expect("a campaign");
        looked_at += 1;
        let at = margin["flips_at"].as_f64().expect("a number");
        let written = match margin["rule"].as_str() {
            Some("quantity qa, limit std") => "std 0.9 kN",
            Some("quantity qc, limit each, lower edge") => "between -1.9 kN",
            Some("quantity qc, limit each, upper edge") => "and 1.9 kN",
            other => panic!("{other:?} did not change"),
        };
        let verdicts = [1.0 - 1e-6, 1.0 + 1e-6].map(|factor| {
            let word = written.split(' ').next().expect("a word");
            let text = fs::read_to_string(&new)
                .expect("read")
                .replace(written, &format!("{word} {} kN", at * factor));
            let source = Source::new("near.fp", text);
            let mut problems = Problems::default();
            let family = family::read(&source, &library::parent, &mut problems);
            let compiled = compile(family, &Overrides::new(), &mut problems).expect("a protocol");
            let campaign = Campaign::open(Path::new(&archive[number]), &mut problems);
            certify(&compiled, &campaign.expect("a campaign"), Settings { traces: 0 }, &|_| {})
                .map_or("not assessable", |found| found.verdict.in_words())
                .to_string()
        });
        assert_ne!(verdicts[0], verdicts[1], "{margin}");
        assert!(verdicts.iter().any(|one| json!(one) == *verdict), "{margin}");
    }
    assert!(looked_at > 0);
}
