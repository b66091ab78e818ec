//! A cell on its way: what the search knows of it, and how it is cut.

use super::{Candidate, Outcome, SAFE, in_order, norm, square};
use crate::cell::{self, CellStore, Plane, Real, TOGETHER, UNIT_ROUNDOFF, V3, bisector, v3};
use crate::site_tree::SiteTree;

/// Distances to the twentieth nearest site beyond which what of a cell is outside the domain is cut off.
const CAP_FROM: Real = 1.4;

/// Sites that a cell visits before it is completed by its vertices, and the same where weights differ. (With 200 instead of 120 a jittered sphere and scanned sites
/// take 9 % more instructions, a Lévy flight 6; where weights differ wavy ones take 9 % more with 120 instead of 200, lognormal ones 6.)
const MOST_NEAR: u32 = 120;
const MOST_NEAR_WEIGHTED: u32 = 200;

/// One cell on its way.
pub(super) struct Cell<'a, S> {
    pub(super) store: &'a mut S,
    pub(super) site: u32,
    pub(super) position: [f64; 3],
    pub(super) weight: Real,
    /// The slope of the weights at the site, where weights differ.
    pub(super) slope: Option<V3>,
    /// From the site to `y`, and how far rounding moves what is less it.
    pub(super) center: V3,
    center_rounding: Real,
    /// An upper bound of the distance from `y` to the farthest vertex.
    pub(super) farthest: Real,
    /// The same, doubled and squared, with room for rounding; and its upper bits.
    pub(super) reach_square: Real,
    pub(super) last_in_order: u32,
    /// `Some(1 + ε)`: sites beyond the paper's enlarged security radius are left out, uncertified.
    pub(super) enlarged: Option<Real>,
    /// The square of the radius about `y` within which the candidates that were not visited cannot cut the cell.
    pub(super) left_square: Real,
    /// Sites that it visits before it is completed by its vertices.
    pub(super) most_near: u32,
    /// Whether many sites in a row have not cut it, which has far to go.
    pub(super) is_idle: bool,
    pub(super) outcome: Outcome,
}

impl<'a, S: CellStore> Cell<'a, S> {
    /// The cell of sorted site `site`, which stands at `x, y, z` with a weight; `slope` is that of the weights there, where they differ.
    pub(super) fn new(
        store: &'a mut S,
        site: u32,
        [x, y, z, weight]: [f64; 4],
        slope: Option<V3>,
        epsilon: Option<Real>,
    ) -> Self {
        let center = slope.map_or(V3::default(), |g| v3(-0.5 * g.x, -0.5 * g.y, -0.5 * g.z));
        Self {
            store,
            site,
            position: [x, y, z],
            weight,
            slope,
            center,
            center_rounding: rounding_about(center),
            farthest: 0.0,
            reach_square: 0.0,
            last_in_order: 0,
            enlarged: epsilon.map(|e| 1.0 + e),
            left_square: Real::INFINITY,
            most_near: if slope.is_some() { MOST_NEAR_WEIGHTED } else { MOST_NEAR },
            is_idle: false,
            outcome: Outcome { status: cell::COMPLETE, ..Outcome::default() },
        }
    }

    /// Measures the cell anew.
    #[inline(always)]
    pub(super) fn measure(&mut self) {
        self.farthest = reach_from(self.store, self.center, self.center_rounding);
        self.reach_square = (4.0 * (self.farthest * self.farthest)) * SAFE;
        self.last_in_order = in_order(self.reach_square);
    }

    /// The way to a site, and what it weighs more than the cell's.
    #[inline(always)]
    pub(super) fn difference(&self, [x, y, z, w]: [f64; 4]) -> (V3, Real) {
        let [px, py, pz] = self.position;
        (v3(x - px, y - py, z - pz), w - self.weight)
    }

    /// Cuts the cell by the bisector with a site, and measures it; `false` ends the search.
    #[inline(always)]
    pub(super) fn visit(&mut self, site: [f64; 4], index: u32) -> bool {
        match self.cut(site, index) {
            cell::UNTOUCHED => true,
            cell::CUT => {
                self.measure();
                true
            }
            _ => false,
        }
    }

    /// Cuts the cell by the bisector with a site: `UNTOUCHED`, `CUT`, or how it ended.
    #[inline(always)]
    pub(super) fn cut(&mut self, site: [f64; 4], index: u32) -> u32 {
        let (d, more) = self.difference(site);
        if self.is_left_out(d) {
            return cell::UNTOUCHED;
        }
        self.outcome.visited += 1;
        let status = cell::clip(self.store, bisector(d, -more), index);
        match status {
            cell::UNTOUCHED => {}
            cell::CUT => self.outcome.cuts += 1,
            _ => self.outcome.status = status,
        }
        status
    }

    /// Makes those of up to eight candidates that are known to leave the cell as it is its own site, which is not visited; they count as visited.
    #[inline(never)]
    pub(super) fn drop_what_cannot_cut(&mut self, tree: &SiteTree, some: &mut [Candidate]) {
        if self.enlarged.is_some() {
            return;
        }
        let mut planes = [[0.0; TOGETHER]; 4];
        for (k, &candidate) in some.iter().enumerate() {
            let (d, more) = self.difference(tree.site(candidate as u32));
            let Plane { n, d } = bisector(d, -more);
            (planes[0][k], planes[1][k], planes[2][k], planes[3][k]) = (n.x, n.y, n.z, d);
        }
        let may_cut = self.store.may_be_cut_by(&planes);
        for (k, candidate) in some.iter_mut().enumerate() {
            if may_cut >> k & 1 == 0 && (*candidate >> 32) as u32 <= self.last_in_order {
                *candidate = *candidate >> 32 << 32 | Candidate::from(self.site);
                self.outcome.visited += 1;
            }
        }
    }

    /// Whether the bisector with a site is among its half-spaces.
    pub(super) fn is_cut_by(&self, site: u32) -> bool {
        (0..self.store.planes()).any(|f| self.store.tag(f) == site)
    }

    /// Whether `epsilon` leaves out the site at `d` from the cell's.
    #[inline(always)]
    fn is_left_out(&mut self, d: V3) -> bool {
        let Some(enlarged) = self.enlarged else { return false };
        let reach = enlarged * (2.0 * cell::farthest_vertex(self.store));
        if square(d) < reach * reach {
            return false;
        }
        self.outcome.uncertified = true;
        true
    }

    /// Cuts off what of the cell is far outside the domain, `scale` being the distance between sites, times some; `false` ends the search.
    #[inline(always)]
    pub(super) fn cap(&mut self, scale: Real) -> bool {
        let radius = CAP_FROM * scale + norm(self.center);
        self.farthest < radius || self.cap_outside(radius)
    }

    #[cold]
    #[inline(never)]
    fn cap_outside(&mut self, radius: Real) -> bool {
        match cell::cap_outside(self.store, radius) {
            cell::UNTOUCHED => true,
            cell::CUT => {
                self.measure();
                true
            }
            status => {
                self.outcome.status = status;
                false
            }
        }
    }
}

/// An upper bound of the distance from `center`, which rounding moves what is less it by up to `rounding`, to the farthest vertex.
#[inline(always)]
pub(super) fn reach_from<S: CellStore>(store: &S, center: V3, rounding: Real) -> Real {
    let V3 { x: square, y: radius, .. } = store.farthest_from(center);
    // The radius bounds each component, √3 < 2.
    ((square.sqrt() + 2.0 * radius) + rounding) * SAFE
}

/// How far rounding moves a vertex less a centre.
#[inline(always)]
pub(super) fn rounding_about(center: V3) -> Real {
    8.0 * UNIT_ROUNDOFF * norm(center)
}
