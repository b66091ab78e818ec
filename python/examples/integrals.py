"""The integral of x^2 + y^2 over each cell: exact, for it is a polynomial."""

import numpy as np

import laguerre as lg

points = np.random.default_rng(5).random((1_000, 3))
cells = lg.cells(points, domain=lg.Box(0, 1), polynomial={(2, 0, 0): 1.0, (0, 2, 0): 1.0})
print(f"over the cube {cells.integral.sum():.15f}, exactly 2/3")
