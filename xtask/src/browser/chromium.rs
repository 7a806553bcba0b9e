//! Chromium without a window, spoken to by its debugging protocol: JSON messages that end in a zero byte, through a pipe.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A browser with one page.
#[derive(Debug)]
pub(super) struct Chromium {
    process: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    events: VecDeque<Value>,
    session: Option<String>,
    last_id: u64,
    /// Its profile, new each time and removed in the end.
    _profile: TempDir,
}

const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Nothing that is asked of it takes so long.
const PATIENCE: Duration = Duration::from_secs(60);
/// The protocol's pipe has the descriptors 3 and 4; a shell puts ours there.
const THROUGH_PIPE: &str = r#"exec "$@" 3<&0 4>&1 </dev/null >/dev/null 2>/dev/null"#;
const FLAGS: [&str; 13] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    // Containers have little shared memory.
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
    "about:blank",
];

impl Chromium {
    /// Starts it, with a profile of its own, and opens a page.
    pub(super) fn start(program: Option<&Path>) -> Result<Self> {
        let program = find(program)?;
        let profile = tempfile::tempdir().context("a folder for the browser's profile")?;
        let mut command = Command::new("sh");
        command.args(["-c", THROUGH_PIPE, "sh"]).arg(&program);
        command.arg(format!("--user-data-dir={}", profile.path().display())).args(FLAGS);
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = command.spawn().with_context(|| program.display().to_string())?;
        let pipes = process.stdin.take().zip(process.stdout.take());
        let (to, from) = pipes.context("the browser has no pipes")?;
        let from = listen(from);
        let (events, session, last_id) = (VecDeque::new(), None, 0);
        let mut browser = Self { process, to, from, events, session, last_id, _profile: profile };
        browser.open_page().with_context(|| format!("{} doesn't answer", program.display()))?;
        Ok(browser)
    }

    fn open_page(&mut self) -> Result<()> {
        let target = self.ask("Target.createTarget", &json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = self.ask("Target.attachToTarget", &attach)?;
        self.session = session["sessionId"].as_str().map(str::to_owned);
        ensure!(self.session.is_some(), "no session: {session}");
        for domain in ["Page", "Runtime", "Network", "Log"] {
            self.ask(&format!("{domain}.enable"), &json!({}))?;
        }
        Ok(())
    }

    /// Sends a command, and waits for its answer. Events on the way are kept.
    pub(super) fn ask(&mut self, method: &str, params: &Value) -> Result<Value> {
        self.last_id += 1;
        let mut message = json!({ "id": self.last_id, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).with_context(|| method.to_owned())?;
        loop {
            let mut message = self.from.recv_timeout(PATIENCE).with_context(|| format!("{method}: no answer"))?;
            if message["id"] != json!(self.last_id) {
                self.events.push_back(message);
                continue;
            }
            if let Some(error) = message.get("error") {
                bail!("{method}: {error}");
            }
            return Ok(message["result"].take());
        }
    }

    /// Waits for an event; returns all events up to it.
    pub(super) fn wait_for(&mut self, method: &str) -> Result<Vec<Value>> {
        let mut seen: Vec<Value> = Vec::new();
        while seen.last().is_none_or(|e| e["method"] != json!(method)) {
            let event = match self.events.pop_front() {
                Some(event) => event,
                None => self.from.recv_timeout(PATIENCE).with_context(|| format!("{method} never came"))?,
            };
            seen.push(event);
        }
        Ok(seen)
    }

    /// What came since, without waiting.
    pub(super) fn drain(&mut self) -> Vec<Value> {
        self.events.extend(self.from.try_iter());
        self.events.drain(..).collect()
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        self.session = None;
        // It ends by itself when asked, and its helpers with it; else it is stopped. There is nobody to tell errors to.
        let asked = self.ask("Browser.close", &json!({}));
        let until = Instant::now() + Duration::from_secs(5);
        while asked.is_ok() && Instant::now() < until && matches!(self.process.try_wait(), Ok(None)) {
            thread::sleep(Duration::from_millis(20));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn find(program: Option<&Path>) -> Result<PathBuf> {
    if let Some(given) = program.map(Path::to_path_buf).or_else(|| std::env::var_os("CHROMIUM").map(PathBuf::from)) {
        return Ok(given);
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let places: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let found = NAMES.iter().flat_map(|name| places.iter().map(move |p| p.join(name))).find(|p| p.is_file());
    found.context("there is no Chromium: install it (Debian: apt-get install chromium), or name it by --chromium")
}

/// A thread that reads messages until the browser ends.
fn listen(from: impl Read + Send + 'static) -> Receiver<Value> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let mut from = BufReader::new(from);
        let mut bytes = Vec::new();
        while from.read_until(0, &mut bytes).is_ok_and(|n| n > 0) {
            bytes.pop();
            let message = serde_json::from_slice(&bytes);
            bytes.clear();
            if message.is_ok_and(|m| sender.send(m).is_err()) {
                return;
            }
        }
    });
    receiver
}
