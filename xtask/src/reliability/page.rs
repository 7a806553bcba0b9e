//! The page: a table of promises, then what rays were cast at closed meshes, and what other libraries miss of them.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use anyhow::Result;
use serde_json::Value;

use super::promises::{PROMISES, Promise};
use super::record::{Record, Word, read};

pub(super) struct Page {
    /// Of the checks that were run.
    records: BTreeMap<&'static str, Record>,
}

/// What other libraries missed is no promise of ours: a record beside those of the promises.
const OTHERS: &str = "others";

impl Page {
    /// From what is kept in a folder.
    pub(super) fn of(folder: &Path) -> Result<Self> {
        let mut records = BTreeMap::new();
        for check in PROMISES.iter().map(|promise| promise.check).chain([OTHERS]) {
            if let Some(record) = read(folder, check)? {
                records.insert(check, record);
            }
        }
        Ok(Self { records })
    }

    pub(super) fn is_clean(&self) -> bool {
        self.records.values().all(|record| record.result != Word::Failed)
    }

    pub(super) fn text(&self) -> String {
        let mut out = String::from(HEAD);
        for Promise { promise, check, command } in &PROMISES {
            let row = self.records.get(check).map_or_else(|| "| not run |".to_owned(), row);
            writeln!(out, "| {promise} | `{command}` | {row} |").ok();
        }
        // With brute force, if the other was not run.
        out += &self.found("soak").or_else(|| self.found("brute")).map(rays).unwrap_or_default();
        out += &self.found(OTHERS).map(others).unwrap_or_default();
        out += &self.found("fuzz").map(fuzzing).unwrap_or_default();
        out
    }

    /// What a check found out in full.
    fn found(&self, check: &str) -> Option<&Value> {
        self.records.get(check).map(|record| &record.found).filter(|found| !found.is_null())
    }
}

/// How much, what came of it, when and where.
fn row(Record { count, result, why, date, version, machine, .. }: &Record) -> String {
    let result = match result {
        Word::Fine => "nothing found".to_owned(),
        Word::Failed => format!("failed: {why}"),
        Word::Skipped => format!("skipped: {why}"),
    };
    format!("{count} | {result} | {date}, {version}, {machine}")
}

const HEAD: &str = "\
<!-- Made by `cargo xtask reliability`; not to be changed by hand. -->
# Reliability

What is promised, how it is tested, and what came of it. Why no ray is lost is in [watertight.md](watertight.md), what files may do in \
[SECURITY.md](../SECURITY.md). What else was run, earlier and in emulators, is in \
[measurements.md](measurements.md#soaking-and-fuzzing-as-far-as-it-went). The results are kept in [reliability/](reliability/).

| promise | test | how much | result | when, which version, where |
|---|---|---|---|---|
";

const ABOUT_RAYS: &str = "\
Every ray starts inside and clear of the surface, so each must hit something, and meet an odd number of crossings. They are aimed at \
vertices, at edges, beside vertices by a step of the last bit, along axes with zeros of both signs, in split planes and faces of boxes, \
and anywhere; directions have length 1, the distance, or up to 2^±20 of it. A cast is a ray through one structure, by one query: nearest, \
any, and for an eighth of the rays all hits. All structures must give the same bits.

";

/// The rays of `soak`: by structure and by mesh, alone and in batches.
fn rays(soak: &Value) -> String {
    let tables = [structures(soak), meshes(soak)].join("\n");
    format!("\n## Rays from inside closed meshes\n\n{ABOUT_RAYS}{tables}{}", batches(soak))
}

/// Casts of each structure by aim; missed and different are of all.
fn structures(soak: &Value) -> String {
    let names = |key: &str| -> Vec<&str> { list(&soak[key]).iter().filter_map(Value::as_str).collect() };
    let aims = names("aims");
    let mut out =
        format!("| casts | {} | missed | different |\n|---|{}---|---|\n", aims.join(" | "), "---|".repeat(aims.len()));
    for (spec, cells) in names("specs").iter().zip(list(&soak["total"]["by_structure"])) {
        let sum = |which: usize| list(cells).iter().filter_map(|cell| cell[which].as_u64()).sum::<u64>();
        let casts: String = list(cells).iter().map(|cell| format!(" {} |", millions(&cell[0]))).collect();
        writeln!(out, "| `{spec}` |{casts} {} | {} |", sum(1), sum(2)).ok();
    }
    let levels = names("levels");
    let of_levels = levels
        .iter()
        .zip(list(&soak["total"]["by_level"]))
        .map(|(level, casts)| format!("{} by {level}", millions(casts)));
    let of_levels = of_levels.collect::<Vec<_>>().join(", ");
    writeln!(out, "\n{} different rays; casts: {of_levels}.", millions(&soak["total"]["rays"])).ok();
    out
}

fn meshes(soak: &Value) -> String {
    let mut out = String::from("| mesh | triangles | casts | missed |\n|---|---|---|---|\n");
    for mesh in list(&soak["meshes"]) {
        writeln!(out, "| {} | {} | {} | {} |", word(&mesh[0]), mesh[1], millions(&mesh[2]), mesh[3]).ok();
    }
    out
}

/// Batches by form, if any were cast.
fn batches(soak: &Value) -> String {
    let forms = list(&soak["forms"]).iter().zip(list(&soak["batches"]["by_form"]));
    let cast = forms.filter(|(_, counts)| counts[0].as_u64() > Some(0));
    let rows: String = cast
        .map(|(form, counts)| {
            format!("| {} | {} | {} | {} |\n", word(form), millions(&counts[0]), counts[1], counts[2])
        })
        .collect();
    if rows.is_empty() { rows } else { format!("\n{ABOUT_BATCHES}\n{rows}") }
}

const ABOUT_BATCHES: &str = "\
In batches, through hierarchies, kd-trees and trees around a point, at the same meshes and a large one; each ray's answer is to be that \
of the ray alone.

| batches | casts | missed | different |
|---|---|---|---|";

/// What others miss, in percent: a row an engine and mesh, a column an aim.
fn others(found: &Value) -> String {
    let all = list(&found["others"]);
    let aims: Vec<&str> = list(&found["aims"]).iter().filter_map(Value::as_str).collect();
    let mut out = format!(
        "\n## What other libraries miss of such rays\n\n{ABOUT_OTHERS}\n| library | mesh | {} |\n",
        aims.join(" | ")
    );
    writeln!(out, "|---|---|{}", "---|".repeat(aims.len())).ok();
    for row in all.chunk_by(|a, b| a["engine"] == b["engine"] && a["mesh"] == b["mesh"]) {
        let cell = |aim: &&str| row.iter().find(|other| other["aim"] == **aim).map_or("–".to_owned(), percent);
        let cells = aims.iter().map(cell).collect::<Vec<_>>().join(" | ");
        writeln!(out, "| {} | {} | {cells} |", word(&row[0]["engine"]), word(&row[0]["mesh"])).ok();
    }
    out
}

const ABOUT_OTHERS: &str = "\
The nearest hit is asked for, ray by ray, through the programs of `engines/`; each ray should find one. Of our structures none misses any \
(above). Not all of them promise it: only Embree's robust mode claims to be watertight.
";

fn percent(other: &Value) -> String {
    match (other["missed"].as_u64(), other["rays"].as_f64()) {
        (Some(0), Some(rays)) => format!("0 of {}", grouped(rays as u64)),
        (Some(missed), Some(rays)) => format!("{:.3} %", 100.0 * missed as f64 / rays),
        _ => "–".to_owned(),
    }
}

/// What fuzzing came to, by target.
fn fuzzing(found: &Value) -> String {
    let targets = found.as_object().into_iter().flatten();
    let rows = targets.map(|(target, came)| {
        let count = |key: &str| came[key].as_u64().unwrap_or_default();
        let hours = count("secs") as f64 / 3600.0;
        let verdict = if came["is_clean"] == true { "nothing" } else { "**failed**" };
        format!("| `{target}` | {hours:.2} | {} | {verdict} |\n", grouped(count("runs")))
    });
    format!("\n## Fuzzing\n\n{ABOUT_FUZZING}\n{}", rows.collect::<String>())
}

const ABOUT_FUZZING: &str = "\
By libFuzzer with AddressSanitizer, one process a target: all runs since something was found last. Hours are by the clock, beside other \
work. An input that takes 10 s, or 2 GiB, would be a finding.

| target | hours | inputs tried | found |
|---|---|---|---|";

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// A count in millions, or whole if it is small.
fn millions(count: &Value) -> String {
    match count.as_u64() {
        Some(n) if n >= 1_000_000 => format!("{:.1} M", n as f64 / 1e6),
        Some(n) => grouped(n),
        None => "–".to_owned(),
    }
}

/// With a comma between thousands.
pub(crate) fn grouped(n: u64) -> String {
    match n {
        0..1000 => n.to_string(),
        _ => format!("{},{:03}", grouped(n / 1000), n % 1000),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_page_says_what_is_kept_and_what_was_not_run() {
        let folder = tempfile::tempdir().unwrap();
        let keep = |check: &str, result: &str, found: Value| {
            let why = if result == "fine" { "" } else { "it broke" };
            let record = json!({
                "count": "7 things", "result": result, "why": why,
                "date": "2026-01-31", "version": "abc", "machine": "this", "found": found
            });
            std::fs::write(folder.path().join(format!("{check}.json")), record.to_string()).unwrap();
        };
        keep("fuzz", "fine", json!({ "rays": { "secs": 5400, "runs": 12_345, "is_clean": true } }));
        assert!(Page::of(folder.path()).unwrap().is_clean());
        keep("builds", "failed", Value::Null);
        keep(
            "soak",
            "fine",
            json!({
                "aims": ["vertex", "edge"], "specs": ["kd+sah"], "levels": ["portable"],
                "total": { "rays": 2_500_000, "by_level": [1234], "by_structure": [[[5, 1, 0], [6, 1, 2]]] },
                "meshes": [["box", 12, 3_000_000, 2]],
                "forms": ["tiles", "rows"], "batches": { "by_form": [[4_000_000, 3, 4], [0, 0, 0]] },
            }),
        );
        let other = |aim: &str, missed: u64| json!({ "engine": "other", "mesh": "box", "aim": aim, "rays": 1000, "missed": missed });
        let both = [other("vertex", 25), other("edge", 0)];
        keep("others", "fine", json!({ "aims": ["vertex", "edge"], "others": both }));
        let page = Page::of(folder.path()).unwrap();
        assert!(!page.is_clean());
        let text = page.text();
        assert!(!text.contains("| rows |"), "{text}");
        for wanted in [
            "| `cargo xtask fuzz` | 7 things | nothing found | 2026-01-31, abc, this |",
            "| 7 things | failed: it broke |",
            "| not run |",
            "| `kd+sah` | 5 | 6 | 2 | 2 |",
            "2.5 M different rays; casts: 1,234 by portable.",
            "| box | 12 | 3.0 M | 2 |",
            "| tiles | 4.0 M | 3 | 4 |",
            "| `rays` | 1.50 | 12,345 | nothing |",
            "| other | box | 2.500 % | 0 of 1,000 |",
        ] {
            assert!(text.contains(wanted), "{wanted} in\n{text}");
        }
    }
}
