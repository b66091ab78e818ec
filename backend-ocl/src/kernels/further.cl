// What is not there for every cell: without it, what the generated text does for it is compiled to nothing. What only some requests ask for is
// built with -D WITH_FACET_SECOND and WITH_INTEGRAL.

#import <store>

#ifdef SHORT
INLINE bool store_is_short(Store *s) { return SHORT; }
#else
INLINE bool store_is_short(Store *s) { return false; }
#endif

// There is no room to keep minors.
INLINE int store_narrow_sign(Store *s, Triplet t, uint v, uint k) { return SIGN_UNKNOWN; }
INLINE bool store_keeps_minors(Store *s) { return false; }
INLINE Minors store_minors(Store *s, uint v) { return (Minors){ 0 }; }
INLINE void store_keep_minors(Store *s, uint v, Minors minors) {}

#if WITH_FACET_SECOND
INLINE FacetSecond store_facet_second(Store *s, uint f) { return s->facet_second[f]; }
INLINE void store_set_facet_second(Store *s, uint f, FacetSecond second) { s->facet_second[f] = second; }
#else
INLINE FacetSecond store_facet_second(Store *s, uint f) { return (FacetSecond){ 0 }; }
INLINE void store_set_facet_second(Store *s, uint f, FacetSecond second) {}
#endif

#if WITH_INTEGRAL
OUTLINE real polynomial(Store *s, V3 x);

INLINE uint store_nodes(Store *s) { return s->world.params->nodes; }
INLINE Node store_node(Store *s, uint q) {
    __global const host_real *node = s->world.integrand + (4u * q);
    return (Node){ .place = (V3){ .x = node[0], .y = node[1], .z = node[2] }, .weight = node[3] };
}
INLINE uint store_degree(Store *s) { return s->world.params->degree; }
INLINE V3 store_origin(Store *s) {
    __global const host_real *origin = s->world.params->origin;
    return (V3){ .x = origin[0], .y = origin[1], .z = origin[2] };
}
INLINE real store_coefficient(Store *s, uint i) { return s->world.integrand[(4u * s->world.params->nodes) + i]; }
INLINE real store_function(Store *s, V3 x) { return polynomial(s, x); }
#else
INLINE uint store_nodes(Store *s) { return 0u; }
INLINE Node store_node(Store *s, uint q) { return (Node){ 0 }; }
INLINE uint store_degree(Store *s) { return 0u; }
INLINE V3 store_origin(Store *s) { return (V3){ 0 }; }
INLINE real store_coefficient(Store *s, uint i) { return REAL(0.0); }
INLINE real store_function(Store *s, V3 x) { return REAL(0.0); }
#endif
