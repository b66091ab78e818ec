"""Volumes of power cells cut by a domain, which is the triangles of its surface (here the twelve of a cube)."""

import numpy as np

import laguerre as lg

points = np.random.default_rng(0).random((1000, 3))
radii = np.random.default_rng(1).uniform(0, 0.05, 1000)
corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
squares = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
triangles = np.array([t for a, b, c, d in squares for t in ([a, b, c], [a, c, d])])
print(lg.cells(points, radii=radii, domain=lg.Domain(corners, triangles)).volume)
