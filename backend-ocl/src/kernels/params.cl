// What the kernels that sort sites and those that use them share, beside what the host tells them (`interface.cl`).

#import "generated/interface.cl"
#import "rough.cl"

// The voxel along an axis that holds x, clamped into the grid .
INLINE uint voxel_along(__global const Params *params, uint axis, double x) {
    const double q = (x - params->grid_lo[axis]) / params->grid_width;
    const uint last = params->grid_dims[axis] - 1u;
    return (q >= (double)last) ? last : ((q > 0.0) ? (uint)q : 0u);
}

// After INNER_SHELLS, voxels from the site to its cell's farthest vertex beyond which what is outside the domain is cut off (nearer ones fail more often: of a million sites
// inside the bunny white ones take 7.0 ms, blue ones 5.5 where they do, with 1.75 8.8 and 7.4, with 2.75 6.7 and 6.2; one NVIDIA H200); those beyond which a cell near the surface is not
// expected to end by itself; and those from which on the cell is cut by a sample of all sites before (of SAMPLE sites).
#define CAP_FROM REAL(2.25)
#define FAR_FROM REAL(3.0)
#define SAMPLE_FROM REAL(5.0)

// Number i of that sample, as evenly spread over the sorted sites.
INLINE uint sampled_site(__global const Params *params, uint i) { return (uint)(((ulong)i * params->tree_sites) / SAMPLE); }

// Room for the roundings of a place in voxels of the domain's grid in single precision, three of them, of which the site's is relative.
#define VOXEL_SLACK 1e-4f
#define VOXEL_ROUNDING 1e-6f

// A place along an axis, in voxels of the domain's grid; what is to be allowed for; and the voxel there, or the one next to it.
INLINE float place_in_domain(__global const Params *params, uint axis, double x) {
    return (float)((x - params->domain_lo[axis]) * params->domain_per_width);
}
INLINE float slack_at(float place) { return VOXEL_SLACK + (fabs(place) * VOXEL_ROUNDING); }
INLINE uint voxel_in_domain(__global const Params *params, uint axis, float place) {
    return (uint)clamp(place, 0.0f, (float)(params->domain_dims[axis] - 1u));
}
