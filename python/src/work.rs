//! Long work in a thread of its own: the interpreter is free meanwhile, and an interrupt of the
//! user ends the waiting.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::prelude::*;

use crate::error::one_raised;
use fishplate::problem::Problem;

/// Time between two looks for an interrupt [ms]: short for a person, and long beside what a look
/// costs (some microseconds).
const TICK: Duration = Duration::from_millis(50);
/// Most threads; each takes the memory of a record.
const MOST_JOBS: usize = 256;

/// Whether the caller has given up.
#[derive(Clone, Debug, Default)]
pub struct Stopped(Arc<AtomicBool>);

impl Stopped {
    pub fn yes(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Runs work with `jobs` threads, one per core without a number. The threads end with the work, so
/// that a process may fork later.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    jobs: Option<usize>,
    work: impl FnOnce(&Stopped) -> T + Send + 'static,
) -> PyResult<T> {
    if let Some(jobs) = jobs.filter(|jobs| !(1..=MOST_JOBS).contains(jobs)) {
        return Err(one_raised(
            py,
            Problem::error("jobs", format!("jobs = {jobs} is not a number from 1 to {MOST_JOBS}")),
        ));
    }
    let failed = |error: &dyn std::fmt::Display| {
        one_raised(py, Problem::error("threads", format!("no threads can be started: {error}")))
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.unwrap_or(0))
        .build()
        .map_err(|error| failed(&error))?;
    let stopped = Stopped::default();
    let (send, receive) = channel();
    let inside = stopped.clone();
    let thread = std::thread::Builder::new().name("fishplate".into()).spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(&inside))));
        drop(pool);
        // Nobody listens after an interrupt.
        let _ = send.send(done);
    });
    thread.map_err(|error| failed(&error))?;
    let mut receive = receive;
    loop {
        // A receiver belongs to one thread: it goes along.
        let got;
        (receive, got) = py.detach(move || {
            let got = receive.recv_timeout(TICK);
            (receive, got)
        });
        match got {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(panic)) => return Err(one_raised(py, internal(&*panic))),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(one_raised(py, internal(&"the thread ended")));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(interrupt) = py.check_signals() {
            stopped.0.store(true, Ordering::Relaxed);
            return Err(interrupt);
        }
    }
}

fn internal(panic: &(dyn Any + Send)) -> Problem {
    let said = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied());
    Problem::error(
        "internal",
        format!("a fault of the program: {}", said.unwrap_or("without a message")),
    )
    .help("please report it")
}
