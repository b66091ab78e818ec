// Nodes of the pyramid, and affine bounds of their sites' weights (`blocks.cl` makes them): slope, and what the weights are at most above that,
// at the node's middle; −∞ where there is no site.

#import "params.cl"

// A node that covers 2^level voxels along each axis.
typedef struct {
    uint level;
    uint i;
    uint j;
    uint k;
} GridNode;

// Of the numbers that are added up here, what rounding can take.
#define BOUND_ROUNDING REAL(1e-13)

INLINE uint index_at(__global const Params *params, GridNode node) {
    return node.i + (level_dim(params, 0, node.level) * (node.j + (level_dim(params, 1, node.level) * node.k)));
}

// Its place among the bounds, which begin with those of blocks.
INLINE uint bound_at(__global const Params *params, GridNode node) {
    return (params->level_begin[node.level] - params->level_begin[block_level(params)]) + index_at(params, node);
}

// Number `index` of the nodes of a level.
INLINE GridNode node_at(__global const Params *params, uint level, uint index) {
    const uint nx = level_dim(params, 0, level);
    const uint ny = level_dim(params, 1, level);
    return (GridNode){ .level = level, .i = index % nx, .j = (index / nx) % ny, .k = (index / nx) / ny };
}
INLINE uint nodes_of(__global const Params *params, uint level) {
    return (level_dim(params, 0, level) * level_dim(params, 1, level)) * level_dim(params, 2, level);
}

INLINE GridNode first_child(GridNode node) { return (GridNode){ .level = node.level - 1u, .i = node.i << 1, .j = node.j << 1, .k = node.k << 1 }; }

// Goes to the next node that is not below this one, and below the one of level `top`; 0 where there is none.
INLINE uint next_node(__global const Params *params, uint top, GridNode *node) {
    while (node->level < top) {
        const uint octant = ((node->i & 1u) | ((node->j & 1u) << 1)) | ((node->k & 1u) << 2);
        for (uint next = octant + 1u; next < 8u; next++) {
            const uint i = (node->i & ~1u) + (next & 1u);
            const uint j = (node->j & ~1u) + ((next >> 1) & 1u);
            const uint k = (node->k & ~1u) + (next >> 2);
            const uint level = node->level;
            if (((i < level_dim(params, 0, level)) && (j < level_dim(params, 1, level))) && (k < level_dim(params, 2, level))) {
                *node = (GridNode){ .level = level, .i = i, .j = j, .k = k };
                return 1;
            }
        }
        *node = (GridNode){ .level = node->level + 1u, .i = node->i >> 1, .j = node->j >> 1, .k = node->k >> 1 };
    }
    return 0;
}

INLINE real3 middle_of(__global const Params *params, GridNode node) {
    const real halved = REAL(0.5) * params->grid_width;
    const uint3 at = ((2u * (uint3)(node.i, node.j, node.k)) + 1u) << node.level;
    return (real3)(params->grid_lo[0], params->grid_lo[1], params->grid_lo[2]) + (halved * convert_double3(at));
}

INLINE real largest_pad(__global const Params *params) {
    return fmax(fmax(params->grid_pad[0], params->grid_pad[1]), params->grid_pad[2]);
}

// Half the width of a node, with what rounding can misplace a site by.
INLINE real half_width(__global const Params *params, uint level) {
    return ((real)(1u << level) * (REAL(0.5000001) * params->grid_width)) + (REAL(4.0) * largest_pad(params));
}

INLINE real norm_1_of(real3 v) { return (fabs(v.x) + fabs(v.y)) + fabs(v.z); }

// The rows of voxels of a node, and where the sites of one of them begin and end.
INLINE uint rows_of(uint level) { return 1u << (2u * level); }
INLINE uint2 sites_of_row(__global const Params *params, __global const uint *voxels, GridNode node, uint row) {
    __global const uint *dims = params->grid_dims;
    const uint b = (node.j << node.level) + (row & ((1u << node.level) - 1u));
    const uint c = (node.k << node.level) + (row >> node.level);
    if ((b >= dims[1]) || (c >= dims[2])) {
        return (uint2)(0u, 0u);
    }
    const uint begin = dims[0] * (b + (dims[1] * c));
    return (uint2)(voxels[begin + (node.i << node.level)], voxels[begin + min((node.i + 1u) << node.level, dims[0])]);
}

// The largest of slope·t − growth·dist²(t, A) along an axis, for t within `half_node` of 0 and A the interval within `half_block` of `block`.
// (`inverse` is 1/2growth, or so large that t is at an end.)
INLINE real most_along(real slope, real half_node, real block, real half_block, real growth, real inverse) {
    const real far = slope * inverse;
    const real t = clamp((slope < REAL(0.0)) ? ((block - half_block) + far) : ((block + half_block) + far), -half_node, half_node);
    const real off = fmax(fabs(t - block) - half_block, REAL(0.0));
    return (slope * t) - ((growth * off) * off);
}

// Of a node's sites the largest weight less slope·(x − from), and less growth·dist²(x, A), where A is the cube about `from` of half the width
// `half_block`.
INLINE real largest_rest(real4 bound, real3 middle, real half_node, real3 slope, real3 from, real half_block, real growth) {
    const real3 way = middle - from;
    const real3 differs = bound.xyz - slope;
    const real inverse = (growth > REAL(0.0)) ? (REAL(0.5) / growth) : REAL(1e300);
    const real most = (most_along(differs.x, half_node, -way.x, half_block, growth, inverse) + most_along(differs.y, half_node, -way.y, half_block, growth, inverse))
        + most_along(differs.z, half_node, -way.z, half_block, growth, inverse);
    const real size = fabs(bound.w) + ((norm_1_of(slope) * (norm_1_of(way) + half_node)) + (norm_1_of(bound.xyz) * half_node));
    return ((bound.w - dot(slope, way)) + most) + (BOUND_ROUNDING * (size + (growth * dot(way, way))));
}
