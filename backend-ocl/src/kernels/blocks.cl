// What the search for neighbours knows beforehand where weights differ: for each block of voxels of the site grid, the largest weight that the
// table of offsets about any of its voxels can meet, and how far the vertices of a cell may be for no site beyond that table to cut it. The
// largest weight of all would have every cell search as far as the heaviest site anywhere could reach.

// Where a site of a block is at least the distance D from others of weight at most W, they cannot cut its cell of radius r, if
// r ≤ (D² − (W − w)) / 2D with w its weight, and W not below w: then D ≥ r + √(r² + W − w).
INLINE real proved_radius(real distance, real excess) {
    return (distance / REAL(2.0)) - (fmax(excess, REAL(0.0)) / (REAL(2.0) * distance));
}

// Voxels along an axis between the nodes `i` of `level` and `b` of `block_level`.
INLINE uint voxels_apart(uint i, uint level, uint b, uint block_level) {
    const uint lo = i << level;
    const uint hi = (i + 1u) << level;
    const uint block_lo = b << block_level;
    const uint block_hi = (b + 1u) << block_level;
    return (lo > block_hi) ? (lo - block_hi) : ((block_lo > hi) ? (block_lo - hi) : 0u);
}

__kernel void bound_blocks(
    __global const Params *params, __global const real4 *sites, __global const uint *voxels, __global const real *weights,
    uint count, __global real2 *blocks
) {
    const uint block = get_global_id(0);
    if (block >= count) {
        return;
    }
    __global const uint *dims = params->grid_dims;
    const uint top = params->top_level;
    const uint own = block_level(params);
    const uint nx = level_dim(params, 0, own);
    const uint ny = level_dim(params, 1, own);
    const uint nz = level_dim(params, 2, own);
    const uint x = block % nx;
    const uint y = (block / nx) % ny;
    const uint z = (block / nx) / ny;
    // 1. The largest weight near, and the smallest of the block's own sites.
    real largest = -INFINITY;
    for (uint k = z - min(z, NEAR_BLOCKS); k < min(z + (NEAR_BLOCKS + 1u), nz); k++) {
        for (uint j = y - min(y, NEAR_BLOCKS); j < min(y + (NEAR_BLOCKS + 1u), ny); j++) {
            for (uint i = x - min(x, NEAR_BLOCKS); i < min(x + (NEAR_BLOCKS + 1u), nx); i++) {
                largest = fmax(largest, weights[params->level_begin[own] + i + (nx * (j + (ny * k)))]);
            }
        }
    }
    real smallest = INFINITY;
    for (uint k = z << own; k < min((z + 1u) << own, dims[2]); k++) {
        for (uint j = y << own; j < min((y + 1u) << own, dims[1]); j++) {
            const uint row = dims[0] * (j + (dims[1] * k));
            const uint end = voxels[row + min((x + 1u) << own, dims[0])];
            for (uint site = voxels[row + (x << own)]; site < end; site++) {
                smallest = fmin(smallest, sites[site].w);
            }
        }
    }
    if (smallest == INFINITY) {
        blocks[block] = (real2)(largest, REAL(0.0));
        return;
    }
    // 2. Through the pyramid, but for what cannot be the least. (Roundings are far below a millionth of a voxel, and pads are known.)
    const real pad = fmax(fmax(params->grid_pad[0], params->grid_pad[1]), params->grid_pad[2]);
    const real apart = ((real)SHELL_RADIUS * params->grid_width * REAL(0.999999)) - (REAL(4.0) * pad);
    real radius = proved_radius(apart, largest - smallest);
    uint level = top;
    uint i = 0;
    uint j = 0;
    uint k = 0;
    for (;;) {
        const uint ax = voxels_apart(i, level, x, own);
        const uint ay = voxels_apart(j, level, y, own);
        const uint az = voxels_apart(k, level, z, own);
        const real voxels_off = sqrt(((real)ax * (real)ax) + ((real)ay * (real)ay) + ((real)az * (real)az));
        const real distance = fmax(apart, (voxels_off * params->grid_width * REAL(0.999999)) - (REAL(4.0) * pad));
        const uint lx = level_dim(params, 0, level);
        const uint ly = level_dim(params, 1, level);
        const real excess = weights[params->level_begin[level] + i + (lx * (j + (ly * k)))] - smallest;
        const real least = proved_radius(distance, excess);
        if ((least < radius) && (level > own)) {
            level--;
            i <<= 1;
            j <<= 1;
            k <<= 1;
            continue;
        }
        radius = fmin(radius, least);
        // On to the next node that is not below this one.
        for (;;) {
            if (level == top) {
                blocks[block] = (real2)(largest, radius - (REAL(0.000001) * fabs(radius)));
                return;
            }
            const uint octant = ((i & 1u) | ((j & 1u) << 1)) | ((k & 1u) << 2);
            uint next = octant + 1u;
            for (; next < 8u; next++) {
                const uint a = (i & ~1u) + (next & 1u);
                const uint b = (j & ~1u) + ((next >> 1) & 1u);
                const uint c = (k & ~1u) + (next >> 2);
                if (((a < level_dim(params, 0, level)) && (b < level_dim(params, 1, level))) && (c < level_dim(params, 2, level))) {
                    i = a;
                    j = b;
                    k = c;
                    break;
                }
            }
            if (next < 8u) {
                break;
            }
            level++;
            i >>= 1;
            j >>= 1;
            k >>= 1;
        }
    }
}
