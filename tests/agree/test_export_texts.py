"""Texts that users give, in files that others compile, build and read: they are shown, and nothing
else comes of them.
"""

import json
import re
import shutil
import subprocess
import zipfile
from xml.etree import ElementTree

import pytest
from compiled import assert_clean, cc
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_casadi import Mechanism, Scene, evaluate, export, motion
from lagrange_casadi.errors import DeclarationError

WICKED = [
    'x"),fopen("PWNED","w"),printf("',
    "x*/ int pwned; /*",
    "*\\/ int pwned; /\\*",
    '100 %s %n %d "quoted" \\',
    "what??/\" ??' ??( trigraphs",
    "it's $HOME ${CMAKE_COMMAND} $<1:x> #[[ ]] <b>&amp;</b> | `rm` ",
    "// comment \\",
    "Kurbel\u2013Presse \u00b5m\u00b2 \U0001f600",
    "%{ %} '); system('touch PWNED'); ('",
    "</title><script>alert(1)</script>",
    "long" * 75,
]
CHARACTERS = st.characters(exclude_categories=["C", "Zs", "Zl", "Zp"], include_characters=" ")
LINES = st.text(CHARACTERS, min_size=1, max_size=40).map(lambda line: f"a{line}z")
TARGETS = ["INTERFACE", "ZERO_CHECK", "RUN_TESTS", "ALL", "test", "install", "Package", "PROJECT"]
TAKEN = "Test clean CMAKE con NUL Prn com1 lpt9 example Selftest double class nullptr typeof errno"
TAKEN += " math String unistd pthread stdio Windows matrix linux I EOF TRUE SEEK_SET debug"
FREE = "slider_crank press engine interface_2 Interface library A E1 B0 console"


def arm(unit="m"):
    m = Mechanism("arm")
    m.revolute("O", m.ground, m.link("a", length=m.parameter("l", 0.5, unit, low=0.0), mass=1.0))
    return Scene(m, {"O": motion.polynomial(0, 2)}, t=(0, 1, 5), wanted=["effort"])


def shown(line, folder):
    """Export a mechanism of this name, of whose parameter it is the unit too; build, run, read."""
    made = export(arm(line), folder, name=line)
    assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", made.prefix)
    assert_clean(folder, made.prefix)
    for source in ("example.c", "selftest.c"):
        assert cc(["cc"], folder, f"{made.prefix}.c.o", f"{source}.o").returncode == 0
        said = subprocess.run([folder / "program"], cwd=folder, capture_output=True, check=True)
    assert said.stdout.decode().startswith(f"{line}: ")
    assert not (folder / "PWNED").exists()
    header = (folder / f"{made.prefix}.h").read_text()
    (struct,) = re.findall(rf"typedef struct \{{\n([^\n]*)\n\}} {made.prefix}_parameters;", header)
    assert re.fullmatch(rf"  {made.prefix}_real l; /\* [^\n]* \*/", struct)
    assert header.count("*/") == header.count("/*")
    content = json.loads((folder / "export.json").read_text())
    assert (content["mechanism"], content["parameters"][0]["unit"]) == (line, line)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("wicked", WICKED)
def test_a_name_and_a_unit_are_only_ever_shown(tmp_path, wicked):
    shown(wicked, tmp_path)


@settings(max_examples=3, deadline=None)
@given(line=LINES)
def test_any_line_is_only_ever_shown(line, tmp_path_factory):
    shown(line, tmp_path_factory.mktemp("lines"))


@pytest.mark.sampled(13)
@pytest.mark.skipif(shutil.which("cmake") is None, reason="needs cmake")
@pytest.mark.parametrize("name", [*WICKED[:2], WICKED[5], *TARGETS])
def test_a_name_stops_no_build(tmp_path, name):
    folder, build = tmp_path / "c", tmp_path / "build"
    export(arm(), folder, name=name)
    for command in (
        ["cmake", "-S", folder, "-B", build],
        ["cmake", "--build", build],
        ["ctest", "--test-dir", build],
        ["cmake", "--install", build, "--prefix", tmp_path / "installed"],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    assert not list(tmp_path.rglob("PWNED"))


def test_a_name_that_is_taken_is_another_one(tmp_path):
    scene = arm()
    for name in [*TARGETS, *TAKEN.split(), *FREE.split()]:
        made = export(scene, tmp_path, name=name, force=True)
        assert made.prefix == (name if name in FREE.split() else f"{name}_mechanism")


@pytest.mark.parametrize("wicked", ["two\nlines", "tab\t", "nul\0", "\u202eright", "lone \udcff"])
def test_what_is_no_line_of_text_is_refused(tmp_path, wicked):
    for what in (lambda: export(arm(), tmp_path, name=wicked), lambda: arm(wicked)):
        with pytest.raises(DeclarationError, match="must be a line of printable characters, got "):
            what()
    says = r"flags: expected options of a compiler, .*: they hold a null character"
    with pytest.raises(DeclarationError, match=says):
        evaluate(arm(), flags="-DX=\0")
    assert not list(tmp_path.iterdir())


@pytest.mark.sampled(7)
@pytest.mark.parametrize("wicked", WICKED)
def test_an_fmu_shows_them_too(tmp_path, wicked):
    pytest.importorskip("fmpy")
    made = export(arm(wicked), tmp_path, name=wicked, fmu=True)
    with zipfile.ZipFile(tmp_path / f"{made.prefix}.fmu") as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        page = archive.read("documentation/index.html").decode()
    assert root.get("modelName") == wicked
    assert wicked in [unit.get("name") for unit in root.iter("Unit")]
    assert "<script>" not in page
