"""The laws of the fluid, as its solver states them, and that it is the program's."""

import json
import os
import signal
import subprocess
import threading

import numpy as np
import pytest

import laguerre as lg

CUBE = lg.Box(0, 1)
PROGRAM = os.environ.get("LAGUERRE_PROGRAM")


def test_volumes_stay_equal_and_energy_is_kept():
    flow = lg.fluid(**lg.scene("taylor-green", 216), steps=10)
    assert flow.steps == 10 and flow.end == "steps" and len(flow.time) == 11
    assert flow.residual.max() <= 1e-6 and flow.cells.volume == pytest.approx(np.full(216, 1 / 216), rel=1.1e-6)
    # Of a twentieth the integrator takes a part; a wrong force or a lost half of a step takes all of it.
    assert np.abs(flow.drift).max() < 0.02 * flow.kinetic.max()
    total = flow.kinetic + flow.spring + flow.potential
    assert total - total[0] == pytest.approx(flow.drift, abs=1e-12)
    assert np.array_equal(flow.cells.volume, lg.cells(flow.points, flow.weights, domain=CUBE).volume)
    mass = 1 / 216
    assert flow.kinetic[-1] == pytest.approx(0.5 * mass * (flow.velocities**2).sum(), rel=1e-12)


def test_heavy_fluid_sinks():
    scene = lg.scene("dam-break", 200)
    flow = lg.fluid(**scene, steps=10)
    heavy = flow.densities > 1
    assert flow.points[heavy, 1].mean() < scene["points"][heavy, 1].mean()
    assert flow.potential[-1] < flow.potential[0] and flow.kinetic[-1] > flow.kinetic[0]


def test_viscosity_takes_energy_and_no_momentum():
    # With springs too soft to be felt, and in a step too short to go anywhere, viscosity is all that acts.
    points = np.random.default_rng(1).random((50, 3))
    velocities = np.random.default_rng(2).standard_normal((50, 3))
    flow = lg.fluid(points, domain=CUBE, velocities=velocities, epsilon=1e6, viscosity=1e3, time_step=1e-6, steps=1)
    assert flow.kinetic[1] < 0.9 * flow.kinetic[0]
    assert flow.velocities.sum(axis=0) == pytest.approx(velocities.sum(axis=0), abs=1e-10)


def test_a_callback_is_told_all_and_stops():
    told = []
    flow = lg.fluid(**lg.scene("beltrami", 64), steps=9, callback=lambda t: told.append(t) or t["step"] == 2)
    assert [t["step"] for t in told] == [0, 1, 2] and flow.end == "stopped" and flow.steps == 2
    for name in ("time", "residual", "kinetic", "spring", "potential", "drift"):
        assert [t[name] for t in told] == getattr(flow, name).tolist()
    for name in ("points", "velocities", "weights"):
        assert np.array_equal(told[-1][name], getattr(flow, name)) and not np.array_equal(told[0][name], told[1][name])

    def fails(told):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        lg.fluid(**lg.scene("beltrami", 8), callback=fails)


def test_a_flow_goes_on_to_the_same_bits_on_any_number_of_threads():
    scene = {**lg.scene("taylor-green", 125), "viscosity": 1e-3}
    whole = lg.fluid(**scene, steps=5, threads=2)
    half = lg.fluid(**scene, steps=2, threads=1)
    assert np.abs(half.weight_rates).max() > 0
    on = lg.fluid(half, steps=3, threads=2)
    assert on.steps == 5 and on.time.tolist() == whole.time[2:].tolist()
    for name in ("points", "velocities", "weights", "weight_rates"):
        assert np.array_equal(getattr(on, name), getattr(whole, name)), name
    assert on.drift[-1] == whole.drift[-1] and on.residual[0] <= 1e-6


def test_any_particles_in_a_mesh():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    domain = lg.Domain(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    start = np.random.default_rng(3).dirichlet([1] * 4, 100)[:, 1:]
    points = lg.lloyd(start, domain=domain, iterations=10, tolerance=0).points
    flow = lg.fluid(points, domain=domain, densities=np.where(points[:, 1] > 0.25, 2.0, 1.0), gravity=[0, -1, 0], steps=3)
    assert flow.cells.volume == pytest.approx(np.full(100, domain.volume / 100), rel=1.1e-6) and flow.epsilon > 0
    snow = lg.scene("snow-globe", points, domain=domain)
    assert snow["shake"][2] == 2 and lg.fluid(**snow, steps=1).steps == 1


@pytest.mark.skipif(PROGRAM is None, reason="LAGUERRE_PROGRAM names no program")
def test_it_is_the_programs_to_the_last_bit(tmp_path):
    command = [PROGRAM, "fluid", "dam-break", "--particles", "150", "--steps", "4", "--checkpoint", "dam.fluid", "--backend", "cpu"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    header, rest = (tmp_path / "dam.fluid").read_bytes().split(b"\n", 1)
    n = json.loads(header)["particles"]
    # 14 numbers, the corners of the box, and before the checksum the state.
    numbers = np.frombuffer(rest[:-8], "<f8")[20:]
    flow = lg.fluid(**lg.scene("dam-break", 150), steps=4, backend="cpu")
    assert len(flow.points) == n and len(numbers) == 9 * n
    state = (flow.points, flow.velocities, flow.densities, flow.weights, flow.weight_rates)
    assert np.array_equal(numbers, np.concatenate([array.ravel() for array in state]))


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: lg.fluid(np.zeros((2, 2))), r"points: an array of shape \(N, 3\)"),
        (lambda: lg.fluid([[0.5] * 3] * 2, domain=CUBE, velocities=[0, 1, 2]), r"velocities: an array of shape \(2, 3\)"),
        (lambda: lg.fluid([[0.5] * 3, [0.2] * 3], domain=CUBE, densities=[1, 0]), "particle 1: density 0 is not a positive"),
        (lambda: lg.fluid([[0.5] * 3, [0.2] * 3], domain=CUBE, viscosity=-1), "viscosity -1e0: 0 or a positive number is needed"),
        (lambda: lg.fluid([[0.5] * 3, [9.0] * 3], domain=CUBE), "particle 1 is thrown far out"),
        (lambda: lg.fluid([[0.5] * 3], domain=CUBE, gravity=[1]), r"gravity: an array of shape \(3,\)"),
        (lambda: lg.fluid([[0.5] * 3], domain=CUBE, steps=-1), "steps: a whole number from 0"),
        (lambda: lg.fluid([[0.5] * 3], domain=CUBE, radii=[1]), "leave them out"),
        (lambda: lg.fluid(lg.fluid([[0.5] * 3], domain=CUBE, steps=0), gravity=[0, 0, 1]), "a Flow goes on with its own"),
        (lambda: lg.fluid([[0.4] * 3, [0.6] * 3], domain=CUBE, velocities=[[9e3] * 3] * 2, time_step=1.0), "step 1: particle 0 is thrown"),
        (lambda: lg.scene("dam"), "scene 'dam': one of 'rayleigh-taylor'"),
        (lambda: lg.scene("dam-break", 0), "points: a number from 1"),
        (lambda: lg.scene("beltrami", domain=CUBE), "leave domain out"),
        (lambda: lg.scene("snow-globe"), "give the points that fill it"),
        (lambda: lg.scene("snow-globe", [[0.5] * 3]), "give a domain"),
    ],
)
def test_what_is_wrong_is_said(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_ctrl_c_ends_it():
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        lg.fluid(**lg.scene("beltrami", 4000), steps=10**6)
