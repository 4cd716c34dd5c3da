//! Vehicles, tracks and records for the tests.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use fishplate::model::equations::Equations;
use fishplate::model::integrate::{Method, SAMPLE, least_steps, run};
use fishplate::model::state::State;
use fishplate::model::{
    CHANNELS, Failure, Profile, ProfileTable, Record, Setup, Track, TrackTable, Vehicle, Window,
    simulate,
};

/// A campaign's folder below the repository.
pub fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

pub const COACH: &str = "examples/coach";
pub const WAGON: &str = "tests/cases/model/wagon";

/// The numbers of a CSV file, column by column; what is no number is NaN.
pub fn columns(path: &Path) -> Vec<Vec<f64>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let mut columns = vec![Vec::new(); reader.headers().unwrap().len()];
    for row in reader.records() {
        for (column, cell) in columns.iter_mut().zip(&row.unwrap()) {
            column.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

/// The vehicle of a campaign with some parameters set.
pub fn vehicle(campaign: &str, set: &[(&str, f64)]) -> Vehicle {
    fn flatten(prefix: &str, value: &serde_yaml::Value, flat: &mut HashMap<String, f64>) {
        if let serde_yaml::Value::Mapping(entries) = value {
            for (key, value) in entries {
                flatten(&format!("{prefix}.{}", key.as_str().unwrap()), value, flat);
            }
        } else if let Some(number) =
            value.as_f64().or_else(|| value.as_str()?.split(' ').next()?.parse().ok())
        {
            // The unit behind a number is that of the model.
            flat.insert(prefix.trim_start_matches('.').to_owned(), number);
        }
    }
    let text = std::fs::read_to_string(folder(campaign).join("vehicle.yaml")).unwrap();
    let mut flat = HashMap::new();
    flatten("", &serde_yaml::from_str(&text).unwrap(), &mut flat);
    let mut vehicle = Vehicle::from_values(|key| flat.get(key).copied()).unwrap();
    for (key, value) in set {
        vehicle.set(key, *value).unwrap();
    }
    vehicle
}

pub fn profile_table(campaign: &str) -> ProfileTable {
    let mut columns = columns(&folder(campaign).join("profile.csv")).into_iter();
    let mut next = || columns.next().unwrap();
    ProfileTable {
        displacement: next(),
        radius_deviation: [next(), next()],
        contact_angle: [next(), next()],
    }
}

pub fn profile(campaign: &str, vehicle: &Vehicle) -> Profile {
    Profile::new(&profile_table(campaign), None, vehicle).unwrap()
}

/// Wheels that are cones, over 20 mm to either side: the only profile whose motion has a closed
/// form.
pub fn cones(conicity: f64, contact_angle: f64, vehicle: &Vehicle) -> Profile {
    let rise = 20.0 * conicity;
    let table = ProfileTable {
        displacement: vec![-20.0, 0.0, 20.0],
        radius_deviation: [vec![-rise, 0.0, rise], vec![rise, 0.0, -rise]],
        contact_angle: [vec![contact_angle; 3], vec![contact_angle; 3]],
    };
    Profile::new(&table, None, vehicle).unwrap()
}

pub fn track_table(path: &Path) -> TrackTable {
    let mut columns = columns(path).into_iter();
    let mut next = || columns.next().unwrap();
    TrackTable {
        distance: next(),
        curvature: next(),
        cant: next(),
        alignment: next(),
        level: next(),
        cross_level: next(),
        gauge: next(),
    }
}

/// An even track: points of distance in m, curvature in 1/m, cant in mm.
pub fn even(points: &[(f64, f64, f64)]) -> TrackTable {
    let zeros = vec![0.0; points.len()];
    TrackTable {
        distance: points.iter().map(|point| point.0).collect(),
        curvature: points.iter().map(|point| point.1).collect(),
        cant: points.iter().map(|point| point.2).collect(),
        alignment: zeros.clone(),
        level: zeros.clone(),
        cross_level: zeros.clone(),
        gauge: zeros,
    }
}

/// Straight run-in of 40 m, ramp of 80 m, 90 m to settle, 100 m to evaluate: the track of the check
/// values. Radius in m, 0 for straight track; cant in mm, with the sign of the radius.
pub fn curve(radius: f64, cant: f64) -> TrackTable {
    let kappa = if radius == 0.0 { 0.0 } else { 1.0 / radius };
    let cant = cant * kappa.signum();
    even(&[(0.0, 0.0, 0.0), (40.0, 0.0, 0.0), (120.0, kappa, cant), (500.0, kappa, cant)])
}

/// The evaluated part of [`curve`], in m.
pub const EVALUATED: (f64, f64) = (210.0, 310.0);

/// A run over a section of a campaign with the record it came with.
pub struct Section {
    pub name: String,
    pub start: f64,
    pub end: f64,
    pub speed: f64,
    pub track: TrackTable,
    /// Distance and the channels.
    pub recorded: Vec<Vec<f64>>,
}

impl Section {
    pub fn window(&self) -> Window {
        Window::around(self.start, self.end)
    }

    pub fn simulate(&self, vehicle: &Vehicle, profile: &Profile) -> Result<Record, Failure> {
        let setup = Setup { vehicle, profile, track: &self.track, speed: self.speed };
        simulate(&setup, self.window(), 1.into())
    }

    /// The samples of a signal of `record` inside the section.
    pub fn inside(&self, distance: &[f64], signal: &[f64]) -> Vec<f64> {
        let pairs = distance.iter().zip(signal);
        pairs
            .filter(|(at, _)| (self.start..=self.end).contains(*at))
            .map(|(_, value)| *value)
            .collect()
    }
}

pub fn sections(campaign: &str) -> Vec<Section> {
    let folder = folder(campaign);
    let mut reader = csv::Reader::from_path(folder.join("sections.csv")).unwrap();
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        let file = format!("{}.csv", &row[0]);
        Section {
            name: row[0].to_owned(),
            start: number(2),
            end: number(3),
            speed: number(8) / 3.6,
            track: track_table(&folder.join("track").join(&file)),
            recorded: columns(&folder.join("simulation").join(&file)).split_off(1),
        }
    });
    rows.collect()
}

pub fn section(campaign: &str, name: &str) -> Section {
    sections(campaign).into_iter().find(|section| section.name == name).unwrap()
}

/// Where a channel stands in a record.
pub fn channel(name: &str) -> usize {
    CHANNELS.iter().position(|(channel, _)| *channel == name).unwrap()
}

pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[middle]
    } else {
        f64::midpoint(sorted[middle - 1], sorted[middle])
    }
}

/// About the mean.
pub fn deviation(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// The states of a free run on straight even track, one per sample of 1 ms, steps of 1 ms /
/// `divided` (0: default).
pub fn free_run(
    equations: &Equations<'_>,
    from: State,
    seconds: f64,
    divided: usize,
) -> Vec<State> {
    let table = even(&[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]);
    let track = Track::new(&table, equations.vehicle);
    let samples = (seconds / SAMPLE).round() as usize + 1;
    let divided = if divided == 0 {
        least_steps(Method::RungeKutta, equations).expect("few steps")
    } else {
        divided
    };
    let mut states = Vec::with_capacity(samples);
    run(equations, &track, from, 10.0, samples, divided, |_, state, _| states.push(*state))
        .unwrap();
    states
}
