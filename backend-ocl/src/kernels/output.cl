// What the kernels write: the same whether one work-item computes a cell or many do.

#import "generated/interface.cl"

// No room left for the records of facets, or of finished cells; the cell is tried again with an empty buffer. After the statuses of the cells.
#define BATCH_FULL 16u

INLINE void write_vector(__global double *out, V3 x) {
    out[0] = x.x;
    out[1] = x.y;
    out[2] = x.z;
}

// Writes the sums of the caller's site i, so many of them.
INLINE void write_sums(__global double *sums, ulong width, uint i, const CellSums *part) {
    __global double *out = sums + ((size_t)i * width);
    out[0] = part->volume;
    write_vector(out + 1, part->first);
    if (width == FEW_SUMS) {
        return;
    }
    write_vector(out + 4, part->second_diagonal);
    write_vector(out + 7, part->second_mixed);
    if (width == MOMENT_SUMS) {
        return;
    }
    out[10] = part->boundary_area;
    write_vector(out + 11, part->boundary_moment);
    write_vector(out + 14, part->boundary_vector);
    out[17] = part->boundary_flux;
    if (width > ALL_SUMS) {
        out[ALL_SUMS] = part->integral;
    }
}
