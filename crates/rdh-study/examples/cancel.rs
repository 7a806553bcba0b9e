//! How long builders work between two questions whether to stop, in CPU time of one thread; more than 50 ms is a failure:
//! `cargo run --release -p rdh-study --example cancel -- [--specs LIST] [--triangles N]`

use std::process::ExitCode;
use std::sync::Mutex;

use rdh::{BuildOptions, Mesh, Query, Ray, RayClass, RaySample, Spec, Training};
use rdh_study::clock::thread_nanos;
use rdh_study::identical::FAMILIES;

/// What a person does not notice.
const LONGEST_MS: f64 = 50.0;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(3),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether none works too long.
fn run() -> Result<bool, String> {
    let (mut specs, mut triangles) = (FAMILIES.to_owned(), 300_000usize);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or(format!("{argument} needs a value"))?;
        match &argument[..] {
            "--specs" => specs = value,
            "--triangles" => triangles = value.parse().map_err(|_| format!("'{value}' is no number"))?,
            other => return Err(format!("{other} is unknown")),
        }
    }
    let mesh = terrain((triangles as f64 / 2.0).sqrt() as u32);
    let training = rays(&mesh);
    let mut longest = 0.0f64;
    println!("| structure | questions | build, s | longest without a question, ms |\n|---|---|---|---|");
    for spec in Spec::list(&specs).map_err(|e| e.to_string())? {
        let (questions, secs, gap) = watched(&mesh, &spec, &training).map_err(|e| format!("{spec}: {e}"))?;
        println!("| `{spec}` | {questions} | {secs:.2} | {gap:.1} |");
        longest = longest.max(gap);
    }
    println!("in all: at most {longest:.1} ms over {} triangles on one thread", mesh.len());
    Ok(longest <= LONGEST_MS)
}

/// How often a build asks, how long it takes, and the longest time without a question, from the start and to the end too.
fn watched(mesh: &Mesh, spec: &Spec, training: &Training) -> rdh::Result<(usize, f64, f64)> {
    let start = thread_nanos();
    let state = Mutex::new((0usize, start, 0u64));
    let note = || {
        let mut state = state.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let (count, last, longest) = *state;
        let now = thread_nanos();
        *state = (count + 1, now, longest.max(now.saturating_sub(last)));
    };
    let cancel = || {
        note();
        false
    };
    let options = BuildOptions { threads: Some(1), cancel: Some(&cancel), ..BuildOptions::default() };
    let tree = rdh::build(mesh, spec, training, &options)?;
    note();
    drop(tree);
    let (count, end, longest) = state.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    Ok((count - 1, (end - start) as f64 * 1e-9, longest as f64 * 1e-6))
}

/// A bumpy height field of n × n squares.
fn terrain(n: u32) -> Mesh {
    let height = |i: u32, j: u32| ((i * 37 + j * 91) % 17) as f32 * 0.002 + ((i / 40 + j / 60) % 5) as f32 * 0.03;
    let row = |j: u32| (0..=n).map(move |i| [i as f32 / n as f32, j as f32 / n as f32, height(i, j)]);
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let square =
        |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let triangles = (0..n).flat_map(|j| (0..n).flat_map(move |i| square(i, j))).collect();
    Mesh::new((0..=n).flat_map(row).collect(), triangles).expect("a valid mesh")
}

/// Slanted rays over the terrain, a third of them for any hit.
fn rays(mesh: &Mesh) -> Training {
    let bounds = mesh.bounds();
    let sample = |i: usize| {
        let at = |k: usize| ((i * k) % 1009) as f32 / 1009.0;
        let ray = Ray::new([at(7), at(13), bounds.max[2] + 0.1], [at(29) - 0.5, at(31) - 0.5, -0.3]);
        let query = if i.is_multiple_of(3) { Query::Occluded } else { Query::Closest };
        RaySample::new(ray, None, query, RayClass::Other)
    };
    Training::from_samples((0..10_000).map(sample).collect())
}
