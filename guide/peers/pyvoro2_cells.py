"""pyvoro2: radical cells of spheres in a box, volume and neighbours of each."""

import numpy as np
import pyvoro2

points = np.random.default_rng(0).random((1000, 3))
radii = np.random.default_rng(1).uniform(0, 0.05, 1000)
box = pyvoro2.Box(((0, 1), (0, 1), (0, 1)))
result = pyvoro2.compute(points, domain=box, mode="power", weights=radii**2)
first = next(cell for cell in result.cells if cell["id"] == 0)
print(result.cell_measures[0], sorted(face["adjacent_cell"] for face in first["faces"]))
