//! Shipped rule sets against NumPy and SciPy: `cases/shipped-rule-sets/independent.py` makes the
//! same records, of whole numbers, and the values in `expected.csv`; `ratings.py` those of
//! ISO/TS 18571, by `objective-rating-metrics` 1.3.

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

/// Expanded uncertainties of the measurement and the simulation, standard ones of numerics and of
/// the input.
const UNCERTAINTIES: [(&str, &str, [f64; 4]); 3] = [
    ("Y", "kN", [0.9, 1.1, 0.2, 0.4]),
    ("Q", "kN", [1.5, 1.2, 0.3, 0.5]),
    ("ay", "m/s^2", [0.05, 0.04, 0.01, 0.02]),
];

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
pub fn triangle(i: i64, quarter: i64, size: i64) -> i64 {
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
            // A rise of its own tells one period from the next.
            let mut value = *mean + waves[0].1 * i * i / (2 * ROWS * ROWS);
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
        "name: Coach\ncategory: passenger\nstatic_wheel_load: 60\nflange_angle: 68 deg\nuncertainty:\n",
    );
    let vehicle = folder.path().join("vehicle.yaml");
    let mut text = fs::read_to_string(&vehicle).expect("readable");
    for (channel, unit, numbers) in UNCERTAINTIES {
        for (part, number) in ["measured", "simulated", "numerical", "input"].iter().zip(numbers) {
            let _ = writeln!(text, "  {channel}_{part}: {number} {unit}");
        }
    }
    fs::write(&vehicle, text).expect("written");
    let mut table = "section,start [m],end [m],radius [m],direction,speed [km/h]\n".to_string();
    for section in 1..=SECTIONS {
        let _ = writeln!(table, "S{section},100,400,500,right,144");
    }
    write("sections.csv", &table);
    folder
}

/// A shipped protocol without its plausibility rules: triangles are no plausible records.
fn run(campaign: &Path, protocol: &str) -> Certification {
    run_with(campaign, protocol, &[])
}

fn run_with(campaign: &Path, protocol: &str, set: &[&str]) -> Certification {
    let path = campaign.join("bare.fp");
    let text = format!(
        "protocol bare \"Without plausibility\"\n  extends  {protocol}\n\nremove\n  plausibility  every\n"
    );
    fs::write(&path, text).expect("written");
    certified(campaign, &path.display().to_string(), set)
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
    assert!(expected.len() == 9, "{:?}", expected.keys());
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

/// The numbers that the texts of standards not to hand have from memory, for a passenger vehicle in
/// a curve of 500 m; 55 kN are 15 kN and a third of an axle load of 120 kN.
#[test]
fn limits_from_memory() {
    let folder = triangles();
    let forces = [
        ("wheel", 1.0),
        ("axle", 1.5),
        ("truck_side_I", 0.6),
        ("truck_side_II", 0.6),
        ("load", 0.10),
    ];
    limits(&run(folder.path(), "aar-m1001-chapter-11"), &forces);
    let doses = [("dose_measured", 30.0), ("dose_simulated", 30.0), ("dose_difference", 0.1)];
    limits(&run(folder.path(), "iso2631-msdv"), &doses);
    let found = run(folder.path(), "gbt5599");
    for (id, wanted) in [("derailment", 0.8), ("unloading", 0.65), ("axle_lateral", 55.0)] {
        let limit = limit(&found, id);
        assert!((limit / wanted - 1.0).abs() < 1e-12, "{id}: {limit}");
    }
    let vehicle = folder.path().join("sections.csv");
    replace(&vehicle, ",500,", ",400,");
    assert!((limit(&run(folder.path(), "gbt5599"), "derailment") - 1.0).abs() < 1e-12);
}

/// Twice the root of the sum of three squares; the measurement has half of its expanded one.
#[test]
fn limits_of_uncertainties() {
    let folder = triangles();
    let found = run(folder.path(), "en-score");
    for (channel, _, [measured, _, numerical, input]) in UNCERTAINTIES {
        let u_val = f64::hypot(numerical, input).hypot(measured / 2.0);
        for (id, wanted) in
            [(format!("{channel}_En"), 1.0), (format!("{channel}_error"), 2.0 * u_val)]
        {
            let limit = limit(&found, &id);
            assert!((limit / wanted - 1.0).abs() < 1e-12, "{id}: {limit} in place of {wanted}");
        }
    }
}

/// Each grade: the bounds of the better ones are missed by 1e-6, those of it and the worse ones are
/// met by as much. `met` is the sign of a bound that is met.
fn grades(
    folder: &Path,
    (protocol, id, ending): (&str, &str, &str),
    names: [&str; 4],
    (value, met): (f64, f64),
) -> Vec<Certification> {
    let mut all = Vec::new();
    for (at, grade) in names.iter().enumerate() {
        let bound = |nth: usize| if nth < at { value - met * 1e-6 } else { value + met * 1e-6 };
        let bounds: Vec<String> =
            (0..3).map(|nth| format!("{}_{ending}={}", names[nth], bound(nth))).collect();
        let set: Vec<&str> = bounds.iter().map(String::as_str).collect();
        let found = run_with(folder, protocol, &set);
        let graded = quantity(&found, id);
        assert_eq!(graded.outcome.as_deref(), Some(*grade), "{set:?}");
        assert_eq!(graded.holds, Some(at < 3), "{set:?}");
        all.push(found);
    }
    all
}

/// The grade of a ride, by the largest of its six values.
#[test]
fn grades_of_the_ride() {
    let folder = triangles();
    let found = run(folder.path(), "gbt5599");
    let values = quantity(&found, "ride_lateral").values.iter().map(|value| value.difference);
    let largest = values.fold(f64::MIN, f64::max);
    let names = ["excellent", "good", "qualified", "unqualified"];
    grades(folder.path(), ("gbt5599", "ride_lateral", "coach"), names, (largest, 1.0));
}

/// Both ends of the interval, by `independent.py` (Student's t of SciPy, sums of the sections).
#[test]
fn ends_of_the_mean_difference() {
    let folder = triangles();
    let found = run(folder.path(), "tost-equivalence");
    let wanted = [
        ("Y", 0.029_402_904_819_304_847, -0.034_724_492_118_074_37),
        ("Q", 0.027_560_088_410_814_226, -0.010_129_165_564_195_198),
        ("ay", 0.031_719_285_700_021_96, 0.029_682_125_338_132_67),
    ];
    for (channel, upper, lower) in wanted {
        let id = format!("{channel}_equivalence");
        let ends = &quantity(&found, &id).statistics;
        assert_eq!(ends.len(), 2, "{id}");
        for (end, wanted) in ends.iter().zip([upper, lower]) {
            let value = end.value.expect("a number");
            assert!((value / wanted - 1.0).abs() < TOLERANCE, "{id}: {value} in place of {wanted}");
        }
    }
}

/// The weighted mean of the ratings, by `ratings.py`, and the grade on both sides of each bound.
#[test]
fn grades_of_the_weighted_rating() {
    const RATING: f64 = 0.985_012_121_038_730_6;
    let folder = triangles();
    let names = ["excellent", "good", "fair", "poor"];
    let graded = ("iso18571-weighted-rating", "rating", "above");
    for found in grades(folder.path(), graded, names, (RATING, -1.0)) {
        let weighted = quantity(&found, "rating").reported[0].value.expect("a number");
        assert!((weighted / RATING - 1.0).abs() < TOLERANCE, "{weighted}");
    }
}
