// Which sites can cut a cell, where weights differ: as `security_reach` of `cell.cl` has it, but less what weights have in common that
// moves all cells alike (`Block` of `interface.cl`). In single precision, rounded to the safe side.

#import "cell.cl"

#define REACH_SAFE 1.00001f
#define PLANE_SAFE 0.99999f

INLINE real square_of(V3 d) { return ((d.x * d.x) + (d.y * d.y)) + (d.z * d.z); }

// A lower bound of the distance from x − g/2 of the bisector of a site x and another at x + d whose weight is larger by `dw`: it cuts no cell whose
// vertices are all nearer. (From the bisector 2u·d = |d|² − dw, and u = u' − g/2.)
INLINE float bisector_distance(V3 d, real dw, V3 slope) {
    const real square = v3_dot(d, d);
    const real shift = v3_dot(slope, d);
    // (Sums of a few terms: far less than this is rounded off.)
    const real height = (square - (dw - shift)) - (REAL(1e-13) * ((square + fabs(dw)) + fabs(shift)));
    const float length = sqrt(convert_float_rtp(fmax(square, REAL(1e-30))));
    return fmax((convert_float_rtz(height) / (2.0f * length)) * PLANE_SAFE, 0.0f);
}

// An upper bound of the distance of sites that can cut a cell, whose weights, so compared, are larger by at most `excess`; `span` is that of its
// farthest vertex from x − g/2.
INLINE float reach_about(float span, float excess) {
    return (span + sqrt(fmax(((span * span) * REACH_SAFE) + excess, 0.0f))) * REACH_SAFE;
}
