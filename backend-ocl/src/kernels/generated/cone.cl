// Generated from core/src/cell/cone.rs by `cargo xtask codegen`; do not edit.

// The truncated cone over triangle `t` from corner `apex`, in the frame of the site.
OUTLINE uint make_cone(Store *s, uint t, Voxel apex, TruncatedCone *cone) {
    const Triangle triangle = store_triangle(s, t);
    const V3 a = store_domain_point(s, triangle.a);
    const V3 b = store_domain_point(s, triangle.b);
    const V3 c = store_domain_point(s, triangle.c);
    const V3 o = store_corner(s, apex);
    const int sign = cone_sign(s, t, apex, sub(a, o), sub(b, o), sub(c, o));
    if (sign == SIGN_UNKNOWN) {
        return UNCERTAIN;
    }
    cone->sign = (real)sign;
    cone->jump = cone->sign * ((real)triangle.times);
    if (sign == 0) {
        return COMPLETE;
    }
    const V3 site = store_site(s);
    const V3 o_in = sub(o, site);
    const V3 a_in = sub(a, site);
    const V3 b_in = sub(b, site);
    const V3 c_in = sub(c, site);
    cone->reach = larger(larger(norm_1(a_in), norm_1(b_in)), larger(norm_1(c_in), norm_1(o_in)));
    cone->end = triangle_plane(a_in, b_in, c_in, cone->sign);
    cone->side_0 = side_over_edge(triangle.a, triangle.b, a, b, o, o_in, cone->sign);
    cone->side_1 = side_over_edge(triangle.b, triangle.c, b, c, o, o_in, cone->sign);
    cone->side_2 = side_over_edge(triangle.c, triangle.a, c, a, o, o_in, cone->sign);
    return COMPLETE;
}

// No cone yet.
OUTLINE TruncatedCone no_cone() {
    return (TruncatedCone){ .sign = REAL(0.0), .jump = REAL(0.0), .reach = REAL(0.0), .end = (Plane){ 0 }, .side_0 = (Plane){ 0 }, .side_1 = (Plane){ 0 }, .side_2 = (Plane){ 0 } };
}

// The prism over triangle `t`, in the frame of the site, on the side that the cone from `apex` keeps: where the surface touches
// the cell, both then decide alike.
OUTLINE uint make_prism(Store *s, uint t, Voxel apex, TruncatedCone *prism) {
    const Triangle triangle = store_triangle(s, t);
    const V3 a = store_domain_point(s, triangle.a);
    const V3 b = store_domain_point(s, triangle.b);
    const V3 c = store_domain_point(s, triangle.c);
    const V3 o = store_corner(s, apex);
    const int sign = cone_sign(s, t, apex, sub(a, o), sub(b, o), sub(c, o));
    if (sign == SIGN_UNKNOWN) {
        return UNCERTAIN;
    }
    prism->sign = REAL(1.0);
    if (sign < 0) {
        prism->sign = -REAL(1.0);
    }
    prism->jump = prism->sign * ((real)triangle.times);
    const V3 site = store_site(s);
    const V3 a_in = sub(a, site);
    const V3 b_in = sub(b, site);
    const V3 c_in = sub(c, site);
    prism->end = triangle_plane(a_in, b_in, c_in, prism->sign);
    const V3 n = scale(prism->sign, prism->end.n);
    prism->side_0 = wall_over_edge(n, a_in, b_in);
    prism->side_1 = wall_over_edge(n, b_in, c_in);
    prism->side_2 = wall_over_edge(n, c_in, a_in);
    return COMPLETE;
}

// The side over the edge from vertex `i` at `p` to vertex `j` at `q`, computed with the ends in index order so that both
// triangles at the edge get the very same plane.
INLINE Plane side_over_edge(uint i, uint j, V3 p, V3 q, V3 o, V3 o_in, real sign) {
    if (i < j) {
        return cone_side(o_in, sub(p, o), sub(q, p), sign);
    }
    return cone_side(o_in, sub(q, o), sub(p, q), -sign);
}

// Whether triangle `t` lies beyond one of the cell's half-spaces, as seen from corner `apex`. (Of 69,266 triangles in the voxels of 4,319 cells of 20,000 sites in the
// bunny 22,710 are left, of which 18,774 have something of the cell in their cones; by their cones' planes alone 62,855 are.)
OUTLINE uint lies_beyond(Store *s, uint t, Voxel apex) {
    const Triangle triangle = store_triangle(s, t);
    const V3 site = store_site(s);
    const V3 a = sub(store_domain_point(s, triangle.a), site);
    const V3 b = sub(store_domain_point(s, triangle.b), site);
    const V3 c = sub(store_domain_point(s, triangle.c), site);
    const V3 o = sub(store_corner(s, apex), site);
    const real reach = larger(larger(norm_1(a), norm_1(b)), larger(norm_1(c), norm_1(o)));
    uint beyond = NONE_BEYOND;
    for (uint f = 0; f < store_planes(s); f++) {
        const Plane plane = store_plane(s, f);
        const real margin = (LEAST_BEYOND * reach) * norm_1(plane.n);
        const real highest = larger(larger(v3_dot(plane.n, a), v3_dot(plane.n, b)), v3_dot(plane.n, c));
        if ((highest + plane.d) < -margin) {
            beyond = TRIANGLE_BEYOND;
            if ((v3_dot(plane.n, o) + plane.d) > margin) {
                return CONE_BEYOND;
            }
        }
    }
    return beyond;
}

// The corner of a voxel from `lo` to `hi` that is nearest to `x`, in the diagram's frame: as an apex within the cell it has cones of the fewest triangles. (From
// the corner of `lo` those of the 20,000 sites have 246,000 vertices of the cell in them, from there 179,000.)
OUTLINE Voxel nearest_corner(Store *s, V3 x, Voxel lo, Voxel hi) {
    const Voxel at = store_voxel_of(s, x);
    const V3 low = store_corner(s, at);
    const V3 high = store_corner(s, (Voxel){ .i = at.i + 1, .j = at.j + 1, .k = at.k + 1 });
    return (Voxel){ .i = nearest_of(x.x, low.x, high.x, at.i, lo.i, hi.i), .j = nearest_of(x.y, low.y, high.y, at.j, lo.j, hi.j), .k = nearest_of(x.z, low.z, high.z, at.k, lo.k, hi.k) };
}

// The number of the voxel from `least` to `most` that begins nearest to `x`, which is from `low` to `high` in number `at`.
INLINE uint nearest_of(real x, real low, real high, uint at, uint least, uint most) {
    uint nearest = at;
    if ((high - x) < (x - low)) {
        nearest += 1;
    }
    if (nearest < least) {
        nearest = least;
    }
    if (nearest > most) {
        nearest = most;
    }
    return nearest;
}

// The exact sign of `det(a − o, b − o, c − o)`, given the rounded differences.
OUTLINE int cone_sign(Store *s, uint t, Voxel apex, V3 a, V3 b, V3 c) {
    const int sign = filtered_sign(a, b, c);
    if (sign == SIGN_UNKNOWN) {
        return store_exact_cone_sign(s, t, apex);
    }
    return sign;
}

// The sign of the determinant of three differences of points, given rounded; never 0, but `SIGN_UNKNOWN` where floating point cannot tell.
HOT int filtered_sign(V3 a, V3 b, V3 c) {
    const real det = v3_dot(a, v3_cross(b, c));
    const V3 abs_b = magnitudes(b);
    const V3 abs_c = magnitudes(c);
    const real permanent = v3_dot(magnitudes(a), v3((abs_b.y * abs_c.z) + (abs_b.z * abs_c.y), (abs_b.z * abs_c.x) + (abs_b.x * abs_c.z), (abs_b.x * abs_c.y) + (abs_b.y * abs_c.x)));
    const real bound = CONE_SIGN_ERROR * permanent;
    if (det > bound) {
        return 1;
    }
    if (det < -bound) {
        return -1;
    }
    return SIGN_UNKNOWN;
}

INLINE V3 magnitudes(V3 a) {
    return v3(fabs(a.x), fabs(a.y), fabs(a.z));
}
