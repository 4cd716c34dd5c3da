//! Decoded numbers that neighbouring stretches have in common: decoded once, and kept for the next
//! stretch within a bound.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{Arc, Mutex},
};

use super::recent::{Recent, locked};

/// Rows of a block: a row group with at most so many is one block, a longer one is parted, since
/// some programs write a million rows in a group. At 200 Hz a block has 160 s; 24 channels of both
/// sides take 13 MB.
pub const ROWS: usize = 1 << 15;
/// Most bytes that are kept for each thread: two blocks of 24 channels of both sides and of the
/// track, since a section may lie across the end of a block. It bounds the memory, whatever the
/// length of a run and the number of runs.
const MOST: usize = 32 << 20;

/// The numbers of a column in a block, SI; `None` if one of them is missing or not finite, or the
/// block cannot be decoded.
pub type Numbers = Option<Arc<Vec<f64>>>;

/// Rows of a file that are decoded together: the file, and the first row.
pub type BlockKey = (PathBuf, usize);

/// The blocks that were used last; shared by all files of a campaign.
#[derive(Clone, Debug, Default)]
pub struct Decoded {
    blocks: Arc<Mutex<Recent<Kept>>>,
    /// Columns of blocks that were decoded.
    #[cfg(test)]
    made: Arc<std::sync::atomic::AtomicUsize>,
}

type Kept = (BlockKey, Arc<Block>);

/// Columns of a block by their position in the file. Who decodes holds the lock, so that others
/// wait instead of decoding the same.
#[derive(Debug, Default)]
struct Block(Mutex<BTreeMap<usize, Numbers>>);

impl Decoded {
    /// The numbers of some columns of a block, given by their positions in the file. `decode` gives
    /// those that are not kept, in the order in which it is asked for them.
    pub fn get(
        &self,
        place: BlockKey,
        positions: &[usize],
        decode: impl FnOnce(&[usize]) -> Vec<Numbers>,
    ) -> Vec<Numbers> {
        let most = MOST * rayon::current_num_threads();
        let block = {
            let mut blocks = locked(&self.blocks);
            let kept = blocks.find(|(known, block)| (*known == place).then(|| Arc::clone(block)));
            kept.unwrap_or_else(|| {
                let new = Arc::new(Block::default());
                blocks.add((place, Arc::clone(&new)), 0, most);
                new
            })
        };
        let mut columns = locked(&block.0);
        let lacks = |position: &usize| !columns.contains_key(position);
        let lacking: Vec<usize> = positions.iter().copied().filter(lacks).collect();
        if !lacking.is_empty() {
            let new = decode(&lacking);
            let bytes = new.iter().flatten().map(|numbers| numbers.len() * size_of::<f64>()).sum();
            #[cfg(test)]
            self.made.fetch_add(lacking.len(), std::sync::atomic::Ordering::Relaxed);
            columns.extend(lacking.into_iter().zip(new));
            locked(&self.blocks).grow(|(_, kept)| Arc::ptr_eq(kept, &block), bytes, most);
        }
        positions.iter().map(|position| columns.get(position).cloned().flatten()).collect()
    }

    /// Columns of blocks that were decoded so far.
    #[cfg(test)]
    pub fn made(&self) -> usize {
        self.made.load(std::sync::atomic::Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(length: usize) -> Numbers {
        Some(Arc::new(vec![1.0; length]))
    }

    #[test]
    fn each_column_of_a_block_is_decoded_once() {
        let decoded = Decoded::default();
        let place = || (PathBuf::from("a"), 0);
        let mut asked = Vec::new();
        for positions in [&[3, 1][..], &[1, 2], &[2, 3, 1], &[1]] {
            let found = decoded.get(place(), positions, |lacking| {
                asked.push(lacking.to_vec());
                lacking.iter().map(|position| numbers(*position)).collect()
            });
            let lengths: Vec<usize> = found.iter().flatten().map(|numbers| numbers.len()).collect();
            assert_eq!(lengths, positions);
        }
        assert_eq!(asked, [vec![3, 1], vec![2]]);
        let other = decoded.get((PathBuf::from("a"), 1), &[1], |_| vec![None]);
        assert_eq!(
            (other, decoded.made()),
            (vec![None], 4),
            "what cannot be used is not decoded again either"
        );
        decoded.get((PathBuf::from("a"), 1), &[1], |_| panic!("known"));
    }

    #[test]
    fn threads_wait_for_who_decodes_the_same() {
        let decoded = Decoded::default();
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for row in 0..50 {
                        let found = decoded.get((PathBuf::from("a"), row), &[0, 1], |lacking| {
                            vec![numbers(row); lacking.len()]
                        });
                        assert!(found.iter().flatten().all(|numbers| numbers.len() == row));
                    }
                });
            }
        });
        assert_eq!(decoded.made(), 100);
    }

    #[test]
    fn what_is_kept_is_bounded_and_the_least_used_goes_first() {
        let decoded = Decoded::default();
        let most = MOST * rayon::current_num_threads();
        let quarter = most / 4 / size_of::<f64>();
        let get = |row: usize| {
            let mut new = false;
            decoded.get((PathBuf::from("a"), row), &[0], |_| {
                new = true;
                vec![numbers(quarter)]
            });
            new
        };
        assert_eq!([0, 1, 2, 3, 0].map(get), [true, true, true, true, false]);
        assert_eq!([4, 0, 1].map(get), [true, false, true], "the second went for the fifth");
        for row in 5..30 {
            get(row);
            let (count, bytes) = locked(&decoded.blocks).extent();
            assert!(bytes <= most && count <= 4, "{bytes} bytes of {most}");
        }
        decoded.get((PathBuf::from("a"), 99), &[0], |_| vec![numbers(most / size_of::<f64>() + 1)]);
        assert!(locked(&decoded.blocks).extent().1 <= most, "one that is too large is not kept");
    }
}
