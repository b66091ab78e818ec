//! The second half of the search (`search.rs`): a cell that reaches far is completed vertex by vertex, by which site has the least power there.

use super::quadratic::FEW_ROUNDINGS_OF_SUM;
use super::search::Vantage;
use super::search_store::{MOST_CANDIDATES, NO_SITE, SearchStore, WIDTH};
use super::status::{COMPLETE, CUT, UNCERTAIN, UNTOUCHED};
use super::tree::{Open, Question, open_blocks, open_root, take_last};
use super::vector::{Real, V3, dot, larger, smaller, sub, v3};

/// Times a vertex's error radius, what a length of the way to the site adds: 2√3, and as much again for the bound's own roundings.
const PER_LENGTH: Real = 8.0;

/// What a power loses with the square of the distance is kept to half the inverse of this.
const LENGTHS_OF_LOST: Real = 1e10;
const LEAST_LENGTH: Real = 1e-150;

/// Completes the cell by its vertices, none of which is settled: `COMPLETE`, or how it ended; `UNCERTAIN` where more sites than there is room for
/// are within rounding of a vertex, or a vertex is not known well.
#[inline]
pub fn search_far<S: SearchStore>(s: &mut S, vantage: Vantage, visited: &mut u32) -> u32 {
    loop {
        let v: u32 = farthest_unsettled(s, vantage);
        if v == NO_SITE {
            return COMPLETE;
        }
        let mut place: V3 = v3(0.0, 0.0, 0.0);
        let mut radius: Real = 0.0;
        if s.fine_position(v, &mut place, &mut radius) != COMPLETE {
            return UNCERTAIN;
        }
        let mut ties: u32 = 0;
        let found: u32 = least_at(s, place, radius, &mut ties);
        if found != NO_SITE {
            s.set_candidate(0, found, 0);
            ties = 1;
        }
        if ties > MOST_CANDIDATES {
            return UNCERTAIN;
        }
        let mut status: u32 = UNTOUCHED;
        let mut i: u32 = 0;
        while (i < ties) && (status == UNTOUCHED) {
            let j: u32 = s.candidate(i);
            if (found != NO_SITE) || (s.has_cut(j) == 0) {
                *visited += 1;
                status = s.cut_by(j);
            }
            i += 1;
        }
        if ((status == UNTOUCHED) && (found != NO_SITE)) && (s.leaves_out() == 0) {
            // What rounding cannot take back has less power there.
            return UNCERTAIN;
        }
        if status == UNTOUCHED {
            s.set_settled(v, true);
            s.lanes_wait();
        } else if status != CUT {
            return status;
        }
    }
}

/// The vertex farthest from the cell's centre of those that are not settled; `NO_SITE` where there is none.
#[inline]
pub(super) fn farthest_unsettled<S: SearchStore>(s: &S, vantage: Vantage) -> u32 {
    let mut nearness: u32 = NO_SITE;
    let mut own: u32 = 0;
    let mut v: u32 = s.lane();
    while v < s.vertices() {
        if !s.settled(v) {
            let way: V3 = sub(s.position(v), vantage.center);
            let its: u32 = s.key_below(-dot(way, way));
            if its < nearness {
                nearness = its;
                own = v;
            }
        }
        v += s.lanes();
    }
    let least: u32 = s.least_of_lanes(nearness);
    if least == NO_SITE {
        return NO_SITE;
    }
    return s.lane_value(own, s.first_of(s.lanes_with((nearness == least) as u32)));
}

/// The site of least power at a vertex, if that is certainly less than the cell's own; else `NO_SITE`, and the candidates are all that may be,
/// of which `ties` says how many.
#[inline]
pub(super) fn least_at<S: SearchStore>(s: &mut S, v: V3, radius: Real, ties: &mut u32) -> u32 {
    let own: Real = dot(v, v);
    let lost: Real = PER_LENGTH * radius;
    // Beyond this power no site can have less than the cell's: with t the distance from the vertex, rounding is at most
    // lost·(√own + t) + FEW_ROUNDINGS_OF_SUM·(t² + own + …), where 2t ≤ length + t²/length for any length; and t² is the power and the
    // largest weight. (A vertex may be where the cell's site is.)
    let length: Real = larger(larger(own.sqrt(), LENGTHS_OF_LOST * lost), LEAST_LENGTH);
    let lost_of_square: Real = (0.5 * lost) / length;
    let share: Real = lost_of_square + (4.0 * FEW_ROUNDINGS_OF_SUM);
    let room: Real = ((1.5 * lost) * length) + (share * larger(s.largest_excess(), 0.0));
    let mut question: Question = Question {
        square: 1.0,
        slope: v3(0.0, 0.0, 0.0),
        limit: ((own * (1.0 + (2.0 * FEW_ROUNDINGS_OF_SUM))) + room) * (1.0 + (2.0 * share)),
        place: v,
        is_power: 1,
    };
    let mut found: u32 = NO_SITE;
    let mut open: Open = open_root(s);
    *ties = 0;
    loop {
        // As many leaves as there are lanes for their sites.
        let lanes: u32 = s.lanes();
        let most: u32 = larger_count(lanes / WIDTH, 1);
        if (open.leaves >= most) || ((open.leaves > 0) && (open.blocks == 0)) {
            let some: u32 = take_last(s, 1, question.limit, most, &mut open.leaves);
            let mut i: u32 = s.lane();
            while i < larger_count(some * WIDTH, lanes) {
                let mut j: u32 = NO_SITE;
                if i < (some * WIDTH) {
                    j = (s.leaf(open.leaves + (i / WIDTH)) * WIDTH) + (i & (WIDTH - 1));
                }
                let mut is_less: u32 = 0;
                let mut is_tied: u32 = 0;
                let mut power: Real = 0.0;
                if (j < s.sites()) && (j != s.own_site()) {
                    let d: V3 = s.way_to(j);
                    let excess: Real = s.excess_of(j);
                    let way: V3 = sub(v, d);
                    let square: Real = dot(way, way);
                    let less: Real = (square - own) - excess;
                    let rounding: Real = (((1.5 * lost) * length) + (lost_of_square * square))
                        + (FEW_ROUNDINGS_OF_SUM * ((square + own) + (excess.abs() + dot(d, d))));
                    power = square - excess;
                    if less < -rounding {
                        is_less = 1;
                    } else if less <= rounding {
                        is_tied = 1;
                    }
                }
                if s.lanes_with(is_less) != 0 {
                    let mut key: u32 = NO_SITE;
                    if is_less != 0 {
                        key = s.key_above(power);
                    }
                    let least: u32 = s.least_of_lanes(key);
                    let from: u32 = s.first_of(s.lanes_with((key == least) as u32));
                    let best: Real = s.lane_real(power, from);
                    if (found == NO_SITE) || (best < question.limit) {
                        found = s.lane_value(j, from);
                        question.limit = smaller(best, question.limit);
                    }
                }
                let tied: u32 = s.lanes_with(is_tied);
                if (found == NO_SITE) && (tied != 0) {
                    let at: u32 = *ties + s.rank_in(tied);
                    if (is_tied != 0) && (at < MOST_CANDIDATES) {
                        s.set_candidate(at, j, 0);
                    }
                    *ties += s.count_of(tied);
                }
                i += lanes;
            }
            s.lanes_wait();
        } else if open.blocks > 0 {
            open = open_blocks(s, question, 1, open);
        } else {
            return found;
        }
    }
}

#[inline(always)]
fn larger_count(a: u32, b: u32) -> u32 {
    if a > b {
        return a;
    }
    return b;
}
