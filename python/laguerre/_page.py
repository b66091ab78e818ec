"""A page of a run, for a browser."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _laguerre
from ._arrays import numbers
from ._container import Container, inner
from ._diagram import Diagram, refuse_unknown

CURVES = ("kinetic", "gradient", "residual")
"""What states of a run may be told that is drawn as its curve: of a fluid the first, which has residuals, too."""


def page(
    path: str | os.PathLike[str],
    states: Sequence[Mapping[str, Any]],
    *,
    domain: Container = None,
    title: str = "Cells over time",
    **options: Any,
) -> None:
    """Writes a page, ``.html``, that shows the cells of a run in 3D over time, all in the one file.

    ``states`` are what callbacks of :func:`lloyd`, :func:`transport` and :func:`fluid` are told (``callback=states.append``), or other mappings with
    ``points`` and, if need be, ``weights``; ``step`` and ``time`` are their names, ``velocities`` colour them by speed, and the page has the curve of
    ``kinetic``, ``gradient`` or ``residual``, of which all have one. The cells of each are computed once more; of many some are taken, evenly, 100 at most, so that the page has no more than 200,000 cells in all, or two. ``options`` are those of :class:`Diagram`.
    """
    if not len(states):
        raise ValueError("states: none is given; gather them by callback=states.append")
    for row, state in enumerate(states):
        if not isinstance(state, Mapping) or "points" not in state:
            raise ValueError(f"states: number {row} has no 'points'; what callbacks are told has, gathered by callback=states.append")
    refuse_unknown(options, "page")
    given = Diagram(states[0]["points"], states[0].get("weights"), domain=domain, **options)._given
    count, has_speeds = len(given.points), all("velocities" in state for state in states)
    taken = []
    for row, state in enumerate(states):
        weights = state.get("weights")
        speeds = np.linalg.norm(numbers(state["velocities"], "velocities", (count, 3)), axis=1) if has_speeds else None
        label = f"step {int(state.get('step', row))}" + (f", time {state['time']:.4f}" if "time" in state else "")
        points = numbers(state["points"], "points", (count, 3))
        taken.append((label, points, None if weights is None else numbers(weights, "weights", (count,)), speeds))
    name = next((name for name in CURVES if all(name in state for state in states)), None)
    curve = None if name is None else (name, [float(state[name]) for state in states])
    _laguerre.page(given.backend, inner(given.container), taken, has_speeds, curve, title, path)
