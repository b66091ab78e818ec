//! The integral of a given function over a convex cell, by quadrature on tetrahedra that lie within it.
//!
//! Not on the signed tetrahedra of `integrate.rs`, whose feet may lie far outside of the cell, where the function need not be smooth nor
//! even defined: each facet is divided into a fan of triangles about its first vertex, and each triangle makes a tetrahedron with the
//! reference point. Where that is in the cell, all nodes are, and no volume is negative; there are a third as many tetrahedra.

use super::store::{IntegralStore, Polytope};
use super::vector::{Real, V3, add, cross, dot, scale, sub};
use super::vertex::Triplet;
use super::wide::{Wide, sum_exact};

/// A node of the quadrature rule on a tetrahedron.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Its three coordinates along the edges from the reference point.
    pub place: V3,
    /// Its share of the volume.
    pub weight: Real,
}

/// The integral of the store's function over the present polytope; `center` is the point that the tetrahedra share.
// Few ask for it: not to be inlined into what all do.
#[cold]
#[cfg_attr(opencl, outline)]
pub(crate) fn integrate_function<S: IntegralStore>(s: &S, center: V3) -> Real {
    let mut sum: Wide = Wide { hi: 0.0, lo: 0.0 };
    for v in 0..s.vertices() {
        let t: Triplet = s.triplet(v);
        add_fans_at_edge(s, v, t.a, t.b, center, &mut sum);
        add_fans_at_edge(s, v, t.b, t.c, center, &mut sum);
        add_fans_at_edge(s, v, t.c, t.a, center, &mut sum);
    }
    // Of sixfold volumes.
    return (sum.hi + sum.lo) / 6.0;
}

/// Adds the tetrahedra over the triangles that the edge (f, g) of vertex `v` has in its two facets; each edge at its later vertex.
#[cfg_attr(opencl, outline)]
fn add_fans_at_edge<S: IntegralStore>(s: &S, v: u32, f: u32, g: u32, center: V3, sum: &mut Wide) {
    let w: u32 = first_vertex_on(s, f, g, v);
    if w == v {
        return;
    }
    let to: V3 = sub(s.position(v), center);
    let from: V3 = sub(s.position(w), center);
    let spoke: V3 = cross(from, to);
    let top_f: u32 = first_vertex_on(s, f, f, w);
    if top_f != w {
        let top: V3 = sub(s.position(top_f), center);
        add_quadrature(s, -dot(top, spoke), top, from, to, center, sum);
    }
    let top_g: u32 = first_vertex_on(s, g, g, w);
    if top_g != w {
        let top: V3 = sub(s.position(top_g), center);
        add_quadrature(s, dot(top, spoke), top, from, to, center, sum);
    }
}

/// The first vertex below `end` that lies on both planes; `end` if there is none.
#[cfg_attr(opencl, outline)]
fn first_vertex_on<S: Polytope>(s: &S, f: u32, g: u32, end: u32) -> u32 {
    for v in 0..end {
        let t: Triplet = s.triplet(v);
        if (((t.a == f) || (t.b == f)) || (t.c == f)) && (((t.a == g) || (t.b == g)) || (t.c == g)) {
            return v;
        }
    }
    return end;
}

/// Adds the integral over the tetrahedron (center, a, b, c) of sixfold signed volume `volume`.
#[cfg_attr(opencl, outline)]
fn add_quadrature<S: IntegralStore>(s: &S, volume: Real, a: V3, b: V3, c: V3, center: V3, sum: &mut Wide) {
    if volume == 0.0 {
        return;
    }
    let mut mean: Wide = Wide { hi: 0.0, lo: 0.0 };
    for q in 0..s.nodes() {
        let node: Node = s.node(q);
        let way: V3 = add(add(scale(node.place.x, a), scale(node.place.y, b)), scale(node.place.z, c));
        add_compensated(node.weight * s.function(add(center, way)), &mut mean);
    }
    add_compensated(volume * (mean.hi + mean.lo), sum);
}

/// Adds `x`, and what rounding loses of it apart.
#[inline(always)]
fn add_compensated(x: Real, sum: &mut Wide) {
    let added: Wide = sum_exact(sum.hi, x);
    sum.hi = added.hi;
    sum.lo = sum.lo + added.lo;
}

/// The store's polynomial at `x`, in the frame of the site: by Horner's scheme, in the order of `FramedIntegrand::coefficients`.
#[cfg_attr(opencl, outline)]
pub(crate) fn polynomial<S: IntegralStore>(s: &S, x: V3) -> Real {
    let degree: u32 = s.degree();
    let y: V3 = add(sub(s.site(), s.origin()), x);
    let mut in_x: Real = 0.0;
    let mut next: u32 = 0;
    let mut i: u32 = 0;
    while i <= degree {
        let mut in_y: Real = 0.0;
        let mut j: u32 = 0;
        while j <= i {
            let mut in_z: Real = 0.0;
            let mut k: u32 = 0;
            while k <= j {
                in_z = (in_z * y.z) + s.coefficient(next);
                next += 1;
                k += 1;
            }
            in_y = (in_y * y.y) + in_z;
            j += 1;
        }
        in_x = (in_x * y.x) + in_y;
        i += 1;
    }
    return in_x;
}
