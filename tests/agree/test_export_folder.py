"""The exported folder: what is in it, what it says of itself, and what it goes over."""

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


def test_the_manifest_knows_all_files(tmp_path):
    made = export(slider_crank(), tmp_path)
    content = json.loads((tmp_path / "export.json").read_text())
    assert set(content["files"]) | {"export.json"} == {path.name for path in tmp_path.iterdir()}
    assert [row["path"] for row in content["outputs"]] == [member.path for member in made.outputs]
    assert content["scene"] in (tmp_path / "slider_crank.h").read_text()


@pytest.mark.parametrize(
    ("options", "low", "high"),
    [({}, 0, 1e-12), ({"precision": "single"}, 1e-9, 1e-4), ({"table": 8}, 1e-3, 1)],
)
def test_the_folder_says_how_it_is_evaluated_and_how_exactly(options, low, high, tmp_path):
    export(slider_crank(), tmp_path, parameters={"l": 0.3125}, **options)
    content = json.loads((tmp_path / "export.json").read_text())
    assert low < content["error"]["largest"] < high
    said = (
        f"options of the export: {content['options']}. Its outputs are off by about"
        f" {content['error']['largest']:.0e}"
    )
    for file in ("slider_crank.h", "README.md"):
        text = re.sub(r"\s+", " ", (tmp_path / file).read_text())
        assert said in text
        assert ("l = 0.3125" in text) is ("table" in options)
    assert content["fixed"] == (
        {"r": 0.1, "l": 0.3125, "m1": 0.1, "m2": 0.1, "m3": 0.1} if "table" in options else {}
    )


def test_examples_of_iterated_loops_go_in_steps_they_can_follow(tmp_path):
    for number, (scene, options) in enumerate(
        ((iterated(), {"newton": 1}), (truss_platform(), {}))
    ):
        folder = tmp_path / str(number)
        made = export(scene, folder, **options)
        assert cc(["cc", "-std=c99"], folder, f"{made.prefix}.c", "example.c").returncode == 0
        ran = subprocess.run([folder / "program"], capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
        assert ran.stdout.count("\n") == 13
        (folder / "shown.c").write_text(
            shown((folder / f"{made.prefix}.h").read_text(), made.prefix)
        )
        assert cc(["cc", "-std=c99"], folder, f"{made.prefix}.c", "shown.c").returncode == 0
        assert subprocess.run([folder / "program"], check=False).returncode == 0


def shown(header, prefix):
    """The header's own example as a program that answers with its last status."""
    lines = re.search(rf"     {prefix}_model model;\n.*?puts\([^\n]*\n", header, re.DOTALL).group()
    return (
        f'#include "{prefix}.h"\n#include <stdio.h>\nint main(void) {{\n{lines}return (int)'
        " status;\n}\n"
    )


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
    (out / "notes.txt").write_text("mine")
    with pytest.raises(PathError, match=r"holds other files, 'notes\.txt' among them"):
        export(slider_crank(), out)
    export(slider_crank(), out, force=True)
    assert (out / "notes.txt").read_text() == "mine"
    (out / "notes.txt").unlink()
    (out / "example.c").write_text("int main(void) { return 0; }\n")
    with pytest.raises(PathError, match=r"an export whose 'example\.c' was changed since"):
        export(slider_crank(), out)
    export(slider_crank(), out, force=True)
    assert "slider_crank" in (out / "example.c").read_text()


def test_what_an_earlier_export_alone_had_goes(tmp_path):
    export(slider_crank(), tmp_path, name="press")
    (tmp_path / "build").mkdir()
    with pytest.raises(PathError, match="holds an export of another name"):
        export(slider_crank(), tmp_path, name="pump")
    export(slider_crank(), tmp_path, name="pump", force=True)
    assert {path.stem for path in tmp_path.glob("*.[ch]")} == {
        "pump",
        "pump_mex",
        "example",
        "selftest",
    }
    assert (tmp_path / "build").is_dir()


def test_nothing_of_others_is_touched_even_by_force(tmp_path):
    (tmp_path / "README.md").write_text("mine")
    with pytest.raises(PathError, match=r"'README\.md' there is no file of an export"):
        export(slider_crank(), tmp_path, force=True)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"README.md": "mine"}


def test_a_table_too_large_for_its_target(tmp_path):
    with pytest.raises(
        SizeError,
        match=r"the table of the cycle takes \d+ bytes of constants, and the limit is 64000",
    ):
        export(slider_crank(), tmp_path / "out", table=4096, precision="single")
    assert not (tmp_path / "out").exists()
    t = np.linspace(0, 1, 4001)
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    scene = Scene(m, {"J": motion.samples(t, t**2)}, t=(0, 1, 11))
    with pytest.raises(
        SizeError, match=r"what curves and motions by samples look up takes 176004 bytes"
    ):
        export(scene, tmp_path / "out", precision="single")
    export(scene, tmp_path / "out", precision="single", largest=200_000)


def test_what_no_drive_moves_is_refused(tmp_path):
    m = Mechanism("bracket")
    m.weld("wall", m.ground, m.link("arm", length=1.0, mass=2.0))
    with pytest.raises(DeclarationError, match="'bracket' has no drive, so C would have no inputs"):
        export(Scene(m, {}), tmp_path / "out")
    assert not list(tmp_path.iterdir())


def test_mistakes(tmp_path):
    with pytest.raises(UnknownNameError, match="unknown output 'effrot'"):
        export(slider_crank(), tmp_path / "out", wanted=["effrot"])
    with pytest.raises(UnknownNameError, match="unknown parameter 'q'"):
        export(slider_crank(), tmp_path / "out", parameters={"q": 1.0})
    with pytest.raises(DeclarationError, match="expected a Scene"):
        export("slider_crank", tmp_path / "out")
    with pytest.raises(DeclarationError, match="newton and table exclude each other"):
        export(slider_crank(), tmp_path / "out", newton=2, table=64)
    with pytest.raises(PathError, match="does not exist"):
        export(slider_crank(), tmp_path / "none" / "out")
    assert not list(tmp_path.iterdir())
