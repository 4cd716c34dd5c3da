//! What a run reads: columns of records and of the table of sections, vehicle data, and the rules
//! that need each of them.

mod parts;

use std::collections::{BTreeMap, BTreeSet};

use parts::{See, input, of_signals, quantity, report, signal};

use crate::check::plan::{
    Datum, DatumKind, Expr, Independent, InputSide, Kind, Plan, Quantity, Scalar, Side, Test,
};
use crate::data::campaign::POINT_KEY;
use crate::data::sites;
use crate::graph::{Graph, InputNode, NodeId, QuantityNodes};
use crate::run::reduce::wanted_of;
use crate::run::sections::units::STATE;
use crate::run::sections::wanted::columns as wanted_columns;
use crate::run::sections::{NOT_STATED, trimmed};
use crate::units::Unit;

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
}

impl Users {
    fn add(&mut self, user: &str, is_quantity: bool) {
        let list = if is_quantity { &mut self.quantities } else { &mut self.rules };
        if !list.iter().any(|known| known == user) {
            list.push(user.to_string());
        }
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
#[derive(Clone, Debug)]
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
    let mut sections = Vec::new();
    if !plan.sections.whole_records {
        sections.push(given("section", "Name of the section and of its records", None, "sections"));
        sections.push(given("start", "Start of the section", Some(&plan.axis.unit), "sections"));
        sections.push(given("end", "End of the section", Some(&plan.axis.unit), "sections"));
        let own =
            plan.columns.iter().zip(columns).filter(|(datum, _)| datum.kind != DatumKind::Campaign);
        sections.extend(own.map(|(datum, users)| datum_need(datum, users)));
        let others: Vec<DatumNeed> = of_every_table(plan)
            .into_iter()
            .filter(|need| sections.iter().all(|known| known.key != need.key))
            .collect();
        sections.extend(others);
    }
    let vehicle =
        plan.vehicle.iter().zip(vehicle).map(|(datum, users)| datum_need(datum, users)).collect();
    let found = plan.sections.find.as_ref().map(|find| {
        let is_found = |index: &usize| !crate::run::find::is_stated(plan, find, *index);
        (0..plan.columns.len())
            .filter(is_found)
            .map(|index| plan.columns[index].key.clone())
            .collect()
    });
    let channels = channels(plan, graph);
    Needs {
        channels,
        positions: positions(plan, graph),
        sections,
        vehicle,
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
        words: Vec::new(),
        range: None,
        default: None,
        required: true,
        users: Users { quantities: Vec::new(), rules: vec![rule.into()] },
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
    let Some(first) = plan.domains.first() else { return Vec::new() };
    let users = |index: usize| {
        let of = plan.domains.iter().filter(|domain| wanted_columns(domain).contains(&index));
        Users {
            quantities: Vec::new(),
            rules: of.map(|domain| format!("domain {}", domain.name)).collect(),
        }
    };
    let mut point = given(
        POINT_KEY,
        "Name of the point of wanted operation",
        None,
        &format!("domain {}", first.name),
    );
    point.users.rules =
        plan.domains.iter().map(|domain| format!("domain {}", domain.name)).collect();
    let read = plan.columns.iter().enumerate().map(|(index, datum)| (datum, users(index)));
    let read =
        read.filter(|(datum, users)| datum.kind != DatumKind::Campaign && !users.rules.is_empty());
    std::iter::once(point).chain(read.map(|(datum, users)| datum_need(datum, users))).collect()
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
    let default = default.or_else(|| datum.may_be_absent.then(|| NOT_STATED.to_string()));
    DatumNeed {
        key: datum.key.clone(),
        title: datum.title.clone(),
        unit: unit.map(|unit| unit.text.clone()),
        words,
        range,
        required: default.is_none(),
        default,
        users,
    }
}

fn positions(plan: &Plan, graph: &Graph) -> Vec<Positions> {
    let of = |(quantity, nodes): (&Quantity, &QuantityNodes)| Positions {
        records: Side::ALL
            .into_iter()
            .filter(|side| quantity.evaluation.reads(*side))
            .map(Side::in_words)
            .collect(),
        columns: nodes
            .signals
            .iter()
            .map(|signal| {
                let mut wanted = BTreeSet::new();
                wanted_of(quantity, signal, &mut wanted);
                graph
                    .columns_of(wanted)
                    .into_iter()
                    .filter(|(_, of_track)| !of_track)
                    .map(|(column, _)| column)
                    .collect()
            })
            .collect(),
    };
    plan.quantities.iter().zip(&graph.quantities).map(of).collect()
}

/// By record and column: whether a number depends on it, and its users. In the order of the records
/// and of the protocol.
type Read = BTreeMap<(usize, usize), (bool, Users)>;

fn channels(plan: &Plan, graph: &Graph) -> Vec<ChannelNeed> {
    let declared = declared(plan);
    let mut names: Vec<String> = Vec::new();
    let mut read = Read::new();
    let number = |names: &mut Vec<String>, column: &str| {
        names.iter().position(|known| known == column).unwrap_or_else(|| {
            names.push(column.to_string());
            names.len() - 1
        })
    };
    // Time and axis stand first; the track record needs no time.
    let axes: Vec<_> = plan.time.iter().chain([&plan.axis]).collect();
    let axes_at: Vec<usize> = axes.iter().map(|axis| number(&mut names, &axis.column)).collect();
    let sides = |reads: &dyn Fn(Side) -> bool| {
        (0..)
            .zip(Side::ALL)
            .filter(|(_, side)| reads(*side))
            .map(|(at, _)| at)
            .collect::<Vec<usize>>()
    };
    let all = sides(&|side| plan.reads(side));
    for &side in &all {
        axes_at.iter().for_each(|&at| {
            drop(read.insert(
                (side, at),
                (true, Users { quantities: Vec::new(), rules: vec!["records".into()] }),
            ))
        });
    }
    let mut add = |nodes: BTreeSet<NodeId>,
                   records: &[usize],
                   user: &str,
                   is_quantity: bool,
                   [required, of_track_too]: [bool; 2]| {
        for (column, of_track) in graph.columns_of(nodes) {
            let at = number(&mut names, &column);
            let of: &[usize] = if of_track { &[Side::ALL.len()] } else { records };
            for &record in of {
                let (is_required, users) = read.entry((record, at)).or_default();
                *is_required |= if of_track { of_track_too } else { required };
                users.add(user, is_quantity);
            }
        }
    };
    for (quantity, nodes) in plan.quantities.iter().zip(&graph.quantities) {
        let mut wanted = BTreeSet::new();
        nodes.signals.iter().for_each(|signal| wanted_of(quantity, signal, &mut wanted));
        add(
            wanted,
            &sides(&|side| quantity.evaluation.reads(side)),
            &quantity.id,
            true,
            [true, false],
        );
    }
    let nodes_of =
        |inputs: &[InputNode]| inputs.iter().flat_map(InputNode::nodes).collect::<BTreeSet<_>>();
    for (check, inputs) in plan.checks.iter().zip(&graph.checks) {
        add(nodes_of(inputs), &all, &format!("check {}", check.name), false, [true, false]);
    }
    for (rule, nodes) in plan.plausibility.iter().zip(&graph.plausibility) {
        let of = nodes
            .positions
            .iter()
            .flat_map(|position| position.own.into_iter().chain(nodes_of(&position.inputs)))
            .collect();
        add(of, &all, &format!("{PLAUSIBILITY}{}", rule.name), false, [false; 2]);
    }
    if plan.sections.find.is_some() {
        let own = sides(&|side| side == crate::run::find::own_side(plan));
        for inputs in
            graph.find.data.iter().chain(&graph.find.conditions).chain([&graph.find.prefer])
        {
            for input in inputs {
                let of = match input.side {
                    InputSide::Own => own.clone(),
                    InputSide::Measured => sides(&|side| side == Side::Measured),
                    InputSide::Simulated => sides(&|side| side == Side::Simulated),
                };
                add(BTreeSet::from([input.node]), &of, SEARCH, false, [true; 2]);
            }
        }
    }
    let track = Side::ALL.len();
    if read.keys().any(|(record, _)| *record == track) {
        let at = axes_at[axes_at.len() - 1];
        read.entry((track, at)).or_default().1.rules.insert(0, "records".into());
    }
    read.into_iter()
        .map(|((record, at), (required, users))| {
            let column = names[at].clone();
            let axis = axes
                .iter()
                .find(|axis| axis.column == column)
                .map(|axis| (None, axis.unit.text.clone()));
            let found = declared
                .get(&(column.clone(), record == track))
                .map(|(channel, unit)| (Some(channel.clone()), unit.text.clone()));
            let (channel, unit) = found.or(axis).unwrap_or_default();
            ChannelNeed {
                record: Side::ALL.get(record).map_or(TRACK, |side| side.in_words()),
                column,
                channel,
                unit,
                required,
                users,
            }
        })
        .collect()
}

/// Channel and unit of each column, with whether it is of the track record.
fn declared(plan: &Plan) -> BTreeMap<(String, bool), (String, Unit)> {
    struct Declared(BTreeMap<(String, bool), (String, Unit)>);
    impl See for Declared {
        fn expr(&mut self, _: &Expr) {}
        fn channel(&mut self, column: &str, channel: &str, unit: &Unit, track: bool) {
            self.0
                .entry((column.to_string(), track))
                .or_insert_with(|| (channel.to_string(), unit.clone()));
        }
    }
    let mut found = Declared(BTreeMap::new());
    rules(plan).iter().for_each(|(.., see)| see(&mut found));
    found.0
}

/// The users of each section datum and of each vehicle datum.
fn data_users(plan: &Plan) -> [Vec<Users>; 2] {
    #[derive(Default)]
    struct Data([BTreeSet<usize>; 2]);
    impl See for Data {
        fn expr(&mut self, expr: &Expr) {
            expr.visit(&mut |part| match part.kind {
                Kind::Column(index) => drop(self.0[0].insert(index)),
                Kind::Vehicle(index) => drop(self.0[1].insert(index)),
                _ => {}
            });
        }
        fn column(&mut self, index: usize) {
            self.0[0].insert(index);
        }
    }
    let mut users =
        [vec![Users::default(); plan.columns.len()], vec![Users::default(); plan.vehicle.len()]];
    for (name, is_quantity, see) in rules(plan) {
        let mut data = Data::default();
        see(&mut data);
        for (users, found) in users.iter_mut().zip(&data.0) {
            found.iter().for_each(|&index| users[index].add(&name, is_quantity));
        }
    }
    users
}

/// Shows the parts of a rule.
type Parts<'a> = Box<dyn Fn(&mut dyn See) + 'a>;

/// The rules, each with its name, whether it is a quantity, and its parts.
fn rules(plan: &Plan) -> Vec<(String, bool, Parts<'_>)> {
    let mut rules: Vec<(String, bool, Parts<'_>)> = Vec::new();
    for rule in &plan.quantities {
        rules.push((rule.id.clone(), true, Box::new(move |see| quantity(rule, see))));
    }
    let mut others: Vec<(String, Parts<'_>)> = Vec::new();
    others.push((
        "sections".into(),
        Box::new(|see| {
            plan.sections.zone.into_iter().for_each(|index| see.column(index));
            plan.sections.only.iter().for_each(|only| see.expr(only));
            plan.sections.reports.iter().for_each(|one| report(one, see));
        }),
    ));
    if let Some(find) = &plan.sections.find {
        for datum in &find.data {
            others.push((
                format!("found {}", plan.columns[datum.column].key),
                Box::new(|see| of_signals(&datum.of, see)),
            ));
        }
        for condition in &find.conditions {
            others.push((
                format!("find {}", condition.name),
                Box::new(|see| of_signals(&condition.require, see)),
            ));
        }
        let rest = |see: &mut dyn See| {
            find.length.iter().for_each(|length| see.expr(length));
            find.prefer.iter().for_each(|prefer| of_signals(prefer, see));
        };
        others.push(("find".into(), Box::new(rest)));
    }
    if let Some(keep) = &plan.sections.keep {
        others.push((
            "keep".into(),
            Box::new(|see| keep.each.iter().for_each(|&index| see.column(index))),
        ));
    }
    for zone in &plan.zones {
        let parts = move |see: &mut dyn See| {
            zone.condition.iter().chain(&zone.minimum_length).for_each(|part| see.expr(part))
        };
        others.push((format!("zone {}", zone.name), Box::new(parts)));
    }
    for check in &plan.checks {
        let parts = move |see: &mut dyn See| {
            std::iter::once(&check.require).chain(&check.unless).for_each(|part| see.expr(part));
            check.inputs.iter().for_each(|part| input(part, see));
        };
        others.push((format!("check {}", check.name), Box::new(parts)));
    }
    for rule in &plan.plausibility {
        let parts = move |see: &mut dyn See| {
            rule.signals.iter().for_each(|(_, part)| signal(part, see));
            rule.unless.iter().for_each(|part| see.expr(part));
            if let Test::Require(requirement) = &rule.test {
                see.expr(&requirement.holds);
                requirement.inputs.iter().for_each(|part| input(part, see));
            }
        };
        others.push((format!("plausibility {}", rule.name), Box::new(parts)));
    }
    for domain in &plan.domains {
        let parts = move |see: &mut dyn See| {
            domain.over.iter().for_each(|coordinate| see.expr(&coordinate.expr));
            domain.each.iter().for_each(|&index| see.column(index));
        };
        others.push((format!("domain {}", domain.name), Box::new(parts)));
    }
    if let Independent::Column(index) = plan.independent {
        others.push(("verdict".into(), Box::new(move |see| see.column(index))));
    }
    rules.extend(others.into_iter().map(|(name, parts)| (name, false, parts)));
    rules
}
