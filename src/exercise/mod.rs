//! Pairs of campaigns on both sides of each limit of a protocol: its own test.
//!
//! | file | content |
//! |---|---|
//! | `bench` | a campaign in memory that is judged again and again with other records |
//! | `disturb` | what is added to a channel |
//! | `drawn` | a campaign where none is given |
//! | `mutate` | numbers of the protocol that are changed, and whether a pair notices |
//! | `search` | the disturbance that brings one limit to both sides, and no other |
//!
//! A campaign whose limits all hold is changed by something that is added to one channel, so little
//! that one value just meets its limit, and so little more that it does not.

mod bench;
mod disturb;
mod drawn;
mod mutate;
mod search;

use crate::certify::Compiled;
use crate::check::{Overrides, family};
use crate::data::Campaign;
use crate::data::write::Outputs;
use crate::impact;
use crate::problem::{Problem, Problems, problem};
use crate::result::exercise::{Exercise, Exercised, NoPair, Pair};
use crate::result::{FORMAT, THIS};
use crate::run::needs::needs;
use bench::{Bench, Said, State};
use search::{Found, Search};

/// Shares of the difference between measurement and simulation that are kept, the largest first
/// with which every limit holds.
const GAPS: [f64; 7] = [1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.005];

/// A limit of the base campaign that is nearer than this leaves no room: others would change sides
/// with it.
const ROOM: f64 = 0.9;

/// What a protocol is read with once more, where its numbers are changed.
#[expect(missing_debug_implementations, reason = "it holds a function")]
#[derive(Clone, Copy)]
pub struct Mutate<'a> {
    pub overrides: &'a Overrides,
    pub find: family::Find<'a>,
}

/// Makes the pairs, from a campaign or from drawn records, and adds their campaigns to files.
///
/// # Errors
/// `limits-not-met`: a limit of the campaign is exceeded; of reading and writing.
pub fn exercise(
    compiled: &Compiled,
    campaign: Option<&Campaign>,
    mutate: Option<Mutate<'_>>,
    outputs: &mut Outputs,
    progress: &dyn Fn(&str),
) -> Result<Exercise, Problems> {
    let limits = impact::limits(compiled, |_| None);
    let mut made = Exercise {
        fishplate: THIS.into(),
        format: FORMAT,
        protocol: compiled.plan.name.clone(),
        campaign: campaign.map_or_else(String::new, |campaign| campaign.name.clone()),
        gap: 1.0,
        limits: Vec::new(),
        mutations: Vec::new(),
    };
    if limits.is_empty() {
        return Ok(made);
    }
    let needs = needs(&compiled.plan, &compiled.graph);
    let drawn = match campaign {
        Some(_) => None,
        None => Some(drawn::drawn(compiled, &limits, &needs)?),
    };
    let Some(campaign) = campaign.or(drawn.as_ref()) else { return Ok(made) };
    made.campaign.clone_from(&campaign.name);
    let mut bench = Bench::new(compiled, &limits, campaign)?;
    let base;
    (base, made.gap) = with_room(&mut bench)?;
    let mut search = Search::new(&bench, &needs, &base);
    let mut kept = Vec::new();
    for (number, limit) in limits.iter().enumerate() {
        progress(&limit.rule);
        let found = search.pair(number);
        let folder = folder(number, &limit.rule);
        let (pair, reason) = match &found {
            Ok(Found { by, inside, outside, .. }) => {
                let (disturbance, inside, outside) = (by.clone(), *inside, *outside);
                (Some(Pair { folder: folder.clone(), disturbance, inside, outside }), None)
            }
            Err(reason) => (None, Some(reason.clone())),
        };
        if let Ok(found) = found {
            write(&bench, outputs, (&folder, &limit.rule), &found)?;
            kept.push((number, found));
        }
        made.limits.push(Exercised {
            limit: limit.rule.clone(),
            rule: limit.place(),
            pair,
            reason,
        });
    }
    made.mutations = mutate.map_or_else(Vec::new, |mutate| {
        mutate::mutations(&bench, (mutate.overrides, mutate.find), (&base, &kept))
    });
    Ok(made)
}

/// The number of limits that a protocol states.
pub fn limits_of(compiled: &Compiled) -> usize {
    impact::limits(compiled, |_| None).len()
}

/// Whether a limit leaves no room, or is not met.
fn near(state: &State) -> bool {
    state.holds == Some(false) || state.reach.is_some_and(|reach| reach > ROOM)
}

/// The campaign in which every limit holds, with room.
fn with_room(bench: &mut Bench<'_>) -> Result<(Said, f64), Problems> {
    let mut now = 1.0;
    for gap in GAPS {
        if gap < now {
            bench.narrow(gap / now)?;
            now = gap;
        }
        let said = bench.base()?;
        if !said.limits.iter().any(near) {
            return Ok((said, gap));
        }
    }
    let said = bench.base()?;
    let both = bench.limits.iter().zip(&said.limits).filter(|(_, state)| near(state));
    let near: Vec<&str> = both.map(|(limit, _)| limit.rule.as_str()).collect();
    let name = &bench.campaign.name;
    Err(problem!(
        "limits-not-met",
        "in {name} these limits do not hold with room: {}",
        near.join("; ")
    )
    .help("give a campaign with `--from` in which every limit holds")
    .into())
}

/// `03-quantity-Y-max-limit-std`
fn folder(number: usize, rule: &str) -> String {
    let plain: String =
        rule.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let words: Vec<&str> = plain.split('-').filter(|word| !word.is_empty()).collect();
    format!("{:02}-{}", number + 1, words.join("-"))
}

fn write(
    bench: &Bench<'_>,
    outputs: &mut Outputs,
    (folder, rule): (&str, &str),
    found: &Found,
) -> Result<(), Problem> {
    for (side, of) in [("inside", found.inside), ("outside", found.outside)] {
        let name = format!("{}: {side} {rule}", bench.campaign.name);
        bench.write((&mut *outputs, &format!("{folder}/{side}")), &name, (&found.by, of.size))?;
    }
    Ok(())
}

/// Whether every limit in force has a pair, and some limit is in force.
pub fn complete(found: &Exercise) -> bool {
    let some = found.limits.is_empty() || found.limits.iter().any(|of| of.pair.is_some());
    some && found.limits.iter().all(|of| of.pair.is_some() || of.reason == Some(NoPair::NotInForce))
}
