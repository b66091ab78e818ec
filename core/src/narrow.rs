//! Signs of determinants by integers, where the coefficients of a cell's planes have few digits, as those of lattices have. They are certain, and a lattice's
//! cells take 30 % fewer instructions with them than by double-double and the integers of `exact.rs` (2,744 sites: 395 to 276 million).
//!
//! The coefficients of a column, x, y, z or d of `[n | d]`, are integers times a power of two that all planes of the cell share; a row may be scaled
//! by one of its own, which changes no sign. Integers stay below 2⁶¹, so minors of two columns below 2¹²³, of three below 2¹⁸⁶, and the determinant below
//! 2²⁴⁹.

use crate::cell::Plane;

/// Bits of a coefficient.
const BITS: i32 = 61;
/// Exponents of numbers that can be scaled twice without overflow, and without loss: what comes of them is above 2⁻⁷⁴¹.
const EXPONENTS: std::ops::Range<i32> = -200..200;

/// The coefficients of a plane as integers.
pub type Row = [i64; 4];

/// The powers of two that make integers of the coefficients, by columns.
#[derive(Clone, Copy, Debug)]
pub struct Columns([f64; 4]);

impl Columns {
    /// Such that the largest numbers of these planes have as many bits as there is room for; `None` where a column is out of range.
    pub fn of(planes: impl Iterator<Item = Plane>) -> Option<Self> {
        let mut largest = [0.0_f64; 4];
        for plane in planes {
            for (most, x) in largest.iter_mut().zip(numbers(plane)) {
                *most = most.max(x.abs());
            }
        }
        let mut scales = [1.0; 4];
        for (scale, most) in scales.iter_mut().zip(largest) {
            if most > 0.0 {
                *scale = power_of_two(BITS - 1 - in_range(most)?);
            }
        }
        Some(Self(scales))
    }

    /// The integers of a plane, if they are such.
    pub fn row(&self, plane: Plane) -> Option<Row> {
        let mut numbers = numbers(plane);
        let mut largest = 0.0_f64;
        for (x, scale) in numbers.iter_mut().zip(self.0) {
            if *x != 0.0 {
                in_range(*x)?;
            }
            *x *= scale;
            largest = largest.max(x.abs());
        }
        // (Up, too: fewer digits are lost then.)
        if largest > 0.0 {
            let scale = power_of_two(BITS - 1 - exponent_of(largest));
            for x in &mut numbers {
                *x *= scale;
            }
        }
        let row = numbers.map(|x| x as i64);
        (row.map(|m| m as f64) == numbers).then_some(row)
    }
}

const fn numbers(plane: Plane) -> [f64; 4] {
    [plane.n.x, plane.n.y, plane.n.z, plane.d]
}

/// The exponent of a number that is not 0, nor near it, if it is in range.
fn in_range(x: f64) -> Option<i32> {
    let exponent = exponent_of(x);
    EXPONENTS.contains(&exponent).then_some(exponent)
}

const fn exponent_of(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1023
}

fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// An integer `upper·2⁶⁴ + lower`.
#[derive(Clone, Copy, Debug, Default)]
struct Long {
    upper: i128,
    lower: u64,
}

/// The minors of three rows without column x, y, z or d, signed as the cofactors of a fourth row.
#[derive(Clone, Copy, Debug, Default)]
pub struct Minors([Long; 4]);

impl Minors {
    /// Of the planes of a vertex.
    pub fn new(a: Row, b: Row, c: Row) -> Self {
        let pair = |i: usize, j: usize| i128::from(a[i]) * i128::from(b[j]) - i128::from(a[j]) * i128::from(b[i]);
        let [xy, xz, xd, yz, yd, zd] = [pair(0, 1), pair(0, 2), pair(0, 3), pair(1, 2), pair(1, 3), pair(2, 3)];
        let [x, y, z, d] = c;
        Self([
            sum([(zd, -y), (yd, z), (yz, -d)]),
            sum([(zd, x), (xd, -z), (xz, d)]),
            sum([(yd, -x), (xd, y), (xy, -d)]),
            sum([(yz, x), (xz, -y), (xy, z)]),
        ])
    }

    /// The sign of the determinant whose fourth row is `k`: −1, 0 or 1.
    pub fn sign(&self, k: Row) -> i32 {
        let (mut upper, mut middle, mut lower) = (0_i128, 0_i128, 0_i128);
        for (minor, x) in self.0.iter().zip(k) {
            let x = i128::from(x);
            lower += i128::from(minor.lower) * x;
            middle += (minor.upper & i128::from(u64::MAX)) * x;
            upper += (minor.upper >> 64) * x;
        }
        middle += lower >> 64;
        upper += middle >> 64;
        match upper.signum() as i32 {
            0 => i32::from((middle | lower) as u64 != 0),
            sign => sign,
        }
    }
}

/// The sum of products.
fn sum(terms: [(i128, i64); 3]) -> Long {
    let (mut upper, mut lower) = (0, 0);
    for (m, x) in terms {
        lower += (m & i128::from(u64::MAX)) * i128::from(x);
        upper += (m >> 64) * i128::from(x);
    }
    Long { upper: upper + (lower >> 64), lower: lower as u64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::v3;
    use crate::exact::sign_of_planes;
    use proptest::prelude::*;

    /// Integers of up to 60 bits, often few, times a power of two.
    fn plane(exponents: [i32; 4], own: i32) -> impl Strategy<Value = Plane> {
        let number = (any::<i64>(), 4..60_u32).prop_map(|(m, shift)| (m >> shift) as f64);
        let scaled = move |m: f64, column: usize| m * 2.0_f64.powi(exponents[column] + own);
        [number.clone(), number.clone(), number.clone(), number]
            .prop_map(move |[x, y, z, d]| Plane { n: v3(scaled(x, 0), scaled(y, 1), scaled(z, 2)), d: scaled(d, 3) })
    }

    proptest! {
        #[test]
        fn signs_are_exact(
            planes in (prop::array::uniform4(-40..40_i32), prop::array::uniform4(-9..9_i32))
                .prop_flat_map(|(of, own)| own.map(|own| plane(of, own))),
            copies in 0..3_usize,
        ) {
            let [a, b, c, mut k] = planes;
            // A sum of two rows makes it 0.
            if copies == 1 {
                k = Plane { n: v3(a.n.x + b.n.x, a.n.y + b.n.y, a.n.z + b.n.z), d: a.d + b.d };
            } else if copies == 2 {
                k = c;
            }
            let columns = Columns::of([a, b].into_iter());
            let rows = columns.and_then(|columns| Some([columns.row(a)?, columns.row(b)?, columns.row(c)?, columns.row(k)?]));
            if let Some([a_row, b_row, c_row, k_row]) = rows {
                prop_assert_eq!(Minors::new(a_row, b_row, c_row).sign(k_row), sign_of_planes(a, b, c, k));
            }
        }
    }

    /// The largest numbers, all signs: nothing overflows (debug builds would say so).
    #[test]
    fn the_largest_numbers_have_room() {
        let most = (1_i64 << BITS) - 1;
        for signs in 0..1_u32 << 16 {
            let row = |r: u32| [0, 1, 2, 3].map(|c| if signs >> (4 * r + c) & 1 == 0 { most } else { -most });
            let [a, b, c, k] = [row(0), row(1), row(2), row(3)];
            let unit = |row: Row| row.map(|x| (x / most) as f64);
            let planes = [a, b, c, k].map(unit).map(|[x, y, z, d]| Plane { n: v3(x, y, z), d });
            assert_eq!(Minors::new(a, b, c).sign(k), sign_of_planes(planes[0], planes[1], planes[2], planes[3]));
        }
    }

    #[test]
    fn what_has_more_digits_is_left() {
        let plane = |x: f64, d: f64| Plane { n: v3(x, 0.0, 0.0), d };
        let columns = Columns::of([plane(1.0, 1.0)].into_iter()).unwrap();
        assert_eq!(columns.row(plane(0.5, -0.25)), Some([1 << 60, 0, 0, -(1 << 59)]));
        assert_eq!(columns.row(plane(1.0, 1.0 / 1024.0 / 1024.0 / 3.0)), None);
        assert_eq!(columns.row(plane(8.0, 2.0)), Some([1 << 60, 0, 0, 1 << 58]));
        assert_eq!(columns.row(plane(f64::NAN, 2.0)), None);
        assert!(Columns::of([plane(1e300, 1.0)].into_iter()).is_none());
    }
}
