//! A simulator whose first failure is kept, and after which it runs no more.

use std::sync::Mutex;

use super::{Simulator, Task};
use crate::effects::Signals;
use crate::problem::Problem;
use crate::units::Unit;

/// A diagnosis that leaves out what fails could name a cause only because its rival failed.
pub struct Strict<'a> {
    inner: &'a dyn Simulator,
    failed: Mutex<Option<Problem>>,
}

impl std::fmt::Debug for Strict<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Strict").field("inner", &self.inner.name()).finish_non_exhaustive()
    }
}

impl<'a> Strict<'a> {
    pub fn new(inner: &'a dyn Simulator) -> Self {
        Self { inner, failed: Mutex::new(None) }
    }

    /// The first failure, if there was one.
    pub fn failed(&self) -> Option<Problem> {
        self.failed.lock().ok()?.clone()
    }
}

impl Simulator for Strict<'_> {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn catalogue_name(&self) -> Option<&str> {
        self.inner.catalogue_name()
    }

    fn unit(&self, channel: &str) -> Option<Unit> {
        self.inner.unit(channel)
    }

    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem> {
        if let Some(problem) = self.failed() {
            return Err(problem);
        }
        self.inner.run(task).inspect_err(|problem| {
            if let Ok(mut failed) = self.failed.lock() {
                failed.get_or_insert_with(|| problem.clone());
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::simulate::Section;

    #[derive(Default)]
    struct Broken(AtomicUsize);

    impl Simulator for Broken {
        fn name(&self) -> &str {
            "broken"
        }

        fn catalogue_name(&self) -> Option<&str> {
            None
        }

        fn run(&self, _: &Task<'_>) -> Result<Signals, Problem> {
            Err(Problem::error(
                "simulator-failed",
                format!("call {}", self.0.fetch_add(1, Ordering::Relaxed)),
            ))
        }
    }

    #[test]
    fn the_first_failure_is_kept_and_the_last_run() {
        let broken = Broken::default();
        let strict = Strict::new(&broken);
        assert!(strict.failed().is_none());
        let section = Section::nowhere();
        for _ in 0..3 {
            let task = Task { section: &section, settings: &[], shift: 0.0, inside_only: false };
            assert_eq!(
                strict.run(&task).map_err(|problem| problem.says).err().as_deref(),
                Some("call 0")
            );
        }
        assert_eq!(
            (
                strict.failed().map(|problem| problem.says).as_deref(),
                broken.0.load(Ordering::Relaxed)
            ),
            (Some("call 0"), 1)
        );
    }
}
