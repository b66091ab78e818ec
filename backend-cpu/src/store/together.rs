//! Eight half-spaces against a cell at once, before they are to cut it one by one.

use super::{CpuStore, LANES, Vertices};
use laguerre_core::cell::{Real, TOGETHER, UNIT_ROUNDOFF};
use pulp::NullaryFnOnce;

/// Vertices of a cell for which that is worth while, at most.
const MOST_VERTICES: usize = 256;

impl CpuStore<'_> {
    /// `may_be_cut_by`, by the widest instructions that the CPU has.
    pub(super) fn together(&self, planes: &[[Real; TOGETHER]; 4]) -> u8 {
        if self.vertices.count > MOST_VERTICES {
            return u8::MAX;
        }
        self.arch.dispatch(Together { vertices: &self.vertices, planes })
    }
}

struct Together<'a> {
    vertices: &'a Vertices,
    planes: &'a [[Real; TOGETHER]; 4],
}

impl NullaryFnOnce for Together<'_> {
    type Output = u8;

    /// (As `mark_all` tests each vertex, with the largest radius of all: rounded sums keep the order of what is added to one number.)
    #[inline(always)]
    fn call(self) -> u8 {
        let Self { vertices, planes: [nx, ny, nz, d] } = self;
        let (mut least, mut radius) = ([Real::INFINITY; TOGETHER], 0.0);
        for v in 0..vertices.count {
            let (four, lane) = (&vertices.places[v / LANES], v % LANES);
            let (x, y, z) = (four.x[lane], four.y[lane], four.z[lane]);
            for k in 0..TOGETHER {
                let along = ((nx[k] * x) + (ny[k] * y)) + (nz[k] * z);
                least[k] = if along < least[k] { along } else { least[k] };
            }
            radius = if four.radius[lane] > radius { four.radius[lane] } else { radius };
        }
        let mut kept = 0;
        for k in 0..TOGETHER {
            let size = (nx[k].abs() + ny[k].abs()) + nz[k].abs();
            let bound = (size * radius) + ((4.0 * UNIT_ROUNDOFF) * d[k].abs());
            kept |= u8::from(least[k] + d[k] > bound) << k;
        }
        !kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use laguerre_core::cell::{CUT, ClipStore, Plane, UNTOUCHED, begin, bisector, clip, v3};
    use laguerre_core::passes::Capacities;

    /// A half-space that is known to leave the cell as it is does so, then and when others have cut it; and few others do.
    #[test]
    fn what_is_known_to_leave_the_cell_leaves_it() {
        let mut store = CpuStore::new(Capacities { planes: 200, vertices: 400 }, None);
        store.turn_to(v3(0.5, 0.5, 0.5));
        begin(&mut store, v3(-0.5, -0.5, -0.5), v3(0.5, 0.5, 0.5));
        let mut dropped: Vec<Plane> = Vec::new();
        let (mut cut, mut untouched, mut open) = (0, 0, 0);
        for i in 0..400_u32 {
            let eight: [Plane; TOGETHER] = std::array::from_fn(|k| {
                let i = i * TOGETHER as u32 + k as u32;
                let turn = 2.399_963_229_728_653 * f64::from(i);
                let z = 2.0 * (f64::from(i) * 0.754_877_666_246_693).fract() - 1.0;
                let across = (1.0 - z * z).sqrt();
                let far = 0.7 + 0.3 * (f64::from(i) * 0.569_840_290_998).fract();
                let d = v3(far * across * turn.cos(), far * across * turn.sin(), far * z);
                // Those of a lattice go through edges and vertices of the cell, and some weigh more.
                let eighths = |x: f64| (8.0 * x).round() / 8.0;
                let d = if i.is_multiple_of(5) { v3(eighths(d.x), eighths(d.y), eighths(d.z)) } else { d };
                bisector(d, 0.02 * f64::from(i % 3))
            });
            let may_cut = store.may_be_cut_by(&[
                eight.map(|plane| plane.n.x),
                eight.map(|plane| plane.n.y),
                eight.map(|plane| plane.n.z),
                eight.map(|plane| plane.d),
            ]);
            for (k, &plane) in eight.iter().enumerate() {
                let is_dropped = may_cut >> k & 1 == 0;
                let status = clip(&mut store, plane, i);
                match status {
                    CUT => cut += 1,
                    UNTOUCHED => untouched += 1,
                    _ => panic!("{status}"),
                }
                assert!(!is_dropped || status == UNTOUCHED, "{i}, {k}");
                open += u32::from(!is_dropped && status == UNTOUCHED);
                dropped.extend(is_dropped.then_some(plane));
            }
        }
        assert!(cut > 50 && dropped.len() > 2500 && open < untouched / 10, "{cut}, {}, {open}", dropped.len());
        for plane in dropped {
            assert_eq!(clip(&mut store, plane, 0), UNTOUCHED);
        }
    }
}
