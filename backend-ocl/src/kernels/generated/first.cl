// Generated from core/src/cell/first.rs by `cargo xtask codegen`; do not edit.

// The six planes of the box; its corners are still to be placed.
OUTLINE void set_box_planes(Store *s, V3 lo, V3 hi) {
    set_box_plane(s, 0, v3(REAL(1.0), REAL(0.0), REAL(0.0)), -lo.x);
    set_box_plane(s, 1, v3(-REAL(1.0), REAL(0.0), REAL(0.0)), hi.x);
    set_box_plane(s, 2, v3(REAL(0.0), REAL(1.0), REAL(0.0)), -lo.y);
    set_box_plane(s, 3, v3(REAL(0.0), -REAL(1.0), REAL(0.0)), hi.y);
    set_box_plane(s, 4, v3(REAL(0.0), REAL(0.0), REAL(1.0)), -lo.z);
    set_box_plane(s, 5, v3(REAL(0.0), REAL(0.0), -REAL(1.0)), hi.z);
    store_set_planes(s, 6);
    store_set_vertices(s, 8);
}

OUTLINE void set_box_plane(Store *s, uint f, V3 n, real d) {
    store_set_plane(s, f, (Plane){ .n = n, .d = d });
    store_set_tag(s, f, TAG_BOX);
}

// Places corner `v` of the box: bit 0 of `v` says whether it is on the maximum along x, bit 1 along y, bit 2 along z. The faces
// are at right angles, so that nothing is rounded.
HOT void place_corner(Store *s, uint v) {
    const uint on_x = v & 1;
    const uint on_y = (v >> 1) & 1;
    const uint on_z = (v >> 2) & 1;
    // The determinant of the three normals is the product of their signs: an odd number of maxima swaps two planes.
    if ((((on_x + on_y) + on_z) & 1) == 0) {
        store_set_triplet(s, v, (Triplet){ .a = on_x, .b = 2 + on_y, .c = 4 + on_z });
    } else {
        store_set_triplet(s, v, (Triplet){ .a = on_x, .b = 4 + on_z, .c = 2 + on_y });
    }
    V3 position = v3(-store_plane(s, 0).d, -store_plane(s, 2).d, -store_plane(s, 4).d);
    if (on_x != 0) {
        position.x = store_plane(s, 1).d;
    }
    if (on_y != 0) {
        position.y = store_plane(s, 3).d;
    }
    if (on_z != 0) {
        position.z = store_plane(s, 5).d;
    }
    store_set_position(s, v, position, (ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(position));
}
