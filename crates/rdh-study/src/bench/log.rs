//! What is found out, appended to a file as it comes, so that an interrupted race goes on where it was.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::rows::{Record, Settings};
use crate::error::{Error, Result};

/// A file of records: a line of settings, then a line for each column of each scene.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: File,
}

/// The first line.
#[derive(Serialize, Deserialize)]
struct Head {
    bench: Settings,
}

impl Log {
    /// Opens a file, or begins it; gives what it holds already. A last line that was cut short is cut off.
    ///
    /// # Errors
    /// A file that can't be read or written, is none of these, or was begun with other settings.
    pub fn open(path: &Path, settings: &Settings) -> Result<(Self, Vec<Record>)> {
        let fail = |e: io::Error| Error::Plan(format!("{}: {e}", path.display()));
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(fail)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(fail)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let records = parse(&text[..whole], path, settings)?;
        file.set_len(whole as u64).map_err(fail)?;
        let mut log = Self { path: path.to_path_buf(), file };
        if whole == 0 {
            log.line(&Head { bench: settings.clone() })?;
        }
        Ok((log, records))
    }

    /// Appends a record.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn append(&mut self, record: &Record) -> Result<()> {
        self.line(record)
    }

    fn line(&mut self, item: &impl Serialize) -> Result<()> {
        let fail = |e: String| Error::Plan(format!("{}: {e}", self.path.display()));
        let line = serde_json::to_string(item).map_err(|e| fail(e.to_string()))? + "\n";
        // In one piece, so that a line is there or not.
        self.file.write_all(line.as_bytes()).map_err(|e| fail(e.to_string()))
    }
}

fn parse(text: &str, path: &Path, settings: &Settings) -> Result<Vec<Record>> {
    let fail = |line: usize, why: String| Error::Plan(format!("{}:{line}: {why}", path.display()));
    let mut lines = text.lines().enumerate();
    let Some((_, head)) = lines.next() else { return Ok(Vec::new()) };
    let head: Head = serde_json::from_str(head).map_err(|e| fail(1, format!("no log of a race: {e}")))?;
    if head.bench != *settings {
        return Err(fail(1, "this race was begun with other settings; give the same, or another file".to_owned()));
    }
    lines.map(|(i, line)| serde_json::from_str(line).map_err(|e| fail(i + 1, e.to_string()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{BenchPlan, Column};

    #[test]
    fn a_race_goes_on_where_it_was_and_only_with_the_same_settings() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("race.jsonl");
        let settings = Settings::of(&BenchPlan::default());
        let record = |scene: &str| Record {
            scene: scene.to_owned(),
            view: "v".to_owned(),
            column: Column::Ao,
            rows: Vec::new(),
        };
        let (mut log, known) = Log::open(&path, &settings).unwrap();
        assert!(known.is_empty());
        log.append(&record("a")).unwrap();
        drop(log);
        // As if the machine had gone down while a line was written.
        let mut text = std::fs::read_to_string(&path).unwrap();
        text += r#"{"scene":"b","vi"#;
        std::fs::write(&path, text).unwrap();
        let (mut log, known) = Log::open(&path, &settings).unwrap();
        assert_eq!(known, [record("a")]);
        log.append(&record("c")).unwrap();
        assert_eq!(Log::open(&path, &settings).unwrap().1, [record("a"), record("c")]);

        let other = Settings { rounds: 99, ..settings };
        assert!(Log::open(&path, &other).unwrap_err().to_string().contains("other settings"));
        std::fs::write(&path, "once upon a time\n").unwrap();
        assert!(Log::open(&path, &other).unwrap_err().to_string().contains("race.jsonl:1"));
    }
}
