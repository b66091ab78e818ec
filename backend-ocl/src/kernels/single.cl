// Cells in single precision. A cell is written only where its rounding cannot matter: `COMPLETE` where the bound of its volume's error is
// below a share of it and it does not come near the domain's surface, `EMPTY` where it is empty with all half-spaces moved outward by
// what rounding may have moved them. All others are the host's, in double precision.

#import "cell.cl"

// The most that rounding may be of a volume.
#define SHARE_OF_VOLUME REAL(0.0009765625)

// Coefficients beyond these, and sites so near that their difference has few digits left, are the host's (see `WIDE_SMALLEST`).
#define LARGEST_NORMAL REAL(524288.0)
#define LARGEST_OFFSET REAL(549755813888.0)
#define NEAREST REAL(256.0)

// For the roundings of a squared distance and its bound.
#define SAFE_SQUARE (REAL(1.0) + (REAL(64.0) * UNIT_ROUNDOFF))

// From the cell's site to another: within `2u|d| + position_error`, componentwise.
INLINE V3 way_to(Store *s, uint site) {
    const real4 other = s->world.sites[site];
    const real4 rest = s->world.rests[site];
    return (V3){ .x = (other.x - s->own.x) + (rest.x - s->own_rest.x), .y = (other.y - s->own.y) + (rest.y - s->own_rest.y),
                 .z = (other.z - s->own.z) + (rest.z - s->own_rest.z) };
}

// The weight of the cell's site less another's: within `2u|dw| + weight_error`.
INLINE real weight_above(Store *s, uint site) {
    return (s->own.w - s->world.sites[site].w) + (s->own_rest.w - s->world.rests[site].w);
}

// How much larger or smaller `n·x + d` of the true bisector may be: x for each unit of distance from the site, and y. Of the normal, 2u of
// each component; of the offset ½(d² + dw), 2u of each factor, 3u of the sum, 2u of dw and 2u of the whole; each with what its
// differences leave.
INLINE real2 bisector_error(Store *s, V3 d, real dw) {
    const real size = norm_1(d);
    const real lost = s->world.params->position_error;
    const real of_normal = ((REAL(2.0) * UNIT_ROUNDOFF) * size) + (REAL(3.0) * lost);
    const real of_offset = (size * (((REAL(6.0) * UNIT_ROUNDOFF) * size) + (REAL(4.0) * lost)))
        + (((REAL(5.0) * UNIT_ROUNDOFF) * fabs(dw)) + s->world.params->weight_error);
    return SAFE_SQUARE * (real2)(of_normal, of_offset);
}

// The same for a face of the box.
INLINE real face_error(Store *s, real d) {
    return ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(d)) + s->world.params->position_error;
}

// Whether sites at squared distance at least `square`, heavier than the cell's by at most `extra`, cannot cut the cell.
INLINE uint out_of_reach(Store *s, real square, real extra) {
    const real margin = ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(extra)) + s->world.params->weight_error;
    const real reach = security_reach(s->farthest, extra + margin);
    return square >= (SAFE_SQUARE * (reach * reach));
}

// Cuts the cell by the bisector with a site, if it can.
INLINE uint visit(Store *s, uint site) {
    if (site == s->site) {
        return UNTOUCHED;
    }
    const V3 d = way_to(s, site);
    const real dw = weight_above(s, site);
    if (out_of_reach(s, v3_dot(d, d), -dw)) {
        return UNTOUCHED;
    }
    s->visited++;
    Plane plane = bisector(d, dw);
    if (!(norm_max(d) > (NEAREST * s->world.params->position_error)) || !(norm_max(d) < LARGEST_NORMAL)
        || !(fabs(plane.d) < LARGEST_OFFSET)) {
        return UNCERTAIN;
    }
    const real2 error = bisector_error(s, d, dw);
    const real most = (error.x * s->farthest) + error.y;
    if (s->is_widened) {
        plane.d = plane.d + most;
        plane.d = plane.d + ((REAL(2.0) * UNIT_ROUNDOFF) * fabs(plane.d));
    }
    const uint status = clip(s, plane, site);
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

// The sites of a voxel, one after the other.
INLINE uint visit_voxel(Store *s, uint voxel) {
    const uint begin = s->world.voxels[voxel];
    const uint end = s->world.voxels[voxel + 1u];
    if ((end - begin) > CROWDED) {
        return UNCERTAIN;
    }
    for (uint site = begin; site < end; site++) {
        const uint status = visit(s, site);
        if ((status != CUT) && (status != UNTOUCHED)) {
            return status;
        }
    }
    return COMPLETE;
}

// Nodes of the pyramid along an axis at a level.
INLINE uint level_dim(Store *s, uint axis, uint level) {
    return (s->world.params->grid_dims[axis] + ((1u << level) - 1u)) >> level;
}

// Whether no site of a node can cut the cell; `sharp`: also by the test of every vertex.
INLINE uint can_skip(Store *s, uint level, uint i, uint j, uint k, uint sharp) {
    __global const Params *params = s->world.params;
    const uint node = i + (level_dim(s, 0, level) * (j + (level_dim(s, 1, level) * k)));
    const real largest = s->world.weights[params->level_begin[level] + node];
    if (largest == -INFINITY) {
        return 1;
    }
    const real extra = largest - s->own.w;
    const real w = params->grid_width;
    const real pad = params->grid_pad;
    const V3 lo = (V3){ .x = (((real)(i << level) * w) - s->own.x) - pad, .y = (((real)(j << level) * w) - s->own.y) - pad,
                        .z = (((real)(k << level) * w) - s->own.z) - pad };
    const V3 hi = (V3){ .x = (((real)((i + 1u) << level) * w) - s->own.x) + pad,
                        .y = (((real)((j + 1u) << level) * w) - s->own.y) + pad,
                        .z = (((real)((k + 1u) << level) * w) - s->own.z) + pad };
    const V3 gap = (V3){ .x = outside_of(REAL(0.0), lo.x, hi.x), .y = outside_of(REAL(0.0), lo.y, hi.y),
                         .z = outside_of(REAL(0.0), lo.z, hi.z) };
    if (out_of_reach(s, v3_dot(gap, gap), extra)) {
        return 1;
    }
    const real margin = ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(extra)) + params->weight_error;
    return sharp && (box_cannot_cut(s, lo, hi, extra + margin) != 0u);
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

// Index along an axis of the voxel that holds x, or of its neighbour where x is between them.
INLINE uint center_along(Store *s, uint axis, real x) {
    const uint last = s->world.params->grid_dims[axis] - 1u;
    const real q = x / s->world.params->grid_width;
    return (q >= (real)last) ? last : ((q > REAL(0.0)) ? (uint)q : 0u);
}

INLINE uint apart(uint a, uint b) { return (a > b) ? (a - b) : (b - a); }

// Through the voxels of the table, nearest first. `COMPLETE` where no other site can cut the cell, `UNTOUCHED` where that is open.
INLINE uint search_shells(Store *s, uint ci, uint cj, uint ck, __global const uchar4 *shells) {
    __global const Params *params = s->world.params;
    const real extra = params->largest_weight - s->own.w;
    const real margin = ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(extra)) + params->weight_error;
    for (uint entry = 0; entry < SHELLS; entry++) {
        if ((((entry == 7u) || (entry == 19u)) || (entry == INNER_SHELLS)) && is_outside(s)) {
            return EMPTY;
        }
        const uchar4 shell = shells[entry];
        // The site is in its voxel up to the pad, and so is any other. All later voxels are at least as far away.
        const real reach = SAFE_SQUARE
            * ((security_reach(s->farthest, extra + margin) + (REAL(4.0) * params->grid_pad)) / params->grid_width);
        if ((real)shell.w >= (SAFE_SQUARE * (reach * reach))) {
            return COMPLETE;
        }
        // Below zero is beyond the end, too.
        const uint i = (ci + (uint)shell.x) - SHELL_RADIUS;
        const uint j = (cj + (uint)shell.y) - SHELL_RADIUS;
        const uint k = (ck + (uint)shell.z) - SHELL_RADIUS;
        if (((i >= params->grid_dims[0]) || (j >= params->grid_dims[1])) || (k >= params->grid_dims[2])) {
            continue;
        }
        if (can_skip(s, 0, i, j, k, 0)) {
            continue;
        }
        const uint status = visit_voxel(s, i + (params->grid_dims[0] * (j + (params->grid_dims[1] * k))));
        if (status != COMPLETE) {
            return status;
        }
    }
    return UNTOUCHED;
}

// Through the pyramid from its root, but for the voxels of the table.
OUTLINE uint search_pyramid(Store *s, uint ci, uint cj, uint ck) {
    __global const Params *params = s->world.params;
    const uint top = params->top_level;
    uint level = top;
    uint i = 0;
    uint j = 0;
    uint k = 0;
    for (;;) {
        const uint is_there = ((i < level_dim(s, 0, level)) && (j < level_dim(s, 1, level))) && (k < level_dim(s, 2, level));
        const uint is_done = (((level == 0u) && (apart(i, ci) <= SHELL_RADIUS)) && (apart(j, cj) <= SHELL_RADIUS))
            && (apart(k, ck) <= SHELL_RADIUS);
        if ((is_there && !is_done) && !can_skip(s, level, i, j, k, 1)) {
            if (level > 0u) {
                level--;
                i <<= 1;
                j <<= 1;
                k <<= 1;
                continue;
            }
            const uint status = visit_voxel(s, i + (params->grid_dims[0] * (j + (params->grid_dims[1] * k))));
            if (status != COMPLETE) {
                return status;
            }
        }
        // The next of its parent's children, or of that one's parent's.
        while ((level < top) && ((((i & j) & k) & 1u) == 1u)) {
            level++;
            i >>= 1;
            j >>= 1;
            k >>= 1;
        }
        if (level == top) {
            return COMPLETE;
        }
        const uint octant = (((i & 1u) | ((j & 1u) << 1)) | ((k & 1u) << 2)) + 1u;
        i = (i & ~1u) | (octant & 1u);
        j = (j & ~1u) | ((octant >> 1) & 1u);
        k = (k & ~1u) | (octant >> 2);
    }
}

// One side of the initial cell, in the frame of the site.
INLINE real side_of_box(Store *s, __global const real *side, __global const real *rest, uint axis, real own, real own_rest, real outward) {
    const real d = (side[axis] - own) + (rest[axis] - own_rest);
    return s->is_widened ? (d + (outward * face_error(s, d))) : d;
}

// Cuts the cell of a site until no other site can cut it.
OUTLINE uint complete_cell(Store *s, uint site, uint is_widened, __global const uchar4 *shells) {
    __global const Params *p = s->world.params;
    s->own = s->world.sites[site];
    s->own_rest = s->world.rests[site];
    s->site = site;
    s->exact = 0;
    s->visited = 0;
    s->is_widened = is_widened;
    s->tilt = REAL(0.0);
    s->shift = REAL(0.0);
    const real4 o = s->own;
    const real4 r = s->own_rest;
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
    const uint ci = center_along(s, 0, o.x);
    const uint cj = center_along(s, 1, o.y);
    const uint ck = center_along(s, 2, o.z);
    status = search_shells(s, ci, cj, ck, shells);
    if (status == UNTOUCHED) {
        status = search_pyramid(s, ci, cj, ck);
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
    const real bound = sums->rounding + (((SAFE_SQUARE * shift) * surface) * fabs(winding));
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
    store.world = (World){ .params = params, .sites = sites, .rests = rests, .voxels = voxels, .weights = weights,
                           .windings = windings, .surface_table = surface_table };
    CellSums part = (CellSums){ 0 };
    uint status = complete_cell(&store, list[turn], 0, shells);
    if (status == COMPLETE) {
        status = integrate_certainly(&store, &part);
    }
    if (store.visited > most_visited[0]) {
        atomic_max(most_visited, store.visited);
    }
    const uint exact = store.exact;
    if (status == EMPTY) {
        status = complete_cell(&store, list[turn], 1, shells);
        // What is left of it widened, rounding may have made.
        status = (status == COMPLETE) ? UNCERTAIN : status;
    }
    outcome[turn] = status | ((exact != 0u) ? OUTCOME_EXACT : 0u);
    sums[turn] = (real4)(part.volume, part.first.x, part.first.y, part.first.z);
}
