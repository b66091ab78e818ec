//! What the functions of [`cell`](crate::cell) return. Only `COMPLETE` and `EMPTY` describe a finished cell; the others are for the
//! scheduler, which tries the cell again with more room or wider arithmetic, and never leave the library.

/// The cell is finished.
pub const COMPLETE: u32 = 0;
/// Nothing of the cell is left.
pub const EMPTY: u32 = 1;
/// The plane cut the cell.
pub const CUT: u32 = 2;
/// The plane leaves the cell as it is.
pub const UNTOUCHED: u32 = 3;
/// No room for another half-space, though unused ones were dropped.
pub const P_FULL: u32 = 4;
/// No room for another vertex.
pub const V_FULL: u32 = 5;
/// A sign or position could not be decided with the arithmetic at hand.
pub const UNCERTAIN: u32 = 6;
/// The cell meets the domain's surface, and the caller asked to leave such cells for later.
pub const BOUNDARY: u32 = 7;

/// Mark of a vertex that a plane keeps.
pub const MARK_KEEP: u32 = 0;
/// Mark of a vertex in conflict: strictly outside the half-space.
pub const MARK_CONFLICT: u32 = 1;
/// Mark of a vertex whose sign floating point cannot decide.
pub const MARK_UNCERTAIN: u32 = 2;

/// Some vertex is in conflict (summary of the marks).
pub const SEEN_CONFLICT: u32 = 1;
/// Some vertex is uncertain (summary of the marks).
pub const SEEN_UNCERTAIN: u32 = 2;
/// Some vertex is kept (summary of the marks).
pub const SEEN_KEEP: u32 = 4;

/// Sign not decided.
pub const SIGN_UNKNOWN: i32 = 2;

/// First of the tags that name no site: a face of the initial box.
pub const TAG_BOX: u32 = 0xFFFF_FFF0;
/// Tag of the plane of a triangle of the domain.
pub const TAG_TRIANGLE: u32 = 0xFFFF_FFF1;
/// Tag of a side of a truncated cone.
pub const TAG_CONE: u32 = 0xFFFF_FFF2;
/// Tag of a half-space that cuts off what is outside the domain.
pub const TAG_CAP: u32 = 0xFFFF_FFF3;
