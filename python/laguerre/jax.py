"""Volumes and centroids of restricted cells, and optimal transport, as differentiable functions, for JAX."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ._cells import Cells
from ._diagram import Diagram
from ._solvers import refuse_density, solved


def cells(points: Any, weights: Any = None, **options: Any) -> tuple[jax.Array, jax.Array]:
    """Volumes, (N,), and centroids, (N, 3), of the cells of points, (N, 3), with weights, (N,); differentiable (backwards, once) with respect to both,
    under ``jit`` and ``vmap``, too.

    ``options`` are those of :class:`laguerre.Diagram`. They are computed in double precision on the host or by OpenCL, whatever the arrays' kind.
    Centroids of empty cells are NaN, and without a gradient.
    """
    points = _real(points)
    kind = points.dtype
    by_radii = options.pop("radii", None)
    if by_radii is not None:
        if weights is not None:
            raise ValueError("weights and radii: give one of them")
        weights = jnp.square(_real(by_radii))
    weights = jnp.zeros(points.shape[0], kind) if weights is None else _real(weights)

    def shapes(n: int) -> tuple[jax.ShapeDtypeStruct, jax.ShapeDtypeStruct]:
        return jax.ShapeDtypeStruct((n,), kind), jax.ShapeDtypeStruct((n, 3), kind)

    def evaluated(p: Any, w: Any, **what: Any) -> Cells:
        return Diagram(np.asarray(p), np.asarray(w), **options).cells(**what)

    def host(p: Any, w: Any) -> Any:
        found = evaluated(p, w)
        return found.volume.astype(kind), found.centroid.astype(kind)

    def host_back(p: Any, w: Any, volume: Any, centroid: Any) -> Any:
        by_points, by_weights = evaluated(p, w, facet_second_moments=True).pullback(np.asarray(volume), np.asarray(centroid))
        return by_weights.astype(kind), by_points.astype(kind)

    @jax.custom_vjp
    def function(p: jax.Array, w: jax.Array) -> Any:
        return jax.pure_callback(host, shapes(p.shape[0]), p, w, vmap_method="sequential")

    def forward(p: jax.Array, w: jax.Array) -> Any:
        return function(p, w), (p, w)

    def backward(kept: Any, bars: Any) -> Any:
        p, w = kept
        by_weights, by_points = jax.pure_callback(host_back, shapes(p.shape[0]), p, w, *bars, vmap_method="sequential")
        return by_points, by_weights.astype(w.dtype)

    function.defvjp(forward, backward)
    return function(points, weights)


def transport(points: Any, masses: Any = None, **options: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Weights, (N,), centroids, (N, 3), and cost of the optimal transport to points, (N, 3), with masses, (N,), all equal without; differentiable (backwards,
    once) with respect to both, through the solve.

    ``options`` are those of :func:`laguerre.transport`; the density is 1, or the domain's own. Masses change so that their sum stays: their gradient sums to 0 (with
    ``normalize``, they change as they will). The backward pass solves again, from the weights found.
    """
    refuse_density(options)
    points = _real(points)
    kind = points.dtype
    has_masses = masses is not None
    masses = _real(masses) if has_masses else jnp.zeros(points.shape[0], kind)

    # Where it starts, and who watches, is the first pass's alone.
    again = {name: value for name, value in options.items() if name not in ("radii", "callback")}

    def found(p: Any, m: Any, options: dict[str, Any]) -> Any:
        return solved(np.asarray(p), np.asarray(m) if has_masses else None, options)

    def host(p: Any, m: Any) -> Any:
        done = found(p, m, options)
        return done.weights.astype(kind), done.cells.centroid.astype(kind), np.asarray(done.cost, kind)

    def host_back(p: Any, m: Any, w: Any, *bars: Any) -> Any:
        by_weights, by_centroid, by_cost = (np.asarray(bar) for bar in bars)
        by_points, by_masses = found(p, m, {**again, "weights": np.asarray(w)}).pullback(by_weights, by_centroid, float(by_cost))
        return by_points.astype(kind), by_masses.astype(kind)

    @jax.custom_vjp
    def function(p: jax.Array, m: jax.Array) -> Any:
        n = p.shape[0]
        shapes = tuple(jax.ShapeDtypeStruct(shape, kind) for shape in ((n,), (n, 3), ()))
        return jax.pure_callback(host, shapes, p, m, vmap_method="sequential")

    def forward(p: jax.Array, m: jax.Array) -> Any:
        done = function(p, m)
        return done, (p, m, done[0])

    def backward(kept: Any, bars: Any) -> Any:
        p, m, w = kept
        n = p.shape[0]
        shapes = (jax.ShapeDtypeStruct((n, 3), kind), jax.ShapeDtypeStruct((n,), kind))
        by_points, by_masses = jax.pure_callback(host_back, shapes, p, m, w, *bars, vmap_method="sequential")
        return by_points, by_masses.astype(m.dtype) if has_masses else jnp.zeros_like(m)

    function.defvjp(forward, backward)
    return function(points, masses)


def _real(x: Any) -> jax.Array:
    """An array of real numbers, of which whole ones are the default kind: results have the points' kind."""
    x = jnp.asarray(x)
    return x if jnp.issubdtype(x.dtype, jnp.floating) else x.astype(float)
