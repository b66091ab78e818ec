"""Solvers and their callbacks; interrupts."""

import json
import os
import re
import signal
import threading
import time

import numpy as np
import pytest

import laguerre as lg

CUBE = lg.Box([0, 0, 0], [1, 1, 1])


def white(n, seed=1):
    return np.random.default_rng(seed).random((n, 3))


def test_lloyd_lowers_the_energy():
    seen = []
    relaxed = lg.lloyd(white(200), domain=CUBE, iterations=5, tolerance=0, callback=seen.append)
    assert [told["energy"] for told in seen] == relaxed.energy.tolist()
    assert len(relaxed.energy) == 6 and np.all(np.diff(relaxed.energy) <= 0) and relaxed.end == "iterations"
    assert np.array_equal(relaxed.cells.volume, lg.cells(relaxed.points, domain=CUBE).volume)


def test_a_run_is_a_page(tmp_path):
    relaxing, moving = [], []
    relaxed = lg.lloyd(white(30), domain=CUBE, iterations=3, tolerance=0, callback=relaxing.append)
    assert np.array_equal(relaxing[0]["points"], white(30)) and np.array_equal(relaxing[-1]["points"], relaxed.points)
    solved = lg.transport(white(30), domain=CUBE, callback=moving.append)
    assert np.array_equal(moving[-1]["weights"], solved.weights) and np.array_equal(moving[0]["points"], white(30))
    flowing = []
    lg.fluid(**lg.scene("beltrami", 27), steps=2, callback=flowing.append)
    for name, states in (("lloyd", relaxing), ("transport", moving), ("fluid", flowing)):
        lg.page(tmp_path / f"{name}.html", states, domain=CUBE)
        page = (tmp_path / f"{name}.html").read_text()
        assert page.count('id="block-') == len(states) and ("speed" in page) >= (name == "fluid")
        drawn = {"lloyd": "gradient", "transport": "residual", "fluid": "kinetic"}[name]
        plot = json.loads(re.search(r'<script[^>]*id="meta"[^>]*>(.*?)</script>', page, re.DOTALL)[1])["plot"]
        assert plot["values"] == [state[drawn] for state in states] and plot["y"].startswith(drawn)


def test_without_a_domain_the_box_stays():
    points = white(100)
    relaxed = lg.lloyd(points, iterations=10, tolerance=0)
    box = np.prod(np.ptp(points, axis=0))
    assert relaxed.cells.volume.sum() == pytest.approx(box, abs=1e-14)
    again = lg.cells(relaxed.points, domain=lg.Box(points.min(0), points.max(0)))
    assert np.array_equal(relaxed.cells.volume, again.volume)
    assert np.array_equal(relaxed.cells.mass_jacobian_points().toarray(), again.mass_jacobian_points().toarray())


def test_functions_are_densities():
    from scipy.interpolate import RegularGridInterpolator

    points = white(60)
    at = np.linspace(0, 1, 3)
    # Linear between its places, and so the density 1 + 2 z.
    image = np.broadcast_to(1 + 2 * at, (3, 3, 3)).copy()
    calls = []

    def value(x):
        calls.append(len(x))
        return interpolated(x)

    interpolated = RegularGridInterpolator((at, at, at), image, bounds_error=False, fill_value=None)
    linear, function = (1.0, [0, 0, 2.0]), lg.Function(value, degree=3)
    one, other = (lg.transport(points, domain=CUBE, density=d, backend="cpu") for d in (linear, function))
    assert other.converged and other.weights == pytest.approx(one.weights, abs=1e-9) and other.cost == pytest.approx(one.cost)
    assert sum(calls) > 1000 * len(calls)
    one, other = (lg.lloyd(points, domain=CUBE, density=d, iterations=3, tolerance=0, backend="cpu") for d in (linear, function))
    assert other.points == pytest.approx(one.points, abs=1e-9) and other.masses == pytest.approx(one.masses, rel=1e-9)
    for solver in (lg.lloyd, lg.transport):
        with pytest.raises(ZeroDivisionError):
            solver(points, domain=CUBE, density=lg.Function(lambda x: 1 / 0), backend="cpu")
        with pytest.raises(ValueError, match="one number for each is needed"):
            solver(points, domain=CUBE, density=lg.Function(lambda x: np.ones((len(x), 2))), backend="cpu")
        with pytest.raises(ValueError, match=r"the density is -1 at \["):
            solver(points, domain=CUBE, density=lg.Function(lambda x: -np.ones(len(x))), backend="cpu")
    with pytest.raises(ValueError, match="a function of points is needed"):
        lg.lloyd(points, density=lg.Function(3.0))
    with pytest.raises(ValueError, match="degree"):
        lg.lloyd(points, density=lg.Function(interpolated, degree=-1))


def test_transport_equalizes():
    points, masses = white(300), np.linspace(1, 2, 300)
    masses /= masses.sum()
    solved = lg.transport(points, domain=CUBE, masses=masses)
    assert solved.converged and solved.residual <= 1e-9
    assert solved.cells.volume == pytest.approx(masses, rel=1e-9)
    assert lg.cells(points, solved.weights, domain=CUBE).volume == pytest.approx(masses, rel=1e-9)
    again = lg.transport(points, domain=CUBE, masses=masses, weights=solved.weights)
    assert len(again.residuals) == 1 and again.cost == pytest.approx(solved.cost)
    scaled = lg.transport(points, domain=CUBE, masses=7 * masses, normalize=True)
    assert scaled.reason is None and scaled.masses == pytest.approx(masses, rel=2e-9)
    linear = lg.transport(points, domain=CUBE, density=(1.0, [0, 0, 2.0]))
    assert linear.masses == pytest.approx(np.full(300, 2 / 300), rel=1e-9)


def test_lloyd_heeds_a_density():
    points = white(60)
    plain = lg.lloyd(points, domain=CUBE, iterations=5, tolerance=0)
    twice = lg.lloyd(points, domain=CUBE, iterations=5, tolerance=0, density=(2.0, [0, 0, 0]))
    assert np.array_equal(plain.points, twice.points) and np.array_equal(2 * plain.energy, twice.energy)
    assert np.array_equal(plain.masses, plain.cells.volume)
    # Of 60 below the middle: half, or 0.5**1.6 of them; and where a peak is.
    low = lg.lloyd(points, domain=CUBE, density=(0.001, [0, 0, 1.0]))
    assert low.converged and low.masses.sum() == pytest.approx(0.501)
    assert 0.25 < np.mean(low.points[:, 2] < 0.5) < 0.42
    peak = lg.Gaussians([[0.2, 0.2, 0.2]], [0.2], [1.0], constant=0.01, degree=3)
    crowded = lg.lloyd(points, domain=CUBE, density=peak, tolerance=0.02, backend="cpu")
    assert crowded.converged and np.all(np.diff(crowded.energy) <= 1e-6 * crowded.energy[0])
    assert np.mean(np.all(crowded.points < 0.5, axis=1)) > 0.4
    with pytest.raises(ValueError, match="the density is -1"):
        lg.lloyd(points, domain=CUBE, density=(1.0, [0, 0, -2.0]))


def test_gaussians_are_transported():
    points = white(200)
    round_ = lg.Gaussians([[0.3, 0.5, 0.5], [0.8, 0.4, 0.6]], [0.2, 0.15], [2.0, 1.0], constant=0.5)
    found = lg.transport(points, domain=CUBE, density=round_, backend="cpu")
    assert found.converged and found.masses == pytest.approx(np.full(200, found.masses.mean()), rel=1e-8)
    # Cells are smaller where it is denser.
    at = np.array([0.3, 0.5, 0.5])
    near = np.linalg.norm(found.cells.centroid - at, axis=1) < 0.15
    assert found.cells.volume[near].mean() < 0.5 * found.cells.volume[~near].mean()
    whole = lg.Gaussians(round_.means, [np.eye(3) * 0.04, np.eye(3) * 0.15**2], round_.masses, constant=0.5)
    again = lg.transport(points, domain=CUBE, density=whole, backend="cpu")
    assert again.weights == pytest.approx(found.weights, abs=1e-12)
    with pytest.raises(ValueError, match="deviation 1 is 0.0"):
        lg.transport(points, domain=CUBE, density=lg.Gaussians([at, at], [0.1, 0.0], [1, 1]), backend="cpu")
    with pytest.raises(ValueError, match="Gaussian 1.*covariance"):
        lg.transport(points, domain=CUBE, density=lg.Gaussians([at, at], [np.eye(3), np.zeros((3, 3))], [1, 1]), backend="cpu")
    with pytest.raises(ValueError, match="means"):
        lg.transport(points, domain=CUBE, density=lg.Gaussians(at, [0.1], [1]), backend="cpu")
    with pytest.raises(ValueError, match="not for functions"):
        found.pullback(cost=1.0)


def test_what_transport_cannot_meet_is_named():
    near = np.array([[0.2, 0.3, 0.4], [0.7, 0.6, 0.5], [0.7 + 1e-15, 0.6, 0.5]])
    solved = lg.transport(near, domain=CUBE)
    assert solved.end == "stalled" and "between sites" in solved.reason
    short = lg.transport(white(30), domain=CUBE, iterations=1)
    assert short.end == "iterations" and " has the mass " in short.reason


@pytest.mark.parametrize("solve", [lg.transport, lambda *a, **o: lg.lloyd(*a, tolerance=0, **o)])
def test_a_callback_ends_a_solver(solve):
    calls = []

    def second(told):
        calls.append(told)
        return len(calls) == 2

    found = solve(white(300), domain=CUBE, callback=second)
    assert len(calls) == 2 and found.end == "stopped"
    assert found.cells.volume.sum() == pytest.approx(1, abs=1e-14)


def test_what_a_callback_raises_is_raised():
    def fails(told):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        lg.transport(white(100), domain=CUBE, callback=fails)


def test_ctrl_c_ends_the_work_and_others_go_on_meanwhile():
    ticks = []

    def ticking():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.01)

    done = threading.Event()
    thread = threading.Thread(target=ticking)
    thread.start()
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    start = time.perf_counter()
    try:
        with pytest.raises(KeyboardInterrupt):
            lg.lloyd(white(20_000), domain=CUBE, iterations=10**6, tolerance=0)
    finally:
        done.set()
        thread.join()
    assert time.perf_counter() - start < 30
    # Without the lock all others would have waited.
    assert len(ticks) > 10


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_ctrl_c_ends_the_writing_of_a_file(tmp_path):
    cells, path = lg.cells(white(5_000), domain=CUBE), tmp_path / "cells.csv"
    cells.save(path)
    whole = len(path.read_bytes())
    path.unlink()
    # A pipe, which has room for a part of it until it is read.
    os.mkfifo(path)
    read = []

    def reading():
        with open(path, "rb") as pipe:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.5)
            read.append(len(pipe.read()))

    thread = threading.Thread(target=reading)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        cells.save(path)
    thread.join()
    assert 0 < read[0] < whole


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_process_that_was_forked_opens_its_own_backend():
    diagram = lg.Diagram(white(50), domain=CUBE)
    volume = diagram.cells().volume
    child = os.fork()
    if child == 0:
        # No assertion ends a child of pytest: it says by its code what it found.
        code = 1
        try:
            diagram.cells()
        except RuntimeError as error:
            same = np.array_equal(lg.cells(white(50), domain=CUBE).volume, volume)
            code = 0 if "fork" in str(error) and same else 2
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.parametrize("call", [lg.devices, lambda: lg.cells(white(5), domain=CUBE, backend="ocl")])
def test_a_process_that_was_forked_is_told_that_it_has_no_opencl(call):
    # (After "auto" has come to what it comes to here, and after OpenCL was asked.)
    lg.Backend("auto")
    assert lg.devices() is not None
    child = os.fork()
    if child == 0:
        code = 1
        try:
            call()
        except RuntimeError as error:
            code = 0 if "before this process was forked" in str(error) else 2
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_options_that_are_not_known_are_named_with_their_function():
    for call in (lg.lloyd, lg.transport, lg.fluid, lambda p, **options: lg.page("a.html", [{"points": p}], **options)):
        with pytest.raises(TypeError, match=r"(lloyd|transport|fluid|page)\(\) got an unexpected keyword argument 'density_'"):
            call(white(3), domain=CUBE, density_=1)


def test_gradients_of_a_transport_that_did_not_converge_come_with_a_warning():
    with pytest.warns(RuntimeWarning, match="not within the tolerance"):
        lg.transport(white(30), domain=CUBE, iterations=1).pullback(weights=np.ones(30))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_process_that_was_forked_relaxes_many_sites():
    # So many that sums over them go to all threads, of which the child has but its backend's.
    points = white(10_000)
    masses = lg.lloyd(points, domain=CUBE, iterations=1).masses
    child = os.fork()
    if child == 0:
        code = 1
        try:
            code = 0 if np.array_equal(lg.lloyd(points, domain=CUBE, iterations=1).masses, masses) else 2
        finally:
            os._exit(code)
    for _ in range(600):
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            break
        time.sleep(0.1)
    else:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        pytest.fail("it waits for threads that it does not have")
    assert os.waitstatus_to_exitcode(status) == 0
