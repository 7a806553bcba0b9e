//! What recording costs, a ray alone and beside the cast that it records: `cargo run --release -p rdh --example recording`.
//! A measurement, no test.

use std::hint::black_box;

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rdh::{Accel, BuildOptions, GeomId, Hit, InstId, Mesh, Query, Ray, RayClass, Recorder, Training, TriId, build};

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
        let recorders = recorders();
        // An application has cast many rays before: what is kept of the next ones is little by then.
        recorders
            .iter()
            .for_each(|(_, recorder)| (0..ROUNDS).for_each(|round| _ = record_round(recorder, &rays, round)));
        beside_the_cast(spec, &accel, &recorders, &mut random);
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
    let hit = Some(Hit { t: 1.0, u: 0.0, v: 0.0, tri: TriId(0), geometry: GeomId(0), instance: InstId(0) });
    let fresh: Vec<Ray> = rays.iter().map(|ray| ray.masked(!round)).collect();
    let start = nanos();
    for ray in &fresh {
        recorder.record(ray, black_box(hit), Query::Closest, RayClass::Other);
    }
    nanos().saturating_sub(start) as f64 / rays.len() as f64
}

/// Rays that are cast alone, twice, and cast and recorded, in turn. All of them are cast once only: what is cast again comes out
/// up to a tenth faster where the branches before it are the same again, since the processor has learnt its way by heart.
fn beside_the_cast(spec: &str, accel: &Accel, recorders: &[(&str, Recorder)], random: &mut Random) {
    let mut nanos = vec![Vec::new(); 2 + recorders.len()];
    for round in 0..ROUNDS as usize {
        for turn in 0..nanos.len() {
            let way = (turn + round) % nanos.len();
            let rays: Vec<Ray> = (0..RAYS).map(|_| from_above(random)).collect();
            // Either way the whole hit is there for whoever wants it.
            nanos[way].push(match way.checked_sub(2) {
                None => time(&rays, |ray| *black_box(&accel.closest(ray))),
                Some(i) => time(&rays, |ray| {
                    let hit = *black_box(&accel.closest(ray));
                    recorders[i].1.record(ray, hit, Query::Closest, RayClass::Primary);
                    hit
                }),
            });
        }
    }
    let medians: Vec<f64> = nanos.into_iter().map(median).collect();
    println!("{spec}: a closest hit of {:.0} ns", medians[0]);
    for (what, nanos) in ["not recorded, again"].into_iter().chain(recorders.iter().map(|r| r.0)).zip(&medians[1..]) {
        println!("  {what}: {:+.2} %", 100.0 * (nanos / medians[0] - 1.0));
    }
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
