"""Restricted power diagrams: Laguerre-Voronoi cells of weighted points, cut by a triangulated domain, and integrals over them.

The power distance of ``x`` to point ``i`` is ``|x - p_i|**2 - w_i``: weights are squared lengths, and a larger weight is a larger cell.
Without weights it is the Voronoi diagram. Every finished cell is complete or empty, by proof.

    import laguerre as lg
    cells = lg.cells(points, domain="swan.off", facets=True)
    cells.volume, cells.centroid, cells.laplacian()

Of points at one place, or nearer than the container's frame can tell apart, one has a cell and the others are empty.
"""

from ._laguerre import __version__

# (What type checkers read; to import `typing` for it would take longer than all the rest.)
TYPE_CHECKING = False
if TYPE_CHECKING:
    from ._backend import Backend, Device, devices
    from ._cells import Boundary, Cells, Facets, Status
    from ._container import Box, Domain
    from ._diagram import Diagram, cells
    from ._fluid import Flow, fluid, scene
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

_MODULES = {
    "_backend": ("Backend", "Device", "devices"),
    "_cells": ("Boundary", "Cells", "Facets", "Status"),
    "_container": ("Box", "Domain"),
    "_diagram": ("Diagram", "cells"),
    "_fluid": ("Flow", "fluid", "scene"),
    "_page": ("page",),
    "_solvers": ("Function", "Gaussians", "Relaxation", "Transport", "lloyd", "transport"),
}


if not TYPE_CHECKING:

    def __getattr__(name):
        """Imports a name when it is first asked for, and NumPy with it, which takes 0.1 s: an ``import laguerre`` alone does not."""
        from importlib import import_module

        for module, names in _MODULES.items():
            if name in names:
                found = globals()[name] = getattr(import_module(f".{module}", __name__), name)
                return found
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
