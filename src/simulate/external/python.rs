//! A Python function as a simulator: processes that stay, one for each worker, and JSON lines over
//! their pipes.

use std::{
    collections::BTreeSet,
    io::{BufRead, BufReader, Read, Write},
    path::PathBuf,
    process::{Child, ChildStdin, Stdio},
    sync::{
        Mutex, OnceLock,
        mpsc::{Receiver, RecvTimeoutError, sync_channel},
    },
    time::Duration,
};

use serde_json::{Map, Value, json};

use super::{
    process::{Fault, Printed, end, ended, last_lines, launched},
    read::{Program, Python},
    started::Mark,
};
use crate::data::text::LARGEST_RECORD;
use crate::disk;

/// The script that calls the function.
const WORKER: &str = include_str!("worker.py");

/// The processes of one simulator.
#[derive(Debug)]
pub struct Workers {
    python: Python,
    launch: Vec<String>,
    environment: Vec<(String, String)>,
    folder: PathBuf,
    timeout: Duration,
    idle: Mutex<Vec<Worker>>,
    /// Parameters that the file declares.
    parameters: OnceLock<Vec<String>>,
}

#[derive(Debug)]
struct Worker {
    child: Child,
    input: Option<ChildStdin>,
    lines: Receiver<String>,
    errors: Printed,
    mark: Mark,
    /// Sections whose inputs it has.
    known: BTreeSet<String>,
}

/// Columns of a record by name, as the function gives them.
pub type Columns = Vec<(String, Vec<f64>)>;

impl Workers {
    pub fn new(python: Python, program: &Program) -> Self {
        let Program { launch, environment, folder, timeout, .. } = program.clone();
        Self {
            python,
            launch,
            environment,
            folder,
            timeout,
            idle: Mutex::default(),
            parameters: OnceLock::new(),
        }
    }

    /// The parameters that the file declares. A process is started to ask for them.
    pub fn parameters(&self) -> Result<&[String], Fault> {
        if self.parameters.get().is_none() {
            let worker = self.start()?;
            self.rest(worker);
        }
        Ok(self.parameters.get().map_or(&[], Vec::as_slice))
    }

    /// Calls the function. `inputs` is asked for if the process does not have those of the section
    /// yet.
    pub fn call(
        &self,
        section: &str,
        parameters: &[(String, f64)],
        inputs: &dyn Fn() -> Value,
    ) -> Result<Columns, Fault> {
        let free = self.idle.lock().ok().and_then(|mut idle| idle.pop());
        let mut worker = free.map_or_else(|| self.start(), Ok)?;
        let values: Map<String, Value> =
            parameters.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
        let inputs = if worker.known.contains(section) { Value::Null } else { inputs() };
        let asked = json!({"section": section, "inputs": inputs, "parameters": values});
        let answer = worker.ask(&asked, self.timeout)?;
        worker.known.insert(section.to_string());
        let found = columns(&answer);
        self.rest(worker);
        found
    }

    fn rest(&self, worker: Worker) {
        if let Ok(mut idle) = self.idle.lock() {
            idle.push(worker);
        }
    }

    fn start(&self) -> Result<Worker, Fault> {
        let errors = disk::scratch_file().map_err(Fault::NotStarted)?;
        let (mut command, mark) =
            launched(&self.launch, &self.python.interpreter, &self.folder, &self.environment);
        command
            .args(["-c", WORKER])
            .arg(&self.python.file)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(errors.try_clone().map_err(Fault::NotStarted)?);
        let mut child = command.spawn().map_err(Fault::NotStarted)?;
        let input = child.stdin.take();
        // One line waits until it is asked for: an answer that nobody asked for takes no memory.
        let (send, lines) = sync_channel(1);
        if let Some(output) = child.stdout.take() {
            std::thread::spawn(move || {
                let mut output = BufReader::new(output);
                let mut line = String::new();
                // A longer line is cut off, and not understood.
                while matches!((&mut output).take(LARGEST_RECORD).read_line(&mut line), Ok(read) if read > 0)
                    && send.send(std::mem::take(&mut line)).is_ok()
                {}
            });
        }
        let mut worker = Worker { child, input, lines, errors, mark, known: BTreeSet::new() };
        let ready = worker.answer(self.timeout)?;
        if let Some(error) = ready.get("error").and_then(Value::as_str) {
            return Err(Fault::Raised(error.to_string()));
        }
        let names = ready
            .get("parameters")
            .and_then(Value::as_array)
            .map(|names| names.iter().filter_map(Value::as_str));
        let Some(names) = names else {
            return Err(Fault::Answer("its first line has no `parameters`".into()));
        };
        let _ = self.parameters.set(names.map(str::to_string).collect());
        Ok(worker)
    }
}

impl Worker {
    fn ask(&mut self, asked: &Value, timeout: Duration) -> Result<Value, Fault> {
        let sent = match &mut self.input {
            Some(input) => writeln!(input, "{asked}").and_then(|()| input.flush()),
            None => Ok(()),
        };
        // A process that has ended says why in what it printed.
        if sent.is_err() {
            return Err(Fault::Ended { said: last_lines(&mut self.errors) });
        }
        self.answer(timeout)
    }

    fn answer(&mut self, timeout: Duration) -> Result<Value, Fault> {
        match self.lines.recv_timeout(timeout) {
            Ok(line) => {
                serde_json::from_str(&line).map_err(|error| Fault::Answer(error.to_string()))
            }
            Err(RecvTimeoutError::Timeout) => Err(Fault::TimedOut { said: String::new() }),
            Err(RecvTimeoutError::Disconnected) => {
                let _ = self.child.wait();
                Err(Fault::Ended { said: last_lines(&mut self.errors) })
            }
        }
    }
}

/// How long a process may take to end after its input was closed, in pauses of 5 ms.
const PAUSES: usize = 100;

/// A process that is not needed any more ends when its input is closed; one that does not is ended,
/// with what it started.
impl Drop for Worker {
    fn drop(&mut self) {
        drop(self.input.take());
        for _ in 0..PAUSES {
            if !matches!(ended(&mut self.child), Ok(false)) {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let _ = end(&mut self.child, &self.mark);
    }
}

fn columns(answer: &Value) -> Result<Columns, Fault> {
    if let Some(error) = answer.get("error").and_then(Value::as_str) {
        return Err(Fault::Raised(error.to_string()));
    }
    let Some(found) = answer.get("channels").and_then(Value::as_object) else {
        return Err(Fault::Answer("the line has neither `channels` nor `error`".into()));
    };
    let column = |(name, values): (&String, &Value)| {
        let values = values.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()?;
        Some((name.clone(), values))
    };
    found
        .iter()
        .map(column)
        .collect::<Option<_>>()
        .ok_or_else(|| Fault::Answer("a channel is no list of numbers".into()))
}
