// What a cell sees of other sites, in double precision.

INLINE V3 store_way_to(Store *s, uint j) {
    const double4 other = s->world.sites[j];
    return (V3){ .x = other.x - s->site.x, .y = other.y - s->site.y, .z = other.z - s->site.z };
}
#if WITH_WEIGHTS
INLINE real store_excess_of(Store *s, uint j) { return s->world.sites[j].w - s->weight; }
INLINE real store_own_excess(Store *s) { return s->weight - s->world.params->smallest_weight; }
INLINE real store_largest_excess(Store *s) { return s->world.params->largest_weight - s->weight; }
#else
INLINE real store_excess_of(Store *s, uint j) { return REAL(0.0); }
INLINE real store_own_excess(Store *s) { return REAL(0.0); }
INLINE real store_largest_excess(Store *s) { return REAL(0.0); }
#endif
