// Generated from backend-ocl/src/interface/ by `cargo xtask codegen`; do not edit.

#import "cell_types.cl"

// backend-ocl/src/interface/single.rs

// Voxels to each side, along each axis, that the table of offsets (`shells.rs`) holds.
#define SHELL_RADIUS ((uint)(4))

// Entries of the table of offsets, and how many of them are about the own voxel.
#define SHELLS ((uint)(729))

#define INNER_SHELLS ((uint)(27))

// A voxel with more sites is the host's, which has trees.
#define CROWDED ((uint)(256))

// The outcome of a cell: its status, and beside it whether a wider stage was needed.
#define OUTCOME_STATUS ((uint)(0xff))

#define OUTCOME_EXACT ((uint)(0x100))

// Scalars of an evaluation, in a unit of the grid's (`single/scene.rs`).
typedef struct {
    // Initial cell, each coordinate as the sum of two numbers.
    float box_lo[3];
    float box_lo_rest[3];
    float box_hi[3];
    float box_hi_rest[3];
    // Width of the voxels of the site grid, whose minimum corner is the origin, and how far outside its voxel rounding may put a site.
    float grid_width;
    float grid_pad;
    // What the two numbers of a position, and of a weight, leave of a difference of two of them, at most.
    float position_error;
    float weight_error;
    // Largest weight of all sites.
    float largest_weight;
    // Domain grid: minimum corner, width of the voxels, and what rounding may misplace a point by.
    float domain_lo[3];
    float domain_width;
    float domain_margin;
    uint grid_dims[3];
    uint top_level;
    uint level_begin[32];
    uint domain_dims[3];
    uint has_domain;
} Params;

#define SINGLE_CELLS_ARGUMENTS \
    __global const Params *params, \
    __global const float4 *sites, \
    __global const float4 *rests, \
    __global const uint *voxels, \
    __global const float *weights, \
    __global const uchar4 *shells, \
    __global const int *windings, \
    __global const uint *surface_table, \
    __global const uint *list, \
    uint count, \
    __global uint *outcome, \
    __global float4 *sums, \
    volatile __global uint *most_visited

// Sizes as on the host: a compiler that pads does not build this.
typedef char size_of_Params[(sizeof(Params) == 248) ? 1 : -1];
