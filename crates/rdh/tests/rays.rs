//! Profiles: the same sample whatever the order and the threads, exact weights, sets without a common ray, and files
//! that are believed only after they are checked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Barrier;

use proptest::prelude::*;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rdh::{Error, GeomId, Hit, InstId, Profile, Query, Ray, RayClass, RaySample, Recorder, TriId};

/// A ray and what became of it, as an application would record it.
#[derive(Debug, Clone, Copy)]
struct Cast {
    ray: Ray,
    hit: Option<Hit>,
    query: Query,
    class: RayClass,
}

/// Bits of the ray, query and class: what makes a ray the same ray.
type Identity = ([u32; 9], Query, RayClass);

fn identity(s: &RaySample) -> Identity {
    (bytemuck::cast(s.ray), s.query, s.class)
}

fn hit(t: f32) -> Hit {
    Hit { t, u: 0.0, v: 0.0, tri: TriId(0), geometry: GeomId(0), instance: InstId(0) }
}

fn unit(rng: &mut Pcg64Mcg) -> f32 {
    (rng.next_u32() >> 8) as f32 / (1 << 24) as f32
}

fn below(rng: &mut Pcg64Mcg, n: usize) -> usize {
    (rng.next_u64() >> 8) as usize % n
}

/// Casts with repeats: each of `distinct` rays is there at least once. The hit depends on the ray alone.
fn casts(count: usize, distinct: usize, seed: u64) -> Vec<Cast> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut unique = |_| {
        let [a, b, c, d, e, f] = [(); 6].map(|()| unit(&mut rng));
        Cast {
            ray: Ray::new([a, b, c], [d - 0.5, e - 0.5, f - 1.5]),
            hit: (a < 0.7).then(|| hit(1.0 + b)),
            query: Query::ALL[below(&mut rng, 3)],
            class: RayClass::ALL[below(&mut rng, 8)],
        }
    };
    let unique: Vec<Cast> = (0..distinct).map(&mut unique).collect();
    (0..count).map(|i| unique[if i < distinct { i } else { below(&mut rng, distinct) }]).collect()
}

fn shuffled(casts: &[Cast], seed: u64) -> Vec<Cast> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut out = casts.to_vec();
    for i in (1..out.len()).rev() {
        out.swap(i, below(&mut rng, i + 1));
    }
    out
}

fn record_all(recorder: &Recorder, casts: &[Cast]) {
    casts.iter().for_each(|c| recorder.record(&c.ray, c.hit, c.query, c.class));
}

fn recorded(casts: &[Cast], capacity: usize, seed: u64) -> Profile {
    let recorder = Recorder::new(capacity, seed);
    record_all(&recorder, casts);
    recorder.into_profile()
}

fn sample(c: &Cast) -> RaySample {
    RaySample::new(c.ray, c.hit, c.query, c.class)
}

fn counts(casts: &[Cast]) -> BTreeMap<Identity, u32> {
    let mut counts = BTreeMap::new();
    for c in casts {
        *counts.entry(identity(&sample(c))).or_insert(0) += 1;
    }
    counts
}

#[test]
fn neither_order_nor_threads_matter() {
    let casts = casts(200_000, 60_000, 1);
    for capacity in [1, 100, 4096, 59_999, 60_000, 60_001, 1 << 20] {
        let expected = recorded(&casts, capacity, 5);
        assert_eq!(expected.len(), capacity.min(60_000));
        assert_eq!(expected, recorded(&shuffled(&casts, 9), capacity, 5));
        let recorder = Recorder::new(capacity, 5);
        std::thread::scope(|scope| {
            for part in casts.chunks(casts.len() / 7 + 1) {
                scope.spawn(|| record_all(&recorder, part));
            }
        });
        assert_eq!(expected, recorder.into_profile(), "capacity {capacity}");
    }
}

#[test]
fn more_threads_than_slots_lose_no_ray() {
    let casts = casts(64_000, 500, 2);
    let recorder = Recorder::new(1000, 1);
    let barrier = Barrier::new(160);
    std::thread::scope(|scope| {
        for part in casts.chunks(400) {
            let (recorder, barrier) = (&recorder, &barrier);
            scope.spawn(move || {
                record_all(recorder, &part[..1]);
                barrier.wait();
                record_all(recorder, &part[1..]);
            });
        }
    });
    assert_eq!(recorder.into_profile(), recorded(&casts, 1000, 1));
}

#[test]
fn weights_are_exact() {
    let casts = casts(300_000, 5000, 3);
    let counts = counts(&casts);
    for capacity in [10, 1000, 5000] {
        let profile = recorded(&casts, capacity, 11);
        assert!(profile.samples().iter().all(|s| counts[&identity(s)] == s.weight));
        assert_eq!(profile.seen(), 300_000);
    }
    let all: u64 = recorded(&casts, 5000, 11).samples().iter().map(|s| u64::from(s.weight)).sum();
    assert_eq!(all, 300_000);
}

#[test]
fn other_seeds_take_other_rays_and_each_is_as_likely() {
    let casts = casts(20_000, 20_000, 4);
    let first = recorded(&casts, 5000, 1);
    let of_first: BTreeSet<Identity> = first.samples().iter().map(identity).collect();
    let second = recorded(&casts, 5000, 2);
    let common = second.samples().iter().filter(|s| of_first.contains(&identity(s))).count();
    // A quarter of 5000, with a standard deviation of 27.
    assert!((1090..1410).contains(&common), "{common}");
    let in_lower_half = first.samples().iter().filter(|s| s.ray.origin[0] < 0.5).count();
    assert!((2300..2700).contains(&in_lower_half), "{in_lower_half}");
}

#[test]
fn one_in_64_is_a_prefix_of_the_whole() {
    let casts = casts(100_000, 100_000, 5);
    let recorder = Recorder::new(1 << 20, 3).one_in(64);
    record_all(&recorder, &casts);
    let thin = recorder.into_profile();
    let whole = recorded(&casts, 1 << 20, 3);
    assert_eq!(thin.samples(), &whole.samples()[..thin.len()]);
    assert_eq!((thin.seen(), whole.rate()), (100_000, 1.0));
    assert!((thin.rate() * 64.0 - 1.0).abs() < 1e-9);
    // 1562 are expected, with a standard deviation of 39.
    assert!((1360..1760).contains(&thin.len()), "{}", thin.len());
}

#[test]
fn merging_is_recording_in_one_go() {
    let casts = casts(50_000, 20_000, 6);
    for capacity in [100, 5000, 50_000] {
        let whole = recorded(&casts, capacity, 7);
        let parts = || casts.chunks(7001).map(|part| recorded(part, capacity, 7));
        assert_eq!(Profile::merge(parts()).unwrap(), whole);
        let halfway = Profile::merge(parts().take(3)).unwrap();
        assert_eq!(Profile::merge(parts().skip(3).chain([halfway])).unwrap(), whole);
        assert_eq!(Profile::merge(parts()).unwrap().thin(50), recorded(&casts, 50, 7));
    }
}

#[test]
fn a_merge_is_as_thin_as_its_thinnest_part() {
    let (many, few) = (casts(40_000, 40_000, 8), casts(1000, 1000, 9));
    let merged = Profile::merge([recorded(&many, 4000, 1), recorded(&few, 4000, 1)]).unwrap();
    let of_few = counts(&few);
    let kept = merged.samples().iter().filter(|s| of_few.contains_key(&identity(s))).count();
    // A tenth, as of the many; not all of them.
    assert!((50..150).contains(&kept), "{kept}");
}

#[test]
fn profiles_of_different_seeds_do_not_merge() {
    let casts = casts(10, 10, 10);
    let error = Profile::merge([recorded(&casts, 5, 1), recorded(&casts, 5, 1), recorded(&casts, 5, 2)]).unwrap_err();
    assert_eq!(error, Error::SeedMismatch { profile: 2, seed: 2, expected: 1 });
    assert_eq!(Profile::merge([]).unwrap(), Profile::default());
}

#[test]
fn the_split_covers_all_and_shares_nothing() {
    // The same rays under several queries and classes: each must be in one set only.
    let mut all = casts(20_000, 20_000, 12);
    let again: Vec<_> = all.iter().map(|c| Cast { query: Query::Occluded, class: RayClass::Other, ..*c }).collect();
    all.extend(again);
    let profile = recorded(&all, 40_000, 1);
    let (training, held_out, unseen) = profile.clone().split(99);
    let sets = [training.samples(), held_out.samples(), unseen.samples()];
    let rays: Vec<BTreeSet<[u32; 9]>> =
        sets.iter().map(|set| set.iter().map(|s| bytemuck::cast(s.ray)).collect()).collect();
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        assert!(rays[a].is_disjoint(&rays[b]));
    }
    assert_eq!(rays.iter().map(BTreeSet::len).sum::<usize>(), 20_000);
    assert_eq!(sets.iter().map(|set| set.len()).sum::<usize>(), profile.len());
    for (set, share) in rays.iter().zip([0.5, 0.25, 0.25]) {
        // Five standard deviations.
        assert!((set.len() as f64 - 20_000.0 * share).abs() < 350.0, "{} of 20000, {share} expected", set.len());
    }
    // Each set is in the profile's order, and the split does not depend on what else is in the profile.
    let mut order = profile.samples().iter();
    assert!(training.samples().iter().all(|s| order.any(|o| o == s)));
    let (small, ..) = profile.clone().thin(1000).split(99);
    assert_eq!(small.samples(), &training.samples()[..small.len()]);
    assert_ne!(profile.split(100).0, training);
}

#[test]
fn classes_can_be_taken_apart() {
    let casts = casts(10_000, 10_000, 13);
    let profile = recorded(&casts, 2000, 1);
    let shadow = profile.clone().only(RayClass::Shadow);
    assert!(!shadow.is_empty() && shadow.samples().iter().all(|s| s.class == RayClass::Shadow));
    let seen = casts.iter().filter(|c| c.class == RayClass::Shadow).count() as u64;
    assert_eq!((shadow.seen(), profile.seen_of(RayClass::Shadow)), (seen, seen));
    let parts = RayClass::ALL.map(|class| profile.clone().only(class));
    assert_eq!(Profile::merge(parts).unwrap(), profile);
}

#[test]
fn the_summary_counts_rays_and_hits() {
    let recorder = Recorder::new(100, 1);
    let along = |z: f32| Ray::new([0.0, 0.0, z], [0.0, 0.0, 4.0]);
    for (z, t) in [(1.0, Some(2.0)), (1.0, Some(2.0)), (1.0, Some(2.0)), (3.0, None)] {
        recorder.record(&along(z), t.map(hit), Query::Closest, RayClass::Primary);
    }
    recorder.record(&Ray::new([5.0; 3], [-1e30, 0.0, 0.0]), None, Query::Occluded, RayClass::Shadow);
    let summary = recorder.into_profile().summary();
    let [primary, shadow] = &summary.groups[..] else { panic!("{summary:?}") };
    assert_eq!((primary.samples, primary.weight, primary.hit_share), (2, 4, 0.75));
    assert_eq!((primary.origins.min, primary.origins.max), ([0.0, 0.0, 1.0], [0.0, 0.0, 3.0]));
    assert_eq!((primary.direction_mean, shadow.direction_mean), ([0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]));
    assert_eq!((shadow.class, shadow.query, shadow.hit_share), (RayClass::Shadow, Query::Occluded, 0.0));
    assert_eq!((summary.origins.max, summary.seen), ([5.0; 3], 5));
}

#[test]
fn the_empty_profile_is_a_profile() {
    for profile in [Profile::default(), recorded(&[], 10, 1), recorded(&[], 0, 1), Profile::from_samples(vec![], 3)] {
        assert_eq!(Profile::from_bytes(&profile.to_bytes()).unwrap(), profile);
        assert!(profile.is_empty() && profile.summary().groups.is_empty());
        assert_eq!((profile.seen(), profile.invalid()), (0, 0));
        let (training, held_out, unseen) = profile.split(1);
        assert!(training.is_empty() && held_out.is_empty() && unseen.is_empty());
    }
}

#[test]
fn capacity_0_counts_only() {
    let profile = recorded(&casts(5000, 100, 1), 0, 1);
    assert_eq!((profile.len(), profile.seen(), profile.rate()), (0, 5000, 0.0));
    assert_eq!(Profile::from_bytes(&profile.to_bytes()).unwrap(), profile);
}

#[test]
fn equal_rays_become_one_sample_and_their_hits_the_nearest() {
    let ray = Ray::new([0.0; 3], [1.0, 0.0, 0.0]);
    let ends = [None, Some(3.0), Some(2.0), None, Some(5.0)];
    for first in 0..ends.len() {
        let recorder = Recorder::new(4, 1);
        for i in 0..100_000 {
            let end = ends[(i + first) % ends.len()];
            recorder.record(&ray, end.map(hit), Query::Closest, RayClass::Primary);
        }
        let profile = recorder.into_profile();
        let [sample] = profile.samples() else { panic!("{profile:?}") };
        assert_eq!((sample.weight, sample.t_hit), (100_000, Some(2.0)));
    }
}

#[test]
fn weights_stop_at_their_maximum() {
    let ray = Ray::new([0.0; 3], [1.0, 0.0, 0.0]);
    let heavy = RaySample { weight: u32::MAX - 1, ..RaySample::new(ray, None, Query::Closest, RayClass::Primary) };
    let profile = Profile::from_samples(vec![heavy, heavy, heavy], 1);
    assert_eq!((profile.len(), profile.samples()[0].weight), (1, u32::MAX));
    assert_eq!(profile.seen(), 3 * u64::from(u32::MAX - 1));
    assert_eq!(Profile::from_bytes(&profile.to_bytes()).unwrap(), profile);
}

/// Rays that no structure can answer.
fn bad_rays() -> Vec<Ray> {
    let good = Ray::new([0.0; 3], [1.0, 0.0, 0.0]);
    let mut bad = vec![Ray { direction: [0.0, -0.0, 0.0], ..good }, good.within(2.0, 1.0)];
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut origin, mut direction) = ([0.0; 3], [1.0; 3]);
            (origin[axis], direction[axis]) = (x, x);
            bad.extend([Ray::new(origin, [1.0; 3]), Ray::new([0.0; 3], direction)]);
        }
    }
    bad.extend([good.within(f32::NAN, 1.0), good.within(0.0, f32::NAN)]);
    bad
}

#[test]
fn invalid_rays_are_counted_and_not_kept() {
    let bad = bad_rays();
    for rate in [1, 1 << 40] {
        let recorder = Recorder::new(100, 1).one_in(rate);
        bad.iter().for_each(|r| recorder.record(r, None, Query::Closest, RayClass::Bounce));
        let profile = recorder.into_profile();
        let all = bad.len() as u64;
        assert_eq!((profile.len(), profile.invalid(), profile.seen()), (0, all, all));
    }
    // None of them can have hit anything; whoever says so gets none of them into the sample, whatever its hash.
    let recorder = Recorder::new(100, 1);
    bad.iter().for_each(|r| recorder.record(r, Some(hit(1.0)), Query::Closest, RayClass::Bounce));
    let profile = recorder.into_profile();
    assert_eq!((profile.len(), profile.invalid(), profile.seen()), (0, 0, bad.len() as u64));
    let samples = bad.iter().map(|&r| RaySample::new(r, Some(hit(1.0)), Query::Closest, RayClass::Bounce)).collect();
    let profile = Profile::from_samples(samples, 1);
    assert_eq!((profile.len(), profile.invalid(), profile.seen()), (0, 0, bad.len() as u64));
    let samples = bad.iter().map(|&r| RaySample::new(r, None, Query::Closest, RayClass::Bounce)).collect();
    let profile = Profile::from_samples(samples, 1);
    assert_eq!((profile.len(), profile.invalid()), (0, bad.len() as u64));
}

#[test]
fn a_hit_that_is_nowhere_is_a_miss() {
    let recorder = Recorder::new(100, 1);
    for (x, t) in [(0.0, f32::NAN), (1.0, f32::INFINITY), (2.0, f32::NEG_INFINITY)] {
        recorder.record(&Ray::new([x, 0.0, 0.0], [1.0; 3]), Some(hit(t)), Query::Closest, RayClass::Ao);
    }
    let profile = recorder.into_profile();
    assert_eq!((profile.len(), profile.invalid()), (3, 0));
    assert!(profile.samples().iter().all(|s| s.t_hit.is_none()));
}

fn format_error(data: &[u8]) -> (usize, String) {
    match Profile::from_bytes(data) {
        Err(Error::Format { offset, reason }) => (offset, reason),
        other => panic!("{other:?}"),
    }
}

/// The file with some bytes replaced and the checksum made right again, as an attacker would do it.
fn forged(data: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut out = data.to_vec();
    out[at..at + bytes.len()].copy_from_slice(bytes);
    let checksum = xxhash_rust::xxh3::xxh3_64(&out[24..]);
    out[16..24].copy_from_slice(&checksum.to_le_bytes());
    out
}

#[test]
fn files_are_read_as_they_were_written() {
    let profile =
        recorded(&casts(5000, 3000, 14), 700, 15).with_settings(r#"{"scene": "balls4", "größe": 7}"#).unwrap();
    let bytes = profile.to_bytes();
    let read = Profile::from_bytes(&bytes).unwrap();
    assert_eq!(read, profile);
    assert_eq!(read.to_bytes(), bytes);
    assert_eq!(bytes.len(), 320 + 48 * 700);
    let error = profile.with_settings("{\n\"a\": }").unwrap_err();
    assert!(matches!(error, Error::Format { offset: 7, .. }), "{error}");
}

#[test]
fn alterations_and_truncations_are_errors() {
    let bytes = recorded(&casts(500, 300, 16), 40, 17).with_settings(r#"{"scene": "tree8"}"#).unwrap().to_bytes();
    let mut rng = Pcg64Mcg::seed_from_u64(18);
    for _ in 0..10_000 {
        let mut data = bytes.clone();
        for _ in 0..1 + below(&mut rng, 4) {
            let at = below(&mut rng, data.len());
            data[at] ^= 1 + below(&mut rng, 255) as u8;
        }
        if below(&mut rng, 4) == 0 {
            data.truncate(below(&mut rng, bytes.len()));
        }
        // Two changes of one byte may cancel out.
        assert!(data == bytes || Profile::from_bytes(&data).is_err());
    }
    for length in 0..bytes.len() {
        let (offset, _) = format_error(&bytes[..length]);
        assert!(offset <= length);
    }
    assert!(Profile::from_bytes(&[&bytes[..], &[0]].concat()).is_err());
}

/// With the checksum put right, what is accepted must still be a profile in every respect.
#[test]
fn forged_files_are_errors_or_sound_profiles() {
    let bytes = recorded(&casts(500, 300, 19), 40, 20).to_bytes();
    let mut rng = Pcg64Mcg::seed_from_u64(21);
    let mut accepted = 0;
    for _ in 0..10_000 {
        let at = 24 + below(&mut rng, bytes.len() - 24);
        let data = forged(&bytes, at, &[below(&mut rng, 256) as u8]);
        if let Ok(profile) = Profile::from_bytes(&data) {
            accepted += 1;
            assert_eq!(profile.to_bytes(), data);
            assert!(profile.samples().iter().all(|s| s.weight > 0 && s.ray.is_valid()));
            assert!(profile.summary().groups.iter().all(|g| g.hit_share.is_finite()));
            assert!(profile.seen() >= profile.invalid());
            profile.split(1);
        }
    }
    assert!(accepted > 0, "hit distances can be altered unnoticed");
}

#[test]
fn errors_say_where_and_why() {
    let bytes = recorded(&casts(500, 300, 22), 40, 23).to_bytes();
    let first = bytes.len() - 40 * 48;
    let nan = f32::NAN.to_le_bytes();
    let huge = u64::MAX.to_le_bytes();
    for (data, offset, reason) in [
        (b"solid cube".to_vec(), 0, "not a .rays file"),
        (forged(&bytes, 0, b"X"), 0, "not a .rays file"),
        (forged(&bytes, 8, &[9]), 8, "version 9"),
        (forged(&bytes, 12, &[9]), 12, "layout 9"),
        (bytes[..100].to_vec(), 100, "within its header"),
        (bytes[..first + 5].to_vec(), first + 5, "should have"),
        (forged(&bytes, 24, &huge), bytes.len(), "should have"),
        (forged(&bytes, 32, &huge), 32, "don't make"),
        (forged(&bytes, 40, &huge), 32, "don't make"),
        (forged(&bytes, 56, &[0; 8]), 32, "capacity of 0"),
        (forged(&bytes, 48, &[0]), first, "hash"),
        (forged(&bytes, 64, &[0; 8]), first, "limit"),
        (forged(&bytes, 136, &huge), 72, "primary"),
        (forged(&bytes, 230, &[1]), 230, "padding"),
        (forged(&bytes, 256, b"}{"), 256, "JSON"),
        (forged(&bytes, 256, &[0xff, 0xff]), 256, "UTF-8"),
        (forged(&bytes, 260, &[1]), 260, "padding"),
        (forged(&bytes, first + 48 + 8, &nan), first + 48, "NaN"),
        (forged(&bytes, first + 40, &[0; 4]), first + 40, "weight of 0"),
        (forged(&bytes, first + 44, &[3]), first + 44, "no query 3"),
        (forged(&bytes, first + 45, &[8]), first + 45, "no class 8"),
        (forged(&bytes, first + 46, &[2]), first + 46, "whether there was a hit"),
        (forged(&bytes, first + 47, &[1]), first + 47, "padding"),
    ] {
        let (at, why) = format_error(&data);
        assert!(at == offset && why.contains(reason), "expected byte {offset}, '{reason}'; got byte {at}, '{why}'");
    }
    let swapped = [&bytes[first + 48..first + 96], &bytes[first..first + 48]].concat();
    let (at, why) = format_error(&forged(&bytes, first, &swapped));
    assert!(at == first + 48 && why.contains("order of their hashes"), "{at} {why}");
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_panic(data in proptest::collection::vec(any::<u8>(), 0..600)) {
        prop_assert!(Profile::from_bytes(&data).is_err());
    }

    /// Any bit patterns, in any order, in any grouping.
    #[test]
    fn any_rays_make_the_same_profile_in_any_grouping(
        words in proptest::collection::vec(any::<([u32; 9], u8, Option<u32>)>(), 0..60),
        capacity in 0usize..20,
        at in 0usize..60,
    ) {
        let cast = |(words, kind, end): ([u32; 9], u8, Option<u32>)| Cast {
            ray: bytemuck::cast(words),
            hit: end.map(|bits| hit(f32::from_bits(bits))),
            query: Query::ALL[kind as usize % 3],
            class: RayClass::ALL[kind as usize % 8],
        };
        let casts: Vec<Cast> = words.into_iter().map(cast).collect();
        let whole = recorded(&casts, capacity, 1);
        let (a, b) = casts.split_at(at.min(casts.len()));
        prop_assert_eq!(&Profile::merge([recorded(b, capacity, 1), recorded(a, capacity, 1)]).unwrap(), &whole);
        prop_assert_eq!(whole.seen(), casts.len() as u64);
        prop_assert_eq!(&Profile::from_bytes(&whole.to_bytes()).unwrap(), &whole);
        let listed = Profile::from_samples(casts.iter().map(sample).collect(), 1).thin(capacity);
        prop_assert_eq!(&listed, &whole);
    }
}
