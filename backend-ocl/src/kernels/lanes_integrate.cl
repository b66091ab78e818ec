// The integrals of a cell that LANES work-items compute together.

#import "lanes.cl"
#import "lanes_sums.cl"
#import "lanes_surface.cl"

// The integrals of a complete cell that reaches as far as `extent` says (`extent_of`): `COMPLETE`, `EMPTY`, `LEFT`, `OPEN` or `NEAR`.
INLINE uint integrate_together(Store *s, uint flags, float extent, V3 *center, real *winding, CellSums *sums) {
    CELL_SPACE Cell *cell = s->cell;
    // Whether the site is outside its cell, or only not strictly inside.
    uint outside = 0;
    uint on_wall = 0;
    for (uint f = s->lane; f < s->planes; f += LANES) {
        outside |= cell->plane[f].d < REAL(0.0);
        on_wall |= cell->plane[f].d == REAL(0.0);
    }
    outside = lanes_with(outside);
    *sums = (CellSums){ 0 };
    *winding = REAL(1.0);
    *center = v3(REAL(0.0), REAL(0.0), REAL(0.0));
#if WITH_DOMAIN
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
    uint near = 1;
#if !TAKES_NEAR
    if (extent <= cell->clear) {
        near = 0;
        *winding = (real)cell->winding;
    } else {
        near = surface_near_box(s, &lo);
        *winding = (real)store_winding(s, lo);
    }
#endif
#if GIVES_NEAR
    if (near != 0u) {
        return NEAR;
    }
#else
    if (near != 0u) {
        Store copy = *s;
        CellSums part = (CellSums){ 0 };
        real inner = REAL(0.0);
        const uint is_out = outside | lanes_with(on_wall);
        const uint ended = lanes_alike(meet_surface(&copy, outside, is_out, flags & SECOND_MOMENTS, &inner, &part));
        s->exact |= copy.exact;
        s->tried = copy.tried;
        if (ended != UNTOUCHED) {
            *sums = part;
            return ended;
        }
        *winding = inner;
    }
#endif
    if (*winding == REAL(0.0)) {
        return EMPTY;
    }
#endif
    uint exact = 0;
    if (refine_together(cell, s->lane, s->vertices, &exact) != COMPLETE) {
        return LEFT;
    }
    s->exact |= exact;
    s->is_fine = 1;
    // The common point of the tetrahedra: the site where it is inside, else the middle of the vertices' box.
    if (outside != 0u) {
        turn_to_box(s);
        *center = scale(REAL(0.5), add(store_position(s, 0), store_position(s, 1)));
    }
    const uint summed = sum_together(cell, s->lane, s->vertices, *winding, *center, REAL(0.0), flags & SECOND_MOMENTS, sums);
    if (summed != COMPLETE) {
        return LEFT;
    }
    if (sums->volume > sums->rounding) {
        // What `settle` would say first.
        return COMPLETE;
    }
    turn_to_box(s);
    return settle(s, sums);
}

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
