//! Record the rays that are really cast, and choose the structure for them: `cargo run --release -p rdh --example record_and_tune`.

use rdh::{BuildOptions, Mesh, Query, Ray, RayClass, Recorder, Spec, Training, TuneOptions, build, tune};

pub(crate) fn main() -> rdh::Result<()> {
    // A rough field of 200 x 200 squares.
    let points = (0..201 * 201).map(|i| [(i % 201) as f32, (i / 201) as f32, (i * 37 % 17) as f32 * 0.3]);
    let halves =
        (0..40_000).map(|i| i / 200 * 201 + i % 200).flat_map(|a| [[a, a + 1, a + 202], [a, a + 202, a + 201]]);
    let mesh = Mesh::new(points.collect(), halves.collect())?;

    // The application casts its rays through a first structure, which needs none, and records them.
    let first = build(&mesh, &"bvh8+sah".parse()?, &Training::none(), &BuildOptions::default())?;
    let recorder = Recorder::new(16_384, 1);
    for i in 0..20_000 {
        let ray = Ray::new([100.0, -20.0, 6.0], [(i % 200 - 100) as f32, 120.0, (i / 200) as f32 * -0.2]);
        recorder.record(&ray, first.closest(&ray), Query::Closest, RayClass::Primary);
    }

    // Candidates are built from half of them, and judged by a quarter; a clock instead of `None` makes it a matter of time.
    let (training, held_out, _unseen) = recorder.into_profile().split(1);
    let tuned = tune(&mesh, &Spec::candidates(), &training, &held_out, &TuneOptions::default(), None)?;
    println!("{}: {}", tuned.accel.stats().spec, tuned.evidence.reason);

    let ray = Ray::new([100.0, -20.0, 6.0], [3.0, 120.0, -5.0]);
    assert_eq!(tuned.accel.closest(&ray), first.closest(&ray));
    Ok(())
}
