// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import <prelude>

// core/src/cell/vector.rs

// Half the distance from 1 to the next number: the largest relative error of one rounding.
#if SINGLE
#define UNIT_ROUNDOFF ((real)(REAL(5.960464477539063e-8)))
#else
#define UNIT_ROUNDOFF ((real)(REAL(1.1102230246251565e-16)))
#endif

// A vector or point.
typedef struct {
    // First component.
    real x;
    // Second component.
    real y;
    // Third component.
    real z;
} V3;

// core/src/cell/status.rs

// The cell is finished.
#define COMPLETE ((uint)(0))

// Nothing of the cell is left.
#define EMPTY ((uint)(1))

// The plane cut the cell.
#define CUT ((uint)(2))

// The plane leaves the cell as it is.
#define UNTOUCHED ((uint)(3))

// No room for another half-space, though unused ones were dropped.
#define P_FULL ((uint)(4))

// No room for another vertex.
#define V_FULL ((uint)(5))

// A sign or position could not be decided with the arithmetic at hand.
#define UNCERTAIN ((uint)(6))

// The cell meets the domain's surface, and the caller asked to leave such cells for later.
#define BOUNDARY ((uint)(7))

// Mark of a vertex that a plane keeps.
#define MARK_KEEP ((uint)(0))

// Mark of a vertex in conflict: strictly outside the half-space.
#define MARK_CONFLICT ((uint)(1))

// Mark of a vertex whose sign floating point cannot decide.
#define MARK_UNCERTAIN ((uint)(2))

// Some vertex is in conflict (summary of the marks).
#define SEEN_CONFLICT ((uint)(1))

// Some vertex is uncertain (summary of the marks).
#define SEEN_UNCERTAIN ((uint)(2))

// Some vertex is kept (summary of the marks).
#define SEEN_KEEP ((uint)(4))

// Sign not decided.
#define SIGN_UNKNOWN ((int)(2))

// First of the tags that name no site: a face of the initial box.
#define TAG_BOX ((uint)(0xFFFFFFF0))

// Tag of the plane of a triangle of the domain.
#define TAG_TRIANGLE ((uint)(0xFFFFFFF1))

// Tag of a side of a truncated cone.
#define TAG_CONE ((uint)(0xFFFFFFF2))

// Tag of a half-space that cuts off what is outside the domain.
#define TAG_CAP ((uint)(0xFFFFFFF3))

// core/src/cell/plane.rs

// The half-space that keeps `n·x + d ≥ 0`; `n` need not be unit.
typedef struct {
    // Inward normal.
    V3 n;
    // Offset.
    real d;
} Plane;

// core/src/cell/vertex.rs

// A vertex as the three half-spaces it lies on, clockwise from outside: `det(n_a, n_b, n_c) > 0` exactly.
typedef struct {
    // First plane.
    uint a;
    // Second plane.
    uint b;
    // Third plane.
    uint c;
} Triplet;

// Below this share of `‖n_a‖₁‖n_b‖₁‖n_c‖₁` of the determinant the three normals count as nearly dependent, and
// `find_vertex` computes the position in double-double. The refined one below is off by the square of `ROUNDINGS_OF_PLACE` u over the share: here by 2u.
//
// In single precision two roundings would leave out every twentieth vertex; so far down one in ten thousand is left out, and the others' radius says
// what they have lost.
#if SINGLE
#define NEARLY_DEPENDENT ((real)(REAL(3.0517578125e-5)))
#else
#define NEARLY_DEPENDENT ((real)(REAL(2.3841857910156e-7)))
#endif

// Down to this share steps of Newton's method lead to the vertex, each by the factor `ROUNDINGS_OF_PLACE` u over the share: here a 16,384th (in single precision a 16th).
#if SINGLE
#define REFINABLE ((real)(REAL(3.0517578125e-5)))
#else
#define REFINABLE ((real)(REAL(5.820766091346741e-11)))
#endif

// Steps that `find_vertex_closely` takes at most: what they leave of the first error down there is less than a rounding.
#define MOST_STEPS ((uint)(3))

// Below this share the position is refined once: Cramer's rule alone is off by the inverse of the share.
//
// Of the digits of single precision there are none to spare.
#if SINGLE
#define WORTH_REFINING ((real)(REAL(0.015625)))
#else
#define WORTH_REFINING ((real)(REAL(0.001953125)))
#endif

// Roundings in a position and in the evaluation of a plane there, in units of `UNIT_ROUNDOFF` and of the sum that
// `find_vertex` forms: at most 8 for Cramer's rule (5 in the numerator, 5 in the determinant weighted by `|v|`, 2 for
// the quotient), and 4 for `n·v + d`; more than doubled for the rounding of the bound itself.
#define ROUNDINGS_OF_PLACE ((real)(REAL(32.0)))

// The same for a position that is itself within a rounding: 1 for each component, 4 for `n·v + d`, and the bound's.
#define ROUNDINGS_OF_EXACT ((real)(REAL(8.0)))

// What Cramer's rule for three planes is made of.
typedef struct {
    // `n_b×n_c`.
    V3 bc;
    // `n_c×n_a`.
    V3 ca;
    // `n_a×n_b`.
    V3 ab;
    // The offsets.
    V3 d;
    // `det(n_a, n_b, n_c)`.
    real det;
    // `‖n_a‖₁‖n_b‖₁‖n_c‖₁`.
    real size;
    // The same, each norm in turn replaced by the offset, and summed.
    real offsets;
} Cramer;

// core/src/cell/store.rs

// A triangle of the domain: the indices of its vertices, outward oriented, and how often it stands.
typedef struct {
    // First vertex.
    uint a;
    // Second vertex.
    uint b;
    // Third vertex.
    uint c;
    // By so much the winding number is larger behind it, seen from outside.
    int times;
} Triangle;

// A voxel of the domain's grid.
typedef struct {
    // Index along x.
    uint i;
    // Index along y.
    uint j;
    // Index along z.
    uint k;
} Voxel;

// core/src/cell/wide.rs

// An unevaluated sum `hi + lo`, `|lo| ≤ u|hi|`.
typedef struct {
    // The sum, rounded.
    real hi;
    // What is left of it.
    real lo;
} Wide;

// Dekker's constant 2²⁷ + 1: halves of 26 bits. In single precision 2¹² + 1: of 12.
#if SINGLE
#define SPLITTER ((real)(REAL(4097.0)))
#else
#define SPLITTER ((real)(REAL(134217729.0)))
#endif

// Error of the whole determinant in units of its sum of magnitudes: each minor, product and sum errs by at most 2⁻¹⁰²
// of the magnitudes it adds; a term passes through two minors, one product and five sums.
// In single precision as many squares of the unit roundoff.
#if SINGLE
#define WIDE_ERROR ((real)(REAL(4.547473508864641e-13)))
#else
#define WIDE_ERROR ((real)(REAL(1.5777218104420236e-30)))
#endif

// Below this the error terms of the products could underflow.
//
// In single precision, with normals below 2²⁰ and offsets below 2⁴⁰ (`single.cl`), minors are below 2⁶¹, and what underflows is below
// 12 · 2⁶¹ · 2⁻¹²³: less than `WIDE_ERROR` of this.
#if SINGLE
#define WIDE_SMALLEST ((real)(REAL(1.52587890625e-5)))
#else
#define WIDE_SMALLEST ((real)(REAL(1e-260)))
#endif

// Below this share of `‖n_a‖₁‖n_b‖₁‖n_c‖₁` of the determinant the normals of three planes count as dependent, and the position is computed
// exactly: double-double is off by `WIDE_ERROR` over the share, here by u/8.
//
// In single precision `NEARLY_DEPENDENT` of vertex.rs: there double-double has no more to give.
#if SINGLE
#define DEPENDENT ((real)(REAL(3.0517578125e-5)))
#else
#define DEPENDENT ((real)(REAL(1.1368683772161603e-13)))
#endif

// The 3×3 minors of `[n | d]` of three planes without its column x, y, z or d, and the magnitudes that they are sums of.
typedef struct {
    Wide x;
    Wide y;
    Wide z;
    Wide d;
    Plane size;
    // 0 where there are none.
    uint is_known;
} Minors;

// A vector in double-double.
typedef struct {
    Wide x;
    Wide y;
    Wide z;
} Wide3;

// core/src/cell/expansion.rs

// A number as the sum of its terms: nonoverlapping, none of them zero, in order of magnitude. A 4×4 determinant adds at most
// 192 numbers, and each adds at most one term.
typedef struct {
    real terms[192];
    uint count;
} Expansion;

// Inputs smaller than this (but for zero) are left to integers: below it the last bit of a product of four, 4·(52 + 200) bits
// down, could underflow.
//
// In single precision 4·(23 + 8) bits are above 2⁻¹²⁶.
#if SINGLE
#define EXPANSION_SMALLEST ((real)(REAL(0.00390625)))
#else
#define EXPANSION_SMALLEST ((real)(REAL(1e-60)))
#endif

// core/src/cell/first.rs

// core/src/cell/quadrature.rs

// A node of the quadrature rule on a tetrahedron.
typedef struct {
    // Its three coordinates along the edges from the reference point.
    V3 place;
    // Its share of the volume.
    real weight;
} Node;

// core/src/cell/integrate.rs

// Flags of [`integrate`](super::integrate_cell): volume and first moment alone.
#define VOLUME_ONLY ((uint)(0))

// Also every half-space's facet.
#define FACETS ((uint)(1))

// Also second moments.
#define SECOND_MOMENTS ((uint)(2))

// Also every facet's second moments; with `FACETS`.
#define FACET_SECOND_MOMENTS ((uint)(4))

// Also the integral of the store's function.
#define INTEGRAL ((uint)(8))

// Of facets no more than their areas, and nothing of the boundary: what the Laplacian is made of. With `FACETS`. (Parts of the surface within a cell are cut out by
// themselves: without them a transport in the bunny takes a third fewer instructions on the CPU.)
#define FACET_AREAS ((uint)(16))

// Sums over one restricted cell, in the frame of its site.
typedef struct {
    // Volume.
    real volume;
    // ∫ x dx.
    V3 first;
    // ∫ x², y², z² dx.
    V3 second_diagonal;
    // ∫ xy, xz, yz dx.
    V3 second_mixed;
    // ∫ of the store's function.
    real integral;
    // What rounding may have added to the volume, at most.
    real rounding;
    // The largest that rounding may have added to one of the pieces that were added and subtracted.
    real largest_rounding;
    // Area of the boundary within the cell.
    real boundary_area;
    // ∫ x dA over the boundary.
    V3 boundary_moment;
    // ∫ n dA over the boundary, `n` outward.
    V3 boundary_vector;
    // ∫ n·x dA over the boundary.
    real boundary_flux;
} CellSums;

// Roundings that one signed volume has gone through, at most: about ten each for the feet H and I and the
// vertex, eight for the determinant, the rest for the sum of up to some hundred terms of mixed sign.
#define ROUNDINGS ((real)(REAL(64.0)))

// Roundings of a refined vertex across its own planes, in units of its distance from the site: 5 for the residual, 2 for the
// correction, 1 for the sum. (Along its planes an ill-conditioned vertex is off by more, but what one facet gains
// there another loses; a single facet's area feels it whole, and is measured by the vertex's error radius.) As much as a displacement of
// the vertex by these does to the two volumes of an edge, so much and no more is lost in computing them from their spoke: 4 for the
// spoke, whose sides are at right angles, 3 for its product with each foot. Both lengths of the bound are sums of magnitudes.
#define ROUNDINGS_ACROSS ((real)(REAL(8.0)))

// Roundings of the plane of a triangle of the surface, in units of its reach: 1 for each coordinate relative to the site, 5 for the plane. The
// planes of two triangles at an edge are not displaced alike, also where both lie in one plane: what a facet loses to one cone it does not gain
// from the next. Where a cell is a few roundings wide there is nothing larger.
#define ROUNDINGS_OF_SURFACE ((real)(REAL(8.0)))

// What is positive counts as nothing only below this share of its bound, which is several times what rounding does.
#define SHARE_OF_NOTHING ((real)(REAL(0.125)))

// Vertices that are summed by themselves before their sum is added to that of the others: a power of two. A sum of n like terms is off by
// some √n roundings: the volume of a cell of 2,866 vertices was by 16 to 25 roundings so, and is by 1 to 3.
#define BLOCK_OF_VERTICES ((uint)(64))

// Below this share of `|n_f|²|n_g|²`, the square of the angle's sine, the foot on the edge is computed exactly: each step of refinement
// leaves some roundings over the sine of the error, here 10⁻⁵, and three are made.
#if SINGLE
#define NEARLY_PARALLEL ((real)(REAL(9.313225746154785e-10)))
#else
#define NEARLY_PARALLEL ((real)(REAL(1.3552527156068805e-20)))
#endif

// Below this it is refined three times, above once.
#if SINGLE
#define WORTH_REFINING_MORE ((real)(REAL(9.313225746154785e-10)))
#else
#define WORTH_REFINING_MORE ((real)(REAL(5.684341886081e-14)))
#endif

// Below this it is refined.
#if SINGLE
#define WORTH_REFINING_FOOT ((real)(REAL(2.44140625e-4)))
#else
#define WORTH_REFINING_FOOT ((real)(REAL(3.814697265625e-6)))
#endif

// Roundings of a foot across its line, in units of its distance over the sine of the angle; refined, of its distance.
#define ROUNDINGS_OF_FOOT ((real)(REAL(8.0)))

// Roundings of the offset of a plane that is moved to the reference point, in units of the distance of that, also over the sine.
#define ROUNDINGS_OF_OFFSET ((real)(REAL(4.0)))

// One plane as the integrals see it: moved to the reference point, with its foot.
typedef struct {
    uint index;
    V3 n;
    real d;
    real square;
    // H = −d n/|n|².
    V3 foot;
} Side;

// A vertex as the integrals see it.
typedef struct {
    // Its half-spaces.
    Triplet triplet;
    // Relative to the reference point.
    V3 position;
    // ‖·‖₁ of its way from the site, and the reach of its planes.
    real distance;
    // Its error radius.
    real radius;
} Corner;

// A tetrahedron with a corner at the reference point: its sixfold signed volume, what rounding may have added to that, and its first moment, times four.
typedef struct {
    real volume;
    real rounding;
    V3 first;
} Piece;

// core/src/cell/facet.rs

// Sums over one facet.
typedef struct {
    // Area.
    real area;
    // ∫ x dA, in the frame of the site.
    V3 moment;
    // The largest that rounding may have added to one of the triangles that were added and subtracted.
    real rounding;
} FacetSum;

// Second moments of one facet: while sums are added up about the point that the tetrahedra share, afterwards about the facet's own
// barycenter.
typedef struct {
    // ∫ x², y², z² dA.
    V3 diagonal;
    // ∫ xy, xz, yz dA.
    V3 mixed;
} FacetSecond;

// The same for the area of a triangle, in units of the product of its two sides at H, which is what a cross product loses where
// they are nearly parallel: one for each side, two for the cross product, three for its product with the normal, one for that with
// one over its length, which is off alike for all triangles of a facet, halved; twice that for the sum. (What H is off, one triangle gains and its
// neighbour loses.)
#define ROUNDINGS_OF_TRIANGLE ((real)(REAL(8.0)))

// The same share for a facet, of the bound of its largest triangle. Of many roundings most cancel: what some hundred triangles
// leave of nothing is below this, but for one in some thousand, while the sum of their bounds would swallow thin facets that the
// other cell, cut by other cones, keeps.
#define SHARE_OF_NO_FACET ((real)(REAL(0.0625)))

// What is negative is believed beyond so many of these bounds. In 1.8 million small diagrams full of ties the noise of one facet came to more than
// a quarter of its bound, and to less than all of it (to 128 where the bound leaves out what feet are off). Of 44,000 diagrams in prisms
// that fold over themselves in slabs of 1e-15 to 1e-2 none has a facet that only one of its cells keeps, or a cell that does not close for one
// that was dropped; with 2 bounds there are 2, with 4 there are 6, with 16 there are 34.
#define BOUNDS_OF_NEGATIVE ((real)(REAL(1.0)))

// core/src/cell/near.rs

// Roundings of a product of three differences, or of one component that is twice rounded.
#define FEW_ROUNDINGS ((real)(REAL(16.0) * UNIT_ROUNDOFF))

// core/src/cell/cone.rs

// A truncated cone: three sides through the apex, and the triangle's plane, keeping what lies behind it.
typedef struct {
    // Sign of the triangle as seen from the apex: +1 where it turns its back, so that what lies behind is outside.
    real sign;
    // How much larger the winding number is within than behind the triangle: the sign, as often as the triangle stands.
    real jump;
    // ‖·‖₁ of the way from the site to the farthest corner: what the planes' rounding is relative to.
    real reach;
    Plane end;
    Plane side_0;
    Plane side_1;
    Plane side_2;
} TruncatedCone;

// The triangle is beyond none of the cell's half-spaces; beyond one, so that it misses the cell; beyond one that holds the apex, so that its cone does, too.
#define NONE_BEYOND ((uint)(0))

#define TRIANGLE_BEYOND ((uint)(1))

#define CONE_BEYOND ((uint)(2))

// How far beyond, as a share of the way to the farthest of its corners and the apex. The sides of a cone are off by roundings over the sine of the angle between
// an edge and the way to it, and what one triangle loses to that its neighbour has: a cone that is left out is beyond the reach of that, down to a sine of 2⁻³¹.
#if SINGLE
#define LEAST_BEYOND ((real)(REAL(0.0009765625)))
#else
#define LEAST_BEYOND ((real)(REAL(9.5367431640625e-7)))
#endif

// The filter's bound for the determinant of three rounded differences: (7 + 56u)u times its permanent (Shewchuk 1997).
#define CONE_SIGN_ERROR ((real)((REAL(7.0) + (REAL(56.0) * UNIT_ROUNDOFF)) * UNIT_ROUNDOFF))

// core/src/cell/settle.rs

// No quotient of volumes beyond this is a winding number.
#define MOST_WINDINGS ((real)(REAL(1e9)))

// core/src/cell/part.rs

// Part of the distance of a cap by which what it cuts off is taken for larger, for all roundings.
#define CAP_MARGIN ((real)(REAL(0.015625)))

// Parts of what a cap cuts off, four along each axis, that are looked at where its bounding box does not tell; and parts of one that does not tell either.
#define ALL_PARTS ((uint)(64))

#define PARTS_OF_PART ((uint)(8))

// core/src/cell/cap.rs

// Caps of a cell at most.
#define MOST_CAPS ((uint)(16))

// The first distance of a cap that is tried, in units of the radius to be reached: its facet has vertices that are farther.
#define FIRST_DISTANCE ((real)(REAL(0.85)))

// The same in units of the farthest vertex's distance, at least: nearer caps are for a cell that is less long.
#define LEAST_SHARE ((real)(REAL(0.0009765625)))

// A vertex less than this times as far as a cap is not worth one.
#define WORTH_A_CAP ((real)(REAL(1.1)))

// core/src/cell/clip.rs

// core/src/cell/restrict.rs
