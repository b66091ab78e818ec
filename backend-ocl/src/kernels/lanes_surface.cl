// Cells near the domain's surface, where LANES work-items compute one together.

#import "lanes_clip.cl"
#import "lanes_sums.cl"

#if WITH_DOMAIN && (WITH_SURFACE || WITH_FACETS)

// How many voxels there are from `lo` to `hi`, and number n of them.
INLINE uint voxels_between(Voxel lo, Voxel hi) {
    return (((hi.i - lo.i) + 1u) * ((hi.j - lo.j) + 1u)) * ((hi.k - lo.k) + 1u);
}
INLINE Voxel voxel_between(Voxel lo, Voxel hi, uint n) {
    const uint across = (hi.i - lo.i) + 1u;
    const uint layer = across * ((hi.j - lo.j) + 1u);
    return (Voxel){ .i = lo.i + (n % across), .j = lo.j + ((n % layer) / across), .k = lo.k + (n / layer) };
}
// How many of them in a row a lane looks at in one go: one, or where they are many all of a row, whose lists stand one after the other, most of them empty. (Of a million sites in the bunny, with
// weights of transport, the cell that reaches farthest waited 5 of its 9 million cycles for the lists of single voxels; one NVIDIA H200.)
#define MANY_VOXELS 256u
INLINE uint voxels_at_once(Voxel lo, Voxel hi, uint all) { return (all > MANY_VOXELS) ? ((hi.i - lo.i) + 1u) : 1u; }
// The last of those from `voxel` on.
INLINE Voxel last_voxel(Voxel voxel, uint at_once) { return (Voxel){ .i = voxel.i + (at_once - 1u), .j = voxel.j, .k = voxel.k }; }

#if WITH_SURFACE
// The vertices of a finished cell, each lane's own, and how many half-spaces and vertices there are.
typedef struct {
    uint triplet[WORDS];
    float4 rough[WORDS];
    uint planes;
    uint vertices;
} Saved;

INLINE Saved saved_cell(Store *s) {
    Saved saved;
    UNROLLED_WORDS
    for (uint word = 0; word < WORDS; word++) {
        const uint v = (word * LANES) + s->lane;
        saved.triplet[word] = s->cell->triplet[v];
        saved.rough[word] = s->cell->rough[v];
    }
    saved.planes = s->planes;
    saved.vertices = s->vertices;
    return saved;
}

INLINE void restore_cell(Store *s, const Saved *saved) {
    CELL_SPACE Cell *cell = s->cell;
    lanes_wait();
    UNROLLED_WORDS
    for (uint word = 0; word < WORDS; word++) {
        const uint v = (word * LANES) + s->lane;
        if (v < saved->vertices) {
            cell->triplet[v] = saved->triplet[word];
            cell->rough[v] = saved->rough[word];
            enter_edges(cell, unpacked(saved->triplet[word]), v);
        }
    }
    s->planes = saved->planes;
    s->vertices = saved->vertices;
    s->is_fine = 0;
    s->view = WHOLE;
    lanes_wait();
}

// Whether entry number `entry` is triangle t's in the first voxel that it stands in, which is in the row of `voxel`.
INLINE uint is_first_in_row(Store *s, uint t, uint entry, Voxel lo, Voxel voxel) {
    const Voxel lowest = store_lowest_voxel(s, t);
    const Voxel first = (Voxel){ .i = max(lowest.i, lo.i), .j = voxel.j, .k = voxel.k };
    return is_first_voxel(lowest, lo, first) && ((entry >= store_list_begin(s, first)) && (entry < store_list_end(s, first)));
}

// The triangles in voxels `lo` to `hi` into the row `marked`, each once, a voxel, or a row of them, for each lane; returns how many there are.
INLINE uint gather_triangles(Store *s, Voxel lo, Voxel hi) {
    const uint below = (1u << s->lane) - 1u;
    const uint all = lanes_alike(voxels_between(lo, hi));
    const uint at_once = lanes_alike(voxels_at_once(lo, hi, all));
    uint found = 0;
    for (uint first = 0; first < all; first += LANES * at_once) {
        const uint n = first + (s->lane * at_once);
        const Voxel voxel = voxel_between(lo, hi, n);
        uint entry = (n < all) ? store_list_begin(s, voxel) : 0u;
        const uint end = (n < all) ? store_list_end(s, last_voxel(voxel, at_once)) : 0u;
        while (lanes_with(entry < end) != 0u) {
            uint t = 0;
            uint is_there = 0;
            if (entry < end) {
                t = store_list_entry(s, entry);
                is_there = (at_once > 1u) ? is_first_in_row(s, t, entry, lo, voxel) : is_first_voxel(store_lowest_voxel(s, t), lo, voxel);
                entry++;
            }
            const uint listed = lanes_with(is_there);
            const uint rank = found + popcount(listed & below);
            if ((is_there != 0u) && (rank < LANES_V)) {
                s->cell->marked[rank] = t;
            }
            found += popcount(listed);
        }
    }
    lanes_wait();
    return found;
}

// Which of `bits` hold: all vertices of the cell are certainly in conflict with one of the cone's half-spaces, a bit each; its end certainly keeps all.
#define BEYOND_CONE 15u
#define WITHIN_END 16u
INLINE uint misses_cone(Store *s, const TruncatedCone *cone, uint bits) {
    const Plane plane[4] = { cone->side_0, cone->side_1, cone->side_2, cone->end };
    uint beyond = bits;
    for (uint v = 0; (v < s->vertices) && (beyond != 0u); v++) {
        const float4 p = s->cell->rough[v];
        UNROLLED
        for (uint i = 0; i < 4u; i++) {
            const uint side = side_of(plane[i], (V3){ .x = p.x, .y = p.y, .z = p.z }, p.w);
            beyond &= (side == MARK_CONFLICT) ? ~0u : ~(1u << i);
            beyond &= ((i == 3u) && (side != MARK_KEEP)) ? ~WITHIN_END : ~0u;
        }
    }
    return beyond;
}

// Adds `weight` times the integrals of the present polytope, whose vertices are in single precision; and of its facets on the first `count` half-spaces.
INLINE uint add_polytope(Store *s, real weight, V3 center, real reach, uint flags, CellSums *sums, uint count, FacetSum *facet) {
    uint exact = 0;
    if (lanes_alike(refine_together(s->cell, s->lane, s->vertices, &exact)) != COMPLETE) {
        return UNCERTAIN;
    }
    s->exact |= exact;
    return lanes_alike(sum_together(s->cell, s->lane, s->vertices, weight, center, reach, flags, sums, count, facet));
}

// Cuts the cell by the half-spaces of a cone that lane `from` has, the last of them its end: `COMPLETE` where something is left, and whether the end has cut it.
INLINE uint cut_by_cone(Store *s, const TruncatedCone *cone, uint from, uint *ends) {
    CELL_SPACE Cell *cell = s->cell;
    if (s->lane == from) {
        cell->cone[0] = cone->side_0;
        cell->cone[1] = cone->side_1;
        cell->cone[2] = cone->side_2;
        cell->cone[3] = cone->end;
    }
    lanes_wait();
    uint status = UNTOUCHED;
    for (uint i = 0; (i < 4u) && ((status == CUT) || (status == UNTOUCHED)); i++) {
        const Plane plane = cell->cone[i];
        if (s->lane == 0u) {
            cell->plane[s->planes] = plane;
        }
        lanes_wait();
        status = clip_together(s, trial_of(s, plane));
        *ends = (i == 3u) && (status == CUT);
    }
    return ((status == CUT) || (status == UNTOUCHED)) ? COMPLETE : status;
}

#if WITH_FACETS
// Adds to the boundary's sums the parts within the cell of the triangles, of which each lane has some (`add_surface`): `COMPLETE`, `LEFT` or `OPEN`.
INLINE uint add_surface_together(
    Store *s, const uint *triangle, uint count, Voxel apex, V3 center, const Saved *saved, CellSums *sums
) {
    CELL_SPACE Cell *cell = s->cell;
    for (uint word = 0; (word * LANES) < count; word++) {
        TruncatedCone prism;
        uint meets = 0;
        uint is_open = 0;
        if (((word * LANES) + s->lane) < count) {
            Store copy = *s;
            const bool is_near = lies_beyond(s, triangle[word], apex) == NONE_BEYOND;
            is_open = is_near && (make_prism(&copy, triangle[word], apex, &prism) != COMPLETE);
            meets = is_near && (is_open == 0u) && (misses_cone(s, &prism, BEYOND_CONE | WITHIN_END) == 0u);
        }
        if (lanes_with(is_open) != 0u) {
            return UNSETTLED;
        }
        for (uint left = lanes_with(meets); left != 0u; left &= left - 1u) {
            const uint from = lowest_bit(left);
            const real jump = lane_real(prism.jump, from);
            uint ends = 0;
            uint status = cut_by_cone(s, &prism, from, &ends);
            if ((status == COMPLETE) && (ends != 0u)) {
                const uint end = s->planes - 1u;
                const Plane plane = cell->cone[3];
                uint exact = 0;
                status = lanes_alike(refine_together(cell, s->lane, s->vertices, &exact));
                s->exact |= exact;
                // (Each lane its share of the corners.)
                Store share = share_of(cell, s->lane, s->vertices, 1);
                FacetSum part;
                status |= lanes_with(integrate_facet(&share, end, center, REAL(0.0), &part) != COMPLETE);
                if (status != COMPLETE) {
                    return UNSETTLED;
                }
                const FacetSum facet = (FacetSum){
                    .area = lanes_sum(part.area), .moment = lanes_sum_of(part.moment), .rounding = lanes_folded(part.rounding, 0u)
                };
                add_boundary(facet, plane, -jump, sums);
            } else if ((status != COMPLETE) && (status != EMPTY)) {
                return status;
            }
            restore_cell(s, saved);
        }
    }
    return COMPLETE;
}
#endif

// Up to so many triangles cones start from the lowest corner, and `lies_beyond` is not asked: a million blue sites in the bunny, most of whose cells near the surface have fewer,
// took 1 to 3 % longer where it was (one NVIDIA H200).
#define FEW_TRIANGLES 10u

// Subtracts from the integrals of the whole cell, times the winding number of a corner near its middle, those of its intersections
// with the truncated cones from there over the triangles near it (`integrate_restricted`); a lane makes and culls each cone, all lanes cut.
// `COMPLETE`, `EMPTY`, `LEFT` or `OPEN`.
INLINE uint restrict_together(Store *s, Voxel lo, Voxel hi, V3 center, uint flags, CellSums *sums, FacetSum *facet) {
    CELL_SPACE Cell *cell = s->cell;
#if COMPACTS
    if ((s->planes + 4u) > LANES_P) {
        s->planes = lanes_alike(compact_together(s->cell, s->lane, s->planes, s->vertices));
    }
#endif
    const Saved saved = saved_cell(s);
    const uint count = gather_triangles(s, lo, hi);
    s->tried = count;
    if ((count > LANES_V) || ((s->planes + 4u) > LANES_P)) {
        return LEFT;
    }
    const bool are_few = count <= FEW_TRIANGLES;
    Voxel apex = lo;
    if (!are_few) {
        apex = nearest_corner(s, add(store_site(s), center), lo, hi);
    }
    const real winding = (real)store_winding(s, apex);
    uint triangle[WORDS];
    UNROLLED_WORDS
    for (uint word = 0; word < WORDS; word++) {
        triangle[word] = cell->marked[(word * LANES) + s->lane];
    }
    const uint base = (WITH_FACETS != 0) ? saved.planes : 0u;
#if WITH_FACETS
    clear_facets(facet);
#endif
    if (winding != REAL(0.0)) {
        if (add_polytope(s, winding, center, REAL(0.0), flags, sums, base, facet) != COMPLETE) {
            return UNSETTLED;
        }
        restore_cell(s, &saved);
    }
    uint touched = 0;
    for (uint word = 0; (word * LANES) < count; word++) {
        TruncatedCone cone;
        uint meets = 0;
        uint is_flat = 0;
        uint is_open = 0;
        if (((word * LANES) + s->lane) < count) {
            Store copy = *s;
            const bool is_near = are_few || (lies_beyond(s, triangle[word], apex) != CONE_BEYOND);
            is_open = is_near && (make_cone(&copy, triangle[word], apex, &cone) != COMPLETE);
            is_flat = is_near && (is_open == 0u) && (cone.sign == REAL(0.0));
            meets = is_near && ((is_open | is_flat) == 0u) && (misses_cone(s, &cone, BEYOND_CONE) == 0u);
        }
        if (lanes_with(is_open) != 0u) {
            return UNSETTLED;
        }
        touched |= lanes_with(is_flat);
        for (uint left = lanes_with(meets); left != 0u; left &= left - 1u) {
            const uint from = lowest_bit(left);
            const real jump = lane_real(cone.jump, from);
            const real reach = lane_real(cone.reach, from);
            uint ends = 0;
            const uint status = cut_by_cone(s, &cone, from, &ends);
            touched |= ends;
            if ((status != COMPLETE) && (status != EMPTY)) {
                return status;
            }
            if ((status != EMPTY) && (add_polytope(s, -jump, center, reach, flags, sums, base, facet) != COMPLETE)) {
                return UNSETTLED;
            }
            restore_cell(s, &saved);
        }
    }
#if WITH_FACETS
    if (asks_for_boundary(flags | FACETS)) {
        const uint added = add_surface_together(s, triangle, count, apex, center, &saved, sums);
        if (added != COMPLETE) {
            return added;
        }
    }
#endif
    if (touched == 0u) {
        // No piece ends at its triangle: the surface does not meet the cell.
        CellSums whole = (CellSums){ 0 };
        int inner = 0;
        if (add_polytope(s, REAL(1.0), center, REAL(0.0), VOLUME_ONLY, &whole, 0u, facet) != COMPLETE) {
            return UNSETTLED;
        }
        // (Its vertices are in double precision from here on.)
        s->is_fine = 1;
        if (volume_is_above_bound(whole) == 0u) {
            return EMPTY;
        }
        if (is_undivided(*sums, whole, &inner) != 0u) {
            *sums = (CellSums){ 0 };
            if (inner == 0) {
                return EMPTY;
            }
#if WITH_FACETS
            clear_facets(facet);
#endif
            if (sum_together(cell, s->lane, s->vertices, (real)inner, center, REAL(0.0), flags, sums, base, facet) != COMPLETE) {
                return UNSETTLED;
            }
        }
    }
    return settle_sums(s, sums);
}
#endif

// What becomes of a cell near the surface, whose vertices are in single precision: `UNTOUCHED` where the surface does not meet it, with its
// winding number; else `COMPLETE` with its integrals, `EMPTY`, `LEFT` or `OPEN`. `is_out`: its site is not strictly inside it.
OUTLINE uint meet_surface(Store *given, uint outside, uint is_out, uint flags, real *inner, CellSums *sums, FacetSum *facet) {
    Store store = *given;
    Store *s = &store;
    s->planes = lanes_alike(s->planes);
    s->vertices = lanes_alike(s->vertices);
    find_box(s->cell, s->lane, s->vertices, 0);
    s->view = BOX_CORNERS;
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = low;
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
    Voxel hi = lo;
    outer_box_of_cell(s, &low, &high);
    voxels_of_box(s, low, high, &lo, &hi);
    const V3 middle = scale(REAL(0.5), add(store_position(s, 0), store_position(s, 1)));
    s->view = WHOLE;
    const real winding = (real)store_winding(s, lo);
    *inner = winding;
    if (lanes_alike(store_surface_voxels(s, lo, hi)) == 0u) {
        return UNTOUCHED;
    }
    // As `surface_passes_by`, each lane with other voxels.
    uint meets = is_out;
    int crossed = 0;
    const uint all = lanes_alike(voxels_between(lo, hi));
    const uint at_once = voxels_at_once(lo, hi, all);
    for (uint n = s->lane * at_once; (n < all) && (meets == 0u); n += LANES * at_once) {
        Voxel voxel = voxel_between(lo, hi, n);
        const Voxel last = last_voxel(voxel, at_once);
        const uint are_empty = (at_once > 1u) && (store_list_begin(s, voxel) == store_list_end(s, last));
        for (; ((voxel.i <= last.i) && (meets == 0u)) && (are_empty == 0u); voxel.i++) {
            meets = voxel_passes_by(s, voxel, lo, low, high, &crossed) == 0u;
        }
    }
    if (lanes_with(meets) == 0u) {
        *inner = winding + lanes_sum((real)crossed);
        return UNTOUCHED;
    }
#if WITH_SURFACE
    const V3 center = (outside != 0u) ? middle : v3(REAL(0.0), REAL(0.0), REAL(0.0));
    const uint status = restrict_together(s, lo, hi, center, flags, sums, facet);
    given->planes = s->planes;
    given->exact = s->exact;
    given->tried = s->tried;
    return status;
#else
    return LEFT;
#endif
}
#endif
