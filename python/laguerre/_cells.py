"""Cells: what is computed of them, and from that."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre
from ._arrays import ReadOnly, freeze, frozen, numbers, whole
from ._backend import Backend, opened
from ._container import Box, Domain, inner
from ._files import save, save_facets

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    import pyvista
    import scipy.sparse
    from numpy.typing import ArrayLike, NDArray


class Status(IntEnum):
    """How a cell ended: complete or empty, by proof; not certified only with ``epsilon``."""

    COMPLETE = 0
    EMPTY = 1
    UNCERTIFIED = 2


@dataclass(frozen=True, eq=False)
class Given(ReadOnly):
    """What cells are of: points, weights, container and backend at the time."""

    points: NDArray[np.float64]
    weights: NDArray[np.float64] | None
    container: Domain | Box | None
    backend: Backend

    def evaluate(
        self, facets: bool, seconds: bool, facet_seconds: bool, geometry: bool, terms: Any, epsilon: Any, solids: bool = False, laplacian: bool = False
    ) -> dict[str, Any]:
        container = inner(self.container)
        return freeze(
            _laguerre.evaluate(
                self.backend, self.points, self.weights, container, facets, laplacian, seconds, facet_seconds, geometry, solids, terms, epsilon
            )
        )


@dataclass(frozen=True, eq=False, repr=False)
class Facets(ReadOnly):
    """Facets between cells as compressed rows: those of point ``i`` are ``offsets[i]`` to ``offsets[i + 1]``, sorted by neighbour. Each stands once
    in each of its two rows."""

    offsets: NDArray[np.int64]
    """Row starts, (N + 1,)."""
    neighbor: NDArray[np.uint32]
    """The point beyond each facet, (M,)."""
    area: NDArray[np.float64]
    """Area within the domain, (M,) (length squared)."""
    centroid: NDArray[np.float64]
    """Barycenter within the domain, (M, 3)."""
    distance: NDArray[np.float64]
    """Distance of the two points, (M,)."""
    _second: NDArray[np.float64] | None

    @property
    def second_moment(self) -> NDArray[np.float64]:
        """Where asked for: the integral of (x - b)(x - b)^T over each facet about its own centroid, (M, 3, 3) (length to the fourth)."""
        return _matrices(self._second, "facet_second_moments")

    def __len__(self) -> int:
        return len(self.neighbor)

    def __repr__(self) -> str:
        return f"<laguerre.Facets: {len(self)} in {len(self.offsets) - 1} rows>"

    def site(self) -> NDArray[np.int64]:
        """The point on this side of each facet, (M,)."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


@dataclass(frozen=True, eq=False, repr=False)
class Boundary(ReadOnly):
    """The piece of the domain's boundary in each cell."""

    area: NDArray[np.float64]
    """(N,) (length squared)."""
    centroid: NDArray[np.float64]
    """Barycenter, (N, 3); zero where there is none."""
    vector_area: NDArray[np.float64]
    """The integral of the outward unit normal over it, (N, 3) (length squared)."""

    def __repr__(self) -> str:
        return f"<laguerre.Boundary of {len(self.area)} cells, area {self.area.sum():g}>"


class Cells(ReadOnly):
    """The restricted cells of points and weights, in their order. All arrays are read-only: take a copy to write."""

    def __init__(self, given: Given, found: dict[str, Any], epsilon: float | None = None) -> None:
        self._given, self._found, self._epsilon = given, found, epsilon
        self.points: NDArray[np.float64] = given.points
        """(N, 3)."""
        self.weights: NDArray[np.float64] | None = given.weights
        """(N,) (length squared), or none where all are equal."""
        self.volume: NDArray[np.float64] = found["volume"]
        """(N,) (length cubed): the integral of the domain's winding number, which may be negative."""
        self.centroid: NDArray[np.float64] = found["centroid"]
        """(N, 3); NaN where the cell is empty."""
        self.status: NDArray[np.uint8] = found["status"]
        """(N,), of :class:`Status`."""

    @property
    def domain(self) -> Domain | Box | None:
        """What they are cut by."""
        return self._given.container

    def _asked(self, name: str, option: str) -> Any:
        if name not in self._found:
            raise ValueError(f"these cells were evaluated without: ask laguerre.cells for {option}")
        return self._found[name]

    @property
    def integral(self) -> NDArray[np.float64]:
        """Where a polynomial was given: its integral over each cell, (N,)."""
        return self._asked("integral", "polynomial={(1, 0, 0): 1.0}")

    @property
    def second_moment(self) -> NDArray[np.float64]:
        """Where asked for: the integral of (x - b)(x - b)^T about each cell's own centroid, (N, 3, 3) (length to the fifth); zero where it is empty."""
        return _matrices(self._found.get("second_moment"), "second_moments")

    @property
    def facets(self) -> Facets:
        """Where asked for: the facets between cells."""
        offsets, f = self._asked("offsets", "facets=True"), self._found
        second = f.get("facet_second_moment")
        return Facets(offsets.view(np.int64), f["neighbor"], f["area"], f["facet_centroid"], f["distance"], second)

    @property
    def boundary(self) -> Boundary:
        """Where facets were asked for: each cell's piece of the boundary."""
        area = self._asked("boundary_area", "facets=True")
        return Boundary(area, self._found["boundary_centroid"], self._found["boundary_vector_area"])

    def integrate(self, function: Callable[[NDArray[np.float64]], Any], degree: int = 3) -> NDArray[np.float64]:
        """The integral of a function over each cell, (N,), or (N, C) of one that has C values (its unit times length cubed).

        ``function`` is given points, (K, 3), thousands at once, and returns (K,) or (K, C) numbers; what it raises is raised. ``degree``, 31 at most, is
        that of the polynomials that are integrated exactly but for rounding (``polynomial=`` of :func:`cells` needs no calls): each cell has some fifty
        tetrahedra of ``(degree // 2 + 1)**3`` points. Of cells that a domain cuts, pieces that reach beyond it are added and subtracted: the function is
        asked for in the whole box around the domain, up to half of its extent on every side, and should be smooth at its surface.

        The cells are computed once more, and once for each value, on the CPU. The result does not depend on the number of threads; it needs memory for a
        batch of points a thread, some megabytes. One more call, with one point, tells how many values there are.
        """
        given = self._given
        if not callable(function):
            raise ValueError(f"function: a function of points is needed, this is {function!r}")
        degree = whole(degree, "degree", most=2**32 - 1)
        if given.backend.name != "cpu":
            given = replace(given, backend=opened("cpu", None, "f64", None))
        middle = np.zeros((1, 3))
        if isinstance(given.container, Domain):
            middle[0] = np.mean(given.container.bounds, axis=0)
        elif given.container is not None:
            middle[0] = (given.container.lo + given.container.hi) / 2
        first = evaluated(function, middle)

        def values(points: NDArray[np.float64]) -> NDArray[np.float64]:
            found = evaluated(function, points)
            if found.shape[1:] != first.shape[1:]:
                raise ValueError(f"function: for {len(points)} points it returned shape {found.shape}, for 1 point {first.shape}")
            return np.ascontiguousarray(found.reshape(len(points), -1))

        columns = first.size
        found = _laguerre.integrate(
            given.backend, given.points, given.weights, inner(given.container), values, degree, columns, self._epsilon
        )
        return frozen(found["integral"].reshape(-1, *first.shape[1:]))

    def __len__(self) -> int:
        return len(self.volume)

    def __repr__(self) -> str:
        return f"<laguerre.Cells of {len(self)} points, {int(np.sum(self.status == Status.EMPTY))} empty>"

    def adjacency(self) -> scipy.sparse.csr_array:
        """(N, N): the area of each facet (length squared)."""
        facets = self.facets
        return self._csr(facets.area, facets.neighbor, facets.offsets)

    def laplacian(self) -> scipy.sparse.csr_array:
        """(N, N) (length): minus area over distance of each facet, and their sum on the diagonal. It is symmetric and positive semidefinite, and each
        row sums to 0. (For Voronoi cells it is the two-point flux Laplacian of finite volumes.)"""
        if "laplacian" in self._found:
            return self._csr(*(self._found[name] for name in ("laplacian", "laplacian_columns", "laplacian_offsets")))
        self._asked("offsets", "laplacian=True or facets=True")
        facets = self.facets
        rate = self._csr(facets.area / facets.distance, facets.neighbor, facets.offsets)
        # To the last bit: each side rounds for itself.
        rate = (rate + rate.T) / 2
        return self._csr(rate.sum(axis=1), np.arange(len(self)), np.arange(len(self) + 1)) - rate

    def mass_jacobian_weights(self) -> scipy.sparse.csr_array:
        """(N, N) (length): the derivative of each volume by each weight, half of the :meth:`laplacian`."""
        return self.laplacian() / 2

    def mass_jacobian_points(self) -> scipy.sparse.csr_array:
        """(N, 3N) (length squared): the derivative of each volume by each coordinate, columns ``3 j + c``.

        This and the derivatives of centroids need the facets' second moments; without ``facet_second_moments=True`` the cells are evaluated once more.
        """
        return self._jacobian("mass", "points")

    def centroid_jacobian_weights(self) -> scipy.sparse.csr_array:
        """(3N, N) (per length): the derivative of each centroid's coordinates, rows ``3 i + r``, by each weight."""
        return self._jacobian("centroid", "weights")

    def centroid_jacobian_points(self) -> scipy.sparse.csr_array:
        """(3N, 3N): the derivative of each centroid's coordinates by each coordinate."""
        return self._jacobian("centroid", "points")

    def pullback(self, volume: ArrayLike, centroid: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The gradients of a function by points, (N, 3), and weights, (N,), from those by volumes, (N,), and centroids, (N, 3): what reverse
        differentiation asks for. Centroids of empty cells take no part."""
        given, found = self._given, self._with_facet_moments()
        by_volume = numbers(volume, "volume", (len(self),))
        by_centroid = numbers(centroid, "centroid", (len(self), 3))
        return _laguerre.pull_back_cells(given.backend, given.points, given.weights, inner(given.container), found, by_volume, by_centroid)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the cells as the file's ending says, in the program's forms, whole or not at all.

        ``.csv`` has a row for each, ``.npy`` (N, 4) volume and centroid, ``.npz`` the arrays; ``.vtu`` (solids, for ParaView), ``.vtp``, ``.ply`` and ``.glb`` have the cells as the domain cuts
        them, ``.html`` a page for a browser that shows them, all in the one file. Without ``geometry=True``, and for ``.vtu``, these are computed once more.
        """
        save(self, path)

    def save_facets(self, path: str | os.PathLike[str]) -> None:
        """Where asked for: writes the facets as the file's ending says, as the program's ``--facets`` does. Each stands once in each of its two rows; a cell's piece
        of the boundary comes first in its row, with neighbour -1 and distance NaN.

        ``.csv`` has a row for each, ``.npy`` those columns, ``.npz`` arrays: the rows of point ``i`` are ``offsets[i]`` to ``offsets[i + 1]`` of ``site``, ``neighbor``, ``area``,
        ``barycenter`` and ``distance``.
        """
        save_facets(self, path)

    def to_pyvista(self) -> pyvista.PolyData:
        """Where geometry was asked for: the faces of all cells, with ``volume``, ``site`` and ``beyond`` (the point on the other side, -1 for the
        boundary) of each."""
        geometry = self._asked("geometry", "geometry=True")
        import pyvista

        offsets, corners, site, beyond = geometry.faces
        mesh = pyvista.PolyData(geometry.points, faces=np.insert(corners, offsets[:-1], np.diff(offsets)))
        mesh.cell_data["site"] = site
        mesh.cell_data["beyond"] = beyond
        mesh.cell_data["volume"] = self.volume[site]
        return mesh

    def _csr(self, values: NDArray[np.float64], columns: NDArray[Any], offsets: NDArray[Any]) -> Any:
        import scipy.sparse

        kind = index_kind(len(values))
        parts = (values, columns.astype(kind), offsets.astype(kind))
        return scipy.sparse.csr_array(parts, shape=(len(self), len(self)))

    def _with_facet_moments(self) -> dict[str, Any]:
        """What was found, with the facets' second moments: evaluated once more at most, for all derivatives."""
        if "facet_second_moment" not in self._found:
            again = self._given.evaluate(True, False, True, False, None, self._epsilon)
            self._found = {**self._found, **again, "volume": self.volume, "centroid": self.centroid}
        return self._found

    def _jacobian(self, of: str, by: str) -> Any:
        import scipy.sparse

        given, found = self._given, self._with_facet_moments()
        offsets, columns, values = _laguerre.jacobian(
            given.backend, given.points, given.weights, inner(given.container), found, of, by
        )
        shape = (3 if of == "centroid" else 1, 3 if by == "points" else 1)
        kind = index_kind(values.size)
        blocks = (values.reshape(-1, *shape), columns.astype(kind), offsets.astype(kind))
        n = len(self)
        return scipy.sparse.csr_array(scipy.sparse.bsr_array(blocks, shape=(n * shape[0], n * shape[1])))


def index_kind(entries: int) -> type[np.signedinteger[Any]]:
    """The indices of a sparse matrix: where 32 bits will do, direct solvers take no others."""
    return np.int32 if entries < 2**31 else np.int64


def evaluated(function: Any, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a function returns for points, as doubles."""
    found = np.asarray(function(points))
    if found.dtype.kind not in "fiub":
        raise ValueError(f"function: real numbers are needed, it returned {found.dtype}")
    if found.ndim not in (1, 2) or len(found) != len(points):
        raise ValueError(f"function: for points of shape {points.shape} it has to return ({len(points)},) or ({len(points)}, C), not {found.shape}")
    return found.astype(float, copy=False)


def _matrices(packed: NDArray[np.float64] | None, option: str) -> NDArray[np.float64]:
    """Symmetric matrices from xx, yy, zz, xy, xz, yz."""
    if packed is None:
        raise ValueError(f"these cells were evaluated without: ask laguerre.cells for {option}=True")
    return frozen(packed.take([0, 3, 4, 3, 1, 5, 4, 5, 2], axis=1).reshape(-1, 3, 3))
