//! The exact stage: sums of floating-point numbers held exactly as expansions (Shewchuk 1997), for signs that double-double
//! leaves open, such as those that are zero, and for vertices of nearly dependent planes.

use super::plane::Plane;
use super::status::{COMPLETE, SIGN_UNKNOWN, UNCERTAIN};
use super::vector::{Real, V3, v3};
use super::wide::{Wide, product_exact, sum_exact, wide_quotient};

/// A number as the sum of its terms: nonoverlapping, none of them zero, in order of magnitude. A 4×4 determinant adds at most
/// 192 numbers, and each adds at most one term.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Expansion {
    pub(super) terms: [Real; 192],
    pub(super) count: u32,
}

/// Inputs smaller than this (but for zero) are left to integers: below it the last bit of a product of four, 4·(52 + 200) bits
/// down, could underflow.
///
/// In single precision 4·(23 + 8) bits are above 2⁻¹²⁶.
#[cfg_attr(opencl, single(0.00390625))]
const EXPANSION_SMALLEST: Real = 1e-60;

/// The sign of the 4×4 determinant with rows `[n | d]`, exactly, or `SIGN_UNKNOWN` where a product could underflow.
#[cfg_attr(opencl, outline)]
pub(crate) fn expansion_sign(a: Plane, b: Plane, c: Plane, e: Plane) -> i32 {
    if ((is_tiny(a) || is_tiny(b)) || is_tiny(c)) || is_tiny(e) {
        return SIGN_UNKNOWN;
    }
    let mut sum: Expansion = Expansion { terms: [0.0; 192], count: 0 };
    // Laplace expansion along the first two columns, as in the wide stage.
    add_minors(&mut sum, a.n.x, a.n.y, b.n.x, b.n.y, c.n.z, c.d, e.n.z, e.d);
    add_minors(&mut sum, c.n.x, c.n.y, a.n.x, a.n.y, b.n.z, b.d, e.n.z, e.d);
    add_minors(&mut sum, a.n.x, a.n.y, e.n.x, e.n.y, b.n.z, b.d, c.n.z, c.d);
    add_minors(&mut sum, b.n.x, b.n.y, c.n.x, c.n.y, a.n.z, a.d, e.n.z, e.d);
    add_minors(&mut sum, e.n.x, e.n.y, b.n.x, b.n.y, a.n.z, a.d, c.n.z, c.d);
    add_minors(&mut sum, c.n.x, c.n.y, e.n.x, e.n.y, a.n.z, a.d, b.n.z, b.d);
    let value: Wide = value_of(&mut sum);
    if value.hi > 0.0 {
        return 1;
    }
    if value.hi < 0.0 {
        return -1;
    }
    return 0;
}

/// The point where three planes meet, each component within a rounding of the exact one: quotients of determinants (Cramer),
/// each exact before it is rounded. `UNCERTAIN` where a product could underflow, or the normals are dependent.
#[cfg_attr(opencl, outline)]
pub(crate) fn expansion_position(a: Plane, b: Plane, c: Plane, position: &mut V3) -> u32 {
    if (is_tiny(a) || is_tiny(b)) || is_tiny(c) {
        return UNCERTAIN;
    }
    let det: Wide = determinant(a.n, b.n, c.n);
    if det.hi == 0.0 {
        return UNCERTAIN;
    }
    let x: Wide = determinant(v3(-a.d, a.n.y, a.n.z), v3(-b.d, b.n.y, b.n.z), v3(-c.d, c.n.y, c.n.z));
    let y: Wide = determinant(v3(a.n.x, -a.d, a.n.z), v3(b.n.x, -b.d, b.n.z), v3(c.n.x, -c.d, c.n.z));
    let z: Wide = determinant(v3(a.n.x, a.n.y, -a.d), v3(b.n.x, b.n.y, -b.d), v3(c.n.x, c.n.y, -c.d));
    *position = v3(wide_quotient(x, det), wide_quotient(y, det), wide_quotient(z, det));
    return COMPLETE;
}

/// Whether a coefficient is smaller than `EXPANSION_SMALLEST` and not zero.
#[inline(always)]
pub(super) fn is_tiny(plane: Plane) -> bool {
    if ((is_tiny_number(plane.n.x) + is_tiny_number(plane.n.y)) + (is_tiny_number(plane.n.z) + is_tiny_number(plane.d)))
        != 0
    {
        return true;
    }
    return false;
}

#[inline(always)]
pub(super) fn is_tiny_number(x: Real) -> u32 {
    if (x.abs() < EXPANSION_SMALLEST) && (x != 0.0) {
        return 1;
    }
    return 0;
}

/// Adds `(x_0 y_1 − x_1 y_0)·(z_2 w_3 − z_3 w_2)`.
#[cfg_attr(opencl, outline)]
pub(super) fn add_minors(
    sum: &mut Expansion,
    x0: Real,
    y0: Real,
    x1: Real,
    y1: Real,
    z2: Real,
    w2: Real,
    z3: Real,
    w3: Real,
) {
    let p: Wide = product_exact(x0, y1);
    let q: Wide = product_exact(-x1, y0);
    let r: Wide = product_exact(z2, w3);
    let t: Wide = product_exact(-z3, w2);
    add_four(sum, p, r);
    add_four(sum, p, t);
    add_four(sum, q, r);
    add_four(sum, q, t);
}

/// Adds `p·q`.
#[cfg_attr(opencl, outline)]
pub(super) fn add_four(sum: &mut Expansion, p: Wide, q: Wide) {
    add_product(sum, p.lo, q.lo);
    add_product(sum, p.lo, q.hi);
    add_product(sum, p.hi, q.lo);
    add_product(sum, p.hi, q.hi);
}

/// Adds `x·y`.
#[inline(always)]
pub(super) fn add_product(sum: &mut Expansion, x: Real, y: Real) {
    if (x == 0.0) || (y == 0.0) {
        return;
    }
    let p: Wide = product_exact(x, y);
    add_number(sum, p.lo);
    add_number(sum, p.hi);
}

/// Adds one number: it passes through the terms from the smallest on and leaves each sum's rounding error behind.
#[cfg_attr(opencl, outline)]
pub(super) fn add_number(sum: &mut Expansion, x: Real) {
    let mut carried: Real = x;
    let mut kept: u32 = 0;
    for i in 0..sum.count {
        let next: Wide = sum_exact(carried, sum.terms[i as usize]);
        carried = next.hi;
        if next.lo != 0.0 {
            sum.terms[kept as usize] = next.lo;
            kept += 1;
        }
    }
    if carried != 0.0 {
        sum.terms[kept as usize] = carried;
        kept += 1;
    }
    sum.count = kept;
}

/// The value rounded to double-double; the sign of its `hi` is the sign of the sum.
#[cfg_attr(opencl, outline)]
pub(super) fn value_of(sum: &mut Expansion) -> Wide {
    if sum.count == 0 {
        return Wide { hi: 0.0, lo: 0.0 };
    }
    let last: u32 = sum.count - 1;
    let mut rest: Real = 0.0;
    for i in 0..last {
        rest = rest + sum.terms[i as usize];
    }
    return sum_exact(sum.terms[last as usize], rest);
}

/// `det(a, b, c)`, exactly before it is rounded to double-double.
#[cfg_attr(opencl, outline)]
pub(super) fn determinant(a: V3, b: V3, c: V3) -> Wide {
    let mut sum: Expansion = Expansion { terms: [0.0; 192], count: 0 };
    add_triple(&mut sum, a.x, b.y, c.z);
    add_triple(&mut sum, -a.x, b.z, c.y);
    add_triple(&mut sum, a.y, b.z, c.x);
    add_triple(&mut sum, -a.y, b.x, c.z);
    add_triple(&mut sum, a.z, b.x, c.y);
    add_triple(&mut sum, -a.z, b.y, c.x);
    return value_of(&mut sum);
}

/// Adds `x·y·z`.
#[cfg_attr(opencl, outline)]
pub(super) fn add_triple(sum: &mut Expansion, x: Real, y: Real, z: Real) {
    let p: Wide = product_exact(x, y);
    add_product(sum, p.lo, z);
    add_product(sum, p.hi, z);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact;

    /// Small integers times powers of two, so that ties and zeros are frequent, and last places that only exact arithmetic sees.
    fn numbers(seed: u64) -> impl FnMut() -> Real {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let bits = state >> 33;
            let small = (bits % 5) as Real - 2.0;
            let scale = [1.0, 1.0, 1.0, 0.125, 3e-7, 1.0 + 2.0 * super::super::UNIT_ROUNDOFF];
            small * scale[(bits >> 8) as usize % 6]
        }
    }

    fn plane(next: &mut impl FnMut() -> Real) -> Plane {
        Plane { n: v3(next(), next(), next()), d: next() }
    }

    #[test]
    fn signs_are_those_of_integers() {
        let mut next = numbers(1);
        let mut zeros = 0;
        for _ in 0..20_000 {
            let [a, b, c, e] = [(); 4].map(|()| plane(&mut next));
            let sign = expansion_sign(a, b, c, e);
            assert_eq!(sign, exact::sign_of_planes(a, b, c, e), "{a:?} {b:?} {c:?} {e:?}");
            zeros += u32::from(sign == 0);
        }
        assert!(zeros > 100);
    }

    #[test]
    fn ties_are_those_of_integers() {
        use super::super::wide::wide_sign;
        let mut next = numbers(3);
        let (mut zeros, mut others) = (0, 0);
        for turn in 0..40_000 {
            let [a, b, c] = [(); 3].map(|()| plane(&mut next));
            // A combination of the others is a tie; off by a last place or so, nearly one.
            let mut e = Plane { n: v3(a.n.x + b.n.x, a.n.y + b.n.y, a.n.z + b.n.z), d: a.d + b.d };
            if turn % 2 == 1 {
                e.d *= 1.0 + 1e-16 * (turn % 7) as Real;
                e.n.x += 1e-33 * next();
            }
            let (sign, exact) = (exact::sign_of_tie(a, b, c, e), exact::sign_of_planes(a, b, c, e));
            if wide_sign(a, b, c, e) == SIGN_UNKNOWN && sign != SIGN_UNKNOWN {
                assert_eq!(sign, exact, "{a:?} {b:?} {c:?} {e:?}");
                zeros += u32::from(sign == 0);
                others += u32::from(sign != 0);
            }
        }
        assert!(zeros > 1000 && others > 100, "{zeros} {others}");
    }

    /// Of planes that nearly meet in a point: what double-double says of them, at once or by minors, is so, and both say it of most.
    #[test]
    fn what_double_double_says_is_so() {
        use super::super::wide::{minors_of, sign_by_minors, wide_sign};
        let mut next = numbers(4);
        let (mut at_once, mut by_minors) = (0, 0);
        for turn in 0..40_000 {
            let [a, b, c] = [(); 3].map(|()| plane(&mut next));
            let n = v3(a.n.x + b.n.x - c.n.x, a.n.y + b.n.y - c.n.y, a.n.z + b.n.z - c.n.z);
            let e = Plane { n, d: (a.d + b.d - c.d) * (1.0 + Real::EPSILON * (turn % 5) as Real) };
            let exact = exact::sign_of_planes(a, b, c, e);
            for (sign, said) in
                [(wide_sign(a, b, c, e), &mut at_once), (sign_by_minors(minors_of(a, b, c), e), &mut by_minors)]
            {
                assert!(sign == SIGN_UNKNOWN || sign == exact, "{a:?} {b:?} {c:?} {e:?}");
                *said += u32::from(sign != SIGN_UNKNOWN);
            }
        }
        assert!(at_once > 20_000 && by_minors > 20_000, "{at_once} {by_minors}");
    }

    #[test]
    fn positions_are_those_of_integers() {
        let mut next = numbers(2);
        for _ in 0..20_000 {
            let [a, b, c] = [(); 3].map(|()| plane(&mut next));
            let (mut by_terms, mut by_integers) = (V3::default(), V3::default());
            let status = expansion_position(a, b, c, &mut by_terms);
            assert_eq!(status, exact::position(a, b, c, &mut by_integers), "{a:?} {b:?} {c:?}");
            for (x, y) in [(by_terms.x, by_integers.x), (by_terms.y, by_integers.y), (by_terms.z, by_integers.z)] {
                assert!((x - y).abs() <= 2.0 * super::super::UNIT_ROUNDOFF * y.abs(), "{a:?} {b:?} {c:?}: {x} for {y}");
            }
        }
    }

    #[test]
    fn what_could_underflow_is_left_to_integers() {
        let tiny = Plane { n: v3(1e-70, 1.0, 0.0), d: 0.0 };
        let plain = Plane { n: v3(1.0, 0.0, 0.0), d: 1.0 };
        assert_eq!(expansion_sign(plain, plain, tiny, plain), SIGN_UNKNOWN);
        assert_eq!(expansion_position(plain, tiny, plain, &mut V3::default()), UNCERTAIN);
    }
}
