// What the generated text stands on where numbers are single: no device needs doubles for it. Built with -D CAP_P, CAP_V (room of one
// cell).

// Every sum and product is rounded by itself; quotients and roots may be off by some roundings more (OpenCL allows 2.5 and 3 units in the
// last place, five and six roundings), for which the bounds of the text have room.
#pragma OPENCL FP_CONTRACT OFF

#define SINGLE 1
typedef float host_real;
typedef float real;
typedef float2 real2;
typedef float4 real4;
#define REAL(literal) literal##f

#define ROLLED

// Nothing is called: where functions were, a launch of 3,750 white sites ended with an address out of range, and each half of it did not (one NVIDIA
// H200; on PoCL no index was ever out of range, and it is as fast).
#define INLINE static inline
#define OUTLINE INLINE
#define HOT INLINE
