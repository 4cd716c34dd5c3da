//! Hidden effects by campaign. Four sets of fixed cases with separate seeds: `derive` for the
//! choice of thresholds, `score` for the scores, `doubt` for the scores of cases without a cause in
//! the catalogue, `test` for the tests; and `fresh`, whose cases and sizes are drawn from the seed.

use fishplate::effects::Gauss;
use fishplate::model::{TrackTable, Vehicle};

use super::vehicles::{COACH, Design, LOCOMOTIVE, RAILCAR, WAGON};

/// A set of campaigns.
#[derive(Clone, Copy)]
pub struct Set {
    pub name: &'static str,
    /// None: it is to be given on the command line.
    pub seed: Option<u64>,
    pub sections_per_zone: usize,
    /// The cases, from the seed.
    pub cases: fn(u64) -> Vec<Case>,
}

pub const SETS: [Set; 5] = [
    Set { name: "derive", seed: Some(4_100_000), sections_per_zone: 4, cases: derive },
    Set { name: "score", seed: Some(91_700_000), sections_per_zone: 4, cases: score },
    Set { name: "doubt", seed: Some(43_300_000), sections_per_zone: 4, cases: doubt },
    Set { name: "test", seed: Some(9_700_000), sections_per_zone: 3, cases: test },
    Set { name: "fresh", seed: None, sections_per_zone: 4, cases: fresh },
];

/// A campaign.
pub struct Case {
    pub number: usize,
    pub kind: &'static str,
    pub design: &'static Design,
    /// As on a command line; `~` marks numbers that are drawn within 15 %.
    pub effects: Vec<String>,
    pub outside: Option<Outside>,
}

/// Causes outside the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// Guiding forces of the trailing bogie drift from section to section.
    Drift,
    /// All right wheels are larger than the left ones.
    WheelRadii,
    /// Rail joints dip every 18 m.
    Joints,
    /// The vehicle ran faster than the table says.
    Speed,
    /// The vertical secondary suspension is much too stiff.
    StiffSecondary,
    /// The lateral secondary suspension is much too soft.
    SoftLateral,
    /// Axle boxes stick.
    StickingBoxes,
    /// The gain of the vertical forces falls from section to section.
    FadingGain,
}

impl Outside {
    const ALL: [Self; 8] = [
        Self::Drift,
        Self::WheelRadii,
        Self::Joints,
        Self::Speed,
        Self::StiffSecondary,
        Self::SoftLateral,
        Self::StickingBoxes,
        Self::FadingGain,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Drift => "drift_over_sections",
            Self::WheelRadii => "wheel_radius_difference",
            Self::Joints => "rail_joints",
            Self::Speed => "speed_error",
            Self::StiffSecondary => "stiff_secondary_springs",
            Self::SoftLateral => "soft_lateral_springs",
            Self::StickingBoxes => "sticking_axle_boxes",
            Self::FadingGain => "fading_gain",
        }
    }

    pub fn on_vehicle(self, vehicle: &mut Vehicle) {
        match self {
            Self::StiffSecondary => vehicle.secondary_kz *= 3.0,
            Self::SoftLateral => vehicle.secondary_ky *= 0.35,
            Self::StickingBoxes => {
                vehicle.primary_friction_z += 6000.0;
                vehicle.primary_friction_y += 6000.0;
            }
            _ => {}
        }
    }

    pub fn on_track(self, track: &mut TrackTable) {
        if self == Self::Joints {
            for (i, s) in track.distance.iter().enumerate() {
                let from = (s % 18.0).min(18.0 - s % 18.0);
                track.level[i] += 3.0 * (-(from / 1.2).powi(2)).exp();
            }
        }
    }

    pub fn speed(self) -> f64 {
        if self == Self::Speed { 1.07 } else { 1.0 }
    }

    /// Offset and factor of a channel in a section.
    pub fn on_channel(self, channel: &str, section: usize) -> (f64, f64) {
        match self {
            Self::Drift if channel.starts_with("Y_3") || channel.starts_with("Y_4") => {
                (0.6 * section as f64, 1.0)
            }
            Self::FadingGain if channel.starts_with('Q') => (0.0, 1.0 - 0.012 * section as f64),
            _ => (0.0, 1.0),
        }
    }
}

type Row = (&'static str, &'static Design, &'static [&'static str], Option<Outside>);

fn numbered(rows: Vec<Row>) -> Vec<Case> {
    let case = |(at, (kind, design, effects, outside)): (usize, Row)| Case {
        number: at + 1,
        kind,
        design,
        effects: effects.iter().map(|effect| (*effect).to_string()).collect(),
        outside,
    };
    rows.into_iter().enumerate().map(case).collect()
}

fn derive(_: u64) -> Vec<Case> {
    let nothing = [&COACH, &WAGON, &RAILCAR, &COACH, &WAGON, &RAILCAR, &COACH, &WAGON];
    let mut rows: Vec<Row> =
        nothing.into_iter().map(|design| ("none", design, &[][..], None)).collect();
    let singles: [(&Design, &[&str]); 14] = [
        (&COACH, &["friction=~0.22"]),
        (&WAGON, &["friction=~0.52"]),
        (&RAILCAR, &["worn_profile.profile.conicity_scale=~1.9"]),
        (&COACH, &["lateral_damper_loss=~0.25"]),
        (&RAILCAR, &["vertical_damper_loss=~0.3"]),
        (&WAGON, &["payload=~5000"]),
        (&COACH, &["cant_error=~18"]),
        (&RAILCAR, &["crosswind=~9000"]),
        (&COACH, &["primary_yaw_stiffness=~2"]),
        (&WAGON, &["sensor_gain=~0.82 on Q_2L"]),
        (&RAILCAR, &["sync_shift=~6"]),
        (&COACH, &["anti_roll_bar=~0.4"]),
        (&COACH, &["track_irregularity_scale=~1.5"]),
        (&RAILCAR, &["bumpstop_gap=~0.012"]),
    ];
    rows.extend(singles.into_iter().map(|(design, effects)| ("single", design, effects, None)));
    let pairs: [(&Design, &[&str]); 5] = [
        (&COACH, &["friction=~0.22", "sensor_gain=~0.8 on Q_3R"]),
        (&RAILCAR, &["payload=~3000", "lateral_damper_loss=~0.3"]),
        (&COACH, &["cant_error=~20", "vertical_damper_loss=~0.3"]),
        (&WAGON, &["payload_offset=~0.07", "friction=~0.2"]),
        (&COACH, &["worn_profile.profile.conicity_scale=~1.8", "sync_shift=~5"]),
    ];
    rows.extend(pairs.into_iter().map(|(design, effects)| ("pair", design, effects, None)));
    let outside = [
        (&COACH, Outside::Drift),
        (&RAILCAR, Outside::SoftLateral),
        (&COACH, Outside::StiffSecondary),
        (&RAILCAR, Outside::Joints),
    ];
    rows.extend(
        outside.into_iter().map(|(design, outside)| ("outside", design, &[][..], Some(outside))),
    );
    numbered(rows)
}

fn score(_: u64) -> Vec<Case> {
    let designs = [&COACH, &RAILCAR, &WAGON];
    let mut rows: Vec<Row> = (0..12).map(|n| ("none", designs[n % 3], &[][..], None)).collect();
    let singles: [(&Design, &[&str]); 32] = [
        (&RAILCAR, &["friction=~0.2"]),
        (&COACH, &["friction=~0.52"]),
        (&WAGON, &["friction=~0.2"]),
        (&COACH, &["friction=~0.18 in zone 4"]),
        (&COACH, &["worn_profile.profile.worn_share=~0.8"]),
        (&COACH, &["worn_profile.profile.conicity_scale=~2"]),
        (&WAGON, &["worn_profile.profile.conicity_scale=~2"]),
        (
            &COACH,
            &[
                "body_bending.body_bending.frequency=~9",
                "body_bending.body_bending.modal_mass=~8000",
            ],
        ),
        (&COACH, &["bumpstop_gap=~0.012"]),
        (&COACH, &["yaw_damper_loss=~0.2"]),
        (&RAILCAR, &["centre_friction=~9000"]),
        (&COACH, &["payload=~3500"]),
        (&RAILCAR, &["payload=~3000"]),
        (&WAGON, &["payload_offset=~0.07"]),
        (&RAILCAR, &["payload_offset=~0.07"]),
        (&RAILCAR, &["anti_roll_bar=~0.4"]),
        (&RAILCAR, &["primary_yaw_stiffness=~2.2"]),
        (&WAGON, &["primary_yaw_stiffness=~0.45"]),
        (&COACH, &["vertical_damper_loss=~0.3"]),
        (&RAILCAR, &["lateral_damper_loss=~0.25"]),
        (
            &COACH,
            &[
                "out_of_roundness.out_of_roundness.amplitude=~0.0006",
                "out_of_roundness.out_of_roundness.wheelset=2",
                "out_of_roundness.out_of_roundness.harmonic=2",
            ],
        ),
        (&RAILCAR, &["track_irregularity_scale=~1.5"]),
        (&WAGON, &["cant_error=~25"]),
        (&RAILCAR, &["cant_error=~18 in direction left"]),
        (&COACH, &["crosswind=~9000"]),
        (&COACH, &["sensor_gain=~0.8 on Y_1L"]),
        (&RAILCAR, &["sensor_gain=~1.2 on az_I"]),
        (&COACH, &["sensor_offset=~6 on Y_2R"]),
        (&WAGON, &["sync_shift=~8"]),
        (&COACH, &["filter_mismatch=~5"]),
        (&RAILCAR, &["channel_swap on Y_1R, Y_2R"]),
        (&COACH, &["crosstalk=~0.07"]),
    ];
    rows.extend(singles.into_iter().map(|(design, effects)| ("single", design, effects, None)));
    let pairs: [(&Design, &[&str]); 7] = [
        (&RAILCAR, &["friction=~0.2", "vertical_damper_loss=~0.3"]),
        (&COACH, &["payload=~3500", "friction=~0.2"]),
        (&COACH, &["cant_error=~20", "sensor_gain=~0.8 on Q_1R"]),
        (&WAGON, &["cant_error=~25", "friction=~0.55"]),
        (&RAILCAR, &["primary_yaw_stiffness=~2.2", "lateral_damper_loss=~0.25"]),
        (&COACH, &["crosswind=~9000", "track_irregularity_scale=~1.5"]),
        (&COACH, &["payload_offset=~0.06", "sync_shift=~6"]),
    ];
    rows.extend(pairs.into_iter().map(|(design, effects)| ("pair", design, effects, None)));
    let outside = [
        (&RAILCAR, Outside::Drift),
        (&COACH, Outside::WheelRadii),
        (&WAGON, Outside::Joints),
        (&COACH, Outside::Speed),
        (&RAILCAR, Outside::StiffSecondary),
        (&COACH, Outside::SoftLateral),
        (&COACH, Outside::StickingBoxes),
        (&COACH, Outside::FadingGain),
    ];
    rows.extend(
        outside.into_iter().map(|(design, outside)| ("outside", design, &[][..], Some(outside))),
    );
    // A cause that fits one quantity only: friction for the outer leading wheel, a gain for all
    // vertical forces, wind for right curves.
    let traps: [(&Design, &[&str]); 4] = [
        (&COACH, &["primary_yaw_stiffness=~2.4"]),
        (&WAGON, &["payload=~6000"]),
        (&RAILCAR, &["cant_error=~18 in direction right"]),
        (&COACH, &["worn_profile.profile.conicity_scale=~0.55"]),
    ];
    rows.extend(traps.into_iter().map(|(design, effects)| ("trap", design, effects, None)));
    numbered(rows)
}

/// No effect, and all causes outside the catalogue, on every vehicle; small shares need more
/// campaigns than `score` has.
fn doubt(_: u64) -> Vec<Case> {
    let designs = [&COACH, &RAILCAR, &WAGON];
    let mut rows: Vec<Row> = (0..24).map(|n| ("none", designs[n % 3], &[][..], None)).collect();
    rows.extend((0..24).map(|n| ("outside", designs[n % 3], &[][..], Some(Outside::ALL[n / 3]))));
    numbered(rows)
}

fn test(_: u64) -> Vec<Case> {
    let rows: Vec<Row> = vec![
        ("none", &COACH, &[], None),
        ("single", &RAILCAR, &["friction=~0.2"], None),
        ("single", &COACH, &["vertical_damper_loss=~0.3"], None),
        ("outside", &COACH, &[], Some(Outside::Drift)),
    ];
    numbered(rows)
}

/// Effects of the drawn cases, and whether they require a soft secondary suspension. In braces:
/// words or ranges of a number, one of which is drawn.
const DRAWN: [(&str, bool); 26] = [
    ("friction={0.15..0.25|0.45..0.55}", false),
    ("friction={0.14..0.2} in zone 4", false),
    ("worn_profile.profile.worn_share={0.5..1}", false),
    ("worn_profile.profile.conicity_scale={0.5..0.65|1.5..2.2}", false),
    (
        "body_bending.body_bending.frequency={7..11}; \
         body_bending.body_bending.modal_mass={4000..9000}",
        true,
    ),
    ("bumpstop_gap={0.006..0.015}", true),
    ("yaw_damper_loss={0.1..0.4}", true),
    ("centre_friction={5000..14000}", true),
    ("payload={1500..6000}", false),
    ("payload_offset={0.04..0.1|-0.1..-0.04}", false),
    ("anti_roll_bar={0.1..0.5|1.5..2}", true),
    ("primary_yaw_stiffness={0.3..0.55|1.8..3}", false),
    ("vertical_damper_loss={0.1..0.45}", true),
    ("lateral_damper_loss={0.1..0.45}", true),
    (
        "out_of_roundness.out_of_roundness.amplitude={0.0004..0.001}; \
         out_of_roundness.out_of_roundness.wheelset={1|2|3|4}; \
         out_of_roundness.out_of_roundness.harmonic={1|2|3}",
        false,
    ),
    ("track_irregularity_scale={0.6..0.75|1.35..1.8}", false),
    ("cant_error={14..30|-30..-14}", false),
    ("cant_error={15..25} in direction {left|right}", false),
    ("crosswind={6000..15000|-15000..-6000}", false),
    (
        "sensor_gain={0.75..0.86|1.14..1.25} on {Y_1L|Y_2R|Y_3R|Y_4L|Q_1R|Q_2L|Q_3L|az_I|ay_II}",
        false,
    ),
    ("sensor_offset={5..9|-9..-5} on {Y_1L|Y_2L|Y_3R|Q_2R|Q_4L}", false),
    ("sync_shift={4..14|-14..-4}", false),
    ("filter_mismatch={3.5..8}", false),
    ("channel_swap on {Y_1L, Y_1R|Y_2R, Y_3R|Q_1L, Q_2L|Q_3L, Q_3R}", false),
    ("polarity=-1 on {Y_1L|Y_2R|Y_4L|ay_I}", false),
    ("crosstalk={0.04..0.1|-0.1..-0.04}", false),
];

/// Pairs of the drawn cases, by the beginnings of two effects.
const DRAWN_PAIRS: [[&str; 2]; 12] = [
    ["friction={0.15", "vertical_damper_loss"],
    ["payload=", "lateral_damper_loss"],
    ["cant_error={14", "sensor_gain"],
    ["primary_yaw_stiffness", "sync_shift"],
    ["crosswind", "track_irregularity_scale"],
    ["worn_profile.profile.conicity_scale", "sensor_offset"],
    ["payload_offset", "friction={0.15"],
    ["crosstalk", "payload="],
    ["out_of_roundness", "crosswind"],
    ["filter_mismatch", "cant_error={14"],
    ["anti_roll_bar", "polarity"],
    ["yaw_damper_loss", "cant_error={14"],
];

/// Every effect once, and 20 cases without an effect, 10 causes outside the catalogue, 10 pairs, on
/// four vehicles in turn.
fn fresh(seed: u64) -> Vec<Case> {
    const DESIGNS: [&Design; 4] = [&COACH, &RAILCAR, &WAGON, &LOCOMOTIVE];
    let random = &mut Gauss::new(seed);
    let mut cases: Vec<Case> = Vec::new();
    let mut turn = random.below(DESIGNS.len());
    let mut design = |sprung: bool| loop {
        turn = (turn + 1) % DESIGNS.len();
        if !sprung || DESIGNS[turn].secondary_suspension {
            return DESIGNS[turn];
        }
    };
    let mut add = |kind, design, effects: Vec<String>, outside| {
        cases.push(Case { number: cases.len() + 1, kind, design, effects, outside });
    };
    for (effect, sprung) in DRAWN {
        add("single", design(sprung), sized(effect, random), None);
    }
    (0..20).for_each(|_| add("none", design(false), Vec::new(), None));
    for outside in (0..10).map(|at| Outside::ALL[at % Outside::ALL.len()]) {
        // Without a secondary suspension, its springs are nearly rigid in any case.
        let sprung = matches!(outside, Outside::StiffSecondary | Outside::SoftLateral);
        add("outside", design(sprung), Vec::new(), Some(outside));
    }
    let mut pairs = DRAWN_PAIRS.to_vec();
    for _ in 0..10 {
        let pair = pairs.swap_remove(random.below(pairs.len()));
        let of: Vec<(&str, bool)> = pair
            .iter()
            .filter_map(|begin| DRAWN.into_iter().find(|(effect, _)| effect.starts_with(begin)))
            .collect();
        let on = design(of.iter().any(|(_, sprung)| *sprung));
        add("pair", on, of.iter().flat_map(|(effect, _)| sized(effect, random)).collect(), None);
    }
    cases
}

/// An effect with what is in braces drawn, as texts for a command line.
fn sized(effect: &str, random: &mut Gauss) -> Vec<String> {
    let mut text = String::new();
    let mut rest = effect;
    while let Some((before, (choice, after))) =
        rest.split_once('{').and_then(|(before, after)| Some((before, after.split_once('}')?)))
    {
        let choices: Vec<&str> = choice.split('|').collect();
        let one = choices[random.below(choices.len())];
        text += before;
        let ends = one
            .split_once("..")
            .and_then(|(low, high)| Some((low.parse::<f64>().ok()?, high.parse::<f64>().ok()?)));
        match ends {
            Some((low, high)) => text += &format!("{:.5}", low + (high - low) * random.uniform()),
            None => text += one,
        }
        rest = after;
    }
    text += rest;
    text.split("; ").map(str::to_string).collect()
}
