"""geogram: volumes of power cells cut by a domain, which it takes as tetrahedra (here the six of a cube)."""

import geogram
import numpy as np

points = np.random.default_rng(0).random((1000, 3))
radii = np.random.default_rng(1).uniform(0, 0.05, 1000)
corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
tetrahedra = np.array([[0, 3, 1, 7], [0, 2, 3, 7], [0, 6, 2, 7], [0, 4, 6, 7], [0, 5, 4, 7], [0, 1, 5, 7]], np.uint32)
found = geogram.Voronoi(points, radii**2, corners, tetrahedra)
a, b, c, d = (np.asarray(found.q)[np.asarray(found.t)[:, k]] for k in range(4))
pieces = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6  # signed
print(np.bincount(found.tseed, weights=pieces, minlength=len(points)))
