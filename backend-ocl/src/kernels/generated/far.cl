// Generated from core/src/cell/far.rs by `cargo xtask codegen`; do not edit.

// Settles those vertices, each lane its own, that are within a radius of `center`: the square of twice it is `proven`, and no other site can cut
// the cell there.
HOT void settle_near(Store *s, V3 center, real proven) {
    uint v = store_lane(s);
    while (v < store_vertices(s)) {
        const V3 way = sub(store_position(s, v), center);
        // (The radius bounds each component, and √3 < 2.)
        const real away = (sqrt(v3_dot(way, way)) + (REAL(2.0) * store_radius(s, v))) * ROOM_OF_DISTANCE;
        if ((REAL(4.0) * (away * away)) < proven) {
            store_settle_own(s, v);
        }
        v += store_lanes(s);
    }
    store_lanes_wait(s);
}

// Completes the cell by its vertices, of which some may be settled: `COMPLETE`, or how it ended; `UNCERTAIN` where more sites than there is room for
// are within rounding of a vertex, or a vertex is not known well. The farthest from `center` come first; so many are asked for at once at first,
// twice as many where one stays, as others will, and half where one is cut off, which wastes what was asked for others.
//
// Of several teams each asks for another vertex at the same time, and the first cuts the cell by what they found. Where vertices are many, each looks for its own
// among a share of them, in every round another, so that the first comes to all.
HOT uint search_far(Store *s, V3 center, uint first_asked, uint *visited) {
    uint at_once = first_asked;
    uint round = 0;
    for (;;) {
        Share share = share_of_all(s);
        const bool is_shared = store_shares_vertices(s) && (store_vertices(s) > MOST_UNSHARED);
        if (is_shared) {
            share = share_of_team(s, round);
        }
        round += 1;
        if (round >= store_teams(s)) {
            round = 0;
        }
        // The farthest; and of each team another.
        uint key = 0;
        uint v = next_unsettled(s, share, center, -REAL(1.0), &key);
        if (store_teams(s) == 1) {
            if (v == NO_SITE) {
                return COMPLETE;
            }
        } else if (!is_shared) {
            for (uint _before = 0; _before < store_team(s); _before++) {
                if (v != NO_SITE) {
                    v = next_unsettled(s, share, center, -REAL(1.0), &key);
                }
            }
        }
        const Answer answer = ask_at(s, v, at_once);
        store_set_answer(s, answer);
        store_teams_wait(s);
        uint status = UNTOUCHED;
        if (store_team(s) == 0) {
            status = take_answers(s, answer, visited);
        }
        status = store_first_says(s, status);
        if (status == UNTOUCHED) {
            at_once = 2 * at_once;
            if (at_once > store_most_asked(s)) {
                at_once = store_most_asked(s);
            }
        } else if (status == CUT) {
            at_once = at_once >> 1;
            if (at_once < 1) {
                at_once = 1;
            }
        } else {
            return status;
        }
    }
}

// Asks for vertex `v`, or where that is `NO_SITE` for none, and for others near it.
HOT Answer ask_at(Store *s, uint v, uint at_once) {
    Answer answer = (Answer){ .vertex = v, .found = NO_SITE, .ties = NO_SITE, .tried = 0 };
    if ((v == NO_SITE) || !ask(s, v, 0)) {
        return answer;
    }
    uint asked = 1;
    if (at_once > 1) {
        asked = ask_near_first(s, at_once);
    }
    uint ties = 0;
    uint stay = 0;
    const uint found = least_at(s, asked, &ties, &stay);
    for (uint i = 1; i < asked; i++) {
        if ((stay & (1 << i)) != 0) {
            const uint other = store_asked(s, i).vertex;
            store_set_settled(s, other, 1);
        }
    }
    if (found != NO_SITE) {
        store_set_candidate(s, 0, found, 0);
        ties = 1;
    } else if ((store_teams(s) > 1) && (ties <= store_most_ties(s))) {
        while ((answer.tried < ties) && store_was_tried(s, store_candidate(s, answer.tried))) {
            answer.tried += 1;
        }
    }
    answer.found = found;
    answer.ties = ties;
    return answer;
}

// Cuts the cell by what the teams found, the first one `own`, or settles their vertices: `CUT`; `UNTOUCHED` where none was cut off; `COMPLETE` where none asked
// for any; `UNCERTAIN` where none knows its own well; or how it ended.
HOT uint take_answers(Store *s, Answer own, uint *visited) {
    if (store_teams(s) == 1) {
        return take_answer(s, 0, own, UNTOUCHED, visited);
    }
    // (Before a cut, after which a number may be another vertex's.)
    bool is_asked = 0;
    bool is_known = 0;
    for (uint team = 0; team < store_teams(s); team++) {
        const Answer its = store_answer(s, team);
        if (its.vertex != NO_SITE) {
            is_asked = 1;
            is_known = is_known || (its.ties <= store_most_ties(s));
        }
        if (its.tried == its.ties) {
            store_set_settled(s, its.vertex, 1);
        }
    }
    if (!is_asked) {
        return COMPLETE;
    }
    if (!is_known) {
        return UNCERTAIN;
    }
    store_lanes_wait(s);
    uint end = UNTOUCHED;
    for (uint team = 0; team < store_teams(s); team++) {
        const Answer its = store_answer(s, team);
        // (A vertex that a team does not know well may be cut off by what the others found: it is asked for again.)
        const bool is_of_use = (its.tried < its.ties) && (its.ties <= store_most_ties(s));
        if (is_of_use && ((end == UNTOUCHED) || (its.found != NO_SITE))) {
            const uint status = take_answer(s, team, its, end, visited);
            if ((status != UNTOUCHED) && (status != CUT)) {
                return status;
            }
            if (status == CUT) {
                end = CUT;
            }
        }
    }
    return end;
}

// What comes of the sites that a team found, once the answers of others have come to `end`; `UNCERTAIN` where they are more than there is room for.
HOT uint take_answer(Store *s, uint team, Answer its, uint end, uint *visited) {
    if (its.ties > store_most_ties(s)) {
        return UNCERTAIN;
    }
    uint status = UNTOUCHED;
    uint i = its.tried;
    while ((i < its.ties) && (status == UNTOUCHED)) {
        const uint j = store_tied(s, team, i);
        if (((its.found != NO_SITE) && (end == UNTOUCHED)) || !store_was_tried(s, j)) {
            *visited += 1;
            status = store_cut_by(s, j);
        }
        i += 1;
    }
    if ((status == UNTOUCHED) && (end == UNTOUCHED)) {
        if ((its.found != NO_SITE) && !store_leaves_out(s)) {
            // What rounding cannot take back has less power there.
            return UNCERTAIN;
        }
        store_set_settled(s, its.vertex, 1);
        store_lanes_wait(s);
    }
    return status;
}

// All of them.
INLINE Share share_of_all(Store *s) {
    return (Share){ .first = 0, .step = store_lanes(s) };
}

// A team's in one of as many rounds as there are teams.
INLINE Share share_of_team(Store *s, uint round) {
    uint turn = store_team(s) + round;
    if (turn >= store_teams(s)) {
        turn -= store_teams(s);
    }
    return (Share){ .first = store_lanes(s) * turn, .step = store_lanes(s) * store_teams(s) };
}

// Of a share's vertices that are not settled, or of the first such that a lane meets, that with the least key above `*key` of its squared distance from a
// place times `sign`, and the key; `NO_SITE` where there is none.
HOT uint next_unsettled(Store *s, Share share, V3 from, real sign, uint *key) {
    uint nearest = NO_SITE;
    uint own = 0;
    uint compared = 0;
    uint v = share.first + store_lane(s);
    while ((v < store_vertices(s)) && (compared < MOST_COMPARED)) {
        if (!store_settled(s, v)) {
            compared += 1;
            const V3 way = sub(store_position(s, v), from);
            const uint its = store_key_below(s, sign * v3_dot(way, way));
            if ((its > *key) && (its < nearest)) {
                nearest = its;
                own = v;
            }
        }
        v += share.step;
    }
    const uint least = store_least_of_lanes(s, nearest);
    *key = least;
    if (least == NO_SITE) {
        return NO_SITE;
    }
    return store_lane_value(s, own, store_first_of(s, store_lanes_with(s, nearest == least)));
}

// Asks for vertices near the first, nearest first, until so many are asked for; returns how many are.
HOT uint ask_near_first(Store *s, uint at_once) {
    const Asked first = store_asked(s, 0);
    uint asked = 1;
    // (Of vertices as far as another one is asked for.)
    uint key = store_key_above(s, REAL(0.0));
    while (asked < at_once) {
        const uint v = next_unsettled(s, share_of_all(s), first.place, REAL(1.0), &key);
        if (v == NO_SITE) {
            return asked;
        }
        if (ask(s, v, asked)) {
            asked += 1;
        }
    }
    return asked;
}

// Makes vertex `v` the asked vertex `i`, where it is known well: whether it is.
INLINE bool ask(Store *s, uint v, uint i) {
    V3 place = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real radius = REAL(0.0);
    if (store_fine_position(s, v, &place, &radius) != COMPLETE) {
        return 0;
    }
    const Asked asked = asked_at(store_largest_excess(s), v, place, radius);
    store_set_asked(s, i, asked);
    return 1;
}

// What is asked for at a place that is off by up to `radius` along each axis, of sites that weigh up to `largest_excess` more than the cell's.
INLINE Asked asked_at(real largest_excess, uint v, V3 place, real radius) {
    const real own = v3_dot(place, place);
    const real lost = PER_LENGTH * radius;
    // Beyond this power no site can have less than the cell's: with t the distance from the vertex, rounding is at most
    // lost·(√own + t) + FEW_ROUNDINGS_OF_SUM·(t² + own + …), where 2t ≤ length + t²/length for any length; and t² is the power and the
    // largest weight. (A vertex may be where the cell's site is.)
    const real length = larger(larger(sqrt(own), LENGTHS_OF_LOST * lost), LEAST_LENGTH);
    const real lost_of_square = (REAL(0.5) * lost) / length;
    const real share = lost_of_square + (REAL(4.0) * FEW_ROUNDINGS_OF_SUM);
    const real lost_of_all = (REAL(1.5) * lost) * length;
    const real room = lost_of_all + (share * larger(largest_excess, REAL(0.0)));
    const real limit = ((own * (REAL(1.0) + (REAL(2.0) * FEW_ROUNDINGS_OF_SUM))) + room) * (REAL(1.0) + (REAL(2.0) * share));
    return (Asked){ .vertex = v, .place = place, .own = own, .lost = lost_of_all, .lost_of_square = lost_of_square, .radius = radius, .limit = limit };
}

// The site of least power at the first asked vertex, if that is certainly less than the cell's own; else `NO_SITE`, and the candidates are all
// that may be, of which `ties` says how many. `stay` has a bit for each of the others where no site has less power or ties, but for those that
// it lies on.
HOT uint least_at(Store *s, uint asked, uint *ties, uint *stay) {
    const uint lanes = store_lanes(s);
    // As many leaves at a time as there are lanes for their sites.
    const uint most = larger_count(lanes / WIDTH, 1);
    uint left = (1 << asked) - 1;
    uint found = NO_SITE;
    Open open = open_top(s, left);
    *ties = 0;
    for (;;) {
        if ((open.leaves >= most) || ((open.leaves > 0) && (open.blocks == 0))) {
            uint some = most;
            if (open.leaves < some) {
                some = open.leaves;
            }
            open.leaves -= some;
            const real limit = store_asked(s, 0).limit;
            const uint before = left;
            uint i = store_lane(s);
            while (i < larger_count(some * WIDTH, lanes)) {
                uint j = NO_SITE;
                uint asks = 0;
                if (i < (some * WIDTH)) {
                    const uint at = open.leaves + (i / WIDTH);
                    j = (store_leaf(s, at) * WIDTH) + (i & (WIDTH - 1));
                    if (j < store_sites(s)) {
                        asks = store_asks_of_site(s, j, store_leaf_asks(s, at)) & left;
                    }
                    if (j == store_own_site(s)) {
                        asks = 0;
                    }
                }
                if (store_lanes_with(s, asks != 0) != 0) {
                    left = left & ask_site(s, j, asks, left, &found, ties);
                }
                i += lanes;
            }
            store_lanes_wait(s);
            if ((store_asked(s, 0).limit < limit) || (left != before)) {
                open = still_asked(s, left, open);
            }
        } else if (open.blocks > 0) {
            const Question question = (Question){ .square = REAL(1.0), .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .limit = REAL(0.0), .vertices = left, .sweeps = 0, .opens_own = 1 };
            open = open_blocks(s, question, open);
        } else {
            *stay = left;
            return found;
        }
    }
}

// Compares the power of each lane's site with the cell's at those of the asked vertices whose bits `asks` has, which are among `left`: `found`,
// the candidates and `ties` as `least_at`; returns all bits but those of vertices other than the first that may not stay.
INLINE uint ask_site(Store *s, uint j, uint asks, uint left, uint *found, uint *ties) {
    uint stay = 0xFFFFFFFF;
    V3 d = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real excess = REAL(0.0);
    if (asks != 0) {
        d = store_way_to(s, j);
        excess = store_excess_of(s, j);
    }
    uint a = 0;
    while ((left >> a) != 0) {
        const Asked its = store_asked(s, a);
        bool is_less = 0;
        bool is_tied = 0;
        real power = REAL(0.0);
        if ((asks & (1 << a)) != 0) {
            const V3 way = sub(its.place, d);
            const real square = v3_dot(way, way);
            const real less = (square - its.own) - excess;
            const real rounding = (its.lost + (its.lost_of_square * square)) + (FEW_ROUNDINGS_OF_SUM * ((square + its.own) + (fabs(excess) + v3_dot(d, d))));
            power = square - excess;
            if (less < -rounding) {
                is_less = 1;
            } else if (less <= rounding) {
                is_tied = 1;
            }
        }
        if (a > 0) {
            bool is_off = 0;
            if ((is_less || is_tied) && !store_touches(s, its.vertex, j)) {
                is_off = 1;
            }
            if (store_lanes_with(s, is_off) != 0) {
                stay = stay & (0xFFFFFFFF ^ (1 << a));
            }
        } else {
            if (store_lanes_with(s, is_less) != 0) {
                uint key = NO_SITE;
                if (is_less) {
                    key = store_key_above(s, power);
                }
                const uint least = store_least_of_lanes(s, key);
                const uint from = store_first_of(s, store_lanes_with(s, key == least));
                const real best = store_lane_real(s, power, from);
                if ((*found == NO_SITE) || (best < its.limit)) {
                    *found = store_lane_value(s, j, from);
                    Asked first = its;
                    first.limit = smaller(best, its.limit);
                    store_set_asked(s, 0, first);
                }
            }
            const uint tied = store_lanes_with(s, is_tied);
            if ((*found == NO_SITE) && (tied != 0)) {
                const uint at = *ties + store_rank_in(s, tied);
                if (is_tied && (at < store_most_ties(s))) {
                    store_set_candidate(s, at, j, 0);
                }
                *ties += store_count_of(s, tied);
            }
        }
        a += 1;
    }
    return stay;
}

INLINE uint larger_count(uint a, uint b) {
    if (a > b) {
        return a;
    }
    return b;
}
