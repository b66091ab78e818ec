//! The vertices of a large cell that a half-space cuts off, found from one of them on: they are connected by edges, and few. (A heavy site's cell among a million has 22,000 vertices, and each
//! of its 11,000 half-spaces cuts off some six.)

use super::{CpuStore, next_bit};
use foldhash::fast::FixedState;
use laguerre_core::cell::{ClipStore, MARK_CONFLICT, MARK_KEEP, Plane, Polytope, SEEN_KEEP, Triplet};
use std::collections::HashMap;
use std::iter;

/// Vertices from which on it is worth while: to test so many takes as long as to look up the edges of a few.
pub(super) const MANY: usize = 2048;

/// Which vertex each directed edge a→b belongs to, of those that vertices have: one of them has it, and the one at its other end b→a.
#[derive(Debug, Default)]
pub(super) struct Edges {
    vertex_of: HashMap<[u32; 2], u32, FixedState>,
    /// Whether it is known, but for what the last half-space may have changed: `changed`, and vertices from `end` on.
    is_known: bool,
    changed: Vec<u32>,
    end: usize,
    /// The number of that half-space.
    last: u32,
    /// A vertex that the next half-space likely cuts off.
    first: Option<u32>,
}

impl Edges {
    /// The next half-space likely cuts off vertex `v`.
    #[inline(always)]
    pub(super) fn begin_at(&mut self, v: u32) {
        self.first = Some(v);
    }

    /// Turns to another cell.
    pub(super) fn turn_to_another(&mut self) {
        self.is_known = false;
        self.first = None;
    }

    /// Forgets what is known: half-spaces or vertices have other numbers.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        self.is_known = false;
    }

    /// Learns the edges of the vertices of these triplets, which half-space `k` is to cut, and takes the one to begin at.
    pub(super) fn learn(&mut self, triplets: &[Triplet], k: u32) -> Option<u32> {
        // (Where others have cut it in between, when it had fewer vertices.)
        self.is_known &= k <= self.last + 1;
        self.last = k;
        let first = self.first.take().filter(|&v| (v as usize) < triplets.len());
        if self.is_known {
            let changed = self.changed.drain(..).filter(|&v| (v as usize) < triplets.len());
            changed.chain(self.end as u32..triplets.len() as u32).for_each(|v| enter(&mut self.vertex_of, triplets, v));
        } else if first.is_some() {
            self.vertex_of.clear();
            (0..triplets.len() as u32).for_each(|v| enter(&mut self.vertex_of, triplets, v));
            self.is_known = true;
        }
        self.changed.clear();
        self.end = triplets.len();
        first
    }

    /// Which vertices a half-space may take the place of, of those that have been learned.
    pub(super) fn expect(&mut self, marked: impl Iterator<Item = u32>) {
        if self.is_known {
            self.changed.extend(marked);
        }
    }

    /// The vertices at the other ends of the edges of that of a triplet.
    pub(super) fn beside(&self, t: Triplet) -> [Option<u32>; 3] {
        [[t.b, t.a], [t.c, t.b], [t.a, t.c]].map(|edge| self.vertex_of.get(&edge).copied())
    }
}

/// Enters the edges of vertex `v`.
fn enter(vertex_of: &mut HashMap<[u32; 2], u32, FixedState>, triplets: &[Triplet], v: u32) {
    let t = triplets[v as usize];
    vertex_of.extend([[t.a, t.b], [t.b, t.c], [t.c, t.a]].map(|edge| (edge, v)));
}

impl CpuStore<'_> {
    /// `mark_conflicts` of a cell of many vertices.
    #[cold]
    #[inline(never)]
    pub(super) fn mark_of_many(&mut self, k: u32, plane: Plane) -> u32 {
        self.mark_from_one(k, plane).unwrap_or_else(|| {
            let seen = self.mark_all(plane);
            let end = self.vertices();
            let next = |v: u32| Some(next_bit(v, end, |word| self.conflict[word] | self.uncertain[word]));
            self.edges.expect(iter::successors(next(0), |&v| next(v + 1)).take_while(|&v| v < end));
            seen
        })
    }

    /// `mark_conflicts` from a vertex on that the plane likely cuts off, along edges; `None` where it does not, or where there is none. What is open may be cut off, and is gone on from as well.
    fn mark_from_one(&mut self, k: u32, plane: Plane) -> Option<u32> {
        let count = self.vertices.count;
        let first = self.edges.learn(&self.vertices.triplets[..count], k)?;
        let (mark, mut seen) = self.mark_by(plane, first);
        if mark != MARK_CONFLICT {
            return None;
        }
        let words = count.div_ceil(64);
        self.conflict[..words].fill(0);
        self.uncertain[..words].fill(0);
        self.set_mark(first, mark);
        let (mut marked, mut next) = (vec![first], 0);
        while let Some(&v) = marked.get(next) {
            next += 1;
            for beside in self.edges.beside(self.triplet(v)) {
                let beside = beside?;
                if self.mark(beside) != MARK_KEEP {
                    continue;
                }
                let (mark, bit) = self.mark_by(plane, beside);
                if mark != MARK_KEEP {
                    self.set_mark(beside, mark);
                    seen |= bit;
                    marked.push(beside);
                }
            }
        }
        seen |= if marked.len() < count { SEEN_KEEP } else { 0 };
        self.edges.expect(marked.into_iter());
        Some(seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use laguerre_core::cell::{CUT, UNTOUCHED, begin, bisector, clip, v3};
    use laguerre_core::passes::Capacities;

    /// A cell of thousands of vertices, by a store that is told where to begin, and by one that is not: the same vertices.
    #[test]
    fn many_vertices_are_cut_off_from_one_on_as_by_looking_at_all() {
        let room = Capacities { planes: 8192, vertices: 16384 };
        let [mut walks, mut looks] = [(); 2].map(|()| CpuStore::new(room, None));
        for store in [&mut walks, &mut looks] {
            store.turn_to(v3(0.5, 0.5, 0.5));
            begin(store, v3(-0.5, -0.5, -0.5), v3(0.5, 0.5, 0.5));
        }
        let (mut walked, mut cut, mut untouched) = (0, 0, 0);
        for i in 0..3200_u32 {
            // Sites about a sphere, and where the cell is large some nearer, whose half-spaces cut off many vertices, some farther, which cut off few or none, and some of a lattice.
            let (many, turn) = (i >= 2400, 2.399_963_229_728_653 * f64::from(i));
            let z = 2.0 * (f64::from(i) * 0.754_877_666_246_693).fract() - 1.0;
            let across = (1.0 - z * z).sqrt();
            let far = if many && i % 97 == 0 { 0.78 } else { 0.8 + 1e-4 * f64::from(i % 7) };
            let mut d = v3(far * across * turn.cos(), far * across * turn.sin(), far * z);
            if many && i % 5 == 0 {
                d = v3((64.0 * d.x).round() / 64.0, (64.0 * d.y).round() / 64.0, (64.0 * d.z).round() / 64.0);
            }
            let plane = bisector(d, 0.0);
            let (k, all) = (looks.planes(), looks.vertices());
            let along = |v: u32| {
                let (p, n) = (looks.position(v), plane.n);
                n.x * p.x + n.y * p.y + n.z * p.z
            };
            let farthest = (0..all).min_by(|&a, &b| along(a).total_cmp(&along(b))).unwrap();
            // (At times one that it leaves, or that there is not.)
            let first = [farthest, farthest, i % all, farthest, all + i][i as usize % 5];
            if all as usize >= MANY {
                walks.set_plane(k, plane);
                looks.set_plane(k, plane);
                walks.begin_at(first);
                let seen = looks.mark_conflicts(k);
                if let Some(its) = walks.mark_from_one(k, plane) {
                    walked += 1;
                    assert_eq!(its, seen, "{i}");
                    (0..all).for_each(|v| assert_eq!(walks.mark(v), looks.mark(v), "vertex {v}, {i}"));
                }
            }
            walks.begin_at(first);
            let status = clip(&mut looks, plane, i);
            assert_eq!(clip(&mut walks, plane, i), status, "{i}");
            (cut, untouched) = (cut + u32::from(status == CUT), untouched + u32::from(status == UNTOUCHED));
            assert_eq!((walks.planes(), walks.vertices()), (looks.planes(), looks.vertices()), "{i}");
            (0..looks.vertices()).for_each(|v| assert_eq!(walks.triplet(v), looks.triplet(v), "vertex {v}, {i}"));
        }
        assert!(
            looks.vertices.count > MANY && walked > 200 && cut > 2400 && untouched > 50,
            "{walked}, {cut}, {untouched}"
        );
    }
}
