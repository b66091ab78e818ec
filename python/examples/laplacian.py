"""Heat that spreads over Voronoi cells: the Laplacian in SciPy."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import laguerre as lg

points = np.random.default_rng(2).random((5_000, 3))
cells = lg.cells(points, domain=lg.Box(0, 1), laplacian=True)
heat = (points[:, 0] < 0.5).astype(float)
after = spsolve((sp.diags_array(cells.volume) + 0.01 * cells.laplacian()).tocsc(), cells.volume * heat)
print(f"heat before {cells.volume @ heat:.6f}, after {cells.volume @ after:.6f}; from {after.min():.3f} to {after.max():.3f}")
