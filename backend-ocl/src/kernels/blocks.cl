// What the search for neighbours knows beforehand where weights differ.
//
// Weights g·x + c that are affine in the site's place only move all cells by −g/2: about x + g/2 each has the neighbours that it has without
// weights. So the weights of each node of the pyramid, from blocks of a few voxels on, are bounded by an affine function, and each block
// has a slope g that all its cells are searched with: distances to vertices are measured from x − g/2, and weights compared less g·x
// (`reach.cl`). The largest weight of all would have every cell search as far as the heaviest site anywhere could
// reach; and the weights of optimal transport differ by hundreds of squared spacings, as far as its cells are from their sites.

#import "bounds.cl"

// Sites that a slope is fitted to, at least, if the node above the block has so many; and what is added to their second moments, in squared
// voxels, so that the fit has one solution.
#define SITES_OF_FIT 8u
#define RIDGE REAL(0.001)

// Least and largest of the weights of a node's sites, less slope·(x − middle).
INLINE real2 range_of_rest(
    __global const Params *params, __global const real4 *sites, __global const uint *voxels, GridNode node, real3 slope, real3 middle
) {
    real2 range = (real2)(INFINITY, -INFINITY);
    for (uint row = 0; row < rows_of(node.level); row++) {
        const uint2 in_row = sites_of_row(params, voxels, node, row);
        for (uint site = in_row.x; site < in_row.y; site++) {
            const real rest = sites[site].w - dot(slope, sites[site].xyz - middle);
            range = (real2)(fmin(range.x, rest), fmax(range.y, rest));
        }
    }
    return range;
}

// The slope of least squares of the weights of a node's sites, in numbers of single precision; zero where they do not differ by less than half
// as much about it.
INLINE real3 fitted_slope(__global const Params *params, __global const real4 *sites, __global const uint *voxels, GridNode node) {
    const real3 none = (real3)(REAL(0.0));
    const real3 middle = middle_of(params, node);
    real n = REAL(0.0);
    real weight = REAL(0.0);
    real3 mean = none;
    real3 second[3] = { none, none, none };
    real3 mixed = none;
    for (uint row = 0; row < rows_of(node.level); row++) {
        const uint2 in_row = sites_of_row(params, voxels, node, row);
        for (uint site = in_row.x; site < in_row.y; site++) {
            const real3 d = sites[site].xyz - middle;
            const real w = sites[site].w;
            n += REAL(1.0);
            weight += w;
            mean += d;
            second[0] += d.x * d;
            second[1] += d.y * d;
            second[2] += d.z * d;
            mixed += w * d;
        }
    }
    mean /= n;
    const real ridge = (RIDGE * n) * (params->grid_width * params->grid_width);
    second[0] = (second[0] - ((n * mean.x) * mean)) + (real3)(ridge, REAL(0.0), REAL(0.0));
    second[1] = (second[1] - ((n * mean.y) * mean)) + (real3)(REAL(0.0), ridge, REAL(0.0));
    second[2] = (second[2] - ((n * mean.z) * mean)) + (real3)(REAL(0.0), REAL(0.0), ridge);
    mixed -= weight * mean;
    const real3 a = cross(second[1], second[2]);
    const real3 solved = (((a * mixed.x) + (cross(second[2], second[0]) * mixed.y)) + (cross(second[0], second[1]) * mixed.z)) / dot(second[0], a);
    if (!(norm_1_of(solved) < REAL(1e15))) {
        return none;
    }
    const real3 slope = convert_double3(convert_float3(solved));
    const real2 with = range_of_rest(params, sites, voxels, node, slope, middle);
    const real2 without = range_of_rest(params, sites, voxels, node, none, middle);
    return ((with.y - with.x) < (REAL(0.5) * (without.y - without.x))) ? slope : none;
}

// The affine bound of each block: slope, and what its weights are at most above that, at its middle.
__kernel void fit_blocks(FIT_BLOCKS_ARGUMENTS) {
    const uint block = get_global_id(0);
    if (block >= count) {
        return;
    }
    const GridNode node = node_at(params, block_level(params), block);
    uint n = 0;
    for (uint row = 0; row < rows_of(node.level); row++) {
        const uint2 in_row = sites_of_row(params, voxels, node, row);
        n += in_row.y - in_row.x;
    }
    if (n == 0u) {
        bounds[block] = (real4)((real3)(REAL(0.0)), -INFINITY);
        return;
    }
    const uint up = ((n < SITES_OF_FIT) && (node.level < params->top_level)) ? 1u : 0u;
    const GridNode fitted = (GridNode){ .level = node.level + up, .i = node.i >> up, .j = node.j >> up, .k = node.k >> up };
    const real3 slope = fitted_slope(params, sites, voxels, fitted);
    const real2 rest = range_of_rest(params, sites, voxels, node, slope, middle_of(params, node));
    const real size = fmax(fabs(rest.x), fabs(rest.y)) + (REAL(2.0) * (norm_1_of(slope) * half_width(params, node.level)));
    bounds[block] = (real4)(slope, rest.y + (BOUND_ROUNDING * size));
}

// The bounds of a level from those of the level below.
__kernel void raise_bounds(RAISE_BOUNDS_ARGUMENTS) {
    const uint index = get_global_id(0);
    if (index >= nodes_of(params, level)) {
        return;
    }
    const GridNode node = node_at(params, level, index);
    const real3 middle = middle_of(params, node);
    const real half_child = half_width(params, level - 1u);
    real3 slope = (real3)(REAL(0.0));
    real largest = -INFINITY;
    real n = REAL(0.0);
    for (uint turn = 0; turn < 2u; turn++) {
        GridNode child = first_child(node);
        do {
            const real4 bound = bounds[bound_at(params, child)];
            if (bound.w == -INFINITY) {
                continue;
            }
            if (turn == 0u) {
                slope += bound.xyz;
                n += REAL(1.0);
            } else {
                largest = fmax(largest, largest_rest(bound, middle_of(params, child), half_child, slope, middle, REAL(0.0), REAL(0.0)));
            }
        } while (next_node(params, level, &child) != 0u);
        slope = (turn == 0u) ? (slope / fmax(n, REAL(1.0))) : slope;
    }
    bounds[bound_at(params, node)] = (real4)(slope, largest);
}

// Where a site of a block is at least the distance D from others whose weights, less the slope's part, are larger by at most W, they cannot
// cut its cell of radius r, if r ≤ (D² − W) / 2D, and W not below 0: then D ≥ r + √(r² + W).
INLINE real proved_radius(real distance, real excess) {
    return (distance / REAL(2.0)) - (fmax(excess, REAL(0.0)) / (REAL(2.0) * distance));
}

// The growths that are tried: a half, a fourth, and so on, and none.
#define GROWTHS 5u
INLINE real growth_of(uint turn) { return (turn < (GROWTHS - 1u)) ? (REAL(1.0) / (real)(2u << turn)) : REAL(0.0); }

__kernel void bound_blocks(BOUND_BLOCKS_ARGUMENTS) {
    const uint block = get_global_id(0);
    if (block >= count) {
        return;
    }
    const uint own = block_level(params);
    const GridNode node = node_at(params, own, block);
    const real4 bound = bounds[block];
    if (bound.w == -INFINITY) {
        return;
    }
    const real3 slope = bound.xyz;
    const real3 middle = middle_of(params, node);
    const real half_block = half_width(params, own);
    const real width = params->grid_width;
    // 1. The smallest of the block's own weights, less the slope's part.
    const real smallest = range_of_rest(params, sites, voxels, node, slope, middle).x;
    // 2. What those of the table of offsets exceed it by, less a growth with the square of their distance: that with which a usual cell
    // is complete first.
    real excess[GROWTHS];
    for (uint g = 0; g < GROWTHS; g++) {
        excess[g] = -INFINITY;
    }
    for (uint k = node.k - min(node.k, NEAR_BLOCKS); k < min(node.k + (NEAR_BLOCKS + 1u), level_dim(params, 2, own)); k++) {
        for (uint j = node.j - min(node.j, NEAR_BLOCKS); j < min(node.j + (NEAR_BLOCKS + 1u), level_dim(params, 1, own)); j++) {
            for (uint i = node.i - min(node.i, NEAR_BLOCKS); i < min(node.i + (NEAR_BLOCKS + 1u), level_dim(params, 0, own)); i++) {
                const GridNode near = (GridNode){ .level = own, .i = i, .j = j, .k = k };
                const real4 other = bounds[index_at(params, near)];
                if (other.w == -INFINITY) {
                    continue;
                }
                const real3 its_middle = middle_of(params, near);
                for (uint g = 0; g < GROWTHS; g++) {
                    excess[g] = fmax(excess[g], largest_rest(other, its_middle, half_block, slope, middle, half_block, growth_of(g)));
                }
            }
        }
    }
    const real usual = REAL(0.7) * width;
    real least = INFINITY;
    uint best = 0;
    for (uint g = 0; g < GROWTHS; g++) {
        const real left = REAL(1.0) - growth_of(g);
        const real over = fmax(excess[g] - (REAL(0.5) * (smallest + bound.w)), REAL(0.0));
        const real reach = (usual + sqrt((usual * usual) + (left * over))) / left;
        best = (reach < least) ? g : best;
        least = fmin(least, reach);
    }
    // 3. Through the pyramid for sites beyond the table, but for what cannot be the least. (Roundings are far below a millionth of a voxel, and
    // pads are known.)
    const real apart = ((real)SHELL_RADIUS * width * REAL(0.999999)) - (REAL(4.0) * largest_pad(params));
    real radius = proved_radius(apart, REAL(0.0));
    GridNode far = (GridNode){ .level = params->top_level, .i = 0, .j = 0, .k = 0 };
    for (;;) {
        const real4 other = bounds[bound_at(params, far)];
        if (other.w > -INFINITY) {
            const real3 its_middle = middle_of(params, far);
            const real half_node = half_width(params, far.level);
            const real3 off = fabs(its_middle - middle);
            const real distance = fmax(apart, length(fmax(off - (half_node + half_block), REAL(0.0))));
            const real rest = largest_rest(other, its_middle, half_node, slope, middle, half_block, REAL(0.0));
            // |d|² − W, at least, over 2|d|, at most.
            const real height = smallest - largest_rest(other, its_middle, half_node, slope, middle, half_block, REAL(1.0));
            const real farthest = length(off + (half_node + half_block));
            const real proved = fmax(proved_radius(distance, rest - smallest), fmax(height, REAL(0.0)) / (REAL(2.0) * farthest));
            if ((proved < radius) && (far.level > own)) {
                far = first_child(far);
                continue;
            }
            radius = fmin(radius, proved);
        }
        if (next_node(params, params->top_level, &far) == 0u) {
            break;
        }
    }
    // (For a site x of weight w the excess is `excess` − w + slope·x.)
    const real from = dot(slope, middle);
    const real farthest = norm_1_of(middle) + (REAL(4.0) * half_block);
    const real size = ((fabs(excess[best]) + fabs(smallest)) + fabs(bound.w)) + (norm_1_of(slope) * farthest);
    blocks[block] = (Block){
        .slope = { slope.x, slope.y, slope.z },
        .excess = (excess[best] - from) + (REAL(4.0) * (BOUND_ROUNDING * size)),
        .growth = growth_of(best),
        .proved = radius - (REAL(0.000001) * fabs(radius))
    };
}
