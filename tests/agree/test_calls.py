"""What crosses from Python to C: structs that lie alike on both sides, whose members are set by
name.
"""

import ctypes
import subprocess

import pytest
from internals import (
    CURVES,
    GRID,
    INSTANTS,
    INTERPOLATE,
    LARGEST,
    Call,
    interface,
)
from internals import DESIGNS_CALL as DESIGNS
from internals import SEARCH_CALL as SEARCH

from lagrange_casadi import codegen

CALLS = (INSTANTS, CURVES, SEARCH, DESIGNS, GRID, LARGEST, INTERPOLATE)
UNEVEN = Call(
    "uneven", {"a": "int", "b": "const real*", "c": "int", "d": "int", "e": "long long", "f": "int"}
)


@pytest.mark.parametrize("language", ["c", "c++"])
@pytest.mark.parametrize("real", ["double", "float"])
def test_structs_lie_alike_in_c_and_python(language, real, tmp_path):
    """Sizes and places of all members, by the compilers that build what is called."""
    compiler = codegen.find_compiler(language)
    wanted, lines = [], []
    for call in (*CALLS, UNEVEN):
        wanted += [ctypes.sizeof(call.type)]
        lines += [f"sizeof({call.name})"]
        for name in call.members:
            member = getattr(call.type, name)
            wanted += [member.offset, member.size]
            lines += [f"offsetof({call.name}, {name})", f"sizeof(((const {call.name}*) 0)->{name})"]
    source = tmp_path / ("layout.c" if language == "c" else "layout.cpp")
    printed = "".join(f'  printf("%lu\\n", (unsigned long) ({line}));\n' for line in lines)
    of_search = interface("double" if real == "double" else "single")
    types = of_search + "".join(
        call.text(real) for call in (*CALLS, UNEVEN) if call not in (CURVES, SEARCH)
    )
    source.write_text(
        f"#include <stddef.h>\n#include <stdio.h>\n{types}int main(void) {{\n{printed}  return"
        " 0;\n}\n"
    )
    subprocess.run([*compiler.command, source, "-o", tmp_path / "layout"], check=True)
    told = subprocess.run([tmp_path / "layout"], capture_output=True, text=True, check=True).stdout
    assert [int(line) for line in told.split()] == wanted
