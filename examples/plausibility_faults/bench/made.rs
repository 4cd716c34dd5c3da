//! Campaigns made with the reference vehicle model: the measurement is a simulation with other
//! parameters on another track than the recorded one, with gains, offsets and noise of the sensors.

use std::fs;
use std::path::Path;

use fishplate::data::record::Format;
use fishplate::effects::{Channel, Gauss, Signals};
use fishplate::model::{CHANNELS, SAMPLING_RATE, TrackTable, Vehicle};
use fishplate::simulate::{Plan, record_file};
use fishplate::units::Unit;

use super::blind::hidden::{catalogue, chosen};
use super::blind::line::{Irregularities, Stretch, measured, ramp};
use super::blind::truth::{DECLARED, Making, World, kind, noise};
use super::blind::vehicles::{COACH, Design, RAILCAR, WAGON};
use super::blind::write::{
    campaign_text, copied, profile, row, simulated, track_text, vehicle_text,
};

/// A locomotive: heavy bogies with motors, short wheelbase for its mass.
pub const LOCOMOTIVE: Design = Design {
    name: "Locomotive",
    category: "locomotive",
    secondary_suspension: true,
    speeds: (60.0, 140.0),
    deficiency: 120.0,
    differs: &[
        ("geometry.half_bogie_spacing", 4.95),
        ("geometry.half_wheelbase", 1.45),
        ("car_body.mass", 46_000.0),
        ("car_body.inertia_roll", 82_000.0),
        ("car_body.inertia_pitch", 8.2e5),
        ("car_body.inertia_yaw", 8.2e5),
        ("car_body.cog_height", 1.85),
        ("car_body.floor_height", 1.3),
        ("bogie.mass", 9500.0),
        ("bogie.inertia_roll", 5200.0),
        ("bogie.inertia_pitch", 12_500.0),
        ("bogie.inertia_yaw", 14_500.0),
        ("wheelset.mass", 2900.0),
        ("wheelset.inertia_roll", 1700.0),
        ("wheelset.inertia_yaw", 1700.0),
        ("wheelset.inertia_spin", 260.0),
        ("wheelset.radius", 0.575),
        ("primary.kx", 1.8e7),
        ("primary.ky", 6.0e6),
        ("primary.kz", 2.1e6),
        ("primary.cz", 2.2e4),
        ("secondary.kx", 5.0e5),
        ("secondary.ky", 5.0e5),
        ("secondary.kz", 1.1e6),
        ("secondary.cz", 5.5e4),
        ("secondary.cy", 6.0e4),
        ("contact.vertical_stiffness", 7.0e7),
    ],
};

/// Wind from one side, in N, on the records of a side.
#[derive(Clone, Copy, Default)]
pub struct Wind {
    pub measured: f64,
    pub simulated: f64,
}

/// What a campaign is made of.
#[derive(Clone)]
pub struct Recipe {
    pub name: String,
    pub design: &'static Design,
    /// Of the records, in Hz.
    pub rate: f64,
    /// Admissible speed in km/h.
    pub speed: f64,
    pub per_zone: usize,
    /// Factor of the irregularities of the line.
    pub quality: f64,
    /// Range of the cant deficiency in mm.
    pub deficiency: (f64, f64),
    /// Factors of parameters of the vehicle on both sides.
    pub vehicle: Vec<(&'static str, f64)>,
    /// Parameters of the model on both sides, as of a load to one side.
    pub both: Vec<(&'static str, f64)>,
    /// Effects of the catalogue in the measurement, as on a command line.
    pub unmodelled: Vec<&'static str>,
    pub wind: Wind,
    pub seed: u64,
}

impl Recipe {
    pub fn of(name: &str, design: &'static Design, seed: u64) -> Self {
        Self {
            name: name.into(),
            design,
            rate: SAMPLING_RATE,
            speed: design.speeds.1.min(FASTEST),
            per_zone: 3,
            quality: 1.0,
            deficiency: (0.45 * design.deficiency, design.deficiency),
            vehicle: Vec::new(),
            both: Vec::new(),
            unmodelled: Vec::new(),
            wind: Wind::default(),
            seed,
        }
    }
}

/// The made campaigns that are sound.
pub fn sound() -> Vec<Recipe> {
    vec![
        Recipe {
            rate: 250.0,
            quality: 1.1,
            deficiency: (30.0, 90.0),
            ..Recipe::of("coach, 250 Hz", &COACH, 501)
        },
        Recipe { per_zone: 4, ..Recipe::of("wagon, 200 Hz", &WAGON, 502) },
        Recipe {
            rate: 500.0,
            quality: 0.8,
            deficiency: (35.0, 90.0),
            ..Recipe::of("locomotive, 500 Hz", &LOCOMOTIVE, 503)
        },
        Recipe { per_zone: 4, quality: 0.7, ..Recipe::of("railcar, 200 Hz", &RAILCAR, 504) },
    ]
}

/// A made campaign that does not pass.
pub fn failing() -> Recipe {
    Recipe {
        per_zone: 4,
        unmodelled: vec!["friction=0.12", "primary_yaw_stiffness=0.4"],
        ..Recipe::of("wagon that fails, 200 Hz", &WAGON, 505)
    }
}

/// Numbers of lines drawn until the vehicle runs over one.
const DRAWS: u64 = 6;
/// Share of the offsets of sensors that changes from section to section, as by temperature.
const OFFSET_SCATTER: f64 = 0.4;

/// Writes a campaign.
///
/// # Errors
/// The vehicle does not run over any of the lines.
pub fn make(recipe: &Recipe, out: &Path) -> Result<(), String> {
    let mut why = String::new();
    for draw in 0..DRAWS {
        match files(recipe, draw) {
            Ok(files) => {
                for (name, bytes) in files {
                    let file = out.join(name);
                    fs::create_dir_all(file.parent().unwrap_or(out)).map_err(|e| e.to_string())?;
                    fs::write(file, bytes).map_err(|e| e.to_string())?;
                }
                return Ok(());
            }
            Err(failed) => why = failed,
        }
    }
    Err(format!("{}: {why}", recipe.name))
}

type Files = Vec<(String, Vec<u8>)>;

fn files(recipe: &Recipe, draw: u64) -> Result<Files, String> {
    let mut random = Gauss::new(1000 * recipe.seed + draw);
    let catalogue = catalogue()?;
    let effects: Vec<String> = recipe.unmodelled.iter().map(|text| (*text).to_string()).collect();
    let effects = chosen(&catalogue, &effects)?;
    let vehicle = vehicle(recipe)?;
    let with_wind = |force: f64| -> Result<Vehicle, String> {
        let mut vehicle = vehicle.clone();
        set(&mut vehicle, "crosswind.force", force)?;
        Ok(vehicle)
    };
    let (of_measurement, of_simulation) =
        (with_wind(recipe.wind.measured)?, with_wind(recipe.wind.simulated)?);
    let (new, worn) = (profile("profile.csv")?, profile("profile_worn.csv")?);
    let world = World::draw(&mut random);
    let mut all = Files::new();
    let mut table = String::from(
        "section,zone [-],start [m],end [m],radius [m],direction,cant [mm],cant deficiency [mm],speed [km/h]\n",
    );
    for stretch in line(recipe, &mut random) {
        let mut track = measured(&stretch, &Irregularities::draw(&mut random));
        scaled(&mut track, recipe.quality);
        let plan = Plan::new(&catalogue, &effects, &super::blind::write::section(&stretch), None)
            .map_err(|problem| problem.says)?;
        let mut truth = of_measurement.clone();
        for (key, value) in &plan.settings {
            set(&mut truth, key, *value)?;
        }
        let making = Making {
            nominal: &truth,
            profile: &new,
            worn: Some(&worn),
            track: &track,
            stretch: &stretch,
            settings: &[],
            shift: 0.0,
            outside: None,
        };
        let at = |why: String| format!("section {}: {why}", stretch.name);
        let mut record = world.record(&making, &mut random).map_err(at)?;
        world.calibrate(&mut record);
        let mut record = at_rate(record, recipe.rate);
        sensors(&mut record, &mut random);
        all.push((format!("measurement/{}.csv", stretch.name), bytes(&record)?));
        let record = simulated(&of_simulation, &new, &track, &stretch).map_err(at)?;
        let record = at_rate(record, recipe.rate);
        all.push((format!("simulation/{}.csv", stretch.name), bytes(&record)?));
        all.push((format!("track/{}.csv", stretch.name), track_text(&track).into()));
        table += &row(&stretch);
    }
    all.push((super::folder::SECTIONS.into(), table.into()));
    for name in ["profile.csv", "profile_worn.csv"] {
        all.push((name.into(), copied(name)?.into()));
    }
    let admissible = format!("admissible_speed: {} km/h\n", recipe.speed);
    all.push((
        "vehicle.yaml".into(),
        (vehicle_text(recipe.design, &of_simulation) + &admissible).into(),
    ));
    all.push(("campaign.yaml".into(), campaign_text(&recipe.name, &vehicle, recipe.rate).into()));
    Ok(all)
}

fn set(vehicle: &mut Vehicle, key: &str, value: f64) -> Result<(), String> {
    vehicle.set(key, value).map_err(|_| format!("{key} = {value}"))
}

fn vehicle(recipe: &Recipe) -> Result<Vehicle, String> {
    let mut vehicle = recipe.design.vehicle()?;
    for (key, factor) in &recipe.vehicle {
        let value = vehicle.get(key).unwrap_or(0.0);
        set(&mut vehicle, key, factor * value)?;
    }
    for (key, value) in &recipe.both {
        set(&mut vehicle, key, *value)?;
    }
    Ok(vehicle)
}

/// Radii of the curves of a zone in m.
const RADII: [(f64, f64); 4] = [(0.0, 0.0), (700.0, 2200.0), (405.0, 595.0), (260.0, 395.0)];
/// Admissible speed in km/h up to which these lengths of the sections of a zone, in m, suffice.
const FASTEST: f64 = 140.0;
const LENGTHS: [f64; 4] = [260.0, 110.0, 105.0, 75.0];
/// Largest and smallest cant of a curve in mm.
const CANT: (f64, f64) = (0.0, 150.0);

/// The sections: radius and cant deficiency are drawn, cant follows from a drawn speed.
fn line(recipe: &Recipe, random: &mut Gauss) -> Vec<Stretch> {
    let mut all = Vec::new();
    for zone in 1..=4 {
        for n in 0..recipe.per_zone {
            let mut between = |(low, high): (f64, f64)| low + (high - low) * random.uniform();
            let name = format!("S{:02}", all.len() + 1);
            let straight = Stretch {
                name,
                zone,
                start: 105.0,
                end: 105.0 + LENGTHS[0],
                radius: None,
                left: n % 2 == 1,
                cant: 0.0,
                deficiency: 0.0,
                speed: between((0.8 * recipe.speed, recipe.speed)),
            };
            if zone == 1 {
                all.push(straight);
                continue;
            }
            let radius = (between(RADII[zone - 1]) / 5.0).round() * 5.0;
            let wanted = between(recipe.deficiency);
            // The speed at which this deficiency needs a usual cant.
            let usual = between((30.0, 110.0));
            let speed = (3.6 * (9.81 * radius * (wanted + usual) / 1500.0).sqrt())
                .clamp(recipe.design.speeds.0, recipe.speed);
            let needed = 1500.0 * (speed / 3.6).powi(2) / (9.81 * radius);
            let cant = ((needed - wanted) / 5.0).round() * 5.0;
            let cant = cant.clamp(CANT.0, CANT.1);
            let start = 40.0 + ramp(cant) + 35.0;
            all.push(Stretch {
                start,
                end: start + LENGTHS[zone - 1],
                radius: Some(radius),
                cant,
                deficiency: needed - cant,
                speed,
                ..straight
            });
        }
    }
    all
}

fn scaled(track: &mut TrackTable, quality: f64) {
    let columns =
        [&mut track.alignment, &mut track.level, &mut track.cross_level, &mut track.gauge];
    columns.into_iter().flatten().for_each(|value| *value *= quality);
}

/// Offsets of this section, and noise of every sample: its density is that of the declared noise at
/// the rate of the model.
fn sensors(signals: &mut Signals, random: &mut Gauss) {
    for channel in &mut signals.channels {
        let offset = OFFSET_SCATTER * DECLARED.offset[kind(&channel.name)] * random.next();
        channel.values.iter_mut().for_each(|value| *value += offset);
    }
    if signals.rate <= SAMPLING_RATE {
        return noise(signals, random);
    }
    let more = (signals.rate / SAMPLING_RATE).sqrt();
    for channel in &mut signals.channels {
        let sigma = more * DECLARED.noise[kind(&channel.name)];
        channel.values.iter_mut().for_each(|value| *value += sigma * random.next());
    }
}

/// A record at another rate. The model's anti-alias filter passes up to 40 Hz.
fn at_rate(signals: Signals, rate: f64) -> Signals {
    if (rate - signals.rate).abs() < 1e-9 {
        return signals;
    }
    let step = signals.rate / rate;
    let count = ((signals.axis.len().max(2) - 2) as f64 / step) as usize;
    let at = |values: &[f64]| (0..count).map(|n| cubic(values, n as f64 * step)).collect();
    Signals {
        axis: at(&signals.axis),
        over_time: false,
        rate,
        channels: signals
            .channels
            .iter()
            .map(|channel| Channel { name: channel.name.clone(), values: at(&channel.values) })
            .collect(),
    }
}

/// Interpolation through four samples.
pub fn cubic(values: &[f64], at: f64) -> f64 {
    let n = at.floor() as usize;
    let t = at - n as f64;
    let sample = |k: isize| values[(n as isize + k).clamp(0, values.len() as isize - 1) as usize];
    let (a, b, c, d) = (sample(-1), sample(0), sample(1), sample(2));
    let slope = (c - a) / 2.0;
    let far = (d - b) / 2.0;
    let bend = 3.0 * (c - b) - 2.0 * slope - far;
    let twist = 2.0 * (b - c) + slope + far;
    b + t * (slope + t * (bend + t * twist))
}

fn bytes(signals: &Signals) -> Result<Vec<u8>, String> {
    let unit = |name: &str| {
        let known = CHANNELS.iter().find(|(known, _)| *known == name);
        known.and_then(|(_, unit)| Unit::parse(unit).ok()).unwrap_or_else(Unit::one)
    };
    record_file(Format::Csv, signals, &unit).map_err(|problem| problem.says)
}
