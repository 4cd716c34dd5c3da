//! Sound campaigns that differ from the usual ones: none of them may be told as faulty.

use std::path::Path;

use super::blind::vehicles::{COACH, Design, RAILCAR, WAGON};
use super::fault::Draw;
use super::folder::{Folder, Side};
use super::made::{LOCOMOTIVE, Recipe, Wind, make};
use super::signal::each;

/// A sound campaign.
pub struct Variation {
    pub name: String,
    /// Whether wind blows in one of the records.
    pub wind: bool,
    pub from: From,
}

pub enum From {
    /// The campaign of a number, changed.
    Changed(usize, fn(&mut Folder)),
    Made(Box<Recipe>),
}

impl Variation {
    /// The campaign in a new folder.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn folder(&self, sound: &[Folder], out: &Path) -> Result<Folder, String> {
        match &self.from {
            From::Changed(base, change) => {
                let mut folder = sound[*base].clone();
                change(&mut folder);
                Ok(folder)
            }
            From::Made(recipe) => {
                make(recipe, out)?;
                Ok(Folder::read(out))
            }
        }
    }
}

/// All variations. `bases` are the names of the sound campaigns.
pub fn all(bases: &[String], seed: u64) -> Vec<Variation> {
    let draw = &mut Draw::new(seed);
    let mut all = Vec::new();
    for (base, name) in bases.iter().enumerate() {
        let mut add = |what: &str, change: fn(&mut Folder)| {
            let name = format!("{name}, {what}");
            all.push(Variation { name, wind: false, from: From::Changed(base, change) });
        };
        add("as it is", |_| {});
        add("forces with one decimal, accelerations with two", rounded);
        add("short margins", short_margins);
    }
    all.extend(winds(draw));
    all.extend(others(draw));
    all.extend(unmodelled(draw));
    all
}

const DESIGNS: [&Design; 4] = [&COACH, &WAGON, &LOCOMOTIVE, &RAILCAR];

fn made(recipe: Recipe) -> Variation {
    let wind = recipe.wind.measured.abs() > 0.0 || recipe.wind.simulated.abs() > 0.0;
    Variation { name: recipe.name.clone(), wind, from: From::Made(Box::new(recipe)) }
}

fn recipe(draw: &mut Draw, name: String, design: &'static Design) -> Recipe {
    Recipe { name: format!("{}, {name}", design.name), ..Recipe::of("", design, draw.seed()) }
}

/// Wind of 10, 15 and 25 kN, on both sides or only in the measurement.
fn winds(draw: &mut Draw) -> Vec<Variation> {
    let mut all = Vec::new();
    for kilonewtons in [10.0, 15.0, 25.0] {
        for both in [true, false] {
            for design in [&COACH, &WAGON, &RAILCAR] {
                let measured = 1000.0 * kilonewtons * draw.sign();
                let (simulated, on) =
                    if both { (measured, "both sides") } else { (0.0, "the measurement") };
                let name = format!("wind of {kilonewtons} kN on {on}");
                let wind = Wind { measured, simulated };
                all.push(made(Recipe { wind, ..recipe(draw, name, design) }));
            }
        }
    }
    all
}

/// Other lines, rates, loads and vehicles on both sides.
fn others(draw: &mut Draw) -> Vec<Variation> {
    let mut all = Vec::new();
    for design in DESIGNS {
        let quality = draw.between(0.25, 0.4);
        let name = format!("irregularities times {quality:.2}");
        all.push(made(Recipe { quality, ..recipe(draw, name, design) }));
        let name = "cant deficiency of 5 to 35 mm".into();
        all.push(made(Recipe { deficiency: (5.0, 35.0), ..recipe(draw, name, design) }));
    }
    let empty = vec![
        ("car_body.mass", 0.22),
        ("car_body.inertia_roll", 0.22),
        ("car_body.inertia_pitch", 0.22),
        ("car_body.inertia_yaw", 0.22),
        ("car_body.cog_height", 0.6),
        ("primary.kz", 0.5),
        ("secondary.centre_friction_torque", 0.3),
    ];
    for n in 0..2 {
        let name = format!("empty, line {n}");
        all.push(made(Recipe { vehicle: empty.clone(), ..recipe(draw, name, &WAGON) }));
    }
    for (design, rate) in [(&COACH, 1000.0), (&WAGON, 1000.0), (&RAILCAR, 600.0)] {
        let name = format!("sampled with {rate} Hz");
        all.push(made(Recipe { rate, ..recipe(draw, name, design) }));
    }
    for design in [&COACH, &RAILCAR, &WAGON] {
        let offset = draw.sign() * draw.between(0.02, 0.06);
        let name = format!("load {offset:.3} m to one side");
        let both = vec![("payload.lateral_offset", offset)];
        all.push(made(Recipe { both, ..recipe(draw, name, design) }));
    }
    for design in DESIGNS {
        let mut factor = || draw.between(0.7, 1.4);
        let vehicle = vec![
            ("car_body.mass", factor()),
            ("primary.kx", factor()),
            ("primary.kz", factor()),
            ("secondary.ky", factor()),
            ("secondary.kz", factor()),
            ("geometry.half_bogie_spacing", 1.1),
        ];
        let name = "another vehicle".into();
        all.push(made(Recipe { vehicle, ..recipe(draw, name, design) }));
    }
    all
}

/// Effects of the catalogue that the simulation does not have.
fn unmodelled(draw: &mut Draw) -> Vec<Variation> {
    let effects: [(&'static Design, &[&str]); 16] = [
        (&COACH, &["friction=0.22"]),
        (&WAGON, &["friction=0.5"]),
        (&RAILCAR, &["friction=0.25"]),
        (&COACH, &["payload=1500"]),
        (&WAGON, &["payload=2500"]),
        (&COACH, &["worn_profile.profile.worn_share=0.7"]),
        (&RAILCAR, &["worn_profile.profile.conicity_scale=1.8"]),
        (&COACH, &["lateral_damper_loss=0.3"]),
        (&RAILCAR, &["vertical_damper_loss=0.4"]),
        (&COACH, &["yaw_damper_loss=0.3"]),
        (&RAILCAR, &["anti_roll_bar=0.5"]),
        (&LOCOMOTIVE, &["primary_yaw_stiffness=0.6"]),
        (&COACH, &["payload_offset=0.04"]),
        (&RAILCAR, &["bumpstop_gap=0.014"]),
        (&LOCOMOTIVE, &["track_irregularity_scale=1.3"]),
        (&WAGON, &["centre_friction=22000"]),
    ];
    let one = |(design, effects): (&'static Design, &[&'static str])| {
        let name = format!("unmodelled {}", effects.join(", "));
        made(Recipe { unmodelled: effects.to_vec(), ..recipe(draw, name, design) })
    };
    effects.into_iter().map(one).collect()
}

fn rounded(folder: &mut Folder) {
    let sections = folder.sections("");
    for (begin, tenth) in [("Y", 10.0), ("Q", 10.0), ("a", 100.0)] {
        folder.channels(Side::Both, &sections, &[begin], |values| {
            each(values, |_, value| (value * tenth).round() / tenth)
        });
    }
}

/// A record ends half a metre before and behind its section.
fn short_margins(folder: &mut Folder) {
    const MARGIN: f64 = 0.5;
    for section in folder.sections("") {
        let [start, end] =
            ["start", "end"].map(|column| folder.fact(&section, column).unwrap_or(0.0));
        for kind in ["simulation", "measurement"] {
            let record = folder.record_mut(&format!("{kind}/{section}.csv"));
            let distance = record.values("distance").to_vec();
            record.keep(|row| distance[row] >= start - MARGIN && distance[row] <= end + MARGIN);
        }
    }
}
