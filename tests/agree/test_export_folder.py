"""The exported folder: what it says of itself, what it goes over, and what is refused."""

import json
import re
import subprocess

import numpy as np
import pytest
from compiled import cc
from mechanisms import slider_crank, truss_platform
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, export, motion
from lagrange_casadi.errors import DeclarationError, PathError, SizeError, UnknownNameError

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("options", "low", "high"),
    [({}, 0, 1e-12), ({"precision": "single"}, 1e-9, 1e-4), ({"table": 8}, 1e-3, 1)],
)
def test_the_folder_says_what_it_holds_and_how_exactly(options, low, high, tmp_path):
    """A table holds numbers of its own; parameters become defaults elsewhere."""
    made = export(slider_crank(), tmp_path, parameters={"l": 0.3125}, **options)
    content = json.loads((tmp_path / "export.json").read_text())
    assert set(content["files"]) | {"export.json"} == {path.name for path in tmp_path.iterdir()}
    assert [row["path"] for row in content["outputs"]] == [member.path for member in made.outputs]
    assert content["scene"] in (tmp_path / "slider_crank.h").read_text()
    assert low < content["error"]["largest"] < high
    off = f"Its outputs are off by about {content['error']['largest']:.0e}"
    for file in ("slider_crank.h", "README.md"):
        text = re.sub(r"\s+", " ", (tmp_path / file).read_text())
        assert f"options of the export: {content['options']}. {off}" in text
        assert ("l = 0.3125" in text) is ("table" in options)
    assert content["fixed"].get("l") == (0.3125 if "table" in options else None)
    if "table" not in options:
        assert "0.3125" in (tmp_path / "slider_crank.c").read_text()


def test_examples_of_iterated_loops_go_in_steps_they_can_follow(tmp_path):
    """That of the folder, and that of the header, which answers with its last status."""
    for scene, options in ((iterated(), {"newton": 1}), (truss_platform(), {})):
        folder = tmp_path / scene.mechanism.name
        p = export(scene, folder, **options).prefix
        header = (folder / f"{p}.h").read_text()
        lines = re.search(rf"     {p}_model model;\n.*?puts\([^\n]*\n", header, re.DOTALL).group()
        head = f'#include "{p}.h"\n#include <stdio.h>\nint main(void) {{\n'
        (folder / "shown.c").write_text(f"{head}{lines}return (int) status;\n}}\n")
        for source, least in (("example.c", 13), ("shown.c", 0)):
            assert cc(["cc", "-std=c99"], folder, f"{p}.c", source).returncode == 0
            ran = subprocess.run([folder / "program"], capture_output=True, text=True, check=True)
            assert ran.stdout.count("\n") >= least


@pytest.mark.parametrize("flag", ["-ffast-math", "-ffinite-math-only"])
def test_arithmetic_without_nan_is_refused(flag, tmp_path):
    export(slider_crank(), tmp_path)
    result = cc(["cc", "-std=c99", "-O2", flag, "-c"], tmp_path, "slider_crank.c", output="x.o")
    assert "compile without -ffast-math" in result.stderr


def test_an_export_goes_over_its_own_files_only(tmp_path):
    out = tmp_path / "out"
    export(slider_crank(), out)
    export(slider_crank(), out, precision="single")
    assert "float" in (out / "slider_crank.h").read_text()
    for name, says in (
        ("notes.txt", r"holds other files, 'notes\.txt' among them"),
        ("example.c", r"an export whose 'example\.c' was changed since"),
    ):
        (out / name).write_text("mine")
        with pytest.raises(PathError, match=says):
            export(slider_crank(), out)
        export(slider_crank(), out, force=True)
        assert ((out / name).read_text() == "mine") == (name == "notes.txt")
        (out / "notes.txt").unlink(missing_ok=True)
    with pytest.raises(PathError, match="holds an export of another name"):
        export(slider_crank(), out, name="pump")
    export(slider_crank(), out, name="pump", force=True)
    there = {path.stem for path in out.glob("*.[ch]")}
    assert there == {"pump", "pump_mex", "example", "selftest"}


def sampled():
    t, m = np.linspace(0, 1, 4001), Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    return Scene(m, {"J": motion.samples(t, t**2)}, t=(0, 1, 11))


def still():
    m = Mechanism("bracket")
    m.weld("wall", m.ground, m.link("arm", length=1.0, mass=2.0))
    return Scene(m, {})


SINGLE = {"precision": "single"}
SLOPES = {"wanted": ["effort", "sensitivity:l"]}
MISTAKES = [
    (slider_crank, {"wanted": ["effrot"]}, UnknownNameError, "unknown output 'effrot'"),
    (slider_crank, {"parameters": {"q": 1.0}}, UnknownNameError, "unknown parameter 'q'"),
    (lambda: "slider_crank", {}, DeclarationError, "expected a Scene"),
    (slider_crank, {"newton": 2, "table": 64}, DeclarationError, "exclude each other"),
    (still, {}, DeclarationError, "'bracket' has no drive, so C would have no inputs"),
    (slider_crank, {"table": 4096, **SINGLE}, SizeError, r"takes \d+ bytes of constants, and the"),
    (sampled, SINGLE, SizeError, r"what curves and motions by samples look up takes 176004 bytes"),
    *(
        (slider_crank, SLOPES | options, DeclarationError, "'sensitivity' needs double precision")
        for options in (SINGLE, {"newton": 2}, {"table": 64})
    ),
    (slider_crank, {"wanted": ["sensitivity"]}, DeclarationError, "sensitivities need other"),
    (
        slider_crank,
        {"structured_text": True, **SINGLE},
        DeclarationError,
        "expected double precision and no table",
    ),
    (
        slider_crank,
        {"control": True, "wanted": ["motion"]},
        DeclarationError,
        "for controllers needs efforts",
    ),
]


@pytest.mark.parametrize(("make", "options", "error", "says"), MISTAKES)
def test_what_is_refused_leaves_no_folder(make, options, error, says, tmp_path):
    with pytest.raises(error, match=says):
        export(make(), tmp_path / "out", **options)
    with pytest.raises(PathError, match="does not exist"):
        export(slider_crank(), tmp_path / "none" / "out")
    assert not list(tmp_path.iterdir())
