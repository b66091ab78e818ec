// The marks of a cell that one work-item computes, as the bits `conflict` and `uncertain` of its `Store`.

INLINE uint store_mark(Store *s, uint v) {
    const uint bit = 1u << (v & 31u);
    if (s->conflict[v >> 5] & bit) {
        return MARK_CONFLICT;
    }
    return (s->uncertain[v >> 5] & bit) ? MARK_UNCERTAIN : MARK_KEEP;
}
INLINE void store_set_mark(Store *s, uint v, uint mark) {
    const uint bit = 1u << (v & 31u);
    const uint conflict = s->conflict[v >> 5] & ~bit;
    const uint uncertain = s->uncertain[v >> 5] & ~bit;
    s->conflict[v >> 5] = (mark == MARK_CONFLICT) ? (conflict | bit) : conflict;
    s->uncertain[v >> 5] = (mark == MARK_UNCERTAIN) ? (uncertain | bit) : uncertain;
}
INLINE uint store_next_conflict(Store *s, uint from, uint end) {
    if (from >= end) {
        return end;
    }
    uint word = from >> 5;
    uint bits = (s->conflict[word] >> (from & 31u)) << (from & 31u);
    while (bits == 0) {
        word++;
        if (word * 32u >= end) {
            return end;
        }
        bits = s->conflict[word];
    }
    return min(word * 32u + (31u - clz(bits & -bits)), end);
}
