// How LANES work-items that compute a cell together talk to each other, through their registers: a warp of NVIDIA's by PTX, whose OpenCL has no
// sub-groups; others WITH_SUBGROUPS; or one alone, with which any device can run the same text and find the same cells. At most 32, a bit of a number
// each; all call these functions at the same time.
//
// Sub-groups are for GPUs, where a trial of them is right (`lanes_trial.cl`), and for tests on CPUs, which the suite is held to with 8 lanes by Intel's
// OpenCL (`intel-opencl-rt`). Its compiler, where it optimises, makes wrong cells of functions that are not inlined: the normals of a box's faces, given to
// `set_box_plane` by value, had what the stack held in place of their zeros (of 2,000 white cells 300 were wrong with 8 lanes, others in each call). With all
// inlined none is (8 and 32 lanes).

#if WITH_SUBGROUPS

#pragma OPENCL EXTENSION cl_khr_subgroups : enable
#ifdef cl_intel_required_subgroup_size
#pragma OPENCL EXTENSION cl_intel_required_subgroup_size : enable
#define OF_LANES __attribute__((intel_reqd_sub_group_size(LANES)))
#else
#define OF_LANES
#endif

// The number of this work-item among the lanes.
INLINE uint own_lane() { return get_sub_group_local_id(); }
// The lanes wait for each other, and see what they wrote.
INLINE void lanes_wait() { sub_group_barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE); }
// The lanes for which `bit` is not 0.
INLINE uint lanes_with(uint bit) { return sub_group_ballot(bit != 0u).x; }
// The largest of the lanes' numbers.
INLINE uint lanes_most(uint x) { return sub_group_reduce_max(x); }
// What lane `from` has.
INLINE uint lane_value(uint x, uint from) { return sub_group_shuffle(x, from); }
// What the lane has whose number differs by the bits of `step`.
INLINE uint lane_beside(uint x, uint step) { return sub_group_shuffle_xor(x, step); }

#else

#define OF_LANES
INLINE uint own_lane() { return (uint)get_local_id(0) % LANES; }

#if LANES == 32u
INLINE void lanes_wait() { asm volatile("bar.warp.sync 0xffffffff;" ::: "memory"); }
INLINE uint lanes_with(uint bit) {
    uint all;
    asm volatile("{ .reg .pred p; setp.ne.u32 p, %1, 0; vote.sync.ballot.b32 %0, p, 0xffffffff; }" : "=r"(all) : "r"(bit));
    return all;
}
INLINE uint lanes_most(uint x) {
    uint most;
    asm volatile("redux.sync.max.u32 %0, %1, 0xffffffff;" : "=r"(most) : "r"(x));
    return most;
}
INLINE uint lane_value(uint x, uint from) {
    uint value;
    asm volatile("shfl.sync.idx.b32 %0, %1, %2, 31, 0xffffffff;" : "=r"(value) : "r"(x), "r"(from));
    return value;
}
INLINE uint lane_beside(uint x, uint step) {
    uint value;
    asm volatile("shfl.sync.bfly.b32 %0, %1, %2, 31, 0xffffffff;" : "=r"(value) : "r"(x), "r"(step));
    return value;
}
#else
INLINE void lanes_wait() {}
INLINE uint lanes_with(uint bit) { return (bit != 0u) ? 1u : 0u; }
INLINE uint lanes_most(uint x) { return x; }
INLINE uint lane_value(uint x, uint from) { return x; }
INLINE uint lane_beside(uint x, uint step) { return x; }
#endif
#endif
