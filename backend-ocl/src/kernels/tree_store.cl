// What the search (`tree_search.cl`) reads of sites and tree, wherever a cell lives.

#import "generated/cell.cl"
#import "generated/tree_types.cl"

INLINE uint store_sites(Store *s) { return s->world.params->tree_sites; }
INLINE uint store_own_site(Store *s) { return s->own; }
INLINE uint store_top_level(Store *s) { return s->world.params->tree_top; }
INLINE uint block_of_tree(Store *s, uint level, uint node) { return s->world.params->tree_begin[level] + (node / WIDTH); }
INLINE NodeBox store_node_box(Store *s, uint level, uint node) {
    __global const Boxes *block = s->world.boxes + block_of_tree(s, level, node);
    const uint k = node % WIDTH;
    return (NodeBox){ .lo = { block->lo[0][k], block->lo[1][k], block->lo[2][k] }, .hi = { block->hi[0][k], block->hi[1][k], block->hi[2][k] } };
}
INLINE NodeSlab store_node_slab(Store *s, uint level, uint node) {
    __global const Slabs *block = s->world.slabs + block_of_tree(s, level, node);
    const uint k = node % WIDTH;
    return (NodeSlab){
        .normal = { block->normal[0][k], block->normal[1][k], block->normal[2][k] }, .lo = block->lo[k], .hi = block->hi[k],
        .largest = block->largest_weight[k]
    };
}

#if LANES && WITH_SWEEP
INLINE RoughVertex store_rough_vertex(Store *s, uint v) {
    const float4 p = s->cell->rough[v];
    return (RoughVertex){ .x = p.x, .y = p.y, .z = p.z, .radius = p.w };
}
#else
INLINE RoughVertex store_rough_vertex(Store *s, uint v) { return (RoughVertex){ .x = 0.0f, .y = 0.0f, .z = 0.0f, .radius = 0.0f }; }
#endif
#if LANES && GOES_ON
// Sites from all over, so many of each node beside one that holds the cell's own, but for leaves: spread evenly along the curve, one of all nodes before the next of each. What decides how
// many, and why there are any, is in `README.md`.
#define OF_NODE ((WITH_SWEEP != 0) ? 8u : 32u)
INLINE uint sites_about(Store *s) { return (OF_NODE * WIDTH) * store_top_level(s); }
INLINE uint site_about(Store *s, uint i) {
    const uint nodes = WIDTH * store_top_level(s);
    const uint turn = i / nodes;
    const uint node = i % nodes;
    const uint size = (WIDTH * WIDTH) << (3u * (node / WIDTH));
    const uint first = (s->own & ~((size * WIDTH) - 1u)) + ((node % WIDTH) * size);
    const uint site = first + (((2u * turn) + 1u) * (size / (2u * OF_NODE)));
    return (site < store_sites(s)) ? site : s->own;
}
INLINE uint store_kept_count(Store *s) { return s->kept_count; }
INLINE uint store_kept_site(Store *s, uint i) {
#if WITH_SWEEP
    if (s->is_shown != 0u) {
        return s->kept[i];
    }
#endif
    return site_about(s, i);
}
#else
INLINE uint store_kept_count(Store *s) { return 0u; }
INLINE uint store_kept_site(Store *s, uint i) { return NO_SITE; }
#endif
// One vertex is asked for at a time, by each team. (Four, each in open blocks and leaves of its own, so that all 32 lanes have some, took a million sites on a bumpy
// surface 1.2 instead of 0.68 s, in a plane 0.11 instead of 0.09, one NVIDIA H200: a step of the tree costs the instructions it takes, then 310, of which
// 73 are in double precision, of two cycles each. It takes 500 where lanes differ in what they ask, and four times as many blocks are open as are taken at a time.)
INLINE uint store_most_asked(Store *s) { return 1u; }
INLINE Asked store_asked(Store *s, uint i) { return s->asked; }
INLINE void store_set_asked(Store *s, uint i, Asked asked) { s->asked = asked; }
INLINE uint store_open_asks(Store *s, uint i) { return 1u; }
INLINE uint store_leaf_asks(Store *s, uint i) { return 1u; }
INLINE uint store_asks_of_site(Store *s, uint j, uint asks) { return asks; }
#if TEAMS <= 1
INLINE uint store_teams(Store *s) { return 1u; }
INLINE bool store_shares_vertices(Store *s) { return false; }
INLINE uint store_team(Store *s) { return 0u; }
INLINE void store_teams_wait(Store *s) {}
INLINE uint store_first_says(Store *s, uint what) { return what; }
INLINE Answer store_answer(Store *s, uint team) { return (Answer){ 0 }; }
INLINE void store_set_answer(Store *s, Answer answer) {}
#if !LANES || SEARCHES_TREE
INLINE uint store_candidate(Store *s, uint i);
INLINE uint store_tied(Store *s, uint team, uint i) { return store_candidate(s, i); }
#endif
#endif
#import "octree_store.cl"
#if LANES && ((WITH_FAR || WITH_SWEEP) || WITH_WEIGHTS)
INLINE uint store_leaves_if_far(Store *s) { return s->world.params->leaves_if_far; }
#else
INLINE uint store_leaves_if_far(Store *s) { return 0u; }
#endif
// (Only where weights differ; where they are equal `Sweep` does it, without domain and facets. Not of large cells, of which one team alone would look at all: 107 of transport in a domain 3.8 instead of 2.2 ms. One NVIDIA H200.)
#if LANES && ((WITH_FAR && WITH_WEIGHTS) && (TEAMS <= 1))
INLINE bool store_is_swept(Store *s) { return true; }
#else
INLINE bool store_is_swept(Store *s) { return false; }
#endif
INLINE uint store_most_ties(Store *s) { return MOST_CANDIDATES; }

// (Of a search of the table alone there is none.)
#if !LANES || SEARCHES_TREE
INLINE uint asks_by_powers(Store *s, uint level, uint node, uint of_block, uint *key);
INLINE uint store_asks_of_node(Store *s, uint level, uint node, uint asks, uint *key) { return asks_by_powers(s, level, node, asks, key); }
#endif

#if WITH_WEIGHTS
#if WITH_TABLE && !LANES
// (One work-item alone searches the tree where they do.)
INLINE bool store_has_weights(Store *s) { return false; }
#else
INLINE bool store_has_weights(Store *s) { return s->world.params->equal_weights == 0u; }
#endif
INLINE NodeWeights store_node_weights(Store *s, uint level, uint node) {
#if !LANES
    // (Where weights are asked for at run time: without them there are no bounds.)
    if (!store_has_weights(s)) {
        return (NodeWeights){ 0 };
    }
#endif
    __global const WeightBounds *block = s->world.weight_bounds + block_of_tree(s, level, node);
    const uint k = node % WIDTH;
    return (NodeWeights){
        .offset = block->c[k], .slope = { block->g[0][k], block->g[1][k], block->g[2][k] },
        .curvature = { block->q[0][k], block->q[1][k], block->q[2][k] }
    };
}
#else
INLINE bool store_has_weights(Store *s) { return false; }
INLINE NodeWeights store_node_weights(Store *s, uint level, uint node) { return (NodeWeights){ 0 }; }
#endif

// Numbers in single precision in their order.
INLINE uint in_order(float x) {
    const uint bits = as_uint(x);
    return bits ^ ((((int)bits < 0) ? 0xFFFFFFFFu : 0u) | 0x80000000u);
}
INLINE uint store_key_below(Store *s, real x) { return in_order(convert_float_rtn(x)); }
INLINE uint store_key_above(Store *s, real x) { return in_order(convert_float_rtp(x)); }
