// Where a cell lives that LANES work-items compute together: in their local memory. Each of them has a `Store` of its own, which
// shows it either the whole cell, or its own share of the vertices, or the two corners of the cell's box: the generated functions
// do the same work on each.
//
// A `Store` stays in registers as long as no function that is not inlined is given its address, and nothing in it is indexed: such
// functions are given a copy. (Without that, half of all instructions were about memory.)

#import "params.cl"
#import "generated/tree_types.cl"
#import "ties.cl"
#import "lanes_talk.cl"

// Whether finished cells are given to another stage, as records: those near the surface to the one WITH_SURFACE that TAKES_CELLS; or where facets are asked for
// all to the one WITH_FACETS, which leaves the records of those that the surface cuts to that; all that are swept to one for their integrals.
#define GIVES_CELLS (!TAKES_CELLS && !WITH_EXACT && !WITH_ROOM)

// Whether what does not end here is kept as it is, for a stage that goes on with it; and whether what is kept is gone on with here. (Not where weights differ: rough places are then in the frame
// of where a stage has the cell.)
#define MAY_BE_BEGUN ((!WITH_TABLE && !(WITH_WEIGHTS || WITH_DOMAIN)) && !(WITH_EXACT || TAKES_CELLS))
#define KEEPS_BEGUN (MAY_BE_BEGUN && !WITH_ROOM)
#define GOES_ON (MAY_BE_BEGUN && (WITH_FAR || WITH_SWEEP))

// Whether what of a cell is far outside the domain is cut off.
#define CUTS_OUTSIDE (WITH_DOMAIN && (WITH_EXACT || WITH_FAR))

// Whether signs that single precision leaves open, and vertices of nearly dependent planes, are settled in double precision and double-double: of
// cells that reach far they are many. Of a million sites on a bumpy surface 99 % went on to the stage WITH_EXACT, for 2.9 s; now none does, and
// all is done in 1.1 s (one NVIDIA H200). WITH_CLOSE for cells of which most have some, by the table of offsets.
#define SETTLES_CLOSELY (((WITH_FAR || WITH_SWEEP) || WITH_CLOSE) && !WITH_EXACT)

// Shares of a vertex's largest component that it may be off by: where it is rounded to single precision (in another frame than the site's it rounds less); where that decides
// how many sites may have the least power there, or a sign; and where it is a rounding.
#if HAS_ORIGIN
#define ROUGH_ENOUGH FINE_ENOUGH
#else
#define ROUGH_ENOUGH REAL(6e-8)
#endif
#define FINE_ENOUGH REAL(4e-12)
#define WITHIN_ROUNDING REAL(1.2e-15)

// The share of a new vertex's determinant from which on Cramer's rule alone tells where it is roughly. Where cells are swept it may be off by 9e-5 of its largest component: few of the signs there are open for
// that, and those are settled closely. (With this, 2⁻³², a million sites on a line took 0.078 s when that was chosen, with 2⁻³⁰ 0.079, with 2⁻²⁸ 0.084, with 2⁻³⁶ 0.084, with `NEARLY_DEPENDENT` 0.095; one NVIDIA
// H200.)
#if WITH_SWEEP
#define ONCE_ENOUGH REAL(2.3283064365386963e-10)
#else
#define ONCE_ENOUGH NEARLY_DEPENDENT
#endif

// Whether some vertices of what a stage takes are of nearly dependent planes: of facets, and of swept cells.
#define TAKES_CLOSELY (WITH_FACETS || (TAKES_CELLS && !WITH_DOMAIN))
// Whether half-spaces that no vertex lies on are dropped.
#define COMPACTS (WITH_EXACT || SETTLES_CLOSELY)

// Whether the tree is searched: where there is no table of offsets, or for what is beyond it; few cells reach so far, and without a domain hardly
// any (there a lattice, of which every cell comes to the stage WITH_EXACT, is 10 % slower with it).
#define SEARCHES_BEYOND (WITH_TABLE && (WITH_FAR && (WITH_DOMAIN || WITH_ROOM)))
#define SEARCHES_TREE (!WITH_TABLE || SEARCHES_BEYOND)

// Whether there may be an octree over the container (`make_octree` of the host: only where weights differ, and where most cells begin with the stage WITH_FAR).
// Elsewhere its text would only be in the way: `First` by the tree has 8,100 instead of 10,200 instructions, of which the nearest cache holds 8,192, `Sweep` had 12,100
// instead of 15,800.
#define WITH_OCTREE (SEARCHES_TREE && (WITH_WEIGHTS && WITH_FAR))

// Whether the rough places of vertices are in the frame of where the weights' slope has the cell, and not in that of its site, which may be many
// cells away: single precision loses what that is farther. (Of a million cells with weights 0.9 |x|² 26 % had open signs.)
#define HAS_ORIGIN (WITH_WEIGHTS && !WITH_DOMAIN)

// Whether open blocks and leaves have keys: in the stages that search far, but for that with exact signs, which has no room.
#define KEEPS_KEYS (WITH_FAR && (!WITH_EXACT || WITH_ROOM))

// Whether some cells are computed before others, for which they keep what bounds them far off: in the stage that completes most cells by their vertices, and in that WITH_SWEEP,
// for the others.
#define KEEPS_FAR (WITH_SWEEP || (!WITH_TABLE && ((WITH_FAR && !WITH_EXACT) && !WITH_ROOM)))

// Half-spaces of a cell that is swept. (64 vertices lie on 34 at most, and those that none lies on are dropped. With room for 64 half-spaces a bumpy surface takes 6 % longer, a Lévy
// flight 2.)
#define SWEPT_P 40u
// Room of a cell, of which many are to fit into local memory; WITH_ROOM that of the few that need more, in local memory (1) and in global (2).
// What needs still more is the host's. (Of each directed edge the vertex is kept.)
#if WITH_ROOM == 2
#define LANES_P 512u
#define LANES_V 1024u
#define CELL_SPACE __global
typedef ushort Place;
#else
#if WITH_ROOM
#define LANES_P 128u
#define LANES_V 256u
#elif WITH_SWEEP
#define LANES_P SWEPT_P
#define LANES_V 64u
#else
#define LANES_P 64u
#define LANES_V 64u
#endif
#define CELL_SPACE __local
typedef uchar Place;
#endif

// Determinants that are decided at once by integers, and terms of each.
#define AT_ONCE 5u
#define TERMS 6u

#define WHOLE 0u
#define SHARE 1u
#define BOX_CORNERS 2u

// Where a site is: in double precision, whatever the cell's own numbers are.
typedef struct {
    double x;
    double y;
    double z;
} Site;

// An integer of 256 bits.
typedef struct {
    Wrapped lo;
    Wrapped hi;
} Product;

typedef struct {
    Plane plane[LANES_P];
    // Site beyond each half-space, or a tag.
    uint source[LANES_P];
    uint triplet[LANES_V];
    union {
        // While the cell is clipped: positions in single precision and their error radii; and of each directed edge a→b, in place
        // `edge_place`, the vertex whose triplet has it.
        struct {
            float4 rough[LANES_V];
            Place vertex_of[LANES_P * LANES_P];
        };
        // Afterwards positions and radii in double precision; and what a vertex of each lane adds to the facets of its three half-spaces. (Most of it is where
        // the edges were: with facets a cell takes 0.8 kB more than without, not 8.)
        struct {
            real4 fine[LANES_V];
#if WITH_FACETS
            FacetSum added[3u * LANES];
#endif
        };
    };
    // Marked vertices; and the edges, packed, that bound the hole, or the vertices whose sign is open.
    uint marked[LANES_V];
    uint row[LANES_V];
#if WITH_EXACT
    Product term[AT_ONCE * TERMS];
    int sign[AT_ONCE];
#endif
#if WITH_SURFACE
    // The half-spaces of a truncated cone.
    Plane cone[4];
#endif
#if SEARCHES_TREE
    // Of the search (`tree_search.cl`), for each team; keys of candidates are the first one's.
    uint open[TEAMS * MOST_OPEN];
    uint leaf[TEAMS * MOST_LEAVES];
#if KEEPS_KEYS
    uint open_key[TEAMS * MOST_OPEN];
    uint leaf_key[TEAMS * MOST_LEAVES];
#endif
    uint candidate[TEAMS * MOST_CANDIDATES];
    uint candidate_key[MOST_CANDIDATES];
#endif
#if TEAMS > 1
    // What each team found, and whether it needed exact arithmetic; what the first one says, and its numbers of half-spaces and vertices.
    Answer answer[TEAMS];
    uint noted[TEAMS];
    uint said;
    uint said_planes;
    uint said_vertices;
#endif
#if WITH_TABLE && WITH_WEIGHTS
    // What sites around weigh more than the cell's, ring by ring, in squared voxels.
    float around[RINGS];
#endif
#if HAS_ORIGIN
    // Where rough places are from, as the way from the site.
    float origin[3];
#endif
    // Box of the vertices: minimum corner, maximum corner, largest error radius.
    real corner[7];
#if WITH_DOMAIN
    // What `look_about` found: while its extent is not above `clear`, the cell is where the winding number is `winding`; and so outside the
    // domain while it is not above `outside`.
    float clear;
    int winding;
    float outside;
    // Whether the surface is near the finished cell.
    uint is_near;
#endif
} Cell;
#if WITH_ROOM == 2
typedef char vast_cell_fits[(sizeof(Cell) <= (8u * VAST_WORDS)) ? 1 : -1];
#endif

typedef struct {
    World world;
    // Triangles that the cell has tried, and one more than the last of them: each is tried once, with no other in between.
    uint tried;
    uint last_tried;
    CELL_SPACE Cell *cell;
    Site site;
    double weight;
    // The sorted index of the site.
    uint own;
    uint lane;
    uint planes;
    uint vertices;
    uint view;
    // The first vertex of those that are shared out; and whether of facets areas alone are summed.
    uint from;
    uint areas_alone;
    uint is_fine;
    uint exact;
    // The vertex that the search asks for.
    Asked asked;
#if TEAMS > 1
    uint team;
#endif
#if WITH_SWEEP
    // Whether what bounds another cell far off is kept for it; and where.
    uint is_shown;
    __global const uint *kept;
#endif
#if KEEPS_BEGUN || GOES_ON
    // What is searched next (`NEAR`, …).
    uint next;
#endif
#if GOES_ON
    // How many sites are kept for it, or come from all over; and whether near ones are looked at before they cut: some may have.
    uint kept_count;
    uint checks_near;
#endif
#if WITH_TABLE
    // Of the search of the table: it, the site's voxel, and the candidates that the lane holds.
    __global const uchar4 *shells;
    uint voxel[3];
    uint held_site[2];
    uint held_key[2];
#if CUTS_OUTSIDE
    // Whether what is outside the domain was cut off, and whether sites from all over have cut the cell, which are not to cut it twice.
    uint is_capped;
    uint is_sampled;
#endif
#endif
} Store;

// What all lanes have alike, so that the compiler knows it: it does not of what depends on a work-item's number, or is the result of a function
// that is not inlined, and where a loop may end so, all that happens in it is slower (all cells by 5 %, with a domain 11 %; one NVIDIA H200).
INLINE uint lanes_alike(uint x) { return lanes_most(x); }

// The largest of numbers that are not negative: their bits are in the same order.
INLINE float lanes_largest(float x) { return as_float(lanes_most(as_uint(x))); }

// The number of another lane; and of the one so many lanes further.
#if SINGLE
INLINE real lane_real(real x, uint from) { return as_float(lane_value(as_uint(x), from)); }
INLINE real real_beside(real x, uint step) { return as_float(lane_beside(as_uint(x), step)); }
#else
INLINE real lane_real(real x, uint from) {
    const uint2 own = as_uint2(x);
    return as_double((uint2)(lane_value(own.x, from), lane_value(own.y, from)));
}
INLINE real real_beside(real x, uint step) {
    const uint2 own = as_uint2(x);
    return as_double((uint2)(lane_beside(own.x, step), lane_beside(own.y, step)));
}
#endif

// The sum, or the largest, of the lanes' numbers: by halves, in one order.
INLINE real lanes_folded(real x, uint is_sum) {
    for (uint step = LANES / 2u; step > 0u; step >>= 1) {
        const real other = real_beside(x, step);
        x = (is_sum != 0u) ? (x + other) : fmax(x, other);
    }
    return x;
}
INLINE real lanes_sum(real x) { return lanes_folded(x, 1u); }

// Before a loop that folds several numbers of the lanes at once. With a domain or weights the text is longer than what the caches of instructions hold well, of which unrolled folds were a third in `First`:
// without them cells near the surface take 0.83 to 0.9 of the time, weights 0.9|x|² 0.95, blue noise in the bunny 0.965; without either white noise took 1.006 (one NVIDIA H200).
#if WITH_DOMAIN || WITH_WEIGHTS
#define FOLDED ROLLED
#else
#define FOLDED UNROLLED
#endif
INLINE V3 v3_beside(V3 x, uint step) {
    return (V3){ .x = real_beside(x.x, step), .y = real_beside(x.y, step), .z = real_beside(x.z, step) };
}
INLINE V3 v3_most(V3 x, V3 y) { return (V3){ .x = fmax(x.x, y.x), .y = fmax(x.y, y.y), .z = fmax(x.z, y.z) }; }
INLINE V3 lanes_sum_of(V3 x) { return (V3){ .x = lanes_sum(x.x), .y = lanes_sum(x.y), .z = lanes_sum(x.z) }; }
INLINE V3 lanes_most_of(V3 x) {
    return (V3){ .x = lanes_folded(x.x, 0u), .y = lanes_folded(x.y, 0u), .z = lanes_folded(x.z, 0u) };
}

INLINE uint lowest_bit(uint bits) { return 31u - clz(bits & -bits); }

// Of vertex v of the view its place in the cell.
INLINE uint place_of(Store *s, uint v) {
    return (s->view == SHARE) ? (s->from + ((v * LANES) + s->lane)) : v;
}

INLINE uint store_cap_p(Store *s) { return LANES_P; }
INLINE uint store_cap_v(Store *s) { return LANES_V; }
INLINE uint store_planes(Store *s) { return s->planes; }
INLINE void store_set_planes(Store *s, uint count) { s->planes = count; }
INLINE uint store_vertices(Store *s) {
    if (s->view == BOX_CORNERS) {
        return 2;
    }
    return (s->view == SHARE) ? (((s->vertices - s->from) + LANES - 1u - s->lane) / LANES) : s->vertices;
}
INLINE void store_set_vertices(Store *s, uint count) { s->vertices = count; }
INLINE Plane store_plane(Store *s, uint f) { return s->cell->plane[f]; }
INLINE void store_set_plane(Store *s, uint f, Plane plane) { s->cell->plane[f] = plane; }
INLINE uint store_tag(Store *s, uint f) { return s->cell->source[f]; }
INLINE void store_set_tag(Store *s, uint f, uint tag) { s->cell->source[f] = tag; }
INLINE Triplet unpacked(uint t) { return (Triplet){ .a = t & 1023u, .b = (t >> 10) & 1023u, .c = (t >> 20) & 1023u }; }
// Beside a triplet, that its vertex is settled (`tree_search.cl`).
#define SETTLED (1u << 30)
INLINE uint packed(Triplet t) { return t.a | (t.b << 10) | (t.c << 20); }
INLINE Triplet store_triplet(Store *s, uint v) { return unpacked(s->cell->triplet[place_of(s, v)]); }
INLINE void store_set_triplet(Store *s, uint v, Triplet t) { s->cell->triplet[place_of(s, v)] = packed(t); }

// What single precision adds to an error radius, as in `store.cl`.
#define ROUGH (10.0f / (float)(1 << 24))
#define ROUGH_UNDERFLOW 1e-33f

#if HAS_ORIGIN
INLINE V3 origin_of(CELL_SPACE const Cell *cell) { return (V3){ .x = cell->origin[0], .y = cell->origin[1], .z = cell->origin[2] }; }
#else
INLINE V3 origin_of(CELL_SPACE const Cell *cell) { return (V3){ .x = REAL(0.0), .y = REAL(0.0), .z = REAL(0.0) }; }
#endif

INLINE V3 store_position(Store *s, uint v) {
    if (s->view == BOX_CORNERS) {
        CELL_SPACE const real *corner = s->cell->corner + (3u * v);
        return (V3){ .x = corner[0], .y = corner[1], .z = corner[2] };
    }
    const uint place = place_of(s, v);
    if (s->is_fine) {
        const real4 p = s->cell->fine[place];
        return (V3){ .x = p.x, .y = p.y, .z = p.z };
    }
    const float4 p = s->cell->rough[place];
#if HAS_ORIGIN
    const V3 from = origin_of(s->cell);
    return (V3){ .x = from.x + p.x, .y = from.y + p.y, .z = from.z + p.z };
#else
    return (V3){ .x = p.x, .y = p.y, .z = p.z };
#endif
}
INLINE real store_radius(Store *s, uint v) {
    if (s->view == BOX_CORNERS) {
        return s->cell->corner[6];
    }
    const uint place = place_of(s, v);
    return s->is_fine ? s->cell->fine[place].w : (real)s->cell->rough[place].w;
}
INLINE void store_set_position(Store *s, uint v, V3 position, real radius) {
    const uint place = place_of(s, v);
    if (s->is_fine) {
        s->cell->fine[place] = (real4)(position.x, position.y, position.z, radius);
        return;
    }
#if HAS_ORIGIN
    // (And what it is off in double precision when it is in the site's frame again.)
    radius += (REAL(2.0) * UNIT_ROUNDOFF) * ((fabs(position.x) + fabs(position.y)) + fabs(position.z));
    const V3 from = origin_of(s->cell);
    position = (V3){ .x = position.x - from.x, .y = position.y - from.y, .z = position.z - from.z };
#endif
    const float4 p = (float4)((float)position.x, (float)position.y, (float)position.z, 0.0f);
    const float largest = fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
    s->cell->rough[place] = (float4)(p.x, p.y, p.z, ((convert_float_rtp(radius) + (ROUGH * largest)) + ROUGH_UNDERFLOW) * ROUGH_SAFE);
}

INLINE void store_note_exact(Store *s) { s->exact = 1; }
INLINE int store_tie_sign(Store *s, Triplet t, uint k) {
    return sign_of_tie(store_plane(s, t.a), store_plane(s, t.b), store_plane(s, t.c), store_plane(s, k));
}
INLINE int store_exact_sign(Store *s, Triplet t, uint k) { return SIGN_UNKNOWN; }
INLINE uint store_exact_position(Store *s, Triplet t, V3 *position) { return UNCERTAIN; }
INLINE uint store_exact_foot(Store *s, uint f, uint g, V3 center, V3 *foot) { return UNCERTAIN; }
INLINE int store_exact_cone_sign(Store *s, uint t, Voxel corner) { return SIGN_UNKNOWN; }
INLINE V3 store_site(Store *s) { return (V3){ .x = s->site.x, .y = s->site.y, .z = s->site.z }; }

// Sums of all facets at once are for one work-item (each lane has its own, `gather_facets`): were they read here, it would be seen.
INLINE FacetSum store_facet(Store *s, uint f) { return (FacetSum){ .area = NAN }; }
INLINE void store_set_facet(Store *s, uint f, FacetSum sum) {}

// Which of a triplet's half-spaces f is; 3 where it is none.
INLINE uint corner_of(Triplet t, uint f) { return (t.a == f) ? 0u : ((t.b == f) ? 1u : ((t.c == f) ? 2u : 3u)); }

INLINE bool store_sums_areas_alone(Store *s) { return s->areas_alone != 0u; }
INLINE bool store_sums_in_blocks(Store *s) { return false; }

// What the lane's vertex, of which it has one at a time, adds to the facet of f.
#if WITH_FACETS
INLINE FacetSum store_facet_at(Store *s, Triplet t, uint f) { return s->cell->added[(3u * s->lane) + corner_of(t, f)]; }
INLINE void store_set_facet_at(Store *s, Triplet t, uint f, FacetSum sum) { s->cell->added[(3u * s->lane) + corner_of(t, f)] = sum; }
#else
INLINE FacetSum store_facet_at(Store *s, Triplet t, uint f) { return (FacetSum){ 0 }; }
INLINE void store_set_facet_at(Store *s, Triplet t, uint f, FacetSum sum) {}
#endif

// The lanes, to the generated text.
INLINE uint store_lanes(Store *s) { return LANES; }
INLINE uint store_lane(Store *s) { return s->lane; }
INLINE uint store_lanes_with(Store *s, bool is_so) { return lanes_with(is_so); }
INLINE uint store_count_of(Store *s, uint lanes) { return popcount(lanes); }
INLINE uint store_rank_in(Store *s, uint lanes) { return popcount(lanes & ((1u << s->lane) - 1u)); }
INLINE uint store_first_of(Store *s, uint lanes) { return lowest_bit(lanes); }
INLINE uint store_least_of_lanes(Store *s, uint x) { return ~lanes_most(~x); }
INLINE uint store_lane_value(Store *s, uint x, uint from) { return lane_value(x, from); }
INLINE real store_lane_real(Store *s, real x, uint from) { return lane_real(x, from); }
INLINE void store_lanes_wait(Store *s) { lanes_wait(); }
INLINE real store_most_of_lanes(Store *s, real x) { return lanes_folded(x, 0u); }
INLINE V3 store_most_along_axes(Store *s, V3 x) { return lanes_most_of(x); }

// (`lanes_clip.cl`.)
INLINE uint store_cut(Store *s, Plane plane, uint tag);

#import "sites.cl"
