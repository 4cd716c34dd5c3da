//! Refuses texts that could overflow the stack of the parser, before they are parsed.

use crate::problem::{Problem, error};
use crate::syntax::document::Text;

/// Largest nesting of parentheses, magnitudes, `not`, signs and `of`. Rules in use are far below
/// it.
const DEEPEST: usize = 30;
/// Largest number of operators between two commas. Each operator of a sum adds a level to the tree.
const MOST_OPERATORS: usize = 60;
/// Largest number of words, numbers and signs.
const LONGEST: usize = 2000;

/// Counts at one level of parentheses.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    /// Signs, `not` and `of` since the last word or comma that ends their operand.
    prefixes: usize,
    bars: usize,
    /// Open `larger of` and `smaller of`, as in `larger of a, larger of b, c`: a comma does not end
    /// them.
    extremes: usize,
    operators: usize,
}

impl Level {
    fn depth(self) -> usize {
        self.prefixes + self.bars.div_ceil(2) + self.extremes
    }

    /// After `and`, `is` and the like.
    fn separate(&mut self) {
        *self = Self { extremes: self.extremes, operators: self.operators, ..Self::default() };
    }

    /// After a comma, `when` or `otherwise`.
    fn finish(&mut self) {
        self.separate();
        self.operators = 0;
    }
}

#[derive(Debug)]
struct Measured {
    levels: Vec<Level>,
    deepest: usize,
    most_operators: usize,
    tokens: usize,
    /// Whether the last item was an operand: a minus after it is a subtraction, not a sign.
    operand: bool,
}

impl Measured {
    fn level(&mut self) -> &mut Level {
        if self.levels.is_empty() {
            self.levels.push(Level::default());
        }
        let last = self.levels.len() - 1;
        &mut self.levels[last]
    }

    fn word(&mut self, word: &str) {
        self.tokens += 1;
        self.operand = false;
        match word {
            "not" | "of" => self.level().prefixes += 1,
            "larger" | "smaller" => self.level().extremes += 1,
            "and" | "or" => {
                self.level().operators += 1;
                self.level().separate();
            }
            "is" => self.level().separate(),
            "when" | "otherwise" | "then" => self.level().finish(),
            _ => self.operand = true,
        }
    }

    fn sign(&mut self, c: char) {
        self.tokens += 1;
        match c {
            '(' => self.levels.push(Level::default()),
            ')' if self.levels.len() > 1 => drop(self.levels.pop()),
            '|' => self.level().bars += 1,
            ',' => self.level().finish(),
            '-' | '−' if !self.operand => self.level().prefixes += 1,
            '+' | '-' | '−' | '*' | '·' | '/' => self.level().operators += 1,
            _ => {}
        }
        self.operand = matches!(c, ')' | '|');
    }

    fn look(&mut self) {
        let depth =
            self.levels.len() + self.levels.iter().map(|level| level.depth()).sum::<usize>();
        self.deepest = self.deepest.max(depth);
        self.most_operators = self.most_operators.max(self.level().operators);
    }
}

/// A problem if parsing the text could overflow the stack or take too long.
pub(super) fn too_deep(text: &Text) -> Option<Problem> {
    let mut found = Measured {
        levels: vec![Level::default()],
        deepest: 0,
        most_operators: 0,
        tokens: 0,
        operand: false,
    };
    let mut word = String::new();
    for c in text.text.chars().chain([' ']) {
        if c.is_alphanumeric() || c == '_' || c == '.' {
            word.push(c);
            continue;
        }
        if !word.is_empty() {
            found.word(&word);
            word.clear();
        }
        if !c.is_whitespace() {
            found.sign(c);
        }
        found.look();
        if found.deepest > DEEPEST || found.tokens > LONGEST {
            break;
        }
    }
    let says = if found.deepest > DEEPEST {
        format!("this is nested deeper than {DEEPEST} levels")
    } else if found.tokens > LONGEST {
        format!("this phrase has more than {LONGEST} words, numbers and signs")
    } else if found.most_operators > MOST_OPERATORS {
        format!(
            "there are {} operators in a row; a rule can have at most {MOST_OPERATORS}",
            found.most_operators
        )
    } else {
        return None;
    };
    let end = text.text.char_indices().map(|(at, _)| at).nth(40).unwrap_or(text.text.len());
    Some(
        error("too-deep", says, &text.place(0..end))
            .help("give names to parts of it with `define`"),
    )
}
