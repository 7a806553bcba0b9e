//! Requests and answers, a line each.

use std::io::{BufRead, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use crate::cast::{self, Form};
use crate::engine::{Absent, Built, Engine, Query, Ray};
use crate::files;
use crate::options::Options;

/// Builds, and answers requests on standard input until it ends.
pub fn serve<E: Engine>() -> ExitCode {
    match run::<E>() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let kind = if error.is::<Absent>() { "absent" } else { "error" };
            answer(&json!({kind: format!("{error:#}")})).ok();
            ExitCode::FAILURE
        }
    }
}

fn run<E: Engine>() -> Result<()> {
    let options = Options::parse(std::env::args_os().skip(1))?;
    let mesh = files::read_mesh(&options.mesh)?;
    let triangles = mesh.triangles.len();
    let Built { engine, version, build_nanos, bytes } = E::build(mesh, &options.mode)?;
    answer(&json!({
        "engine": E::NAME, "version": version, "mode": options.mode, "triangles": triangles,
        "build_nanos": build_nanos, "bytes": bytes,
    }))?;
    let mut server = Server { engine, answers: options.answers, rays: None };
    for line in std::io::stdin().lock().lines() {
        let reply = server.request(&line?).unwrap_or_else(|e| json!({"error": format!("{e:#}")}));
        answer(&reply)?;
    }
    Ok(())
}

/// A built engine, and the file of rays that it cast last: reading is not what is measured, but it disturbs the caches.
struct Server<E> {
    engine: E,
    answers: Option<PathBuf>,
    rays: Option<(PathBuf, Vec<Ray>)>,
}

/// `cast single closest 3 FILE`, or the same without the number for `answers`.
struct Request<'a> {
    form: Form,
    query: Query,
    /// How often; nothing where answers are wanted.
    reps: Option<u32>,
    /// May hold blanks, so it comes last.
    file: &'a Path,
}

impl<E: Engine> Server<E> {
    fn request(&mut self, line: &str) -> Result<Value> {
        let Request { form, query, reps, file } = Request::parse(line)?;
        let rays = match &mut self.rays {
            Some((known, rays)) if known == file => rays,
            last => &last.insert((file.to_path_buf(), files::read_rays(file)?)).1,
        };
        let Some(reps) = reps else {
            let out = self.answers.as_ref().context("this program was started without --answers FILE")?;
            let answers = cast::answers(&self.engine, rays, query, form)?;
            files::write_answers(out, &answers)?;
            return Ok(json!({"rays": answers.len()}));
        };
        let casts = (0..reps).map(|_| cast::timed(&self.engine, rays, query, form)).collect::<Result<Vec<_>>>()?;
        let last = casts.last().copied().unwrap_or_default();
        let nanos: Vec<u64> = casts.iter().map(|c| c.nanos).collect();
        Ok(json!({"nanos": nanos, "hits": last.hits, "t_sum": last.t_sum}))
    }
}

impl<'a> Request<'a> {
    const KNOWN: &'static str =
        "cast single|packets closest|occluded REPS FILE; answers single|packets closest|occluded FILE";

    fn parse(line: &'a str) -> Result<Self> {
        let timed = line.starts_with("cast ");
        let words: Vec<_> = line.splitn(if timed { 5 } else { 4 }, ' ').collect();
        let (verb, form, query, reps, file) = match words[..] {
            ["cast", form, query, reps, file] => ("cast", form, query, Some(reps), file),
            ["answers", form, query, file] => ("answers", form, query, None, file),
            _ => bail!("'{line}' is not understood; known: {}", Self::KNOWN),
        };
        let form = match form {
            "single" => Form::Single,
            "packets" => Form::Packets,
            _ => bail!("{verb}: unknown form '{form}'; known: single, packets"),
        };
        let query = match query {
            "closest" => Query::Closest,
            "occluded" => Query::Occluded,
            _ => bail!("{verb}: unknown query '{query}'; known: closest, occluded"),
        };
        let reps = reps.map(|n| n.parse().with_context(|| format!("'{n}' repetitions"))).transpose()?;
        Ok(Self { form, query, reps, file: Path::new(file) })
    }
}

fn answer(value: &Value) -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{value}")?;
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_parsed_and_wrong_ones_refused() {
        let request = Request::parse("cast packets occluded 3 /a b/c.rays").unwrap();
        assert_eq!((request.form, request.query, request.reps), (Form::Packets, Query::Occluded, Some(3)));
        assert_eq!(request.file, Path::new("/a b/c.rays"));
        let request = Request::parse("answers single closest a b").unwrap();
        assert_eq!((request.form, request.query, request.reps), (Form::Single, Query::Closest, None));
        assert_eq!(request.file, Path::new("a b"));
        let wrong = [
            "",
            "cast",
            "cast single closest x a",
            "cast single nearest 1 a",
            "cast pairs closest 1 a",
            "cost a b c d",
        ];
        for line in wrong {
            assert!(Request::parse(line).is_err(), "{line}");
        }
    }
}
