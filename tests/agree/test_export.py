"""The exported folder: what it holds, that it is clean C, that it fails loudly, and that it is the
same bytes each time.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from compiled import EVALUATED, cc, compilers, present, told
from mechanisms import sampled_cam, slider_crank, spline_arm, truss_platform
from places import FOLDERS
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, export, load_case, motion, table

ARITHMETIC = [
    {},
    {"precision": "single"},
    {"newton": 2, "precision": "single"},
    {"table": 64},
    {"table": 64, "precision": "single"},
]
ITERATED = {"iterated": iterated, "truss_platform": truss_platform}
SCENES = {"cam": sampled_cam, "slider_crank": slider_crank, "spline_arm": spline_arm} | ITERATED
ON = [
    (name, options)
    for name in SCENES
    for options in ARITHMETIC
    if name in ITERATED or "newton" not in options
]
CASES = sorted(path.parent for path in (Path(__file__).parents[2] / "cases").glob("*/case.py"))


def keywords():
    """A mechanism whose names are words that C and C++ keep for themselves."""
    m = Mechanism("double")
    l = m.parameter("double", 0.5, "m", low=0.0)
    arm = m.link("int", length=l, mass=m.parameter("register", 2.0, "kg"))
    m.revolute("class", m.ground, arm)
    return Scene(m, {"class": motion.polynomial(0, 2)}, t=(0, 1, 11))


# Only one drive that turns has a cycle to be read from a table.
@pytest.mark.sampled(19)
@pytest.mark.parametrize(
    ("name", "options"), [(n, o) for n, o in ON if n == "slider_crank" or "table" not in o], ids=str
)
def test_the_source_is_clean(name, options, tmp_path):
    clean(SCENES[name](), tmp_path, options, compilers())


@pytest.mark.sampled(37)
@pytest.mark.parametrize("options", ARITHMETIC[:2], ids=str)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_source_of_every_case_is_clean(case, options, tmp_path):
    clean(load_case(case).scene, tmp_path, options, compilers()[:2])


def clean(scene, folder, options, commands):
    made = export(scene, folder, **options)
    for label, command in commands:
        if not present(command[0]):
            continue
        programs = (
            [f"{made.prefix}.c"]
            if "++" in label
            else [f"{made.prefix}.c", "selftest.c", "example.c"]
        )
        for source in programs:
            result = cc([*command, "-O2", "-c"], folder, source, output="x.o")
            assert result.returncode == 0, f"{label} {source}: {result.stderr}"


@pytest.mark.sampled(13)
@pytest.mark.parametrize(("name", "options"), [(n, o) for n, o in ON if "table" not in o], ids=str)
def test_the_self_test_passes_under_sanitizers(name, options, tmp_path):
    made = export(SCENES[name](), tmp_path, **options)
    sanitized = [
        "cc",
        "-std=c99",
        "-g",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ]
    result = cc(sanitized, tmp_path, f"{made.prefix}.c", "selftest.c")
    if "cannot find" in result.stderr:
        pytest.skip("this compiler has no sanitizers' libraries")
    assert result.returncode == 0, result.stderr
    ran = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "0 wrong" in ran.stdout


def test_the_self_test_can_fail(tmp_path):
    made = export(slider_crank(), tmp_path)
    source = (tmp_path / "selftest.c").read_text()
    _, _, rows = source.partition("outputs_at[INSTANTS][OUTPUTS] = {\n  {")
    first = rows.partition(",")[0]
    (tmp_path / "selftest.c").write_text(
        source.replace(rows, rows.replace(first, f"{float(first) + 1e-3!r}", 1))
    )
    assert cc(["cc", "-std=c99"], tmp_path, f"{made.prefix}.c", "selftest.c").returncode == 0
    ran = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert f"wrong: {made.outputs[0].name} is" in ran.stdout


def symbols(folder, prefix):
    assert cc(["cc", "-std=c99", "-O2", "-c"], folder, f"{prefix}.c", output="x.o").returncode == 0
    lines = subprocess.run(
        ["nm", folder / "x.o"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return [line.split()[-2:] for line in lines]


@pytest.mark.sampled(5)
@pytest.mark.parametrize("options", ARITHMETIC, ids=str)
def test_only_prefixed_symbols_are_seen_and_only_libm_is_needed(options, tmp_path):
    made = export(truss_platform() if "newton" in options else slider_crank(), tmp_path, **options)
    found = symbols(tmp_path, made.prefix)
    assert all(name.startswith(f"{made.prefix}_") for kind, name in found if kind in "TDRBC")
    assert not [name for kind, name in found if kind in "DdBbC"], "no state"
    needed = {name for kind, name in found if kind == "U"} - {
        "_GLOBAL_OFFSET_TABLE_",
        "memset",
        "memcpy",
    }
    functions = {"sin", "cos", "sincos", "atan2", "sqrt", "ceil", "floor", "fmax"}
    suffix = "f" if options.get("precision") == "single" else ""
    assert needed <= {name + suffix for name in functions}


UNPREPARED = "status = @_prepare(&model, &parameters);"
UNTIMELY = "status = @_motion(&model, NAN, &inputs); "
PREPARED = "status = @_prepare(&model, &parameters); @_motion(&model, 0.01, &inputs); "


FAILURES = [
    ("model.seal = 0; inputs.O = 0; " + EVALUATED, "the model was not prepared"),
    ("parameters.l = -1; " + UNPREPARED, "a parameter is not finite, or out of its range"),
    ("parameters.r = 0; " + UNPREPARED, "or gives a link no length"),
    ("parameters.l = NAN; " + UNPREPARED, "a parameter is not finite"),
    ("parameters.m2 = INFINITY; " + UNPREPARED, "a parameter is not finite"),
    (PREPARED + "inputs.O_rate = NAN; " + EVALUATED, "an input is not finite"),
    (PREPARED + "inputs.O = INFINITY; " + EVALUATED, "an input is not finite"),
    (PREPARED + UNTIMELY + EVALUATED, "an input is not finite"),
    (PREPARED + UNTIMELY + "outputs.effort_O = NAN;", "the time is not finite"),
    (
        "parameters.l = 0.05; " + PREPARED + "inputs.O = 1.5; " + EVALUATED,
        "its links do not reach",
    ),
    (
        "parameters.l = 0.1; " + PREPARED + "inputs.O = 1.5707963267948966; " + EVALUATED,
        "a loop is at a dead centre",
    ),
    (PREPARED + "inputs.O_rate = 1e200; " + EVALUATED, "a result is not finite"),
    (PREPARED + "outputs.effort_O = NAN; status = (@_status) 99;", "unknown status"),
]
SECTION = (
    "@_forces forces; %s status = @_section(&model, &outputs, SLIDER_CRANK_LINK_ROD, %s, &forces);"
    " outputs.effort_O = forces.axial;"
)


def test_failures_say_so_and_leave_nothing_undefined(tmp_path):
    """Of an evaluation, and of the forces of a link at ratios outside it."""
    ratios = ("-0.001", "1.001", "NAN", "INFINITY")
    sections = [SECTION % (PREPARED + EVALUATED, ratio) for ratio in ratios]
    lost = SECTION % (PREPARED + "inputs.O = NAN; " + EVALUATED, "0.5")
    tried = [
        *FAILURES,
        *((section, "a ratio xi/l is outside 0 to 1") for section in sections),
        (lost, "a result is not finite"),
    ]
    found = told(tmp_path, export(slider_crank(), tmp_path), *(what for what, _ in tried))
    for (statements, says), (status, value, sentence) in zip(tried, found, strict=True):
        assert status != 0, statements
        assert says in sentence, statements
        assert np.isnan(value) or statements.endswith(UNPREPARED), statements


@pytest.mark.parametrize(("beyond", "there"), [(None, None), ("hold", 3.0), ("line", 3.8)])
def test_a_table_beyond_its_ends_is_told(beyond, there, tmp_path):
    """A brake by a table of the angle up to 0.5 rad, at 0.5 and at 0.7 rad, and no other load."""
    m = Mechanism("braked")
    arm = m.link("arm", length=m.parameter("l", 0.3, "m"), mass=0.0)
    turn = m.revolute("O", m.ground, arm)
    m.torque("brake", arm, -table(m.coordinate(turn), [0.0, 0.5], [1.0, 3.0], beyond=beyond))
    scene = Scene(m, {"O": motion.polynomial(0.0, 0.1)}, t=(0, 5, 11), wanted=["effort"])
    made = export(scene, tmp_path)
    tried = (PREPARED + f"inputs.O = {angle}; " + EVALUATED for angle in ("0.5", "0.7"))
    (within, effort, _), (status, other, sentence) = told(tmp_path, made, *tried)
    assert (within, effort) == (0, pytest.approx(3.0, rel=1e-6))
    if there is None:
        assert status != 0
        assert np.isnan(other)
        assert "outside the curve's range" in sentence
    else:
        assert (status, other) == (0, pytest.approx(there, rel=1e-6))


def test_iterated_loops_report_failure_and_stay_where_they_were(tmp_path):
    made = export(iterated(), tmp_path, newton=2)
    far = "inputs.O += 2.5; " + EVALUATED
    back = "inputs.O -= 2.5; " + EVALUATED
    tried = (PREPARED + EVALUATED + far, PREPARED + EVALUATED + far + back)
    (away, lost, _), (again, effort, _) = told(tmp_path, made, *tried)
    assert away != 0
    assert np.isnan(lost)
    assert again == 0
    assert not np.isnan(effort)


def test_twice_the_same_bytes(tmp_path):
    program = (
        f"import sys; sys.path[:0] = {FOLDERS!r}; from mechanisms import slider_crank; from"
        " lagrange_casadi import export; "
    )
    program += "export(slider_crank(), sys.argv[1], precision='single')"
    for name, seed in (("one", "1"), ("two", "2")):
        environment = {
            "PYTHONHASHSEED": seed,
            "PATH": "",
            "XDG_CACHE_HOME": str(tmp_path / f"cache_{name}"),
        }
        subprocess.run(
            [sys.executable, "-c", program, tmp_path / name],
            check=True,
            env=environment,
        )
    files = {path.name: path.read_bytes() for path in (tmp_path / "one").iterdir()}
    assert files == {path.name: path.read_bytes() for path in (tmp_path / "two").iterdir()}
    assert not any(str(tmp_path).encode() in content for content in files.values())


def test_names_that_c_keeps_for_itself(tmp_path):
    made = export(keywords(), tmp_path)
    assert made.prefix == "double_mechanism"
    assert made.mapped == {
        "name double": "double_mechanism",
        "parameter double": "double_",
        "parameter register": "register_",
        "input class": "class_",
    }
    for text in (
        (tmp_path / "README.md").read_text(),
        (tmp_path / "double_mechanism.h").read_text(),
    ):
        assert "parameter register" in text
        assert "register_" in text
    for _, command in compilers():
        if present(command[0]):
            result = subprocess.run(
                [*command, "-c", tmp_path / "double_mechanism.c", "-o", tmp_path / "x.o"],
                capture_output=True,
                text=True,
                check=False,
            )
            assert result.returncode == 0, result.stderr
    assert cc(["cc", "-std=c99"], tmp_path, "double_mechanism.c", "selftest.c").returncode == 0
    subprocess.run([tmp_path / "program"], check=True, capture_output=True)
