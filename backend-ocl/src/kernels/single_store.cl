// Where a cell lives whose numbers are single: in the private memory of its work-item, with all its half-spaces. Lengths are in a unit
// of the sites' (`Params` of `single_interface.cl`), so that products of four coefficients neither overflow nor underflow.

// Whether weights differ is asked at run time.
#define WITH_WEIGHTS 1

#import "generated/single_interface.cl"
#import "generated/tree_types.cl"
#import "rough.cl"

#define WORDS ((CAP_V + 31) / 32)

// What rounding to single precision adds to a place.
#define ROUGH REAL(0.0)

// Sites and domain, in global memory. What only cells at the surface need is not there: those are the host's.
typedef struct {
    __global const Params *params;
    // Sorted sites, x, y, z, weight, each as the sum of two numbers.
    __global const real4 *sites;
    __global const real4 *rests;
    // The tree over them.
    __global const Boxes *boxes;
    __global const Slabs *slabs;
    __global const WeightBounds *weight_bounds;
    __global const real *domain_vertices;
    __global const uint4 *triangles;
    __global const uint *lowest_voxels;
    __global const uint *list_offsets;
    __global const uint *list_entries;
    __global const int *windings;
    __global const uint *surface_table;
} World;

typedef struct {
    World world;
    // Triangles that the cell has tried, and one more than the last of them: each is tried once, with no other in between.
    uint tried;
    uint last_tried;
    // The cell's site, what its place and weight are more than these, and its sorted index.
    V3 site;
    real weight;
    real4 rest;
    uint own;
    uint exact;
    // Of the search: what of the tree is open, the leaves and candidates at hand, and the vertex that is asked for.
    uint open[MOST_OPEN];
    uint open_key[MOST_OPEN];
    uint leaf[MOST_LEAVES];
    uint leaf_key[MOST_LEAVES];
    uint candidate[MOST_CANDIDATES];
    uint candidate_key[MOST_CANDIDATES];
    Asked asked;
    // Whether a site was met that is too near for single numbers to tell what it does.
    uint is_too_near;
    // 1: half-spaces are moved outward by all that rounding may have moved them.
    uint is_widened;
    // Upper bound of the distance to the farthest vertex.
    real farthest;
    // Of the half-spaces that may bound the cell, how far rounding may have moved one of them: the first for each unit of distance from the
    // site.
    real tilt;
    real shift;
    // The least `n·v + d` of the half-space at hand.
    real least;
    uint planes;
    uint vertices;
    Plane plane[CAP_P];
    uint tag[CAP_P];
    ushort link[CAP_P];
    // Position and error radius.
    real4 rough[CAP_V];
    // Three indices of ten bits.
    uint triplet[CAP_V];
    uint conflict[WORDS];
    uint uncertain[WORDS];
} Store;

INLINE uint store_cap_p(Store *s) { return CAP_P; }
INLINE uint store_cap_v(Store *s) { return CAP_V; }
INLINE uint store_planes(Store *s) { return s->planes; }
INLINE void store_set_planes(Store *s, uint count) { s->planes = count; }
INLINE uint store_vertices(Store *s) { return s->vertices; }
INLINE void store_set_vertices(Store *s, uint count) { s->vertices = count; }

INLINE Plane store_plane(Store *s, uint f) { return s->plane[f]; }
INLINE void store_set_plane(Store *s, uint f, Plane plane) { s->plane[f] = plane; }
INLINE uint store_tag(Store *s, uint f) { return s->tag[f]; }
INLINE void store_set_tag(Store *s, uint f, uint tag) { s->tag[f] = tag; }
INLINE void store_move_plane(Store *s, uint from, uint to) {
    s->plane[to] = s->plane[from];
    s->tag[to] = s->tag[from];
}
INLINE uint store_link(Store *s, uint f) { return s->link[f]; }
INLINE void store_set_link(Store *s, uint f, uint link) { s->link[f] = (ushort)link; }
INLINE void store_toggle_link(Store *s, uint f, uint change) { s->link[f] ^= (ushort)change; }
INLINE bool store_was_toggled_once(Store *s, uint f) { return false; }

INLINE Triplet store_triplet(Store *s, uint v) {
    const uint t = s->triplet[v];
    return (Triplet){ .a = t & 1023u, .b = (t >> 10) & 1023u, .c = (t >> 20) & 1023u };
}
// Beside a triplet, that its vertex is settled (`tree_search.cl`).
#define SETTLED (1u << 30)
INLINE uint packed(Triplet t) { return t.a | (t.b << 10) | (t.c << 20); }
INLINE void store_set_triplet(Store *s, uint v, Triplet t) { s->triplet[v] = packed(t); }
INLINE void store_renumber(Store *s, uint v, Triplet t) { s->triplet[v] = packed(t) | (s->triplet[v] & SETTLED); }

INLINE V3 store_position(Store *s, uint v) {
    return (V3){ .x = s->rough[v].x, .y = s->rough[v].y, .z = s->rough[v].z };
}
INLINE real store_radius(Store *s, uint v) { return s->rough[v].w; }
INLINE void store_set_position(Store *s, uint v, V3 position, real radius) {
    s->rough[v] = (real4)(position.x, position.y, position.z, radius);
}
INLINE void store_move_vertex(Store *s, uint from, uint to) {
    s->triplet[to] = s->triplet[from];
    s->rough[to] = s->rough[from];
}

// Far above what underflow can lose of the products of a half-space and a vertex, far below what anything here is worth.
#define UNDERFLOW REAL(1e-30)

INLINE uint store_mark_conflicts(Store *s, uint k) {
    const Plane plane = s->plane[k];
    const real size = (fabs(plane.n.x) + fabs(plane.n.y)) + fabs(plane.n.z);
    const real slack = ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(plane.d)) + UNDERFLOW;
    uint seen = 0;
    s->least = INFINITY;
    for (uint first = 0; first < s->vertices; first += 32u) {
        const uint here = min(s->vertices - first, 32u);
        uint conflict = 0;
        uint keep = 0;
        for (uint b = 0; b < here; b++) {
            const real4 v = s->rough[first + b];
            const real value = (((plane.n.x * v.x) + (plane.n.y * v.y)) + (plane.n.z * v.z)) + plane.d;
            const real bound = (size * v.w) + slack;
            s->least = fmin(s->least, value - bound);
            conflict |= ((value < -bound) ? 1u : 0u) << b;
            keep |= ((value > bound) ? 1u : 0u) << b;
        }
        const uint uncertain = (0xFFFFFFFFu >> (32u - here)) & ~(conflict | keep);
        s->conflict[first >> 5] = conflict;
        s->uncertain[first >> 5] = uncertain;
        seen |= (conflict ? SEEN_CONFLICT : 0u) | (uncertain ? SEEN_UNCERTAIN : 0u) | (keep ? SEEN_KEEP : 0u);
    }
    return seen;
}

INLINE V3 store_farthest(Store *s) {
    real square = REAL(0.0);
    real radius = REAL(0.0);
    for (uint v = 0; v < s->vertices; v++) {
        const real4 p = s->rough[v];
        square = fmax(square, ((p.x * p.x) + (p.y * p.y)) + (p.z * p.z));
        radius = fmax(radius, p.w);
    }
    return (V3){ .x = square, .y = radius, .z = REAL(0.0) };
}

INLINE V3 store_site(Store *s) { return s->site; }

// From the cell's site to another: within `2u|d| + position_error`, componentwise.
INLINE V3 store_way_to(Store *s, uint j) {
    const real4 other = s->world.sites[j];
    const real4 rest = s->world.rests[j];
    const V3 d = (V3){ .x = (other.x - s->site.x) + (rest.x - s->rest.x), .y = (other.y - s->site.y) + (rest.y - s->rest.y),
                       .z = (other.z - s->site.z) + (rest.z - s->rest.z) };
    const real largest = fmax(fmax(fabs(d.x), fabs(d.y)), fabs(d.z));
    s->is_too_near |= (largest < s->world.params->least_distance) ? 1u : 0u;
    return d;
}
// What another site weighs more: within `2u|excess| + weight_error`.
INLINE real store_excess_of(Store *s, uint j) {
    return (s->world.sites[j].w - s->weight) + (s->world.rests[j].w - s->rest.w);
}
INLINE real store_own_excess(Store *s) { return s->weight; }
INLINE real store_largest_excess(Store *s) { return s->world.params->largest_weight - s->weight; }

// Only where cells meet the surface, or for facets.
INLINE void store_save(Store *s) {}
INLINE void store_restore(Store *s) {}
INLINE FacetSum store_facet(Store *s, uint f) { return (FacetSum){ 0 }; }
INLINE void store_set_facet(Store *s, uint f, FacetSum sum) {}

// What only arbitrary precision can decide is the host's: the cell is handed back.
INLINE void store_note_exact(Store *s) { s->exact = 1; }
INLINE int store_tie_sign(Store *s, Triplet t, uint k) { return SIGN_UNKNOWN; }
INLINE int store_exact_sign(Store *s, Triplet t, uint k) { return SIGN_UNKNOWN; }
INLINE uint store_exact_position(Store *s, Triplet t, V3 *position) { return UNCERTAIN; }
INLINE uint store_exact_foot(Store *s, uint f, uint g, V3 center, V3 *foot) { return UNCERTAIN; }
INLINE int store_exact_cone_sign(Store *s, uint t, Voxel corner) { return SIGN_UNKNOWN; }

#import "marks.cl"
#import "one_lane.cl"
