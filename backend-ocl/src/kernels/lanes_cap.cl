// Cuts off what of a cell is far outside the domain, and cuts it by sites from all over, where LANES work-items compute it together: not built
// in the first stage, since a cell of a site amid others reaches nowhere far.

#import "lanes_clip.cl"

#if CUTS_OUTSIDE

// `cap_outside`, where the store can stay in registers.
OUTLINE uint cap_together(Store *given, real radius) {
    Store store = taken_store(given);
    const uint status = cap_outside(&store, radius);
    return give_back(given, &store, status);
}

// Cuts by a sample of all sites, as `cap_far` of `search.cl`: `CUT`, `UNTOUCHED`, or how the cell ended.
OUTLINE uint sample_together(Store *given, uint own) {
    Store store = taken_store(given);
    Store *s = &store;
    uint end = UNTOUCHED;
    for (uint i = 0; i < SAMPLE; i++) {
        const uint site = sampled_site(s->world.params, i);
        if ((site == own) || (has_cut(s, site) != 0u)) {
            continue;
        }
        const uint status = cut_together(s, bisector_with(s, site), site);
        end = (status == UNTOUCHED) ? end : status;
        if ((status != UNTOUCHED) && (status != CUT)) {
            break;
        }
    }
    return give_back(given, &store, end);
}
#endif
