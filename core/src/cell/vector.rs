//! Vectors of the dialect: a struct and functions, so that the text reads the same in OpenCL C.

/// The floating-point type of the algorithm.
pub type Real = f64;

/// The type of bounds that have room for it: single precision on devices.
pub type Rough = f64;

/// Half the distance from 1 to the next number: the largest relative error of one rounding.
#[cfg_attr(opencl, single(5.960464477539063e-8))]
pub const UNIT_ROUNDOFF: Real = 1.1102230246251565e-16;

/// A vector or point.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct V3 {
    /// First component.
    pub x: Real,
    /// Second component.
    pub y: Real,
    /// Third component.
    pub z: Real,
}

/// The vector (x, y, z).
#[inline(always)]
pub fn v3(x: Real, y: Real, z: Real) -> V3 {
    return V3 { x: x, y: y, z: z };
}

/// a + b.
#[inline(always)]
pub(crate) fn add(a: V3, b: V3) -> V3 {
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

/// a − b.
#[inline(always)]
pub(crate) fn sub(a: V3, b: V3) -> V3 {
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// t·a.
#[inline(always)]
pub(crate) fn scale(t: Real, a: V3) -> V3 {
    return v3(t * a.x, t * a.y, t * a.z);
}

/// a·b.
#[inline(always)]
pub(crate) fn dot(a: V3, b: V3) -> Real {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

/// a×b. Exactly −(b×a) also in floating point.
#[inline(always)]
pub(crate) fn cross(a: V3, b: V3) -> V3 {
    return v3((a.y * b.z) - (a.z * b.y), (a.z * b.x) - (a.x * b.z), (a.x * b.y) - (a.y * b.x));
}

/// Sum of the components' magnitudes, at least the Euclidean norm.
#[inline(always)]
pub(crate) fn norm_1(a: V3) -> Real {
    return (a.x.abs() + a.y.abs()) + a.z.abs();
}

/// Largest magnitude of a component.
#[inline(always)]
pub(crate) fn norm_max(a: V3) -> Real {
    let mut m: Real = a.x.abs();
    if a.y.abs() > m {
        m = a.y.abs();
    }
    if a.z.abs() > m {
        m = a.z.abs();
    }
    return m;
}

/// The smaller of two numbers.
#[inline(always)]
pub(crate) fn smaller(a: Real, b: Real) -> Real {
    if b < a {
        return b;
    }
    return a;
}

/// The larger of two numbers.
#[inline(always)]
pub(crate) fn larger(a: Real, b: Real) -> Real {
    if b > a {
        return b;
    }
    return a;
}
