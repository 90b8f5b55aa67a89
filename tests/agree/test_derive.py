"""Graphs are derived once: named by all that they come from, kept on disk, and the same when they
come back.
"""

import hashlib
import pickle
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from internals import Wanted, fingerprint, sources
from mechanisms import slider_crank
from outside import doubled
from places import FOLDERS

import lagrange_casadi
from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import PickleError
from lagrange_casadi.motion import Motion, expression, harmonic, polynomial, samples

pytestmark = pytest.mark.quick


def name_of(scene):
    return fingerprint(scene, Wanted.of(scene.mechanism, scene.wanted))


def test_a_second_process_derives_nothing(fresh_cache, tmp_path):
    first = evaluate(slider_crank(), backend="c")
    program = (
        f"import sys; sys.path[:0] = {FOLDERS!r}; from mechanisms import"
        " slider_crank;"
        " __import__('importlib').import_module('lagrange_casadi.equations.derive').assemble ="
        " None; from lagrange_casadi import evaluate; print(evaluate(slider_crank(),"
        " backend='c').effort('O').tobytes().hex())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert bytes.fromhex(done.stdout.strip()) == first.effort("O").tobytes()


def pendulum(
    length=0.5,
    mass=1.2,
    gravity=9.81,
    load=3.0,
    place=0.2,
    law=None,
    name="pendulum",
    wanted=("all",),
    **keywords,
):
    m = Mechanism(name)
    m.gravity = (0.0, -gravity, 0.0)
    k = m.parameter("k", 2.0, "N")
    arm = m.link("arm", length=length, mass=mass)
    pin = m.revolute("pin", m.ground, arm)
    m.force("push", arm.at(place), x=load * k * ca.sin(m.coordinate(pin)))
    return Scene(m, {"pin": law or polynomial(0.1, 2.0)}, wanted=wanted, **keywords)


UP = np.nextafter
CHANGES = [
    {"length": UP(0.5, 1)},
    {"mass": UP(1.2, 2)},
    {"gravity": UP(9.81, 10)},
    {"load": UP(3.0, 4)},
    {"place": UP(0.2, 1)},
    {"law": polynomial(0.1, UP(2.0, 3))},
    {"law": harmonic(0.1, 0.2, 0.3)},
    {"law": expression(lambda t: 0.1 + 2.0 * t * t)},
    {"law": samples([0, 1, 2, 3], [0, 1, 4, 2])},
    {"law": samples([0, 1, 2, 3], [0, 1, 4, UP(2.0, 3)])},
    {"name": "other"},
    {"wanted": ("effort",)},
    {"t": (UP(0.0, 1), 1.0, 101)},
    {"posture": {"arm": 0.3}},
]


def test_every_change_of_a_declaration_has_another_name():
    names = [name_of(pendulum()), *(name_of(pendulum(**change)) for change in CHANGES)]
    assert None not in names
    assert len(set(names)) == len(names)
    assert name_of(pendulum()) == names[0]


def test_what_is_asked_of_an_evaluation_has_no_part_in_the_name():
    assert name_of(pendulum(xi=(0, 1, 7), t=(0.0, 1.0, 3))) == name_of(pendulum())


def test_what_cannot_be_told_is_not_kept(fresh_cache):
    scene = pendulum()
    scene.mechanism.note = object()
    assert name_of(scene) is None
    derive(scene)
    assert not list(fresh_cache.glob("*.graph"))


def test_a_damaged_graph_is_derived_again_and_said(fresh_cache):
    first = evaluate(pendulum())
    (path,) = fresh_cache.glob("*.graph")
    whole = path.read_text()
    path.write_text(whole[:-20])
    with pytest.warns(UserWarning, match=r"the cached .*\.graph was damaged and is made again"):
        again = evaluate(pendulum())
    assert path.read_text() == whole
    assert np.array_equal(again.effort("pin"), first.effort("pin"))


def test_a_motion_by_a_callback_is_not_kept(fresh_cache):
    scene = pendulum(law=Motion(doubled))
    assert name_of(scene) is None
    for _ in range(2):
        assert (
            evaluate(scene, backend="vm", wanted=["motion"], certificate=False)
            .motion("pin")
            .value[-1]
            == 2.0
        )
    assert not list(fresh_cache.glob("*.graph"))
    with pytest.raises(
        PickleError, match=r"the scene of '.*' cannot be pickled: it calls a function"
    ):
        pickle.dumps(derive(scene, ["motion"]))


def test_the_code_that_derives_is_all_of_the_package():
    """A change anywhere may derive other graphs: none is believed to be as it was kept."""
    root = Path(lagrange_casadi.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    assert sources() == digest.hexdigest()
