// The octree over the container, as the search sees it (`OctreeStore`).

#if LANES && WITH_OCTREE
INLINE V3 store_octree_lo(Store *s) { return v3(s->world.params->box_lo[0], s->world.params->box_lo[1], s->world.params->box_lo[2]); }
INLINE V3 store_octree_hi(Store *s) { return v3(s->world.params->box_hi[0], s->world.params->box_hi[1], s->world.params->box_hi[2]); }
INLINE real store_octree_off(Store *s) { return s->world.params->octree_off; }
INLINE OctreeNode store_octree_node(Store *s, uint i) {
    const uint2 node = s->world.octree_nodes[i];
    return (OctreeNode){ .begin = node.x, .count = node.y };
}
INLINE uint store_octree_leaf(Store *s, uint i) { return s->world.octree_leaves[i]; }

INLINE uint store_lane(Store *s);
INLINE void store_lanes_wait(Store *s);
INLINE void store_set_leaf(Store *s, uint i, uint leaf, uint key, uint asks);
INLINE OctreePlace octree_box_at(Store *s, V3 place);

INLINE uint store_set_listed_leaves(Store *s, uint asks) {
    if (s->world.params->octree_off == REAL(0.0)) {
        return 0u;
    }
    const Asked asked = s->asked;
    const V3 place = v3(s->site.x + asked.place.x, s->site.y + asked.place.y, s->site.z + asked.place.z);
    const real rounding = UNIT_ROUNDOFF * ((fabs(place.x) + fabs(place.y)) + fabs(place.z));
    if (!((asked.radius + rounding) <= s->world.params->octree_off)) {
        return 0u;
    }
    const OctreeNode node = octree_box_at(s, place).node;
    for (uint i = store_lane(s); i < node.count; i += LANES) {
        store_set_leaf(s, i, s->world.octree_leaves[node.begin + i], 0u, asks);
    }
    store_lanes_wait(s);
    return node.count;
}
INLINE uint store_home(Store *s, V3 *place) {
    if (s->world.params->octree_off == REAL(0.0)) {
        return HOME_UNKNOWN;
    }
    const uint home = s->world.octree_homes[s->own];
    if (home >= NO_BOX) {
        return (home == NO_BOX) ? HOME_UNKNOWN : HOME_NOWHERE;
    }
#if WITH_WEIGHTS
    const real4 middle = s->world.octree_middles[home];
    *place = v3(middle.x - s->site.x, middle.y - s->site.y, middle.z - s->site.z);
#endif
    return HOME_KNOWN;
}
INLINE uint visit_leaves(Store *s, Vantage vantage, uint leaves, bool is_home, uint *visited);
INLINE uint store_visit_leaves(Store *s, Vantage vantage, uint leaves, bool is_home, uint *visited) { return visit_leaves(s, vantage, leaves, is_home, visited); }
#else
// (One work-item alone goes through the tree over the sites.)
INLINE V3 store_octree_lo(Store *s) { return v3(REAL(0.0), REAL(0.0), REAL(0.0)); }
INLINE V3 store_octree_hi(Store *s) { return v3(REAL(0.0), REAL(0.0), REAL(0.0)); }
INLINE real store_octree_off(Store *s) { return REAL(0.0); }
INLINE OctreeNode store_octree_node(Store *s, uint i) { return (OctreeNode){ .begin = 0u, .count = 0u }; }
INLINE uint store_octree_leaf(Store *s, uint i) { return 0u; }
INLINE uint store_set_listed_leaves(Store *s, uint asks) { return 0u; }
INLINE uint store_home(Store *s, V3 *place) { return HOME_UNKNOWN; }
INLINE uint store_visit_leaves(Store *s, Vantage vantage, uint leaves, bool is_home, uint *visited) { return UNTOUCHED; }
#endif
