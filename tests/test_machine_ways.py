"""Machines from practice in every way of evaluating them: drives elsewhere, guided points, rows and
curves together.
"""

from dataclasses import replace

import numpy as np
import pytest
from design_rows import around, assert_refined
from exported import by_c99, compare, expected, exported, instants, solve
from machines import SCENES

from lagrange_casadi import derive, evaluate
from lagrange_casadi.base.status import Status
from lagrange_casadi.instants.evaluation_method import EvaluationMethod
from lagrange_casadi.studies.designs.engine import DesignEngine


@pytest.mark.sampled(19)
@pytest.mark.parametrize("name", SCENES)
def test_every_way_gives_the_same_within_its_errors(name):
    scene = SCENES[name]()
    exact = evaluate(scene, backend="vm")
    size = {}
    for quantity in exact.series:
        unit = exact.unit(quantity)
        size[unit] = max(size.get(unit, 0.0), np.abs(exact.array(quantity)).max())
    ways = [{"backend": "c"}, {"backend": "lanes"}, {"precision": "single"}]
    for way in ways if derive(scene).newton is None else [*ways, {"newton": 4}]:
        found = evaluate(scene, **way)
        assert found.certified, way
        for quantity in exact.series:
            gap = np.abs(found.array(quantity) - exact.array(quantity)).max()
            # An estimate is within a factor of ten; angles and places may be of next to nothing.
            assert (
                gap
                <= 10.0 * float(np.max(found.errors[quantity])) + 1e-13 * size[exact.unit(quantity)]
            ), (way, quantity)


@pytest.mark.sampled(13)
@pytest.mark.parametrize("name", SCENES)
def test_designs_have_the_peaks_of_the_api(name):
    """Of the cam some: a search looks at every one of its points."""
    scene = SCENES[name]()
    if name == "cam":
        scene = replace(scene, wanted=["effort", "output:contact_force"])
    for backend in ("c", "lanes"):
        designs, p = (
            DesignEngine.of(scene, t=(*scene.span, 97), method=EvaluationMethod(backend)),
            around(scene, 2),
        )
        outcome = designs.evaluate(p)
        assert outcome.status.tolist() == [Status.OK] * 2
        for row in range(2):
            assert_refined(scene, designs, outcome, row, p[row])


@pytest.mark.sampled(17)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", SCENES)
def test_exported_c_has_the_numbers_of_the_api(name, precision, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    compare(
        found, expected(scene, told, solution), told, made, solution, exact=precision == "double"
    )
