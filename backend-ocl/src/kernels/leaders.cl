// Which cells keep for others what bounds them far off: of each block of leaves of the tree the first of those that are to be computed.

#import "params.cl"

// Of `count` cells the least site in each block.
__kernel void choose_leaders(CHOOSE_LEADERS_ARGUMENTS) {
    const uint turn = get_global_id(0);
    if (turn < count) {
        const uint site = (has_list != 0u) ? list[first + turn] : (first + turn);
        atomic_min(leaders + (site / 64u), site);
    }
}
