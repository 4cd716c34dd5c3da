//! Mean comfort in the manner of EN 12299, of tones: closed forms.

use std::f64::consts::{PI, SQRT_2};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::common::campaign::certified;

/// Samples per second, and the length of the record in s: a section of 300 s between margins.
const RATE: u32 = 250;
const LENGTH: u32 = 340;
/// Amplitudes in m/s² of the lateral tone of 1 Hz and the vertical tone of 5 Hz; those at the other
/// position are smaller by the shares.
const LATERAL: f64 = 0.4;
const VERTICAL: f64 = 0.5;
const SHARES: [f64; 2] = [0.8, 0.9];

/// Both tones; the simulation has a lateral one of another size and phase.
fn tones(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("written");
    write(
        "campaign.yaml",
        "name: Tones\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n",
    );
    write("vehicle.yaml", "name: Coach\n");
    write("sections.csv", "section,start [s],end [s]\nS01,20,320\n");
    for (side, gain, phase) in [("measurement", 1.0, 0.0), ("simulation", 1.1, 0.3)] {
        fs::create_dir_all(folder.join(side)).expect("a folder");
        let mut text =
            "time [s],ay_I [m/s^2],ay_II [m/s^2],az_I [m/s^2],az_II [m/s^2]\n".to_string();
        for row in 0..=LENGTH * RATE {
            let time = f64::from(row) / f64::from(RATE);
            let lateral = gain * LATERAL * (2.0 * PI * time + phase).sin();
            let vertical = VERTICAL * (2.0 * PI * 5.0 * time).sin();
            let [far_y, far_z] = [SHARES[0] * lateral, SHARES[1] * vertical];
            let _ = writeln!(text, "{time:.3},{lateral:.6},{far_y:.6},{vertical:.6},{far_z:.6}");
        }
        write(&format!("{side}/S01.csv"), &text);
    }
}

/// Of a tone in a 5 s window with whole periods, the weighted rms value is A |H| / sqrt(2), the same
/// in all windows. |H| from the transfer functions, evaluated in Python with complex numbers: Wd at
/// 1 Hz 1.0110, Wb at 5 Hz 0.9570, Wk at 5 Hz 1.0388 (ISO 2631-1:1997, Table 3 has 1.011 and
/// 1.039). The bilinear transformation at 250 samples a second moves it by 0.06 %.
#[test]
fn mean_comfort_of_tones() {
    const TOLERANCE: f64 = 2e-3;
    let folder = tempfile::tempdir().expect("a temporary folder");
    tones(folder.path());
    // Tones are no plausible records.
    let protocol = folder.path().join("bare.fp");
    let text = "protocol bare \"Without plausibility\"\n  extends  en12299-mean-comfort\n\nremove\n  plausibility  every\n";
    fs::write(&protocol, text).expect("written");
    for (weighting, vertical) in [("Wb", 0.957_0), ("Wk", 1.038_8)] {
        let set = format!("vertical_weighting={weighting}");
        let found = certified(folder.path(), &protocol.display().to_string(), &[&set])
            .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
        let index = |gain: f64, [y, z]: [f64; 2]| {
            let lateral = gain * y * LATERAL * 1.011_0 / SQRT_2;
            6.0 * lateral.hypot(z * VERTICAL * vertical / SQRT_2)
        };
        let expected = |gain| [index(gain, [1.0, 1.0]), index(gain, SHARES)];
        let [measured, simulated] = [expected(1.0), expected(1.1)];
        let values = |id: &str| -> Vec<f64> {
            let quantity = found.quantities.iter().find(|one| one.id == id).expect("a quantity");
            quantity.values.iter().map(|value| value.difference).collect()
        };
        for (id, expected) in [("index_measured", measured), ("index_simulated", simulated)] {
            let values = values(id);
            assert_eq!(values.len(), 2, "{id}");
            for (value, expected) in values.iter().zip(expected) {
                assert!((value / expected - 1.0).abs() < TOLERANCE, "{id}: {value}, {expected}");
            }
        }
        for (at, difference) in values("index_difference").iter().enumerate() {
            let expected = simulated[at] - measured[at];
            assert!((difference / expected - 1.0).abs() < TOLERANCE, "{difference}, {expected}");
        }
    }
}
