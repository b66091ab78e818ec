// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "cell_types.cl"

// core/src/cell/search_store.rs

// Sites in a leaf of the tree, and nodes in a block.
#define WIDTH ((uint)(8))

// A site's number that no site has.
#define NO_SITE ((uint)(0xFFFFFFFF))

// Open blocks, leaves at hand, and candidates that there is room for: see `search.rs`.
#define MOST_OPEN ((uint)(208))

// Leaves.
#define MOST_LEAVES ((uint)(40))

// Candidates.
#define MOST_CANDIDATES ((uint)(64))

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

// core/src/cell/tree.rs

// Roundings of a sum of some twenty terms, in units of the sum of their sizes.
#define FEW_ROUNDINGS_OF_SUM ((real)(REAL(64.0) * UNIT_ROUNDOFF))

// Bits of an open block that say which of its level it is; those above say its level.
#define LEVEL_SHIFT ((uint)(28))

#define BLOCK_MASK ((uint)(0x0FFFFFFF))

// Open blocks from which on one is taken at a time: of four every child may be open, and of one on each level seven of eight.
#define FEW_OPEN ((uint)(96))

// What is asked of a site at the way `d`, of excess `w`: whether `α|d|² + g·d − w + more` is below a limit.
typedef struct {
    // α.
    real square;
    // g.
    V3 slope;
    real more;
    real limit;
    // Where this is the power at a vertex: the vertex, and 1.
    V3 place;
    uint is_power;
} Question;

// The open blocks and the leaves at hand.
typedef struct {
    uint blocks;
    uint leaves;
} Open;

// core/src/cell/search.rs

// Leaves whose sites are candidates at one time.
#define LEAVES_AT_ONCE ((uint)(8))

// Sites of the own leaf's block that are visited first.
#define FIRST_SITES ((uint)(16))

// What a key may round off, as a share, and where numbers underflow.
#define ROOM_OF_KEY ((real)(REAL(1.000004)))

#define LEAST_OF_KEY ((real)(REAL(1e-37)))

// Leaves that a cell looks at, and sites that it visits, before it is completed by its vertices.
#define MOST_NEAR_LEAVES ((uint)(160))

#define MOST_NEAR_SITES ((uint)(240))

// The largest curvature of the weights that is reckoned with: of more, near neighbours hide a cell.
#define MOST_CURVATURE ((real)(REAL(0.96)))

// What is left of a product `ρs` of a vertex's error and a site's distance from it is taken as this share of `s²`, and its square over four
// times the share: any share is right, a small one keeps what is tried exactly rare.
#define SHARE_OF_SQUARE ((real)(REAL(0.0000000000009094947017729282)))

// Times a vertex's error radius, what a length of the way to the site adds: 2√3, and as much again for the bound's own roundings.
#define PER_LENGTH ((real)(REAL(8.0)))

// From where a cell is searched.
typedef struct {
    // g, the slope of the weights at the site.
    V3 slope;
    // −g/2.
    V3 center;
    // λ.
    real lambda;
} Vantage;

// What is visited of the sites that are met.
typedef struct {
    // Keys from `above` on and below `below`.
    uint above;
    uint below;
    // So many at most, and those that are as near as the last of them.
    uint most;
} Wanted;
