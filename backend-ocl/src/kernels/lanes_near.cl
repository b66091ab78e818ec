// Finished cells on their way from the stage that cuts all cells to one that TAKES_CELLS: those near the domain's surface, or where facets are asked for all. A
// record: site, numbers of half-spaces and of vertices, winding number, whether exact arithmetic was needed and whether the surface is near; the vertices in single precision; their
// triplets, and what is beyond the half-spaces: a site, or a face of the box.

#import "lanes_clip.cl"
#import "output.cl"

// In a record, instead of a site: the first of the faces of the box.
#define TAG_FACE 0xFFFFFFE0u

#if GIVES_CELLS
// Whether all finished cells are another stage's, which sums their facets.
INLINE uint gives_all(Store *s) { return s->world.params->flags & FACETS; }

// Which face of the box a half-space is: where some were dropped it has another number than at first. (Without that such cells were found anew in the stage
// WITH_EXACT, or worse.)
INLINE uint face_of(Plane plane) {
    const uint axis = (plane.n.x != REAL(0.0)) ? 0u : ((plane.n.y != REAL(0.0)) ? 1u : 2u);
    return TAG_FACE + ((2u * axis) + ((((plane.n.x + plane.n.y) + plane.n.z) < REAL(0.0)) ? 1u : 0u));
}

// Writes the record of a cell, whose place is `place`: `FINISHED`; or where there is no room `FACETS_FULL` or, without facets, `OPEN`: a stage WITH_EXACT finds
// the same cell anew, so that no bit depends on which cells came first, but of cells completed by their vertices, which it may cut in another order.
INLINE uint give_cell(
    Store *s, __global uint4 *near, volatile __global Counters *counters, uint site, uint exact, uint *place
) {
#if WITH_DOMAIN
    const uint about = (uint)s->cell->winding;
    const uint is_near = s->cell->is_near;
#else
    const uint about = 1u;
    const uint is_near = 0;
#endif
    const uint kind = ((exact != 0u) ? 1u : 0u) | (is_near << 1);
    const uint words = s->vertices + s->planes;
    const uint length = (1u + s->vertices) + ((words + 3u) / 4u);
    uint begin = 0;
    if (s->lane == 0u) {
        begin = atomic_add(&counters->near, length);
    }
    begin = lane_value(begin, 0);
    *place = begin;
    if ((begin + length) > s->world.params->near_room) {
        return (gives_all(s) != 0u) ? FACETS_FULL : OPEN;
    }
    __global uint4 *record = near + begin;
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
    return FINISHED;
}
#endif

#if TAKES_CELLS
// The cell of a record; that of the box has been begun.
INLINE void take_cell(Store *s, __global const uint4 *record) {
    CELL_SPACE Cell *cell = s->cell;
    s->planes = record->y & 0xFFFFu;
    s->vertices = record->y >> 16;
    s->exact = record->w & 1u;
#if WITH_DOMAIN
    cell->winding = (int)record->z;
    cell->is_near = record->w >> 1;
#endif
    __global const uint *word = (__global const uint *)((record + 1) + s->vertices);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        cell->rough[v] = as_float4(record[1u + v]);
        cell->triplet[v] = word[v];
#if WITH_SURFACE
        enter_edges(cell, unpacked(word[v]), v);
#endif
    }
    // (Faces of the box come first, each in its place or further to the front.)
    for (uint first = 0; first < s->planes; first += LANES) {
        const uint f = first + s->lane;
        const uint beyond = (f < s->planes) ? word[s->vertices + f] : TAG_FACE;
        const Plane plane = (beyond >= TAG_FACE) ? cell->plane[beyond - TAG_FACE] : bisector_with(s, beyond);
        lanes_wait();
        if (f < s->planes) {
            cell->plane[f] = plane;
            cell->source[f] = (beyond >= TAG_FACE) ? TAG_BOX : beyond;
        }
        lanes_wait();
    }
}
#endif
