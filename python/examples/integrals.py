"""The integral of x^2 + y^2 over each cell: exact, for it is a polynomial; and of a function that is none, called with many points at once."""

import numpy as np

import laguerre as lg

points = np.random.default_rng(5).random((1_000, 3))
cells = lg.cells(points, domain=lg.Box(0, 1), polynomial={(2, 0, 0): 1.0, (0, 2, 0): 1.0})
print(f"over the cube {cells.integral.sum():.15f}, exactly 2/3")
waves = cells.integrate(lambda x: np.sin(np.pi * x[:, 0]), degree=7)
print(f"over the cube {waves.sum():.12f}, exactly {2 / np.pi:.12f}")
