//! The second half of the search (`search.rs`): a cell that reaches far is completed vertex by vertex, by which site has the least power there.
//!
//! One descent of the tree asks for the site of least power at one vertex, and for others near it whether they stay: a node is read once for all
//! of them. On the CPU, where a node's bounds are worked out for eight nodes at a time, up to eight vertices are asked for at once.

use super::listed::ask_listed;
use super::quadratic::FEW_ROUNDINGS_OF_SUM;
use super::search_store::{Answer, Asked, NO_SITE, SearchStore, WIDTH};
use super::status::{COMPLETE, CUT, UNCERTAIN, UNTOUCHED};
use super::tree::{Open, Question, open_blocks, open_top, still_asked};
use super::vector::{Real, UNIT_ROUNDOFF, V3, dot, larger, smaller, sub, v3};

/// Times a vertex's error radius, what a length of the way to the site adds: 2√3, and as much again for the bound's own roundings.
const PER_LENGTH: Real = 8.0;

/// Room for the roundings of a distance, and of what a place is off by about a center.
const ROOM_OF_DISTANCE: Real = 1.0 + (32.0 * UNIT_ROUNDOFF);

/// Vertices up to which every team looks at all. (Were there no shares, the eighth of eight teams would go over all vertices eight times, in global memory: of a million sites with
/// lognormal radii the 450 largest cells took 28.6 instead of 20.4 ms. Where four teams had shares of more than 64 vertices cells took 3 to 9 % longer: what is not farthest cuts less.
/// One NVIDIA H200.)
const MOST_UNSHARED: u32 = 256;

/// Vertices that are not settled that a lane compares at most: a cell of a heavy site may have ten thousand.
pub(super) const MOST_COMPARED: u32 = 64;

/// What a power loses with the square of the distance is kept to half the inverse of this.
#[cfg_attr(opencl, single(1e3))]
const LENGTHS_OF_LOST: Real = 1e10;
/// Of a place at the site itself.
#[cfg_attr(opencl, single(1e-15))]
const LEAST_LENGTH: Real = 1e-150;

/// Settles those vertices, each lane its own, that are within a radius of `center`: the square of twice it is `proven`, and no other site can cut
/// the cell there.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn settle_near<S: SearchStore>(s: &mut S, center: V3, proven: Real) {
    let mut v: u32 = s.lane();
    while v < s.vertices() {
        let way: V3 = sub(s.position(v), center);
        // (The radius bounds each component, and √3 < 2.)
        let away: Real = (dot(way, way).sqrt() + (2.0 * s.radius(v))) * ROOM_OF_DISTANCE;
        if (4.0 * (away * away)) < proven {
            s.settle_own(v);
        }
        v += s.lanes();
    }
    s.lanes_wait();
}

/// Completes the cell by its vertices, of which some may be settled: `COMPLETE`, or how it ended; `UNCERTAIN` where more sites than there is room for
/// are within rounding of a vertex, or a vertex is not known well. The farthest from `center` come first; so many are asked for at once at first,
/// twice as many where one stays, as others will, and half where one is cut off, which wastes what was asked for others.
///
/// Of several teams each asks for another vertex at the same time, and the first cuts the cell by what they found. Where vertices are many, each looks for its own
/// among a share of them, in every round another, so that the first comes to all.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn search_far<S: SearchStore>(s: &mut S, center: V3, first_asked: u32, visited: &mut u32) -> u32 {
    let mut at_once: u32 = first_asked;
    let mut round: u32 = 0;
    loop {
        let mut share: Share = share_of_all(s);
        let is_shared: bool = s.shares_vertices() && (s.vertices() > MOST_UNSHARED);
        if is_shared {
            share = share_of_team(s, round);
        }
        round += 1;
        if round >= s.teams() {
            round = 0;
        }
        // The farthest; and of each team another.
        let mut key: u32 = 0;
        let mut v: u32 = next_unsettled(s, share, center, -1.0, &mut key);
        if s.teams() == 1 {
            if v == NO_SITE {
                return COMPLETE;
            }
        } else if !is_shared {
            for _before in 0..s.team() {
                if v != NO_SITE {
                    v = next_unsettled(s, share, center, -1.0, &mut key);
                }
            }
        }
        let answer: Answer = ask_at(s, v, at_once);
        s.set_answer(answer);
        s.teams_wait();
        let mut status: u32 = UNTOUCHED;
        if s.team() == 0 {
            status = take_answers(s, answer, visited);
        }
        status = s.first_says(status);
        if status == UNTOUCHED {
            at_once = 2 * at_once;
            if at_once > s.most_asked() {
                at_once = s.most_asked();
            }
        } else if status == CUT {
            at_once = at_once >> 1;
            if at_once < 1 {
                at_once = 1;
            }
        } else {
            return status;
        }
    }
}

/// Asks for vertex `v`, or where that is `NO_SITE` for none, and for others near it.
#[inline]
#[cfg_attr(opencl, hot)]
fn ask_at<S: SearchStore>(s: &mut S, v: u32, at_once: u32) -> Answer {
    let mut answer: Answer = Answer { vertex: v, found: NO_SITE, ties: NO_SITE, tried: 0 };
    if (v == NO_SITE) || !ask(s, v, 0) {
        return answer;
    }
    let mut asked: u32 = 1;
    if at_once > 1 {
        asked = ask_near_first(s, at_once);
    }
    let mut ties: u32 = 0;
    let mut stay: u32 = 0;
    let found: u32 = least_at(s, asked, &mut ties, &mut stay);
    for i in 1..asked {
        if (stay & (1 << i)) != 0 {
            let other: u32 = s.asked(i).vertex;
            s.set_settled(other, true);
        }
    }
    if found != NO_SITE {
        s.set_candidate(0, found, 0);
        ties = 1;
    } else if (s.teams() > 1) && (ties <= s.most_ties()) {
        while (answer.tried < ties) && s.was_tried(s.candidate(answer.tried)) {
            answer.tried += 1;
        }
    }
    answer.found = found;
    answer.ties = ties;
    return answer;
}

/// Cuts the cell by what the teams found, the first one `own`, or settles their vertices: `CUT`; `UNTOUCHED` where none was cut off; `COMPLETE` where none asked
/// for any; `UNCERTAIN` where none knows its own well; or how it ended.
#[inline]
#[cfg_attr(opencl, hot)]
fn take_answers<S: SearchStore>(s: &mut S, own: Answer, visited: &mut u32) -> u32 {
    if s.teams() == 1 {
        return take_answer(s, 0, own, UNTOUCHED, visited);
    }
    // (Before a cut, after which a number may be another vertex's.)
    let mut is_asked: bool = false;
    let mut is_known: bool = false;
    for team in 0..s.teams() {
        let its: Answer = s.answer(team);
        if its.vertex != NO_SITE {
            is_asked = true;
            is_known = is_known || (its.ties <= s.most_ties());
        }
        if its.tried == its.ties {
            s.set_settled(its.vertex, true);
        }
    }
    if !is_asked {
        return COMPLETE;
    }
    if !is_known {
        return UNCERTAIN;
    }
    s.lanes_wait();
    let mut end: u32 = UNTOUCHED;
    for team in 0..s.teams() {
        let its: Answer = s.answer(team);
        // (A vertex that a team does not know well may be cut off by what the others found: it is asked for again.)
        let is_of_use: bool = (its.tried < its.ties) && (its.ties <= s.most_ties());
        if is_of_use && ((end == UNTOUCHED) || (its.found != NO_SITE)) {
            let status: u32 = take_answer(s, team, its, end, visited);
            if (status != UNTOUCHED) && (status != CUT) {
                return status;
            }
            if status == CUT {
                end = CUT;
            }
        }
    }
    return end;
}

/// What comes of the sites that a team found, once the answers of others have come to `end`; `UNCERTAIN` where they are more than there is room for.
#[inline]
#[cfg_attr(opencl, hot)]
fn take_answer<S: SearchStore>(s: &mut S, team: u32, its: Answer, end: u32, visited: &mut u32) -> u32 {
    if its.ties > s.most_ties() {
        return UNCERTAIN;
    }
    let mut status: u32 = UNTOUCHED;
    let mut i: u32 = its.tried;
    while (i < its.ties) && (status == UNTOUCHED) {
        let j: u32 = s.tied(team, i);
        if ((its.found != NO_SITE) && (end == UNTOUCHED)) || !s.was_tried(j) {
            *visited += 1;
            status = s.cut_by(j);
        }
        i += 1;
    }
    if (status == UNTOUCHED) && (end == UNTOUCHED) {
        if (its.found != NO_SITE) && !s.leaves_out() {
            // What rounding cannot take back has less power there.
            return UNCERTAIN;
        }
        s.set_settled(its.vertex, true);
        s.lanes_wait();
    }
    return status;
}

/// Which vertices a team looks at: as many in a row as it has lanes, from the first on and again after every `step`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Share {
    first: u32,
    step: u32,
}

/// All of them.
#[inline(always)]
pub(super) fn share_of_all<S: SearchStore>(s: &S) -> Share {
    return Share { first: 0, step: s.lanes() };
}

/// A team's in one of as many rounds as there are teams.
#[inline(always)]
fn share_of_team<S: SearchStore>(s: &S, round: u32) -> Share {
    let mut turn: u32 = s.team() + round;
    if turn >= s.teams() {
        turn -= s.teams();
    }
    return Share { first: s.lanes() * turn, step: s.lanes() * s.teams() };
}

/// Of a share's vertices that are not settled, or of the first such that a lane meets, that with the least key above `*key` of its squared distance from a
/// place times `sign`, and the key; `NO_SITE` where there is none.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn next_unsettled<S: SearchStore>(s: &S, share: Share, from: V3, sign: Real, key: &mut u32) -> u32 {
    let mut nearest: u32 = NO_SITE;
    let mut own: u32 = 0;
    let mut compared: u32 = 0;
    let mut v: u32 = share.first + s.lane();
    while (v < s.vertices()) && (compared < MOST_COMPARED) {
        #[cfg(not(opencl))]
        if s.settled(v) {
            v = s.next_open(v);
            continue;
        }
        if !s.settled(v) {
            compared += 1;
            let way: V3 = sub(s.position(v), from);
            let its: u32 = s.key_below(sign * dot(way, way));
            if (its > *key) && (its < nearest) {
                nearest = its;
                own = v;
            }
        }
        v += share.step;
    }
    let least: u32 = s.least_of_lanes(nearest);
    *key = least;
    if least == NO_SITE {
        return NO_SITE;
    }
    return s.lane_value(own, s.first_of(s.lanes_with(nearest == least)));
}

/// Asks for vertices near the first, nearest first, until so many are asked for; returns how many are.
#[inline]
#[cfg_attr(opencl, hot)]
fn ask_near_first<S: SearchStore>(s: &mut S, at_once: u32) -> u32 {
    let first: Asked = s.asked(0);
    let mut asked: u32 = 1;
    #[cfg(not(opencl))]
    if s.lanes() == 1 {
        return ask_listed(s, first.place, at_once);
    }
    // (Of vertices as far as another one is asked for.)
    let mut key: u32 = s.key_above(0.0);
    while asked < at_once {
        let v: u32 = next_unsettled(s, share_of_all(s), first.place, 1.0, &mut key);
        if v == NO_SITE {
            return asked;
        }
        if ask(s, v, asked) {
            asked += 1;
        }
    }
    return asked;
}

/// Makes vertex `v` the asked vertex `i`, where it is known well: whether it is.
#[inline(always)]
pub(super) fn ask<S: SearchStore>(s: &mut S, v: u32, i: u32) -> bool {
    let mut place: V3 = v3(0.0, 0.0, 0.0);
    let mut radius: Real = 0.0;
    if s.fine_position(v, &mut place, &mut radius) != COMPLETE {
        return false;
    }
    let asked: Asked = asked_at(s.largest_excess(), v, place, radius);
    s.set_asked(i, asked);
    return true;
}

/// What is asked for at a place that is off by up to `radius` along each axis, of sites that weigh up to `largest_excess` more than the cell's.
#[inline(always)]
pub fn asked_at(largest_excess: Real, v: u32, place: V3, radius: Real) -> Asked {
    let own: Real = dot(place, place);
    let lost: Real = PER_LENGTH * radius;
    // Beyond this power no site can have less than the cell's: with t the distance from the vertex, rounding is at most
    // lost·(√own + t) + FEW_ROUNDINGS_OF_SUM·(t² + own + …), where 2t ≤ length + t²/length for any length; and t² is the power and the
    // largest weight. (A vertex may be where the cell's site is.)
    let length: Real = larger(larger(own.sqrt(), LENGTHS_OF_LOST * lost), LEAST_LENGTH);
    let lost_of_square: Real = (0.5 * lost) / length;
    let share: Real = lost_of_square + (4.0 * FEW_ROUNDINGS_OF_SUM);
    let lost_of_all: Real = (1.5 * lost) * length;
    let room: Real = lost_of_all + (share * larger(largest_excess, 0.0));
    let limit: Real = ((own * (1.0 + (2.0 * FEW_ROUNDINGS_OF_SUM))) + room) * (1.0 + (2.0 * share));
    return Asked {
        vertex: v,
        place: place,
        own: own,
        lost: lost_of_all,
        lost_of_square: lost_of_square,
        radius: radius,
        limit: limit,
    };
}

/// The site of least power at the first asked vertex, if that is certainly less than the cell's own; else `NO_SITE`, and the candidates are all
/// that may be, of which `ties` says how many. `stay` has a bit for each of the others where no site has less power or ties, but for those that
/// it lies on.
#[inline]
#[cfg_attr(opencl, hot)]
pub(crate) fn least_at<S: SearchStore>(s: &mut S, asked: u32, ties: &mut u32, stay: &mut u32) -> u32 {
    let lanes: u32 = s.lanes();
    // As many leaves at a time as there are lanes for their sites.
    let most: u32 = larger_count(lanes / WIDTH, 1);
    let mut left: u32 = (1 << asked) - 1;
    let mut found: u32 = NO_SITE;
    let mut open: Open = open_top(s, left);
    *ties = 0;
    loop {
        if (open.leaves >= most) || ((open.leaves > 0) && (open.blocks == 0)) {
            let mut some: u32 = most;
            if open.leaves < some {
                some = open.leaves;
            }
            open.leaves -= some;
            let limit: Real = s.asked(0).limit;
            let before: u32 = left;
            let mut i: u32 = s.lane();
            while i < larger_count(some * WIDTH, lanes) {
                let mut j: u32 = NO_SITE;
                let mut asks: u32 = 0;
                if i < (some * WIDTH) {
                    let at: u32 = open.leaves + (i / WIDTH);
                    j = (s.leaf(at) * WIDTH) + (i & (WIDTH - 1));
                    if j < s.sites() {
                        asks = s.asks_of_site(j, s.leaf_asks(at)) & left;
                    }
                    if j == s.own_site() {
                        asks = 0;
                    }
                }
                if s.lanes_with(asks != 0) != 0 {
                    left = left & ask_site(s, j, asks, left, &mut found, ties);
                }
                i += lanes;
            }
            s.lanes_wait();
            if (s.asked(0).limit < limit) || (left != before) {
                open = still_asked(s, left, open);
            }
        } else if open.blocks > 0 {
            let question: Question = Question {
                square: 1.0,
                slope: v3(0.0, 0.0, 0.0),
                limit: 0.0,
                vertices: left,
                sweeps: false,
                opens_own: true,
            };
            open = open_blocks(s, question, open);
        } else {
            *stay = left;
            return found;
        }
    }
}

/// Compares the power of each lane's site with the cell's at those of the asked vertices whose bits `asks` has, which are among `left`: `found`,
/// the candidates and `ties` as `least_at`; returns all bits but those of vertices other than the first that may not stay.
#[inline(always)]
fn ask_site<S: SearchStore>(s: &mut S, j: u32, asks: u32, left: u32, found: &mut u32, ties: &mut u32) -> u32 {
    let mut stay: u32 = 0xFFFF_FFFF;
    let mut d: V3 = v3(0.0, 0.0, 0.0);
    let mut excess: Real = 0.0;
    if asks != 0 {
        d = s.way_to(j);
        excess = s.excess_of(j);
    }
    let mut a: u32 = 0;
    while (left >> a) != 0 {
        let its: Asked = s.asked(a);
        let mut is_less: bool = false;
        let mut is_tied: bool = false;
        let mut power: Real = 0.0;
        if (asks & (1 << a)) != 0 {
            let way: V3 = sub(its.place, d);
            let square: Real = dot(way, way);
            let less: Real = (square - its.own) - excess;
            let rounding: Real = (its.lost + (its.lost_of_square * square))
                + (FEW_ROUNDINGS_OF_SUM * ((square + its.own) + (excess.abs() + dot(d, d))));
            power = square - excess;
            if less < -rounding {
                is_less = true;
            } else if less <= rounding {
                is_tied = true;
            }
        }
        if a > 0 {
            let mut is_off: bool = false;
            if (is_less || is_tied) && !s.touches(its.vertex, j) {
                is_off = true;
            }
            if s.lanes_with(is_off) != 0 {
                stay = stay & (0xFFFF_FFFF ^ (1 << a));
            }
        } else {
            if s.lanes_with(is_less) != 0 {
                let mut key: u32 = NO_SITE;
                if is_less {
                    key = s.key_above(power);
                }
                let least: u32 = s.least_of_lanes(key);
                let from: u32 = s.first_of(s.lanes_with(key == least));
                let best: Real = s.lane_real(power, from);
                if (*found == NO_SITE) || (best < its.limit) {
                    *found = s.lane_value(j, from);
                    let mut first: Asked = its;
                    first.limit = smaller(best, its.limit);
                    s.set_asked(0, first);
                }
            }
            let tied: u32 = s.lanes_with(is_tied);
            if (*found == NO_SITE) && (tied != 0) {
                let at: u32 = *ties + s.rank_in(tied);
                if is_tied && (at < s.most_ties()) {
                    s.set_candidate(at, j, 0);
                }
                *ties += s.count_of(tied);
            }
        }
        a += 1;
    }
    return stay;
}

#[inline(always)]
fn larger_count(a: u32, b: u32) -> u32 {
    if a > b {
        return a;
    }
    return b;
}
