//! Resolves names in expressions over numbers, words and conditions.

use std::collections::BTreeSet;

use super::Checker;
use super::names::bare_word;
use super::plan::{
    Datum, DatumKind, Expr, Input, InputSide, Kind, Operator, Origin, Scalar, Step, Taken, Type,
};
use super::scope::{Reduce, Scope};
use super::steps::after;
use crate::catalog::{METRICS, MetricEntry, REDUCERS, Reducer, STATISTICS, Statistic};
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase};
use crate::units::Unit;

/// The meaning of a statistic's name in the bound of a limit, and how to limit an expression of
/// values instead.
pub(super) const LIMITS_NOT_VALUES: &str = "in a limit, the name of a statistic stands for the limit of that statistic, not for its \
    value; an expression of values stands before the limit: `limit (mean + 3 * std) 60 kN`";

/// Where a section is on the axis.
const EXTENT: [&str; 3] = ["start", "end", "length"];

/// What says to which campaign of several a section belongs.
pub(super) const CAMPAIGN: &str = "campaign";

impl Checker<'_> {
    /// A value taken from the own signal of the quantity.
    pub(super) fn own_reducer(
        &mut self,
        reducer: Reducer,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        self.percentile_range(reducer, &span)?;
        let Some(Reduce { own: Some(dimension), axis, side, .. }) = scope.reduce else {
            let what = reducer.in_words();
            let problem = Problem::error(
                "no-signal",
                format!("`{what}` needs a signal, and there is none here"),
            )
            .at(&span);
            let of_sections = scope
                .group
                .as_ref()
                .is_some_and(|group| group.values.is_none() && scope.limits.is_none());
            self.problems.push(if of_sections {
                problem.help(format!(
                    "of the sections there are only data: `{what} of speed`, `{what} of length`"
                ))
            } else if scope.reduce.is_some() {
                problem.help(format!("name the signal: `{what} of ...`"))
            } else {
                problem
            });
            return None;
        };
        let ty = Type::Number(reducer.gives(dimension, axis));
        let kind = Kind::Input(add_input(
            scope,
            Input {
                taken: Taken::Reduced(reducer),
                signal: None,
                chain: Vec::new(),
                over: None,
                side,
                span: span.span.clone(),
            },
        ));
        Some(Expr { kind, ty, span })
    }

    fn percentile_range(&mut self, reducer: Reducer, span: &Span) -> Option<()> {
        match reducer {
            Reducer::Percentile(percent) if !(0.0..=100.0).contains(&percent) => {
                self.problems.push(
                    Problem::error(
                        "out-of-range",
                        format!("a percentile must be from 0 to 100, this is {percent}"),
                    )
                    .at(span),
                );
                None
            }
            _ => Some(()),
        }
    }

    /// The reducer of `NAME of signal`.
    pub(super) fn reducer(
        &mut self,
        reducer: &Phrase,
        text: &Text,
        of_records: bool,
    ) -> Option<Reducer> {
        let place = text.place(reducer.range.clone());
        let found = match &reducer.node {
            Node::Percentile(percent) => Some(Reducer::Percentile(*percent)),
            Node::Path(name) => Reducer::named(name),
            _ => None,
        };
        let Some(found) = found else {
            let word = if let Node::Path(path) = &reducer.node { path.as_str() } else { "" };
            if !self.is_failed(word) {
                let numbers = self
                    .names
                    .parameter_blocks
                    .keys()
                    .chain(self.names.defines.keys())
                    .cloned()
                    .collect::<Vec<_>>();
                let reducers = REDUCERS.iter().map(|entry| entry.name).filter(|_| of_records);
                let known: Vec<&str> = reducers.chain(numbers.iter().map(String::as_str)).collect();
                let says =
                    format!("`{word} of` is neither a value of a signal nor a share of a number");
                self.problems
                    .push(Problem::error("unknown-reducer", says).at(&place).suggest(word, known));
            }
            return None;
        };
        self.percentile_range(found, &place)?;
        Some(found)
    }

    /// `range of curvature`: a value taken from a named signal.
    pub(super) fn reduced(
        &mut self,
        reducer: &Phrase,
        signal: &Phrase,
        text: &Text,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let place = text.place(reducer.range.clone());
        let found = self.reducer(reducer, text, scope.reduce.is_some())?;
        let Some(Reduce { axis, side, .. }) = scope.reduce else {
            self.problems.push(
                Problem::error(
                    "no-records",
                    format!(
                        "`{} of ...` needs the records of a section, which are not available here",
                        found.in_words()
                    ),
                )
                .at(span),
            );
            return None;
        };
        if self.names_side(signal, &mut BTreeSet::new()) {
            return self.of_both(found, signal, text, span, scope);
        }
        let at = scope.at.clone();
        // `slope of A over B` is parsed as `slope of (A over B)`.
        let (signal, over) = match &signal.node {
            Node::Over(signal, over) => (signal.as_ref(), Some(over.as_ref())),
            _ => (signal, None),
        };
        let (signal, chain) = match &signal.node {
            Node::Through(inner, filter) if over.is_none() => {
                (inner.as_ref(), self.window_of(filter, text)?)
            }
            _ => (signal, Vec::new()),
        };
        let signal = self.signal(signal, text, &at);
        let over = match over {
            None => None,
            Some(over) => Some(self.slope_axis(found, over, &place, text, &at)?),
        };
        let signal = signal?;
        let axis = over.as_ref().map_or(axis, |over| over.dimension);
        let ty = Type::Number(found.gives(after(&chain, signal.dimension), axis));
        let input = Input {
            taken: Taken::Reduced(found),
            signal: Some(signal),
            chain,
            over,
            side,
            span: span.span.clone(),
        };
        Some(Expr { kind: Kind::Input(add_input(scope, input)), ty, span: span.clone() })
    }

    /// The steps of a filter that stands last before a number is taken: there, windows may be among
    /// them.
    fn window_of(&mut self, filter: &At<String>, text: &Text) -> Option<Vec<Step>> {
        let steps = self.filter_named(&filter.node, &text.place(filter.range.clone()))?;
        self.step_order(&steps, false)?;
        Some(steps)
    }

    /// The value of a fixed side, such as `measured(p99.85)`, whichever side is evaluated.
    pub(super) fn on_side(
        &mut self,
        name: &At<String>,
        arguments: &[Phrase],
        text: &Text,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let (Some(reduce), [argument]) = (scope.reduce, arguments) else {
            let says = format!(
                "`{}(...)` must contain one value of a signal; it can be used in the value of a quantity or in a check",
                name.node
            );
            self.problems.push(Problem::error("side", says).at(span));
            return None;
        };
        let side = if name.node == "measured" { InputSide::Measured } else { InputSide::Simulated };
        scope.reduce = Some(Reduce { side, ..reduce });
        let found = self.expr(argument, text, scope);
        scope.reduce = Some(reduce);
        found
    }

    pub(super) fn path(&mut self, path: &str, span: &Origin, scope: &mut Scope) -> Option<Expr> {
        let expr = |kind, ty| Some(Expr { kind, ty, span: span.clone() });
        if scope.words.iter().any(|word| word == path) {
            return expr(
                Kind::Constant(Scalar::Word(path.to_string())),
                Type::Word(scope.words.clone()),
            );
        }
        if let Some(pair) = scope.pair {
            match path {
                "simulated" => return expr(Kind::Simulated, Type::Number(pair)),
                "measured" => return expr(Kind::Measured, Type::Number(pair)),
                _ => {}
            }
        }
        if let (Some(dimension), "value") = (scope.value, path) {
            return expr(Kind::Input(0), Type::Number(dimension));
        }
        if let Some(found) = self.group_path(path, span, scope) {
            return found;
        }
        if let Some((dimension, names)) = &scope.limits
            && names.iter().any(|name| name == path)
        {
            return expr(Kind::LimitOf(path.to_string()), Type::Number(*dimension));
        }
        if let Some(statistic) = Statistic::named(path).filter(|_| scope.limits.is_some()) {
            let says = format!(
                "there is no other limit of the {} that this could refer to",
                statistic.title(self.ddof)
            );
            self.problems
                .push(Problem::error("no-such-limit", says).at(span).help(LIMITS_NOT_VALUES));
            return None;
        }
        if let Some(reducer) = Reducer::named(path) {
            return self.own_reducer(reducer, span.clone(), scope);
        }
        if scope.reduce.is_some_and(|reduce| reduce.metrics)
            && let Some(entry) = MetricEntry::called(path)
        {
            return self.metric_named(entry, span, scope);
        }
        if self.names.parameter_blocks.contains_key(path) {
            let parameter = self.parameter(path, span)?;
            return expr(Kind::Constant(parameter.value), parameter.ty);
        }
        if let Some(define) = self.names.defines.get(path).cloned() {
            self.used_defines.insert(path.to_string());
            self.unconfirmed |= self.names.unconfirmed.contains_key(path);
            return self.inside("define", path, span, |checker| {
                checker.expr(&define.phrase, &define.text, scope)
            });
        }
        if matches!(path, "true" | "false") {
            return expr(Kind::Constant(Scalar::Flag(path == "true")), Type::Flag);
        }
        if let Some(found) = self.datum_path(path, span, scope) {
            return found;
        }
        if let Some(found) = self.extent_path(path, span, scope) {
            return Some(found);
        }
        let signal = self.is_signal(path) || self.is_failed(path);
        if let Some(unit) = Unit::parse(path).ok().filter(|_| !signal) {
            return expr(Kind::Constant(Scalar::Number(unit.factor)), Type::Number(unit.dimension));
        }
        self.unknown_name(path, span, scope);
        None
    }

    /// `start`, `end` and `length` of the section on the axis, unless the protocol has columns of
    /// these names.
    fn extent_path(&self, path: &str, span: &Origin, scope: &Scope) -> Option<Expr> {
        let axis = self.axis.as_ref().filter(|_| scope.section)?.unit.dimension;
        let number = |kind| Expr { kind, ty: Type::Number(axis), span: span.clone() };
        match path {
            "start" => Some(number(Kind::Start)),
            "end" => Some(number(Kind::End)),
            "length" => Some(number(Kind::Binary(
                Operator::Subtract,
                Box::new(number(Kind::End)),
                Box::new(number(Kind::Start)),
            ))),
            _ => None,
        }
    }

    /// A datum: `vehicle.category`, `section.radius`, or the name without prefix.
    fn datum_path(&mut self, path: &str, span: &Origin, scope: &Scope) -> Option<Option<Expr>> {
        let (role, name) = path.split_once('.').map_or(("", path), |(role, name)| (role, name));
        let of = |data: &[super::plan::Datum], wanted: &str| {
            if role.is_empty() || role == wanted {
                data.iter().position(|datum| datum.name == name)
            } else {
                None
            }
        };
        let vehicle = of(&self.names.vehicle, "vehicle");
        let column = of(&self.names.columns, "section").or_else(|| {
            let asked = vehicle.is_none() && (role.is_empty() || role == "section");
            if asked { self.campaign_column(name, span) } else { None }
        });
        if column.is_some() && vehicle.is_some() {
            self.problems.push(
                Problem::error(
                    "ambiguous",
                    format!("`{name}` is both a vehicle datum and a section column"),
                )
                .at(span)
                .help(format!("write `vehicle.{name}` or `section.{name}`")),
            );
            return Some(None);
        }
        if let Some(index) = column {
            let is_zone = matches!(self.zone.as_ref().map(|zone| &zone.kind), Some(Kind::Column(zone)) if *zone == index);
            let ty = datum_type(&self.names.columns[index].kind);
            if let Some(zone) = scope.zone.clone().filter(|_| is_zone) {
                return Some(Some(Expr {
                    kind: Kind::Constant(Scalar::Word(zone)),
                    ty,
                    span: span.clone(),
                }));
            }
            if scope.section {
                return Some(Some(Expr { kind: Kind::Column(index), ty, span: span.clone() }));
            }
            let says = format!(
                "`{path}` differs between sections, but this expression has one value for all sections"
            );
            let problem = Problem::error("no-section", says).at(span);
            // Only the scope of limits has the vehicle but no section.
            self.problems.push(match (scope.vehicle, is_zone) {
                (true, true) => problem.help("a limit that depends on the zone ends with `for each zone`"),
                (true, false) => problem
                    .help("a bound can use a mean, such as `mean of radius`; a limit for some sections ends with `for sections where ...`; a limit of `each` value can depend on its section"),
                (false, _) => problem,
            });
            return Some(None);
        }
        let index = vehicle?;
        if scope.vehicle {
            let ty = datum_type(&self.names.vehicle[index].kind);
            return Some(Some(Expr { kind: Kind::Vehicle(index), ty, span: span.clone() }));
        }
        self.problems.push(
            Problem::error(
                "no-vehicle",
                format!(
                    "`{path}` depends on the vehicle; expected a number that the protocol fixes"
                ),
            )
            .at(span)
            .help("make it a `parameter`, which a campaign can set"),
        );
        Some(None)
    }

    /// The column that says to which campaign a section belongs: it need not be declared, and is
    /// there once something asks for it. A column that the protocol declares by this name goes
    /// before it.
    pub(super) fn campaign_column(&mut self, name: &str, span: &Span) -> Option<usize> {
        if let Some(known) = self.names.columns.iter().position(|datum| datum.name == name) {
            return Some(known);
        }
        (name == CAMPAIGN && !self.is_signal(name)).then(|| {
            self.names.columns.push(Datum {
                name: CAMPAIGN.into(),
                title: "Campaign".into(),
                key: CAMPAIGN.into(),
                kind: DatumKind::Campaign,
                default: None,
                may_be_absent: false,
                range: None,
                span: span.clone(),
            });
            self.names.columns.len() - 1
        })
    }

    /// Whether `word of ...` is a product, because a parameter, definition or datum has this name.
    pub(super) fn is_number_name(&self, phrase: &Phrase) -> bool {
        let Node::Path(path) = &phrase.node else { return false };
        let datum = |role: &str, data: &[super::plan::Datum], name: &str| {
            data.iter().any(|datum| {
                datum.name == name || path.strip_prefix(role).is_some_and(|rest| rest == datum.name)
            })
        };
        Reducer::named(path).is_none()
            && (self.names.parameter_blocks.contains_key(path)
                || self.names.defines.contains_key(path)
                || datum("section.", &self.names.columns, path)
                || datum("vehicle.", &self.names.vehicle, path))
    }

    /// Whether the block of a name has an error that was already reported.
    pub(super) fn is_failed(&self, path: &str) -> bool {
        let name = path.split_once('.').map_or(path, |(_, name)| name);
        self.names.failed.contains(name)
    }

    fn unknown_name(&mut self, path: &str, span: &Span, scope: &Scope) {
        if self.is_failed(path) {
            return;
        }
        if self.is_signal(path) {
            self.problems.push(
                Problem::error(
                    "signal-not-number",
                    format!("expected a number, `{path}` is a signal"),
                )
                .at(span)
                .help(format!("take a number from it: `mean of {path}`")),
            );
            return;
        }
        let digits = path.find(|c: char| !c.is_ascii_digit()).unwrap_or(0);
        if digits > 0 {
            let problem = Problem::error(
                "unknown-unit",
                format!("`{}` is not a known unit", &path[digits..]),
            )
            .at(span);
            self.problems.push(
                match Unit::parse(&path[digits..]).err().and_then(|unknown| unknown.near) {
                    Some(near) => {
                        problem.help(format!("did you mean `{} {near}`?", &path[..digits]))
                    }
                    None => problem,
                },
            );
            return;
        }
        let mut known: Vec<String> =
            self.names.parameter_blocks.keys().chain(self.names.defines.keys()).cloned().collect();
        if scope.pair.is_some() {
            known.extend(["simulated".to_string(), "measured".to_string()]);
        }
        if let Some((_, names)) = &scope.limits {
            known.extend(names.iter().cloned());
        }
        if scope.group.as_ref().is_some_and(|group| group.values.is_some()) {
            known.extend(STATISTICS.iter().map(|entry| entry.name.to_string()));
            known.extend(self.names.estimates.keys().cloned());
        }
        if scope.value.is_some() {
            known.push("value".into());
        }
        if scope.reduce.is_some_and(|reduce| reduce.own.is_some()) {
            known.extend(REDUCERS.iter().map(|entry| entry.name.to_string()));
        }
        if scope.reduce.is_some_and(|reduce| reduce.metrics) {
            known.extend(METRICS.iter().map(MetricEntry::call_in_words));
        }
        if scope.section {
            known.push(CAMPAIGN.into());
            known.extend(EXTENT.map(String::from));
            known.extend(self.names.columns.iter().map(|datum| datum.name.clone()));
        }
        if scope.vehicle {
            for datum in &self.names.vehicle {
                known.push(datum.name.clone());
                known.push(format!("vehicle.{}", datum.name));
            }
        }
        self.problems.push(
            Problem::error("unknown-name", format!("nothing is called `{path}` here"))
                .at(span)
                .suggest(path, known.iter().map(String::as_str)),
        );
    }

    /// The choice that a bare word stands for: the word itself, or the value of the choice
    /// parameter of this name.
    pub(super) fn choice_word(&mut self, word: &str, span: &Span) -> Option<String> {
        if !self.names.parameter_blocks.contains_key(word) {
            return Some(word.to_string());
        }
        match self.parameter(word, span)?.value {
            Scalar::Word(choice) => Some(choice),
            _ => Some(word.to_string()),
        }
    }

    /// As [`Self::choice_word`], for a phrase that is a bare word.
    pub(super) fn choice_phrase(&mut self, phrase: &Phrase, text: &Text) -> Option<String> {
        let word = bare_word(phrase)?;
        self.choice_word(word, &text.place(phrase.range.clone()))
    }
}

fn datum_type(kind: &DatumKind) -> Type {
    match kind {
        DatumKind::Number(unit) => Type::Number(unit.dimension),
        DatumKind::Words(words) => Type::Word(words.clone()),
        DatumKind::Flag => Type::Flag,
        // Any word: the campaigns are not known before the run.
        DatumKind::Campaign => Type::Word(Vec::new()),
    }
}

pub(super) fn add_input(scope: &mut Scope, input: Input) -> usize {
    scope.inputs.push(input);
    scope.inputs.len() - 1
}
