//! Clauses of a standard or law, and what stands for each.

/// A clause, with the rules that compute what it asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clause {
    pub clause: String,
    /// What it asks for, in own words, by each block that names it.
    pub says: Vec<String>,
    /// Kind and name of each rule: `quantity Y_max`.
    pub rules: Vec<String>,
    /// Who judges what no rule computes.
    pub judged_by: Option<String>,
}

/// What stands for a clause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    Computed,
    /// A rule computes a part, and a person judges the rest.
    ComputedAndJudged,
    Judged,
    NotCovered,
}

impl Clause {
    pub fn standing(&self) -> Standing {
        match (self.rules.is_empty(), &self.judged_by) {
            (false, None) => Standing::Computed,
            (false, Some(_)) => Standing::ComputedAndJudged,
            (true, Some(_)) => Standing::Judged,
            (true, None) => Standing::NotCovered,
        }
    }
}

impl Standing {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Computed => "computed",
            Self::ComputedAndJudged => "computed, and judged by a person",
            Self::Judged => "judged by a person",
            Self::NotCovered => "not covered",
        }
    }
}
