// What the kernels write: the same whether one work-item computes a cell or many do.

#import "generated/interface.cl"

// No room left for facet records; the cell is tried again with an empty buffer. After the statuses of the cells.
#define FACETS_FULL 16u

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
