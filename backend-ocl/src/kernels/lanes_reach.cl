// How far a cell reaches that LANES work-items compute together.

#import "lanes_clip.cl"

// An upper bound of the distance of the farthest vertex from a place in the frame of the rough ones (`farthest_vertex`, in single precision).
INLINE float farthest_from(Store *s, float3 place) {
    float most = 0.0f;
    float4 ahead[AHEAD];
    UNROLLED_WORDS
    for (uint word = 0; word < WORDS_FOR(s->vertices); word++) {
        if ((word * LANES) < s->vertices) {
            const uint v = (word * LANES) + s->lane;
            const float4 p = rough_of_word(s, word, ahead);
            const float3 d = p.xyz - place;
            const float square = fmax(fma(d.x, d.x, fma(d.y, d.y, d.z * d.z)), ROUGH_SQUARE);
            const float far = (sqrt(square) + (2.0f * p.w)) * ROUGH_SAFE;
            most = fmax(most, (v < s->vertices) ? far : 0.0f);
        }
    }
    return lanes_largest(most);
}
// The same from the site.
INLINE float farthest_of(Store *s) {
    const V3 from = origin_of(s->cell);
    return farthest_from(s, (float3)(-(float)from.x, -(float)from.y, -(float)from.z));
}

// What is compared with what is known of the domain: where the table of offsets is gone through the squared distance from which on no site can cut
// the cell, so that one number does for both (a register less in the inner loop).
#if WITH_TABLE
INLINE float extent_of(float farthest) { return (4.0f * farthest) * (farthest * ROUGH_SAFE); }
#else
INLINE float extent_of(float farthest) { return farthest; }
#endif
