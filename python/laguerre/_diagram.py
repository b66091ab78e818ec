"""Diagrams: points, weights and their container."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._arrays import frozen, numbers, real, whole
from ._backend import Backend, opened
from ._cells import Cells, Given
from ._container import Box, Container, Domain, taken

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray


class Diagram:
    """Points, weights and their container, to be evaluated again and again: the container's grid and the backend are kept.

    ``points`` are (N, 3) (length), ``weights``, (N,), are squared lengths, in whose place ``radii``, (N,), are lengths whose squares are the weights. ``domain`` is a :class:`Domain`,
    a :class:`Box`, a mesh's file, a PyVista or trimesh mesh, or nothing: the box around these points. ``backend`` is ``"auto"`` (a GPU if there is one),
    ``"cpu"``, ``"ocl"`` or a :class:`Backend`; ``devices`` are the numbers of OpenCL devices, ``threads`` the CPU's.
    """

    def __init__(
        self,
        points: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        radii: ArrayLike | None = None,
        domain: Container = None,
        backend: str | Backend = "auto",
        devices: list[int] | None = None,
        precision: str = "f64",
        threads: int | None = None,
    ) -> None:
        points = numbers(points, "points", (None, 3))
        weights = _weights(len(points), weights, radii)
        self._given = Given(points, weights, taken(domain, points), opened(backend, devices, precision, threads))

    def set(self, points: ArrayLike, weights: ArrayLike | None = None, *, radii: ArrayLike | None = None) -> None:
        """Other points and weights (none given: all equal) in the same container. Cells that were evaluated stay those of theirs."""
        points = numbers(points, "points", (None, 3))
        weights = _weights(len(points), weights, radii)
        self._given = Given(points, weights, self._given.container, self._given.backend)

    @property
    def points(self) -> NDArray[np.float64]:
        """The points, (N, 3)."""
        return self._given.points

    @property
    def weights(self) -> NDArray[np.float64] | None:
        """The weights, (N,), or none where all are equal."""
        return self._given.weights

    @property
    def domain(self) -> Domain | Box | None:
        """What the cells are cut by; none where the points have no box."""
        return self._given.container

    @property
    def backend(self) -> Backend:
        """Where they are computed."""
        return self._given.backend

    def cells(
        self,
        *,
        facets: bool = False,
        laplacian: bool = False,
        second_moments: bool = False,
        facet_second_moments: bool = False,
        geometry: bool = False,
        polynomial: Mapping[tuple[int, int, int], float] | None = None,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        epsilon: float | None = None,
    ) -> Cells:
        """Volumes, (N,) (length cubed), and centroids, (N, 3) (length), of all cells, and what else is asked for.

        ``facets`` are neighbours, with areas, centroids and distances, and each cell's piece of the boundary: :class:`Facets`, :class:`Boundary`.
        ``second_moments`` are (N, 3, 3), ``facet_second_moments`` (M, 3, 3), which derivatives of volumes by points and of centroids are made of.
        ``geometry`` has the cells as polygons, for :meth:`Cells.to_pyvista` and :meth:`Cells.save`. ``laplacian`` is what :meth:`Cells.laplacian` needs, for which ``facets`` will do as well; by itself it is faster, on a GPU by a third.
        ``polynomial`` maps exponents of x, y, z, counted from ``origin``, to coefficients: ``{(2, 0, 0): 1.0}`` is x squared, :attr:`Cells.integral` its integral. ``epsilon`` ends each search at a radius that is enlarged by
        ``1 + epsilon`` instead of a proof.
        """
        terms = None
        if polynomial is not None:
            terms = (_terms(polynomial), numbers(origin, "origin", (3,)).tolist())
        if epsilon is not None:
            epsilon = real(epsilon, "epsilon")
        given = self._given
        found = given.evaluate(facets, second_moments, facet_second_moments, geometry, terms, epsilon, laplacian=laplacian)
        return Cells(given, found, epsilon)


def cells(
    points: ArrayLike,
    weights: ArrayLike | None = None,
    *,
    radii: ArrayLike | None = None,
    domain: Container = None,
    facets: bool = False,
    laplacian: bool = False,
    second_moments: bool = False,
    facet_second_moments: bool = False,
    geometry: bool = False,
    polynomial: Mapping[tuple[int, int, int], float] | None = None,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    epsilon: float | None = None,
    backend: str | Backend = "auto",
    devices: list[int] | None = None,
    precision: str = "f64",
    threads: int | None = None,
) -> Cells:
    """The restricted cells of weighted points.

    ``points`` are (N, 3) (length). ``weights``, (N,), are squared lengths; a larger one is a larger cell. In their place ``radii``, (N,), are lengths whose
    squares are the weights. ``domain`` is a :class:`Domain`, a :class:`Box`, a mesh's file, a PyVista or trimesh mesh, or nothing: the box around the points.

    The :class:`Cells` have ``volume``, (N,) (length cubed), ``centroid``, (N, 3) (length), ``status``, (N,), and what is asked for: see
    :meth:`Diagram.cells`, and :class:`Diagram` for ``backend``, ``devices``, ``precision`` and ``threads``. Where points move and their container stays, a
    :class:`Diagram` is faster.

    >>> laguerre.cells([[0.25, 0.5, 0.5], [0.75, 0.5, 0.5]], [0.1, 0.0], domain=laguerre.Box(0, 1)).volume
    array([0.6, 0.4])
    """
    diagram = Diagram(
        points, weights, radii=radii, domain=domain, backend=backend, devices=devices, precision=precision, threads=threads
    )
    return diagram.cells(
        facets=facets, laplacian=laplacian, second_moments=second_moments, facet_second_moments=facet_second_moments,
        geometry=geometry, polynomial=polynomial, origin=origin, epsilon=epsilon,
    )  # fmt: skip


def refuse_unknown(options: dict[str, Any], of: str) -> None:
    """What a function hands on to :class:`Diagram` is named with that function, where it is not known."""
    for name in options.keys() - (Diagram.__init__.__kwdefaults__ or {}).keys():
        raise TypeError(f"{of}() got an unexpected keyword argument '{name}'")


def _terms(polynomial: Any) -> list[tuple[list[int], float]]:
    """Exponents and coefficients."""
    if not hasattr(polynomial, "items") or not polynomial:
        raise ValueError(f"polynomial: terms are needed, one at least, as {{(1, 0, 0): 1.0}}; this is {polynomial!r}")
    terms = []
    for exponents, coefficient in polynomial.items():
        if np.shape(exponents) != (3,):
            raise ValueError(f"polynomial: three exponents are needed, of x, y and z, as (1, 0, 0); this is {exponents!r}")
        terms.append(([whole(e, "polynomial: exponent", most=2**32 - 1) for e in exponents], real(coefficient, "polynomial: coefficient")))
    return terms


def _weights(count: int, weights: Any, radii: Any) -> NDArray[np.float64] | None:
    if radii is not None:
        if weights is not None:
            raise ValueError("weights and radii: give one of them")
        lengths = numbers(radii, "radii", (count,))
        if (lengths < 0).any():
            raise ValueError(f"radii: that of point {int(np.argmax(lengths < 0))} is negative")
        return frozen(np.square(lengths))
    return None if weights is None else numbers(weights, "weights", (count,))
