// The domain, as the cells see it. (`Store`, declared before, has its `world`.)

#import <store>
#import "surface_table.cl"

INLINE bool store_has_domain(Store *s) { return s->world.params->has_domain != 0u; }

// Lattice coordinates are exact, as on the host (domain_grid/lattice.rs).
INLINE real domain_coordinate(Store *s, uint axis, uint i) {
    return s->world.params->domain_lo[axis] + ((real)i * s->world.params->domain_width);
}
INLINE uint domain_voxel(Store *s, uint axis, real x) {
    const uint last = s->world.params->domain_dims[axis] - 1u;
    const real q = (x - s->world.params->domain_lo[axis]) / s->world.params->domain_width;
    if (!(q >= REAL(1.0))) {
        return 0;
    }
    const uint i = (q >= (real)last) ? last : (uint)q;
    return (domain_coordinate(s, axis, i) > x) ? i - 1u : i;
}
INLINE Voxel store_voxel_of(Store *s, V3 x) {
    return (Voxel){ .i = domain_voxel(s, 0, x.x), .j = domain_voxel(s, 1, x.y), .k = domain_voxel(s, 2, x.z) };
}
INLINE V3 store_corner(Store *s, Voxel voxel) {
    return (V3){
        .x = domain_coordinate(s, 0, voxel.i), .y = domain_coordinate(s, 1, voxel.j), .z = domain_coordinate(s, 2, voxel.k)
    };
}
INLINE uint domain_index(Store *s, Voxel voxel) {
    __global const uint *dims = s->world.params->domain_dims;
    return voxel.i + (dims[0] * (voxel.j + (dims[1] * voxel.k)));
}
INLINE int store_winding(Store *s, Voxel voxel) { return s->world.windings[domain_index(s, voxel)]; }
INLINE uint store_surface_voxels(Store *s, Voxel lo, Voxel hi) {
    const uint3 end = (uint3)(hi.i + 1u, hi.j + 1u, hi.k + 1u);
    return voxels_met(s->world.params->domain_dims, s->world.surface_table, (uint3)(lo.i, lo.j, lo.k), end);
}
INLINE uint store_list_begin(Store *s, Voxel voxel) { return s->world.list_offsets[domain_index(s, voxel)]; }
INLINE uint store_list_end(Store *s, Voxel voxel) { return s->world.list_offsets[domain_index(s, voxel) + 1u]; }
INLINE uint store_list_entry(Store *s, uint e) { return s->world.list_entries[e]; }
INLINE Voxel store_lowest_voxel(Store *s, uint t) {
    __global const uint *lowest = s->world.lowest_voxels + 3u * t;
    return (Voxel){ .i = lowest[0], .j = lowest[1], .k = lowest[2] };
}
INLINE Triangle store_triangle(Store *s, uint t) {
    s->tried += (s->last_tried != (t + 1u)) ? 1u : 0u;
    s->last_tried = t + 1u;
    const uint4 words = s->world.triangles[t];
    return (Triangle){ .a = words.x, .b = words.y, .c = words.z, .times = (int)words.w };
}
INLINE V3 store_domain_point(Store *s, uint i) {
    __global const host_real *point = s->world.domain_vertices + 3u * i;
    return (V3){ .x = point[0], .y = point[1], .z = point[2] };
}
