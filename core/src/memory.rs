//! Memory whose size an input decides: where it is not to be had, that is an error in one line, not the end of the program.

use std::fmt;

use crate::{Error, Result};

/// An empty vector with room for `count` elements of what is called `what`.
///
/// # Errors
/// `Input` where there is not so much memory.
pub fn with_room<T>(count: usize, what: impl fmt::Display) -> Result<Vec<T>> {
    let mut elements: Vec<T> = Vec::new();
    match elements.try_reserve_exact(count) {
        Ok(()) if leaves_some(&elements) => Ok(elements),
        _ => Err(none_for(count as u64, size_of::<T>() as u64, &what)),
    }
}

/// What has to be left for all that asks without being able to go without it: words of messages, buffers of files, threads that begin.
const SPARE: usize = 4 << 20;

/// Whether there is memory left beside a vector, if that is large.
fn leaves_some<T>(elements: &Vec<T>) -> bool {
    let is_large = elements.capacity().saturating_mul(size_of::<T>()) >= SPARE;
    !is_large || is_there(SPARE)
}

/// Whether so many bytes could be had at this moment. (Behind a black box: an allocation that nobody uses is left out otherwise, and found to succeed.)
fn is_there(bytes: usize) -> bool {
    std::hint::black_box(Vec::<u8>::new()).try_reserve_exact(bytes).is_ok()
}

/// Whether there is memory for what cannot go without it, before work that `what` names.
///
/// # Errors
/// `Input` where not.
pub fn spare(what: impl fmt::Display) -> Result<()> {
    let none = || Error::input(format!("not enough memory for {what}; give more"));
    is_there(SPARE).then_some(()).ok_or_else(none)
}

/// `count` times `value`.
///
/// # Errors
/// As [`with_room`].
pub fn filled<T: Clone>(value: T, count: usize, what: impl fmt::Display) -> Result<Vec<T>> {
    let mut elements = with_room(count, what)?;
    elements.resize(count, value);
    Ok(elements)
}

/// Appends `element` to those of what is called `what`.
///
/// # Errors
/// `Input` where there is no memory for more.
pub fn push<T>(elements: &mut Vec<T>, element: T, what: impl fmt::Display) -> Result<()> {
    if elements.len() == elements.capacity() && (elements.try_reserve(1).is_err() || !leaves_some(elements)) {
        return Err(none_for(2 * elements.len() as u64, size_of::<T>() as u64, &what));
    }
    elements.push(element);
    Ok(())
}

/// Whether `count` times `bytes` bytes could be had at this moment, before work that will take about so much in many pieces.
///
/// # Errors
/// `Input` where not.
pub fn probe(count: u64, bytes: u64, what: impl fmt::Display) -> Result<()> {
    let all = count.checked_mul(bytes).and_then(|all| usize::try_from(all).ok());
    if all.is_some_and(is_there) { Ok(()) } else { Err(none_for(count, bytes, &what)) }
}

fn none_for(count: u64, bytes: u64, what: &dyn fmt::Display) -> Error {
    let megabytes = (count as f64 * bytes as f64 / 1e6).ceil();
    Error::input(format!("not enough memory for {count} {what}, which take {megabytes} MB; give fewer, or more memory"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_had_is_named() {
        let count = usize::MAX / 64;
        let said = with_room::<[f64; 3]>(count, "sites").unwrap_err().to_string();
        assert!(said.starts_with(&format!("not enough memory for {count} sites")), "{said}");
        assert_eq!(probe(u64::MAX, 2, "cells").unwrap_err().kind(), crate::ErrorKind::Input);
        assert_eq!(filled(7, 3, "numbers").unwrap(), [7; 3]);
        let mut numbers = vec![1];
        push(&mut numbers, 2, "numbers").unwrap();
        assert_eq!(numbers, [1, 2]);
    }
}
