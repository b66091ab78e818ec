"""Containers, diagrams and their cells."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre

if TYPE_CHECKING:
    import pyvista
    import scipy.sparse
    from numpy.typing import ArrayLike, NDArray

COMPLETE, EMPTY, UNCERTIFIED = 0, 1, 2


class Domain:
    """A closed, consistently oriented triangle mesh; shells within shells count by their winding number.

    ``vertices`` is (V, 3), ``triangles`` (T, 3) of indices from 0, counterclockwise from outside (a mesh turned inside out is turned back, which
    ``notes`` says). A PyVista or trimesh mesh of triangles is taken in the place of both.
    """

    __slots__ = ("_inner",)

    def __init__(self, vertices: Any, triangles: ArrayLike | None = None) -> None:
        if triangles is None:
            vertices, triangles = _mesh(vertices)
        self._inner = _laguerre.Domain(_table(vertices, "vertices"), _triangles(triangles))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Domain:
        """Reads ``.obj``, ``.off``, ``.ply`` or ``.stl``."""
        domain = cls.__new__(cls)
        domain._inner = _laguerre.Domain.load(path)
        return domain

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
        """The integral of the winding number (length cubed)."""
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

    def __repr__(self) -> str:
        return f"<laguerre.Domain of {len(self.triangles)} triangles, volume {self.volume:g}>"


class Box:
    """An axis-aligned box from corner ``lo`` to corner ``hi``."""

    __slots__ = ("hi", "lo")

    def __init__(self, lo: ArrayLike, hi: ArrayLike) -> None:
        self.lo, self.hi = (np.array(np.broadcast_to(np.asarray(c, dtype=float), (3,))) for c in (lo, hi))

    @property
    def volume(self) -> float:
        """Its volume (length cubed)."""
        return float(np.prod(self.hi - self.lo))

    def __repr__(self) -> str:
        return f"laguerre.Box({self.lo.tolist()}, {self.hi.tolist()})"


@dataclass(frozen=True, eq=False)
class Facets:
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
    boundary_area: NDArray[np.float64]
    """Area of the piece of the domain's boundary in each cell, (N,)."""
    boundary_centroid: NDArray[np.float64]
    """Its barycenter, (N, 3); zero where there is none."""
    boundary_normal: NDArray[np.float64]
    """The integral of the outward unit normal over it, (N, 3) (length squared)."""
    second_moment: NDArray[np.float64] | None
    """Where asked for: integral of (x - b)(x - b)^T over each facet, as xx, yy, zz, xy, xz, yz, (M, 6) (length to the fourth)."""

    def __len__(self) -> int:
        return len(self.neighbor)

    def site(self) -> NDArray[np.int64]:
        """The point on this side of each facet, (M,)."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


class Cells:
    """The restricted cells of ``Diagram``: arrays in the order of its points."""

    def __init__(self, diagram: Diagram, found: dict[str, Any]) -> None:
        self.diagram = diagram
        self._found = found
        self.volume: NDArray[np.float64] = found["volume"]
        """(N,), length cubed: the integral of the domain's winding number."""
        self.centroid: NDArray[np.float64] = found["centroid"]
        """(N, 3); NaN where the cell is empty."""
        self.status: NDArray[np.uint8] = found["status"]
        """(N,): 0 complete, 1 empty, both by proof; 2 not certified, only with ``epsilon``."""
        self.integral: NDArray[np.float64] | None = found.get("integral")
        """(N,), where a polynomial was given: its integral over each cell."""
        self._second = found.get("second_moment")

    @property
    def second_moment(self) -> NDArray[np.float64]:
        """(N, 3, 3), length to the fifth: integral of (x - b)(x - b)^T about each cell's own centroid."""
        if self._second is None:
            raise ValueError("the cells have no second moments: ask for second_moments=True")
        return self._second[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3)

    @property
    def facets(self) -> Facets:
        """The facets, where asked for."""
        f = self._found
        if "offsets" not in f:
            raise ValueError("the cells have no facets: ask for facets=True")
        return Facets(
            f["offsets"].view(np.int64), f["neighbor"], f["area"], f["facet_centroid"], f["distance"],
            f["boundary_area"], f["boundary_centroid"], f["boundary_normal"], f.get("facet_second_moment"),
        )  # fmt: skip

    def __len__(self) -> int:
        return len(self.volume)

    def __repr__(self) -> str:
        return f"<laguerre.Cells of {len(self)} points, {int(np.sum(self.status == EMPTY))} empty>"

    def adjacency(self) -> scipy.sparse.csr_array:
        """(N, N): the area of each facet, for whose pattern it stands."""
        facets = self.facets
        return self._csr(facets.area, facets.neighbor, facets.offsets)

    def laplacian(self) -> scipy.sparse.csr_array:
        """(N, N), length: minus area over distance of each facet, and their sum on the diagonal. It is positive semidefinite, and each row sums to 0.
        (For Voronoi cells it is the two-point flux Laplacian of finite volumes.)"""
        import scipy.sparse

        facets = self.facets
        rate = self._csr(facets.area / facets.distance, facets.neighbor, facets.offsets)
        rate = (rate + rate.T) / 2  # to the last bit, what one side rounds otherwise
        return scipy.sparse.csr_array(scipy.sparse.diags_array(rate.sum(axis=1)) - rate)

    def mass_jacobian_weights(self) -> scipy.sparse.csr_array:
        """(N, N): the derivative of each volume by each weight; half of the :meth:`laplacian`."""
        return self.laplacian() / 2

    def mass_jacobian_points(self) -> scipy.sparse.csr_array:
        """(N, 3N): the derivative of each volume by each coordinate, columns ``3 j + c``."""
        return self._jacobian("mass", "points")

    def centroid_jacobian_weights(self) -> scipy.sparse.csr_array:
        """(3N, N): the derivative of each centroid's coordinates, rows ``3 i + r``, by each weight."""
        return self._jacobian("centroid", "weights")

    def centroid_jacobian_points(self) -> scipy.sparse.csr_array:
        """(3N, 3N): the derivative of each centroid's coordinates by each coordinate."""
        return self._jacobian("centroid", "points")

    def pullback(
        self, volume: NDArray[np.float64], centroid: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The gradients of a function by points, (N, 3), and weights, (N,), from those by volumes, (N,), and centroids, (N, 3): what reverse
        differentiation asks for. Empty cells take no part."""
        by_centroid = np.where(self.status[:, None] == EMPTY, 0.0, centroid).ravel()
        points = self._jacobian("mass", "points").T @ volume + self.centroid_jacobian_points().T @ by_centroid
        weights = self._jacobian("mass", "weights").T @ volume + self.centroid_jacobian_weights().T @ by_centroid
        return points.reshape(-1, 3), weights

    def _csr(self, values: NDArray[np.float64], columns: NDArray[Any], offsets: NDArray[Any]) -> Any:
        import scipy.sparse

        kind = np.int32 if len(values) < 2**31 else np.int64
        parts = (values, columns.astype(kind), offsets.astype(kind))
        return scipy.sparse.csr_array(parts, shape=(len(self), len(self)))

    def _jacobian(self, of: str, by: str) -> Any:
        import scipy.sparse

        d, found = self.diagram, self._found
        if "facet_second_moment" not in found:
            # Once for all Jacobians.
            found = self._found = {**found, **d._evaluate(facet_second_moments=True)}
        offsets, columns, values = _laguerre.jacobian(d.points, d.weights, d._container, found, of, by)
        shape = (3 if of == "centroid" else 1, 3 if by == "points" else 1)
        blocks = (values.reshape(-1, *shape), columns.astype(np.int64), offsets.view(np.int64))
        n = len(self)
        return scipy.sparse.csr_array(scipy.sparse.bsr_array(blocks, shape=(n * shape[0], n * shape[1])))

    def to_pyvista(self) -> pyvista.PolyData:
        """The faces of all restricted cells, with ``volume``, ``site`` and ``beyond`` (the point on the other side, -1 for the boundary) of each."""
        import pyvista

        if "geometry" not in self._found:
            raise ValueError("the cells have no geometry: ask for geometry=True")
        geometry = self._found["geometry"]
        offsets, corners, site, beyond = geometry.faces
        faces = np.insert(corners, offsets[:-1], np.diff(offsets))
        mesh = pyvista.PolyData(geometry.points, faces=faces)
        mesh.cell_data["site"] = site
        mesh.cell_data["beyond"] = beyond
        mesh.cell_data["volume"] = self.volume[site]
        return mesh


class Diagram:
    """Points, weights and their container, to be evaluated again and again: the domain's grid and the backend's memory are kept.

    ``weights`` are squared lengths; ``radii``, in their place, lengths whose squares are the weights. ``backend`` is ``"auto"`` (a GPU if there is one),
    ``"cpu"``, ``"ocl"`` or a :class:`Backend`.
    """

    def __init__(
        self,
        points: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        radii: ArrayLike | None = None,
        domain: Domain | Box | None = None,
        backend: str | _laguerre.Backend = "auto",
        devices: list[int] | None = None,
        precision: str = "f64",
        threads: int | None = None,
    ) -> None:
        if isinstance(backend, str):
            backend = _laguerre.Backend(backend, devices, precision, threads)
        self.backend = backend
        self.domain = domain
        self.set(points, weights, radii=radii)

    def set(self, points: ArrayLike, weights: ArrayLike | None = None, *, radii: ArrayLike | None = None) -> None:
        """Other points and weights in the same container."""
        if radii is not None:
            if weights is not None:
                raise ValueError("weights and radii: give one of them")
            weights = np.square(np.asarray(radii, dtype=float))
        self.points = _table(points, "points")
        self.weights = None if weights is None else np.ascontiguousarray(weights, dtype=float)
        if self.weights is not None and self.weights.shape != (len(self.points),):
            raise ValueError(f"weights: shape ({len(self.points)},) is needed, this is {self.weights.shape}")

    @property
    def _container(self) -> Any:
        if self.domain is None:
            return None
        if isinstance(self.domain, Box):
            return (self.domain.lo.tolist(), self.domain.hi.tolist())
        return self.domain._inner

    def _evaluate(
        self, *, facets: bool = False, second_moments: bool = False, facet_second_moments: bool = False,
        geometry: bool = False, polynomial: Any = None, epsilon: float | None = None,
    ) -> dict[str, Any]:  # fmt: skip
        return _laguerre.evaluate(
            self.backend, self.points, self.weights, self._container, facets, second_moments, facet_second_moments,
            geometry, polynomial, epsilon,
        )  # fmt: skip

    def cells(
        self,
        *,
        facets: bool = False,
        second_moments: bool = False,
        facet_second_moments: bool = False,
        geometry: bool = False,
        polynomial: dict[tuple[int, int, int], float] | None = None,
        epsilon: float | None = None,
    ) -> Cells:
        """Volumes and centroids of all cells, and what else is asked for. ``polynomial`` maps exponents of x, y, z to coefficients."""
        terms = None if polynomial is None else ([(list(e), float(c)) for e, c in polynomial.items()], [0.0] * 3)
        found = self._evaluate(
            facets=facets, second_moments=second_moments, facet_second_moments=facet_second_moments,
            geometry=geometry, polynomial=terms, epsilon=epsilon,
        )  # fmt: skip
        # The cells are of these points, also when others are set.
        of = Diagram.__new__(Diagram)
        of.__dict__.update(self.__dict__)
        return Cells(of, found)


def cells(points: ArrayLike, weights: ArrayLike | None = None, **options: Any) -> Cells:
    """The restricted cells of weighted points: :class:`Diagram` and :meth:`Diagram.cells` in one call, with the options of both."""
    of_diagram = {name: options.pop(name) for name in _OF_DIAGRAM if name in options}
    return Diagram(points, weights, **of_diagram).cells(**options)


_OF_DIAGRAM = ("radii", "domain", "backend", "devices", "precision", "threads")


def _table(rows: Any, what: str) -> NDArray[np.float64]:
    if hasattr(rows, "__dlpack__") and not isinstance(rows, np.ndarray):
        rows = np.from_dlpack(rows)
    table = np.ascontiguousarray(rows, dtype=float)
    if table.ndim != 2 or table.shape[1] != 3:
        raise ValueError(f"{what}: an array of shape (N, 3) is needed, this has {table.shape}")
    return table


def _triangles(rows: Any) -> NDArray[np.uint32]:
    triangles = np.asarray(rows)
    if triangles.ndim != 2 or triangles.shape[1] != 3:
        raise ValueError(f"triangles: an array of shape (T, 3) is needed, this has {triangles.shape}")
    if triangles.dtype.kind not in "iu":
        raise ValueError(f"triangles: integers are needed, these are {triangles.dtype}")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= 2**32):
        raise ValueError("triangles: an index is negative or beyond 32 bits")
    return np.ascontiguousarray(triangles, dtype=np.uint32)


def _mesh(mesh: Any) -> tuple[Any, Any]:
    """Vertices and triangles of a PyVista or trimesh mesh."""
    if hasattr(mesh, "regular_faces") and hasattr(mesh, "points"):
        return mesh.points, mesh.triangulate().regular_faces
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    raise ValueError("a domain is made of vertices and triangles, or of a PyVista or trimesh mesh")
