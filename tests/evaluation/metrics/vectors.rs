//! The pairs of `tests/cases/vectors`: filters, values per section, sliding means.

use fishplate::metrics::{
    filter::{Band, Cutoff, Filter, Phase},
    percentile::{Method, percentile, percentiles},
    statistics::{Divisor, mean, rms, standard_deviation},
    window::{Ends, Kind, Sliding},
};
use serde_json::Value;

use crate::metrics::{all_close, case, close, json, number, numbers};

pub const PAIRS: [&str; 4] =
    ["pair_Y_offset_200Hz", "pair_Q_gain_500Hz", "pair_ay_shift_400Hz", "pair_az_noise_1000Hz"];

/// Header and columns of a table of numbers.
fn table(path: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_path(case(path)).expect(path);
    let header: Vec<String> = reader.headers().expect(path).iter().map(String::from).collect();
    let mut columns = vec![Vec::new(); header.len()];
    for row in reader.records() {
        for (column, text) in columns.iter_mut().zip(&row.expect(path)) {
            column.push(text.parse().expect(path));
        }
    }
    (header, columns)
}

pub struct Pair {
    pub expected: Value,
    distance: Vec<f64>,
    measured: Vec<f64>,
    simulated: Vec<f64>,
}

impl Pair {
    pub fn read(name: &str) -> Self {
        let expected = json("vectors/expected.json")["pairs"][name].clone();
        let (_, mut columns) = table(&format!("vectors/{name}.csv"));
        let simulated = columns.pop().expect("four columns");
        let measured = columns.pop().expect("four columns");
        let distance = columns.pop().expect("four columns");
        Self { expected, distance, measured, simulated }
    }

    fn section(&self) -> (f64, f64) {
        (number(&self.expected["start"]), number(&self.expected["end"]))
    }

    fn cut(&self, signal: &[f64]) -> Vec<f64> {
        let (start, end) = self.section();
        self.distance
            .iter()
            .zip(signal)
            .filter(|(at, _)| (start..=end).contains(*at))
            .map(|(_, value)| *value)
            .collect()
    }

    /// Unfiltered simulation and measurement in the section.
    pub fn signals(&self) -> (Vec<f64>, Vec<f64>) {
        (self.cut(&self.simulated), self.cut(&self.measured))
    }

    fn sides(&self) -> [(&'static str, &[f64]); 2] {
        [("measurement", &self.measured), ("simulation", &self.simulated)]
    }

    fn filter(&self, name: &str, phase: &str) -> Filter {
        let spec = &self.expected["filters"][name];
        let band = match &spec["Wn"] {
            Value::Array(edges) => Band::BandPass(number(&edges[0]), number(&edges[1])),
            single => Band::LowPass(number(single)),
        };
        let phase = match phase {
            "zero_phase" => Phase::Zero,
            "causal_rest" => Phase::CausalFromRest,
            _ => Phase::Causal,
        };
        let order = number(&spec["order"]) as usize;
        Filter::design(band, order, number(&self.expected["fs"]), phase, Cutoff::PerPass)
            .expect("a good design")
    }
}

#[test]
fn sections_are_scipys() {
    for name in PAIRS {
        let pair = Pair::read(name);
        for (filter, spec) in pair.expected["filters"].as_object().expect("filters") {
            let ours = pair.filter(filter, "zero_phase");
            let theirs = spec["sos"].as_array().expect("sections");
            assert_eq!(ours.sections().len(), theirs.len());
            for (ours, theirs) in ours.sections().iter().zip(theirs) {
                for (a, e) in ours.iter().zip(numbers(theirs)) {
                    close(*a, e, 1e-11);
                }
            }
            assert_eq!(ours.samples_needed(), number(&spec["sosfiltfilt_padlen"]) as usize + 1);
            for (frequency, level) in spec["response_dB"].as_object().expect("response") {
                let frequency: f64 = frequency.parse().expect("a frequency");
                let of_one_pass = 10.0 * ours.gain(frequency).log10();
                assert!(
                    (of_one_pass - number(level)).abs() < 1e-6,
                    "{name} {filter} {frequency} Hz: {of_one_pass} dB"
                );
            }
        }
    }
}

/// Samples to 1e-9 of the largest; statistics of the section to 1e-9 of themselves, or of the rms
/// where they pass through zero.
#[test]
fn filtered_records_and_their_values() {
    for name in PAIRS {
        let pair = Pair::read(name);
        let (header, columns) = table(&format!("vectors/{name}_filtered.csv"));
        for (title, expected) in header.iter().zip(&columns).skip(1) {
            let [filter, phase, side] = title.split(' ').collect::<Vec<_>>()[..] else {
                panic!("{title}")
            };
            let signal =
                pair.sides().into_iter().find(|(name, _)| *name == side).expect("a side").1;
            let filtered = pair.filter(filter, phase).apply(signal).expect("long enough");
            let rows: Vec<f64> = columns[0].iter().map(|&row| filtered[row as usize]).collect();
            let scale = filtered.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
            all_close(&rows, expected, scale, 1e-9);

            let section = pair.cut(&filtered);
            let values = &pair.expected["values"][filter][phase][side];
            let root = number(&values["rms"]);
            let near = |actual: Option<f64>, key: &str| {
                let (actual, expected) = (actual.expect("defined"), number(&values[key]));
                assert!(
                    (actual - expected).abs() < 1e-9 * root,
                    "{name} {title} {key}: {actual}, not {expected}"
                );
            };
            near(rms(&section), "rms");
            near(mean(&section), "mean");
            near(standard_deviation(&section, Divisor::Sample), "std_n1");
            near(standard_deviation(&section, Divisor::Population), "std_n");
            for (percent, key) in [(0.15, "p0_15"), (50.0, "p50"), (99.85, "p99_85")] {
                near(percentile(&section, percent, Method::Linear).ok(), key);
            }
            for (method, expected) in values["percentile_methods"].as_object().into_iter().flatten()
            {
                let method = Method::from_name(method).expect("a method");
                let ours = percentiles(&section, &[0.15, 50.0, 99.85], method).expect("values");
                all_close(&ours, &numbers(expected), root, 1e-9);
            }
        }
    }
}

#[test]
fn sliding_means() {
    for name in PAIRS {
        let pair = Pair::read(name);
        let (start, end) = pair.section();
        for (side, signal) in pair.sides() {
            let expected = &pair.expected["sliding_mean_2m"][side];
            for (ends, key) in [(Ends::Samples, "samples"), (Ends::Integral, "integral")] {
                let window = Sliding {
                    width: 2.0,
                    step: Some(0.5),
                    kind: Kind::Mean,
                    ends,
                    short_sections: false,
                };
                let starts = window.starts(&pair.distance, start, end).expect("a section");
                assert_eq!(starts.len() as f64, number(&expected["windows"]));
                assert_eq!(
                    [starts[0], starts[starts.len() - 1]].to_vec(),
                    numbers(&expected["window_start"])
                );
                let means = window.over(&pair.distance, signal, start, end).expect("a section");
                let theirs = numbers(&expected[key]);
                all_close(&means, &theirs, rms(signal).expect("defined"), 1e-12);
                if ends == Ends::Samples {
                    close(
                        percentile(&means, 99.85, Method::Linear).expect("values"),
                        number(&expected["samples_p99_85"]),
                        1e-11,
                    );
                    close(
                        percentile(&means, 0.15, Method::Linear).expect("values"),
                        number(&expected["samples_p0_15"]),
                        1e-11,
                    );
                    // A record already cut to the section gives the same windows.
                    let cut = window
                        .over(&pair.cut(&pair.distance), &pair.cut(signal), start, end)
                        .expect("a section");
                    all_close(&cut, &means, rms(signal).expect("defined"), 1e-14);
                }
            }
        }
    }
}
