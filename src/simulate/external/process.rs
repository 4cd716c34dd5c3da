//! Runs a program without a shell and with a time limit, and keeps its last output.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::started::{self, Mark};
use crate::disk;

/// The file that takes what a program prints. It has no name, and is made by `disk`.
pub type Printed = File;

/// A call of a program.
#[derive(Clone, Copy, Debug)]
pub struct Call<'a> {
    /// Words before the program, which start it on another machine.
    pub launch: &'a [String],
    pub program: &'a Path,
    pub arguments: &'a [String],
    pub environment: &'a [(String, String)],
    /// Working folder.
    pub folder: &'a Path,
    pub timeout: Duration,
}

/// Failure of a call, with the last output of the program.
#[derive(Debug)]
pub enum Fault {
    /// It could not be started; the system's error.
    NotStarted(std::io::Error),
    /// It was terminated with all its child processes at the time limit.
    TimedOut { said: String },
    /// It ended with an exit code other than 0, or by a signal.
    Failed { status: ExitStatus, said: String },
    /// The process of a Python function ended during a call.
    Ended { said: String },
    /// The function raised this.
    Raised(String),
    /// What the function answered is not understood.
    Answer(String),
}

/// Number of lines and bytes of the program's output that are kept.
const LINES: usize = 8;
const BYTES: u64 = 4096;
const FIRST_LOOK: Duration = Duration::from_millis(1);
const LONGEST_PAUSE: Duration = Duration::from_millis(50);

/// A command that starts a program in a folder, by words before it if there are any. The mark finds
/// what it starts.
pub fn launched(
    launch: &[String],
    program: &Path,
    folder: &Path,
    environment: &[(String, String)],
) -> (Command, Mark) {
    let mut command = match launch.split_first() {
        Some((first, words)) => {
            let mut command = Command::new(first);
            command.args(words).arg(program);
            command
        }
        None => Command::new(program),
    };
    let mark = Mark::new();
    command.current_dir(folder).envs(environment.iter().cloned()).env(started::NAME, mark.value());
    // A separate process group, so that its child processes are ended with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    (command, mark)
}

/// Runs a program to its end. Its output goes to files, so that it cannot block.
///
/// # Errors
/// See [`Fault`].
pub fn run(call: &Call<'_>) -> Result<(), Fault> {
    let mut error = disk::scratch_file().map_err(Fault::NotStarted)?;
    let mut output = disk::scratch_file().map_err(Fault::NotStarted)?;
    let to = |file: &File| file.try_clone().map(Stdio::from).map_err(Fault::NotStarted);
    let (mut command, mark) = launched(call.launch, call.program, call.folder, call.environment);
    command.args(call.arguments).stdin(Stdio::null()).stdout(to(&output)?).stderr(to(&error)?);
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

/// Exit status of the child; `None` if it was terminated at the time limit.
fn wait(child: &mut Child, timeout: Duration, mark: &Mark) -> std::io::Result<Option<ExitStatus>> {
    let started = Instant::now();
    let mut pause = FIRST_LOOK;
    loop {
        match ended(child) {
            Ok(true) => return end(child, mark).map(Some),
            Ok(false) => {}
            Err(error) => {
                let _ = end(child, mark);
                return Err(error);
            }
        }
        let left = timeout.saturating_sub(started.elapsed());
        if left.is_zero() {
            let _ = end(child, mark);
            return Ok(None);
        }
        std::thread::sleep(pause.min(left));
        pause = (pause * 2).min(LONGEST_PAUSE);
    }
}

/// Whether a child has ended. Its number stays taken, so that it can be that of no other process
/// before [`end`].
#[cfg(unix)]
pub fn ended(child: &mut Child) -> std::io::Result<bool> {
    use rustix::process::{WaitId, WaitIdOptions, waitid};
    let Some(id) = number(child) else { return Ok(child.try_wait()?.is_some()) };
    let how = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    match waitid(WaitId::Pid(id), how) {
        Ok(status) => Ok(status.is_some()),
        Err(rustix::io::Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

#[cfg(not(unix))]
pub fn ended(child: &mut Child) -> std::io::Result<bool> {
    Ok(child.try_wait()?.is_some())
}

#[cfg(unix)]
fn number(child: &Child) -> Option<rustix::process::Pid> {
    i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw)
}

/// Terminates a child that may have ended, its group and processes that left the group, and waits
/// for the child.
pub fn end(child: &mut Child, mark: &Mark) -> std::io::Result<ExitStatus> {
    #[cfg(unix)]
    if let Some(group) = number(child) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill();
    started::end(mark, child.id());
    child.wait()
}

pub fn last_lines(file: &mut File) -> String {
    let length = file.metadata().map_or(0, |meta| meta.len());
    let mut bytes = Vec::new();
    let read = file
        .seek(SeekFrom::Start(length.saturating_sub(BYTES)))
        .and_then(|_| file.take(BYTES).read_to_end(&mut bytes));
    if read.is_err() {
        return String::new();
    }
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.trim_end().lines().collect();
    lines[lines.len().saturating_sub(LINES)..].join("\n")
}
