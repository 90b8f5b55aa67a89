"""The emitted C: pedantically clean, the same text in every process, and the same bits whatever
optimizes it, however many threads run it, and whatever stands beside an instant.
"""

import itertools
import subprocess

import numpy as np
import pytest
from compiled import (
    PEDANTIC,
    SCENES,
    STRICT,
    built,
    columns,
    filled,
)
from conftest import CASES
from design_rows import DENSITIES, loaded
from internals import (
    EvaluationMethod,
    KeptOutputs,
    backends,
    library,
    stages_of,
)
from mechanisms import crank_and_rod, every_function, slider_crank
from parametric import declared

from lagrange_casadi import Mechanism, Scene, codegen, derive, evaluate, motion
from lagrange_casadi.errors import SizeError

pytestmark = pytest.mark.usefixtures("released")

PRECISIONS = ("double", "single")
both = pytest.mark.parametrize("language", ["c", "c++"])
precise = pytest.mark.parametrize("precision", PRECISIONS)
WHOLE = SCENES | {
    "functions": every_function,
    "stations": lambda: crank_and_rod(DENSITIES["table"](), loads=loaded),
    "sleigh": lambda: declared(CASES / "sleigh"),
}


@pytest.mark.quick
@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", WHOLE)
def test_emitted_c_is_pedantically_clean(name, tmp_path):
    """What evaluates instants, and what finishes designs as well; of instants in singles no double
    is meant, and none comes in by a promotion.
    """
    scene = WHOLE[name]()
    program, source = derive(scene), tmp_path / "scene.c"
    steps = (None, 2) if program.newton is not None else (None,)
    for precision, newton in itertools.product(PRECISIONS, steps):
        method = EvaluationMethod(precision=precision, newton=newton)
        stages = stages_of(program, method, np.linspace(*scene.span, scene.t[2]))
        for reduction in (None, KeptOutputs.of(program, method).reduction):
            source.write_text(codegen.emit(program, stages, newton, reduction))
            flags = STRICT if precision == "single" and reduction is None else PEDANTIC
            command = [*codegen.find_compiler().command, *flags, "-fsyntax-only", source]
            result = subprocess.run(command, capture_output=True, text=True, check=False)
            assert result.returncode == 0, (precision, newton, reduction is None, result.stderr)


@pytest.mark.quick
@pytest.mark.sampled(19)
@precise
@both
@pytest.mark.parametrize("name", SCENES)
def test_the_bits_are_those_of_the_instant_alone(name, language, precision, monkeypatch):
    """All values are written; none depends on the optimization, the threads, or the tail."""
    scene = SCENES[name]()
    program, t = derive(scene), np.linspace(*scene.span, 80)
    whole = columns(program, t, language, precision=precision)
    for level in ("-O1", "-O0"):
        again = columns(program, t, language, extra=(level,), precision=precision)
        assert again.tobytes() == whole.tobytes()
    made = built(program, language, precision=precision)
    for n in (*range(1, 19), 63, 64, 65, 72, 79):
        assert np.array_equal(filled(made, program, t[:n], precision=precision), whole[:, :n])
    many = np.tile(t[:79], 500)
    one = filled(made, program, many, precision=precision)
    assert np.array_equal(one[:, :79], whole[:, :79]) or program.newton
    monkeypatch.setattr(library, "_WORTH_A_THREAD", 0)
    for threads in (2, 3, 5):
        assert filled(made, program, many, threads, precision).tobytes() == one.tobytes()


@precise
@both
def test_columns_that_go_past_the_caches_have_the_same_bits(language, precision):
    """Rows that begin with a line of the cache are streamed where they are large; what lies between
    them stays.
    """
    program, real = derive(slider_crank()), {"double": float, "single": np.float32}[precision]
    n = (5 << 20) // (len(program.columns) * np.dtype(real).itemsize) + 13
    library, t = built(program, language, precision=precision), np.linspace(0, 0.08, n)
    lines = backends.rows(len(program.columns), n + 100, real)
    lines[...] = np.nan
    streamed = filled(library, program, t, precision=precision, out=lines[:, :n])
    plain = filled(
        library, program, t, precision=precision, out=backends.rows(len(lines), n + 1, real)[:, 1:]
    )
    assert streamed.tobytes() == plain.tobytes()
    assert np.isnan(lines[:, n:]).all()


@pytest.mark.parametrize("backend", ["c", "lanes"])
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
