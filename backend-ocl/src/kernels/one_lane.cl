// A work-item that computes a cell alone is the one lane that does.

INLINE uint store_lanes(Store *s) { return 1u; }
INLINE uint store_lane(Store *s) { return 0u; }
INLINE uint store_lanes_with(Store *s, bool is_so) { return is_so; }
INLINE uint store_count_of(Store *s, uint lanes) { return lanes; }
INLINE uint store_rank_in(Store *s, uint lanes) { return 0u; }
INLINE uint store_first_of(Store *s, uint lanes) { return 0u; }
INLINE uint store_least_of_lanes(Store *s, uint x) { return x; }
INLINE uint store_lane_of_key(Store *s, uint own, uint least) { return 0u; }
INLINE uint store_lane_value(Store *s, uint x, uint from) { return x; }
INLINE real store_lane_real(Store *s, real x, uint from) { return x; }
INLINE void store_lanes_wait(Store *s) {}
INLINE real store_most_of_lanes(Store *s, real x) { return x; }
INLINE V3 store_most_along_axes(Store *s, V3 x) { return x; }

// (Where clipping is: `generated/cell_alone.cl`.)
INLINE uint store_cut(Store *s, Plane plane, uint tag);

// One after the other, all vertices add to the same sums.
INLINE FacetSum store_facet_at(Store *s, Triplet t, uint f) { return store_facet(s, f); }
INLINE void store_set_facet_at(Store *s, Triplet t, uint f, FacetSum sum) { store_set_facet(s, f, sum); }
INLINE bool store_sums_areas_alone(Store *s) { return false; }
INLINE bool store_sums_in_blocks(Store *s) { return true; }
