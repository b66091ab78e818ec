// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/cell_types.cl"

// core/src/cell/search_store.rs

// Sites in a leaf of the tree, and nodes in a block.
#define WIDTH ((uint)(8))

// A site's number that no site has.
#define NO_SITE ((uint)(0xFFFFFFFF))

// Open blocks, leaves at hand, and candidates that there is room for: see `search.rs`.
#define MOST_OPEN ((uint)(124))

// Leaves.
#define MOST_LEAVES ((uint)(40))

// Candidates.
#define MOST_CANDIDATES ((uint)(112))

// Leaves whose sites become candidates at one time.
#define LEAVES_AT_ONCE ((uint)(4))

// Sites that are kept, or come from all over, that become candidates at a time: no more than there is room for.
#define KEPT_AT_ONCE ((uint)(96))

// The box of a node's sites, in the diagram's frame.
typedef struct {
    // Minimum corner.
    V3 lo;
    // Maximum corner.
    V3 hi;
} NodeBox;

// An upper bound of the weights of a node's sites, less the least weight of all: `c + g·(x − m) + Σ q_k (x − m)_k²`, m the middle of its box.
typedef struct {
    // c, with room for the roundings of evaluating it.
    real offset;
    // g.
    V3 slope;
    // q.
    V3 curvature;
} NodeWeights;

// A slab `lo ≤ n·x ≤ hi` that holds a node's sites, and the largest of their weights, less the least of all.
typedef struct {
    // n, a unit vector.
    V3 normal;
    // Rounded down.
    real lo;
    // Rounded up.
    real hi;
    // Of the weights.
    real largest;
} NodeSlab;

// A vertex at which the search asks for the site of least power.
typedef struct {
    // Its number in the store.
    uint vertex;
    // Its place, from the cell's site.
    V3 place;
    // The cell's own power there.
    real own;
    // What its error radius takes from a power: this, and this share of the square of the site's distance.
    real lost;
    // The share.
    real lost_of_square;
    // How far along each axis the place is off at most.
    real radius;
    // Beyond this power no site can have less than the cell; of the first, also not less than the site that was found.
    real limit;
} Asked;

// A vertex in the precision of bounds.
typedef struct {
    // Its place, from the cell's site.
    float x;
    // The same.
    float y;
    // The same.
    float z;
    // How far along each axis it is off that place at most.
    float radius;
} RoughVertex;

// What is found at an asked vertex.
typedef struct {
    // Its number in the store, or `NO_SITE` where none was asked for.
    uint vertex;
    // The site that certainly has less power there, or `NO_SITE`.
    uint found;
    // How many candidates may have: that site alone, or where there is none those that tie; `NO_SITE` where the vertex is not known well.
    uint ties;
    // How many of those that tie, from the first on, were tried before, as far as it was looked: where there is one team it is not.
    uint tried;
} Answer;

// The count of a box of the octree over the container that has parts, and of one that lists too many leaves.
#define HAS_PARTS ((uint)(0xFFFFFFFF))

// Too many.
#define UNLISTED ((uint)(0xFFFFFFFE))

// A box of the octree over the container: where the leaves that it lists begin, and how many there are; or where its eight parts begin.
typedef struct {
    // Where they begin.
    uint begin;
    // How many leaves, or [`HAS_PARTS`], or [`UNLISTED`].
    uint count;
} OctreeNode;

// What the octree over the container tells of a site's cell: nothing; where it is; or that no box lists the site, whose cell is empty.
#define HOME_UNKNOWN ((uint)(0))

// Where it is.
#define HOME_KNOWN ((uint)(1))

// It is empty.
#define HOME_NOWHERE ((uint)(2))

// core/src/cell/quadratic.rs

// Roundings of a sum of some twenty terms, in units of the sum of their sizes.
#define FEW_ROUNDINGS_OF_SUM ((real)(REAL(64.0) * UNIT_ROUNDOFF))

// core/src/cell/bound.rs

// The site whose cell is searched.
typedef struct {
    // Its place.
    V3 site;
    // What it weighs more than the lightest of all.
    real excess;
    // Whether weights differ.
    bool has_weights;
} Seer;

// core/src/cell/octree.rs

// Roundings of a difference of powers.
#define ROUNDINGS_OF_MORE ((real)(REAL(32.0) * UNIT_ROUNDOFF))

// By how much a box is taken to be larger on each side, as a share of the container's extent: a place may be off by a quarter of it.
#define OCTREE_MARGIN ((real)(REAL(1e-9)))

// A box that lists so many leaves of eight sites, or fewer, is not split. (With 10 the octree takes twice as long, with 32 the cells do.)
#define FEW_LISTED ((uint)(20))

// A box is split so often at most.
#define MOST_DEPTH ((uint)(18))

// Nor is it where it lists more than this share of what the box before lists, twice in a row: sites that nearly tie, as at a sphere's middle.
#define BARREN ((real)(REAL(0.8)))

// How often in a row that may be.
#define MOST_BARREN ((uint)(2))

// Places of a box whose sites of least power leave others out: its middle, and the middles of its faces.
#define OCTREE_PLACES ((uint)(7))

// A site, as a box of the octree sees it.
typedef struct {
    // Its place.
    V3 place;
    // What it weighs more than the lightest of all.
    real excess;
    // The square of its distance from the box's middle.
    real square;
} SeenSite;

// core/src/cell/tree.rs

// Bits of an open block that say which of its level it is; those above say its level.
#define LEVEL_SHIFT ((uint)(28))

#define BLOCK_MASK ((uint)(0x0FFFFFFF))

// Open blocks from which on one is taken at a time: of four every child may be open, and of one on each level seven of eight.
#define FEW_OPEN ((uint)(32))

// What is asked of a site at the way `d`, of excess `w`: whether `αd² + g·d − w` is below a limit; or of the asked vertices whose bits are in
// `vertices`, whether its power there is below theirs.
typedef struct {
    // α.
    real square;
    // g.
    V3 slope;
    real limit;
    // 0 where no vertex is asked for.
    uint vertices;
    // Whether it is instead whether a site may cut the cell at a vertex that is not settled.
    bool sweeps;
    // Whether nodes that hold the site's own leaf's block are opened, too.
    bool opens_own;
} Question;

// The open blocks and the leaves at hand.
typedef struct {
    uint blocks;
    uint leaves;
} Open;

// A box of the octree over the container.
typedef struct {
    V3 lo;
    V3 hi;
    // Of it.
    real diagonal;
    // What it lists.
    OctreeNode node;
} OctreePlace;

// core/src/cell/search.rs

// All sites are visited first that are within [`NEAR_SQUARE`] times, as a square, the distance of the `NEAR_SITES`th of the own leaf's block: of white
// noise some forty.
#define NEAR_SITES ((uint)(8))

#define NEAR_SQUARE ((real)(REAL(2.25)))

// What a key may round off, as a share, and where numbers underflow.
#define ROOM_OF_KEY ((real)(REAL(1.000004)))

#define LEAST_OF_KEY ((real)(REAL(1e-37)))

// From a key up, what of it is certainly below the square that it was rounded from, where that does not underflow.
#define SHARE_OF_KEY ((real)(REAL(0.99999)))

#define LEAST_TO_SHARE ((real)(REAL(1e-30)))

// For a cell that then reaches this many times as far, as a square, few leaves or none are looked at before it is completed by its vertices
// (`SearchStore::leaves_if_far`), and for any so many leaves, or sites, at most. (With 100 instead of 500 a million sites of a Lévy flight take 0.262 s instead of 0.197, with
// 3,000 on a bumpy surface 0.299 instead of 0.288; one NVIDIA H200.)
#define FAR_SQUARE ((real)(REAL(500.0)))

#define MOST_NEAR_LEAVES ((uint)(400))

#define MOST_NEAR_SITES ((uint)(400))

// A cell that then reaches this many times as far, as a square, is cut by what may cut it at a vertex, where the store says so (`SearchStore::is_swept`), and else by all that it reaches: how far a
// node is takes less to find, but a long cell reaches much that cannot cut it. (8,253 cells of transport in a domain, 300 leaves looked at for each and 11 vertices asked for, then: 4.9 ms, swept 3.8; of a million
// sites with weights 0.5 |x|² 10,554: 5.1 and 2.0. With 1, 16 and 64: 3.9, 4.9 and 5.5 of the first, 1.9, 2.2 and 3.0 of the second; and with 1 those with -2 |x|² 3.1 instead of 2.8. One NVIDIA H200.)
#define SWEPT_SQUARE ((real)(REAL(4.0)))

// What is searched: all near a cell, and then what it reaches; sites that are known to bound what is beside it far off, or come from all over; and all that can still cut it at a vertex (`sweep.rs`).
#define NEAR ((uint)(0))

// The second.
#define KEPT ((uint)(1))

// The third.
#define SWEEP ((uint)(2))

// Leaves that are looked at before a sweep is given up, and sites visited: bounds in single precision may tell little apart.
#define MOST_SWEPT_LEAVES ((uint)(400))

#define MOST_SWEPT_SITES ((uint)(200))

// Room for the roundings of a limit.
#define SAFE ((real)(REAL(1.0) + (REAL(16.0) * UNIT_ROUNDOFF)))

// The largest curvature of the weights that is reckoned with: of more, near neighbours hide a cell.
#define MOST_CURVATURE ((real)(REAL(0.96)))

// From where a cell is searched: as weights lead to it, or as an octree over the container tells.
typedef struct {
    // g, the slope of the weights at the site.
    V3 slope;
    // −g/2.
    V3 center;
    // λ.
    real lambda;
    // What the octree tells (`HOME_KNOWN`, …).
    uint home;
} Vantage;

// What becomes a candidate of the sites that are met: keys from `above` on and below `below`.
typedef struct {
    uint above;
    uint below;
} Wanted;

// core/src/cell/sweep.rs

// What single precision rounds off, of what is multiplied: 46 roundings at most (see `may_cut_at`), 2.75e-6.
#define SWEEP_ROUNDINGS ((float)(REAL(3e-6)))

#define SWEEP_OUTWARD ((real)(REAL(1e-6)))

// Where its squares underflow.
#define SWEEP_LEAST_SQUARE ((float)(REAL(1e-30)))

#define SWEEP_NOTHING ((float)(REAL(0.0)))

// 2, and what `may_cut_at` rounds off of it.
#define SWEEP_TWICE ((float)(REAL(2.00001)))

// 2, with room for roundings.
#define SWEPT_TWICE ((real)(REAL(2.0) + (REAL(16.0) * UNIT_ROUNDOFF)))

#define SWEEP_MINUS_TWICE ((float)(-REAL(2.0)))

// A place in single precision, from the cell's site.
typedef struct {
    float x;
    float y;
    float z;
} RoughPlace;

// What holds a node's sites, from the cell's: a box, and a slab `below ≤ n·x ≤ above`.
typedef struct {
    RoughPlace lo;
    RoughPlace hi;
    RoughPlace normal;
    float below;
    float above;
    // How far the box reaches along its axes in all, and the slab along its normal.
    float size;
} RoughNode;

// core/src/cell/far.rs

// Times a vertex's error radius, what a length of the way to the site adds: 2√3, and as much again for the bound's own roundings.
#define PER_LENGTH ((real)(REAL(8.0)))

// Room for the roundings of a distance, and of what a place is off by about a center.
#define ROOM_OF_DISTANCE ((real)(REAL(1.0) + (REAL(32.0) * UNIT_ROUNDOFF)))

// Vertices up to which every team looks at all. (Were there no shares, the eighth of eight teams would go over all vertices eight times, in global memory: of a million sites with
// lognormal radii the 450 largest cells took 28.6 instead of 20.4 ms. Where four teams had shares of more than 64 vertices cells took 3 to 9 % longer: what is not farthest cuts less.
// One NVIDIA H200.)
#define MOST_UNSHARED ((uint)(256))

// Vertices that are not settled that a lane compares at most: a cell of a heavy site may have ten thousand.
#define MOST_COMPARED ((uint)(64))

// What a power loses with the square of the distance is kept to half the inverse of this.
#if SINGLE
#define LENGTHS_OF_LOST ((real)(REAL(1e3)))
#else
#define LENGTHS_OF_LOST ((real)(REAL(1e10)))
#endif

// Of a place at the site itself.
#if SINGLE
#define LEAST_LENGTH ((real)(REAL(1e-15)))
#else
#define LEAST_LENGTH ((real)(REAL(1e-150)))
#endif

// Which vertices a team looks at: as many in a row as it has lanes, from the first on and again after every `step`.
typedef struct {
    uint first;
    uint step;
} Share;

// core/src/cell/boxes.rs

// Cuts after which it is looked which of a box's candidates may still cut the cell.
#define CUTS_IN_BOX ((uint)(6))

// Beyond all that is in a container.
#if SINGLE
#define NO_END ((real)(REAL(1e30)))
#else
#define NO_END ((real)(REAL(1e300)))
#endif

// core/src/cell/ring.rs

// How many rings there are. The last has no end.
#define RINGS ((uint)(16))

// core/src/cell/candidates.rs

// Lanes that hold a candidate within reach, at least, for that to be worth while.
#define WORTH_A_LOOK ((uint)(4))

// One of the candidates that a lane holds.
typedef struct {
    // Its key, or `NO_SITE` of none.
    uint key;
    // Its number.
    uint number;
} Held;

// core/src/cell/table.rs

// What is allowed for the roundings of a distance in voxels, in single precision and below 16, and of its square.
#define SLACK_IN_VOXELS ((float)(REAL(1e-5)))

#define SAFE_IN_VOXELS ((float)(REAL(1.00001)))

// Where weights differ a cell which sites may cut that are, as squared voxels, farther than this when the voxels about its own, so many offsets, have been gone through, is given up: it would go through what is
// left of the table, most often in vain. (Of 215,222 cells of transport in a domain the table proves 77 %, in 7.5 ms; given up so, with 6 voxels, 77 % in 4.2, with 4 voxels 73 % in 3.8; lognormal radii are
// found sooner by the tree where they need more than 4. After 125 offsets, with 6 voxels, 4.3. One NVIDIA H200.)
#define TRIED_OFFSETS ((uint)(27))

#define WORTH_GOING_ON ((float)(REAL(16.0)))

// (Named, since a literal would be a `Real`, in double precision on devices.)
#define NO_GAP ((float)(REAL(0.0)))

#define ONE_VOXEL ((float)(REAL(1.0)))

#define HALF ((float)(REAL(0.5)))

// The number of what is no voxel.
#define NO_VOXEL ((uint)(0xFFFFFFFF))

// A voxel's place, in voxels from the site's own.
typedef struct {
    // Along x.
    int x;
    // Along y.
    int y;
    // Along z.
    int z;
    // A lower bound of the squared distance, in voxels, from any place in the site's voxel to this one and to all that come later, in the table or
    // not.
    float apart;
} Offset;

// A place in a voxel, in voxels.
typedef struct {
    // Along x.
    float x;
    // Along y.
    float y;
    // Along z.
    float z;
} VoxelPlace;

// Consecutive sorted sites.
typedef struct {
    // The first.
    uint begin;
    // One more than the last.
    uint end;
} SiteRange;

// core/src/cell/node.rs

// Sites of a sample, at most.
#define MOST_SAMPLED ((uint)(64))

// Sites from which on an affine, and a quadratic bound of weights are tried.
#define ENOUGH_FOR_SLOPE ((uint)(6))

#define ENOUGH_FOR_CURVATURE ((uint)(16))

// A bound of higher degree is taken where it leaves less than this share of the range of weights.
#define WORTH_A_DEGREE ((real)(REAL(0.6)))

// What is added to the diagonal of the normal equations for slopes and curvatures, as a share: flat sets of sites leave them open.
#define RIDGE_SHARE ((real)(REAL(1e-9)))

// Squarings of the matrix for the thinnest direction: any direction gives a true slab, a better one a thinner.
#define SQUARINGS ((uint)(5))

// The least that a width is taken for, and what no number of a bound exceeds.
#define LEAST_WIDTH ((real)(REAL(1e-300)))

#define LARGEST ((real)(REAL(1e300)))

// Coefficients of an affine function, and of a quadratic one.
#define AFFINE ((uint)(4))

#define QUADRATIC ((uint)(7))

// A symmetric matrix.
typedef struct {
    real xx;
    real yy;
    real zz;
    real xy;
    real yz;
    real zx;
} Symmetric;

// Normal equations of a quadratic function. (All loops over them are of a fixed length, so that they stay in registers on devices: with lengths that vary a tree over a million weighted sites took
// 3.5 ms, and without weights 0.9; one NVIDIA H200.)
typedef struct {
    real matrix[49];
    real right[7];
} Equations;

// What a polynomial leaves of the sampled weights: the range.
typedef struct {
    real top;
    real bottom;
} Rest;

// core/src/cell/around.rs

// A node whose extent is less than where its ring begins is not opened, nor one whose extent is less than this share of the block's own: a block that spans a gap
// between sites is as large as what it would be gone through.
#define SHARE_OF_BLOCK ((real)(REAL(0.25)))

// A block of leaves, around which sites are looked at.
typedef struct {
    NodeBox bounds;
    V3 middle;
    V3 slope;
    // The width of a voxel.
    real width;
} Around;

// What a site, or any of a node's, weighs at most, less the slope at the middle of the block.
typedef struct {
    // That.
    real most;
    // The ring that the nearest of it is in, at least.
    uint ring;
    // Whether its parts are not looked at.
    bool is_small;
} Seen;
