// Generated from core/src/cell/ring.rs by `cargo xtask codegen`; do not edit.

// Where a ring ends, in voxels: at 2, 3, 4, 6, 8, 12, …, where the next begins.
INLINE uint end_of_ring(uint ring) {
    return (2 + (ring & 1)) << (ring / 2);
}

// The level of the nodes that are blocks of leaves, as far as there are any.
INLINE uint level_of_block(uint top_level) {
    if (top_level == 0) {
        return 0;
    }
    return 1;
}

// The block of leaves of a site, a node of that level.
INLINE uint block_of_site(uint top_level, uint site) {
    return (site / WIDTH) >> (3 * level_of_block(top_level));
}

// A weight less what a slope makes of the way to its site, and the size of what is summed.
INLINE real less_slope(real excess, V3 slope, V3 way, real *size) {
    const real x = slope.x * way.x;
    const real y = slope.y * way.y;
    const real z = slope.z * way.z;
    *size = fabs(excess) + ((fabs(x) + fabs(y)) + fabs(z));
    return excess - ((x + y) + z);
}
