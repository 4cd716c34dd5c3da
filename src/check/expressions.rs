//! One walk over phrases that gives typed expressions: of numbers, words and conditions, of values of
//! a group, and of samples. Where an expression stands decides which names it can use ([`Scope`]).

use super::{
    evaluate::{evaluate, number, shape},
    functions::{function, is_signal_function},
    prelude::*,
    values::Nothing,
};
use crate::catalog::Reducer;
use crate::syntax::phrase::Number;

impl Type {
    /// A number, or a number for each sample, of another dimension.
    pub fn of_dimension(&self, dimension: Dimension) -> Self {
        match *self {
            Self::Samples { points, .. } => Self::Samples { dimension, points },
            _ => Self::Number(dimension),
        }
    }

    /// As in messages: `a force`, `a word`.
    pub fn in_words(&self) -> String {
        match self {
            Self::Number(dimension) | Self::Samples { dimension, .. } => dimension.in_words(),
            Self::Word(_) => "a word".into(),
            Self::Flag | Self::SampleFlags { .. } => "a condition".into(),
        }
    }
}

impl Points {
    fn in_words(self) -> &'static str {
        match self {
            Self::Record => "samples of a record",
            Self::Track => "samples of the track record",
            Self::Spectrum => "lines of a spectrum",
            Self::Cycles => "cycles",
        }
    }
}

impl Checker<'_> {
    /// A typed expression; `None` after a problem.
    pub fn expr(&mut self, phrase: &Phrase, scope: &mut Scope) -> Option<Expr> {
        let origin = origin(phrase);
        let span = origin.span.clone();
        let may_miss = std::mem::take(&mut scope.may_miss);
        let found = self.deeper(&span, |checker| checker.expr_inside(phrase, origin, scope))?;
        if found.may_miss_samples() && !may_miss {
            return self.missing_samples(&found);
        }
        Some(found)
    }

    /// An expression that is a condition.
    pub fn condition(&mut self, phrase: &Phrase, scope: &mut Scope) -> Option<Expr> {
        let condition = self.expr(phrase, scope)?;
        self.flag_type(&condition)?;
        Some(condition)
    }

    fn expr_inside(&mut self, phrase: &Phrase, span: Origin, scope: &mut Scope) -> Option<Expr> {
        let (kind, ty) = match &phrase.node {
            node if scope.samples && !self.of_samples(phrase, scope) => {
                let number = self.expr(phrase, &mut scope.of_section())?;
                if !matches!(node, Node::Binary(..) | Node::Not(_) | Node::Near { .. }) {
                    self.number_type(&number)?;
                }
                return Some(number);
            }
            Node::Number(Number { value, .. }) if !value.is_finite() => {
                return self.refuse(problem!(
                    "not-finite",
                    &span,
                    "`{}` is too large for a number",
                    span.words
                ));
            }
            Node::Number(number) => {
                (Kind::Constant(Scalar::Number(number.value)), Type::Number(number.dimension()))
            }
            Node::PercentileBy(_) => return self.by_percentile(phrase, scope),
            node if of_percentile(node) => return self.by_percentile(phrase, scope),
            Node::Percentile(percent) if scope.group.is_some() => {
                return self.group_percentile(*percent, &span, scope);
            }
            Node::Percentile(_) if scope.limits.is_some() => {
                return self.bare_statistic(&span.words, &span, scope);
            }
            Node::Percentile(percent) => {
                return self.own_reducer(Reducer::Percentile(*percent), span, scope);
            }
            Node::Path(path) if scope.samples => return self.samples_named(path, &span, scope),
            Node::Path(path) => return self.path(path, &span, scope),
            Node::Quoted(name) => {
                return self.refuse(
                    problem!(
                        "not-a-number",
                        &span,
                        "`\"{name}\"` is a name, which only a word can be compared with"
                    )
                    .help("for instance: `campaign is \"series 2\"`"),
                );
            }
            Node::Negative(inner) => {
                let inner = self.expr(inner, scope)?;
                self.number_type(&inner)?;
                let ty = inner.ty.clone();
                (Kind::Negative(Box::new(inner)), ty)
            }
            Node::Not(inner) => {
                let inner = self.expr(inner, scope)?;
                self.flag_type(&inner)?;
                let ty = inner.ty.clone();
                (Kind::Not(Box::new(inner)), ty)
            }
            Node::Magnitude(inner) => {
                let inner = self.expr(inner, scope)?;
                self.number_type(&inner)?;
                let ty = inner.ty.clone();
                (Kind::Call(function("magnitude")?, vec![inner]), ty)
            }
            Node::Power(inner, exponent) => {
                return self.power(inner, exponent, span, scope);
            }
            Node::Table { of, points, held } => {
                return self.table(of, points, *held, span, scope);
            }
            Node::Binary(operator @ (Operator::Is | Operator::IsNot), left, right) => {
                return self.equality(*operator, left, right, &span, scope);
            }
            // `2/3 of std` is two thirds of it. `2/share of std` is ambiguous.
            Node::Binary(Operator::Divide, _, right)
                if !scope.samples
                    && matches!(&right.node, Node::Reduced(factor, _) if self.is_number_name(factor)) =>
            {
                let says = "this can be read as `a / (b of c)` and as `(a / b) of c`";
                return self.refuse(error("ambiguous", says, &span).help("use parentheses"));
            }
            Node::Binary(operator, left, right) => {
                let inputs = scope.inputs.len();
                if *operator == Operator::Add && scope.samples {
                    self.sign_as_condition(left, right, &span);
                }
                let found = self.binary(*operator, left, right, span, scope)?;
                if matches!(found.kind, Kind::Constant(_)) {
                    // `false and p0.15 > p99.85` does not need the records.
                    scope.inputs.truncate(inputs);
                }
                return Some(found);
            }
            Node::Near { .. } if scope.samples => {
                let says = "`near` compares numbers of a section, and here are samples";
                return self.refuse(error("no-samples", says, &span).help("`|Q - 60 kN| <= 5 kN`"));
            }
            Node::Near { .. } => return self.near(phrase, scope).map(|near| near.holds),
            Node::Call(name, arguments) if scope.samples && is_signal_function(&name.node) => {
                return self.over_axis(name, arguments, span, scope);
            }
            Node::Call(name, arguments)
                if !scope.samples && matches!(name.node.as_str(), "measured" | "simulated") =>
            {
                return self.on_side(name, arguments, &span, scope);
            }
            Node::Call(name, arguments) if !scope.samples && name.node == "siblings" => {
                return self.of_siblings(arguments, &span, scope);
            }
            Node::Call(name, arguments) if self.metric_called(name, scope) => {
                return self.metric_call(name, arguments, &span, scope);
            }
            Node::Call(name, arguments) if self.names.arguments.contains_key(&name.node) => {
                return self.defined_of(name, arguments, &span, scope);
            }
            Node::Call(name, arguments) => {
                let function = self.function(name, arguments.len())?;
                let arguments = all(arguments.iter().map(|argument| self.expr(argument, scope)))?;
                for argument in &arguments {
                    self.number_type(argument)?;
                }
                let dimension = self.function_type(function, &arguments)?;
                let ty = self.of_one_record(dimension, &arguments.iter().collect::<Vec<_>>())?;
                (Kind::Call(function, arguments), ty)
            }
            Node::Reduced(limit, of) if Self::is_limit(limit, scope) => {
                return self.limit_named(of, &span, scope);
            }
            // `share of std` with a parameter `share` is a product, `mean of Y` a value of a
            // signal.
            Node::Reduced(factor, of) if self.is_number_name(factor) => {
                return self.binary(Operator::Multiply, factor, of, span, scope);
            }
            Node::Reduced(reducer, of) if scope.samples => {
                return self.level(reducer, of, span, scope);
            }
            Node::Reduced(reducer, of) if let Node::ForEach(one, keys) = &of.node => {
                return self.of_each_group(reducer, one, keys, &span, scope);
            }
            Node::ForEach(_, keys) => return self.many_numbers(keys, &span),
            Node::Weighted(of, by) => return self.weighted(of, by, &span, scope),
            Node::Reduced(reducer, of) if self.other_quantity(of, scope).is_some() => {
                return self.of_other(reducer, of, &span, scope);
            }
            Node::Reduced(_, of) if scope.value.is_some() => {
                return self.no_such_quantity(of, &span);
            }
            Node::Reduced(reducer, of) if scope.group.is_some() => {
                return self.group_data(reducer, of, &span, scope);
            }
            Node::Bound { upper, confidence, of, bootstrap } => {
                return self.group_bound((*upper, confidence, *bootstrap), of, &span, scope);
            }
            Node::Share { counted, of_sections: false, condition }
                if scope.group.is_none() && scope.reduce.is_some() =>
            {
                return self.share_of_samples(*counted, condition, &span, scope);
            }
            Node::Share { counted, of_sections, condition } => {
                let of = (*counted, *of_sections);
                return self.group_share(of, condition, None, &span, scope);
            }
            Node::Fit(fit) => return self.group_fit(fit, &span, scope),
            Node::Reduced(reducer, signal) => {
                return self.reduced(reducer, signal, &span, scope);
            }
            Node::Over(value, over) => return self.slope_over(value, over, &span, scope),
            Node::PlaceOf(name, words) if scope.samples => {
                return self.placed(name, words, &span, scope);
            }
            Node::Through(inner, steps) if scope.samples => {
                return self.filtered(inner, steps, span, scope);
            }
            Node::PlaceOf(name, _) => return self.not_a_number(&name.node, &span),
            Node::Through(inner, _) => return self.not_a_number(&inner.words(), &span),
            Node::Cases(arms, otherwise) => {
                return self.cases(arms, otherwise.as_deref(), &span, scope);
            }
        };
        self.folded(Expr { kind, ty, span }, scope)
    }

    fn not_a_number(&mut self, signal: &str, span: &Span) -> Option<Expr> {
        let is_name = signal.chars().all(|c| c.is_alphanumeric() || c == '_');
        if is_name && !self.is_signal(signal) {
            self.unknown_signal(signal, span);
            return None;
        }
        self.refuse(
            problem!("signal-not-number", span, "expected a number, `{signal}` is a signal")
                .help("take a number from it: `mean of ...`, `range of ...`"),
        )
    }

    /// A power. The exponent is a plain number that is constant.
    fn power(
        &mut self,
        base: &Phrase,
        exponent: &Phrase,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let base = self.expr(base, scope)?;
        let of = self.number_type(&base)?;
        let value = self.constant_of("exponent", Dimension::ONE, "a plain number", exponent)?;
        let Some(dimension) = of.power(value) else {
            let problem = problem!("power", &span, "{} has no power of {value}", of.in_words());
            return self.refuse(problem.also(&base.span, of.in_words()).help(
                "exponents of units are fractions such as 1/3, 0.3 or 1.5: whole sixtieths, up to 127; a third is `(1/3)`",
            ));
        };
        let ty = base.ty.of_dimension(dimension);
        let kind = Kind::Mapped(Box::new(base), Mapping::Power(value));
        self.folded(Expr { kind, ty, span }, scope)
    }

    /// Arithmetic, a comparison of numbers, or conditions that are joined.
    fn binary(
        &mut self,
        operator: Operator,
        left: &Phrase,
        right: &Phrase,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let (left, right) = (self.expr(left, scope), self.expr(right, scope));
        let (left, right) = (left?, right?);
        let ty = self.binary_type(operator, &left, &right, scope)?;
        if operator == Operator::Divide && number(&right, &Nothing) == Ok(0.0) {
            return self.refuse(
                error("not-finite", "this is a division by zero", &span).also(&right.span, "zero"),
            );
        }
        let kind = Kind::Binary(operator, Box::new(left), Box::new(right));
        self.folded(Expr { kind, ty, span }, scope)
    }

    fn binary_type(
        &mut self,
        operator: Operator,
        left: &Expr,
        right: &Expr,
        scope: &Scope,
    ) -> Option<Type> {
        if matches!(operator, Operator::And | Operator::Or) {
            let (a, b) = (self.flag_type(left), self.flag_type(right));
            return a.and(b).and_then(|()| self.condition_type(left, right));
        }
        let (a, b) = (self.number_type(left), self.number_type(right));
        let (a, b) = (a?, b?);
        let dimension = match operator {
            Operator::Multiply => a * b,
            Operator::Divide
                if matches!(right.kind, Kind::Constant(Scalar::Number(0.0))) && !scope.samples =>
            {
                return self.refuse(error("not-finite", "this divides by zero", &right.span));
            }
            Operator::Divide => a / b,
            Operator::Add | Operator::Subtract if a == b => a,
            Operator::Subtract if !scope.samples => {
                return self.mismatch("subtracted", left, right);
            }
            Operator::Add | Operator::Subtract => return self.mismatch("added", left, right),
            _ if a == b => return self.condition_type(left, right),
            _ => return self.mismatch("compared", left, right),
        };
        self.of_one_record(dimension, &[left, right])
    }

    /// The type of what is computed from these parts, sample by sample if any has samples. Track and
    /// vehicle records have different samples and cannot be combined.
    pub fn of_one_record(&mut self, dimension: Dimension, parts: &[&Expr]) -> Option<Type> {
        match self.record_of(parts)? {
            None => Some(Type::Number(dimension)),
            Some(points) => Some(Type::Samples { dimension, points }),
        }
    }

    /// The type of a condition on two parts: for each sample if one of them has samples.
    fn condition_type(&mut self, left: &Expr, right: &Expr) -> Option<Type> {
        let points = self.record_of(&[left, right])?;
        Some(points.map_or(Type::Flag, |points| Type::SampleFlags { points }))
    }

    /// What the samples of these parts are taken at; `Some(None)` where no part has samples.
    pub fn record_of(&mut self, parts: &[&Expr]) -> Option<Option<Points>> {
        let mut sampled = parts.iter().filter_map(|part| Some((part, part.points()?)));
        let Some((first, points)) = sampled.next() else { return Some(None) };
        let cycles = cycles_of(first);
        let unlike = |other: &Expr| points == Points::Cycles && cycles_of(other) != cycles;
        let Some((other, others)) =
            sampled.find(|(other, others)| *others != points || unlike(other))
        else {
            return Some(Some(points));
        };
        if points.of_section() || others.of_section() {
            let (a, b) = (points.in_words(), others.in_words());
            let says = if points == others {
                "cycles of two signals cannot be combined".to_owned()
            } else {
                format!("{a} and {b} cannot be combined")
            };
            let help =
                "take a number of one, `mean of Y`, or say it of the whole, `spectrum(Y - Q, 4 s)`";
            let problem = error("mixed-records", says, &other.span).help(help);
            return self.refuse(problem.also(&first.span, points.in_words()));
        }
        self.refuse(
            error(
                "mixed-records",
                "a channel of the track record cannot be combined with one of simulation and measurement, sample by sample",
                &other.span,
            )
            .also(&first.span, "the other record"),
        )
    }

    /// Reports two operands that do not agree.
    pub fn mismatch<T>(&mut self, done: &str, left: &Expr, right: &Expr) -> Option<T> {
        let problem = unlike(done, left, right);
        // A number as it is written, without a unit.
        let bare = |expr: &Expr| {
            expr.ty == Type::Number(Dimension::ONE)
                && matches!(expr.kind, Kind::Constant(Scalar::Number(_)))
        };
        let (number, other) = if bare(left) { (left, right) } else { (right, left) };
        let written = number.span.text();
        let help = match other.ty {
            Type::Number(dimension)
                if done == "compared" && bare(number) && written.parse::<f64>().is_ok() =>
            {
                let unit = self.own_unit("", dimension);
                Some(format!("a number has its unit: `{written} {unit}`"))
            }
            _ => None,
        };
        self.refuse(problem.help_if(help))
    }

    /// Replaces an expression of constants by its value, except among samples; a problem where there
    /// is none, such as for a division by zero.
    pub fn folded(&mut self, expr: Expr, scope: &Scope) -> Option<Expr> {
        if matches!(expr.kind, Kind::Constant(_)) {
            return Some(expr);
        }
        let known =
            |part: &Expr| matches!(part.kind, Kind::Constant(_)) || !part.parts().is_empty();
        match evaluate(&expr, &Nothing) {
            Ok(value) if !scope.samples => Some(Expr { kind: Kind::Constant(value), ..expr }),
            Err(reason) if !expr.any(&|part| !known(part)) => {
                self.refuse(error("not-finite", reason.text(), &expr.span))
            }
            _ => Some(expr),
        }
    }

    /// The dimension of a number or of samples.
    pub fn number_type(&mut self, expr: &Expr) -> Option<Dimension> {
        if let Type::Number(dimension) | Type::Samples { dimension, .. } = expr.ty {
            return Some(dimension);
        }
        self.refuse(problem!(
            "not-a-number",
            expr,
            "expected a number, this is {}",
            expr.ty.in_words()
        ))
    }

    /// Whether it is a condition; a problem if not.
    pub fn flag_type(&mut self, expr: &Expr) -> Option<()> {
        if matches!(expr.ty, Type::Flag | Type::SampleFlags { .. }) {
            return Some(());
        }
        self.refuse(
            problem!(
                "not-a-condition",
                expr,
                "expected a condition, this is {}",
                expr.ty.in_words()
            )
            .help("compare it: `... is ...`, `... <= ...`"),
        )
    }
}

/// Two operands of different types or dimensions; the problem points at both.
pub fn unlike(done: &str, left: &Expr, right: &Expr) -> Problem {
    let (a, b) = (left.ty.in_words(), right.ty.in_words());
    let meant = |one: &Expr, other: &Expr| match other.ty {
        Type::Number(wanted) | Type::Samples { dimension: wanted, .. } => {
            Unit::meant(one.span.text(), wanted)
        }
        _ => None,
    };
    problem!("unit-mismatch", &right.span, "{a} and {b} cannot be {done}")
        .label(b)
        .also(&left.span, a)
        .help_if(meant(right, left).or_else(|| meant(left, right)))
}

/// The signal that cycles are of.
fn cycles_of(expr: &Expr) -> Option<String> {
    expr.find(&|part| matches!(part.kind, Kind::OfSection(SectionOperation::CycleRanges, _)))
        .map(shape)
}

/// Whether a percentile by a constant is taken of something: `percentile level of Q`.
fn of_percentile(node: &Node) -> bool {
    let (Node::Reduced(of, _) | Node::Weighted(of, _)) = node else { return false };
    matches!(of.node, Node::PercentileBy(_))
}

/// The place and the words of a whole field.
pub fn whole(text: &Text) -> Origin {
    Origin { span: text.span.clone(), words: normalised(&text.text).into() }
}

/// The place and the words of a phrase.
pub fn origin(phrase: &Phrase) -> Origin {
    Origin { span: phrase.place(), words: phrase.words().into() }
}
