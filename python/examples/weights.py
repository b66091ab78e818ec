"""What a weight does: it is a squared length, and the facet of two cells moves by a difference of weights over twice their distance."""

import numpy as np

import laguerre as lg

points, box = np.array([[0.25, 0.5, 0.5], [0.75, 0.5, 0.5]]), lg.Box(0, 1)
print("equal weights    ", lg.cells(points, domain=box).volume)  # 0.5, 0.5
print("0.1 more         ", lg.cells(points, [0.1, 0.0], domain=box).volume)  # 0.5 + 0.1 / (2 * 0.5) = 0.6, 0.4
print("both 7 more      ", lg.cells(points, [7.1, 7.0], domain=box).volume)  # the same: only differences count
print("radii 0.4 and 0.3", lg.cells(points, radii=[0.4, 0.3], domain=box).volume)  # 0.16 - 0.09 = 0.07 more
print("0.6 more         ", lg.cells(points, [0.6, 0.0], domain=box).volume)  # beyond the box: the other cell is empty
