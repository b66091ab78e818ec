// Where a cell lives that one work-item computes: in its private memory, which GPUs interleave between work-items.

// Whether weights differ is asked at run time.
#define WITH_WEIGHTS 1

#import "params.cl"
#import "generated/tree_types.cl"
#import "ties.cl"

#define WORDS ((CAP_V + 31) / 32)

// Sources of half-spaces from here on are no sites but places in `special`.
#define SPECIAL 0xFFFFFF00u

// Places for half-spaces that are no bisectors: the six of the box, those of a cone, of which at most four live at a time, and the caps.
#define BOX_PLACES 6u
#define CONE_PLACES 8u
#define PLACES (BOX_PLACES + CONE_PLACES + MOST_CAPS)

// While the cell is clipped, it is kept small, so that many cells fit into the cache: half-spaces as the site they come from, and
// vertices rounded to single precision, with an error radius that knows it. Where that is not enough to decide a sign, the vertex is
// computed anew. For the integrals, all vertices are (`refine`).
typedef struct {
    World world;
    // Triangles that the cell has tried, and one more than the last of them: each is tried once, with no other in between.
    uint tried;
    uint last_tried;
    V3 site;
    real weight;
    uint planes;
    uint vertices;
    uint saved;
    uint exact;
    // Of the search: the sorted index of the site, and whether sites were left out that might cut the cell; of that of the tree.
    uint own;
    uint uncertified;
    uint open[MOST_OPEN];
    uint open_key[MOST_OPEN];
    uint leaf[MOST_LEAVES];
    uint leaf_key[MOST_LEAVES];
    uint candidate[MOST_CANDIDATES];
    uint candidate_key[MOST_CANDIDATES];
    Asked asked;
#if WITH_TABLE
    // Of the search of the table: it, the site's voxel, how far what is outside the domain was looked for, whether it was cut off, and whether sites
    // from all over have cut the cell, which are not to cut it twice.
    __global const uchar4 *shells;
    uint voxel[3];
    uint rings;
    uint is_capped;
    uint is_sampled;
#endif
    uint is_fine;
    // The half-space that was set last, and its index.
    uint last_index;
    Plane last;
    Plane special[PLACES];
    uint special_tag[PLACES];
    uint specials;
    uint caps;
    uint source[CAP_P];
    ushort link[CAP_P];
#if WITH_FACETS
    FacetSum facet[CAP_P];
#endif
#if WITH_FACET_SECOND
    FacetSecond facet_second[CAP_P];
#endif
    // Position and error radius.
    float4 rough[CAP_V];
    // Three indices of ten bits.
    uint triplet[CAP_V];
    uint conflict[WORDS];
    uint uncertain[WORDS];
    real x[CAP_V];
    real y[CAP_V];
    real z[CAP_V];
    real radius[CAP_V];
    real saved_x[CAP_V];
    real saved_y[CAP_V];
    real saved_z[CAP_V];
    real saved_radius[CAP_V];
    uint saved_triplet[CAP_V];
} Store;

INLINE uint store_cap_p(Store *s) { return CAP_P; }
INLINE uint store_cap_v(Store *s) { return CAP_V; }
INLINE uint store_planes(Store *s) { return s->planes; }
INLINE void store_set_planes(Store *s, uint count) { s->planes = count; }
INLINE uint store_vertices(Store *s) { return s->vertices; }
INLINE void store_set_vertices(Store *s, uint count) { s->vertices = count; }

INLINE Plane bisector(V3 d, real dw);

INLINE Plane store_plane(Store *s, uint f) {
    if (f == s->last_index) {
        return s->last;
    }
    const uint source = s->source[f];
    if (source >= SPECIAL) {
        return s->special[source - SPECIAL];
    }
    const real4 other = s->world.sites[source];
    const V3 d = (V3){ .x = other.x - s->site.x, .y = other.y - s->site.y, .z = other.z - s->site.z };
    return bisector(d, s->weight - other.w);
}
INLINE void store_set_plane(Store *s, uint f, Plane plane) {
    s->last = plane;
    s->last_index = f;
}
INLINE uint store_tag(Store *s, uint f) {
    const uint source = s->source[f];
    return (source >= SPECIAL) ? s->special_tag[source - SPECIAL] : source;
}
INLINE void store_set_tag(Store *s, uint f, uint tag) {
    if (tag < TAG_BOX) {
        s->source[f] = tag;
        return;
    }
    uint place = f;
    if (tag == TAG_CAP) {
        place = (BOX_PLACES + CONE_PLACES) + s->caps;
        s->caps++;
    } else if (tag != TAG_BOX) {
        place = BOX_PLACES + (s->specials % CONE_PLACES);
        s->specials++;
    }
    s->special[place] = s->last;
    s->special_tag[place] = tag;
    s->source[f] = SPECIAL + place;
}
INLINE void store_move_plane(Store *s, uint from, uint to) {
    s->source[to] = s->source[from];
    s->last_index = 0xFFFFFFFFu;
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

// What single precision adds to an error radius, in units of the largest coordinate: 1 rounding of the position; of the plane's
// coefficients, three products and three sums, 7 in all; the rest for the bound itself. And what underflow can lose.
#define ROUGH ((real)1.0 / (real)(1 << 24) * REAL(10.0))
#define ROUGH_UNDERFLOW 1e-33

INLINE V3 store_position(Store *s, uint v) {
    if (s->is_fine) {
        return (V3){ .x = s->x[v], .y = s->y[v], .z = s->z[v] };
    }
    const float4 rough = s->rough[v];
    return (V3){ .x = rough.x, .y = rough.y, .z = rough.z };
}
INLINE real store_radius(Store *s, uint v) { return s->is_fine ? s->radius[v] : (real)s->rough[v].w; }
INLINE void store_set_position(Store *s, uint v, V3 position, real radius) {
    if (s->is_fine) {
        s->x[v] = position.x;
        s->y[v] = position.y;
        s->z[v] = position.z;
        s->radius[v] = radius;
        return;
    }
    const real largest = fmax(fmax(fabs(position.x), fabs(position.y)), fabs(position.z));
    const float w = convert_float_rtp((radius + (ROUGH * largest)) + ROUGH_UNDERFLOW);
    s->rough[v] = (float4)((float)position.x, (float)position.y, (float)position.z, w);
}
INLINE void store_move_vertex(Store *s, uint from, uint to) {
    s->triplet[to] = s->triplet[from];
    if (s->is_fine) {
        s->x[to] = s->x[from];
        s->y[to] = s->y[from];
        s->z[to] = s->z[from];
        s->radius[to] = s->radius[from];
    } else {
        s->rough[to] = s->rough[from];
    }
}

// Only for the integrals, and so in double precision.
INLINE void store_save(Store *s) {
    for (uint v = 0; v < s->vertices; v++) {
        s->saved_x[v] = s->x[v];
        s->saved_y[v] = s->y[v];
        s->saved_z[v] = s->z[v];
        s->saved_radius[v] = s->radius[v];
        s->saved_triplet[v] = s->triplet[v];
    }
    s->saved = s->vertices;
}
INLINE void store_restore(Store *s) {
    for (uint v = 0; v < s->saved; v++) {
        s->x[v] = s->saved_x[v];
        s->y[v] = s->saved_y[v];
        s->z[v] = s->saved_z[v];
        s->radius[v] = s->saved_radius[v];
        s->triplet[v] = s->saved_triplet[v];
    }
    s->vertices = s->saved;
}

#if WITH_FACETS
INLINE FacetSum store_facet(Store *s, uint f) { return s->facet[f]; }
INLINE void store_set_facet(Store *s, uint f, FacetSum sum) { s->facet[f] = sum; }
#else
INLINE FacetSum store_facet(Store *s, uint f) { return (FacetSum){ 0 }; }
INLINE void store_set_facet(Store *s, uint f, FacetSum sum) {}
#endif

INLINE V3 store_site(Store *s) { return s->site; }

// In double precision, 32 vertices from `first` on: the bits of those in conflict as x, of those kept as y.
OUTLINE uint2 mark_fine(Store *s, uint first, uint here) {
    const Plane plane = s->last;
    const real size = (fabs(plane.n.x) + fabs(plane.n.y)) + fabs(plane.n.z);
    const real slack = (REAL(4.0) * UNIT_ROUNDOFF) * fabs(plane.d);
    uint2 bits = (uint2)(0u, 0u);
    for (uint b = 0; b < here; b++) {
        const uint v = first + b;
        const real value = (((plane.n.x * s->x[v]) + (plane.n.y * s->y[v])) + (plane.n.z * s->z[v])) + plane.d;
        const real bound = (size * s->radius[v]) + slack;
        bits.x |= ((value < -bound) ? 1u : 0u) << b;
        bits.y |= ((value > bound) ? 1u : 0u) << b;
    }
    return bits;
}

OUTLINE uint find_vertex(Store *s, Triplet t, V3 *position, real *radius);

// Vertices that single precision leaves open, in double precision.
OUTLINE uint2 mark_open(Store *s, uint first, uint open) {
    const Plane plane = s->last;
    const real size = (fabs(plane.n.x) + fabs(plane.n.y)) + fabs(plane.n.z);
    const real slack = (REAL(4.0) * UNIT_ROUNDOFF) * fabs(plane.d);
    uint2 bits = (uint2)(0u, 0u);
    while (open != 0u) {
        const uint b = 31u - clz(open & -open);
        open &= open - 1u;
        V3 position;
        real radius;
        if (find_vertex(s, store_triplet(s, first + b), &position, &radius) != COMPLETE) {
            continue;
        }
        const real value = (((plane.n.x * position.x) + (plane.n.y * position.y)) + (plane.n.z * position.z)) + plane.d;
        const real bound = (size * radius) + slack;
        bits.x |= ((value < -bound) ? 1u : 0u) << b;
        bits.y |= ((value > bound) ? 1u : 0u) << b;
    }
    return bits;
}

// The half-space at hand is the one that was set last.
INLINE uint store_mark_conflicts(Store *s, uint k) {
    const Plane plane = s->last;
    const float nx = (float)plane.n.x;
    const float ny = (float)plane.n.y;
    const float nz = (float)plane.n.z;
    const float d = (float)plane.d;
    const float size = convert_float_rtp((fabs(plane.n.x) + fabs(plane.n.y)) + fabs(plane.n.z));
    const float slack = convert_float_rtp((ROUGH * fabs(plane.d)) + ROUGH_UNDERFLOW);
    uint any_conflict = 0;
    uint any_uncertain = 0;
    uint any_keep = 0;
    for (uint first = 0; first < s->vertices; first += 32u) {
        const uint here = min(s->vertices - first, 32u);
        const uint all = 0xFFFFFFFFu >> (32u - here);
        uint2 bits = (uint2)(0u, 0u);
        if (s->is_fine) {
            bits = mark_fine(s, first, here);
        } else {
            for (uint b = 0; b < here; b++) {
                const float4 v = s->rough[first + b];
                const float value = (((nx * v.x) + (ny * v.y)) + (nz * v.z)) + d;
                const float bound = (size * v.w) + slack;
                bits.x |= ((value < -bound) ? 1u : 0u) << b;
                bits.y |= ((value > bound) ? 1u : 0u) << b;
            }
            const uint open = all & ~(bits.x | bits.y);
            if (open != 0u) {
                bits |= mark_open(s, first, open);
            }
        }
        const uint uncertain = all & ~(bits.x | bits.y);
        s->conflict[first >> 5] = bits.x;
        s->uncertain[first >> 5] = uncertain;
        any_conflict |= bits.x;
        any_uncertain |= uncertain;
        any_keep |= bits.y;
    }
    return (any_conflict ? SEEN_CONFLICT : 0u) | (any_uncertain ? SEEN_UNCERTAIN : 0u) | (any_keep ? SEEN_KEEP : 0u);
}

// In single precision: its roundings are less than the radius allows for.
INLINE V3 store_farthest(Store *s) {
    float square = 0.0f;
    float radius = 0.0f;
    for (uint v = 0; v < s->vertices; v++) {
        const float4 p = s->rough[v];
        square = fmax(square, ((p.x * p.x) + (p.y * p.y)) + (p.z * p.z));
        radius = fmax(radius, p.w);
    }
    if (square >= ROUGH_SQUARE) {
        return (V3){ .x = square, .y = radius, .z = REAL(0.0) };
    }
    real largest = REAL(0.0);
    for (uint v = 0; v < s->vertices; v++) {
        const float4 p = s->rough[v];
        largest = fmax(largest, (((real)p.x * p.x) + ((real)p.y * p.y)) + ((real)p.z * p.z));
    }
    return (V3){ .x = largest, .y = radius, .z = REAL(0.0) };
}

// What only arbitrary precision can decide is the host's: the cell is handed back.
INLINE void store_note_exact(Store *s) { s->exact = 1; }
INLINE int store_tie_sign(Store *s, Triplet t, uint k) {
    return sign_of_tie(store_plane(s, t.a), store_plane(s, t.b), store_plane(s, t.c), store_plane(s, k));
}
INLINE int store_exact_sign(Store *s, Triplet t, uint k) { return SIGN_UNKNOWN; }
INLINE uint store_exact_position(Store *s, Triplet t, V3 *position) { return UNCERTAIN; }
INLINE uint store_exact_foot(Store *s, uint f, uint g, V3 center, V3 *foot) { return UNCERTAIN; }
INLINE int store_exact_cone_sign(Store *s, uint t, Voxel corner) { return SIGN_UNKNOWN; }

#import "marks.cl"
#import "one_lane.cl"
#import "sites.cl"
