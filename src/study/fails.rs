//! Bit set of the selections that do not meet a limit: one bit for each pair of half selections.

/// One bit per row and column.
#[derive(Clone, Debug)]
pub struct Fails {
    pub rows: usize,
    pub columns: usize,
    words: usize,
    bits: Vec<u64>,
    /// For every `STEP`th position in the order of the columns, the set of all columns from there
    /// on.
    from: Vec<u64>,
}

/// Columns set one by one before whole sets are used.
const STEP: usize = 64;

impl Fails {
    pub fn new(rows: usize, columns: usize) -> Self {
        let words = columns.div_ceil(64).max(1);
        Self { rows, columns, words, bits: vec![0; rows * words], from: Vec::new() }
    }

    #[inline]
    pub fn fail(&mut self, row: u32, column: u32) {
        self.bits[row as usize * self.words + column as usize / 64] |= 1 << (column % 64);
    }

    /// As [`Self::fail`] where it fails.
    #[inline(always)]
    pub fn set(&mut self, row: u32, column: u32, fails: bool) {
        self.bits[row as usize * self.words + column as usize / 64] |=
            u64::from(fails) << (column % 64);
    }

    /// Sets the order of columns for the following calls of `between`.
    #[inline(always)]
    pub fn order(&mut self, columns: &[u32]) {
        let cuts = columns.len().div_ceil(STEP);
        self.from.clear();
        self.from.resize((cuts + 1) * self.words, 0);
        for cut in (0..cuts).rev() {
            let (here, after) = self.from.split_at_mut((cut + 1) * self.words);
            let here = &mut here[cut * self.words..];
            here.copy_from_slice(&after[..self.words]);
            for column in &columns[cut * STEP..((cut + 1) * STEP).min(columns.len())] {
                here[*column as usize / 64] |= 1 << (*column % 64);
            }
        }
    }

    /// Sets a row in all columns between two positions in the order.
    #[inline(always)]
    pub fn between(&mut self, row: u32, columns: &[u32], from: usize, to: usize) {
        let (first, last) = (from.div_ceil(STEP), to / STEP);
        if first >= last {
            columns[from..to].iter().for_each(|column| self.fail(row, *column));
            return;
        }
        for part in [from..first * STEP, last * STEP..to] {
            columns[part].iter().for_each(|column| self.fail(row, *column));
        }
        let start = row as usize * self.words;
        let set = |cut: usize| &self.from[cut * self.words..(cut + 1) * self.words];
        let words = self.bits[start..start + self.words].iter_mut();
        for ((word, set), rest) in words.zip(set(first)).zip(set(last)) {
            *word |= set & !rest;
        }
    }

    /// Whether a selection is in the set.
    pub fn has(&self, row: usize, column: usize) -> bool {
        self.bits[row * self.words + column / 64] >> (column % 64) & 1 == 1
    }

    pub fn count(&self) -> u64 {
        // Uses the population-count instruction where the processor has one.
        pulp::Arch::new()
            .dispatch(|| self.bits.iter().map(|word| u64::from(word.count_ones())).sum())
    }

    /// Takes the union with another set.
    pub fn join_all(&mut self, other: &Self) {
        for (word, other) in self.bits.iter_mut().zip(&other.bits) {
            *word |= other;
        }
    }

    /// The words of the set, row by row; bits beyond the last column are zero.
    pub fn words(&self) -> &[u64] {
        &self.bits
    }

    pub fn words_mut(&mut self) -> &mut [u64] {
        &mut self.bits
    }

    /// Number of selections not in the set, by row and by column.
    pub fn unmarked(&self) -> (Vec<u64>, Vec<u64>) {
        let mut columns = vec![self.rows as u64; self.columns];
        let rows = self
            .bits
            .chunks(self.words)
            .map(|words| {
                let mut marked = 0;
                for (at, word) in words.iter().enumerate() {
                    let mut word = *word;
                    marked += u64::from(word.count_ones());
                    while word != 0 {
                        columns[at * 64 + word.trailing_zeros() as usize] -= 1;
                        word &= word - 1;
                    }
                }
                self.columns as u64 - marked
            })
            .collect();
        (rows, columns)
    }

    /// Increments the count of every selection in the set.
    pub fn tally(&self, counts: &mut [u8]) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                let count = &mut counts[row * self.columns + column];
                *count = count.saturating_add(u8::from(self.has(row, column)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole sets and single columns together are the columns between two positions.
    #[test]
    fn ranges_of_an_order_are_marked() {
        let order: Vec<u32> = (0..331_u32).map(|k| k * 97 % 331).collect();
        for (from, to) in [(0, 331), (0, 0), (5, 60), (63, 65), (64, 128), (1, 330), (200, 331)] {
            let (mut fails, mut single) = (Fails::new(2, 331), Fails::new(2, 331));
            fails.order(&order);
            fails.between(1, &order, from, to);
            order[from..to].iter().for_each(|column| single.fail(1, *column));
            assert_eq!(fails.words(), single.words(), "{from} to {to}");
            assert_eq!(fails.count(), (to - from) as u64);
        }
    }
}
