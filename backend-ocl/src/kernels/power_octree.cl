// The octree over the container (`core/src/power_octree.rs`): a group of work-items for each part of a box, for some of its leaves, or for each box.

#import "generated/nodes.cl"

// Before a loop over places, so that what there is of each stays in registers.
#define EACH_PLACE _Pragma("unroll")

// Places but the first, which is a box's middle; and leaves that are marked at a time.
#define FACES (OCTREE_PLACES - 1u)
#define MARKED 1024u

#define NO_LEAST 0xffffffffu

INLINE V3 corner_of(__global const double *corner) { return v3(corner[0], corner[1], corner[2]); }
INLINE void set_corner(__global double *corner, V3 v) {
    corner[0] = v.x;
    corner[1] = v.y;
    corner[2] = v.z;
}
INLINE V3 place_of(real4 site) { return v3(site.x, site.y, site.z); }

// Of each of several places the site with the least of the work-items' powers in a group, of equals the first: each has put the least of its own behind those of
// the work-items before. They stand where the first had its own. (One place after the other, by six times as many barriers, took a tenth more of
// split_boxes.)
INLINE void least_of_group(__local real *powers, __local uint *of, uint places) {
    const uint own = get_local_id(0);
    for (uint distance = OCTREE_GROUP / 2u; distance > 0u; distance >>= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < distance) {
            for (uint at = own; at < (places * OCTREE_GROUP); at += OCTREE_GROUP) {
                const real other = powers[at + distance];
                const uint its = of[at + distance];
                if ((other < powers[at]) || ((other == powers[at]) && (its < of[at]))) {
                    powers[at] = other;
                    of[at] = its;
                }
            }
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

// A part of a box, and those of the box's leaves, from `begin` to before `end`, that a group looks at.
typedef struct {
    V3 middle;
    V3 halves;
    __global const uint *list;
    __global uchar *mark;
    uint begin;
    uint end;
} Part;

// One of `slices` of a part's leaves.
INLINE Part part_of(Splitting s, uint part, uint slice, uint slices) {
    __global const OctreeBox *whole = s.boxes + (part / WIDTH);
    const uint octant = part % WIDTH;
    const uint all = whole->count;
    const V3 lo = part_lo(corner_of(whole->lo), corner_of(whole->hi), octant);
    const V3 hi = part_hi(corner_of(whole->lo), corner_of(whole->hi), octant);
    const uint each = (all + (slices - 1u)) / slices;
    const uint begin = min(slice * each, all);
    return (Part){
        .middle = middle_of(lo, hi),
        .halves = half_of(lo, hi, s.margin),
        .list = s.leaves + whole->begin,
        .mark = s.kept + (((size_t)WIDTH * whole->begin) + ((size_t)octant * all)),
        .begin = begin,
        .end = min(begin + each, all)
    };
}

// Of the middle, or with `is_second` of each middle of a face, the site of least power, of those leaves that are marked then: a work-item for each site, so that those of a leaf are read together.
INLINE void find_least(Splitting s, Part part, bool is_second, __local real *powers, __local uint *of) {
    const uint own = get_local_id(0);
    const uint places = is_second ? FACES : 1u;
    const uint last = s.params->tree_sites;
    real least[FACES];
    uint site[FACES];
    EACH_PLACE
    for (uint p = 0; p < FACES; p++) {
        least[p] = INFINITY;
        site[p] = NO_LEAST;
    }
    for (uint i = (part.begin * WIDTH) + own; i < (part.end * WIDTH); i += OCTREE_GROUP) {
        const uint at = i / WIDTH;
        const uint j = (part.list[at] * WIDTH) + (i % WIDTH);
        if ((j < last) && (!is_second || (part.mark[at] != 0u))) {
            const real4 its = s.sites[j];
            EACH_PLACE
            for (uint p = 0; p < FACES; p++) {
                if (p >= places) {
                    break;
                }
                const real power = power_at(place_of(its), its.w, octree_place(part.middle, part.halves, p + (is_second ? 1u : 0u)));
                site[p] = (power < least[p]) ? j : site[p];
                least[p] = (power < least[p]) ? power : least[p];
            }
        }
    }
    EACH_PLACE
    for (uint p = 0; p < FACES; p++) {
        if (p >= places) {
            break;
        }
        powers[(p * OCTREE_GROUP) + own] = least[p];
        of[(p * OCTREE_GROUP) + own] = site[p];
    }
    least_of_group(powers, of, places);
}

// Marks those leaves, with `is_second` of those that are marked, with a site that may have less power than each of those that have the least (`of`, as `find_least` has them)
// somewhere in the part; how many they are. `others`, `bits` and `total` are scratch.
INLINE uint mark_leaves(Splitting s, Part part, bool is_second, __local const uint *of, __local SeenSite *others, __local uint *bits, __local uint *total) {
    const uint own = get_local_id(0);
    const uint places = is_second ? FACES : 1u;
    const uint last = s.params->tree_sites;
    const real base = s.params->smallest_weight;
    uint found = 0;
    if (own < places) {
        const real4 other = s.sites[of[own * OCTREE_GROUP]];
        others[own] = seen_from(place_of(other), other.w - base, part.middle);
    }
    if (own == 0u) {
        *total = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint from = part.begin; from < part.end; from += MARKED) {
        const uint to = min(from + MARKED, part.end);
        for (uint i = own; i < (MARKED / 32u); i += OCTREE_GROUP) {
            bits[i] = 0;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint i = (from * WIDTH) + own; i < (to * WIDTH); i += OCTREE_GROUP) {
            const uint at = i / WIDTH;
            const uint j = (part.list[at] * WIDTH) + (i % WIDTH);
            if ((j < last) && (!is_second || (part.mark[at] != 0u))) {
                const real4 its = s.sites[j];
                const SeenSite seen = seen_from(place_of(its), its.w - base, part.middle);
                bool has_more = false;
                for (uint p = 0; (p < places) && !has_more; p++) {
                    has_more = more_power(seen, others[p], part.halves) > REAL(0.0);
                }
                if (!has_more) {
                    atomic_or(&bits[(at - from) / 32u], 1u << ((at - from) % 32u));
                }
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint at = from + own; at < to; at += OCTREE_GROUP) {
            const uint stays = (bits[(at - from) / 32u] >> ((at - from) % 32u)) & 1u;
            part.mark[at] = (uchar)stays;
            found += stays;
        }
        barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    }
    atomic_add(total, found);
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint count = *total;
    barrier(CLK_LOCAL_MEM_FENCE);
    return count;
}

// Marks those of a box's leaves with a site that may have the least power somewhere in a part of it, and counts them: by the site of least power in the middle; and where that leaves
// many, by those in the middles of the faces. A group for each part.
__kernel __attribute__((reqd_work_group_size(OCTREE_GROUP, 1, 1))) void split_boxes(SPLIT_BOXES_ARGUMENTS) {
    __local real powers[OCTREE_GROUP * FACES];
    __local uint of[OCTREE_GROUP * FACES];
    __local SeenSite others[FACES];
    __local uint bits[MARKED / 32u];
    __local uint total;
    const Splitting s = SPLITTING_OF_ARGUMENTS;
    const Part part = part_of(s, get_group_id(0), 0u, 1u);
    uint count = 0;
    // (A loop: as functions that are called twice PoCL 3 gave marks that differed from run to run.)
    for (uint turn = 0; (turn <= 1u) && ((turn == 0u) || (count > FEW_LISTED)); turn++) {
        find_least(s, part, turn != 0u, powers, of);
        count = mark_leaves(s, part, turn != 0u, of, others, bits, &total);
    }
    if (get_local_id(0) == 0u) {
        counts[get_group_id(0)] = count;
    }
}

// The same where boxes list many leaves, in four steps, a group for each of `slices` of the leaves: the sites of least power of each slice;
__kernel __attribute__((reqd_work_group_size(OCTREE_GROUP, 1, 1))) void find_leasts(FIND_LEASTS_ARGUMENTS) {
    __local real powers[OCTREE_GROUP * FACES];
    __local uint of[OCTREE_GROUP * FACES];
    const uint own = get_local_id(0);
    const uint number = get_group_id(0) / slices;
    if ((is_second != 0u) && (firsts[number] <= FEW_LISTED)) {
        return;
    }
    const Splitting s = SPLITTING_OF_ARGUMENTS;
    find_least(s, part_of(s, number, get_group_id(0) % slices, slices), is_second != 0u, powers, of);
    if (own < ((is_second != 0u) ? FACES : 1u)) {
        leasts[(get_group_id(0) * FACES) + own] = of[own * OCTREE_GROUP];
    }
}

// and by the least of these the leaves of each. They are counted in `firsts`, the second time in `counts`.
__kernel __attribute__((reqd_work_group_size(OCTREE_GROUP, 1, 1))) void mark_slices(MARK_SLICES_ARGUMENTS) {
    __local real powers[OCTREE_GROUP * FACES];
    __local uint of[OCTREE_GROUP * FACES];
    __local SeenSite others[FACES];
    __local uint bits[MARKED / 32u];
    __local uint total;
    const uint own = get_local_id(0);
    const uint number = get_group_id(0) / slices;
    const uint slice = get_group_id(0) % slices;
    const uint places = (is_second != 0u) ? FACES : 1u;
    if ((is_second != 0u) && (firsts[number] <= FEW_LISTED)) {
        if ((own == 0u) && (slice == 0u)) {
            counts[number] = firsts[number];
        }
        return;
    }
    const Splitting s = SPLITTING_OF_ARGUMENTS;
    const Part part = part_of(s, number, slice, slices);
    for (uint p = 0; p < places; p++) {
        const V3 place = octree_place(part.middle, part.halves, p + is_second);
        real least = INFINITY;
        uint site = NO_LEAST;
        for (uint i = own; i < slices; i += OCTREE_GROUP) {
            const uint j = leasts[(((number * slices) + i) * FACES) + p];
            if (j != NO_LEAST) {
                const real power = power_at(place_of(sites[j]), sites[j].w, place);
                if ((power < least) || ((power == least) && (j < site))) {
                    least = power;
                    site = j;
                }
            }
        }
        powers[(p * OCTREE_GROUP) + own] = least;
        of[(p * OCTREE_GROUP) + own] = site;
    }
    least_of_group(powers, of, places);
    const uint count = mark_leaves(s, part, is_second != 0u, of, others, bits, &total);
    if (own == 0u) {
        atomic_add((is_second != 0u) ? &counts[number] : &firsts[number], count);
    }
}

// What becomes of each part, as numbers that are summed up then.
__kernel void judge_parts(JUDGE_PARTS_ARGUMENTS) {
    const uint part = get_global_id(0);
    if (part > parts) {
        return;
    }
    uint is_split = 0;
    uint keeps = 0;
    if (part < parts) {
        __global const OctreeBox *whole = boxes + (part / WIDTH);
        keeps = counts[part];
        is_split = part_is_split(keeps, barren_of_part(whole->barren, keeps, whole->count), depth) ? 1u : 0u;
        if ((is_split == 0u) && (keeps > most)) {
            keeps = 0;
            *unlisted = 1u;
        }
    }
    splits[part] = is_split;
    wholes[part] = (is_split != 0u) ? keeps : 0u;
    lists[part] = (is_split != 0u) ? 0u : keeps;
}

// Writes the box of each part, and again where it is split next, and puts the marked leaves in their place: where it begins among those of boxes that are split next, or of those that are listed.
__kernel __attribute__((reqd_work_group_size(OCTREE_GROUP, 1, 1))) void place_leaves(PLACE_LEAVES_ARGUMENTS) {
    __local uint begins[OCTREE_GROUP];
    const uint own = get_local_id(0);
    const uint part = get_group_id(0);
    __global const OctreeBox *whole = boxes + (part / WIDTH);
    const uint all = whole->count;
    const uint keeps = counts[part];
    const bool is_split = splits[part + 1u] != splits[part];
    if (own == 0u) {
        const uint octant = part % WIDTH;
        const V3 lo = part_lo(corner_of(whole->lo), corner_of(whole->hi), octant);
        const V3 hi = part_hi(corner_of(whole->lo), corner_of(whole->hi), octant);
        const V3 middle = middle_of(lo, hi);
        middles[first + part] = (real4)((float)middle.x, (float)middle.y, (float)middle.z, REAL(0.0));
        uint2 node = (uint2)(0u, UNLISTED);
        if (is_split) {
            __global OctreeBox *box = next_boxes + splits[part];
            set_corner(box->lo, lo);
            set_corner(box->hi, hi);
            box->begin = wholes[part];
            box->count = keeps;
            box->node = first + part;
            box->barren = barren_of_part(whole->barren, keeps, all);
        } else if (keeps <= most) {
            node = (uint2)(before + lists[part], keeps);
        }
        nodes[first + part] = node;
        if (octant == 0u) {
            nodes[whole->node] = (uint2)(first + part, HAS_PARTS);
        }
    }
    if (!is_split && (keeps > most)) {
        return;
    }
    __global const uint *list = leaves + whole->begin;
    __global const uchar *mark = kept + (((size_t)WIDTH * whole->begin) + ((size_t)(part % WIDTH) * all));
    __global uint *target = is_split ? (next + wholes[part]) : (listed + (before + lists[part]));
    // (Each its own, one after the other, so that their order stays.)
    const uint each = (all + (OCTREE_GROUP - 1u)) / OCTREE_GROUP;
    const uint begin = min(own * each, all);
    const uint end = min(begin + each, all);
    uint count = 0;
    for (uint i = begin; i < end; i++) {
        count += mark[i];
    }
    begins[own] = count;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint at = 0;
    for (uint i = 0; i < own; i++) {
        at += begins[i];
    }
    for (uint i = begin; i < end; i++) {
        if (mark[i] != 0u) {
            target[at] = list[i];
            at += 1u;
        }
    }
}

// For each site the least of its ways home (`way_home`) from the middles of the boxes that list it; and with `is_second` the first box of that way.
__kernel __attribute__((reqd_work_group_size(OCTREE_GROUP, 1, 1))) void find_homes(FIND_HOMES_ARGUMENTS) {
    __local real powers[OCTREE_GROUP];
    __local uint of[OCTREE_GROUP];
    const uint own = get_local_id(0);
    const uint node = get_group_id(0);
    const uint2 its = nodes[node];
    const uint last = params->tree_sites;
    if ((its.y >= UNLISTED) || (its.y == 0u)) {
        return;
    }
    __global const uint *list = listed + its.x;
    const V3 middle = place_of(middles[node]);
    const uint all = its.y * WIDTH;
    real least = INFINITY;
    uint first = 0;
    for (uint i = own; i < all; i += OCTREE_GROUP) {
        const uint j = (list[i / WIDTH] * WIDTH) + (i % WIDTH);
        if (j < last) {
            const real4 site = sites[j];
            const real power = power_at(place_of(site), site.w, middle);
            first = (power < least) ? j : first;
            least = (power < least) ? power : least;
        }
    }
    powers[own] = least;
    of[own] = first;
    least_of_group(powers, of, 1);
    first = of[0];
    const V3 place = place_of(sites[first]);
    least = power_at(place, sites[first].w, middle);
    for (uint i = own; i < all; i += OCTREE_GROUP) {
        const uint j = (list[i / WIDTH] * WIDTH) + (i % WIDTH);
        if (j < last) {
            const real4 site = sites[j];
            const real power = power_at(place_of(site), site.w, middle);
            const uint way = as_uint(way_home(place_of(site), power, place, least));
            if (is_second == 0u) {
                atomic_min(&ways[j], way);
            } else if (way == ways[j]) {
                atomic_min(&homes[j], node);
            }
        }
    }
}
