//! A plane through a domain: the closed curves in which it meets the surface.

use std::collections::HashMap;

use laguerre::Domain;

/// A plane with coordinates: `origin + a·u + b·v`, `u` and `v` orthonormal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlicePlane {
    pub(crate) origin: [f64; 3],
    pub(crate) u: [f64; 3],
    pub(crate) v: [f64; 3],
}

impl SlicePlane {
    /// The point at coordinates (a, b).
    pub(crate) fn point(&self, [a, b]: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + a * self.u[k] + b * self.v[k])
    }

    /// The curves in which the plane meets the surface of `domain`, in coordinates (a, b), with the domain on their left (seen
    /// against u × v); polygons without a repeated last point.
    pub(crate) fn curves(&self, domain: &Domain) -> Vec<Vec<[f64; 2]>> {
        let normal = cross(self.u, self.v);
        // Where a vertex lies on the plane it counts as above it: as if the plane stood an infinitesimal lower.
        let heights: Vec<f64> = domain.vertices().iter().map(|&p| dot(normal, self.relative(p))).collect();
        // Every triangle that is cut leads from an edge, named by its lower and higher vertex, to another.
        let mut next: HashMap<[u32; 2], Vec<[u32; 2]>> = HashMap::new();
        for t in domain.triangles() {
            let edges = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            let above = |i: u32| heights[i as usize] >= 0.0;
            let down = edges.iter().find(|e| above(e[0]) && !above(e[1]));
            let up = edges.iter().find(|e| !above(e[0]) && above(e[1]));
            if let (Some(&down), Some(&up)) = (down, up) {
                next.entry(sorted(down)).or_default().push(sorted(up));
            }
        }
        let mut starts: Vec<[u32; 2]> = next.keys().copied().collect();
        starts.sort_unstable();
        let mut curves = Vec::new();
        for start in starts {
            while let Some(mut edge) = next.get_mut(&start).and_then(Vec::pop) {
                let mut curve = vec![self.crossing(domain, &heights, start)];
                // In a closed mesh each edge is entered as often as it is left, so this ends at the start.
                while edge != start {
                    curve.push(self.crossing(domain, &heights, edge));
                    let Some(following) = next.get_mut(&edge).and_then(Vec::pop) else { break };
                    edge = following;
                }
                curves.push(curve);
            }
        }
        curves
    }

    /// Where an edge meets the plane.
    fn crossing(&self, domain: &Domain, heights: &[f64], [i, j]: [u32; 2]) -> [f64; 2] {
        let (hi, hj) = (heights[i as usize], heights[j as usize]);
        let t = hi / (hi - hj);
        let [p, q] = [i, j].map(|i| self.relative(domain.vertices()[i as usize]));
        [self.u, self.v].map(|axis| (1.0 - t) * dot(axis, p) + t * dot(axis, q))
    }

    fn relative(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| p[k] - self.origin[k])
    }
}

fn sorted([i, j]: [u32; 2]) -> [u32; 2] {
    [i.min(j), i.max(j)]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(curve: &[[f64; 2]]) -> f64 {
        let edges = curve.iter().zip(curve.iter().cycle().skip(1));
        0.5 * edges.map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
    }

    #[test]
    fn slices_add_up_to_the_volume() {
        let domain = laguerre::shapes::swan().domain();
        let (lo, hi) = domain.bounding_box();
        let n = 400;
        let step = (hi[2] - lo[2]) / f64::from(n);
        let volume: f64 = (0..n)
            .map(|i| {
                let origin = [0.0, 0.0, lo[2] + (f64::from(i) + 0.5) * step];
                let plane = SlicePlane { origin, u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] };
                plane.curves(&domain).iter().map(|c| area(c)).sum::<f64>() * step
            })
            .sum();
        // The midpoint rule on a piecewise quadratic function: what is left is of the order of 1/n².
        assert!((volume / domain.volume() - 1.0).abs() < 1e-4, "{volume}");
    }

    #[test]
    fn a_plane_through_vertices_is_no_special_case() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let domain = Domain::new(&vertices, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
        let at = |z: f64| SlicePlane { origin: [0.0, 0.0, z], u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] }.curves(&domain);
        assert_eq!(at(0.0).len(), 0, "all vertices of the base count as above");
        assert_eq!(at(1.0).len(), 1);
        let middle = at(0.5);
        assert_eq!((middle.len(), area(&middle[0])), (1, 0.125));
    }
}
