//! Whole campaigns: a campaign comes out, the same bytes every time, or nothing.

use std::fs;

use super::program::{files, program, ran};
use super::{Place, SECTIONS};

#[test]
fn the_same_bytes_on_any_number_of_cores() {
    let place = Place::new();
    let effects = [
        "--effect",
        "friction=0.5",
        "--effect",
        "sensor_noise=0.4 on Y_1R",
        "--effect",
        "worn_profile=0.7",
    ];
    place.simulated("one", &[&effects[..], &["--jobs", "1"]].concat());
    place.simulated("two", &[&effects[..], &["--jobs", "2"]].concat());
    let one = files(&place.path("one"));
    assert_eq!(one.len(), files(&place.path("two")).len());
    for path in one {
        let inside = path.strip_prefix(place.path("one")).expect("inside");
        assert_eq!(
            fs::read(&path).expect("readable"),
            fs::read(place.path("two").join(inside)).expect("readable"),
            "{inside:?}"
        );
    }
}

#[test]
fn what_comes_out_is_a_campaign() {
    let place = Place::new();
    let ran = place.simulated("out", &["--effect", "friction=0.5"]);
    assert!(ran.stderr.contains("written: 4 sections to out"), "{}", ran.stderr);
    for file in [
        "vehicle.yaml",
        "sections.csv",
        "profile.csv",
        "profile_worn.csv",
        "track/S13.csv",
        "measurement/S13.csv",
    ] {
        assert!(
            place.text(&format!("out/{file}")) == place.text(&format!("small/{file}")),
            "{file}"
        );
    }
    assert!(place.text("out/campaign.yaml").contains("Coach C44, on-track test, second series"));
    let again = place.path("out");
    let report = place.path("report");
    let (again, report) = (again.display().to_string(), report.display().to_string());
    let ran = ran_certify(&again, &report);
    assert!(ran.code <= 1, "{}", ran.stderr);
}

fn ran_certify(campaign: &str, out: &str) -> super::program::Ran {
    ran(program().args([
        "certify",
        campaign,
        "--out",
        out,
        "--only",
        "results",
        "--protocol",
        "en14363-2016-annex-t-six-sections",
    ]))
}

#[test]
fn a_fault_in_one_section_leaves_nothing() {
    let place = Place::new();
    fs::remove_file(place.path("small/track/S10.csv")).expect("removed");
    let ran = place.simulate("out", &[]);
    assert_eq!(ran.code, 3, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("small/sections.csv") && ran.stderr.contains("track/S10.csv"),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_run_that_diverges_leaves_nothing() {
    let place = Place::new();
    place.replace("small/sections.csv", ",67.2", ",540");
    let ran = place.simulate(
        "out",
        &["--effect", "yaw_damper_loss=0", "--effect", "worn_profile.conicity_scale=3"],
    );
    assert_eq!(ran.code, 3, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("section `S13`: ") && ran.stderr.contains(" s after the start, at "),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_campaign_that_lacks_what_the_model_needs() {
    let place = Place::new();
    place.replace("small/campaign.yaml", "track: track\n", "");
    let ran = place.simulate("out", &[]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("the campaign has no `track`"), "{}", ran.stderr);
    let place = Place::new();
    place.replace("small/vehicle.yaml", "  kx: 1.2e+7 N/m\n", "");
    let ran = place.simulate("out", &[]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("`primary.kx`"), "{}", ran.stderr);
}

#[test]
fn a_section_that_repeats_no_other() {
    let place = Place::new();
    let table = place.text("small/sections.csv");
    let mut lines = table.lines();
    let mut repeated = format!("{},repeat of\n", lines.next().expect("a header"));
    lines.for_each(|line| repeated.push_str(&format!("{line},S99\n")));
    fs::write(place.path("small/sections.csv"), repeated).expect("written");
    let ran = place.simulate("out", &[]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("error[unknown-section]: `repeat of` names `S99`"),
        "{}",
        ran.stderr
    );
    let small = place.path("small").display().to_string();
    let ran = super::program::ran(program().args(["diagnose", &small, "--preflight"]));
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("error[unknown-section]: `repeat of` names `S99`"),
        "{}",
        ran.stderr
    );
}

#[test]
fn sections_without_speed() {
    let place = Place::new();
    place.replace("small/sections.csv", "speed [km/h]", "velocity [km/h]");
    let ran = place.simulate("out", &[]);
    assert_eq!(ran.code, 3);
    assert!(
        SECTIONS.iter().all(|name| ran.stderr.contains(&format!("section `{name}` has no speed"))),
        "{}",
        ran.stderr
    );
}

/// The new campaign says what it is, and with `--increment` what was in the simulation before as
/// well.
#[test]
fn what_was_added_stands_in_the_origin_and_in_the_name() {
    let place = Place::new();
    place.simulated("one", &["--effect", "friction=0.23"]);
    assert!(
        place
            .text("one/campaign.yaml")
            .starts_with("name: Coach C44, on-track test, second series, with friction 0.23\n")
    );
    assert!(place.text("one/campaign.yaml").contains("\norigin: origin.yaml\n"));
    let origin = place.text("one/origin.yaml");
    for part in [
        "command: simulate\n",
        "- effect: friction\n",
        "    value: 0.23\n",
        "fitted to: []\n",
        "- path: track/S13.csv\n",
    ] {
        assert!(origin.contains(part), "{part}\n{origin}");
    }
    let hash = fishplate::data::hash::sha256(
        &fs::read(place.path("small/measurement/S13.csv")).expect("readable"),
    );
    assert!(origin.contains(&hash), "{origin}");
    let two = place.path("two");
    let call = |more: &[&str]| {
        let arguments = ["simulate", "one", "--out", "two", "--effect", "payload=2 t"];
        assert_eq!(ran(program().current_dir(place.path("")).args(arguments).args(more)).code, 0);
        (place.text("two/campaign.yaml"), place.text("two/origin.yaml"))
    };
    let (name, added) = call(&["--increment"]);
    assert!(
        name.starts_with(
            "name: Coach C44, on-track test, second series, with friction 0.23 and payload 2"
        ),
        "{name}"
    );
    assert!(
        added.contains("- effect: friction\n") && added.contains("- effect: payload\n"),
        "{added}"
    );
    // Made anew, nothing of what was there is in it.
    let (name, anew) = call(&[]);
    assert!(
        name.starts_with("name: Coach C44, on-track test, second series, with payload 2"),
        "{name}"
    );
    assert!(
        !anew.contains("- effect: friction\n") && anew.contains("- effect: payload\n"),
        "{anew}"
    );
    let report = place.path("report");
    let ran = ran_certify(&two.display().to_string(), &report.display().to_string());
    assert!(ran.stdout.contains(", simulation with effect payload = 2"), "{}", ran.stdout);
}
