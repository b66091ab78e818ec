//! What bounds the sites of a node of the tree: a box, a slab across their thinnest direction, and their weights by a polynomial.
//!
//! Directions and slopes are those of a sample of the sites: any give a true bound. What the bound then has to hold is found from the sites where
//! the sample is all of them (a leaf's have too few for a curvature: they are tried with that of their block), and else from the bounds of the nodes two levels below, so that a tree's cost is that of its sites. (From those one level
//! below, cells of the vertices of a scanned surface took 20 % more time on the CPU.)

use super::quadratic::{FEW_ROUNDINGS_OF_SUM, add_least};
use super::search_store::{NodeBox, NodeSlab, NodeWeights};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, larger, norm_1, scale, smaller, sub, v3};

/// Sites of a sample, at most.
pub const MOST_SAMPLED: u32 = 64;

/// Sites from which on an affine, and a quadratic bound of weights are tried.
const ENOUGH_FOR_SLOPE: u32 = 6;
const ENOUGH_FOR_CURVATURE: u32 = 16;

/// A bound of higher degree is taken where it leaves less than this share of the range of weights.
const WORTH_A_DEGREE: Real = 0.6;

/// What is added to the diagonal of the normal equations for slopes and curvatures, as a share: flat sets of sites leave them open.
const RIDGE_SHARE: Real = 1e-9;

/// Squarings of the matrix for the thinnest direction: any direction gives a true slab, a better one a thinner.
const SQUARINGS: u32 = 5;

/// The least that a width is taken for, and what no number of a bound exceeds.
const LEAST_WIDTH: Real = 1e-300;
const LARGEST: Real = 1e300;

/// Coefficients of an affine function, and of a quadratic one.
const AFFINE: u32 = 4;
const QUADRATIC: u32 = 7;

/// A node: its sites, or a sample of them and the nodes that it is made of.
pub trait NodeSource {
    /// Number of sampled sites, one at least and [`MOST_SAMPLED`] at most.
    fn sampled(&self) -> u32;
    /// The place of one.
    fn sampled_place(&self, i: u32) -> V3;
    /// What it weighs more than the lightest site of all.
    fn sampled_weight(&self, i: u32) -> Real;
    /// Number of these nodes, of the second level below; 0 where all sites are sampled.
    fn parts(&self) -> u32;
    /// The box of one.
    fn part_box(&self, i: u32) -> NodeBox;
    /// Its slab.
    fn part_slab(&self, i: u32) -> NodeSlab;
    /// What bounds its weights.
    fn part_weights(&self, i: u32) -> NodeWeights;
    /// The curvature of what bounds the weights of the node above, for a leaf; else 0.
    fn curvature_above(&self) -> V3;
}

#[inline(always)]
fn least_corner(a: V3, b: V3) -> V3 {
    return v3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z));
}

#[inline(always)]
fn largest_corner(a: V3, b: V3) -> V3 {
    return v3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z));
}

/// The box of a node's sites.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn box_of_node<S: NodeSource>(s: &S) -> NodeBox {
    let mut bounds: NodeBox = NodeBox { lo: s.sampled_place(0), hi: s.sampled_place(0) };
    let mut i: u32 = 1;
    while (s.parts() == 0) && (i < s.sampled()) {
        bounds.lo = least_corner(bounds.lo, s.sampled_place(i));
        bounds.hi = largest_corner(bounds.hi, s.sampled_place(i));
        i += 1;
    }
    for i in 0..s.parts() {
        let its: NodeBox = s.part_box(i);
        bounds.lo = least_corner(bounds.lo, its.lo);
        bounds.hi = largest_corner(bounds.hi, its.hi);
    }
    return bounds;
}

/// A symmetric matrix.
#[repr(C)]
#[derive(Clone, Copy)]
struct Symmetric {
    xx: Real,
    yy: Real,
    zz: Real,
    xy: Real,
    yz: Real,
    zx: Real,
}

#[inline(always)]
fn square_of_matrix(m: Symmetric) -> Symmetric {
    return Symmetric {
        xx: ((m.xx * m.xx) + (m.xy * m.xy)) + (m.zx * m.zx),
        yy: ((m.xy * m.xy) + (m.yy * m.yy)) + (m.yz * m.yz),
        zz: ((m.zx * m.zx) + (m.yz * m.yz)) + (m.zz * m.zz),
        xy: ((m.xx * m.xy) + (m.xy * m.yy)) + (m.zx * m.yz),
        yz: ((m.xy * m.zx) + (m.yy * m.yz)) + (m.yz * m.zz),
        zx: ((m.zx * m.xx) + (m.yz * m.xy)) + (m.zz * m.zx),
    };
}

/// A unit vector across the thinnest direction of the sampled sites: the longest of what their spread leaves of its trace, where the powers of that
/// matrix lead.
#[inline]
#[cfg_attr(opencl, hot)]
fn thinnest_direction<S: NodeSource>(s: &S) -> V3 {
    let count: u32 = s.sampled();
    let mut mean: V3 = v3(0.0, 0.0, 0.0);
    for i in 0..count {
        mean = add(mean, s.sampled_place(i));
    }
    mean = scale(1.0 / (count as Real), mean);
    let mut spread: Symmetric = Symmetric { xx: 0.0, yy: 0.0, zz: 0.0, xy: 0.0, yz: 0.0, zx: 0.0 };
    for i in 0..count {
        let d: V3 = sub(s.sampled_place(i), mean);
        spread.xx += d.x * d.x;
        spread.yy += d.y * d.y;
        spread.zz += d.z * d.z;
        spread.xy += d.x * d.y;
        spread.yz += d.y * d.z;
        spread.zx += d.z * d.x;
    }
    let mut power: Symmetric = Symmetric {
        xx: spread.yy + spread.zz,
        yy: spread.zz + spread.xx,
        zz: spread.xx + spread.yy,
        xy: -spread.xy,
        yz: -spread.yz,
        zx: -spread.zx,
    };
    for _turn in 0..SQUARINGS {
        let unit: Real = 1.0 / ((power.xx + power.yy) + power.zz);
        power = square_of_matrix(Symmetric {
            xx: power.xx * unit,
            yy: power.yy * unit,
            zz: power.zz * unit,
            xy: power.xy * unit,
            yz: power.yz * unit,
            zx: power.zx * unit,
        });
    }
    let along: V3 = v3(
        ((power.xx * 0.577) + (power.xy * 0.5771)) + (power.zx * 0.5772),
        ((power.xy * 0.577) + (power.yy * 0.5771)) + (power.yz * 0.5772),
        ((power.zx * 0.577) + (power.yz * 0.5771)) + (power.zz * 0.5772),
    );
    let length: Real = dot(along, along).sqrt();
    // (Not a number where the sites are one.)
    if (length > 0.0) && (length < LARGEST) {
        return scale(1.0 / length, along);
    }
    return v3(1.0, 0.0, 0.0);
}

/// The largest `n·x` of a box.
#[inline(always)]
fn largest_along(bounds: NodeBox, n: V3) -> Real {
    return (larger(n.x * bounds.lo.x, n.x * bounds.hi.x) + larger(n.y * bounds.lo.y, n.y * bounds.hi.y))
        + larger(n.z * bounds.lo.z, n.z * bounds.hi.z);
}

/// A slab that holds a node's sites, whose box is known.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn slab_of_node<S: NodeSource>(s: &S, bounds: NodeBox) -> NodeSlab {
    let normal: V3 = thinnest_direction(s);
    let mut slab: NodeSlab = NodeSlab { normal: normal, lo: LARGEST, hi: -LARGEST, largest: 0.0 };
    let mut i: u32 = 0;
    while (s.parts() == 0) && (i < s.sampled()) {
        let height: Real = dot(normal, s.sampled_place(i));
        slab.lo = smaller(slab.lo, height);
        slab.hi = larger(slab.hi, height);
        slab.largest = larger(slab.largest, s.sampled_weight(i));
        i += 1;
    }
    for i in 0..s.parts() {
        // By its box alone, or by its slab and what the box has across the slab's normal.
        let its: NodeSlab = s.part_slab(i);
        let its_box: NodeBox = s.part_box(i);
        let share: Real = dot(normal, its.normal);
        let rest: V3 = sub(normal, scale(share, its.normal));
        let top: Real = larger(share * its.lo, share * its.hi) + largest_along(its_box, rest);
        let bottom: Real = smaller(share * its.lo, share * its.hi) - largest_along(its_box, scale(-1.0, rest));
        slab.hi = larger(slab.hi, smaller(top, largest_along(its_box, normal)));
        slab.lo = smaller(slab.lo, larger(bottom, -largest_along(its_box, scale(-1.0, normal))));
        slab.largest = larger(slab.largest, its.largest);
    }
    let farthest: V3 = v3(
        larger(bounds.lo.x.abs(), bounds.hi.x.abs()),
        larger(bounds.lo.y.abs(), bounds.hi.y.abs()),
        larger(bounds.lo.z.abs(), bounds.hi.z.abs()),
    );
    let outward: Real = FEW_ROUNDINGS_OF_SUM * norm_1(farthest);
    slab.lo = slab.lo - outward;
    slab.hi = slab.hi + outward;
    return slab;
}

/// Normal equations of a quadratic function. (All loops over them are of a fixed length, so that they stay in registers on devices: with lengths that vary a tree over a million weighted sites took
/// 3.5 ms, and without weights 0.9; one NVIDIA H200.)
#[repr(C)]
#[derive(Clone, Copy)]
struct Equations {
    matrix: [Real; 49],
    right: [Real; 7],
}

/// What a polynomial leaves of the sampled weights: the range.
#[repr(C)]
#[derive(Clone, Copy)]
struct Rest {
    top: Real,
    bottom: Real,
}

/// A polynomial without its constant at the way `u` from where it is about.
#[inline(always)]
fn rise(w: NodeWeights, u: V3) -> Real {
    return (((w.slope.x + (w.curvature.x * u.x)) * u.x) + ((w.slope.y + (w.curvature.y * u.y)) * u.y))
        + ((w.slope.z + (w.curvature.z * u.z)) * u.z);
}

#[inline]
#[cfg_attr(opencl, hot)]
fn rest_of_sampled<S: NodeSource>(s: &S, middle: V3, w: NodeWeights) -> Rest {
    let mut rest: Rest = Rest { top: -LARGEST, bottom: LARGEST };
    for i in 0..s.sampled() {
        let its: Real = s.sampled_weight(i) - rise(w, sub(s.sampled_place(i), middle));
        rest.top = larger(rest.top, its);
        rest.bottom = smaller(rest.bottom, its);
    }
    return rest;
}

/// The normal equations of what fits the sampled weights best, less a given curvature.
#[inline(always)]
fn equations_of_sampled<S: NodeSource>(s: &S, middle: V3, width: Real, base: Real, curvature: V3) -> Equations {
    let mut e: Equations = Equations { matrix: [0.0; 49], right: [0.0; 7] };
    for i in 0..s.sampled() {
        let way: V3 = sub(s.sampled_place(i), middle);
        let u: V3 = scale(1.0 / width, way);
        let curved: V3 = v3(curvature.x * way.x, curvature.y * way.y, curvature.z * way.z);
        let w: Real = (s.sampled_weight(i) - base) - dot(curved, way);
        let mut terms: [Real; 7] = [0.0; 7];
        terms[0] = 1.0;
        terms[1] = u.x;
        terms[2] = u.y;
        terms[3] = u.z;
        terms[4] = u.x * u.x;
        terms[5] = u.y * u.y;
        terms[6] = u.z * u.z;
        #[cfg_attr(opencl, unrolled)]
        for row in 0..QUADRATIC {
            #[cfg_attr(opencl, unrolled)]
            for column in 0..QUADRATIC {
                if column >= row {
                    e.matrix[((row * QUADRATIC) + column) as usize] += terms[row as usize] * terms[column as usize];
                }
            }
            e.right[row as usize] += terms[row as usize] * w;
        }
    }
    return e;
}

/// The polynomial of so many coefficients, and where these are but a slope of a given curvature, that fits the sampled weights best, without its constant; all 0 where
/// there is none.
#[inline]
#[cfg_attr(opencl, hot)]
fn fit_of_sampled<S: NodeSource>(
    s: &S,
    middle: V3,
    width: Real,
    base: Real,
    unknowns: u32,
    curvature: V3,
) -> NodeWeights {
    let mut e: Equations = equations_of_sampled(s, middle, width, base, curvature);
    let ridge: Real = RIDGE_SHARE * (s.sampled() as Real);
    #[cfg_attr(opencl, unrolled)]
    for row in 0..QUADRATIC {
        if row > 0 {
            e.matrix[((row * QUADRATIC) + row) as usize] += ridge;
        }
        // (Coefficients that are not asked for are 0.)
        if row >= unknowns {
            e.matrix[((row * QUADRATIC) + row) as usize] = 1.0;
            e.right[row as usize] = 0.0;
        }
        #[cfg_attr(opencl, unrolled)]
        for column in 0..QUADRATIC {
            if column > row {
                if column >= unknowns {
                    e.matrix[((row * QUADRATIC) + column) as usize] = 0.0;
                }
                e.matrix[((column * QUADRATIC) + row) as usize] = e.matrix[((row * QUADRATIC) + column) as usize];
            }
        }
    }
    // Gauss–Jordan; positive definite, so that no pivot is sought.
    #[cfg_attr(opencl, unrolled)]
    for pivot in 0..QUADRATIC {
        let inverse: Real = 1.0 / e.matrix[((pivot * QUADRATIC) + pivot) as usize];
        #[cfg_attr(opencl, unrolled)]
        for row in 0..QUADRATIC {
            if row != pivot {
                let share: Real = e.matrix[((row * QUADRATIC) + pivot) as usize] * inverse;
                #[cfg_attr(opencl, unrolled)]
                for column in 0..QUADRATIC {
                    if column >= pivot {
                        e.matrix[((row * QUADRATIC) + column) as usize] -=
                            share * e.matrix[((pivot * QUADRATIC) + column) as usize];
                    }
                }
                e.right[row as usize] -= share * e.right[pivot as usize];
            }
        }
    }
    let mut largest: Real = 0.0;
    #[cfg_attr(opencl, unrolled)]
    for row in 0..QUADRATIC {
        e.right[row as usize] = e.right[row as usize] / (e.matrix[((row * QUADRATIC) + row) as usize] * width);
        if row >= AFFINE {
            e.right[row as usize] = e.right[row as usize] / width;
        }
        // (What is not a number is not below.)
        if !(e.right[row as usize].abs() < LARGEST) {
            largest = LARGEST;
        }
    }
    let mut fit: NodeWeights = NodeWeights { offset: 0.0, slope: v3(0.0, 0.0, 0.0), curvature: v3(0.0, 0.0, 0.0) };
    if largest < LARGEST {
        fit.slope = v3(e.right[1], e.right[2], e.right[3]);
        fit.curvature = curvature;
        if unknowns == QUADRATIC {
            fit.curvature = v3(e.right[4], e.right[5], e.right[6]);
        }
    }
    return fit;
}

/// Adds the largest of a part's bound less the node's, along an axis, to `sum`; `middle` is the node's.
#[inline(always)]
fn add_largest(
    lo: Real,
    hi: Real,
    middle: Real,
    slope: Real,
    curvature: Real,
    its_slope: Real,
    its_curvature: Real,
    sum: &mut Real,
    size: &mut Real,
) {
    let mut least: Real = 0.0;
    add_least(lo, hi, middle, curvature, slope, its_slope, its_curvature, &mut least, size);
    *sum -= least;
}

/// An upper bound of the weights of a node's sites, whose box is known: of least degree that is tighter by enough.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn weights_of_node<S: NodeSource>(s: &S, bounds: NodeBox) -> NodeWeights {
    let middle: V3 = scale(0.5, add(bounds.lo, bounds.hi));
    let halves: V3 = scale(0.5, sub(bounds.hi, bounds.lo));
    let width: Real = larger(larger(larger(halves.x, halves.y), halves.z), LEAST_WIDTH);
    let mut best: NodeWeights = NodeWeights { offset: 0.0, slope: v3(0.0, 0.0, 0.0), curvature: v3(0.0, 0.0, 0.0) };
    let mut rest: Rest = rest_of_sampled(s, middle, best);
    let all: Real = rest.top - rest.bottom;
    let mut range: Real = all;
    // (Of weights that are large and differ by little, the ridge would leave more than they differ by.)
    let base: Real = 0.5 * (rest.top + rest.bottom);
    let mut degree: u32 = 1;
    while (degree <= 2) && ((all > 0.0) && (s.sampled() >= ENOUGH_FOR_SLOPE)) {
        let mut unknowns: u32 = AFFINE;
        let mut curvature: V3 = v3(0.0, 0.0, 0.0);
        if degree == 2 {
            if s.sampled() >= ENOUGH_FOR_CURVATURE {
                unknowns = QUADRATIC;
            } else {
                curvature = s.curvature_above();
            }
        }
        if (degree == 1) || ((unknowns == QUADRATIC) || (norm_1(curvature) > 0.0)) {
            let fit: NodeWeights = fit_of_sampled(s, middle, width, base, unknowns, curvature);
            let left: Rest = rest_of_sampled(s, middle, fit);
            if (left.top - left.bottom) < (WORTH_A_DEGREE * range) {
                rest = left;
                range = left.top - left.bottom;
                best = fit;
            }
        }
        degree += 1;
    }
    let mut top: Real = rest.top;
    let mut size: Real = 0.0;
    let mut i: u32 = 0;
    while (s.parts() == 0) && (i < s.sampled()) {
        size = larger(size, s.sampled_weight(i));
        i += 1;
    }
    if s.parts() > 0 {
        top = -LARGEST;
    }
    while i < s.parts() {
        let its: NodeWeights = s.part_weights(i);
        let its_box: NodeBox = s.part_box(i);
        let lo: V3 = its_box.lo;
        let hi: V3 = its_box.hi;
        let mut its_top: Real = its.offset;
        let mut its_size: Real = its.offset.abs();
        add_largest(
            lo.x,
            hi.x,
            middle.x,
            best.slope.x,
            best.curvature.x,
            its.slope.x,
            its.curvature.x,
            &mut its_top,
            &mut its_size,
        );
        add_largest(
            lo.y,
            hi.y,
            middle.y,
            best.slope.y,
            best.curvature.y,
            its.slope.y,
            its.curvature.y,
            &mut its_top,
            &mut its_size,
        );
        add_largest(
            lo.z,
            hi.z,
            middle.z,
            best.slope.z,
            best.curvature.z,
            its.slope.z,
            its.curvature.z,
            &mut its_top,
            &mut its_size,
        );
        top = larger(top, its_top);
        size = larger(size, its_size);
        i += 1;
    }
    // The middle is rounded, here and where the bound is evaluated.
    let steep: V3 = v3(
        best.slope.x.abs() + (2.0 * (best.curvature.x.abs() * halves.x)),
        best.slope.y.abs() + (2.0 * (best.curvature.y.abs() * halves.y)),
        best.slope.z.abs() + (2.0 * (best.curvature.z.abs() * halves.z)),
    );
    let off: Real = (4.0 * UNIT_ROUNDOFF)
        * (((steep.x * larger(bounds.lo.x.abs(), bounds.hi.x.abs()))
            + (steep.y * larger(bounds.lo.y.abs(), bounds.hi.y.abs())))
            + (steep.z * larger(bounds.lo.z.abs(), bounds.hi.z.abs())));
    size += (top.abs() + (steep.x * halves.x)) + ((steep.y * halves.y) + (steep.z * halves.z));
    best.offset = (top + (FEW_ROUNDINGS_OF_SUM * size)) + off;
    return best;
}
