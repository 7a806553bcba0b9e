//! Generators as text: `balls(size=5,resolution=8)`.

use crate::error::{Error, Result};

/// Reads `name` or `name(key=value,…)` into a generator's table. Values are integers, numbers, or words.
///
/// # Errors
/// A bracket that doesn't close, or a parameter that isn't `key=value` or comes twice.
pub fn parse_call(text: &str) -> Result<toml::Table> {
    let text = text.trim();
    let (name, inner) = match text.split_once('(') {
        None => (text, ""),
        Some((name, rest)) => {
            let inner = rest.strip_suffix(')').ok_or_else(|| Error::whole(format!("`{text}`: `)` is missing")))?;
            (name.trim(), inner)
        }
    };
    let mut table = toml::Table::new();
    table.insert("generator".to_owned(), toml::Value::String(name.to_owned()));
    for part in inner.split(',').map(str::trim).filter(|_| !inner.trim().is_empty()) {
        let (key, value) =
            part.split_once('=').ok_or_else(|| Error::whole(format!("`{part}` in `{text}` is not key=value")))?;
        let (key, value) = (key.trim().to_owned(), value.trim());
        if key.is_empty() || value.is_empty() {
            return Err(Error::whole(format!("`{part}` in `{text}` is not key=value")));
        }
        if table.insert(key.clone(), parse_value(value)).is_some() {
            return Err(Error::whole(format!("`{key}` comes twice in `{text}`")));
        }
    }
    Ok(table)
}

fn parse_value(text: &str) -> toml::Value {
    if let Ok(integer) = text.parse::<i64>() {
        return toml::Value::Integer(integer);
    }
    text.parse::<f64>().map_or_else(|_| toml::Value::String(text.to_owned()), toml::Value::Float)
}

/// A generator's table as text, parameters in alphabetical order.
pub fn format_call(table: &toml::Table) -> String {
    let name = table.get("generator").and_then(toml::Value::as_str).unwrap_or("?");
    let mut parts: Vec<String> = table.iter().filter(|(key, _)| *key != "generator").map(parameter).collect();
    parts.sort();
    if parts.is_empty() { name.to_owned() } else { format!("{name}({})", parts.join(",")) }
}

fn parameter((key, value): (&String, &toml::Value)) -> String {
    match value {
        toml::Value::String(word) => format!("{key}={word}"),
        other => format!("{key}={other}"),
    }
}
