// Numbers in single precision in their order, and back.
INLINE uint in_order(float x) {
    const uint bits = as_uint(x);
    return bits ^ ((((int)bits < 0) ? 0xFFFFFFFFu : 0u) | 0x80000000u);
}
INLINE float from_order(uint key) { return as_float(((key >> 31) != 0u) ? (key ^ 0x80000000u) : ~key); }
