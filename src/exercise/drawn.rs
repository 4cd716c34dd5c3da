//! A campaign for a protocol of which none is given: records of waves, whose levels and sizes are
//! searched until every limit holds and nothing is found.

use std::{collections::BTreeMap, f64::consts::TAU, sync::Arc};

use indexmap::IndexSet;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::bench::{Said, State, said};
use crate::certify::Compiled;
use crate::check::plan::{Datum, DatumKind, Side};
use crate::data::{
    Campaign, RecordKind,
    campaign::{CAMPAIGN_FILE, Memory},
    write::table_csv,
};
use crate::effects::{Channel, Signals};
use crate::impact::Written;
use crate::metrics::random::{GOLDEN, mixed};
use crate::problem::{Problem, Problems};
use crate::run::{
    self,
    needs::{ChannelNeed, DatumNeed, Needs},
};
use crate::simulate::frame;
use crate::units::{Dimension, Unit};

/// Columns of the table of sections that are no data of the protocol.
const SECTION: &str = "section";
const START: &str = "start";
const END: &str = "end";

/// Sections, their lengths in s, samples per second, and the speed in m/s: enough for minimum
/// numbers of sections, means over five minutes, and filters up to 100 Hz.
const SECTIONS: usize = 6;
const LENGTHS: [f64; 2] = [60.0, 330.0];
const RATE: f64 = 250.0;
const SPEED: f64 = 20.0;

/// What is recorded before and after a section, s: filters settle there.
const MARGIN: f64 = 5.0;

/// Frequencies of the waves, Hz: those of car bodies, bogies and wheelsets.
const WAVES: [f64; 7] = [0.23, 0.61, 1.3, 2.9, 5.3, 11.0, 23.0];

/// The size of what a measurement has and its simulation has not, as a share of the waves.
const GAP: f64 = 0.05;

/// Levels and sizes that are tried, in the unit of the protocol: 1, 2 and 5 times powers of ten.
const POWERS: std::ops::Range<i32> = -3..5;

/// How often all channels are gone through.
const ROUNDS: usize = 2;

/// How near a value may be to its limit.
const NEAR: f64 = 0.5;

/// Level and size of the waves of a channel.
#[derive(Clone, Copy, Debug)]
struct Waves {
    level: f64,
    size: f64,
}

/// # Errors
/// The protocol needs more than records and sections that are drawn, or none were found.
pub fn drawn(compiled: &Compiled, limits: &[Written], needs: &Needs) -> Result<Campaign, Problems> {
    let mut first = None;
    for length in LENGTHS {
        let drawing = Drawing::new(compiled, needs, length);
        match drawing.search(limits) {
            Ok(Some(campaign)) => return Ok(campaign),
            Ok(None) => {}
            Err(problems) => first = first.or(Some(problems)),
        }
    }
    let says = "no records were drawn with which every limit holds and nothing is found";
    Err(first.unwrap_or_else(|| Problem::error("limits-not-met", says).into()))
}

/// Waves of the columns of the records, each of size 1.
#[derive(Debug)]
struct Drawing<'a> {
    compiled: &'a Compiled,
    /// The channels that have levels and sizes.
    names: Vec<&'a str>,
    texts: BTreeMap<String, Vec<u8>>,
    records: Vec<Drawn>,
}

/// A record: what it is called, and of each column its channel, its unit and its waves.
#[derive(Debug)]
struct Drawn {
    name: String,
    axes: Signals,
    columns: Vec<(usize, Unit, Channel)>,
}

impl<'a> Drawing<'a> {
    fn new(compiled: &'a Compiled, needs: &'a Needs, length: f64) -> Self {
        let plan = &compiled.plan;
        let names: IndexSet<&str> =
            needs.channels.iter().filter_map(|need| need.channel.as_deref()).collect();
        let names: Vec<&str> = names.into_iter().collect();
        let over_time = plan.axis.unit.dimension == Dimension::TIME;
        let per_second = if over_time { 1.0 } else { SPEED };
        let sections: Vec<String> = (1..=SECTIONS).map(|number| format!("S{number:02}")).collect();
        let mut text = json!({"name": "drawn records", "vehicle": "vehicle.yaml"});
        let rows = ((length + 2.0 * MARGIN) * RATE) as usize;
        let mut records = Vec::new();
        for kind in RecordKind::ALL {
            let side = Side::ALL.into_iter().find(|side| side.kind() == kind);
            let record = side.map_or(kind.key(), Side::in_words);
            let of: Vec<&ChannelNeed> =
                needs.channels.iter().filter(|need| need.record == record).collect();
            if of.is_empty() {
                continue;
            }
            text[kind.key()] = kind.key().into();
            for section in &sections {
                let column = |need: &&ChannelNeed| {
                    let at =
                        names.iter().position(|name| need.channel.as_deref() == Some(*name))?;
                    let unit = Unit::parse(&need.unit).ok()?;
                    let of = format!("{} {section}", need.column);
                    let gap = if side == Some(Side::Measured) { GAP } else { 0.0 };
                    let values = waves(&of, gap, rows);
                    Some((at, unit, Channel { name: need.column.clone(), values }))
                };
                let axis = (0..rows).map(|row| row as f64 / RATE * per_second).collect();
                records.push(Drawn {
                    name: format!("{}/{section}", kind.key()),
                    axes: Signals { axis, over_time, rate: RATE, channels: Vec::new() },
                    columns: of.iter().filter_map(column).collect(),
                });
            }
        }
        let mut texts = BTreeMap::new();
        let keys: Vec<&str> = needs.vehicle.iter().map(|need| need.key.as_str()).collect();
        let data = plan.vehicle.iter().filter(|datum| keys.contains(&datum.key.as_str()));
        texts.insert("vehicle.yaml".into(), vehicle(data).to_string().into_bytes());
        if !needs.sections.is_empty() {
            text["sections"] = "sections.csv".into();
            let ends = [MARGIN * per_second, (MARGIN + length) * per_second];
            let table = table(compiled, &needs.sections, &sections, ends);
            texts.insert("sections.csv".into(), table.into_bytes());
        }
        texts.insert(CAMPAIGN_FILE.into(), text.to_string().into_bytes());
        Self { compiled, names, texts, records }
    }

    /// The campaign in which all is well, or `None`.
    ///
    /// # Errors
    /// No campaign of this kind can be judged.
    fn search(&self, limits: &[Written]) -> Result<Option<Campaign>, Problems> {
        let Compiled { plan, graph, .. } = self.compiled;
        let wrong = |waves: &[Waves]| -> Result<f64, Problems> {
            let campaign = self.campaign(waves)?;
            let (_, outcome) = run::again(plan, graph, &campaign, &[], &|_| true)?;
            Ok(wrongs(&said(limits, &outcome)))
        };
        let mut waves = vec![Waves { level: 0.0, size: 0.1 }; self.names.len()];
        let mut least = wrong(&waves)?;
        for _ in 0..ROUNDS {
            for at in 0..waves.len() {
                let with = |tried: Waves| {
                    let mut new = waves.clone();
                    new[at] = tried;
                    wrong(&new).ok().map(|found| (found, new))
                };
                let trials: Vec<Waves> = trials(waves[at]).collect();
                let tried: Vec<_> = trials.into_par_iter().filter_map(with).collect();
                let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((found, new)) = best.filter(|(found, _)| *found < least) {
                    (least, waves) = (found, new);
                }
                if least == 0.0 {
                    return self.campaign(&waves).map(Some);
                }
            }
        }
        Ok(None)
    }

    fn campaign(&self, waves: &[Waves]) -> Result<Campaign, Problems> {
        let mut memory = Memory { texts: self.texts.clone(), ..Memory::default() };
        for Drawn { name, axes, columns } in &self.records {
            let sized = |(at, _, Channel { name, values }): &(usize, Unit, Channel)| {
                let Waves { level, size } = waves[*at];
                let values = values.iter().map(|value| level + size * value).collect();
                Channel { name: name.clone(), values }
            };
            let signals = Signals { channels: columns.iter().map(sized).collect(), ..axes.clone() };
            let unit = |name: &str| {
                let of = columns.iter().find(|(_, _, channel)| channel.name == name);
                of.map_or_else(Unit::one, |(_, unit, _)| unit.clone())
            };
            let frame = frame(name, &signals, &unit)?;
            memory.records.insert(name.clone(), Arc::new(frame));
        }
        let mut problems = Problems::default();
        Campaign::with_memory(None, memory, &mut problems).ok_or(problems)
    }
}

/// How far a campaign is from one in which all is well: 0 if it is one.
fn wrongs(said: &Said) -> f64 {
    let of_limit = |state: &State| match (state.reach, state.holds) {
        (Some(reach), Some(true)) => (reach / NEAR).max(1.0).ln(),
        (Some(reach), _) => 1.0 + reach.abs().max(1.0).ln(),
        (None, _) => 5.0,
    };
    said.limits.iter().map(of_limit).sum::<f64>() + said.findings.len() as f64
}

fn trials(now: Waves) -> impl Iterator<Item = Waves> {
    let sizes = POWERS.flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
    let levels = sizes.clone().flat_map(|level| [level, -level]).chain([0.0]);
    let with_level = levels.map(move |level| Waves { level, ..now });
    sizes.map(move |size| Waves { size, ..now }).chain(with_level)
}

/// The table of sections, all with the same data.
fn table(
    compiled: &Compiled,
    needs: &[DatumNeed],
    sections: &[String],
    [start, end]: [f64; 2],
) -> String {
    let needed: Vec<&DatumNeed> = needs.iter().filter(|need| need.required).collect();
    let heading = |need: &&DatumNeed| match &need.unit {
        Some(unit) => format!("{} [{unit}]", need.key),
        None => need.key.clone(),
    };
    let datum = |key: &str| compiled.plan.columns.iter().find(|datum| datum.key == key);
    let cell = |section: &String, key: &str| match (key, datum(key).map(value)) {
        (SECTION, _) => section.clone(),
        (START, _) => start.to_string(),
        (END, _) => end.to_string(),
        (_, Some(Value::String(word))) => word,
        (_, other) => other.map_or_else(String::new, |value| value.to_string()),
    };
    let row = |section| needed.iter().map(|need| cell(section, &need.key)).collect();
    let head = needed.iter().map(heading).collect();
    let rows: Vec<Vec<String>> = [head].into_iter().chain(sections.iter().map(row)).collect();
    table_csv(&rows)
}

/// The vehicle file, of which YAML reads JSON.
fn vehicle<'a>(data: impl Iterator<Item = &'a Datum>) -> Value {
    let mut file = json!({"name": "drawn vehicle"});
    for datum in data {
        let pointer = datum.key.split('.').fold(String::new(), |path, part| path + "/" + part);
        let mut maps = pointer.match_indices('/').skip(1).map(|(end, _)| &pointer[..end]);
        // A map is made before what stands in it.
        let _ = maps.try_for_each(|map| {
            let (above, key) = map.rsplit_once('/')?;
            let above = file.pointer_mut(above)?.as_object_mut()?;
            above.entry(key).or_insert_with(|| json!({}));
            Some(())
        });
        if let Some((above, key)) = pointer.rsplit_once('/')
            && let Some(map) = file.pointer_mut(above).and_then(Value::as_object_mut)
        {
            map.insert(key.to_string(), value(datum));
        }
    }
    file
}

/// The middle of what a datum may be.
fn value(datum: &Datum) -> Value {
    match &datum.kind {
        DatumKind::Number(unit) => {
            let middle =
                datum.range.as_ref().map_or(unit.to_si(1.0), |range| match range.low > 0.0 {
                    true => (range.low * range.high).sqrt(),
                    false => f64::midpoint(range.low, range.high),
                });
            unit.from_si(middle).into()
        }
        DatumKind::Words(words) => words.first().cloned().unwrap_or_default().into(),
        DatumKind::Flag => true.into(),
        DatumKind::AnyWord | DatumKind::Campaign => "a".into(),
    }
}

/// A sum of waves with drawn phases, and a share of another one.
fn waves(of: &str, share: f64, rows: usize) -> Vec<f64> {
    let phases = |what: &str| WAVES.map(|wave| TAU * fraction(&format!("{of} {what} {wave}")));
    let (own, gap) = (phases("waves"), phases("gap"));
    let value = |row: usize| {
        let sum = |phases: &[f64]| -> f64 {
            let time = row as f64 / RATE;
            WAVES.iter().zip(phases).map(|(wave, phase)| (TAU * wave * time + phase).sin()).sum()
        };
        sum(&own) + share * sum(&gap)
    };
    (0..rows).map(value).collect()
}

/// A number from 0 to 1 that follows from a text.
fn fraction(text: &str) -> f64 {
    let add = |seed: u64, byte| mixed(seed ^ u64::from(byte)).wrapping_add(GOLDEN);
    text.bytes().fold(GOLDEN, add) as f64 / u64::MAX as f64
}
