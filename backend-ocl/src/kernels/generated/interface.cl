// Generated from backend-ocl/src/interface/ by `cargo xtask codegen`; do not edit.

#import "generated/cell_types.cl"

// core/src/site_tree.rs

// Sites in a leaf, and nodes in a block.
#define WIDTH ((uint)(8))

// Coordinate of the boxes of nodes that are not there: farther than any site, and its square is finite.
#define NOWHERE ((double)(1e150))

// Eight sibling nodes: the tight boxes of their sites.
typedef struct {
    // Minimum corners, axis by axis.
    double lo[3][WIDTH];
    // Maximum corners, axis by axis.
    double hi[3][WIDTH];
} Boxes;

// An upper bound of the weights of each of eight sibling nodes, less [`SiteTree::base_weight`]:
// `w_j − base ≤ c + g·(p_j − m) + Σ_k q_k (p_j − m)_k²`, `m` the middle of the box. `c` has room for all roundings of evaluating it.
typedef struct {
    // Constant.
    double c[WIDTH];
    // Slope, axis by axis.
    double g[3][WIDTH];
    // Curvature, axis by axis.
    double q[3][WIDTH];
} WeightBounds;

// A slab that holds the sites of each of eight sibling nodes, across their thinnest direction: it tells sites that lie along a surface from
// a sphere that touches the surface.
typedef struct {
    // Unit normals, axis by axis; zero where the box says as much.
    double normal[3][WIDTH];
    // Least `normal·p`, rounded down.
    double lo[WIDTH];
    // Largest `normal·p`, rounded up.
    double hi[WIDTH];
    // Largest weight, less the base.
    double largest_weight[WIDTH];
} Slabs;

// core/src/assemble/facets.rs

// One facet of a finished cell, in the frame of its site. Devices write the same. (16 bytes: with its moment, which the Laplacian has no use for, it took
// 40, and ten million sites have 155 million facets.)
typedef struct {
    // Area.
    double area;
    // The caller's index of the site beyond it.
    uint neighbor;
    // Zero.
    uint unused;
} FacetRecord;

// core/src/power_octree.rs

// A box that is to be split.
typedef struct {
    // Lower corner.
    double lo[3];
    // Upper corner.
    double hi[3];
    // Where the leaves that it lists begin among those of all such boxes.
    uint begin;
    // How many there are.
    uint count;
    // Its number among all boxes.
    uint node;
    // How often in a row it and those before have listed nearly as much as the box before.
    uint barren;
} OctreeBox;

// backend-ocl/src/interface/data.rs

// Voxels to each side, along each axis, that the table of offsets (`shells.rs`) holds.
#define SHELL_RADIUS ((uint)(6))

// Entries of the table of offsets, and how many of them are about the own voxel.
#define SHELLS ((uint)(2197))

#define INNER_SHELLS ((uint)(27))

// A voxel with more sites than this is crowded: the table is blind inside it, and the tree over all sites is searched alone.
#define CROWDED ((uint)(64))

// Sites from all over that a cell is cut by where it reaches to other parts of the domain.
#define SAMPLE ((uint)(512))

// Room for a cell that is too large for local memory, in units of 8 bytes.
#define VAST_WORDS ((uint)(77000))

// Room for the sites that bound a cell far off, kept for others of its block of leaves, and for their number.
#define MOST_KEPT ((uint)(32))

// The turns of cells where some keep these sites for others: 0 is theirs, 1 that of the others. Where none does all have this one.
#define ALL_TURNS ((uint)(2))

// Work-items that go over the leaves of a box of the octree over the container: a box lists some sixty where it is split last.
#define OCTREE_GROUP ((uint)(64))

// The home of a site that is not known, and that of one that no box lists.
#define NO_BOX ((uint)(0xfffffffe))

#define NO_HOME ((uint)(0xffffffff))

// Levels of the tree at most.
#define MOST_TREE_LEVELS ((uint)(12))

// Work-items of a group where sites are sorted, and the elements that each of them scans.
#define GRID_GROUP ((uint)(256))

#define SCAN_EACH ((uint)(8))

// Work-items of a group that bounds nodes of the tree: as many as sites of a sample.
#define NODES_GROUP ((uint)(64))

// Work-items of a group that looks around a block of leaves.
#define RINGS_GROUP ((uint)(64))

// Numbers of a cell, of those that tell how far a facet may go.
#define CELL_NUMBERS ((uint)(8))

// The numbers that each of them adds up.
#define SUM_EACH ((uint)(16))

// Sums over all cells (`totals.cl`): cells that are not empty; those not certified; volumes; of those below 0; their squares; the energy; the displacement.
#define TOTALS ((uint)(7))

// The elements that each of them sorts at a time; bits of a digit, and how many values it has.
#define SORT_EACH ((uint)(8))

#define DIGIT_BITS ((uint)(4))

#define DIGITS ((uint)(16))

// Sums that are written for each cell: volume and first moment; the second moments; all; and last the integral.
#define FEW_SUMS ((uint)(4))

#define MOMENT_SUMS ((uint)(10))

#define ALL_SUMS ((uint)(18))

// The outcome of a cell that this device did not compute: a coincident site's, or another device's.
#define NOT_COMPUTED ((uint)(0xffffffff))

// A row of the Laplacian with more facets is long: its work-items would take too long to sort it.
#define LONG_ROW ((uint)(512))

// Work-items that share out the facets of a row: it has 15.5 where sites are white. (By one, neighboring work-items read and wrote far apart.)
#define PER_ROW ((uint)(16))

// Work-items of a group that makes a row of a product of matrices.
#define ROW_GROUP ((uint)(32))

// The outcome of a cell: its status, and beside it whether exact arithmetic was needed, and whether it is uncertified.
#define OUTCOME_STATUS ((uint)(0xff))

#define OUTCOME_EXACT ((uint)(0x100))

#define OUTCOME_UNCERTIFIED ((uint)(0x200))

// Scalars of an evaluation.
typedef struct {
    // Initial cell: the box, or the domain's grid.
    double box_lo[3];
    double box_hi[3];
    // Site grid: minimum corner, width of the voxels and its inverse; largest and smallest weight of all.
    double grid_lo[3];
    double grid_width;
    double grid_per_width;
    double largest_weight;
    double smallest_weight;
    // Domain grid: minimum corner, width of the voxels and its inverse.
    double domain_lo[3];
    double domain_width;
    double domain_per_width;
    // 1 + ε of the paper's security radius, or 0 for a proof.
    double enlarged;
    // `Frame`: x' = (x − shift) / unit, and what is taken as zero.
    double frame_shift[3];
    double frame_unit;
    double frame_smallest;
    // What the monomials of the polynomial to be integrated are about.
    double origin[3];
    // What the Laplacian is in units of.
    double laplacian_unit;
    // How far a place may be off where the octree over the container tells the sites of least power; 0 where there is no octree.
    double octree_off;
    // Where the records of this batch will stand among all.
    ulong facet_base;
    // How many sums are written for each cell.
    ulong sums_width;
    uint grid_dims[3];
    uint domain_dims[3];
    uint has_domain;
    // The tree over the sites (`SiteTree`): where the blocks of each level begin, the root's level, the number of sites.
    uint tree_begin[MOST_TREE_LEVELS];
    uint tree_top;
    uint tree_sites;
    // 1: the table of offsets is gone through first.
    uint has_table;
    // What to compute: the flags of `integrate_cell`.
    uint flags;
    // 1: all weights are the same; 0 also where they will differ soon.
    uint equal_weights;
    // Room for facet records.
    uint facet_room;
    // Nodes of the quadrature rule, and the polynomial's degree.
    uint nodes;
    uint degree;
    // Room for records of finished cells.
    uint given_room;
    // Room for those of cells that have been begun.
    uint begun_room;
    // Leaves that are looked at for a cell that reaches far, before it is completed by its vertices: where weights differ, and else in stages that do that.
    uint leaves_if_far;
} Params;

// Range of the sites of one group, or of all.
typedef struct {
    double lo[3];
    double hi[3];
    double smallest_weight;
    double largest_weight;
} Range;

// What the cells of a run count.
typedef struct {
    // Lengths of the lists of cells that did not end.
    uint surface;
    uint later;
    uint full;
    uint left;
    // The most sites that a cell visited.
    uint visited;
    // Facet records.
    uint facets;
    // The most triangles that a cell tried.
    uint tried;
    // Length of the records of finished cells.
    uint given;
    // Of those for later, those that reach beyond what was searched, or have more half-spaces than there is room for.
    uint beyond;
    // Length of the records of cells that have been begun; more than there is room for where some had none.
    uint begun;
} Counters;

// backend-ocl/src/interface/kernels.rs

// Sites and domain.
typedef struct {
    __global const Params *params;
    // Sorted sites: x, y, z, weight.
    __global const double4 *sites;
    // Where the sites of each voxel begin and end, where the table of offsets is gone through.
    __global const uint2 *voxels;
    // The tree over the sites, block by block.
    __global const Boxes *boxes;
    __global const Slabs *slabs;
    __global const WeightBounds *weight_bounds;
    // What the sites around each block of leaves weigh at most, less its slope, ring by ring, where the table of offsets is gone through and weights differ.
    __global const double *around;
    // The octree over the container: where the parts of each box begin, or the leaves that it lists, and how many these are; these leaves; the box
    // that each sorted site's cell is in; and the boxes' middles.
    __global const uint2 *octree_nodes;
    __global const uint *octree_leaves;
    __global const uint *octree_homes;
    __global const double4 *octree_middles;
    __global const double *domain_vertices;
    // Corners, and how often it stands.
    __global const uint4 *triangles;
    __global const uint *lowest_voxels;
    __global const uint *list_offsets;
    __global const uint *list_entries;
    __global const int *windings;
    __global const uint *surface_table;
    // Nodes and coefficients of the function to be integrated, if there is one.
    __global const double *integrand;
} World;
#define WORLD_OF_ARGUMENTS ((World){ \
    .params = params, \
    .sites = sites, \
    .voxels = voxels, \
    .boxes = boxes, \
    .slabs = slabs, \
    .weight_bounds = weight_bounds, \
    .around = around, \
    .octree_nodes = octree_nodes, \
    .octree_leaves = octree_leaves, \
    .octree_homes = octree_homes, \
    .octree_middles = octree_middles, \
    .domain_vertices = domain_vertices, \
    .triangles = triangles, \
    .lowest_voxels = lowest_voxels, \
    .list_offsets = list_offsets, \
    .list_entries = list_entries, \
    .windings = windings, \
    .surface_table = surface_table, \
    .integrand = integrand \
})

#define CELLS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    __global const uint2 *voxels, \
    __global const Boxes *boxes, \
    __global const Slabs *slabs, \
    __global const WeightBounds *weight_bounds, \
    __global const double *around, \
    __global const uint2 *octree_nodes, \
    __global const uint *octree_leaves, \
    __global const uint *octree_homes, \
    __global const double4 *octree_middles, \
    __global const double *domain_vertices, \
    __global const uint4 *triangles, \
    __global const uint *lowest_voxels, \
    __global const uint *list_offsets, \
    __global const uint *list_entries, \
    __global const int *windings, \
    __global const uint *surface_table, \
    __global const double *integrand, \
    __global const uchar4 *shells, \
    __global const int2 *abouts, \
    __global const uint *order, \
    __global const uint *list, \
    uint has_list, \
    uint first, \
    uint stride, \
    uint apart, \
    uint count, \
    uint interior_only, \
    uint turn_of, \
    __global const uint *leaders, \
    __global uint *kept, \
    __global uint *outcome, \
    __global double *sums, \
    __global ulong2 *rows, \
    __global FacetRecord *facets, \
    __global double *facet_moments, \
    __global FacetSecond *facet_seconds, \
    volatile __global Counters *counters, \
    __global uint *surface, \
    __global uint *later, \
    __global uint *full, \
    __global uint *left, \
    __global uint4 *given, \
    __global uint4 *begun, \
    __global uint *begun_places, \
    __global ulong *vast

#define ENTER_SITES_ARGUMENTS \
    __global const Params *params, \
    __global const double *positions, \
    __global const double *weights, \
    uint has_weights, \
    uint count, \
    __global double4 *placed, \
    __global Range *ranges

#define MARK_VOXELS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *placed, \
    uint count, \
    __global uint *marks

#define RANK_SITES_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *placed, \
    uint count, \
    __global const uchar2 *turns, \
    uint levels, \
    uint finer, \
    __global ulong *ranks, \
    __global uint *slots

#define COUNT_DIGITS_ARGUMENTS \
    __global const ulong *ranks, \
    uint count, \
    uint shift, \
    __global uint *counts

#define PLACE_DIGITS_ARGUMENTS \
    __global const ulong *ranks, \
    __global const uint *slots, \
    uint count, \
    uint shift, \
    __global const uint *starts, \
    __global ulong *new_ranks, \
    __global uint *new_slots

#define SCAN_BLOCKS_ARGUMENTS \
    __global uint *data, \
    uint count, \
    __global uint *sums

#define ADD_BLOCKS_ARGUMENTS \
    __global uint *data, \
    uint count, \
    __global const uint *sums

#define SETTLE_RUNS_ARGUMENTS \
    __global const double4 *placed, \
    __global const ulong *ranks, \
    uint count, \
    uint most, \
    __global uint *slots, \
    __global uint *kept, \
    __global uint *is_long

#define GATHER_SITES_ARGUMENTS \
    __global const double4 *placed, \
    __global const uint *slots, \
    __global const uint *places, \
    uint count, \
    __global double4 *sites, \
    __global uint *order

#define FIND_VOXELS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    uint count, \
    __global uint2 *voxels, \
    __global uint *crowded

#define BOUND_NODES_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    uint level, \
    uint blocks, \
    __global Boxes *boxes, \
    __global Slabs *slabs, \
    __global WeightBounds *weight_bounds

#define LOOK_AT_RINGS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    __global const Boxes *boxes, \
    __global const WeightBounds *weight_bounds, \
    __global double *around

#define TIGHTEN_SLABS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    uint level, \
    __global Slabs *slabs

// Boxes of the octree over the container that are split, and the leaves that they list.
typedef struct {
    __global const Params *params;
    __global const double4 *sites;
    __global const OctreeBox *boxes;
    __global const uint *leaves;
    double margin;
    // 1 for each leaf of a box that a part keeps, part by part.
    __global uchar *kept;
} Splitting;
#define SPLITTING_OF_ARGUMENTS ((Splitting){ \
    .params = params, \
    .sites = sites, \
    .boxes = boxes, \
    .leaves = leaves, \
    .margin = margin, \
    .kept = kept \
})

#define SPLIT_BOXES_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    __global const OctreeBox *boxes, \
    __global const uint *leaves, \
    double margin, \
    __global uchar *kept, \
    __global uint *counts

#define FIND_LEASTS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    __global const OctreeBox *boxes, \
    __global const uint *leaves, \
    double margin, \
    __global uchar *kept, \
    uint slices, \
    uint is_second, \
    __global const uint *firsts, \
    __global uint *leasts

#define MARK_SLICES_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    __global const OctreeBox *boxes, \
    __global const uint *leaves, \
    double margin, \
    __global uchar *kept, \
    uint slices, \
    uint is_second, \
    __global const uint *leasts, \
    volatile __global uint *firsts, \
    volatile __global uint *counts

#define JUDGE_PARTS_ARGUMENTS \
    __global const OctreeBox *boxes, \
    __global const uint *counts, \
    uint parts, \
    uint depth, \
    uint most, \
    __global uint *splits, \
    __global uint *wholes, \
    __global uint *lists, \
    __global uint *unlisted

#define PLACE_LEAVES_ARGUMENTS \
    __global const OctreeBox *boxes, \
    __global const uint *leaves, \
    __global const uchar *kept, \
    __global const uint *counts, \
    __global const uint *splits, \
    __global const uint *wholes, \
    __global const uint *lists, \
    uint most, \
    uint first, \
    uint before, \
    __global OctreeBox *next_boxes, \
    __global uint *next, \
    __global uint *listed, \
    __global uint2 *nodes, \
    __global double4 *middles

#define FIND_HOMES_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    __global const uint2 *nodes, \
    __global const double4 *middles, \
    __global const uint *listed, \
    uint is_second, \
    volatile __global uint *ways, \
    volatile __global uint *homes

#define MEASURE_CLEARANCES_ARGUMENTS \
    __global const Params *params, \
    __global const uint *surface_table, \
    uint count, \
    __global uchar *clearances

#define CHOOSE_LEADERS_ARGUMENTS \
    __global const uint *list, \
    uint has_list, \
    uint first, \
    uint count, \
    volatile __global uint *leaders

#define LOOK_ABOUT_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    uint first, \
    uint count, \
    __global const uchar *clearances, \
    __global const int *windings, \
    __global int2 *abouts

#define COUNT_ROWS_ARGUMENTS \
    uint count, \
    __global const uint *outcome, \
    __global const ulong2 *rows, \
    __global uint *counts

#define WRITE_ROWS_ARGUMENTS \
    __global const Params *params, \
    uint count, \
    __global const double4 *placed, \
    __global const ulong2 *rows, \
    __global const FacetRecord *records, \
    __global const double *moments, \
    uint has_seconds, \
    __global const FacetSecond *seconds, \
    __global const uint *offsets, \
    double area_unit, \
    double second_unit, \
    __global uint *neighbors, \
    __global double *areas, \
    __global double *barycenters, \
    __global double *distances, \
    __global double *second_moments

#define COUNT_FACETS_ARGUMENTS \
    __global const uint *order, \
    uint count, \
    __global const uint *outcome, \
    __global const ulong2 *rows, \
    __global uint *place, \
    __global uint *counts, \
    __global uint *is_long

#define LIST_FACETS_ARGUMENTS \
    __global const uint *order, \
    uint count, \
    __global const ulong2 *rows, \
    __global const FacetRecord *records, \
    __global const uint *place, \
    __global const uint *offsets, \
    __global uint *listed

#define SORT_FACETS_ARGUMENTS \
    __global const uint *order, \
    uint count, \
    __global const ulong2 *rows, \
    __global const FacetRecord *records, \
    __global const uint *listed, \
    __global const uint *offsets, \
    __global uint *columns, \
    __global double *areas

#define MATCH_FACETS_ARGUMENTS \
    __global const Params *params, \
    __global const double4 *sites, \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *areas, \
    __global FacetRecord *records, \
    __global uint *counts

#define PACK_FACETS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const FacetRecord *records, \
    __global const uint *starts, \
    __global uint *packed_columns, \
    __global double *packed_values

#define FILL_LAPLACIAN_ARGUMENTS \
    uint count, \
    __global const uint *starts, \
    __global const uint *packed_columns, \
    __global const double *packed_values, \
    double scale, \
    __global uint *offsets, \
    __global uint *columns, \
    __global double *values

#define GATHER_CELLS_ARGUMENTS \
    __global const Params *params, \
    uint count, \
    __global const uint *order, \
    __global const double4 *sites, \
    __global const uint *outcome, \
    __global const double *sums, \
    double per_unit, \
    __global double *cells

#define SUM_CELLS_ARGUMENTS \
    __global const Params *params, \
    uint count, \
    __global const double4 *placed, \
    __global const uint *outcome, \
    __global const double *sums, \
    __global double *parts

#define MOVE_SITES_ARGUMENTS \
    __global const Params *params, \
    uint count, \
    __global const double4 *placed, \
    __global const uint *outcome, \
    __global const double *sums, \
    __global const double *positions, \
    __global double *moved

#define TRY_LANES_ARGUMENTS \
    __global uint *right

// backend-ocl/src/interface/algebra.rs

#define MULTIPLY_ARGUMENTS \
    uint count, \
    uint per_row, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *x, \
    __global double *y, \
    uint width, \
    uint which, \
    uint subtracts

#define COMBINE_ARGUMENTS \
    uint count, \
    double alpha, \
    uint has_scales, \
    __global const double *scales, \
    __global const double *x, \
    double beta, \
    __global double *y

#define SMOOTH_ARGUMENTS \
    uint count, \
    uint per_row, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double alpha, \
    double beta, \
    uint has_last, \
    uint is_nothing, \
    __global const double *last, \
    __global double *residual, \
    __global double *step, \
    __global double *solution

#define DOT_PARTS_ARGUMENTS \
    uint count, \
    __global const double *x, \
    __global const double *y, \
    __global double *parts

#define SUM_PARTS_ARGUMENTS \
    uint count, \
    __global const double *x, \
    __global double *parts

#define SUBTRACT_NUMBER_ARGUMENTS \
    uint count, \
    double number, \
    __global double *x

#define INVERT_DIAGONAL_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global double *inverse

#define FIND_BEYOND_ARGUMENTS \
    uint count, \
    __global const double *x, \
    double factor, \
    __global const double *bounds, \
    __global uint *is_found

#define FIND_RISEN_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *x, \
    __global const double *cells, \
    double share, \
    double flattest, \
    __global uint *is_found

#define STIFFEN_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *x, \
    __global const double *cells, \
    double share, \
    double flattest, \
    __global uint *made_offsets, \
    __global uint *made_columns, \
    __global double *made_values

#define PART_CELLS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *cells, \
    double depth, \
    __global double *changes

#define RANK_FREE_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double strong, \
    __global const uint *root, \
    __global uint *ranks, \
    __global uint *is_found

#define SPREAD_RANKS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double strong, \
    __global const uint *ranks, \
    __global uint *near

#define CHOOSE_ROOTS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double strong, \
    __global const uint *ranks, \
    __global const uint *near, \
    __global uint *root

#define JOIN_ROOTS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double strong, \
    __global uint *root

#define JOIN_REST_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double strong, \
    __global const uint *root, \
    __global uint *joined, \
    __global uint *numbers

#define PROLONG_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const double *inverse, \
    double strong, \
    double omega, \
    __global const uint *joined, \
    __global const uint *numbers, \
    uint fills, \
    __global uint *starts, \
    __global uint *made_columns, \
    __global double *made_values, \
    __global uint *is_found

#define COUNT_COLUMNS_ARGUMENTS \
    uint count, \
    __global const uint *columns, \
    __global uint *counts

#define LIST_COLUMNS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const uint *starts, \
    __global uint *listed, \
    __global uint *listed_rows, \
    __global uint *listed_places

#define SORT_COLUMNS_ARGUMENTS \
    __global const uint *starts, \
    __global const double *values, \
    __global const uint *listed_rows, \
    __global const uint *listed_places, \
    __global uint *made_columns, \
    __global double *made_values

#define MULTIPLY_ROWS_ARGUMENTS \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global const double *values, \
    __global const uint *other_offsets, \
    __global const uint *other_columns, \
    __global const double *other_values, \
    uint fills, \
    __global uint *starts, \
    __global uint *made_columns, \
    __global double *made_values, \
    __global uint *is_found

#define BALANCE_ROWS_ARGUMENTS \
    uint count, \
    __global const uint *offsets, \
    __global const uint *columns, \
    __global double *values

// backend-ocl/src/interface/parity.rs

// All that `parity.cl` has: the words of each of `count` calls stand in a row; `table` begins with where its parts do.
#define PARITY_ARGUMENTS \
    __global const Params *params, \
    __global const double *domain_vertices, \
    __global const uint *table, \
    __global const double *integrand, \
    __global const ulong *inputs, \
    uint input_width, \
    __global ulong *outputs, \
    uint output_width, \
    uint count

// Sizes as on the host: a compiler that pads does not build this.
typedef char size_of_Boxes[(sizeof(Boxes) == 384) ? 1 : -1];
typedef char size_of_WeightBounds[(sizeof(WeightBounds) == 448) ? 1 : -1];
typedef char size_of_Slabs[(sizeof(Slabs) == 384) ? 1 : -1];
typedef char size_of_FacetRecord[(sizeof(FacetRecord) == 16) ? 1 : -1];
typedef char size_of_OctreeBox[(sizeof(OctreeBox) == 64) ? 1 : -1];
typedef char size_of_Params[(sizeof(Params) == 368) ? 1 : -1];
typedef char size_of_Range[(sizeof(Range) == 64) ? 1 : -1];
typedef char size_of_Counters[(sizeof(Counters) == 40) ? 1 : -1];
