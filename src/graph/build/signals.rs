//! The nodes of signals: from columns of the records to the samples of a section.

use super::{
    super::{NodeId, Operation},
    Builder,
};
use crate::check::{
    evaluate::{shape, words},
    plan::{AxisOperation, Expr, Kind, Mapping, Operator, Points, Scalar, Step, StepSpec, Type},
};
use crate::source::Span;

impl Builder {
    /// The node of a signal, or of a number that is constant along the record.
    pub(super) fn signal(&mut self, signal: &Expr) -> NodeId {
        let (dimension, from) = (signal.dimension(), &signal.span);
        match &signal.kind {
            _ if signal.ty == Type::Flag => self.constant(signal),
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
            Kind::Mapped(inner, mapping) => {
                let inner = self.signal(inner);
                let label = match mapping {
                    Mapping::Power(exponent) => format!("{}^{exponent}", self.grouped(inner)),
                    Mapping::Table(_) => format!("table {}", self.grouped(inner)),
                };
                self.add(
                    Operation::Mapped(mapping.clone()),
                    vec![inner],
                    dimension,
                    from,
                    label,
                    format!("map {mapping}"),
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
            Kind::OfSection(operation, inner) => {
                let (_, input) = self.processed(inner, &[], from);
                let kind = format!("{operation:?}");
                let operation = Operation::OfSection(operation.clone());
                self.add(operation, vec![input], dimension, from, words(signal), kind)
            }
            Kind::Level(reducer, inner) => {
                let (_, cut) = self.processed(inner, &[], from);
                let cut = self.present(cut, inner);
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
            Kind::Not(inner) => {
                let one = Kind::Constant(Scalar::Number(1.0));
                let one = Expr::number(one, dimension, &signal.span);
                let inputs = vec![self.signal(&one), self.signal(inner)];
                let label = format!("not ({})", self.named(inputs[1]));
                let operation = Operation::Arithmetic(Operator::Subtract);
                self.add(operation, inputs, dimension, from, label, "not".into())
            }
            Kind::Cases(arms, otherwise)
                if arms.iter().any(|(_, on)| matches!(on.ty, Type::SampleFlags { .. })) =>
            {
                let values = arms.iter().map(|(value, _)| value).chain(otherwise.as_deref());
                let conditions = arms.iter().map(|(_, condition)| condition);
                let inputs: Vec<NodeId> =
                    values.chain(conditions).map(|part| self.signal(part)).collect();
                let operation = Operation::Choose(arms.len());
                let kind = format!("choose {} {}", arms.len(), inputs.len());
                self.add(operation, inputs, dimension, from, words(signal), kind)
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
            _ => self.constant(signal),
        }
    }

    /// A number, or a condition on the section, that is the same all along the record.
    fn constant(&mut self, of: &Expr) -> NodeId {
        let kind = format!("constant {}", shape(of));
        let operation = Operation::Constant(of.clone());
        self.add(operation, Vec::new(), of.dimension(), &of.span, words(of), kind)
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
            Operation::Arithmetic(_) | Operation::Negative | Operation::Mapped(_) => {
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
    pub(super) fn processed(
        &mut self,
        signal: &Expr,
        chain: &[Step],
        from: &Span,
    ) -> (NodeId, NodeId) {
        let mut node = self.signal(signal);
        let inside = chain
            .iter()
            .position(|step| matches!(step.kind, StepSpec::Window { .. } | StepSpec::RemoveMean))
            .unwrap_or(chain.len());
        for step in &chain[..inside] {
            node = self.step(node, step);
        }
        let filtered = node;
        if signal.points().is_some_and(Points::of_section) {
            return (filtered, node);
        }
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
            let dimension = self.nodes[node].dimension * step.factor;
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

    /// The samples that there are, of a signal of which some may be missing.
    pub(super) fn present(&mut self, node: NodeId, signal: &Expr) -> NodeId {
        if !signal.may_miss_samples() {
            return node;
        }
        let (dimension, label) = (self.nodes[node].dimension, "samples that there are".to_owned());
        let operation = Operation::Present;
        self.add(operation, vec![node], dimension, &signal.span, label, "present".into())
    }

    /// The label of the signal that a processed signal was made from.
    pub(super) fn origin(&self, mut node: NodeId) -> String {
        while let (
            Operation::Cut | Operation::Present | Operation::Window(_) | Operation::Step(_),
            Some(&input),
        ) = (&self.nodes[node].operation, self.nodes[node].inputs.first())
        {
            node = input;
        }
        self.named(node)
    }
}

fn symbol(operator: Operator) -> &'static str {
    match operator {
        Operator::Add => " + ",
        Operator::Subtract => " - ",
        Operator::Multiply => " * ",
        Operator::Divide => " / ",
        Operator::And => " and ",
        Operator::Or => " or ",
        Operator::Less => " < ",
        Operator::LessEqual => " <= ",
        Operator::Greater => " > ",
        Operator::GreaterEqual => " >= ",
        Operator::Is => " is ",
        Operator::IsNot => " is not ",
    }
}
