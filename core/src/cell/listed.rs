//! For hosts: the vertices near one that is asked for, listed once.

use super::far::{MOST_COMPARED, ask};
use super::search_store::SearchStore;
use super::vector::{V3, dot, sub};

/// Asks for vertices near `place`, where the first is, as `ask_near_first` of `far.rs`; returns how many are asked for. (Gone over anew for each of seven they took a sixth of the time of a
/// heavy site's cell.)
pub(super) fn ask_listed<S: SearchStore>(s: &mut S, place: V3, at_once: u32) -> u32 {
    let mut listed = [u64::MAX; MOST_COMPARED as usize];
    let above = s.key_above(0.0);
    let (mut count, mut compared) = (0, 0);
    let mut v = s.next_open(0);
    while v < s.vertices() && compared < MOST_COMPARED {
        compared += 1;
        let way = sub(s.position(v), place);
        let key = s.key_below(dot(way, way));
        if key > above {
            listed[count] = u64::from(key) << 32 | u64::from(v);
            count += 1;
        }
        v = s.next_open(v + 1);
    }
    let listed = &mut listed[..count];
    let (mut asked, mut last) = (1, 0);
    for i in 0..count {
        if asked >= at_once {
            break;
        }
        let nearest = (i..count).min_by_key(|&other| listed[other]).unwrap_or(i);
        listed.swap(i, nearest);
        let (key, v) = (listed[i] >> 32, listed[i] as u32);
        // (Of those as far as another one is asked for.)
        if key != last && ask(s, v, asked) {
            asked += 1;
        }
        last = key;
    }
    asked
}
