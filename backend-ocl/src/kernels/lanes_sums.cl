// Sums over the vertices of a polytope that LANES work-items compute together.

#import "generated/cell.cl"

// A lane's view of its share of the vertices.
INLINE Store share_of(CELL_SPACE Cell *cell, uint lane, uint vertices, uint is_fine) {
    Store share;
    share.cell = cell;
    share.lane = lane;
    share.vertices = vertices;
    share.view = SHARE;
    share.from = 0;
    share.areas_alone = 0;
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
    low = scale(-REAL(1.0), low);
    FOLDED
    for (uint step = LANES / 2u; step > 0u; step >>= 1) {
        low = v3_most(low, v3_beside(low, step));
        high = v3_most(high, v3_beside(high, step));
        radius = fmax(radius, real_beside(radius, step));
    }
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

// All vertices in double precision: they take the place of the rough ones. Where signs are not settled closely, or records are taken, nearly all were born by `find_vertex_once`;
// the rest of `find_vertex`, which is never reached there, takes 3 % of the time of even sites for being there. (Of facets, and of swept cells, some planes are nearly dependent, as
// cells reach far: areas of clusters with weights of a first step of transport were off by 1e-9 of their mean without refinement, and are by 3e-12. Those, and of particles that were a
// lattice, are placed closely.)
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
#if TAKES_CLOSELY
        if (find_vertex_refined(&share, store_triplet(&share, v), &position, &radius) != COMPLETE) {
            status |= place_closely(cell, (LANES * v) + lane, 1);
            continue;
        }
#else
        status |= find_vertex_once(&share, store_triplet(&share, v), NEARLY_DEPENDENT, &position, &radius);
#endif
        store_set_position(&share, v, position, radius);
#endif
    }
    *exact = share.exact;
    lanes_wait();
    return (lanes_with(status != COMPLETE) != 0u) ? UNCERTAIN : COMPLETE;
}

// What is one piece of code, and what is not: a lane's own facets stay in registers only where what adds to them is inlined, and `integrate` is to be there once
// where pieces of a cell are many. (Without facets nothing is but the whole.)
#if WITH_FACETS && WITH_SURFACE
#define SUM_SHARE OUTLINE
#else
#define SUM_SHARE INLINE
#endif
#if WITH_FACETS
#define SUM_TOGETHER INLINE
#else
#define SUM_TOGETHER OUTLINE
#endif

// `integrate`, of a lane's share of the vertices from number `from`.
SUM_SHARE uint sum_share(
    CELL_SPACE Cell *cell, uint lane, uint from, uint vertices, real weight, V3 center, real reach, uint flags, CellSums *part
) {
    Store share = share_of(cell, lane, vertices, 1);
    share.from = from;
    share.areas_alone = flags & FACET_AREAS;
    return integrate(&share, weight, center, reach, flags, part);
}

#if WITH_FACETS
// What another work-item has or-ed into it: in global memory not what the nearest cache may still have.
#if WITH_ROOM == 2
#define ORED(x) atomic_or((x), 0u)
#else
#define ORED(x) (*(x))
#endif

// Adds what vertices `from` to `end`, of which each lane has had one, have added to their facets to those that each lane has, of the first `count` half-spaces:
// number `turn·LANES + lane` is its own. In the order of vertices. (Each lane looks at the vertices of its own facets alone, five or six of some 27, which have told it: where it looked at
// all, with something to add for three lanes at a time, a cell took 38,000 instead of 23,000 cycles in `Integrals`, one NVIDIA H200.)
INLINE void gather_facets(CELL_SPACE Cell *cell, uint lane, uint from, uint end, uint count, uint flags, FacetSum *facet) {
    // Of each half-space which lanes' vertices lie on it.
    volatile CELL_SPACE uint *on = cell->row;
    for (uint f = lane; f < count; f += LANES) {
        on[f] = 0;
    }
    lanes_wait();
    if ((from + lane) < end) {
        const Triplet t = unpacked(cell->triplet[from + lane]);
        const uint corner[3] = { t.a, t.b, t.c };
        UNROLLED_WORDS
        for (uint k = 0; k < 3u; k++) {
            if (corner[k] < count) {
                atomic_or(on + corner[k], 1u << lane);
            }
        }
    }
    lanes_wait();
    UNROLLED_WORDS
    for (uint turn = 0; turn < (LANES_P / LANES); turn++) {
        const uint f = (turn * LANES) + lane;
        uint left = (f < count) ? ORED(on + f) : 0u;
        while (left != 0u) {
            const uint k = lowest_bit(left);
            left &= left - 1u;
            CELL_SPACE const FacetSum *added = cell->added + ((3u * k) + corner_of(unpacked(cell->triplet[from + k]), f));
            facet[turn].area += added->area;
            facet[turn].rounding = fmax(facet[turn].rounding, added->rounding);
            if ((flags & FACET_AREAS) == 0u) {
                facet[turn].moment = add(facet[turn].moment, added->moment);
            }
        }
    }
}

INLINE void clear_facets(FacetSum *facet) {
    UNROLLED_WORDS
    for (uint turn = 0; turn < (LANES_P / LANES); turn++) {
        facet[turn] = (FacetSum){ 0 };
    }
}
#endif

// Adds `weight` times the integrals of the present polytope to `sums`, as `integrate` does with one vertex after the other; and WITH_FACETS those of its facets on
// the first `count` half-spaces to what each lane has.
SUM_TOGETHER uint sum_together(
    CELL_SPACE Cell *cell, uint lane, uint vertices, real weight, V3 center, real reach, uint flags, CellSums *sums, uint count, FacetSum *facet
) {
    CellSums part = (CellSums){ 0 };
    uint status = COMPLETE;
#if WITH_FACETS
    flags |= (count != 0u) ? FACETS : 0u;
    ROLLED
    for (uint from = 0; from < vertices; from += LANES) {
        const uint end = min(vertices, from + LANES);
        for (uint corner = 0; corner < 3u; corner++) {
            cell->added[(3u * lane) + corner] = (FacetSum){ 0 };
        }
        status |= sum_share(cell, lane, from, end, weight, center, reach, flags, &part);
        lanes_wait();
        gather_facets(cell, lane, from, end, count, flags, facet);
        lanes_wait();
    }
#else
    status = sum_share(cell, lane, 0, vertices, weight, center, reach, flags, &part);
#endif
    if (lanes_with(status != COMPLETE) != 0u) {
        return UNCERTAIN;
    }
    FOLDED
    for (uint step = LANES / 2u; step > 0u; step >>= 1) {
        part.rounding += real_beside(part.rounding, step);
        part.volume += real_beside(part.volume, step);
        part.first = add(part.first, v3_beside(part.first, step));
    }
    sums->volume += part.volume;
    sums->first = add(sums->first, part.first);
    sums->rounding += part.rounding;
    sums->largest_rounding = fmax(sums->largest_rounding, part.rounding);
    if ((flags & SECOND_MOMENTS) != 0u) {
        sums->second_diagonal = add(sums->second_diagonal, lanes_sum_of(part.second_diagonal));
        sums->second_mixed = add(sums->second_mixed, lanes_sum_of(part.second_mixed));
    }
    return COMPLETE;
}
