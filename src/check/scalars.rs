//! Types expressions over numbers, words and conditions, and folds what is constant.

use super::Checker;
use super::evaluate::{Nothing, evaluate};
use super::names::{Assignment, bare_word};
use super::plan::{DatumKind, Expr, Input, InputSide, Kind, Operator, Scalar, Type};
use crate::catalog::{FUNCTIONS, Function, REDUCERS, Reducer, Signature};
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase};
use crate::units::{Dimension, Unit};

/// Defines may refer to defines, but not for ever.
const DEEPEST_DEFINE: usize = 24;

/// Which names an expression may use, and the reduced signals found in it.
#[derive(Debug)]
pub(super) struct Scope {
    pub vehicle: bool,
    pub section: bool,
    /// Reducers may be used.
    pub reduce: Option<Reduce>,
    /// `simulated` and `measured`, of this dimension.
    pub pair: Option<Dimension>,
    /// Limits of other statistics, of this dimension.
    pub limits: Option<(Dimension, Vec<String>)>,
    pub inputs: Vec<Input>,
    depth: usize,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Reduce {
    /// Dimension of the quantity's own processed signal; `None` where there is no such signal.
    pub own: Option<Dimension>,
    pub axis: Dimension,
    pub side: InputSide,
}

impl Scope {
    fn new(vehicle: bool, section: bool) -> Self {
        Self { vehicle, section, reduce: None, pair: None, limits: None, inputs: Vec::new(), depth: 0 }
    }

    /// Parameters and numbers only.
    pub fn constant() -> Self {
        Self::new(false, false)
    }

    pub fn vehicle() -> Self {
        Self::new(true, false)
    }

    pub fn section() -> Self {
        Self::new(true, true)
    }

    pub fn reducing(own: Option<Dimension>, axis: Dimension) -> Self {
        Self { reduce: Some(Reduce { own, axis, side: InputSide::Own }), ..Self::new(true, true) }
    }

    pub fn pair(dimension: Dimension) -> Self {
        Self { pair: Some(dimension), ..Self::new(true, true) }
    }
}

impl Checker<'_> {
    /// A typed expression, or `None` after a problem was noted.
    pub(super) fn expr(&mut self, phrase: &Phrase, text: &Text, scope: &mut Scope) -> Option<Expr> {
        let span = text.place(phrase.range.clone());
        let (kind, ty) = match &phrase.node {
            Node::Number { value, unit } => {
                let dimension = unit.as_ref().map_or(Dimension::ONE, |unit| unit.dimension);
                (Kind::Constant(Scalar::Number(*value)), Type::Number(dimension))
            }
            Node::Percentile(percent) => return self.own_reducer(Reducer::Percentile(*percent), span, scope),
            Node::Path(path) => return self.path(path, &span, scope),
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
                let Some(dimension) = dimension.power(*exponent) else {
                    self.problems.push(Problem::error("power", "this power is beyond any unit").at(&span));
                    return None;
                };
                (Kind::Power(Box::new(inner), *exponent), Type::Number(dimension))
            }
            Node::Binary(operator @ (Operator::Is | Operator::IsNot), left, right) => {
                return self.equality(*operator, left, right, text, &span, scope);
            }
            Node::Binary(operator, left, right) => {
                let left = self.expr(left, text, scope);
                let right = self.expr(right, text, scope);
                let (left, right) = (left?, right?);
                let ty = self.binary_type(*operator, &left, &right)?;
                (Kind::Binary(*operator, Box::new(left), Box::new(right)), ty)
            }
            Node::Call(name, arguments) if matches!(name.node.as_str(), "measured" | "simulated") => {
                return self.on_side(name, arguments, text, &span, scope);
            }
            Node::Call(name, arguments) => {
                let function = self.function(name, arguments.len(), text)?;
                let arguments: Vec<Option<Expr>> = arguments.iter().map(|argument| self.expr(argument, text, scope)).collect();
                let arguments = arguments.into_iter().collect::<Option<Vec<_>>>()?;
                let dimensions = arguments.iter().map(|argument| self.number_type(argument)).collect::<Option<Vec<_>>>()?;
                let spans: Vec<Span> = arguments.iter().map(|argument| argument.span.clone()).collect();
                let dimension = self.function_type(function, &dimensions, &spans)?;
                (Kind::Call(function, arguments), Type::Number(dimension))
            }
            // `share of std` with a parameter `share` is a product, `mean of Y` a reduced signal.
            Node::Reduced(factor, of) if bare_word(factor).is_some_and(|word| self.is_number_name(word)) => {
                let (left, right) = (self.expr(factor, text, scope), self.expr(of, text, scope));
                let (left, right) = (left?, right?);
                let ty = self.binary_type(Operator::Multiply, &left, &right)?;
                (Kind::Binary(Operator::Multiply, Box::new(left), Box::new(right)), ty)
            }
            Node::Reduced(reducer, signal) => return self.reduced(reducer, signal, text, &span, scope),
            Node::PlaceOf(name, _) | Node::Through(_, name) => {
                self.problems.push(
                    Problem::error("signal-not-number", format!("`{}` is a signal here, a number is needed", name.node))
                        .at(&span)
                        .help("reduce it: `mean of ...`, `range of ...`"),
                );
                return None;
            }
            Node::Cases(arms, otherwise) => return self.cases(arms, otherwise.as_deref(), text, &span, scope),
        };
        Some(fold(Expr { kind, ty, span }))
    }

    /// Whether the protocol has a block of this name: if it is not known all the same, its own problem was noted.
    pub(super) fn is_block(&self, name: &str) -> bool {
        const NAMED: [&str; 6] = ["parameter", "define", "channel", "signal", "section", "filter"];
        self.blocks.iter().any(|block| block.name_text() == name && NAMED.contains(&block.kind.text.as_str()) && !self.defined(name))
    }

    fn defined(&self, name: &str) -> bool {
        self.names.parameters.contains_key(name)
            || self.names.defines.contains_key(name)
            || self.names.channels.contains_key(name)
            || self.names.signals.contains_key(name)
            || self.names.filters.contains_key(name)
            || self.names.columns.iter().any(|datum| datum.name == name)
    }

    fn is_number_name(&self, word: &str) -> bool {
        Reducer::named(word).is_none()
            && (self.names.parameters.contains_key(word)
                || self.names.defines.contains_key(word)
                || self.names.columns.iter().chain(&self.names.vehicle).any(|datum| datum.name == word))
    }

    fn cases(
        &mut self,
        arms: &[(Phrase, Option<Phrase>)],
        otherwise: Option<&Phrase>,
        text: &Text,
        span: &Span,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let mut checked: Vec<(Expr, Option<Expr>)> = Vec::new();
        let mut ok = true;
        for (value, condition) in arms {
            let condition = match condition {
                None => None,
                Some(condition) => {
                    let Some(condition) = self.expr(condition, text, scope) else {
                        ok = false;
                        continue;
                    };
                    ok &= self.flag_type(&condition).is_some();
                    Some(condition)
                }
            };
            // An arm that a parameter rules out is still checked, but asks nothing of the records.
            let inputs = scope.inputs.len();
            let Some(value) = self.expr(value, text, scope) else {
                ok = false;
                continue;
            };
            if matches!(condition.as_ref().map(|condition| &condition.kind), Some(Kind::Constant(Scalar::Flag(false)))) {
                scope.inputs.truncate(inputs);
                ok &= checked.first().is_none_or(|(first, _)| first.ty == value.ty || self.alike(first, &value).is_some());
                continue;
            }
            checked.push((value, condition));
        }
        let otherwise = match otherwise {
            None => None,
            Some(value) => {
                let decided = checked
                    .iter()
                    .any(|(_, condition)| condition.as_ref().is_none_or(|c| matches!(c.kind, Kind::Constant(Scalar::Flag(true)))));
                let inputs = scope.inputs.len();
                let value = self.expr(value, text, scope)?;
                if decided {
                    scope.inputs.truncate(inputs);
                    None
                } else {
                    Some(value)
                }
            }
        };
        if !ok {
            return None;
        }
        let all: Vec<&Expr> = checked.iter().map(|(value, _)| value).chain(otherwise.as_ref()).collect();
        let Some(first) = all.first() else {
            self.problems.push(Problem::error("no-case", "no case of this can apply with the parameters as set").at(span));
            return None;
        };
        for other in &all[1..] {
            self.alike(first, other)?;
        }
        let ty = first.ty.clone();
        match (checked.first(), &otherwise) {
            (Some((value, None)), _) => return Some(value.clone()),
            (Some((value, Some(Expr { kind: Kind::Constant(Scalar::Flag(true)), .. }))), _) => return Some(value.clone()),
            (None, Some(value)) => return Some(value.clone()),
            _ => {}
        }
        Some(Expr { kind: Kind::Cases(checked, otherwise.map(Box::new)), ty, span: span.clone() })
    }

    /// Both of one type and dimension; a problem pointing at both otherwise.
    fn alike(&mut self, first: &Expr, other: &Expr) -> Option<()> {
        let same = match (&first.ty, &other.ty) {
            (Type::Word(_), Type::Word(_)) => true,
            (a, b) => a == b,
        };
        if same {
            return Some(());
        }
        self.problems.push(
            Problem::error("unit-mismatch", format!("one case is {}, another {}", in_words(&first.ty), in_words(&other.ty)))
                .at(&other.span)
                .label(in_words(&other.ty))
                .also(&first.span, in_words(&first.ty)),
        );
        None
    }

    fn equality(&mut self, operator: Operator, left: &Phrase, right: &Phrase, text: &Text, span: &Span, scope: &mut Scope) -> Option<Expr> {
        let left = self.expr(left, text, scope)?;
        let right_span = text.place(right.range.clone());
        let right = match (&left.ty, &right.node) {
            (Type::Word(words), node) => {
                let word = match node {
                    Node::Path(path) => path.clone(),
                    Node::Number { value, unit: None } => value.to_string(),
                    _ => {
                        self.problems.push(
                            Problem::error("not-a-word", "a word is compared with something that is no word")
                                .at(&right_span)
                                .also(&left.span, "a word"),
                        );
                        return None;
                    }
                };
                if !words.contains(&word) {
                    self.problems.push(
                        Problem::error("unknown-choice", format!("`{word}` is none of its words"))
                            .at(&right_span)
                            .also(&left.span, format!("one of {}", words.join(", ")))
                            .suggest(&word, words.iter().map(String::as_str)),
                    );
                    return None;
                }
                Expr { kind: Kind::Constant(Scalar::Word(word)), ty: left.ty.clone(), span: right_span }
            }
            (Type::Flag, Node::Path(path)) if path == "true" || path == "false" => {
                Expr { kind: Kind::Constant(Scalar::Flag(path == "true")), ty: Type::Flag, span: right_span }
            }
            _ => {
                let right = self.expr(right, text, scope)?;
                if matches!((&left.ty, &right.ty), (Type::Number(a), Type::Number(b)) if a == b) || left.ty == right.ty {
                    right
                } else {
                    self.mismatch("compared", &left, &right);
                    return None;
                }
            }
        };
        Some(fold(Expr { kind: Kind::Binary(operator, Box::new(left), Box::new(right)), ty: Type::Flag, span: span.clone() }))
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
            Operator::Divide => Some(Type::Number(a / b)),
            Operator::Add | Operator::Subtract if a == b => Some(Type::Number(a)),
            Operator::Add | Operator::Subtract => {
                self.mismatch(if operator == Operator::Add { "added" } else { "subtracted" }, left, right);
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
        self.problems.push(
            Problem::error("unit-mismatch", format!("{} and {} cannot be {done}", in_words(&left.ty), in_words(&right.ty)))
                .at(&right.span)
                .label(in_words(&right.ty))
                .also(&left.span, in_words(&left.ty)),
        );
    }

    pub(super) fn number_type(&mut self, expr: &Expr) -> Option<Dimension> {
        if let Type::Number(dimension) = expr.ty {
            return Some(dimension);
        }
        self.problems.push(Problem::error("not-a-number", format!("a number is needed, this is {}", in_words(&expr.ty))).at(&expr.span));
        None
    }

    pub(super) fn flag_type(&mut self, expr: &Expr) -> Option<()> {
        if expr.ty == Type::Flag {
            return Some(());
        }
        self.problems.push(
            Problem::error("not-a-condition", format!("a condition is needed, this is {}", in_words(&expr.ty)))
                .at(&expr.span)
                .help("compare it: `... is ...`, `... <= ...`"),
        );
        None
    }

    pub(super) fn function(&mut self, name: &At<String>, count: usize, text: &Text) -> Option<&'static Function> {
        let span = text.place(name.range.clone());
        let Some(found) = function(&name.node) else {
            self.problems.push(
                Problem::error("unknown-function", format!("`{}` is no function", name.node))
                    .at(&span)
                    .suggest(&name.node, FUNCTIONS.iter().map(|function| function.name)),
            );
            return None;
        };
        let needed = if found.signature == Signature::PairSame { 2 } else { 1 };
        if count != needed {
            self.problems.push(Problem::error("arguments", format!("`{}` takes {needed}, there are {count}", found.name)).at(&span));
            return None;
        }
        Some(found)
    }

    /// The dimension a function gives, or a problem at the argument that does not suit it.
    pub(super) fn function_type(&mut self, function: &Function, of: &[Dimension], spans: &[Span]) -> Option<Dimension> {
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
            Signature::Plain => {
                refuse(self, format!("`{}` takes a plain number or an angle, this is {}", function.name, of[0].in_words()), 0)
            }
            Signature::Root => of[0].root().or_else(|| refuse(self, format!("{} has no square root", of[0].in_words()), 0)),
            Signature::PairSame if of[0] == of[1] => Some(of[0]),
            Signature::PairSame => {
                refuse(self, format!("`{}` takes two alike, these are {} and {}", function.name, of[0].in_words(), of[1].in_words()), 1)
            }
        }
    }

    fn own_reducer(&mut self, reducer: Reducer, span: Span, scope: &mut Scope) -> Option<Expr> {
        if let Reducer::Percentile(percent) = reducer {
            if !(0.0..=100.0).contains(&percent) {
                self.problems
                    .push(Problem::error("out-of-range", format!("a percentile lies between 0 and 100, this is {percent}")).at(&span));
                return None;
            }
        }
        match scope.reduce {
            Some(Reduce { own: Some(dimension), axis, side }) => {
                let ty = Type::Number(reducer.gives(dimension, axis));
                let kind = Kind::Input(add_input(scope, Input { reducer, signal: None, side, span: span.clone() }));
                Some(Expr { kind, ty, span })
            }
            _ => {
                self.problems.push(
                    Problem::error("no-signal", format!("`{}` reduces a signal, and there is none here", reducer.in_words()))
                        .at(&span)
                        .help(format!("name it: `{} of ...`", reducer.in_words())),
                );
                None
            }
        }
    }

    fn reduced(&mut self, reducer: &Phrase, signal: &Phrase, text: &Text, span: &Span, scope: &mut Scope) -> Option<Expr> {
        let Some(Reduce { axis, side, .. }) = scope.reduce else {
            self.problems.push(Problem::error("no-records", "signals of records cannot be used here").at(span));
            return None;
        };
        let found = match &reducer.node {
            Node::Percentile(percent) => Some(Reducer::Percentile(*percent)),
            Node::Path(name) => Reducer::named(name),
            _ => None,
        };
        let Some(found) = found else {
            let word = bare_word(reducer).unwrap_or_default();
            self.problems.push(
                Problem::error("unknown-reducer", format!("`{word}` reduces no signal"))
                    .at(&text.place(reducer.range.clone()))
                    .suggest(word, REDUCERS.iter().map(|entry| entry.name)),
            );
            return None;
        };
        let signal = self.signal(signal, text, &Assignment::new())?;
        let ty = Type::Number(found.gives(signal.dimension, axis));
        let kind = Kind::Input(add_input(scope, Input { reducer: found, signal: Some(signal), side, span: span.clone() }));
        Some(Expr { kind, ty, span: span.clone() })
    }

    /// `measured(p99.85)`: the value of that side, whichever side is evaluated.
    fn on_side(&mut self, name: &At<String>, arguments: &[Phrase], text: &Text, span: &Span, scope: &mut Scope) -> Option<Expr> {
        let (Some(reduce), [argument]) = (scope.reduce, arguments) else {
            self.problems.push(
                Problem::error("side", format!("`{}(...)` takes one reduced signal, in the value of a quantity or a check", name.node))
                    .at(span),
            );
            return None;
        };
        let side = if name.node == "measured" { InputSide::Measured } else { InputSide::Simulated };
        scope.reduce = Some(Reduce { side, ..reduce });
        let found = self.expr(argument, text, scope);
        scope.reduce = Some(reduce);
        found
    }

    fn path(&mut self, path: &str, span: &Span, scope: &mut Scope) -> Option<Expr> {
        if let Some(pair) = scope.pair {
            let kind = match path {
                "simulated" => Some(Kind::Simulated),
                "measured" => Some(Kind::Measured),
                _ => None,
            };
            if let Some(kind) = kind {
                return Some(Expr { kind, ty: Type::Number(pair), span: span.clone() });
            }
        }
        if let Some((dimension, names)) = &scope.limits {
            if names.iter().any(|name| name == path) {
                return Some(Expr { kind: Kind::LimitOf(path.to_string()), ty: Type::Number(*dimension), span: span.clone() });
            }
        }
        if scope.reduce.is_some_and(|reduce| reduce.own.is_some()) {
            if let Some(reducer) = Reducer::named(path) {
                return self.own_reducer(reducer, span.clone(), scope);
            }
        }
        if let Some(parameter) = self.names.parameters.get(path) {
            return Some(Expr { kind: Kind::Constant(parameter.value.clone()), ty: parameter.ty.clone(), span: span.clone() });
        }
        if let Some(define) = self.names.defines.get(path).cloned() {
            return self.define(path, &define, span, scope);
        }
        if matches!(path, "true" | "false") {
            return Some(Expr { kind: Kind::Constant(Scalar::Flag(path == "true")), ty: Type::Flag, span: span.clone() });
        }
        if let Some(found) = self.datum_path(path, span, scope) {
            return found;
        }
        if scope.section {
            let axis = self.axis.as_ref().map_or(Dimension::LENGTH, |axis| axis.unit.dimension);
            let number = Type::Number(axis);
            match path {
                "start" => return Some(Expr { kind: Kind::Start, ty: number, span: span.clone() }),
                "end" => return Some(Expr { kind: Kind::End, ty: number, span: span.clone() }),
                "length" => {
                    let side = |kind| Box::new(Expr { kind, ty: number.clone(), span: span.clone() });
                    return Some(Expr {
                        kind: Kind::Binary(Operator::Subtract, side(Kind::End), side(Kind::Start)),
                        ty: number.clone(),
                        span: span.clone(),
                    });
                }
                _ => {}
            }
        }
        if let Ok(unit) = Unit::parse(path) {
            return Some(Expr { kind: Kind::Constant(Scalar::Number(unit.factor)), ty: Type::Number(unit.dimension), span: span.clone() });
        }
        self.unknown_name(path, span, scope);
        None
    }

    /// `vehicle.category`, `section.radius`, or the name alone.
    fn datum_path(&mut self, path: &str, span: &Span, scope: &Scope) -> Option<Option<Expr>> {
        let (role, name) = path.split_once('.').map_or(("", path), |(role, name)| (role, name));
        let ty = |kind: &DatumKind| match kind {
            DatumKind::Number(unit) => Type::Number(unit.dimension),
            DatumKind::Words(words) => Type::Word(words.clone()),
            DatumKind::Flag => Type::Flag,
        };
        if matches!(role, "" | "section") {
            if let Some(index) = self.names.columns.iter().position(|datum| datum.name == name) {
                if scope.section {
                    let ty = ty(&self.names.columns[index].kind);
                    return Some(Some(Expr { kind: Kind::Column(index), ty, span: span.clone() }));
                }
                self.problems.push(
                    Problem::error("no-section", format!("`{path}` differs from section to section and cannot be used here"))
                        .at(span)
                        .help("this holds for all sections at once; a condition on sections goes into `for sections where ...` or `for zones ...`"),
                );
                return Some(None);
            }
        }
        if matches!(role, "" | "vehicle") {
            if let Some(index) = self.names.vehicle.iter().position(|datum| datum.name == name) {
                if scope.vehicle {
                    let ty = ty(&self.names.vehicle[index].kind);
                    return Some(Some(Expr { kind: Kind::Vehicle(index), ty, span: span.clone() }));
                }
                self.problems.push(Problem::error("no-vehicle", format!("`{path}` is not known before a campaign is opened")).at(span));
                return Some(None);
            }
        }
        None
    }

    fn define(&mut self, name: &str, define: &super::names::Written, span: &Span, scope: &mut Scope) -> Option<Expr> {
        if scope.depth >= DEEPEST_DEFINE {
            self.problems.push(
                Problem::error("define-loop", format!("`{name}` is defined by itself")).at(&define.text.span).also(span, "used here"),
            );
            return None;
        }
        scope.depth += 1;
        let found = self.expr(&define.phrase, &define.text, scope);
        scope.depth -= 1;
        found
    }

    fn unknown_name(&mut self, path: &str, span: &Span, scope: &Scope) {
        if self.is_block(path) {
            return;
        }
        let mut known: Vec<String> = self.names.parameters.keys().chain(self.names.defines.keys()).cloned().collect();
        if scope.pair.is_some() {
            known.extend(["simulated".to_string(), "measured".to_string()]);
        }
        if let Some((_, names)) = &scope.limits {
            known.extend(names.iter().cloned());
        }
        if scope.reduce.is_some() {
            known.extend(REDUCERS.iter().map(|entry| entry.name.to_string()));
        }
        if scope.section {
            known.extend(self.names.columns.iter().map(|datum| datum.name.clone()));
        }
        if scope.vehicle {
            for datum in &self.names.vehicle {
                known.push(format!("vehicle.{}", datum.name));
                known.push(datum.name.clone());
            }
        }
        let mut problem = Problem::error("unknown-name", format!("nothing is called `{path}` here")).at(span);
        if self.names.channels.contains_key(path) || self.names.signals.contains_key(path) {
            problem = problem.help(format!("`{path}` is a signal: reduce it, `mean of {path}`"));
        } else {
            problem = problem.suggest(path, known.iter().map(String::as_str));
        }
        self.problems.push(problem);
    }
}

fn add_input(scope: &mut Scope, input: Input) -> usize {
    scope.inputs.push(input);
    scope.inputs.len() - 1
}

pub(super) fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// A constant in place of an expression of constants.
pub(super) fn fold(expr: Expr) -> Expr {
    if matches!(expr.kind, Kind::Constant(_)) {
        return expr;
    }
    match evaluate(&expr, &Nothing) {
        Ok(value) => Expr { kind: Kind::Constant(value), ..expr },
        Err(_) => expr,
    }
}

pub(super) fn in_words(ty: &Type) -> String {
    match ty {
        Type::Number(dimension) => dimension.in_words(),
        Type::Word(_) => "a word".into(),
        Type::Flag => "a condition".into(),
    }
}
