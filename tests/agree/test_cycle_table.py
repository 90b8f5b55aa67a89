"""What reads a cycle table: compiled or not, in blocks or one by one, in either precision, the same
bits.
"""

import math
import re
import shutil
import subprocess

import numpy as np
import pytest
from internals import FLAGS, compiler, cycle_table
from tables import case, made, some_motion

from lagrange_casadi import codegen


def read(table, motion, out, compiled, monkeypatch):
    with monkeypatch.context() as patch:
        if not compiled:
            patch.setattr(compiler, "find_compiler", lambda: None)
        cycle_table._compiled.cache_clear()
        table.evaluate(*motion, out)
    cycle_table._compiled.cache_clear()
    return out


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", ["slider_crank", "andrews_squeezer"])
def test_compiled_and_not_give_the_same_bits(name, dtype, monkeypatch):
    """In blocks between two nodes and in others, whole blocks and not, with rows apart; more
    columns than a tile holds.
    """
    table = made(case(name), 64)
    table = table.single() if dtype is np.float32 else table
    random = some_motion(1003, turns=20.0)
    for angles in (random[0], np.linspace(-40.0, 40.0, 1003), np.linspace(0.1, 0.2, 1003)):
        rows = [row.astype(dtype) for row in (angles, *random[1:])]
        for n in (0, 1, 15, 16, 17, 1003):
            cut = [row[:n] for row in rows]
            wide = [np.full((len(table.columns), n + 8), np.nan, dtype) for _ in range(2)]
            compiled, plain = (
                read(table, cut, w[:, :n], c, monkeypatch)
                for w, c in zip(wide, (True, False), strict=True)
            )
            assert np.isfinite(compiled).all()
            assert compiled.tobytes() == plain.tobytes()
            assert np.isnan(wide[0][:, n:]).all()


@pytest.mark.parametrize("compiled", [True, False])
def test_what_is_no_number_gives_none_and_reads_nothing_else(compiled, monkeypatch):
    table = made(case("slider_crank"), 64, ["effort"])
    rows = np.array(
        [
            [math.nan, math.inf, -math.inf, 1e300, 0.3, 0.3, 0.3],
            [1.0] * 4 + [math.nan, 1, 1],
            [1.0] * 6 + [math.inf],
        ]
    )
    out = read(table, rows, np.zeros((3, 7)), compiled, monkeypatch)
    assert table.columns == ("_closure:guide", "_gap:guide", "effort:O")
    assert np.isnan(out[[0, 2], :3]).all()
    assert np.isnan(out[2, 4])
    assert np.isfinite(out[:, 5]).all()
    assert np.isinf(out[2, 6])


@pytest.mark.skipif(shutil.which("objdump") is None, reason="no objdump to look with")
def test_single_precision_takes_no_double(tmp_path):
    compiler = codegen.find_compiler("c")
    source = tmp_path / "interpolate.c"
    source.write_text(cycle_table.source())
    found = {}
    for real in ("float", "double"):
        target = tmp_path / f"{real}.o"
        command = [
            *compiler.command,
            *(flag for flag in FLAGS["c"] if flag != "-shared"),
            f"-DREAL={real}",
            "-c",
            source,
            "-o",
            target,
        ]
        subprocess.run(command, check=True)
        text = subprocess.run(
            ["objdump", "-d", "-r", target], check=True, capture_output=True, text=True
        ).stdout
        found[real] = re.findall(
            r"cvtss2sd|cvtsd2ss|mulsd|mulpd|\bfcvt\s+[ds]|\bfmul\s+(?:d|v\d+\.2d)|malloc|<sin", text
        )
    assert not found["float"]
    assert found["double"]


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_reader_is_pedantically_clean(real, tmp_path):
    source = tmp_path / "interpolate.c"
    source.write_text(cycle_table.source())
    flags = [
        "-std=c99",
        "-pedantic",
        "-Wall",
        "-Wextra",
        "-Wdouble-promotion",
        "-Wconversion",
        "-Werror",
        f"-DREAL={real}",
    ]
    command = [*codegen.find_compiler("c").command, *flags, "-c", source, "-o", tmp_path / "out.o"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
