//! Hours of sunlight on the walls of a town: `cargo run --release -p rdh-scene --example sunlight`.

use rdh::tune::confirm;
use rdh::{GeomId, Hit, InstId, Mesh, Query, Ray, RayClass, Recorder, Spec, Training, TriId, TuneOptions, build, tune};
use rdh_scene::catalog;

/// The sun's declination in degrees, from winter to summer.
const DAYS: [f64; 6] = [-23.4, -16.0, -5.0, 6.0, 16.5, 23.4];

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = catalog::find("quarter", &[])?.load(0)?;
    let mesh = scene.flatten()?.mesh;
    let options = TuneOptions::default();

    // The rays are known beforehand, so a few walls stand for all: no need to cast everything once to learn.
    let first = build(&mesh, &"bvh8+sah".parse()?, &Training::none(), &options.build)?;
    let recorder = Recorder::new(65_536, 1);
    for ray in walls(&mesh).step_by(40).flat_map(|wall| towards_the_sun(&mesh, wall)) {
        recorder.record(&ray, first.closest(&ray), Query::Occluded, RayClass::Shadow);
    }
    let (training, held_out, unseen) = recorder.into_profile().split(1);
    let candidates = Spec::list("bvh8+sah,bvh8(high)+sah,bvh8+rdh,bvh8(high)+rdh")?;
    let tuned = tune(&mesh, &candidates, &training, &held_out, &options, None)?;
    println!("{}", tuned.evidence.reason);
    if let Some(found) = confirm(&tuned, &unseen, &options, None)? {
        println!("on {} unseen rays: {:.3} of the cost", found.rays, found.counts.ratio);
        assert!(!found.is_slower(options.risk));
    }

    let (mut lit, mut asked) = (0, 0);
    for ray in walls(&mesh).flat_map(|wall| towards_the_sun(&mesh, wall)) {
        lit += usize::from(!tuned.accel.occluded(&ray));
        asked += 1;
    }
    println!("{asked} rays: the sun shines on the walls {:.1} % of the time", 100.0 * lit as f64 / asked as f64);
    Ok(())
}

/// Triangles that stand upright; z is up.
fn walls(mesh: &Mesh) -> impl Iterator<Item = TriId> {
    (0..mesh.len() as u32).map(TriId).filter(|id| mesh.normal(*id).is_some_and(|n| n[2].abs() < 0.1))
}

/// From the middle of a wall, while the sun is up and before it: every half hour of some days, at 48° north.
fn towards_the_sun(mesh: &Mesh, wall: TriId) -> impl Iterator<Item = Ray> {
    let middle = Hit { t: 0.0, u: 1.0 / 3.0, v: 1.0 / 3.0, tri: wall, geometry: GeomId(0), instance: InstId(0) };
    let normal = mesh.normal(wall).unwrap_or_default();
    let times = DAYS.into_iter().flat_map(|day| (0..48).map(move |half| (day, f64::from(half) * 7.5 - 180.0)));
    times.map(|(day, hour)| sun(day, hour)).filter_map(move |sun| {
        let before = (0..3).map(|a| sun[a] * normal[a]).sum::<f32>() > 0.0;
        (sun[2] > 0.0 && before).then(|| mesh.spawn(&middle, sun))
    })
}

/// Where the sun stands by its declination and hour angle in degrees: x is east, y is north.
fn sun(declination: f64, hour: f64) -> [f32; 3] {
    let [(sd, cd), (sh, ch), (sl, cl)] = [declination, hour, 48.0].map(|degrees: f64| degrees.to_radians().sin_cos());
    [-cd * sh, cl * sd - sl * cd * ch, sl * sd + cl * cd * ch].map(|x| x as f32)
}
