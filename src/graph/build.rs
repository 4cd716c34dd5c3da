//! Builds the graph from a plan. It cannot fail: every rule of a plan has an operation.

mod signals;

use std::sync::Arc;

use indexmap::IndexMap;

use super::{
    FindNodes, Graph, InputNode, Joint, Label, LimitNodes, Node, NodeId, Operation,
    PlausibilityNodes, PositionNodes, QuantityNodes, SignalNodes, ValueNodes,
};
use crate::check::{
    evaluate::{shape, words},
    plan::{
        Evaluation, Expr, Input, Key, Kind, Limit, OfSection, Plan, Plausibility, Position,
        Quantity, Report, Scope, Step, Taken, Test, Valued,
    },
};
use crate::source::Span;
use crate::units::Dimension;

pub fn from_plan(plan: &Plan) -> Graph {
    let mut builder = Builder {
        axis: plan.axis.unit.dimension,
        nodes: Vec::new(),
        known: IndexMap::new(),
        classes: IndexMap::new(),
    };
    let checks = plan
        .checks
        .iter()
        .map(|check| check.inputs.iter().map(|input| builder.input(input, None)).collect())
        .collect();
    let find = builder.find(plan);
    let plausibility = plan.plausibility.iter().map(|rule| builder.plausibility(rule)).collect();
    let quantities: Vec<QuantityNodes> = plan
        .quantities
        .iter()
        .enumerate()
        .map(|(index, quantity)| builder.quantity(plan, index, quantity))
        .collect();
    let mut verdicts = vec![None; plan.verdicts.len()];
    (0..plan.verdicts.len()).for_each(|at| builder.verdict(plan, &quantities, at, &mut verdicts));
    Graph {
        nodes: builder.nodes,
        quantities,
        checks,
        find,
        plausibility,
        verdicts: verdicts.into_iter().flatten().collect(),
    }
}

struct Builder {
    axis: Dimension,
    nodes: Vec<Node>,
    /// The nodes built so far, by operation and inputs as text.
    known: IndexMap<String, NodeId>,
    classes: IndexMap<String, usize>,
}

/// The own signal of a rule: filtered over the record, processed in the section.
#[derive(Clone, Copy)]
struct Own<'a> {
    filtered: NodeId,
    processed: NodeId,
    chain: &'a [Step],
}

impl Builder {
    /// The node with this operation and these inputs; a new one only if there is none yet.
    fn add(
        &mut self,
        operation: Operation,
        inputs: Vec<NodeId>,
        dimension: Dimension,
        from: &Span,
        label: impl Into<Label>,
        kind: String,
    ) -> NodeId {
        let label = label.into();
        let what = match &operation {
            Operation::Read { column } => format!("read {column} {kind}"),
            Operation::Constant(expr) => format!("constant {}", shape(expr)),
            Operation::Select(conditions) => {
                format!("select {}", conditions.iter().map(shape).collect::<Vec<_>>().join(";"))
            }
            // Each of these belongs to a single rule.
            Operation::Value(_)
            | Operation::Compare(_)
            | Operation::Estimate(_)
            | Operation::Report(_)
            | Operation::Limit(_) => {
                format!("{kind} {} {}", label.text, from.start)
            }
            _ => kind.clone(),
        };
        let key = format!("{what} {inputs:?}");
        if let Some(&node) = self.known.get(&key) {
            return node;
        }
        let mut of: Vec<usize> = inputs.iter().map(|&input| self.nodes[input].class).collect();
        if matches!(
            operation,
            Operation::Estimate(_)
                | Operation::Report(_)
                | Operation::Limit(_)
                | Operation::Verdict(_)
        ) {
            of.sort_unstable();
            of.dedup();
        }
        let class_key = format!("{kind} {of:?}");
        let next = self.classes.len();
        let class = *self.classes.entry(class_key).or_insert(next);
        let track =
            inputs.iter().any(|&input| self.nodes[input].track) || kind.starts_with("track ");
        self.nodes.push(Node {
            operation,
            inputs,
            dimension,
            track,
            from: from.clone(),
            label,
            class,
        });
        self.known.insert(key, self.nodes.len() - 1);
        self.nodes.len() - 1
    }

    fn own<'a>(&mut self, signal: &Expr, chain: &'a [Step], from: &Span) -> Own<'a> {
        let (filtered, processed) = self.processed(signal, chain, from);
        Own { filtered, processed, chain }
    }

    /// A value taken from a named signal, from the own signal, or from the own signal of both
    /// sides.
    fn input(&mut self, input: &Input, own: Option<Own<'_>>) -> InputNode {
        let own = match (&input.signal, own) {
            (Some(signal), _) if !matches!(input.taken, Taken::OfBoth(_)) => {
                let own = self.own(signal, &input.chain, &input.span);
                Own { processed: self.present(own.processed, signal), ..own }
            }
            (_, Some(own)) => own,
            // Not reached: the checker allows an input without signal only where there is an own
            // signal.
            (_, None) => {
                let nothing = self.add(
                    Operation::Cut,
                    Vec::new(),
                    Dimension::ONE,
                    &input.span,
                    String::new(),
                    "nothing".into(),
                );
                Own { filtered: nothing, processed: nothing, chain: &[] }
            }
        };
        let over = input.over.as_ref().map(|over| self.processed(over, own.chain, &input.span).1);
        let (node, joint) = match (input.taken, &input.signal) {
            (Taken::Compared(metric), _) => {
                let on_common_points =
                    metric.on_common_points(own.chain.iter().all(|step| step.kind.keeps_samples()));
                let node = if on_common_points { own.filtered } else { own.processed };
                (node, Some(Joint::Metric { metric, on_common_points, over }))
            }
            (Taken::OfBoth(reducer), Some(signal)) => {
                (own.filtered, Some(Joint::Samples { reducer, signal: Arc::new(signal.clone()) }))
            }
            (Taken::Reduced(reducer) | Taken::OfBoth(reducer), _) => {
                let axis = over.map_or(self.axis, |over| self.nodes[over].dimension);
                let dimension = reducer.gives(self.nodes[own.processed].dimension, axis);
                let kind = format!("reduce {}", reducer.in_words());
                let label = over.map_or(reducer.in_words(), |over| {
                    format!("{} over {}", reducer.in_words(), self.origin(over))
                });
                let of = std::iter::once(own.processed).chain(over).collect();
                (
                    self.add(Operation::Reduce(reducer), of, dimension, &input.span, label, kind),
                    None,
                )
            }
        };
        InputNode { node, side: input.side, siblings: input.siblings, joint }
    }

    fn find(&mut self, plan: &Plan) -> FindNodes {
        let Some(find) = &plan.sections.find else { return FindNodes::default() };
        let mut inputs = |of: &OfSection| {
            of.inputs.iter().map(|input| self.input(input, None)).collect::<Vec<InputNode>>()
        };
        FindNodes {
            data: find.data.iter().map(|datum| inputs(&datum.of)).collect(),
            conditions: find
                .conditions
                .iter()
                .map(|condition| inputs(&condition.require))
                .collect(),
            prefer: find.prefer.iter().flat_map(&mut inputs).collect(),
        }
    }

    fn plausibility(&mut self, rule: &Plausibility) -> PlausibilityNodes {
        let mut own: Vec<Option<Own<'_>>> = rule
            .signals
            .iter()
            .map(|(_, signal)| Some(self.own(signal, &rule.chain, &rule.span)))
            .collect();
        if own.is_empty() {
            own.push(None);
        }
        let position = |builder: &mut Self, own: Option<Own<'_>>| {
            let inputs = match &rule.test {
                Test::Require(requirement) => {
                    requirement.inputs.iter().map(|input| builder.input(input, own)).collect()
                }
                Test::Distinct(_) | Test::Exchanged(_) => Vec::new(),
            };
            PositionNodes { own: own.map(|own| own.processed), inputs }
        };
        PlausibilityNodes { positions: own.into_iter().map(|own| position(self, own)).collect() }
    }

    /// A verdict, after those that it uses. The checker has excluded verdicts that depend on
    /// themselves.
    fn verdict(
        &mut self,
        plan: &Plan,
        quantities: &[QuantityNodes],
        at: usize,
        nodes: &mut Vec<Option<NodeId>>,
    ) {
        if nodes[at].is_some() {
            return;
        }
        let verdict = &plan.verdicts[at];
        let others = verdict.decision.verdicts();
        others.iter().for_each(|&input| self.verdict(plan, quantities, input, nodes));
        let about = verdict.decision.quantities();
        let limits = about.iter().flat_map(|&at| quantities[at].limits.iter());
        let inputs = limits.map(|nodes| nodes.limit);
        let inputs = inputs.chain(others.into_iter().filter_map(|other| nodes[other])).collect();
        let (label, kind) = match &verdict.name {
            Some(name) => (format!("{name}: {}", verdict.criterion), format!("verdict {name}")),
            None => (verdict.criterion.clone(), "verdict".to_string()),
        };
        let operation = Operation::Verdict(Arc::new(verdict.decision.clone()));
        nodes[at] = Some(self.add(operation, inputs, Dimension::ONE, &verdict.span, label, kind));
    }

    fn quantity(&mut self, plan: &Plan, index: usize, quantity: &Quantity) -> QuantityNodes {
        let signals: Vec<SignalNodes> = (0..quantity.positions.len())
            .map(|number| self.position(index, quantity, number))
            .collect();
        let rows: Vec<NodeId> = signals.iter().map(|signal| signal.compare).collect();
        let limit = |limit: &Arc<Limit>| {
            let (title, name) = (&limit.estimate.title, &limit.estimate.name);
            let label = Label::of(&quantity.id, format!("{title}{}", of_rows(&limit.scope)));
            let kind = format!("estimate {index}");
            let estimate = Operation::Estimate(Arc::clone(limit));
            let others = limit.estimate.others().into_iter().chain(limit.bound.others());
            let rows = rows.iter().copied().chain(self.rows_of_others(plan, others)).collect();
            let estimate =
                self.add(estimate, rows, quantity.unit.dimension, &limit.span, label, kind);
            let label = Label::of(&quantity.id, format!("{name} {}", limit.words));
            let operation = Operation::Limit(Arc::clone(limit));
            let limit = self.add(
                operation,
                vec![estimate],
                Dimension::ONE,
                &limit.span,
                label,
                format!("limit {index}"),
            );
            LimitNodes { estimate, limit }
        };
        let limits = quantity.limits.iter().map(limit).collect();
        let report = |report: &Arc<Report>| {
            let others = self.rows_of_others(plan, report.estimate.others().into_iter());
            let what = format!("{}{}", report.estimate.title, of_rows(&report.scope));
            let label = Label::of(&quantity.id, what);
            let rows = rows.iter().copied().chain(others).collect();
            let operation = Operation::Report(Arc::clone(report));
            self.add(
                operation,
                rows,
                quantity.unit.dimension,
                &report.span,
                label,
                format!("report {index}"),
            )
        };
        let reports = quantity.reports.iter().map(report).collect();
        QuantityNodes { signals, limits, reports }
    }

    /// The rows of other quantities from which an estimate or a limit takes a number.
    fn rows_of_others(&mut self, plan: &Plan, others: impl Iterator<Item = usize>) -> Vec<NodeId> {
        let mut rows = Vec::new();
        for other in others {
            let Some(quantity) = plan.quantities.get(other) else { continue };
            rows.extend(
                (0..quantity.positions.len())
                    .map(|number| self.position(other, quantity, number).compare),
            );
        }
        rows
    }

    fn position(&mut self, index: usize, quantity: &Quantity, number: usize) -> SignalNodes {
        let Position { name, signal, .. } = &quantity.positions[number];
        let own = self.own(signal, &quantity.chain, &quantity.span);
        let Own { filtered, processed, .. } = own;
        let mut inputs = Vec::new();
        let (values, over, before) = match quantity.evaluation.as_ref() {
            Evaluation::Values { values, .. } => {
                let values: Vec<ValueNodes> = values
                    .iter()
                    .map(|value| self.value((index, number), quantity, value, own))
                    .collect();
                let before = values.iter().map(|value| value.node).collect();
                (values, None, before)
            }
            Evaluation::Metric { over, .. } => {
                let over = over
                    .get(number)
                    .map(|signal| self.processed(signal, &quantity.chain, &quantity.span).1);
                (Vec::new(), over, [processed].into_iter().chain(over).collect())
            }
            Evaluation::Combined { of, .. } => {
                inputs =
                    of.inputs[number].iter().map(|input| self.input(input, Some(own))).collect();
                let mut before: Vec<NodeId> = inputs.iter().flat_map(InputNode::nodes).collect();
                before.dedup();
                (Vec::new(), None, before)
            }
        };
        let what = quantity.words.comparison.clone();
        let text = format!("{} {name}: {what}", quantity.id);
        let label = Label { text, ..Label::of(&quantity.id, what) };
        let operation = Operation::Compare(Arc::clone(&quantity.evaluation));
        let compare = self.add(
            operation,
            before,
            quantity.unit.dimension,
            &quantity.span,
            label,
            format!("compare {index}"),
        );
        SignalNodes { processed, filtered, values, over, inputs, compare }
    }

    fn value(
        &mut self,
        (index, number): (usize, usize),
        quantity: &Quantity,
        value: &Valued,
        own: Own<'_>,
    ) -> ValueNodes {
        let inputs: Vec<InputNode> =
            value.inputs[number].iter().map(|input| self.input(input, Some(own))).collect();
        // A value that is one reduced signal needs no node of its own.
        if let (Kind::Input(0), [input]) = (&value.expr.kind, inputs.as_slice()) {
            return ValueNodes { node: input.node, inputs };
        }
        let of: Vec<NodeId> = inputs.iter().map(|input| input.node).collect();
        let what = words(&value.expr);
        let text = format!("{what} of {}", quantity.positions[number].name);
        let label = Label { text, subject: None, what };
        let operation = Operation::Value(Arc::new(value.expr.clone()));
        let kind = format!("value {index}");
        let node = self.add(operation, of, quantity.unit.dimension, &value.expr.span, label, kind);
        ValueNodes { node, inputs }
    }
}

/// The rows that an estimate uses, as text; empty for all rows.
fn of_rows(scope: &Scope) -> String {
    let mut words = String::new();
    if !scope.zones.is_empty() {
        words.push_str(&format!(
            ", zone{} {}",
            if scope.zones.len() == 1 { "" } else { "s" },
            scope.zones.join(", ")
        ));
    }
    for key in &scope.each {
        words.push_str(", each ");
        words.push_str(&match key {
            Key::Section => "section".to_string(),
            Key::Site => "site".into(),
            Key::Record => "record".into(),
            Key::Place(place) => place.replace('_', " "),
            Key::Column(index) => format!("column {index}"),
        });
    }
    if let Some((_, condition)) = &scope.condition {
        words.push_str(&format!(", where {condition}"));
    }
    words
}
