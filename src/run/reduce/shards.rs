//! The part of a run that reads records: each section to its values. Sections do not depend on each
//! other, so that they can be evaluated in parts, on other machines, in any order.

use std::ops::Range;

use rayon::prelude::*;

use super::prepared::{Prepared, Progress};
use super::section;
use crate::run::record::{Stretches, Work};
use crate::run::sections::Unit;
use crate::run::values::{SectionValues, Shifts};

/// A part of the sections: number `number` of `of`, counted from 0. Sections that follow each other
/// are in one part, so that a part reads one stretch of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub number: usize,
    pub of: usize,
}

impl Shard {
    pub const WHOLE: Self = Self { number: 0, of: 1 };

    /// `2/8`
    ///
    /// # Errors
    /// It has another form, or the number is not below that of all parts.
    pub fn parse(text: &str) -> Result<Self, String> {
        let form = || "a shard is `NUMBER/ALL`, the number from 0, such as `0/8`".to_string();
        let (number, of) = text.split_once('/').ok_or_else(form)?;
        let (number, of) =
            (number.trim().parse().map_err(|_| form())?, of.trim().parse().map_err(|_| form())?);
        if number >= of {
            return Err(format!("there is no shard {number} of {of}; {}", form()));
        }
        Ok(Self { number, of })
    }

    /// The numbers of its sections, of so many in all.
    pub fn range(self, sections: usize) -> Range<usize> {
        let from =
            |number: usize| (number as u128 * sections as u128 / self.of.max(1) as u128) as usize;
        from(self.number)..from(self.number + 1)
    }
}

/// The values of a section and its number.
pub type Numbered = (usize, SectionValues);

impl Prepared<'_> {
    /// The values of the sections of a shard, in the order of the sections.
    pub fn sections(&self, shard: Shard, progress: Progress<'_>) -> Vec<Numbered> {
        let of_section = |(number, mut values): (usize, Vec<SectionValues>)| {
            (number, values.pop().unwrap_or_default())
        };
        self.shifted(shard, &Shifts::NONE, progress).into_iter().map(of_section).collect()
    }

    /// The same with one value for each shift.
    pub fn shifted(
        &self,
        shard: Shard,
        shifts: &Shifts<'_>,
        progress: Progress<'_>,
    ) -> Vec<(usize, Vec<SectionValues>)> {
        let units: Vec<(usize, &Unit)> = shard
            .range(self.basis.units.len())
            .map(|number| (number, &self.basis.units[number]))
            .collect();
        let stretch = |(_, unit): &(usize, &Unit)| unit.stretch.map(|stretch| stretch.number);
        // A stretch is read by one worker. Sections by themselves differ in length: distributed one
        // by one, they keep all workers busy.
        let groups: Vec<&[(usize, &Unit)]> =
            units.chunk_by(|a, b| stretch(a).is_some() && stretch(a) == stretch(b)).collect();
        let of_group = |group: &[(usize, &Unit)]| {
            let stretches = Stretches::default();
            let work = Work { stretches: Some(&stretches), ..self.work() };
            let one = |(number, unit): &(usize, &Unit)| {
                let faulty = || vec![SectionValues::default(); shifts.offsets.len()];
                let values = if unit.fault.is_some() {
                    faulty()
                } else {
                    section::of_section(&work, unit, shifts)
                };
                progress(&unit.name);
                (*number, values)
            };
            group.iter().map(one).collect::<Vec<_>>()
        };
        groups.into_par_iter().with_max_len(1).flat_map_iter(of_group).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_all_sections_once() {
        for sections in [0, 1, 7, 412] {
            for of in 1..9 {
                let all: Vec<usize> =
                    (0..of).flat_map(|number| Shard { number, of }.range(sections)).collect();
                assert_eq!(all, (0..sections).collect::<Vec<_>>());
                let longest =
                    (0..of).map(|number| Shard { number, of }.range(sections).len()).max();
                assert!(longest <= Some(sections.div_ceil(of)), "{sections} in {of}");
            }
        }
    }

    #[test]
    fn a_shard_is_read() {
        assert_eq!(Shard::parse("2/8"), Ok(Shard { number: 2, of: 8 }));
        for wrong in ["", "8", "8/8", "1/0", "-1/8", "a/b", "1/8/2"] {
            assert!(Shard::parse(wrong).is_err(), "{wrong}");
        }
    }
}
