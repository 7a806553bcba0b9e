//! From a spec to a structure.

use crate::accel::{self, Accel};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::rays::Training;
use crate::spec::Spec;
use crate::tune;

/// Builds what `spec` names, from `rays` where its heuristic asks for them. For `auto` it chooses by the rays, with counts alone
/// ([`tune::auto`]); [`Stats::spec`](crate::Stats::spec) says what.
///
/// # Errors
/// A heuristic that needs rays, or `auto`, without any; a budget that can't be kept, lack of memory, or cancellation.
pub fn build(mesh: &Mesh, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Accel> {
    if *spec != Spec::AUTO {
        return accel::build(mesh, spec, rays, options);
    }
    if rays.is_empty() {
        return Err(Error::NoRays { spec: spec.to_string() });
    }
    Ok(tune::auto(mesh, rays, options)?.accel)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicI64, Ordering};

    use super::*;
    use crate::error::Error;
    use crate::mem::failing::{taken, with_grants};
    use crate::naive;
    use crate::rays::{Query, RayClass, RaySample};
    use crate::simd::Level;
    use crate::soup::{numbers, soup};
    use crate::{Ray, TriId};

    /// One of each way to build.
    const FAMILIES: [&str; 16] = [
        "kd+sah",
        "kd(leaf=1,split=exact)+sah",
        "kd+rdh",
        "kd(prune=visits)+rdh(paper)",
        "bvh2+sah",
        "bvh4(quick)+sah",
        "bvh8+sah",
        "bvh8(high)+sah",
        "bvh8(split=sweep)+sah",
        "sbvh8+sah",
        "bvh8(from=kd)+sah",
        "bvh8(compact)+sah",
        "bvh8+rdh",
        "bvh2+rdh(prior=0)",
        "sbvh8(high)+rdh(rays=whole)",
        "bvh4(high,from=kd)+rdh",
    ];

    fn rays(mesh: &Mesh, n: u32) -> Vec<Ray> {
        let mut x = numbers(n + 1);
        let aim = |i: u32| {
            let (from, at) = ([x(), x(), x()], mesh.corners(TriId(i % mesh.len() as u32))[i as usize % 3]);
            Ray::new(from, [0, 1, 2].map(|a| at[a] - from[a]))
        };
        (0..n).map(aim).collect()
    }

    fn training(mesh: &Mesh, n: u32) -> Training {
        let sample = |(i, ray): (usize, Ray)| {
            let query = if i.is_multiple_of(3) { Query::Occluded } else { Query::Closest };
            RaySample::new(ray, naive::closest(mesh, &ray), query, RayClass::Other)
        };
        Training::from_samples(rays(mesh, n).into_iter().enumerate().map(sample).collect())
    }

    /// Some numbers up to a limit: the first ones, the last one, and ever fewer between.
    fn some_below(limit: i64) -> impl Iterator<Item = i64> {
        let next = |k: &i64| Some(k + 1 + k / 6);
        std::iter::successors(Some(0), next).take_while(move |&k| k < limit - 1).chain([limit - 1])
    }

    /// Wherever memory is refused first, the build is an error and holds nothing; on two threads, too.
    #[test]
    fn refused_memory_is_an_error_and_leaks_nothing() {
        let mesh = soup(1500, 0.3);
        let rays = training(&mesh, 60);
        for text in FAMILIES {
            let spec: Spec = text.parse().expect(text);
            let with = |grants, threads| {
                let options = BuildOptions { threads: (threads == 1).then_some(1), ..BuildOptions::default() };
                with_grants(grants, threads, || build(&mesh, &spec, &rays, &options).map(|accel| accel.fingerprint()))
            };
            let (whole, requests) = with(i64::MAX / 2, 1);
            assert!(whole.is_ok() && requests > 5, "{text}: {whole:?} after {requests} requests");
            for grants in some_below(requests) {
                let before = taken();
                let (built, _) = with(grants, 1);
                assert!(matches!(built, Err(Error::OutOfMemory { .. })), "{text}, {grants} of {requests}: {built:?}");
                drop(built);
                assert_eq!(taken(), before, "{text}, {grants} of {requests}: bytes that were not given back");
            }
            for grants in some_below(requests).step_by(6) {
                let (built, _) = with(grants, 2);
                let right = matches!(built, Err(Error::OutOfMemory { .. })) || built == whole;
                assert!(right, "{text}, {grants} of {requests}, two threads: {built:?}");
            }
        }
    }

    /// Wherever a build is told to stop, it does, with one error, and holds nothing.
    #[test]
    fn cancelled_builds_are_one_error_and_leak_nothing() {
        let mesh = soup(4000, 0.3);
        let rays = training(&mesh, 60);
        for text in FAMILIES {
            let spec: Spec = text.parse().expect(text);
            let with = |limit: i64| {
                let asked = AtomicI64::new(0);
                let cancel = || asked.fetch_add(1, Ordering::Relaxed) >= limit;
                let options = BuildOptions { threads: Some(1), cancel: Some(&cancel), ..BuildOptions::default() };
                (build(&mesh, &spec, &rays, &options).err(), asked.load(Ordering::Relaxed))
            };
            let (error, questions) = with(i64::MAX);
            assert!(error.is_none() && questions > 2, "{text}: {error:?} after {questions}");
            for limit in some_below(questions) {
                let before = taken();
                let (error, asked) = with(limit);
                assert_eq!(error, Some(Error::Cancelled), "{text}, {limit} of {questions}");
                assert!(asked <= limit + 8, "{text}: asked {asked} times, cancelled at {limit}");
                assert_eq!(taken(), before, "{text}, {limit} of {questions}: bytes that were not given back");
            }
        }
    }

    /// Small enough for interpreters of the language, which look for undefined behaviour.
    #[test]
    fn small_trees_of_every_kind_answer_as_brute_force() {
        let mesh = soup(40, 0.3);
        let (training, rays, mut hits) = (training(&mesh, 8), rays(&mesh, 12), Vec::new());
        for text in FAMILIES {
            let spec: Spec = text.parse().expect(text);
            let options = BuildOptions { threads: Some(1), level: Some(Level::PORTABLE), ..BuildOptions::default() };
            let built = build(&mesh, &spec, &training, &options).expect(text);
            let read = Accel::from_bytes(&built.to_bytes().expect(text)).expect(text).with_level(Level::PORTABLE);
            for (accel, ray) in [&built, &read].into_iter().flat_map(|accel| rays.iter().map(move |ray| (accel, ray))) {
                assert_eq!(accel.closest(ray), naive::closest(&mesh, ray), "{text}");
                assert_eq!(accel.occluded(ray), naive::occluded(&mesh, ray), "{text}");
                accel.all_hits(ray, &mut hits);
                assert_eq!(hits, naive::all_hits(&mesh, ray), "{text}");
            }
        }
    }
}
