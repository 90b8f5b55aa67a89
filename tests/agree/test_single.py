"""Single means single: in the C, in what compilers make of it, and in the numbers."""

import platform
import re
import shutil
import subprocess

import pytest
from compiled import HEADER, SCENES, STRICT
from internals import FLAGS, LANES_PLACE, compensated, plain
from mechanisms import every_function
from operations import EACH

from lagrange_casadi import Mechanism, Scene, codegen, derive, evaluate
from lagrange_casadi.errors import SizeError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("released")


WHOLE = SCENES | {"functions": every_function}


def built(name, precision, language, folder):
    """The object code of a scene, by the package's own flags, pedantically clean."""
    program = derive(WHOLE[name]())
    source = codegen.emit(
        program, plain(program) if precision == "double" else compensated(program, precision)
    )
    path = folder / ("scene.c" if language == "c" else "scene.cpp")
    path.write_text(
        source if language == "c" else source.replace(LANES_PLACE, HEADER.read_text(), 1)
    )
    flags = [flag for flag in FLAGS[language] if flag not in ("-shared", "-nostartfiles")]
    # A pack is passed as the machine's vectors are, and CasADi knows no C++.
    flags += STRICT if language == "c" else [*STRICT[3:], "-Wno-psabi"]
    command = [
        *codegen.find_compiler(language).command,
        *flags,
        "-c",
        path,
        "-o",
        folder / "scene.o",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "scene.o"


# Arithmetic, comparisons and conversions of doubles, in SSE, AVX and x87; to move or to mask eight
# bytes is none.
ON_DOUBLES = re.compile(
    r"v?(add|sub|mul|div|sqrt|max|min|cmp\w*|u?comi|round|rndscale|rcp\w*|rsqrt\w*|scalef|reduce|get\w+|h(add|sub)|addsub|dp)[sp]d"
    r"|vfn?m\w+[sp]d|v?cvt\w*[sp]d\w*|f(ld|st|add|sub|mul|div|prem|sqrt|ild|com|ucom|i?st)\w*"
)


def on_doubles(path):
    """The instructions on doubles in object code."""
    listed = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", path], capture_output=True, text=True, check=True
    )
    found = re.findall(r"^\s*[0-9a-f]+:\s+(?:\{\w+\}\s+)?(\w+)", listed.stdout, re.MULTILINE)
    assert len(found) > 50
    return {instruction for instruction in found if ON_DOUBLES.fullmatch(instruction)}


def functions_of_doubles(path):
    """The functions of doubles that object code asks a library for."""
    listed = subprocess.run(["nm", "-u", path], capture_output=True, text=True, check=True)
    names = [line.split()[-1].rpartition("_")[2] for line in listed.stdout.splitlines()]
    return {name for name in names if name in {*EACH, "pow", "sincos"} - {"not", "and", "or"}}


tools = pytest.mark.skipif(
    not (
        shutil.which("objdump")
        and shutil.which("nm")
        and platform.machine() in ("x86_64", "AMD64", "i686")
    ),
    reason="reads the instructions of x86 by objdump and nm",
)


@pytest.mark.sampled(13)
@tools
@pytest.mark.parametrize("language", ["c", "c++"])
@pytest.mark.parametrize("name", WHOLE)
def test_no_instruction_is_on_doubles(name, language, tmp_path):
    path = built(name, "single", language, tmp_path)
    assert on_doubles(path) == set()
    assert functions_of_doubles(path) == set()


@tools
@pytest.mark.parametrize("language", ["c", "c++"])
def test_instructions_on_doubles_are_told(language, tmp_path):
    """The same look at code for doubles finds them."""
    path = built("functions", "double", language, tmp_path)
    assert {name.removeprefix("v")[:3] for name in on_doubles(path)} >= {"add", "mul", "sub"}
    assert functions_of_doubles(path) >= {"atan2", "exp", "erf", "hypot", "pow"}


def loaded(constant):
    m = Mechanism("loaded")
    arm = m.link("arm", length=1, mass=1)
    joint = m.revolute("J", m.ground, arm)
    m.torque("t", arm, 1.0 + constant * m.rate(joint))
    return Scene(m, {"J": polynomial(0.3, 0.4)}, t=(0, 1, 9))


def test_a_number_too_large_for_single_is_refused():
    with pytest.raises(
        SizeError,
        match=r"the number 1e\+39 is too large for single precision, which ends at 3\.4e\+38",
    ):
        evaluate(loaded(1e39), precision="single")
    assert evaluate(loaded(1e39)).array("load:t:mz")[0] == 4e38
