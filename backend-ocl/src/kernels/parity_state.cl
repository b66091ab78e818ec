// What the generated kernels of parity.cl stand on: words in and out, and the cell that functions of the store are called on. The host's
// twin is core/src/cell/parity.rs. Built with -D NEIGHBORS, the sites that cut the cell.

#import "search.cl"

typedef __global const ulong *Input;
typedef __global ulong *Output;

INLINE uint take_uint(Input *in) { return (uint)*(*in)++; }
INLINE bool take_bool(Input *in) { return take_uint(in) != 0u; }
INLINE int take_int(Input *in) { return (int)take_uint(in); }
INLINE real take_real(Input *in) { return as_double(*(*in)++); }

INLINE void give_uint(Output *out, uint value) { *(*out)++ = value; }
INLINE void give_bool(Output *out, bool value) { give_uint(out, value); }
INLINE void give_int(Output *out, int value) { give_uint(out, (uint)value); }
// Which bits a NaN has is nobody's promise.
INLINE void give_real(Output *out, real value) { *(*out)++ = isnan(value) ? 0x7ff8000000000000ul : as_ulong(value); }

OUTLINE void give_V3(Output *out, V3 value);
OUTLINE void give_Plane(Output *out, Plane value);
OUTLINE void give_Triplet(Output *out, Triplet value);
OUTLINE void give_FacetSum(Output *out, FacetSum value);

#define PARITY_CALL \
    const size_t number = get_global_id(0); \
    if (number >= count) { \
        return; \
    } \
    Input in = inputs + (number * input_width); \
    Output out = outputs + (number * output_width)

// The store, and first of all results whether the cell could be made.
#define PARITY_STORE \
    Store store; \
    Store *s = &store; \
    s->world = (World){ \
        .params = params, .domain_vertices = domain_vertices, .triangles = (__global const uint4 *)(table + table[0]), .lowest_voxels = table + table[1], \
        .list_offsets = table + table[2], .list_entries = table + table[3], \
        .windings = (__global const int *)(table + table[4]), .surface_table = table + table[5], .integrand = integrand \
    }; \
    const uint made = parity_store(s, &in); \
    give_uint(&out, made); \
    if (made != COMPLETE) { \
        return; \
    }

// A cell in the middle of its life, made as `cells` makes it: clipped in single precision by the bisectors with some sites, then all its
// vertices computed in double precision, and marked by the bisector with one more site.
OUTLINE uint parity_store(Store *s, Input *in) {
    __global const real4 *sites = (__global const real4 *)*in;
    *in += 4u * (1u + NEIGHBORS);
    const real4 own = sites[0];
    s->world.sites = sites;
    s->tried = 0;
    s->last_tried = 0;
    uint status = begin_alone(s, 0);
    Plane plane = (Plane){ 0 };
    for (uint i = 1; i <= NEIGHBORS; i++) {
        const real4 other = sites[i];
        const V3 d = (V3){ .x = other.x - own.x, .y = other.y - own.y, .z = other.z - own.z };
        plane = bisector(d, own.w - other.w);
        if (i < NEIGHBORS) {
            status = clip(s, plane, i);
            if (status > UNTOUCHED) {
                return status;
            }
        }
    }
    status = refine(s);
    if (status != COMPLETE) {
        return status;
    }
    for (uint f = 0; f < CAP_P; f++) {
        const real x = (real)f;
        const V3 moment = (V3){ .x = x, .y = x, .z = x };
        store_set_facet(s, f, (FacetSum){ .area = x, .moment = moment, .rounding = x });
        store_set_facet_second(s, f, (FacetSecond){ .diagonal = moment, .mixed = moment });
    }
    store_set_plane(s, s->planes, plane);
    store_mark_conflicts(s, s->planes);
    store_save(s);
    return COMPLETE;
}

// The cell afterwards, in words whose number does not depend on it. Marks are scratch, and left out.
OUTLINE void parity_dump(Output *out, Store *s) {
    give_uint(out, s->planes);
    give_uint(out, s->vertices);
    for (uint f = 0; f < CAP_P; f++) {
        const uint is_there = f < s->planes;
        give_Plane(out, is_there ? store_plane(s, f) : (Plane){ 0 });
        give_uint(out, is_there ? store_tag(s, f) : 0u);
        give_uint(out, is_there ? store_link(s, f) : 0u);
        give_FacetSum(out, is_there ? store_facet(s, f) : (FacetSum){ 0 });
        const FacetSecond second = is_there ? store_facet_second(s, f) : (FacetSecond){ 0 };
        give_V3(out, second.diagonal);
        give_V3(out, second.mixed);
    }
    for (uint v = 0; v < CAP_V; v++) {
        const uint is_there = v < s->vertices;
        give_Triplet(out, is_there ? store_triplet(s, v) : (Triplet){ 0 });
        give_V3(out, is_there ? store_position(s, v) : (V3){ 0 });
        give_real(out, is_there ? store_radius(s, v) : REAL(0.0));
    }
}
