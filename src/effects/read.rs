//! Reads a catalogue of effects from YAML, and reports every fault with its place.

use std::sync::Arc;

use super::catalogue::{Action, Acts, Catalogue, Effect, Fit, Group, Parameter};
use super::operators::Operator;
use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::units::Unit;
use crate::yaml::{self, Node, Value};

const TOP: [&str; 7] = ["catalogue", "title", "extends", "groups", "units", "effects", "diagnosis"];
const EFFECT: [&str; 14] = [
    "title",
    "means",
    "acts on",
    "parameters",
    "operator",
    "signals",
    "channels",
    "together",
    "each",
    "fit",
    "candidate",
    "confinable",
    "settled by",
    "tolerance",
];
const PARAMETER: [&str; 9] =
    ["unit", "neutral", "default", "range", "trials", "means", "model", "simulators", "vanishes"];
/// Placeholder for a channel in the name of a parameter.
pub const CHANNEL: &str = "<channel>";

/// Finds the text of an extended catalogue.
pub type Find<'a> = &'a dyn Fn(&str, &Source) -> Result<Arc<Source>, Box<Problem>>;

/// Reads a catalogue. An extended catalogue is read first; effects of the same name replace its
/// effects.
///
/// `known` lists the parameters of the built-in model.
///
/// Problems: `yaml`, `unknown-key`, `key-missing`, `wrong-kind`, `unknown-unit`, `unit-mismatch`,
/// `range`, `unknown-operator`, `unknown-channel`, `unknown-parameter`, `extends-loop`; those of
/// expressions: `unit-missing`, `unknown-name`, `not-here`, `contradiction`.
pub fn read(
    source: &Arc<Source>,
    find: Find<'_>,
    known: &ModelParameters<'_>,
    problems: &mut Problems,
) -> Option<Catalogue> {
    read_below(source, find, known, problems, 0)
}

/// The parameters of the built-in model: names with units.
pub type ModelParameters<'a> = [(&'a str, &'a str)];

fn read_below(
    source: &Arc<Source>,
    find: Find<'_>,
    known: &ModelParameters<'_>,
    problems: &mut Problems,
    depth: usize,
) -> Option<Catalogue> {
    let before = problems.errors();
    let tree = yaml::load(source, problems)?;
    let mut reader = Reader { known, problems, groups: Vec::new(), units: Vec::new() };
    reader.keys(&tree, &TOP, "a catalogue");
    let mut base = None;
    if let Some(named) = reader.text(&tree, "extends") {
        if depth > 8 {
            reader.fault(
                "extends-loop",
                "catalogues extend each other in a circle",
                tree.get("extends"),
            );
        } else {
            match find(&named, source) {
                Ok(text) => base = read_below(&text, find, known, reader.problems, depth + 1),
                Err(problem) => {
                    let problem = *problem;
                    reader.problems.push(match tree.get("extends") {
                        Some(node) if problem.at.is_none() => problem.at(&node.span),
                        _ => problem,
                    });
                }
            }
        }
    }
    let mut catalogue = base.unwrap_or_else(|| Catalogue {
        name: String::new(),
        title: String::new(),
        source: Arc::clone(source),
        groups: Vec::new(),
        units: Vec::new(),
        effects: Vec::new(),
        diagnosis: None,
    });
    catalogue.source = Arc::clone(source);
    catalogue.name = reader.need_text(&tree, "catalogue").unwrap_or_default();
    catalogue.title = reader.text(&tree, "title").unwrap_or_default();
    for (key, node) in tree.get("groups").map_or(&[][..], Node::entries) {
        let channels = reader.list(node);
        catalogue.groups.retain(|group| group.name != key.text);
        catalogue.groups.push(Group { name: key.text.clone(), channels });
    }
    if let Some(node) = tree.get("diagnosis") {
        catalogue.diagnosis = Some(node.clone());
    }
    reader.groups.clone_from(&catalogue.groups);
    if let Some(node) = tree.get("units") {
        reader.units(node, &mut catalogue.units);
    }
    reader.units.clone_from(&catalogue.units);
    for (key, node) in tree.get("effects").map_or(&[][..], Node::entries) {
        let removed = node.scalar_text() == Some("remove");
        if removed && catalogue.effect(&key.text).is_none() {
            let known = catalogue.effects.iter().map(|effect| effect.name.as_str());
            let says = format!("there is no effect `{}` to remove", key.text);
            reader.problems.push(
                Problem::error("unknown-effect", says).at(&key.span).suggest(&key.text, known),
            );
        }
        catalogue.effects.retain(|effect| effect.name != key.text);
        if removed {
            continue;
        }
        if let Some(effect) = reader.effect(&key.text, key, node) {
            catalogue.effects.push(effect);
        }
    }
    (problems.errors() == before).then_some(catalogue)
}

pub(super) struct Reader<'a> {
    known: &'a ModelParameters<'a>,
    pub problems: &'a mut Problems,
    groups: Vec<Group>,
    pub units: Vec<(String, Unit)>,
}

impl Reader<'_> {
    pub fn fault(&mut self, code: &'static str, says: impl Into<String>, at: Option<&Node>) {
        let problem = Problem::error(code, says);
        self.problems.push(match at {
            Some(node) => problem.at(&node.span),
            None => problem,
        });
    }

    fn keys(&mut self, node: &Node, known: &[&str], what: &str) {
        if !matches!(node.value, Value::Map(_)) {
            return self.fault(
                "wrong-kind",
                format!("{what} must be a map of keys and values, not {}", node.kind_in_words()),
                Some(node),
            );
        }
        for (key, _) in node.entries() {
            if !known.contains(&key.text.as_str()) {
                let problem =
                    Problem::error("unknown-key", format!("{what} has no key `{}`", key.text))
                        .at(&key.span);
                self.problems.push(problem.suggest(&key.text, known.iter().copied()));
            }
        }
    }

    fn text(&mut self, node: &Node, key: &str) -> Option<String> {
        let found = node.get(key)?;
        if let Some(text) = found.scalar_text() {
            return Some(text.trim().to_string());
        }
        self.fault(
            "wrong-kind",
            format!("`{key}` must be text, not {}", found.kind_in_words()),
            Some(found),
        );
        None
    }

    fn need_text(&mut self, node: &Node, key: &str) -> Option<String> {
        if node.get(key).is_none() {
            self.problems.push(
                Problem::error("key-missing", format!("`{key}` is missing"))
                    .at(&node.span.part(0..0)),
            );
        }
        self.text(node, key)
    }

    fn flag(&mut self, node: &Node, key: &str, default: bool) -> bool {
        match node.get(key).map(|found| &found.value) {
            None => default,
            Some(Value::Bool(flag)) => *flag,
            Some(_) => {
                self.fault("wrong-kind", format!("`{key}` must be true or false"), node.get(key));
                default
            }
        }
    }

    /// A text or a list of texts.
    fn list(&mut self, node: &Node) -> Vec<String> {
        if let Some(text) = node.scalar_text() {
            return vec![text.to_string()];
        }
        let texts: Vec<String> =
            node.items().iter().filter_map(|item| Some(item.scalar_text()?.to_string())).collect();
        if !matches!(node.value, Value::List(_)) || texts.len() != node.items().len() {
            self.fault("wrong-kind", "expected a list of names", Some(node));
        }
        texts
    }

    fn number(&mut self, node: &Node, key: &str) -> Option<f64> {
        let found = node.get(key)?;
        if found.number().is_none() {
            self.fault(
                "wrong-kind",
                format!("`{key}` must be a number, not {}", found.kind_in_words()),
                Some(found),
            );
        }
        found.number()
    }

    fn numbers(&mut self, node: &Node, key: &str) -> Option<Vec<f64>> {
        let found = node.get(key)?;
        let numbers: Option<Vec<f64>> = found.items().iter().map(Node::number).collect();
        if numbers.is_none() || !matches!(found.value, Value::List(_)) {
            self.fault("wrong-kind", format!("`{key}` must be a list of numbers"), Some(found));
        }
        numbers
    }

    /// Groups and channels by name.
    pub fn channels(&mut self, node: &Node) -> Vec<String> {
        let mut channels = Vec::new();
        for name in self.list(node) {
            if let Some(group) = self.groups.iter().find(|group| group.name == name) {
                channels.extend(group.channels.iter().cloned());
            } else if self.groups.iter().any(|group| group.channels.contains(&name)) {
                channels.push(name);
            } else {
                let names: Vec<String> = self
                    .groups
                    .iter()
                    .flat_map(|group| [vec![group.name.clone()], group.channels.clone()].concat())
                    .collect();
                let problem = Problem::error(
                    "unknown-channel",
                    format!("`{name}` is neither a group nor a channel of a group"),
                )
                .at(&node.span);
                self.problems.push(problem.suggest(&name, names.iter().map(String::as_str)));
            }
        }
        channels
    }

    fn effect(&mut self, name: &str, key: &yaml::Key, node: &Node) -> Option<Effect> {
        self.keys(node, &EFFECT, "an effect");
        let acts = self.need_text(node, "acts on")?;
        let Some(acts) = Acts::ALL.into_iter().find(|known| known.in_words() == acts) else {
            let problem =
                Problem::error("unknown-word", format!("an effect does not act on `{acts}`"));
            let problem =
                node.get("acts on").map_or(problem.clone(), |node| problem.at(&node.span));
            self.problems.push(problem.suggest(&acts, Acts::ALL.map(Acts::in_words)));
            return None;
        };
        let mut parameters = Vec::new();
        let mut trials = Vec::new();
        for (key, node) in node.get("parameters").map_or(&[][..], Node::entries) {
            if let Some((parameter, tried)) = self.parameter(&key.text, node) {
                parameters.push(parameter);
                trials.push(tried);
            }
        }
        if parameters.is_empty() {
            // If all parameters are faulty, this is reported already.
            if node.get("parameters").is_some_and(|node| !node.entries().is_empty()) {
                return None;
            }
            self.problems.push(
                Problem::error("key-missing", format!("the effect `{name}` has no parameters"))
                    .at(&key.span),
            );
            return None;
        }
        let action = self.action(node, &parameters)?;
        let fits = self.fits(node, &parameters, &trials, &action);
        Some(Effect {
            name: name.to_string(),
            title: self.text(node, "title").unwrap_or_else(|| name.replace('_', " ")),
            means: self.text(node, "means").unwrap_or_default(),
            acts,
            parameters,
            fits,
            candidate: self.flag(node, "candidate", true),
            confinable: self.flag(node, "confinable", !matches!(action, Action::Signals(..))),
            action,
            settled_by: self.text(node, "settled by"),
            tolerance: self.text(node, "tolerance"),
            span: key.span.clone(),
        })
    }

    fn action(&mut self, node: &Node, parameters: &[Parameter]) -> Option<Action> {
        if let Some(signals) = node.get("signals") {
            return self.formulas(node, signals, parameters);
        }
        let Some(name) = self.text(node, "operator") else { return Some(Action::Simulator) };
        let Some(operator) = Operator::ALL.into_iter().find(|known| known.name() == name) else {
            let problem =
                Problem::error("unknown-operator", format!("there is no operator `{name}`"));
            let problem =
                node.get("operator").map_or(problem.clone(), |node| problem.at(&node.span));
            self.problems.push(problem.suggest(&name, Operator::ALL.map(Operator::name)));
            return None;
        };
        let channels = match node.get("channels") {
            Some(channels) => self.channels(channels),
            None => self.groups.iter().flat_map(|group| group.channels.clone()).collect(),
        };
        Some(Action::Signals(operator, channels))
    }

    /// Candidates of the diagnosis. `fit` lists the parameters that are varied together; otherwise
    /// each parameter with trials is varied by itself. `each` and `together` list the channels on
    /// which operators act.
    fn fits(
        &mut self,
        node: &Node,
        parameters: &[Parameter],
        trials: &[Vec<f64>],
        action: &Action,
    ) -> Vec<Fit> {
        let mut lists = Vec::new();
        if let Some(each) = node.get("each") {
            lists.extend(self.channels(each).into_iter().map(|channel| vec![channel]));
        }
        for item in node.get("together").map_or(&[][..], Node::items) {
            lists.push(self.channels(item));
        }
        if lists.is_empty() {
            lists.push(if let Action::Signals(_, channels) = action {
                channels.clone()
            } else {
                Vec::new()
            });
        }
        let axis = |at: usize| (at, trials[at].clone());
        let sets: Vec<Vec<usize>> = match node.get("fit") {
            None => (0..parameters.len())
                .filter(|at| !trials[*at].is_empty())
                .map(|at| vec![at])
                .collect(),
            Some(fit) => {
                let mut sets = Vec::new();
                for item in fit.items() {
                    let names = self.list(item);
                    let found: Vec<usize> = names
                        .iter()
                        .filter_map(|name| parameters.iter().position(|known| known.name == *name))
                        .collect();
                    if found.len() < names.len() || found.iter().any(|at| trials[*at].is_empty()) {
                        self.fault(
                            "unknown-parameter",
                            "`fit` must list parameters of this effect that have `trials`",
                            Some(item),
                        );
                    } else {
                        sets.push(found);
                    }
                }
                sets
            }
        };
        sets.into_iter()
            .map(|set| Fit { axes: set.into_iter().map(axis).collect(), channels: lists.clone() })
            .collect()
    }

    fn parameter(&mut self, name: &str, node: &Node) -> Option<(Parameter, Vec<f64>)> {
        self.keys(node, &PARAMETER, "a parameter");
        let unit = self.need_text(node, "unit")?;
        let unit = self.unit(&unit, node.get("unit")?)?;
        let range = self.numbers(node, "range").unwrap_or_default();
        let [low, high] = range[..] else {
            self.fault(
                "range",
                format!("`range` of `{name}` must be two numbers, the smallest and the largest plausible value"),
                Some(node),
            );
            return None;
        };
        if low > high {
            self.fault(
                "range",
                format!("the range of `{name}` is empty: {low} to {high}"),
                node.get("range"),
            );
            return None;
        }
        let mut trials = self.numbers(node, "trials").unwrap_or_default();
        trials.sort_by(f64::total_cmp);
        for trial in trials.iter().filter(|trial| **trial < low || **trial > high) {
            self.fault(
                "range",
                format!("the trial {trial} is outside the range {low} to {high} of `{name}`"),
                node.get("trials"),
            );
        }
        let neutral = match node.get("neutral") {
            None => None,
            Some(found) if found.scalar_text() == Some("vehicle") => None,
            Some(_) => self.number(node, "neutral"),
        };
        let default = self.number(node, "default").or(neutral).unwrap_or(low);
        let model = self.text(node, "model");
        let model = match model {
            Some(parameter) => Some(self.model(&parameter, &unit, node.get("model")?)?),
            None => None,
        };
        let mut simulators = Vec::new();
        for (simulator, target) in node.get("simulators").map_or(&[][..], Node::entries) {
            let (text, factor) = match &target.value {
                Value::Map(_) => (
                    self.need_text(target, "parameter")?,
                    self.number(target, "factor").unwrap_or(1.0),
                ),
                _ => (target.scalar_text().unwrap_or_default().to_string(), 1.0),
            };
            simulators.push((simulator.text.clone(), text, factor));
        }
        let meaning = self.text(node, "means").unwrap_or_default();
        let vanishes_high = self.text(node, "vanishes").as_deref() == Some("high");
        Some((
            Parameter {
                name: name.to_string(),
                unit,
                neutral,
                default,
                low,
                high,
                meaning,
                vanishes_high,
                model,
                simulators,
            },
            trials,
        ))
    }

    pub fn unit(&mut self, text: &str, node: &Node) -> Option<Unit> {
        Unit::parse(text)
            .map_err(|unknown| {
                let problem = Problem::error(
                    "unknown-unit",
                    format!("`{}` is not a known unit", unknown.word),
                )
                .at(&node.span);
                self.problems.push(match unknown.near {
                    Some(near) => problem.meant(near),
                    None => problem,
                });
            })
            .ok()
    }

    fn model(&mut self, parameter: &str, unit: &Unit, node: &Node) -> Option<(String, f64)> {
        let Some((_, wanted)) = self.known.iter().find(|(known, _)| *known == parameter) else {
            let problem = Problem::error(
                "unknown-parameter",
                format!("the model has no parameter `{parameter}`"),
            )
            .at(&node.span);
            self.problems
                .push(problem.suggest(parameter, self.known.iter().map(|(known, _)| *known)));
            return None;
        };
        let wanted = Unit::parse(wanted).ok()?;
        if wanted.dimension != unit.dimension {
            let says = format!(
                "`{parameter}` of the model is in {wanted}, which is another quantity than {unit}"
            );
            self.problems.push(Problem::error("unit-mismatch", says).at(&node.span));
            return None;
        }
        Some((parameter.to_string(), unit.factor / wanted.factor))
    }
}
