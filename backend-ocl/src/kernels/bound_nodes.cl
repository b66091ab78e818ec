// The tree over the sorted sites: what bounds the nodes of a level, when those are known that it stands on (`order_of_levels`).

#import "generated/nodes.cl"

INLINE void set_vector(__global real (*of)[WIDTH], uint k, V3 v) {
    of[0][k] = v.x;
    of[1][k] = v.y;
    of[2][k] = v.z;
}

// Sites of a leaf stand so far apart in local memory, so that the work-items of a group, each with a leaf of its own, read from other banks.
#define STRIDE (WIDTH + 1u)

// The same of a node of leaves.
#define STRIDE_OF_NODE ((WIDTH * WIDTH) + 1u)

typedef char group_has_all_sampled[(NODES_GROUP >= MOST_SAMPLED) ? 1 : -1];
typedef char group_has_a_block[((WIDTH * STRIDE_OF_NODE) <= (NODES_GROUP * STRIDE)) ? 1 : -1];

// A leaf by each work-item; of nodes of leaves a block by each group, one by each of its first work-items; a node of a higher level by each group. It brings what they are made of into local memory. (Read from global
// memory, each number was waited for: the five levels of 215,222 sites with weights took 1.16 ms, of which those above the leaves 1.12. With one node above leaves to each group, those of a million sites with
// weights took 1.39 ms. One NVIDIA H200.)
__kernel __attribute__((reqd_work_group_size(NODES_GROUP, 1, 1))) void bound_nodes(BOUND_NODES_ARGUMENTS) {
    __local real4 near[NODES_GROUP * STRIDE];
    __local PartOfNode part[MOST_SAMPLED];
    const uint own = get_local_id(0);
    const uint of_group = (level == 0u) ? NODES_GROUP : ((level == 1u) ? WIDTH : 1u);
    const uint first = (uint)get_group_id(0) * of_group;
    const uint node = first + min(own, of_group - 1u);
    const uint sites_of_tree = params->tree_sites;
    const uint shift = 3u * (level + 1u);
    const uint block = params->tree_begin[level] + (node / WIDTH);
    const uint k = node % WIDTH;
    const ulong begin = (ulong)node << shift;
    const uint count = (begin < sites_of_tree) ? (uint)min((ulong)sites_of_tree - begin, 1ul << shift) : 0u;
    const bool is_large = count > MOST_SAMPLED;
    const V3 none = v3(NOWHERE, NOWHERE, NOWHERE);
    const V3 zero = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    Store source = (Store){
        .near = near, .part = part, .base = params->smallest_weight, .sampled = min(count, MOST_SAMPLED), .curvature_above = zero,
        .parts = is_large ? (((count - 1u) >> (shift - 6u)) + 1u) : 0u
    };
    if (level <= 1u) {
        const uint of_node = (level == 0u) ? WIDTH : (WIDTH * WIDTH);
        const uint stride = (level == 0u) ? STRIDE : STRIDE_OF_NODE;
        source.near = near + (stride * min(own, of_group - 1u));
        for (uint i = own; i < (of_group * of_node); i += NODES_GROUP) {
            near[((i / of_node) * stride) + (i % of_node)] = sites[min((first * of_node) + i, sites_of_tree - 1u)];
        }
    }
    if (level == 0u) {
        // (The blocks of leaves are bounded before, of which all sites are sampled.)
        if ((count > 0u) && ((params->tree_top > 0u) && (params->equal_weights == 0u))) {
            const uint above = node / WIDTH;
            source.curvature_above = weights_in(weight_bounds + (params->tree_begin[1] + (above / WIDTH)), above % WIDTH).curvature;
        }
    } else if (level > 1u) {
        if (own < source.sampled) {
            near[own] = sites[begin + (((ulong)own * count) / source.sampled)];
        }
        if (own < source.parts) {
            const uint its = (params->tree_begin[level - 2u] + (node * WIDTH)) + (own / WIDTH);
            part[own].box = box_in(boxes + its, own % WIDTH);
            part[own].slab = slab_in(slabs + its, own % WIDTH);
            if (params->equal_weights == 0u) {
                part[own].weights = weights_in(weight_bounds + its, own % WIDTH);
            }
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if ((own >= of_group) || (node >= (blocks * WIDTH))) {
        return;
    }
    NodeBox bounds = (NodeBox){ .lo = none, .hi = none };
    NodeSlab slab = (NodeSlab){ .normal = zero, .lo = REAL(0.0), .hi = REAL(0.0), .largest = -INFINITY };
    NodeWeights weights = (NodeWeights){ .offset = -NOWHERE, .slope = zero, .curvature = zero };
    if (count > 0u) {
        bounds = box_of_node(&source);
        slab = slab_of_node(&source, bounds);
        if (params->equal_weights == 0u) {
            weights = weights_of_node(&source, bounds);
        }
    }
    set_vector(boxes[block].lo, k, bounds.lo);
    set_vector(boxes[block].hi, k, bounds.hi);
    set_vector(slabs[block].normal, k, slab.normal);
    slabs[block].lo[k] = slab.lo;
    slabs[block].hi[k] = slab.hi;
    slabs[block].largest_weight[k] = slab.largest;
    if (params->equal_weights == 0u) {
        weight_bounds[block].c[k] = weights.offset;
        set_vector(weight_bounds[block].g, k, weights.slope);
        set_vector(weight_bounds[block].q, k, weights.curvature);
    }
}

// Blocks at hand of a group that looks around a block of leaves, each with one more than its level (0 of a leaf's sites) above its number, as open blocks of a search have it (`tree.rs`); and of them
// those that it looks at in one step.
#define AT_HAND 512u
#define IN_A_STEP (RINGS_GROUP / WIDTH)

// What the sites around each block of leaves weigh at most, less its slope, ring by ring: a group of work-items for each block, which look at eight nodes of eight blocks in one step, the last ones that were
// found, all at what was known before it, so that what comes of it depends on no order. (A work-item for each ring, from the root each time, took 1.8 ms for a million sites; one NVIDIA H200.)
__kernel __attribute__((reqd_work_group_size(RINGS_GROUP, 1, 1))) void look_at_rings(LOOK_AT_RINGS_ARGUMENTS) {
    __local real largest[RINGS];
    __local Seen seen_by[RINGS_GROUP];
    __local uint at_hand[AT_HAND];
    // Bits of those work-items whose nodes are opened, and of those whose nodes, or sites, count as they are.
    __local uint opened[RINGS_GROUP / 32u];
    __local uint counted[RINGS_GROUP / 32u];
    const uint own = get_local_id(0);
    const uint block = get_group_id(0);
    Store source = (Store){ .sites = sites, .boxes = boxes, .weights = weight_bounds, .base = params->smallest_weight, .params = params };
    const Around around_it = around_block(&source, block, params->grid_width);
    const uint tree_sites = params->tree_sites;
    if (own < RINGS) {
        largest[own] = -INFINITY;
    }
    if (own == 0u) {
        at_hand[0] = (params->tree_top + 1u) << LEVEL_SHIFT;
    }
    uint count = 1;
    while (count > 0u) {
        const uint some = min(count, IN_A_STEP);
        if (own < (RINGS_GROUP / 32u)) {
            opened[own] = 0;
            counted[own] = 0;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        bool opens = false;
        uint child = 0;
        if ((own / WIDTH) < some) {
            const uint its = at_hand[(count - some) + (own / WIDTH)];
            const uint level = its >> LEVEL_SHIFT;
            const uint node = ((its & BLOCK_MASK) * WIDTH) + (own % WIDTH);
            if (((ulong)node << (3u * level)) < tree_sites) {
                const Seen seen = (level == 0u) ? look_at_site(&source, around_it, node) : look_at_node(&source, around_it, level - 1u, node);
                real known = -INFINITY;
                for (uint ring = 0; ring <= seen.ring; ring++) {
                    known = fmax(known, largest[ring]);
                }
                if (seen.most > known) {
                    opens = !seen.is_small && (((count - some) + RINGS_GROUP) <= AT_HAND);
                    child = ((level - 1u) << LEVEL_SHIFT) | node;
                    seen_by[own] = seen;
                    atomic_or((opens ? opened : counted) + (own / 32u), 1u << (own % 32u));
                }
            }
        }
        count -= some;
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint word = 0; word < (RINGS_GROUP / 32u); word++) {
            const uint before = popcount(opened[word] & ((1u << (own % 32u)) - 1u));
            if (opens && (word == (own / 32u))) {
                at_hand[count + before] = child;
            }
            count += popcount(opened[word]);
            for (uint left = (own < RINGS) ? counted[word] : 0u; left != 0u; left &= left - 1u) {
                const uint i = (32u * word) + popcount((left & (~left + 1u)) - 1u);
                if (seen_by[i].ring == own) {
                    largest[own] = fmax(largest[own], seen_by[i].most);
                }
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (own < RINGS) {
        real most = largest[0];
        for (uint ring = 1; ring <= own; ring++) {
            most = fmax(most, largest[ring]);
        }
        around[(RINGS * block) + own] = most;
    }
}

// The slabs of a level's nodes from all their sites: a group of work-items for each node.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void tighten_slabs(TIGHTEN_SLABS_ARGUMENTS) {
    __local real lo[GRID_GROUP];
    __local real hi[GRID_GROUP];
    __local real size[GRID_GROUP];
    const uint own = get_local_id(0);
    const uint node = get_group_id(0);
    const uint shift = 3u * (level + 1u);
    __global Slabs *slab = slabs + (params->tree_begin[level] + (node / WIDTH));
    const uint k = node % WIDTH;
    const V3 normal = vector_of(slab->normal, k);
    const ulong begin = (ulong)node << shift;
    const ulong end = min((ulong)params->tree_sites, begin + (1ul << shift));
    real least = INFINITY;
    real most = -INFINITY;
    real largest = REAL(0.0);
    for (ulong i = begin + own; i < end; i += GRID_GROUP) {
        const V3 place = (V3){ .x = sites[i].x, .y = sites[i].y, .z = sites[i].z };
        const real height = v3_dot(normal, place);
        least = fmin(least, height);
        most = fmax(most, height);
        largest = fmax(largest, norm_1(place));
    }
    lo[own] = least;
    hi[own] = most;
    size[own] = largest;
    for (uint distance = GRID_GROUP / 2u; distance > 0u; distance >>= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < distance) {
            lo[own] = fmin(lo[own], lo[own + distance]);
            hi[own] = fmax(hi[own], hi[own + distance]);
            size[own] = fmax(size[own], size[own + distance]);
        }
    }
    if (own == 0u) {
        slab->lo[k] = lo[0] - (FEW_ROUNDINGS_OF_SUM * size[0]);
        slab->hi[k] = hi[0] + (FEW_ROUNDINGS_OF_SUM * size[0]);
    }
}
