//! The diagnosis on measured data of a machine that is no rail vehicle, with a program as the simulator.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/double-pendulum")
}

/// The example's program, which is built beside the tests.
fn simulator() -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_fishplate"));
    let name = format!("double_pendulum_simulator{}", std::env::consts::EXE_SUFFIX);
    program.parent().unwrap().join("examples").join(name)
}

fn diagnosed(folder: &Path) -> Value {
    let written = std::fs::read_to_string(example().join("sim.yaml")).unwrap();
    let path = simulator().display().to_string();
    let sim = written.replace("../../target/release/examples/double_pendulum_simulator", &format!("{path:?}"));
    std::fs::write(folder.join("sim.yaml"), sim).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(["diagnose", "--no-cache", "--quiet", "--protocol"])
        .arg(example().join("double-pendulum.fp"))
        .arg("--effects")
        .arg(example().join("effects.yaml"))
        .arg("--simulator")
        .arg(folder.join("sim.yaml"))
        .arg("--write-improved")
        .arg(folder.join("improved"))
        .arg("--out")
        .arg(folder.join("out"))
        .arg(example())
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(1), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_str(&std::fs::read_to_string(folder.join("out/diagnosis.json")).unwrap()).unwrap()
}

/// What docs/double-pendulum.md says: friction and rotors at the elbow, as the source of the data identified, and a shoulder that stays
/// unexplained.
#[test]
fn the_elbow_is_named_and_the_shoulder_stays_open() {
    let folder = tempfile::tempdir().unwrap();
    let found = diagnosed(folder.path());
    assert_eq!(found["verdict"], "unexplained");
    let effects = found["causes"][0]["effects"].as_array().unwrap();
    let size = |name: &str, parameter: &str| {
        let effect = effects.iter().find(|effect| effect["name"] == name).unwrap_or_else(|| panic!("no {name}: {effects:#?}"));
        effect["parameters"][parameter]["value"].as_f64().unwrap()
    };
    let (friction, rotors) = (size("elbow_friction", "elbow.coulomb"), size("motor_inertia", "motor.inertia"));
    assert!((0.09..0.14).contains(&friction), "{friction}");
    assert!((3e-5..7e-5).contains(&rotors), "{rotors}");
    assert_eq!(effects.len(), 2, "{effects:#?}");
    assert!(found["says"][0].as_str().unwrap().contains("tau_1"));
    let shrink = &found["shrink"];
    let removed = shrink["fraction_removed"].as_f64().unwrap();
    assert!((0.35..0.45).contains(&removed), "{removed}");
    for quantity in shrink["quantities"].as_array().unwrap() {
        let least = if quantity["id"].as_str().unwrap().starts_with("elbow") { 0.7 } else { 0.0 };
        assert!(quantity["variance_explained"].as_f64().unwrap() > least, "{quantity}");
    }
    improved_campaign_runs_over_time(folder.path());
}

/// Records of the improved campaign run over the same time, with another torque at the elbow.
fn improved_campaign_runs_over_time(folder: &Path) {
    let read = |path: PathBuf| std::fs::read_to_string(path).unwrap();
    let (before, after) = (read(example().join("simulation/A3.csv")), read(folder.join("improved/simulation/A3.csv")));
    assert_eq!(before.lines().next(), after.lines().next());
    assert_eq!(before.lines().count(), after.lines().count());
    let cells = |text: &str| -> Vec<Vec<f64>> {
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let pairs: Vec<_> = cells(&before).into_iter().zip(cells(&after)).collect();
    assert!(pairs.iter().all(|(before, after)| (before[0] - after[0]).abs() < 1e-9));
    assert!(pairs.iter().any(|(before, after)| (before[2] - after[2]).abs() > 0.05));
}
