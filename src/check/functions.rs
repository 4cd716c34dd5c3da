//! Functions of expressions, by name.

use super::prelude::*;
use crate::catalog::{FUNCTIONS, Function, MetricEntry, SIGNAL_FUNCTIONS, Signature};
use crate::syntax::idiom;

impl Checker<'_> {
    /// The function of a name with this number of arguments; a problem where there is none.
    pub fn function(&mut self, name: &At<String>, count: usize) -> Option<&'static Function> {
        let Some(found) = function(&name.node) else {
            let problem = problem!("unknown-function", name, "`{}` is not a function", name.node);
            return self.refuse(if MetricEntry::called(&name.node).is_some() {
                problem.help("it is a metric, which compares two signals: use it in the `metric` of a quantity")
            } else if is_signal_function(&name.node) {
                problem.help(format!("it gives a signal, expected a number: `rms of {}(...)`", name.node))
            } else {
                let own = self.names.arguments.keys().map(String::as_str);
                let known = FUNCTIONS.iter().map(|function| function.name);
                let known: Vec<&str> =
                    known.chain(SIGNAL_FUNCTIONS.map(|(name, ..)| name)).chain(own).collect();
                or_idiom(problem, &name.node, known)
            });
        };
        let needed = if found.signature == Signature::PairSame { 2 } else { 1 };
        if count != needed {
            return self.refuse(problem!(
                "arguments",
                name,
                "wrong number of arguments of `{}`: expected {needed}, found {count}",
                found.name
            ));
        }
        Some(found)
    }

    /// The dimension of the function's value; a problem at the argument whose dimension does not
    /// agree.
    pub fn function_type(&mut self, function: &Function, arguments: &[Expr]) -> Option<Dimension> {
        let (first, second) = (arguments.first()?, arguments.get(1));
        let (name, of) = (function.name, first.dimension());
        let (says, at) = match function.signature {
            Signature::Same => return Some(of),
            Signature::ToPlain => return Some(Dimension::ONE),
            Signature::Plain if of == Dimension::ONE => return Some(of),
            Signature::Plain => {
                let says =
                    format!("`{name}` needs a plain number or an angle, this is {}", of.in_words());
                (says, first)
            }
            Signature::Root => match of.power(0.5) {
                Some(root) => return Some(root),
                None => (format!("{} has no square root", of.in_words()), first),
            },
            Signature::PairSame if second?.dimension() == of => return Some(of),
            Signature::PairSame => {
                let says = format!(
                    "`{name}` needs two arguments of the same dimension, these are {} and {}",
                    of.in_words(),
                    second?.dimension().in_words()
                );
                (says, second?)
            }
        };
        let pair = (function.signature == Signature::PairSame).then_some(first);
        self.refuse(error("unit-mismatch", says, at).also_if(pair, of.in_words()))
    }
}

/// The function of a name.
pub fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// Whether it is a function of signals along the axis.
pub fn is_signal_function(name: &str) -> bool {
    SIGNAL_FUNCTIONS.iter().any(|(known, ..)| *known == name)
}

/// The problem of an unknown word, with how the language says it, else with the nearest known word.
pub fn or_idiom(
    problem: Problem,
    word: &str,
    known: impl IntoIterator<Item = impl AsRef<str>>,
) -> Problem {
    match idiom(word) {
        Some(help) => problem.help(help),
        None => problem.suggest(word, known),
    }
}
