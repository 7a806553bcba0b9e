//! Casts rays from inside closed meshes until so many are cast; a miss, or another answer than the first structure's, is a failure:
//! `cargo run --release -p rdh-study --example soak -- [--rays 1e9] [--seed N] [--brute] [--specs LIST] [--scenes DIR] [--json FILE]
//! [--engines DIR [--engine-rays N]] [--minutes N] [--batches 1e7]`
//!
//! A ray counts once for each structure and query. With `--brute` the meshes are small, and brute force says what is right. After
//! `--minutes` it ends with fewer rays: each mesh gets its share of what time is left. The file is written after every mesh. With
//! `--scenes` those scenes of a folder that are closed are cast at as well. With `--engines` the competitors whose programs are in the
//! folder (engines/README.md) get rays that are aimed alike. With `--batches` so many rays are cast in each form of batches, through trees
//! around a point, too; `--rays 0` leaves the others out. `cargo xtask soak` runs it.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use rdh::Spec;
use rdh::simd::Level;
use rdh_scene::catalog;
use rdh_study::identical::FAMILIES;
use rdh_study::soak::others::{Other, others};
use rdh_study::soak::{
    Aim, Batches, Closed, Detail, Form, Plan, Tally, closed_meshes, closed_model, large_mesh, shares, soak,
    soak_batches,
};
use serde_json::json;

fn main() -> ExitCode {
    match Wanted::parse(std::env::args().skip(1)).and_then(|wanted| wanted.run()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(3),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Wanted {
    plan: Plan,
    scenes: Option<PathBuf>,
    json: Option<PathBuf>,
    engines: Option<PathBuf>,
    engine_rays: usize,
    time: Option<Duration>,
    /// Of each form.
    batches: u64,
}

/// Larger scenes are not looked at: the structures of all kinds would take minutes to build.
const MOST_TRIANGLES: usize = 200_000;

impl Wanted {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let list = |text: &str| Spec::list(text).map_err(|e| e.to_string());
        let mut plan = Plan { specs: list(FAMILIES)?, casts: 10_000_000, seed: 1, brute: false };
        // What it chooses is one of the others, and choosing takes as long as building them all.
        plan.specs.retain(|spec| *spec != Spec::AUTO);
        let mut wanted =
            Self { plan, scenes: None, json: None, engines: None, engine_rays: 100_000, time: None, batches: 0 };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            match &argument[..] {
                "--rays" => wanted.plan.casts = number(&value()?)?,
                "--seed" => wanted.plan.seed = number(&value()?)?,
                "--brute" => wanted.plan.brute = true,
                "--specs" => wanted.plan.specs = list(&value()?)?,
                "--scenes" => wanted.scenes = Some(value()?.into()),
                "--json" => wanted.json = Some(value()?.into()),
                "--engines" => wanted.engines = Some(value()?.into()),
                "--minutes" => wanted.time = Some(Duration::from_secs(60 * number(&value()?)?)),
                "--batches" => wanted.batches = number(&value()?)?,
                "--engine-rays" => wanted.engine_rays = number(&value()?)? as usize,
                other => return Err(format!("{other} is unknown")),
            }
        }
        Ok(wanted)
    }

    /// Whether nothing was missed.
    fn run(&self) -> Result<bool, String> {
        let meshes = self.meshes()?;
        let start = Instant::now();
        let (mut total, mut by_mesh) = (Tally::default(), Vec::new());
        for (i, (closed, part)) in meshes.iter().zip(shares(&meshes)).enumerate().filter(|_| self.plan.casts > 0) {
            // What smaller shares have overshot is taken from those to come.
            let share = self.plan.casts.saturating_sub(total.casts) as f64 * part;
            let until = self.time.map(|time| Instant::now() + time.saturating_sub(start.elapsed()).mul_f64(part));
            let tally =
                soak(closed, i, share as u64, until, &self.plan).map_err(|e| format!("{}: {e}", closed.name))?;
            by_mesh.push((closed, tally.clone()));
            total = total.plus(tally);
            let (rays, casts) = (total.rays, total.casts);
            eprintln!(
                "{}/{} {}: {rays} rays, {casts} casts, {} missed, {} different, {:.0} s",
                i + 1,
                meshes.len(),
                closed.name,
                total.misses,
                total.different,
                start.elapsed().as_secs_f64()
            );
            self.write(&total, &by_mesh, &[], &Batches::default())?;
        }
        self.print(&total, &by_mesh);
        let batches = self.cast_batches(meshes.clone())?;
        let others = self.others(&meshes)?;
        print_others(&others);
        self.write(&total, &by_mesh, &others, &batches)?;
        Ok(total.is_clean() && batches.is_clean())
    }

    fn cast_batches(&self, mut meshes: Vec<Closed>) -> Result<Batches, String> {
        let mut all = Batches::default();
        if self.batches == 0 {
            return Ok(all);
        }
        meshes.push(large_mesh());
        let mut left = self.batches as f64;
        for (i, (closed, part)) in meshes.iter().zip(shares(&meshes)).enumerate() {
            let share = (left * part).ceil() as u64;
            left -= share as f64;
            let one = soak_batches(closed, i, share, self.plan.seed).map_err(|e| format!("{}: {e}", closed.name))?;
            all = all.plus(one);
            eprintln!("{}/{} {}: {:?}", i + 1, meshes.len(), closed.name, all.by_form);
        }
        println!("\n| batches | casts | missed | other than alone |\n|---|---|---|---|");
        for (form, [casts, misses, different]) in Form::ALL.iter().zip(all.by_form) {
            println!("| {} | {casts} | {misses} | {different} |", form.name());
        }
        all.faults.iter().for_each(|fault| println!("{fault}"));
        Ok(all)
    }

    /// What is known by now.
    fn write(
        &self,
        total: &Tally,
        by_mesh: &[(&Closed, Tally)],
        others: &[Other],
        batches: &Batches,
    ) -> Result<(), String> {
        let Some(path) = &self.json else { return Ok(()) };
        let meshes =
            by_mesh.iter().map(|(closed, tally)| json!([closed.name, closed.mesh.len(), tally.casts, tally.misses]));
        let document = json!({
            "seed": self.plan.seed, "brute": self.plan.brute, "total": total,
            "specs": self.plan.specs.iter().map(Spec::to_string).collect::<Vec<_>>(),
            "aims": Aim::ALL.map(Aim::name),
            "levels": Level::available().iter().map(|level| level.name()).collect::<Vec<_>>(),
            "meshes": meshes.collect::<Vec<_>>(), "others": others, "batches": batches,
            "forms": Form::ALL.map(Form::name),
        });
        std::fs::write(path, document.to_string()).map_err(|e| format!("{}: {e}", path.display()))
    }

    fn meshes(&self) -> Result<Vec<Closed>, String> {
        let mut meshes = closed_meshes(if self.plan.brute { Detail::Coarse } else { Detail::Fine });
        let Some(folder) = &self.scenes else { return Ok(meshes) };
        let entries = catalog::indexed(folder).map_err(|e| e.to_string())?;
        for entry in entries.iter().filter(|entry| entry.triangles <= MOST_TRIANGLES) {
            let scene = entry.load(0).map_err(|e| format!("{}: {e}", entry.id))?;
            let flat = scene.flatten().map_err(|e| format!("{}: {e}", entry.id))?;
            match closed_model(&entry.id, &flat.mesh) {
                Some(closed) => meshes.push(closed),
                None => eprintln!("{}: it is not closed, and left out", entry.id),
            }
        }
        Ok(meshes)
    }

    fn print(&self, total: &Tally, by_mesh: &[(&Closed, Tally)]) {
        println!("| structure |{} missed | different |", Aim::ALL.map(|aim| format!(" {} |", aim.name())).concat());
        println!("|---|{}---|---|", "---|".repeat(Aim::ALL.len()));
        for (spec, cells) in self.plan.specs.iter().zip(&total.by_structure) {
            let casts: String = cells.iter().map(|[casts, ..]| format!(" {casts} |")).collect();
            let sum = |which: usize| cells.iter().map(|cell| cell[which]).sum::<u64>();
            println!("| `{spec}` |{casts} {} | {} |", sum(1), sum(2));
        }
        println!("\n| mesh | triangles | rays | casts | missed | different |\n|---|---|---|---|---|---|");
        for (Closed { name, mesh, .. }, tally) in by_mesh {
            let Tally { rays, casts, misses, different, .. } = tally;
            println!("| {name} | {} | {rays} | {casts} | {misses} | {different} |", mesh.len());
        }
        for (level, casts) in Level::available().iter().zip(&total.by_level) {
            println!("\n{}: {casts} casts", level.name());
        }
        total.faults.iter().for_each(|fault| println!("{fault}"));
        let Tally { rays, casts, misses, different, .. } = total;
        println!("\n{rays} rays, {casts} casts, seed {}: {misses} missed, {different} different", self.plan.seed);
    }

    fn others(&self, meshes: &[Closed]) -> Result<Vec<Other>, String> {
        match &self.engines {
            Some(folder) => others(meshes, folder, self.engine_rays, self.plan.seed),
            None => Ok(Vec::new()),
        }
    }
}

fn print_others(others: &[Other]) {
    if !others.is_empty() {
        println!("\n| engine | mesh | aim | rays | missed |\n|---|---|---|---|---|");
    }
    for Other { engine, mesh, aim, rays, missed } in others {
        println!("| {engine} | {mesh} | {aim} | {rays} | {missed} |");
    }
}

/// `1000000`, or `1e6`.
fn number(text: &str) -> Result<u64, String> {
    let parsed = text.parse().ok().or_else(|| {
        let x: f64 = text.parse().ok()?;
        ((0.0..1e18).contains(&x) && x.fract() == 0.0).then_some(x as u64)
    });
    parsed.ok_or(format!("'{text}' is no whole number"))
}
