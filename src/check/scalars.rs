//! Determines types of expressions over numbers, words and conditions, and evaluates constants.

use super::Checker;
use super::conditions::impossible;
use super::evaluate::{evaluate, words};
use super::functions::{function, is_signal_function};
use super::plan::{DatumKind, Expr, Kind, Operator, Origin, Scalar, Type};
use super::scope::Scope;
use super::values::Nothing;
use crate::catalog::{FUNCTIONS, Function, MetricEntry, Reducer, SIGNAL_FUNCTIONS, Signature};
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase};
use crate::units::Dimension;

impl Checker<'_> {
    /// A typed expression; `None` after a problem.
    pub(super) fn expr(&mut self, phrase: &Phrase, text: &Text, scope: &mut Scope) -> Option<Expr> {
        let origin = origin(phrase, text);
        let span = origin.span.clone();
        self.deeper(&span, |checker| checker.expr_inside(phrase, text, origin, scope))
    }

    fn expr_inside(
        &mut self,
        phrase: &Phrase,
        text: &Text,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let (kind, ty) = match &phrase.node {
            Node::Number { value, .. } if !value.is_finite() => {
                let says = format!("`{}` is too large for a number", span.words);
                self.problems.push(Problem::error("not-finite", says).at(&span));
                return None;
            }
            Node::Number { value, unit } => {
                let dimension = unit.as_ref().map_or(Dimension::ONE, |unit| unit.dimension);
                (Kind::Constant(Scalar::Number(*value)), Type::Number(dimension))
            }
            Node::Percentile(percent) if scope.group.is_some() => {
                return self.group_percentile(*percent, &span, scope)?;
            }
            Node::Percentile(percent) => {
                return self.own_reducer(Reducer::Percentile(*percent), span, scope);
            }
            Node::Path(path) => return self.path(path, &span, scope),
            Node::Quoted(name) => {
                let says =
                    format!("`\"{name}\"` is a name, which only a word can be compared with");
                self.problems.push(
                    Problem::error("not-a-number", says)
                        .at(&span)
                        .help("for instance: `campaign is \"series 2\"`"),
                );
                return None;
            }
            Node::Negative(inner) => {
                let inner = self.expr(inner, text, scope)?;
                let dimension = self.number_type(&inner)?;
                (Kind::Negative(Box::new(inner)), Type::Number(dimension))
            }
            Node::Not(inner) => {
                let inner = self.expr(inner, text, scope)?;
                self.flag_type(&inner)?;
                (Kind::Not(Box::new(inner)), Type::Flag)
            }
            Node::Magnitude(inner) => {
                let inner = self.expr(inner, text, scope)?;
                let dimension = self.number_type(&inner)?;
                (Kind::Call(function("magnitude")?, vec![inner]), Type::Number(dimension))
            }
            Node::Power(inner, exponent) => {
                let inner = self.expr(inner, text, scope)?;
                let dimension = self.number_type(&inner)?;
                let dimension = self.power(dimension, *exponent, &span)?;
                (Kind::Power(Box::new(inner), *exponent), Type::Number(dimension))
            }
            Node::Binary(operator @ (Operator::Is | Operator::IsNot), left, right) => {
                return self.equality(*operator, left, right, text, &span, scope);
            }
            Node::Binary(operator, left, right) => {
                self.divided_by_share(*operator, right, &span)?;
                let inputs = scope.inputs.len();
                let (left, right) = (self.expr(left, text, scope), self.expr(right, text, scope));
                let (left, right) = (left?, right?);
                let ty = self.binary_type(*operator, &left, &right)?;
                self.divided_by_zero(*operator, &right, &span)?;
                let found = self.folded(Expr {
                    kind: Kind::Binary(*operator, Box::new(left), Box::new(right)),
                    ty,
                    span,
                })?;
                if matches!(found.kind, Kind::Constant(_)) {
                    // `false and p0.15 > p99.85` does not need the records.
                    scope.inputs.truncate(inputs);
                }
                return Some(found);
            }
            Node::Near { .. } => return self.near(phrase, text, scope).map(|near| near.holds),
            Node::Call(name, arguments)
                if matches!(name.node.as_str(), "measured" | "simulated") =>
            {
                return self.on_side(name, arguments, text, &span, scope);
            }
            Node::Call(name, arguments) if self.metric_called(name, scope) => {
                return self.metric_call(name, arguments, text, &span, scope);
            }
            Node::Call(name, arguments) => {
                let function = self.function(name, arguments.len(), text)?;
                let arguments: Vec<Option<Expr>> =
                    arguments.iter().map(|argument| self.expr(argument, text, scope)).collect();
                let arguments = arguments.into_iter().collect::<Option<Vec<_>>>()?;
                let dimensions = arguments
                    .iter()
                    .map(|argument| self.number_type(argument))
                    .collect::<Option<Vec<_>>>()?;
                let spans: Vec<Span> =
                    arguments.iter().map(|argument| argument.span.span.clone()).collect();
                let dimension = self.function_type(function, &dimensions, &spans)?;
                (Kind::Call(function, arguments), Type::Number(dimension))
            }
            // `share of std` with a parameter `share` is a product, `mean of Y` a value of a
            // signal.
            Node::Reduced(factor, of) if self.is_number_name(factor) => {
                let (left, right) = (self.expr(factor, text, scope), self.expr(of, text, scope));
                let (left, right) = (left?, right?);
                let ty = self.binary_type(Operator::Multiply, &left, &right)?;
                (Kind::Binary(Operator::Multiply, Box::new(left), Box::new(right)), ty)
            }
            Node::Reduced(reducer, of) if let Node::ForEach(one, keys) = &of.node => {
                return self.of_each_group(reducer, one, keys, text, &span, scope);
            }
            Node::ForEach(_, keys) => return self.many_numbers(keys, text, &span),
            Node::Weighted(of, by) => return self.weighted(of, by, text, &span, scope),
            Node::Reduced(reducer, of) if self.other_quantity(of, scope).is_some() => {
                return self.of_other(reducer, of, text, &span, scope);
            }
            Node::Reduced(_, of) if scope.value.is_some() => {
                return self.no_such_quantity(of, text, &span);
            }
            Node::Reduced(reducer, of) if scope.group.is_some() => {
                return self.group_data(reducer, of, text, &span, scope);
            }
            Node::Bound { upper, confidence, of, bootstrap } => {
                return self.group_bound((*upper, *confidence, *bootstrap), of, text, &span, scope);
            }
            Node::Share { of_sections, condition } => {
                return self.group_share(*of_sections, condition, None, text, &span, scope);
            }
            Node::Fit(fit) => return self.group_fit(fit, text, &span, scope),
            Node::Reduced(reducer, signal) => {
                return self.reduced(reducer, signal, text, &span, scope);
            }
            Node::Over(value, over) => return self.slope_over(value, over, text, &span, scope),
            Node::PlaceOf(name, _) => return self.not_a_number(&name.node, &span),
            Node::Through(inner, _) => return self.not_a_number(&words_at(text, inner), &span),
            Node::Cases(arms, otherwise) => {
                return self.cases(arms, otherwise.as_deref(), text, &span, scope);
            }
        };
        self.folded(Expr { kind, ty, span })
    }

    fn not_a_number(&mut self, signal: &str, span: &Span) -> Option<Expr> {
        self.problems.push(
            Problem::error(
                "signal-not-number",
                format!("expected a number, `{signal}` is a signal"),
            )
            .at(span)
            .help("take a number from it: `mean of ...`, `range of ...`"),
        );
        None
    }

    pub(super) fn power(
        &mut self,
        dimension: Dimension,
        exponent: i8,
        span: &Span,
    ) -> Option<Dimension> {
        let found = dimension.power(exponent);
        if found.is_none() {
            self.problems.push(
                Problem::error("power", "this power gives exponents of units that are too large")
                    .at(span),
            );
        }
        found
    }

    fn divided_by_zero(&mut self, operator: Operator, right: &Expr, span: &Span) -> Option<()> {
        if operator != Operator::Divide
            || !matches!(right.kind, Kind::Constant(Scalar::Number(0.0)))
        {
            return Some(());
        }
        self.problems.push(
            Problem::error("not-finite", "this is a division by zero")
                .at(span)
                .also(&right.span, "zero"),
        );
        None
    }

    /// `2/3 of std` is two thirds of it. `2/share of std` is ambiguous.
    fn divided_by_share(&mut self, operator: Operator, right: &Phrase, span: &Span) -> Option<()> {
        if operator != Operator::Divide
            || !matches!(&right.node, Node::Reduced(factor, _) if self.is_number_name(factor))
        {
            return Some(());
        }
        self.problems.push(
            Problem::error("ambiguous", "this can be read as `a / (b of c)` and as `(a / b) of c`")
                .at(span)
                .help("use parentheses"),
        );
        None
    }

    fn cases(
        &mut self,
        arms: &[(Phrase, Phrase)],
        otherwise: Option<&Phrase>,
        text: &Text,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let mut found: Vec<(Expr, Expr)> = Vec::new();
        let mut last: Option<Expr> = None;
        let mut values: Vec<Expr> = Vec::new();
        let mut ok = true;
        for (value, condition) in arms {
            let before = scope.asked();
            let condition = self
                .expr(condition, text, scope)
                .filter(|condition| self.flag_type(condition).is_some());
            // The case of a condition that parameters or the zone make false is still checked, but
            // needs no records and no values.
            let value = self.expr(value, text, scope);
            let (Some(value), Some(condition)) = (value, condition) else {
                ok = false;
                continue;
            };
            values.push(value.clone());
            match condition.kind {
                _ if last.is_some() => scope.forget(before),
                Kind::Constant(Scalar::Flag(false)) => scope.forget(before),
                Kind::Constant(Scalar::Flag(true)) => last = Some(value),
                _ => found.push((value, condition)),
            }
        }
        if let Some(otherwise) = otherwise {
            let before = scope.asked();
            match self.expr(otherwise, text, scope) {
                None => ok = false,
                Some(value) => {
                    values.push(value.clone());
                    if last.is_some() {
                        scope.forget(before);
                    } else {
                        last = Some(value);
                    }
                }
            }
        }
        let (first, rest) = values.split_first().filter(|_| ok)?;
        for other in rest {
            self.alike(first, other)?;
        }
        if found.is_empty() {
            if last.is_none() {
                let says = match &scope.zone {
                    Some(zone) => format!("no case of this applies in zone {zone}"),
                    None => "no case of this can apply with the parameters as set".into(),
                };
                self.problems.push(Problem::error("no-case", says).at(span));
            }
            return last;
        }
        if last.is_none() {
            self.covered(&found.iter().map(|(_, condition)| condition).collect::<Vec<_>>(), span);
        }
        let ty = first.ty.clone();
        Some(Expr { kind: Kind::Cases(found, last.map(Box::new)), ty, span: span.clone() })
    }

    /// Warns unless one of the conditions certainly holds.
    pub(super) fn covered(&mut self, conditions: &[&Expr], span: &Span) {
        let mut all: Vec<(&Expr, bool)> =
            self.assumed.iter().map(|condition| (condition, true)).collect();
        all.extend(conditions.iter().map(|condition| (*condition, false)));
        if !impossible(&all) && !self.partial {
            self.problems.push(
                Problem::warning(
                    "no-otherwise",
                    "if none of these conditions holds, this has no value",
                )
                .at(span)
                .help("end it with `, otherwise ...`"),
            );
        }
    }

    /// Both must have the same type and dimension; otherwise a problem points at both.
    fn alike(&mut self, first: &Expr, other: &Expr) -> Option<()> {
        let same = match (&first.ty, &other.ty) {
            (Type::Word(_), Type::Word(_)) => true,
            (a, b) => a == b,
        };
        if same {
            return Some(());
        }
        self.problems.push(
            Problem::error(
                "unit-mismatch",
                format!("one case is {}, another {}", in_words(&first.ty), in_words(&other.ty)),
            )
            .at(&other.span)
            .label(in_words(&other.ty))
            .also(&first.span, in_words(&first.ty)),
        );
        None
    }

    fn equality(
        &mut self,
        operator: Operator,
        left: &Phrase,
        right: &Phrase,
        text: &Text,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(left) = self.expr(left, text, scope) else {
            // The right side is checked as well, unless it may be a word of the part with the
            // error.
            if !matches!(right.node, Node::Path(_)) {
                self.expr(right, text, scope);
            }
            return None;
        };
        let right_span = origin(right, text);
        let right = match (&left.ty, &right.node) {
            (Type::Word(choices), node) => {
                let word = match node {
                    Node::Path(path) => path.clone(),
                    Node::Quoted(word) => word.clone(),
                    Node::Number { value, unit: None } => value.to_string(),
                    _ => {
                        self.problems.push(
                            Problem::error(
                                "not-a-word",
                                format!(
                                    "`{}` is a word and can only be compared with a word",
                                    words(&left)
                                ),
                            )
                            .at(&right_span)
                            .also(&left.span, "a word"),
                        );
                        return None;
                    }
                };
                // A choice parameter stands for its value, unless a word with its name is among the
                // choices.
                let meant = choices.contains(&word) || matches!(node, Node::Quoted(_));
                let word = if meant { word } else { self.choice_word(&word, &right_span)? };
                if self.is_campaign(&left) {
                    self.campaigns.push(Spanned::new(word.clone(), right_span.span.clone()));
                } else if !choices.contains(&word) {
                    self.problems.push(
                        Problem::error(
                            "unknown-choice",
                            format!("`{}` cannot be `{word}`", words(&left)),
                        )
                        .at(&right_span)
                        .also(&left.span, format!("one of {}", choices.join(", ")))
                        .suggest(&word, choices.iter().map(String::as_str)),
                    );
                    return None;
                }
                Expr {
                    kind: Kind::Constant(Scalar::Word(word)),
                    ty: left.ty.clone(),
                    span: right_span,
                }
            }
            (Type::Flag, Node::Path(path)) if path == "true" || path == "false" => Expr {
                kind: Kind::Constant(Scalar::Flag(path == "true")),
                ty: Type::Flag,
                span: right_span,
            },
            _ => {
                let right = self.expr(right, text, scope)?;
                if matches!((&left.ty, &right.ty), (Type::Number(a), Type::Number(b)) if a == b)
                    || left.ty == right.ty
                {
                    right
                } else {
                    self.mismatch("compared", &left, &right);
                    return None;
                }
            }
        };
        self.folded(Expr {
            kind: Kind::Binary(operator, Box::new(left), Box::new(right)),
            ty: Type::Flag,
            span: span.clone(),
        })
    }

    fn is_campaign(&self, expr: &Expr) -> bool {
        matches!(expr.kind, Kind::Column(index) if self.names.columns[index].kind == DatumKind::Campaign)
    }

    /// Replaces an expression of constants by its value; a problem where there is none, such as for
    /// a division by zero.
    fn folded(&mut self, expr: Expr) -> Option<Expr> {
        if matches!(expr.kind, Kind::Constant(_)) {
            return Some(expr);
        }
        match evaluate(&expr, &Nothing) {
            Ok(value) => Some(Expr { kind: Kind::Constant(value), ..expr }),
            Err(_) if !of_constants(&expr) => Some(expr),
            Err(reason) => {
                self.problems.push(Problem::error("not-finite", reason).at(&expr.span));
                None
            }
        }
    }

    fn binary_type(&mut self, operator: Operator, left: &Expr, right: &Expr) -> Option<Type> {
        if matches!(operator, Operator::And | Operator::Or) {
            let (a, b) = (self.flag_type(left), self.flag_type(right));
            return (a.is_some() && b.is_some()).then_some(Type::Flag);
        }
        let (a, b) = (self.number_type(left), self.number_type(right));
        let (a, b) = (a?, b?);
        match operator {
            Operator::Multiply => Some(Type::Number(a * b)),
            Operator::Divide if matches!(right.kind, Kind::Constant(Scalar::Number(0.0))) => {
                self.problems
                    .push(Problem::error("not-finite", "this divides by zero").at(&right.span));
                None
            }
            Operator::Divide => Some(Type::Number(a / b)),
            Operator::Add | Operator::Subtract if a == b => Some(Type::Number(a)),
            Operator::Add | Operator::Subtract => {
                self.mismatch(
                    if operator == Operator::Add { "added" } else { "subtracted" },
                    left,
                    right,
                );
                None
            }
            _ if a == b => Some(Type::Flag),
            _ => {
                self.mismatch("compared", left, right);
                None
            }
        }
    }

    fn mismatch(&mut self, done: &str, left: &Expr, right: &Expr) {
        let problem = Problem::error(
            "unit-mismatch",
            format!("{} and {} cannot be {done}", in_words(&left.ty), in_words(&right.ty)),
        )
        .at(&right.span)
        .label(in_words(&right.ty))
        .also(&left.span, in_words(&left.ty));
        // A number as it is written, without a unit.
        let bare = |expr: &Expr| {
            expr.ty == Type::Number(Dimension::ONE)
                && matches!(expr.kind, Kind::Constant(Scalar::Number(_)))
        };
        let (number, other) = if bare(left) { (left, right) } else { (right, left) };
        let written = number.span.text();
        let unit = match other.ty {
            Type::Number(dimension)
                if done == "compared" && bare(number) && written.parse::<f64>().is_ok() =>
            {
                Some(self.own_unit("", dimension))
            }
            _ => None,
        };
        self.problems.push(match unit {
            Some(unit) => problem.help(format!("a number has its unit: `{written} {unit}`")),
            None => problem,
        });
    }

    pub(super) fn number_type(&mut self, expr: &Expr) -> Option<Dimension> {
        if let Type::Number(dimension) = expr.ty {
            return Some(dimension);
        }
        self.problems.push(
            Problem::error(
                "not-a-number",
                format!("expected a number, this is {}", in_words(&expr.ty)),
            )
            .at(&expr.span),
        );
        None
    }

    pub(super) fn flag_type(&mut self, expr: &Expr) -> Option<()> {
        if expr.ty == Type::Flag {
            return Some(());
        }
        self.problems.push(
            Problem::error(
                "not-a-condition",
                format!("expected a condition, this is {}", in_words(&expr.ty)),
            )
            .at(&expr.span)
            .help("compare it: `... is ...`, `... <= ...`"),
        );
        None
    }

    pub(super) fn function(
        &mut self,
        name: &At<String>,
        count: usize,
        text: &Text,
    ) -> Option<&'static Function> {
        let span = text.place(name.range.clone());
        let Some(found) = function(&name.node) else {
            let problem =
                Problem::error("unknown-function", format!("`{}` is not a function", name.node))
                    .at(&span);
            self.problems.push(if MetricEntry::called(&name.node).is_some() {
                problem.help("it is a metric, which compares two signals: use it in the `metric` of a quantity")
            } else if is_signal_function(&name.node) {
                problem.help(format!("it gives a signal, expected a number: `rms of {}(...)`", name.node))
            } else {
                problem.suggest(&name.node, FUNCTIONS.iter().map(|function| function.name).chain(SIGNAL_FUNCTIONS.map(|(name, ..)| name)))
            });
            return None;
        };
        let needed = if found.signature == Signature::PairSame { 2 } else { 1 };
        if count != needed {
            self.problems.push(
                Problem::error(
                    "arguments",
                    format!(
                        "wrong number of arguments of `{}`: expected {needed}, found {count}",
                        found.name
                    ),
                )
                .at(&span),
            );
            return None;
        }
        Some(found)
    }

    /// The dimension of the function's value; a problem at the argument whose dimension does not
    /// agree.
    pub(super) fn function_type(
        &mut self,
        function: &Function,
        of: &[Dimension],
        spans: &[Span],
    ) -> Option<Dimension> {
        let refuse = |checker: &mut Self, says: String, at: usize| {
            let mut problem = Problem::error("unit-mismatch", says).at(&spans[at]);
            if at > 0 {
                problem = problem.also(&spans[0], of[0].in_words());
            }
            checker.problems.push(problem);
            None
        };
        match function.signature {
            Signature::Same => Some(of[0]),
            Signature::ToPlain => Some(Dimension::ONE),
            Signature::Plain if of[0] == Dimension::ONE => Some(Dimension::ONE),
            Signature::Plain => refuse(
                self,
                format!(
                    "`{}` needs a plain number or an angle, this is {}",
                    function.name,
                    of[0].in_words()
                ),
                0,
            ),
            Signature::Root => of[0]
                .root()
                .or_else(|| refuse(self, format!("{} has no square root", of[0].in_words()), 0)),
            Signature::PairSame if of[0] == of[1] => Some(of[0]),
            Signature::PairSame => refuse(
                self,
                format!(
                    "`{}` needs two arguments of the same dimension, these are {} and {}",
                    function.name,
                    of[0].in_words(),
                    of[1].in_words()
                ),
                1,
            ),
        }
    }
}

/// Whether all direct parts are constants. They were folded before.
fn of_constants(expr: &Expr) -> bool {
    let constant = |part: &Expr| matches!(part.kind, Kind::Constant(_));
    match &expr.kind {
        Kind::Negative(inner) | Kind::Not(inner) | Kind::Power(inner, _) => constant(inner),
        Kind::Binary(_, left, right) => constant(left) && constant(right),
        Kind::Call(_, arguments) => arguments.iter().all(constant),
        _ => false,
    }
}

pub(super) fn origin(phrase: &Phrase, text: &Text) -> Origin {
    Origin { span: text.place(phrase.range.clone()), words: words_at(text, phrase).into() }
}

pub(super) fn words_at(text: &Text, phrase: &Phrase) -> String {
    super::names::normalised(text.text.get(phrase.range.clone()).unwrap_or(""))
}

pub(super) fn in_words(ty: &Type) -> String {
    match ty {
        Type::Number(dimension) => dimension.in_words(),
        Type::Word(_) => "a word".into(),
        Type::Flag => "a condition".into(),
    }
}
