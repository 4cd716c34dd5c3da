//! Runs a program: no shell, a time limit, and what it said at last.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::started::{self, Mark};
use crate::disk;

/// A call to be made.
#[derive(Clone, Copy, Debug)]
pub struct Call<'a> {
    pub program: &'a Path,
    pub arguments: &'a [String],
    pub environment: &'a [(String, String)],
    /// Where it runs.
    pub folder: &'a Path,
    pub timeout: Duration,
}

/// How a call failed.
#[derive(Debug)]
pub enum Fault {
    /// It could not be started, with what the system says.
    NotStarted(std::io::Error),
    /// It was ended, with all that it started, when its time was up.
    TimedOut { said: String },
    /// It ended with another exit code than 0, or by a signal.
    Failed { status: ExitStatus, said: String },
}

/// Lines and bytes that are kept of what a program said.
const LINES: usize = 8;
const BYTES: u64 = 4096;
const FIRST_LOOK: Duration = Duration::from_millis(1);
const LONGEST_PAUSE: Duration = Duration::from_millis(50);

/// Runs a program to its end. Standard output and standard error go to files, so that a talkative program cannot block.
///
/// # Errors
/// See [`Fault`].
pub fn run(call: &Call<'_>) -> Result<(), Fault> {
    let mut error = disk::scratch_file().map_err(Fault::NotStarted)?;
    let mut output = disk::scratch_file().map_err(Fault::NotStarted)?;
    let to = |file: &File| file.try_clone().map(Stdio::from).map_err(Fault::NotStarted);
    let mut command = Command::new(call.program);
    command.args(call.arguments).current_dir(call.folder).stdin(Stdio::null()).stdout(to(&output)?).stderr(to(&error)?);
    command.envs(call.environment.iter().map(|(name, value)| (name, value)));
    let mark = Mark::new();
    command.env(started::NAME, mark.value());
    // A group of its own, so that what it starts ends with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn().map_err(Fault::NotStarted)?;
    let status = wait(&mut child, call.timeout, &mark);
    let mut said = || {
        let said = last_lines(&mut error);
        if said.is_empty() { last_lines(&mut output) } else { said }
    };
    match status {
        Ok(Some(status)) if status.success() => Ok(()),
        Ok(Some(status)) => Err(Fault::Failed { status, said: said() }),
        Ok(None) => Err(Fault::TimedOut { said: said() }),
        Err(error) => Err(Fault::NotStarted(error)),
    }
}

/// How the child ended; `None` if it was ended here.
fn wait(child: &mut Child, timeout: Duration, mark: &Mark) -> std::io::Result<Option<ExitStatus>> {
    let started = Instant::now();
    let mut pause = FIRST_LOOK;
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(Some(status)),
            Ok(None) => {}
            Err(error) => {
                end(child, mark);
                return Err(error);
            }
        }
        let left = timeout.saturating_sub(started.elapsed());
        if left.is_zero() {
            end(child, mark);
            return Ok(None);
        }
        std::thread::sleep(pause.min(left));
        pause = (pause * 2).min(LONGEST_PAUSE);
    }
}

/// Ends a child, its group and what left that group, and waits until the child is gone.
fn end(child: &mut Child, mark: &Mark) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill();
    started::end(mark);
    let _ = child.wait();
}

fn last_lines(file: &mut File) -> String {
    let length = file.metadata().map_or(0, |meta| meta.len());
    let mut bytes = Vec::new();
    let read = file.seek(SeekFrom::Start(length.saturating_sub(BYTES))).and_then(|_| file.take(BYTES).read_to_end(&mut bytes));
    if read.is_err() {
        return String::new();
    }
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.trim_end().lines().collect();
    lines[lines.len().saturating_sub(LINES)..].join("\n")
}
