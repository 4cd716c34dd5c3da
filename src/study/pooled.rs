//! Statistics that are no sums: each selection is evaluated from its values, once for all
//! selections that agree in the sections that the statistic needs.

use std::collections::HashMap;

use rayon::prelude::*;

use super::{
    case::{Case, Kind, Measure, Stratum, choose},
    fails::Fails,
    halves::{Half, Halves},
    listed::{Listed, weighted},
};
use crate::metrics::moments::Moments;

/// Largest number of selections that are evaluated from their values.
const MOST: f64 = 2e6;
/// Largest number of selections that are evaluated from sums: their values take 16 bytes each.
const MOST_OF_SUMS: f64 = 3e7;

impl Measure {
    fn needs(&self, section: usize) -> bool {
        match self.estimator() {
            Some(estimator) => estimator.concerns(section),
            None => !self.values[section].is_empty(),
        }
    }

    /// Whether every selection may be evaluated.
    pub fn is_countable(&self, case: &Case) -> bool {
        if self.kind != Kind::Values {
            return true;
        }
        let most = match self.estimator() {
            Some(estimator) if estimator.from_sums(case.sections.len()).is_some() => MOST_OF_SUMS,
            _ => MOST,
        };
        let (needed, _) = self.strata(case);
        needed.iter().map(|stratum| choose(stratum.members.len(), stratum.take)).product::<f64>()
            <= most
    }

    /// The strata whose sections it needs, and the number of choices of the others.
    fn strata(&self, case: &Case) -> (Vec<Stratum>, f64) {
        let (needed, others): (Vec<&Stratum>, Vec<&Stratum>) = case
            .strata
            .iter()
            .partition(|stratum| stratum.members.iter().any(|&section| self.needs(section)));
        let times =
            others.iter().map(|stratum| choose(stratum.members.len(), stratum.take)).product();
        (needed.into_iter().cloned().collect(), times)
    }

    /// Its order statistics over all selections, however many there are, where few of them differ
    /// in what it needs.
    pub fn listed_alone(&self, case: &Case) -> Option<Listed> {
        if !self.is_countable(case) {
            return None;
        }
        let (strata, times) = self.strata(case);
        let case = Case {
            strata,
            sections: case.sections.clone(),
            quantities: Vec::new(),
            rule: case.rule,
        };
        Pooled::over(self, &Halves::of(&case)).listed(times)
    }
}

pub(super) type Ends = Option<((u32, u32), (u32, u32))>;

/// The values of a statistic for each different choice of rows and of columns.
pub struct Pooled {
    rows: Choices,
    columns: Choices,
    /// By row and column of the different choices; `None` where it is not defined.
    values: Vec<Option<f64>>,
}

/// The choices of a half that differ in the sections that are needed, in the order of the first of
/// each.
struct Choices {
    different: Vec<Vec<usize>>,
    /// Number of the first choice of each, and how many there are.
    first: Vec<u32>,
    times: Vec<f64>,
    /// For each choice of the half the number among the different ones.
    of: Vec<u32>,
}

impl Choices {
    fn new(half: &Half, measure: &Measure, sections: usize) -> Self {
        let needed: Vec<bool> = (0..sections).map(|section| measure.needs(section)).collect();
        let mut known: HashMap<Vec<usize>, u32> = HashMap::new();
        let mut found =
            Self { different: Vec::new(), first: Vec::new(), times: Vec::new(), of: Vec::new() };
        for (number, choice) in half.choices().enumerate() {
            let choice: Vec<usize> =
                choice.iter().map(|&at| at as usize).filter(|&at| needed[at]).collect();
            let at = *known.entry(choice).or_insert_with_key(|choice| {
                found.different.push(choice.clone());
                found.first.push(number as u32);
                found.times.push(0.0);
                found.different.len() as u32 - 1
            });
            found.times[at as usize] += 1.0;
            found.of.push(at);
        }
        found
    }
}

impl Pooled {
    pub fn over(measure: &Measure, halves: &Halves) -> Self {
        let sections = measure.values.len();
        let (rows, columns) = (
            Choices::new(&halves.rows, measure, sections),
            Choices::new(&halves.columns, measure, sections),
        );
        let from_sums = measure.estimator().and_then(|estimator| estimator.from_sums(sections));
        let values = match &from_sums {
            Some(from_sums) => {
                let add = |choice: &Vec<usize>| {
                    let sums = choice.iter().map(|&at| from_sums.sums[at]);
                    sums.fold(Moments::default(), Moments::plus)
                };
                let of_columns: Vec<Moments> = columns.different.iter().map(add).collect();
                let of_row = |row: &Vec<usize>| {
                    let row = add(row);
                    of_columns
                        .iter()
                        .map(|column| from_sums.over(row.plus(*column)))
                        .collect::<Vec<_>>()
                };
                rows.different.par_iter().flat_map_iter(of_row).collect()
            }
            None => {
                let of_row = |row: &Vec<usize>| {
                    let over =
                        |column: &Vec<usize>| measure.over(row.iter().chain(column).copied());
                    columns.different.iter().map(over).collect::<Vec<_>>()
                };
                rows.different.par_iter().flat_map_iter(of_row).collect()
            }
        };
        Self { rows, columns, values }
    }

    /// Marks the selections that do not meet the limit, and returns their number; `without` is told
    /// those without a value.
    pub fn mark(
        &self,
        measure: &Measure,
        fails: &mut Fails,
        mut without: impl FnMut(u32, u32),
    ) -> u64 {
        let holds: Vec<Option<bool>> =
            self.values.iter().map(|value| value.map(|value| measure.holds(value))).collect();
        let width = self.columns.different.len();
        let mut failing = 0;
        for (row, &of_row) in self.rows.of.iter().enumerate() {
            let of_row = &holds[of_row as usize * width..][..width];
            if of_row.iter().all(|holds| *holds == Some(true)) {
                continue;
            }
            for (column, &of_column) in self.columns.of.iter().enumerate() {
                match of_row[of_column as usize] {
                    Some(true) => {}
                    Some(false) => {
                        fails.fail(row as u32, column as u32);
                        failing += 1;
                    }
                    None => without(row as u32, column as u32),
                }
            }
        }
        failing
    }

    /// Row and column of the smallest and of the largest value; of equal ones, the first.
    pub fn ends(&self) -> Ends {
        let width = self.columns.different.len();
        let mut ends: Option<((f64, usize), (f64, usize))> = None;
        for (at, value) in
            self.values.iter().enumerate().filter_map(|(at, value)| Some((at, (*value)?)))
        {
            let (least, most) = ends.get_or_insert(((value, at), (value, at)));
            if value < least.0 {
                *least = (value, at);
            }
            // The last of equal ones, as where values are sorted with their places.
            if value >= most.0 {
                *most = (value, at);
            }
        }
        let place = |at: usize| (self.rows.first[at / width], self.columns.first[at % width]);
        ends.map(|(least, most)| (place(least.1), place(most.1)))
    }

    /// Order statistics, where each selection stands for so many.
    pub fn listed(&self, times: f64) -> Option<Listed> {
        let width = self.columns.different.len();
        let weight =
            |at: usize| times * self.rows.times[at / width] * self.columns.times[at % width];
        let mut list: Vec<(f64, f64)> = self
            .values
            .iter()
            .enumerate()
            .filter_map(|(at, value)| value.map(|value| (value, weight(at))))
            .collect();
        list.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        weighted(&list)
    }
}
