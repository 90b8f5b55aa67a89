"""What crosses from Python to C: structs that lie alike on both sides, whose members are set by
name.
"""

import ctypes
import subprocess

import numpy as np
import pytest
from internals import (
    CURVES,
    GRID,
    INSTANTS,
    INTERPOLATE,
    LARGEST,
    Call,
    DesignEngine,
    EvaluationMethod,
    interface,
)
from internals import DESIGNS_CALL as DESIGNS
from internals import SEARCH_CALL as SEARCH
from mechanisms import slider_crank

from lagrange_casadi import codegen, derive

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


def test_the_emitted_c_has_the_structs():
    """What the layout was asked of is what is compiled."""
    program = derive(slider_crank())
    assert INSTANTS.text() in codegen.emit(program)
    engine = DesignEngine.of(slider_crank(), method=EvaluationMethod("vm"))
    source = codegen.emit(engine.program, engine.stages, None, engine.kept.reduction)
    assert INSTANTS.text() in source
    assert interface("double") + DESIGNS.text() in source


def test_members_are_set_by_name_and_none_is_forgotten():
    made = UNEVEN.made(f=6, e=5, d=4, c=3, b=None, a=1)
    assert [getattr(made, name) for name in UNEVEN.members] == [1, None, 3, 4, 5, 6]
    with pytest.raises(TypeError, match="uneven: without b, e"):
        UNEVEN.made(a=1, c=3, d=4, f=6)
    with pytest.raises(AttributeError):
        UNEVEN.made(a=1, b=None, c=3, d=4, e=5, g=6)


@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_the_order_of_results_does_not_matter(backend):
    engine = DesignEngine.of(slider_crank(), method=EvaluationMethod(backend))
    p = np.array([list(slider_crank().mechanism.values().values())])
    expected = engine.evaluate(p)
    q, e = len(engine.quantities), len(engine.efforts)
    names = {
        "history": None,
        "rms": np.full((1, e), np.nan),
        "xi": np.full((1, q), np.nan),
        "value": np.full((1, q), np.nan),
    }
    names |= {
        "mean": np.full((1, e), np.nan),
        "status": np.full(1, -1, np.int8),
        "peak_t": np.full((1, q), np.nan),
    }
    engine.library.designs(engine.t[None], np.zeros((1, 0), bool), p, names)
    for name, own in (
        ("status", "status"),
        ("value", "value"),
        ("peak_t", "t"),
        ("xi", "xi"),
        ("mean", "mean"),
        ("rms", "rms"),
    ):
        assert names[name].tobytes() == getattr(expected, own).tobytes()
    found = {name: array for name, array in names.items() if name != "history"}
    with pytest.raises(TypeError, match="without history"):
        engine.library.designs(engine.t[None], np.zeros((1, 0), bool), p, found)
