// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

use super::{Function, Word, Words};
use crate::cell::{TAG_CONE, vector, plane, vertex, wide, expansion, clip, security, integrate, cone, restrict, vector::V3, plane::Plane, vertex::Triplet, wide::Wide, expansion::Expansion, integrate::CellSums, integrate::FacetSum, integrate::Side, integrate::Corner, store::Voxel, cone::TruncatedCone};

words!(V3 { x, y, z });
words!(Plane { n, d });
words!(Triplet { a, b, c });
words!(Wide { hi, lo });
words!(Expansion { terms, count });
words!(CellSums { volume, first, second_diagonal, second_mixed, rounding, largest_rounding, boundary_area, boundary_moment, boundary_vector, boundary_flux });
words!(FacetSum { area, moment, rounding });
words!(Side { index, n, d, square, foot });
words!(Corner { position, distance, radius });
words!(Voxel { i, j, k });
words!(TruncatedCone { sign, reach, end, side_0, side_1, side_2 });

/// Every function that other modules can see.
pub static FUNCTIONS: &[Function] = &[
    host!((x: f64, y: f64, z: f64) vector::v3(x, y, z), []),
    host!((a: V3, b: V3) vector::add(a, b), []),
    host!((a: V3, b: V3) vector::sub(a, b), []),
    host!((t: f64, a: V3) vector::scale(t, a), []),
    host!((a: V3, b: V3) vector::dot(a, b), []),
    host!((a: V3, b: V3) vector::cross(a, b), []),
    host!((a: V3) vector::norm_1(a), []),
    host!((a: V3) vector::norm_max(a), []),
    host!((a: f64, b: f64) vector::smaller(a, b), []),
    host!((a: f64, b: f64) vector::larger(a, b), []),
    host!((d: V3, dw: f64) plane::bisector(d, dw), []),
    host!((o: V3, lo_o: V3, edge: V3, sign: f64) plane::cone_side(o, lo_o, edge, sign), []),
    host!((a: V3, b: V3, c: V3, sign: f64) plane::triangle_plane(a, b, c, sign), []),
    host!((n: V3, a: V3, b: V3) plane::wall_over_edge(n, a, b), []),
    host!(s, (v: u32) vertex::place_vertex(&mut s, v), []),
    host!(s, (t: Triplet, position: V3, radius: f64) vertex::find_vertex(&mut s, t, &mut position, &mut radius), [position, radius]),
    host!((plane: Plane, x: V3) vertex::residual(plane, x), []),
    host!((ra: f64, rb: f64, rc: f64, bc: V3, ca: V3, ab: V3) vertex::combine(ra, rb, rc, bc, ca, ab), []),
    host!(s, (v: u32, k: u32) wide::sign_of_conflict(&mut s, v, k), []),
    host!((a: Plane, b: Plane, c: Plane, e: Plane) wide::wide_sign(a, b, c, e), []),
    host!((sum: Wide, size: f64, x0: f64, y0: f64, x1: f64, y1: f64, z2: f64, w2: f64, z3: f64, w3: f64, sign: f64) wide::add_term(&mut sum, &mut size, x0, y0, x1, y1, z2, w2, z3, w3, sign), [sum, size]),
    host!((x0: f64, y0: f64, x1: f64, y1: f64) wide::minor(x0, y0, x1, y1), []),
    host!((a: f64, b: f64) wide::product_exact(a, b), []),
    host!((a: Wide, b: Wide) wide::wide_add(a, b), []),
    host!((a: Wide, b: Wide) wide::multiply(a, b), []),
    host!((a: f64, b: f64) wide::sum_exact(a, b), []),
    host!((a: Wide, b: Wide) wide::wide_quotient(a, b), []),
    host!((a: Plane, b: Plane, c: Plane, e: Plane) expansion::expansion_sign(a, b, c, e), []),
    host!((a: Plane, b: Plane, c: Plane, position: V3) expansion::expansion_position(a, b, c, &mut position), [position]),
    host!((plane: Plane) expansion::is_tiny(plane), []),
    host!((x: f64) expansion::is_tiny_number(x), []),
    host!((sum: Expansion, x0: f64, y0: f64, x1: f64, y1: f64, z2: f64, w2: f64, z3: f64, w3: f64) expansion::add_minors(&mut sum, x0, y0, x1, y1, z2, w2, z3, w3), [sum]),
    host!((sum: Expansion, p: Wide, q: Wide) expansion::add_four(&mut sum, p, q), [sum]),
    host!((sum: Expansion, x: f64, y: f64) expansion::add_product(&mut sum, x, y), [sum]),
    host!((sum: Expansion, x: f64) expansion::add_number(&mut sum, x), [sum]),
    host!((sum: Expansion) expansion::value_of(&mut sum), [sum]),
    host!((a: V3, b: V3, c: V3) expansion::determinant(a, b, c), []),
    host!((sum: Expansion, x: f64, y: f64, z: f64) expansion::add_triple(&mut sum, x, y, z), [sum]),
    host!(s, (lo: V3, hi: V3) clip::begin(&mut s, lo, hi), []),
    host!(s, (f: u32, n: V3, d: f64) clip::set_box_plane(&mut s, f, n, d), []),
    host!(s, (plane: Plane, tag: u32 = TAG_CONE) clip::clip(&mut s, plane, tag), []),
    host!(s, (k: u32) clip::settle_marks(&mut s, k), []),
    host!(s, (f: u32, change: u32) clip::toggle_link(&mut s, f, change), []),
    host!(s, () clip::clear_links(&mut s), []),
    host!(s, (end: u32, edge: Triplet) clip::find_boundary_edge(&mut s, end, &mut edge), [edge]),
    host!(s, (end: u32, a: u32, b: u32) clip::is_boundary_edge(&mut s, end, a, b), []),
    host!(s, () clip::compact_planes(&mut s), []),
    host!(s, () security::farthest_vertex(&s), []),
    host!((r: f64, dw: f64) security::security_reach(r, dw), []),
    host!(s, (lo: V3, hi: V3, dw: f64) security::box_cannot_cut(&s, lo, hi, dw), []),
    host!((x: f64, lo: f64, hi: f64) security::outside_of(x, lo, hi), []),
    host!((sums: CellSums) integrate::volume_is_above_bound(sums), []),
    host!((sum: FacetSum) integrate::facet_is_above_bound(sum), []),
    host!(s, (weight: f64, center: V3, reach: f64, flags: u32, sums: CellSums) integrate::integrate(&mut s, weight, center, reach, flags, &mut sums), [sums]),
    host!(s, (f: u32, center: V3) integrate::side(&s, f, center), []),
    host!(s, (f: Side, g: Side, at: Corner, weight: f64, center: V3, flags: u32, part: CellSums) integrate::add_edge(&mut s, f, g, at, weight, center, flags, &mut part), [part]),
    host!(s, (f: Side, g: Side, center: V3, foot: V3) integrate::foot_on_edge(&mut s, f, g, center, &mut foot), [foot]),
    host!((volume: f64, h: V3, i: V3, v: V3, flags: u32, part: CellSums) integrate::add_tetrahedron(volume, h, i, v, flags, &mut part), [part]),
    host!((a: f64, b: f64, c: f64) integrate::squares(a, b, c), []),
    host!((a: f64, b: f64, c: f64, d: f64, e: f64, f: f64) integrate::products(a, b, c, d, e, f), []),
    host!((f: Side, foot: V3, at: Corner, sign: f64, center: V3, sum: FacetSum) integrate::add_triangle(f, foot, at, sign, center, &mut sum), [sum]),
    host!(s, (index: u32, center: V3, sum: FacetSum) integrate::integrate_facet(&mut s, index, center, &mut sum), [sum]),
    host!(s, () integrate::reset_facets(&mut s), []),
    host!((sum: FacetSum, plane: Plane, outward: f64, sums: CellSums) integrate::add_boundary(sum, plane, outward, &mut sums), [sums]),
    host!(s, () integrate::reference_point(&s), []),
    host!(s, (t: u32, apex: Voxel, center: V3, flags: u32, touched: u32, sums: CellSums) cone::add_cone(&mut s, t, apex, center, flags, &mut touched, &mut sums), [touched, sums]),
    host!(s, (cone: TruncatedCone) cone::clip_by_sides(&mut s, cone), []),
    host!(s, (t: u32, apex: Voxel, center: V3, sums: CellSums) cone::add_surface(&mut s, t, apex, center, &mut sums), [sums]),
    host!(s, (k: u32, plane: Plane) cone::all_in_conflict(&mut s, k, plane), []),
    host!(s, (t: u32, apex: Voxel, cone: TruncatedCone) cone::make_cone(&mut s, t, apex, &mut cone), [cone]),
    host!(() cone::no_cone(), []),
    host!(s, (t: u32, apex: Voxel, prism: TruncatedCone) cone::make_prism(&mut s, t, apex, &mut prism), [prism]),
    host!((i: u32, j: u32, p: V3, q: V3, o: V3, o_in: V3, sign: f64) cone::side_over_edge(i, j, p, q, o, o_in, sign), []),
    host!(s, (t: u32, apex: Voxel, a: V3, b: V3, c: V3) cone::cone_sign(&mut s, t, apex, a, b, c), []),
    host!((a: V3) cone::magnitudes(a), []),
    host!(s, (flags: u32, interior_only: u32, sums: CellSums) restrict::integrate_cell(&mut s, flags, interior_only, &mut sums), [sums]),
    host!(s, (sums: CellSums) restrict::settle(&s, &sums), []),
    host!(s, () restrict::lies_outside(&s), []),
    host!(s, (weight: f64, center: V3, flags: u32, sums: CellSums) restrict::integrate_whole(&mut s, weight, center, flags, &mut sums), [sums]),
    host!(s, (sums: CellSums) restrict::add_box_faces(&s, &mut sums), [sums]),
    host!(s, (low: V3, high: V3) restrict::box_of_cell(&s, &mut low, &mut high), [low, high]),
    host!(s, (lo: Voxel, hi: Voxel) restrict::voxels_of_cell(&s, &mut lo, &mut hi), [lo, hi]),
    host!(s, (lo: Voxel, hi: Voxel, center: V3, flags: u32, touched: u32, sums: CellSums) restrict::add_cones(&mut s, lo, hi, center, flags, &mut touched, &mut sums), [touched, sums]),
    host!((lowest: Voxel, lo: Voxel, voxel: Voxel) restrict::is_first_voxel(lowest, lo, voxel), []),
];
