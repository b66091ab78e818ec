// Whether LANES work-items are what `lanes_talk.cl` takes them for: a device's answer, not its documentation, decides whether cells are computed together.

#import "generated/interface.cl"
#import "lanes_talk.cl"

#define CELLS_OF_TRIAL 8u

// Gives 1 for each work-item for which all is right.
OF_LANES
__kernel void try_lanes(TRY_LANES_ARGUMENTS) {
    __local uint seen[CELLS_OF_TRIAL * LANES];
    const uint place = (uint)get_local_id(0);
    const uint lane = own_lane();
    uint is_right = 1;
#if WITH_SUBGROUPS
    is_right &= (get_sub_group_size() == LANES) && (get_max_sub_group_size() == LANES);
    is_right &= (uint)get_sub_group_id() == (place / LANES);
#endif
    is_right &= lane == (place % LANES);
    const uint all = 0xFFFFFFFFu >> (32u - LANES);
    is_right &= lanes_with(lane & 1u) == (0xAAAAAAAAu & all);
    is_right &= lanes_most((lane * 5u) % LANES) == (LANES - 1u);
    is_right &= lanes_most(0x80000000u | lane) == (0x80000000u | (LANES - 1u));
    for (uint from = 0; from < LANES; from++) {
        is_right &= lane_value(lane * 3u, from) == (from * 3u);
    }
    for (uint step = LANES / 2u; step > 0u; step >>= 1) {
        is_right &= lane_beside(lane * 7u, step) == ((lane ^ step) * 7u);
    }
    seen[place] = lane;
    lanes_wait();
    for (uint other = 0; other < LANES; other++) {
        is_right &= seen[(place - lane) + other] == other;
    }
    lanes_wait();
    // Some lanes alone, then all again.
    if ((lane % 3u) == 1u) {
        seen[place] = lane + 1u;
    }
    lanes_wait();
    is_right &= seen[place - lane + 1u] == 2u;
    right[get_global_id(0)] = is_right;
}
