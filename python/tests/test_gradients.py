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
    whole = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 1]])
    assert np.allclose(laguerre.jax.cells(whole, domain=lg.Box(-0.5, 1.5))[0], lg.cells(whole, domain=lg.Box(-0.5, 1.5)).volume)
    several = jax.vmap(lambda p: laguerre.jax.cells(p, domain=CUBE)[0])(jax.numpy.stack([points, 1 - points]))
    assert several == pytest.approx(np.stack([lg.cells(p, domain=CUBE).volume for p in (points, 1 - np.asarray(points))]))


def transported(points, masses, by, **options):
    found = lg.transport(points, domain=CUBE, masses=masses, tolerance=1e-13, **options)
    return (found.weights * by[0]).sum() + (found.cells.centroid * by[1]).sum() + by[2] * found.cost


def check_transport(gradients):
    """Likewise, of points and of masses whose sum stays, through the solve; ``gradients`` is given points, masses and the derivatives by the results."""
    points, _, by_weights, by_centroid = inputs()
    random = np.random.default_rng(6)
    masses = 0.5 + random.random(N)
    masses /= masses.sum()
    by = (by_weights, by_centroid, 0.7)
    by_points, by_masses = gradients(points, masses, by)
    for _ in range(3):
        p, m = random.standard_normal(points.shape), random.standard_normal(N) / N
        m -= m.mean()
        step = 1e-5
        of_points = (transported(points + step * p, masses, by) - transported(points - step * p, masses, by)) / (2 * step)
        of_masses = (transported(points, masses + step * m, by) - transported(points, masses - step * m, by)) / (2 * step)
        assert (by_points * p).sum() == pytest.approx(of_points, rel=1e-5)
        assert (by_masses * m).sum() == pytest.approx(of_masses, rel=1e-5)


def test_through_a_transport():
    def gradients(points, masses, by):
        by_points, by_masses = lg.transport(points, domain=CUBE, masses=masses, tolerance=1e-13).pullback(*by)
        assert abs(by_masses.sum()) < 1e-9
        return by_points, by_masses

    check_transport(gradients)
    found = lg.transport(inputs()[0], domain=CUBE)
    assert np.allclose(found.pullback(cost=1.0)[0], 2 / N * (inputs()[0] - found.cells.centroid), atol=1e-10)
    with pytest.raises(ValueError, match="centroid"):
        found.pullback(centroid=np.zeros((3, 3)))


def check_normalized(gradients):
    """Masses that are scaled change as they will."""
    points, _, by_weights, by_centroid = inputs()
    random = np.random.default_rng(7)
    masses = 3 + 2 * random.random(N)
    by = (by_weights, by_centroid, 0.7)
    by_masses = gradients(points, masses, by)[1]
    for _ in range(3):
        m, step = random.standard_normal(N), 1e-4
        of_masses = [transported(points, masses + s * m, by, normalize=True) for s in (step, -step)]
        assert (by_masses * m).sum() == pytest.approx((of_masses[0] - of_masses[1]) / (2 * step), rel=1e-5)
    assert abs(by_masses @ masses) < 1e-9


def test_through_masses_that_are_scaled():
    check_normalized(lambda points, masses, by: lg.transport(points, domain=CUBE, masses=masses, normalize=True, tolerance=1e-13).pullback(*by))


def test_torch_through_a_transport():
    torch = pytest.importorskip("torch")
    import laguerre.torch

    def gradients(*given):
        points, masses = (torch.tensor(x, requires_grad=True) for x in given[:2])
        weights, centroid, cost = laguerre.torch.transport(points, masses, domain=CUBE, tolerance=1e-13)
        by = given[2]
        ((weights * torch.tensor(by[0])).sum() + (centroid * torch.tensor(by[1])).sum() + by[2] * cost).backward()
        return points.grad.numpy(), masses.grad.numpy()

    check_transport(gradients)


def test_jax_through_a_transport():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import laguerre.jax

    def gradients(points, masses, by):
        def loss(p, m):
            weights, centroid, cost = laguerre.jax.transport(p, m, domain=CUBE, tolerance=1e-13)
            return (weights * by[0]).sum() + (centroid * by[1]).sum() + by[2] * cost

        return tuple(np.asarray(x) for x in jax.grad(loss, argnums=(0, 1))(points, masses))

    check_transport(gradients)
    # A start by radii is the first pass's alone.
    loss = lambda p: laguerre.jax.transport(p, domain=CUBE, radii=np.full(N, 0.1))[2]
    assert np.allclose(jax.grad(loss)(inputs()[0]), lg.transport(inputs()[0], domain=CUBE).pullback(cost=1.0)[0], atol=1e-9)
    with pytest.raises(ValueError, match="Domain.image"):
        laguerre.jax.transport(inputs()[0], domain=CUBE, density=(1.0, [0, 0, 0]))
