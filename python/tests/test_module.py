"""The module by itself: what importing it takes, and what it offers."""

import ast
import doctest
import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import laguerre as lg


def test_importing_it_does_not_import_numpy():
    # NumPy alone takes longer than the 0.1 s that an import may.
    code = "import sys, laguerre; print('numpy' in sys.modules, laguerre.Box(0, 1), 'numpy' in sys.modules)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told == "False laguerre.Box([0.0, 0.0, 0.0], [1.0, 1.0, 1.0]) True\n"


def test_its_names_are_there_when_they_are_asked_for():
    assert sorted(dir(lg)) == sorted(lg.__all__) == sorted(["__version__", *(name for names in lg._MODULES.values() for name in names)])
    names = {}
    exec("from laguerre import *", names)
    assert all(names[name] is getattr(lg, name) for name in lg.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'cell'"):
        lg.cell


def is_member(value):
    return inspect.isfunction(value) or inspect.isgetsetdescriptor(value) or isinstance(value, (property, classmethod, staticmethod))


@pytest.mark.parametrize("name", [name for name in lg.__all__ if name != "__version__"])
def test_what_it_offers_is_documented(name):
    offered = getattr(lg, name)
    assert offered.__doc__, name
    for member, value in vars(offered).items() if inspect.isclass(offered) else ():
        if not member.startswith("_") and is_member(value):
            assert inspect.getdoc(getattr(offered, member)), f"{name}.{member}"


def test_results_are_told_in_one_line():
    pytest.importorskip("scipy")
    points, box = np.random.default_rng(1).random((200, 3)), lg.Box(0, 1)
    cells = lg.cells(points, domain=box, facets=True, second_moments=True, facet_second_moments=True)
    results = [
        box, lg.Domain.image(np.ones((1, 1, 1))), cells, cells.facets, cells.boundary,
        lg.transport(points, domain=box), lg.lloyd(points, domain=box, iterations=2), lg.fluid(points, domain=box, steps=1),
    ]  # fmt: skip
    for result in results:
        assert type(result).__name__ in repr(result) and "\n" not in repr(result) and len(repr(result)) < 120
    for moments in (cells.second_moment, cells.facets.second_moment):
        assert moments.flags.c_contiguous and not moments.flags.writeable
    assert {matrix.indices.dtype for matrix in (cells.laplacian(), cells.adjacency(), cells.mass_jacobian_points())} == {np.dtype(np.int32)}


def test_the_first_example_is_as_it_says():
    example = next(iter(doctest.DocTestFinder().find(lg.cells, "cells", globs={"laguerre": lg})))
    assert doctest.DocTestRunner().run(example) == (0, 1)


@pytest.mark.parametrize("example", sorted((Path(__file__).parents[1] / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_examples_take_ten_lines(example):
    code = ast.parse(example.read_text()).body[1:]
    lines = example.read_text().splitlines()[code[0].lineno - 1 :]
    assert sum(bool(line.strip()) for line in lines) <= 10
