//! New memory of the host for large results.
//!
//! The first write to a page waits until the system has cleared it. Where copies are the first, threads come to new pages at random, and several to a
//! huge one: 682 MB took 67 to 75 ms, with huge pages 98 to 118 (16 cores). Here each thread has huge pages of its own first: 15 to 20 ms, after which
//! the copy takes 16 to 22; and they are given back in 2 ms instead of 40.

use crate::buffer::LARGE;
use laguerre_core::{FacetArrays, Request};
use rayon::prelude::*;
use std::mem::MaybeUninit;
use std::slice;

/// Bytes of a page, and of a huge one. (Where pages are larger, `madvise` refuses, and nothing is lost but time.)
const PAGE: usize = 4 << 10;
const HUGE: usize = 2 << 20;

/// Bytes from which on pages are to be huge: NumPy's.
const WORTH_HUGE: usize = 2 * HUGE;

/// Room for so many, whose pages are there if it is large. Large room is gone through by the threads of a pool (`LARGE`).
pub(crate) fn room<T>(length: usize) -> Vec<T> {
    let mut data: Vec<T> = Vec::with_capacity(length);
    let bytes = length * size_of::<T>();
    if bytes >= LARGE {
        // SAFETY: these bytes are the vector's, and hold no value yet.
        let bytes = unsafe { slice::from_raw_parts_mut(data.as_mut_ptr().cast::<MaybeUninit<u8>>(), bytes) };
        if bytes.len() >= WORTH_HUGE {
            ask_for_huge_pages(bytes);
        }
        let before = bytes.as_ptr().align_offset(HUGE).min(bytes.len());
        let (first, rest) = bytes.split_at_mut(before);
        touch(first);
        rest.par_chunks_mut(HUGE).for_each(touch);
    }
    data
}

/// Gives room that is not for so many back: where it is too small, or so large that it would be a waste to keep it.
pub(crate) fn keep_fitting<T>(data: &mut Vec<T>, length: usize) {
    if data.capacity() < length || data.capacity() > length + length / 8 {
        *data = Vec::new();
    }
}

/// (The system may have none: pages are small then.)
#[cfg(target_os = "linux")]
fn ask_for_huge_pages(bytes: &mut [MaybeUninit<u8>]) {
    let before = bytes.as_ptr().align_offset(PAGE);
    if let Some(pages @ [_, ..]) = bytes.get_mut(before..) {
        // SAFETY: the pages are the caller's (of the last another may have a part), and this changes how they are kept, not what they hold.
        unsafe { libc::madvise(pages.as_mut_ptr().cast(), pages.len(), libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn ask_for_huge_pages(_bytes: &mut [MaybeUninit<u8>]) {}

/// Writes to each page.
fn touch(bytes: &mut [MaybeUninit<u8>]) {
    for page in bytes.chunks_mut(PAGE) {
        page[0].write(0);
    }
}

/// How long the lists of an output are: a guess, from those of the last one of as many sites.
#[derive(Clone, Copy, Default)]
pub(crate) struct Lengths {
    sites: usize,
    /// Facets, and entries of the Laplacian; 0 where there were none.
    pub(crate) facets: usize,
    pub(crate) entries: usize,
}

impl Lengths {
    /// Those of so many sites, none where these are others than the last ones.
    pub(crate) fn of(&mut self, sites: usize) -> &mut Self {
        if self.sites != sites {
            *self = Self { sites, ..Self::default() };
        }
        self
    }
}

/// Memory for these lists, made while devices compute.
#[derive(Default)]
pub(crate) struct Ahead {
    pub(crate) facets: FacetArrays,
    pub(crate) columns: Vec<u32>,
    pub(crate) values: Vec<f64>,
}

impl Ahead {
    /// For what a request asks for, of so many sites.
    pub(crate) fn new(mut last: Lengths, request: &Request, sites: usize) -> Self {
        last.of(sites);
        let some_more = |count: usize| count + count / 64;
        let facets = if request.facets() { some_more(last.facets) } else { 0 };
        let is_read = request.laplacian() && !request.keeps_laplacian();
        let entries = if is_read { some_more(last.entries) } else { 0 };
        let mut arrays = FacetArrays::default();
        arrays.neighbor = room(facets);
        arrays.area = room(facets);
        arrays.barycenter = room(facets);
        arrays.distance = room(facets);
        arrays.second_moment = request.facet_second_moments().then(|| room(facets));
        Self { facets: arrays, columns: room(entries), values: room(entries) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Room of any size can be filled to its end.
    #[test]
    fn room_is_as_large_as_was_asked_for() {
        for length in [0, 1, 1000, LARGE / 24, LARGE / 24 + 1, (3 * HUGE + 5) / 24] {
            let mut data: Vec<[f64; 3]> = room(length);
            assert!(data.is_empty() && data.capacity() >= length);
            let begin = data.as_ptr();
            data.resize(length, [1.0, 2.0, 3.0]);
            assert!(data.as_ptr() == begin && data.iter().all(|place| place[2] == 3.0));
        }
    }
}
