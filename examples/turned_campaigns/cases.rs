//! Hidden effects by campaign: 36 single effects, ten without an effect, 20 causes outside the
//! catalogue, ten pairs.

use fishplate::effects::Catalogue;

use super::base::Base;
use super::draw::Draw;
use super::faults::{self, Fault};

/// A campaign to be written.
#[derive(Debug)]
pub struct Case {
    /// Index of the base campaign.
    pub base: usize,
    pub kind: &'static str,
    pub hidden: Hidden,
    pub fault: Option<Fault>,
}

/// Effects, and how they are introduced.
#[derive(Clone, Debug, Default)]
pub struct Hidden {
    /// As on a command line.
    pub effects: Vec<String>,
    /// Values in the vehicle file that differ from the measured vehicle.
    pub vehicle: Vec<(String, f64)>,
    /// Effects that are added to the records with the reference model.
    pub added: Vec<String>,
}

type Single = fn(&mut Draw, &Base, &Catalogue) -> Hidden;

/// Name, and whether the effect requires a soft secondary suspension.
const SINGLES: [(&str, bool, Single); 23] = [
    ("friction", false, friction),
    ("worn profile", false, worn_profile),
    ("bending", true, bending),
    ("bump stop", true, bump_stop),
    ("yaw dampers", true, yaw_dampers),
    ("centre friction", false, centre_friction),
    ("payload", false, payload),
    ("load to one side", false, load_to_one_side),
    ("anti-roll bar", true, anti_roll_bar),
    ("axle guidance", false, axle_guidance),
    ("vertical dampers", true, vertical_dampers),
    ("lateral dampers", false, lateral_dampers),
    ("out of round", false, out_of_round),
    ("irregularities", false, irregularities),
    ("cant", false, cant),
    ("wind", false, wind),
    ("gain", false, gain),
    ("offset", false, offset),
    ("shift", false, shift),
    ("low-pass", false, low_pass),
    ("swap", false, swap),
    ("polarity", false, polarity),
    ("crosstalk", false, crosstalk),
];

const PAIRS: [[&str; 2]; 15] = [
    ["payload", "lateral dampers"],
    ["friction", "wind"],
    ["cant", "vertical dampers"],
    ["polarity", "anti-roll bar"],
    ["gain", "friction"],
    ["payload", "worn profile"],
    ["irregularities", "offset"],
    ["axle guidance", "shift"],
    ["wind", "bending"],
    ["load to one side", "friction"],
    ["cant", "irregularities"],
    ["low-pass", "payload"],
    ["yaw dampers", "vertical dampers"],
    ["worn profile", "vertical dampers"],
    ["crosstalk", "friction"],
];

/// Every single effect once and thirteen of them twice, and the other cases.
pub fn drawn(bases: &[Base], catalogue: &Catalogue, seed: u64) -> Vec<Case> {
    let draw = &mut Draw::new(seed);
    let sprung: Vec<usize> = (0..bases.len()).filter(|at| bases[*at].sprung()).collect();
    let every: Vec<usize> = (0..bases.len()).collect();
    let mut cases = Vec::new();
    let again = draw.some(SINGLES.to_vec(), 13);
    for (_, needs_springs, single) in SINGLES.into_iter().chain(again) {
        let among = if needs_springs { &sprung } else { &every };
        if among.is_empty() {
            continue;
        }
        let base = among[draw.below(among.len())];
        cases.push(Case {
            base,
            kind: "single",
            hidden: single(draw, &bases[base], catalogue),
            fault: None,
        });
    }
    for _ in 0..10 {
        let base = draw.below(bases.len());
        cases.push(Case { base, kind: "none", hidden: nothing(draw, &bases[base]), fault: None });
    }
    // The following cases are for passenger vehicles.
    if sprung.is_empty() {
        return cases;
    }
    for make in draw.some(faults::ALL.to_vec(), 20) {
        let base = sprung[draw.below(sprung.len())];
        let fault = make(draw, &bases[base], catalogue);
        cases.push(Case { base, kind: "outside", hidden: Hidden::default(), fault: Some(fault) });
    }
    for pair in draw.some(PAIRS.to_vec(), 10) {
        let base = sprung[draw.below(sprung.len())];
        let mut hidden = Hidden::default();
        for (_, _, single) in
            pair.iter().filter_map(|name| SINGLES.iter().find(|(known, ..)| known == name))
        {
            let one = single(draw, &bases[base], catalogue);
            hidden.effects.extend(one.effects);
            hidden.vehicle.extend(one.vehicle);
            hidden.added.extend(one.added);
        }
        cases.push(Case { base, kind: "pair", hidden, fault: None });
    }
    cases
}

/// The vehicle file differs from the measured vehicle.
fn moved(effect: String, vehicle: &[(&str, f64)]) -> Hidden {
    let vehicle = vehicle.iter().map(|(key, value)| ((*key).to_string(), *value)).collect();
    Hidden { effects: vec![effect], vehicle, added: Vec::new() }
}

/// The vehicle file has a larger value, of which the measured vehicle has a share.
fn left(base: &Base, effect: &str, share: f64, keys: &[&str]) -> Hidden {
    let vehicle: Vec<(&str, f64)> =
        keys.iter().map(|key| (*key, base.value(key) / share)).collect();
    moved(format!("{effect}={share}"), &vehicle)
}

/// The effect is added to the records with the reference model.
fn added(effects: Vec<String>) -> Hidden {
    Hidden { added: effects.clone(), effects, vehicle: Vec::new() }
}

/// An operation is applied to the records.
fn operated(effect: String) -> Hidden {
    Hidden { effects: vec![effect], ..Hidden::default() }
}

fn friction(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    let truth = base.vehicle.friction;
    let higher = truth < 0.3 || draw.chance(0.6);
    let assumed = if higher {
        truth + draw.between(0.10, 0.25, 3)
    } else {
        truth - draw.between(0.10, 0.18, 3)
    };
    moved(format!("friction={truth}"), &[("friction", assumed)])
}

fn worn_profile(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    let truth = base.value("profile.conicity_scale");
    let assumed = truth * draw.either((0.5, 0.65), (1.5, 2.0), 2);
    moved(
        format!("worn_profile.profile.conicity_scale={truth}"),
        &[("profile.conicity_scale", assumed)],
    )
}

fn bending(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    let (frequency, mass) = (draw.between(7.0, 11.0, 2), draw.between(4000.0, 9000.0, 0));
    added(vec![
        format!("body_bending.body_bending.frequency={frequency}"),
        format!("body_bending.body_bending.modal_mass={mass}"),
    ])
}

fn bump_stop(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    added(vec![format!("bumpstop_gap={}", draw.between(0.004, 0.016, 4))])
}

fn yaw_dampers(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    let keys = ["secondary.yaw_damper_series_stiffness", "secondary.yaw_damper_damping"];
    left(base, "yaw_damper_loss", draw.between(0.1, 0.5, 2), &keys)
}

fn centre_friction(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    const KEY: &str = "secondary.centre_friction_torque";
    let (torque, measured) = (draw.between(5000.0, 14_000.0, 0), base.value(KEY));
    match measured > torque {
        true => moved(format!("centre_friction={measured}"), &[(KEY, measured - torque)]),
        false => added(vec![format!("centre_friction={}", measured + torque)]),
    }
}

fn payload(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    // A tenth to a fifth of the mass of a coach body; 50 % more on a freight wagon.
    let mass = draw.between(2500.0, 6000.0, 0) * if base.sprung() { 1.0 } else { 1.5 };
    let body = base.value("car_body.mass");
    let share = (body - mass) / body;
    let mut vehicle = vec![("car_body.mass", body - mass)];
    for key in ["car_body.inertia_roll", "car_body.inertia_pitch", "car_body.inertia_yaw"] {
        vehicle.push((key, share * base.value(key)));
    }
    moved(format!("payload={mass}"), &vehicle)
}

fn load_to_one_side(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    added(vec![format!("payload_offset={}", draw.either_sign(0.04, 0.10, 3))])
}

fn anti_roll_bar(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    left(
        base,
        "anti_roll_bar",
        draw.either((0.1, 0.5), (1.5, 2.0), 2),
        &["secondary.anti_roll_stiffness"],
    )
}

fn axle_guidance(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    left(base, "primary_yaw_stiffness", draw.either((0.3, 0.55), (1.8, 3.0), 2), &["primary.kx"])
}

fn vertical_dampers(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    left(base, "vertical_damper_loss", draw.between(0.1, 0.5, 2), &["secondary.cz"])
}

fn lateral_dampers(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    left(base, "lateral_damper_loss", draw.between(0.15, 0.5, 2), &["secondary.cy"])
}

fn out_of_round(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    let of = |what: &str, value: f64| format!("out_of_roundness.out_of_roundness.{what}={value}");
    let (wheelset, harmonic) = (1.0 + draw.below(4) as f64, 1.0 + draw.below(3) as f64);
    added(vec![
        of("amplitude", draw.between(0.0004, 0.001, 5)),
        of("wheelset", wheelset),
        of("harmonic", harmonic),
    ])
}

fn irregularities(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    const KEY: &str = "track.irregularity_scale";
    let truth = base.value(KEY);
    moved(
        format!("track_irregularity_scale={truth}"),
        &[(KEY, truth / draw.either((0.6, 0.75), (1.35, 1.8), 2))],
    )
}

fn cant(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    const KEY: &str = "track.cant_error";
    let (truth, error) = (base.value(KEY), draw.either_sign(14.0, 30.0, 1));
    // A relative error is not defined for a size of zero.
    match truth == 0.0 {
        true => added(vec![format!("cant_error={error}")]),
        false => moved(format!("cant_error={truth}"), &[(KEY, truth - error)]),
    }
}

fn wind(draw: &mut Draw, base: &Base, _: &Catalogue) -> Hidden {
    let force = draw.either_sign(6000.0, 15_000.0, 0) * if base.sprung() { 1.0 } else { 1.5 };
    added(vec![format!("crosswind={force}")])
}

/// A random channel of some groups.
pub fn channel(draw: &mut Draw, catalogue: &Catalogue, groups: &[&str]) -> String {
    let channels: Vec<String> =
        groups.iter().filter_map(|group| catalogue.channels(group)).flatten().collect();
    channels[draw.below(channels.len())].clone()
}

fn gain(draw: &mut Draw, _: &Base, catalogue: &Catalogue) -> Hidden {
    let channel = channel(draw, catalogue, &["guiding forces", "vertical forces", "accelerations"]);
    operated(format!("sensor_gain={} on {channel}", draw.either((0.75, 0.86), (1.14, 1.25), 3)))
}

fn offset(draw: &mut Draw, _: &Base, catalogue: &Catalogue) -> Hidden {
    let channel = channel(draw, catalogue, &["guiding forces", "vertical forces", "accelerations"]);
    let size = if channel.starts_with('a') {
        draw.either_sign(0.08, 0.2, 3)
    } else {
        draw.either_sign(5.0, 9.0, 3)
    };
    operated(format!("sensor_offset={size} on {channel}"))
}

fn shift(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    operated(format!("sync_shift={}", draw.either_sign(4.0, 14.0, 2)))
}

fn low_pass(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    let on = draw.one(&["", "", " on guiding forces", " on accelerations, bogie accelerations"]);
    operated(format!("filter_mismatch={}{on}", draw.between(3.5, 9.0, 2)))
}

fn swap(draw: &mut Draw, _: &Base, catalogue: &Catalogue) -> Hidden {
    let group = draw.one(&["guiding forces", "vertical forces"]);
    let two = draw.some(catalogue.channels(group).unwrap_or_default(), 2);
    operated(format!("channel_swap on {}", two.join(", ")))
}

fn polarity(draw: &mut Draw, _: &Base, catalogue: &Catalogue) -> Hidden {
    operated(format!(
        "polarity=-1 on {}",
        channel(draw, catalogue, &["guiding forces", "accelerations"])
    ))
}

fn crosstalk(draw: &mut Draw, _: &Base, _: &Catalogue) -> Hidden {
    operated(format!("crosstalk={}", draw.either_sign(0.04, 0.10, 3)))
}

/// Declared tolerances, and the numbers of the vehicle file to which they apply.
const DECLARED: [(&str, &[&str]); 4] = [
    (
        "suspension stiffness [-]",
        &["primary.kx", "primary.ky", "primary.kz", "secondary.ky", "secondary.kz"],
    ),
    ("suspension damping [-]", &["primary.cz", "primary.cy", "secondary.cz", "secondary.cy"]),
    ("masses and inertias [-]", &["car_body.mass", "bogie.mass", "wheelset.mass"]),
    ("equivalent conicity [-]", &["profile.conicity_scale"]),
];

/// No effect: the vehicle file differs from the measured vehicle within the declared tolerances.
fn nothing(draw: &mut Draw, base: &Base) -> Hidden {
    let mut vehicle = Vec::new();
    for (name, keys) in DECLARED {
        for key in keys {
            vehicle.push((*key, base.value(key) * draw.normal(base.declared(name)).exp()));
        }
    }
    vehicle.push((
        "friction",
        base.vehicle.friction + draw.normal(base.declared("friction per section [-]")),
    ));
    let livelier = draw.normal(base.declared("irregularity amplitude [-]")).exp();
    vehicle.push(("track.irregularity_scale", base.value("track.irregularity_scale") * livelier));
    // Tolerances declared by section, with a common deviation of all sections.
    vehicle.push((
        "track.cant_error",
        base.value("track.cant_error") + 0.5 * draw.normal(base.declared("cant [mm]")),
    ));
    Hidden { effects: Vec::new(), ..moved(String::new(), &vehicle) }
}
