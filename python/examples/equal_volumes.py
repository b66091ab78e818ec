"""Weights for cells of equal volume in the unit cube."""

import numpy as np

import laguerre as lg

points = np.random.default_rng(0).random((1000, 3))
solved = lg.transport(points, domain=lg.Box(0, 1), masses=np.full(1000, 1 / 1000))
print(solved.weights)
