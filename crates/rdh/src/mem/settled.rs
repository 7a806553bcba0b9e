//! Arrays that are finished: as large as needed, and on large pages where the system has them to give.

use std::mem::MaybeUninit;
use std::ops::Range;

use rayon::prelude::*;

use super::Plain;
use crate::error::Result;

/// Lists one after the other without spare room, for an array that will be read in no order: incoherent rays through large trees
/// are up to 7 % faster for large pages. Each element is changed as the number of its list says.
pub(crate) fn joined<T: Copy + Send + Sync, U: Send>(
    lists: &[&[T]],
    parallel: bool,
    what: &'static str,
    change: impl Fn(usize, T) -> U + Sync,
) -> Result<Vec<U>> {
    let len = lists.iter().map(|list| list.len()).sum();
    let mut joined: Vec<U> = room(len, what)?;
    let (mut pieces, mut rest) = (Vec::with_capacity(lists.len()), &mut joined.spare_capacity_mut()[..len]);
    for (i, list) in lists.iter().enumerate() {
        let (piece, after) = rest.split_at_mut(list.len());
        rest = after;
        pieces.push((i, *list, piece));
    }
    let copy = |(i, list, piece): (usize, &[T], &mut [MaybeUninit<U>])| {
        for (slot, &element) in piece.iter_mut().zip(list) {
            slot.write(change(i, element));
        }
    };
    if parallel {
        pieces.into_par_iter().for_each(copy)
    } else {
        pieces.into_iter().for_each(copy)
    }
    // SAFETY: the pieces are `len` slots together; each is as long as its list, and has been written.
    unsafe { joined.set_len(len) };
    Ok(joined)
}

/// What is made of the numbers below `n`, chunk by chunk, in their order: at most one element of each. Chunks of their own threads
/// write to where they would lie if each number made one, and close ranks afterwards.
pub(crate) fn made<T: Copy + Send, I: Iterator<Item = T>>(
    n: usize,
    chunk: usize,
    parallel: bool,
    what: &'static str,
    make: impl Fn(Range<usize>) -> I + Sync,
) -> Result<Vec<T>> {
    let mut all: Vec<T> = room(n, what)?;
    let fill = |(i, piece): (usize, &mut [MaybeUninit<T>])| {
        let numbers = i * chunk..i * chunk + piece.len();
        let slots = piece.iter_mut().zip(make(numbers));
        slots.map(|(slot, element)| slot.write(element)).count()
    };
    let slots = &mut all.spare_capacity_mut()[..n];
    let counts: Vec<usize> = if parallel {
        slots.par_chunks_mut(chunk).enumerate().map(fill).collect()
    } else {
        slots.chunks_mut(chunk).enumerate().map(fill).collect()
    };
    let mut len = 0;
    for (i, count) in counts.into_iter().enumerate() {
        if len != i * chunk {
            slots.copy_within(i * chunk..i * chunk + count, len);
        }
        len += count;
    }
    // SAFETY: the first `len` slots have been written: as many at the beginning of each chunk as it has made, moved together.
    unsafe { all.set_len(len) };
    Ok(all)
}

/// A copy without spare room, of whole elements that are given as bytes, wherever they lie.
pub(crate) fn settled_bytes<T: Plain>(bytes: &[u8], what: &'static str) -> Result<Vec<T>> {
    let len = bytes.len() / size_of::<T>();
    let mut copy: Vec<T> = room(len, what)?;
    // SAFETY: there is room for `len` elements, the bytes hold as many, and any bytes are plain data.
    unsafe {
        std::ptr::copy_nonoverlapping(bytes.as_ptr(), copy.as_mut_ptr().cast(), len * size_of::<T>());
        copy.set_len(len);
    }
    Ok(copy)
}

fn room<T>(len: usize, what: &'static str) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    if super::refused() {
        return Err(super::none::<T>(len, what));
    }
    vec.try_reserve_exact(len).map_err(|_| super::none::<T>(len, what))?;
    ask_for_large_pages(&mut vec);
    Ok(vec)
}

/// Smaller arrays stay as they are.
#[cfg(all(target_os = "linux", not(miri)))]
const LARGE_PAGE: usize = 2 << 20;

/// Asks before the first write, since what is written has its pages. Whether it is granted makes no difference but in time.
#[cfg(all(target_os = "linux", not(miri)))]
fn ask_for_large_pages<T>(vec: &mut Vec<T>) {
    let bytes = vec.capacity() * size_of::<T>();
    let start = vec.as_mut_ptr().cast::<u8>();
    // Whole large pages only: what else lies beside the array is none of our business.
    let skip = start.align_offset(LARGE_PAGE);
    if skip.saturating_add(LARGE_PAGE) > bytes {
        return;
    }
    let whole = (bytes - skip) / LARGE_PAGE * LARGE_PAGE;
    // SAFETY: the range lies within the vector's memory, none of which has been written yet: what it holds may be forgotten.
    unsafe {
        let range = start.add(skip).cast();
        // Memory that was used before has small pages already; it gives them back first.
        if rustix::mm::madvise(range, whole, rustix::mm::Advice::LinuxHugepage).is_ok() {
            rustix::mm::madvise(range, whole, rustix::mm::Advice::LinuxDontNeed).ok();
        }
    }
}

#[cfg(not(all(target_os = "linux", not(miri))))]
fn ask_for_large_pages<T>(_: &mut Vec<T>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_leaves_no_gap() {
        for n in [0, 1, 99, 100, 1000] {
            for (every, parallel) in [(1, true), (2, false), (3, true), (200, true), (10_000, false)] {
                let some = |range: Range<usize>| range.filter(move |i| i % every == 0);
                let all = made(n, 100, parallel, "numbers", some).unwrap();
                assert_eq!(all, (0..n).step_by(every).collect::<Vec<_>>(), "{n}, {every}");
            }
        }
    }

    #[test]
    fn copies_are_equal_and_without_spare_room() {
        // Interpreters of the language take a quarter of an hour for millions.
        let long = if cfg!(miri) { 30_000 } else { 3_000_000 };
        for len in [0, 1, 1000, long] {
            let vec: Vec<u32> = (0..len).collect();
            let (low, high) = vec.split_at(vec.len() / 3);
            let copy =
                joined(&[low, &[], high], len > 1, "numbers", |list, x| if list == 2 { x + 1 } else { x }).unwrap();
            let vec: Vec<u32> = low.iter().copied().chain(high.iter().map(|x| x + 1)).collect();
            assert_eq!((copy.len(), copy.capacity()), (vec.len(), vec.len()));
            assert!(copy == vec);
            assert!(settled_bytes::<u32>(bytemuck::cast_slice(&vec), "numbers").unwrap() == vec);
        }
    }
}
