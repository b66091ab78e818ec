// A node of the tree, as `nodes.cl` sees it (`NodeSource`).

#import "generated/interface.cl"
#import "generated/tree_types.cl"

typedef struct {
    __global const real4 *sites;
    __global const Boxes *boxes;
    __global const Slabs *slabs;
    __global const WeightBounds *weights;
    real base;
    // Its sites.
    uint begin;
    uint count;
    // The nodes that it is made of: how many, and their first block.
    uint parts;
    uint block;
    V3 curvature_above;
    // The tree, as far as it is made.
    __global const Params *params;
} Store;

INLINE uint store_sampled(Store *s) { return min(s->count, MOST_SAMPLED); }
INLINE real4 sampled_site_of(Store *s, uint i) { return s->sites[s->begin + (uint)(((ulong)i * s->count) / store_sampled(s))]; }
INLINE V3 store_sampled_place(Store *s, uint i) {
    const real4 site = sampled_site_of(s, i);
    return (V3){ .x = site.x, .y = site.y, .z = site.z };
}
INLINE real store_sampled_weight(Store *s, uint i) { return sampled_site_of(s, i).w - s->base; }
INLINE uint store_parts(Store *s) { return s->parts; }
INLINE V3 vector_of(__global const real (*of)[WIDTH], uint k) { return (V3){ .x = of[0][k], .y = of[1][k], .z = of[2][k] }; }
INLINE NodeBox store_part_box(Store *s, uint i) {
    __global const Boxes *block = s->boxes + (s->block + (i / WIDTH));
    return (NodeBox){ .lo = vector_of(block->lo, i % WIDTH), .hi = vector_of(block->hi, i % WIDTH) };
}
INLINE NodeWeights weights_in(__global const WeightBounds *block, uint k) {
    return (NodeWeights){ .offset = block->c[k], .slope = vector_of(block->g, k), .curvature = vector_of(block->q, k) };
}
INLINE NodeSlab store_part_slab(Store *s, uint i) {
    __global const Slabs *block = s->slabs + (s->block + (i / WIDTH));
    const uint k = i % WIDTH;
    return (NodeSlab){ .normal = vector_of(block->normal, k), .lo = block->lo[k], .hi = block->hi[k], .largest = block->largest_weight[k] };
}
INLINE NodeWeights store_part_weights(Store *s, uint i) {
    return weights_in(s->weights + (s->block + (i / WIDTH)), i % WIDTH);
}
INLINE V3 store_curvature_above(Store *s) { return s->curvature_above; }

// The whole tree (`AroundSource`).
INLINE uint store_top_level(Store *s) { return s->params->tree_top; }
INLINE NodeBox store_node_box(Store *s, uint level, uint node) {
    __global const Boxes *block = s->boxes + (s->params->tree_begin[level] + (node / WIDTH));
    return (NodeBox){ .lo = vector_of(block->lo, node % WIDTH), .hi = vector_of(block->hi, node % WIDTH) };
}
INLINE NodeWeights store_node_weights(Store *s, uint level, uint node) {
    return weights_in(s->weights + (s->params->tree_begin[level] + (node / WIDTH)), node % WIDTH);
}
INLINE V3 store_site_place(Store *s, uint j) { return (V3){ .x = s->sites[j].x, .y = s->sites[j].y, .z = s->sites[j].z }; }
INLINE real store_site_weight(Store *s, uint j) { return s->sites[j].w - s->base; }
