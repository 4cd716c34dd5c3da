//! The method and the step of the built-in model, and the records of the example that were made
//! with them.

use std::fs;

use super::program::{Ran, program, ran};
use super::{Place, apart, channel, root};

/// `simulate examples/code-benchmark` into a place.
fn simulated(place: &Place, out: &str, more: &[&str]) -> Ran {
    let out = place.path(out);
    ran(program()
        .current_dir(root())
        .args(["simulate", "examples/code-benchmark", "--out"])
        .arg(out)
        .args(more))
}

/// Some columns of a record, by the names of their headers.
fn cut(record: &str, columns: &[&str]) -> String {
    let heads: Vec<&str> = record.lines().next().expect("a header").split(',').collect();
    let at: Vec<usize> = columns
        .iter()
        .map(|name| heads.iter().position(|head| head == name).expect("a column"))
        .collect();
    let line = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        at.iter().map(|at| cells[*at]).collect::<Vec<_>>().join(",") + "\n"
    };
    record.lines().map(line).collect()
}

/// The commands of `examples/code-benchmark/README.md` write the records that are there; the
/// records of the independent program are those of `examples/coach`.
#[test]
fn the_example_is_made_by_its_commands() {
    let place = Place::new();
    let readme =
        fs::read_to_string(root().join("examples/code-benchmark/README.md")).expect("there");
    let commands: Vec<&str> = readme
        .lines()
        .filter_map(|line| line.strip_prefix("    fishplate "))
        .filter(|words| words.starts_with("simulate"))
        .collect();
    assert_eq!(commands.len(), 4);
    for command in commands {
        // Quotes hold a step together.
        let words: Vec<String> = command
            .split('"')
            .enumerate()
            .flat_map(|(at, part)| {
                if at % 2 == 1 {
                    vec![part.to_string()]
                } else {
                    part.split_whitespace().map(str::to_string).collect()
                }
            })
            .collect();
        let at = words.iter().position(|word| word == "--out").expect("an output");
        let name = words[at + 1].trim_start_matches("target/").to_string();
        let out = place.path(&name);
        let words = words.iter().enumerate().map(|(nth, word)| {
            if nth == at + 1 { out.display().to_string() } else { word.clone() }
        });
        let made = ran(program().current_dir(root()).args(words));
        assert_eq!(made.code, 0, "{command}\n{}", made.stderr);
        let folder =
            if name == "reference" { "reference".to_string() } else { format!("codes/{name}") };
        same(&|section| place.text(&format!("{name}/simulation/{section}.csv")), &folder);
    }
    same(
        &|section| {
            fs::read_to_string(root().join(format!("examples/coach/simulation/{section}.csv")))
                .expect("there")
        },
        "codes/independent",
    );
    let origin = place.text("midpoint/origin.yaml");
    assert!(origin.contains("midpoint method with steps of 0.5 ms or less"), "{origin}");
    assert!(!place.text("built_in/origin.yaml").contains("steps of"));
}

#[track_caller]
fn same(made: &dyn Fn(&str) -> String, folder: &str) {
    for section in ["S01", "S05", "S13"] {
        let there = root().join(format!("examples/code-benchmark/{folder}/{section}.csv"));
        let there = fs::read_to_string(&there)
            .unwrap_or_else(|error| panic!("{}: {error}", there.display()));
        let heads: Vec<&str> = there.lines().next().expect("a header").split(',').collect();
        assert!(cut(&made(section), &heads) == there, "{folder}/{section}.csv");
    }
}

/// 1 ms is what the model does without an option; what is asked for is the largest step.
#[test]
fn steps_are_no_longer_than_asked_for() {
    let place = Place::new();
    let record = |out: &str, more: &[&str]| {
        let made = simulated(&place, out, more);
        assert_eq!(made.code, 0, "{}", made.stderr);
        place.text(&format!("{out}/simulation/S13.csv"))
    };
    let plain = record("plain", &[]);
    assert_eq!(plain, record("one", &["--step", "1"]));
    assert_eq!(record("fifth", &["--step", "0.2 ms"]), record("more", &["--step", "200 us"]));
    assert_eq!(record("half", &["--step", "0.5"]), record("less", &["--step", "0.6"]));
    let midpoint = record("midpoint", &["--integrator", "midpoint"]);
    assert_ne!(plain, midpoint);
    // Another method of the same equations: forces within 0.2 kN.
    let (a, b) = (place.record("plain", "S13"), place.record("midpoint", "S13"));
    let far = apart(channel(&a, "Y_1L"), channel(&b, "Y_1L"));
    assert!((0.0..0.2).contains(&far), "{far}");
}

#[test]
fn steps_that_are_none() {
    let place = Place::new();
    for (step, words) in [
        ("2 ms", "a step of 2 ms is outside the range of the model, 0.001 to 1 ms"),
        ("0", "outside the range"),
        ("-1", "outside the range"),
        ("1e-9 s", "outside the range"),
        ("fast", "`fast` is not a number"),
        ("1 m", "error[step]"),
    ] {
        let argument = format!("--step={step}");
        let made = simulated(&place, "out", &[&argument]);
        assert_eq!(made.code, 2, "{step}: {}", made.stderr);
        assert!(made.stderr.contains(words), "{step}: {}", made.stderr);
        assert!(!place.path("out").exists());
    }
    let other = simulated(&place, "out", &["--simulator", "sim.yaml", "--step", "0.5"]);
    assert_eq!(other.code, 2, "{}", other.stderr);
}
