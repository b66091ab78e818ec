"""From points to a picture, on the screen and in a file."""

import numpy as np, pyvista, laguerre as lg

points = np.random.default_rng(0).uniform(-1, 1, (2_000, 3))
cells = lg.cells(points, domain=pyvista.Icosphere(), geometry=True)
cells.to_pyvista().plot(scalars="volume", screenshot="cells.png")
