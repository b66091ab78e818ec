//! The minors of vertices' planes, which decide the sign of each further plane at a sixth of what it takes anew: kept from the first sign on that floating
//! point leaves open.

use laguerre_core::cell::{Minors, Plane, SIGN_UNKNOWN, Triplet};
use laguerre_core::narrow::{self, Columns, Row};

/// What a vertex has: minors in double-double, in integers.
const HAS_WIDE: u8 = 1;
const HAS_NARROW: u8 = 2;

/// Those of the vertices of a cell.
#[derive(Debug, Default)]
pub(crate) struct KeptMinors {
    /// Of each vertex what it has.
    has: Vec<u8>,
    wide: Vec<Minors>,
    narrow: Vec<narrow::Minors>,
    /// What makes integers of the cell's planes, once they were asked for: `Some(None)` where nothing does.
    columns: Option<Option<Columns>>,
    /// Integers of planes, once they were asked for.
    rows: Vec<Option<Option<Row>>>,
}

impl KeptMinors {
    /// With room for so many planes and vertices.
    pub(crate) fn with_room(planes: usize, vertices: usize) -> Self {
        Self { has: vec![0; vertices], rows: vec![None; planes], ..Self::default() }
    }

    /// Turns to another cell, whose planes and vertices are all set anew.
    pub(crate) fn turn_to_another(&mut self) {
        self.columns = None;
    }

    #[inline(always)]
    pub(crate) fn forget_plane(&mut self, f: usize) {
        self.rows[f] = None;
    }

    #[inline(always)]
    pub(crate) fn forget_vertex(&mut self, v: usize) {
        self.has[v] = 0;
    }

    pub(crate) fn forget_vertices(&mut self) {
        self.has.fill(0);
    }

    pub(crate) fn wide(&self, v: usize) -> Minors {
        if self.has[v] & HAS_WIDE == 0 { Minors::default() } else { self.wide[v] }
    }

    pub(crate) fn keep_wide(&mut self, v: usize, minors: Minors) {
        keep(&mut self.wide, v, minors);
        self.has[v] |= HAS_WIDE;
    }

    /// The sign of plane `k` at vertex `v`, of triplet `t`, by integers, where the planes are such.
    pub(crate) fn narrow_sign(&mut self, planes: &[Plane], v: usize, t: Triplet, k: usize) -> i32 {
        let Some(last) = self.row(planes, k) else { return SIGN_UNKNOWN };
        if self.has[v] & HAS_NARROW == 0 {
            let rows = [t.a, t.b, t.c].map(|f| self.row(planes, f as usize));
            let [Some(a), Some(b), Some(c)] = rows else { return SIGN_UNKNOWN };
            keep(&mut self.narrow, v, narrow::Minors::new(a, b, c));
            self.has[v] |= HAS_NARROW;
        }
        self.narrow[v].sign(last)
    }

    fn row(&mut self, planes: &[Plane], f: usize) -> Option<Row> {
        // (Those of the box have larger numbers than all others, of fewer digits.)
        let others = || planes.get(6..).filter(|others| !others.is_empty()).unwrap_or(planes);
        let columns = *self.columns.get_or_insert_with(|| Columns::of(others().iter().copied()));
        *self.rows[f].get_or_insert_with(|| columns.and_then(|columns| columns.row(planes[f])))
    }
}

fn keep<T: Clone + Default>(all: &mut Vec<T>, v: usize, minors: T) {
    if v >= all.len() {
        all.resize(v + 1, T::default());
    }
    all[v] = minors;
}
