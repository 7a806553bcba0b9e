//! What casts rays: a structure of ours in this process, or an engine in its own.

use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use rdh::{Accel, Query, Ray};
use rdh_study::clock::thread_nanos;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::columns::Column;
use super::install::Engine;

/// What came of casting a batch once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cast {
    /// One thread's CPU time.
    pub(crate) nanos: u64,
    /// Rays that hit something.
    pub(crate) hits: u64,
    /// Sum of the hit distances; 0 for any-hit rays.
    pub(crate) t_sum: f64,
}

/// Rays of a column, in memory and in a file.
#[derive(Debug)]
pub(crate) struct Batch {
    pub(crate) column: Column,
    pub(crate) rays: Vec<Ray>,
    pub(crate) file: PathBuf,
}

/// What casts rays.
pub(crate) enum Contender {
    Ours { name: String, accel: Box<Accel>, build_secs: f64, trained: bool },
    Embree { spec: EmbreeSpec, process: Process },
}

impl Contender {
    /// The name in tables.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Ours { name, .. } => name.clone(),
            Self::Embree { spec, .. } => format!("embree4({spec})"),
        }
    }

    /// CPU seconds of the build.
    pub(crate) fn build_secs(&self) -> f64 {
        match self {
            Self::Ours { build_secs, .. } => *build_secs,
            Self::Embree { process, .. } => process.build_secs,
        }
    }

    /// Bytes of the structure and its copies of triangles.
    pub(crate) fn bytes(&self) -> u64 {
        match self {
            Self::Ours { accel, .. } => accel.stats().bytes as u64,
            Self::Embree { process, .. } => process.bytes,
        }
    }

    /// Casts a batch once.
    pub(crate) fn cast(&mut self, batch: &Batch) -> Result<Cast> {
        match self {
            Self::Ours { accel, .. } => Ok(cast_ours(accel, batch)),
            Self::Embree { process, .. } => process.cast(batch),
        }
    }
}

/// The same loop as the engines'.
fn cast_ours(accel: &Accel, batch: &Batch) -> Cast {
    let start = thread_nanos();
    let (mut hits, mut t_sum) = (0, 0.0);
    if batch.column.query() == Query::Occluded {
        hits = batch.rays.iter().filter(|ray| accel.occluded(ray)).count() as u64;
    } else {
        for hit in batch.rays.iter().filter_map(|ray| accel.closest(ray)) {
            hits += 1;
            t_sum += f64::from(hit.t);
        }
    }
    let (hits, t_sum) = black_box((hits, t_sum));
    Cast { nanos: thread_nanos() - start, hits, t_sum }
}

/// A build of Embree: `high-avx2`, `medium-robust-avx512`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct EmbreeSpec {
    quality: String,
    pub(crate) robust: bool,
    isa: String,
}

impl EmbreeSpec {
    /// Whether this machine can run it: Embree would not say so, but crash or take other instructions.
    pub(crate) fn is_supported(&self) -> bool {
        match self.isa.as_str() {
            #[cfg(target_arch = "x86_64")]
            "avx2" => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            "avx512" => ["f", "dq", "cd", "bw", "vl"].iter().all(|part| avx512(part)),
            #[cfg(target_arch = "x86_64")]
            _ => true,
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn avx512(part: &str) -> bool {
    match part {
        "f" => is_x86_feature_detected!("avx512f"),
        "dq" => is_x86_feature_detected!("avx512dq"),
        "cd" => is_x86_feature_detected!("avx512cd"),
        "bw" => is_x86_feature_detected!("avx512bw"),
        _ => is_x86_feature_detected!("avx512vl"),
    }
}

impl std::fmt::Display for EmbreeSpec {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}-{}", self.quality, if self.robust { "-robust" } else { "" }, self.isa)
    }
}

impl FromStr for EmbreeSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<_> = text.split('-').collect();
        let (quality, robust, isa) = match parts[..] {
            [quality, isa] => (quality, false, isa),
            [quality, "robust", isa] => (quality, true, isa),
            _ => return Err("QUALITY[-robust]-ISA is needed, as in high-avx2".to_owned()),
        };
        let known = ["high", "medium"].contains(&quality) && ["sse2", "sse4.2", "avx", "avx2", "avx512"].contains(&isa);
        known.then(|| Self { quality: quality.to_owned(), robust, isa: isa.to_owned() }).ok_or_else(|| {
            "known qualities: high, medium; instruction sets: sse2, sse4.2, avx, avx2, avx512".to_owned()
        })
    }
}

/// A running engine.
pub(crate) struct Process {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    build_secs: f64,
    bytes: u64,
}

impl Process {
    /// Starts the engine on a mesh file, and waits until it has built.
    pub(crate) fn start(engine: &Engine, spec: &EmbreeSpec, mesh: &Path) -> Result<Self> {
        let mut command = Command::new(&engine.program);
        command.arg("--lib").arg(&engine.lib).arg("--mesh").arg(mesh);
        command.args(["--quality", &spec.quality, "--isa", &spec.isa]).args(spec.robust.then_some("--robust"));
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().context("engines/embree")?;
        let (input, output) = (child.stdin.take().context("no input")?, child.stdout.take().context("no output")?);
        let mut process = Self { child, input, output: BufReader::new(output), build_secs: 0.0, bytes: 0 };
        let built = process.answer()?;
        process.build_secs = field::<f64>(&built, "build_nanos")? * 1e-9;
        process.bytes = field(&built, "bytes")?;
        Ok(process)
    }

    fn cast(&mut self, batch: &Batch) -> Result<Cast> {
        let query = if batch.column.query() == Query::Occluded { "occluded" } else { "closest" };
        writeln!(self.input, "cast {} {query} 1", batch.file.display()).context("the engine has ended")?;
        let answer = self.answer()?;
        let nanos: Vec<u64> = field(&answer, "nanos")?;
        ensure!(nanos.len() == 1, "the engine repeated {} times, not once", nanos.len());
        Ok(Cast { nanos: nanos[0], hits: field(&answer, "hits")?, t_sum: field(&answer, "t_sum")? })
    }

    fn answer(&mut self) -> Result<Value> {
        let mut line = String::new();
        if self.output.read_line(&mut line)? == 0 {
            bail!("the engine has ended without an answer: {}", self.child.wait()?);
        }
        let answer: Value = serde_json::from_str(&line).with_context(|| format!("the engine answered '{line}'"))?;
        match answer.get("error") {
            Some(error) => bail!("the engine says: {}", error.as_str().unwrap_or_default()),
            None => Ok(answer),
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It would end by itself when its input does, but not before it has answered.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

fn field<T: DeserializeOwned>(answer: &Value, name: &str) -> Result<T> {
    let value = answer.get(name).cloned().unwrap_or_default();
    serde_json::from_value(value).with_context(|| format!("the engine's answer {answer}: field '{name}'"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn builds_of_embree_round_trip() {
        for text in ["high-avx2", "medium-robust-avx512", "high-sse4.2"] {
            assert_eq!(text.parse::<EmbreeSpec>().unwrap().to_string(), text);
        }
        for text in ["", "high", "low-avx2", "high-avx3", "high-robust", "high-solid-avx2"] {
            assert!(text.parse::<EmbreeSpec>().is_err(), "{text}");
        }
    }
}
