//! The memory of an import of runs: one file at a time is held, and little of what is made of it.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use fishplate::data::record::read_raw;
use fishplate::data::write::{Values, parquet};

/// A record of `examples/run`, repeated; its bytes as numbers.
fn repeated(from: &str, times: usize, to: &Path) -> usize {
    let mut columns = read_raw(Path::new(from), "record").expect("a record");
    for column in &mut columns {
        let Values::Numbers(values) = &mut column.values else { panic!("numbers") };
        let axis = ["time [s]", "distance [m]"].contains(&column.heading.as_str());
        let once = values.clone();
        let length =
            if axis { 2.0 * once[once.len() - 1] - once[once.len() - 2] - once[0] } else { 0.0 };
        values.extend(
            (1..times)
                .flat_map(|number| once.iter().map(move |value| value + length * number as f64)),
        );
    }
    fs::write(to, parquet(&columns).expect("written")).expect("written");
    columns.iter().map(|column| 8 * column.values.len()).sum()
}

/// Most memory of an import in bytes, and the bytes of the numbers of one of its records.
fn peak(times: usize) -> (usize, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let side = |name: &str| {
        format!(
            "{name}:\n  files: {name}.parquet\n  time: time\n  distance: distance\n  channels: as named\n"
        )
    };
    let mut bytes = 0;
    for (name, file) in [("measurement", "north-measured"), ("simulation", "north-simulated")] {
        let from = format!("examples/run/records/{file}.parquet");
        bytes = repeated(&from, times, &folder.path().join(format!("{name}.parquet")));
    }
    let mapping = format!("name: long\nruns: [R]\n{}{}", side("measurement"), side("simulation"));
    fs::write(folder.path().join("mapping.yaml"), mapping).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fishplate"));
    command
        .arg("import")
        .arg(folder.path().join("mapping.yaml"))
        .args(["--records", "parquet", "--out"])
        .arg(folder.path().join("out"))
        // What is freed is given back at once: later, its amount depends on the load of the machine.
        .env("MIMALLOC_PURGE_DELAY", "0");
    let mut child =
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts");
    let mut most = 0;
    let code = loop {
        // The mark of the most memory is gone when the program has ended.
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let mark = status.lines().find_map(|line| {
            line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse::<usize>().ok()
        });
        most = most.max(mark.unwrap_or(0) << 10);
        if let Some(code) = child.try_wait().expect("a child") {
            break code;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    assert!(code.success() && folder.path().join("out/simulation/R.parquet").is_file());
    (most, bytes)
}

/// The memory grows with the file that is read, its bytes and its numbers, not with both records
/// and not with what is written.
#[test]
fn a_longer_run_needs_the_memory_of_one_file() {
    let ((short, of_short), (long, of_long)) = (peak(4), peak(8));
    let (grown, file) = (long.saturating_sub(short), of_long - of_short);
    assert!(
        grown < 3 * file,
        "{short} to {long} bytes: {} times the numbers of a record",
        grown as f64 / file as f64
    );
}
