// Cells on their way from one stage to another. Finished ones to one that TAKES_CELLS: those near the domain's surface, those that were swept, or where facets are asked for all; and what a stage that
// KEEPS_BEGUN does not complete to one that GOES_ON. A record: site; numbers of half-spaces and of vertices; winding number, or without a domain what `search_near` has proved; whether exact arithmetic was
// needed, and whether the surface is near, or what is searched next; the vertices in single precision; their triplets, and what is beyond the half-spaces: a site, a face of the box, or what a cap cut off;
// and the half-spaces of caps.

#import "lanes_clip.cl"
#import "output.cl"

// In a record, instead of a site: the first of the faces of the box, and of the caps.
#define TAG_FACE 0xFFFFFFE0u
#define TAG_FIRST_CAP 0xFFFFFFF0u
// Units of 16 bytes that the half-space of one takes.
#define CAP_LENGTH 2u

// Where the half-spaces of caps begin in a record.
INLINE uint caps_begin(uint vertices, uint planes) { return (1u + vertices) + (((vertices + planes) + 3u) / 4u); }

#if GIVES_CELLS
// Whether all finished cells are another stage's, which has their integrals.
INLINE uint gives_all(Store *s) { return (WITH_SWEEP != 0) ? 1u : (s->world.params->flags & FACETS); }

// Which face of the box a half-space is: where some were dropped it has another number than at first. (Without that such cells were found anew in the stage
// WITH_EXACT, or worse.)
INLINE uint face_of(Plane plane) {
    const uint axis = (plane.n.x != REAL(0.0)) ? 0u : ((plane.n.y != REAL(0.0)) ? 1u : 2u);
    return TAG_FACE + ((2u * axis) + ((((plane.n.x + plane.n.y) + plane.n.z) < REAL(0.0)) ? 1u : 0u));
}

// Writes the record of a cell, whose place is `place`, where there is room for it: whether there is. `proven` is what `search_near` says of one that is not finished.
INLINE bool give_cell(
    Store *s, __global uint4 *records, volatile __global uint *used, uint room, uint site, uint exact, real proven, uint *place
) {
#if WITH_DOMAIN
    const uint about = (uint)s->cell->winding;
    const uint next = s->cell->is_near;
#elif KEEPS_BEGUN
    const uint about = as_uint(convert_float_rtz(proven));
    const uint next = s->next;
#else
    const uint about = 0;
    const uint next = 0;
#endif
    const uint kind = ((exact != 0u) ? 1u : 0u) | (next << 1);
    const uint caps_at = caps_begin(s->vertices, s->planes);
    uint length = caps_at;
#if CUTS_OUTSIDE
    for (uint first = 0; first < s->planes; first += LANES) {
        const uint f = first + s->lane;
        length += CAP_LENGTH * popcount(lanes_with((f < s->planes) && (s->cell->source[f] == TAG_CAP)));
    }
#endif
    uint begin = 0;
    if (s->lane == 0u) {
        // (What is used tells whether all had room, and is not to grow on until it begins anew.)
        begin = (*used <= room) ? atomic_add(used, length) : room;
    }
    begin = lane_value(begin, 0);
    *place = begin;
    if ((begin + length) > room) {
        return false;
    }
    __global uint4 *record = records + begin;
    if (s->lane == 0u) {
        *record = (uint4)(site, s->planes | (s->vertices << 16), about, kind);
    }
    __global uint *word = (__global uint *)((record + 1) + s->vertices);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        record[1u + v] = as_uint4(s->cell->rough[v]);
        word[v] = s->cell->triplet[v];
    }
    for (uint f = s->lane; f < s->planes; f += LANES) {
        const uint beyond = s->cell->source[f];
        word[s->vertices + f] = (beyond == TAG_BOX) ? face_of(s->cell->plane[f]) : beyond;
    }
#if CUTS_OUTSIDE
    uint caps = 0;
    for (uint first = 0; first < s->planes; first += LANES) {
        const uint f = first + s->lane;
        const uint are_caps = lanes_with((f < s->planes) && (s->cell->source[f] == TAG_CAP));
        if (((are_caps >> s->lane) & 1u) != 0u) {
            const uint cap = caps + popcount(are_caps & ((1u << s->lane) - 1u));
            const Plane plane = s->cell->plane[f];
            word[s->vertices + f] = TAG_FIRST_CAP + cap;
            vstore4((double4)(plane.n.x, plane.n.y, plane.n.z, plane.d), 0, (__global double *)((record + caps_at) + (CAP_LENGTH * cap)));
        }
        caps += popcount(are_caps);
    }
#endif
    return true;
}
#endif

#if TAKES_CELLS || GOES_ON
// The cell of a record; that of the box has been begun. (Where weights differ rough places are from where the stage that gave the cell had its origin; but without a domain nobody
// looks at them then.)
INLINE void take_cell(Store *s, __global const uint4 *record) {
    CELL_SPACE Cell *cell = s->cell;
    s->planes = record->y & 0xFFFFu;
    s->vertices = record->y >> 16;
    s->exact = record->w & 1u;
#if WITH_DOMAIN
    cell->winding = (int)record->z;
    cell->is_near = record->w >> 1;
#elif GOES_ON
    // (A sweep that was given up began with what another cell had shown. Another one begins with sites from all over.)
    s->next = min(record->w >> 1, (WITH_SWEEP != 0) ? KEPT : (SWEEP + 1u));
#endif
    __global const uint *word = (__global const uint *)((record + 1) + s->vertices);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        cell->rough[v] = as_float4(record[1u + v]);
        cell->triplet[v] = word[v];
#if WITH_SURFACE || GOES_ON
        enter_edges(cell, unpacked(word[v]), v);
#endif
    }
    const uint caps_at = caps_begin(s->vertices, s->planes);
    // (Faces of the box come first, each in its place or further to the front.)
    for (uint first = 0; first < s->planes; first += LANES) {
        const uint f = first + s->lane;
        const uint beyond = (f < s->planes) ? word[s->vertices + f] : TAG_FACE;
        const uint is_cap = beyond >= TAG_FIRST_CAP;
        Plane plane;
        if (is_cap != 0u) {
            const double4 cap = vload4(0, (__global const double *)((record + caps_at) + (CAP_LENGTH * (beyond - TAG_FIRST_CAP))));
            plane = (Plane){ .n = { cap.x, cap.y, cap.z }, .d = cap.w };
        } else {
            plane = (beyond >= TAG_FACE) ? cell->plane[beyond - TAG_FACE] : bisector_with(s, beyond);
        }
        lanes_wait();
        if (f < s->planes) {
            cell->plane[f] = plane;
            cell->source[f] = (is_cap != 0u) ? TAG_CAP : ((beyond >= TAG_FACE) ? TAG_BOX : beyond);
        }
        lanes_wait();
    }
}
#endif
