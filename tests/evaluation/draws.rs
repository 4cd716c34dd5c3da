//! Verdicts by draws of the sections. The counts of draws are those of `cases/values/draws.py`,
//! which draws the same sections and estimates with NumPy.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::campaign::{certified, copy, lines, replace};
use crate::common::program::fishplate;
use fishplate::result::{Certification, InDraws, Outcome, Reason, Verdict};
use tempfile::TempDir;

const COACH: &str = "examples/coach-good";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The protocol of the case with changes.
fn protocol(changes: &[(&str, &str)]) -> (TempDir, String) {
    let text = fs::read_to_string(root().join("tests/cases/values/draws.fp")).expect("a protocol");
    let text = changes.iter().fold(text, |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("draws.fp");
    fs::write(&path, text).expect("written");
    (folder, path.to_str().expect("a path").to_owned())
}

fn found_in(campaign: &Path, changes: &[(&str, &str)], set: &[&str]) -> Certification {
    let (_folder, path) = protocol(changes);
    certified(campaign, &path, set).unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

fn of<'a>(found: &'a Certification, verdict: Option<&str>) -> &'a InDraws {
    let named = |one: &&InDraws| one.verdict.as_deref() == verdict;
    found.drawn.iter().find(named).expect("a verdict by draws")
}

fn outcome(found: &Certification, verdict: &str) -> (Outcome, Vec<String>) {
    let found = found.verdicts.iter().find(|one| one.name == verdict).expect("a verdict");
    (found.outcome, found.reasons.iter().map(|reason| reason.text().to_string()).collect())
}

#[test]
fn counts_of_draws_agree_with_numpy() {
    let found = found_in(&root().join(COACH), &[], &[]);
    let held = |verdict| {
        let one = of(&found, verdict);
        assert_eq!((one.draws, one.undefined, one.units), (2000, 0, 13), "{verdict:?}");
        one.held
    };
    assert_eq!([None, Some("limits"), Some("quantities")].map(held), [59, 1508, 716]);
    let often = of(&found, None).most_often.as_ref().expect("a limit");
    assert_eq!((often.quantity.as_str(), often.draws), ("Y_qst", 1723));
    assert_eq!(found.verdict, Verdict::NotValidated);
    assert_eq!(outcome(&found, "limits").0, Outcome::Holds);
    assert_eq!(outcome(&found, "quantities").0, Outcome::DoesNotHold);
    assert_eq!(
        found.reasons[0].text().to_string(),
        "the rule holds in 59 of 2000 draws of 13 independent units (3.0 %); required: 90 %; most \
         often not met: Y_qst, share where |value| <= 2 kN, in 86.2 % of the draws"
    );
    // Then why the sections as they are do not meet it.
    assert!(matches!(found.reasons[1].root(), Reason::About { .. }), "{:?}", found.reasons[1]);
}

/// A limit that has no value in the 202 of 2000 draws in which zone 2 has one curve radius only.
#[test]
fn draws_without_a_value_are_counted_by_themselves() {
    let with = |share: &str| {
        let limit = format!(
            "quantity Q_max\n  limit  (regression over radius at 1300 m) 100 kN for zones 2\n\n\
             verdict line\n  of     Q_max\n  holds  when every limit holds in {share} of draws\n\n\
             verdict\n"
        );
        found_in(&root().join(COACH), &[("verdict\n", &limit)], &[])
    };
    for (share, expected) in [("85 %", Outcome::Holds), ("95 %", Outcome::NotAssessable)] {
        let found = with(share);
        let one = of(&found, Some("line"));
        assert_eq!((one.held, one.undefined), (HELD, 2000 - HELD));
        assert_eq!(outcome(&found, "line").0, expected, "{share}");
    }
    let (_, reasons) = outcome(&with("95 %"), "line");
    let undefined = format!("it cannot be judged in {} of them; ", 2000 - HELD);
    assert!(reasons[0].contains(&undefined), "{}", reasons[0]);
}

/// Draws in which zone 2 has sections of two or three curve radii.
const HELD: usize = 1798;

/// No draw is made where the sections as they are cannot be judged, or where a zone has one unit.
#[test]
fn nothing_is_drawn_without_enough_units() {
    let campaign = copy(&root().join(COACH));
    lines(&campaign.path().join("sections.csv"), |all| {
        all.retain(|line| !line.starts_with("S06") && !line.starts_with("S07"));
    });
    let found = found_in(campaign.path(), &[], &[]);
    assert_eq!((found.verdict, found.drawn.len()), (Verdict::NotAssessable, 0));
    let found = found_in(campaign.path(), &[], &["sections_per_zone=1"]);
    assert_eq!(found.verdict, Verdict::NotAssessable);
    let expected = "only 1 independent unit has its sections in zone 2; a draw needs at least 2";
    assert_eq!(found.reasons[0].text().to_string(), expected);
}

#[test]
fn rules_that_cannot_be_drawn_are_refused() {
    let says = |old: &str, new: &str| {
        let (_folder, path) = protocol(&[(old, new)]);
        let checked = fishplate(&["check", &path]);
        assert!(checked.code != 0, "{new}");
        checked.stderr
    };
    let twice = says("std 1.3 kN", "upper 95 % of std 1.9 kN");
    assert!(twice.contains("error[interval-of-draws]"), "{twice}");
    assert!(twice.contains("count the scatter between the sections twice"), "{twice}");
    let share = says("in 90 %", "in 110 %");
    let range = "a share of draws must be at least 50 % and below 100 %";
    assert!(share.contains(range), "{share}");
    assert!(says("in 90 %", "in 40 %").contains(range));
    let written = says("in 90 % of draws", "in 90 % of draw");
    assert!(written.contains("expected `in 95 % of draws`"), "{written}");
}

/// Studies and `impact` judge a campaign many times, or put verdicts together from single limits.
#[test]
fn studies_refuse_verdicts_by_draws() {
    let (folder, path) = protocol(&[]);
    let out = folder.path().join("out");
    let out = out.to_str().expect("a path");
    let campaign = root().join(COACH);
    let campaign = campaign.to_str().expect("a path");
    for study in ["sections", "margin", "sync"] {
        let refused = fishplate(&["study", study, campaign, "--protocol", &path, "--out", out]);
        assert!(refused.stderr.contains("error[study-verdict]"), "{study}: {}", refused.stderr);
    }
    let parent = "en14363-2016-annex-t";
    let refused = fishplate(&["impact", parent, &path, "--over", campaign, "--out", out]);
    assert!(refused.stderr.contains("error[impact-verdict]"), "{}", refused.stderr);
}

/// The counts follow from the values: a file in which they are changed does not verify.
#[test]
fn changed_counts_are_noticed() {
    let (folder, path_of_protocol) = protocol(&[]);
    let out = folder.path().join("out");
    let out_text = out.to_str().expect("a path");
    let campaign = root().join(COACH);
    let campaign = campaign.to_str().expect("a path");
    let run = fishplate(&["certify", campaign, "--protocol", &path_of_protocol, "--out", out_text]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    // Alone: a report in PDF carries the results once more.
    let results = folder.path().join("results.json");
    fs::copy(out.join("results.json"), &results).expect("copied");
    let verify = || {
        let path = results.to_str().expect("a path");
        fishplate(&["verify", path, "--protocol", &path_of_protocol, "--report-only"])
    };
    let sound = verify();
    assert!(sound.stdout.contains("agrees       statistics"), "{}{}", sound.stdout, sound.stderr);
    replace(&results, "\"held\": 1508", "\"held\": 1950");
    let forged = verify();
    assert!(forged.stdout.contains("DIFFERS      statistics"), "{}", forged.stdout);
    assert!(forged.stdout.contains("drawn"), "{}", forged.stdout);
}
