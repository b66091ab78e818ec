// The tree over the sorted sites: what bounds the nodes of a level, which those of the levels below it are known for.

#import "nodes.cl"

INLINE void set_vector(__global real (*of)[WIDTH], uint k, V3 v) {
    of[0][k] = v.x;
    of[1][k] = v.y;
    of[2][k] = v.z;
}

__kernel void bound_nodes(BOUND_NODES_ARGUMENTS) {
    const uint node = get_global_id(0);
    const uint sites_of_tree = params->tree_sites;
    const uint shift = 3u * (level + 1u);
    if (node >= (blocks * WIDTH)) {
        return;
    }
    const uint block = params->tree_begin[level] + (node / WIDTH);
    const uint k = node % WIDTH;
    const V3 none = v3(NOWHERE, NOWHERE, NOWHERE);
    const V3 zero = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    NodeBox bounds = (NodeBox){ .lo = none, .hi = none };
    NodeSlab slab = (NodeSlab){ .normal = zero, .lo = REAL(0.0), .hi = REAL(0.0), .largest = -INFINITY };
    NodeWeights weights = (NodeWeights){ .offset = -NOWHERE, .slope = zero, .curvature = zero };
    const ulong begin = (ulong)node << shift;
    if (begin < sites_of_tree) {
        const uint count = (uint)min((ulong)sites_of_tree - begin, 1ul << shift);
        const uint is_large = count > MOST_SAMPLED;
        Store source = (Store){
            .sites = sites, .boxes = boxes, .slabs = slabs, .weights = weight_bounds, .base = params->smallest_weight, .begin = (uint)begin,
            .count = count, .parts = (is_large != 0u) ? (((count - 1u) >> (shift - 6u)) + 1u) : 0u,
            .block = (is_large != 0u) ? (params->tree_begin[level - 2u] + (node * WIDTH)) : 0u
        };
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
