// Finished cells near the domain's surface, on their way from the stage that cuts all cells to the stage that looks at the surface. A record:
// site, numbers of half-spaces and of vertices, whether exact arithmetic was needed; the vertices in single precision; their
// triplets, and the sites beyond the half-spaces.

#import "lanes_clip.cl"

#if GIVES_NEAR
// Writes the record of a cell, whose place is `place`: `NEAR`; or `OPEN` where there is no room: a stage WITH_EXACT finds the same cell anew, so
// that no bit depends on which cells came first, but of cells completed by their vertices, which it may cut in another order.
INLINE uint give_cell(
    Store *s, __global uint4 *near, volatile __global Counters *counters, uint site, uint exact, uint *place
) {
    const uint words = s->vertices + s->planes;
    const uint length = (1u + s->vertices) + ((words + 3u) / 4u);
    uint begin = 0;
    if (s->lane == 0u) {
        begin = atomic_add(&counters->near, length);
    }
    begin = lane_value(begin, 0);
    *place = begin;
    if ((begin + length) > s->world.params->near_room) {
        return OPEN;
    }
    __global uint4 *record = near + begin;
    if (s->lane == 0u) {
        *record = (uint4)(site, s->planes, s->vertices, exact);
    }
    __global uint *word = (__global uint *)((record + 1) + s->vertices);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        record[1u + v] = as_uint4(s->cell->rough[v]);
        word[v] = s->cell->triplet[v];
    }
    for (uint f = s->lane; f < s->planes; f += LANES) {
        word[s->vertices + f] = s->cell->source[f];
    }
    return NEAR;
}
#endif

#if TAKES_NEAR
// The cell of a record; that of the box, of which the first half-spaces are, has been begun.
INLINE void take_cell(Store *s, __global const uint4 *record) {
    CELL_SPACE Cell *cell = s->cell;
    s->planes = record->y;
    s->vertices = record->z;
    s->exact = record->w;
    __global const uint *word = (__global const uint *)((record + 1) + s->vertices);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        cell->rough[v] = as_float4(record[1u + v]);
        cell->triplet[v] = word[v];
        enter_edges(cell, unpacked(word[v]), v);
    }
    for (uint f = 6u + s->lane; f < s->planes; f += LANES) {
        const uint beyond = word[s->vertices + f];
        cell->plane[f] = bisector_with(s, beyond);
        cell->source[f] = beyond;
    }
    lanes_wait();
}
#endif
