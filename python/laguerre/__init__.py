"""Restricted power diagrams: Laguerre-Voronoi cells of weighted points, cut by a triangulated domain, and integrals over them.

The power distance of ``x`` to point ``i`` is ``|x - p_i|**2 - w_i``: weights are squared lengths, and a larger weight is a larger cell.
Without weights it is the Voronoi diagram. Every finished cell is complete or empty, by proof.

    import laguerre as lg
    domain = lg.Domain.load("swan.off")
    cells = lg.cells(points, domain=domain, facets=True)
    cells.volume, cells.centroid, cells.laplacian()
"""

from ._cells import Box, Cells, Diagram, Domain, Facets, cells
from ._laguerre import Backend, devices
from ._solvers import Relaxation, Transport, lloyd, transport

__version__ = "0.1.0"
__all__ = [
    "Backend",
    "Box",
    "Cells",
    "Diagram",
    "Domain",
    "Facets",
    "Relaxation",
    "Transport",
    "cells",
    "devices",
    "lloyd",
    "transport",
]
