// Cuts off what of a cell is far outside the domain, where LANES work-items compute it together: not built in the first stage, since a cell of a site amid
// others reaches nowhere far.

#import "lanes_clip.cl"

#if CUTS_OUTSIDE

// `cap_outside`, where the store can stay in registers.
OUTLINE uint cap_together(Store *given, real radius) {
    Store store = taken_store(given);
    const uint status = cap_outside(&store, radius);
    return give_back(given, &store, status);
}
#endif
