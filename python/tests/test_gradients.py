"""Gradients in PyTorch and JAX against finite differences."""

import numpy as np
import pytest

import laguerre as lg

CUBE = lg.Box([0, 0, 0], [1, 1, 1])
N = 40


def inputs():
    random = np.random.default_rng(4)
    return random.random((N, 3)), 1e-3 * random.random(N), random.standard_normal(N), random.standard_normal((N, 3))


def value(points, weights, by_volume, by_centroid):
    cells = lg.cells(points, weights, domain=CUBE)
    return (cells.volume * by_volume).sum() + (cells.centroid * by_centroid).sum()


def check(by_points, by_weights):
    """A finite change along random directions, central."""
    points, weights, *by = inputs()
    random = np.random.default_rng(5)
    for _ in range(5):
        p, w = random.standard_normal(points.shape), random.standard_normal(weights.shape)
        step = 1e-6
        of_points = (value(points + step * p, weights, *by) - value(points - step * p, weights, *by)) / (2 * step)
        of_weights = (value(points, weights + step * w, *by) - value(points, weights - step * w, *by)) / (2 * step)
        assert (by_points * p).sum() == pytest.approx(of_points, rel=1e-6)
        assert (by_weights * w).sum() == pytest.approx(of_weights, rel=1e-6)


def test_torch():
    torch = pytest.importorskip("torch")
    import laguerre.torch

    points, weights, *by = (torch.tensor(x) for x in inputs())
    points.requires_grad_(), weights.requires_grad_()
    volume, centroid = laguerre.torch.cells(points, weights, domain=CUBE)
    assert np.array_equal(volume.detach(), lg.cells(points.detach(), weights.detach(), domain=CUBE).volume)
    ((volume * by[0]).sum() + (centroid * by[1]).sum()).backward()
    check(points.grad.numpy(), weights.grad.numpy())


def test_torch_refuses_what_would_be_wrong():
    torch = pytest.importorskip("torch")
    import laguerre.torch

    points = torch.tensor(inputs()[0], requires_grad=True)
    volume, centroid = laguerre.torch.cells(points, domain=CUBE)
    expected = torch.autograd.grad((centroid**2).sum(), points, retain_graph=True)[0]
    # What becomes of one output is nothing to the other.
    with torch.no_grad():
        volume.mul_(1000)
    assert torch.equal(torch.autograd.grad((centroid**2).sum(), points, retain_graph=True)[0], expected)
    first = torch.autograd.grad((centroid**2).sum(), points, create_graph=True)[0]
    with pytest.raises(RuntimeError, match="once_differentiable"):
        first.sum().backward()
    with torch.no_grad():
        points.add_(0.01)
    with pytest.raises(RuntimeError, match="modified by an inplace operation"):
        (centroid**2).sum().backward()


def test_jax():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import laguerre.jax

    points, weights, *by = (jax.numpy.asarray(x) for x in inputs())

    @jax.jit
    def function(points, weights):
        volume, centroid = laguerre.jax.cells(points, weights, domain=CUBE)
        return (volume * by[0]).sum() + (centroid * by[1]).sum()

    check(*map(np.asarray, jax.grad(function, argnums=(0, 1))(points, weights)))
    several = jax.vmap(lambda p: laguerre.jax.cells(p, domain=CUBE)[0])(jax.numpy.stack([points, 1 - points]))
    assert several == pytest.approx(np.stack([lg.cells(p, domain=CUBE).volume for p in (points, 1 - np.asarray(points))]))
