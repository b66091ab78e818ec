//! Volume, barycenter and area of a closed mesh, to the last digit or two.
//!
//! With `n = (b − a) × (c − a)`, a triangle adds `a·n / 6` to the volume and `a·n (a + b + c) / 24` to the first moment
//! (the cone from the origin over it). These terms cancel, so they are computed and summed in twice the precision; where
//! even that is not enough (thin shells, or no volume at all), exactly.

use num_bigint::BigInt;

use crate::exact::Dyadic;
use crate::summation::Sum;

/// The integrals of a mesh, in the unit of its vertices.
pub(super) struct Moments {
    /// Signed volume; zero only where it is exactly zero.
    pub(super) volume: f64,
    pub(super) barycenter: [f64; 3],
    pub(super) area: f64,
}

impl Moments {
    /// The integrals of a mesh in a frame: coordinates are at most 2, and zero or at least 2⁻¹⁵⁰. Each triangle stands so many times.
    pub(super) fn of_mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]], times: &[i32]) -> Self {
        let mut area = Sum::default();
        let mut volume6 = Wide::default();
        let mut moment24 = [Wide::default(); 3];
        let mut magnitude = 0.0;
        for (t, &times) in triangles.iter().zip(times) {
            let [a, b, c] = t.map(|i| vertices[i as usize]);
            let times = f64::from(times);
            let u: [Wide; 3] = std::array::from_fn(|k| Wide::difference(b[k], a[k]));
            let v: [Wide; 3] = std::array::from_fn(|k| Wide::difference(c[k], a[k]));
            let mut n = [Wide::default(); 3];
            let mut term = Wide::default();
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let (p, q) = (u[i].times(v[j]), u[j].times(v[i]));
                n[k] = p.plus(q.negated());
                term = term.plus(n[k].times(Wide::from(a[k])));
                magnitude += times.abs() * a[k].abs() * (p.hi.abs() + q.hi.abs());
            }
            term = term.times(Wide::from(times));
            area.add(times.abs() * n.iter().map(|x| x.hi * x.hi).sum::<f64>().sqrt());
            volume6 = volume6.plus(term);
            for k in 0..3 {
                let sum = Wide::difference(a[k], -b[k]).plus(Wide::from(c[k]));
                moment24[k] = moment24[k].plus(term.times(sum));
            }
        }
        // Each operation on `Wide` errs by at most 8u² (u = 2⁻⁵³) of the magnitudes that go in, a term takes fewer than
        // 8 of them in a row and the sums one for each triangle; below the bound a volume is right to 2⁻⁵⁴ of itself.
        let bound = (8.0 * triangles.len() as f64 + 64.0) * magnitude * (-106_f64).exp2();
        let area = area.total() / 2.0;
        if volume6.hi.abs() > bound * 54_f64.exp2() {
            let barycenter = moment24.map(|m| m.hi / volume6.hi / 4.0);
            Self { volume: volume6.hi / 6.0, barycenter, area }
        } else {
            let (volume, barycenter) = exactly(vertices, triangles, times);
            Self { volume, barycenter, area }
        }
    }
}

/// Volume and barycenter by integers, each rounded at the end; the barycenter of no volume is NaN.
fn exactly(vertices: &[[f64; 3]], triangles: &[[u32; 3]], times: &[i32]) -> (f64, [f64; 3]) {
    let integers: Vec<[BigInt; 3]> = vertices.iter().map(|v| v.map(to_integer)).collect();
    let mut volume6 = BigInt::ZERO;
    let mut moment24 = [BigInt::ZERO; 3];
    for (t, &times) in triangles.iter().zip(times) {
        let [a, b, c] = t.map(|i| &integers[i as usize]);
        let once: BigInt = (0..3)
            .map(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                &a[k] * (&b[i] * &c[j] - &b[j] * &c[i])
            })
            .sum();
        let term = once * times;
        for k in 0..3 {
            moment24[k] += &term * (&a[k] + &b[k] + &c[k]);
        }
        volume6 += term;
    }
    let v = Dyadic::of(volume6, 0).rounded();
    // Largest magnitudes: (2²⁰⁵)³ · 6 · 2²⁸ · 2³¹ and (2²⁰⁵)⁴ · 18 · 2²⁸ · 2³¹, both within the range of f64.
    let barycenter = moment24.map(|m| Dyadic::of(m, 0).rounded() / v / 4.0 * (-f64::from(FRACTION_BITS)).exp2());
    (v * (-3.0 * f64::from(FRACTION_BITS)).exp2() / 6.0, barycenter)
}

/// Frame coordinates are multiples of `2^-FRACTION_BITS`: the smallest is 2⁻¹⁵⁰ and has 52 bits below its first.
const FRACTION_BITS: u32 = 202;

/// `x · 2^FRACTION_BITS`, which is an integer.
fn to_integer(x: f64) -> BigInt {
    let bits = x.abs().to_bits();
    let exponent = (bits >> 52) as i32 - 1075 + FRACTION_BITS as i32;
    if x == 0.0 || exponent < 0 {
        return BigInt::ZERO;
    }
    let magnitude = BigInt::from((bits & ((1 << 52) - 1)) | 1 << 52) << exponent as usize;
    if x < 0.0 { -magnitude } else { magnitude }
}

/// A number as the unevaluated sum `hi + lo`, `hi` being its rounding: about 106 bits.
#[derive(Clone, Copy, Default)]
struct Wide {
    hi: f64,
    lo: f64,
}

impl Wide {
    fn from(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    /// `a − b`, exactly (Knuth).
    fn difference(a: f64, b: f64) -> Self {
        let hi = a - b;
        let part = hi - a;
        Self { hi, lo: (a - (hi - part)) - (b + part) }
    }

    fn plus(self, other: Self) -> Self {
        let sum = Self::difference(self.hi, -other.hi);
        Self::normalised(sum.hi, sum.lo + (self.lo + other.lo))
    }

    fn times(self, other: Self) -> Self {
        let hi = self.hi * other.hi;
        let lo = self.hi.mul_add(other.hi, -hi) + (self.hi * other.lo + self.lo * other.hi);
        Self::normalised(hi, lo)
    }

    fn negated(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }

    /// `hi + lo` where `|hi| ≥ |lo|` or the sum is a rounding of zero.
    fn normalised(hi: f64, lo: f64) -> Self {
        let sum = hi + lo;
        Self { hi: sum, lo: lo - (sum - hi) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments_of(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Moments {
        Moments::of_mesh(vertices, triangles, &vec![1; triangles.len()])
    }

    #[test]
    fn wide_sums_agree_with_exact_ones() {
        // A fan of slivers around a skew axis: large terms that cancel.
        let mut vertices = vec![[-1.9, 0.3, 1.1], [-0.95, 0.77, 1.6]];
        let n = 500_u32;
        for i in 0..n {
            let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            vertices.push([-1.5 + 0.3 * angle.cos(), 0.5 + 0.2 * angle.sin(), 1.4 + 1e-3 * (3.0 * angle).sin()]);
        }
        let mut triangles = Vec::new();
        for i in 0..n {
            let (p, q) = (2 + i, 2 + (i + 1) % n);
            triangles.extend([[0, p, q], [1, q, p]]);
        }
        let wide = moments_of(&vertices, &triangles);
        let (volume, barycenter) = exactly(&vertices, &triangles, &vec![1; triangles.len()]);
        assert!((wide.volume - volume).abs() <= 2.3e-16 * volume.abs(), "{} {volume}", wide.volume);
        for (found, right) in wide.barycenter.into_iter().zip(barycenter) {
            assert!((found - right).abs() <= 4.5e-16 * right.abs());
        }
    }

    #[test]
    fn thin_and_empty_meshes_are_summed_exactly() {
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let tetrahedron = |height: f64| [[0.1, 0.2, 0.3], [1.1, 0.2, 0.3], [0.1, 1.2, 0.3], [0.1, 0.2, 0.3 + height]];
        let height = (0.3 + 1e-15) - 0.3;
        let thin = moments_of(&tetrahedron(1e-15), &triangles);
        let base = (1.1_f64 - 0.1) * (1.2_f64 - 0.2);
        assert!((thin.volume / (base * height / 6.0) - 1.0).abs() < 1e-15, "{}", thin.volume);
        assert!((thin.barycenter[0] - 0.35).abs() < 1e-15);
        assert_eq!(moments_of(&tetrahedron(0.0), &triangles).volume, 0.0);
        // Two fans over one ring in the plane z = x + y: nothing, or as much as the second apex is lifted.
        let at = |x: f64, y: f64| {
            let [x, y] = [x, y].map(|x| (x * 50_f64.exp2()).round() * (-50_f64).exp2());
            [x, y, x + y]
        };
        let mut vertices = vec![at(0.1, 0.2), at(0.3, -0.1)];
        vertices.extend((0..40_u32).map(|i| at(0.7 * f64::from(i).cos(), 0.7 * f64::from(i).sin())));
        let fans: Vec<[u32; 3]> =
            (0..40).flat_map(|i| [[0, 2 + i, 2 + (i + 1) % 40], [1, 2 + (i + 1) % 40, 2 + i]]).collect();
        assert_eq!(moments_of(&vertices, &fans).volume, 0.0);
        // The cone from the origin over the flattened upper fan has a third of its area as volume, like the lifted tent.
        let flat: Vec<[f64; 3]> = vertices.iter().map(|v| [v[0], v[1], 1.0]).collect();
        let upper: Vec<[u32; 3]> = fans.iter().copied().step_by(2).collect();
        let ring = moments_of(&flat, &upper);
        vertices[0][2] += (-50_f64).exp2();
        let lifted = moments_of(&vertices, &fans).volume;
        let right = ring.volume * (-50_f64).exp2();
        assert!((lifted / right - 1.0).abs() < 1e-15, "{lifted:e} is not {right:e}");
    }
}
