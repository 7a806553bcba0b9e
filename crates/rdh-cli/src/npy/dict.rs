//! The header's text: a Python dictionary of three entries.

use anyhow::{Context as _, Result, bail, ensure};

/// The three entries of a header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dict {
    /// The type of the elements, as text; only plain types are known.
    pub(super) descr: String,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<u64>,
}

impl Dict {
    /// Parses `{'descr': '<f4', 'fortran_order': False, 'shape': (10, 8), }`, entries in any order.
    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut rest = text.trim().strip_prefix('{').context("the header is no dictionary")?.trim_start();
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        while !rest.starts_with('}') {
            let (key, after) = quoted(rest)?;
            let value = after.trim_start().strip_prefix(':').context("a key of the header has no value")?.trim_start();
            rest = match key {
                "descr" => put(&mut descr, quoted(value).context("structured arrays hold no rays")?)?,
                "fortran_order" => put(&mut fortran_order, boolean(value)?)?,
                "shape" => put(&mut shape, tuple(value)?)?,
                other => bail!("the header has an unknown entry '{other}'"),
            };
            rest = rest.trim_start();
            rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
        }
        ensure!(rest[1..].trim().is_empty(), "something follows the header's dictionary");
        Ok(Self {
            descr: descr.context("the header has no 'descr'")?.to_owned(),
            fortran_order: fortran_order.context("the header has no 'fortran_order'")?,
            shape: shape.context("the header has no 'shape'")?,
        })
    }
}

/// Keeps a value that may come once; returns what follows it.
fn put<'a, T>(slot: &mut Option<T>, (value, rest): (T, &'a str)) -> Result<&'a str> {
    ensure!(slot.replace(value).is_none(), "an entry of the header comes twice");
    Ok(rest)
}

fn quoted(text: &str) -> Result<(&str, &str)> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"')).context("the header lacks a quoted text")?;
    text[1..].split_once(quote).context("the header's text is cut off")
}

fn boolean(text: &str) -> Result<(bool, &str)> {
    let known = [("True", true), ("False", false)];
    let found = known.iter().find_map(|(word, value)| Some((*value, text.strip_prefix(word)?)));
    found.context("'fortran_order' is neither True nor False")
}

fn tuple(text: &str) -> Result<(Vec<u64>, &str)> {
    let inner = text.strip_prefix('(').context("'shape' is no tuple")?;
    let (inner, rest) = inner.split_once(')').context("'shape' is cut off")?;
    let sides = inner.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape = sides.map(|side| side.parse().with_context(|| format!("'{side}' in 'shape' is no number")));
    Ok((shape.collect::<Result<_>>()?, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_numpy_writes_is_read() {
        let dict = Dict::parse("{'descr': '<f4', 'fortran_order': False, 'shape': (10, 8), }   \n").unwrap();
        assert_eq!(dict, Dict { descr: "<f4".to_owned(), fortran_order: false, shape: vec![10, 8] });
        assert_eq!(Dict::parse("{\"shape\":(3,),'fortran_order':True,'descr':'|b1'}").unwrap().shape, [3]);
        assert!(Dict::parse("{'descr': '<f8', 'fortran_order': False, 'shape': ()}").unwrap().shape.is_empty());
    }

    #[test]
    fn what_is_no_header_is_an_error() {
        for text in [
            "",
            "{",
            "}",
            "{}",
            "{'descr'",
            "{'descr': }",
            "{'descr': 5, 'fortran_order': False, 'shape': ()}",
            "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': ()}",
            "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': ()}",
            "{'descr': '<f4', 'fortran_order': 0, 'shape': ()}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (-1,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1)} x",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1), 'more': 'x'}",
            "{'ä",
        ] {
            assert!(Dict::parse(text).is_err(), "{text}");
        }
        assert!(Dict::parse(&"{".repeat(100_000)).is_err());
    }
}
