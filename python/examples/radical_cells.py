"""Radical cells of spheres in a box, volume and neighbours of each."""

import numpy as np

import laguerre as lg

points = np.random.default_rng(0).random((1000, 3))
radii = np.random.default_rng(1).uniform(0, 0.05, 1000)
cells = lg.cells(points, radii=radii, domain=lg.Box(0, 1), facets=True)
facets = cells.facets
print(cells.volume[0], facets.neighbor[facets.offsets[0] : facets.offsets[1]])
