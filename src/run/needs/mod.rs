//! What a run reads: columns of records and of the table of sections, vehicle data, and the rules
//! that need each of them.

mod reads;

use std::collections::{BTreeMap, BTreeSet};

use indexmap::IndexSet;

use crate::data::{campaign::POINT_KEY, sites};
use crate::graph::QuantityNodes;
use crate::run::{
    prelude::*,
    reduce::wanted_of,
    sections::{NOT_STATED, trimmed, units::STATE, wanted::columns as wanted_columns},
};
use crate::units::Unit;
use reads::rules;

#[derive(Clone, Debug, Default)]
pub struct Needs {
    pub channels: Vec<ChannelNeed>,
    /// The positions of each quantity, by which it is known whether one without a channel can be
    /// left out.
    pub positions: Vec<Positions>,
    /// Columns of the table of sections; none where whole records are evaluated.
    pub sections: Vec<DatumNeed>,
    pub vehicle: Vec<DatumNeed>,
    /// Section data that are found in runs, by their columns; absent where the protocol does not
    /// look for sections.
    pub found: Option<Vec<String>>,
    /// Columns of the table of wanted operation; none where the protocol has no domain.
    pub application: Vec<DatumNeed>,
}

/// The positions of a quantity.
#[derive(Clone, Debug, Default)]
pub struct Positions {
    /// Whose records it reads: `simulated`, `measured`.
    pub records: Vec<&'static str>,
    /// The columns of each position.
    pub columns: Vec<Vec<String>>,
}

impl ChannelNeed {
    /// Whether a number depends on it only where sections are looked for in runs.
    pub fn of_search_alone(&self) -> bool {
        let others = self
            .users
            .rules
            .iter()
            .filter(|rule| *rule != SEARCH && !rule.starts_with(PLAUSIBILITY));
        self.users.quantities.is_empty() && others.count() == 0
    }
}

impl Needs {
    /// Whether nothing can be evaluated of an axis, a check or a quantity if columns are missing,
    /// of which the need is one. Otherwise only positions are left out.
    pub fn blocks(&self, need: &ChannelNeed, missing: &dyn Fn(&str, &str) -> bool) -> bool {
        let uses = |of: &Positions| {
            of.records.contains(&need.record)
                && of.columns.iter().any(|columns| columns.contains(&need.column))
        };
        let lacks = |of: &Positions, columns: &[String]| {
            columns.iter().any(|column| of.records.iter().any(|record| missing(record, column)))
        };
        need.users.rules.iter().any(|rule| !rule.starts_with(PLAUSIBILITY))
            || self
                .positions
                .iter()
                .any(|of| uses(of) && of.columns.iter().all(|columns| lacks(of, columns)))
    }
}

/// Beginning of the user that is a plausibility rule: it looks at a channel only where it was
/// recorded.
const PLAUSIBILITY: &str = "plausibility ";

/// The user that is the search for sections in runs.
pub const SEARCH: &str = "the search for sections";

/// Who needs something.
#[derive(Clone, Debug, Default)]
pub struct Users {
    pub quantities: Vec<String>,
    /// Other rules: `zone 1`, `check full_curve`.
    pub rules: Vec<String>,
    /// Whether sections are not assessable without it, though it may be absent.
    pub of_requirement: bool,
}

impl Users {
    fn add(&mut self, user: &str, is_quantity: bool) {
        let list = if is_quantity { &mut self.quantities } else { &mut self.rules };
        if !list.iter().any(|known| known == user) {
            list.push(user.to_string());
        }
    }

    fn join(&mut self, other: &Self) {
        other.quantities.iter().for_each(|user| self.add(user, true));
        other.rules.iter().for_each(|user| self.add(user, false));
        self.of_requirement |= other.of_requirement;
    }
}

/// A column of the records.
#[derive(Clone, Debug)]
pub struct ChannelNeed {
    /// `simulated`, `measured` or `track`.
    pub record: &'static str,
    pub column: String,
    /// The channel of the protocol; `None` for an axis that is no channel.
    pub channel: Option<String>,
    pub unit: String,
    /// Whether a number depends on it. Otherwise a rule looks at it only where it was recorded.
    pub required: bool,
    pub users: Users,
}

/// A column of the table of sections or of wanted operation, or a value of the vehicle file.
#[derive(Clone, Debug, Default)]
pub struct DatumNeed {
    pub key: String,
    pub title: String,
    /// The unit of a number.
    pub unit: Option<String>,
    /// The possible words.
    pub words: Vec<String>,
    pub range: Option<String>,
    pub default: Option<String>,
    pub required: bool,
    pub users: Users,
}

/// Name of the records of the track.
const TRACK: &str = "track";

pub fn needs(plan: &Plan, graph: &Graph) -> Needs {
    let [columns, vehicle] = data_users(plan);
    let of_data = |(datum, users): (&Datum, Users)| datum_need(datum, users);
    let mut sections = Vec::new();
    if !plan.sections.whole_records {
        sections.push(given("section", "Name of the section and of its records", None, "sections"));
        sections.push(given("start", "Start of the section", Some(&plan.axis.unit), "sections"));
        sections.push(given("end", "End of the section", Some(&plan.axis.unit), "sections"));
        let own = plan.columns.iter().zip(columns).filter(|(datum, _)| datum.is_stated());
        sections.extend(own.map(of_data));
        let mut others = of_every_table(plan);
        others.retain(|need| sections.iter().all(|known| known.key != need.key));
        sections.extend(others);
    }
    let found = plan.sections.find.as_ref().map(|find| {
        let columns = plan.columns.iter().enumerate();
        let found = columns.filter(|(index, _)| !crate::run::find::is_stated(plan, find, *index));
        found.map(|(_, datum)| datum.key.clone()).collect()
    });
    Needs {
        channels: channels(plan, graph),
        positions: positions(plan, graph),
        sections,
        vehicle: plan.vehicle.iter().zip(vehicle).map(of_data).collect(),
        found,
        application: application(plan),
    }
}

/// A column that the program itself reads.
fn given(key: &str, title: &str, unit: Option<&Unit>, rule: &str) -> DatumNeed {
    DatumNeed {
        key: key.into(),
        title: title.into(),
        unit: unit.map(|unit| unit.text.clone()),
        required: true,
        users: Users { rules: vec![rule.into()], ..Users::default() },
        ..DatumNeed::default()
    }
}

/// Columns that every table of sections may have: they say which sections are one site, and the
/// state of the vehicle.
fn of_every_table(plan: &Plan) -> Vec<DatumNeed> {
    let optional = |key: &str, title: &str, rule: &str| DatumNeed {
        required: false,
        default: Some(NOT_STATED.into()),
        ..given(key, title, None, rule)
    };
    let of_repeats = |quantity: &&Quantity| quantity.evaluation.of_repeats();
    let repeats: Vec<String> =
        plan.quantities.iter().filter(of_repeats).map(|quantity| quantity.id.clone()).collect();
    let mut repeat = optional(
        sites::REPEAT_OF,
        "Name of the section that was measured before, where this one repeats it",
        "independent site",
    );
    if !repeats.is_empty() {
        repeat.required = true;
        repeat.default = None;
        repeat.users.quantities = repeats;
    }
    vec![
        repeat,
        optional(sites::SITE, "The same text for all sections of one site", "independent site"),
        optional(
            sites::TRACK,
            "Name of the track; sections that overlap on it are one site",
            "independent site",
        ),
        optional(
            STATE,
            "State of the vehicle, where the campaign has a vehicle file for each state",
            "vehicle states",
        ),
    ]
}

/// Columns of the table of wanted operation, in the order of the protocol.
fn application(plan: &Plan) -> Vec<DatumNeed> {
    if plan.domains.is_empty() {
        return Vec::new();
    }
    let users = |reads: &dyn Fn(&Domain) -> bool| {
        let domains = plan.domains.iter().filter(|domain| reads(domain));
        let rules = domains.map(|domain| format!("domain {}", domain.name)).collect();
        Users { rules, ..Users::default() }
    };
    let point = given(POINT_KEY, "Name of the point of wanted operation", None, "");
    let mut needs = vec![DatumNeed { users: users(&|_| true), ..point }];
    for (index, datum) in plan.columns.iter().enumerate() {
        let users = users(&|domain| wanted_columns(plan, domain).contains(&index));
        if datum.is_stated() && !users.rules.is_empty() {
            needs.push(datum_need(datum, users));
        }
    }
    needs
}

fn datum_need(datum: &Datum, users: Users) -> DatumNeed {
    let unit = if let DatumKind::Number(unit) = &datum.kind { Some(unit) } else { None };
    let words = match &datum.kind {
        DatumKind::Words(words) => words.clone(),
        DatumKind::Flag => vec!["true".into(), "false".into()],
        _ => Vec::new(),
    };
    let default = datum.default.as_ref().map(|default| match default {
        Scalar::Number(value) => unit
            .map_or_else(|| trimmed(*value), |unit| trimmed(unit.from_si(*value)) + &unit.suffix()),
        Scalar::Word(word) => word.clone(),
        Scalar::Flag(flag) => flag.to_string(),
    });
    let range = datum.range.as_ref().map(|range| range.words.clone());
    let default = default.or_else(|| datum.optional.map(|_| NOT_STATED.to_string()));
    DatumNeed {
        key: datum.key.clone(),
        title: datum.title.clone(),
        unit: unit.map(|unit| unit.text.clone()),
        words,
        range,
        required: default.is_none()
            || (datum.optional == Some(Optional::NotAssessable) && users.of_requirement),
        default,
        users,
    }
}

fn positions(plan: &Plan, graph: &Graph) -> Vec<Positions> {
    let of = |(quantity, nodes): (&Quantity, &QuantityNodes)| {
        let columns = nodes.signals.iter().map(|signal| {
            let mut wanted = BTreeSet::new();
            wanted_of(quantity, signal, &mut wanted);
            let columns = graph.columns_of(wanted).into_iter().filter(|(_, of_track)| !of_track);
            columns.map(|(column, _)| column).collect()
        });
        let sides = Side::ALL.into_iter().filter(|side| quantity.evaluation.reads(*side));
        Positions { records: sides.map(Side::in_words).collect(), columns: columns.collect() }
    };
    plan.quantities.iter().zip(&graph.quantities).map(of).collect()
}

/// Number of the track record; the sides stand before it.
const TRACK_RECORD: usize = Side::ALL.len();

/// The numbers of some sides.
fn sides(reads: impl Fn(Side) -> bool) -> Vec<usize> {
    (0..TRACK_RECORD).filter(|&at| reads(Side::ALL[at])).collect()
}

/// The columns that are read, in the order of the records and of the protocol.
#[derive(Default)]
struct Columns {
    names: IndexSet<String>,
    /// By record and column: whether a number depends on it, and its users.
    read: BTreeMap<(usize, usize), (bool, Users)>,
}

impl Columns {
    /// Adds the columns of some nodes. `required`: whether numbers depend on those of a side, and
    /// on those of the track record.
    fn add(
        &mut self,
        graph: &Graph,
        nodes: BTreeSet<NodeId>,
        records: &[usize],
        (user, is_quantity): (&str, bool),
        required: [bool; 2],
    ) {
        for (column, of_track) in graph.columns_of(nodes) {
            let (at, _) = self.names.insert_full(column);
            for &record in if of_track { &[TRACK_RECORD][..] } else { records } {
                let (is_required, users) = self.read.entry((record, at)).or_default();
                *is_required |= required[usize::from(of_track)];
                users.add(user, is_quantity);
            }
        }
    }
}

fn channels(plan: &Plan, graph: &Graph) -> Vec<ChannelNeed> {
    let mut columns = Columns::default();
    // Time and axis stand first; the track record needs no time.
    let axes: Vec<&Axis> = plan.time.iter().chain([&plan.axis]).collect();
    columns.names.extend(axes.iter().map(|axis| axis.column.clone()));
    let (all, axis_at) = (sides(|side| plan.reads(side)), columns.names.len() - 1);
    let records = || Users { rules: vec!["records".into()], ..Users::default() };
    for &side in &all {
        columns.read.extend((0..=axis_at).map(|at| ((side, at), (true, records()))));
    }
    for (quantity, nodes) in plan.quantities.iter().zip(&graph.quantities) {
        let mut wanted = BTreeSet::new();
        nodes.signals.iter().for_each(|signal| wanted_of(quantity, signal, &mut wanted));
        let sides = sides(|side| quantity.evaluation.reads(side));
        columns.add(graph, wanted, &sides, (&quantity.id, true), [true, false]);
    }
    for (check, inputs) in plan.checks.iter().zip(&graph.checks) {
        let nodes = inputs.iter().flat_map(InputNode::nodes).collect();
        let user = format!("check {}", check.name);
        columns.add(graph, nodes, &all, (&user, false), [true, false]);
    }
    for (rule, nodes) in plan.plausibility.iter().zip(&graph.plausibility) {
        let nodes = nodes
            .positions
            .iter()
            .flat_map(|at| at.own.into_iter().chain(at.inputs.iter().flat_map(InputNode::nodes)));
        let user = format!("{PLAUSIBILITY}{}", rule.name);
        columns.add(graph, nodes.collect(), &all, (&user, false), [false; 2]);
    }
    if plan.sections.find.is_some() {
        let own = crate::run::find::own_side(plan);
        let find = &graph.find;
        for input in find.data.iter().chain(&find.conditions).flatten().chain(&find.prefer) {
            let of = match input.side {
                InputSide::Own => own,
                InputSide::Measured => Side::Measured,
                InputSide::Simulated => Side::Simulated,
            };
            let sides = sides(|side| side == of);
            columns.add(graph, [input.node].into(), &sides, (SEARCH, false), [true; 2]);
        }
    }
    if columns.read.keys().any(|(record, _)| *record == TRACK_RECORD) {
        let (_, users) = columns.read.entry((TRACK_RECORD, axis_at)).or_default();
        users.rules.insert(0, "records".into());
    }
    let declared = declared(plan);
    let channel = |((record, at), (required, users)): ((usize, usize), (bool, Users))| {
        let column = columns.names[at].clone();
        let found = declared.get(&(column.clone(), record == TRACK_RECORD));
        let axis = axes.iter().find(|axis| axis.column == column).map(|axis| &axis.unit);
        let unit = found.map(|(_, unit)| unit).or(axis);
        ChannelNeed {
            record: Side::ALL.get(record).map_or(TRACK, |side| side.in_words()),
            channel: found.map(|(channel, _)| channel.clone()),
            unit: unit.map_or_else(String::new, |unit| unit.text.clone()),
            required: required && !optional(plan, &column, record == TRACK_RECORD),
            column,
            users,
        }
    };
    columns.read.into_iter().map(channel).collect()
}

/// Whether records may lack a column.
fn optional(plan: &Plan, column: &str, track: bool) -> bool {
    let mut channels = plan.optional.iter().filter(|channel| channel.track == track);
    channels.any(|channel| channel.columns.iter().any(|known| known == column))
}

/// Channel and unit of each column, with whether it is of the track record.
fn declared(plan: &Plan) -> BTreeMap<(String, bool), (String, Unit)> {
    let mut found = BTreeMap::new();
    for expr in rules(plan).into_iter().flat_map(|(.., reads)| reads.exprs) {
        expr.visit(&mut |part| {
            if let Kind::Channel { column, channel, unit } = &part.kind {
                let key = (column.clone(), part.track());
                found.entry(key).or_insert_with(|| (channel.clone(), unit.clone()));
            }
        });
    }
    found
}

/// The users of each section datum and of each vehicle datum.
fn data_users(plan: &Plan) -> [Vec<Users>; 2] {
    let mut columns = vec![Users::default(); plan.columns.len()];
    let mut vehicle = vec![Users::default(); plan.vehicle.len()];
    for (name, is_quantity, reads) in rules(plan) {
        let of_requirement = plan.zones.iter().any(|zone| name == format!("zone {}", zone.name))
            || plan
                .checks
                .iter()
                .any(|rule| rule.required && name == format!("check {}", rule.name));
        let add = |users: &mut Users| {
            users.add(&name, is_quantity);
            users.of_requirement |= of_requirement;
        };
        reads.columns.iter().for_each(|&index| add(&mut columns[index]));
        for expr in reads.exprs {
            expr.visit(&mut |part| match part.kind {
                Kind::Column(index) => add(&mut columns[index]),
                Kind::Vehicle(index) => add(&mut vehicle[index]),
                _ => {}
            });
        }
    }
    // What needs a datum needs those that it is computed from.
    for datum in plan.sections.computed.iter().rev() {
        let of = columns[datum.column].clone();
        datum.of.expr.visit(&mut |part| match part.kind {
            Kind::Column(index) => columns[index].join(&of),
            Kind::Vehicle(index) => vehicle[index].join(&of),
            _ => {}
        });
    }
    [columns, vehicle]
}
