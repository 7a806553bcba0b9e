//! What recording costs, a ray alone and beside the cast that it records: `cargo run --release -p rdh --example recording`.
//! A measurement, no test.

use std::hint::black_box;

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rdh::{Accel, BuildOptions, Hit, Mesh, Query, Ray, RayClass, Recorder, Training, build};

/// Few enough for the first cache: a ray that was just traced is there.
const RAYS: usize = 512;
const ROUNDS: u32 = 8192;

fn main() -> rdh::Result<()> {
    let mut random = Random(Pcg64Mcg::seed_from_u64(1));
    let rays: Vec<Ray> =
        (0..RAYS).map(|_| Ray::new([(); 3].map(|()| random.unit()), [(); 3].map(|()| random.unit()))).collect();
    for (what, recorder) in recorders() {
        let nanos: Vec<f64> = (0..ROUNDS).map(|round| record_round(&recorder, &rays, round)).collect();
        let (best, total) = (nanos.iter().copied().fold(f64::INFINITY, f64::min), nanos.iter().sum::<f64>());
        println!(
            "{what}: {:.2} ns a ray in the mean, {best:.2} in the best of {ROUNDS} rounds",
            total / nanos.len() as f64
        );
    }
    let mesh = field(300)?;
    for spec in ["bvh8+sah", "kd+sah"] {
        let accel = build(&mesh, &spec.parse()?, &Training::none(), &BuildOptions::default())?;
        for (what, recorder) in recorders() {
            // An application has cast many rays before: what is kept of the next ones is little by then.
            (0..ROUNDS).for_each(|round| _ = record_round(&recorder, &rays, round));
            beside_the_cast(&format!("{spec}, {what}"), &accel, &recorder, &mut random);
        }
    }
    Ok(())
}

fn recorders() -> [(&'static str, Recorder); 3] {
    [
        ("capacity 16384", Recorder::new(16_384, 1)),
        ("capacity 2^20", Recorder::new(1 << 20, 1)),
        ("one in 64", Recorder::new(1 << 20, 1).one_in(64)),
    ]
}

/// Records other rays each round, since repeats of the same ones would all be kept or all left out.
fn record_round(recorder: &Recorder, rays: &[Ray], round: u32) -> f64 {
    let fresh: Vec<Ray> = rays.iter().map(|ray| ray.masked(!round)).collect();
    let start = nanos();
    for ray in &fresh {
        recorder.record(ray, None, Query::Closest, RayClass::Other);
    }
    nanos().saturating_sub(start) as f64 / rays.len() as f64
}

/// The same fresh rays in each round, cast alone and cast and recorded, in turn; each begins as often as the other.
fn beside_the_cast(what: &str, accel: &Accel, recorder: &Recorder, random: &mut Random) {
    let (mut ratios, mut alone) = (Vec::new(), Vec::new());
    for round in 0..1500 {
        let rays: Vec<Ray> = (0..RAYS).map(|_| from_above(random)).collect();
        // Either way the whole hit is there for whoever wants it.
        let plain = || time(&rays, |ray| *black_box(&accel.closest(ray)));
        let recorded = || {
            time(&rays, |ray| {
                let hit = *black_box(&accel.closest(ray));
                recorder.record(ray, hit, Query::Closest, RayClass::Primary);
                hit
            })
        };
        // What comes first finds the caches cold: that one counts for nobody.
        plain();
        let [a, b] = if round % 2 == 0 { [plain(), recorded()] } else { [recorded(), plain()] };
        let [plain, recorded] = if round % 2 == 0 { [a, b] } else { [b, a] };
        ratios.push(recorded / plain);
        alone.push(plain);
    }
    println!("{what}: {:+.2} % of a closest hit of {:.0} ns", 100.0 * (median(ratios) - 1.0), median(alone));
}

/// Nanoseconds a ray.
fn time(rays: &[Ray], cast: impl Fn(&Ray) -> Option<Hit>) -> f64 {
    let start = nanos();
    black_box(rays.iter().filter_map(cast).map(|hit| hit.t).sum::<f32>());
    nanos().saturating_sub(start) as f64 / rays.len() as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A rough field of `n` x `n` squares.
fn field(n: u32) -> rdh::Result<Mesh> {
    let points =
        (0..(n + 1) * (n + 1)).map(|i| [(i % (n + 1)) as f32, (i / (n + 1)) as f32, (i * 37 % 17) as f32 * 0.1]);
    let corner = |i: u32| i / n * (n + 1) + i % n;
    let halves = (0..n * n).map(corner).flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    Mesh::new(points.collect(), halves.collect())
}

/// From a camera over the field to somewhere on it.
fn from_above(random: &mut Random) -> Ray {
    let eye = [150.0, -40.0, 60.0];
    let target = [300.0 * random.unit(), 300.0 * random.unit(), 0.0];
    Ray::new(eye, [0, 1, 2].map(|a| target[a] - eye[a]))
}

struct Random(Pcg64Mcg);

impl Random {
    fn unit(&mut self) -> f32 {
        (self.0.next_u64() >> 40) as f32 / (1 << 24) as f32 + 0.01
    }
}

/// This thread's CPU time; elsewhere the time that has passed.
#[cfg(target_os = "linux")]
fn nanos() -> u64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

#[cfg(not(target_os = "linux"))]
fn nanos() -> u64 {
    use std::sync::LazyLock;
    use std::time::Instant;

    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_nanos() as u64
}
