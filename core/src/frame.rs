//! The frame in which everything is computed: the caller's lengths, moved near the origin and scaled by a power of two,
//! both without rounding for every coordinate of the container, and undone on the way out.

/// Coordinates of the frame smaller than this are taken as zero: 2⁻¹⁵⁰ of the box. Below it the products of the
/// predicates could underflow; above it they cannot (five factors of at least 2⁻²⁰² each stay above 2⁻¹⁰²²).
pub const SMALLEST: f64 = f64::from_bits((1023 - 150) << 52);

/// An affine map `x' = (x − shift) / unit`, exact for the coordinates of the box it was made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    shift: [f64; 3],
    unit: f64,
}

impl Frame {
    /// The frame of the box `[lo, hi]` (caller's coordinates): its largest extent becomes at most 1 and more than ½.
    ///
    /// An axis is shifted only where the difference is exact for every coordinate in the box (Sterbenz: both ends of
    /// one sign and within a factor of two of each other); otherwise the box is within two extents of zero anyway.
    pub fn of_box(lo: [f64; 3], hi: [f64; 3]) -> Self {
        let mut extent = 0.0_f64;
        let mut shift = [0.0; 3];
        for k in 0..3 {
            extent = extent.max(hi[k] - lo[k]);
            let (near, far) = if lo[k] > 0.0 { (lo[k], hi[k]) } else { (hi[k], lo[k]) };
            if (lo[k] > 0.0 || hi[k] < 0.0) && far.abs() <= 2.0 * near.abs() {
                shift[k] = near;
            }
        }
        let mut unit = 1.0_f64;
        while unit < extent {
            unit *= 2.0;
        }
        while unit * 0.5 >= extent && extent > 0.0 {
            unit *= 0.5;
        }
        Self { shift, unit }
    }

    /// The caller's coordinates of the frame's origin.
    pub fn shift(&self) -> [f64; 3] {
        self.shift
    }

    /// The length in the caller's world of one unit of the frame: a power of two.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Caller's coordinates to the frame's.
    pub fn enter(&self, x: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| {
            let y = (x[k] - self.shift[k]) / self.unit;
            if y.abs() < SMALLEST { 0.0 } else { y }
        })
    }

    /// A weight of the caller's in the frame's unit.
    pub fn enter_weight(&self, w: f64) -> f64 {
        // The sum makes −0 a 0: of equal weights the first counts, whatever their signs.
        (w / (self.unit * self.unit)).clamp(f64::MIN, f64::MAX) + 0.0
    }

    /// The frame's coordinates to the caller's.
    pub fn leave(&self, x: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| x[k] * self.unit + self.shift[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entering_is_exact_for_the_box() {
        for (lo, hi) in [(1000.0, 1001.0), (-3.0, 5.0), (-1001.0, -1000.0), (1e-90, 3e-90), (0.0, 1e90)] {
            let frame = Frame::of_box([lo; 3], [hi; 3]);
            let step = (hi - lo) / 7.0;
            for i in 0..8 {
                let x = lo + step * f64::from(i);
                let y = frame.enter([x; 3])[0];
                assert!(y.abs() <= 2.0, "{x} became {y}");
                assert_eq!(frame.leave([y; 3])[0], x, "box [{lo}, {hi}]");
            }
        }
    }
}
