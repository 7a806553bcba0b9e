//! What is found out, appended to a file as it comes, so that an interrupted race goes on where it was.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::rows::{Record, Settings};
use crate::error::{Error, Result};
use crate::study::log;

/// A file of records: the settings, then what is found out in each column of each scene. One process at a time writes it; each line
/// has its checksum and is safe before the race goes on.
#[derive(Debug)]
pub struct Log(log::Log<Line>);

/// A line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Line {
    /// The first one.
    Bench(Settings),
    Column(Record),
}

impl Log {
    /// Opens a file, or begins it; gives what it holds already. A last line that was cut short is cut off.
    ///
    /// # Errors
    /// A file that can't be read or written, that another process is writing, that is damaged or no such log, or that was begun with other
    /// settings.
    pub fn open(path: &Path, settings: &Settings) -> Result<(Self, Vec<Record>)> {
        let fail = |reason: &str| Error::Content { path: path.to_owned(), reason: reason.to_owned() };
        let (mut log, contents) = log::Log::open(path)?;
        let mut lines = contents.records.into_iter();
        match lines.next() {
            None => log.append(&Line::Bench(settings.clone()))?,
            Some(Line::Bench(known)) if known == *settings => {}
            Some(Line::Bench(_)) => {
                return Err(fail("this race was begun with other settings; give the same, or another file"));
            }
            Some(Line::Column(_)) => return Err(fail("line 1: the settings are missing")),
        }
        let record = |line| match line {
            Line::Column(record) => Ok(record),
            Line::Bench(_) => Err(fail("there are settings in the middle")),
        };
        Ok((Self(log), lines.map(record).collect::<Result<_>>()?))
    }

    /// Appends a record; it is safe when this returns.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn append(&mut self, record: &Record) -> Result<()> {
        self.0.append(&Line::Column(record.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{BenchFailure, BenchPlan, Column};

    fn record(scene: &str) -> Record {
        let failure = BenchFailure { scene: scene.to_owned(), engine: None, reason: "it broke".to_owned() };
        Record {
            scene: scene.to_owned(),
            view: "v".to_owned(),
            column: Column::Ao,
            rows: Vec::new(),
            failures: vec![failure],
            skipped: Vec::new(),
        }
    }

    #[test]
    fn a_race_goes_on_where_it_was_and_only_with_the_same_settings() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("race.log");
        let settings = Settings::of(&BenchPlan::default());
        let (mut log, known) = Log::open(&path, &settings).unwrap();
        assert!(known.is_empty());
        log.append(&record("a")).unwrap();
        let busy = Log::open(&path, &settings).unwrap_err().to_string();
        assert!(busy.contains("another process is writing it"), "{busy}");
        drop(log);
        // As if the machine had gone down while a line was written.
        let mut text = std::fs::read_to_string(&path).unwrap();
        text += r#"0123456789abcdef {"column":{"scene":"b","vi"#;
        std::fs::write(&path, text).unwrap();
        let (mut log, known) = Log::open(&path, &settings).unwrap();
        assert_eq!(known, [record("a")]);
        log.append(&record("c")).unwrap();
        drop(log);
        assert_eq!(Log::open(&path, &settings).unwrap().1, [record("a"), record("c")]);

        let other = Settings { rounds: 99, ..settings };
        assert!(Log::open(&path, &other).unwrap_err().to_string().contains("other settings"));
    }

    #[test]
    fn a_changed_byte_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("race.log");
        let settings = Settings::of(&BenchPlan::default());
        Log::open(&path, &settings).unwrap().0.append(&record("a")).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("it broke", "it works")).unwrap();
        let error = Log::open(&path, &settings).unwrap_err().to_string();
        assert!(error.contains("race.log: line 2") && error.contains("checksum"), "{error}");
    }
}
