// What bounds that are worked out in single precision leave room for.

#import <prelude>

// Below this the squares of single precision could underflow.
#define ROUGH_SQUARE 1e-30f

// What single precision rounds off in a few operations.
#define ROUGH_SAFE 1.000002f

// The most that rounding may be of a volume that is a single number.
#define SHARE_OF_VOLUME 0.0009765625f
