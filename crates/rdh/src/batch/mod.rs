//! Many rays at once: shared among the threads of rayon's current pool. Answers are those of single rays, in any case.

mod rows;

use rayon::prelude::*;

use crate::geom::Ray;

/// Rays that a thread takes at a time, at most, …
const LARGEST: usize = 1 << 16;
/// … and at least: fewer would not be worth waking it, …
const SMALLEST: usize = 1 << 10;
/// … or this many where there are as many for each thread: rays without order are then given one.
const ENOUGH: usize = 1 << 12;
/// Whole tiles.
const UNIT: usize = 64;
/// Rows that a thread needs to make tiles of them.
const ROWS: usize = 8;

/// Fewer rays are not worth looking at: they go one by one.
const FEW: usize = UNIT;

/// Has few rays answered one by one by `alone`, others by `cast`, which gets some of them, where their answers go, and how many rays a row has if they are whole
/// rows of a picture.
///
/// # Panics
/// If there are not as many answers as rays.
pub(crate) fn cast<A: Send>(
    rays: &[Ray],
    answers: &mut [A],
    alone: impl Fn(&Ray) -> A,
    cast: impl Fn(&[Ray], &mut [A], Option<usize>) + Sync,
) {
    if rays.len() < FEW {
        same_number(rays, answers);
        rays.iter().zip(answers).for_each(|(ray, answer)| *answer = alone(ray));
        return;
    }
    let rows = rows::find(rays);
    let (width, lead) = rows.map_or((None, 0), |rows| (Some(rows.width), rows.lead));
    share(rays, answers, (width, lead), cast);
}

/// The same for rows of a known width.
///
/// # Panics
/// If there are not as many answers as rays, or `width` is 0.
pub(crate) fn cast_rows<A: Send>(
    rays: &[Ray],
    answers: &mut [A],
    width: usize,
    cast: impl Fn(&[Ray], &mut [A], Option<usize>) + Sync,
) {
    assert!(width > 0, "a row has rays");
    share(rays, answers, (Some(width.min(rays.len().max(1))), 0), cast);
}

fn share<A: Send>(
    rays: &[Ray],
    answers: &mut [A],
    (width, lead): (Option<usize>, usize),
    cast: impl Fn(&[Ray], &mut [A], Option<usize>) + Sync,
) {
    same_number(rays, answers);
    let threads = rayon::current_num_threads();
    // Some more than threads, so that none waits long for the last.
    let parts = if threads == 1 { 1 } else { 4 * threads };
    let smallest = (rays.len() / threads).clamp(SMALLEST, ENOUGH);
    let share = (rays.len() / parts).clamp(smallest, LARGEST);
    let part = share.next_multiple_of(width.map_or(UNIT, |width| ROWS * width));
    let (first, rest) = rays.split_at(lead);
    let (first_answers, rest_answers) = answers.split_at_mut(lead);
    cast(first, first_answers, None);
    if threads == 1 || rest.len() <= part {
        rest.chunks(part).zip(rest_answers.chunks_mut(part)).for_each(|(rays, answers)| cast(rays, answers, width));
    } else {
        let parts = rest.par_chunks(part).zip(rest_answers.par_chunks_mut(part));
        parts.for_each(|(rays, answers)| cast(rays, answers, width));
    }
}

fn same_number<A>(rays: &[Ray], answers: &[A]) {
    assert_eq!(rays.len(), answers.len(), "there are to be as many answers as rays");
}
