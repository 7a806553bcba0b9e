//! An engine that runs in a process of its own: requests and answers, a line each.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rdh::Query;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::files;
use super::registry::Form;

/// A running engine that has built its structure.
#[derive(Debug)]
pub(crate) struct Process {
    child: Arc<Mutex<Child>>,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    /// Where it writes the answers of all rays.
    answers: PathBuf,
    pub(crate) built: Built,
    /// Told to end by being dropped.
    _watchdog: Option<Sender<()>>,
}

/// What an engine says once it has built.
#[derive(Debug, Deserialize)]
pub(crate) struct Built {
    pub(crate) version: String,
    /// CPU time of the build.
    pub(crate) build_nanos: u64,
    /// The structure, and its copies of triangles.
    pub(crate) bytes: u64,
}

/// What came of casting a batch once.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Cast {
    /// One thread's CPU time.
    pub(crate) nanos: u64,
    /// Rays that hit something.
    pub(crate) hits: u64,
    /// Sum of the hit distances; 0 for any-hit rays.
    pub(crate) t_sum: f64,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Trouble {
    /// The competitor isn't installed, or this machine can't run it.
    Absent(String),
    /// Something went wrong.
    Failed(String),
}

/// What an engine says instead of an answer.
#[derive(Debug, Deserialize)]
struct Refusal {
    absent: Option<String>,
    error: Option<String>,
}

#[derive(Debug, Deserialize)]
struct CastAnswer {
    nanos: Vec<u64>,
    hits: u64,
    t_sum: f64,
}

#[derive(Debug, Deserialize)]
struct RaysAnswer {
    rays: usize,
}

impl Process {
    /// Starts a program on a mesh file, and waits until it has built. With a limit it is killed after that time, whatever it does then.
    pub(crate) fn start(
        program: &Path,
        mode: &str,
        mesh: &Path,
        answers: PathBuf,
        limit: Option<Duration>,
    ) -> Result<Self, Trouble> {
        if !program.is_file() {
            return Err(Trouble::Absent(format!("{} is not there", program.display())));
        }
        let mut command = Command::new(program);
        command.arg("--mesh").arg(mesh).args(["--mode", mode]).arg("--answers").arg(&answers);
        // Whatever it uses for threads: builds are compared on one.
        command.env("RAYON_NUM_THREADS", "1");
        let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = child.map_err(|e| Trouble::Failed(format!("{}: {e}", program.display())))?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(Trouble::Failed("the engine has no pipes".to_owned()));
        };
        let unknown = Built { version: String::new(), build_nanos: 0, bytes: 0 };
        let child = Arc::new(Mutex::new(child));
        let watchdog = limit.map(|limit| watchdog(Arc::clone(&child), limit));
        let output = BufReader::new(output);
        let mut process = Self { child, input, output, answers, built: unknown, _watchdog: watchdog };
        process.built = process.answer()?;
        Ok(process)
    }

    /// Casts a file of rays once.
    pub(crate) fn cast(&mut self, form: Form, query: Query, file: &Path) -> Result<Cast, Trouble> {
        self.ask(&format!("cast {} {} 1 {}", form.name(), name(query), file.display()))?;
        let CastAnswer { nanos, hits, t_sum } = self.answer()?;
        match nanos[..] {
            [nanos] => Ok(Cast { nanos, hits, t_sum }),
            _ => Err(Trouble::Failed(format!("the engine cast {} times, not once", nanos.len()))),
        }
    }

    /// The answers of all rays of a file: a distance, 0 for an occlusion; infinite for a miss.
    pub(crate) fn answers(&mut self, form: Form, query: Query, file: &Path) -> Result<Vec<f32>, Trouble> {
        // What is read below must be what it writes now.
        std::fs::remove_file(&self.answers).ok();
        self.ask(&format!("answers {} {} {}", form.name(), name(query), file.display()))?;
        let RaysAnswer { rays } = self.answer()?;
        let answers = files::read_answers(&self.answers).map_err(|e| Trouble::Failed(e.to_string()))?;
        if answers.len() == rays {
            Ok(answers)
        } else {
            Err(Trouble::Failed(format!("the engine wrote {} answers for {rays} rays", answers.len())))
        }
    }

    fn ask(&mut self, request: &str) -> Result<(), Trouble> {
        writeln!(self.input, "{request}").map_err(|_| self.ended())
    }

    fn answer<T: DeserializeOwned>(&mut self) -> Result<T, Trouble> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(0) => return Err(self.ended()),
            Ok(_) => {}
            Err(e) => return Err(Trouble::Failed(format!("the engine can't be heard: {e}"))),
        }
        if let Ok(Refusal { absent: Some(why), .. }) = serde_json::from_str(&line) {
            return Err(Trouble::Absent(why));
        }
        if let Ok(Refusal { error: Some(why), .. }) = serde_json::from_str(&line) {
            return Err(Trouble::Failed(why));
        }
        serde_json::from_str(&line)
            .map_err(|e| Trouble::Failed(format!("the engine answered '{}': {e}", line.trim_end())))
    }

    fn ended(&mut self) -> Trouble {
        // Its pipe is closed, so it won't be long.
        let how = lock(&self.child).wait().map_or_else(|e| e.to_string(), |status| status.to_string());
        Trouble::Failed(format!("the engine has ended without an answer: {how}"))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It would end by itself when its input does, but not before it has answered.
        let mut child = lock(&self.child);
        child.kill().ok();
        child.wait().ok();
    }
}

/// Kills a child after some time, unless the sender is dropped before.
fn watchdog(child: Arc<Mutex<Child>>, limit: Duration) -> Sender<()> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        if receiver.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
            lock(&child).kill().ok();
        }
    });
    sender
}

fn lock(child: &Mutex<Child>) -> std::sync::MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

fn name(query: Query) -> &'static str {
    if query == Query::Occluded { "occluded" } else { "closest" }
}
