"""Exports to controllers: structured text of IEC 61131-3, run; a header of C++, compiled."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from structured import blocks

from lagrange_casadi import evaluate, export, load_case


def written(name, folder, **options):
    scene = load_case(name).scene
    return scene, export(scene, folder, name=name, **options).prefix


@pytest.mark.parametrize("name", ["slider_crank", "scara", "cardan_shaft"])
def test_structured_text_passes_its_test(name, tmp_path):
    """The second has tables and the third iterates; each number that is changed is noticed."""
    scene, prefix = written(name, tmp_path, structured_text=True)
    text = (tmp_path / f"{prefix}.st").read_text()
    test = blocks(text)[f"mechanism_{prefix}_test"]()
    test()
    assert test.failed == 0
    assert test.unit.valid
    solution = evaluate(scene, backend="vm")
    drive = solution.outputs and next(o for o in solution.outputs if o.group == "effort")
    member = "out_" + re.sub(r"\W+", "_", str(drive))
    k = int(np.argmin(np.abs(solution.t - test.t)))
    found, expected = getattr(test.unit, member), solution.outputs[drive]
    assert abs(found - expected[k]) < 1e-10 * np.abs(expected).max()
    other = int(re.search(rf"{member} := y\[(\d+)\];", text)[1]) - 1
    test = blocks(re.sub(rf"({member} := y)\[\d+\];", rf"\1[{other}];", text))
    test = test[f"mechanism_{prefix}_test"]()
    test()
    assert test.failed > 0


def test_what_is_no_result_is_not_valid(tmp_path):
    """Outputs stay those of the last instant that is valid."""
    _, prefix = written("four_bar", tmp_path, structured_text=True)
    unit = blocks((tmp_path / f"{prefix}.st").read_text())[f"mechanism_{prefix}"]()
    unit(in_O=1.0, in_O_rate=2.0, in_O_acceleration=0.0)
    assert unit.valid
    before = unit.out_effort_O
    unit(in_O_rate=1e200)
    assert not unit.valid
    assert unit.out_effort_O == before


@pytest.mark.skipif(not shutil.which("g++"), reason="needs a C++ compiler")
@pytest.mark.parametrize(
    ("name", "precision"), [("arm6", "double"), ("delta", "double"), ("slider_crank", "single")]
)
def test_the_header_for_controllers_passes_its_test(name, precision, tmp_path):
    _, prefix = written(name, tmp_path, control=True, precision=precision, wanted=["effort"])
    strict = ["-O0", "-pedantic", "-Wall", "-Wextra", "-Werror"]
    test = tmp_path / f"{prefix}_control_test.cpp"

    subprocess.run(["gcc", "-std=c99", "-O0", "-c", f"{prefix}.c"], cwd=tmp_path, check=True)

    def run():
        built = ["g++", "-std=c++11", *strict, test.name, f"{prefix}.o", "-o", "test", "-lm"]
        subprocess.run(built, cwd=tmp_path, check=True)
        return subprocess.run(["./test"], cwd=tmp_path, capture_output=True, text=True, check=False)

    assert (done := run()).returncode == 0, done.stdout
    header = tmp_path / f"{prefix}_control.hpp"
    header.write_text(header.read_text().replace("moved[i] - still[i]", "moved[i] + still[i]"))
    done = run()
    assert "reflected inertia times acceleration" in done.stdout
    assert done.returncode == 1
