// Generated from backend-ocl/src/interface/ by `cargo xtask codegen`; do not edit.

#import "generated/cell_types.cl"

// core/src/site_tree.rs

// Sites in a leaf, and nodes in a block.
#define WIDTH ((uint)(8))

// Eight sibling nodes: the tight boxes of their sites.
typedef struct {
    // Minimum corners, axis by axis.
    float lo[3][WIDTH];
    // Maximum corners, axis by axis.
    float hi[3][WIDTH];
} Boxes;

// An upper bound of the weights of each of eight sibling nodes, less [`SiteTree::base_weight`]:
// `w_j − base ≤ c + g·(p_j − m) + Σ_k q_k (p_j − m)_k²`, `m` the middle of the box. `c` has room for all roundings of evaluating it.
typedef struct {
    // Constant.
    float c[WIDTH];
    // Slope, axis by axis.
    float g[3][WIDTH];
    // Curvature, axis by axis.
    float q[3][WIDTH];
} WeightBounds;

// A slab that holds the sites of each of eight sibling nodes, across their thinnest direction: it tells sites that lie along a surface from
// a sphere that touches the surface.
typedef struct {
    // Unit normals, axis by axis; zero where the box says as much.
    float normal[3][WIDTH];
    // Least `normal·p`, rounded down.
    float lo[WIDTH];
    // Largest `normal·p`, rounded up.
    float hi[WIDTH];
    // Largest weight, less the base.
    float largest_weight[WIDTH];
} Slabs;

// backend-ocl/src/interface/single.rs

// The outcome of a cell: its status, and beside it whether a wider stage was needed.
#define OUTCOME_STATUS ((uint)(0xff))

#define OUTCOME_EXACT ((uint)(0x100))

// Scalars of an evaluation, in a unit of the sites' (`single/scene.rs`).
typedef struct {
    // Initial cell, each coordinate as the sum of two numbers.
    float box_lo[3];
    float box_lo_rest[3];
    float box_hi[3];
    float box_hi_rest[3];
    // What the two numbers of a position, and of a weight, leave of a difference of two of them, at most.
    float position_error;
    float weight_error;
    // Of sites that are nearer than this, along all axes, single numbers tell too little.
    float least_distance;
    // Largest weight of all sites; the smallest is 0.
    float largest_weight;
    // Domain grid: minimum corner, width of the voxels, and what rounding may misplace a point by.
    float domain_lo[3];
    float domain_width;
    float domain_margin;
    uint domain_dims[3];
    uint has_domain;
    // Whether all weights are equal.
    uint equal_weights;
    // The tree over the sites: how many, the root's level, and where the blocks of each level begin.
    uint tree_sites;
    uint tree_top;
    uint tree_begin[12];
} Params;

#define SINGLE_CELLS_ARGUMENTS \
    __global const Params *params, \
    __global const float4 *sites, \
    __global const float4 *rests, \
    __global const Boxes *boxes, \
    __global const Slabs *slabs, \
    __global const WeightBounds *weight_bounds, \
    __global const int *windings, \
    __global const uint *surface_table, \
    __global const uint *list, \
    uint count, \
    __global uint *outcome, \
    __global float4 *sums, \
    volatile __global uint *most_visited

// Sizes as on the host: a compiler that pads does not build this.
typedef char size_of_Boxes[(sizeof(Boxes) == 192) ? 1 : -1];
typedef char size_of_WeightBounds[(sizeof(WeightBounds) == 224) ? 1 : -1];
typedef char size_of_Slabs[(sizeof(Slabs) == 192) ? 1 : -1];
typedef char size_of_Params[(sizeof(Params) == 160) ? 1 : -1];
