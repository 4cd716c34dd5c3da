//! Compares a mapping with the needs of a protocol, before any record is read.

use super::{ChannelMap, Channels, Distance, Mapping, Runs, Side};
use crate::data::RecordKind;
use crate::data::cells::name_and_unit;
use crate::problem::{Problem, Problems, error, nearest, warning};
use crate::run::needs::{ChannelNeed, DatumNeed, Needs, SEARCH};
use crate::source::Spanned;
use crate::units::Unit;

/// What the needs call the records of a side.
pub fn record_of(kind: RecordKind) -> &'static str {
    match kind {
        RecordKind::Measurement => "measured",
        RecordKind::Simulation => "simulated",
        RecordKind::Track => "track",
    }
}

/// Problems: `channel-missing`, `unit-mismatch`, `column-missing`, `datum-missing`; warnings:
/// `side-missing`, `position-left-out`.
pub fn agree(mapping: &Mapping, needs: &Needs, problems: &mut Problems) {
    let missing = |record: &str, column: &str| {
        mapping.sides.iter().any(|side| record_of(side.kind) == record && lacks(side, column))
    };
    for kind in [RecordKind::Measurement, RecordKind::Simulation] {
        let of_side: Vec<&ChannelNeed> =
            needs.channels.iter().filter(|need| need.record == record_of(kind)).collect();
        match mapping.side(kind) {
            Some(side) => agree_side(
                (mapping, side),
                &of_side,
                &|need| needs.blocks(need, &missing),
                problems,
            ),
            None if of_side.iter().any(|need| is_required(mapping, need)) => {
                let says = format!(
                    "the protocol also reads the {}, which this mapping does not import",
                    kind.key()
                );
                problems.push(warning("side-missing", says, &mapping.top()));
            }
            None => {}
        }
    }
    match &mapping.runs {
        Some(runs) => agree_runs(mapping, runs, needs, problems),
        None => agree_sections(mapping, needs, problems),
    }
    agree_vehicle(mapping, needs, problems);
}

/// Whether a number depends on a channel; on those of the search only where the sections are looked
/// for in runs.
fn is_required(mapping: &Mapping, need: &ChannelNeed) -> bool {
    let is_search = mapping.runs.as_ref().is_some_and(|runs| runs.table.is_none());
    need.required && (is_search || !need.of_search_alone())
}

/// Section data must be found in the runs or stated of each; otherwise there is a table of
/// sections.
fn agree_runs(mapping: &Mapping, runs: &Runs, needs: &Needs, problems: &mut Problems) {
    if runs.table.is_some() || needs.sections.is_empty() {
        return;
    }
    let Some(found) = &needs.found else {
        let problem = error(
            "no-search",
            "the protocol does not look for sections in runs",
            &mapping.sections.span,
        );
        problems
            .push(problem.help("name a protocol with `use found sections`, or a table of sections with a column `run`: `sections: ...`"));
        return;
    };
    let given = ["section", "start", "end"];
    let is_open = |need: &&DatumNeed| {
        need.required && !given.contains(&need.key.as_str()) && !found.contains(&need.key)
    };
    for need in needs.sections.iter().filter(is_open) {
        for (name, facts) in mapping.sections.names.iter().zip(&runs.facts) {
            let known = || facts.iter().map(|(key, _)| name_and_unit(&key.text).0);
            if !known().any(|known| known == need.key) {
                let says = format!(
                    "`{}` of run `{}` is neither found nor stated, and the protocol needs it: {}",
                    need.key, name.value, need.title
                );
                let problem =
                    error("missing-run-data", says, &name.span).suggest(&need.key, known());
                let example = need.words.first().map_or("...", String::as_str);
                problems.push(match problem.help {
                    Some(_) => problem,
                    None => problem.help(format!(
                        "state it of the run: `{}: {{{}: {example}}}`",
                        name.value, need.key
                    )),
                });
            }
        }
    }
}

fn agree_sections(mapping: &Mapping, needs: &Needs, problems: &mut Problems) {
    let mut required = needs.sections.iter().filter(|need| need.required);
    if mapping.sections.table.is_none() {
        if required.next().is_some() {
            let says = "the protocol evaluates sections, and the mapping lists only names";
            problems.push(
                error("column-missing", says, &mapping.sections.span)
                    .help("name the table of sections: `sections: sections.csv`"),
            );
        }
        return;
    }
    for need in required.filter(|need| !mapping.sections.has_column(&need.key)) {
        let says = format!(
            "the table of sections has no column `{}`, which the protocol needs: {}",
            need.key, need.title
        );
        let problem = error("column-missing", says, &mapping.sections.span);
        problems.push(problem.suggest(&need.key, mapping.sections.columns()));
    }
}

fn agree_vehicle(mapping: &Mapping, needs: &Needs, problems: &mut Problems) {
    for need in needs.vehicle.iter().filter(|need| need.required) {
        match &mapping.vehicle {
            None => {
                let problem = Problem::error(
                    "key-missing",
                    format!(
                        "the protocol needs vehicle data (`{}`: {}), and the mapping names no vehicle file",
                        need.key, need.title
                    ),
                );
                problems.push(problem.at(&mapping.top()).help("write `vehicle: vehicle.yaml`"));
                break;
            }
            Some((written, node)) if node.lookup(&need.key).is_none() => {
                let says = format!(
                    "the vehicle file has no `{}`, which the protocol needs: {}",
                    need.key, need.title
                );
                let known = node.entries().iter().map(|(key, _)| key.text.as_str());
                problems
                    .push(error("datum-missing", says, &written.span).suggest(&need.key, known));
            }
            Some(_) => {}
        }
    }
}

/// Whether a side does not map a column. Of channels that keep their names this is known only of
/// the file.
fn lacks(side: &Side, column: &str) -> bool {
    side.channels.maps().is_some_and(|maps| {
        !maps.iter().any(|map| map.name.value == column) && !is_axis(side, column)
    })
}

fn is_axis(side: &Side, column: &str) -> bool {
    column == "time" || column == "distance" && side.distance.is_some()
}

fn agree_side(
    (mapping, side): (&Mapping, &Side),
    needs: &[&ChannelNeed],
    blocks: &dyn Fn(&ChannelNeed) -> bool,
    problems: &mut Problems,
) {
    let named = |name: &str| needs.iter().find(|need| need.column == name);
    let Channels::Maps(maps) = &side.channels else { return };
    let strangers: Vec<&Spanned<String>> =
        maps.iter().map(|map| &map.name).filter(|name| named(&name.value).is_none()).collect();
    let missing: Vec<&ChannelNeed> = needs
        .iter()
        .copied()
        .filter(|need| is_required(mapping, need) && lacks(side, &need.column))
        .collect();
    // A slip is one, even if the position could be left out.
    let near = missing.iter().find_map(|need| {
        let slip = nearest(&need.column, strangers.iter().map(|name| name.value.as_str()))?;
        strangers.iter().find(|name| name.value == slip).map(|name| (*need, *name))
    });
    let (needed, left_out): (Vec<&ChannelNeed>, Vec<&ChannelNeed>) = missing
        .into_iter()
        .partition(|need| near.is_some_and(|(slip, _)| slip.column == need.column) || blocks(need));
    if let Some(problem) = not_there(side, &needed, "not mapped") {
        problems.push(match near {
            Some((need, slip)) => Problem { help: None, ..problem }
                .also(&slip.span, format!("is `{}` meant?", need.column)),
            None => problem,
        });
    }
    problems.add(left_out_of(side, &left_out, "not mapped"));
    let others = maps.iter().chain(side.distance.iter().filter_map(|distance| match distance {
        Distance::Channel(map) => Some(map),
        Distance::Speed { .. } | Distance::Trigger { .. } => None,
    }));
    for map in others {
        if let Some(need) = named(&map.name.value) {
            units(map, need, problems);
        }
    }
}

/// Of channels that keep their names: those that the protocol needs and a file does not have.
/// `names`: the channels of the file.
pub fn as_named(
    (mapping, side): (&Mapping, &Side),
    needs: &Needs,
    names: &[&str],
    shown: &str,
) -> Vec<Problem> {
    let record = record_of(side.kind);
    let lacks = |column: &str| !names.contains(&column) && !is_axis(side, column);
    let missing = needs
        .channels
        .iter()
        .filter(|need| is_required(mapping, need) && need.record == record && lacks(&need.column));
    let (needed, left_out): (Vec<&ChannelNeed>, Vec<&ChannelNeed>) =
        missing.partition(|need| needs.blocks(need, &|of, column| of == record && lacks(column)));
    let is = format!("not in `{shown}`, whose channels keep their names");
    let error = not_there(side, &needed, &is).map(|problem| {
        let near = needed.iter().find_map(|need| Some((need, nearest(&need.column, names.iter().copied())?)));
        match near {
            Some((need, near)) => problem.help(format!("is `{near}` meant? Write `channels:` with `{}: {near}`", need.column)),
            None => problem.help("say what they are in the file: `channels: {...}` with a line for each, in place of `as named`"),
        }
    });
    error.into_iter().chain(left_out_of(side, &left_out, &is)).collect()
}

/// Channels without which an axis, a check or a quantity cannot be evaluated.
fn not_there(side: &Side, missing: &[&ChannelNeed], is: &str) -> Option<Problem> {
    let first = missing.first()?;
    let (list, kind) = (listed(missing), side.kind.key());
    let says = match missing.len() {
        1 => format!("the protocol needs {list} of the {kind}, and it is {is}"),
        count => {
            format!("the protocol needs {count} channels of the {kind} that are {is}: {list}")
        }
    };
    let problem = error("channel-missing", says, &side.span);
    let user = first.users.quantities.iter().chain(&first.users.rules).next();
    Some(match user {
        Some(_) if first.of_search_alone() => {
            problem.help(format!("`{}` is for {SEARCH} in the runs", first.column))
        }
        Some(user) => problem.help(format!(
            "`{}` is for {user}; `fishplate explain PROTOCOL --stage needs` lists all needs",
            first.column
        )),
        None => problem,
    })
}

fn listed(channels: &[&ChannelNeed]) -> String {
    let names: Vec<String> = channels.iter().map(|need| format!("`{}`", need.column)).collect();
    names.join(", ")
}

/// Channels without which only positions are left out.
fn left_out_of(side: &Side, missing: &[&ChannelNeed], is: &str) -> Option<Problem> {
    let mut users: Vec<&str> =
        missing.iter().flat_map(|need| &need.users.quantities).map(String::as_str).collect();
    users.sort_unstable();
    users.dedup();
    let (list, kind) = (listed(missing), side.kind.key());
    let (are, their) =
        if missing.len() > 1 { ("are", "their positions are") } else { ("is", "its position is") };
    let says = format!("{list} of the {kind} {are} {is}; {their} left out of {}", users.join(", "));
    (!missing.is_empty()).then(|| warning("position-left-out", says, &side.span))
}

/// Units that the mapping states must be of the dimension of the channel.
fn units(map: &ChannelMap, need: &ChannelNeed, problems: &mut Problems) {
    let Ok(wanted) = Unit::parse(&need.unit) else { return };
    let stated = map.unit.iter().chain(&map.written_in).map(|unit| (&unit.value, &unit.span));
    for (unit, span) in
        stated.chain(map.offset.iter().map(|offset| (&offset.value.unit, &offset.span)))
    {
        if unit.dimension != wanted.dimension {
            let says = format!(
                "`{}` is {} in the protocol ({wanted}), and {unit} is {}",
                map.name.value,
                wanted.dimension.in_words(),
                unit.dimension.in_words()
            );
            let problem = error("unit-mismatch", says, span)
                .also(&map.name.span, wanted.dimension.in_words());
            problems.push(if is_gravity(&unit.text, &wanted) {
                problem.help("`g` is the gram; the unit of gravity is `gn`")
            } else {
                problem
            });
        }
    }
}

/// Whether the gram stands for the unit of gravity.
pub fn is_gravity(text: &str, wanted: &Unit) -> bool {
    text == "g" && Unit::parse("gn").is_ok_and(|gn| gn.dimension == wanted.dimension)
}

/// The unit in which a channel is written: as stated, else as the protocol has it.
pub fn target(map: &ChannelMap, kind: RecordKind, needs: Option<&Needs>) -> Option<Unit> {
    if let Some(unit) = &map.written_in {
        return Some(unit.value.clone());
    }
    unit_needed(&map.name.value, kind, needs)
}

pub fn unit_needed(name: &str, kind: RecordKind, needs: Option<&Needs>) -> Option<Unit> {
    let need = needs?
        .channels
        .iter()
        .find(|need| need.record == record_of(kind) && need.column == name)?;
    Unit::parse(&need.unit).ok()
}
