//! Sparse rows, made on all threads to the same bits for every number of them.

use crate::parallel;

/// Rows that one thread takes at a time.
const CHUNK: usize = 4096;

/// Rows one after the other: where each begins (one more than rows), and the column and the value of each entry.
pub type Rows = (Vec<usize>, Vec<u32>, Vec<f64>);

/// The rows that `row` appends, as columns and values, to what it is given; with scratch of its thread's.
pub fn gather<S>(
    rows: usize,
    scratch: impl Fn() -> S + Sync,
    row: impl Fn(usize, &mut S, &mut Vec<u32>, &mut Vec<f64>) + Sync,
) -> Rows {
    let parts = parallel::chunks(rows, CHUNK, |range| {
        let mut scratch = scratch();
        let (mut ends, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for i in range {
            row(i, &mut scratch, &mut columns, &mut values);
            ends.push(columns.len());
        }
        (ends, columns, values)
    });
    let mut offsets = Vec::with_capacity(rows + 1);
    let mut entries = 0;
    offsets.push(0);
    for (ends, columns, _) in &parts {
        offsets.extend(ends.iter().map(|end| entries + end));
        entries += columns.len();
    }
    (offsets, joined(parts.iter().map(|part| &part.1[..])), joined(parts.iter().map(|part| &part.2[..])))
}

/// The parts one after the other. They are copied on all threads: one alone takes as long as all else of a matrix of a million rows.
fn joined<'a, T: Copy + Default + Send + Sync + 'a>(parts: impl Iterator<Item = &'a [T]> + Clone) -> Vec<T> {
    let mut whole = vec![T::default(); parts.clone().map(<[T]>::len).sum()];
    let mut rest = &mut whole[..];
    let mut places = Vec::new();
    for part in parts {
        places.push((rest.split_off_mut(..part.len()).unwrap_or_default(), part));
    }
    parallel::each(places, |_, (place, part)| place.copy_from_slice(part));
    whole
}

/// Where each stands in a list of some numbers below `count`; `count` as a number where it does not.
pub fn places(order: &[u32], count: usize) -> Vec<u32> {
    let mut place = vec![count as u32; count];
    for (row, &i) in order.iter().enumerate() {
        place[i as usize] = row as u32;
    }
    place
}
