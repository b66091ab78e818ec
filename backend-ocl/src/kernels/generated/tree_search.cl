// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "tree_store.cl"
#import "generated/candidate_search.cl"

INLINE void add_least(real lo, real hi, real from, real alpha, real g, real slope, real curvature, real *sum, real *size);
INLINE real gap_along(real lo, real hi, real place, real off);
INLINE real square_to_box(V3 lo, V3 hi, V3 place, real off);
INLINE real least_weighted(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_of_node(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_power_of_node(Seer seer, V3 v, NodeBox bounds, NodeSlab slab, NodeWeights weights);
INLINE real reach_of_bisector(V3 g, V3 d, real excess);
INLINE V3 middle_of(V3 lo, V3 hi);
INLINE V3 half_of(V3 lo, V3 hi, real margin);
INLINE V3 part_lo(V3 lo, V3 hi, uint octant);
INLINE V3 part_hi(V3 lo, V3 hi, uint octant);
INLINE uint barren_of_part(uint barren, uint count, uint all);
INLINE bool part_is_split(uint count, uint barren, uint depth);
INLINE V3 octree_place(V3 middle, V3 halves, uint i);
INLINE real power_at(V3 site, real weight, V3 place);
INLINE SeenSite seen_from(V3 place, real excess, V3 middle);
INLINE real more_power(SeenSite site, SeenSite other, V3 halves);
INLINE float way_home(V3 site, real power, V3 first, real least);
INLINE Seer seer_of(Store *s);
INLINE OctreePlace octree_box_at(Store *s, V3 place);
INLINE Open open_top(Store *s, uint vertices);
INLINE Open open_path(Store *s);
INLINE uint keep_asked(Store *s, bool is_leaf, uint vertices, uint count);
INLINE Open still_asked(Store *s, uint vertices, Open open);
INLINE uint asks_by_powers(Store *s, uint level, uint node, uint of_block, uint *key);
HOT Open open_blocks(Store *s, Question question, Open given);
HOT Vantage vantage_of(Store *s);
INLINE real size_around(Store *s);
HOT uint search_near(Store *s, Vantage vantage, uint what, uint *visited, real *proven);
HOT uint near_key(Store *s, Vantage vantage, real *near);
HOT uint gather(Store *s, Vantage vantage, uint first, uint leaves, Wanted wanted, uint count);
INLINE uint gather_kept(Store *s, Vantage vantage, uint first, uint count, uint below);
INLINE bool may_cut(Store *s, Seer seer, uint level, uint node);
INLINE bool may_cut_weighted(Seer seer, V3 place, real radius, NodeBox bounds, NodeWeights weights);
INLINE RoughNode seen_roughly(V3 site, NodeBox bounds, NodeSlab slab);
INLINE float lower(real x);
INLINE float upper(real x);
INLINE float within(float lo, float hi, float x);
INLINE float fused(float a, float b, float c);
INLINE float least_along(float lo, float hi, float q, float more);
INLINE bool may_cut_at(RoughNode node, RoughVertex p);
HOT void settle_near(Store *s, V3 center, real proven);
HOT uint search_far(Store *s, V3 center, uint first_asked, uint *visited);
HOT Answer ask_at(Store *s, uint v, uint at_once);
HOT uint take_answers(Store *s, Answer own, uint *visited);
HOT uint take_answer(Store *s, uint team, Answer its, uint end, uint *visited);
INLINE Share share_of_all(Store *s);
INLINE Share share_of_team(Store *s, uint round);
HOT uint next_unsettled(Store *s, Share share, V3 from, real sign, uint *key);
HOT uint ask_near_first(Store *s, uint at_once);
INLINE bool ask(Store *s, uint v, uint i);
INLINE Asked asked_at(real largest_excess, uint v, V3 place, real radius);
HOT uint least_at(Store *s, uint asked, uint *ties, uint *stay);
INLINE uint ask_site(Store *s, uint j, uint asks, uint left, uint *found, uint *ties);
INLINE uint larger_count(uint a, uint b);
HOT uint search_boxes(Store *s, Vantage vantage, uint *visited);
HOT uint search_from(Store *s, Vantage vantage, uint what, uint *visited, real *proven);
INLINE OctreePlace open_ended(Store *s, OctreePlace at);
INLINE bool is_in_box(Store *s, OctreePlace at, V3 place, real radius);
INLINE uint take_fresh(Store *s, OctreeNode node, uint *looked);
HOT uint visit_leaves(Store *s, Vantage vantage, uint leaves, bool is_home, uint *visited);

#import "generated/quadratic.cl"
#import "generated/bound.cl"
#import "generated/octree.cl"
#import "generated/tree.cl"
#import "generated/search.cl"
#import "generated/sweep.cl"
#import "generated/far.cl"
#import "generated/boxes.cl"
