"""The emitted C: pedantically clean, reproducible, and the same numbers as the virtual machine."""

import itertools
import os
import subprocess
import sys

import casadi as ca
import numpy as np
import pytest
from compiled import PEDANTIC, SCENES, STRICT, columns, fake_compiler
from conftest import CASES
from design_rows import DENSITIES, loaded
from internals import PRECISIONS, EvaluationMethod, KeptOutputs, compiler, run, stages_of
from mechanisms import crank_and_rod, every_function, slider_crank
from parametric import declared
from places import FOLDERS, TESTS

from lagrange_casadi import Mechanism, Scene, codegen, derive, evaluate, motion
from lagrange_casadi.errors import CompilerError

pytestmark = pytest.mark.usefixtures("released")


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
@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", SCENES)
def test_c_fills_every_value_and_agrees_with_the_virtual_machine(name):
    scene = SCENES[name]()
    program = derive(scene)
    t, p = np.linspace(*scene.span, scene.t[2]), np.array(list(scene.mechanism.values().values()))
    out = columns(program, t, "c")
    machine, _ = run(program, t, p, EvaluationMethod("vm"))
    scale = np.max(np.abs(machine.out), axis=1, keepdims=True) + 1e-300
    assert np.max(np.abs(out - machine.out) / scale) <= (
        0.0 if name in ("slider_crank", "four_bar") else 1e-13
    )


@pytest.mark.sampled(21)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("language", ["c", "c++"])
@pytest.mark.parametrize("name", SCENES)
def test_the_level_of_optimization_changes_no_bit(name, language, precision):
    scene = SCENES[name]()
    program, t = derive(scene), np.linspace(scene.t[0], scene.t[1], 37)
    found = {
        columns(program, t, language, extra=extra, precision=precision).tobytes()
        for extra in ((), ("-O1",), ("-O0",))
    }
    assert len(found) == 1


@pytest.mark.parametrize("backend", ["c", "lanes"])
def test_no_flag_changes_the_arithmetic_of_the_process(backend):
    """What -ffast-math allows in a library is not done to everyone who loads it."""
    evaluate(slider_crank(["effort"]), backend=backend, flags="-ffast-math")
    assert np.float64(1e-310) * np.float64(0.5) == 5e-311


@pytest.mark.parametrize("backend", ["vm", "c", "lanes"])
def test_a_load_may_call_a_function_that_is_not_inlined(backend):
    x = ca.SX.sym("x")
    called = ca.Function("called", [x], [ca.sin(x) * x], {"never_inline": True})
    m = Mechanism("arm")
    k, arm = m.parameter("k", 2.0), m.link("arm", length=1, mass=1)
    joint = m.revolute("J", m.ground, arm)
    m.torque("t", arm, called(m.coordinate(joint)) * called(k))
    solution = evaluate(Scene(m, {"J": motion.polynomial(0.3, 1)}, t=(0, 1, 9)), backend=backend)
    angle = solution.motion("J").value
    np.testing.assert_allclose(
        solution.series["load:t:mz"], np.sin(angle) * angle * np.sin(2.0) * 2.0, rtol=1e-14
    )


def test_emission_is_the_same_in_every_process(tmp_path):
    """Two interpreters with different hash seeds emit the same bytes; no path, no clock."""
    program = (
        "import sys; sys.path[:0] = {!r}; from mechanisms import slider_crank; from lagrange_casadi"
        " import codegen, derive; "
    )
    program = (
        program.format([str(tmp_path), *FOLDERS]) + "print(codegen.emit(derive(slider_crank())))"
    )
    texts = []
    for seed in ("1", "2"):
        environment = os.environ | {"PYTHONHASHSEED": seed}
        done = subprocess.run(
            [sys.executable, "-c", program],
            capture_output=True,
            text=True,
            check=True,
            env=environment,
        )
        texts.append(done.stdout)
    assert texts[0] == texts[1]
    assert str(tmp_path) not in texts[0]
    assert str(TESTS) not in texts[0]


def test_a_changed_parameter_derives_and_compiles_nothing(fresh_cache):
    scene = slider_crank()
    evaluate(scene, backend="c")
    before = sorted(fresh_cache.iterdir())
    evaluate(scene, backend="c", parameters={"l": 0.3, "m2": 1.0}, t=(0, 1, 7))
    assert sorted(fresh_cache.iterdir()) == before
    assert sorted(path.suffix for path in before) == [".c", ".graph", ".sha256", ".so"]


def test_a_damaged_library_is_built_again_and_said(fresh_cache):
    evaluate(slider_crank(["effort"]), backend="c")
    (path,) = fresh_cache.glob("*.so")
    whole = path.read_bytes()
    path.unlink()  # it is mapped into this process
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.warns(
        UserWarning, match=r"the cached library .*\.so was damaged and is built again"
    ):
        evaluate(slider_crank(["effort"]), backend="c")
    assert path.read_bytes() == whole


def test_a_failing_compiler_is_quoted_and_its_message_kept(tmp_path, fresh_cache, monkeypatch):
    fake_compiler(
        tmp_path,
        monkeypatch,
        'test "$1" = --version && echo fake 1.0 && exit 0; echo "x.c:1: error: no" >&2; exit 3',
    )
    with pytest.raises(
        CompilerError,
        match=r"fake-cc failed with status 3: x\.c:1: error: no \(whole message in .*\.log\)",
    ):
        evaluate(slider_crank(["effort"]), backend="c")
    assert [path.read_text() for path in fresh_cache.glob("*.log")] == ["x.c:1: error: no\n"]
    assert not list(fresh_cache.glob("*.so"))


@pytest.fixture
def _no_compiler(monkeypatch):
    for variable in ("CC", "CXX"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda _: None)


@pytest.mark.usefixtures("_no_compiler")
def test_without_a_compiler_the_virtual_machine_serves_and_says_so():
    with pytest.warns(UserWarning, match=r"no C or C\+\+ compiler found"):
        solution = evaluate(slider_crank(["effort"]))
    assert solution.provenance.backend == "vm"
    for backend, needs in (("c", "C"), ("lanes", r"C\+\+")):
        with pytest.raises(CompilerError, match=f"backend '{backend}' needs a {needs} compiler"):
            evaluate(slider_crank(["effort"]), backend=backend)
    with pytest.raises(
        CompilerError,
        match=r"precision 'single' needs a compiler: none of c\+\+, .*, ziglang found",
    ):
        evaluate(slider_crank(["effort"]), precision="single")


def test_a_failing_cxx_compiler_is_said_and_c_serves(tmp_path, fresh_cache, monkeypatch):
    fake_compiler(
        tmp_path,
        monkeypatch,
        'test "$1" = --version && exit 0; echo "x.cpp:1: error: no" >&2; exit 3',
        "CXX",
    )
    with pytest.warns(
        UserWarning, match=r"fake-cc failed with status 3: x\.cpp:1: error: no .*; using scalar C"
    ):
        assert evaluate(slider_crank(["effort"])).provenance.backend == "c"
    with pytest.raises(CompilerError, match="fake-cc failed with status 3"):
        evaluate(slider_crank(["effort"]), backend="lanes")
