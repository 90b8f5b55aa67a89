"""Grids of section forces in files: which links have them, and that readers fill them from laws."""

import h5py
import numpy as np
import pytest
from internals import figures

from lagrange_casadi import check, evaluate, load, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

CASE = """
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import bent_bar
from lagrange_casadi.motion import harmonic


def scene():
    m = Mechanism("bell")
    bar = bent_bar(m, "bell", [(0.3, 0.0), (0.0, 0.0), (0.0, 0.2)], mass=2.0)
    rod = m.link("rod", length=0.4, mass=1.0)
    m.revolute("pivot", m.ground, bar.corner(1))
    m.revolute("pin", bar.tip, rod)
    swing = {"pivot": harmonic(0.0, 0.3, 2.0), "pin": harmonic(0.2, 0.4, 3.0)}
    return Scene(m, swing, t=(0, 1, 61))
"""


@pytest.fixture(scope="module")
def solution():
    names = {}
    exec(CASE, names)
    return evaluate(names["scene"]())


def stored(path):
    with h5py.File(path) as file:
        return {link for link in file["section"] if "bending" in file["section"][link]}


@pytest.mark.parametrize(
    ("grids", "links"),
    [
        (None, {"rod"}),
        (True, {"rod", "bell_1", "bell_2"}),
        (False, set()),
        (["bell_2"], {"bell_2"}),
    ],
)
def test_what_is_left_out_is_filled_from_the_law(solution, tmp_path, grids, links):
    path = tmp_path / "bell.h5"
    save(solution, path, grids=grids)
    assert stored(path) == links
    assert check(path) == []
    back = load(path)
    assert list(back.names()) == list(solution.names())
    assert dict(back.errors) == dict(solution.errors)
    for name in solution.names():
        np.testing.assert_array_equal(back.array(name), solution.array(name), err_msg=name)
    for link in solution.links_with_sections:
        name = f"section:{link}:bending"
        assert back.peak(name) == solution.peak(name)


def test_readers_need_no_grids(solution, tmp_path):
    pages = []
    for name, grids in (("none", False), ("all", True)):
        (tmp_path / name).mkdir()
        save(solution, tmp_path / name / "a.h5", grids=grids)
        back = load(tmp_path / name / "a.h5")
        back.report(tmp_path / name / "a.html")
        pages.append((tmp_path / name / "a.html").read_bytes())
        back.to_xarray()
    assert pages[0] == pages[1]
    bare = load(tmp_path / "none" / "a.h5")
    (bending,) = [spec for spec in figures.default_figures(bare) if spec.name == "section_bell_1"]
    assert all(path for _, path in figures.draw(bare, [bending], tmp_path))
    sizes = [(tmp_path / name / "a.h5").stat().st_size for name in ("none", "all")]
    assert sizes[0] < sizes[1] / 2


def test_grids_are_of_links_with_sections(solution, tmp_path):
    with pytest.raises(UnknownNameError, match="link with sections"):
        save(solution, tmp_path / "a.h5", grids=["bell"])
    with pytest.raises(DeclarationError, match="grids: expected True or False or a list of texts"):
        save(solution, tmp_path / "a.h5", grids="rod")
    assert not (tmp_path / "a.h5").exists()


def test_the_command_stores_what_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.py").write_text(CASE)
    run = ["run", "case.py", "--no-figures", "--out", "a.h5"]
    every = {"rod", "bell_1", "bell_2"}
    for options, links in (
        ([], {"rod"}),
        (["--grids"], every),
        (["--no-grids"], set()),
        (["--want", "section:bell_1", "--want", "section:rod"], {"rod", "bell_1"}),
    ):
        main([*run, *options])
        assert stored("a.h5") == links
