//! Faults: what is wrong, what must be told of it, and how large it is.

use fishplate::effects::Gauss;

use super::answer::Answer;
use super::evaluate::{evaluated, shares};
use super::folder::{Folder, Side};

/// What a finding must name: one of these sections and one of these channels.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// Empty: of the campaign or of any section.
    pub sections: Vec<String>,
    /// The finding has a name that begins as one of them: of a channel, a record, or in its data;
    /// empty: any.
    pub channels: Vec<String>,
}

/// What a fault's size is.
#[derive(Clone, Copy, Debug)]
pub enum Size {
    /// Such that a statistic moves by a drawn share of its limit; where the search begins, and the
    /// largest that occurs.
    Sought { from: f64, most: f64 },
    /// Drawn; a statistic must move by more than [`LEAST`].
    Drawn(f64),
    /// Drawn, of what no statistic is computed from, as the speed of the table of sections.
    Fact(f64),
}

/// Puts a fault of a size into a campaign.
pub type Put = Box<dyn Fn(&mut Folder, f64) + Send + Sync>;

pub struct Fault {
    pub says: String,
    pub size: Size,
    pub told: Told,
    /// Rules that name the right cause, and codes of the program; see [`super::score::score`].
    pub right: &'static [&'static str],
    pub put: Put,
}

/// Smallest and largest change of a statistic, as a share of its limit.
pub const LEAST: f64 = 0.1;
pub const LARGEST: f64 = 1.0;
/// A size is accepted if its change is within this factor of the drawn one.
const CLOSE: f64 = 1.5;
/// Evaluations in the search of a size.
const SEARCHES: usize = 5;

/// Random numbers, and what faults are drawn of.
pub struct Draw(pub Gauss);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(Gauss::new(seed))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.0.uniform() < share
    }

    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { -1.0 } else { 1.0 }
    }

    pub fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.0.below(list.len())]
    }

    /// A seed for the noise of a fault.
    pub fn seed(&mut self) -> u64 {
        self.0.below(1 << 30) as u64
    }

    /// One of the channels that the protocol evaluates.
    pub fn channel(&mut self) -> String {
        let kinds = ["Y", "Q", "ay", "az"];
        let kind = *self.of(&kinds);
        self.channel_of(kind)
    }

    /// An evaluated channel of a kind.
    pub fn channel_of(&mut self, kind: &str) -> String {
        let places: &[&str] = match kind {
            "Y" | "Q" => &["1R", "1L", "3R", "3L"],
            _ => &["I", "II"],
        };
        format!("{kind}_{}", self.of(places))
    }

    /// The side of a fault of one side: more often the measurement.
    pub fn side(&mut self) -> Side {
        if self.chance(0.7) { Side::Measurement } else { Side::Simulation }
    }

    /// All sections, or one.
    pub fn sections(&mut self, folder: &Folder, all: f64) -> Vec<String> {
        let sections = folder.sections("");
        if self.chance(all) { sections } else { vec![self.of(&sections).clone()] }
    }
}

/// Names under which a channel, or a sum that contains it, is reported.
pub fn own(channel: &str) -> Vec<String> {
    let names = match (channel.split_once('_'), channel.as_bytes()) {
        (Some(("Y", wheel)), _) => vec![format!("YQ_{wheel}"), format!("SigmaY_{}", &wheel[..1])],
        (Some(("Q", wheel)), _) => ["SigmaQ", "DeltaQ"]
            .map(|sum| format!("{sum}_{}", &wheel[..1]))
            .into_iter()
            .chain([format!("YQ_{wheel}")])
            .collect(),
        _ => Vec::new(),
    };
    names.into_iter().chain([channel.to_string()]).collect()
}

/// Names under which the channels of a kind are reported.
pub fn of_kind(kind: &str) -> Vec<String> {
    let names: &[&str] = match kind {
        "Y" => &["Y_", "SigmaY", "TotalY", "YQ_"],
        "Q" => &["Q_", "SigmaQ", "TotalQ", "DeltaQ", "YQ_"],
        "ay" => &["ay_"],
        _ => &["az_"],
    };
    texts(names)
}

pub fn texts(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_string()).collect()
}

/// All sections are named where all are concerned: then any of them is right.
pub fn concerned(folder: &Folder, sections: &[String], channels: Vec<String>) -> Told {
    let all = sections.len() == folder.sections("").len();
    Told { sections: if all { Vec::new() } else { sections.to_vec() }, channels }
}

/// A fault with its size, put into a campaign.
pub struct Sized {
    pub fault: Fault,
    pub size: f64,
    /// The largest change of a statistic, as a share of its limit.
    pub moved: f64,
    pub folder: Folder,
}

/// The size of a fault, if there is one at which a statistic moves enough.
pub fn sized(
    fault: Fault,
    sound: &Folder,
    shares_before: &Answer,
    draw: &mut Draw,
) -> Option<Sized> {
    let with = |size: f64| {
        let mut folder = sound.clone();
        (fault.put)(&mut folder, size);
        let moved = evaluated(&folder, shares).map_or(LARGEST, |after| after.moved(shares_before));
        (folder, moved)
    };
    match fault.size {
        Size::Fact(size) => {
            let mut folder = sound.clone();
            (fault.put)(&mut folder, size);
            Some(Sized { size, moved: f64::NAN, folder, fault })
        }
        Size::Drawn(size) => {
            let (folder, moved) = with(size);
            (moved >= LEAST).then_some(Sized { size, moved, folder, fault })
        }
        Size::Sought { from, most } => {
            let wanted = draw.log_between(LEAST, LARGEST);
            let mut size = from;
            for _ in 0..SEARCHES {
                let (folder, moved) = with(size);
                let close = moved >= wanted / CLOSE && moved <= wanted * CLOSE;
                if moved >= LEAST && (close || (moved < wanted && size.abs() >= most)) {
                    return Some(Sized { size, moved, folder, fault });
                }
                let factor = (wanted / moved.max(1e-6)).clamp(0.05, 20.0);
                size = (size.abs() * factor).min(most).copysign(from);
            }
            None
        }
    }
}
