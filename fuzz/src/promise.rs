//! What is promised of every message.

use fishplate::problem::{Problem, Problems, Severity};
use fishplate::source::Span;

/// Messages looked at in print; the same code prints all others.
const PRINTED: usize = 8;

/// Every place lies inside its text, every message says something, and no control character reaches
/// the terminal.
#[track_caller]
pub fn told(problems: &[Problem]) {
    for problem in problems {
        let code = problem.code;
        assert!(code != "internal", "{}", problem.says);
        assert!(!problem.says.trim().is_empty(), "`{code}` says nothing");
        let places = problem.at.iter().chain(problem.also.iter().map(|(place, _)| place));
        places.for_each(|place| inside(code, place));
    }
    for problem in problems.iter().take(PRINTED) {
        let printed = problem.render(false);
        let raw = printed.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
        assert!(raw.is_none(), "`{}` prints {raw:?}:\n{printed}", problem.code);
    }
}

#[track_caller]
fn inside(code: &str, place: &Span) {
    let (text, range) = (&place.source.text, place.start..place.end);
    assert!(
        text.get(range.clone()).is_some(),
        "`{code}` points at {range:?} of {} bytes",
        text.len()
    );
}

/// As [`told`], and every error of a text that is not empty says where it is.
#[track_caller]
pub fn placed(problems: &Problems) {
    told(&problems.0);
    for problem in problems.0.iter().filter(|problem| problem.severity == Severity::Error) {
        assert!(problem.at.is_some(), "`{}` has no place: {}", problem.code, problem.says);
    }
}

/// The codes of the errors, each once: where a form gives less narrow places, errors of one field
/// fall together.
pub fn codes(problems: &Problems) -> Vec<&'static str> {
    let errors = problems.0.iter().filter(|problem| problem.severity == Severity::Error);
    let mut codes: Vec<_> = errors.map(|problem| problem.code).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}
