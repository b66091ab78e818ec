// The octree over the container (`core/src/power_octree.rs`): a group of work-items for each part of a box, or for each box.

#import "generated/nodes.cl"

// Before a loop over places, so that what there is of each stays in registers.
#define EACH_PLACE _Pragma("unroll")

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
    const uint size = (uint)get_local_size(0);
    for (uint distance = size / 2u; distance > 0u; distance >>= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < distance) {
            for (uint at = own; at < (places * size); at += size) {
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

// Marks those of a box's leaves with a site that may have the least power somewhere in a part of it, and counts them: each work-item looks at its own.
// (Its loop as a function, called twice, gave marks that differed from run to run where PoCL 3 had two threads.)
__kernel void split_boxes(SPLIT_BOXES_ARGUMENTS) {
    __local real powers[GRID_GROUP * (OCTREE_PLACES - 1u)];
    __local uint of[GRID_GROUP * (OCTREE_PLACES - 1u)];
    __local uint total;
    const uint own = get_local_id(0);
    const uint size = get_local_size(0);
    const uint octant = get_group_id(0) % WIDTH;
    __global const OctreeBox *whole = boxes + (get_group_id(0) / WIDTH);
    const V3 lo = part_lo(corner_of(whole->lo), corner_of(whole->hi), octant);
    const V3 hi = part_hi(corner_of(whole->lo), corner_of(whole->hi), octant);
    const V3 middle = middle_of(lo, hi);
    const V3 halves = half_of(lo, hi, margin);
    const uint all = whole->count;
    const uint last = params->tree_sites;
    const real base = params->smallest_weight;
    __global const uint *list = leaves + whole->begin;
    __global uchar *mark = kept + (((size_t)WIDTH * whole->begin) + ((size_t)octant * all));
    uint count = all;
    // By the site of least power in the middle; and where that leaves many, by those in the middles of the faces.
    for (uint first = 0; (first <= 1u) && ((first == 0u) || (count > FEW_LISTED)); first++) {
        const uint places = (first == 0u) ? 1u : (OCTREE_PLACES - 1u);
        SeenSite others[OCTREE_PLACES - 1u];
        real least[OCTREE_PLACES - 1u];
        uint site[OCTREE_PLACES - 1u];
        EACH_PLACE
        for (uint p = 0; p < (OCTREE_PLACES - 1u); p++) {
            least[p] = INFINITY;
            site[p] = 0;
        }
        for (uint i = own; i < all; i += size) {
            if ((first == 0u) || (mark[i] != 0u)) {
                const uint begin = list[i] * WIDTH;
                const uint end = min(begin + WIDTH, last);
                for (uint j = begin; j < end; j++) {
                    const real4 its = sites[j];
                    EACH_PLACE
                    for (uint p = 0; p < (OCTREE_PLACES - 1u); p++) {
                        if (p >= places) {
                            break;
                        }
                        const real power = power_at(place_of(its), its.w, octree_place(middle, halves, first + p));
                        site[p] = (power < least[p]) ? j : site[p];
                        least[p] = (power < least[p]) ? power : least[p];
                    }
                }
            }
        }
        EACH_PLACE
        for (uint p = 0; p < (OCTREE_PLACES - 1u); p++) {
            if (p >= places) {
                break;
            }
            powers[(p * size) + own] = least[p];
            of[(p * size) + own] = site[p];
        }
        least_of_group(powers, of, places);
        EACH_PLACE
        for (uint p = 0; p < (OCTREE_PLACES - 1u); p++) {
            if (p >= places) {
                break;
            }
            const real4 other = sites[of[p * size]];
            others[p] = seen_from(place_of(other), other.w - base, middle);
        }
        if (own == 0u) {
            total = 0;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        uint found = 0;
        for (uint i = own; i < all; i += size) {
            bool stays = false;
            if ((first == 0u) || (mark[i] != 0u)) {
                const uint begin = list[i] * WIDTH;
                const uint end = min(begin + WIDTH, last);
                for (uint j = begin; (j < end) && !stays; j++) {
                    const real4 its = sites[j];
                    const SeenSite seen = seen_from(place_of(its), its.w - base, middle);
                    bool has_more = false;
                    EACH_PLACE
                    for (uint p = 0; p < (OCTREE_PLACES - 1u); p++) {
                        if ((p >= places) || has_more) {
                            break;
                        }
                        has_more = more_power(seen, others[p], halves) > REAL(0.0);
                    }
                    stays = !has_more;
                }
            }
            mark[i] = stays ? 1u : 0u;
            found += stays ? 1u : 0u;
        }
        atomic_add(&total, found);
        barrier(CLK_LOCAL_MEM_FENCE);
        count = total;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (own == 0u) {
        counts[get_group_id(0)] = count;
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
