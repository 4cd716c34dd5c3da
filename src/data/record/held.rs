//! Bytes of files that neighbouring stretches have in common: read once, and kept for the next
//! stretch within a bound.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use bytes::Bytes;

use super::{
    decoded::Decoded,
    layout::Layout,
    recent::{Recent, locked},
};

/// Most bytes that are kept in all: both sides and the track of a run of 60 km with 24 channels, or
/// some row groups of longer ones. It bounds the memory of a worker, whatever the length of the
/// archive.
const MOST: usize = 64 << 20;
/// Largest file that is kept as a whole, when it is read for its hash: four of them fit.
const WHOLE: u64 = MOST as u64 / 4;

/// Files whose footer is kept for each thread: the three records of a run, and the one that was
/// used before.
const FOOTERS: usize = 4;

/// The parts of files that were read last, and what was decoded last; shared by all files of a
/// campaign.
#[derive(Clone, Debug, Default)]
pub struct Held {
    parts: Arc<Mutex<Recent<HeldBytes>>>,
    /// Footers of Parquet files.
    layouts: Arc<Mutex<Recent<Footer>>>,
    pub(super) decoded: Decoded,
}

/// What the footer of a file says.
type Footer = (PathBuf, Arc<Layout>);

#[derive(Debug)]
struct HeldBytes {
    file: PathBuf,
    start: u64,
    bytes: Bytes,
}

impl HeldBytes {
    fn bytes(&self, file: &Path, range: &Range<u64>) -> Option<Bytes> {
        let from = usize::try_from(range.start.checked_sub(self.start)?).ok()?;
        let to = usize::try_from(range.end.checked_sub(self.start)?).ok()?;
        (from <= to && to <= self.bytes.len() && self.file == file)
            .then(|| self.bytes.slice(from..to))
    }
}

impl Held {
    /// Whether a file of so many bytes is kept as a whole.
    pub fn takes_whole(size: u64) -> bool {
        size <= WHOLE
    }

    /// What the footer of a file says, if it is kept.
    pub(super) fn layout(&self, file: &Path) -> Option<Arc<Layout>> {
        locked(&self.layouts).find(|(known, layout)| (known == file).then(|| Arc::clone(layout)))
    }

    /// Keeps what the footer of a file says.
    pub(super) fn keep_layout(&self, file: &Path, layout: &Arc<Layout>) {
        let most = FOOTERS * rayon::current_num_threads();
        locked(&self.layouts).add((file.to_path_buf(), Arc::clone(layout)), 1, most);
    }

    /// A part of a file, if it is kept.
    pub fn get(&self, file: &Path, range: &Range<u64>) -> Option<Bytes> {
        locked(&self.parts).find(|part| part.bytes(file, range))
    }

    /// Keeps a part of a file; those that were not used for the longest time go.
    pub fn keep(&self, file: &Path, start: u64, bytes: Bytes) {
        let size = bytes.len();
        if size <= MOST {
            locked(&self.parts).add(
                HeldBytes { file: file.to_path_buf(), start, bytes },
                size,
                MOST,
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_found_within_what_is_kept() {
        let held = Held::default();
        let (file, other) = (Path::new("a"), Path::new("b"));
        assert_eq!(held.get(file, &(0..1)), None);
        held.keep(file, 10, Bytes::from_static(b"0123456789"));
        assert_eq!(held.get(file, &(12..15)).as_deref(), Some(&b"234"[..]));
        assert_eq!(held.get(file, &(10..20)).as_deref(), Some(&b"0123456789"[..]));
        for outside in [9..12, 15..21, 20..22, 0..5] {
            assert_eq!(held.get(file, &outside), None, "{outside:?}");
        }
        assert_eq!(held.get(other, &(12..15)), None);
    }

    #[test]
    fn what_is_kept_is_bounded_and_the_least_used_goes_first() {
        let held = Held::default();
        let quarter = || Bytes::from(vec![7_u8; MOST / 4]);
        let names: Vec<PathBuf> = (0..5).map(|number| PathBuf::from(number.to_string())).collect();
        names[..4].iter().for_each(|name| held.keep(name, 0, quarter()));
        assert!(held.get(&names[0], &(0..1)).is_some(), "used again");
        held.keep(&names[4], 0, quarter());
        let kept: Vec<bool> = names.iter().map(|name| held.get(name, &(0..1)).is_some()).collect();
        assert_eq!(kept, [true, false, true, true, true]);
        held.keep(Path::new("large"), 0, Bytes::from(vec![0_u8; MOST + 1]));
        assert_eq!(held.get(Path::new("large"), &(0..1)), None);
        assert!(locked(&held.parts).extent().1 <= MOST);
    }
}
