"""What reads a cycle table: compiled or not, in blocks or one by one, in either precision, the same
bits.
"""

import math
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from internals import FLAGS, CycleTable, compiler, cycle_table
from tables import case, made, some_motion, worst_gap

from lagrange_casadi import codegen
from lagrange_casadi.errors import DeclarationError


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


def test_instants_one_by_one_take_code_of_their_own(monkeypatch):
    """As a controller has it: nothing is done for instants that are not there, and the bits are the
    same.
    """
    table, rows = made(case("six_bar"), 64), some_motion(40)
    both = [np.full((len(table.columns), 40), np.nan) for _ in range(2)]
    table.evaluate(*rows, both[0])
    monkeypatch.setattr(cycle_table, "_OPTIONS", ("-DBLOCK=1", "-DPACK=1"))
    read(table, rows, both[1], True, monkeypatch)
    assert both[0].tobytes() == both[1].tobytes()


def test_where_a_block_is_cut_changes_no_bit():
    table, rows = made(case("six_bar"), 64), some_motion(301)
    whole, parts = (np.full((len(table.columns), 301), np.nan) for _ in range(2))
    table.evaluate(*rows, whole)
    for start in range(0, 301, 7):
        table.evaluate(*(row[start : start + 7] for row in rows), parts[:, start : start + 7])
    assert whole.tobytes() == parts.tobytes()


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


def test_rows_of_another_layout_are_filled_too():
    table, rows = made(case("slider_crank"), 64), some_motion(50)
    plain = np.full((len(table.columns), 50), np.nan)
    table.evaluate(*rows, plain)
    for other in (
        np.full((50, len(table.columns)), np.nan).T,
        np.full((len(table.columns), 100), np.nan)[:, ::2],
    ):
        table.evaluate(*np.repeat(rows, 2, axis=1)[:, ::2], other)
        assert np.array_equal(other, plain)


def test_single_precision_is_near_and_says_how_near():
    scene = case("slider_crank")
    table = made(scene)
    single = table.single()
    assert single.nbytes == table.nbytes // 2
    assert 1e-8 < single.error < 1e-6
    # At an angle that is exact in single precision, only the table itself rounds.
    motion = [row.astype(np.float32).astype(float) for row in some_motion(turns=1.0)]
    assert worst_gap(scene, single, *motion) < 1.5 * single.error
    assert worst_gap(scene, single, motion[0] + np.float32(32 * math.tau), *motion[1:]) < 1e-4


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


def test_arrays_that_do_not_fit_are_refused():
    table = made(case("slider_crank"), 64, ["effort"])
    row = np.zeros(5)
    with pytest.raises(
        DeclarationError,
        match=r"out: expected an array of float64 of shape \(3, 5\), got float64 of \(2, 5\)",
    ):
        table.evaluate(row, row, row, np.zeros((2, 5)))
    with pytest.raises(
        DeclarationError,
        match=r"out: expected an array of float64 of shape \(3, 5\), got float32 of \(3, 5\)",
    ):
        table.evaluate(row, row, row, np.zeros((3, 5), np.float32))
    with pytest.raises(
        DeclarationError, match=r"expected three rows of one length, got \(5,\), \(4,\) and \(5,\)"
    ):
        table.evaluate(row, row[:4], row, np.zeros((3, 5)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"turns": 0}, "turns: expected at least 1, got 0"),
        ({"kept": np.ones((4, 2), dtype=bool)}, r"kept: expected the shape \(4, 3\), got \(4, 2\)"),
        (
            {"coefficients": np.zeros((12, 4))},
            r"coefficients: expected at least 13 rows of 4, got \(12, 4\)",
        ),
        (
            {"coefficients": np.zeros((69, 5))},
            r"coefficients: expected at least 13 rows of 4, got \(69, 5\)",
        ),
        (
            {"coefficients": np.zeros((69, 4), dtype=int)},
            r"coefficients: expected contiguous rows of float64 or float32, got int64",
        ),
        ({"coefficients": np.zeros((4, 69)).T}, r"coefficients: expected contiguous rows"),
        ({"drift": np.zeros(2)}, r"drift: expected one of each column, 3, got \(2,\)"),
        ({"peaks": np.zeros(1)}, r"peaks: expected one of each column, 3, got \(1,\)"),
    ],
)
def test_a_table_of_parts_that_do_not_fit_is_refused(change, message):
    table = made(case("slider_crank"), 64, ["effort"])
    assert isinstance(table, CycleTable)
    with pytest.raises(DeclarationError, match=message):
        replace(table, **change)
