// How a cell that LANES work-items compute together is begun, and clipped.

#import "lanes_exact.cl"

// Words of a bit for each vertex, LANES bits in each. Every lane keeps all of them, in registers unless they are many; then one, if there are enough
// lanes.
#define WORDS (LANES_V / LANES)
#define MANY_WORDS (WORDS > 8u)
#if (LANES > 1u) && (MANY_WORDS && (WORDS <= LANES))
#define SPREADS_WORDS 1
#define KEPT_WORDS 1
#else
#define SPREADS_WORDS 0
#define KEPT_WORDS WORDS
#endif
// Whether marked vertices are looked at one by each lane, and not in the words that they are in, of which each may have few. (A Lévy flight takes 0.183 so, 0.195 word by
// word, sites in a plane 0.085 and 0.089; the 470 largest cells of lognormal radii, which are in global memory, 13 instead of 18 ms. But in stages where no cell is completed by its
// vertices white sites take 2 % longer so, a perturbed lattice 3. One NVIDIA H200.)
#define SPREADS_MARKED (WITH_FAR != 0)
// Words of vertices that are read at once: of those in global memory each lane waits for several together.
#if (LANES > 1u) && (WITH_ROOM == 2)
#define AHEAD 8
#else
#define AHEAD 1
#endif
#if (LANES > 1u) && MANY_WORDS
#define UNROLLED_WORDS
#else
#define UNROLLED_WORDS UNROLLED
#endif
// Words that are gone through for so many vertices: all of them where that is unrolled.
#define WORDS_FOR(vertices) (MANY_WORDS ? (((vertices) + (LANES - 1u)) / LANES) : WORDS)
INLINE uint word_of(const uint *bits, uint word) {
#if SPREADS_WORDS
    return lane_value(bits[0], word);
#else
    return bits[word];
#endif
}
INLINE void set_word(uint *bits, uint lane, uint word, uint value) {
#if SPREADS_WORDS
    bits[0] = (lane == word) ? value : bits[0];
#else
    bits[word] = value;
#endif
}

// How a cell ends that is left to a stage with more room, or where facets are asked for and the surface cuts it by its record to that WITH_SURFACE, and in the end
// to the host; to this kernel built WITH_EXACT; to the stage that TAKES_CELLS.
#define LEFT 32u
#define OPEN 33u
#define FINISHED 34u
// What exact arithmetic is asked of.
#define UNSETTLED ((WITH_EXACT != 0) ? LEFT : OPEN)
// As `OPEN`, for reaching beyond what is searched here, or for more half-spaces than there is room for in a stage that KEEPS_BEGUN: what is there is a whole cell, less far cut.
#define BEYOND 35u

INLINE uint edge_place(uint a, uint b) { return (a * LANES_P) + b; }
INLINE void enter_edges(CELL_SPACE Cell *cell, Triplet t, uint v) {
    cell->vertex_of[edge_place(t.a, t.b)] = (Place)v;
    cell->vertex_of[edge_place(t.b, t.c)] = (Place)v;
    cell->vertex_of[edge_place(t.c, t.a)] = (Place)v;
}

// Starts a cell as the box `[lo, hi]`: the lanes write the same planes, and a corner each.
OUTLINE void begin_together(CELL_SPACE Cell *cell, uint lane, V3 lo, V3 hi) {
    Store store;
    store.cell = cell;
    store.view = WHOLE;
    store.is_fine = 0;
    set_box_planes(&store, lo, hi);
    lanes_wait();
    for (uint v = lane; v < 8u; v += LANES) {
        place_corner(&store, v);
        enter_edges(cell, store_triplet(&store, v), v);
    }
    lanes_wait();
}

// A half-space in single precision, in the frame of the rough places; the size of its normal, and what its offset rounds off.
typedef struct {
    float4 plane;
    float size;
    float slack;
} Trial;

// (In single precision the sum of the normal's size is off by two roundings: `ROUGH_SAFE` of a vertex's radius has room for them.)
INLINE Trial trial_of(Store *s, Plane plane) {
#if HAS_ORIGIN
    const V3 from = origin_of(s->cell);
    const real d = plane.d + v3_dot(plane.n, from);
    const float off = convert_float_rtp((REAL(8.0) * UNIT_ROUNDOFF) * (fabs(plane.d) + (norm_1(plane.n) * norm_1(from))));
#else
    const real d = plane.d;
    const float off = 0.0f;
#endif
    return (Trial){
        .plane = (float4)((float)plane.n.x, (float)plane.n.y, (float)plane.n.z, (float)d),
        .size = convert_float_rtp(norm_1(plane.n)),
        .slack = (((ROUGH * fabs((float)d)) + off) + ROUGH_UNDERFLOW) * ROUGH_SAFE
    };
}

// How far a vertex is within it, in its units; and what is off in that. (Fused, which rounds less, and the same everywhere.)
INLINE float value_at(Trial t, float4 p) { return fma(t.plane.x, p.x, fma(t.plane.y, p.y, fma(t.plane.z, p.z, t.plane.w))); }
INLINE float bound_at(Trial t, float4 p) { return fma(t.size, p.w, t.slack); }

// The rough place of the lane's vertex in a word, of words that are gone through from the first. (Beyond the last vertex there is room, and anything in it.)
INLINE float4 rough_of_word(Store *s, uint word, float4 *ahead) {
#if AHEAD > 1
    if ((word % AHEAD) == 0u) {
        UNROLLED
        for (uint i = 0; i < AHEAD; i++) {
            ahead[i] = s->cell->rough[((word + i) * LANES) + s->lane];
        }
    }
    return ahead[word % AHEAD];
#else
    return s->cell->rough[(word * LANES) + s->lane];
#endif
}

// Whether vertex v is among the marked ones.
INLINE uint is_marked(const uint *bits, uint v) {
#if SPREADS_WORDS
    return (lane_value(bits[0], v / LANES) >> (v & (LANES - 1u))) & 1u;
#elif (LANES > 1u) && !MANY_WORDS
    uint its = bits[0];
    UNROLLED_WORDS
    for (uint word = 1; word < WORDS; word++) {
        its = (v < (word * LANES)) ? its : bits[word];
    }
    return (its >> (v & (LANES - 1u))) & 1u;
#else
    // (Of an edge that is not there, any number.)
    return (bits[min(v / LANES, WORDS - 1u)] >> (v % LANES)) & 1u;
#endif
}

// Those of the lanes' edges a→b that are to be there into the row of the hole's edges, of which there are `count`; returns how many
// there are now.
INLINE uint enter_hole(Store *s, uint is_there, uint a, uint b, uint count) {
    const uint all = lanes_with(is_there);
    const uint rank = count + popcount(all & ((1u << s->lane) - 1u));
    if ((is_there != 0u) && (rank < LANES_V)) {
        s->cell->row[rank] = a | (b << 10);
    }
    return count + popcount(all);
}

// The same of the three edges of each lane's marked vertex t, those whose reverse belongs to no marked one.
INLINE uint enter_hole_at(Store *s, const uint *bits, uint is_there, Triplet t, uint count) {
    CELL_SPACE const Cell *cell = s->cell;
    const uint behind_ab = is_marked(bits, cell->vertex_of[edge_place(t.b, t.a)]);
    const uint behind_bc = is_marked(bits, cell->vertex_of[edge_place(t.c, t.b)]);
    const uint behind_ca = is_marked(bits, cell->vertex_of[edge_place(t.a, t.c)]);
    count = enter_hole(s, is_there & ~behind_ab, t.a, t.b, count);
    count = enter_hole(s, is_there & ~behind_bc, t.b, t.c, count);
    return enter_hole(s, is_there & ~behind_ca, t.c, t.a, count);
}

// Clips by half-space k = `planes`, which is already in its place: `CUT`, `UNTOUCHED`, `EMPTY`, `LEFT` or `OPEN`.
INLINE uint clip_together(Store *s, Trial trial) {
    CELL_SPACE Cell *cell = s->cell;
    const uint k = s->planes;
    const uint end = s->vertices;
    // 1. Mark, as `store.cl` does.
    const uint words = WORDS_FOR(end);
    uint bits[KEPT_WORDS];
#if SPREADS_WORDS
    bits[0] = 0;
#endif
    uint marked = 0;
    float4 ahead[AHEAD];
    UNROLLED_WORDS
    for (uint word = 0; word < words; word++) {
        uint here = 0;
        if ((word * LANES) < end) {
            const uint v = (word * LANES) + s->lane;
            const float4 p = rough_of_word(s, word, ahead);
            const float value = value_at(trial, p);
            const float bound = bound_at(trial, p);
            uint mark = (value < -bound) ? MARK_CONFLICT : ((value > bound) ? MARK_KEEP : MARK_UNCERTAIN);
            mark = (v < end) ? mark : MARK_KEEP;
            if (lanes_with(mark == MARK_UNCERTAIN) != 0u) {
#if SETTLES_CLOSELY
                mark = settle_closely(cell, v, k, mark);
                if (lanes_with(mark == MARK_UNCERTAIN) != 0u) {
                    return OPEN;
                }
#elif WITH_EXACT
                s->exact |= settle_together(cell, s->lane, v, k, &mark);
                if (lanes_with(mark == MARK_UNCERTAIN) != 0u) {
                    return LEFT;
                }
#else
                return OPEN;
#endif
            }
            here = lanes_with(mark == MARK_CONFLICT);
            marked += popcount(here);
        }
        set_word(bits, s->lane, word, here);
    }
    if (marked == 0u) {
        return UNTOUCHED;
    }
    if (marked == end) {
        return EMPTY;
    }
    // 2. The marked vertices in a row, and the edges that bound their hole in another: each gives the new vertex (a, b, k), first into the
    // places of the marked vertices, then at the end.
    const uint below = (1u << s->lane) - 1u;
    uint before = 0;
    uint born = 0;
    UNROLLED_WORDS
    for (uint word = 0; word < words; word++) {
        const uint here = word_of(bits, word);
        if (here != 0u) {
            const uint v = (word * LANES) + s->lane;
            const uint is_there = (here >> s->lane) & 1u;
            const Triplet t = unpacked((is_there != 0u) ? cell->triplet[v] : 0u);
            if (is_there != 0u) {
                cell->marked[before + popcount(here & below)] = v;
            }
            before += popcount(here);
            if (!SPREADS_MARKED) {
                born = enter_hole_at(s, bits, is_there, t, born);
            }
        }
    }
    if (SPREADS_MARKED) {
        lanes_wait();
        ROLLED
        for (uint first = 0; first < marked; first += LANES) {
            const uint is_there = (first + s->lane) < marked;
            const Triplet t = unpacked((is_there != 0u) ? cell->triplet[cell->marked[first + s->lane]] : 0u);
            born = enter_hole_at(s, bits, is_there, t, born);
        }
    }
    const uint count = (end - marked) + born;
    if (count > LANES_V) {
        return LEFT;
    }
    lanes_wait();
    // 3. The new vertices.
    uint status = COMPLETE;
    for (uint rank = s->lane; rank < born; rank += LANES) {
        const uint edge = cell->row[rank];
        const uint slot = (rank < marked) ? cell->marked[rank] : ((end + rank) - marked);
        const Triplet t = (Triplet){ .a = edge & 1023u, .b = edge >> 10, .c = k };
        V3 position;
        real radius;
        store_set_triplet(s, slot, t);
        enter_edges(cell, t, slot);
        if (find_vertex_once(s, t, ONCE_ENOUGH, &position, &radius) == COMPLETE) {
            store_set_position(s, slot, position, radius);
        } else {
#if WITH_EXACT
            uint exact = 0;
            status |= place_carefully(cell, slot, &exact);
            s->exact |= exact;
#elif SETTLES_CLOSELY
            status |= place_closely(cell, slot, 0);
#else
            status = UNCERTAIN;
#endif
        }
    }
    if (lanes_with(status != COMPLETE) != 0u) {
        return UNSETTLED;
    }
    // 4. Fill the places left over from the end.
    lanes_wait();
    if (born < marked) {
        uint moved = born;
        UNROLLED_WORDS
        for (uint word = (MANY_WORDS ? (count / LANES) : 0u); word < words; word++) {
            const uint v = (word * LANES) + s->lane;
            const uint here = word_of(bits, word);
            const uint at_end = (v >= count) && (v < end) && (((here >> s->lane) & 1u) == 0u);
            const uint all = lanes_with(at_end);
            if (at_end != 0u) {
                const uint to = cell->marked[moved + popcount(all & below)];
                const uint same = cell->triplet[v];
                cell->triplet[to] = same;
                cell->rough[to] = cell->rough[v];
                enter_edges(cell, unpacked(same), to);
            }
            moved += popcount(all);
        }
        lanes_wait();
    }
    s->vertices = count;
    s->planes = k + 1u;
    return CUT;
}

#if COMPACTS || KEEPS_BEGUN
#define PLANE_TURNS ((LANES_P + (LANES - 1u)) / LANES)
// Drops the half-spaces that no vertex lies on and renumbers the others in order (`compact_planes`); returns how many are left. (Vertices stay settled:
// where they did not, and all were asked for again, six cells of a million sites on a jittered sphere took 226 ms, and now 107; one NVIDIA H200.)
OUTLINE uint compact_together(CELL_SPACE Cell *cell, uint lane, uint planes, uint vertices) {
    for (uint f = lane; f < LANES_P; f += LANES) {
        cell->row[f] = 0;
    }
    lanes_wait();
    for (uint v = lane; v < vertices; v += LANES) {
        const Triplet t = unpacked(cell->triplet[v]);
        cell->row[t.a] = 1;
        cell->row[t.b] = 1;
        cell->row[t.c] = 1;
    }
    lanes_wait();
    Plane plane[PLANE_TURNS];
    uint source[PLANE_TURNS];
    uint used[PLANE_TURNS];
    for (uint turn = 0; turn < PLANE_TURNS; turn++) {
        const uint f = (turn * LANES) + lane;
        if (f < planes) {
            plane[turn] = cell->plane[f];
            source[turn] = cell->source[f];
        }
        used[turn] = lanes_with((f < planes) && (cell->row[f] != 0u));
    }
    lanes_wait();
    uint kept = 0;
    for (uint turn = 0; turn < PLANE_TURNS; turn++) {
        if (((used[turn] >> lane) & 1u) != 0u) {
            const uint to = kept + popcount(used[turn] & ((1u << lane) - 1u));
            cell->plane[to] = plane[turn];
            cell->source[to] = source[turn];
            cell->row[(turn * LANES) + lane] = to;
        }
        kept += popcount(used[turn]);
    }
    lanes_wait();
    for (uint v = lane; v < vertices; v += LANES) {
        const Triplet t = unpacked(cell->triplet[v]);
        const Triplet to = (Triplet){ .a = cell->row[t.a], .b = cell->row[t.b], .c = cell->row[t.c] };
        cell->triplet[v] = packed(to) | (cell->triplet[v] & SETTLED);
        enter_edges(cell, to, v);
    }
    lanes_wait();
    return kept;
}
#endif

#if WITH_EXACT || CUTS_OUTSIDE
// The store of a cell, to be worked on where it can stay in registers; what the caller takes over from it; and back.
INLINE Store taken_store(const Store *given) {
    Store store = *given;
    store.planes = lanes_alike(store.planes);
    store.vertices = lanes_alike(store.vertices);
    return store;
}
INLINE void take_over(Store *s, const Store *copy) {
    s->planes = lanes_alike(copy->planes);
    s->vertices = lanes_alike(copy->vertices);
    s->exact |= copy->exact;
}
INLINE uint give_back(Store *given, const Store *store, uint status) {
    given->planes = store->planes;
    given->vertices = store->vertices;
    given->exact = store->exact;
    return status;
}
#endif

// Whether there is room for another half-space; in a stage that COMPACTS it is made, where some are not used.
INLINE uint has_room(Store *s) {
#if COMPACTS
    if (s->planes == LANES_P) {
        s->planes = lanes_alike(compact_together(s->cell, s->lane, s->planes, s->vertices));
    }
#endif
    return s->planes < LANES_P;
}

// Cuts by a half-space that `source` says whose it is: `CUT`, `UNTOUCHED`, `EMPTY`, `LEFT`, `OPEN` or `BEYOND`.
INLINE uint cut_together(Store *s, Plane plane, uint source) {
    if (has_room(s) == 0u) {
        return (COMPACTS != 0) ? LEFT : ((KEEPS_BEGUN != 0) ? BEYOND : OPEN);
    }
    if (s->lane == 0u) {
        s->cell->plane[s->planes] = plane;
        s->cell->source[s->planes] = source;
    }
    lanes_wait();
    return clip_together(s, trial_of(s, plane));
}

INLINE uint store_cut(Store *s, Plane plane, uint tag) { return cut_together(s, plane, tag); }

// Whether a site's bisector is among the cell's half-spaces.
INLINE uint has_cut(Store *s, uint site) {
    uint found = 0;
    for (uint f = s->lane; f < s->planes; f += LANES) {
        found |= s->cell->source[f] == site;
    }
    return lanes_with(found) != 0u;
}

// The half-space of the bisector with another site.
INLINE Plane bisector_with(Store *s, uint beyond) {
    const double4 other = s->world.sites[beyond];
    const V3 way = (V3){ .x = other.x - s->site.x, .y = other.y - s->site.y, .z = other.z - s->site.z };
    return bisector(way, s->weight - other.w);
}
