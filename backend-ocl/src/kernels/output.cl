// What the kernels write: the same whether one work-item computes a cell or many do.

// No room left for facet records; the cell is tried again with an empty buffer. After the statuses of the cells.
#define FACETS_FULL 16u

// One facet of a finished cell, in the frame of its site (`FacetRecord` of assemble.rs).
typedef struct {
    real area;
    real moment[3];
    uint neighbor;
    uint unused;
} FacetRecord;

// Sums that are written for each cell: volume and first moment, with any flag all others, and last the integral where it is asked for.
#define FEW_SUMS 4u
#define ALL_SUMS 18u

// Counters: the lengths of the lists of cells that did not end, the most sites that a cell visited, facet records, the most triangles
// that a cell tried, the length of the records of cells near the surface.
#define OF_BOUNDARY 0u
#define OF_FAILED 1u
#define OF_FULL 2u
#define OF_UNDECIDED 3u
#define VISITED 4u
#define OF_FACETS 5u
#define TRIED 6u
#define OF_NEAR 7u

// Writes the sums of the caller's site i.
INLINE void write_sums(__global real *sums, uint flags, uint i, const CellSums *part) {
    const uint width = (flags == 0u) ? FEW_SUMS : (ALL_SUMS + (((flags & INTEGRAL) != 0u) ? 1u : 0u));
    __global real *out = sums + ((size_t)i * width);
    out[0] = part->volume;
    out[1] = part->first.x;
    out[2] = part->first.y;
    out[3] = part->first.z;
    if (flags == 0u) {
        return;
    }
    out[4] = part->second_diagonal.x;
    out[5] = part->second_diagonal.y;
    out[6] = part->second_diagonal.z;
    out[7] = part->second_mixed.x;
    out[8] = part->second_mixed.y;
    out[9] = part->second_mixed.z;
    out[10] = part->boundary_area;
    out[11] = part->boundary_moment.x;
    out[12] = part->boundary_moment.y;
    out[13] = part->boundary_moment.z;
    out[14] = part->boundary_vector.x;
    out[15] = part->boundary_vector.y;
    out[16] = part->boundary_vector.z;
    out[17] = part->boundary_flux;
    if (width > ALL_SUMS) {
        out[ALL_SUMS] = part->integral;
    }
}

// What the device thinks of the layouts: sizes, and offsets of the fields behind which padding could hide.
__kernel void probe(__global uint *out) {
    __private Params params;
    out[0] = sizeof(Params);
    out[1] = (uint)((__private char *)&params.grid_dims - (__private char *)&params);
    out[2] = (uint)((__private char *)&params.facet_room - (__private char *)&params);
    out[3] = sizeof(Cluster);
    out[4] = sizeof(FacetRecord);
    out[5] = sizeof(V3);
    out[6] = sizeof(Plane);
    out[7] = sizeof(CellSums);
    out[8] = sizeof(FacetSecond);
}
