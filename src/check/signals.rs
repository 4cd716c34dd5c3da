//! Checks what only expressions over samples have: channels at positions, filters inside
//! expressions, operations along the axis.

use super::{functions::or_idiom, names::Signal, prelude::*, steps::after};
use crate::syntax::phrase::Step as WrittenStep;

impl Checker<'_> {
    /// The signal that an expression stands for at the given positions.
    pub fn signal(&mut self, phrase: &Phrase, at: &Assignment) -> Option<Expr> {
        self.expr(phrase, &mut Scope::samples(at, None))
    }

    /// `Y through LP20`, `Y through low-pass 10 Hz`.
    pub fn filtered(
        &mut self,
        inner: &Phrase,
        steps: &[At<WrittenStep>],
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let inner = self.expr(inner, scope);
        let steps = self.steps_of(steps);
        let (inner, steps) = (inner?, steps?);
        self.step_order(&steps, false)?;
        if let Some(window) = steps.iter().find(|step| !step.kind.keeps_samples()) {
            let says = "a filter inside a signal must keep the samples; this one has a window or resampling";
            return self
                .refuse(error("window-in-signal", says, &span).also(&window.span, "this step"));
        }
        let points = self.of_record(&inner, &span)?;
        let dimension = after(&steps, inner.dimension());
        let kind = Kind::Filtered(Box::new(inner), steps);
        Some(Expr::samples(kind, dimension, points, &span))
    }

    /// An operation along the axis: `shifted(X, 2 m)`, `derivative(X)`, `integral(X, time)`.
    pub fn over_axis(
        &mut self,
        name: &At<String>,
        arguments: &[Phrase],
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        if name.node == "spectrum" {
            return self.spectrum(name, arguments, span, scope);
        }
        if name.node == "cycle_ranges" {
            return self.cycle_ranges(name, arguments, span, scope);
        }
        let shifted = name.node == "shifted";
        let (of, second) = match arguments {
            [of] if !shifted => (of, None),
            [of, second] => (of, Some(second)),
            _ => {
                let takes = if shifted {
                    "a signal and a distance"
                } else {
                    "a signal and optionally `time`"
                };
                let (name_of, count) = (&name.node, arguments.len());
                return self.refuse(problem!(
                    "arguments",
                    name,
                    "`{name_of}` needs {takes}; number of arguments: {count}"
                ));
            }
        };
        let signal = self.expr(of, scope);
        let axis = self.axis_dimension();
        let over_time = !shifted && second.is_some();
        let operation = match second {
            Some(distance) if shifted => {
                let distance = self.expr(distance, &mut scope.of_section())?;
                let found = self.number_type(&distance)?;
                let needed = format!("a distance along the axis ({})", axis.in_words());
                self.suits("distance", found == axis, &needed, found, &distance.span)?;
                AxisOperation::Shifted(Box::new(distance))
            }
            Some(second)
                if !(matches!(&second.node, Node::Path(path) if path == "time")
                    && (self.time.is_some() || axis == Dimension::TIME)) =>
            {
                let problem = problem!(
                    "arguments",
                    second,
                    "`{}` is computed over the axis or over `time`",
                    name.node
                );
                return self.refuse(if self.time.is_some() {
                    problem
                } else {
                    problem.help("the protocol has no field `time`")
                });
            }
            _ if name.node == "derivative" => AxisOperation::Derivative { over_time },
            _ => AxisOperation::Integral { over_time },
        };
        let signal = signal?;
        let points = self.of_record(&signal, &span)?;
        if over_time && signal.track() {
            return self.refuse(
                error("arguments", "the track record has no time", &span)
                    .help("remove `time`: it is then computed over the axis"),
            );
        }
        let along = if over_time { Dimension::TIME } else { axis };
        let dimension = match operation {
            AxisOperation::Shifted(_) => signal.dimension(),
            AxisOperation::Derivative { .. } => signal.dimension() / along,
            AxisOperation::Integral { .. } => signal.dimension() * along,
        };
        let kind = Kind::OverAxis(operation, Box::new(signal));
        Some(Expr::samples(kind, dimension, points, &span))
    }

    /// `mean of Y` among samples: the number of the section, taken from each of them.
    pub fn level(
        &mut self,
        reducer: &Phrase,
        of: &Phrase,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let reducer = self.reducer(reducer, true)?;
        scope.may_miss = true;
        let of = self.expr(of, scope)?;
        let of = self.at_frequencies(of)?;
        self.suits_points(reducer, &of, &span)?;
        let dimension = reducer.gives(of.dimension(), of.along(self.axis_dimension()));
        let points = of.points().unwrap_or(Points::Record);
        Some(Expr::samples(Kind::Level(reducer, Box::new(of)), dimension, points, &span))
    }

    /// Whether a channel or signal has this name.
    pub fn is_signal(&self, name: &str) -> bool {
        self.names.signals.contains_key(name)
    }

    /// The samples of one side: `simulated`, `measured`.
    pub fn side_of_own(&mut self, side: Side, span: &Origin, scope: &Scope) -> Option<Expr> {
        let Some(dimension) = scope.own_of_both else {
            return self.refuse(problem!("side", span, "`{}` can only be used as samples in the `metric` of a quantity and in plausibility rules",
                side.in_words()).help(
                "elsewhere an expression is evaluated for simulation and measurement alike",
            ));
        };
        Some(Expr::samples(Kind::Side(side), dimension, Points::Record, span))
    }

    /// Reports a name of no channel or signal.
    pub fn unknown_signal(&mut self, name: &str, span: &Span) {
        if self.is_failed(name) {
            return;
        }
        let names = &self.names;
        let problem = problem!("unknown-signal", span, "no channel or signal is called `{name}`");
        // `ay_I` is a column of the records: the channel at a position.
        let column = name.rsplit_once('_').and_then(|(channel, member)| {
            let has = |place: &&String| {
                let members = names.places.get(*place).map(|known| &known.members);
                members.is_some_and(|members| members.iter().any(|own| own == member))
            };
            let known = names.signals.get(channel).filter(|known| known.is.is_none())?;
            let place = known.places.iter().find(has)?;
            Some(format!("`{channel}` at a position: `{channel} at {place} {member}`"))
        });
        self.tell(match column {
            Some(help) => problem.help(help),
            None => or_idiom(problem, name, names.signals.keys()),
        });
    }

    /// The samples of a channel or of a computed signal at a position.
    pub fn signal_at(&mut self, name: &str, span: &Origin, scope: &Scope) -> Option<Expr> {
        let signal = self.names.signals.get(name)?.clone();
        let column = self.fill(name, &signal, span, &scope.at)?;
        let Some(is) = &signal.is else {
            let unit = signal.unit?;
            let dimension = unit.dimension;
            let kind = Kind::Channel { column, channel: name.to_string(), unit };
            let points = if signal.track { Points::Track } else { Points::Record };
            return Some(Expr::samples(kind, dimension, points, span));
        };
        let of_place = |place: &String| Some((place.clone(), scope.at.get(place)?.clone()));
        let own: Assignment = signal.places.iter().filter_map(of_place).collect();
        let found = self.inside("signal", name, span, |checker| {
            checker.expr(is, &mut Scope::samples(&own, scope.own_of_both))
        })?;
        match &signal.unit {
            Some(unit) if unit.dimension != found.dimension() => {
                let words = found.dimension().in_words();
                self.refuse(
                    problem!(
                        "unit-mismatch",
                        &signal.span,
                        "signal `{name}` is declared in {unit}, but is {words}"
                    )
                    .also(&found, words),
                )
            }
            _ => Some(found),
        }
    }

    /// The name with its places inserted; a problem if one is not stated.
    pub fn fill(
        &mut self,
        name: &str,
        signal: &Signal,
        used: &Span,
        at: &Assignment,
    ) -> Option<String> {
        let mut filled = signal.pattern.clone();
        for place in &signal.places {
            let Some(member) = at.get(place) else {
                return self.refuse(
                    problem!(
                        "open-place",
                        used,
                        "`{name}` has a position for each {place}; the {place} is not stated"
                    )
                    .also(&signal.span, format!("at each {place}"))
                    .help(format!("write `{name} at {place} ...`")),
                );
            };
            filled = filled.replace(&format!("{{{place}}}"), member);
        }
        Some(filled)
    }
}
