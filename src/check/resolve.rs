//! Resolves the names in expressions by scope: parameters, data, definitions, statistics, values of
//! signals, and signals themselves.

use super::{functions::or_idiom, prelude::*, scope::Reduce, steps::after};
use crate::catalog::{
    DIFFERENCES, METRICS, MetricEntry, REDUCERS, Reducer, STATISTICS, Statistic, TOTAL,
};
use crate::source::Source;
use crate::syntax::idiom;

/// Where a section is on the axis.
const EXTENT: [&str; 3] = ["start", "end", "length"];

/// What says to which campaign of several a section belongs.
pub const CAMPAIGN: &str = "campaign";

impl Checker<'_> {
    /// A value taken from the own signal of the quantity.
    pub fn own_reducer(
        &mut self,
        reducer: Reducer,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        self.percentile_range(reducer, &span)?;
        let Some(Reduce { own: Some(dimension), axis, side, .. }) = scope.reduce else {
            let what = reducer.in_words();
            let of_sections =
                scope.group.is_some() && scope.values().is_none() && scope.limits.is_none();
            let help = if of_sections {
                Some(format!(
                    "of the sections there are only data: `{what} of speed`, `{what} of length`"
                ))
            } else {
                scope.reduce.map(|_| format!("name the signal: `{what} of ...`"))
            };
            return self.refuse(
                problem!("no-signal", &span, "`{what}` needs a signal, and there is none here")
                    .help_if(help),
            );
        };
        let input = Input::own(Taken::Reduced(reducer), side, &span);
        Some(scope.input(input, reducer.gives(dimension, axis), &span))
    }

    fn percentile_range(&mut self, reducer: Reducer, at: &impl Located) -> Option<()> {
        let Reducer::Percentile(percent) = reducer else { return Some(()) };
        self.is_percentage(percent, at)
    }

    /// Whether a percentile is one from 0 to 100.
    pub fn is_percentage(&mut self, percent: f64, at: &impl Located) -> Option<()> {
        if (0.0..=100.0).contains(&percent) {
            return Some(());
        }
        self.refuse(problem!(
            "out-of-range",
            at,
            "a percentile must be from 0 to 100, this is {percent}"
        ))
    }

    /// The reducer of `NAME of signal`.
    pub fn reducer(&mut self, reducer: &Phrase, of_records: bool) -> Option<Reducer> {
        let reducer = &self.with_percentile(reducer)?;
        let found = match &reducer.node {
            Node::Percentile(percent) => Some(Reducer::Percentile(*percent)),
            Node::Path(name) if name == TOTAL.name => Some(Reducer::Named(&TOTAL)),
            Node::Path(name) => Reducer::named(name),
            _ => None,
        };
        let Some(found) = found else {
            let word = if let Node::Path(path) = &reducer.node { path.as_str() } else { "" };
            if !self.is_failed(word) {
                let numbers = self.names.parameter_blocks.keys().chain(self.names.defines.keys());
                let reducers = REDUCERS.iter().map(|entry| entry.name).filter(|_| of_records);
                let known = reducers.chain(numbers.map(String::as_str));
                let problem = problem!(
                    "unknown-reducer",
                    reducer,
                    "`{word} of` is neither a value of a signal nor a share of a number"
                );
                self.tell(or_idiom(problem, word, known));
            }
            return None;
        };
        self.percentile_range(found, reducer)?;
        Some(found)
    }

    /// `range of curvature`: a value taken from a named signal.
    pub fn reduced(
        &mut self,
        reducer: &Phrase,
        signal: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let found = self.reducer(reducer, scope.reduce.is_some())?;
        let Some(Reduce { axis, side, .. }) = scope.reduce else {
            return self.refuse(problem!(
                "no-records",
                span,
                "`{} of ...` needs the records of a section, which are not available here",
                found.in_words()
            ));
        };
        if self.names_side(signal) {
            return self.of_both(found, signal, span, scope);
        }
        // `slope of A over B` is parsed as `slope of (A over B)`.
        let (signal, over) = match &signal.node {
            Node::Over(signal, over) => (signal.as_ref(), Some(over.as_ref())),
            _ => (signal, None),
        };
        let (signal, chain) = match &signal.node {
            Node::Through(inner, steps) if over.is_none() => {
                let steps = self.steps_of(steps)?;
                self.step_order(&steps, false)?;
                // A filter that stands last before a number is taken may have windows.
                (inner.as_ref(), steps)
            }
            _ => (signal, Vec::new()),
        };
        let at = &scope.at;
        // A slope takes its two signals sample by sample; a filter needs all samples.
        let may_miss = over.is_none() && chain.is_empty();
        let signal = self.expr(signal, &mut Scope { may_miss, ..Scope::samples(at, None) });
        let over = if_written(over.map(|over| self.slope_axis(found, over, reducer, at)))?;
        let signal = self.at_frequencies(signal?)?;
        self.suits_points(found, &signal, span)?;
        if over.is_some() || !chain.is_empty() {
            self.of_record(&signal, span)?;
        }
        let axis = over.as_ref().map_or(signal.along(axis), Expr::dimension);
        let dimension = found.gives(after(&chain, signal.dimension()), axis);
        let own = Input::own(Taken::Reduced(found), side, span);
        let input = Input { signal: Some(signal), chain, over, ..own };
        Some(scope.input(input, dimension, span))
    }

    /// The value of a fixed side, such as `measured(p99.85)`, whichever side is evaluated.
    pub fn on_side(
        &mut self,
        name: &At<String>,
        arguments: &[Phrase],
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let (Some(reduce), [argument]) = (scope.reduce, arguments) else {
            return self.refuse(problem!("side", span, "`{}(...)` must contain one value of a signal; it can be used in the value of a quantity or in a check",
                name.node));
        };
        let side = if name.node == "measured" { InputSide::Measured } else { InputSide::Simulated };
        scope.reduce = Some(Reduce { side, ..reduce });
        let found = self.expr(argument, scope);
        scope.reduce = Some(reduce);
        Some(Expr { span: span.clone(), ..found? })
    }

    /// The same number of the other positions of a plausibility rule: `siblings(noise_floor)`.
    pub fn of_siblings(
        &mut self,
        arguments: &[Phrase],
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let inputs = scope.inputs.len();
        if let ([argument], true) = (arguments, scope.siblings) {
            let found = self.expr(argument, scope)?;
            if let (Kind::Input(at), [_, ..]) = (&found.kind, scope.inputs.get(inputs..)?)
                && scope.inputs[*at].signal.is_none()
            {
                scope.inputs[*at].siblings = true;
                scope.inputs[*at].span = span.span.clone();
                return Some(Expr { span: span.clone(), ..found });
            }
        }
        self.refuse(
            problem!(
                "siblings",
                span,
                "`siblings(...)` must contain one value of the signal of a plausibility rule"
            )
            .help("write the rule with `of`, and for example `siblings(noise_floor)`"),
        )
    }

    /// What a name stands for in an expression of numbers, words and conditions.
    pub fn path(&mut self, path: &str, span: &Origin, scope: &mut Scope) -> Option<Expr> {
        let expr = |kind, ty| Some(Expr { kind, ty, span: span.clone() });
        let number = |kind, dimension| Some(Expr::number(kind, dimension, span));
        if scope.words.iter().any(|word| word == path) {
            return expr(
                Kind::Constant(Scalar::Word(path.to_string())),
                Type::Word(scope.words.clone()),
            );
        }
        if let Some(found) = scope.argument(path) {
            return Some(Expr { span: span.clone(), ..found.clone() });
        }
        if let (Some(pair), Some(side)) = (scope.pair, Side::named(path)) {
            return number(Kind::Side(side), pair);
        }
        if scope.pair.is_some()
            && let Some((_, expression)) = DIFFERENCES.iter().find(|(name, _)| *name == path)
        {
            let source = Source::new(format!("difference `{path}`"), *expression);
            let text = Text { text: (*expression).to_string(), span: source.whole(), exact: true };
            let phrase = from_pest::expression(&text, self.problems)?;
            return self.expr(&phrase, scope);
        }
        if let (Some(dimension), "value") = (scope.value, path) {
            return number(Kind::Input(0), dimension);
        }
        if let Some(found) = self.group_path(path, span, scope) {
            return found;
        }
        if scope.limits.is_some() && Statistic::named(path).is_some() {
            return self.bare_statistic(path, span, scope);
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
            let kind = match parameter.value {
                Ok(value) => Kind::Constant(value),
                Err(optional) => Kind::NotStated(path.to_string(), optional),
            };
            return expr(kind, parameter.ty);
        }
        if self.names.defines.contains_key(path) {
            self.unconfirmed |= self.values.open(path);
            return self.defined(path, span, scope);
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
            return number(Kind::Constant(Scalar::Number(unit.factor)), unit.dimension);
        }
        self.unknown_name(path, span, scope);
        None
    }

    /// What a definition stands for.
    fn defined(&mut self, name: &str, span: &Span, scope: &mut Scope) -> Option<Expr> {
        if let Some(arguments) = self.names.arguments.get(name) {
            let help = format!("write `{name}({})`", arguments.join(", "));
            let problem = problem!("arguments", span, "`{name}` needs arguments");
            return self.refuse(problem.help(help));
        }
        let define = self.names.defines.get(name)?.clone();
        self.used_defines.insert(name.to_string());
        let outside = std::mem::take(&mut scope.arguments);
        let found = self.inside("define", name, span, |checker| checker.expr(&define, scope));
        scope.arguments = outside;
        found
    }

    /// What a definition with arguments stands for: `comfort(ay, 2 m/s^2)`.
    pub fn defined_of(
        &mut self,
        name: &At<String>,
        given: &[Phrase],
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let names = self.names.arguments.get(&name.node)?.clone();
        let define = self.names.defines.get(&name.node)?.clone();
        self.unconfirmed |= self.values.open(&name.node);
        self.used_defines.insert(name.node.clone());
        if names.len() != given.len() {
            let (count, found) = (names.len(), given.len());
            let s = if count == 1 { "" } else { "s" };
            let says = format!("`{}` has {count} argument{s}; found {found}", name.node);
            let help = format!("write `{}({})`", name.node, names.join(", "));
            return self.refuse(error("arguments", says, name).help(help));
        }
        let found = all(given.iter().map(|argument| self.expr(argument, scope)))?;
        let arguments = names.into_iter().zip(found).collect();
        let outside = std::mem::replace(&mut scope.arguments, arguments);
        let found = self.inside("define", &name.node, span, |checker| checker.expr(&define, scope));
        scope.arguments = outside;
        Some(Expr { span: span.clone(), ..found? })
    }

    /// A name among samples: a side, a channel, a signal, or a number.
    pub fn samples_named(&mut self, name: &str, span: &Origin, scope: &mut Scope) -> Option<Expr> {
        if let Some(found) = scope.argument(name) {
            return Some(Expr { span: span.clone(), ..found.clone() });
        }
        if let Some(side) = Side::named(name).filter(|_| !self.is_signal(name)) {
            return self.side_of_own(side, span, scope);
        }
        if self.is_signal(name) {
            return self.signal_at(name, span, scope);
        }
        if self.is_frequency(name) {
            let (dimension, points) = (Dimension::FREQUENCY, Points::Spectrum);
            return Some(Expr::samples(Kind::Frequency, dimension, points, span));
        }
        if self.names.defines.contains_key(name) {
            return self.defined(name, span, scope);
        }
        let data = self.names.columns.iter().chain(&self.names.vehicle);
        let known = self.names.parameter_blocks.contains_key(name)
            || name.contains('.')
            || data.into_iter().any(|datum| datum.name == name)
            || Unit::parse(name).is_ok();
        if !known {
            self.unknown_signal(name, span);
            return None;
        }
        let number = self.path(name, span, &mut Scope::section())?;
        self.number_type(&number)?;
        Some(number)
    }

    /// `start`, `end` and `length` of the section on the axis, unless the protocol has columns of
    /// these names.
    fn extent_path(&self, path: &str, span: &Origin, scope: &Scope) -> Option<Expr> {
        let axis = self.axis.as_ref().filter(|_| scope.section)?.unit.dimension;
        let number = |kind| Expr::number(kind, axis, span);
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
        let of = |data: &[Datum], wanted: &str| {
            let asked = role.is_empty() || role == wanted;
            data.iter().position(|datum| asked && datum.name == name)
        };
        let vehicle = of(&self.names.vehicle, "vehicle");
        let column = of(&self.names.columns, "section").or_else(|| {
            let asked = vehicle.is_none() && (role.is_empty() || role == "section");
            if asked { self.campaign_column(name, span) } else { None }
        });
        if column.is_some() && vehicle.is_some() {
            return Some(
                self.refuse(
                    problem!(
                        "ambiguous",
                        span,
                        "`{name}` is both a vehicle datum and a section column"
                    )
                    .help(format!("write `vehicle.{name}` or `section.{name}`")),
                ),
            );
        }
        if let Some(index) = column {
            let is_zone = matches!(self.zone.as_ref().map(|zone| &zone.kind), Some(Kind::Column(zone)) if *zone == index);
            let zone = scope.zone.clone().filter(|_| is_zone);
            let kind = match zone.map(|zone| Kind::Constant(Scalar::Word(zone))) {
                None if scope.section => Some(Kind::Column(index)),
                of_zone => of_zone,
            };
            if let Some(kind) = kind {
                let ty = datum_type(&self.names.columns[index].kind);
                return Some(Some(Expr { kind, ty, span: span.clone() }));
            }
            let problem = problem!(
                "no-section",
                span,
                "`{path}` differs between sections, but this expression has one value for all sections"
            );
            // Only the scope of limits has the vehicle but no section.
            return Some(self.refuse(match (scope.vehicle, is_zone) {
                (true, true) => problem.help("a limit that depends on the zone ends with `for each zone`"),
                (true, false) => problem
                    .help("a bound can use a mean, such as `mean of radius`; a limit for some sections ends with `for sections where ...`; a limit of `each` value can depend on its section"),
                (false, _) => problem,
            }));
        }
        let index = vehicle?;
        if scope.vehicle {
            let ty = datum_type(&self.names.vehicle[index].kind);
            return Some(Some(Expr { kind: Kind::Vehicle(index), ty, span: span.clone() }));
        }
        Some(
            self.refuse(
                problem!(
                    "no-vehicle",
                    span,
                    "`{path}` depends on the vehicle; expected a number that the protocol fixes"
                )
                .help("make it a `parameter`, which a campaign can set"),
            ),
        )
    }

    /// The column that says to which campaign a section belongs: it need not be declared, and is
    /// there once something asks for it. A column that the protocol declares by this name goes
    /// before it.
    pub fn campaign_column(&mut self, name: &str, span: &Span) -> Option<usize> {
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
                optional: None,
                computed: false,
                range: None,
                span: span.clone(),
            });
            self.names.columns.len() - 1
        })
    }

    /// Whether `word of ...` is a product, because a parameter, definition or datum has this name.
    pub fn is_number_name(&self, phrase: &Phrase) -> bool {
        let Node::Path(path) = &phrase.node else { return false };
        let datum = |role: &str, data: &[Datum]| {
            let name = path.strip_prefix(role).unwrap_or(path);
            data.iter().any(|datum| datum.name == *path || datum.name == name)
        };
        Reducer::named(path).is_none()
            && (self.names.parameter_blocks.contains_key(path)
                || self.names.defines.contains_key(path)
                || datum("section.", &self.names.columns)
                || datum("vehicle.", &self.names.vehicle))
    }

    /// Whether a definition or a datum has this name.
    pub fn is_declared(&self, name: &str) -> bool {
        let mut data = self.names.columns.iter().chain(&self.names.vehicle);
        data.any(|datum| datum.name == name) || self.names.defines.contains_key(name)
    }

    /// Whether the block of a name has an error that was already reported.
    pub fn is_failed(&self, path: &str) -> bool {
        let name = path.split_once('.').map_or(path, |(_, name)| name);
        self.names.failed.contains(name)
    }

    fn unknown_name(&mut self, path: &str, span: &Span, scope: &Scope) {
        if self.is_failed(path) {
            return;
        }
        if self.is_signal(path) {
            let help = format!("take a number from it: `mean of {path}`");
            self.tell(
                problem!("signal-not-number", span, "expected a number, `{path}` is a signal")
                    .help(help),
            );
            return;
        }
        let digits = path.find(|c: char| !c.is_ascii_digit()).unwrap_or(0);
        if digits > 0 {
            let (number, unit) = path.split_at(digits);
            let near = Unit::parse(unit).err().and_then(|unknown| unknown.near);
            let near = near.map(|near| format!("did you mean `{number} {near}`?"));
            let help = near.or_else(|| idiom(unit).map(str::to_string));
            self.tell(problem!("unknown-unit", span, "`{unit}` is not a known unit").help_if(help));
            return;
        }
        let mut known: Vec<String> =
            self.names.parameter_blocks.keys().chain(self.names.defines.keys()).cloned().collect();
        if scope.pair.is_some() {
            known.extend(Side::ALL.map(|side| side.in_words().to_string()));
        }
        if scope.values().is_some() {
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
        let problem = problem!("unknown-name", span, "nothing is called `{path}` here");
        self.tell(or_idiom(problem, path, &known));
    }

    /// The choice that a bare word stands for: the word itself, or the value of the choice
    /// parameter of this name.
    pub fn choice_word(&mut self, word: &str, span: &Span) -> Option<String> {
        if !self.names.parameter_blocks.contains_key(word) {
            return Some(word.to_string());
        }
        match self.parameter(word, span)?.value {
            Ok(Scalar::Word(choice)) => Some(choice),
            _ => Some(word.to_string()),
        }
    }
}

fn datum_type(kind: &DatumKind) -> Type {
    match kind {
        DatumKind::Number(unit) => Type::Number(unit.dimension),
        DatumKind::Words(words) => Type::Word(words.clone()),
        DatumKind::Flag => Type::Flag,
        // The words are not known before the run.
        DatumKind::AnyWord | DatumKind::Campaign => Type::Word(Vec::new()),
    }
}
