"""Lloyd's relaxation and semi-discrete optimal transport."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre
from ._arrays import ReadOnly, freeze, numbers, real, whole
from ._cells import Cells, Given, evaluated
from ._container import Container, inner
from ._diagram import Diagram, refuse_unknown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Relaxation(ReadOnly):
    """What :func:`lloyd` came to."""

    points: NDArray[np.float64]
    """The points, (N, 3)."""
    energy: NDArray[np.float64]
    """The energy at the start and after each iteration (length to the fifth, times the density's unit): the integral of ``density * (|x - p|**2 - w)`` over all cells."""
    gradient: NDArray[np.float64]
    """The mean distance of points from centroids (by mass, of mass), over the mean cell's size, likewise."""
    masses: NDArray[np.float64]
    """The masses of their cells, (N,); volumes without a density."""
    end: str
    """``"converged"``, ``"iterations"`` (there were no more) or ``"stopped"`` (by the callback)."""
    cells: Cells
    """The cells of these points, with second moments."""

    @property
    def converged(self) -> bool:
        """Whether the last gradient is within the tolerance."""
        return self.end == "converged"

    def __repr__(self) -> str:
        return f"<laguerre.Relaxation of {len(self.points)} points: {self.end}, {len(self.gradient) - 1} iterations, gradient {self.gradient[-1]:.1e}>"


@dataclass(frozen=True, eq=False)
class Gaussians:
    """The density ``constant + sum of mass * N(x; mean, covariance)``, for :func:`transport` and :func:`lloyd` on the CPU.

    ``means`` is (K, 3). ``covariances`` is (K, 3, 3), symmetric and positive definite (length squared), or (K,): standard deviations (length) along every
    direction. ``masses`` is (K,): the integral of each over all of space, of which a domain has a part. It is integrated over each cell by quadrature of that
    ``degree``, 0 to 31: cells are to be no larger than the deviations, or the degree is to be high. Where a Gaussian underflows to 0, some 38
    deviations from its mean, it takes a ``constant``.
    """

    means: ArrayLike
    covariances: ArrayLike
    masses: ArrayLike
    constant: float = 0.0
    degree: int = 5

    def _given(self) -> tuple[int, float, list[tuple[Any, Any, float]]]:
        means = numbers(self.means, "Gaussians: means", (None, 3))
        k = len(means)
        if np.ndim(self.covariances) == 1:
            deviations = numbers(self.covariances, "Gaussians: deviations", (k,))
            if not np.all(deviations > 0):
                wrong = int(np.argmin(deviations > 0))
                raise ValueError(f"Gaussians: deviation {wrong} is {float(deviations[wrong])!r}; a positive length is needed")
            covariances = deviations[:, None, None] ** 2 * np.eye(3)
        else:
            covariances = numbers(self.covariances, "Gaussians: covariances", (k, 3, 3))
        masses = numbers(self.masses, "Gaussians: masses", (k,))
        return whole(self.degree, "Gaussians: degree", most=2**32 - 1), real(self.constant, "Gaussians: constant"), list(zip(means.tolist(), covariances.tolist(), masses.tolist()))


@dataclass(frozen=True, eq=False)
class Function:
    """A density that is a function, for :func:`transport` and :func:`lloyd` on the CPU.

    ``value`` is given points, (K, 3), thousands at once, and returns (K,) positive numbers; what it raises is raised. It is integrated over each cell by
    quadrature of that ``degree``, 0 to 31, and asked for in the whole box around a domain, up to half of its extent on every side, as by :meth:`Cells.integrate`. An image, interpolated
    linearly: ``scipy.interpolate.RegularGridInterpolator(axes, image, bounds_error=False, fill_value=None)``, whose kinks cost digits where voxels are smaller than cells.
    """

    value: Callable[[NDArray[np.float64]], Any]
    degree: int = 5

    def _given(self) -> tuple[int, Any]:
        if not callable(self.value):
            raise ValueError(f"Function: value: a function of points is needed, this is {self.value!r}")

        def column(points: NDArray[np.float64]) -> NDArray[np.float64]:
            found = evaluated(self.value, points)
            if found.size != len(points):
                raise ValueError(f"Function: for {len(points)} points it returned shape {found.shape}; one number for each is needed")
            return np.ascontiguousarray(found.reshape(-1, 1))

        return whole(self.degree, "Function: degree", most=2**32 - 1), column


@dataclass(frozen=True, eq=False, repr=False)
class Transport(ReadOnly):
    """What :func:`transport` came to."""

    weights: NDArray[np.float64]
    """The weights, (N,) (length squared); their mean is 0."""
    masses: NDArray[np.float64]
    """The masses of their cells, (N,)."""
    residual: float
    """Largest ``|mass / target - 1|``."""
    residuals: NDArray[np.float64]
    """The same at the start and after each step."""
    cost: float | None
    """The integral of ``density * |x - p|**2`` over all cells; none where a callback stopped it and the density is not 1."""
    end: str
    """``"converged"``, ``"iterations"`` (there were no more), ``"stalled"`` (no step makes the error smaller) or ``"stopped"`` (by the callback)."""
    reason: str | None
    """Which point's mass is farthest from the one asked for, and what stands in its way, where that can be shown; none where it converged."""
    cells: Cells
    """The cells of these weights."""
    _density: tuple[Any, ...] | None = None
    _scaled: NDArray[np.float64] | None = None

    @property
    def converged(self) -> bool:
        """Whether the residual is within the tolerance."""
        return self.end == "converged"

    def __repr__(self) -> str:
        return f"<laguerre.Transport of {len(self.weights)} points: {self.end}, {len(self.residuals) - 1} steps, residual {self.residual:.1e}>"

    def pullback(
        self, weights: ArrayLike | None = None, centroid: ArrayLike | None = None, cost: float = 0.0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The gradients of a function by points, (N, 3), and masses, (N,), through the solve, from those by ``weights``, (N,), centroids, (N, 3), and the ``cost``:
        what reverse differentiation asks for. Masses change so that their sum stays: their gradient sums to 0; with ``normalize`` they are those that were given, to which their gradient is
        orthogonal. With a ``density`` that is linear there is none
        by centroids, with :class:`Gaussians` and :class:`Function` none at all. It takes one diagram and one linear system."""
        if not self.converged:
            message = f"the residual is {self.residual:.1e} and not within the tolerance: these are gradients through the solve of the masses that it came to"
            warnings.warn(message, RuntimeWarning, stacklevel=2)
        given = self.cells._given
        n = len(given.points)
        by_points, by_masses = _laguerre.pull_back(
            given.backend,
            given.points,
            self.weights,
            inner(given.container),
            self._density,
            None if weights is None else numbers(weights, "weights", (n,)),
            None if centroid is None else numbers(centroid, "centroid", (n, 3)),
            real(cost, "cost"),
        )
        if self._scaled is not None:
            # m T / sum(m) is what was solved for.
            of_all = self._scaled.sum()
            by_masses = (self.masses.sum() / of_all) * (by_masses - (by_masses @ self._scaled) / of_all)
        return by_points, by_masses


def lloyd(
    points: ArrayLike,
    *,
    domain: Container = None,
    weights: ArrayLike | None = None,
    density: tuple[float, ArrayLike] | Gaussians | Function | None = None,
    method: str = "lbfgs",
    iterations: int = 100,
    tolerance: float = 1e-3,
    callback: Callable[[dict[str, Any]], Any] | None = None,
    **options: Any,
) -> Relaxation:
    """Moves points, (N, 3), down the energy of centroidal tessellations, by ``"lbfgs"`` or by Lloyd's own steps (``"lloyd"``), until their mean distance from the
    centroids is at most ``tolerance`` times the mean cell's size, or there are no more ``iterations``.

    With a ``density``, as of :func:`transport`, points go to centroids of mass, and crowd where it is high.
    ``callback`` is given ``energy``, ``gradient`` and ``evaluations`` (diagrams so far), and ``points`` and ``weights``, after each iteration, the start
    included; a true answer ends it with what there is. ``options`` are those of :class:`Diagram`.
    """
    iterations = check(iterations, callback, options, "lloyd")
    tolerance = real(tolerance, "tolerance")
    given = Diagram(points, weights, domain=domain, **options)._given
    found = _laguerre.lloyd(
        given.backend, given.points, given.weights, inner(given.container), plain(density), method, iterations, tolerance, callback
    )
    cells = freeze(found).pop("cells")
    given = Given(found["points"], given.weights, given.container, given.backend)
    return Relaxation(cells=Cells(given, cells), **found)


def transport(
    points: ArrayLike,
    *,
    domain: Container = None,
    masses: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    density: tuple[float, ArrayLike] | Gaussians | Function | None = None,
    iterations: int = 100,
    tolerance: float = 1e-9,
    normalize: bool = False,
    facets: bool = False,
    callback: Callable[[dict[str, Any]], Any] | None = None,
    **options: Any,
) -> Transport:
    """Weights for cells of the ``masses``, (N,), asked for (all equal without): semi-discrete optimal transport, by a damped Newton method.

    ``points`` are (N, 3). It ends where the largest ``|mass / target - 1|`` is at most ``tolerance``. ``weights``, (N,), are where it starts. ``density`` is ``(value, gradient)`` for ``value + gradient . x``, :class:`Gaussians` or :class:`Function`; without, it is 1. The masses have to sum to the
    domain's; with ``normalize`` they are scaled so that they do, and ``Transport.masses`` are those of the domain.
    ``callback`` is given ``step``, ``residual`` and ``fraction`` (of the Newton step that was gone), and ``points`` and ``weights``, after each step, the
    start included; a true answer ends it with what there is. With ``facets`` its cells have facets, which takes one more diagram. ``options`` are those of :class:`Diagram`.
    """
    iterations = check(iterations, callback, options, "transport")
    tolerance = real(tolerance, "tolerance")
    given = Diagram(points, weights, domain=domain, **options)._given
    wanted = None if masses is None else numbers(masses, "masses", (len(given.points),))
    rho = plain(density)
    found = _laguerre.transport(
        given.backend, given.points, given.weights, inner(given.container), wanted, rho, iterations, tolerance, normalize, facets, callback
    )
    cells = freeze(found).pop("cells")
    given = Given(given.points, found["weights"], given.container, given.backend)
    scaled = wanted.copy() if normalize and wanted is not None else None
    return Transport(cells=Cells(given, cells), _density=rho, _scaled=scaled, **found)


def plain(density: tuple[float, ArrayLike] | Gaussians | Function | None) -> tuple[Any, ...] | None:
    """A density as the extension takes it."""
    if density is None:
        return None
    if isinstance(density, (Gaussians, Function)):
        return density._given()
    if not isinstance(density, (tuple, list)) or len(density) != 2:
        raise ValueError("density: (value, gradient), Gaussians(...) or Function(f) is needed")
    return (real(density[0], "density: value"), numbers(density[1], "density's gradient", (3,)).tolist())


def refuse_density(options: dict[str, Any]) -> None:
    """Centroids have no derivative by points with a density that is linear."""
    if options.get("density") is not None:
        raise ValueError("density: differentiable transport has none but the domain's own: Domain.image, Domain.tetrahedra")


def solved(points: Any, masses: Any, options: dict[str, Any]) -> Transport:
    """A transport that is to be differentiated: it has converged."""
    found = transport(points, masses=masses, **options)
    if not found.converged:
        raise ValueError(f"the residual is {found.residual:.1e} and not within the tolerance ({found.end}): {found.reason}")
    return found


def check(count: Any, callback: Any, options: dict[str, Any], of: str, what: str = "iterations") -> int:
    """Refuses what no solver can take; how many iterations there are to be at most."""
    refuse_unknown(options, of)
    if callback is not None and not callable(callback):
        raise ValueError(f"callback: a function is needed, this is {callback!r}")
    return whole(count, what)
