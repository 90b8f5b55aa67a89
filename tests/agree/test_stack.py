"""No call takes more stack than the header says, whatever compiles it."""

import functools
import re
import shutil
from pathlib import Path

import pytest
from stack_usage import deepest

from lagrange_casadi import export, load_case

CASES = sorted(path.parent.name for path in (Path(__file__).parents[2] / "cases").glob("*/case.py"))
ITERATED = ("beam_pump", "bricard", "cardan_shaft", "delta", "five_link_suspension", "rrr3")
FLAGS = ("-std=c99", "-ffp-contract=off", "-fno-math-errno")
CORTEX = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
COMPILERS = {
    "gcc -O0": ("gcc", "-O0"),
    "gcc -O2": ("gcc", "-O2"),
    "clang -O2": ("clang", "-O2"),
    "arm -O2": ("arm-none-eabi-gcc", *CORTEX, "-O2"),
    "arm -Os": ("arm-none-eabi-gcc", *CORTEX, "-Os"),
}
METHODS = {
    "double": {},
    "single": {"precision": "single"},
    "newton": {"newton": 2},
    "slopes": {"wanted": ["all", "sensitivity"]},
    "table": {"table": 1e-6, "precision": "single", "wanted": ["effort"]},
}


def stated(header):
    return int(re.search(r"^#define \w+_STACK (\d+)$", header.read_text(), re.MULTILINE)[1])


@functools.cache
def exported(name, method, folder):
    loaded = load_case(Path(__file__).parents[2] / "cases" / name)
    agreed = export(loaded.scene, folder, name=loaded.name, **METHODS[method])
    return folder / f"{agreed.prefix}.c"


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """Where sources are exported to, once for all compilers."""
    return tmp_path_factory.mktemp("sources")


# A bound is nearest where functions are inlined in one another, and iterated loops are one more.
BUILT = [
    (case, method, name) for case in CASES for method in ("double", "single") for name in COMPILERS
]
BUILT += [(case, "newton", name) for case in ITERATED for name in COMPILERS if name.endswith("-O2")]
BUILT += [
    (case, "slopes", name) for case in ("slider_crank", "v_twin", "excavator") for name in COMPILERS
]
BUILT += [(case, "table", name) for case in ("slider_crank", "six_bar") for name in COMPILERS]


@pytest.mark.sampled(197)
@pytest.mark.parametrize(("case", "method", "compiler"), BUILT)
def test_the_stack_that_the_header_states_is_never_exceeded(
    case, method, compiler, sources, tmp_path
):
    command = (*COMPILERS[compiler], *FLAGS)
    if shutil.which(command[0]) is None:
        pytest.skip(f"there is no {command[0]}")
    source = exported(case, method, sources / f"{method}-{case}")
    assert 64 < deepest(command, source, tmp_path) <= stated(source.with_suffix(".h"))
