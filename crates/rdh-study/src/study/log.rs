//! Logs, of a study or a race: one record a line, each with its checksum, appended and made durable before the next job begins.
//!
//! A line is sixteen hexadecimal digits (XXH3-64 of the rest), a space, and the record as JSON. A process that dies while it writes leaves
//! a last line without an end, which is cut off; anything else that is wrong with a log is an error that says where.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::{Serialize, de::DeserializeOwned};
use xxhash_rust::xxh3::xxh3_64;

use crate::error::{Error, Result};

/// A log that is being written, by this process alone.
#[derive(Debug)]
pub struct Log<R, F: Durable = File> {
    file: F,
    path: PathBuf,
    /// Bytes of whole records.
    len: u64,
    records: PhantomData<fn(R)>,
}

/// What a log is written to.
pub trait Durable: Write {
    /// Returns when everything written is safe.
    ///
    /// # Errors
    /// What the system says.
    fn sync(&mut self) -> io::Result<()>;

    /// Cuts off what is beyond `len`, and goes on writing there.
    ///
    /// # Errors
    /// What the system says.
    fn cut(&mut self, len: u64) -> io::Result<()>;
}

impl Durable for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }

    fn cut(&mut self, len: u64) -> io::Result<()> {
        self.set_len(len)?;
        self.seek(SeekFrom::Start(len)).map(|_| ())
    }
}

/// What is in a log.
#[derive(Debug)]
pub struct Contents<R> {
    /// The records, in order.
    pub records: Vec<R>,
    /// Bytes of whole records.
    pub len: u64,
    /// Bytes of a torn line at the end.
    pub torn: u64,
}

impl<R: Serialize + DeserializeOwned> Log<R> {
    /// Opens a log to append to, made if it isn't there; a torn last line is cut off. Returns what is in it.
    ///
    /// # Errors
    /// A log that another process is writing, that can't be read, or that is damaged otherwise.
    pub fn open(path: &Path) -> Result<(Self, Contents<R>)> {
        let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(Error::file(path))?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => {
                Error::Content { path: path.to_owned(), reason: "another process is writing it".to_owned() }
            }
            TryLockError::Error(source) => Error::File { path: path.to_owned(), source },
        })?;
        let contents = read(path)?;
        let mut log = Self { file, path: path.to_owned(), len: contents.len, records: PhantomData };
        log.file.cut(log.len).map_err(Error::file(path))?;
        Ok((log, contents))
    }
}

impl<R: Serialize, F: Durable> Log<R, F> {
    /// Appends a record; it is safe when this returns. If it can't be written, the log holds what it held before.
    ///
    /// # Errors
    /// What the system says, with the file: a full disk, say.
    pub fn append(&mut self, record: &R) -> Result<()> {
        let line = line(record).map_err(|e| Error::Content { path: self.path.clone(), reason: e.to_string() })?;
        match self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync()) {
            Ok(()) => {
                self.len += line.len() as u64;
                Ok(())
            }
            Err(source) => {
                // Half a line is a torn line, which the next one to open the log would cut off, too.
                let _ = self.file.cut(self.len);
                Err(Error::File { path: self.path.clone(), source })
            }
        }
    }
}

/// Reads a log.
///
/// # Errors
/// A file that can't be read; a line that ends and is damaged, with its number and byte.
pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Contents<R>> {
    let mut reader = BufReader::new(File::open(path).map_err(Error::file(path))?);
    let mut contents = Contents { records: Vec::new(), len: 0, torn: 0 };
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        if reader.read_until(b'\n', &mut line).map_err(Error::file(path))? == 0 {
            break;
        }
        match parse(&line) {
            Ok(record) => {
                contents.records.push(record);
                contents.len += line.len() as u64;
            }
            // Written in one piece, a line that doesn't end is one whose writer died; if it is one of ours.
            Err(_) if is_begun(&line) => contents.torn = line.len() as u64,
            Err(reason) => {
                let reason = format!("line {number}, byte {}: {reason}", contents.len);
                return Err(Error::Content { path: path.to_owned(), reason });
            }
        }
    }
    Ok(contents)
}

/// Whether a line begins as ours do, and does not end.
fn is_begun(line: &[u8]) -> bool {
    let (sum, rest) = line.split_at(line.len().min(16));
    sum.iter().all(u8::is_ascii_hexdigit) && (rest.is_empty() || rest.starts_with(b" ")) && line.last() != Some(&b'\n')
}

fn line(record: &impl Serialize) -> serde_json::Result<String> {
    let json = serde_json::to_string(record)?;
    Ok(format!("{:016x} {json}\n", xxh3_64(json.as_bytes())))
}

fn parse<R: DeserializeOwned>(line: &[u8]) -> Result<R, String> {
    let line = line.strip_suffix(b"\n").ok_or("the line does not end")?;
    let text = std::str::from_utf8(line).map_err(|e| e.to_string())?;
    let (sum, json) = text.split_once(' ').ok_or("there is no checksum")?;
    if sum != format!("{:016x}", xxh3_64(json.as_bytes())) {
        return Err("the checksum is wrong".to_owned());
    }
    serde_json::from_str(json).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::Mode;
    use crate::rows::Failure;
    use crate::study::record::{Job, Record};

    fn record(view: &str) -> Record {
        let job = Job { experiment: "modes".into(), scene: "room".into(), view: view.into(), frame: 0, mode: Mode::Ao };
        let failure = Failure { scene: "room".into(), view: None, spec: None, reason: format!("größer als {view}") };
        Record { failures: vec![failure], ..Record::of(job) }
    }

    fn written(path: &Path, views: &[&str]) {
        let (mut log, _) = Log::<Record>::open(path).unwrap();
        for view in views {
            log.append(&record(view)).unwrap();
        }
    }

    fn views(contents: &Contents<Record>) -> Vec<&str> {
        contents.records.iter().map(|r| r.job.view.as_str()).collect()
    }

    #[test]
    fn what_is_appended_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("jobs.log");
        written(&path, &["a", "b"]);
        written(&path, &["c"]);
        let contents = read(&path).unwrap();
        assert_eq!((views(&contents), contents.torn), (vec!["a", "b", "c"], 0));
        assert_eq!(contents.records[1], record("b"));
    }

    #[test]
    fn a_line_torn_at_any_byte_costs_that_line_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("jobs.log");
        written(&path, &["a", "b"]);
        let whole = std::fs::read(&path).unwrap();
        let first = line(&record("a")).unwrap().len();
        for end in 0..whole.len() {
            std::fs::write(&path, &whole[..end]).unwrap();
            let (mut log, contents) = Log::<Record>::open(&path).unwrap();
            let kept = if end < first { 0 } else { 1 };
            assert_eq!(contents.records.len(), kept, "cut at byte {end}");
            log.append(&record("c")).unwrap();
            drop(log);
            let contents = read::<Record>(&path).unwrap();
            assert_eq!((contents.records.len(), contents.torn), (kept + 1, 0), "cut at byte {end}");
        }
    }

    #[test]
    fn damage_elsewhere_is_an_error_that_says_where() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("jobs.log");
        written(&path, &["a", "b", "c"]);
        let mut bytes = std::fs::read(&path).unwrap();
        let first = line(&record("a")).unwrap().len();
        bytes[first + 40] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        let error = Log::<Record>::open(&path).unwrap_err().to_string();
        assert!(error.contains(&format!("jobs.log: line 2, byte {first}: the checksum is wrong")), "{error}");
    }

    #[test]
    fn a_file_that_is_no_log_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poem.txt");
        for text in ["once upon a time", "deadbeef: a time\n", "0123456789abcdef0"] {
            std::fs::write(&path, text).unwrap();
            assert!(Log::<Record>::open(&path).unwrap_err().to_string().contains("line 1, byte 0"), "{text}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
    }

    #[test]
    fn two_processes_cannot_write_one_log() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("jobs.log");
        let (_log, _) = Log::<Record>::open(&path).unwrap();
        let error = Log::<Record>::open(&path).unwrap_err().to_string();
        assert!(error.contains("another process is writing it"), "{error}");
    }

    /// A disk with room for so many bytes.
    #[derive(Debug)]
    struct Small {
        bytes: Vec<u8>,
        room: usize,
    }

    impl Write for Small {
        fn write(&mut self, data: &[u8]) -> io::Result<usize> {
            let fits = data.len().min(self.room - self.bytes.len());
            self.bytes.extend_from_slice(&data[..fits]);
            if fits == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(fits) }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Durable for Small {
        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }

        fn cut(&mut self, len: u64) -> io::Result<()> {
            self.bytes.truncate(len as usize);
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_said_and_nothing_is_lost() {
        let first = line(&record("a")).unwrap();
        let disk = Small { bytes: Vec::new(), room: first.len() + 30 };
        let mut log = Log { file: disk, path: "jobs.log".into(), len: 0, records: PhantomData };
        log.append(&record("a")).unwrap();
        let error = log.append(&record("b")).unwrap_err().to_string();
        assert!(error.starts_with("jobs.log: ") && error.contains("no storage space"), "{error}");
        assert_eq!(log.file.bytes, first.as_bytes());
    }
}
