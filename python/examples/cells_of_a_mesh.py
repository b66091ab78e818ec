"""A cloud of points cut by a mesh, seen in PyVista (here written to a file)."""

import numpy as np
import pyvista

import laguerre as lg

ball = lg.Domain(pyvista.Icosphere(nsub=3))
points = np.random.default_rng(1).uniform(-1, 1, (2_000, 3))
mesh = lg.cells(points, domain=ball, geometry=True).to_pyvista()
mesh.save("cells.vtp")  # mesh.plot(scalars="volume") on a screen
print(f"{mesh.n_cells} faces of the cells in a ball of volume {ball.volume:.4f}")
