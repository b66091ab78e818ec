//! The wider stage of the signs: double-double arithmetic, about 104 bits, which decides nearly all that floating point
//! leaves open. Products are split by Dekker's method, so that no fused operation is needed on the host.

use super::expansion::expansion_sign;
use super::plane::Plane;
use super::status::{COMPLETE, SIGN_UNKNOWN, UNCERTAIN};
use super::store::SignStore;
use super::vector::{Real, UNIT_ROUNDOFF, V3, norm_1, norm_max, v3};
use super::vertex::{ROUNDINGS_OF_EXACT, Triplet};

/// An unevaluated sum `hi + lo`, `|lo| ≤ u|hi|`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wide {
    /// The sum, rounded.
    pub(crate) hi: Real,
    /// What is left of it.
    pub(crate) lo: Real,
}

/// Dekker's constant 2²⁷ + 1: halves of 26 bits. In single precision 2¹² + 1: of 12.
#[cfg_attr(opencl, single(4097.0))]
const SPLITTER: Real = 134217729.0;

/// Error of the whole determinant in units of its sum of magnitudes: each minor, product and sum errs by at most 2⁻¹⁰²
/// of the magnitudes it adds; a term passes through two minors, one product and five sums.
/// In single precision as many squares of the unit roundoff.
#[cfg_attr(opencl, single(4.547473508864641e-13))]
const WIDE_ERROR: Real = 1.5777218104420236e-30;

/// Below this the error terms of the products could underflow.
///
/// In single precision, with normals below 2²⁰ and offsets below 2⁴⁰ (`single.cl`), minors are below 2⁶¹, and what underflows is below
/// 12 · 2⁶¹ · 2⁻¹²³: less than `WIDE_ERROR` of this.
#[cfg_attr(opencl, single(1.52587890625e-5))]
const WIDE_SMALLEST: Real = 1e-260;

/// Below this share of `‖n_a‖₁‖n_b‖₁‖n_c‖₁` of the determinant the normals of three planes count as dependent, and the position is computed
/// exactly: double-double is off by `WIDE_ERROR` over the share, here by u/8.
///
/// In single precision `NEARLY_DEPENDENT` of vertex.rs: there double-double has no more to give.
#[cfg_attr(opencl, single(3.0517578125e-5))]
const DEPENDENT: Real = 1.1368683772161603e-13;

/// The sign of the 4×4 determinant of `[n | d]` of the planes of vertex `v` and of plane `k`: −1, 0 or 1, or `SIGN_UNKNOWN`
/// where no stage of the store can decide it. Negative: the vertex is in conflict with `k`. Five stages: integers, where
/// coefficients have few digits, double-double, integers that wrap, expansions, and the store's own.
#[cfg_attr(opencl, outline)]
pub(crate) fn sign_of_conflict<S: SignStore>(s: &mut S, v: u32, k: u32) -> i32 {
    let t: Triplet = s.triplet(v);
    let a: Plane = s.plane(t.a);
    let b: Plane = s.plane(t.b);
    let c: Plane = s.plane(t.c);
    let e: Plane = s.plane(k);
    let mut sign: i32 = s.narrow_sign(t, v, k);
    if sign != SIGN_UNKNOWN {
        // (Of the others double-double would have told almost all.)
        if sign == 0 {
            s.note_exact();
        }
        return sign;
    }
    if s.keeps_minors() {
        let mut minors: Minors = s.minors(v);
        if minors.is_known == 0 {
            minors = minors_of(a, b, c);
            s.keep_minors(v, minors);
        }
        sign = sign_by_minors(minors, e);
    } else {
        sign = wide_sign(a, b, c, e);
    }
    if sign != SIGN_UNKNOWN {
        return sign;
    }
    s.note_exact();
    sign = s.tie_sign(t, k);
    if sign != SIGN_UNKNOWN {
        return sign;
    }
    sign = expansion_sign(a, b, c, e);
    if sign != SIGN_UNKNOWN {
        return sign;
    }
    return s.exact_sign(t, k);
}

/// The 3×3 minors of `[n | d]` of three planes without its column x, y, z or d, and the magnitudes that they are sums of.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Minors {
    x: Wide,
    y: Wide,
    z: Wide,
    d: Wide,
    size: Plane,
    /// 0 where there are none.
    is_known: u32,
}

/// The minors of three planes.
#[cfg_attr(opencl, outline)]
pub(super) fn minors_of(a: Plane, b: Plane, c: Plane) -> Minors {
    // Of columns z and d, and of x and y.
    let zd: Wide3 =
        Wide3 { x: minor(b.n.z, b.d, c.n.z, c.d), y: minor(c.n.z, c.d, a.n.z, a.d), z: minor(a.n.z, a.d, b.n.z, b.d) };
    let xy: Wide3 = Wide3 {
        x: minor(b.n.x, b.n.y, c.n.x, c.n.y),
        y: minor(c.n.x, c.n.y, a.n.x, a.n.y),
        z: minor(a.n.x, a.n.y, b.n.x, b.n.y),
    };
    let zd_size: V3 = v3(
        (b.n.z * c.d).abs() + (c.n.z * b.d).abs(),
        (c.n.z * a.d).abs() + (a.n.z * c.d).abs(),
        (a.n.z * b.d).abs() + (b.n.z * a.d).abs(),
    );
    let xy_size: V3 = v3(
        (b.n.x * c.n.y).abs() + (c.n.x * b.n.y).abs(),
        (c.n.x * a.n.y).abs() + (a.n.x * c.n.y).abs(),
        (a.n.x * b.n.y).abs() + (b.n.x * a.n.y).abs(),
    );
    return Minors {
        x: wide_dot(zd, v3(a.n.y, b.n.y, c.n.y)),
        y: wide_dot(zd, v3(a.n.x, b.n.x, c.n.x)),
        z: wide_dot(xy, v3(a.d, b.d, c.d)),
        d: wide_dot(xy, v3(a.n.z, b.n.z, c.n.z)),
        size: Plane {
            n: v3(
                ((a.n.y.abs() * zd_size.x) + (b.n.y.abs() * zd_size.y)) + (c.n.y.abs() * zd_size.z),
                ((a.n.x.abs() * zd_size.x) + (b.n.x.abs() * zd_size.y)) + (c.n.x.abs() * zd_size.z),
                ((a.d.abs() * xy_size.x) + (b.d.abs() * xy_size.y)) + (c.d.abs() * xy_size.z),
            ),
            d: ((a.n.z.abs() * xy_size.x) + (b.n.z.abs() * xy_size.y)) + (c.n.z.abs() * xy_size.z),
        },
        is_known: 1,
    };
}

/// The sign of `det [n|d](a, b, c, e)` by the minors of a, b and c: `e_y M_y − e_x M_x + d M_d − e_z M_z`; or `SIGN_UNKNOWN`. A term passes through
/// one minor, two products and four sums: less than in `wide_sign`.
#[cfg_attr(opencl, outline)]
pub(super) fn sign_by_minors(minors: Minors, e: Plane) -> i32 {
    let first: Wide = wide_add(wide_scaled(minors.y, e.n.y), wide_scaled(minors.x, -e.n.x));
    let second: Wide = wide_add(wide_scaled(minors.d, e.d), wide_scaled(minors.z, -e.n.z));
    let sum: Wide = wide_add(first, second);
    let size: Real = ((minors.size.n.y * e.n.y.abs()) + (minors.size.n.x * e.n.x.abs()))
        + ((minors.size.d * e.d.abs()) + (minors.size.n.z * e.n.z.abs()));
    return sign_beyond(sum, size);
}

/// The sign of a determinant whose magnitudes sum to `size`, or `SIGN_UNKNOWN`.
#[inline(always)]
fn sign_beyond(sum: Wide, size: Real) -> i32 {
    if (size < WIDE_SMALLEST) || !(sum.hi.abs() > (WIDE_ERROR * size)) {
        return SIGN_UNKNOWN;
    }
    if sum.hi < 0.0 {
        return -1;
    }
    return 1;
}

/// The sign of `det [n|d](a, b, c, e)` by double-double arithmetic, or `SIGN_UNKNOWN`.
#[cfg_attr(opencl, outline)]
pub(super) fn wide_sign(a: Plane, b: Plane, c: Plane, e: Plane) -> i32 {
    // Laplace expansion along the first two columns: x, y against z, d.
    let mut sum: Wide = Wide { hi: 0.0, lo: 0.0 };
    let mut size: Real = 0.0;
    add_term(&mut sum, &mut size, a.n.x, a.n.y, b.n.x, b.n.y, c.n.z, c.d, e.n.z, e.d, 1.0);
    add_term(&mut sum, &mut size, a.n.x, a.n.y, c.n.x, c.n.y, b.n.z, b.d, e.n.z, e.d, -1.0);
    add_term(&mut sum, &mut size, a.n.x, a.n.y, e.n.x, e.n.y, b.n.z, b.d, c.n.z, c.d, 1.0);
    add_term(&mut sum, &mut size, b.n.x, b.n.y, c.n.x, c.n.y, a.n.z, a.d, e.n.z, e.d, 1.0);
    add_term(&mut sum, &mut size, b.n.x, b.n.y, e.n.x, e.n.y, a.n.z, a.d, c.n.z, c.d, -1.0);
    add_term(&mut sum, &mut size, c.n.x, c.n.y, e.n.x, e.n.y, a.n.z, a.d, b.n.z, b.d, 1.0);
    return sign_beyond(sum, size);
}

/// Adds `sign·(x_0 y_1 − x_1 y_0)·(z_2 w_3 − z_3 w_2)` to `sum`, and the magnitude of its parts to `size`.
#[inline(always)]
pub(super) fn add_term(
    sum: &mut Wide,
    size: &mut Real,
    x0: Real,
    y0: Real,
    x1: Real,
    y1: Real,
    z2: Real,
    w2: Real,
    z3: Real,
    w3: Real,
    sign: Real,
) {
    let left: Wide = minor(x0, y0, x1, y1);
    let right: Wide = minor(z2, w2, z3, w3);
    let product: Wide = multiply(left, right);
    let scaled: Wide = Wide { hi: sign * product.hi, lo: sign * product.lo };
    *sum = wide_add(*sum, scaled);
    let left_size: Real = (x0 * y1).abs() + (x1 * y0).abs();
    let right_size: Real = (z2 * w3).abs() + (z3 * w2).abs();
    *size = *size + (left_size * right_size);
}

/// `x_0 y_1 − x_1 y_0`.
#[inline(always)]
pub(super) fn minor(x0: Real, y0: Real, x1: Real, y1: Real) -> Wide {
    let p: Wide = product_exact(x0, y1);
    let q: Wide = product_exact(x1, y0);
    let negated: Wide = Wide { hi: -q.hi, lo: -q.lo };
    return wide_add(p, negated);
}

/// `a·b`, exactly.
#[inline(always)]
pub(crate) fn product_exact(a: Real, b: Real) -> Wide {
    let p: Real = a * b;
    return Wide { hi: p, lo: rest_of_product(a, b) };
}

/// What rounding leaves out of the product `a·b`.
///
/// On devices one operation instead of sixteen, and the same bits.
#[cfg_attr(opencl, returns("fma(a, b, -(a * b))"))]
#[inline(always)]
pub(super) fn rest_of_product(a: Real, b: Real) -> Real {
    let p: Real = a * b;
    let ta: Real = SPLITTER * a;
    let a_hi: Real = ta - (ta - a);
    let a_lo: Real = a - a_hi;
    let tb: Real = SPLITTER * b;
    let b_hi: Real = tb - (tb - b);
    let b_lo: Real = b - b_hi;
    return ((((a_hi * b_hi) - p) + (a_hi * b_lo)) + (a_lo * b_hi)) + (a_lo * b_lo);
}

/// `a + b`, both halves exactly, then rounded to double-double.
#[inline(always)]
pub(crate) fn wide_add(a: Wide, b: Wide) -> Wide {
    let high: Wide = sum_exact(a.hi, b.hi);
    let low: Wide = sum_exact(a.lo, b.lo);
    let first: Wide = sum_exact(high.hi, high.lo + low.hi);
    return sum_exact(first.hi, first.lo + low.lo);
}

/// `a·b`.
#[inline(always)]
pub(super) fn multiply(a: Wide, b: Wide) -> Wide {
    let p: Wide = product_exact(a.hi, b.hi);
    let rest: Real = p.lo + ((a.hi * b.lo) + (a.lo * b.hi));
    return sum_exact(p.hi, rest);
}

/// `a + b`, exactly.
#[inline(always)]
pub(crate) fn sum_exact(a: Real, b: Real) -> Wide {
    let s: Real = a + b;
    let t: Real = s - a;
    let error: Real = (a - (s - t)) + (b - t);
    return Wide { hi: s, lo: error };
}

/// `a/b`, rounded to one number: within a rounding and a little of the exact quotient.
#[cfg_attr(opencl, outline)]
pub(crate) fn wide_quotient(a: Wide, b: Wide) -> Real {
    let first: Real = a.hi / b.hi;
    let product: Wide = multiply(Wide { hi: first, lo: 0.0 }, b);
    let rest: Wide = wide_add(a, Wide { hi: -product.hi, lo: -product.lo });
    return first + (rest.hi / b.hi);
}

/// The position of the vertex of three planes by Cramer's rule in double-double, and its error radius; `UNCERTAIN` where their normals are dependent.
#[cfg_attr(opencl, outline)]
pub(crate) fn wide_position(a: Plane, b: Plane, c: Plane, position: &mut V3, radius: &mut Real) -> u32 {
    let size_a: Real = norm_1(a.n);
    let size_b: Real = norm_1(b.n);
    let size_c: Real = norm_1(c.n);
    let size: Real = (size_a * size_b) * size_c;
    let x: Wide3 = wide_cross(b.n, c.n);
    let y: Wide3 = wide_cross(c.n, a.n);
    let z: Wide3 = wide_cross(a.n, b.n);
    let det: Wide = wide_dot(x, a.n);
    if !(size > WIDE_SMALLEST) || !(det.hi > (DEPENDENT * size)) {
        return UNCERTAIN;
    }
    *position = v3(
        wide_quotient(wide_combine(x.x, y.x, z.x, a.d, b.d, c.d), det),
        wide_quotient(wide_combine(x.y, y.y, z.y, a.d, b.d, c.d), det),
        wide_quotient(wide_combine(x.z, y.z, z.z, a.d, b.d, c.d), det),
    );
    let offsets: Real =
        (((a.d.abs() * size_b) * size_c) + ((b.d.abs() * size_c) * size_a)) + ((c.d.abs() * size_a) * size_b);
    let largest: Real = norm_max(*position);
    *radius = ((ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * largest) + ((WIDE_ERROR / det.hi) * (offsets + (largest * size)));
    return COMPLETE;
}

/// A vector in double-double.
#[repr(C)]
#[derive(Clone, Copy)]
struct Wide3 {
    x: Wide,
    y: Wide,
    z: Wide,
}

#[inline(always)]
fn wide_cross(p: V3, q: V3) -> Wide3 {
    return Wide3 { x: minor(p.y, p.z, q.y, q.z), y: minor(p.z, p.x, q.z, q.x), z: minor(p.x, p.y, q.x, q.y) };
}

/// `a·b` for a vector b of numbers.
#[inline(always)]
fn wide_dot(a: Wide3, b: V3) -> Wide {
    return wide_add(wide_add(wide_scaled(a.x, b.x), wide_scaled(a.y, b.y)), wide_scaled(a.z, b.z));
}

#[inline(always)]
fn wide_scaled(a: Wide, by: Real) -> Wide {
    return multiply(a, Wide { hi: by, lo: 0.0 });
}

/// `−(a x + b y + c z)`.
#[inline(always)]
fn wide_combine(x: Wide, y: Wide, z: Wide, a: Real, b: Real, c: Real) -> Wide {
    return wide_add(wide_add(wide_scaled(x, -a), wide_scaled(y, -b)), wide_scaled(z, -c));
}
