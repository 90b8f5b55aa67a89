"""Exported C: clean to every compiler, right by its own test, loud where it fails, and without a
name that C keeps for itself.
"""

import re
import subprocess

import numpy as np
import pytest
from compiled import EVALUATED, PREPARED, UNPREPARED, assert_clean, cc, told
from conftest import CASES, NAMES
from every_way import laws
from mechanisms import sampled_cam, slider_crank, spline_arm, truss_platform
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, export, load_case, motion, table

ARITHMETIC = {
    "double": {},
    "single": {"precision": "single"},
    "newton": {"newton": 2, "precision": "single"},
    "table": {"table": 64},
    "single table": {"table": 64, "precision": "single"},
    "slopes": {"wanted": ["all", "sensitivity"]},
}
SCENES = {
    "cam": sampled_cam,
    "press": slider_crank,
    "laws": laws,
    "spline_arm": spline_arm,
    "iterated": iterated,
    "truss_platform": truss_platform,
} | {name: lambda name=name: load_case(CASES / name).scene for name in NAMES}
EXPORTED = [(name, way) for name in SCENES for way in ("double", "single")]
EXPORTED += [("press", "table"), ("press", "single table"), ("press", "slopes")]
EXPORTED += [("iterated", "newton"), ("truss_platform", "newton"), ("truss_platform", "slopes")]
EXPORTED += [("laws", "slopes")]
SANITIZED = ["-O0", "-g", "-ffp-contract=off", "-fsanitize=address,undefined"]
SANITIZED += ["-fno-sanitize-recover=all"]


def self_test(folder, prefix, *flags):
    """Whether the self-test of a folder passes, and what it says."""
    built = cc(["cc", "-std=c99", *flags], folder, f"{prefix}.c", "selftest.c")
    assert built.returncode == 0, built.stderr
    ran = subprocess.run([folder / "program"], capture_output=True, text=True, check=False)
    return ran.returncode == 0, ran.stdout + ran.stderr


@pytest.mark.sampled(31)
@pytest.mark.parametrize(("name", "way"), sorted(EXPORTED))
def test_it_is_clean_and_passes_its_own_test(name, way, tmp_path):
    """By every compiler, and under sanitizers; only prefixed symbols are seen, nothing is kept
    between calls, and of libraries only functions of the precision are asked for.
    """
    made = export(SCENES[name](), tmp_path, **ARITHMETIC[way])
    assert_clean(tmp_path, made.prefix)
    passes, says = self_test(tmp_path, made.prefix, *SANITIZED)
    assert passes, says
    assert "0 wrong" in says
    command = ["nm", tmp_path / f"{made.prefix}.c.o"]
    listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = [line.split()[-2:] for line in listed.splitlines()]
    assert all(name.startswith(f"{made.prefix}_") for kind, name in found if kind in "TDRBC")
    assert not [name for kind, name in found if kind in "DdBbC"], "no state"
    needed = {name for kind, name in found if kind == "U"}
    suffix = "f" if "single" in way or way == "newton" else ""
    functions = (
        "" if "table" in way else "sin cos sincos atan2 sqrt ceil fmax fmin exp log pow fmod"
    )
    allowed = {word + suffix for word in f"{functions} floor".split()}
    assert needed <= allowed | {"_GLOBAL_OFFSET_TABLE_", "memset", "memcpy"}
    text = (tmp_path / f"{made.prefix}.c").read_text()
    assert not re.search(r"\b(malloc|calloc|realloc|free|alloca)\b", text)
    assert not suffix or not re.search(r"\bdouble\b", text)


def test_its_own_test_can_fail(tmp_path):
    """For an output, and for a derivative."""
    made = export(slider_crank(), tmp_path, wanted=["all", "sensitivity"])
    source = (tmp_path / "selftest.c").read_text()
    for head, says in (("outputs_at", f"{made.outputs[0].name} is"), ("slopes_at", " by ")):
        rows = source.partition(f"{head}[INSTANTS]")[2].partition("{\n  {")[2]
        first = rows.partition(",")[0]
        wrong = rows.replace(first, repr(float(first) + 1e-3), 1)
        (tmp_path / "selftest.c").write_text(source.replace(rows, wrong))
        passes, said = self_test(tmp_path, made.prefix)
        assert not passes
        assert says in said


UNTIMELY = "status = @_motion(&model, NAN, &inputs); "
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


def test_a_table_beyond_its_ends_is_told(tmp_path):
    """A brake by a table of the angle up to 0.5 rad, at 0.5 and at 0.7 rad, and no other load."""
    m = Mechanism("braked")
    arm = m.link("arm", length=m.parameter("l", 0.3, "m"), mass=0.0)
    turn = m.revolute("O", m.ground, arm)
    m.torque("brake", arm, -table(m.coordinate(turn), [0.0, 0.5], [1.0, 3.0]))
    scene = Scene(m, {"O": motion.polynomial(0.0, 0.1)}, t=(0, 5, 11), wanted=["effort"])
    tried = (PREPARED + f"inputs.O = {angle}; " + EVALUATED for angle in ("0.5", "0.7"))
    (within, effort, _), (status, other, words) = told(tmp_path, export(scene, tmp_path), *tried)
    assert (within, effort) == (0, pytest.approx(3.0, rel=1e-6))
    assert status != 0
    assert np.isnan(other)
    assert "outside the curve's range" in words


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


def test_names_may_be_words_of_c_and_of_its_headers(tmp_path):
    """Of ISO C's headers, which are all there before the exported header."""
    m = Mechanism("double")
    names = "NULL EOF M_PI INT_MAX SEEK_SET stdin errno SIGINT DBL_EPSILON true I SEAL EDOM"
    names = [*names.split(), "double", "register"]
    parts = [m.parameter(name, 0.1, "m", low=0.0) for name in names]
    first = m.link("NAN", length=sum(parts), mass=1.0)
    m.revolute("INFINITY", m.ground, first)
    m.revolute("class", first.tip, m.link("BUFSIZ", length=0.3, mass=1.0))
    scene = Scene(
        m, {"INFINITY": motion.polynomial(0, 1), "class": motion.polynomial(0, 2)}, t=(0, 1, 5)
    )
    made = export(scene, tmp_path)
    assert made.prefix == "double_mechanism"
    assert made.mapped.items() >= {f"parameter {name}": f"{name}_" for name in names}.items()
    assert made.mapped["input class"] == "class_"
    headers = (
        "assert complex ctype errno fenv float inttypes limits locale math setjmp signal stdarg"
        " stdbool stddef stdint stdio stdlib"
    )
    first = "".join(
        f"#include <{header}.h>\n"
        for header in [*headers.split(), "string", "tgmath", "time", "wchar", "wctype"]
    )
    for file in (f"{made.prefix}.c", "selftest.c"):
        (tmp_path / file).write_text(first + (tmp_path / file).read_text())
    done = cc(["cc", "-std=gnu11"], tmp_path, f"{made.prefix}.c", "selftest.c")
    assert done.returncode == 0, done.stderr
    assert subprocess.run([tmp_path / "program"], check=False, capture_output=True).returncode == 0
