"""Files of runs: round trip, every reader, grids, what check finds, and what is never replaced."""

import os
import re

import h5py
import numpy as np
import pytest
import sweeps
from conftest import ROOT
from forging import edit

from lagrange_casadi import Sweep, check, evaluate, load, save
from lagrange_casadi.errors import BusyError, DeclarationError, PathError, StoreError

pytestmark = pytest.mark.quick

FOREIGN = "it is an HDF5 file of something else, or without its seal"


@pytest.fixture
def file(solution, tmp_path):
    path = tmp_path / "result.h5"
    save(solution, path)
    return path


@pytest.mark.parametrize(
    ("change", "finding"),
    [
        (
            lambda h: h["section/rod/bending"].__setitem__((3, 4), 7.0),
            "section/rod/bending: differs from its law by",
        ),
        (
            lambda h: h["effort/O"].__setitem__(5, np.nan),
            "effort/O: values that are not finite",
        ),
        (
            lambda h: h["effort/O"].attrs.__setitem__("units", "lbf ft"),
            "effort/O: units 'lbf ft', expected 'N m'",
        ),
        (
            lambda h: h["effort/O"].attrs.__setitem__("sign", "whatever"),
            "effort/O: sign differs from the schema",
        ),
        (lambda h: h["effort/O"].dims[0].detach_scale(h["t"]), "effort/O: axis 0 has no scale /t"),
        (lambda h: h.__delitem__("effort"), "effort/O: missing"),
        (
            lambda h: h["effort/O"].__setitem__(5, 3.0),
            "power: .*, computed anew, is worse than the tolerance|balance: ",
        ),
        (
            lambda h: h["certificate/power"].__setitem__(5, 0.1),
            "certificate/power: 0.1 is worse than the tolerance 1e-09",
        ),
    ],
)
def test_check_names_what_is_wrong(file, change, finding):
    edit(file, change)
    found = check(file)
    assert re.search(finding, found[0])


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"notes", "it is no file of HDF5"),
        (b"\x89HDF\r\n\x1a\n" + b"damaged" * 100, FOREIGN),
        (b"MATLAB".ljust(512) + b"\x89HDF\r\n\x1a\n" + b"damaged" * 100, FOREIGN),
    ],
)
def test_nothing_is_replaced_that_was_not_read_and_found_to_be_a_run(
    solution, tmp_path, content, says
):
    target = tmp_path / "x.h5"
    target.write_bytes(content)
    with pytest.raises(PathError, match=rf"cannot write .*x\.h5: {says}; choose another name"):
        save(solution, target)
    assert target.read_bytes() == content


@pytest.mark.parametrize("mode", ["r+", "a"])
def test_a_run_that_another_program_writes_is_left_alone(solution, file, mode):
    before = file.stat().st_ino
    with sweeps.held(file, mode):
        with pytest.raises(BusyError, match=r"result\.h5: another program has it open to write"):
            save(solution, file)
        with pytest.raises(StoreError, match=r"result\.h5: another program has it open to write"):
            load(file)
        assert file.stat().st_ino == before


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
def bell():
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
def test_what_is_left_out_is_filled_from_the_law(bell, tmp_path, grids, links):
    path = tmp_path / "bell.h5"
    save(bell, path, grids=grids)
    assert stored(path) == links
    assert check(path) == []
    back = load(path)
    assert list(back.names()) == list(bell.names())
    assert dict(back.errors) == dict(bell.errors)
    for name in bell.names():
        np.testing.assert_array_equal(back.array(name), bell.array(name), err_msg=name)
    for link in bell.links_with_sections:
        name = f"section:{link}:bending"
        assert back.peak(name) == bell.peak(name)


def test_the_documentation_verifies_a_file(solution, tmp_path, monkeypatch):
    (block,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "schema.md").read_text(), re.DOTALL
    )
    save(solution.during(slice(0, 5)), tmp_path / "press.h5")
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "schema.md", "exec"), {})
    content = bytearray((tmp_path / "press.h5").read_bytes())
    content[5000] ^= 1
    (tmp_path / "press.h5").write_bytes(content)
    with pytest.raises(AssertionError):
        exec(compile(block, "schema.md", "exec"), {})


def test_other_files_and_places_are_refused(solution, file, tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as h:
        h["x"] = 1.0
    (tmp_path / "folder.h5").mkdir()
    os.mkfifo(tmp_path / "pipe.h5")
    for name, error, says in (
        ("other", StoreError, "it has no seal: .*; run it again$"),
        ("folder", PathError, "is a folder, not a file$"),
        ("pipe", PathError, "is a device or a pipe, not a file$"),
        ("missing", PathError, "no such file"),
    ):
        for read in (load, check, Sweep.open):
            with pytest.raises(error, match=says):
                read(tmp_path / f"{name}.h5")
    edit(file, lambda h: h.attrs.__setitem__("schema_version", 99))
    with pytest.raises(StoreError, match="schema version 99, this program reads version 1"):
        load(file)
    for one, place, more, says in (
        (tmp_path, solution, {}, r"save: (solution|path): expected a"),
        (solution, tmp_path, {}, "it is a folder"),
        (solution, tmp_path / "nowhere" / "x.h5", {}, "folder .*nowhere does not exist"),
        (solution, tmp_path / "a.h5", {"grids": ["bell"]}, "unknown link with sections 'bell'"),
        (solution, tmp_path / "a.h5", {"grids": "rod"}, "grids: expected True or False or a list"),
    ):
        with pytest.raises((PathError, DeclarationError), match=says):
            save(one, place, **more)
    assert not (tmp_path / "a.h5").exists()
