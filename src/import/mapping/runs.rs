//! Whole runs as sources: their names, what the campaign says of them, and what is done with a
//! drift of the distance.

use super::reader::{Reader, metre};
use super::sections::{self, Sections};
use super::stated::place;
use crate::data::campaign::{CORRECT, RUNS, TELL};
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::yaml::{Key, Node, Value};

/// Largest change of the shift from one window to the next that is looked for, in m, where the
/// mapping states none.
const WITHIN: f64 = 20.0;
/// Length of a window in m, where the mapping states none: ten times the waves of the track that
/// both records have in common.
const WINDOW: f64 = 250.0;
/// Shortest window in largest shifts: a window must be longer than what it is moved by.
const SHORTEST: f64 = 2.0;

const DRIFT: &str = "drift";
const CLOCK: &str = "clock";
const KEYS: [&str; 4] = ["do", CLOCK, "within", "window"];

/// The runs of a mapping.
#[derive(Clone, Debug)]
pub struct Runs {
    /// Facts of each run for `campaign.yaml`, in the order of the names.
    pub facts: Vec<Vec<(Key, Node)>>,
    /// The table of sections that are cut from the runs, by its path as written.
    pub table: Option<Spanned<String>>,
}

/// What is done with a drift of the measured distance against the simulated one.
#[derive(Clone, Debug)]
pub struct Drift {
    pub correct: bool,
    /// Whether the time is corrected as well.
    pub correct_clock: bool,
    /// In m.
    pub within: f64,
    pub window: f64,
    pub span: Span,
}

/// `runs: [R1, R2]`, or `runs: {R1: {country: DE}, R2: {country: CH}}`.
pub(super) fn read(reader: &mut Reader<'_>, tree: &Node, node: &Node) -> Option<(Runs, Sections)> {
    const EXAMPLE: &str =
        "write `runs: [R1, R2]`, or with what holds for each run `runs: {R1: {country: DE}}`";
    let before = reader.problems.errors();
    let mut facts = Vec::new();
    let mut names = Vec::new();
    match &node.value {
        Value::List(items) if !items.is_empty() => {
            names = items.iter().filter_map(|item| reader.text_of(item, RUNS)).collect();
            facts = vec![Vec::new(); names.len()];
        }
        Value::Map(entries) if !entries.is_empty() => {
            for (key, of_run) in entries {
                names.push(Spanned::new(key.text.trim().to_string(), key.span.clone()));
                facts.push(of_one(reader, &key.text, of_run));
            }
        }
        _ => {
            let says = format!(
                "`{RUNS}` must be a list of names, or a map of names and facts; this is {}",
                node.kind_in_words()
            );
            reader.problems.push(Problem::error("wrong-kind", says).at(&node.span).help(EXAMPLE));
        }
    }
    for (number, name) in names.iter().enumerate() {
        if let Some(first) = names[..number].iter().find(|first| first.value == name.value) {
            let problem =
                Problem::error("duplicate-name", format!("two runs are called `{}`", name.value))
                    .at(&name.span);
            reader.problems.push(problem.also(&first.span, "the first of them"));
        }
    }
    sections::check(reader.problems, &names);
    if let Some(margin) = tree.get("margin") {
        reader.fault(
            "contradiction",
            "`margin` cuts the record of a section; a run is kept as a whole",
            &margin.span,
        );
    }
    let table = reader.text(tree, "sections");
    let runs = Runs { facts, table };
    (reader.problems.errors() == before)
        .then(|| (runs, Sections { table: None, names, span: node.span.clone(), word: "run" }))
}

fn of_one(reader: &mut Reader<'_>, name: &str, node: &Node) -> Vec<(Key, Node)> {
    if matches!(node.value, Value::Null) {
        return Vec::new();
    }
    if !matches!(node.value, Value::Map(_)) {
        let says = format!(
            "the run `{name}` must be a map of what holds for it, not {}",
            node.kind_in_words()
        );
        reader.problems.push(
            Problem::error("wrong-kind", says)
                .at(&node.span)
                .help("for instance: `{country: DE, line: north}`"),
        );
        return Vec::new();
    }
    for (key, value) in node.entries() {
        if ["measurement", "simulation", "track"].contains(&key.text.as_str()) {
            let problem = Problem::error(
                "unknown-key",
                format!("`{}` of a run is written by the import", key.text),
            )
            .at(&key.span);
            reader.problems.push(
                problem.help("the path of its file stands in `files` of the side, with `{run}`"),
            );
        } else if key.text == DRIFT && ![CORRECT, TELL].contains(&value.raw.as_str()) {
            let problem =
                Problem::error("unknown-choice", format!("`{DRIFT}` cannot be `{}`", value.raw))
                    .at(&value.span);
            reader.problems.push(problem.suggest(&value.raw, [CORRECT, TELL]));
        } else if value.scalar_text().is_none() {
            let says = format!(
                "`{}` of a run must be a single value; this is {}",
                key.text,
                value.kind_in_words()
            );
            reader.fault("wrong-kind", says, &value.span);
        }
    }
    node.entries().to_vec()
}

/// `drift: correct`, `drift: tell`, or `drift: {do: correct, clock: correct, within: 20 m, window:
/// 250 m}`.
pub(super) fn drift(reader: &mut Reader<'_>, side: &Node, sections: &Sections) -> Option<Drift> {
    let (key, node) = side.entry(DRIFT)?;
    let before = reader.problems.errors();
    let what = match &node.value {
        Value::Map(_) => {
            reader.keys(node, &KEYS, "`drift`");
            reader.need_text(node, "do", "what is done with the drift")?
        }
        _ => reader.text_of(node, DRIFT)?,
    };
    let clock = reader.text(node, CLOCK);
    for (key, what) in
        std::iter::once((DRIFT, &what)).chain(clock.as_ref().map(|clock| (CLOCK, clock)))
    {
        if ![CORRECT, TELL].contains(&what.value.as_str()) {
            let problem =
                Problem::error("unknown-choice", format!("`{key}` cannot be `{}`", what.value))
                    .at(&what.span);
            reader.problems.push(problem.suggest(&what.value, [CORRECT, TELL]));
        }
    }
    let within = reader.number(node, "within", &metre()).unwrap_or(WITHIN);
    let window =
        reader.number(node, "window", &metre()).unwrap_or_else(|| WINDOW.max(SHORTEST * within));
    if within <= 0.0 {
        reader.fault(
            "out-of-range",
            "`within` must be above zero",
            &place(node.get("within"), &node.span),
        );
    } else if window < SHORTEST * within {
        let says = format!("a window of {window} m is too short for a shift of up to {within} m");
        let problem =
            Problem::error("out-of-range", says).at(&place(node.get("window"), &node.span));
        reader.problems.push(problem.help(format!("at least {} m are needed", SHORTEST * within)));
    }
    if sections.word != "run" && !sections.names.is_empty() {
        let problem = Problem::error(
            "contradiction",
            "a drift is looked for along runs, and this mapping imports sections",
        )
        .at(&key.span);
        reader.problems.push(
            problem.help("name the runs in `runs`; the shift of single sections is `offsets`"),
        );
    }
    let correct_clock = clock.is_some_and(|clock| clock.value == CORRECT);
    (reader.problems.errors() == before).then(|| Drift {
        correct: what.value == CORRECT,
        correct_clock,
        within,
        window,
        span: key.span.clone(),
    })
}
