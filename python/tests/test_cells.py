"""The laws of cells, in NumPy."""

import concurrent.futures
import copy
import gzip
import os
import pickle
import time
import types

import numpy as np
import pytest

import laguerre as lg

CUBE = lg.Box([0, 0, 0], [1, 1, 1])
TETRAHEDRON = (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))


def white(n, seed=1):
    return np.random.default_rng(seed).random((n, 3))


@pytest.fixture(scope="module")
def thousand():
    weights = 1e-3 * np.random.default_rng(2).random(1000)
    return lg.cells(white(1000), weights, domain=CUBE, facets=True, second_moments=True)


def test_cells_fill_the_box(thousand):
    assert thousand.volume.sum() == pytest.approx(1, abs=1e-14)
    full = thousand.status == 0
    assert np.all((thousand.status == 1) == np.isnan(thousand.centroid[:, 0]))
    middle = (thousand.volume[full, None] * thousand.centroid[full]).sum(axis=0)
    assert middle == pytest.approx([0.5] * 3, abs=1e-13)


def test_cells_of_a_mesh_fill_it():
    domain = lg.Domain(*TETRAHEDRON)
    cells = lg.cells(white(500), domain=domain, facets=True)
    assert domain.volume == pytest.approx(1 / 6, abs=1e-16)
    assert cells.volume.sum() == pytest.approx(1 / 6, abs=1e-15)
    assert cells.boundary.area.sum() == pytest.approx(domain.area, abs=1e-13)
    assert domain.triangles.shape == (4, 3) and domain.vertices.shape == (4, 3)
    assert domain.centroid == pytest.approx([0.25] * 3) and domain.bounds[1] == pytest.approx([1, 1, 1])


def test_facets_close_their_cells(thousand):
    facets = thousand.facets
    site, points = facets.site(), thousand.points
    normal = (points[facets.neighbor] - points[site]) / facets.distance[:, None]
    closing = thousand.boundary.vector_area.copy()
    np.add.at(closing, site, facets.area[:, None] * normal)
    assert np.abs(closing).max() < 1e-13


def test_the_laplacian_is_one(thousand):
    matrix = thousand.laplacian()
    assert matrix.shape == (1000, 1000) and abs(matrix - matrix.T).max() == 0
    assert np.abs(matrix.sum(axis=1)).max() < 1e-12
    x = np.random.default_rng(3).standard_normal(1000)
    assert x @ (matrix @ x) >= 0
    assert thousand.adjacency().nnz == len(thousand.facets)
    alone = lg.cells(thousand.points, 1e-3 * np.random.default_rng(2).random(1000), domain=CUBE, laplacian=True)
    assert abs(alone.laplacian() - matrix).max() < 1e-14 and abs(alone.laplacian() - alone.laplacian().T).max() == 0
    assert alone.laplacian().has_sorted_indices and alone.mass_jacobian_weights().nnz == alone.laplacian().nnz
    with pytest.raises(ValueError, match="laplacian=True or facets=True"):
        lg.cells(thousand.points, domain=CUBE).laplacian()


@pytest.mark.parametrize("by", ["weights", "points"])
def test_jacobians_are_the_differences(by):
    points, weights = white(40, 5), 1e-3 * np.random.default_rng(6).random(40)
    diagram = lg.Diagram(points, weights, domain=lg.Domain(*TETRAHEDRON))
    cells = diagram.cells(facets=True)
    # A finite change of a random direction, central: the error is of its square.
    way = np.random.default_rng(7).standard_normal(weights.shape if by == "weights" else points.shape)
    step = 1e-6

    def moved(sign):
        change = sign * step * way
        args = (points, weights + change) if by == "weights" else (points + change, weights)
        moved = lg.cells(*args, domain=diagram.domain)
        return moved.volume, moved.volume[:, None] * np.nan_to_num(moved.centroid)

    (v, m), (u, l) = moved(1), moved(-1)
    of_mass = getattr(cells, f"mass_jacobian_{by}")() @ way.ravel()
    assert of_mass == pytest.approx((v - u) / (2 * step), abs=1e-6)
    of_centroid = (getattr(cells, f"centroid_jacobian_{by}")() @ way.ravel()).reshape(-1, 3)
    first = of_centroid * cells.volume[:, None] + np.nan_to_num(cells.centroid) * of_mass[:, None]
    assert first == pytest.approx((m - l) / (2 * step), abs=1e-6)


def test_polynomials_and_second_moments_agree(thousand):
    of_xx = lg.cells(thousand.points, thousand.weights, domain=CUBE, polynomial={(2, 0, 0): 1.0, (1, 1, 0): 2.0}).integral
    b, v = np.nan_to_num(thousand.centroid), thousand.volume
    second = thousand.second_moment
    assert np.array_equal(second, second.transpose(0, 2, 1))
    expected = second[:, 0, 0] + v * b[:, 0] ** 2 + 2 * (second[:, 0, 1] + v * b[:, 0] * b[:, 1])
    assert of_xx == pytest.approx(expected, abs=1e-16)


def test_functions_are_integrated_in_batches(thousand):
    sizes = []

    def cubic(x):
        sizes.append(len(x))
        return np.stack([x[:, 0] ** 2 * x[:, 1] - x[:, 2], np.ones(len(x))], axis=1)

    for domain in (CUBE, lg.Domain(*TETRAHEDRON)):
        exact = lg.cells(thousand.points, thousand.weights, domain=domain, polynomial={(2, 1, 0): 1.0, (0, 0, 1): -1.0})
        found = exact.integrate(cubic, 3)
        assert found.shape == (1000, 2)
        assert found[:, 0] == pytest.approx(exact.integral, abs=1e-15, rel=1e-12)
        assert found[:, 1] == pytest.approx(exact.volume, abs=1e-15, rel=1e-12)
        # One column alone, on any number of threads: the same bits.
        for threads in (1, 2):
            again = lg.cells(thousand.points, thousand.weights, domain=domain, threads=threads)
            assert np.array_equal(again.integrate(lambda x: cubic(x)[:, 0]), found[:, 0])
    assert max(sizes) > 10_000 and len(sizes) < 6 * 1000 / 50
    # What is no polynomial converges.
    smooth = [lg.cells(thousand.points, domain=CUBE).integrate(lambda x: np.exp(x.sum(axis=1)), degree).sum() for degree in (1, 7)]
    assert abs(smooth[0] / np.expm1(1.0) ** 3 - 1) < 1e-3 and smooth[1] == pytest.approx(np.expm1(1.0) ** 3, rel=1e-11)


def test_what_a_function_raises_is_raised():
    cells, calls = lg.cells(white(5000), domain=CUBE, threads=2), []

    def fails(x):
        calls.append(len(x))
        if len(calls) > 2:
            raise LookupError("enough")
        return x[:, 0]

    with pytest.raises(LookupError, match="enough"):
        cells.integrate(fails)
    # Another thread may have been calling it meanwhile.
    assert len(calls) <= 4


def test_radii_are_roots_of_weights():
    radii = 0.05 * np.random.default_rng(8).random(200)
    by_radii = lg.cells(white(200), radii=radii, domain=CUBE)
    assert np.array_equal(by_radii.volume, lg.cells(white(200), radii**2, domain=CUBE).volume)


def test_a_diagram_is_used_again():
    diagram = lg.Diagram(white(300), domain=CUBE, threads=1)
    first = diagram.cells(facets=True)
    diagram.set(white(300, 9))
    assert np.array_equal(diagram.cells().volume, lg.cells(white(300, 9), domain=CUBE).volume)
    # Cells stay those of their points, whatever becomes of the arrays that they were given in.
    assert np.array_equal(first.mass_jacobian_points().toarray(), lg.cells(white(300), domain=CUBE).mass_jacobian_points().toarray())


def test_arrays_that_change_afterwards_change_nothing():
    points, weights = white(100), 1e-3 * np.random.default_rng(2).random(100)
    box = lg.Box([0, 0, 0], [1, 1, 1])
    cells = lg.cells(points, weights, domain=box, facets=True)
    expected = lg.cells(points.copy(), weights.copy(), domain=CUBE).mass_jacobian_points().toarray()
    points += 0.05
    weights[:] = 0
    assert np.array_equal(cells.mass_jacobian_points().toarray(), expected)
    for array in (cells.volume, cells.centroid, cells.points, box.hi, cells.facets.area):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_what_nobody_can_write_to_is_not_copied():
    cells = lg.cells(white(100), domain=CUBE)
    again = lg.cells(cells.points, domain=CUBE)
    assert again.points is cells.points and np.array_equal(again.volume, cells.volume)
    constant = white(100)
    constant.flags.writeable = False
    assert lg.cells(constant, domain=CUBE).points is constant
    # Behind a view is an array that can be written to; and what is not in C order cannot be taken as it is.
    view = white(100)[:]
    view.flags.writeable = False
    assert lg.cells(view, domain=CUBE).points is not view
    assert lg.cells(np.asfortranarray(constant), domain=CUBE).points.flags.c_contiguous


def test_arrays_of_others_are_taken_by_dlpack():
    class Other:
        """An array that knows nothing of NumPy."""

        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **options):
            return self.array.__dlpack__(**options)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    class Old(Other):
        """One that does not say who else writes to it."""

        def __dlpack__(self, stream=None):
            return self.array.__dlpack__()

    class Busy(Other):
        def __dlpack__(self, **options):
            raise BufferError("it is on a device")

    points, weights = white(100), 1e-3 * white(100, 2)[:, 0]
    expected = lg.cells(points, weights, domain=CUBE).volume
    assert np.array_equal(lg.cells(Other(points), Other(weights), domain=CUBE).volume, expected)
    shared = points.copy()
    cells = lg.cells(Old(shared), domain=CUBE)
    shared[:] = 0.0
    assert np.array_equal(cells.points, points)
    with pytest.raises(ValueError, match="points: it is on a device: detach it and bring it to the host"):
        lg.cells(Busy(points), domain=CUBE)


def test_domains_diagrams_and_backends_are_pickled():
    domain = pickle.loads(pickle.dumps(lg.Domain(*TETRAHEDRON)))
    assert domain.volume == pytest.approx(1 / 6)
    diagram = lg.Diagram(white(50), domain=domain, threads=1)
    again = pickle.loads(pickle.dumps(diagram))
    assert again.backend.threads == 1
    assert np.array_equal(again.cells().volume, diagram.cells().volume)


def test_a_backend_is_opened_once():
    first, second = (lg.Diagram(white(5), domain=CUBE, threads=2) for _ in range(2))
    assert first.backend is second.backend and first.backend.threads == 2


def test_python_threads_share_domains_and_diagrams():
    # With Python's lock or without: what they share is constant, and each has the bits that it has alone.
    diagram = lg.Diagram(white(400), domain=lg.Domain(*TETRAHEDRON))

    def work(seed):
        other = lg.Diagram(white(400, seed), domain=diagram.domain)
        cells = diagram.cells(facets=True)
        return cells.volume, cells.pullback(cells.volume, cells.points)[0], other.cells().integrate(lambda x: x[:, 0] ** 2)

    alone = [work(seed) for seed in range(6)]
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        for together, expected in zip(pool.map(work, range(6)), alone):
            assert all(np.array_equal(a, b) for a, b in zip(together, expected))


def test_small_diagrams_do_not_wait():
    diagram = lg.Diagram(white(5), domain=CUBE, threads=1)
    times = []
    for _ in range(300):
        start = time.perf_counter()
        diagram.cells()
        times.append(time.perf_counter() - start)
    # Not a measure of speed: a missed wake-up would cost 50 ms in some per cent of the calls.
    assert np.quantile(times, 0.9) < 0.04


def test_other_layouts_are_taken():
    points = white(100)
    expected = lg.cells(points, domain=CUBE).volume
    for other in (np.asfortranarray(points), points.tolist(), np.repeat(points, 2, axis=0)[::2]):
        assert np.array_equal(lg.cells(other, domain=CUBE).volume, expected)
    assert lg.cells(points.astype("f4"), domain=CUBE).volume == pytest.approx(expected, abs=1e-6)


def test_the_faces_are_seen_in_pyvista():
    pytest.importorskip("pyvista")
    cells = lg.cells(white(50), domain=lg.Domain(*TETRAHEDRON), geometry=True)
    mesh = cells.to_pyvista()
    for site in np.flatnonzero(cells.volume):
        faces = mesh.extract_cells(mesh.cell_data["site"] == site).extract_surface(algorithm="dataset_surface")
        assert abs(faces.triangulate().volume) == pytest.approx(cells.volume[site], rel=1e-5)
    outside = mesh.extract_cells(mesh.cell_data["beyond"] == -1)
    assert outside.compute_cell_sizes().cell_data["Area"].sum() == pytest.approx(1.5 + 3**0.5 / 2, rel=1e-6)


def test_meshes_of_others_are_domains():
    pyvista = pytest.importorskip("pyvista")
    domain = lg.Domain(pyvista.Sphere())
    assert 0.4 < domain.volume < 0.53
    assert lg.cells(white(200) - 0.5, domain=domain).volume.sum() == pytest.approx(domain.volume, abs=1e-14)


def test_a_mesh_of_trimesh_is_a_domain():
    # (It is told by its attributes, which are what counts.)
    mesh = types.SimpleNamespace(vertices=TETRAHEDRON[0], faces=TETRAHEDRON[1])
    assert lg.Domain(mesh).volume == lg.Domain(*TETRAHEDRON).volume
    assert lg.cells(white(20), domain=mesh).volume.sum() == pytest.approx(1 / 6)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: lg.cells(np.zeros((3, 2))), r"points: an array of shape \(N, 3\)"),
        (lambda: lg.cells(white(3), [1.0], domain=CUBE), r"weights: an array of shape \(3,\) is needed"),
        (lambda: lg.cells(white(3), [1.0] * 3, radii=[1.0] * 3), "give one of them"),
        (lambda: lg.cells([[0, 0, float("nan")]], domain=CUBE), "site 0: coordinate NaN"),
        (lambda: lg.cells(white(3), radii=[1.0, -1.0, 0.0]), "that of point 1 is negative"),
        (lambda: lg.cells(white(3) + 1j), "real numbers are needed"),
        (lambda: lg.cells([["0", "1", "2"]]), "real numbers are needed"),
        (lambda: lg.cells(np.ma.masked_greater(white(3), 0.1)), "masked"),
        (lambda: lg.cells(np.zeros((0, 3))), "no sites"),
        (lambda: lg.cells(white(3), domain=lg.Box(1, 0)), "must be greater|is flat|minimum"),
        (lambda: lg.cells(white(3), domain=CUBE, epsilon=float("nan")), "epsilon NaN"),
        (lambda: lg.cells(white(3), domain=CUBE, polynomial={}), "terms are needed"),
        (lambda: lg.cells(white(3), domain=CUBE, polynomial="x^2"), "terms are needed"),
        (lambda: lg.cells(white(3), domain=CUBE, polynomial={(-1, 0, 0): 1.0}), "exponent: a whole number from 0"),
        (lambda: lg.cells(white(3), domain=CUBE, polynomial={(1, 0): 1.0}), "three exponents"),
        (lambda: lg.cells(white(3), domain=CUBE, epsilon="wide"), "epsilon: a number is needed"),
        (lambda: lg.cells(white(3), domain=CUBE, devices=0), r"as \[0\]; this is 0"),
        (lambda: lg.cells(white(3), domain=CUBE, devices=[-1]), "devices: a number from 0"),
        (lambda: lg.cells(white(3), domain=CUBE, devices=[]), "an empty list"),
        (lambda: lg.cells(white(3), domain=CUBE, backend=lg.Backend("cpu"), threads=2), "an open backend has its own"),
        (lambda: lg.cells(white(3), domain=(0, 1)), "PyVista or trimesh"),
        (lambda: lg.cells([[0.0, 0, 0]]), "the bounding box of one site is flat"),
        (lambda: lg.Domain(TETRAHEDRON[0], TETRAHEDRON[1][:3]), "the domain's surface is open"),
        (lambda: lg.Domain(TETRAHEDRON[0], TETRAHEDRON[1] - 1), "negative"),
        (lambda: lg.Domain(TETRAHEDRON[0], TETRAHEDRON[1] * 1.0), "integers"),
        (lambda: lg.Domain("cube"), "PyVista or trimesh"),
        (lambda: lg.cells(white(3), domain=CUBE).facets, "facets=True"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(3), "a function of points"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(lambda x: x[:, 0], 32), "degree 32 is beyond 31"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(lambda x: x[:, 0], 1.5), "degree: a whole number from 0 is needed, this is 1.5"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(lambda x: 1.0), r"it has to return \(1,\) or \(1, C\)"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(lambda x: x[:, :2] if len(x) > 1 else x), "for 1 point"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(lambda x: x[:, 0] * 1j), "real numbers are needed"),
        (lambda: lg.cells(white(3), domain=CUBE).integrate(lambda x: np.full(len(x), np.nan)), "is not finite"),
        (lambda: lg.cells(white(3), domain=CUBE).second_moment, "second_moments=True"),
        (lambda: lg.cells(white(3), domain=CUBE).to_pyvista(), "geometry=True"),
        (lambda: lg.cells(white(3), domain=CUBE, backend="gpu"), "'auto', 'cpu' or 'ocl'"),
        (lambda: lg.cells(white(3), domain=CUBE, backend="cpu", precision="f32"), "take 'ocl'"),
        (lambda: lg.cells(white(3), domain=CUBE, threads=0), "threads: a whole number from 1 is needed, this is 0"),
        (lambda: lg.lloyd(white(3), domain=CUBE, method="newton"), "'lbfgs' or 'lloyd'"),
        (lambda: lg.lloyd(white(3), domain=CUBE, iterations=-1), "a whole number from 0"),
        (lambda: lg.lloyd(white(3), domain=CUBE, iterations=10**30), "a whole number from 0"),
        (lambda: lg.lloyd(white(3), domain=CUBE, tolerance=-1.0), "tolerance -1"),
        (lambda: lg.page("none.html", []), "none is given"),
        (lambda: lg.page("none.html", [{"step": 0}]), "number 0 has no 'points'"),
        (lambda: lg.page("cells.csv", [{"points": white(3)}]), r"\.html"),
        (lambda: lg.page("cells.html", [{"points": white(3)}, {"points": white(2)}]), r"points: an array of shape \(3, 3\)"),
        (lambda: lg.lloyd(white(3), domain=CUBE, callback=3), "a function is needed"),
        (lambda: lg.transport(white(3), domain=CUBE, masses=[[1.0]] * 3), r"masses: an array of shape \(3,\)"),
        (lambda: lg.transport(white(3), domain=CUBE, masses=[1.0] * 3), "multiply each by"),
        (lambda: lg.transport(white(3), domain=CUBE, tolerance=float("nan")), "tolerance NaN"),
    ],
)
def test_what_is_wrong_is_said(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_cells_are_saved_in_the_programs_forms(thousand, tmp_path):
    thousand.save(tmp_path / "cells.csv")
    rows = np.loadtxt(tmp_path / "cells.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows[:, 1], thousand.volume) and np.array_equal(rows[:, 2:5], thousand.centroid, equal_nan=True)
    thousand.save(tmp_path / "cells.npz")
    with np.load(tmp_path / "cells.npz") as arrays:
        assert np.array_equal(arrays["volume"], thousand.volume) and np.array_equal(arrays["second_moment"], thousand.second_moment)
        assert np.array_equal(arrays["facets"], rows[:, 5])
    thousand.save(tmp_path / "cells.npy")
    assert np.array_equal(np.load(tmp_path / "cells.npy"), rows[:, 1:5], equal_nan=True)
    with pytest.raises(ValueError, match=r"cells\.xyz.*\.csv, \.npz, \.vtu"):
        thousand.save(tmp_path / "cells.xyz")
    for name in ("none/cells.csv", "none/cells.npy", "none/cells.npz"):
        with pytest.raises(FileNotFoundError, match="there is no folder"):
            thousand.save(tmp_path / name)
    assert {path.name for path in tmp_path.iterdir()} == {"cells.csv", "cells.npy", "cells.npz"}


def test_facets_are_saved_in_the_programs_forms(thousand, tmp_path):
    for ending in ("csv", "npy", "npz"):
        thousand.save_facets(tmp_path / f"facets.{ending}")
    rows = np.loadtxt(tmp_path / "facets.csv", delimiter=",", skiprows=1)
    assert np.array_equal(np.load(tmp_path / "facets.npy"), rows, equal_nan=True)
    with np.load(tmp_path / "facets.npz") as arrays:
        columns = ("site", "neighbor", "area", "barycenter", "distance")
        assert np.array_equal(np.column_stack([arrays[name] for name in columns]), rows, equal_nan=True)
        starts = arrays["offsets"]
        assert np.array_equal(np.repeat(np.arange(1000), np.diff(starts)), rows[:, 0])
    assert rows[rows[:, 1] < 0, 2].sum() == pytest.approx(thousand.boundary.area.sum())
    with pytest.raises(ValueError, match="unknown ending"):
        thousand.save_facets(tmp_path / "facets.xyz")


@pytest.mark.skipif(os.name != "posix", reason="modes and links are of Unix")
def test_what_is_saved_keeps_its_mode_and_follows_links(thousand, tmp_path):
    file, link = tmp_path / "cells.npz", tmp_path / "link.npz"
    file.touch(mode=0o600)
    link.symlink_to(file.name)
    thousand.save(link)
    assert link.is_symlink() and file.stat().st_mode & 0o777 == 0o600
    with np.load(file) as arrays:
        assert np.array_equal(arrays["volume"], thousand.volume)


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_copies_of_results_are_read_only(again):
    solved = lg.transport(white(30), domain=CUBE, facets=True, backend="cpu")
    other = again(solved)
    assert np.array_equal(other.weights, solved.weights)
    cells = other.cells
    arrays = (other.weights, other.residuals, cells.points, cells.volume, cells.status, cells.facets.area, again(cells.boundary).area)
    assert not any(array.flags.writeable for array in arrays)


def test_geometry_is_saved_whether_it_was_asked_for_or_not(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    domain = lg.Domain(*TETRAHEDRON)
    asked, not_asked = (lg.cells(white(50), domain=domain, geometry=geometry) for geometry in (True, False))
    for ending in (".vtu", ".vtp", ".ply", ".glb", ".html"):
        for cells in (asked, not_asked):
            cells.save(tmp_path / f"{cells is asked}{ending}")
        assert (tmp_path / f"True{ending}").read_bytes() == (tmp_path / f"False{ending}").read_bytes()
    assert pyvista.read(tmp_path / "True.vtp").n_cells == asked.to_pyvista().n_cells
    solids = pyvista.read(tmp_path / "True.vtu")
    assert np.array_equal(np.unique(solids.cell_data["volume"]), np.unique(asked.volume[asked.status == 0]))
    page = (tmp_path / "True.html").read_text()
    assert "<title>50 cells</title>" in page.replace("\n", "") and 'id="block-0"' in page


def test_domains_are_read_from_what_others_write(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    ball = pyvista.Icosphere(nsub=2)
    for ending in (".ply", ".stl", ".vtk", ".vtp"):
        ball.save(tmp_path / f"ball{ending}")
        with open(tmp_path / f"ball{ending}", "rb") as plain, gzip.open(tmp_path / f"ball{ending}.gz", "wb") as packed:
            packed.write(plain.read())
        for name in (f"ball{ending}", f"ball{ending}.gz"):
            assert lg.Domain.load(tmp_path / name).volume == pytest.approx(ball.volume, rel=1e-6)


def test_files_that_are_not_there_are_errors_of_the_system():
    with pytest.raises(FileNotFoundError, match=r"none\.off: cannot open"):
        lg.Domain.load("none.off")
    with pytest.raises(TypeError):
        lg.cells(white(3), domain=CUBE, facet=True)


def test_densities():
    random = np.random.default_rng(8)
    values = random.integers(0, 50, (3, 4, 2)).astype(float)
    image = lg.Domain.image(values, 0, [3, 2, 1])
    assert image.volume == pytest.approx(values.sum() / 4)
    points = random.random((30, 3)) * [3, 2, 1]
    cells = lg.cells(points, domain=image)
    assert cells.volume.sum() == pytest.approx(image.volume)
    assert np.array_equal(lg.cells(points, domain=pickle.loads(pickle.dumps(image))).volume, cells.volume)
    assert np.allclose(lg.cells(points, domain=lg.Domain.image(np.asfortranarray(values), 0, [3, 2, 1])).volume, cells.volume)
    assert lg.Domain.image(values).bounds[1].tolist() == [3, 4, 2]
    # Two tetrahedra, of which one is in both.
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    given = np.array([[0, 1, 2, 3], [1, 0, 2, 3]], dtype=np.uint32)
    both = lg.Domain.tetrahedra(corners, given, [1, 2])
    given[:] = 0
    assert both.volume == pytest.approx(0.5)
    assert pickle.loads(pickle.dumps(both)).volume == both.volume
    even = lg.transport(points, domain=image)
    assert np.allclose(even.masses, image.volume / 30, rtol=1e-8)
    with pytest.raises(ValueError, match="cells of a domain with a density have none"):
        lg.cells(points, domain=image, geometry=True)
    with pytest.raises(ValueError, match="number from 0"):
        lg.Domain.image(-values)
    with pytest.raises(ValueError, match=r"shape \(N, N, N\)"):
        lg.Domain.image(values[0])
    with pytest.raises(ValueError, match=r"shape \(T, 4\)"):
        lg.Domain.tetrahedra(corners, [[0, 1, 2]], [1])
    with pytest.raises(ValueError, match="65535 threads: from 1 to 4096 are needed"):
        lg.cells(points, domain=image, threads=65535)


def test_meshes_are_oriented():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    right = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    wrong = right.copy()
    wrong[1] = wrong[1, ::-1]
    assert lg.Domain(vertices, wrong).volume == lg.Domain(vertices, right).volume
    assert "not consistently oriented" in lg.Domain(vertices, wrong).notes[0]
    assert lg.Domain(vertices, right, orient=True).notes == []
