//! Caps: half-spaces that cut off what of a cell is far from its site and outside the domain, where it has no integral. A cell at
//! the edge of a cloud of sites would else reach to the container's box, and be cut there by sites from all over the cloud. One text for one lane
//! and for many, which share out the vertices and the parts that are looked at.

use super::lanes::Lanes;
use super::part::{
    ALL_PARTS, PARTS_OF_PART, add_to_part, box_has_nothing, box_is_outside, middle_of_part, middle_within_part,
    next_distance, widen_part,
};
use super::plane::Plane;
use super::status::{CUT, TAG_CAP, UNTOUCHED};
use super::store::{CutStore, DomainStore, Polytope};
use super::vector::{Real, V3, dot, larger, scale, sub, v3};

/// Caps of a cell at most.
pub const MOST_CAPS: u32 = 16;

/// The first distance of a cap that is tried, in units of the radius to be reached: its facet has vertices that are farther.
const FIRST_DISTANCE: Real = 0.85;
/// The same in units of the farthest vertex's distance, at least: nearer caps are for a cell that is less long.
const LEAST_SHARE: Real = 0.0009765625;
/// A vertex less than this times as far as a cap is not worth one.
const WORTH_A_CAP: Real = 1.1;

/// Cuts off, cap by cap, what lies outside the domain, until no vertex is farther from the site than `radius`, or what is cannot be cut
/// off: `CUT` where something was, `UNTOUCHED` where nothing was, or how the cell ended.
#[cfg_attr(opencl, hot)]
pub fn cap_outside<S: CutStore + DomainStore>(s: &mut S, radius: Real) -> u32 {
    if !s.has_domain() || !(radius > 0.0) {
        return UNTOUCHED;
    }
    let mut end: u32 = UNTOUCHED;
    for _caps in 0..MOST_CAPS {
        let far: V3 = farthest_position(s);
        let length: Real = dot(far, far).sqrt();
        if length <= radius {
            return end;
        }
        let mut distance: Real = larger(FIRST_DISTANCE * radius, LEAST_SHARE * length);
        let mut status: u32 = UNTOUCHED;
        while (status == UNTOUCHED) && ((WORTH_A_CAP * distance) < length) {
            if part_is_outside(s, far, distance * length) {
                status = s.cut(Plane { n: scale(-1.0, far), d: distance * length }, TAG_CAP);
            }
            distance = next_distance(distance, radius);
        }
        if status == UNTOUCHED {
            return end;
        }
        if status != CUT {
            return status;
        }
        end = CUT;
    }
    return end;
}

/// The position of the vertex that is farthest from the site.
#[cfg_attr(opencl, hot)]
pub(super) fn farthest_position<S: Polytope + Lanes>(s: &S) -> V3 {
    let mut own: V3 = v3(0.0, 0.0, 0.0);
    let mut square: Real = 0.0;
    let mut v: u32 = s.lane();
    while v < s.vertices() {
        let p: V3 = s.position(v);
        if dot(p, p) > square {
            own = p;
            square = dot(p, p);
        }
        v += s.lanes();
    }
    let from: u32 = s.first_of(s.lanes_with(square == s.most_of_lanes(square)));
    return v3(s.lane_real(own.x, from), s.lane_real(own.y, from), s.lane_real(own.z, from));
}

/// Whether what of the cell has `direction·x ≥ height` certainly lies where the domain's winding number is 0: its bounding box, or each
/// part of it that has something of the cell.
#[cfg_attr(opencl, hot)]
pub(super) fn part_is_outside<S: DomainStore + Lanes>(s: &S, direction: V3, height: Real) -> bool {
    let mut low: V3 = direction;
    let mut high: V3 = direction;
    let mut radius: Real = 0.0;
    let mut v: u32 = s.lane();
    while v < s.vertices() {
        add_to_part(s, v, direction, height, &mut low, &mut high);
        radius = larger(radius, s.radius(v));
        v += s.lanes();
    }
    low = scale(-1.0, s.most_along_axes(scale(-1.0, low)));
    high = s.most_along_axes(high);
    if !widen_part(s, direction, height, s.most_of_lanes(radius), &mut low, &mut high) {
        return false;
    }
    return box_is_outside(s, low, high) || parts_are_outside(s, direction, height, low, sub(high, low));
}

/// Whether each of the parts of a box of some extent from `low` on is outside, or has nothing of the cell with `direction·x ≥ height`; or each of that
/// one's own parts.
#[cfg_attr(opencl, hot)]
fn parts_are_outside<S: DomainStore + Lanes>(s: &S, direction: V3, height: Real, low: V3, extent: V3) -> bool {
    let size: V3 = scale(0.25, extent);
    let mut first: u32 = 0;
    while first < ALL_PARTS {
        let n: u32 = first + s.lane();
        let mut is_open: bool = false;
        if n < ALL_PARTS {
            is_open = !box_has_nothing(s, direction, height, middle_of_part(low, size, n), size);
        }
        let mut open: u32 = s.lanes_with(is_open);
        while open != 0 {
            // One for each eight lanes, one of its parts a lane.
            let mut own: u32 = ALL_PARTS;
            let mut before: u32 = 0;
            while (open != 0) && (before < s.lanes()) {
                if (s.lane() >= before) && (s.lane() < (before + PARTS_OF_PART)) {
                    own = first + s.first_of(open);
                }
                open = open & (open - 1);
                before += PARTS_OF_PART;
            }
            let mut is_there: bool = false;
            let mut part: u32 = s.lane() & (PARTS_OF_PART - 1);
            while (own < ALL_PARTS) && (part < PARTS_OF_PART) {
                let middle: V3 = middle_within_part(middle_of_part(low, size, own), size, part);
                if !box_has_nothing(s, direction, height, middle, scale(0.5, size)) {
                    is_there = true;
                }
                part += s.lanes();
            }
            if s.lanes_with(is_there) != 0 {
                return false;
            }
        }
        first += s.lanes();
    }
    return true;
}
