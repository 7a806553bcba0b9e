//! Words, numbers and line numbers of text formats.

use crate::error::{Error, Result};

/// Walks through text word by word. Lines end with LF, CR LF or CR; the text need not be UTF-8.
pub(super) struct Text<'a> {
    bytes: &'a [u8],
    /// Where the next word is looked for.
    pub at: usize,
}

impl<'a> Text<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The next word, on whatever line.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_while(|b| b.is_ascii_whitespace());
        self.take_word()
    }

    /// The next word of this line. A backslash at a line's end continues the line.
    pub(super) fn word_in_line(&mut self) -> Option<&'a [u8]> {
        loop {
            self.skip_while(|b| b.is_ascii_whitespace() && !is_end(b));
            match self.continuation() {
                0 => break,
                length => self.at += length,
            }
        }
        if self.peek().is_none_or(is_end) { None } else { self.take_word() }
    }

    /// The rest of this line, without its end.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let start = self.at;
        self.skip_while(|b| !is_end(b));
        &self.bytes[start..self.at]
    }

    /// Goes past the end of this line and of the lines that continue it.
    pub(super) fn skip_line(&mut self) {
        loop {
            self.skip_while(|b| !is_end(b) && b != b'\\');
            match self.continuation() {
                0 if self.peek() == Some(b'\\') => self.at += 1,
                0 => return,
                length => self.at += length,
            }
        }
    }

    /// Whether only white space is left.
    pub(super) fn is_at_end(&mut self) -> bool {
        self.skip_while(|b| b.is_ascii_whitespace());
        self.peek().is_none()
    }

    /// "line 12", for a place in the text.
    pub(super) fn line(&self, at: usize) -> String {
        line_of(self.bytes, at)
    }

    /// An error at a place in the text.
    pub(super) fn error(&self, at: usize, reason: impl Into<String>) -> Error {
        Error::at(self.line(at), reason)
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn skip_while(&mut self, skip: impl Fn(u8) -> bool) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|&b| !skip(b)).unwrap_or(rest.len());
    }

    fn take_word(&mut self) -> Option<&'a [u8]> {
        let start = self.at;
        self.skip_while(|b| !b.is_ascii_whitespace());
        (self.at > start).then(|| &self.bytes[start..self.at])
    }

    /// How many bytes a line continuation takes here; 0 if there is none.
    fn continuation(&self) -> usize {
        match &self.bytes[self.at..] {
            [b'\\', b'\r', b'\n', ..] => 3,
            [b'\\', b'\n' | b'\r', ..] => 2,
            _ => 0,
        }
    }
}

fn is_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// "line 12", for a place in some bytes.
pub(crate) fn line_of(bytes: &[u8], at: usize) -> String {
    let before = &bytes[..at.min(bytes.len())];
    let count = |end: u8| before.iter().filter(|&&b| b == end).count();
    // Only files of old have lines that end with CR alone.
    let ends = match count(b'\n') {
        0 => count(b'\r'),
        ends => ends,
    };
    format!("line {}", ends + 1)
}

/// A number, as a coordinate may be: finite, and within the range of f32.
pub(super) fn coordinate(word: &[u8]) -> Result<f64, String> {
    number(word).and_then(in_range)
}

/// Any number, infinities and NaN included.
pub(super) fn number(word: &[u8]) -> Result<f64, String> {
    let text = std::str::from_utf8(word).ok();
    text.and_then(|t| t.parse().ok()).ok_or_else(|| format!("'{}' is not a number", shown(word)))
}

/// Refuses what can't be a coordinate.
pub(super) fn in_range(x: f64) -> Result<f64, String> {
    if x.abs() <= f64::from(f32::MAX) {
        Ok(x)
    } else if x.is_finite() {
        Err(format!("coordinate {x:e} is beyond the range of 32-bit floats"))
    } else {
        Err(format!("coordinate {x} is not a finite number"))
    }
}

/// A word for an error message: readable, and not too long.
pub(super) fn shown(word: &[u8]) -> String {
    const MOST: usize = 40;
    let text: String = String::from_utf8_lossy(&word[..word.len().min(MOST)]).escape_debug().collect();
    if word.len() > MOST { format!("{text}…") } else { text }
}
