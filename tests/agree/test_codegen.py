"""The emitted C: pedantically clean, the same text in every process, and the same bits whatever
optimizes it, however many threads run it, and whatever stands beside an instant.
"""

import itertools

import numpy as np
import pytest
from compiled import PEDANTIC, STRICT
from design_rows import DENSITIES, loaded
from internals import backends, library
from mechanisms import (
    crank_and_rod,
    every_function,
    four_bar,
    slider_crank,
    spline_arm,
    truss_platform,
)

from lagrange_casadi import Mechanism, Scene, derive, evaluate, load_case, motion, prepare
from lagrange_casadi.errors import SizeError

SCENES = {
    "slider_crank": slider_crank,
    "effort_alone": lambda: slider_crank(wanted=["effort"]),
    "four_bar": four_bar,
    "iterated": truss_platform,
    "spline": spline_arm,
}
PRECISIONS = ("double", "single")
BACKENDS = ("c", "lanes")
WHOLE = SCENES | {
    "functions": every_function,
    "stations": lambda: crank_and_rod(DENSITIES["table"](), loads=loaded),
    "sleigh": lambda: load_case("sleigh").scene,
}


@pytest.mark.quick
@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", WHOLE)
def test_emitted_c_is_pedantically_clean(name):
    """What evaluates instants, and what finishes designs as well; of instants in singles no double
    is meant, and none comes in by a promotion.
    """
    scene = WHOLE[name]()
    steps = (None, 2) if derive(scene).newton is not None else (None,)
    for precision, newton in itertools.product(PRECISIONS, steps):
        method = {"backend": "c", "precision": precision, "newton": newton}
        flags = " ".join(STRICT if precision == "single" else PEDANTIC)
        evaluate(scene, **method, flags=flags, certificate=False)
        prepare(scene, **method, flags=" ".join(PEDANTIC)).peaks()


STEP = 2.0**-18


@pytest.fixture
def unwritten(monkeypatch):
    """Columns are NaN before they are evaluated."""
    empty = backends.rows

    def rows(*size):
        out = empty(*size)
        out[...] = np.nan
        return out

    monkeypatch.setattr(backends, "rows", rows)


def series(scene, count, first=0, **method):
    """The bits of all series at so many instants; none is left as it was."""
    t = (first * STEP, (first + count - 1) * STEP, count)
    found = evaluate(scene, t=t, **method, certificate=False).series
    assert all(np.isfinite(values).all() for values in found.values())
    return np.array([*found.values()])


@pytest.mark.quick
@pytest.mark.usefixtures("released", "unwritten")
@pytest.mark.sampled(19)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", SCENES)
def test_the_bits_are_those_of_the_instant_alone(name, backend, precision, monkeypatch):
    """None depends on the optimization, the threads, or the tail."""
    scene, method = SCENES[name](), {"backend": backend, "precision": precision}
    whole = series(scene, 80, **method)
    for level in ("-O1", "-O0"):
        assert series(scene, 80, flags=level, **method).tobytes() == whole.tobytes()
    for n in (*range(1, 19), 63, 64, 65, 72, 79):
        assert np.array_equal(series(scene, n, **method), whole[:, :n])
    monkeypatch.setattr(library, "_WORTH_A_THREAD", 0)
    for threads in (2, 3, 5):
        assert series(scene, 80, threads=threads, **method).tobytes() == whole.tobytes()


@pytest.mark.usefixtures("released", "unwritten")
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("backend", BACKENDS)
def test_columns_that_go_past_the_caches_have_the_same_bits(backend, precision):
    """Rows that begin with a line of the cache are streamed where they are large."""
    scene = slider_crank(["effort", "reaction", "section"])
    method = {"backend": backend, "precision": precision, "threads": 1}
    size = len(derive(scene).columns) * {"double": 8, "single": 4}[precision]
    n, few = (5 << 20) // size + 13, 997
    streamed = series(scene, n, **method)
    for first in range(0, n - few, few):
        plain = series(scene, few, first, **method)
        assert np.array_equal(plain, streamed[:, first : first + few])


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_flag_changes_the_arithmetic_of_the_process(backend):
    """What -ffast-math allows in a library is not done to everyone who loads it."""
    evaluate(slider_crank(["effort"]), backend=backend, flags="-ffast-math")
    assert np.float64(1e-310) * np.float64(0.5) == 5e-311


def pushed(constant):
    m = Mechanism("loaded")
    arm = m.link("arm", length=1, mass=1)
    joint = m.revolute("J", m.ground, arm)
    m.torque("t", arm, 1.0 + constant * m.rate(joint))
    return Scene(m, {"J": motion.polynomial(0.3, 0.4)}, t=(0, 1, 9))


def test_a_number_too_large_for_single_is_refused():
    with pytest.raises(
        SizeError,
        match=r"the number 1e\+39 is too large for single precision, which ends at 3\.4e\+38",
    ):
        evaluate(pushed(1e39), precision="single")
    assert evaluate(pushed(1e39)).array("load:t:mz")[0] == 4e38
