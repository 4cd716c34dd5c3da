//! Every channel of every format against the CSV original, and what a file says of itself.

use fishplate::foreign::{Channel, File, Options, outline};

use super::{FILES, data, good};

/// Gravity as in the unit `g` of accelerations.
const G: f64 = 9.806_65;

/// The channel of the original and the factor to its unit and sign; the forces of the left wheels
/// are positive outward in the measurements.
fn original(side: &str, channel: &Channel) -> Option<(String, f64)> {
    let name = channel.name.trim_start_matches("$R_");
    let parts: Vec<&str> = name.split(' ').collect();
    let (name, sign) = match (side, parts.as_slice()) {
        (_, ["time" | "Zeit" | "t"]) => ("time".to_string(), 1.0),
        (_, ["s_track" | "Weg" | "distance"]) => ("distance".to_string(), 1.0),
        ("measurement", [set, force @ ("Y" | "Q"), wheel @ ("re" | "li")]) => {
            let wheel = if *wheel == "re" { 'R' } else { 'L' };
            let sign = if *force == "Y" && wheel == 'L' { -1.0 } else { 1.0 };
            (format!("{force}_{}{wheel}", set.trim_start_matches("ST")), sign)
        }
        ("measurement", [body @ ("WK1" | "WK2" | "DG1" | "DG2"), axis]) => {
            let bogie = if body.starts_with("DG") { "b" } else { "" };
            let end = if body.ends_with('1') { "I" } else { "II" };
            (format!("a{}{bogie}_{end}", axis.trim_end_matches('.')), 1.0)
        }
        ("simulation", [name]) => match *name {
            "yss_I" => ("ay_I".into(), 1.0),
            "yss_II" => ("ay_II".into(), 1.0),
            "zss_I" => ("az_I".into(), 1.0),
            "zss_II" => ("az_II".into(), 1.0),
            "yss_plus_1" => ("ayb_I".into(), 1.0),
            "yss_plus_4" => ("ayb_II".into(), 1.0),
            name => {
                let letters: Vec<char> = name.chars().collect();
                let [force @ ('Y' | 'Q'), wheel @ ('1' | '2'), set] = letters[..] else {
                    return None;
                };
                (format!("{force}_{set}{}", if wheel == '1' { 'R' } else { 'L' }), 1.0)
            }
        },
        _ => return None,
    };
    let factor = match channel.unit.as_deref() {
        Some("N") => 1e-3,
        Some("g") => G,
        Some("kN" | "s" | "m" | "m/s^2" | "m/s²") => 1.0,
        _ => return None,
    };
    Some((name, sign * factor))
}

/// Largest deviation of forces in kN, accelerations in m/s², times and distances, and the number of
/// channels compared.
fn deviations(file: &File, side: &str, original_file: &File) -> ([f64; 4], usize) {
    let mut largest = [0.0f64; 4];
    let mut count = 0;
    for channel in
        file.tables.iter().filter(|table| table.name != "group 2").flat_map(|table| &table.channels)
    {
        let Some((name, factor)) = original(side, channel) else { continue };
        let wanted = original_file.tables[0]
            .channels
            .iter()
            .find(|channel| channel.name == name)
            .expect("the original has it");
        assert!(
            !channel.values.is_empty() && channel.values.len() <= wanted.values.len(),
            "{name}: {}",
            channel.values.len()
        );
        let kind = match name.as_bytes()[0] {
            b'Y' | b'Q' => 0,
            b'a' => 1,
            b't' => 2,
            _ => 3,
        };
        for (value, wanted) in channel.values.iter().zip(&wanted.values) {
            largest[kind] = largest[kind].max((value * factor - wanted).abs());
        }
        count += 1;
    }
    (largest, count)
}

/// The forces are written with two decimals in kN, the accelerations with four; a single number has
/// seven digits.
#[test]
fn every_channel_is_that_of_the_original() {
    for (name, side) in FILES.into_iter().filter(|(name, _)| *name != "measurement.csv") {
        let (limits, channels) = match name {
            "groups.mf4" => ([4e-6, 3e-7, 1e-12, 0.0], 23),
            "group.tdms" => ([4e-6, 3e-7, 0.0, 1e-12], 23),
            "v5.mat" | "v5_plain.mat" => ([2e-14, 1e-15, 1e-12, 0.0], 23),
            "v73.mat" | "simpack.dat" => ([2e-14, 1e-15, 1e-12, 1e-12], 24),
            _ => ([0.0; 4], 24),
        };
        let (found, count) = deviations(
            &good(name, &Options::default()),
            side,
            &good(&format!("{side}.csv"), &Options::default()),
        );
        for (found, limit) in found.into_iter().zip(limits) {
            assert!(found <= limit, "{name}: {found:?} is more than {limits:?}");
        }
        assert_eq!(count, channels, "{name}");
    }
}

#[test]
fn groups_have_their_own_rates() {
    let file = good("groups.mf4", &Options::default());
    let found: Vec<(&str, Option<i64>, usize)> = file
        .tables
        .iter()
        .map(|table| (table.name.as_str(), table.rate.map(|rate| rate.round() as i64), table.rows))
        .collect();
    let comments: Vec<bool> = file
        .tables
        .iter()
        .map(|table| {
            table.facts.iter().any(|(name, text)| name == "comment" && text.contains("Hz"))
        })
        .collect();
    assert_eq!(found, [("group 1", Some(200), 200), ("group 2", Some(20), 20)]);
    assert_eq!(comments, [true, true]);
    let speed =
        file.tables[1].channels.iter().find(|channel| channel.name == "v").expect("the speed");
    assert_eq!(speed.unit.as_deref(), Some("km/h"));
    let rates = |name: &str| {
        good(name, &Options::default()).tables[0].rate.map(|rate| (rate * 1e6).round() / 1e6)
    };
    for name in [
        "v5.mat",
        "group.tdms",
        "zstd.parquet",
        "book.xlsx",
        "windows.csv",
        "v73.mat",
        "simpack.dat",
    ] {
        assert_eq!(rates(name), Some(200.0), "{name}");
    }
}

#[test]
fn what_a_file_says_of_itself_is_kept() {
    let table = &good("v5.mat", &Options::default()).tables[0];
    assert_eq!(table.name, "S06");
    assert!(
        table.facts.iter().any(|(name, value)| name == "x_start" && value.starts_with("109.")),
        "{:?}",
        table.facts
    );
    let facts = |name: &str| {
        let file = good(name, &Options::default());
        file.facts
            .into_iter()
            .chain(file.tables.into_iter().flat_map(|table| table.facts))
            .collect::<Vec<_>>()
    };
    let has = |name: &str, wanted: (&str, &str)| {
        assert!(
            facts(name).contains(&(wanted.0.into(), wanted.1.into())),
            "{name}: {:?}",
            facts(name)
        )
    };
    has("zstd.parquet", ("section", "S06"));
    has("lz4.feather", ("section", "S06"));
    has("simpack.dat", ("Section", "S06"));
    has("simpack.dat", ("Model", "Coach_C44.spck"));
    has("group.tdms", ("convention", "Y outward positive"));
    has("group.tdms", ("wf_increment", "0.005"));
    has("windows.csv", ("encoding", "windows-1252"));
    has("windows.csv", ("separator", "`;`"));
    has("book.xlsx", ("sheet `Info`", "no rows of numbers"));
    let sheets: Vec<String> =
        good("book.xlsx", &Options::default()).tables.into_iter().map(|table| table.name).collect();
    assert_eq!(sheets, ["S06"]);
}

#[test]
fn an_outline_has_the_same_channels() {
    for (name, _) in FILES {
        let outline = outline(&data(name), name, &Options::default()).expect("an outline");
        let whole = good(name, &Options::default());
        let names = |file: &File| -> Vec<_> {
            let channels = |channels: &[Channel]| {
                channels
                    .iter()
                    .map(|channel| (channel.name.clone(), channel.unit.clone()))
                    .collect::<Vec<_>>()
            };
            file.tables
                .iter()
                .map(|table| (table.name.clone(), table.rows, channels(&table.channels)))
                .collect()
        };
        assert_eq!(names(&outline), names(&whole), "{name}");
    }
}
