"""Grids of section forces: compiled or not, in one piece or in many, the same bits."""

from dataclasses import replace

import numpy as np
import pytest
from internals import FORCES, NumericDensity, PointLoad, SectionLaw, compiler, grids
from mechanisms import slider_crank

from lagrange_casadi import evaluate, load, save
from lagrange_casadi.errors import DeclarationError, SizeError

pytestmark = pytest.mark.quick

random = np.random.default_rng(4)


def loaded_law(n):
    """A link with a load at its tip, one at a station, and one that travels from before the base to
    beyond the tip.
    """
    coefficients = {
        name: random.normal(size=n) for name in ("n0", "n1", "n2", "f0", "f1", "f2", "m0")
    }
    stations = (np.ones(n), np.full(n, 0.4), np.linspace(-0.1, 1.1, n))
    loads = tuple(
        PointLoad(f"load{i}", station, *random.normal(size=(3, n)))
        for i, station in enumerate(stations)
    )
    return SectionLaw(
        0.7, NumericDensity((0.0, 0.3, 1.0), ((1.3, 0.2), (0.5,))), coefficients, loads
    )


@pytest.mark.parametrize(
    ("n", "k"), [(1, 1), (1, 4097), (700, 7), (3, 5000), (911, 201), (2, 100_001), (140_000, 1)]
)
def test_compiled_and_not_agree_to_the_last_bit(n, k, monkeypatch):
    law, xi = loaded_law(n), np.linspace(0, 1, k)
    for force in FORCES:
        monkeypatch.setattr(grids, "WORTH_COMPILING", 10**12)
        plain = law.on_grid(force, xi)
        monkeypatch.setattr(grids, "WORTH_COMPILING", 0)
        for share, streaming in ((10**9, 10**12), (1000, 10**12), (1000, 0), (10**9, 0)):
            monkeypatch.setattr(grids, "_SHARE", share)
            monkeypatch.setattr(grids, "_STREAMING", streaming)
            for offset in (0, 1):  # off the vectors' boundaries too
                out = np.full(n * k + 1, np.nan)[offset : offset + n * k].reshape(n, k)
                assert law.on_grid(force, xi, out) is out
                assert out.tobytes() == plain.tobytes()


@pytest.mark.parametrize("many", [0, 2])
@pytest.mark.parametrize("planes", [1, 2])
@pytest.mark.parametrize("terms", [1, 2, 3, 4, 5, 9])
def test_sums_of_any_length_agree_to_the_last_bit(terms, planes, many, monkeypatch):
    """A link with loads along it has more terms than others: a resultant of five once lost its last
    one in compiled code.
    """
    n, k = 97, 37
    columns, rows = [*random.normal(size=(planes * terms, n))], random.normal(size=(terms, k))
    loads = [tuple(random.uniform(0, 1, size=(3, n))) for _ in range(planes * many)]
    u, found = np.linspace(0, 1, k), []
    for worth, share, streaming in (
        (10**12, 1, 0),
        (0, 10**9, 10**12),
        (0, 1000, 10**12),
        (0, 10**9, 0),
        (0, 1000, 0),
    ):
        monkeypatch.setattr(grids, "WORTH_COMPILING", worth)
        monkeypatch.setattr(grids, "_SHARE", share)
        monkeypatch.setattr(grids, "_STREAMING", streaming)
        found.append(np.full((n + 1, k), np.nan))
        given = grids.Columns(columns, loads, planes), grids.Functions(rows)
        grids.fill([given], u, found[-1][None, :n], threads=3)
        assert np.isnan(found[-1][n]).all()
    assert len({grid.tobytes() for grid in found}) == 1
    sums = np.zeros((planes, n, k))
    for plane in range(planes):
        for m in range(plane * terms, (plane + 1) * terms):
            sums[plane] += columns[m][:, None] * rows[m - plane * terms]
        for station, constant, slope in loads[plane * many : (plane + 1) * many]:
            sums[plane] += np.where(
                u < station[:, None],
                constant[:, None] + slope[:, None] * (station[:, None] - u),
                0.0,
            )
    expected = np.hypot(*sums) if planes == 2 else sums[0]
    np.testing.assert_allclose(found[0][:n], expected, rtol=0, atol=1e-13)


def test_a_grid_is_what_the_law_gives_at_each_point():
    law, xi = loaded_law(50), np.linspace(0, 1, 41)
    for force in FORCES:
        np.testing.assert_allclose(
            law.on_grid(force, xi), law.at(force, np.tile(xi, (50, 1))), rtol=0, atol=1e-14
        )


@pytest.mark.parametrize("loaded", [False, True])
def test_grids_of_several_forces_are_those_of_each_and_follow_the_law(loaded, monkeypatch):
    """Addresses of a law's arrays are kept: numbers that are written into these later count."""
    monkeypatch.setattr(grids, "WORTH_COMPILING", 0)
    law, other = (replace(loaded_law(90), **({} if loaded else {"loads": ()})) for _ in range(2))
    xi, found = np.linspace(0, 1, 41), np.empty((len(FORCES), 90, 41))
    law.on_grids(FORCES, xi, found)
    assert [grid.tobytes() for grid in found] == [law.on_grid(f, xi).tobytes() for f in FORCES]
    for mine, new in zip(law.outputs("rod").values(), other.outputs("rod").values(), strict=True):
        mine[:] = new
    law.on_grids(FORCES, xi, found)
    assert [grid.tobytes() for grid in found] == [other.on_grid(f, xi).tobytes() for f in FORCES]


@pytest.mark.parametrize(
    ("designs", "n", "k"), [(1, 1, 1), (5, 40, 7), (3, 200, 2100), (2, 1, 4097)]
)
@pytest.mark.parametrize("worth", [0, 10**12])
def test_what_is_largest_over_the_instants_is_that_of_each_design_s_grid(
    designs, n, k, worth, monkeypatch
):
    laws, xi = [loaded_law(n) for _ in range(designs)], np.linspace(0, 1, k)
    scale = np.linspace(0.5, 2.0, designs)[:, None]
    stations = [
        PointLoad(
            "",
            *(
                np.stack([getattr(law.loads[i], name) for law in laws])
                for name in ("station", "n", "f", "m")
            ),
        )
        for i in range(3)
    ]
    together = SectionLaw(
        0.7 * scale,
        NumericDensity((0.0, 0.3, 1.0), ((1.3 * scale, 0.2 * scale), (0.5 * scale,))),
        {name: np.stack([law.coefficients[name] for law in laws]) for name in laws[0].coefficients},
        tuple(stations),
    )
    monkeypatch.setattr(grids, "WORTH_COMPILING", worth)
    for force in FORCES:
        found = together.largest(force, together.basis(xi))
        for row, law, (factor,) in zip(found, laws, scale, strict=True):
            density = NumericDensity(
                (0.0, 0.3, 1.0), ((1.3 * factor, 0.2 * factor), (0.5 * factor,))
            )
            grid = replace(law, length=0.7 * factor, density=density).on_grid(force, xi)
            best = grid[np.argmax(np.abs(grid), axis=0), np.arange(k)]
            assert row.tobytes() == best.tobytes()


@pytest.mark.parametrize("worth", [0, 10**12])
def test_what_is_largest_of_two_as_large_and_of_nothing(worth, monkeypatch):
    monkeypatch.setattr(grids, "WORTH_COMPILING", worth)
    rows = [
        [-2.0, 2.0, 1.0],
        [np.nan] * 3,
        [1.0, -3.0, 0.0],
        [np.nan, 2.0, 1.0],
        [1.0, np.inf, 1.0],
    ]
    columns = grids.Columns([np.array(rows), *np.zeros((2, 5, 3))])
    found = grids.largest((columns, grids.Functions(np.ones((3, 5, 4)))), np.linspace(0, 1, 4))
    np.testing.assert_array_equal(
        found, np.repeat([[2.0], [np.nan], [-3.0], [np.nan], [np.nan]], 4, axis=1)
    )


def test_without_a_compiler_numpy_fills(monkeypatch):
    monkeypatch.setattr(compiler, "find_compiler", lambda: None)
    grids._compiled.cache_clear()
    law, xi = loaded_law(400), np.linspace(0, 1, 401)
    plain = law.on_grid("bending", xi)
    grids._compiled.cache_clear()
    monkeypatch.undo()
    assert np.array_equal(law.on_grid("bending", xi), plain)


def test_a_file_written_in_blocks_holds_the_whole_grid(tmp_path, monkeypatch):
    solution = evaluate(slider_crank(), t=(0, 0.08, 203), xi=(0, 1, 17))
    for chunk, block in ((1 << 20, 1 << 23), (1000, 5000), (40, 40)):
        monkeypatch.setattr("lagrange_casadi.store.runs._CHUNK_BYTES", chunk)
        monkeypatch.setattr("lagrange_casadi.store.runs._BLOCK_BYTES", block)
        save(solution, tmp_path / "x.h5")
        again = load(tmp_path / "x.h5")
        for force in FORCES:
            assert np.array_equal(
                again.array(f"section:rod:{force}"), solution.array(f"section:rod:{force}")
            )


def test_what_does_not_fit_into_memory_is_one_line_with_its_size():
    with pytest.raises(
        SizeError,
        match=(
            r"not enough memory for a grid of axial: 11 x 1 000 000 000 000 values are 8\.8e\+04"
            r" GB, and this machine has"
        ),
    ):
        grids.empty("a grid of axial", (11, 10**12))


def test_an_array_of_another_layout_is_filled_too(monkeypatch):
    law, xi = loaded_law(60), np.linspace(0, 1, 41)
    plain = law.on_grid("bending", xi)
    monkeypatch.setattr(grids, "WORTH_COMPILING", 0)
    wide = np.full((60, 82), -1.0)
    law.on_grid("bending", xi, wide[:, ::2])
    assert np.array_equal(wide[:, ::2], plain)
    assert np.all(wide[:, 1::2] == -1.0)
    assert np.array_equal(law.on_grid("bending", xi, np.full((60, 41), np.nan, order="F")), plain)
    np.testing.assert_allclose(law.on_grid("bending", xi.astype(np.float32)), plain, atol=1e-5)
    with pytest.raises(
        DeclarationError, match=r"out: expected an array of shape \(60, 41\), got \(59, 41\)"
    ):
        law.on_grid("bending", xi, np.zeros((59, 41)))
