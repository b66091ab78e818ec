"""Restricted power diagrams: Laguerre-Voronoi cells of weighted points, cut by a triangulated domain, and integrals over them.

The power distance of ``x`` to point ``i`` is ``|x - p_i|**2 - w_i``: weights are squared lengths, and a larger weight is a larger cell.
Without weights it is the Voronoi diagram. Every finished cell is complete or empty, by proof.

    import laguerre as lg
    cells = lg.cells(points, domain="swan.off", facets=True)
    cells.volume, cells.centroid, cells.laplacian()

Of points at one place, or nearer than the container's frame can tell apart, one has a cell and the others are empty.
"""

from ._backend import Backend, Device, devices
from ._cells import Boundary, Cells, Facets, Status
from ._container import Box, Domain
from ._diagram import Diagram, cells
from ._fluid import Flow, fluid, scene
from ._laguerre import __version__
from ._page import page
from ._solvers import Function, Gaussians, Relaxation, Transport, lloyd, transport

__all__ = [
    "Backend",
    "Boundary",
    "Box",
    "Cells",
    "Device",
    "Diagram",
    "Domain",
    "Facets",
    "Flow",
    "Function",
    "Gaussians",
    "Relaxation",
    "Status",
    "Transport",
    "__version__",
    "cells",
    "devices",
    "fluid",
    "lloyd",
    "page",
    "scene",
    "transport",
]
