//! The search for the sites that cut a cell, over the one tree ([`SiteTree`]).
//!
//! 1. **Near** (`group.rs`). The eight sites of a leaf look about together: leaves come nearest first, chunk by chunk, and with each chunk a bound
//!    of all sites that are not listed yet. A cell takes the sites of a chunk nearest first, until the bound proves that no other can cut it.
//! 2. **Far** (`core/src/cell/far.rs`, as on devices). A cell that reaches beyond what is worth listing is completed vertex by vertex: which site has
//!    the least power there?
//!
//! Where weights are rough an octree over the container tells where a cell is, and it is completed box by box (`hard.rs`, `core/src/cell/boxes.rs`).
//!
//! What is proved, and from where, is said in `core/src/cell/search.rs`.

#![allow(clippy::needless_range_loop, reason = "loops over eight lanes of several arrays at once")]

mod group;
mod hard;
mod one_cell;
mod store;

use crate::cell::bound::reach_of_bisector;
use crate::cell::far::search_far;
use crate::cell::search_store::SearchStore as _;
use crate::cell::{self, CellStore, EMPTY, Real, TAG_BOX, TOGETHER, UNIT_ROUNDOFF, V3, v3};
use crate::diagram::Prepared;
use crate::site_tree::{Leaf, SiteTree, WIDTH};
use group::Group;
use one_cell::Cell;
use pulp::{Arch, NullaryFnOnce};
use store::{MOST_ASKED, Room, Searched};

/// Chunks that a group lists at most.
const MOST_CHUNKS: usize = 12;

/// How many times as far (as a square) as what is listed a cell may reach for the next chunk to be worth while; the chunks before the bound is
/// large enough to tell.
const WORTH_A_CHUNK: Real = 24.0;
const SURE_CHUNKS: usize = 2;

/// Candidates that are sorted at once, where there are more than twice as many.
const SORTED_AT_ONCE: usize = 64;

/// Sites in a row that do not cut a cell before it is completed by its vertices, if it reaches that many times as far (as a square) as all that
/// is listed can prove.
const MOST_IDLE: u32 = 24;
const FAR: Real = 64.0;

/// Sites that share what bounds their cells far off, those of a block of the tree, and how many of those are kept.
const SHARING: usize = WIDTH * WIDTH;
const MOST_KEPT: usize = 64;

/// Candidates between two looks at the whole: what the next have before them, and whether the cell already lies outside the domain.
const BETWEEN_LOOKS: usize = TOGETHER;

/// Those of them that left the cell as it is, from which on the next are first looked at together. (Of a white cell's 24 that do 15 are found so: 4.6 % fewer
/// instructions, inside the bunny 5.5, of a Lévy flight 11, of blue noise 0.6 % more; by time 3 % less with 3, 2 or 4, blue noise the same.)
const MANY_UNTOUCHED: u32 = 3;

/// Relative room for the roundings of a test of reach: at most ten operations each.
const SAFE: Real = 1.0 + 16.0 * UNIT_ROUNDOFF;

/// A candidate as one number to sort by: the upper bits of what [`Reaches`] says of it, then its sorted index.
type Candidate = u64;

/// Searches of one thread, and their buffers.
#[derive(Debug)]
pub struct Search<'a> {
    prepared: &'a Prepared,
    group: Group<'a>,
    room: Box<Room>,
    reaches: Vec<Reaches>,
    candidates: Vec<Candidate>,
    /// The sites that bound the cells before far off, as far as these are of this block and were completed by their vertices: the last cell's first. What completes a
    /// cell there completes those beside it.
    kept: Vec<u32>,
    kept_of: usize,
    is_row: bool,
    /// The instructions that the CPU has.
    arch: Arch,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// `COMPLETE`, `EMPTY`, or what makes the cell be tried again.
    pub status: u32,
    /// Whether `epsilon` left out sites that might cut the cell.
    pub uncertified: bool,
    /// Sites visited, and those of them that cut the cell.
    pub visited: u32,
    /// Blocks of eight nodes of the tree opened for its vertices.
    pub opened: u32,
    cuts: u32,
}

impl<'a> Search<'a> {
    /// Over the sites of a diagram.
    pub fn new(prepared: &'a Prepared) -> Self {
        Self {
            prepared,
            group: Group::new(&prepared.sites),
            room: Box::default(),
            reaches: Vec::new(),
            candidates: Vec::new(),
            kept: Vec::new(),
            kept_of: 0,
            is_row: false,
            arch: Arch::new(),
        }
    }

    /// From here on cells of one block that are completed one after the other share what bounds them far off. For a task that always has the same cells
    /// in the same order, so that the number of threads changes nothing.
    pub fn begin_row(&mut self) {
        self.is_row = true;
        self.kept.clear();
    }

    /// Cuts the cell of sorted site `site` until no other site can cut it. What it does depends on the sites alone, not on the cells before, but for those of a
    /// row ([`Search::begin_row`]).
    pub fn complete<S: CellStore>(&mut self, store: &mut S, site: u32, epsilon: Option<Real>) -> Outcome {
        let prepared = self.prepared;
        let [x, y, z, weight] = prepared.sites.site(site);
        let relative = |c: [f64; 3]| v3(c[0] - x, c[1] - y, c[2] - z);
        let status = cell::begin(store, relative(prepared.container.lo), relative(prepared.container.hi));
        if status != cell::COMPLETE {
            return Outcome { status, ..Outcome::default() };
        }
        if let Some(octree) = &prepared.octree
            && let Some(outcome) = self.complete_at_home(store, octree, site, epsilon)
        {
            return outcome;
        }
        self.group.turn_to(site as usize);
        let slope = prepared.sites.has_weights().then(|| self.group.slope_at([x, y, z]));
        let mut cell = Cell::new(store, site, [x, y, z, weight], slope, epsilon);
        cell.measure();
        if let Some(proven_square) = self.near(&mut cell) {
            self.far(&mut cell, proven_square);
        }
        cell.outcome
    }

    /// Visits the sites of the group's chunks until none beyond them can cut the cell. Where that is not worth while, the square of the radius
    /// about the cell's centre within which they cannot.
    fn near<S: CellStore>(&mut self, cell: &mut Cell<'_, S>) -> Option<Real> {
        let mut proven_square = 0.0;
        let may_lie_outside = self.prepared.domain_grid().is_some() && !stands_within(cell);
        for chunk in 0..MOST_CHUNKS {
            if !self.group.has_chunk(chunk) || !self.visit_chunk(cell, chunk, may_lie_outside) {
                return None;
            }
            if self.prepared.domain_grid().is_some() {
                if may_lie_outside && cell::lies_outside(cell.store) {
                    cell.outcome.status = EMPTY;
                    return None;
                }
                if chunk == 0 && !cell.cap(self.group.near().max(0.0).sqrt()) {
                    return None;
                }
            }
            let needed = (cell.farthest * cell.farthest) * SAFE;
            proven_square = self.group.proven_square(chunk, cell.position, cell.weight).min(cell.left_square);
            if needed <= proven_square {
                return None;
            }
            if cell.is_idle
                || cell.outcome.visited > cell.most_near
                || (chunk >= SURE_CHUNKS && needed > WORTH_A_CHUNK * proven_square)
            {
                break;
            }
        }
        Some(proven_square)
    }

    /// Completes the cell by its vertices; those within the proven radius of its centre need no look.
    #[cold]
    #[inline(never)]
    fn far<S: CellStore>(&mut self, cell: &mut Cell<'_, S>, proven_square: Real) {
        // (With `epsilon` nothing is shared: a site that is left out would make the cell uncertified, though it may not cut it.)
        let shares = self.is_row && cell.enlarged.is_none();
        // (Those that reach less were visited.)
        let above = 4.0 * proven_square;
        if shares && !self.visit_kept(cell, above) {
            return;
        }
        // Where many sites in a row have not cut a simple cell, few will; nor, likely, where there were those that cut the cells beside it.
        let is_simple = cell.is_idle && cell.store.vertices() as usize <= 2 * MOST_ASKED;
        let center = cell.center;
        let Prepared { sites, octree, .. } = self.prepared;
        let mut searched = Searched::new(cell, sites, octree.as_ref(), &mut self.room, proven_square.max(0.0).sqrt());
        let first_asked = if is_simple || (shares && !self.kept.is_empty()) { searched.most_asked() } else { 1 };
        let status = search_far(&mut searched, center, first_asked, &mut 0);
        cell.outcome.status = status;
        cell.outcome.opened = self.room.opened();
        if shares && status == cell::COMPLETE {
            self.keep(cell, above);
        }
    }

    /// Visits the sites that are kept, where they reach at least `above`; `false` ends the search. (Of sites on a bumpy surface each cell then asks 9 times for some
    /// of its vertices instead of 25, and takes 0.7 of the time.)
    fn visit_kept<S: CellStore>(&mut self, cell: &mut Cell<'_, S>, above: Real) -> bool {
        let block = cell.site as usize / SHARING;
        if self.kept_of != block {
            self.kept.clear();
            self.kept_of = block;
        }
        self.kept.iter().all(|&j| {
            let may_cut = j != cell.site && (above..cell.reach_square).contains(&self.reach(cell, j));
            !may_cut || cell.is_cut_by(j) || cell.visit(self.prepared.sites.site(j), j)
        })
    }

    /// Keeps the sites that bound a cell and reach at least `above`.
    fn keep<S: CellStore>(&mut self, cell: &Cell<'_, S>, above: Real) {
        let tags = (0..cell.store.planes()).map(|f| cell.store.tag(f));
        let far: Vec<u32> = tags.filter(|&tag| tag < TAG_BOX && self.reach(cell, tag) >= above).collect();
        self.kept.retain(|j| !far.contains(j));
        self.kept.splice(0..0, far);
        self.kept.truncate(MOST_KEPT);
    }

    /// What [`Reaches`] says of a site.
    #[inline(always)]
    fn reach<S: CellStore>(&self, cell: &Cell<'_, S>, j: u32) -> Real {
        let (d, more) = cell.difference(self.prepared.sites.site(j));
        cell.slope.map_or_else(|| square(d), |slope| reach_of_bisector(slope, d, more))
    }

    /// Visits the sites of a chunk that may cut the cell, nearest bisector first; `false` ends the search.
    fn visit_chunk<S: CellStore>(&mut self, cell: &mut Cell<'_, S>, chunk: usize, may_lie_outside: bool) -> bool {
        let tree = &self.prepared.sites;
        let leaves = self.group.leaves(chunk);
        let (position, weight) = (cell.position, cell.weight);
        let reaches = &mut self.reaches;
        self.arch.dispatch(Reaching { tree, leaves, position, weight, slope: cell.slope, reaches });
        let mut above = Real::NEG_INFINITY;
        if chunk == 0 {
            // The nearest some first: the others are fewer once these have cut the cell.
            let near = self.group.near();
            let nearest = gather(leaves, &self.reaches, above, near.min(cell.reach_square), &mut self.candidates);
            if !visit_all::<S, false>(tree, cell, nearest, Real::INFINITY, may_lie_outside) {
                return false;
            }
            above = near;
        }
        let rest = gather(leaves, &self.reaches, above, cell.reach_square, &mut self.candidates);
        let promised_square = self.group.proven_square(chunk, position, weight);
        let far_square = if promised_square > 0.0 { FAR * promised_square } else { Real::INFINITY };
        visit_all::<S, false>(tree, cell, rest, far_square, false)
    }
}

/// Finds what the leaves of a chunk have, by the widest instructions that the CPU has.
struct Reaching<'a> {
    tree: &'a SiteTree,
    leaves: &'a [u32],
    position: [f64; 3],
    weight: Real,
    slope: Option<V3>,
    reaches: &'a mut Vec<Reaches>,
}

impl NullaryFnOnce for Reaching<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { tree, leaves, position, weight, slope, reaches } = self;
        if reaches.len() < leaves.len() {
            reaches.resize(leaves.len(), Reaches { of: [0.0; WIDTH], least: 0.0 });
        }
        for (row, &leaf) in reaches.iter_mut().zip(leaves) {
            *row = Reaches::new(tree.leaf(leaf), position, weight, slope);
        }
    }
}

/// What of a leaf's sites may cut a cell.
#[derive(Clone, Copy, Debug)]
struct Reaches {
    /// For each site `j` `4ρ²`, at least, with the sign of `ρ`, the distance of its bisector from the cell's centre: `(h_j − h_i)²/D²`, which with
    /// equal weights is `D²`. It cannot cut the cell if that is at least `4r²`. For the cell's own site 0, or not a number.
    of: [Real; WIDTH],
    /// The least of them.
    least: Real,
}

impl Reaches {
    #[inline(always)]
    fn new(leaf: &Leaf, position: [f64; 3], weight: Real, slope: Option<V3>) -> Self {
        let [xs, ys, zs] = &leaf.at;
        let [px, py, pz] = position;
        let mut of = [0.0; WIDTH];
        match slope {
            None => {
                for k in 0..WIDTH {
                    let (x, y, z) = (xs[k] - px, ys[k] - py, zs[k] - pz);
                    of[k] = ((x * x) + (y * y)) + (z * z);
                }
            }
            Some(g) => {
                for k in 0..WIDTH {
                    let (x, y, z) = (xs[k] - px, ys[k] - py, zs[k] - pz);
                    of[k] = reach_of_bisector(g, v3(x, y, z), leaf.weight[k] - weight);
                }
            }
        }
        Self { of, least: least_of(&of) }
    }
}

/// The sites that reach less than `below`, and at least `above`, into the room for all, which grows where it is not enough.
#[inline(always)]
fn gather<'c>(
    leaves: &[u32],
    reaches: &[Reaches],
    above: Real,
    below: Real,
    candidates: &'c mut Vec<Candidate>,
) -> &'c mut [Candidate] {
    let all = leaves.len() * WIDTH;
    if candidates.len() < all {
        candidates.resize(all, 0);
    }
    let mut count = 0;
    for (&leaf, row) in leaves.iter().zip(reaches) {
        // Most leaves are out of reach as a whole.
        if row.least >= below {
            continue;
        }
        for (k, &reach) in row.of.iter().enumerate() {
            candidates[count] =
                Candidate::from(in_order(reach)) << 32 | Candidate::from(leaf * WIDTH as u32 + k as u32);
            // Without a branch.
            count += usize::from(reach >= above && reach < below);
        }
    }
    &mut candidates[..count]
}

/// Whether it is known that a cell does not lie outside the domain: of equal weights it has its site, and that is within, where no triangle is near. (Of sites all inside the bunny each
/// cell was asked three times, for 3 % of all instructions.)
fn stands_within<S: CellStore>(cell: &Cell<'_, S>) -> bool {
    let voxel = cell.store.voxel_of(cell.store.site());
    cell.slope.is_none() && cell.store.surface_voxels(voxel, voxel) == 0 && cell.store.winding(voxel) != 0
}

/// Visits candidates, nearest first; `false` ends the search. Unless `ALL` are to be, it leaves those that are more than a cell visits near.
fn visit_all<S: CellStore, const ALL: bool>(
    tree: &SiteTree,
    cell: &mut Cell<'_, S>,
    mut candidates: &mut [Candidate],
    far_square: Real,
    looks_outside: bool,
) -> bool {
    let (mut cuts, mut since) = (cell.outcome.cuts, cell.outcome.visited);
    let mut untouched = 0;
    while !candidates.is_empty() {
        // Of many most are never visited, and need not be sorted.
        let mut count = candidates.len();
        if count > 2 * SORTED_AT_ONCE {
            count = SORTED_AT_ONCE;
            candidates.select_nth_unstable(count);
        }
        let (nearest, beyond) = candidates.split_at_mut(count);
        nearest.sort_unstable();
        for some in nearest.chunks_mut(BETWEEN_LOOKS) {
            if cell.outcome.cuts != cuts {
                (cuts, since) = (cell.outcome.cuts, cell.outcome.visited);
            }
            let is_idle = cell.outcome.visited - since >= MOST_IDLE && cell.farthest * cell.farthest > far_square;
            if is_idle || (!ALL && cell.outcome.visited > cell.most_near) {
                // What is left reaches at least as near as its first.
                cell.left_square = cell.left_square.min(0.25 * from_order((some[0] >> 32) as u32));
                cell.is_idle = is_idle;
                return true;
            }
            let before = cell.outcome;
            if untouched >= MANY_UNTOUCHED {
                cell.drop_what_cannot_cut(tree, some);
            }
            for &candidate in &*some {
                if (candidate >> 32) as u32 > cell.last_in_order {
                    // So are those that come after it.
                    return true;
                }
                let site = candidate as u32;
                if site != cell.site && !cell.visit(tree.site(site), site) {
                    return false;
                }
            }
            untouched = (cell.outcome.visited - before.visited) - (cell.outcome.cuts - before.cuts);
            // Cells outside the domain need not be complete to be known empty.
            if looks_outside && cell::lies_outside(cell.store) {
                cell.outcome.status = EMPTY;
                return false;
            }
        }
        candidates = beyond;
    }
    true
}

/// The larger of two numbers, in one instruction; `max` takes three, for what is not a number.
#[inline(always)]
fn larger(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

/// The smaller, likewise.
#[inline(always)]
fn smaller(a: Real, b: Real) -> Real {
    if a < b { a } else { b }
}

/// The least of eight; of what is not a number, none.
#[inline(always)]
fn least_of(of: &[Real; WIDTH]) -> Real {
    let mut pairs = [Real::INFINITY; 2];
    for pair in of.as_chunks::<2>().0 {
        pairs = [smaller(pair[0], pairs[0]), smaller(pair[1], pairs[1])];
    }
    smaller(pairs[0], pairs[1])
}

#[inline(always)]
fn square(d: V3) -> Real {
    ((d.x * d.x) + (d.y * d.y)) + (d.z * d.z)
}

#[inline(always)]
fn norm(d: V3) -> Real {
    square(d).sqrt()
}

/// The upper bits of a number, in the order of numbers.
#[inline(always)]
fn in_order(x: Real) -> u32 {
    let bits = (x.to_bits() >> 32) as u32;
    // All of a negative number's bits turn, of others the sign alone.
    bits ^ (((bits as i32 >> 31) as u32) | 1 << 31)
}

/// The least number of these upper bits.
#[inline(always)]
fn from_order(bits: u32) -> Real {
    let bits = bits ^ ((!(bits as i32) >> 31) as u32 | 1 << 31);
    Real::from_bits(u64::from(bits) << 32)
}

#[cfg(test)]
mod tests;
