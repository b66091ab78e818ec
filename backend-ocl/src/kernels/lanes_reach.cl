// How far a cell reaches that LANES work-items compute together, which sites can cut it, and in what order they do.

#import "lanes_clip.cl"

// An upper bound of the distance of the farthest vertex from a place in the frame of the site (`farthest_vertex`, in single precision).
INLINE float farthest_from(Store *s, float3 place) {
    float most = 0.0f;
    UNROLLED_WORDS
    for (uint word = 0; word < WORDS; word++) {
        if ((word * LANES) < s->vertices) {
            const uint v = (word * LANES) + s->lane;
            const float4 p = s->cell->rough[v];
            const float3 d = p.xyz - place;
            const float square = fmax(((d.x * d.x) + (d.y * d.y)) + (d.z * d.z), ROUGH_SQUARE);
            const float far = (sqrt(square) + (2.0f * p.w)) * ROUGH_SAFE;
            most = fmax(most, (v < s->vertices) ? far : 0.0f);
        }
    }
    return lanes_largest(most);
}
INLINE float farthest_of(Store *s) { return farthest_from(s, (float3)(0.0f, 0.0f, 0.0f)); }

#if !WITH_TABLE
INLINE float extent_of(float farthest) { return farthest; }
#else
// What is carried from cut to cut, for what is asked of the domain (0 where the cell is outside, which nothing reaches) and of other sites: the
// squared distance from which on no site can cut the cell. A site's key is the smaller, the earlier it had better cut; those cannot that are not
// below the limit.
typedef struct {
    float extent;
} Reach;
INLINE float extent_of(float farthest) { return (4.0f * farthest) * (farthest * ROUGH_SAFE); }
INLINE Reach reach_now(Store *s) { return (Reach){ .extent = extent_of(farthest_of(s)) }; }
INLINE Reach within(Reach reach, float outside) { return (Reach){ .extent = (reach.extent <= outside) ? 0.0f : reach.extent }; }
INLINE uint key_limit(Reach reach) { return as_uint(reach.extent); }
INLINE uint key_of(V3 way) { return as_uint(convert_float_rtz(v3_dot(way, way))); }

#if WITH_DOMAIN
// Whether a vertex is so many voxels of the site grid away from the site, and may be on the other side of the surface.
INLINE uint is_beyond(Store *s, Reach reach, real widths) {
    const float from = extent_of(convert_float_rtp(widths * s->world.params->grid_width));
    return (reach.extent > from) && (reach.extent > s->cell->clear);
}
#endif

// A squared distance in voxels, for comparison with those between voxels.
INLINE float voxels_in_reach(Store *s, float reach) {
    const float in_voxels = (sqrt(reach) * (convert_float_rtp(s->world.params->grid_per_width) * ROUGH_SAFE)) + SHELL_SLACK;
    return (in_voxels * in_voxels) * 1.00001f;
}

// No key of a candidate.
#define USED 0xFFFFFFFFu

// Cuts by those of two sites for each lane that are in reach, nearest first: `UNTOUCHED`, or how the cell ended.
INLINE uint cut_by_nearest(Store *s, const uint *site, uint *key, uint is_sampled, Reach *reach, uint *visited) {
    for (;;) {
        const uint mine = min(key[0], key[1]);
        const uint nearest = ~lanes_most(~mine);
        if (nearest >= key_limit(*reach)) {
            return UNTOUCHED;
        }
        // (No index, so that all stays in registers.)
        const uint from = lowest_bit(lanes_with(mine == nearest));
        const uint is_first = key[0] == mine;
        const uint beyond = lane_value((is_first != 0u) ? site[0] : site[1], from);
        if (s->lane == from) {
            key[0] = (is_first != 0u) ? USED : key[0];
            key[1] = (is_first != 0u) ? key[1] : USED;
        }
        if ((is_sampled != 0u) && (has_cut(s, beyond) != 0u)) {
            continue;
        }
        *visited += 1u;
        // Each lane makes the half-space for itself.
        const uint status = cut_together(s, bisector_with(s, beyond), beyond);
        if (status == CUT) {
            *reach = reach_now(s);
#if WITH_DOMAIN
            // (Which ends the search without a way out of here of its own.)
            *reach = within(*reach, s->cell->outside);
#endif
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
}
#endif
