//! Faults drawn at random in sound and failing campaigns, and sound variations: how many are told.

pub mod answer;
mod balance;
mod best_match;
mod blind;
mod cell;
pub mod evaluate;
pub mod fault;
pub mod first_round;
pub mod folder;
mod independence;
pub mod made;
mod sample;
pub mod score;
mod signal;
pub mod variations;

use std::path::Path;

use answer::Answer;
use evaluate::{Program, answer, evaluated, shares};
use fault::{Draw, Fault, sized};
use folder::Folder;
use made::Recipe;
use rayon::prelude::*;
use score::{Score, score, wrongly};
use variations::Variation;

/// A kind of fault, and one of it at random.
pub type Kind = (&'static str, fn(&mut Draw, &Folder) -> Fault);

/// The mechanisms that must tell them.
pub const MECHANISMS: [(&str, &[Kind]); 5] = [
    ("independence of both sides", independence::KINDS),
    ("balance over the campaign", balance::KINDS),
    ("the best match", best_match::KINDS),
    ("single sample and spectrum", sample::KINDS),
    ("the cell", cell::KINDS),
];

/// A campaign into which faults are put.
pub struct Base {
    pub name: String,
    pub folder: Folder,
    /// What the program tells of it.
    pub answer: Answer,
    /// Its statistics without rules of plausibility.
    shares: Answer,
    pub fails: bool,
}

/// A fault that was evaluated.
pub struct Case {
    pub mechanism: usize,
    pub kind: &'static str,
    pub base: usize,
    pub says: String,
    pub moved: f64,
    pub score: Score,
}

/// Campaigns: those that are sound, then those that fail. The two of the examples are made by
/// another implementation of the model.
///
/// # Errors
/// One cannot be made.
pub fn bases(
    program: &Program,
    sound: &[Recipe],
    failing: &[Recipe],
    out: &Path,
) -> Result<Vec<Base>, String> {
    let example = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    let folders: Vec<(String, Folder)> = sound
        .par_iter()
        .chain(failing)
        .enumerate()
        .map(|(n, recipe)| {
            let place = out.join(format!("made-{n}"));
            made::make(recipe, &place)?;
            Ok((recipe.name.clone(), Folder::read(&place)))
        })
        .collect::<Result<_, String>>()?;
    let known = |name: &str| {
        let copy = out.join(name);
        Folder::read(&example(name)).write(&copy);
        (format!("example {name}"), Folder::read(&copy))
    };
    let mut all = vec![known("coach-good")];
    all.extend(folders);
    all.insert(1 + sound.len(), known("coach"));
    let sound = 1 + sound.len();
    let base = |(at, (name, folder)): (usize, (String, Folder))| {
        let fails = at >= sound;
        let own = evaluated(&folder, |path| answer(&Program::Own, path));
        let wanted = if fails { "not validated" } else { "validated" };
        if own.verdict != wanted {
            return Err(format!("{name} is {}: {}", own.verdict, own.reasons.join("; ")));
        }
        let answer = match program {
            Program::Own => own,
            Program::Other(_) => evaluated(&folder, |path| answer(program, path)),
        };
        let shares =
            evaluated(&folder, shares).ok_or_else(|| format!("{name} cannot be evaluated"))?;
        Ok(Base { name, folder, answer, shares, fails })
    };
    let all: Vec<Result<Base, String>> = all.into_par_iter().enumerate().map(base).collect();
    let wrong: Vec<&str> =
        all.iter().filter_map(|base| Some(base.as_ref().err()?.as_str())).collect();
    if wrong.is_empty() { all.into_iter().collect() } else { Err(wrong.join("\n")) }
}

/// Attempts to draw a fault of a kind that moves a statistic enough.
const ATTEMPTS: usize = 12;

/// As many faults of each mechanism, the kinds in turn, each in a campaign drawn, evaluated; of
/// kinds whose name contains `only`. Each is shown as it is done.
pub fn faults(
    program: &Program,
    bases: &[Base],
    (seed, of_each): (u64, usize),
    only: &str,
    show: &(dyn Fn(&Case) + Sync),
) -> Vec<Case> {
    let asked = |(mechanism, n): &(usize, usize)| {
        let kinds = MECHANISMS[*mechanism].1;
        kinds[n % kinds.len()].0.contains(only)
    };
    let every: Vec<(usize, usize)> = (0..MECHANISMS.len())
        .flat_map(|m| (0..of_each).map(move |n| (m, n)))
        .filter(asked)
        .collect();
    every
        .par_iter()
        .filter_map(|at| case(program, bases, seed, *at))
        .inspect(|case| show(case))
        .collect()
}

fn case(
    program: &Program,
    bases: &[Base],
    seed: u64,
    (mechanism, n): (usize, usize),
) -> Option<Case> {
    let (_, kinds) = MECHANISMS[mechanism];
    let draw = &mut Draw::new(seed * 1_000_003 + (1000 * mechanism + n) as u64);
    for attempt in 0..ATTEMPTS {
        // After half of the attempts, the next kind.
        let (kind, make) = kinds[(n + attempt / (ATTEMPTS / 2)) % kinds.len()];
        let base = drawn_base(draw, bases, mechanism == 0);
        let sound = &bases[base];
        let fault = make(draw, &sound.folder);
        let Some(sized) = sized(fault, &sound.folder, &sound.shares, draw) else { continue };
        let answer = evaluated(&sized.folder, |path| answer(program, path));
        let score = score(&answer, &sound.answer, &sized.fault.told, sized.fault.right);
        let says = format!("{} {:.3}", sized.fault.says, sized.size);
        return Some(Case { mechanism, kind, base, says, moved: sized.moved, score });
    }
    None
}

/// Half of the simulations that were made from a measurement are of campaigns that fail.
fn drawn_base(draw: &mut Draw, bases: &[Base], copied: bool) -> usize {
    let sound = bases.iter().filter(|base| !base.fails).count();
    if copied && draw.chance(0.5) {
        sound + draw.0.below(bases.len() - sound)
    } else {
        draw.0.below(bases.len())
    }
}

/// A sound variation that was evaluated.
#[derive(Debug)]
pub struct Quiet {
    pub name: String,
    pub wrongly: Vec<String>,
    pub verdict: String,
}

/// The sound variations, evaluated.
///
/// # Errors
/// One cannot be made.
pub fn quiet(
    program: &Program,
    bases: &[Base],
    variations: &[Variation],
    out: &Path,
) -> Result<Vec<Quiet>, String> {
    let sound: Vec<Folder> = bases.iter().map(|base| base.folder.clone()).collect();
    let of = |(n, variation): (usize, &Variation)| {
        let place = out.join(format!("variation-{n}"));
        let folder = variation.folder(&sound, &place)?;
        let answer = evaluated(&folder, |path| answer(program, path));
        let wrongly = wrongly(&answer, variation.wind);
        Ok(Quiet { name: variation.name.clone(), wrongly, verdict: answer.verdict })
    };
    variations.par_iter().enumerate().map(of).collect()
}

/// The fixed faults of the first round in a campaign: name and score.
pub fn first_round(program: &Program, base: &Base) -> Vec<(&'static str, Score)> {
    let of = |fault: &first_round::Fault| {
        let mut folder = base.folder.clone();
        let told = (fault.put)(&mut folder);
        let answer = evaluated(&folder, |path| answer(program, path));
        (fault.name, score(&answer, &base.answer, &told, &[]))
    };
    first_round::all().par_iter().map(of).collect()
}
