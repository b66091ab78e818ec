"""Cells as files."""

from __future__ import annotations

import contextlib
import errno
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre
from ._container import inner

if TYPE_CHECKING:
    from ._cells import Cells

WITH_GEOMETRY = (".vtp", ".ply", ".glb", ".html", ".htm")
"""Endings of files that show the cells as polygons; ``.vtu`` has solids."""


def save(cells: Cells, path: str | os.PathLike[str]) -> None:
    """Writes cells as the file's ending says: :meth:`Cells.save`."""
    given, found, ending = cells._given, cells._found, os.path.splitext(os.fspath(path))[1].lower()
    if ending == ".npz":
        return _save_npz(cells, os.fspath(path))
    if ending == ".vtu" or (ending in WITH_GEOMETRY and "geometry" not in found):
        found = {**found, "geometry": given.evaluate(False, False, False, True, None, cells._epsilon, ending == ".vtu")["geometry"]}
    _laguerre.save(given.backend, given.points, given.weights, inner(given.container), found, path)


def _save_npz(cells: Cells, path: str) -> None:
    found: dict[str, Any] = {"volume": cells.volume, "barycenter": cells.centroid, "status": cells.status}
    if "offsets" in cells._found:
        found["facets"] = np.diff(cells.facets.offsets) + (cells.boundary.area > 0)
    found.update({name: getattr(cells, name) for name in ("integral", "second_moment") if name in cells._found})
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise FileNotFoundError(errno.ENOENT, f"{path}: there is no folder '{folder}'; make it first")
    # Whole or not at all.
    part = f"{path}.{os.getpid()}.part"
    try:
        with open(part, "wb") as file:
            np.savez(file, **found)
        os.replace(part, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.remove(part)
