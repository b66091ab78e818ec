// What the generated text stands on. Built with -D CAP_P, CAP_V (room of one cell) and WITH_FACETS.

#pragma OPENCL EXTENSION cl_khr_fp64 : enable
// Every sum and product is rounded by itself, as on the host: the same bits on every device.
#pragma OPENCL FP_CONTRACT OFF

// The numbers that the host shares, and those of a cell.
typedef double host_real;
#if SINGLE
typedef float real;
typedef float2 real2;
typedef float3 real3;
typedef float4 real4;
#define REAL(literal) literal##f
#else
typedef double real;
typedef double2 real2;
typedef double3 real3;
typedef double4 real4;
#define REAL(literal) literal
#endif

// A loop that is not to be unrolled where many work-items wait for the same instructions; and one over numbers that have to stay in registers. In builds that ask for ROLLS_ALL no loop is unrolled: those whose
// text has all there is, and is what a first call ever waits for (figures in README.md).
#if ROLLS_ALL
#define ROLLED
#define UNROLLED
#define for _Pragma("unroll 1") for
#define while _Pragma("unroll 1") while
#else
#if LANES > 1
#define ROLLED _Pragma("unroll 1")
#else
#define ROLLED
#endif
#if LANES == 1
#define UNROLLED
#else
#define UNROLLED _Pragma("unroll")
#endif
#endif

// What is inlined, and what had better be one piece of code: it is called from several places, and large (`outline` in the Rust text). In between is what
// to inline is worth it where lanes share the work of a cell, and not where each work-item has all of it (`hot`). In sub-groups nothing is a piece of code of
// its own: Intel's compiler for CPUs loses what is 0 of a struct that is given by value to a function which is not inlined (`lanes_talk.cl`). Nor is it where
// SHORT asks for short text: in the stages of most cells, where nothing but volumes, barycenters and facets is asked for, and each function is called from
// few places (figures in README.md).
#define INLINE static inline
#if WITH_SUBGROUPS || SHORT
#define OUTLINE INLINE
#else
#define OUTLINE static __attribute__((noinline))
#endif
#ifdef LANES
#define HOT INLINE
#else
#define HOT OUTLINE
#endif
