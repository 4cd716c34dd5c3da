//! The truth: deviations within the tolerances, and the effects.

use fishplate::effects::{Channel, Gauss, Signals};
use fishplate::model::{
    CHANNELS, Profile, ProfileTable, SAMPLING_RATE, Setup, TrackTable, Vehicle, Window, simulate,
};

use super::cases::Outside;
use super::line::Stretch;

/// Declared tolerances: one standard deviation each.
pub struct Declared {
    pub stiffness: f64,
    pub damping: f64,
    pub masses: f64,
    pub friction: f64,
    pub conicity: f64,
    /// In mm.
    pub clearance: f64,
    pub cant: f64,
    pub curvature: f64,
    pub irregularity: f64,
    /// In mm.
    pub residual: f64,
    pub gain: f64,
    /// Y, Q in kN, accelerations in m/s^2: offset and noise per sample.
    pub offset: [f64; 3],
    pub noise: [f64; 3],
}

pub const DECLARED: Declared = Declared {
    stiffness: 0.03,
    damping: 0.07,
    masses: 0.006,
    friction: 0.02,
    conicity: 0.08,
    clearance: 0.25,
    cant: 2.5,
    curvature: 0.008,
    irregularity: 0.05,
    residual: 0.35,
    gain: 0.012,
    offset: [0.4, 0.6, 0.01],
    noise: [0.4, 0.6, 0.02],
};

impl Declared {
    /// Entries of `campaign.yaml`.
    pub fn lines(&self) -> String {
        let [y, q, a] = self.offset;
        let [yn, qn, an] = self.noise;
        let entries = [
            ("suspension stiffness [-]", self.stiffness),
            ("suspension damping [-]", self.damping),
            ("masses and inertias [-]", self.masses),
            ("friction per section [-]", self.friction),
            ("equivalent conicity [-]", self.conicity),
            ("flange clearance [mm]", self.clearance),
            ("cant [mm]", self.cant),
            ("curvature [-]", self.curvature),
            ("irregularity amplitude [-]", self.irregularity),
            ("irregularity residual [mm]", self.residual),
            ("channel gain [-]", self.gain),
            ("Y offset [kN]", y),
            ("Q offset [kN]", q),
            ("acceleration offset [m/s^2]", a),
            ("Y noise [kN]", yn),
            ("Q noise [kN]", qn),
            ("acceleration noise [m/s^2]", an),
        ];
        entries.iter().map(|(name, value)| format!("  {name}: {value}\n")).collect()
    }
}

const STIFFNESSES: [&str; 7] = [
    "primary.kx",
    "primary.ky",
    "primary.kz",
    "secondary.kx",
    "secondary.ky",
    "secondary.kz",
    "secondary.anti_roll_stiffness",
];
const DAMPINGS: [&str; 5] =
    ["primary.cz", "primary.cy", "secondary.cz", "secondary.cy", "secondary.yaw_damper_damping"];
const MASSES: [&str; 7] = [
    "car_body.mass",
    "car_body.inertia_roll",
    "car_body.inertia_pitch",
    "car_body.inertia_yaw",
    "bogie.mass",
    "wheelset.mass",
    "car_body.cog_height",
];

/// Properties common to all sections of a campaign.
pub struct World {
    factors: Vec<(&'static str, f64)>,
    conicity: f64,
    clearance: f64,
    irregularity: f64,
    lateral: f64,
    law: f64,
    kalker: f64,
    track_stiffness: f64,
    dry: f64,
    bending: (f64, f64),
    bend_of_profile: [f64; 2],
    gains: Vec<f64>,
    offsets: Vec<f64>,
}

impl World {
    pub fn draw(random: &mut Gauss) -> Self {
        let declared = &DECLARED;
        let mut factors = Vec::new();
        for (keys, sd) in [
            (&STIFFNESSES[..], declared.stiffness),
            (&DAMPINGS[..], declared.damping),
            (&MASSES[..], declared.masses),
        ] {
            keys.iter().for_each(|key| factors.push((*key, (sd * random.next()).exp())));
        }
        let between =
            |random: &mut Gauss, low: f64, high: f64| low + (high - low) * random.uniform();
        Self {
            factors,
            conicity: (declared.conicity * random.next()).exp(),
            clearance: declared.clearance * random.next(),
            irregularity: (declared.irregularity * random.next()).exp(),
            lateral: between(random, 1.0, 1.2),
            law: between(random, 1.8, 3.0),
            kalker: between(random, 1.0, 1.25),
            track_stiffness: between(random, 0.7, 1.2),
            dry: between(random, 100.0, 400.0),
            bending: (between(random, 11.5, 14.0), between(random, 25_000.0, 45_000.0)),
            bend_of_profile: [0.02 * random.next(), 0.02 * random.next()],
            gains: (0..CHANNELS.len()).map(|_| 1.0 + declared.gain * random.next()).collect(),
            offsets: CHANNELS
                .iter()
                .map(|(name, _)| declared.offset[kind(name)] * random.next())
                .collect(),
        }
    }

    fn vehicle(
        &self,
        nominal: &Vehicle,
        settings: &[(String, f64)],
        friction: f64,
        outside: Option<Outside>,
    ) -> Result<Vehicle, String> {
        let mut vehicle = nominal.clone();
        let set = |vehicle: &mut Vehicle, key: &str, value: f64| {
            vehicle.set(key, value).map_err(|_| format!("{key} = {value}"))
        };
        for (key, value) in settings {
            set(&mut vehicle, key, *value)?;
        }
        let times = |vehicle: &mut Vehicle, key: &str, factor: f64| {
            let value = vehicle.get(key).unwrap_or(0.0);
            vehicle.set(key, value * factor).map_err(|_| key.to_string())
        };
        for (key, factor) in &self.factors {
            times(&mut vehicle, key, *factor)?;
        }
        times(&mut vehicle, "profile.conicity_scale", self.conicity)?;
        times(&mut vehicle, "contact.kalker_scale", self.kalker)?;
        times(&mut vehicle, "contact.vertical_stiffness", self.track_stiffness)?;
        set(&mut vehicle, "contact.chartet_exponent", self.law)?;
        let mu = (vehicle.friction + friction).max(0.03);
        set(&mut vehicle, "friction", mu)?;
        let (z, y) = (vehicle.primary_friction_z + self.dry, vehicle.primary_friction_y + self.dry);
        set(&mut vehicle, "primary.friction_z", z)?;
        set(&mut vehicle, "primary.friction_y", y)?;
        if vehicle.bending_frequency == 0.0 {
            set(&mut vehicle, "body_bending.frequency", self.bending.0)?;
            set(&mut vehicle, "body_bending.modal_mass", self.bending.1)?;
            set(&mut vehicle, "body_bending.damping_ratio", 0.04)?;
        }
        if let Some(outside) = outside {
            outside.on_vehicle(&mut vehicle);
        }
        Ok(vehicle)
    }

    /// The profile, slightly different from that of the file.
    fn profile(
        &self,
        table: &ProfileTable,
        worn: Option<&ProfileTable>,
        vehicle: &Vehicle,
        outside: Option<Outside>,
    ) -> Result<Profile, String> {
        let bent = |table: &ProfileTable| {
            let mut bent = table.clone();
            for (i, displacement) in table.displacement.iter().enumerate() {
                for (side, sign) in [(0, 1.0), (1, -1.0)] {
                    let u = sign * displacement;
                    bent.radius_deviation[side][i] += self.bend_of_profile[0] * (u / 2.5).sin()
                        + self.bend_of_profile[1] * (u / 4.0).tanh();
                    bent.contact_angle[side][i] *= 1.0 + self.bend_of_profile[1];
                }
                if outside == Some(Outside::WheelRadii) {
                    bent.radius_deviation[0][i] += 0.8;
                }
            }
            bent
        };
        Profile::new(&bent(table), worn.map(bent).as_ref(), vehicle)
            .ok_or_else(|| "no profile".to_string())
    }

    /// The true track, which differs from the recorded one.
    fn track(
        &self,
        measured: &TrackTable,
        random: &mut Gauss,
        outside: Option<Outside>,
    ) -> TrackTable {
        let declared = &DECLARED;
        let mut track = measured.clone();
        let scatter = self.irregularity * (declared.irregularity * random.next()).exp();
        let full =
            measured.curvature.iter().fold(0.0_f64, |most, kappa| most.max(kappa.abs())).max(1e-9);
        let (cant, bend) =
            (declared.cant * random.next(), 1.0 + declared.curvature * random.next());
        for i in 0..track.distance.len() {
            track.cant[i] += cant * measured.curvature[i] / full;
            track.curvature[i] *= bend;
        }
        let lateral = self.lateral * scatter;
        for (column, factor) in [
            (&mut track.alignment, lateral),
            (&mut track.level, scatter),
            (&mut track.cross_level, scatter),
            (&mut track.gauge, lateral),
        ] {
            let rest = residual(column.len(), random);
            column
                .iter_mut()
                .zip(rest)
                .for_each(|(value, rest)| *value = factor * *value + declared.residual * rest);
        }
        track.gauge.iter_mut().for_each(|gauge| *gauge += self.clearance);
        if let Some(outside) = outside {
            outside.on_track(&mut track);
        }
        track
    }

    /// The measured record of a section. `settings` are those of the effects on the simulator.
    ///
    /// # Errors
    /// The run fails.
    pub fn record(&self, made: &Making<'_>, random: &mut Gauss) -> Result<Signals, String> {
        let vehicle = self.vehicle(
            made.nominal,
            made.settings,
            DECLARED.friction * random.next(),
            made.outside,
        )?;
        let profile = self.profile(made.profile, made.worn, &vehicle, made.outside)?;
        let track = self.track(made.track, random, made.outside);
        let speed = made.stretch.speed / 3.6
            * (1.0 + 0.002 * random.next())
            * made.outside.map_or(1.0, Outside::speed);
        let around = Window::around(made.stretch.start, made.stretch.end);
        let window = Window { from: around.from - made.shift, to: around.to - made.shift };
        let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed };
        let record = simulate(&setup, window, 2.into()).map_err(|failure| failure.to_string())?;
        let channels = CHANNELS
            .iter()
            .zip(record.channels)
            .map(|((name, _), values)| Channel { name: (*name).to_string(), values });
        Ok(Signals {
            axis: record.distance,
            over_time: false,
            rate: SAMPLING_RATE,
            channels: channels.collect(),
        })
    }

    /// Applies gain and offset of every channel, within their tolerances.
    pub fn calibrate(&self, signals: &mut Signals) {
        for (at, channel) in signals.channels.iter_mut().enumerate() {
            channel
                .values
                .iter_mut()
                .for_each(|value| *value = self.gains[at] * *value + self.offsets[at]);
        }
    }
}

/// Adds white noise to every sample.
pub fn noise(signals: &mut Signals, random: &mut Gauss) {
    for channel in &mut signals.channels {
        let noise = DECLARED.noise[kind(&channel.name)];
        channel.values.iter_mut().for_each(|value| *value += noise * random.next());
    }
}

/// Inputs of a record.
pub struct Making<'a> {
    pub nominal: &'a Vehicle,
    pub profile: &'a ProfileTable,
    pub worn: Option<&'a ProfileTable>,
    pub track: &'a TrackTable,
    pub stretch: &'a Stretch,
    pub settings: &'a [(String, f64)],
    /// Recorded minus true position in m.
    pub shift: f64,
    pub outside: Option<Outside>,
}

/// Index of a channel in [`Declared::offset`] and [`Declared::noise`].
pub fn kind(channel: &str) -> usize {
    ["Y", "Q"].iter().position(|letter| channel.starts_with(letter)).unwrap_or(2)
}

/// Short waves that the recording car does not measure, of rms 1: noise smoothed over about 1 m.
fn residual(points: usize, random: &mut Gauss) -> Vec<f64> {
    let mut state = [0.0; 2];
    let values: Vec<f64> = (0..points)
        .map(|_| {
            state[0] += 0.35 * (random.next() - state[0]);
            state[1] += 0.35 * (state[0] - state[1]);
            state[1]
        })
        .collect();
    let rms = (values.iter().map(|value| value * value).sum::<f64>() / points.max(1) as f64).sqrt();
    values.iter().map(|value| value / rms).collect()
}
