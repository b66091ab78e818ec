// The table of offsets that shells.rs makes: the voxels about a site's own, nearest first.

// Voxels along each axis to each side, entries in all, and how many of them are about the own voxel.
#define SHELL_RADIUS 6u
#define SHELLS 2197u
#define INNER_SHELLS 27u

// What single precision may err by in a distance to a voxel, in units of a voxel: distances are below 16, and pads below 1e-9.
#define SHELL_SLACK 1e-5f
