//! Shipped rule sets against NumPy and SciPy: `cases/shipped-rule-sets/independent.py` makes the
//! same records, of whole numbers, and the values in `expected.csv`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::common::campaign::{certified, replace};
use fishplate::result::{Certification, QuantityResult};

const EXPECTED: &str = "tests/cases/shipped-rule-sets/expected.csv";
/// Samples of a record, 400 a second and 0.1 m apart.
const ROWS: i64 = 4801;
const SECTIONS: i64 = 3;
/// Share of a value, or of 0.001 of its unit for smaller ones.
const TOLERANCE: f64 = 1e-9;

/// Quarter of the period in samples, and size, of a wave.
type Wave = (i64, i64);

/// Name, unit, mean and waves of each channel, as `channels` of `independent.py`.
fn channels() -> Vec<(String, &'static str, i64, Vec<Wave>)> {
    let forces: [(&str, i64, &[Wave]); 3] = [
        ("Y", 9000, &[(97, 16_000), (31, 7000), (7, 2000)]),
        ("Q", 60_000, &[(113, 18_000), (23, 12_000), (5, 3000)]),
        ("Q_level", 61_000, &[(211, 500)]),
    ];
    let mut all = Vec::new();
    for (name, mean, waves) in forces {
        for wheel in ["1R", "1L", "2R", "2L", "3R", "3L", "4R", "4L"] {
            all.push((format!("{name}_{wheel}"), "N", mean, waves.to_vec()));
        }
    }
    for (name, mean, big) in [("ay", 300, 900), ("az", 0, 1300), ("ayb", 0, 2100)] {
        for gear in ["I", "II"] {
            let waves = vec![(129, big), (41, big / 2), (11, big / 3)];
            all.push((format!("{name}_{gear}"), "mm/s^2", mean, waves));
        }
    }
    all
}

/// A triangle wave of whole numbers.
fn triangle(i: i64, quarter: i64, size: i64) -> i64 {
    let r = i.rem_euclid(4 * quarter);
    let v = if r <= quarter {
        r
    } else if r <= 3 * quarter {
        2 * quarter - r
    } else {
        r - 4 * quarter
    };
    (size * v).div_euclid(quarter)
}

/// `side` is 0 for the measurement and 1 for the simulation.
fn record(section: i64, side: i64) -> String {
    let channels = channels();
    let mut text = "time [s],distance [m]".to_string();
    for (name, unit, ..) in &channels {
        let _ = write!(text, ",{name} [{unit}]");
    }
    text.push('\n');
    for i in 0..ROWS {
        let _ = write!(text, "{}.{:04},{}.{}", i / 400, i % 400 * 25, i / 10, i % 10);
        for (at, (name, _, mean, waves)) in (0..).zip(&channels) {
            let mut value = *mean;
            for (k, (quarter, size)) in (1..).zip(waves) {
                let shift = 37 * at * k + 1000 * section + 3 * side;
                let size = size + size * side / 16;
                value += triangle(i + shift, quarter + at % 5 + 2 * section, size);
            }
            // A blow of 20 ms, which a rule on short peaks leaves out.
            if name == "az_I" && (2000..2008).contains(&i) {
                value += 6000;
            }
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

fn triangles() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).expect("written");
    };
    for (side, kind) in [(0, "measurement"), (1, "simulation")] {
        fs::create_dir(folder.path().join(kind)).expect("a folder");
        for section in 0..SECTIONS {
            write(&format!("{kind}/S{}.csv", section + 1), &record(section, side));
        }
    }
    write(
        "campaign.yaml",
        "name: Triangles\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n",
    );
    write(
        "vehicle.yaml",
        "name: Coach\ncategory: passenger\nstatic_wheel_load: 60\nflange_angle: 68 deg\n",
    );
    let mut table = "section,start [m],end [m],radius [m],direction,speed [km/h]\n".to_string();
    for section in 1..=SECTIONS {
        let _ = writeln!(table, "S{section},100,400,500,right,144");
    }
    write("sections.csv", &table);
    folder
}

/// A shipped protocol without its plausibility rules: triangles are no plausible records.
fn run(campaign: &Path, protocol: &str) -> Certification {
    let path = campaign.join("bare.fp");
    let text = format!(
        "protocol bare \"Without plausibility\"\n  extends  {protocol}\n\nremove\n  plausibility  every\n"
    );
    fs::write(&path, text).expect("written");
    certified(campaign, &path.display().to_string(), &[])
        .unwrap_or_else(|problems| panic!("{protocol}: {}", problems.render(false)))
}

#[track_caller]
fn quantity<'a>(found: &'a Certification, id: &str) -> &'a QuantityResult {
    let known = found.quantities.iter().find(|one| one.id == id);
    known.unwrap_or_else(|| panic!("no quantity {id}"))
}

/// Values by section, quantity and position.
type Values = BTreeMap<[String; 3], f64>;

/// The rows of `expected.csv`, by protocol.
fn expected() -> BTreeMap<String, Values> {
    let text = fs::read_to_string(EXPECTED).expect("the expected values");
    let mut all: BTreeMap<String, Values> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [protocol, section, quantity, position, value] = cells[..] else {
            panic!("{line}: five cells");
        };
        let place = [section, quantity, position].map(str::to_string);
        let value = value.parse().expect("a number");
        all.entry(protocol.to_string()).or_default().insert(place, value);
    }
    all
}

#[test]
fn values_agree_with_numpy_and_scipy() {
    let folder = triangles();
    let expected = expected();
    assert!(expected.len() >= 3, "{:?}", expected.keys());
    for (protocol, mut expected) in expected {
        let found = run(folder.path(), &protocol);
        for quantity in &found.quantities {
            for value in &quantity.values {
                let position = value.signal.rsplit('_').next().unwrap_or_default();
                let place = [value.section.as_str(), &quantity.id, position].map(str::to_string);
                let wanted = expected.remove(&place);
                let wanted = wanted.unwrap_or_else(|| panic!("{protocol}: {place:?} is new"));
                assert!(
                    (value.difference - wanted).abs() <= TOLERANCE * wanted.abs().max(1e-3),
                    "{protocol}, {place:?}: {} in place of {wanted}",
                    value.difference
                );
            }
        }
        assert!(expected.is_empty(), "{protocol} has no {:?}", expected.keys());
    }
}

/// The limit of a quantity that has one.
#[track_caller]
fn limit(found: &Certification, id: &str) -> f64 {
    quantity(found, id).statistics[0].limit.unwrap_or_else(|| panic!("{id} has no limit"))
}

#[track_caller]
fn limits(found: &Certification, wanted: &[(&str, f64)]) {
    assert_eq!(found.quantities.len(), wanted.len());
    for (id, wanted) in wanted {
        let limit = limit(found, id);
        assert!((limit / wanted - 1.0).abs() < 1e-12, "{id}: {limit} in place of {wanted}");
    }
}

const GN: f64 = 9.806_65;
/// tan 68° by Python's `math.tan`.
const TAN: f64 = 2.475_086_853_416_296_4;
/// The limit of a single wheel, for 68° and a friction of 0.5.
const SINGLE: f64 = (TAN - 0.5) / (1.0 + 0.5 * TAN);

/// Table of 49 CFR 213.333 by class of vehicle; 5000 lbf are 22.241 108 kN over an axle of 120 kN.
#[test]
fn limits_of_cfr_213_333() {
    let folder = triangles();
    let net = 0.4 + 5000.0 * 4.448_221_615_260_5 / 120_000.0;
    for (category, [lateral, rms, vertical]) in
        [("passenger", [0.65, 0.10, 1.0]), ("freight", [0.75, 0.12, 1.25])]
    {
        let vehicle = folder.path().join("vehicle.yaml");
        replace(&vehicle, "category: passenger", &format!("category: {category}"));
        let found = run(folder.path(), "cfr-213-333");
        let wanted = [
            ("wheel_load", 0.15),
            ("single_wheel", SINGLE),
            ("net_axle", net),
            ("truck_side_I", 0.6),
            ("truck_side_II", 0.6),
            ("body_lateral_peak", lateral * GN),
            ("body_vertical_peak", vertical * GN),
            ("body_lateral_rms", rms * GN),
            ("body_vertical_rms", 0.25 * GN),
            ("truck_lateral", 0.30 * GN),
        ];
        limits(&found, &wanted);
    }
}

#[test]
fn limits_of_cfr_238_appendix_c() {
    let folder = triangles();
    let wanted = [
        ("single_wheel", SINGLE),
        ("net_axle", 0.5),
        ("wheel_load", 0.10),
        ("side_load_I", 0.20),
        ("side_load_II", 0.20),
        ("truck_side_I", 0.6),
        ("truck_side_II", 0.6),
    ];
    limits(&run(folder.path(), "cfr-238-appendix-c"), &wanted);
    limits(&run(folder.path(), "cfr-238-appendix-c-stationary"), &[("load", 0.60)]);
}
