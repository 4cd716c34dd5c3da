//! Bytes of files that neighbouring stretches have in common: read once, and kept for the next
//! stretch within a bound.

use std::collections::VecDeque;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use bytes::Bytes;

use super::columnar::Layout;
use super::decoded::Decoded;

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
#[derive(Clone, Default)]
pub struct Held {
    parts: Arc<Mutex<Parts>>,
    /// Footers of Parquet files; the one that was used last is the first.
    layouts: Arc<Mutex<Layouts>>,
    pub(super) decoded: Decoded,
}

type Layouts = VecDeque<(PathBuf, Arc<Layout>)>;

#[derive(Default)]
struct Parts {
    /// The one that was used last is the first.
    parts: VecDeque<Part>,
    bytes: usize,
}

struct Part {
    file: PathBuf,
    start: u64,
    bytes: Bytes,
}

impl Part {
    fn of(&self, file: &Path, range: &Range<u64>) -> Option<Bytes> {
        let from = usize::try_from(range.start.checked_sub(self.start)?).ok()?;
        let to = usize::try_from(range.end.checked_sub(self.start)?).ok()?;
        (from <= to && to <= self.bytes.len() && self.file == file)
            .then(|| self.bytes.slice(from..to))
    }
}

impl fmt::Debug for Held {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Held").finish_non_exhaustive()
    }
}

impl Held {
    /// Whether a file of so many bytes is kept as a whole.
    pub fn takes_whole(size: u64) -> bool {
        size <= WHOLE
    }

    /// What the footer of a file says, if it is kept.
    pub(super) fn layout(&self, file: &Path) -> Option<Arc<Layout>> {
        let mut layouts = self.layouts.lock().unwrap_or_else(PoisonError::into_inner);
        let at = layouts.iter().position(|(known, _)| known == file)?;
        let used = layouts.remove(at)?;
        let layout = Arc::clone(&used.1);
        layouts.push_front(used);
        Some(layout)
    }

    /// Keeps what the footer of a file says.
    pub(super) fn keep_layout(&self, file: &Path, layout: &Arc<Layout>) {
        let mut layouts = self.layouts.lock().unwrap_or_else(PoisonError::into_inner);
        layouts.push_front((file.to_path_buf(), Arc::clone(layout)));
        layouts.truncate(FOOTERS * rayon::current_num_threads());
    }

    /// A part of a file, if it is kept.
    pub fn get(&self, file: &Path, range: &Range<u64>) -> Option<Bytes> {
        let mut held = self.parts.lock().unwrap_or_else(PoisonError::into_inner);
        let at = held.parts.iter().position(|part| part.of(file, range).is_some())?;
        let part = held.parts.remove(at)?;
        let found = part.of(file, range);
        held.parts.push_front(part);
        found
    }

    /// Keeps a part of a file; those that were not used for the longest time go.
    pub fn keep(&self, file: &Path, start: u64, bytes: Bytes) {
        if bytes.len() > MOST {
            return;
        }
        let mut held = self.parts.lock().unwrap_or_else(PoisonError::into_inner);
        held.bytes += bytes.len();
        held.parts.push_front(Part { file: file.to_path_buf(), start, bytes });
        while held.bytes > MOST {
            let Some(last) = held.parts.pop_back() else { return };
            held.bytes -= last.bytes.len();
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
        assert!(held.parts.lock().expect("held").bytes <= MOST);
    }
}
