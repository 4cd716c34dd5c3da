//! Index of the cells of a block of text.

use super::lanes::{CHUNK, Lanes};

/// Bytes indexed at a time; the index fits the first-level cache.
const STRETCH: usize = 1 << 14;
/// Marks written at a time. A chunk has seldom more than eight; a loop over exactly those would be
/// mispredicted in most chunks.
const AT_ONCE: usize = 8;

/// The positions after each comma, line feed and quote of a block.
#[derive(Debug, Default)]
pub(super) struct Marks {
    places: Vec<usize>,
    count: usize,
    /// End of the indexed block.
    pub end: usize,
}

impl Marks {
    /// The positions in order, beginning with the start of the block.
    #[inline(always)]
    pub fn after(&self) -> &[usize] {
        &self.places[..self.count]
    }

    /// Indexes the block that begins at `start`.
    #[inline(always)]
    pub fn find(&mut self, lanes: impl Lanes, text: &[u8], start: usize) {
        // Space for the start and for one mark per byte; whole chunks are written.
        self.places.resize(1 + STRETCH + CHUNK, 0);
        self.places[0] = start;
        self.count = 1;
        self.end = text.len().min(start + STRETCH);
        let (chunks, rest) = text[start..self.end].as_chunks::<CHUNK>();
        let mut at = start;
        for chunk in chunks {
            self.push(at, lanes.ends(chunk));
            at += CHUNK;
        }
        let mut last = [0; CHUNK];
        last[..rest.len()].copy_from_slice(rest);
        self.push(at, lanes.ends(&last));
    }

    #[inline(always)]
    fn push(&mut self, at: usize, mut bits: u64) {
        let Some(places) = self.places[self.count..].first_chunk_mut::<CHUNK>() else { return };
        self.count += bits.count_ones() as usize;
        let (groups, _) = places.as_chunks_mut::<AT_ONCE>();
        for group in groups {
            for place in group {
                // Behind the last mark, something is written that the next chunk replaces.
                *place = at + bits.trailing_zeros() as usize + 1;
                bits &= bits.wrapping_sub(1);
            }
            if bits == 0 {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lanes::each;
    use super::*;

    proptest! {
        #[test]
        fn every_mark_and_no_other(text in prop::collection::vec(prop::sample::select(b"1.,\"\n\r-+ \xac\x8a".to_vec()), 0..300), start in 0..300_usize) {
            let start = start.min(text.len());
            let expected: Vec<usize> = (start..text.len()).filter(|at| b",\n\"".contains(&text[*at])).map(|at| at + 1).collect();
            each!(lanes => {
                let mut marks = Marks::default();
                marks.find(lanes, &text, start);
                prop_assert_eq!(marks.after()[0], start);
                prop_assert_eq!(&marks.after()[1..], expected.as_slice());
                prop_assert_eq!(marks.end, text.len());
            });
        }
    }

    #[test]
    fn a_stretch_has_an_end() {
        let text = vec![b','; 3 * STRETCH];
        each!(lanes => {
            let mut marks = Marks::default();
            marks.find(lanes, &text, 5);
            assert_eq!((marks.after().len(), marks.end), (STRETCH + 1, 5 + STRETCH));
        });
    }
}
