//! Builds the graph from a plan. It cannot fail: every rule of a plan has an operation.

use indexmap::IndexMap;

use std::sync::Arc;

use super::{
    FindNodes, Graph, InputNode, Joint, Label, LimitNodes, Node, NodeId, Operation,
    PlausibilityNodes, PositionNodes, QuantityNodes, SignalNodes, ValueNodes,
};
use crate::check::evaluate::{shape, words};
use crate::check::plan::{
    AxisOperation, Decision, Evaluation, Expr, Input, Key, Kind, Limit, OfSignals, Operator, Plan,
    Plausibility, Position, Quantity, Report, Scope, Step, StepSpec, Taken, Test, Valued,
};
use crate::source::Span;
use crate::units::Dimension;

pub fn from_plan(plan: &Plan) -> Graph {
    let mut builder = Builder { axis: plan.axis.unit.dimension, ..Builder::default() };
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

impl Default for Builder {
    fn default() -> Self {
        Self {
            axis: Dimension::LENGTH,
            nodes: Vec::new(),
            known: IndexMap::new(),
            classes: IndexMap::new(),
        }
    }
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

    /// The node of a signal, or of a number that is constant along the record.
    fn signal(&mut self, signal: &Expr) -> NodeId {
        let (dimension, from) = (signal.dimension(), &signal.span);
        match &signal.kind {
            Kind::Channel { column, channel, .. } => {
                let record = if signal.track() { "track" } else { "record" };
                self.add(
                    Operation::Read { column: column.clone() },
                    Vec::new(),
                    dimension,
                    from,
                    column.clone(),
                    format!("{record} {channel}"),
                )
            }
            Kind::Binary(operator, left, right) => {
                let inputs = vec![self.signal(left), self.signal(right)];
                let label = self.arithmetic_label(*operator, inputs[0], inputs[1]);
                self.add(
                    Operation::Arithmetic(*operator),
                    inputs,
                    dimension,
                    from,
                    label,
                    format!("{operator:?}"),
                )
            }
            Kind::Negative(inner) => {
                let inner = self.signal(inner);
                let label = format!("-{}", self.grouped(inner));
                self.add(
                    Operation::Negative,
                    vec![inner],
                    dimension,
                    from,
                    label,
                    "negative".into(),
                )
            }
            Kind::Power(inner, exponent) => {
                let inner = self.signal(inner);
                let label = format!("{}^{exponent}", self.grouped(inner));
                self.add(
                    Operation::Power(*exponent),
                    vec![inner],
                    dimension,
                    from,
                    label,
                    format!("power {exponent}"),
                )
            }
            Kind::Call(function, arguments) => {
                let inputs: Vec<NodeId> =
                    arguments.iter().map(|argument| self.signal(argument)).collect();
                let label = format!("{}({})", function.name, self.joined(&inputs, ", "));
                self.add(
                    Operation::Apply(function),
                    inputs,
                    dimension,
                    from,
                    label,
                    format!("apply {}", function.name),
                )
            }
            Kind::Filtered(inner, steps) => {
                let inner = self.signal(inner);
                steps.iter().fold(inner, |node, step| self.step(node, step))
            }
            Kind::OverAxis(operation, inner) => self.over_axis(operation, inner, signal),
            Kind::Level(reducer, inner) => {
                let (_, cut) = self.processed(inner, &[], from);
                let label = format!("{} of {}", reducer.in_words(), self.origin(cut));
                let kind = format!("reduce {}", reducer.in_words());
                let number = self.add(
                    Operation::Reduce(*reducer),
                    vec![cut],
                    dimension,
                    from,
                    reducer.in_words(),
                    kind,
                );
                self.add(Operation::Level, vec![number], dimension, from, label, "level".into())
            }
            Kind::Cases(arms, otherwise) => {
                let mut inputs: Vec<NodeId> =
                    arms.iter().map(|(signal, _)| self.signal(signal)).collect();
                if let Some(otherwise) = otherwise {
                    inputs.push(self.signal(otherwise));
                }
                let conditions: Vec<Expr> =
                    arms.iter().map(|(_, condition)| condition.clone()).collect();
                let kind = format!(
                    "select {}",
                    conditions.iter().map(shape).collect::<Vec<_>>().join(";")
                );
                let label = format!("one of {}", self.joined(&inputs, ", "));
                self.add(Operation::Select(conditions), inputs, dimension, from, label, kind)
            }
            // The checker allows sides only in values taken from both sides, which have no node.
            _ => {
                let kind = format!("constant {}", shape(signal));
                let operation = Operation::Constant(signal.clone());
                self.add(operation, Vec::new(), dimension, from, words(signal), kind)
            }
        }
    }

    fn over_axis(&mut self, operation: &AxisOperation, inner: &Expr, signal: &Expr) -> NodeId {
        let inner = self.signal(inner);
        let of_time = |over_time: bool| if over_time { ", time" } else { "" };
        let (name, more, kind) = match operation {
            AxisOperation::Shifted(distance) => {
                ("shifted", format!(", {}", words(distance)), shape(distance))
            }
            AxisOperation::Derivative { over_time } => {
                ("derivative", of_time(*over_time).to_string(), over_time.to_string())
            }
            AxisOperation::Integral { over_time } => {
                ("integral", of_time(*over_time).to_string(), over_time.to_string())
            }
        };
        let label = format!("{name}({}{more})", self.named(inner));
        let operation = Operation::OverAxis(operation.clone());
        self.add(
            operation,
            vec![inner],
            signal.dimension(),
            &signal.span,
            label,
            format!("{name} {kind}"),
        )
    }

    fn joined(&self, nodes: &[NodeId], between: &str) -> String {
        nodes.iter().map(|&node| self.named(node)).collect::<Vec<_>>().join(between)
    }

    /// Name of a signal inside an expression; a filtered signal is named after its input.
    fn named(&self, node: NodeId) -> String {
        match (&self.nodes[node].operation, self.nodes[node].inputs.first()) {
            (Operation::Step(_), Some(&input)) => format!("{} filtered", self.grouped(input)),
            _ => self.nodes[node].label.text.clone(),
        }
    }

    /// The name, in parentheses where it has several parts.
    fn grouped(&self, node: NodeId) -> String {
        match self.nodes[node].operation {
            Operation::Arithmetic(_) | Operation::Negative | Operation::Power(_) => {
                format!("({})", self.named(node))
            }
            _ => self.named(node),
        }
    }

    fn arithmetic_label(&self, operator: Operator, left: NodeId, right: NodeId) -> String {
        let is_sum = |node: NodeId| {
            matches!(
                self.nodes[node].operation,
                Operation::Arithmetic(Operator::Add | Operator::Subtract)
            )
        };
        let product = matches!(operator, Operator::Multiply | Operator::Divide);
        let left = if product && is_sum(left) { self.grouped(left) } else { self.named(left) };
        let is_part =
            matches!(self.nodes[right].operation, Operation::Arithmetic(_) | Operation::Negative);
        let right = if is_part && (product || is_sum(right)) {
            self.grouped(right)
        } else {
            self.named(right)
        };
        format!("{left}{}{right}", symbol(operator))
    }

    fn step(&mut self, node: NodeId, step: &Step) -> NodeId {
        let dimension = self.nodes[node].dimension * step.factor;
        let kind = format!("step {:?} {}", step.kind, step.factor);
        self.add(
            Operation::Step(step.kind.clone()),
            vec![node],
            dimension,
            &step.span,
            step.words.clone(),
            kind,
        )
    }

    /// The filtered signal of the record and the processed signal of the section.
    fn processed(&mut self, signal: &Expr, chain: &[Step], from: &Span) -> (NodeId, NodeId) {
        let mut node = self.signal(signal);
        let inside = chain
            .iter()
            .position(|step| matches!(step.kind, StepSpec::Window { .. } | StepSpec::RemoveMean))
            .unwrap_or(chain.len());
        for step in &chain[..inside] {
            node = self.step(node, step);
        }
        let filtered = node;
        // A window takes samples up to the ends of the section itself; all other steps work on the
        // samples cut out.
        if !matches!(chain.get(inside).map(|step| &step.kind), Some(StepSpec::Window { .. })) {
            let dimension = self.nodes[node].dimension;
            node = self.add(
                Operation::Cut,
                vec![node],
                dimension,
                from,
                "samples of the section".to_owned(),
                "cut".into(),
            );
        }
        for step in &chain[inside..] {
            let dimension = self.nodes[node].dimension;
            let kind = format!("window {:?}", step.kind);
            node = self.add(
                Operation::Window(step.kind.clone()),
                vec![node],
                dimension,
                &step.span,
                step.words.clone(),
                kind,
            );
        }
        (filtered, node)
    }

    /// A value taken from a named signal, from the own signal, or from the own signal of both
    /// sides.
    fn input(&mut self, input: &Input, own: Option<Own<'_>>) -> InputNode {
        let own = match (&input.signal, own) {
            (Some(signal), _) if !matches!(input.taken, Taken::OfBoth(_)) => {
                let (filtered, processed) = self.processed(signal, &input.chain, &input.span);
                Own { filtered, processed, chain: &input.chain }
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
        InputNode { node, side: input.side, joint }
    }

    fn find(&mut self, plan: &Plan) -> FindNodes {
        let Some(find) = &plan.sections.find else { return FindNodes::default() };
        let mut inputs = |of: &OfSignals| {
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

    /// The label of the signal that a processed signal was made from.
    fn origin(&self, mut node: NodeId) -> String {
        while let (Operation::Cut | Operation::Window(_) | Operation::Step(_), Some(&input)) =
            (&self.nodes[node].operation, self.nodes[node].inputs.first())
        {
            node = input;
        }
        self.named(node)
    }

    fn plausibility(&mut self, rule: &Plausibility) -> PlausibilityNodes {
        let own: Vec<Option<Own<'_>>> = if rule.signals.is_empty() {
            vec![None]
        } else {
            let own = |(_, signal): &(String, Expr)| {
                let (filtered, processed) = self.processed(signal, &rule.chain, &rule.span);
                Some(Own { filtered, processed, chain: &rule.chain })
            };
            rule.signals.iter().map(own).collect()
        };
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
        let inputs = match &verdict.decision {
            Decision::Limits { quantities: about, .. } => about
                .iter()
                .flat_map(|&at| quantities[at].limits.iter().map(|nodes| nodes.limit))
                .collect(),
            Decision::Verdicts(over) => {
                let inputs = over.verdicts();
                inputs.iter().for_each(|&input| self.verdict(plan, quantities, input, nodes));
                inputs.into_iter().filter_map(|input| nodes[input]).collect()
            }
            Decision::Person(_) => Vec::new(),
        };
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
        let (filtered, processed) = self.processed(signal, &quantity.chain, &quantity.span);
        let own = Own { filtered, processed, chain: &quantity.chain };
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

fn symbol(operator: Operator) -> &'static str {
    match operator {
        Operator::Add => " + ",
        Operator::Subtract => " - ",
        Operator::Multiply => " * ",
        _ => " / ",
    }
}
