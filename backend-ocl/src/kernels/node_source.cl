// A node of the tree, as `nodes.cl` sees it (`NodeSource`).

#import "generated/interface.cl"
#import "generated/tree_types.cl"

// What bounds a node that another is made of.
typedef struct {
    NodeBox box;
    NodeSlab slab;
    NodeWeights weights;
} PartOfNode;

typedef struct {
    // Of a node (`NodeSource`): its sites, or a sample of them; and the nodes that it is made of.
    __local const real4 *near;
    __local const PartOfNode *part;
    uint sampled;
    uint parts;
    V3 curvature_above;
    // The tree, as far as it is made.
    __global const real4 *sites;
    __global const Boxes *boxes;
    __global const WeightBounds *weights;
    __global const Params *params;
    real base;
} Store;

INLINE V3 vector_of(__global const real (*of)[WIDTH], uint k) { return (V3){ .x = of[0][k], .y = of[1][k], .z = of[2][k] }; }
INLINE NodeBox box_in(__global const Boxes *block, uint k) {
    return (NodeBox){ .lo = vector_of(block->lo, k), .hi = vector_of(block->hi, k) };
}
INLINE NodeSlab slab_in(__global const Slabs *block, uint k) {
    return (NodeSlab){ .normal = vector_of(block->normal, k), .lo = block->lo[k], .hi = block->hi[k], .largest = block->largest_weight[k] };
}
INLINE NodeWeights weights_in(__global const WeightBounds *block, uint k) {
    return (NodeWeights){ .offset = block->c[k], .slope = vector_of(block->g, k), .curvature = vector_of(block->q, k) };
}

INLINE uint store_sampled(Store *s) { return s->sampled; }
INLINE V3 store_sampled_place(Store *s, uint i) { return (V3){ .x = s->near[i].x, .y = s->near[i].y, .z = s->near[i].z }; }
INLINE real store_sampled_weight(Store *s, uint i) { return s->near[i].w - s->base; }
INLINE uint store_parts(Store *s) { return s->parts; }
INLINE NodeBox store_part_box(Store *s, uint i) { return s->part[i].box; }
INLINE NodeSlab store_part_slab(Store *s, uint i) { return s->part[i].slab; }
INLINE NodeWeights store_part_weights(Store *s, uint i) { return s->part[i].weights; }
INLINE V3 store_curvature_above(Store *s) { return s->curvature_above; }

// The whole tree (`AroundSource`).
INLINE uint store_top_level(Store *s) { return s->params->tree_top; }
INLINE uint block_of_node(Store *s, uint level, uint node) { return s->params->tree_begin[level] + (node / WIDTH); }
INLINE NodeBox store_node_box(Store *s, uint level, uint node) { return box_in(s->boxes + block_of_node(s, level, node), node % WIDTH); }
INLINE NodeWeights store_node_weights(Store *s, uint level, uint node) { return weights_in(s->weights + block_of_node(s, level, node), node % WIDTH); }
INLINE V3 store_site_place(Store *s, uint j) { return (V3){ .x = s->sites[j].x, .y = s->sites[j].y, .z = s->sites[j].z }; }
INLINE real store_site_weight(Store *s, uint j) { return s->sites[j].w - s->base; }
