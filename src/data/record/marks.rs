//! Index of the cells of a block of text.

/// Bytes indexed at a time; the index fits the first-level cache.
const STRETCH: usize = 1 << 14;
/// Bytes compared at a time.
const CHUNK: usize = 64;

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
    pub fn after(&self) -> &[usize] {
        &self.places[..self.count]
    }

    /// Indexes the block that begins at `start`.
    pub fn find(&mut self, text: &[u8], start: usize) {
        // Space for the start and for one mark per byte; whole chunks are written.
        self.places.resize(1 + STRETCH + CHUNK, 0);
        self.places[0] = start;
        self.count = 1;
        self.end = text.len().min(start + STRETCH);
        let (chunks, rest) = text[start..self.end].as_chunks::<CHUNK>();
        let mut at = start;
        for chunk in chunks {
            self.push(at, bits(chunk));
            at += CHUNK;
        }
        let mut last = [0; CHUNK];
        last[..rest.len()].copy_from_slice(rest);
        self.push(at, bits(&last));
    }

    fn push(&mut self, at: usize, mut bits: u64) {
        let Some(places) = self.places[self.count..].first_chunk_mut::<CHUNK>() else { return };
        let mut found = 0;
        while bits != 0 {
            places[found % CHUNK] = at + bits.trailing_zeros() as usize + 1;
            found += 1;
            bits &= bits - 1;
        }
        self.count += found;
    }
}

/// A bit for each byte that ends a cell; the first byte is the lowest bit.
fn bits(chunk: &[u8; CHUNK]) -> u64 {
    // The first loop is vectorised; the product in the second one combines eight flags into one byte.
    let mut flags = [0; CHUNK];
    for (flag, byte) in flags.iter_mut().zip(chunk) {
        *flag = u8::from(matches!(byte, b',' | b'\n' | b'"'));
    }
    let (eights, _) = flags.as_chunks::<8>();
    eights.iter().rev().fold(0, |bits, eight| bits << 8 | u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_mark_and_no_other(text in prop::collection::vec(prop::sample::select(b"1.,\"\n\r-+ \xac\x8a".to_vec()), 0..300), start in 0..300_usize) {
            let start = start.min(text.len());
            let mut marks = Marks::default();
            marks.find(&text, start);
            let expected = (start..text.len()).filter(|at| b",\n\"".contains(&text[*at])).map(|at| at + 1);
            prop_assert_eq!(marks.after(), &[start].into_iter().chain(expected).collect::<Vec<_>>());
            prop_assert_eq!(marks.end, text.len());
        }
    }

    #[test]
    fn a_stretch_has_an_end() {
        let text = vec![b','; 3 * STRETCH];
        let mut marks = Marks::default();
        marks.find(&text, 5);
        assert_eq!((marks.after().len(), marks.end), (STRETCH + 1, 5 + STRETCH));
    }
}
