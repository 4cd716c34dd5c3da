//! What was used last, within a bound.

use std::{
    collections::VecDeque,
    sync::{Mutex, MutexGuard, PoisonError},
};

/// Values with their sizes; the one that was used last is the first.
#[derive(Debug)]
pub struct Recent<V> {
    values: VecDeque<(V, usize)>,
    /// Of all values.
    size: usize,
}

/// Nothing is half-written under a lock, so a panic of another thread does no harm.
pub fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<V> Default for Recent<V> {
    fn default() -> Self {
        Self { values: VecDeque::new(), size: 0 }
    }
}

impl<V> Recent<V> {
    /// What is looked for in the values; the value that has it is then the one used last.
    pub fn find<T>(&mut self, looked_for: impl Fn(&V) -> Option<T>) -> Option<T> {
        let mut values = self.values.iter().enumerate();
        let (at, found) = values.find_map(|(at, (value, _))| Some((at, looked_for(value)?)))?;
        let used = self.values.remove(at)?;
        self.values.push_front(used);
        Some(found)
    }

    /// Adds a value; those that were not used for the longest time go until the sizes are not more
    /// than `most`.
    pub fn add(&mut self, value: V, size: usize, most: usize) {
        self.values.push_front((value, 0));
        self.grow(|_| true, size, most);
    }

    /// Adds to the size of the first value that is meant; as [`Self::add`].
    pub fn grow(&mut self, meant: impl Fn(&V) -> bool, more: usize, most: usize) {
        // A value that went meanwhile is not counted.
        let Some((_, size)) = self.values.iter_mut().find(|(value, _)| meant(value)) else {
            return;
        };
        *size += more;
        self.size += more;
        while self.size > most {
            let Some((_, gone)) = self.values.pop_back() else { return };
            self.size -= gone;
        }
    }

    /// Number of values and their size.
    #[cfg(test)]
    pub fn extent(&self) -> (usize, usize) {
        (self.values.len(), self.size)
    }
}
