"""Cells as files."""

from __future__ import annotations

import errno
import io
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre
from ._container import inner

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._cells import Cells

WITH_GEOMETRY = (".vtp", ".ply", ".glb", ".html", ".htm")
"""Endings of files that show the cells as polygons; ``.vtu`` has solids."""


def save(cells: Cells, path: str | os.PathLike[str]) -> None:
    """Writes cells as the file's ending says: :meth:`Cells.save`."""
    given, found, ending = cells._given, cells._found, os.path.splitext(os.fspath(path))[1].lower()
    if ending == ".npy":
        return _write(path, np.column_stack((cells.volume, cells.centroid)))
    if ending == ".npz":
        columns: dict[str, Any] = {"volume": cells.volume, "barycenter": cells.centroid, "status": cells.status}
        if "offsets" in found:
            columns["facets"] = np.diff(cells.facets.offsets) + (cells.boundary.area > 0)
        columns.update({name: getattr(cells, name) for name in ("integral", "second_moment") if name in found})
        return _write(path, columns)
    if ending == ".vtu" or (ending in WITH_GEOMETRY and "geometry" not in found):
        found = {**found, "geometry": given.evaluate(False, False, False, True, None, cells._epsilon, ending == ".vtu")["geometry"]}
    _laguerre.save(given.backend, given.points, given.weights, inner(given.container), found, False, path)


def save_facets(cells: Cells, path: str | os.PathLike[str]) -> None:
    """Writes facets as the file's ending says: :meth:`Cells.save_facets`."""
    given, ending = cells._given, os.path.splitext(os.fspath(path))[1].lower()
    facets, boundary = cells.facets, cells.boundary
    if ending not in (".npy", ".npz"):
        return _laguerre.save(given.backend, given.points, given.weights, inner(given.container), cells._found, True, path)
    # Pieces of the boundary come first in their rows.
    pieces = np.flatnonzero(boundary.area > 0)
    at = facets.offsets[pieces]
    columns: dict[str, Any] = {
        "site": np.insert(facets.site(), at, pieces),
        "neighbor": np.insert(facets.neighbor.astype(np.int64), at, -1),
        "area": np.insert(facets.area, at, boundary.area[pieces]),
        "barycenter": np.insert(facets.centroid, at, boundary.centroid[pieces], axis=0),
        "distance": np.insert(facets.distance, at, np.nan),
    }
    if ending == ".npy":
        return _write(path, np.column_stack(tuple(columns.values())))
    offsets = facets.offsets + np.insert(np.cumsum(boundary.area > 0), 0, 0)
    return _write(path, {"offsets": offsets, **columns})


def _write(path: str | os.PathLike[str], found: NDArray[np.float64] | dict[str, Any]) -> None:
    """An array as ``.npy``, or arrays by their names as ``.npz``: whole or not at all."""
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise FileNotFoundError(errno.ENOENT, f"{os.fspath(path)}: there is no folder '{folder}'; make it first")
    file = io.BytesIO()
    if isinstance(found, dict):
        np.savez(file, **found)
    else:
        np.save(file, found)
    _laguerre.write(path, np.frombuffer(file.getbuffer(), np.uint8))
