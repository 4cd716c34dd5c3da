//! The check values of the model's description: medians over 100 m of even track, from the
//! independent code that made the simulation records of the campaigns. Within 0.02 kN and 0.001
//! m/s^2, as the description promises.

use fishplate::model::{Setup, Window, simulate};

use crate::model::common::{COACH, EVALUATED, WAGON, channel, curve, median, profile, vehicle};

struct Case {
    vehicle: &'static str,
    /// m, 0 straight; mm; m/s
    track: (f64, f64, f64),
    /// kN, wheels 1R 1L 2R 2L 3R 3L 4R 4L
    y: [f64; 8],
    q: [f64; 8],
    /// m/s^2
    ay: [f64; 2],
}

const CASES: [Case; 7] = [
    Case {
        vehicle: COACH,
        track: (0.0, 0.0, 44.0),
        y: [1.35, -1.35, 1.35, -1.35, 1.35, -1.35, 1.35, -1.35],
        q: [54.55, 54.55, 54.55, 54.55, 54.55, 54.55, 54.55, 54.55],
        ay: [0.0, 0.0],
    },
    Case {
        vehicle: COACH,
        track: (300.0, 120.0, 20.0),
        y: [17.13, -36.09, 4.89, 1.68, 18.50, -25.27, -0.37, -4.87],
        q: [43.56, 66.72, 51.65, 58.63, 47.24, 63.04, 48.19, 62.09],
        ay: [0.641, 0.641],
    },
    Case {
        vehicle: COACH,
        track: (-300.0, 120.0, 20.0),
        y: [36.09, -17.13, -1.68, -4.89, 25.27, -18.50, 4.87, 0.37],
        q: [66.72, 43.56, 58.63, 51.65, 63.04, 47.24, 62.09, 48.19],
        ay: [-0.641, -0.641],
    },
    Case {
        vehicle: COACH,
        track: (500.0, 100.0, 27.0),
        y: [14.38, -26.92, -0.88, -4.59, 13.95, -19.35, -3.52, -8.92],
        q: [42.85, 67.33, 45.22, 64.95, 44.99, 65.18, 43.19, 66.98],
        ay: [0.942, 0.942],
    },
    Case {
        vehicle: COACH,
        track: (1500.0, 80.0, 40.0),
        y: [3.58, -3.51, -3.59, -8.37, 2.75, -0.83, -4.30, -9.51],
        q: [49.22, 60.51, 45.79, 63.93, 49.79, 59.93, 45.26, 64.46],
        ay: [0.624, 0.623],
    },
    Case {
        vehicle: WAGON,
        track: (300.0, 100.0, 18.0),
        y: [31.74, -54.87, 4.92, -1.04, 29.81, -42.10, -0.08, -6.86],
        q: [93.66, 127.70, 102.05, 119.32, 94.98, 126.38, 96.90, 124.46],
        ay: [0.485, 0.485],
    },
    Case {
        vehicle: WAGON,
        track: (600.0, 80.0, 23.0),
        y: [17.29, -25.44, -0.89, -6.93, 12.13, -9.15, -5.41, -13.56],
        q: [100.42, 120.37, 100.96, 119.84, 100.59, 120.19, 94.49, 126.32],
        ay: [0.399, 0.399],
    },
];

/// Medians over the evaluated part, in the order of the record's channels.
pub fn medians(campaign: &str, radius: f64, cant: f64, speed: f64) -> Vec<f64> {
    let vehicle = vehicle(campaign, &[]);
    let profile = profile(campaign, &vehicle);
    let track = curve(radius, cant);
    let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed };
    let record = simulate(&setup, Window::around(EVALUATED.0, EVALUATED.1), 1.into()).unwrap();
    let inside = |signal: &Vec<f64>| {
        let pairs = record.distance.iter().zip(signal);
        pairs
            .filter(|(at, _)| (EVALUATED.0..=EVALUATED.1).contains(*at))
            .map(|(_, value)| *value)
            .collect::<Vec<_>>()
    };
    record.channels.iter().map(|signal| median(&inside(signal))).collect()
}

#[test]
fn all_medians_of_coach_and_wagon() {
    for case in &CASES {
        let (radius, cant, speed) = case.track;
        let found = medians(case.vehicle, radius, cant, speed);
        for (i, expected) in case.y.iter().chain(&case.q).enumerate() {
            let difference = found[i] - expected;
            assert!(
                difference.abs() <= 0.02,
                "{} R {radius} channel {i}: {} kN, not {expected}",
                case.vehicle,
                found[i]
            );
        }
        for (name, expected) in ["ay_I", "ay_II"].iter().zip(case.ay) {
            let found = found[channel(name)];
            assert!(
                (found - expected).abs() <= 0.001,
                "{} R {radius} {name}: {found} m/s^2, not {expected}",
                case.vehicle
            );
        }
    }
}
