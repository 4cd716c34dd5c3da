//! Whole runs as sources: their names, what the campaign says of them, and what is done with a
//! drift of the distance.

use super::sections::{self, Sections};
use crate::data::RecordKind;
use crate::data::campaign::{OnDrift, RUNS};
use crate::problem::error;
use crate::source::{Span, Spanned};
use crate::yaml::{FromNode, Key, Metres, Node, Reader, Value, fields};

/// Largest change of the shift from one window to the next that is looked for, in m, where the
/// mapping states none.
const WITHIN: f64 = 20.0;
/// Length of a window in m, where the mapping states none: ten times the waves of the track that
/// both records have in common.
const WINDOW: f64 = 250.0;
/// Shortest window in largest shifts: a window must be longer than what it is moved by.
const SHORTEST: f64 = 2.0;

/// The key of what is done with a drift.
const DRIFT: &str = "drift";

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

fields! {
    /// A drift of which more is stated than what is done with it.
    struct Written: "`drift`" {
        "do" what: OnDrift => "what is done with the drift",
        "clock" clock: Option<OnDrift>,
        "within" within: Metres = Metres(WITHIN),
        "window" window: Option<Metres>,
    }
}

/// `runs: [R1, R2]`, or `runs: {R1: {country: DE}, R2: {country: CH}}`.
pub fn read(reader: &mut Reader<'_>, tree: &Node) -> Option<(Runs, Sections)> {
    const EXAMPLE: &str =
        "write `runs: [R1, R2]`, or with what holds for each run `runs: {R1: {country: DE}}`";
    let before = reader.problems.errors();
    let (key, node) = tree.entry(RUNS)?;
    type Facts = Vec<(Key, Node)>;
    let (names, facts): (Vec<Spanned<String>>, Vec<Facts>) = match &node.value {
        Value::List(items) if !items.is_empty() => {
            let names: Vec<Spanned<String>> = Vec::from_node(reader, key, node)?;
            names.into_iter().map(|name| (name, Vec::new())).unzip()
        }
        Value::Map(entries) if !entries.is_empty() => entries
            .iter()
            .map(|(key, run)| {
                let name = Spanned::new(key.text.trim().to_string(), key.span.clone());
                (name, facts_of_run(reader, &key.text, run))
            })
            .unzip(),
        _ => {
            let be = "a list of names, or a map of names and facts";
            reader.tell(node.is_not(&format!("`{RUNS}`"), be).help(EXAMPLE));
            Default::default()
        }
    };
    sections::check_names(reader.problems, &names, "run");
    if let Some(margin) = tree.get("margin") {
        let says = "`margin` cuts the record of a section; a run is kept as a whole";
        reader.fault("contradiction", says, &margin.span);
    }
    let table = reader.optional(tree, "sections");
    let sections = Sections { table: None, names, span: node.span.clone(), word: "run" };
    (reader.problems.errors() == before).then_some((Runs { facts, table }, sections))
}

fn facts_of_run(reader: &mut Reader<'_>, name: &str, node: &Node) -> Vec<(Key, Node)> {
    if !matches!(node.value, Value::Map(_) | Value::Null) {
        let problem = node.is_not(&format!("the run `{name}`"), "a map of what holds for it");
        reader.tell(problem.help("for instance: `{country: DE, line: north}`"));
    }
    for (key, value) in node.entries() {
        if RecordKind::ALL.iter().any(|kind| kind.key() == key.text) {
            let says = format!("`{}` of a run is written by the import", key.text);
            let problem = error("unknown-key", says, &key.span);
            reader.tell(
                problem.help("the path of its file stands in `files` of the side, with `{run}`"),
            );
        } else if key.text == DRIFT {
            OnDrift::from_node(reader, key, value);
        } else if value.scalar_text().is_none() {
            let problem = value.is_not(&format!("`{}` of a run", key.text), "a single value");
            reader.tell(problem);
        }
    }
    node.entries().to_vec()
}

/// `drift: correct`, `drift: tell`, or `drift: {do: correct, clock: correct, within: 20 m, window:
/// 250 m}`.
impl FromNode<&Sections> for Drift {
    fn from_node(reader: &mut Reader<'_, &Sections>, key: &Key, node: &Node) -> Option<Self> {
        let before = reader.problems.errors();
        let Written { what, clock, within: Metres(within), window } = match &node.value {
            Value::Map(_) => Written::from_node(reader, key, node)?,
            _ => {
                let what = OnDrift::from_node(reader, key, node)?;
                Written { what, clock: None, within: Metres(WITHIN), window: None }
            }
        };
        let window = window.map_or_else(|| WINDOW.max(SHORTEST * within), |window| window.0);
        if within <= 0.0 {
            let says = "`within` must be above zero";
            reader.fault("out-of-range", says, node.span_of("within"));
        } else if window < SHORTEST * within {
            let says =
                format!("a window of {window} m is too short for a shift of up to {within} m");
            let problem = error("out-of-range", says, node.span_of("window"));
            reader.tell(problem.help(format!("at least {} m are needed", SHORTEST * within)));
        }
        if reader.with.word != "run" && !reader.with.names.is_empty() {
            let says = "a drift is looked for along runs, and this mapping imports sections";
            let problem = error("contradiction", says, &key.span);
            reader.tell(
                problem.help("name the runs in `runs`; the shift of single sections is `offsets`"),
            );
        }
        (reader.problems.errors() == before).then(|| Self {
            correct: what == OnDrift::Correct,
            correct_clock: clock == Some(OnDrift::Correct),
            within,
            window,
            span: key.span.clone(),
        })
    }
}
