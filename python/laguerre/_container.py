"""What cells are cut by: domains and boxes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _laguerre
from ._arrays import frozen, indices, numbers

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Domain:
    """A closed triangle mesh; shells within shells count by their winding number. Or a density: :meth:`image`, :meth:`tetrahedra`.

    ``vertices`` is (V, 3), ``triangles`` (T, 3) of indices from 0, counterclockwise from outside. A mesh turned inside out is turned back, and one whose
    triangles do not agree is oriented, which ``notes`` says; with ``orient=True`` every part of the surface is turned outward, or inward within an odd number of others. A PyVista
    or trimesh mesh is taken in the place of both.
    """

    __slots__ = ("_inner", "_made")

    def __init__(self, vertices: Any, triangles: ArrayLike | None = None, *, orient: bool = False) -> None:
        if triangles is None:
            vertices, triangles = _mesh(vertices)
        self._inner = _laguerre.Domain(numbers(vertices, "vertices", (None, 3)), indices(triangles, "triangles", 3), orient)
        self._made: tuple[Any, ...] | None = None

    @classmethod
    def image(cls, values: ArrayLike, lo: ArrayLike = 0.0, hi: ArrayLike | None = None) -> Domain:
        """A density (mass per volume) that is constant in each voxel: ``values`` is (nx, ny, nz), and fills the box from corner ``lo`` to ``hi``, each (3,) or
        one number for all axes; without ``hi`` voxels are unit cubes.

        Volumes of cells are then their masses, centroids and second moments those of mass, areas of facets the density's integrals, all exact.
        Densities are kept to 28 bits below the largest, which ``notes`` says where it changes one; integers up to 2**28 are kept.
        """
        values = numbers(values, "values", (None, None, None))
        lo = _corner(lo)
        hi = _corner(lo + values.shape if hi is None else hi)
        made = _laguerre.Domain.image(values.ravel(), values.shape, lo.tolist(), hi.tolist())
        return cls._of(made, (Domain.image, (values, lo, hi)))

    @classmethod
    def tetrahedra(cls, points: ArrayLike, tetrahedra: ArrayLike, values: ArrayLike) -> Domain:
        """A density that is constant in each tetrahedron, likewise: ``points`` is (V, 3), ``tetrahedra`` (T, 4) of indices from 0, in any order, ``values`` (T,). Where
        some overlap, densities add up."""
        points = numbers(points, "points", (None, 3))
        corners = frozen(indices(tetrahedra, "tetrahedra", 4).copy())
        values = numbers(values, "values", (None,))
        made = _laguerre.Domain.tetrahedra(points, corners, values)
        return cls._of(made, (Domain.tetrahedra, (points, corners, values)))

    @classmethod
    def _of(cls, inner: Any, made: tuple[Any, ...] | None) -> Domain:
        domain = cls.__new__(cls)
        domain._inner, domain._made = inner, made
        return domain

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, orient: bool = False) -> Domain:
        """Reads ``.obj``, ``.off``, ``.ply``, ``.stl``, ``.vtk`` or ``.vtp``, each also with ``.gz`` behind it; ``orient`` as for arrays."""
        return cls._of(_laguerre.Domain.load(path, orient), None)

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The vertices as they were taken, (V, 3)."""
        return self._inner.vertices

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """The triangles as they were taken, (T, 3)."""
        return self._inner.triangles

    @property
    def volume(self) -> float:
        """The integral of the winding number (length cubed), or the mass."""
        return self._inner.volume

    @property
    def area(self) -> float:
        """The area of the surface (length squared)."""
        return self._inner.area

    @property
    def centroid(self) -> NDArray[np.float64]:
        """The barycenter, (3,)."""
        return self._inner.centroid

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Minimum and maximum corner of the box around it."""
        lo, hi = self._inner.bounds
        return np.array(lo), np.array(hi)

    @property
    def notes(self) -> list[str]:
        """What was changed on the way in, one line each."""
        return self._inner.notes

    def __reduce__(self) -> tuple[Any, ...]:
        return self._made or (Domain, (self.vertices, self.triangles))

    def __repr__(self) -> str:
        return f"<laguerre.Domain of {len(self.triangles)} triangles, volume {self.volume:g}>"


class Box:
    """An axis-aligned box from corner ``lo`` to corner ``hi``, each (3,) or one number for all axes."""

    __slots__ = ("hi", "lo")

    def __init__(self, lo: ArrayLike, hi: ArrayLike) -> None:
        self.lo, self.hi = (_corner(corner) for corner in (lo, hi))

    @property
    def volume(self) -> float:
        """Its volume (length cubed)."""
        return float(np.prod(self.hi - self.lo))

    def __reduce__(self) -> tuple[Any, ...]:
        return Box, (self.lo, self.hi)

    def __repr__(self) -> str:
        return f"laguerre.Box({self.lo.tolist()}, {self.hi.tolist()})"


Container = Union[Domain, Box, str, "os.PathLike[str]", Any, None]
"""A domain, a box, a file of a mesh, a PyVista or trimesh mesh; or nothing, which is the box around the points."""


def taken(container: Container, points: NDArray[np.float64]) -> Domain | Box | None:
    """What a container stands for."""
    if container is None:
        # (Of points that have no box the evaluation says so.)
        has_box = len(points) and np.isfinite(points).all() and np.ptp(points, axis=0).all()
        return Box(points.min(axis=0), points.max(axis=0)) if has_box else None
    if isinstance(container, (Domain, Box)):
        return container
    if isinstance(container, (str, os.PathLike)):
        return Domain.load(container)
    return Domain(container)


def inner(container: Domain | Box | None) -> Any:
    """The same for `_laguerre`."""
    if container is None:
        return None
    return container._inner if isinstance(container, Domain) else (container.lo.tolist(), container.hi.tolist())


def _corner(corner: Any) -> NDArray[np.float64]:
    if np.ndim(corner) == 0:
        corner = [corner] * 3
    return frozen(numbers(corner, "a corner of the box", (3,)))


def _mesh(mesh: Any) -> tuple[Any, Any]:
    """Vertices and triangles of a PyVista or trimesh mesh."""
    if hasattr(mesh, "regular_faces") and hasattr(mesh, "points"):
        return mesh.points, mesh.triangulate().regular_faces
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    raise ValueError("domain: a laguerre.Domain or Box, a file, or a PyVista or trimesh mesh is needed")
