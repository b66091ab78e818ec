//! Exact arithmetic on `f64` inputs, for what floating point and double-double cannot decide: integers from a library.

use crate::cell::{COMPLETE, Plane, SIGN_UNKNOWN, UNCERTAIN, V3};
use num_bigint::BigInt;

/// The sign (−1, 0, 1) of the 4×4 determinant with rows `[n | d]` of the planes `a`, `b`, `c`, `k`.
pub fn sign_of_planes(a: Plane, b: Plane, c: Plane, k: Plane) -> i32 {
    let rows = [a, b, c, k].map(|p| integer_row([p.n.x, p.n.y, p.n.z, p.d]));
    // A row's own power of two does not change the sign. Products of four 29-bit numbers, 24 of them, fit in 128 bits.
    if rows.iter().all(|row| row.bits <= 29) {
        let small = rows.each_ref().map(|row| row.mantissas.map(|(m, shift)| i128::from(m) << shift));
        return determinant(&small).signum() as i32;
    }
    let large = rows.each_ref().map(|row| row.mantissas.map(|(m, shift)| BigInt::from(m) << shift as usize));
    sign(&determinant(&large))
}

/// The same sign where double-double arithmetic could not tell the determinant from 0, or `SIGN_UNKNOWN` where this does not suffice.
///
/// Columns are integers times a power of two, their `unit`, and below their `top`; so is the determinant, D·2^Σunit. It is smaller than
/// 2·`WIDE_ERROR`·24·2^Σtop then (24 products), so |D| < 2^(Σ(top − unit) − 93): up to 220 bits of all columns it is less than 2¹²⁷, and
/// integers modulo 2¹²⁸ have its sign, whatever wraps on the way. (Units above 2⁻⁸⁰⁰: nothing that double-double does underflows.)
pub fn sign_of_tie(a: Plane, b: Plane, c: Plane, k: Plane) -> i32 {
    let rows = [a, b, c, k].map(|p| [p.n.x, p.n.y, p.n.z, p.d]);
    let mut numbers = [[0_i128; 4]; 4];
    let (mut units, mut bits) = (0, 0);
    for column in 0..4 {
        let parts = rows.map(|row| odd_part(row[column]));
        let present = parts.iter().filter(|(m, _)| *m != 0);
        let Some(unit) = present.clone().map(|&(_, e)| e).min() else { return 0 };
        let top = present.map(|&(m, e)| e + 64 - m.unsigned_abs().leading_zeros() as i32).max().unwrap_or(unit);
        units += unit;
        bits += top - unit;
        for (row, (m, e)) in parts.into_iter().enumerate() {
            numbers[row][column] = i128::from(m).checked_shl((e - unit) as u32).filter(|_| m != 0).unwrap_or(0);
        }
    }
    if units < -800 || bits > 220 {
        return SIGN_UNKNOWN;
    }
    let minor = |first: usize, i: usize, j: usize| {
        let ([a, b], [c, d]) = ([numbers[i][first], numbers[i][first + 1]], [numbers[j][first], numbers[j][first + 1]]);
        a.wrapping_mul(d).wrapping_sub(b.wrapping_mul(c))
    };
    let term = |i, j, k, l| minor(0, i, j).wrapping_mul(minor(2, k, l));
    let plus = [term(0, 1, 2, 3), term(0, 3, 1, 2), term(1, 2, 0, 3), term(2, 3, 0, 1)];
    let minus = [term(0, 2, 1, 3), term(1, 3, 0, 2)];
    let sum = plus.iter().fold(0_i128, |sum, x| sum.wrapping_add(*x));
    minus.iter().fold(sum, |sum, x| sum.wrapping_sub(*x)).signum() as i32
}

/// x = m·2ᵉ with m odd, or (0, 0).
fn odd_part(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (m, e) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    if m == 0 {
        return (0, 0);
    }
    let zeros = m.trailing_zeros();
    let m = m >> zeros;
    (if x < 0.0 { -m } else { m }, e + zeros as i32)
}

/// The sign of `det(a − o, b − o, c − o)`.
pub fn sign_of_cone(a: V3, b: V3, c: V3, o: V3) -> i32 {
    let coord = |p: V3| robust::Coord3D { x: p.x, y: p.y, z: p.z };
    let det = robust::orient3d(coord(a), coord(b), coord(c), coord(o));
    i32::from(det > 0.0) - i32::from(det < 0.0)
}

/// The point where three planes meet, each component rounded once. Returns `COMPLETE`, or `UNCERTAIN` where the normals are
/// dependent.
pub fn position(a: Plane, b: Plane, c: Plane, point: &mut V3) -> u32 {
    let (na, nb, nc) = (vector(a.n), vector(b.n), vector(c.n));
    let (bc, ca, ab) = (cross(&nb, &nc), cross(&nc, &na), cross(&na, &nb));
    let det = dot(&na, &bc);
    if det.mantissa == BigInt::ZERO {
        return UNCERTAIN;
    }
    let (da, db, dc) = (Dyadic::new(-a.d), Dyadic::new(-b.d), Dyadic::new(-c.d));
    let component = |k: usize| da.times(&bc[k]).plus(&db.times(&ca[k])).plus(&dc.times(&ab[k])).over(&det);
    *point = V3 { x: component(0), y: component(1), z: component(2) };
    COMPLETE
}

/// The foot, relative to `center`, of the perpendicular from `center` to the line of planes `f` and `g`, each component rounded
/// once. Returns `COMPLETE`, or `UNCERTAIN` where the planes are parallel.
pub fn foot(f: Plane, g: Plane, center: V3, point: &mut V3) -> u32 {
    let (nf, ng, c) = (vector(f.n), vector(g.n), vector(center));
    let x = cross(&nf, &ng);
    let square = dot(&x, &x);
    if square.mantissa == BigInt::ZERO {
        return UNCERTAIN;
    }
    let df = Dyadic::new(f.d).plus(&dot(&nf, &c)).negated();
    let dg = Dyadic::new(g.d).plus(&dot(&ng, &c)).negated();
    let (gx, xf) = (cross(&ng, &x), cross(&x, &nf));
    let component = |k: usize| df.times(&gx[k]).plus(&dg.times(&xf[k])).over(&square);
    *point = V3 { x: component(0), y: component(1), z: component(2) };
    COMPLETE
}

/// A row of numbers as integers times a common power of two: each a mantissa and a shift.
struct IntegerRow {
    mantissas: [(i64, u32); 4],
    bits: u32,
}

fn integer_row(row: [f64; 4]) -> IntegerRow {
    let parts = row.map(decompose);
    let least = parts.iter().filter(|(m, _)| *m != 0).map(|&(_, e)| e).min().unwrap_or(0);
    let mantissas = parts.map(|(m, e)| (m, if m == 0 { 0 } else { (e - least) as u32 }));
    let bits = mantissas.iter().map(|&(m, shift)| 64 - m.unsigned_abs().leading_zeros() + shift).max().unwrap_or(0);
    IntegerRow { mantissas, bits }
}

/// `x` as `mantissa · 2^exponent`, the mantissa odd or zero.
fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, exponent) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    let odd = mantissa >> zeros;
    (if x < 0.0 { -odd } else { odd }, exponent + zeros as i32)
}

/// Determinant by Laplace expansion along the first two columns.
fn determinant<T>(rows: &[[T; 4]; 4]) -> T
where
    for<'a> &'a T: std::ops::Mul<&'a T, Output = T>,
    T: std::ops::Add<Output = T> + std::ops::Sub<Output = T>,
{
    let minor = |i: usize, j: usize, k: usize| &rows[i][k] * &rows[j][k + 1] - &rows[j][k] * &rows[i][k + 1];
    let term = |i, j, k, l| &minor(i, j, 0) * &minor(k, l, 2);
    term(0, 1, 2, 3) - term(0, 2, 1, 3) + term(0, 3, 1, 2) + term(1, 2, 0, 3) - term(1, 3, 0, 2) + term(2, 3, 0, 1)
}

fn sign(x: &BigInt) -> i32 {
    if *x == BigInt::ZERO { 0 } else { i32::from(*x > BigInt::ZERO) * 2 - 1 }
}

/// An exact binary fraction: `mantissa · 2^exponent`.
#[derive(Clone)]
pub(crate) struct Dyadic {
    mantissa: BigInt,
    exponent: i32,
}

impl Dyadic {
    pub(crate) fn new(x: f64) -> Self {
        let (mantissa, exponent) = decompose(x);
        Self { mantissa: mantissa.into(), exponent }
    }

    /// `mantissa · 2^exponent`.
    pub(crate) fn of(mantissa: BigInt, exponent: i32) -> Self {
        Self { mantissa, exponent }
    }

    /// Rounded to nearest.
    pub(crate) fn rounded(&self) -> f64 {
        self.over(&Self::new(1.0))
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        Self { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let exponent = self.exponent.min(other.exponent);
        let aligned = |x: &Self| &x.mantissa << (x.exponent - exponent) as usize;
        Self { mantissa: aligned(self) + aligned(other), exponent }
    }

    pub(crate) fn negated(&self) -> Self {
        Self { mantissa: -self.mantissa.clone(), exponent: self.exponent }
    }

    /// −1, 0 or 1.
    pub(crate) fn sign(&self) -> i32 {
        sign(&self.mantissa)
    }

    /// The quotient, rounded to nearest.
    pub(crate) fn over(&self, divisor: &Self) -> f64 {
        if self.mantissa == BigInt::ZERO {
            return 0.0;
        }
        // 64 or 65 bits of quotient and a sticky bit: more than the 54 that rounding to nearest needs.
        let length = |x: &BigInt| x.bits() as i32;
        let shift = 65 + length(&divisor.mantissa) - length(&self.mantissa);
        let scaled = |x: &BigInt, by: i32| x << by.max(0) as usize;
        let numerator = scaled(&self.mantissa, shift);
        let denominator = scaled(&divisor.mantissa, -shift);
        let quotient = &numerator / &denominator;
        let exact = &quotient * &denominator == numerator;
        let whole = i128::try_from(quotient).unwrap_or(0) << 1;
        let sticky = i128::from(!exact) * whole.signum();
        let exponent = self.exponent - divisor.exponent - shift - 1;
        // Two steps, so that the power of two stays within range.
        let half = exponent / 2;
        (whole + sticky) as f64 * 2.0_f64.powi(half) * 2.0_f64.powi(exponent - half)
    }
}

/// The determinant of three rows.
pub(crate) fn determinant_of_rows([a, b, c]: &[[Dyadic; 3]; 3]) -> Dyadic {
    dot(a, &cross(b, c))
}

fn vector(v: V3) -> [Dyadic; 3] {
    [v.x, v.y, v.z].map(Dyadic::new)
}

fn dot(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> Dyadic {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

/// The cross product.
pub(crate) fn cross(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    [1, 2, 0].map(|i| {
        let j = (i + 1) % 3;
        a[i].times(&b[j]).plus(&a[j].times(&b[i]).negated())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::v3;

    fn plane(x: f64, y: f64, z: f64, d: f64) -> Plane {
        Plane { n: v3(x, y, z), d }
    }

    #[test]
    fn determinant_of_known_rows() {
        // Upper triangular: the sign of the product of the diagonal; a swap of rows turns it.
        let rows = [
            plane(2.0, 5.0, -1.0, 3.0),
            plane(0.0, -3.0, 7.0, 1.0),
            plane(0.0, 0.0, 0.1, 4.0),
            plane(0.0, 0.0, 0.0, 9.0),
        ];
        assert_eq!(sign_of_planes(rows[0], rows[1], rows[2], rows[3]), -1);
        assert_eq!(sign_of_planes(rows[1], rows[0], rows[2], rows[3]), 1);
        assert_eq!(sign_of_planes(rows[0], rows[1], rows[0], rows[3]), 0);
    }

    #[test]
    fn sign_sees_one_unit_in_the_last_place() {
        let third = 1.0 / 3.0;
        let base = [plane(1.0, 0.0, 0.0, -third), plane(0.0, 1.0, 0.0, -0.1), plane(0.0, 0.0, 1.0, -1e-40)];
        // x + y + z through (1/3, 0.1, 1e-40): the sum of the offsets in f64 is not that of the numbers.
        let below = sign_of_planes(base[0], base[1], base[2], plane(1.0, 1.0, 0.0, -(third + 0.1)));
        let error = (third - (third + 0.1)) + 0.1;
        assert_eq!(
            below,
            if error > 0.0 {
                1
            } else if error < 0.0 {
                -1
            } else {
                0
            }
        );
        assert_eq!(sign_of_planes(base[0], base[1], base[2], plane(0.0, 0.0, 1.0, 0.0)), 1);
        assert_eq!(sign_of_planes(base[0], base[1], base[2], plane(0.0, 0.0, 0.5, -0.5e-40)), 0);
    }

    #[test]
    fn positions_and_feet_are_rounded_once() {
        let mut point = v3(0.0, 0.0, 0.0);
        let status =
            position(plane(3.0, 0.0, 0.0, -1.0), plane(0.0, 7.0, 0.0, 1.0), plane(0.0, 0.0, -1.0, 1e-300), &mut point);
        assert_eq!((status, point), (COMPLETE, v3(1.0 / 3.0, -1.0 / 7.0, 1e-300)));
        // Planes that differ by 1e-14 in slope meet at x = 1.
        let tilt = 2.0_f64.powi(-47);
        let status =
            position(plane(0.0, 1.0, 0.0, 0.0), plane(tilt, 1.0, 0.0, -tilt), plane(0.0, 0.0, -1.0, 0.0), &mut point);
        assert_eq!((status, point), (COMPLETE, v3(1.0, 0.0, 0.0)));
        let status = foot(plane(0.0, 1.0, 0.0, 0.0), plane(tilt, 1.0, 0.0, -tilt), v3(0.25, 2.0, 5.0), &mut point);
        assert_eq!((status, point), (COMPLETE, v3(0.75, -2.0, 0.0)));
    }
}
