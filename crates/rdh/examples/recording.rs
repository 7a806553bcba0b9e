//! What recording a ray costs: `cargo run --release -p rdh --example recording`. A measurement, no test.

use std::time::Instant;

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rdh::{Query, Ray, RayClass, Recorder};

/// Few enough for the first cache: a ray that was just traced is there.
const RAYS: usize = 512;
const ROUNDS: u32 = 8192;

fn main() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut unit = || (random.next_u64() >> 40) as f32 / (1 << 24) as f32 + 0.01;
    let rays: Vec<Ray> =
        (0..RAYS).map(|_| Ray::new([0.0; 3].map(|_: f32| unit()), [0.0; 3].map(|_: f32| unit()))).collect();
    for (what, recorder) in [
        ("capacity 16384", Recorder::new(16_384, 1)),
        ("capacity 2^20", Recorder::new(1 << 20, 1)),
        ("one in 64", Recorder::new(1 << 20, 1).one_in(64)),
    ] {
        let nanos: Vec<f64> = (0..ROUNDS).map(|round| record_round(&recorder, &rays, round)).collect();
        let (best, total) = (nanos.iter().copied().fold(f64::INFINITY, f64::min), nanos.iter().sum::<f64>());
        println!(
            "{what}: {:.2} ns a ray in the mean, {best:.2} in the best of {ROUNDS} rounds",
            total / nanos.len() as f64
        );
    }
}

/// Records other rays each round, since repeats of the same ones would all be kept or all left out.
fn record_round(recorder: &Recorder, rays: &[Ray], round: u32) -> f64 {
    let fresh: Vec<Ray> = rays.iter().map(|ray| ray.masked(!round)).collect();
    let start = Instant::now();
    for ray in &fresh {
        recorder.record(ray, None, Query::Closest, RayClass::Other);
    }
    start.elapsed().as_nanos() as f64 / rays.len() as f64
}
