//! Checks what decides between values: `a when b, otherwise c`, and comparisons with words.

use super::{
    conditions::impossible, evaluate::words, expressions::origin, names::bare_word, prelude::*,
};
use crate::syntax::phrase::Number;

impl Checker<'_> {
    /// The value of the first case whose condition holds, else of the last: `a when b, otherwise c`.
    pub fn cases(
        &mut self,
        arms: &[(Phrase, Phrase)],
        otherwise: Option<&Phrase>,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let mut found: Vec<(Expr, Expr)> = Vec::new();
        let mut last: Option<Expr> = None;
        let mut values: Vec<Expr> = Vec::new();
        let mut ok = true;
        let told = self.problems.0.len();
        let written: Vec<&Phrase> = arms.iter().map(|(value, _)| value).chain(otherwise).collect();
        let always = otherwise.map(|value| (value, None));
        let arms = arms.iter().map(|(value, condition)| (value, Some(condition)));
        for (value, condition) in arms.chain(always) {
            let before = scope.asked();
            let condition = condition.map(|condition| self.condition(condition, scope));
            // The case of a condition that parameters or the zone make false is still checked, but
            // needs no records and no values.
            let value = self.expr(value, scope);
            let Some(value) = value.filter(|_| !matches!(condition, Some(None))) else {
                ok = false;
                continue;
            };
            values.push(value.clone());
            let condition = condition.flatten();
            let known = match condition.as_ref().map(|condition| &condition.kind) {
                Some(Kind::Constant(Scalar::Flag(holds))) => Some(*holds),
                Some(_) => None,
                None => Some(true),
            };
            match condition.filter(|_| known.is_none()) {
                _ if last.is_some() => scope.forget(before),
                Some(condition) => found.push((value, condition)),
                None if known == Some(true) => last = Some(value),
                None => scope.forget(before),
            }
        }
        if !ok {
            self.words_of_nothing(&written, told, span);
        }
        let (first, rest) = values.split_first().filter(|_| ok)?;
        for other in rest {
            self.alike(first, other)?;
        }
        let of_samples = |(_, on): &(Expr, Expr)| matches!(on.ty, Type::SampleFlags { .. });
        if last.is_none() && !found.is_empty() && !found.iter().any(of_samples) {
            self.covered(found.iter().map(|(_, condition)| condition), span);
        }
        self.select(found, last, span, scope.zone.as_deref())
    }

    /// One problem for cases that are all unknown words, in place of one for each: `low when ...,
    /// otherwise high`. `told` is the number of problems before them.
    fn words_of_nothing(&mut self, written: &[&Phrase], told: usize, span: &Span) {
        let words: Option<Vec<&str>> = written.iter().copied().map(bare_word).collect();
        let Some(words) = words.filter(|words| words.len() > 1) else { return };
        let new = self.problems.0.get(told..).unwrap_or_default();
        if new.len() != words.len() || new.iter().any(|problem| problem.code != "unknown-name") {
            return;
        }
        self.problems.0.truncate(told);
        let says = format!("`{}` are words, which only data can have", words.join("`, `"));
        let help = format!(
            "declare a column of the table of sections: a `section` block with `one of  {}`; limits of some sections end with `for sections where ...`",
            words.join(", ")
        );
        self.tell(error("unknown-name", says, span).help(help));
    }

    /// The value of the first condition that holds, of which all have the same type.
    pub fn select(
        &mut self,
        arms: Vec<(Expr, Expr)>,
        otherwise: Option<Expr>,
        span: &Origin,
        zone: Option<&str>,
    ) -> Option<Expr> {
        if arms.is_empty() {
            if otherwise.is_none() {
                let says = match zone {
                    Some(zone) => format!("no case of this applies in zone {zone}"),
                    None => "no case of this can apply with the parameters as set".into(),
                };
                self.tell(error("no-case", says, span));
            }
            return otherwise;
        }
        let all: Vec<&Expr> = arms.iter().map(|(value, _)| value).chain(&otherwise).collect();
        let ty = match &all[0].ty {
            Type::Number(dimension) | Type::Samples { dimension, .. } => {
                let conditions = arms.iter().map(|(_, condition)| condition);
                let all: Vec<&Expr> = all.iter().copied().chain(conditions).collect();
                self.of_one_record(*dimension, &all)?
            }
            ty => ty.clone(),
        };
        Some(Expr { kind: Kind::Cases(arms, otherwise.map(Box::new)), ty, span: span.clone() })
    }

    /// Whether one of the conditions certainly holds wherever the present expression is evaluated.
    pub fn always_one<'e>(&self, conditions: impl Iterator<Item = &'e Expr>) -> bool {
        let assumed = self.assumed.iter().map(|condition| (condition, true));
        let all: Vec<(&Expr, bool)> =
            assumed.chain(conditions.map(|condition| (condition, false))).collect();
        impossible(&all)
    }

    /// Warns unless one of the conditions certainly holds.
    fn covered<'e>(&mut self, conditions: impl Iterator<Item = &'e Expr>, span: &Span) {
        if !self.always_one(conditions) && !self.partial {
            let says = "if none of these conditions holds, this has no value";
            self.problems
                .push(warning("no-otherwise", says, span).help("end it with `, otherwise ...`"));
        }
    }

    /// Both must have the same type and dimension; otherwise a problem points at both.
    fn alike(&mut self, first: &Expr, other: &Expr) -> Option<()> {
        let same = match (&first.ty, &other.ty) {
            (Type::Word(_), Type::Word(_)) | (Type::Flag, Type::Flag) => true,
            (Type::Number(_) | Type::Samples { .. }, Type::Number(_) | Type::Samples { .. }) => {
                first.dimension() == other.dimension()
            }
            _ => false,
        };
        if same {
            return Some(());
        }
        let (a, b) = (first.ty.in_words(), other.ty.in_words());
        self.refuse(
            problem!("unit-mismatch", other, "one case is {a}, another {b}")
                .label(b)
                .also(first, a),
        )
    }

    /// `a is b`, of words, conditions or numbers.
    pub fn equality(
        &mut self,
        operator: Operator,
        left: &Phrase,
        right: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(left) = self.expr(left, scope) else {
            // The right side is checked as well, unless it may be a word of the part with the
            // error.
            if !matches!(right.node, Node::Path(_)) {
                self.expr(right, scope);
            }
            return None;
        };
        let constant =
            |value| Expr { kind: Kind::Constant(value), ty: left.ty.clone(), span: origin(right) };
        let right = match (&left.ty, &right.node) {
            (Type::Word(choices), _) => {
                constant(Scalar::Word(self.compared_word(&left, choices, right)?))
            }
            (Type::Flag, Node::Path(path)) if path == "true" || path == "false" => {
                constant(Scalar::Flag(path == "true"))
            }
            _ => {
                let right = self.expr(right, scope)?;
                if left.ty != right.ty {
                    return self.mismatch("compared", &left, &right);
                }
                right
            }
        };
        self.folded(Expr::flag(operator, left, right, span), scope)
    }

    /// The word with which a word is compared: one of its choices.
    fn compared_word(&mut self, left: &Expr, choices: &[String], right: &Phrase) -> Option<String> {
        let word = match &right.node {
            Node::Path(word) | Node::Quoted(word) => word.clone(),
            Node::Number(Number { value, unit: None }) => value.to_string(),
            _ => {
                return self.refuse(
                    problem!(
                        "not-a-word",
                        right,
                        "`{}` is a word and can only be compared with a word",
                        words(left)
                    )
                    .also(left, "a word"),
                );
            }
        };
        // A choice parameter stands for its value, unless a word with its name is among the choices.
        let meant = choices.contains(&word) || matches!(right.node, Node::Quoted(_));
        let word = if meant { word } else { self.choice_word(&word, &right.place())? };
        let of_any = self.word_of_any(left);
        if of_any == Some(DatumKind::Campaign) {
            self.campaigns.push(Spanned::new(word.clone(), right.place()));
        } else if of_any.is_some() {
            self.is_no_datum(&word, right)?;
        } else if !choices.contains(&word) {
            return self.refuse(
                problem!("unknown-choice", right, "`{}` cannot be `{word}`", words(left))
                    .also(left, format!("one of {}", choices.join(", ")))
                    .suggest(&word, choices),
            );
        }
        Some(word)
    }

    /// The kind of a datum whose words are not known before the run; of several cases, of the first
    /// that is one.
    fn word_of_any(&self, of: &Expr) -> Option<DatumKind> {
        let kind = match &of.kind {
            Kind::Column(index) => &self.names.columns[*index].kind,
            Kind::Vehicle(index) => &self.names.vehicle[*index].kind,
            Kind::Cases(arms, otherwise) => {
                let mut values = arms.iter().map(|(value, _)| value).chain(otherwise.as_deref());
                return values.find_map(|value| self.word_of_any(value));
            }
            _ => return None,
        };
        matches!(kind, DatumKind::AnyWord | DatumKind::Campaign).then(|| kind.clone())
    }

    /// Refuses a word without quotes that is the name of a datum: no list tells which is meant.
    fn is_no_datum(&mut self, word: &str, written: &Phrase) -> Option<()> {
        let names = &self.names;
        let mut data = names.columns.iter().chain(&names.vehicle);
        let Some(datum) = data.find(|datum| datum.name == word) else { return Some(()) };
        if matches!(written.node, Node::Quoted(_)) {
            return Some(());
        }
        let problem = problem!("not-a-word", written, "`{word}` is the name of a datum")
            .also(&datum.span, "declared here")
            .help(format!("a word is only compared with a word; if it is meant: `\"{word}\"`"));
        self.refuse(problem)
    }
}
