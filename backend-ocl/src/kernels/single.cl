// Cells in single precision. A cell is written only where its rounding cannot matter: `COMPLETE` where the bound of its volume's error is
// below a share of it and it does not come near the domain's surface, `EMPTY` where it is empty with all half-spaces moved outward by
// what rounding may have moved them. All others are the host's, in double precision.

#import "generated/cell_alone.cl"

INLINE uint store_cut(Store *s, Plane plane, uint tag) { return clip(s, plane, tag); }

// Coefficients beyond these are the host's (see `WIDE_SMALLEST`).
#define LARGEST_NORMAL REAL(524288.0)
#define LARGEST_OFFSET REAL(549755813888.0)

// For the roundings of what is a length, or a square of one.
#define SAFE_LENGTH (REAL(1.0) + (REAL(64.0) * UNIT_ROUNDOFF))

// How much larger or smaller `n·x + d` of the true bisector may be: x for each unit of distance from the site, and y. Of the normal, 2u of
// each component; of the offset ½(d² + dw), 2u of each factor, 3u of the sum, 2u of dw and 2u of the whole; each with what its
// differences leave.
INLINE real2 bisector_error(Store *s, V3 d, real dw) {
    const real size = norm_1(d);
    const real lost = s->world.params->position_error;
    const real of_normal = ((REAL(2.0) * UNIT_ROUNDOFF) * size) + (REAL(3.0) * lost);
    const real of_offset = (size * (((REAL(6.0) * UNIT_ROUNDOFF) * size) + (REAL(4.0) * lost)))
        + (((REAL(5.0) * UNIT_ROUNDOFF) * fabs(dw)) + s->world.params->weight_error);
    return SAFE_LENGTH * (real2)(of_normal, of_offset);
}

// The same for a face of the box.
INLINE real face_error(Store *s, real d) {
    return ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(d)) + s->world.params->position_error;
}

// The voxels of the domain that the cell's bounding box meets, rounded outward.
INLINE void voxels_near(Store *s, Voxel *lo, Voxel *hi) {
    V3 low;
    V3 high;
    const real margin = box_of_cell(s, &low, &high) + s->world.params->domain_margin;
    const V3 outward = (V3){ .x = margin, .y = margin, .z = margin };
    *lo = store_voxel_of(s, sub(add(store_site(s), low), outward));
    *hi = store_voxel_of(s, add(add(store_site(s), high), outward));
}

// Whether the cell, and so all that clipping can leave of it, lies outside the domain.
OUTLINE uint is_outside(Store *s) {
    if (s->world.params->has_domain == 0u) {
        return 0;
    }
    Voxel lo;
    Voxel hi;
    voxels_near(s, &lo, &hi);
    return (store_surface_voxels(s, lo, hi) == 0u) && (store_winding(s, lo) == 0);
}

// Bisectors that are moved outward need not cut off what the sites do.
INLINE bool store_leaves_out(Store *s) { return s->is_widened != 0u; }

INLINE uint store_cut_by(Store *s, uint j) {
    const V3 d = store_way_to(s, j);
    const real dw = -store_excess_of(s, j);
    Plane plane = bisector(d, dw);
    if ((s->is_too_near != 0u) || !(norm_max(d) < LARGEST_NORMAL) || !(fabs(plane.d) < LARGEST_OFFSET)) {
        return UNCERTAIN;
    }
    const real2 error = bisector_error(s, d, dw);
    const real most = (error.x * s->farthest) + error.y;
    if (s->is_widened) {
        plane.d = plane.d + most;
        plane.d = plane.d + ((REAL(2.0) * UNIT_ROUNDOFF) * fabs(plane.d));
    }
    const uint status = clip(s, plane, j);
    if ((status == CUT) || (s->least < most)) {
        const real length = sqrt(v3_dot(d, d));
        s->tilt = fmax(s->tilt, error.x / length);
        s->shift = fmax(s->shift, error.y / length);
    }
    if (status == CUT) {
        s->farthest = farthest_vertex(s);
    }
    return status;
}
INLINE uint store_cut_outside(Store *s, real radius) { return (is_outside(s) != 0u) ? EMPTY : UNTOUCHED; }

#import "tree_alone.cl"

// One side of the initial cell, in the frame of the site.
INLINE real side_of_box(Store *s, __global const real *side, __global const real *rest, uint axis, real own, real own_rest, real outward) {
    const real d = (side[axis] - own) + (rest[axis] - own_rest);
    return s->is_widened ? (d + (outward * face_error(s, d))) : d;
}

// Cuts the cell of a site until no other site can cut it.
OUTLINE uint complete_cell(Store *s, uint site, uint is_widened, uint *visited) {
    __global const Params *p = s->world.params;
    const real4 o = s->world.sites[site];
    const real4 r = s->world.rests[site];
    s->own = site;
    s->site = (V3){ .x = o.x, .y = o.y, .z = o.z };
    s->weight = o.w;
    s->rest = r;
    s->exact = 0;
    s->is_too_near = 0;
    s->is_widened = is_widened;
    s->tilt = REAL(0.0);
    s->shift = REAL(0.0);
    const V3 lo = (V3){ .x = side_of_box(s, p->box_lo, p->box_lo_rest, 0, o.x, r.x, REAL(-1.0)),
                        .y = side_of_box(s, p->box_lo, p->box_lo_rest, 1, o.y, r.y, REAL(-1.0)),
                        .z = side_of_box(s, p->box_lo, p->box_lo_rest, 2, o.z, r.z, REAL(-1.0)) };
    const V3 hi = (V3){ .x = side_of_box(s, p->box_hi, p->box_hi_rest, 0, o.x, r.x, REAL(1.0)),
                        .y = side_of_box(s, p->box_hi, p->box_hi_rest, 1, o.y, r.y, REAL(1.0)),
                        .z = side_of_box(s, p->box_hi, p->box_hi_rest, 2, o.z, r.z, REAL(1.0)) };
    const V3 extent = sub(hi, lo);
    if (!(extent.x > REAL(0.0)) || !(extent.y > REAL(0.0)) || !(extent.z > REAL(0.0))
        || !(larger(norm_max(lo), norm_max(hi)) < LARGEST_OFFSET)) {
        return UNCERTAIN;
    }
    uint status = begin(s, lo, hi);
    if (status != COMPLETE) {
        return status;
    }
    s->farthest = farthest_vertex(s);
    const Vantage vantage = vantage_of(s);
    real proven;
    status = search_near(s, vantage, NEAR, visited, &proven);
    if (status == UNTOUCHED) {
        settle_near(s, vantage.center, proven);
        status = search_far(s, vantage.center, 1u, visited);
    }
    if (s->is_too_near != 0u) {
        return UNCERTAIN;
    }
    return ((status == COMPLETE) && is_outside(s)) ? EMPTY : status;
}

// The integrals of a finished cell, where they are certain.
OUTLINE uint integrate_certainly(Store *s, CellSums *sums) {
    *sums = (CellSums){ 0 };
    compact_planes(s);
    real winding = REAL(1.0);
    if (s->world.params->has_domain != 0u) {
        Voxel lo;
        Voxel hi;
        voxels_near(s, &lo, &hi);
        if (store_surface_voxels(s, lo, hi) != 0u) {
            return BOUNDARY;
        }
        winding = (real)store_winding(s, lo);
    }
    if (integrate_whole(s, winding, reference_point(s), VOLUME_ONLY, sums) != COMPLETE) {
        return UNCERTAIN;
    }
    // How far half-spaces may be from where they should be. A convex body has no more surface than a box around it.
    real shift = (s->tilt * s->farthest) + s->shift;
    for (uint f = 0; f < s->planes; f++) {
        if (s->tag[f] == TAG_BOX) {
            shift = fmax(shift, face_error(s, s->plane[f].d));
        }
    }
    V3 low;
    V3 high;
    const real radius = box_of_cell(s, &low, &high);
    const V3 e = add(sub(high, low), (V3){ .x = radius, .y = radius, .z = radius });
    const real surface = REAL(2.0) * (((e.x * e.y) + (e.y * e.z)) + (e.z * e.x));
    const real bound = sums->rounding + (((SAFE_LENGTH * shift) * surface) * fabs(winding));
    return (bound < (SHARE_OF_VOLUME * fabs(sums->volume))) ? COMPLETE : UNCERTAIN;
}

// Computes `count` cells, those of `list`: `outcome` and `sums` (volume and first moment) by
// their place in it.
__kernel void single_cells(SINGLE_CELLS_ARGUMENTS) {
    const uint turn = (uint)get_global_id(0);
    if (turn >= count) {
        return;
    }
    Store store;
    store.tried = 0;
    store.last_tried = 0;
    store.world = (World){ .params = params, .sites = sites, .rests = rests, .boxes = boxes, .slabs = slabs,
                           .weight_bounds = weight_bounds, .windings = windings, .surface_table = surface_table };
    CellSums part = (CellSums){ 0 };
    uint visited = 0;
    // An empty one is computed again, widened; what is left of it then, rounding may have made. (One call for both, so that the compiler has
    // it once.)
    uint status = COMPLETE;
    uint exact = 0;
    uint is_widened = 0;
    for (;;) {
        status = complete_cell(&store, list[turn], is_widened, &visited);
        exact |= store.exact;
        if ((is_widened != 0u) || (status != EMPTY)) {
            break;
        }
        is_widened = 1;
    }
    if (status == COMPLETE) {
        status = (is_widened != 0u) ? UNCERTAIN : integrate_certainly(&store, &part);
    }
    if (visited > most_visited[0]) {
        atomic_max(most_visited, visited);
    }
    outcome[turn] = status | ((exact != 0u) ? OUTCOME_EXACT : 0u);
    sums[turn] = (real4)(part.volume, part.first.x, part.first.y, part.first.z);
}
