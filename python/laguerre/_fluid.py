"""Incompressible fluid by power particles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre
from ._arrays import ReadOnly, freeze, frozen, numbers, real, whole
from ._cells import Cells, Given
from ._container import Box, Container, inner, taken
from ._diagram import Diagram
from ._solvers import check

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Flow(ReadOnly):
    """What :func:`fluid` came to, which it goes on from when it is given in the place of points."""

    points: NDArray[np.float64]
    """The particles, (N, 3) (length)."""
    velocities: NDArray[np.float64]
    """Their velocities, (N, 3) (length/time)."""
    densities: NDArray[np.float64]
    """Their densities, (N,)."""
    weights: NDArray[np.float64]
    """The weights of the cells of equal volume, (N,) (length squared)."""
    weight_rates: NDArray[np.float64]
    """How fast they changed in the last step, (N,) (length squared/time)."""
    steps: int
    """Steps so far, those included that were before it was given."""
    epsilon: float
    """The time scale of the springs."""
    time: NDArray[np.float64]
    """The time at the start and after each of the S steps, (S + 1,), as all that follows."""
    residual: NDArray[np.float64]
    """Largest relative error of a volume."""
    kinetic: NDArray[np.float64]
    """The kinetic energy (mass length squared/time squared), as the other energies."""
    spring: NDArray[np.float64]
    """The energy of the springs: cells of equal volume have more than none."""
    potential: NDArray[np.float64]
    """The energy of gravity on what is heavier or lighter than the mean."""
    drift: NDArray[np.float64]
    """How far the sum of the three is from what it was at the start, less what gravity's change brought in and viscosity took out."""
    end: str
    """``"steps"`` (there were no more) or ``"stopped"`` (by the callback)."""
    cells: Cells
    """The cells of these points and weights, with facets."""
    _settings: dict[str, Any]
    _at_start: tuple[float, float]

    def __repr__(self) -> str:
        return f"<laguerre.Flow of {len(self.points)} particles: {self.end}, {self.steps} steps, time {self.time[-1]:g}>"


def fluid(
    points: ArrayLike | Flow,
    *,
    domain: Container = None,
    velocities: ArrayLike | None = None,
    densities: ArrayLike | None = None,
    epsilon: float | None = None,
    viscosity: float | None = None,
    gravity: ArrayLike | None = None,
    shake: tuple[ArrayLike, float, float] | None = None,
    time_step: float | None = None,
    steps: int = 100,
    callback: Callable[[dict[str, Any]], Any] | None = None,
    **options: Any,
) -> Flow:
    """Steps of an incompressible fluid that fills its container: each particle has a cell of the same volume, to 1e-6, and a spring to its centroid.

    ``velocities`` are (N, 3) (length/time; at rest without), ``densities`` (N,) (1 without), ``viscosity`` is kinematic (length squared/time; 0 without),
    ``gravity`` (3,) (length/time squared; none without); ``shake`` adds to it ``(acceleration, period, swings)``, a sine from time 0. ``epsilon`` is the time
    scale of the springs; without, one by which gravity and speed stretch them by a quarter of a cell, or by 0.08 of it where densities differ.
    ``time_step`` follows springs and the fastest particle where it is not given. Points that are not spread evenly have much energy in their springs:
    begin from those of :func:`lloyd`, or of :func:`scene`. A :class:`Flow` in the place of ``points`` goes on, with its domain and settings, to the bits
    of one that was not interrupted.

    ``callback`` is given ``step``, ``time``, ``residual``, ``kinetic``, ``spring``, ``potential`` and ``drift`` as :class:`Flow` has them, and ``points``,
    ``velocities`` and ``weights`` (copies that are its own) after each step, the start included; a true answer ends it with what there is. ``options`` are
    those of :class:`Diagram`, but for ``radii``: the weights are found.
    """
    steps = check(steps, callback, options, "fluid", "steps")
    if "radii" in options:
        raise ValueError("radii: a fluid finds its weights; leave them out")
    before: tuple[Any, ...] | None = None
    settings: dict[str, Any]
    if isinstance(points, Flow):
        own = (domain, velocities, densities, epsilon, viscosity, gravity, shake, time_step)
        if any(setting is not None for setting in own):
            raise ValueError("a Flow goes on with its own domain, velocities, densities and settings: give steps, callback and where to compute alone")
        flow = points
        before = (flow.steps, float(flow.time[-1]), flow.weights, flow.weight_rates, *flow._at_start)
        given = Diagram(flow.points, domain=flow.cells.domain, **(options or {"backend": flow.cells._given.backend}))._given
        speeds, densities, settings = flow.velocities, flow.densities, flow._settings
    else:
        given = Diagram(points, domain=domain, **options)._given
        count = len(given.points)
        speeds = frozen(np.zeros((count, 3))) if velocities is None else numbers(velocities, "velocities", (count, 3))
        densities = frozen(np.ones(count)) if densities is None else numbers(densities, "densities", (count,))
        settings = {
            "epsilon": None if epsilon is None else real(epsilon, "epsilon"),
            "viscosity": 0.0 if viscosity is None else real(viscosity, "viscosity"),
            "gravity": _vector(gravity, "gravity"),
            "shake": None if shake is None else _shake(shake),
            "time_step": None if time_step is None else real(time_step, "time_step"),
        }
    found = _laguerre.fluid(
        given.backend, given.points, inner(given.container), speeds, densities, before=before, steps=steps, callback=callback, **settings
    )
    cells = freeze(found).pop("cells")
    given = Given(found["points"], found["weights"], given.container, given.backend)
    return Flow(cells=Cells(given, cells), _settings={**settings, "epsilon": found["epsilon"]}, **found)


def scene(name: str, points: int | ArrayLike = 10_000, *, domain: Container = None, gravity: float | None = None) -> dict[str, Any]:
    """A fluid to begin with, as the program's ``laguerre fluid`` has it: the arguments of :func:`fluid`, for ``fluid(**scene("dam-break", 2_000))``.

    ``name`` is ``"rayleigh-taylor"`` (heavy fluid over light), ``"dam-break"`` (heavy fluid at one side, let go), ``"taylor-green"`` or ``"beltrami"``
    (vortices in the unit cube) or ``"snow-globe"`` (snow in a shaken globe, which needs a ``domain``). ``points`` is the number of particles, or as near to
    it as a lattice comes in the scene's box; of a ``domain`` they are (N, 3), evenly spread in it, as those of :func:`lloyd`. ``gravity`` is downwards, to
    -y (length/time squared); without, half of the container's height is fallen through in a unit of time.
    """
    count, centers, container = 0, None, None
    if isinstance(points, (int, np.integer)):
        count = whole(points, "points", "a number from 1 to 4,294,967,295", 1, 2**32 - 1)
        container = None if domain is None else taken(domain, np.zeros((0, 3)))
    else:
        centers = numbers(points, "points", (None, 3))
        container = None if domain is None else taken(domain, centers)
    found = freeze(_laguerre.scene(name, count, centers, inner(container), gravity))
    extent = found.pop("extent")
    return {"domain": container if container is not None else Box(0, extent), **found}


def _shake(shake: Any) -> tuple[list[float], float, float]:
    if not isinstance(shake, (tuple, list)) or len(shake) != 3:
        raise ValueError(f"shake: (acceleration, period, swings) is needed, as ((1, 0, 0), 0.5, 2); this is {shake!r}")
    return _vector(shake[0], "shake"), real(shake[1], "shake: period"), real(shake[2], "shake: swings")


def _vector(values: Any, what: str) -> list[float]:
    return [0.0] * 3 if values is None else numbers(values, what, (3,)).tolist()
