// Generated from core/src/cell/vector.rs by `cargo xtask codegen`; do not edit.

// The vector (x, y, z).
INLINE V3 v3(real x, real y, real z) {
    return (V3){ .x = x, .y = y, .z = z };
}

// a + b.
INLINE V3 add(V3 a, V3 b) {
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

// a − b.
INLINE V3 sub(V3 a, V3 b) {
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

// t·a.
INLINE V3 scale(real t, V3 a) {
    return v3(t * a.x, t * a.y, t * a.z);
}

// a·b.
INLINE real v3_dot(V3 a, V3 b) {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

// a×b. Exactly −(b×a) also in floating point.
INLINE V3 v3_cross(V3 a, V3 b) {
    return v3((a.y * b.z) - (a.z * b.y), (a.z * b.x) - (a.x * b.z), (a.x * b.y) - (a.y * b.x));
}

// Sum of the components' magnitudes, at least the Euclidean norm.
INLINE real norm_1(V3 a) {
    return (fabs(a.x) + fabs(a.y)) + fabs(a.z);
}

// Largest magnitude of a component.
INLINE real norm_max(V3 a) {
    real m = fabs(a.x);
    if (fabs(a.y) > m) {
        m = fabs(a.y);
    }
    if (fabs(a.z) > m) {
        m = fabs(a.z);
    }
    return m;
}

// The smaller of two numbers.
INLINE real smaller(real a, real b) {
    if (b < a) {
        return b;
    }
    return a;
}

// The larger of two numbers.
INLINE real larger(real a, real b) {
    if (b > a) {
        return b;
    }
    return a;
}
