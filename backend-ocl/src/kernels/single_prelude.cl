// What the generated text stands on where numbers are single: no device needs doubles for it. Built with -D CAP_P, CAP_V (room of one
// cell).

// Every sum and product is rounded by itself; quotients and roots may be off by some roundings more (OpenCL allows 2.5 and 3 units in the
// last place, five and six roundings), for which the bounds of the text have room.
#pragma OPENCL FP_CONTRACT OFF

#define SINGLE 1
typedef float real;
typedef float2 real2;
typedef float4 real4;
#define REAL(literal) literal##f

#define INLINE static inline
#define OUTLINE static __attribute__((noinline))
#define HOT OUTLINE
