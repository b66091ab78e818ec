// A cell computed by LANES work-items together: the vertices are shared out among them when a half-space is tried, the new
// vertices when it cuts, the candidates when the next one is looked for, the tetrahedra when the cell is integrated. It gives the same
// cell as `evaluate.cl` from the same functions of `cell.cl`; written anew is what goes over all vertices one by one there. Cells
// that need more room than there is, or exact arithmetic that is the host's, are left to that kernel.
//
// In single precision (-D SINGLE=1) numbers of a cell are `float`: the half-spaces, rounded from the sites' in double precision, its vertices, whose
// error radii have room for that, and the integrals. Signs that this leaves open, 24,000 of a million white cells have one, are for the next stage, so
// that every cell is cut by the same sites as in double precision.
//
// Built first with -D WITH_EXACT=0 and -D WITH_SURFACE=0: a cell is given up as soon as a sign is open in single precision, so that nothing in the
// inner loop calls a function; and where it is near the surface, so that what few cells need does not take the place of the inner loop in the cache
// of instructions. WITH_SURFACE is for those (where facets are asked for, with WITH_EXACT), WITH_FACETS by itself for all where facets are asked for, whose
// sums take registers and text as well: both take finished cells (TAKES_CELLS). WITH_FAR for cells that are completed by their vertices
// (`lanes_tree.cl`), WITH_EXACT for what is open in either, WITH_ROOM for what needs more room: such a cell has TEAMS of LANES work-items, which ask
// for its vertices and wait for each other at barriers; all else the first does. WITH_WEIGHTS where they differ: what only they need costs others 8 %.
// WITH_TABLE where the table of offsets is gone through before the tree is searched (`lanes_table.cl`); WITH_CLOSE for cells of which most have open signs,
// by that table; WITH_SWEEP for cells that end with one look at all that can still cut them, some of which begin
// with what bounds others far off (`leaders.cl`), and whose integrals are another stage's (TAKES_CELLS). What a stage of the tree does not complete it KEEPS_BEGUN, without a domain and with equal
// weights, and the next GOES_ON.

#import "lanes_table.cl"
#import "lanes_records.cl"
#import "lanes_integrate.cl"
#import "output.cl"

// As `cells` of `evaluate.cl`, with LANES work-items for each cell and CELLS cells in a group.
OF_LANES
__kernel void cells(CELLS_ARGUMENTS) {
#if WITH_ROOM != 2
    __local Cell cells[CELLS];
#endif
    const uint flags = params->flags & ((SHORT != 0) ? FACET_AREAS : (SECOND_MOMENTS | FACET_AREAS));
    const uint own_turn = lanes_alike((uint)get_global_id(0) / (LANES * TEAMS));
    if (own_turn >= count) {
        return;
    }
    const uint turn = first + (own_turn * stride);
#if TAKES_CELLS
    __global const uint4 *record = given + list[turn];
    const uint site = record->x;
#else
    const uint site = (has_list != 0u) ? list[turn] : turn;
#endif
#if KEEPS_FAR
    const uint block = site / (WIDTH * WIDTH);
    __global uint *kept_of_block = kept + (MOST_KEPT * block);
    if ((turn_of != ALL_TURNS) && (turn_of != ((site != leaders[block]) ? 1u : 0u))) {
        return;
    }
#endif
    Store store;
    Store *s = &store;
    s->world = WORLD_OF_ARGUMENTS;
    s->own = site;
#if KEEPS_BEGUN || GOES_ON
    s->next = NEAR;
#endif
#if GOES_ON
    s->checks_near = 0;
#endif
#if WITH_SWEEP
    s->is_shown = (turn_of != ALL_TURNS) ? 1u : 0u;
    s->checks_near = s->is_shown;
    // (Where nothing is kept of its block, as where the first cell there needs more room, it begins with what is kept of another of the same node: of a million sites on a
    // bumpy surface 8,000 instead of 51,000 sweeps are given up, scanned 84,000 instead of 212,000.)
    if (turn_of != ALL_TURNS) {
        for (uint step = 1; (step < WIDTH) && (lanes_alike(kept_of_block[0]) == 0u); step++) {
            kept_of_block = kept + (MOST_KEPT * min(block ^ step, (params->tree_sites - 1u) / (WIDTH * WIDTH)));
        }
        s->kept_count = lanes_alike(kept_of_block[0]);
        s->kept = kept_of_block + 1u;
    } else {
        s->kept_count = sites_about(s);
    }
#elif GOES_ON
    s->kept_count = sites_about(s);
#endif
    s->tried = 0;
    s->last_tried = 0;
    const double4 own = sites[site];
#if WITH_ROOM == 2
    __global Cell *cell = ((__global Cell *)vast) + own_turn;
#else
    __local Cell *cell = cells + lanes_alike((uint)get_local_id(0) / (LANES * TEAMS));
#endif
    s->cell = cell;
    s->site = (Site){ .x = own.x, .y = own.y, .z = own.z };
    s->weight = own.w;
    s->lane = own_lane();
#if TEAMS > 1
    s->team = lanes_alike((uint)get_local_id(0) / LANES);
#endif
#if WITH_DOMAIN && !TAKES_CELLS
    const int2 about = abouts[site];
    const float clear = (as_float(about.x) > 0.0f) ? extent_of(as_float(about.x)) : -1.0f;
    cell->clear = clear;
    cell->winding = about.y;
    cell->outside = (about.y == 0) ? clear : -1.0f;
#endif
    s->view = WHOLE;
    s->is_fine = 0;
    s->exact = 0;
    s->from = 0;
    s->areas_alone = 0;
    const V3 lo = (V3){ .x = params->box_lo[0] - own.x, .y = params->box_lo[1] - own.y, .z = params->box_lo[2] - own.z };
    const V3 hi = (V3){ .x = params->box_hi[0] - own.x, .y = params->box_hi[1] - own.y, .z = params->box_hi[2] - own.z };
#if !WITH_TABLE
    const Vantage vantage = vantage_of(s);
#elif WITH_WEIGHTS
    const Vantage vantage = vantage_in_block(s);
#else
    const Vantage vantage = (Vantage){ .lambda = REAL(0.5) };
#endif
#if HAS_ORIGIN
    // (Within the box, where the cell is.)
    cell->origin[0] = (float)fmin(fmax(vantage.center.x, lo.x), hi.x);
    cell->origin[1] = (float)fmin(fmax(vantage.center.y, lo.y), hi.y);
    cell->origin[2] = (float)fmin(fmax(vantage.center.z, lo.z), hi.z);
    lanes_wait();
#endif
    if (IS_FIRST_TEAM) {
        begin_together(cell, s->lane, lo, hi);
#if TEAMS > 1
        for (uint team = 0; team < TEAMS; team++) {
            cell->noted[team] = 0;
        }
#endif
    }
    s->planes = 6;
    s->vertices = 8;
    uint visited = 0;
    float extent = 0.0f;
#if TAKES_CELLS
    take_cell(s, record);
    uint status = COMPLETE;
#elif WITH_TABLE
    uint status = complete_by_table(s, vantage, shells, &visited, &extent);
#else
    real above = REAL(0.0);
#if GOES_ON
    const uint begun_at = (params->begun_room != 0u) ? lanes_alike(begun_places[site]) : 0u;
    if (IS_FIRST_TEAM && (begun_at != 0u)) {
        __global const uint4 *record = begun + (begun_at - 1u);
        take_cell(s, record);
        s->planes = lanes_alike(s->planes);
        s->vertices = lanes_alike(s->vertices);
        s->next = lanes_alike(s->next);
        s->checks_near = 1;
        above = (real)as_float(record->z);
    }
#endif
    uint status = complete_by_tree(s, vantage, &visited, &extent, &above);
#if KEEPS_FAR && !WITH_SWEEP
    if ((turn_of == 0u) && ((status == COMPLETE) && (above > REAL(0.0)))) {
        keep_far(s, vantage.slope, above, kept_of_block);
    }
#endif
#endif
    // (The others have done what they are for.)
    if (!IS_FIRST_TEAM) {
        return;
    }
    CellSums part = (CellSums){ 0 };
#if WITH_FACETS && WITH_SWEEP
#error "swept cells have no room for facets"
#endif
#if WITH_FACETS
    FacetSum facet[LANES_P / LANES];
#else
    FacetSum *facet = 0;
#endif
    if (status == COMPLETE) {
        status = integrate_together(s, flags, extent, &part, facet);
    }
    const uint i = order[site];
#if WITH_FACETS
    if (status == COMPLETE) {
        uint kept[LANES_P / LANES];
        uint n = 0;
#if !WITH_DOMAIN
        CellSums walls = (CellSums){ 0 };
#endif
        UNROLLED_WORDS
        for (uint turn = 0; turn < (LANES_P / LANES); turn++) {
            const uint f = (turn * LANES) + s->lane;
            uint is_facet = 0;
            if (f < s->planes) {
#if !WITH_DOMAIN
                if ((cell->source[f] == TAG_BOX) && asks_for_boundary(flags | FACETS)) {
                    add_boundary(facet[turn], cell->plane[f], REAL(1.0), &walls);
                }
#endif
                is_facet = (cell->source[f] < TAG_BOX) && (facet_is_above_bound(facet[turn]) != 0u);
            }
            kept[turn] = lanes_with(is_facet);
            n += popcount(kept[turn]);
        }
#if !WITH_DOMAIN
        if (lanes_with(walls.boundary_area != REAL(0.0)) != 0u) {
            part.boundary_area = lanes_sum(walls.boundary_area);
            part.boundary_moment = lanes_sum_of(walls.boundary_moment);
            part.boundary_vector = lanes_sum_of(walls.boundary_vector);
            part.boundary_flux = lanes_sum(walls.boundary_flux);
        }
#endif
        uint begin = 0;
        if (s->lane == 0u) {
            begin = atomic_add(&counters->facets, n);
        }
        begin = lane_value(begin, 0);
        if ((begin + n) > params->facet_room) {
            status = BATCH_FULL;
        } else {
            uint next = begin;
            UNROLLED_WORDS
            for (uint turn = 0; turn < (LANES_P / LANES); turn++) {
                if (((kept[turn] >> s->lane) & 1u) != 0u) {
                    const size_t at = (size_t)next + popcount(kept[turn] & ((1u << s->lane) - 1u));
                    facets[at].area = facet[turn].area;
                    facets[at].neighbor = order[cell->source[(turn * LANES) + s->lane]];
                    facets[at].unused = 0u;
                    if ((flags & FACET_AREAS) == 0u) {
                        write_vector(facet_moments + (3 * at), facet[turn].moment);
                    }
                }
                next += popcount(kept[turn]);
            }
            if (s->lane == 0u) {
                rows[i] = (ulong2)(params->facet_base + begin, n);
            }
        }
    }
#endif
    const uint exact = lanes_with(s->exact);
#if GIVES_CELLS
    uint place = 0;
#if KEEPS_BEGUN
    // (What ends so has been cut by whole half-spaces.)
    const bool may_go_on = ((status == BEYOND) || (status == LEFT)) || ((WITH_SWEEP != 0) && (status == BATCH_FULL));
    const bool is_begun = may_go_on && (params->begun_room != 0u);
    const real proven = above;
    if (is_begun && (s->planes > SWEPT_P)) {
        s->planes = lanes_alike(compact_together(cell, s->lane, s->planes, s->vertices));
    }
#else
    const bool is_begun = false;
    const real proven = REAL(0.0);
#endif
    if (is_begun || (status == FINISHED)) {
        const bool is_given = give_cell(
            s, is_begun ? begun : given, is_begun ? &counters->begun : &counters->given, is_begun ? params->begun_room : params->given_room, site, exact, proven,
            &place
        );
        // (A stage WITH_EXACT might cut a finished cell in another order, and which cells have no room depends on which came first: no bit is to.)
        if (!is_begun) {
            status = is_given ? FINISHED : BATCH_FULL;
        } else if (is_given && (s->lane == 0u)) {
            begun_places[site] = place + 1u;
        }
    }
#endif
    if (s->lane != 0u) {
        return;
    }
    if (visited > counters->visited) {
        atomic_max(&counters->visited, visited);
    }
#if WITH_SURFACE
    if (s->tried > counters->tried) {
        atomic_max(&counters->tried, s->tried);
    }
#endif
    if (status == BATCH_FULL) {
#if TAKES_CELLS
        // (Its record: it is for want of room for facets alone.)
        full[atomic_inc(&counters->full)] = list[turn];
#else
        full[atomic_inc(&counters->full)] = site;
#endif
        return;
    }
    if (status == BEYOND) {
        atomic_inc(&counters->beyond);
    }
    if ((status == OPEN) || (status == BEYOND)) {
        later[atomic_inc(&counters->later)] = site;
        return;
    }
#if GIVES_CELLS
    if (status == FINISHED) {
        surface[atomic_inc(&counters->surface)] = place;
        return;
    }
#endif
    if ((status != COMPLETE) && (status != EMPTY)) {
#if TAKES_CELLS && (WITH_DOMAIN && !WITH_SURFACE)
        // (Its record, which the stage WITH_SURFACE takes.)
        left[atomic_inc(&counters->left)] = list[turn];
#else
        left[atomic_inc(&counters->left)] = site;
#endif
        return;
    }
    outcome[i] = status | ((exact != 0u) ? OUTCOME_EXACT : 0u);
    if (status == COMPLETE) {
#if SHORT && !WITH_FACETS
        write_sums(sums, FEW_SUMS, i, &part);
#else
        write_sums(sums, params->sums_width, i, &part);
#endif
    }
}
