// Generated from core/src/cell/octree.rs by `cargo xtask codegen`; do not edit.

// The middle of a box.
INLINE V3 middle_of(V3 lo, V3 hi) {
    return v3(REAL(0.5) * (lo.x + hi.x), REAL(0.5) * (lo.y + hi.y), REAL(0.5) * (lo.z + hi.z));
}

// Half its extent, and a margin.
INLINE V3 half_of(V3 lo, V3 hi, real margin) {
    return add(scale(REAL(0.5), sub(hi, lo)), v3(margin, margin, margin));
}

// The lower corner of one of a box's eight parts, that which is upper along the axes whose bits `octant` has.
INLINE V3 part_lo(V3 lo, V3 hi, uint octant) {
    V3 corner = lo;
    const V3 middle = middle_of(lo, hi);
    if ((octant & 1) != 0) {
        corner.x = middle.x;
    }
    if ((octant & 2) != 0) {
        corner.y = middle.y;
    }
    if ((octant & 4) != 0) {
        corner.z = middle.z;
    }
    return corner;
}

// Its upper corner.
INLINE V3 part_hi(V3 lo, V3 hi, uint octant) {
    return part_lo(hi, lo, octant ^ (WIDTH - 1));
}

// How often in a row a part of a box lists nearly as much as the box before: the box has done so `barren` times, and the part keeps so many of all
// that the box lists.
INLINE uint barren_of_part(uint barren, uint count, uint all) {
    if (((real)count) > (BARREN * ((real)all))) {
        return barren + 1;
    }
    return 0;
}

// Whether a part that keeps so many leaves, and that `depth` splits have made, is split.
INLINE bool part_is_split(uint count, uint barren, uint depth) {
    return ((count > FEW_LISTED) && (depth < MOST_DEPTH)) && (barren < MOST_BARREN);
}

// The middle of a box, of given half extent; of its faces, for `i` from 1.
INLINE V3 octree_place(V3 middle, V3 halves, uint i) {
    V3 place = middle;
    if (i == 1) {
        place.x += halves.x;
    }
    if (i == 2) {
        place.x -= halves.x;
    }
    if (i == 3) {
        place.y += halves.y;
    }
    if (i == 4) {
        place.y -= halves.y;
    }
    if (i == 5) {
        place.z += halves.z;
    }
    if (i == 6) {
        place.z -= halves.z;
    }
    return place;
}

// The power of a site at a place.
INLINE real power_at(V3 site, real weight, V3 place) {
    const V3 way = sub(site, place);
    return v3_dot(way, way) - weight;
}

// A site as the box about `middle` sees it.
INLINE SeenSite seen_from(V3 place, real excess, V3 middle) {
    const V3 way = sub(place, middle);
    return (SeenSite){ .place = place, .excess = excess, .square = v3_dot(way, way) };
}

// By how much a site has more power than another at least, everywhere in a box of given half extent: the difference is affine.
INLINE real more_power(SeenSite site, SeenSite other, V3 halves) {
    const V3 way = sub(site.place, other.place);
    const real change = REAL(2.0) * v3_dot(halves, v3(fabs(way.x), fabs(way.y), fabs(way.z)));
    const real size = (site.square + other.square) + (site.excess + other.excess);
    return (((site.square - other.square) - (site.excess - other.excess)) - change) - (ROUNDINGS_OF_MORE * size);
}

// How far it is from a place, where the least power is that of site `first`, to where `site`, which has so much power there, has as little: about
// twice that, in single precision; 0 for that site itself.
INLINE float way_home(V3 site, real power, V3 first, real least) {
    const V3 apart = sub(site, first);
    const real way = (power - least) / sqrt(v3_dot(apart, apart));
    if (way > REAL(0.0)) {
        return (float)way;
    }
    return REAL(0.0);
}
