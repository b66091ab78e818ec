// Sums over the vertices of a polytope that LANES work-items compute together.

#import "generated/cell.cl"

// A lane's view of its share of the vertices.
INLINE Store share_of(CELL_SPACE Cell *cell, uint lane, uint vertices, uint is_fine) {
    Store share;
    share.cell = cell;
    share.lane = lane;
    share.vertices = vertices;
    share.view = SHARE;
    share.is_fine = is_fine;
    share.exact = 0;
    return share;
}

// The corners of the box of the vertices into the cell.
OUTLINE void find_box(CELL_SPACE Cell *cell, uint lane, uint vertices, uint is_fine) {
    Store share = share_of(cell, lane, vertices, is_fine);
    V3 low = (V3){ .x = INFINITY, .y = INFINITY, .z = INFINITY };
    V3 high = (V3){ .x = -INFINITY, .y = -INFINITY, .z = -INFINITY };
    real radius = REAL(0.0);
    if (store_vertices(&share) != 0u) {
        radius = box_of_cell(&share, &low, &high);
    }
    low = lanes_most_of(scale(-REAL(1.0), low));
    high = lanes_most_of(high);
    radius = lanes_folded(radius, 0u);
    lanes_wait();
    if (lane == 0u) {
        cell->corner[0] = -low.x;
        cell->corner[1] = -low.y;
        cell->corner[2] = -low.z;
        cell->corner[3] = high.x;
        cell->corner[4] = high.y;
        cell->corner[5] = high.z;
        cell->corner[6] = radius;
    }
    lanes_wait();
}

// The view of that box.
INLINE void turn_to_box(Store *s) {
    find_box(s->cell, s->lane, s->vertices, s->is_fine);
    s->view = BOX_CORNERS;
}

// `settle`, of the cell whose integrals these are: `COMPLETE` or `EMPTY`.
INLINE uint settle_sums(Store *s, CellSums *sums) {
    if (sums->volume > sums->rounding) {
        // What it would say first.
        return COMPLETE;
    }
    turn_to_box(s);
    return settle(s, sums);
}

// All vertices in double precision: they take the place of the rough ones. Where signs are not settled closely each was born by `find_vertex_once`;
// the rest of `find_vertex`, which is never reached there, takes 3 % of the time of even sites for being there.
OUTLINE uint refine_together(CELL_SPACE Cell *cell, uint lane, uint vertices, uint *exact) {
    Store share = share_of(cell, lane, vertices, 1);
    uint status = COMPLETE;
    lanes_wait();
    for (uint v = 0; v < store_vertices(&share); v++) {
#if WITH_EXACT || SETTLES_CLOSELY
        status |= place_vertex(&share, v);
#else
        V3 position;
        real radius;
        status |= find_vertex_once(&share, store_triplet(&share, v), &position, &radius);
        store_set_position(&share, v, position, radius);
#endif
    }
    *exact = share.exact;
    lanes_wait();
    return (lanes_with(status != COMPLETE) != 0u) ? UNCERTAIN : COMPLETE;
}

// Adds `weight` times the integrals of the present polytope to `sums`, as `integrate` does with one vertex after the other.
OUTLINE uint sum_together(
    CELL_SPACE Cell *cell, uint lane, uint vertices, real weight, V3 center, real reach, uint flags, CellSums *sums
) {
    Store share = share_of(cell, lane, vertices, 1);
    CellSums part = (CellSums){ 0 };
    const uint status = integrate(&share, weight, center, reach, flags, &part);
    if (lanes_with(status != COMPLETE) != 0u) {
        return UNCERTAIN;
    }
    const real rounding = lanes_sum(part.rounding);
    sums->volume += lanes_sum(part.volume);
    sums->first = add(sums->first, lanes_sum_of(part.first));
    sums->rounding += rounding;
    sums->largest_rounding = fmax(sums->largest_rounding, rounding);
    if ((flags & SECOND_MOMENTS) != 0u) {
        sums->second_diagonal = add(sums->second_diagonal, lanes_sum_of(part.second_diagonal));
        sums->second_mixed = add(sums->second_mixed, lanes_sum_of(part.second_mixed));
    }
    return COMPLETE;
}

#if WITH_FACETS
// The vertices of half-space f, as the view: each lane may have another.
INLINE void turn_to_facet(Store *s, uint f) {
    s->corners = 0;
    s->view = WHOLE;
    for (uint v = 0; v < s->vertices; v++) {
        const Triplet t = unpacked(s->cell->triplet[v]);
        if (((t.a == f) || (t.b == f)) || (t.c == f)) {
            if (s->corners == MOST_CORNERS) {
                return;
            }
            s->corner[s->corners] = (Place)v;
            s->corners++;
        }
    }
    s->view = FACET_CORNERS;
}

// Adds `weight` times the facets of the present polytope on the first `count` half-spaces to those that each lane has: number `turn·LANES + lane` is its own.
INLINE uint add_facets(const Store *s, uint count, real weight, V3 center, real reach, FacetSum *facet) {
    Store copy = *s;
    Place corner[MOST_CORNERS];
    copy.corner = corner;
    copy.is_fine = 1;
    uint status = COMPLETE;
    UNROLLED
    for (uint turn = 0; turn < (LANES_P / LANES); turn++) {
        const uint f = (turn * LANES) + s->lane;
        if (f < count) {
            turn_to_facet(&copy, f);
            FacetSum sum;
            status |= integrate_facet(&copy, f, center, reach, &sum);
            facet[turn].area += weight * sum.area;
            facet[turn].moment = add(facet[turn].moment, scale(weight, sum.moment));
            facet[turn].rounding = fmax(facet[turn].rounding, sum.rounding);
        }
    }
    return (lanes_with(status != COMPLETE) != 0u) ? UNCERTAIN : COMPLETE;
}

INLINE void clear_facets(FacetSum *facet) {
    UNROLLED
    for (uint turn = 0; turn < (LANES_P / LANES); turn++) {
        facet[turn] = (FacetSum){ 0 };
    }
}
#endif
